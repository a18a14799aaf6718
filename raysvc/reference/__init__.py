"""Reference mode: light followed along random paths, as the truth to measure approximations by.

sequence_kernels       well spread random numbers
eye                    rays from the lens through the pixels
environment            directions to where an environment is bright
emitters               points on triangles that shine
scattering_kernels     glTF's BRDF: its value, its sampling, and the density of that
paths                  all of it put together, a wave of paths at a time
film                   sums of samples per pixel
"""
