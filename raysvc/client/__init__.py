"""A client of the HTTP service, for Python.

    from raysvc.client import Client

    with Client("http://127.0.0.1:8000", key="raysvc_...") as client:
        scene = client.scenes.add("helmet.glb")
        render = client.renders.make(scene.id, camera={"width": 800, "height": 450})
        picture = client.renders.image(render.id, "png")

What goes wrong is raised as the same exceptions as where raysvc itself does the work
(`raysvc.errors`). Names are those of the HTTP interface.

    client.py        Client: everything below at one address
    stored.py        scenes and environments
    jobs.py          what renders.py and comparisons.py (of acceleration structures) share
    following.py     hearing how far a job is, and waiting for it
    resources.py     what the service answers with
    scene_files.py   a scene's file and those that it refers to
    connection.py    requests, repeated where that does no harm
    problems.py      from problems to exceptions
"""

from raysvc.client.client import Client
from raysvc.client.resources import Job, Stored

__all__ = ["Client", "Job", "Stored"]
