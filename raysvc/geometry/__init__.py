"""Mathematics with no scene in it: transforms, rays, the ray-triangle test."""
