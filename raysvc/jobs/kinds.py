"""The two kinds of things that are stored, and how their files become them."""

import functools

from raysvc.errors import InvalidEnvironment, InvalidScene
from raysvc.jobs.store import Kind, Upload
from raysvc.jobs.summary import environment_bytes, environment_summary, scene_bytes, scene_summary
from raysvc.limits import Limits
from raysvc.loading import load_environment, load_scene
from raysvc.loading.files import ARCHIVE_SUFFIX, Files
from raysvc.scene import Environment, Scene


def scene_kind(limits: Limits) -> Kind[Scene]:
    """Scenes: one file, several with side files, or an archive of them."""
    return Kind(
        name="scene",
        load=functools.partial(load_scene, limits=limits),
        open=functools.partial(_open_scene, limits=limits),
        summarise=scene_summary,
        weigh=scene_bytes,
    )


def environment_kind(limits: Limits) -> Kind[Environment]:
    """Environments: one file."""
    return Kind(
        name="environment",
        load=functools.partial(load_environment, limits=limits),
        open=functools.partial(_open_environment, limits=limits),
        summarise=environment_summary,
        weigh=environment_bytes,
    )


def _open_scene(upload: Upload, limits: Limits) -> Files:
    if not upload.files:
        raise InvalidScene("no file was sent", field="file")
    if len(upload.files) == 1:
        ((name, data),) = upload.files.items()
        if name.lower().endswith(ARCHIVE_SUFFIX):
            return Files.from_zip(data, limits)
    return Files.from_memory(upload.files, upload.main, limits)


def _open_environment(upload: Upload, limits: Limits) -> Files:
    if len(upload.files) != 1:
        raise InvalidEnvironment(f"needs one file, got {len(upload.files)}", field="file")
    return Files.from_memory(upload.files, next(iter(upload.files)), limits)
