"""Images and samplers (specification, section 3.8)."""

import pygltflib

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.loading.gltf.buffers import Buffers, read_uri
from raysvc.loading.gltf.document import Document, item
from raysvc.loading.gltf.extensions import TextureSource, extension, note_unsupported
from raysvc.loading.images import decode_image
from raysvc.scene import Texture
from raysvc.scene.texture import Wrap
from raysvc.types import Bytes

_WRAPS: dict[int, Wrap] = {10497: "repeat", 33071: "clamp", 33648: "mirror"}
_NEAREST = 9728
_FILTERS = (None, 9728, 9729)


class Textures:
    """The textures that materials ask for, each made once; images are decoded once."""

    def __init__(self, document: Document, buffers: Buffers) -> None:
        self._document, self._buffers = document, buffers
        self._images: dict[int, Bytes] = {}
        self._numbers: dict[int, int | None] = {}
        self._made: list[Texture] = []
        self._pixels = 0

    def number(self, index: int, path: str) -> int | None:
        """Return which of the scene's textures shows textures[index]; None if none can."""
        texture = item(self._document.gltf.textures, index, "textures", path)
        if index not in self._numbers:
            self._numbers[index] = self._make(texture, f"textures[{index}]")
        return self._numbers[index]

    def check(self, index: int, path: str) -> None:
        """Raise InvalidScene if there is no textures[index]."""
        item(self._document.gltf.textures, index, "textures", path)

    def all(self) -> tuple[Texture, ...]:
        """Return the textures made so far."""
        return tuple(self._made)

    def _make(self, texture: pygltflib.Texture, path: str) -> int | None:
        journal = self._document.journal
        note_unsupported(texture, path, journal)
        webp = extension(TextureSource, "EXT_texture_webp", texture, path)
        source = texture.source if webp is None or webp.source is None else webp.source
        if source is None:
            journal.note("has no image that can be read and is left out", path)
            return None
        texels = self._image(source, path)
        sampler = pygltflib.Sampler()
        if texture.sampler is not None:
            sampler = item(
                self._document.gltf.samplers, texture.sampler, "samplers", f"{path}.sampler"
            )
        here = f"samplers[{texture.sampler}]"
        if sampler.magFilter not in _FILTERS:
            raise InvalidScene(f"{sampler.magFilter} is unknown", f"{here}.magFilter")
        self._made.append(
            Texture(
                texels,
                wrap_u=_wrap(sampler.wrapS, f"{here}.wrapS"),
                wrap_v=_wrap(sampler.wrapT, f"{here}.wrapT"),
                nearest=sampler.magFilter == _NEAREST,
                name=texture.name or "",
            )
        )
        return len(self._made) - 1

    def _image(self, index: int, path: str) -> Bytes:
        image = item(self._document.gltf.images, index, "images", f"{path}.source")
        if index not in self._images:
            limits = self._document.limits
            here = f"images[{index}]"
            texels = decode_image(self._bytes(image, here), limits.max_texture_pixels, here)
            self._pixels += texels.shape[0] * texels.shape[1]
            if self._pixels > limits.max_scene_texture_pixels:
                largest = limits.max_scene_texture_pixels
                raise LimitExceeded(f"all images have more than {largest:,} pixels", here)
            texels.setflags(write=False)
            self._images[index] = texels
        return self._images[index]

    def _bytes(self, image: pygltflib.Image, path: str) -> bytes | memoryview:
        if image.bufferView is not None:
            return self._buffers.view(image.bufferView, f"{path}.bufferView")
        if image.uri is None:
            raise InvalidScene("has neither uri nor bufferView", path)
        return read_uri(image.uri, self._document, f"{path}.uri")


def _wrap(code: int, path: str) -> Wrap:
    if code not in _WRAPS:
        raise InvalidScene(f"{code} is unknown", path)
    return _WRAPS[code]
