"""How surfaces answer light, by glTF's BRDF.

direct        a sun or punctual light: what arrives, and what is reflected of it
image_light   an environment: its sun apart, the rest through summed-area tables
filtered_map  an environment filtered ahead of time for a roughness, for other renderers
"""
