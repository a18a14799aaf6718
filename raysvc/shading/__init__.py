"""What a surface is at a point: attributes by barycentrics, then textures and material."""
