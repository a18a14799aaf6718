"""From a scene to a picture: what may be asked, the stages, and what comes out.

Settings, View, Probe   what a caller may ask
prepare                 what is made once per scene and environment
STAGES                  one literal tuple, from the raster to the lens
Frame                   layers, statistics, files
"""
