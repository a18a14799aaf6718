"""What the OpenAPI document says beyond what the routes' signatures do: bodies that routes read
themselves, problems, and examples of all that is sent and
answered."""

from collections.abc import Iterator
from typing import Any, Final

from pydantic import BaseModel

from api.answer_examples import ANSWER_EXAMPLES
from api.comparison_schemas import ComparisonBody
from api.examples import BODY_EXAMPLES, ID_EXAMPLES, QUERY_EXAMPLES
from api.filter_schemas import FilteredBody
from api.problems import MEDIA_TYPE
from api.schemas import ProblemBody, RenderBody

BODIES: Final[tuple[type[BaseModel], ...]] = (RenderBody, ComparisonBody, FilteredBody, ProblemBody)
PROBLEM: Final[dict[str, Any]] = {
    "description": "An RFC 9457 problem",
    "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/ProblemBody"}}},
}


def complete(schema: dict[str, Any]) -> None:
    """Add to a document that FastAPI has made."""
    schemas = schema["components"]["schemas"]
    for model in BODIES:
        body = model.model_json_schema(ref_template="#/components/schemas/{model}")
        schemas |= {**body.pop("$defs", {}), model.__name__: body}
    for name in ("HTTPValidationError", "ValidationError"):  # FastAPI's own, which ours replaces
        schemas.pop(name, None)
    for name, example in ANSWER_EXAMPLES.items():
        if name in schemas:
            schemas[name]["example"] = example
    for method, path, operation in _operations(schema):
        _describe_problems(operation)
        _give_examples(f"{method.upper()} {path}", path, operation)


def _operations(schema: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    for path, methods in schema["paths"].items():
        for method, operation in methods.items():
            yield method, path, operation


def _describe_problems(operation: dict[str, Any]) -> None:
    responses = operation["responses"]
    responses.pop("422", None)
    responses["4XX"] = PROBLEM


def _give_examples(name: str, path: str, operation: dict[str, Any]) -> None:
    for parameter in operation.get("parameters", []):
        if parameter["in"] == "path" and parameter["name"] == "id":
            parameter["example"] = next(
                example for start, example in ID_EXAMPLES.items() if path.startswith(start)
            )
        elif parameter["name"] in QUERY_EXAMPLES:
            parameter["example"] = QUERY_EXAMPLES[parameter["name"]]
    for media_type, body in operation.get("requestBody", {}).get("content", {}).items():
        if (name, media_type) in BODY_EXAMPLES:
            body["example"] = BODY_EXAMPLES[name, media_type]
