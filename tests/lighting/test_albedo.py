"""Directional albedos against integrals over a hemisphere."""

import numpy as np
import pytest

from raysvc.lighting.albedo import albedo_tables, diffuse_albedo, specular_albedo
from tests.lighting.surfaces import surface_of
from tests.oracles.lobe import albedo

BASE = np.array([0.05, 0.5, 1.0])


@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.23, 0.5, 0.77, 1.0])
@pytest.mark.parametrize("nov", [0.07, 0.3, 0.71, 1.0])
@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_albedo_is_the_integral_of_the_formula(nov, roughness, metallic):
    diffuse, specular = albedo(nov, BASE, metallic, roughness)
    view = np.array([[np.sqrt(1 - nov**2), 0, nov]])
    surface = surface_of(np.array([[0, 0, 1.0]]), view, BASE, metallic, roughness)
    np.testing.assert_allclose(specular_albedo(surface)[0], specular, rtol=3e-3)
    np.testing.assert_allclose(diffuse_albedo(surface)[0], diffuse, rtol=3e-3, atol=1e-7)


def test_no_albedo_exceeds_one():
    tables = albedo_tables()
    assert (tables.specular >= 0).all()
    assert tables.specular.sum(axis=-1).max() <= 1.0 + 1e-6
    assert 0 <= tables.diffuse.min() and tables.diffuse.max() <= 1
