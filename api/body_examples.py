"""Examples of what is sent, for the OpenAPI document. They are real: a test sends each of them."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

SCENE: Final = "9f2c4e6a8b0d1f3e5a7c9b1d3f5e7a9c0b2d4f6e8a1c3e5b7d9f0a2c4e6b8d1f"
ENVIRONMENT: Final = "3b5d7f9e1a2c4e6f8b0d1f3a5c7e9b2d4f6a8c0e1b3d5f7a9c2e4b6d8f0a1c3e"
JOB: Final = "5e7a9c1b3d5f7e9a1c3b5d7f9e1a3c5b"

PARAMETERS: Final[Mapping[str, Mapping[str, str]]] = MappingProxyType(
    {
        "/v1/scenes": {"id": SCENE},
        "/v1/environments": {"id": ENVIRONMENT},
        "/v1/renders": {"id": JOB},
        "/v1/comparisons": {"id": JOB},
    }
)
"""Of the paths that begin so; `format` has an enumeration of its own."""

_JSON: Final = "application/json"
_FORM: Final = "multipart/form-data"
_CAMERA: Final = {"eye": [2.0, 1.2, 3.0], "target": [0.0, 0.8, 0.0], "width": 320, "height": 180}
_RENDER: Final = {
    "scene": "builtin:cornell",
    "environment": "builtin:studio",
    "camera": {"width": 320, "height": 180},
    "settings": {"bounces": 2, "tone_map": "agx"},
}

BODIES: Final[Mapping[tuple[str, str], Mapping[str, Mapping[str, Any]]]] = MappingProxyType(
    {
        ("post", "/v1/scenes"): {
            _JSON: {"a built-in scene": {"builtin": "cornell"}},
            _FORM: {
                "a glTF with a side file": {"file": ["scene.gltf", "scene.bin"]},
                "which of two is the scene": {"file": ["a.ply", "b.ply"], "main": "a.ply"},
            },
        },
        ("post", "/v1/environments"): {
            _JSON: {"a built-in environment": {"builtin": "studio"}},
            _FORM: {"a lat-long map": {"file": ["studio.hdr"]}},
        },
        ("post", "/v1/environments/{id}/filtered"): {
            _JSON: {
                "two maps and the irradiance": {"roughness": [0.25, 0.5], "irradiance": True},
                "spherical harmonics": {"format": "json"},
            }
        },
        ("post", "/v1/renders"): {
            _JSON: {
                "the least": {"scene": "builtin:cornell"},
                "light, camera, settings": _RENDER,
                "a lens": {
                    "scene": "builtin:cornell",
                    "camera": {**_CAMERA, "focal_length_mm": 50.0, "f_number": 1.8},
                },
                "a probe": {
                    "scene": "builtin:cornell",
                    "environment": {"probe_at": [0.0, 1.0, 0.0], "environment": "builtin:studio"},
                },
            }
        },
        ("post", "/v1/render"): {
            _JSON: {"light, camera, settings": _RENDER},
            _FORM: {
                "a file and light": {
                    "scene": ["helmet.glb"],
                    "environment": "builtin:studio",
                    "camera": {"width": 800, "height": 450},
                }
            },
        },
        ("post", "/v1/lens"): {
            _FORM: {
                "a picture that holds its depth": {
                    "picture": "sharp.exr",
                    "camera": {"focal_length_mm": 50, "f_number": 1.8, "focus_distance": 2.5},
                }
            }
        },
        ("post", "/v1/comparisons"): {
            _JSON: {
                "two structures on random rays": {
                    "scene": "builtin:cornell",
                    "rays": "random",
                    "count": 1000,
                    "structures": ["bvh", "kd"],
                }
            }
        },
        ("put", "/v1/scenes/{id}/positions"): {
            "application/x-npy": {"as numpy.save writes it": "(binary: (V, 3) float32)"}
        },
    }
)
"""By method and path, media type, and what the example shows."""


def add_body_examples(schema: dict[str, Any]) -> None:
    """Put the examples of bodies and ids where an OpenAPI document has them."""
    for path, operations in schema["paths"].items():
        for method, operation in operations.items():
            for parameter in operation.get("parameters", ()):
                known = PARAMETERS.get("/".join(path.split("/")[:3]), {})
                if parameter["name"] in known:
                    parameter["example"] = known[parameter["name"]]
            for media_type, named in BODIES.get((method, path), {}).items():
                operation["requestBody"]["content"][media_type]["examples"] = {
                    name: {"value": value} for name, value in named.items()
                }
