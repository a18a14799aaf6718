"""Examples of what comes back, for the OpenAPI document; shortened where answers are long."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

from api.body_examples import ENVIRONMENT, JOB, SCENE

CREATED: Final = "2026-11-25T12:00:00.000+00:00"

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
    "attempts": 1,
    "heartbeat": None,
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

METRICS: Final = "# TYPE raysvc_queue_jobs gauge\nraysvc_queue_jobs 3.0\n"


def add_answer_examples(schema: dict[str, Any]) -> None:
    """Put the examples of answers where an OpenAPI document has them."""
    for operations in schema["paths"].values():
        for operation in operations.values():
            for answer in operation["responses"].values():
                for content in answer.get("content", {}).values():
                    shown = content.get("schema", {}).get("$ref", "").rpartition("/")[2]
                    if shown in ANSWERS:
                        content["example"] = ANSWERS[shown]
    plain = schema["paths"]["/metrics"]["get"]["responses"]["200"]["content"]["text/plain"]
    plain["example"] = METRICS
