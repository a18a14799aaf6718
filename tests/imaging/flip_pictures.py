"""Pictures that FLIP is tested with, the same on every machine: nothing here is drawn at random."""

import numpy as np

HEIGHT, WIDTH = 48, 64


def colours():
    """(H, W, 3) float32 in 0..1: ramps of red and green under a pattern of blue."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    blue = 0.5 + 0.5 * np.sin(0.3 * x) * np.cos(0.2 * y)
    return np.stack([x / (WIDTH - 1), y / (HEIGHT - 1), blue], axis=-1).astype(np.float32)


def grain():
    """(H, W, 3) float64 in -1..1, as rough as noise: the fraction of a fast sine."""
    index = np.arange(HEIGHT * WIDTH * 3, dtype=np.float64).reshape(HEIGHT, WIDTH, 3)
    return 2.0 * (np.abs(np.sin(index * 12.9898)) * 437.5453 % 1.0) - 1.0


def chequer(size):
    """(H, W, 3) float32 of black and white fields."""
    fields = (np.indices((HEIGHT, WIDTH)) // size).sum(axis=0) % 2
    return np.repeat(fields[..., None], 3, axis=2).astype(np.float32)


def plain(red, green, blue):
    """(H, W, 3) float32 of one colour."""
    return np.full((HEIGHT, WIDTH, 3), (red, green, blue), np.float32)


def display_pairs():
    """Pairs of sRGB pictures by name."""
    dotted = colours()
    dotted[20, 30] = 1.0
    return {
        "grain": (colours(), np.clip(colours() + 0.15 * grain(), 0, 1).astype(np.float32)),
        "moved": (colours(), np.roll(colours(), 2, axis=1)),
        "dotted": (colours(), dotted),
        "inverted": (chequer(4), 1 - chequer(4)),
        "black and white": (plain(0, 0, 0), plain(1, 1, 1)),
        "green and blue": (plain(0, 1, 0), plain(0, 0, 1)),
    }


def scene_pairs():
    """Pairs of linear pictures by name, the second of 18 stops."""
    dim = colours() ** 3 * 5 + np.float32(0.01)
    rough = (dim * (1 + 0.2 * grain())).astype(np.float32)
    sun, other_sun = dim.copy(), rough.copy()
    sun[3:6, 8:12] = 5000.0
    other_sun[3:6, 9:13] = 4000.0
    return {"dim": (dim, rough), "sun": (sun, other_sun)}
