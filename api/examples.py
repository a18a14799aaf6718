"""Examples for the OpenAPI document, one for whatever can be sent; `/docs` offers them to be tried.

All of them work as they are, except that ids are those of nothing.
"""

from types import MappingProxyType
from typing import Any, Final

JSON: Final = "application/json"
FORM: Final = "multipart/form-data"

CAMERA: Final[dict[str, Any]] = {"width": 64, "height": 36, "fov_y_deg": 35.0}
TRIANGLE: Final = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
"""An OBJ file."""
SCENE: Final = "builtin:cornell"
DIGEST: Final = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"
TOKEN: Final = "5f1d7a84db00d2fce00b31a7fc73224f"

ID_EXAMPLES: Final = MappingProxyType(
    {
        "/v1/scenes/": DIGEST,
        "/v1/environments/{id}/filtered": "builtin:gradient",
        "/v1/environments/": DIGEST,
        "/v1/renders/": TOKEN,
        "/v1/comparisons/": TOKEN,
    }
)
"""By what a path begins with; the first that fits counts."""

QUERY_EXAMPLES: Final = MappingProxyType({"layer": "beauty", "format": "png"})

BODY_EXAMPLES: Final = MappingProxyType(
    {
        ("POST /v1/scenes", JSON): {"builtin": "cornell"},
        ("POST /v1/scenes", FORM): {"file": [TRIANGLE], "main": "file"},
        ("POST /v1/environments", JSON): {"builtin": "studio"},
        ("POST /v1/environments", FORM): {"file": ["#?RADIANCE\n"]},
        ("POST /v1/environments/{id}/filtered", JSON): {
            "roughness": [0.25, 1.0],
            "irradiance": True,
            "width": 32,
        },
        ("POST /v1/renders", JSON): {
            "scene": SCENE,
            "environment": "builtin:studio",
            "camera": CAMERA,
            "settings": {"bounces": 1, "tone_map": "agx"},
        },
        ("POST /v1/render", JSON): {"scene": SCENE, "camera": CAMERA},
        ("POST /v1/render", FORM): {
            "scene": SCENE,
            "camera": CAMERA,
            "settings": {"aa": "none"},
        },
        ("POST /v1/lens", FORM): {
            "picture": "(an EXR file with depth)",
            "camera": {"f_number": 1.8, "focal_length_mm": 50.0, "focus_distance": 2.0},
            "settings": {"aperture_blades": 6},
        },
        ("POST /v1/comparisons", JSON): {
            "scene": SCENE,
            "rays": "random",
            "count": 1000,
            "structures": ["bvh", "kd"],
            "rounds": 1,
            "builds": 1,
        },
    }
)
"""By method and path, and media type."""
