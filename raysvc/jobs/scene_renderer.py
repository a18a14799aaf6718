"""The renderer that a service uses: from names in the stores to a frame."""

from raysvc.frame.frame import Frame
from raysvc.frame.render import render
from raysvc.frame.warm_up import warm_up
from raysvc.jobs.requests import RenderRequest
from raysvc.jobs.store import ContentStore
from raysvc.limits import Limits
from raysvc.parallel import Control
from raysvc.scene import Environment, Scene


class SceneRenderer:
    """Looks scene and environment up and renders them."""

    def __init__(
        self,
        scenes: ContentStore[Scene],
        environments: ContentStore[Environment],
        limits: Limits,
    ) -> None:
        self._limits = limits
        self._scenes = scenes
        self._environments = environments

    def warm_up(self) -> None:
        """Compile the kernels, or load them from the cache, by rendering something small."""
        warm_up()

    def render(self, request: RenderRequest, control: Control) -> Frame:
        """Make the picture. Raises InvalidInput, Cancelled, DeadlineExceeded, NotFound."""
        scene = self._scenes.get(request.scene)
        environment = None
        if request.environment is not None:
            environment = self._environments.get(request.environment)
        probe = request.probe
        around = None if probe is None else {**probe.model_dump(), "environment": environment}
        return render(
            scene,
            environment if around is None else around,
            request.camera,
            request.settings,
            control=control,
            limits=self._limits,
        )
