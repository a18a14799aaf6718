"""How near filtered light comes to integrals over all texels, lobe by lobe and method by method.

Small lights, which are no part of what is filtered, are left out on both sides. Directions are
random; views are evenly spread over N.V from 0.15 to 1.
"""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Final, Literal

import numpy as np

from raysvc.compare.lobe_integrals import diffuse_integrals, phong_integrals, specular_integrals
from raysvc.compare.measure import Steps
from raysvc.compare.sat_lobes import LatLongLobes
from raysvc.compare.white_surface import DIELECTRIC_F0, brushed_surface, white_surface
from raysvc.lighting.albedo import albedo_tables, diffuse_albedo
from raysvc.lighting.brute_kernels import brute_specular
from raysvc.lighting.image_light import METHODS, Filtering, ImageLight
from raysvc.lighting.lobe_fit import LOOKUPS
from raysvc.lighting.sun import LUMINANCE
from raysvc.parallel import Control, map_chunks
from raysvc.scene import Environment
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats

DIRECTIONS: Final = 400
EXPONENTS: Final = (8.0, 11.3, 32.0, 45.0, 128.0, 512.0)
ROUGHNESS: Final = (0.05, 0.1, 0.25, 0.42, 0.5, 0.59, 1.0)
"""Both also between the levels that lobes are read from."""
BRUSHED: Final = (0.1, 0.25, 0.5)
ANISOTROPY: Final = 0.6
SAMPLES: Final = 16384
"""Of a brushed lobe, whose integral over all texels has no closed form that is exact for narrow
ones: points of the map at its visible normals."""
CHUNK = 10
POLE, EQUATOR = 0.866, 0.5
"""|y| of what a lobe looks at, above and below which it is near a pole or the equator."""

Shown = Callable[[], Floats | Doubles]


@dataclass(frozen=True, slots=True)
class LightError:
    """One method of filtering one lobe of one map."""

    measured: Literal["error"]
    map: str
    lobe: Literal["diffuse", "phong", "ggx", "brushed"]
    parameter: float | None
    """Phong's exponent; GGX's roughness, across the scratches where it is brushed."""
    method: str
    """`sat` is what raysvc does by default."""
    directions: int
    mean_relative_error: float
    """Of luminance, over all directions."""
    pole_error: float
    """Over those within 30 degrees of a pole."""
    equator_error: float
    """Over those within 30 degrees of the equator."""
    seconds: float
    """For all directions, on one thread."""


def light_errors(
    maps: Mapping[str, Environment], directions: int, seed: int, steps: Steps, control: Control
) -> list[LightError]:
    """Measure all lobes and methods on maps; each map's lobe is one of `steps`."""
    rng = np.random.default_rng(seed)
    normal = _unit(rng.normal(size=(directions, 3)))
    tangent = _unit(np.cross(normal, rng.normal(size=(directions, 3))))
    cosine = rng.uniform(0.15, 1.0, (directions, 1))
    view = cosine * normal + np.sqrt(1 - cosine**2) * tangent
    results: list[LightError] = []
    for name, environment in maps.items():
        for lobe in _lobes(environment, normal, view, control):
            steps.next(f"{name}, {lobe.lobe}")
            results += _errors(name, lobe)
    return results


def lobe_count() -> int:
    """How many lobes are measured of each map."""
    return 1 + len(EXPONENTS) + len(ROUGHNESS) + len(BRUSHED)


@dataclass(frozen=True, slots=True)
class _Lobe:
    lobe: Literal["diffuse", "phong", "ggx", "brushed"]
    parameter: float | None
    towards: Doubles
    truth: Doubles
    """(N, 3)."""
    methods: Mapping[str, Shown]


def _lobes(
    environment: Environment, normal: Doubles, view: Doubles, control: Control
) -> Iterator[_Lobe]:
    """All lobes of one map, with their integrals; those take most of the time."""
    lights = {method: ImageLight(environment, filtering=Filtering(method)) for method in METHODS}
    sat = lights["sat"]
    shapes = _shapes(sat.rest)
    plastic = white_surface(normal, view, 0.0, 0.5)
    albedo = diffuse_albedo(plastic)
    yield _Lobe(
        "diffuse",
        None,
        normal,
        _integral(partial(diffuse_integrals, sat.rest, f0=DIELECTRIC_F0), control, normal, view),
        {method: partial(lights[method].diffuse, plastic) for method in ("sat", "sh9", "brute")}
        | {name: partial(_scaled, albedo, shape, normal, 1.0) for name, shape in shapes.items()},
    )
    for exponent in EXPONENTS:
        yield _Lobe(
            "phong",
            exponent,
            normal,
            _integral(partial(phong_integrals, sat.rest, exponent=exponent), control, normal),
            {"sat": partial(sat.phong, normal.astype(np.float32), exponent)}
            | {name: partial(shape, normal, exponent) for name, shape in shapes.items()},
        )
    mirrored = 2 * np.einsum("nk,nk->n", normal, view)[:, None] * normal - view
    for roughness in ROUGHNESS:
        integrals = partial(specular_integrals, sat.rest, roughness=roughness, f0=DIELECTRIC_F0)
        surface = white_surface(normal, view, 0.0, roughness)
        yield _Lobe(
            "ggx",
            roughness,
            mirrored,
            _integral(integrals, control, normal, view),
            {
                method: partial(lights[method].specular, surface)
                for method in ("sat", "split_sum", "brute")
            }
            | {f"sat_{k}_lookups": partial(sat.specular, surface, k) for k in LOOKUPS if k != 4},
        )
    for roughness in BRUSHED:
        surface = brushed_surface(normal, view, roughness, ANISOTROPY)
        yield _Lobe(
            "brushed",
            roughness,
            mirrored,
            _sampled(sat, surface, control),
            {
                "sat" if lookups == 4 else f"sat_{lookups}_lookups": partial(
                    sat.specular, surface, lookups
                )
                for lookups in LOOKUPS
            },
        )


def _sampled(light: ImageLight, surface: Surface, control: Control) -> Doubles:
    """(N, 3) of points, by many points of the map each."""

    def some(begin: int, end: int) -> Floats:
        rows = surface.rows(begin, end)
        shown = np.empty((rows.size, 3), np.float32)
        terms = albedo_tables().specular
        brute_specular(light.rest, SAMPLES, terms, 1.0, 0.0, 1.0, rows, shown)
        return shown

    sampled = np.concatenate(map_chunks(surface.size, CHUNK, some, control))
    return sampled.astype(np.float64)


def _shapes(rest: Floats) -> dict[str, Callable[[Doubles, float], Doubles]]:
    """Single filters of a lat-long map's tables, as of 2009."""
    boxes = LatLongLobes(rest, 1)
    return {
        "box": boxes.box,
        "nested_boxes": boxes.nested,
        "order_2": LatLongLobes(rest, 2).box,
        "order_3": LatLongLobes(rest, 3).box,
    }


def _scaled(
    albedo: Floats, shape: Callable[[Doubles, float], Doubles], towards: Doubles, exponent: float
) -> Doubles:
    scaled: Doubles = albedo * shape(towards, exponent)
    return scaled


def _integral(integral: Callable[..., Doubles], control: Control, *directions: Doubles) -> Doubles:
    """Integrals at all directions, a few on each thread at a time."""

    def some(begin: int, end: int) -> Doubles:
        return integral(*(each[begin:end] for each in directions))

    return np.concatenate(map_chunks(len(directions[0]), CHUNK, some, control))


def _errors(name: str, lobe: _Lobe) -> Iterator[LightError]:
    truth = lobe.truth @ LUMINANCE
    height = np.abs(lobe.towards[:, 1])
    for method, shown in lobe.methods.items():
        start = time.perf_counter()
        got = shown()
        seconds = time.perf_counter() - start
        error = np.abs(got @ LUMINANCE / truth - 1)
        yield LightError(
            measured="error",
            map=name,
            lobe=lobe.lobe,
            parameter=lobe.parameter,
            method=method,
            directions=len(truth),
            mean_relative_error=float(error.mean()),
            pole_error=_mean(error[height > POLE]),
            equator_error=_mean(error[height < EQUATOR]),
            seconds=seconds,
        )


def _mean(errors: Doubles) -> float:
    return float(errors.mean()) if len(errors) else 0.0


def _unit(vectors: Doubles) -> Doubles:
    unit: Doubles = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return unit
