"""Makes docs/images/sat_precision.png, and prints the tables of docs/summed_area_tables.md.

Run from the root of the repository: python -m docs.make_sat_picture
"""

from pathlib import Path

import numpy as np

import raysvc
from raysvc.imaging.encode import encode_png
from raysvc.imaging.sat import box_sums, summed_area_table
from raysvc.imaging.sat_orders import ORDERS, integrated, spline_means
from raysvc.imaging.tone_map import display8
from raysvc.lighting.sun import extract_suns

FINER = 4
"""Texels of a map of 4096 x 2048 for each of the built-in sky."""
PIECES = (
    (slice(450, 570), slice(400, 640)),
    (slice(960, 1080), slice(3600, 3840)),
)
"""Of that map: the sun, and the horizon far from it, where the sums are larger."""
SIDE = 3
SUN, CLAMP = 5e4, 50.0
SUN_TEXELS = slice(100, 104), slice(300, 304)
WIDTHS = (2, 8, 32)
BOXES = 4000
SPLINES = 400


def box_means(table, side, rows, columns):
    """Means (..., 3) of boxes whose upper left texels are at rows and columns."""
    flat = np.stack([rows.ravel(), columns.ravel(), rows.ravel() + side, columns.ravel() + side], 1)
    return (box_sums(table, flat.astype(float)) / side**2).reshape(*rows.shape, 3)


def mean_free(image, **asked):
    """A table of an image without its mean, and that mean; in single precision."""
    mean = image.mean((0, 1), dtype=np.float64).astype(np.float32)
    return summed_area_table(image - mean, dtype=np.float32, **asked), mean


def picture():
    """A sky under a small box: float32, float32 without sun and mean, float64."""
    sky = raysvc.load_environment("builtin:clear_sky").radiance
    _, sunless = extract_suns(sky)
    sky, sunless = (each.repeat(FINER, 0).repeat(FINER, 1) for each in (sky, sunless))
    without_mean, mean = mean_free(sunless)
    tables = [
        (summed_area_table(sky, dtype=np.float32), 0.0),
        (without_mean, mean),
        (summed_area_table(sky), 0.0),
    ]
    sheet = []
    for piece in PIECES:
        rows, columns = np.mgrid[piece] - SIDE // 2
        shown = [box_means(table, SIDE, rows, columns) + mean for table, mean in tables]
        sheet.append(np.hstack(shown).astype(np.float32))
    return display8(np.vstack(sheet), "pbr_neutral")


def dim_map_with_sun(rng):
    """(512, 1024, 3) on a grid of 2^-20, so that sums of float64 are exact: clouds and a sun."""
    image = rng.lognormal(-0.5, 0.6, (512, 1024, 3))
    image[SUN_TEXELS] = SUN
    return np.ldexp(np.round(np.ldexp(image, 20)), -20)


def box_errors(image, rng):
    """Largest errors of dim boxes by the way the table was made, a row for each."""
    single = image.astype(np.float32)
    tables = {
        "float32, sequential": (summed_area_table(single, dtype=np.float32), 0.0),
        "float32, doubling": (summed_area_table(single, "doubling", dtype=np.float32), 0.0),
        "float32, mean taken out": mean_free(single),
        f"float32, clamped at {CLAMP:g}, mean taken out": mean_free(np.minimum(single, CLAMP)),
        f"float32, clamped at {CLAMP:g}, mean taken out, doubling": mean_free(
            np.minimum(single, CLAMP), builder="doubling"
        ),
        "float64": (summed_area_table(single), 0.0),
    }
    rows, columns = rng.integers(200, 470, BOXES), rng.integers(350, 980, BOXES)
    true = [exact_means(single, side, rows, columns) for side in WIDTHS]
    for name, (table, mean) in tables.items():
        found = [box_means(table, side, rows, columns) + mean for side in WIDTHS]
        yield name, [np.abs(a - b).max() for a, b in zip(found, true, strict=True)]


def exact_means(image, side, rows, columns):
    """The same as `box_means`, of an image on a grid of 2^-20, by sums of whole numbers."""
    sums = np.zeros((image.shape[0] + 1, image.shape[1] + 1, 3), np.int64)
    sums[1:, 1:] = np.ldexp(image.astype(np.float64), 20).astype(np.int64).cumsum(0).cumsum(1)
    bottom, right = rows + side, columns + side
    whole = sums[bottom, right] - sums[rows, right] - sums[bottom, columns] + sums[rows, columns]
    return np.ldexp(whole.astype(np.float64), -20) / side**2


def spline_errors(image, rng):
    """Largest errors of dim filters by order, and the largest entry of the table."""
    for order in ORDERS:
        table = integrated(image, order)
        errors = []
        for side in (1, *WIDTHS):
            places = rng.uniform((250, 500), (400, 900), (SPLINES, 2))
            filters = np.column_stack([places, np.full((SPLINES, 2), side / 2)])
            means = spline_means(table, order, filters)
            true = [weighted(image, order, *each) for each in filters]
            errors.append(np.abs(means - true).max())
        yield f"{order}, largest entry {np.abs(table).max():.0e}", errors


def weighted(image, order, row, column, half_rows, half_columns):
    """The mean of texels by their weights under a B-spline."""
    down = spline_weights(image.shape[0], order, row, half_rows)
    across = spline_weights(image.shape[1], order, column, half_columns)
    rows, columns = np.flatnonzero(down), np.flatnonzero(across)
    return np.einsum("i,j,ijc->c", down[rows], across[columns], image[np.ix_(rows, columns)])


def spline_weights(length, order, centre, half):
    """Weights of texels along one axis: differences of the B-spline's integral at their edges."""
    edges = np.clip((np.arange(length + 1) - centre) / (2 * half), -order / 2, order / 2)
    signs = {1: (1, -1), 2: (1, -2, 1), 3: (1, -3, 3, -1)}[order]
    total = sum(
        sign * np.maximum(edges + order / 2 - k, 0) ** order for k, sign in enumerate(signs)
    )
    return np.diff(total) / np.prod(np.arange(1, order + 1))


def main():
    """Write the picture, print the tables."""
    Path("docs/images/sat_precision.png").write_bytes(encode_png(picture()))
    rng = np.random.default_rng(2009)
    image = dim_map_with_sun(rng)
    for title, found in (
        (f"boxes of {WIDTHS}", box_errors(image, rng)),
        (f"orders, boxes of {(1, *WIDTHS)}", spline_errors(image, rng)),
        (f"orders, clamped at {CLAMP:g}", spline_errors(np.minimum(image, CLAMP), rng)),
    ):
        print(title)  # noqa: T201
        for name, errors in found:
            print("|", name, "|", " | ".join(f"{error:.1e}" for error in errors), "|")  # noqa: T201


if __name__ == "__main__":
    main()
