"""What is rendered: immutable data, already in world space, with every index checked.

    Scene        triangles with attributes, materials, textures, lights, cameras
    Environment  radiance from every direction, as a lat-long map

Loaders (`raysvc.loading`) and makers (`raysvc.builtin`) produce these; nothing below knows about
files.
"""

from raysvc.scene.camera import Camera, SceneCamera
from raysvc.scene.environment import Environment
from raysvc.scene.light import PunctualLight
from raysvc.scene.material import Material, TextureRef
from raysvc.scene.scene import Scene
from raysvc.scene.texture import Texture

__all__ = [
    "Camera",
    "Environment",
    "Material",
    "PunctualLight",
    "Scene",
    "SceneCamera",
    "Texture",
    "TextureRef",
]
