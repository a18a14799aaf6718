"""What the OpenAPI document says beyond what the routes' signatures do: bodies that routes read
themselves, keys, and an example of everything that is sent and comes back."""

from typing import Any, Final

from pydantic import BaseModel

from api.access import describe_security
from api.answer_examples import add_answer_examples
from api.body_examples import add_body_examples
from api.comparison_schemas import ComparisonBody
from api.filter_schemas import FilteredBody
from api.schemas import ProblemBody, RenderBody

BODIES: Final[tuple[type[BaseModel], ...]] = (RenderBody, ComparisonBody, FilteredBody, ProblemBody)


def complete(schema: dict[str, Any]) -> None:
    """Add to a document that FastAPI has made."""
    schemas = schema["components"]["schemas"]
    for model in BODIES:
        body = model.model_json_schema(ref_template="#/components/schemas/{model}")
        schemas |= {**body.pop("$defs", {}), model.__name__: body}
    for name in ("HTTPValidationError", "ValidationError"):  # FastAPI's own, which ours replaces
        schemas.pop(name, None)
    for operations in schema["paths"].values():
        for operation in operations.values():
            operation["responses"].pop("422", None)
    describe_security(schema)
    add_body_examples(schema)
    add_answer_examples(schema)
