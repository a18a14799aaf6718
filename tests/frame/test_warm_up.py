"""Warming up goes through everything that a frame may need."""

import pytest

import raysvc
from raysvc.frame.warm_up import specimen, warm_up
from tests.frame.subjects import still_life


def test_the_specimen_has_every_kind_of_material_and_slot() -> None:
    scene = specimen()
    assert {material.alpha_mode for material in scene.materials} == {"opaque", "mask", "blend"}
    assert None not in scene.materials[0].texture_refs()
    assert scene.materials[0].solid and scene.materials[0].clearcoat > 0


@pytest.mark.parametrize("mode", ["hybrid", "reference"])
def test_a_frame_after_the_specimen_compiles_nothing_new(mode: str) -> None:
    """Kernels are specialised to types; the specimen has met those of another scene."""
    warm_up()
    before = compiled()
    view, scene = {"width": 32, "height": 18, "aperture_radius": 0.05}, still_life()
    for shape in (scene, scene.deformed(2 * scene.positions)):
        raysvc.render(shape, camera=view, settings={"mode": mode, "samples": 1})
        raysvc.render(shape, camera=view, settings={"aa": "full", "texture_filter": "sat"})
        raysvc.render(shape, {"probe_at": [-0.9, 0.8, 0.0], "size": 16}, view)
        for settings in ({"aperture_blades": 5}, {"lens_order": 3}, {"lens_shape": "box"}):
            raysvc.render(shape, camera=view | {"aperture_radius": 2.0}, settings=settings)
    assert compiled() == before


def compiled() -> dict[str, int]:
    """How many specialisations each kernel of the frame has."""
    from raysvc.frame import composite_kernels
    from raysvc.geometry import triangle_kernels
    from raysvc.lens import (
        aperture_kernels,
        box_kernels,
        compose_kernels,
        fill_kernels,
        point_kernels,
        silhouette_kernels,
        slice_kernels,
        sum_kernels,
    )
    from raysvc.lighting import clearcoat, cube_map_kernels, direct_kernels, image_kernels
    from raysvc.reference import (
        environment_kernels,
        scattering_kernels,
        sequence_kernels,
        weight_kernels,
    )
    from raysvc.shading import (
        coat_kernels,
        coverage_kernels,
        glass_kernels,
        mip_kernels,
        surface_kernels,
        texture_sum_kernels,
    )
    from raysvc.tracing import occlusion_kernels, offset_kernels, ray_differential_kernels

    modules = (
        composite_kernels,
        triangle_kernels,
        aperture_kernels,
        box_kernels,
        compose_kernels,
        fill_kernels,
        point_kernels,
        silhouette_kernels,
        slice_kernels,
        sum_kernels,
        clearcoat,
        cube_map_kernels,
        direct_kernels,
        image_kernels,
        coat_kernels,
        coverage_kernels,
        glass_kernels,
        mip_kernels,
        surface_kernels,
        texture_sum_kernels,
        occlusion_kernels,
        offset_kernels,
        ray_differential_kernels,
        environment_kernels,
        scattering_kernels,
        sequence_kernels,
        weight_kernels,
    )
    return {
        f"{module.__name__}.{name}": len(value.signatures)
        for module in modules
        for name, value in vars(module).items()
        if hasattr(value, "signatures")
    }
