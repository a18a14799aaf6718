"""Finished pictures and comparisons by the name of their request: in memory, and on the disk."""

from raysvc.compare.result import Comparison
from raysvc.frame.settings import Settings
from raysvc.jobs.disk_budget import DiskCounts
from raysvc.jobs.kept_comparison import comparison_from, comparison_record
from raysvc.jobs.kept_picture import KeptPicture, KeptStatistics
from raysvc.jobs.lru import Counts, LeastRecentlyUsed
from raysvc.jobs.renderer import Picture
from raysvc.jobs.requests import ComparisonRequest, RenderRequest
from raysvc.jobs.result_folder import ResultFolder
from raysvc.jobs.scene_comparer import comparison_bytes


class Results:
    """What was finished, within three budgets; what was not asked for longest makes room.

    What is put is on the disk when `put` returns, and is found again by another process.
    """

    def __init__(
        self, folder: ResultFolder, picture_memory_bytes: int, comparison_memory_bytes: int
    ) -> None:
        self._folder = folder
        self._pictures: LeastRecentlyUsed[Picture] = LeastRecentlyUsed(
            picture_memory_bytes, picture_bytes
        )
        self._comparisons: LeastRecentlyUsed[Comparison] = LeastRecentlyUsed(
            comparison_memory_bytes, comparison_bytes
        )

    def put_picture(self, request: RenderRequest, picture: Picture) -> None:
        """Keep a picture. Raises StorageFull."""
        about = {
            "statistics": picture.statistics.to_dict(),
            "settings": request.settings.model_dump(mode="json"),
        }
        self._folder.put(request.name, about, picture.layers)
        self._pictures.put(request.name, picture)

    def picture(self, request: RenderRequest) -> Picture | None:
        """Return a picture if it is still kept."""
        held = self._pictures.get(request.name)
        if held is not None:
            self._folder.touch(request.name)
            return held
        kept = self._folder.get(request.name)
        if kept is None:
            return None
        about, layers = kept
        settings = Settings.model_validate(about["settings"])
        picture = KeptPicture(layers, KeptStatistics(about["statistics"]), settings)
        self._pictures.put(request.name, picture)
        return picture

    def has_picture(self, request: RenderRequest) -> bool:
        """Is a picture kept, in memory or on the disk?"""
        return request.name in self._pictures or self._folder.touch(request.name)

    def put_comparison(self, request: ComparisonRequest, comparison: Comparison) -> None:
        """Keep a comparison. Raises StorageFull."""
        self._folder.put(request.name, *comparison_record(comparison))
        self._comparisons.put(request.name, comparison)

    def comparison(self, request: ComparisonRequest) -> Comparison | None:
        """Return a comparison if it is still kept."""
        held = self._comparisons.get(request.name)
        if held is not None:
            self._folder.touch(request.name)
            return held
        kept = self._folder.get(request.name)
        if kept is None:
            return None
        comparison = comparison_from(*kept)
        self._comparisons.put(request.name, comparison)
        return comparison

    @property
    def picture_counts(self) -> Counts:
        """How often pictures were held in memory when they were asked for."""
        return self._pictures.counts

    @property
    def comparison_counts(self) -> Counts:
        """The same of comparisons."""
        return self._comparisons.counts

    @property
    def disk_counts(self) -> DiskCounts:
        """What made room on the disk, and what pictures and comparisons take there."""
        return self._folder.counts


def picture_bytes(picture: Picture) -> int:
    """Memory that a picture's layers take."""
    return sum(layer.nbytes for layer in picture.layers.values())
