"""What boundaries of solids, and sheets, reflect and let through."""

import math

import numpy as np
import pytest

from raysvc.geometry.refraction import transmitted_cosine
from raysvc.lighting.albedo import diffuse_albedo, specular_albedo
from raysvc.lighting.boundary_albedo import boundary_albedo, boundary_tables
from raysvc.lighting.boundary_albedo_kernels import ior_at, ior_place
from raysvc.lighting.brdf import ggx_alpha
from raysvc.shading.glass import Glass
from tests.lighting.surfaces import surface_of
from tests.oracles.brdf import gltf_lobes
from tests.oracles.btdf import hemisphere, refraction, schlick_weight

NORMAL = np.array([0.0, 0.0, 1.0])


def glass_of(cosine, roughness, *, ior=1.5, solid=True, entering=True, base=1.0, metallic=0.0):
    """Surface of white glass seen at cosines (N,)."""
    cosine = np.atleast_1d(np.asarray(cosine, float))
    count = len(cosine)
    view = np.stack([np.sqrt(1 - cosine**2), 0 * cosine, cosine], axis=1)
    f0 = ((ior - 1) / (ior + 1)) ** 2
    surface = surface_of(np.tile(NORMAL, (count, 1)), view, base, metallic, roughness, f0)
    return surface._replace(
        transmission=np.ones(count, np.float32),
        glass=Glass(
            np.full(count, solid),
            np.full(count, entering),
            np.full(count, ior, np.float32),
            np.zeros((count, 3), np.float32),
        ),
    )


@pytest.mark.parametrize("ior", [1.1, 1.33, 1.5, 2.42])
@pytest.mark.parametrize("entering", [True, False])
def test_a_smooth_boundary_keeps_all_light(ior, entering):
    cosine = np.linspace(0.1, 1, 40)
    reflected, transmitted = boundary_albedo(glass_of(cosine, 0.0, ior=ior, entering=entering))
    np.testing.assert_allclose(reflected + transmitted, 1, atol=5e-3)


@pytest.mark.parametrize("ior", [1.33, 1.5, 2.42])
def test_nothing_leaves_a_smooth_solid_beyond_the_critical_angle(ior):
    critical = math.sqrt(1 - 1 / ior**2)
    cosine = np.linspace(0.05, 0.97, 30) * critical
    reflected, transmitted = boundary_albedo(glass_of(cosine, 0.0, ior=ior, entering=False))
    assert transmitted.max() < 0.03
    np.testing.assert_allclose(reflected, 1, atol=0.03)


@pytest.mark.parametrize("ior", [1.33, 1.5, 1.8])
@pytest.mark.parametrize("cosine", [1.0, 0.7, 0.3])
def test_a_smooth_slab_in_a_furnace_is_invisible(ior, cosine):
    """R + T T' (1 + R' + R'^2 ...) for light that goes to and fro inside."""
    inside = transmitted_cosine(cosine, 1 / ior)
    ((r, *_),), ((t, *_),) = boundary_albedo(glass_of(cosine, 0.0, ior=ior))
    ((ri, *_),), ((ti, *_),) = boundary_albedo(glass_of(inside, 0.0, ior=ior, entering=False))
    assert r == pytest.approx(ri, abs=3e-3)
    assert r + t * ti / (1 - ri) == pytest.approx(1, abs=5e-3)


@pytest.mark.parametrize("roughness", [0.4, 1.0])
@pytest.mark.parametrize("eta", [1 / 1.5, 1.33, 1.5])
@pytest.mark.parametrize("cosine", [0.95, 0.6, 0.25])
def test_rough_boundaries_are_integrals_of_the_formula(roughness, eta, cosine):
    ior = max(eta, 1 / eta)
    here, there = (1, ior) if eta < 1 else (ior, 1)
    surface = glass_of(cosine, roughness, ior=ior, entering=eta < 1)
    ((got_reflected, *_),), ((got_transmitted, *_),) = boundary_albedo(surface)
    f0 = float(surface.dielectric_f0[0])
    view = surface.to_viewer[0].astype(float)

    below, angle = hemisphere(500, 300)
    lobe, voh = refraction(view, below, here, there, ggx_alpha(roughness))
    through = (1 - f0) * (1 - schlick_weight(voh, here, there)) * lobe * -below[:, 2]
    assert got_transmitted == pytest.approx(through.sum() * angle, abs=0.012)

    above = below * [1, 1, -1]
    half = above + view
    voh = (half @ view) / np.linalg.norm(half, axis=1)
    _, lobe = gltf_lobes(NORMAL, view, above, np.ones(3), 1.0, roughness)
    back = (f0 + (1 - f0) * schlick_weight(voh, here, there)) * lobe[:, 0] * above[:, 2]
    assert got_reflected == pytest.approx(back.sum() * angle, abs=0.012)


@pytest.mark.parametrize("roughness", [0.0, 0.5, 1.0])
def test_a_sheet_lets_through_the_lobe_that_it_would_reflect(roughness):
    cosine = np.linspace(0.1, 1, 10)
    reflected, transmitted = boundary_albedo(glass_of(cosine, roughness, solid=False))
    white = specular_albedo(surface_of(np.tile(NORMAL, (10, 1)), [0, 0, 1.0], 1.0, 1.0, roughness))
    mirror = glass_of(cosine, roughness, solid=False, metallic=1.0)
    np.testing.assert_allclose(reflected + transmitted, specular_albedo(mirror), rtol=1e-5)
    assert white.shape == transmitted.shape


def test_base_colour_tints_and_metal_stops_what_goes_through():
    base = np.array([0.9, 0.5, 0.1])
    for solid, entering in ((False, True), (True, True), (True, False)):
        kind = {"solid": solid, "entering": entering}
        white = boundary_albedo(glass_of(0.9, 0.2, **kind))[1]
        np.testing.assert_allclose(
            boundary_albedo(glass_of(0.9, 0.2, base=base, **kind))[1], white * base, rtol=1e-5
        )
        assert not boundary_albedo(glass_of(0.9, 0.2, metallic=1.0, **kind))[1].any()
        surface = glass_of(0.9, 0.2, **kind)
        surface.transmission[:] = 0.25
        np.testing.assert_allclose(boundary_albedo(surface)[1], white * 0.25, rtol=1e-5)


def test_what_goes_through_is_not_diffused():
    surface = glass_of([0.9, 0.4], 0.5)
    assert not diffuse_albedo(surface).any()
    opaque = surface._replace(transmission=np.zeros(2, np.float32))
    half = surface._replace(transmission=np.full(2, 0.5, np.float32))
    np.testing.assert_allclose(diffuse_albedo(half), diffuse_albedo(opaque) / 2, rtol=1e-6)
    assert diffuse_albedo(opaque).min() > 0.5


def test_the_axis_of_indices_ends_where_it_says():
    for place in (0.1, 0.5, 1.0):
        assert ior_place(ior_at(place)) == pytest.approx(place)
    assert ior_place(1.0) == 0 and ior_place(100.0) == 1


def test_no_albedo_exceeds_one():
    tables = boundary_tables()
    assert tables.outside.min() >= 0 and tables.outside.max() <= 1 + 1e-6
    assert tables.inside.min() >= 0
    # F0 = 0 and F0 = 1
    assert (tables.inside[..., 1] + tables.inside[..., 2]).max() <= 1.01
    assert (tables.inside[..., 0] + tables.inside[..., 1]).max() <= 1 + 1e-6
