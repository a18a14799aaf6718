"""One question, which triangle first, and interchangeable answers to it.

`base.Accelerator` is the whole contract, `registry.STRUCTURES` the list of those who keep it. A
structure says only *which* triangle a ray meets; t and barycentrics come from
`raysvc.geometry.triangle`, shared by all, so that a picture does not depend on the structure.
"""
