"""Whatever is done to a document, it loads or is refused by name; no other exception escapes."""

import json
import math
import random
from typing import Any

import numpy as np
import pytest

from raysvc.errors import InvalidInput
from raysvc.limits import Limits
from raysvc.loading.files import Files
from raysvc.loading.gltf import load_gltf
from tests.loading.gltf.building import QUAD, QUAD_INDICES, QUAD_UV, Builder, load_text

SMALL = Limits(max_nodes=500, max_triangles=10_000, max_vertices=30_000)
ODD: list[Any] = [
    None,
    True,
    -1,
    0,
    1,
    3,
    5126,
    1.5,
    1e300,
    math.nan,
    math.inf,
    1 << 31,
    1 << 70,
    "",
    "x",
    "../x",
    "data:,x",
    [],
    [0],
    [[]],
    {},
    {"index": 0},
    [1e38] * 16,
]


def full() -> Builder:
    """A document that uses nearly everything that is read."""
    builder = Builder(
        cameras=[
            {"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1, "aspectRatio": 2}},
            {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 1}},
        ],
        extensions={
            "KHR_lights_punctual": {
                "lights": [{"type": "spot", "color": [1, 1, 1], "spot": {"innerConeAngle": 0}}]
            }
        },
        samplers=[{"wrapS": 33071, "magFilter": 9728}],
        materials=[
            {
                "pbrMetallicRoughness": {
                    "baseColorFactor": [1, 1, 1, 1],
                    "baseColorTexture": {
                        "index": 0,
                        "extensions": {"KHR_texture_transform": {"offset": [1, 2], "rotation": 3}},
                    },
                },
                "normalTexture": {"index": 0, "scale": 2},
                "emissiveFactor": [1, 1, 1],
                "alphaMode": "MASK",
                "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3}},
            }
        ],
    )
    builder.png(np.zeros((2, 2, 3), np.uint8), sampler=0)
    sparse = {
        "count": 1,
        "indices": {"bufferView": builder.view(b"\0"), "componentType": 5121},
        "values": {"bufferView": builder.view(np.ones(3, "f").tobytes())},
    }
    builder.mesh(
        builder.accessor(QUAD, sparse=sparse),
        QUAD_INDICES,
        {"material": 0, "mode": 5},
        NORMAL=np.tile([0, 0, 1], (4, 1)).astype("f"),
        TEXCOORD_0=QUAD_UV,
        TEXCOORD_1=builder.accessor((QUAD_UV * 255).astype("B"), normalized=True),
        COLOR_0=np.ones((4, 4), "f"),
    )
    given = {"TRANSLATION": builder.accessor(np.ones((2, 3), "f"))}
    builder.node(children=[1, 2], rotation=[0, 0, 0, 1], scale=[1, -1, 1])
    builder.node(mesh=0, camera=0, extensions={"EXT_mesh_gpu_instancing": {"attributes": given}})
    builder.node(
        mesh=0,
        matrix=np.eye(4).reshape(-1).tolist(),
        camera=1,
        extensions={"KHR_lights_punctual": {"light": 0}},
    )
    return builder


def places(tree: Any) -> list[tuple[Any, Any]]:
    """Every container and key within a JSON tree."""
    found, waiting = [], [tree]
    while waiting:
        holder = waiting.pop()
        keys = list(holder) if isinstance(holder, dict) else range(len(holder))
        for key in keys:
            found.append((holder, key))
            if isinstance(holder[key], dict | list):
                waiting.append(holder[key])
    return found


def outcome(text: bytes) -> None:
    try:
        scene = load_text(text, limits=SMALL)
    except InvalidInput as error:
        assert error.field
        assert len(str(error)) < 2000
    else:
        assert np.isfinite(scene.positions).all()


def test_the_full_document_itself_loads():
    scene = full().load()
    assert len(scene.triangles) == 4 * 3
    assert (len(scene.cameras), len(scene.lights), len(scene.textures)) == (2, 1, 1)


def test_every_value_replaced_by_an_odd_one_is_refused_or_harmless():
    text = full().text()
    count = len(places(json.loads(text)))
    chooser = random.Random(7)
    for number in range(count):
        for odd in chooser.sample(ODD, 8):
            tree = json.loads(text)
            holder, key = places(tree)[number]
            holder[key] = odd
            outcome(json.dumps(tree).encode())


def test_every_value_removed_is_refused_or_harmless():
    text = full().text()
    for number in range(len(places(json.loads(text)))):
        tree = json.loads(text)
        holder, key = places(tree)[number]
        del holder[key]
        outcome(json.dumps(tree).encode())


def test_changed_bytes_of_text_and_container_are_refused_or_harmless(rng):
    container, text = full().container(), full().text()
    for _ in range(600):
        for whole in (container, text):
            damaged = bytearray(whole)
            for at in rng.integers(0, len(whole), rng.integers(1, 6)):
                damaged[at] = rng.integers(256)
            try:
                load_gltf(Files.from_memory({"a.glb": bytes(damaged)}), SMALL)
            except InvalidInput as error:
                assert error.field


@pytest.mark.parametrize(
    "uri",
    [
        "http://127.0.0.1:9/x",
        "file:///etc/hostname",
        "/dev/zero",
        "../../../../etc/hostname",
        "%2e%2e%2fetc%2fhostname",
        "..%5c..%5cx",
        "\\\\server\\x",
        "a%00b",
        "data:",
        "data:;base64",
        "data:application/octet-stream;base64,????",
    ],
)
def test_uris_never_lead_outside(uri):
    builder = Builder(buffers=[{"byteLength": 36, "uri": uri}])
    builder.mesh()
    with pytest.raises(InvalidInput) as raised:
        builder.load()
    assert raised.value.field == "buffers[0].uri"
