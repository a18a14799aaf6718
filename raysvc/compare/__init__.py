"""Which acceleration structure suits a scene, and why: measured, never estimated.

ray_sets    the rays that are asked: random, primary, reflection, diffuse, shadow
settings    what a caller may ask of a comparison
compare     scene and settings in, comparison out
contenders  structures that are built and asked;  measure: how fast, how often
result      what comes of it, with the names that files and answers use
talk_2009   the figures of the talk that this project follows, for the scene that matches
tables      a comparison as JSON, CSV and Markdown;  charts: as SVG and PNG
heat_map    node steps and triangle tests of every pixel;  heat_map_files: as PNG and EXR
benchmark   all structures on all ray sets, against Embree
"""
