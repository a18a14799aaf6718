"""Why a job failed, as the text that outlives the process."""

import json

from raysvc import errors


def error_text(error: errors.RaysvcError) -> str:
    """Return JSON of what an error says; it will be of the nearest kind that raysvc names."""
    kind = next(kind for kind in type(error).__mro__ if kind.__module__ == errors.__name__)
    values = {
        "kind": kind.__name__,
        "message": error.message,
        "field": error.field,
        "retryable": error.retryable,
    }
    return json.dumps(values)


def error_from(text: str) -> errors.RaysvcError:
    """Return the error that a text was made of."""
    values = json.loads(text)
    kind = getattr(errors, values["kind"], errors.RaysvcError)
    error: errors.RaysvcError = kind.__new__(kind)
    errors.RaysvcError.__init__(error, values["message"], values["field"])
    error.retryable = values["retryable"]
    return error
