"""The buffer: what is nearest, whatever the threads and bands."""

import numpy as np
import pytest

from raysvc.errors import Cancelled
from raysvc.parallel import Control
from raysvc.raster import rasterise
from raysvc.raster.rasterise import Raster
from tests.raster.drawing import raster
from tests.scenes import camera, mesh, quad, soup, stairs


@pytest.mark.parametrize("threads", [2, 5])
def test_threads_do_not_change_the_picture(rng, threads):
    scene = mesh(*soup(rng, 400))
    view = camera((0, 0, 3), width=97, height=200, half_height=0.5)
    one, many = raster(scene, view), raster(scene, view, threads=threads)
    assert (one.visible() == many.visible()).all()
    assert (one.visible() >= 0).any()
    everything = np.arange(400, dtype=np.int32)
    empty, also_empty = (
        raster(scene, view, solid=False, threads=n).nearer_fragments(everything)
        for n in (1, threads)
    )
    assert (empty.pixel == also_empty.pixel).all()
    assert (empty.key == also_empty.key).all()


@pytest.mark.parametrize("rows", [1, 7, 1000])
def test_bands_do_not_change_the_picture(rng, monkeypatch, rows):
    scene = mesh(*soup(rng, 200))
    view = camera((0, 0, 3), width=50, height=70, half_height=0.5)
    expected = raster(scene, view).visible()
    monkeypatch.setattr(rasterise, "BAND_ROWS", rows)
    assert (raster(scene, view).visible() == expected).all()


def test_stairs_seen_from_above_show_tread_by_tread():
    scene = stairs(4)
    view = camera(
        (2, 0.5, 50),
        (2, 0.5, 0),
        width=8,
        height=2,
        half_height=0.5,
        projection="orthographic",
    )
    assert (raster(scene, view).visible().reshape(2, 8) // 2 == [[0, 0, 1, 1, 2, 2, 3, 3]]).all()


def test_an_empty_scene_shows_nothing():
    scene = mesh(np.zeros((0, 3)), np.zeros((0, 3)))
    assert (raster(scene, camera()).visible() == -1).all()


def test_one_pixel_is_a_picture():
    assert raster(quad(), camera(width=1, height=1)).visible().tolist() == [0]


def test_triangles_with_holes_wait_until_they_are_let_in():
    front, back = quad(z=1.0), quad(z=0.0)
    positions = np.concatenate([back.positions, front.positions])
    scene = mesh(positions, np.concatenate([back.triangles, front.triangles + 4]))
    solid = np.array([True, True, False, False])
    view = camera(width=9, height=9, half_height=0.1)
    buffer = Raster(scene, solid, np.ones(4, bool), view, Control(threads=1))
    assert (buffer.visible() < 2).all()
    waiting = buffer.nearer_fragments(np.array([2, 3], np.int32))
    assert len(waiting.pixel) == 81
    assert (buffer.visible() < 2).all()
    buffer.add(waiting)
    assert (buffer.visible() >= 2).all()


def test_fragments_behind_the_buffer_are_not_handed_out():
    scene = mesh(
        np.concatenate([quad(z=1.0).positions, quad(z=0.0).positions]),
        np.concatenate([quad().triangles, quad().triangles + 4]),
    )
    solid = np.array([True, True, False, False])
    view = camera(width=9, height=9, half_height=0.1)
    buffer = Raster(scene, solid, np.ones(4, bool), view, Control(threads=1))
    assert len(buffer.nearer_fragments(np.array([2, 3], np.int32)).pixel) == 0


def test_a_cancelled_raster_stops():
    control = Control(threads=1)
    control.cancel()
    with pytest.raises(Cancelled):
        Raster(quad(), np.ones(2, bool), np.ones(2, bool), camera(), control)
