"""How surfaces answer light: glTF's BRDF, punctual lights and sun, and environments through summed-area tables."""
