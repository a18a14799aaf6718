"""The acceleration structures that there are."""

from fastapi import APIRouter, Response

from api.responses import SafeJSONResponse
from api.routes.stored import PROBLEM_RESPONSES
from api.schemas import StructureList, structure_resource
from raysvc.accel.registry import STRUCTURES

router = APIRouter(prefix="/v1/structures", tags=["structures"], responses=PROBLEM_RESPONSES)


@router.get("", responses={200: {"model": StructureList}})
async def list_structures() -> Response:
    """The registry: names, whether this machine can run them and why not, parameters."""
    structures = [structure_resource(name, entry) for name, entry in STRUCTURES.items()]
    return SafeJSONResponse(StructureList(structures=structures).model_dump(mode="json"))
