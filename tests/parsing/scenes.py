"""A scene that holds something of everything a scene can hold."""

import numpy as np

from raysvc.frame.warm_up import specimen
from raysvc.scene import (
    Material,
    PunctualLight,
    Scene,
    SceneCamera,
    Texture,
    TextureRef,
)


def crowded_scene() -> Scene:
    plain = specimen()
    texels = np.arange(2 * 3 * 4, dtype=np.uint8).reshape(2, 3, 4)
    pose = np.eye(4)
    pose[:3, 3] = 0.1, 0.2, 0.3
    return Scene(
        positions=plain.positions,
        normals=plain.normals,
        tangents=plain.tangents,
        uv=plain.uv,
        colours=plain.colours,
        triangles=plain.triangles,
        material_of_triangle=plain.material_of_triangle,
        object_of_triangle=plain.object_of_triangle,
        materials=(
            *plain.materials,
            Material(
                name="half of a pair: \ud800",
                base_colour=(0.1, 0.2, 1 / 3, 1.0),
                normal_texture=TextureRef(1, 1, (1.0, 0.5, 0.25, 0.0, 2.0, 3.0)),
                absorption=(1.0, 2.0, 3.0),
            ),
        ),
        textures=(
            *plain.textures,
            Texture(texels, "clamp", "mirror", nearest=True, name="a"),
            Texture(texels, name="the same texels, repeated"),
        ),
        lights=(PunctualLight("spot", (1.0, 2.0, 3.0), inner_cone_rad=0.1, name="lamp"),),
        cameras=(
            SceneCamera(pose, fov_y_deg=35.0, aspect_ratio=1.5, name="eye"),
            SceneCamera(np.eye(4), height_m=2.0),
        ),
        name="crowded",
        warnings=("something was left out",),
    )
