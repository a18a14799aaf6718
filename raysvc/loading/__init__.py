"""Scene and environment files in, checked data out."""
