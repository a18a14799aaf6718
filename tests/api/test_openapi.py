"""Requests made from the OpenAPI document are answered as it says; `bench.fuzz_http` makes more."""

from pathlib import Path

import pytest

from api import comparison_schemas, filter_schemas, schemas
from api.answer_examples import ANSWER_EXAMPLES
from api.app import create_app
from api.examples import BODY_EXAMPLES, JSON
from api.settings import ApiSettings
from bench.fuzz_http import fuzz, service
from tests.api.conftest import MakeClient

EXAMPLES = 3
"""Per route, beside those that the document's bounds suggest."""


def test_examples_of_answers_are_what_may_be_answered() -> None:
    models = {
        name: model
        for module in (schemas, comparison_schemas, filter_schemas)
        for name, model in vars(module).items()
    }
    for name, example in ANSWER_EXAMPLES.items():
        models[name].model_validate(example, extra="forbid")


def test_every_answer_in_json_has_an_example(tmp_path: Path) -> None:
    document = create_app(ApiSettings(data_dir=tmp_path)).openapi()
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            for status, answer in operation["responses"].items():
                for media_type, content in answer.get("content", {}).items():
                    if "json" in media_type and "$ref" in content.get("schema", {}):
                        name = content["schema"]["$ref"].rpartition("/")[2]
                        found = document["components"]["schemas"][name]
                        assert "example" in found, (method, path, status)


def test_examples_of_bodies_are_accepted(make_client: MakeClient) -> None:
    client = make_client(queue_size=10)
    for (route, media_type), body in BODY_EXAMPLES.items():
        if media_type == JSON:
            path = route.removeprefix("POST ").replace("{id}", "builtin:gradient")
            response = client.post(path, json=body)
            assert response.is_success, (route, response.text)


@pytest.mark.slow
def test_no_request_is_answered_otherwise_than_documented(tmp_path: Path) -> None:
    pytest.importorskip("schemathesis", exc_type=ImportError)
    with service(tmp_path) as url:
        assert fuzz(url, EXAMPLES, seed=20091123, phases=("examples", "fuzzing")) == 0
