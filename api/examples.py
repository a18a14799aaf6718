"""Examples for the OpenAPI document: what is sent to every route, and what comes back.

Bodies that are sent are real: a test sends each of them. Answers are shortened where they are long.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

SCENE: Final = "9f2c4e6a8b0d1f3e5a7c9b1d3f5e7a9c0b2d4f6e8a1c3e5b7d9f0a2c4e6b8d1f"
ENVIRONMENT: Final = "3b5d7f9e1a2c4e6f8b0d1f3a5c7e9b2d4f6a8c0e1b3d5f7a9c2e4b6d8f0a1c3e"
JOB: Final = "5e7a9c1b3d5f7e9a1c3b5d7f9e1a3c5b"
CREATED: Final = "2026-11-25T12:00:00.000+00:00"

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

_STORED: Final[dict[str, Any]] = {"created": CREATED, "builtin": None, "warnings": []}
_SCENE: Final = {
    **_STORED,
    "id": SCENE,
    "name": "helmet.glb",
    "links": {"self": f"/v1/scenes/{SCENE}", "positions": f"/v1/scenes/{SCENE}/positions"},
    "rest": None,
    "triangles": 15452,
    "vertices": 14556,
    "objects": 1,
    "bounds": {"min": [-0.94, -0.9, -1.0], "max": [0.94, 0.9, 1.0]},
    "materials": [],
    "textures": [],
    "cameras": [],
    "lights": [],
}
_ENVIRONMENT: Final = {
    **_STORED,
    "id": ENVIRONMENT,
    "name": "studio.hdr",
    "links": {"self": f"/v1/environments/{ENVIRONMENT}"},
    "width": 2048,
    "height": 1024,
    "mean_radiance": [0.41, 0.4, 0.38],
    "max_radiance": 212.5,
}
_JOB: Final = {
    "id": JOB,
    "state": "done",
    "stage": None,
    "progress": 1.0,
    "position": None,
    "created": CREATED,
    "started": "2026-11-25T12:00:00.010+00:00",
    "finished": "2026-11-25T12:00:00.840+00:00",
    "error": None,
    "scene": SCENE,
}

ANSWERS: Final[Mapping[str, Any]] = MappingProxyType(
    {
        "SceneResource": _SCENE,
        "SceneList": {"scenes": [_SCENE]},
        "EnvironmentResource": _ENVIRONMENT,
        "EnvironmentList": {"environments": [_ENVIRONMENT]},
        "RenderResource": {
            **_JOB,
            "links": {"self": f"/v1/renders/{JOB}", "image": f"/v1/renders/{JOB}/image"},
            "environment": ENVIRONMENT,
            "camera": {"width": 320, "height": 180},
            "settings": {"bounces": 2},
            "statistics": {
                "width": 320,
                "height": 180,
                "stages": [{"name": "rasterise", "seconds": 0.02}],
                "total_seconds": 0.83,
                "rays": {"reflection": 20110, "shadow": 41200},
                "warnings": [],
            },
            "warnings": [],
        },
        "ComparisonResource": {
            **_JOB,
            "links": {
                "self": f"/v1/comparisons/{JOB}",
                "table": f"/v1/comparisons/{JOB}/table.csv",
                "chart": f"/v1/comparisons/{JOB}/chart.svg",
            },
            "settings": {"structures": ["bvh"]},
            "rays": {"kind": "random", "count": 1000, "seed": 0},
            "structures": [
                {
                    "name": "bvh",
                    "trees": "one",
                    "build": {"nodes": 53, "max_depth": 7},
                    "traversal": {"node_steps_per_ray": 8.4, "mrays_per_s_one_thread": 1.4},
                }
            ],
        },
        "Sh9Body": {
            "convention": "real, orthonormal, Y_00 = 1 / (2 sqrt(pi))",
            "basis": ["Y_0_0"],
            "radiance": [[1.45, 1.42, 1.35]],
            "irradiance": [[4.56, 4.46, 4.24]],
        },
        "StructureList": {
            "structures": [
                {
                    "name": "bvh",
                    "summary": "Two-wide bounding volume hierarchy.",
                    "available": True,
                    "why_not": None,
                    "parameters": {"type": "object", "properties": {}},
                }
            ]
        },
        "Health": {"status": "ready"},
        "ProblemBody": {
            "type": "urn:raysvc:problem:invalid-setting",
            "title": "A setting is wrong",
            "status": 422,
            "detail": "Input should be less than or equal to 8 (got 9)",
            "instance": "/v1/renders",
            "field": "settings.bounces",
            "retryable": False,
            "request_id": "4f2a09c1d7e34b5c8a6d0e1f2b3c4d5e",
        },
    }
)
"""By the name of the schema."""

METRICS: Final = "# TYPE raysvc_queue_jobs gauge\nraysvc_queue_jobs 3\n"


def add_examples(schema: dict[str, Any]) -> None:
    """Put the examples where an OpenAPI document has them."""
    for path, operations in schema["paths"].items():
        for method, operation in operations.items():
            for parameter in operation.get("parameters", ()):
                known = PARAMETERS.get("/".join(path.split("/")[:3]), {})
                if parameter["name"] in known:
                    parameter["example"] = known[parameter["name"]]
            bodies = BODIES.get((method, path), {})
            for media_type, named in bodies.items():
                operation["requestBody"]["content"][media_type]["examples"] = {
                    name: {"value": value} for name, value in named.items()
                }
            for answer in operation["responses"].values():
                for content in answer.get("content", {}).values():
                    shown = content.get("schema", {}).get("$ref", "").rpartition("/")[2]
                    if shown in ANSWERS:
                        content["example"] = ANSWERS[shown]
    plain = schema["paths"]["/metrics"]["get"]["responses"]["200"]["content"]["text/plain"]
    plain["example"] = METRICS
