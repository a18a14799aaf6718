"""A picture as it is kept on the disk, and as it comes back."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from raysvc.frame.frame import encode_layers
from raysvc.frame.settings import Settings


@dataclass(frozen=True, slots=True)
class KeptStatistics:
    """How a picture came about, as it was said then."""

    values: Mapping[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """Ready for JSON."""
        return dict(self.values)


@dataclass(frozen=True, slots=True, eq=False)
class KeptPicture:
    """Layers, and how they are shown: encodes to the same bytes as the frame that they are of."""

    layers: Mapping[str, NDArray[Any]]
    statistics: KeptStatistics
    settings: Settings

    def encode(self, format: str, layer: str | None = None) -> bytes:
        """Return a file, as `raysvc.frame.frame.Frame.encode` does."""
        return encode_layers(self.layers, self.settings, format, layer)
