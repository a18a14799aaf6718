"""A frame in the making."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from raysvc.frame.points import Points
from raysvc.frame.prepared import Prepared
from raysvc.frame.primary import CHUNK
from raysvc.frame.probe import Probe
from raysvc.frame.radiance import Illumination
from raysvc.frame.reflections import Reflection, Transmission
from raysvc.frame.secondary_rays import SecondaryRays
from raysvc.frame.settings import Settings
from raysvc.frame.shadows import AreaShadow
from raysvc.frame.statistics import Ledger
from raysvc.lens.slices import Slices
from raysvc.parallel import Control, map_chunks
from raysvc.scene import Camera, Environment
from raysvc.tracing.gloss import GlossPicture
from raysvc.tracing.neighbours import Neighbours
from raysvc.types import Bools, Floats, Ints, Longs


@dataclass(slots=True, eq=False)
class Draft:
    """A frame in the making. Stages fill it from top to bottom; N points, H x W pixels."""

    prepared: Prepared
    camera: Camera
    settings: Settings
    control: Control
    ledger: Ledger
    illumination: Illumination
    rays: SecondaryRays
    environment: Environment
    probe: Probe | None = None
    """From where the scene is captured for glossy surfaces."""
    shown: Bools | None = None
    """(F,) triangles that the camera sees; None is all."""
    points: Points = field(init=False)
    front: Longs = field(init=False)
    """(H * W,) which point stands for a pixel in the layers, or -1."""
    hidden: Bools = field(init=False)
    """(N,) which points only a lens shows: those behind the front have no part in the pixel."""
    slices: Slices | None = None
    """What is blurred together; None where nothing is."""
    uncovered: Bools | None = None
    """(H * W,) pixels behind which the lens may see; None where there is no lens."""
    direct: Floats = field(init=False)
    """(N, 3) radiance that the points return of lights."""
    shadows: list[AreaShadow] = field(default_factory=list)
    depth_step: Floats = field(init=False)
    """(N,) metres that depth may change from a pixel to the next on a point's surface."""
    neighbours: Neighbours = field(init=False)
    """The points in front, told apart by their shading normals."""
    ambient: Floats = field(init=False)
    """(N, 10) columns of an `Ambient`."""
    reflection: Reflection = field(init=False)
    transmission: Transmission = field(init=False)
    grainy: Bools = field(init=False)
    """(N,) points whose lobes are too narrow to share rays, and too wide for one to tell."""
    gloss: GlossPicture = field(init=False)
    """What rays into the lobes of rough mirrors have brought."""
    frost: GlossPicture | None = None
    """What rays through glass have brought; None where there is no glass."""
    radiance: Floats = field(init=False)
    """(N, 3) that leaves the points."""
    beauty: Floats = field(init=False)
    """(H, W, 4) premultiplied linear RGBA."""
    layers: dict[str, NDArray[Any]] = field(default_factory=dict)

    @property
    def shape(self) -> tuple[int, int]:
        """H, W."""
        return self.camera.height, self.camera.width

    def part_of_triangle(self) -> Ints:
        """(F,) int32 number of the object and material of each triangle of the scene."""
        scene = self.prepared.scene
        part = scene.object_of_triangle * len(scene.materials) + scene.material_of_triangle
        return part.astype(np.int32)

    def picture(self, values: NDArray[Any], empty: float) -> NDArray[Any]:
        """Lay out values (N, ...) of the points in front as a picture (H, W, ...)."""
        seen = self.front >= 0
        picture = np.full((len(seen), *values.shape[1:]), empty, values.dtype)
        picture[seen] = values[self.front[seen]]
        return picture.reshape(*self.shape, *values.shape[1:])

    def each(
        self, work: Callable[[int, int], Floats], stage: str, channels: tuple[int, ...]
    ) -> Floats:
        """Join what `work` makes of chunks of the points: (N, *channels)."""
        parts = map_chunks(len(self.points.pixel), CHUNK, work, self.control, stage)
        return np.concatenate(parts) if parts else np.zeros((0, *channels), np.float32)
