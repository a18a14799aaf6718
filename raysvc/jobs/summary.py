"""What is said of a scene or an environment without rendering it."""

import math
from typing import Any

import numpy as np

from raysvc.scene import Environment, Material, PunctualLight, Scene, SceneCamera
from raysvc.scene.material import TEXTURE_SLOTS


def scene_summary(scene: Scene) -> dict[str, Any]:
    """Counts, bounds, materials, textures, cameras, lights and warnings, ready for JSON."""
    least, greatest = scene.bounds()
    per_material = np.bincount(scene.material_of_triangle, minlength=len(scene.materials))
    objects = scene.object_of_triangle
    return {
        "name": scene.name,
        "triangles": len(scene.triangles),
        "vertices": len(scene.positions),
        "objects": int(np.unique(objects).size) if objects.size else 0,
        "bounds": {"min": least.tolist(), "max": greatest.tolist()},
        "materials": [
            _material(material, int(triangles))
            for material, triangles in zip(scene.materials, per_material, strict=True)
        ],
        "textures": [
            {"name": t.name, "width": t.texels.shape[1], "height": t.texels.shape[0]}
            for t in scene.textures
        ],
        "cameras": [_camera(camera) for camera in scene.cameras],
        "lights": [_light(light) for light in scene.lights],
        "warnings": list(scene.warnings),
    }


def environment_summary(environment: Environment) -> dict[str, Any]:
    """Size, mean and greatest radiance (solid-angle weighted, linear RGB) and warnings."""
    radiance = environment.radiance
    height, width = radiance.shape[:2]
    # A row's solid angle falls with the sine of the angle from the pole.
    weight = np.sin((np.arange(height) + 0.5) * (math.pi / height))
    mean = (weight[:, None] * radiance.mean(axis=1, dtype=np.float64)).sum(axis=0) / weight.sum()
    return {
        "name": environment.name,
        "width": width,
        "height": height,
        "mean_radiance": mean.tolist(),
        "max_radiance": float(radiance.max()),
        "warnings": list(environment.warnings),
    }


def scene_bytes(scene: Scene) -> int:
    """Memory that a scene's arrays and textures take."""
    arrays = (
        scene.positions,
        scene.normals,
        scene.tangents,
        scene.uv,
        scene.colours,
        scene.triangles,
        scene.material_of_triangle,
        scene.object_of_triangle,
    )
    return sum(a.nbytes for a in arrays) + sum(t.texels.nbytes for t in scene.textures)


def environment_bytes(environment: Environment) -> int:
    """Memory that an environment's pixels take."""
    return int(environment.radiance.nbytes)


def _material(material: Material, triangles: int) -> dict[str, Any]:
    textures = {
        slot: ref.texture
        for slot, ref in zip(TEXTURE_SLOTS, material.texture_refs(), strict=True)
        if ref is not None
    }
    return {
        "name": material.name,
        "triangles": triangles,
        "base_colour": list(material.base_colour),
        "metallic": material.metallic,
        "roughness": material.roughness,
        "emissive": list(material.emissive),
        "alpha_mode": material.alpha_mode,
        "double_sided": material.double_sided,
        "unlit": material.unlit,
        "ior": material.ior,
        "transmission": material.transmission,
        "solid": material.solid,
        "absorption": list(material.absorption),
        "clearcoat": material.clearcoat,
        "clearcoat_roughness": material.clearcoat_roughness,
        "anisotropy": material.anisotropy,
        "anisotropy_rotation_rad": material.anisotropy_rotation_rad,
        "textures": textures,
    }


def _camera(camera: SceneCamera) -> dict[str, Any]:
    return {
        "name": camera.name,
        "fov_y_deg": camera.fov_y_deg,
        "height_m": camera.height_m,
        "aspect_ratio": camera.aspect_ratio,
        "world_from_camera": camera.world_from_camera.tolist(),
    }


def _light(light: PunctualLight) -> dict[str, Any]:
    return {
        "name": light.name,
        "kind": light.kind,
        "intensity": list(light.intensity),
        "position": list(light.position),
        "direction": list(light.direction),
    }
