"""What each pixel's ray costs: node steps and triangle tests."""

from dataclasses import dataclass

import numpy as np

from raysvc.accel.base import Rays
from raysvc.compare.contenders import Contender
from raysvc.parallel import Control
from raysvc.scene import Camera
from raysvc.types import Floats


@dataclass(frozen=True, slots=True, eq=False)
class HeatMap:
    """Costs of a camera's nearest-hit rays, (H, W) float32 each, row 0 at the top."""

    node_steps: Floats
    triangle_tests: Floats


def heat_map(contender: Contender, camera: Camera, control: Control) -> HeatMap | None:
    """Count for every pixel; None for a structure that does not show what it does."""
    count = camera.width * camera.height
    origins, directions = camera.rays(np.arange(count))
    rays = Rays(origins, directions, np.full(count, np.inf, np.float32))
    counters = contender.count(rays, "nearest", control)
    if counters is None:
        return None
    shape = (camera.height, camera.width)
    return HeatMap(
        counters.node_steps.reshape(shape).astype(np.float32),
        counters.triangle_tests.reshape(shape).astype(np.float32),
    )
