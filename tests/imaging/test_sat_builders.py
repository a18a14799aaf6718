"""Every builder makes the same table, in as many passes as it should, with any threads."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from raysvc.errors import Cancelled, InvalidSetting
from raysvc.imaging import sat_builders
from raysvc.imaging.sat import build_table, summed_area_table
from raysvc.imaging.sat_builders import BUILDERS
from raysvc.parallel import Control
from tests.oracles import wrapping_sums

GRID = st.integers(-(2**28), 2**28).map(lambda n: n / 2**20)
IMAGES = st.tuples(st.integers(1, 9), st.integers(1, 9), st.integers(1, 4)).flatmap(
    lambda shape: arrays.arrays(np.float64, shape, elements=GRID)
)
ALL = pytest.mark.parametrize("builder", BUILDERS)


@pytest.fixture
def narrow(monkeypatch):
    """Cut small images into as many lanes, strips and chunks as large ones."""
    monkeypatch.setattr(sat_builders, "LANE_TEXELS", 1)
    monkeypatch.setattr(sat_builders, "BLOCK_ROWS", 3)
    monkeypatch.setattr(sat_builders, "STRIP_ROWS", 4)
    monkeypatch.setattr(sat_builders, "CHUNK_ROWS", 5)
    monkeypatch.setattr(sat_builders, "CHUNK_VALUES", 7)


@ALL
@settings(deadline=None, max_examples=60)
@given(image=IMAGES, samples=st.integers(2, 9))
def test_sums_on_a_grid_are_exact(builder, image, samples):
    table = summed_area_table(image, builder, samples=samples)
    expected = wrapping_sums.from_fixed_point(wrapping_sums.table(image))
    np.testing.assert_array_equal(table, expected)


@ALL
@pytest.mark.usefixtures("narrow")
@pytest.mark.parametrize("shape", [(23, 37, 3), (24, 32, 3), (1, 40, 3), (40, 1, 3), (19, 21, 4)])
def test_sums_on_a_grid_are_exact_however_the_work_is_cut(builder, shape, rng):
    image = rng.integers(0, 2**24, shape) / 2**20
    expected = wrapping_sums.from_fixed_point(wrapping_sums.table(image))
    for threads in (1, 2, 5):
        table = summed_area_table(image, builder, control=Control(threads))
        np.testing.assert_array_equal(table, expected)


@ALL
@pytest.mark.usefixtures("narrow")
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("channels", [1, 3])
def test_tables_have_the_same_bits_with_any_number_of_threads(builder, dtype, channels, rng):
    image = rng.lognormal(0, 3, (45, 61, channels))
    tables = [
        summed_area_table(image, builder, dtype=dtype, control=Control(threads))
        for threads in (1, 2, 3, 7)
    ]
    assert all(table.tobytes() == tables[0].tobytes() for table in tables)


@ALL
def test_sums_that_round_agree(builder, rng):
    image = rng.lognormal(0, 3, (150, 333, 3)).astype(np.float32)
    table = summed_area_table(image, builder, samples=4, control=Control(2))
    expected = image.astype(np.longdouble).cumsum(0).cumsum(1)
    np.testing.assert_allclose(table[1:, 1:], expected.astype(np.float64), rtol=1e-12)


@pytest.mark.parametrize("shape", [(256, 256), (1, 1), (1, 9), (8, 27), (100, 65)])
@pytest.mark.parametrize("samples", [2, 3, 4, 8, 16, 1000])
def test_doubling_takes_as_many_passes_as_the_formula_says(shape, samples):
    built = build_table(np.ones((*shape, 1)), "doubling", samples=samples)
    # Logarithms of whole powers are not whole in floating point
    formula = sum(math.ceil(math.log(side, samples) - 1e-9) for side in shape)
    assert built.passes == formula
    assert built.table[-1, -1, 0] == shape[0] * shape[1]


def test_passes_are_those_of_the_talk():
    image = np.ones((256, 256, 1))
    passes = [build_table(image, "doubling", samples=k).passes for k in (2, 16)]
    assert passes == [16, 4]
    assert [build_table(image, name).passes for name in ("fused", "scan", "strips")] == [1, 4, 3]


def test_every_pass_of_doubling_is_one_that_runs(monkeypatch):
    ran = []
    for name in ("add_from_the_left", "add_from_above"):
        kernel = getattr(sat_builders, name)

        def counted(source, target, stride, *rest, kernel=kernel, name=name):
            ran.append((name, stride))
            kernel(source, target, stride, *rest)

        monkeypatch.setattr(sat_builders, name, counted)
    image = np.arange(20.0 * 30).reshape(20, 30, 1)
    built = build_table(image, "doubling", samples=3)
    assert len(ran) == built.passes == 7
    assert [stride for _, stride in ran] == [1, 3, 9, 27, 1, 3, 9]


@ALL
def test_a_table_is_written_where_asked(builder, rng):
    image = rng.random((12, 10, 3)).astype(np.float32)
    out = np.full((13, 11, 3), np.nan)
    assert summed_area_table(image, builder, out=out) is out
    np.testing.assert_array_equal(out, summed_area_table(image, builder))


@ALL
def test_images_with_gaps_are_read(builder, rng):
    image = rng.random((12, 10, 3))
    table = summed_area_table(image[::-1, ::2], builder)
    np.testing.assert_array_equal(table, summed_area_table(image[::-1, ::2].copy(), builder))


@ALL
def test_sums_of_single_precision_are_made_in_it(builder, rng):
    image = rng.random((40, 50, 3)).astype(np.float32)
    table = summed_area_table(image, builder, dtype=np.float32)
    assert table.dtype == np.float32
    error = np.abs(table - summed_area_table(image)).max()
    assert 1e-6 < error < 1e-2


@ALL
def test_building_can_be_stopped(builder):
    control = Control(2)
    control.cancel()
    with pytest.raises(Cancelled):
        summed_area_table(np.ones((9, 9, 3)), builder, control=control)


@pytest.mark.parametrize(
    ("asked", "complaint"),
    [
        ({"builder": "magic"}, "builder: unknown 'magic'; there is fused, doubling, scan, strips"),
        ({"samples": 1}, "samples: must be at least 2, is 1"),
        ({"dtype": np.int32}, "dtype: must be float32 or float64, is int32"),
        ({"out": np.zeros((5, 5, 3))}, "out: must be "),
        ({"out": np.zeros((5, 6, 3), np.float32)}, "out: must be "),
        ({"out": np.zeros((5, 12, 3))[:, ::2]}, "out: must be "),
        ({"image": np.zeros((4, 5))}, "image: must be "),
        ({"image": np.zeros((4, 0, 3))}, "image: must be "),
        ({"image": np.zeros((4, 5, 3), np.int64)}, "image: must be "),
    ],
)
def test_what_cannot_be_summed_is_refused_by_name(asked, complaint):
    with pytest.raises(InvalidSetting) as refused:
        summed_area_table(**{"image": np.zeros((4, 5, 3)), **asked})
    assert str(refused.value).startswith(complaint)
