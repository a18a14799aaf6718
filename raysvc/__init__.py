"""A 3D scene and a camera in, a picture out, on a CPU.

    import raysvc

    scene = raysvc.load("helmet.glb")
    frame = raysvc.render(scene, camera={"width": 800, "height": 450})
    frame.save("helmet.png")

Conventions of the whole system
-------------------------------
- Space is right-handed, +Y up, in metres; a camera looks along its -Z with +Y up.
- Colours are linear, scene-referred, Rec.709 primaries, until they are tone mapped.
- Pixel (row, col) has its centre at (row + 0.5, col + 0.5); row 0 is the top.
- Counter-clockwise triangles face the viewer.
- Directions are unit unless named otherwise; a ray's t is in units of |direction|.
- An environment's centre column is what is seen along -Z, +X is to its right, +Y up;
  `yaw_deg` turns it counter-clockwise seen from above.
- Transforms are named `<to>_from_<from>` and multiply column vectors from the left.
- Rays and geometry are float32, accumulated tables float64 or fixed point.
- The same request gives the same bytes, whatever the number of threads; what is random is seeded.
"""

from raysvc.frame.frame import Frame
from raysvc.frame.render import render
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.lighting.filtered_map import filtered_map, irradiance_map
from raysvc.lighting.spherical_harmonics import Sh9, sh9
from raysvc.loading import load_environment
from raysvc.loading import load_scene as load
from raysvc.scene import Environment, Scene
from raysvc.version import VERSION as __version__

__all__ = [
    "Environment",
    "Frame",
    "Scene",
    "Settings",
    "Sh9",
    "View",
    "__version__",
    "filtered_map",
    "irradiance_map",
    "load",
    "load_environment",
    "render",
    "sh9",
]
