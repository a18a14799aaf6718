"""Scenes and the like as messages: nothing is lost on the way, and nothing false gets in."""

import copy
import dataclasses
import json
from typing import Any

import numpy as np
import pytest

from raysvc.errors import InvalidEnvironment, InvalidScene
from raysvc.loading.picture_file import StoredPicture
from raysvc.loading.shape_file import Shape
from raysvc.parsing.message import BadMessage, Message
from raysvc.parsing.scene_message import (
    SCENE_ARRAYS,
    depth_from,
    depth_message,
    environment_from,
    environment_message,
    picture_from,
    picture_message,
    scene_from,
    scene_message,
    shape_from,
    shape_message,
)
from raysvc.scene import Environment, Scene
from tests.parsing.scenes import crowded_scene


def sent(message: Message) -> Message:
    """As it is after a journey: fields through JSON, arrays copied."""
    return Message(
        json.loads(json.dumps(message.fields)), [np.array(array) for array in message.arrays]
    )


def test_a_scene_arrives_as_it_was() -> None:
    scene = crowded_scene()
    found = scene_from(sent(scene_message(scene)))
    for field in dataclasses.fields(Scene):
        if field.name in ("rest", "_bounds", "textures", "cameras"):
            continue
        one, other = getattr(scene, field.name), getattr(found, field.name)
        assert np.array_equal(one, other) if isinstance(one, np.ndarray) else one == other, field
    assert np.array_equal(scene.bounds(), found.bounds())
    for texture, there in zip(scene.textures, found.textures, strict=True):
        assert np.array_equal(texture.texels, there.texels)
        assert dataclasses.replace(texture, texels=there.texels) != texture  # they have no equality
        for name in ("wrap_u", "wrap_v", "nearest", "name"):
            assert getattr(texture, name) == getattr(there, name)
    for camera, there in zip(scene.cameras, found.cameras, strict=True):
        assert np.array_equal(camera.world_from_camera, there.world_from_camera)
        for name in ("fov_y_deg", "height_m", "aspect_ratio", "name"):
            assert getattr(camera, name) == getattr(there, name)


def test_texels_that_textures_share_are_sent_once() -> None:
    scene = crowded_scene()
    message = scene_message(scene)
    different = {id(texture.texels) for texture in scene.textures}
    assert len(message.arrays) == len(SCENE_ARRAYS) + len(different) + len(scene.cameras)
    found = scene_from(sent(message))
    assert found.textures[-1].texels is found.textures[-2].texels


def forged(change: Any) -> Message:
    message = sent(scene_message(crowded_scene()))
    arrays = list(message.arrays)
    fields = copy.deepcopy(message.fields)
    change(fields, arrays)
    return Message(fields, arrays)


def put(number: int, value: Any) -> Any:
    def change(fields: dict[str, Any], arrays: list[Any]) -> None:
        arrays[number] = value(arrays[number])

    return change


def first(array: np.ndarray, value: float) -> np.ndarray:
    array.flat[0] = value
    return array


@pytest.mark.parametrize(
    "change",
    [
        put(0, lambda a: first(a, np.nan)),
        put(0, lambda a: a[:-1]),
        put(0, lambda a: a.astype(np.float64)),
        put(5, lambda a: first(a, 1 << 30)),
        put(5, lambda a: first(a, -1)),
        put(6, lambda a: first(a, 99)),
        put(6, lambda a: a[:-1]),
        put(7, lambda a: first(a, -1)),
        put(7, lambda a: first(a, 2**31 - 1)),
        put(8, lambda a: a[..., :3]),
        put(8, lambda a: a.astype(np.int32)),
        put(8, lambda a: a[:0]),
        put(-1, lambda a: first(a, np.inf)),
        put(-1, lambda a: a[:3]),
        lambda fields, arrays: arrays.clear(),
        lambda fields, arrays: fields["textures"][0].update(texels=-1),
        lambda fields, arrays: fields["textures"][0].update(texels=10**9),
        lambda fields, arrays: fields["textures"][0].update(wrap_u="never"),
        lambda fields, arrays: fields["materials"][0].update(alpha_mode="maybe"),
        lambda fields, arrays: fields["materials"][0].update(base_colour=[1, 2]),
        lambda fields, arrays: fields["materials"][0].update(roughness=float("nan")),
        lambda fields, arrays: fields["materials"][-1]["normal_texture"].update(texture=77),
        lambda fields, arrays: fields["materials"][-1]["normal_texture"].update(uv_set=2),
        lambda fields, arrays: fields["materials"].clear(),
        lambda fields, arrays: fields["lights"][0].update(kind="torch"),
        lambda fields, arrays: fields["lights"][0].update(position=[0, float("nan"), 0]),
        lambda fields, arrays: fields["cameras"][0].update(fov_y_deg=float("inf")),
        lambda fields, arrays: fields.update(name=3),
        lambda fields, arrays: fields.update(surprise=1),
        lambda fields, arrays: fields.update(warnings=["x" * 1_000_000]),
    ],
)
def test_a_forged_scene_is_refused(change: Any) -> None:
    with pytest.raises((BadMessage, InvalidScene)):
        scene_from(forged(change))


def test_an_environment_arrives_as_it_was_or_not_at_all() -> None:
    pixels = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
    found = environment_from(sent(environment_message(Environment(pixels, "sky", ("dark",)))))
    assert np.array_equal(found.radiance, pixels)
    assert (found.name, found.warnings) == ("sky", ("dark",))
    fields = {"name": "sky", "warnings": []}
    for wrong in (-pixels, pixels * np.float32(np.nan), pixels[..., :2], pixels[:0]):
        with pytest.raises(InvalidEnvironment):
            environment_from(Message(fields, [wrong]))
    for arrays in ([], [pixels.astype(np.float64)], [pixels[0]]):
        with pytest.raises(BadMessage):
            environment_from(Message(fields, arrays))


def test_a_picture_and_its_depth_arrive_as_they_were_or_not_at_all() -> None:
    rgba = np.arange(24, dtype=np.float32).reshape(2, 3, 4)
    found = picture_from(sent(picture_message(StoredPicture(rgba, True))))
    assert np.array_equal(found.rgba, rgba) and found.coded is True
    depth = np.array([[1.0, np.inf]], np.float32)
    assert np.array_equal(depth_from(sent(depth_message(depth))), depth)
    for wrong in (rgba[..., :3], rgba[0], rgba[:0], rgba.astype(np.float64)):
        with pytest.raises(BadMessage):
            picture_from(Message({"coded": True}, [wrong]))
    for wrong in (-depth, depth * np.float32(np.nan), depth[0], depth[:0]):
        with pytest.raises(BadMessage):
            depth_from(Message({}, [wrong]))
    with pytest.raises(BadMessage):
        picture_from(Message({}, [rgba]))


def test_positions_of_another_scene_are_refused() -> None:
    positions = np.zeros((4, 3), np.float32)
    assert shape_from(sent(shape_message(Shape(positions))), 4).normals is None
    for arrays in ([], [positions] * 3, [positions[:3]], [positions.astype(np.int32)]):
        with pytest.raises(BadMessage):
            shape_from(Message({}, arrays), 4)
