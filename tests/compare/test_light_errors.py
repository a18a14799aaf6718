"""The benchmark of light: errors fall where filters fit, and integrals are right themselves."""

import dataclasses

import numpy as np
import pytest

from raysvc.builtin import BUILTIN_ENVIRONMENTS
from raysvc.compare.light_errors import BRUSHED, EXPONENTS, ROUGHNESS, light_errors, lobe_count
from raysvc.compare.lobe_integrals import diffuse_integrals, phong_integrals, specular_integrals
from raysvc.compare.measure import Steps
from raysvc.compare.sat_benchmark import bench_sat
from raysvc.loading import load_environment
from raysvc.parallel import Control
from raysvc.scene import Environment
from tests.oracles.lobe import albedo, map_directions, outgoing


@pytest.fixture(scope="module")
def studio():
    radiance = BUILTIN_ENVIRONMENTS["studio"]().radiance
    return Environment(np.ascontiguousarray(radiance.reshape(128, 4, 256, 4, 3).mean((1, 3))))


@pytest.fixture(scope="module")
def errors(studio):
    control = Control()
    found = light_errors({"studio": studio}, 60, 1, Steps(lobe_count(), control), control)
    return {(e.lobe, e.parameter, e.method): e for e in found}


def test_the_default_is_near_and_better_than_what_it_replaces(errors):
    for (lobe, parameter, method), found in errors.items():
        if method == "sat":
            limit = {"diffuse": 0.015, "phong": 0.03, "ggx": 0.06, "brushed": 0.08}[lobe]
            assert found.mean_relative_error < limit, (lobe, parameter)
        elif method in ("box", "split_sum"):
            default = errors[lobe, parameter, "sat"]
            assert default.mean_relative_error < found.mean_relative_error, (lobe, parameter)


@pytest.fixture(scope="module")
def judged(assets):
    """Errors of the default by lobe and parameter, under the five maps that judge it."""
    files = ("venice_sunset_1k.hdr", "studio_small_03_1k.hdr", "kloppenheim_05_1k.hdr")
    names = [str(assets / "hdr" / name) for name in (*files, "KernerEnvLatLong.exr")]
    maps = {name: load_environment(name) for name in (*names, "builtin:studio")}
    control, found = Control(), {}
    steps = Steps(lobe_count() * len(maps), control)
    # The benchmark's own seed. Means of 60 directions vary by half a percent under the studio: GGX
    # of 0.42 is 2.4 % here, 4.1 % with seed 2, and 3.5 % over 400
    for each in light_errors(maps, 60, 0, steps, control):
        if each.method == "sat":
            found.setdefault((each.lobe, each.parameter), []).append(each)
    assert {len(each) for each in found.values()} == {len(maps)}
    return found


def mean_of(errors, kind):
    return np.mean([getattr(each, kind) for each in errors])


@pytest.mark.assets
@pytest.mark.slow
def test_under_the_maps_that_judge_it_the_default_is_within_its_limits(judged):
    limits = {"diffuse": 0.01, "phong": 0.03, "ggx": 0.04}
    for (lobe, parameter), errors in judged.items():
        if lobe in limits:
            assert mean_of(errors, "mean_relative_error") <= limits[lobe], (lobe, parameter)


@pytest.mark.assets
@pytest.mark.slow
def test_under_the_maps_that_judge_it_poles_are_not_worse_than_the_equator(judged):
    for lobe in ("diffuse", "phong", "ggx"):
        some = [each for key, errors in judged.items() if key[0] == lobe for each in errors]
        assert mean_of(some, "pole_error") <= 1.5 * mean_of(some, "equator_error"), lobe


def test_all_lobes_are_measured_in_all_directions(errors):
    assert {p for lobe, p, _ in errors if lobe == "phong"} == set(EXPONENTS)
    assert {p for lobe, p, _ in errors if lobe == "ggx"} == set(ROUGHNESS)
    assert {p for lobe, p, _ in errors if lobe == "brushed"} == set(BRUSHED)
    assert {m for lobe, _, m in errors if lobe == "diffuse"} >= {"sat", "sh9", "brute", "box"}
    for found in errors.values():
        assert found.directions == 60 and found.seconds > 0
        assert 0 < found.mean_relative_error < 2 and found.measured == "error"
        assert min(found.pole_error, found.equator_error) >= 0


def test_errors_are_the_same_from_run_to_run_and_on_any_number_of_threads(studio, errors):
    control = Control(1)
    again = light_errors({"studio": studio}, 60, 1, Steps(lobe_count(), control), control)
    for found in again:
        before = dataclasses.replace(
            errors[found.lobe, found.parameter, found.method], seconds=found.seconds
        )
        assert found == before


def test_integrals_of_a_constant_map_are_albedos():
    sky = np.full((256, 512, 3), 0.5, np.float32)
    for nov in (0.3, 0.9):
        normal, view = np.array([[0.0, 0, 1]]), np.array([[np.sqrt(1 - nov**2), 0, nov]])
        for roughness in (0.1, 0.5, 1.0):
            diffuse, specular = albedo(nov, np.ones(3), 0.0, roughness, steps=400)
            got = specular_integrals(sky, normal, view, roughness, 0.04)[0]
            np.testing.assert_allclose(got, 0.5 * specular, rtol=0.01)
        got = diffuse_integrals(sky, normal, view, 0.04)[0]
        np.testing.assert_allclose(got, 0.5 * diffuse, rtol=0.01)
    np.testing.assert_allclose(phong_integrals(sky, normal, 20.0), 0.5, rtol=1e-6)


def test_integrals_are_the_oracles(studio, rng):
    normal, view = np.array([0.0, 0.6, 0.8]), np.array([0.6, 0.0, 0.8])
    diffuse, specular = outgoing(studio.radiance, normal, view, np.ones(3), 0.0, 0.5)
    got = diffuse_integrals(studio.radiance, normal[None], view[None], 0.04)[0]
    np.testing.assert_allclose(got, diffuse, rtol=1e-6)
    got = specular_integrals(studio.radiance, normal[None], view[None], 0.5, 0.04)[0]
    np.testing.assert_allclose(got, specular, rtol=5e-3)
    texels, angles = map_directions(128, 256)
    weights = np.maximum(texels @ normal, 0) ** 8 * angles
    expected = weights @ studio.radiance.reshape(-1, 3) / weights.sum()
    got = phong_integrals(studio.radiance, normal[None], 8.0)[0]
    np.testing.assert_allclose(got, expected, rtol=1e-6)


def test_the_benchmark_lights_a_picture_with_the_first_map(studio):
    measured = bench_sat(16, 8, rounds=1, control=Control(2), maps={"a": studio}, directions=8)
    lights = [r for r in measured["results"] if r["measured"] == "light"]
    assert {(r["order"], r["threads"]) for r in lights} == {
        (o, t) for o in (1, 2, 3) for t in (1, 2)
    }
    for each in lights:
        assert each["width"] * each["height"] > each["points"] > 100_000
        assert each["rebuilt_seconds"] >= each["static_seconds"] > 0 < each["tables_seconds"]
    assert sum(r["measured"] == "error" for r in measured["results"]) > 30
