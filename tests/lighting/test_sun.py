"""Suns are found, taken out and keep their light."""

import math

import numpy as np
import pytest

from raysvc.lighting.sun import LUMINANCE, MOST, extract_suns
from tests.oracles.lobe import map_directions

HEIGHT, WIDTH = 128, 256


def map_with_disc(towards, radius_deg, radiance=3000.0, background=0.5, parts=4):
    """Lat-long map with a disc whose edge is anti-aliased, and the unit direction."""
    towards = np.asarray(towards, float) / np.linalg.norm(towards)
    fine, _ = map_directions(HEIGHT * parts, WIDTH * parts)
    inside = (fine @ towards > math.cos(math.radians(radius_deg))).astype(float)
    share = inside.reshape(HEIGHT, parts, WIDTH, parts).mean((1, 3))[..., None]
    colour = np.array([1.0, 0.8, 0.5])
    return (background + share * radiance * colour).astype(np.float32), towards


def facing_irradiance(radiance, towards):
    light, angles = map_directions(*radiance.shape[:2])
    return (angles * np.maximum(light @ towards, 0)) @ radiance.reshape(-1, 3).astype(float)


PLACES = {
    "high": (0.3, 0.7, -0.5),
    "seam": (1e-4, 0.4, 1.0),
    "pole": (0.01, 1.0, 0.02),
    "near the pole": (0.1, 1.0, 0.05),
    "nadir": (0.0, -1.0, 0.0),
    "horizon": (-1.0, 0.0, 0.2),
}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("radius_deg", [2.0, 4.0])
def test_a_disc_anywhere_becomes_a_sun_and_keeps_its_light(place, radius_deg):
    radiance, towards = map_with_disc(PLACES[place], radius_deg)
    (sun,), rest = extract_suns(radiance)
    found = np.array(sun.direction)
    assert math.degrees(math.acos(min(found @ towards, 1.0))) < 0.25
    assert math.degrees(sun.angular_radius_rad) == pytest.approx(radius_deg, abs=0.6)
    before = facing_irradiance(radiance, found)
    after = facing_irradiance(rest, found) + sun.irradiance
    np.testing.assert_allclose(after, before, rtol=1e-3)
    np.testing.assert_allclose(rest, 0.5, rtol=1e-4)
    assert rest.dtype == np.float32 and radiance.max() > 2000


def test_one_texel_is_a_sun():
    radiance = np.full((HEIGHT, WIDTH, 3), 0.2, np.float32)
    radiance[40, 0] = 5e4
    (sun,), rest = extract_suns(radiance)
    assert rest.max() == pytest.approx(0.2)
    assert 0 < sun.angular_radius_rad < 2 * math.pi / HEIGHT


@pytest.mark.parametrize(
    "radiance",
    [
        np.zeros((16, 32, 3), np.float32),
        np.ones((1, 1, 3), np.float32),
        np.linspace(0, 1, 64 * 128 * 3, dtype=np.float32).reshape(64, 128, 3),
        map_with_disc((0.5, 0.5, 0.5), 14.0, radiance=50.0)[0],
    ],
    ids=["black", "one texel", "ramp", "softbox"],
)
def test_maps_without_a_small_dominant_light_have_no_sun(radiance):
    suns, rest = extract_suns(radiance)
    assert suns == () and rest is radiance


def test_a_weak_spot_stays_in_the_map():
    assert extract_suns(map_with_disc((0, 1, 1), 1.0, radiance=5.0)[0])[0] == ()


def test_several_small_lights_are_suns_beside_a_softbox_that_is_none():
    radiance, softbox = map_with_disc((0.2, -0.5, 1.0), 12.0, radiance=60.0)
    places, strengths = [(1, 0.2, 0), (-0.6, 0.5, -0.4), (0, -1, 0.1)], [3000.0, 900.0, 400.0]
    for place, strength in zip(places, strengths, strict=True):
        disc, _ = map_with_disc(place, 1.5, radiance=strength)
        radiance = np.maximum(radiance, disc)
    suns, rest = extract_suns(radiance)
    assert len(suns) == 3
    assert [sun.irradiance[0] for sun in suns] == sorted(s.irradiance[0] for s in suns)[::-1]
    for sun, place in zip(suns, places, strict=True):
        assert np.dot(sun.direction, place) / np.linalg.norm(place) > 0.9999
    # All light is still there: that of a disc is its irradiance over the mean cosine
    taken = sum(np.array(s.irradiance) * 2 / (1 + math.cos(s.angular_radius_rad)) for s in suns)
    np.testing.assert_allclose(flux(rest) + taken, flux(radiance), rtol=1e-3)
    assert (rest @ LUMINANCE).max() < 60.1
    texels, _ = map_directions(HEIGHT, WIDTH)
    inside = (texels @ softbox > math.cos(math.radians(11.0))).reshape(HEIGHT, WIDTH)
    np.testing.assert_array_equal(rest[inside], radiance[inside])


def test_no_more_suns_than_a_picture_can_afford():
    radiance = np.full((HEIGHT, WIDTH, 3), 0.2, np.float32)
    radiance[40, :: WIDTH // 8] = 5e4
    suns, rest = extract_suns(radiance)
    assert len(suns) == MOST and (rest[..., 0] > 1).sum() == 8 - MOST


@pytest.mark.assets
@pytest.mark.parametrize("name", ["venice_sunset_1k.hdr", "KernerEnvLatLong.exr"])
def test_suns_and_rest_hold_all_light_of_real_maps(assets, name):
    radiance = _read(assets / "hdr" / name)
    suns, rest = extract_suns(radiance)
    taken = sum(np.array(s.irradiance) * 2 / (1 + math.cos(s.angular_radius_rad)) for s in suns)
    np.testing.assert_allclose(flux(rest) + taken, flux(radiance), rtol=1e-3)


@pytest.mark.assets
@pytest.mark.parametrize(
    ("name", "radius_deg"),
    [("kloppenheim_05_1k.hdr", 0.5), ("venice_sunset_1k.hdr", 0.6), ("KernerEnvLatLong.exr", 2.0)],
)
def test_skies_have_their_sun(assets, name, radius_deg):
    radiance = _read(assets / "hdr" / name)
    (sun, *_), rest = extract_suns(radiance)
    assert math.degrees(sun.angular_radius_rad) < radius_deg
    assert sun.direction[1] > 0
    found = np.array(sun.direction)
    after = facing_irradiance(rest, found) + sun.irradiance
    np.testing.assert_allclose(after, facing_irradiance(radiance, found), rtol=1e-3)
    assert (rest @ LUMINANCE).max() < 0.1 * (radiance @ LUMINANCE).max()


@pytest.mark.assets
def test_labels_of_directions_are_no_sun(assets):
    assert extract_suns(_read(assets / "hdr" / "OrientationLatLong.exr"))[0] == ()


def flux(radiance):
    """Light of a map from all directions together."""
    _, angles = map_directions(*radiance.shape[:2])
    return angles @ radiance.reshape(-1, 3).astype(float)


def _read(path):
    import OpenImageIO

    pixels = OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT)
    return np.ascontiguousarray(pixels[..., :3], np.float32)
