"""Scenes, environments and pictures as messages, and back, checked.

The checks are those that constructing the things makes, on which kernels rely (every index, every
shape, finite numbers), and of the fields that no constructor looks at, here.
"""

import dataclasses
import math
from typing import Annotated, Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from raysvc.loading.picture_file import StoredPicture
from raysvc.loading.shape_file import Shape
from raysvc.parsing.message import BadMessage, Message
from raysvc.scene import Environment, Material, PunctualLight, Scene, SceneCamera, Texture
from raysvc.scene.texture import Wrap

SCENE_ARRAYS: Final = (
    "positions",
    "normals",
    "tangents",
    "uv",
    "colours",
    "triangles",
    "material_of_triangle",
    "object_of_triangle",
)
LONGEST_TEXT: Final = 1 << 16

Fields = TypeVar("Fields", bound=BaseModel)
Text = Annotated[str, Field(max_length=LONGEST_TEXT)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _TextureFields(_Strict):
    texels: int
    wrap_u: Wrap
    wrap_v: Wrap
    nearest: bool
    name: Text


class _CameraFields(_Strict):
    world_from_camera: int
    fov_y_deg: float | None
    height_m: float | None
    aspect_ratio: float | None
    name: Text


class _SceneFields(_Strict):
    name: Text
    warnings: tuple[Text, ...]
    materials: tuple[Material, ...]
    lights: tuple[PunctualLight, ...]
    textures: tuple[_TextureFields, ...]
    cameras: tuple[_CameraFields, ...]


class _EnvironmentFields(_Strict):
    name: Text
    warnings: tuple[Text, ...]


class _PictureFields(_Strict):
    coded: bool


def scene_message(scene: Scene) -> Message:
    """Say a scene; texels that several textures share are said once."""
    arrays: list[NDArray[Any]] = [getattr(scene, name) for name in SCENE_ARRAYS]
    numbers: dict[int, int] = {}

    def number_of(array: NDArray[Any]) -> int:
        if id(array) not in numbers:
            numbers[id(array)] = len(arrays)
            arrays.append(array)
        return numbers[id(array)]

    fields = {
        "name": scene.name,
        "warnings": scene.warnings,
        "materials": [dataclasses.asdict(material) for material in scene.materials],
        "lights": [dataclasses.asdict(light) for light in scene.lights],
        "textures": [
            _fields_of(texture) | {"texels": number_of(texture.texels)}
            for texture in scene.textures
        ],
        "cameras": [
            _fields_of(camera)
            | {"world_from_camera": number_of(np.asarray(camera.world_from_camera, np.float64))}
            for camera in scene.cameras
        ],
    }
    return Message(fields, arrays)


def scene_from(message: Message) -> Scene:
    """Hear a scene. Raises BadMessage, or InvalidScene as `Scene` does."""
    said = _checked(_SceneFields, message)
    if len(message.arrays) < len(SCENE_ARRAYS):
        raise BadMessage("lacks arrays of a scene")
    named = dict(zip(SCENE_ARRAYS, message.arrays, strict=False))
    objects = named["object_of_triangle"]
    if objects.size and not 0 <= objects.min() <= int(objects.max()) * len(said.materials) < 2**31:
        raise BadMessage("has impossible numbers of objects")
    for light in said.lights:
        if not all(map(math.isfinite, (*light.intensity, *light.position, *light.direction))):
            raise BadMessage("has a light that is nowhere")
    return Scene(
        **named,
        materials=said.materials,
        textures=tuple(_texture(message, texture) for texture in said.textures),
        lights=said.lights,
        cameras=tuple(_camera(message, camera) for camera in said.cameras),
        name=said.name,
        warnings=said.warnings,
    )


def shape_message(shape: Shape) -> Message:
    """Say where vertices are; whole numbers, which a message has not, as float64."""
    arrays = (shape.positions, shape.normals)
    return Message(
        {},
        [
            array if array.dtype in (np.float32, np.float64) else array.astype(np.float64)
            for array in arrays
            if array is not None
        ],
    )


def shape_from(message: Message, vertices: int) -> Shape:
    """Hear where so many vertices are. Raises BadMessage."""
    if len(message.arrays) not in (1, 2):
        raise BadMessage("has no positions")
    for array in message.arrays:
        if array.shape != (vertices, 3) or array.dtype not in (np.float32, np.float64):
            raise BadMessage("has positions of another shape")
    return Shape(*message.arrays)


def environment_message(environment: Environment) -> Message:
    """Say an environment."""
    fields = {"name": environment.name, "warnings": environment.warnings}
    return Message(fields, [environment.radiance])


def environment_from(message: Message) -> Environment:
    """Hear an environment. Raises BadMessage, or InvalidEnvironment as `Environment` does."""
    said = _checked(_EnvironmentFields, message)
    return Environment(_array(message, 0, np.float32, 3), said.name, said.warnings)


def picture_message(picture: StoredPicture) -> Message:
    """Say a picture."""
    return Message({"coded": picture.coded}, [picture.rgba])


def picture_from(message: Message) -> StoredPicture:
    """Hear a picture. Raises BadMessage."""
    said = _checked(_PictureFields, message)
    rgba = _array(message, 0, np.float32, 3)
    if rgba.shape[2] != 4 or 0 in rgba.shape:
        raise BadMessage("has no RGBA")
    return StoredPicture(rgba, said.coded)


def depth_message(depth: NDArray[np.float32]) -> Message:
    """Say a picture's depth."""
    return Message({}, [depth])


def depth_from(message: Message) -> NDArray[np.float32]:
    """Hear a picture's depth. Raises BadMessage."""
    depth = _array(message, 0, np.float32, 2)
    if 0 in depth.shape or not (depth > 0).all():
        raise BadMessage("has depth that is none")
    return depth


def _texture(message: Message, said: _TextureFields) -> Texture:
    texels = _array(message, said.texels, np.uint8, 3)
    if texels.shape[2] != 4 or 0 in texels.shape:
        raise BadMessage("has a texture without texels")
    return Texture(texels, said.wrap_u, said.wrap_v, said.nearest, said.name)


def _camera(message: Message, said: _CameraFields) -> SceneCamera:
    pose = _array(message, said.world_from_camera, np.float64, 2)
    numbers = (said.fov_y_deg, said.height_m, said.aspect_ratio)
    finite = all(number is None or math.isfinite(number) for number in numbers)
    if pose.shape != (4, 4) or not np.isfinite(pose).all() or not finite:
        raise BadMessage("has a camera that is nowhere")
    return SceneCamera(pose, said.fov_y_deg, said.height_m, said.aspect_ratio, said.name)


def _fields_of(thing: Texture | SceneCamera) -> dict[str, Any]:
    """What a dataclass holds, its arrays as they are."""
    return {field.name: getattr(thing, field.name) for field in dataclasses.fields(thing)}


def _checked(model: type[Fields], message: Message) -> Fields:
    try:
        return TypeAdapter(model).validate_python(message.fields)
    except ValidationError as error:
        raise BadMessage(f"has wrong fields: {str(error)[:200]}") from None


def _array(message: Message, number: int, dtype: type[Any], dimensions: int) -> NDArray[Any]:
    if not 0 <= number < len(message.arrays):
        raise BadMessage("lacks an array")
    array = message.arrays[number]
    if array.dtype != dtype or array.ndim != dimensions:
        raise BadMessage("has an array of another kind")
    return array
