"""The loop over the rays that leave points in all directions."""

from raysvc.jit import kernel
from raysvc.lighting.soft_map_kernels import SoftMap, soft_radiance
from raysvc.types import Floats, Ints


@kernel
def gather_ambient(
    soft: SoftMap,
    directions: Floats,
    through: Floats,
    patch: Ints,
    radiance: Floats,
    columns: Floats,
) -> None:
    """Fill columns (N, 10) of an `Ambient`; the arguments are those of `ambient`."""
    count = through.shape[1]
    for n in range(len(through)):
        free, hx, hy, hz = 0.0, 0.0, 0.0, 0.0
        red, green, blue = 0.0, 0.0, 0.0
        all_red, all_green, all_blue = 1e-30, 1e-30, 1e-30
        hidden_red, hidden_green, hidden_blue = 0.0, 0.0, 0.0
        for k in range(count):
            x, y, z = directions[n, k, 0], directions[n, k, 1], directions[n, k, 2]
            passes = float(through[n, k])
            r, g, b = soft_radiance(soft, x, y, z)
            # What is black everywhere takes the part of its light that is free, too
            r, g, b = r + 1e-20, g + 1e-20, b + 1e-20
            all_red, all_green, all_blue = all_red + r, all_green + g, all_blue + b
            red, green, blue = red + passes * r, green + passes * g, blue + passes * b
            free += passes
            rest = 1.0 - passes
            hx, hy, hz = hx + rest * x, hy + rest * y, hz + rest * z
            p = patch[n, k]
            if p >= 0:
                hidden_red += rest * radiance[p, 0]
                hidden_green += rest * radiance[p, 1]
                hidden_blue += rest * radiance[p, 2]
        columns[n, 0] = free / count
        columns[n, 1], columns[n, 2], columns[n, 3] = hx / count, hy / count, hz / count
        columns[n, 4] = red / all_red
        columns[n, 5] = green / all_green
        columns[n, 6] = blue / all_blue
        columns[n, 7] = hidden_red / count
        columns[n, 8] = hidden_green / count
        columns[n, 9] = hidden_blue / count


@kernel
def gather_sky(soft: SoftMap, directions: Floats, through: Floats, radiance: Floats) -> None:
    """Fill radiance (N, 3): means of what comes through along rays (N, K) of the environment."""
    count = through.shape[1]
    for n in range(len(through)):
        red, green, blue = 0.0, 0.0, 0.0
        for k in range(count):
            if through[n, k] > 0.0:
                passes = float(through[n, k])
                r, g, b = soft_radiance(
                    soft, directions[n, k, 0], directions[n, k, 1], directions[n, k, 2]
                )
                red, green, blue = red + passes * r, green + passes * g, blue + passes * b
        radiance[n, 0], radiance[n, 1], radiance[n, 2] = red / count, green / count, blue / count


@kernel
def gather_patches(patch: Ints, hidden: Floats, sent: Floats, radiance: Floats) -> None:
    """Fill radiance (N, 3): means of what patches send along rays (N, K), as far as they hide.

    `patch` (N, K) is -1 where nothing is met, `sent` (P, 3).
    """
    count = patch.shape[1]
    for n in range(len(patch)):
        red, green, blue = 0.0, 0.0, 0.0
        for k in range(count):
            p = patch[n, k]
            if p >= 0:
                red += hidden[n, k] * sent[p, 0]
                green += hidden[n, k] * sent[p, 1]
                blue += hidden[n, k] * sent[p, 2]
        radiance[n, 0], radiance[n, 1], radiance[n, 2] = red / count, green / count, blue / count
