"""What Prometheus asks for."""

from fastapi import APIRouter, Response
from prometheus_client import CONTENT_TYPE_PLAIN_0_0_4

from api.context import ContextDep
from api.routes.stored import PROBLEM_RESPONSES

router = APIRouter(tags=["health"], responses=PROBLEM_RESPONSES)


@router.get(
    "/metrics",
    response_class=Response,
    responses={200: {"content": {"text/plain": {}}, "description": "Prometheus text format"}},
)
async def metrics(context: ContextDep) -> Response:
    """Counts and times since the service started, in Prometheus's text format."""
    return Response(
        context.metrics.text(),
        headers={"Content-Type": CONTENT_TYPE_PLAIN_0_0_4, "Cache-Control": "no-store"},
    )
