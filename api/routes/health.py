"""For whoever watches over the process."""

from fastapi import APIRouter, Response

from api.context import ContextDep
from api.responses import SafeJSONResponse
from api.schemas import Health

router = APIRouter(tags=["health"])


@router.get("/healthz", responses={200: {"model": Health}})
async def healthz() -> Response:
    """The process lives."""
    return SafeJSONResponse({"status": "ok"})


@router.get("/readyz", responses={200: {"model": Health}, 503: {"model": Health}})
async def readyz(context: ContextDep) -> Response:
    """The first render would not wait for the compiler, and the service is not draining."""
    reason = context.service.not_ready
    return SafeJSONResponse({"status": reason or "ready"}, 503 if reason else 200)
