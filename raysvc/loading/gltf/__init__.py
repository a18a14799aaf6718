"""glTF 2.0 (.gltf, .glb) to a scene.

container -> document -> buffers -> accessors
                                 -> textures -> slots -> layers -> materials
nodes -> instances -> primitives (topology, attributes, directions) -> placing -> assemble
      -> views (cameras and lights)
"""

from raysvc.loading.gltf.assemble import load_gltf

__all__ = ["load_gltf"]
