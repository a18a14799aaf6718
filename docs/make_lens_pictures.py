"""Makes the pictures of docs/lens.md.

lens.png: a scene in focus, spread, and seen through a sampled lens. lens_fence.png: a frame
gathered and spread, and its reference. lens_bokeh.png: what a point becomes.

Run from the root of the repository: python -m docs.make_lens_pictures
"""

from pathlib import Path

import numpy as np

import raysvc
from raysvc.imaging.encode import encode_png
from raysvc.imaging.layer_picture import layer_picture
from raysvc.imaging.tone_map import display8
from raysvc.lens.aperture import Aperture
from raysvc.lens.bokeh import Bokeh
from raysvc.lens.coc import coc_px
from raysvc.lens.spread import spread
from raysvc.scene import Camera

CAMERA = Camera(np.eye(4), 480, 270, half_height=0.36, aperture_radius=0.14, focus_distance=8.0)
CARDS = (
    # depth, left, right, bottom, top, colour
    (14.0, 2.5, 5.5, -1.0, 3.0, (0.1, 0.6, 0.2)),
    (10.0, 0.4, 2.4, -1.0, 2.0, (0.8, 0.6, 0.1)),
    (8.0, -2.0, 0.2, -1.0, 1.6, (0.8, 0.1, 0.1)),
    (7.2, -0.4, 0.9, -1.0, 0.2, (0.2, 0.2, 0.8)),
)
WALL_DEPTH, FENCE_DEPTH, GROUND = 30.0, 2.2, -1.0
ANTI_ALIASING = 4
LENS_SAMPLES = 512


def trace(origins, directions):
    """Colour (N, 3) and depth (N,) along rays whose directions have z = -1."""
    colour, depth = np.zeros(origins.shape), np.full(len(origins), np.inf)

    def at(t):
        return (origins + t[:, None] * directions)[:, :2].T

    def put(t, inside, shade):
        nearer = inside & (t > 0) & (t < depth)
        depth[nearer], colour[nearer] = t[nearer], np.broadcast_to(shade, colour.shape)[nearer]

    def chequers(u, v):
        return ((np.floor(u) + np.floor(v)) % 2)[:, None]

    # A striped wall with small lamps, and a chequered ground.
    t = np.full(len(origins), WALL_DEPTH)
    x, y = at(t)
    wall = np.where(chequers(x / 2, 0 * y), (0.15, 0.25, 0.5), (0.35, 0.4, 0.5))
    off_lamp = np.hypot(x - 3 * np.round(x / 3), y - 5 - 3 * np.round((y - 5) / 3))
    lamp = (off_lamp < 0.1) & (y > 3)
    put(t, True, np.where(lamp[:, None], (60.0, 45.0, 25.0), wall))
    falling = np.minimum(directions[:, 1], -1e-9)
    t = (GROUND - origins[:, 1]) / falling
    put(t, t < WALL_DEPTH, 0.15 + 0.45 * chequers(at(t)[0], t))

    for card_depth, left, right, bottom, top, shade in CARDS:
        t = np.full(len(origins), card_depth)
        x, y = at(t)
        inside = (x > left) & (x < right) & (y > bottom) & (y < top)
        put(t, inside, np.array(shade) * (0.65 + 0.35 * chequers(6 * x, 6 * y)))

    t = np.full(len(origins), FENCE_DEPTH)
    x, y = at(t)
    posts = (np.abs(x + 1.2) < 0.07) | (np.abs(x - 1.1) < 0.07)
    put(t, posts | ((np.abs(y + 0.55) < 0.04) & (np.abs(x) < 2)), (0.9, 0.85, 0.8))
    return colour, depth


def rays(dx, dy):
    """Origins and directions with z = -1 of all pixels, shifted by (dx, dy) pixels."""
    pixels = np.arange(CAMERA.width * CAMERA.height)
    origins, directions = CAMERA.shifted(dx, dy).rays(pixels)
    return origins.astype(float), directions / -directions[:, 2:].astype(float)


def pinhole():
    """The picture in focus, (H, W, 3), anti-aliased, and its depth (H, W)."""
    steps = (np.arange(ANTI_ALIASING) + 0.5) / ANTI_ALIASING - 0.5
    samples = [trace(*rays(dx, dy))[0] for dy in steps for dx in steps]
    return image(np.mean(samples, axis=0)), image(trace(*rays(0.0, 0.0))[1])


def through_lens():
    """The same scene through a sampled lens, (H, W, 3): what spreading approximates."""
    rng = np.random.default_rng(1)
    total = 0.0
    for i in range(LENS_SAMPLES):
        _, directions = rays(*(rng.random(2) - 0.5))
        radius = CAMERA.aperture_radius * np.sqrt((i + rng.random()) / LENS_SAMPLES)
        angle = i * np.pi * (3 - np.sqrt(5))
        on_lens = np.array([radius * np.cos(angle), radius * np.sin(angle), 0.0])
        origins = np.broadcast_to(on_lens, directions.shape)
        total = total + trace(origins, directions - on_lens / CAMERA.focus_distance)[0]
    return image(total / LENS_SAMPLES)


def image(values):
    """Rows and columns from flat pixels, float32."""
    return values.reshape(CAMERA.height, CAMERA.width, *values.shape[1:]).astype(np.float32)


def main():
    """Write all pictures."""
    comparison()
    fence()
    bokeh()


def fence():
    """Gathered, spread, and through 256 samples of the lens per pixel."""
    scene, light = raysvc.load("builtin:fence"), raysvc.load_environment("builtin:gradient")
    view = {"gltf_camera": 0, "width": 400, "height": 225, "aperture_radius": 0.06}
    view |= {"focus_distance": 5.0}
    true = {"mode": "reference", "samples": 256}
    frames = [
        raysvc.render(scene, light, view, settings).display()[..., :3]
        for settings in ({"lens": "gather"}, {}, true)
    ]
    write("lens_fence", np.concatenate(frames, axis=1))


def bokeh():
    """A highlight before and behind the focus through several openings, and as boxes."""
    bokehs = [Bokeh(), *(Bokeh(aperture=Aperture(n)) for n in (3, 5, 6))]
    bokehs += [Bokeh("box", order) for order in (1, 2, 3)]
    rows = []
    for diameter in (60.0, -60.0):
        row = []
        for each in bokehs:
            rgba = np.zeros((96, 96, 4), np.float32)
            rgba[..., 3] = 1.0
            rgba[48, 48, :3] = 1400.0
            coc = np.full((96, 96), diameter, np.float32)
            row.append(display8(spread(rgba, coc, each)[..., :3].copy(), "linear"))
        rows.append(np.concatenate(row, axis=1))
    write("lens_bokeh", np.concatenate(rows))


def write(name, picture):
    """Write a picture of 8 bits."""
    Path(f"docs/images/{name}.png").write_bytes(encode_png(np.ascontiguousarray(picture)))


def comparison():
    """In focus, circles of confusion; spread, sampled lens."""
    sharp, depth = pinhole()
    coc = coc_px(CAMERA, depth)
    blurred = spread(np.concatenate([sharp, np.ones_like(sharp[..., :1])], axis=2), coc)
    truth = through_lens()
    shown = [display8(each, "pbr_neutral") for each in (sharp, blurred[..., :3].copy(), truth)]
    rows = [[shown[0], layer_picture("coc", coc)], [shown[1], shown[2]]]
    sheet = np.concatenate([np.concatenate(row, axis=1) for row in rows])
    write("lens", sheet)


if __name__ == "__main__":
    main()
