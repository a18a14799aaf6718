"""Fits GGX lobes by sums of round lobes, and writes the table that lights pictures.

    python -m bench.fit_lobes [FOLDER OF .hdr AND .exr]

Truth are integrals over visible normals of four maps and three synthetic ones, at random places and
turns; the built-in environments are kept out of it, to see by them what the fit is worth elsewhere
(`raysvc bench sat`). At every node of the table SciPy, which raysvc itself does not need, searches
for places, widths and weights with the least robust sum of errors; each search begins from its
neighbours, to which a small force binds it, for what lies between nodes is interpolated.
"""

import argparse
import math
import os
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from raysvc.jit import kernel
from raysvc.lighting.albedo_kernels import integrate_specular
from raysvc.lighting.brdf import fresnel_weight, shadowing_given_masking, visible_normal
from raysvc.lighting.image_kernels import GGX_BOX, level_of_alpha
from raysvc.lighting.image_light import ImageLight
from raysvc.lighting.lobe_fit import ALPHA_NODES, FILE, LOOKUPS, NODES
from raysvc.lighting.lobe_level_kernels import round_lobe
from raysvc.lighting.sun import LUMINANCE
from raysvc.loading import load_environment
from raysvc.scene import Environment
from raysvc.types import Doubles, Floats, Ints

MAPS = (
    "venice_sunset_1k.hdr",
    "studio_small_03_1k.hdr",
    "kloppenheim_05_1k.hdr",
    "KernerEnvLatLong.exr",
)
POINTS = 100
"""For each map, at every node."""
RAYS = 2048
"""Of each point's integral."""
ROBUST_FROM = 0.03
"""Relative error from which errors count by their size instead of their square."""
BOND = 0.004
"""Force towards the neighbours, in errors per unit of a parameter."""
BEGIN = (16, 6)
"""The node that is fitted first, for there lobes are neither round nor cut off."""
F0 = (0.04, 1.0)
"""Reflectances whose errors count."""


@dataclass(frozen=True)
class Points:
    """Points under one environment, all seen at the same N.V, and what they show of it."""

    light: ImageLight
    normal: Doubles
    lean: Doubles
    """(N, 3) R - N."""
    truth: Doubles
    """(N, 2) luminance: means weighted by 1 - x and by x, with Fresnel's x."""


def main() -> None:
    """Fit, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    assets = os.environ.get("RAYSVC_ASSETS", "../shared/assets")
    parser.add_argument("folder", nargs="?", type=Path, default=Path(assets) / "hdr")
    parser.add_argument("--lookups", type=int, nargs="*", default=LOOKUPS)
    arguments = parser.parse_args()
    maps = [load_environment(arguments.folder / name).radiance for name in MAPS]
    maps += [softboxes(seed) for seed in range(3)]
    lights = [ImageLight(Environment(radiance)) for radiance in maps]
    tables = {}
    if FILE.exists():
        with np.load(FILE) as kept:
            tables = dict(kept)
    for lookups in arguments.lookups:
        table = np.zeros((ALPHA_NODES, NODES, lookups, 4), np.float32)
        done = np.zeros((ALPHA_NODES, NODES), bool)
        for a in outwards(ALPHA_NODES, BEGIN[0]):
            alpha, rests = 2.0 ** (0.5 * (a - ALPHA_NODES + 1)), np.zeros(NODES)
            for m in outwards(NODES, BEGIN[1]):
                beside = [(a - 1, m), (a + 1, m), (a, m - 1), (a, m + 1)]
                near = [
                    table[n]
                    for n in beside
                    if 0 <= n[0] < ALPHA_NODES and 0 <= n[1] < NODES and done[n]
                ]
                data = [points(light, alpha, cosine(m), 100 * a + m) for light in lights]
                table[a, m], rests[m] = fitted(data, alpha, cosine(m), lookups, near)
                done[a, m] = True
            sys.stdout.write(
                f"{lookups} alpha {alpha:.4f}: " + " ".join(f"{100 * r:.1f}" for r in rests) + "\n"
            )
            sys.stdout.flush()
        tables[f"lookups_{lookups}"] = table
    np.savez_compressed(FILE, **tables)


def outwards(count: int, begin: int) -> list[int]:
    """0..count - 1 in an order in which each follows a neighbour."""
    return [*range(begin, count), *range(begin - 1, -1, -1)]


def cosine(m: int) -> float:
    """N.V of a column of the table."""
    return max((m / (NODES - 1)) ** 2, 0.002)


def softboxes(seed: int) -> Floats:
    """A map of a few bright rectangles on a dim gradient."""
    rng = np.random.default_rng(seed)
    rows, columns = np.mgrid[0.5:256, 0.5:512]
    up, turn = np.cos(rows / 256 * np.pi), columns / 512 * 2 * np.pi
    radiance = np.full((256, 512, 3), 0.03) + 0.1 * np.maximum(up, 0)[..., None] * rng.random(3)
    for _ in range(8):
        height, width = rng.uniform(0.08, 0.6, 2)
        inside = np.abs(up - rng.uniform(-1, 1)) < height / 2
        inside &= np.abs((turn - rng.uniform(0, 2 * np.pi) + np.pi) % (2 * np.pi) - np.pi) < width
        radiance[inside] += 10 ** rng.uniform(-0.5, 1.3) * rng.uniform(0.5, 1, 3)
    return radiance.astype(np.float32)


def points(light: ImageLight, alpha: float, nov: float, seed: int) -> Points:
    """Random points, and their integrals."""
    rng = np.random.default_rng(seed)
    normal = _unit(rng.normal(size=(POINTS, 3)))
    tangent = _unit(np.cross(normal, rng.normal(size=(POINTS, 3))))
    truth = np.empty((POINTS, 2))
    rest = np.ascontiguousarray(light.rest @ LUMINANCE.astype(np.float32), np.float32)
    integrate(rest, normal, tangent, alpha, nov, RAYS, truth)
    sine = math.sqrt(1 - nov * nov)
    return Points(light, normal, (nov - 1) * normal + sine * tangent, truth)


@kernel
def integrate(
    rest: Floats,
    normal: Doubles,
    tangent: Doubles,
    alpha: float,
    nov: float,
    rays: int,
    truth: Doubles,
) -> None:
    """Fill truth (N, 2) from a map's luminance (H, W), its texels constant; V leans from T."""
    height, width = rest.shape
    sine = math.sqrt(1.0 - nov * nov)
    for i in range(len(normal)):
        nx, ny, nz = normal[i, 0], normal[i, 1], normal[i, 2]
        tx, ty, tz = tangent[i, 0], tangent[i, 1], tangent[i, 2]
        bx, by, bz = ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx
        lit, grazing, scale, bias = 0.0, 0.0, 0.0, 0.0
        for k in range(rays):
            turn = 2.0 * math.pi * ((k * 0.6180339887498949) % 1.0)
            u = (k + 0.5) / rays
            h = visible_normal((-sine, 0.0, nov), alpha, math.cos(turn), math.sin(turn), u)
            voh = -sine * h[0] + nov * h[2]
            a, b, c = 2.0 * voh * h[0] + sine, 2.0 * voh * h[1], 2.0 * voh * h[2] - nov
            if c <= 0.0:
                continue
            y = a * ty + b * by + c * ny
            x, z = a * tx + b * bx + c * nx, a * tz + b * bz + c * nz
            row = min(int(math.acos(min(max(y, -1.0), 1.0)) / math.pi * height), height - 1)
            column = int((math.atan2(x, -z) / (2.0 * math.pi) + 0.5) * width) % width
            weight, fresnel = shadowing_given_masking(c, nov, alpha), fresnel_weight(voh)
            lit += weight * (1.0 - fresnel) * rest[row, column]
            scale += weight * (1.0 - fresnel)
            grazing += weight * fresnel * rest[row, column]
            bias += weight * fresnel
        truth[i, 0] = lit / max(scale, 1e-30)
        truth[i, 1] = grazing / max(bias, 1e-30)


def fitted(
    data: list[Points], alpha: float, nov: float, lookups: int, near: list[Floats]
) -> tuple[Floats, float]:
    """One node's lookups (K, 4), and their mean relative error."""
    level = level_of_alpha(alpha)
    share = fresnel_share(alpha, nov)
    truths = [(f0 * p.truth[:, 0] * share[0] + p.truth[:, 1] * share[1]) for p in data for f0 in F0]

    def errors(free: Doubles) -> Doubles:
        node = lookups_of(free)
        shown = []
        for p in data:
            both = np.empty((len(p.normal), 2))
            respond(*p.light.lobes, p.normal, p.lean, level, node, both)
            shown += [f0 * both[:, 0] * share[0] + both[:, 1] * share[1] for f0 in F0]
        return np.concatenate([a / b - 1 for a, b in zip(shown, truths, strict=True)])

    bond = BOND if near else 0.1 * BOND

    def costs(free: Doubles, start: Doubles) -> Doubles:
        """Errors, flattened beyond ROBUST_FROM, and the pull of the neighbours."""
        e = errors(free)
        robust = np.sqrt(2 * (np.sqrt(1 + (e / ROBUST_FROM) ** 2) - 1)) * ROBUST_FROM * np.sign(e)
        return np.concatenate([robust, (free - start) * (bond * math.sqrt(len(e)))])

    if near:
        starts = [np.mean([free_of(n) for n in near], axis=0)]
    else:
        starts = [fresh(lookups, lean, wide) for lean in (0.2, 0.6) for wide in (1.0, 4.0)]
    found = [
        least_squares(costs, start, args=(start,), diff_step=1e-3, max_nfev=40 if not near else 20)
        for start in starts
    ]
    best = min(found, key=lambda f: float(f.cost)).x
    return lookups_of(best).astype(np.float32), float(np.abs(errors(best)).mean())


def fresh(lookups: int, lean: float, wide: float) -> Doubles:
    """Free parameters without knowledge: from wide ones near N to narrow ones beyond R."""
    k = np.linspace(0, 1, lookups) if lookups > 1 else np.array([1.0])
    return np.concatenate([1 - lean + 1.25 * lean * k, wide * (1 - 1.3 * k), np.zeros(2 * lookups)])


def lookups_of(free: Doubles) -> Doubles:
    """Lookups (K, 4) of free parameters (4 K,); their weights sum to one."""
    place, wider, lit, grazing = free.reshape(4, -1)
    weights = [np.exp(w - w.max()) for w in (lit, grazing)]
    return np.stack([place, wider] + [w / w.sum() for w in weights], axis=1)


def free_of(node: Floats) -> Doubles:
    """Undo `lookups_of`."""
    place, wider, lit, grazing = node.astype(np.float64).T
    logs = [np.log(np.maximum(w, 1e-4)) for w in (lit, grazing)]
    return np.concatenate([place, wider] + [w - w.mean() for w in logs])


@kernel
def respond(  # noqa: PLR0913 - a kernel takes plain arrays
    sharp: Doubles,
    order: int,
    texels: Floats,
    sides: Ints,
    firsts: Ints,
    normal: Doubles,
    lean: Doubles,
    level: float,
    node: Doubles,
    both: Doubles,
) -> None:
    """Write luminances (N, 2) that a node's lookups give, for 1 - x and for x."""
    for i in range(len(normal)):
        both[i, 0] = both[i, 1] = 0.0
        for k in range(len(node)):
            r, g, b = round_lobe(
                sharp,
                order,
                texels,
                sides,
                firsts,
                normal[i, 0] + node[k, 0] * lean[i, 0],
                normal[i, 1] + node[k, 0] * lean[i, 1],
                normal[i, 2] + node[k, 0] * lean[i, 2],
                level + node[k, 1],
                GGX_BOX,
                0.0,
            )
            y = 0.2126 * r + 0.7152 * g + 0.0722 * b
            both[i, 0] += node[k, 2] * y
            both[i, 1] += node[k, 3] * y


def fresnel_share(alpha: float, nov: float) -> tuple[float, float]:
    """What constant light gives, by F0 and besides it."""
    table = np.empty((1, 1, 2))
    integrate_specular(np.array([nov]), np.array([math.sqrt(alpha)]), 1597, table)
    return float(table[0, 0, 0]), float(table[0, 0, 1])


def _unit(vectors: Doubles) -> Doubles:
    unit: Doubles = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return unit


if __name__ == "__main__":
    main()
