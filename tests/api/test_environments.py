import pytest
from fastapi.testclient import TestClient

# 2 x 1 pixels of radiance 0.5: mantissa 128, exponent 128 (Ward 1991, "Real Pixels").
GREY_HDR = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + bytes([128, 128, 128, 128]) * 2


def test_a_radiance_file_becomes_a_resource(client: TestClient) -> None:
    response = client.post("/v1/environments", files={"file": ("grey.hdr", GREY_HDR)})
    assert response.status_code == 201, response.text
    body = response.json()
    assert (body["width"], body["height"]) == (2, 1)
    assert body["mean_radiance"] == pytest.approx([0.5, 0.5, 0.5], rel=0.01)
    assert client.get("/v1/environments").json() == {"environments": [body]}
    assert client.delete(response.headers["Location"]).status_code == 204


def test_a_built_in_environment_is_asked_for_by_name(client: TestClient) -> None:
    response = client.post("/v1/environments", json={"builtin": "gradient"})
    assert response.status_code == 201
    assert response.json()["width"] == 2 * response.json()["height"]


def test_what_is_not_an_environment_is_refused(client: TestClient) -> None:
    response = client.post("/v1/environments", files={"file": ("grey.hdr", b"<html>")})
    assert response.status_code == 422
    assert response.json()["type"] == "urn:raysvc:problem:invalid-environment"


def test_an_environment_is_one_file(client: TestClient) -> None:
    files = [("file", ("a.hdr", GREY_HDR)), ("file", ("b.hdr", GREY_HDR))]
    response = client.post("/v1/environments", files=files)
    assert (response.status_code, response.json()["field"]) == (422, "file")
