"""The two kinds of things that are stored, and how their files become them."""

from raysvc.jobs.store import Kind, Upload
from raysvc.jobs.summary import environment_bytes, environment_summary, scene_bytes, scene_summary
from raysvc.loading import load_environment, load_scene
from raysvc.parsing import Parser
from raysvc.scene import Environment, Scene


def scene_kind(parser: Parser) -> Kind[Scene]:
    """Scenes: one file, several with side files, or an archive of them."""

    def load(source: str | Upload) -> Scene:
        if isinstance(source, str):
            return load_scene(source)
        return parser.scene(source.files, source.main)

    return Kind(name="scene", load=load, summarise=scene_summary, weigh=scene_bytes)


def environment_kind(parser: Parser) -> Kind[Environment]:
    """Environments: one file."""

    def load(source: str | Upload) -> Environment:
        if isinstance(source, str):
            return load_environment(source)
        return parser.environment(source.files)

    return Kind(
        name="environment", load=load, summarise=environment_summary, weigh=environment_bytes
    )
