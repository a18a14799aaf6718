from pathlib import Path

import numpy as np

import raysvc
from raysvc.frame.frame import FORMATS
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.jobs import RenderRequest, ResultFolder, Results
from tests.jobs.requests import request

VIEW = View(width=24, height=14, aperture_radius=0.02)
SETTINGS = Settings(tone_map="agx", exposure_stops=0.5, background="transparent", threads=1)


def results_in(folder: Path, memory_bytes: int = 1 << 20) -> Results:
    return Results(ResultFolder(folder, 1 << 30), memory_bytes, memory_bytes)


def test_a_frame_comes_back_from_the_disk_with_every_byte_of_its_files(tmp_path: Path) -> None:
    frame = raysvc.render(raysvc.load("builtin:shiny"), camera=VIEW, settings=SETTINGS)
    assert np.isinf(frame.layers["depth"]).any() and "coc" in frame.layers
    asked = RenderRequest("a" * 64, None, VIEW, SETTINGS)
    results_in(tmp_path).put_picture(asked, frame)
    patient = RenderRequest("a" * 64, None, VIEW, SETTINGS.model_copy(update={"threads": 2}))
    kept = results_in(tmp_path).picture(patient)
    assert kept is not None
    assert kept.statistics.to_dict() == frame.statistics.to_dict()
    assert list(kept.layers) == list(frame.layers)
    for format in FORMATS:
        assert kept.encode(format) == frame.encode(format)
    for layer in frame.layers:
        for format in ("png", "exr", "npz"):
            assert kept.encode(format, layer) == frame.encode(format, layer)


def test_what_is_asked_for_in_memory_is_in_use_on_the_disk_too(tmp_path: Path) -> None:
    picture = raysvc.render(raysvc.load("builtin:cornell"), camera=VIEW, settings={"aa": "none"})
    requests = [request(seed=seed) for seed in range(3)]
    ample = ResultFolder(tmp_path / "ample", 1 << 30)
    Results(ample, 1 << 20, 0).put_picture(requests[0], picture)
    size = ample.counts.held_bytes
    results = Results(ResultFolder(tmp_path / "tight", 2 * size + size // 2), 1 << 30, 0)
    results.put_picture(requests[0], picture)
    results.put_picture(requests[1], picture)
    assert results.picture(requests[0]) is picture
    results.put_picture(requests[2], picture)
    left = {path.name for path in (tmp_path / "tight").iterdir() if path.is_file()}
    assert left == {requests[0].name, requests[2].name}
