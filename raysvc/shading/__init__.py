"""What a surface is at a point: attributes from triangle and barycentrics, then textures and material."""
