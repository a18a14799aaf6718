"""What the camera sees, without rays: NumPy over spans of scanlines.

    project  ->  clip  ->  spans  ->  fragments  ->  nearest triangle per pixel

No loop runs over triangles or pixels: triangles are expanded to the rows that they cover, rows to
pixels, by ragged `repeat`. The result says only which triangle a pixel shows; where on it comes
from the ray through the pixel's centre (`raysvc.geometry.triangle_kernels`), the same function that
serves traced rays.
"""
