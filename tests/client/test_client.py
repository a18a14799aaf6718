"""The client against a service behind a socket, whose renderer paints patterns."""

import io
import threading
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from raysvc.access import KeyStore, Scope
from raysvc.client import Client
from raysvc.errors import (
    Cancelled,
    DeadlineExceeded,
    InvalidScene,
    InvalidSetting,
    NotAllowed,
    NotAuthenticated,
    NotFinished,
    NotFound,
    QueueFull,
    Unreachable,
)
from raysvc.jobs import PatternRenderer
from tests.client.conftest import MakeClient, Serve

CAMERA = {"width": 8, "height": 4}
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 2
"""


def test_a_picture_is_made_and_progress_is_heard(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(seconds=0.3, steps=30))
    scene = client.scenes.add("builtin:cornell")
    heard: list[tuple[str, float]] = []
    render = client.renders.make(
        scene.id, camera=CAMERA, on_progress=lambda *progress: heard.append(progress)
    )
    assert render.state == "done"
    assert render.statistics["width"] == 8
    with Image.open(io.BytesIO(client.renders.image(render.id, "png"))) as image:
        assert image.size == (8, 4)
    assert heard[-1] == ("done", 1.0)
    assert any(stage == "pattern" and 0 < part < 1 for stage, part in heard)


def test_a_file_is_sent_once_and_found_again(client: Client, tmp_path: Path) -> None:
    path = tmp_path / "triangle.ply"
    path.write_text(PLY)
    scene = client.scenes.add(path)
    assert client.scenes.add(str(path)).id == scene.id
    assert scene.resource["triangles"] == 1
    assert [stored.id for stored in client.scenes.list()] == [scene.id]
    assert client.scenes.get(scene.id) == scene
    client.scenes.delete(scene.id)
    with pytest.raises(NotFound):
        client.scenes.get(scene.id)


def test_vertices_are_moved(client: Client, tmp_path: Path) -> None:
    path = tmp_path / "triangle.ply"
    path.write_text(PLY)
    scene = client.scenes.add(path)
    positions = np.load(io.BytesIO(client.scenes.positions(scene.id)))
    moved = client.scenes.move(scene.id, (positions + 1).astype("<f4").tobytes())
    assert moved.resource["rest"] == scene.id
    assert moved.resource["bounds"]["min"] == [1.0, 1.0, 1.0]


def test_environments_are_kept_and_filtered(client: Client) -> None:
    sky = client.environments.add("builtin:gradient")
    assert [stored.id for stored in client.environments.list()] == [sky.id]
    assert client.environments.get(sky.id) == sky
    assert len(client.environments.sh9(sky.id)["radiance"]) == 9
    maps = client.environments.filtered(sky.id, "npz", roughness=[1.0], width=16)
    with np.load(io.BytesIO(maps)) as layers:
        assert layers["roughness_1"].shape == (8, 16, 3)
    client.environments.delete(sky.id)
    assert client.environments.list() == []


def test_one_request_makes_a_picture(client: Client, tmp_path: Path) -> None:
    path = tmp_path / "triangle.ply"
    path.write_text(PLY)
    stored = client.scenes.add(path)
    render = client.renders.make(stored.id, camera=CAMERA)
    for scene in (path, str(path)):
        assert client.render(scene, camera=CAMERA) == client.renders.image(render.id)
    assert client.render("builtin:cornell", "builtin:studio", CAMERA, {"seed": 1}, format="webp")


def test_a_picture_gets_a_lens(client: Client, tmp_path: Path) -> None:
    grey = np.full((4, 6, 3), 100, np.uint8)
    Image.fromarray(grey).save(tmp_path / "picture.png")
    Image.fromarray(grey[..., 0]).save(tmp_path / "depth.png")
    camera = {"focal_length_mm": 50, "f_number": 2.0}
    data = client.lens(
        tmp_path / "picture.png", camera, tmp_path / "depth.png", depth_scale_m=0.1, format="npz"
    )
    with np.load(io.BytesIO(data)) as layers:
        assert layers["coc"].shape == (4, 6)
        assert layers["depth"][0, 0] == pytest.approx(10.0)


def test_structures_are_compared(client: Client) -> None:
    scene = client.scenes.add("builtin:cornell")
    comparison = client.comparisons.make(
        scene.id, count=100, structures=["bvh"], rounds=1, builds=1, camera=CAMERA, heat_map=True
    )
    assert comparison.resource["structures"][0]["name"] == "bvh"
    assert client.comparisons.table(comparison.id, "csv").startswith(b"source,scene,rays")
    assert b"<svg" in client.comparisons.chart(comparison.id)
    assert client.comparisons.heat_map(comparison.id).startswith(b"\x89PNG")
    assert client.comparisons.get(comparison.id) == comparison
    assert client.comparisons.cancel(comparison.id).state == "done"


def test_a_service_tells_of_itself(client: Client) -> None:
    assert client.alive()
    while not client.ready():
        pass
    assert "bvh" in [structure["name"] for structure in client.structures()]
    assert "raysvc_ready 1" in client.metrics()


def test_what_a_job_fails_of_is_raised_here(make_client: MakeClient) -> None:
    fault = InvalidSetting("is wrong", "settings.bounces")
    client = make_client(PatternRenderer(fault=fault))
    scene = client.scenes.add("builtin:cornell")
    with pytest.raises(InvalidSetting) as raised:
        client.renders.make(scene.id)
    assert str(raised.value) == str(fault)


def test_errors_are_those_of_local_work(client: Client, tmp_path: Path) -> None:
    broken = tmp_path / "broken.ply"
    broken.write_text("ply\nnothing more")
    with pytest.raises(InvalidScene):
        client.scenes.add(broken)
    with pytest.raises(InvalidSetting) as setting:
        client.renders.submit("builtin:cornell", settings={"bounces": 9})
    assert setting.value.field == "settings.bounces"
    with pytest.raises(NotFound):
        client.renders.get("../scenes")
    with pytest.raises(InvalidSetting):
        client.scenes.add("builtin:atlantis")


def test_a_render_that_takes_long_is_cancelled(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(seconds=60.0, steps=6000))
    job = client.renders.submit("builtin:cornell", camera=CAMERA)
    with pytest.raises(DeadlineExceeded):
        client.renders.wait(job, timeout_s=0.05)
    with pytest.raises(NotFinished):
        client.renders.image(job.id)
    client.renders.cancel(job.id)
    job = client.renders.wait(job)
    assert job.state == "cancelled"
    with pytest.raises(Cancelled):
        job.check()


def test_a_full_queue_is_waited_for_as_long_as_patience_lasts(make_client: MakeClient) -> None:
    renderer = PatternRenderer(seconds=0.4, steps=40)
    client = make_client(renderer, queue_size=1)
    done: list[str] = []

    def make(width: int) -> None:
        done.append(
            client.renders.make("builtin:cornell", camera={"width": width, "height": 4}).state
        )

    threads = [threading.Thread(target=make, args=(width,)) for width in range(4, 8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert done == ["done"] * 4
    assert 'reason="queue-full"' in client.metrics()


def test_without_patience_a_full_queue_is_an_error(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(seconds=60.0, steps=6000), queue_size=1)
    client._connection._patience_s = 0.0
    with pytest.raises(QueueFull):
        for width in range(4, 8):
            client.renders.submit("builtin:cornell", camera={"width": width, "height": 4})


def test_a_key_is_needed_where_there_are_keys(serve: Serve, tmp_path: Path) -> None:
    keys = KeyStore(tmp_path / "data")
    reader = keys.add("reader", Scope.READ)
    keys.close()
    url = serve()
    with Client(url) as nobody, pytest.raises(NotAuthenticated):
        nobody.scenes.list()
    with Client(url, reader) as client:
        assert client.scenes.list() == []
        with pytest.raises(NotAllowed) as raised:
            client.scenes.add("builtin:cornell")
    assert raised.value.scope == "render"


def test_where_nothing_answers_that_is_said() -> None:
    with Client("http://127.0.0.1:9", patience_s=0) as client, pytest.raises(Unreachable) as raised:
        client.alive()
    assert "127.0.0.1:9" in str(raised.value)
