"""Examples of what is answered, for the OpenAPI document, by the name of the schema."""

from types import MappingProxyType
from typing import Any, Final

from api.examples import CAMERA, DIGEST, TOKEN

CREATED: Final = "2026-11-25T14:25:00.147+00:00"

_SCENE: Final[dict[str, Any]] = {
    "id": DIGEST,
    "created": CREATED,
    "builtin": None,
    "name": "helmet",
    "warnings": ["animations are not shown"],
    "links": {"self": f"/v1/scenes/{DIGEST}", "positions": f"/v1/scenes/{DIGEST}/positions"},
    "rest": None,
    "triangles": 46356,
    "vertices": 41456,
    "objects": 1,
    "bounds": {"min": [-0.94, -0.9, -0.99], "max": [0.94, 0.9, 0.99]},
    "materials": [{"name": "metal", "triangles": 46356, "metallic": 1.0, "roughness": 1.0}],
    "textures": [{"name": "colour", "width": 2048, "height": 2048}],
    "cameras": [],
    "lights": [],
}
_ENVIRONMENT: Final[dict[str, Any]] = {
    "id": DIGEST,
    "created": CREATED,
    "builtin": "studio",
    "name": "studio",
    "warnings": [],
    "links": {"self": f"/v1/environments/{DIGEST}"},
    "width": 1024,
    "height": 512,
    "mean_radiance": [0.801, 0.793, 0.782],
    "max_radiance": 10.44,
}
_STRUCTURE: Final[dict[str, Any]] = {
    "name": "bvh",
    "summary": "A binary tree of boxes.",
    "available": True,
    "why_not": None,
    "parameters": {"properties": {"max_leaf": {"type": "integer", "default": 8}}},
}
_JOB: Final[dict[str, Any]] = {
    "id": TOKEN,
    "state": "done",
    "stage": None,
    "progress": 1.0,
    "position": None,
    "created": CREATED,
    "started": "2026-11-25T14:25:00.151+00:00",
    "finished": "2026-11-25T14:25:00.712+00:00",
    "error": None,
}

ANSWER_EXAMPLES: Final = MappingProxyType[str, dict[str, Any]](
    {
        "SceneResource": _SCENE,
        "SceneList": {"scenes": [_SCENE]},
        "EnvironmentResource": _ENVIRONMENT,
        "EnvironmentList": {"environments": [_ENVIRONMENT]},
        "StructureResource": _STRUCTURE,
        "StructureList": {"structures": [_STRUCTURE]},
        "RenderResource": {
            **_JOB,
            "links": {"self": f"/v1/renders/{TOKEN}", "image": f"/v1/renders/{TOKEN}/image"},
            "scene": DIGEST,
            "environment": None,
            "camera": CAMERA,
            "settings": {"mode": "hybrid", "bounces": 2},
            "statistics": {
                "width": CAMERA["width"],
                "height": CAMERA["height"],
                "stages": [{"name": "rasterise", "seconds": 0.009}],
                "total_seconds": 0.561,
                "rays": {"reflection": 1790, "shadow": 2304, "occlusion": 36864},
            },
            "warnings": [],
        },
        "ComparisonResource": {
            **_JOB,
            "links": {
                "self": f"/v1/comparisons/{TOKEN}",
                "table": f"/v1/comparisons/{TOKEN}/table.csv",
                "chart": f"/v1/comparisons/{TOKEN}/chart.svg",
            },
            "scene": DIGEST,
            "settings": {"structures": ["bvh"], "trees": "one"},
            "rays": {"kind": "random", "count": 1000, "seed": 0},
            "query": "nearest",
            "triangles": 46356,
            "structures": [
                {
                    "name": "bvh",
                    "trees": "one",
                    "build": {"nodes": 18233, "build_ms": 41.2},
                    "traversal": {"node_steps_per_ray": 31.4, "mrays_per_s_one_thread": 1.9},
                }
            ],
            "seconds": 2.4,
        },
        "Sh9Body": {
            "convention": "real, orthonormal",
            "basis": ["Y00"] * 9,
            "radiance": [[1.0, 1.0, 1.0]] * 9,
            "irradiance": [[3.1, 3.1, 3.1]] * 9,
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
        },
    }
)
