"""Everything that raysvc raises on purpose.

RaysvcError
  + InvalidInput            the caller sent something wrong; names the field
  |   - InvalidScene        a scene file that is broken or lies
  |   - InvalidEnvironment  the same for an environment map
  |   - InvalidSetting      a camera, setting or parameter out of its range, or unknown
  |   - Unsupported         correct, and required, but not something that raysvc can do
  |   - LimitExceeded       larger than the limits allow
  |   - IdempotencyKeyReused  a key that stands for another request
  + NotFound                no such scene, environment, render
  + NotFinished             there will be a picture, but not yet
  + Gone                    there was a picture, and it is no longer kept
  + Unavailable             a part of raysvc that this machine cannot run
  + NotAuthenticated        a key is needed, and none or no good one was sent
  + NotAllowed              the key is good, but not for this
  + ForeignPage             a page of another origin made a browser send it
  + Unreachable             no service answers there
  + QueueFull               try again later
  + Busy                    accepted, and its turn did not come in time
  + InUse                   jobs are going to need it
  + Draining                the service is about to end and takes no more work
  + StorageFull             the disk has no room
  + FolderInUse             another process keeps its data there
  + Crashed                 the work has ended the process again and again
  + Cancelled               the caller asked to stop
  + DeadlineExceeded        the work took longer than it was given
"""


class RaysvcError(Exception):
    """Root of the tree. `field` names what was wrong, in the caller's words, or is None."""

    retryable = False

    def __init__(self, message: str, field: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.field = field

    def __str__(self) -> str:
        return f"{self.field}: {self.message}" if self.field else self.message


class InvalidInput(RaysvcError):
    """The caller sent something wrong."""


class InvalidScene(InvalidInput):
    """A scene file that is broken, incomplete or contradicts itself."""


class InvalidEnvironment(InvalidInput):
    """An environment map that cannot be read as a picture of all directions."""


class InvalidSetting(InvalidInput):
    """A camera, setting or parameter that is unknown or out of its range."""


class Unsupported(InvalidInput):
    """Correct input that requires something raysvc does not do."""


class LimitExceeded(InvalidInput):
    """Input larger than the configured limits."""


class IdempotencyKeyReused(InvalidInput):
    """An idempotency key that was sent with another request before."""


class NotFound(RaysvcError):
    """Nothing has that name."""


class NotFinished(RaysvcError):
    """The job has no picture: it is waiting or running (then retry), or it ended without one."""

    def __init__(self, message: str, field: str | None = None, *, retryable: bool = False) -> None:
        super().__init__(message, field)
        self.retryable = retryable


class Gone(RaysvcError):
    """The picture made room for newer ones; the same request makes it again."""


class Unavailable(RaysvcError):
    """A part of raysvc that this machine cannot run, and why."""


class NotAuthenticated(RaysvcError):
    """The service wants a key, and none came with the request, or one that it does not know."""


class NotAllowed(RaysvcError):
    """The key that came with the request does not reach as far as this."""

    def __init__(self, message: str, field: str | None = None, *, scope: str | None = None) -> None:
        super().__init__(message, field)
        self.scope = scope
        """What the key would have to be for."""


class ForeignPage(RaysvcError):
    """A page of an origin that may not call the service made a browser send this."""


class Unreachable(RaysvcError):
    """No service answers at an address, or what answers is none."""

    retryable = True


class QueueFull(RaysvcError):
    """More work is waiting than the queue may hold."""

    retryable = True

    def __init__(self, message: str, retry_after_s: float) -> None:
        super().__init__(message)
        self.retry_after_s = retry_after_s


class Busy(RaysvcError):
    """What was asked for waited in the line for as long as it may, and was given up."""

    retryable = True

    def __init__(self, message: str, retry_after_s: float) -> None:
        super().__init__(message)
        self.retry_after_s = retry_after_s


class InUse(RaysvcError):
    """It cannot go yet: jobs that wait or run are going to read it."""

    retryable = True


class Draining(RaysvcError):
    """The service finishes what it has begun and takes no more work."""

    retryable = True


class StorageFull(RaysvcError):
    """There is no room on the disk for what has to be kept."""

    retryable = True


class FolderInUse(RaysvcError):
    """Another process keeps its data in the same folder."""


class Crashed(RaysvcError):
    """The process ended while it did this work, as often as it may be tried."""


class Cancelled(RaysvcError):
    """The caller asked for the work to stop."""


class DeadlineExceeded(RaysvcError):
    """The work took longer than its deadline."""

    retryable = True
