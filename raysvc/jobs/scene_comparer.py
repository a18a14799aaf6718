"""The measurements that a service makes: from a name in the store to a comparison."""

from raysvc.compare.compare import compare
from raysvc.compare.result import Comparison
from raysvc.jobs.requests import ComparisonRequest
from raysvc.jobs.store import ContentStore
from raysvc.limits import Limits
from raysvc.loading.scene_file import BUILTIN_PREFIX
from raysvc.parallel import Control
from raysvc.scene import Scene


class SceneComparer:
    """Looks a scene up and measures structures on it."""

    def __init__(self, scenes: ContentStore[Scene], limits: Limits) -> None:
        self._scenes, self._limits = scenes, limits

    def compare(self, request: ComparisonRequest, control: Control) -> Comparison:
        """Measure. Raises InvalidInput, Unavailable, Cancelled, DeadlineExceeded, NotFound."""
        record = self._scenes.record(request.scene)
        source = record.id if record.builtin is None else BUILTIN_PREFIX + record.builtin
        return compare(
            self._scenes.get(request.scene),
            request.settings,
            source=source,
            control=control,
            limits=self._limits,
        )


def comparison_bytes(comparison: Comparison) -> int:
    """Memory that a comparison takes, nearly all of it heat maps."""
    maps = comparison.heat_maps.values()
    return 4096 + sum(m.node_steps.nbytes + m.triangle_tests.nbytes for m in maps)
