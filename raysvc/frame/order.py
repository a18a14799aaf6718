"""In which order the stages of a frame run.

    hybrid      rasterise -> peel -> layers -> shadows -> occlusion -> probe -> reflections -> light
                -> edges -> lens
    reference   rasterise -> layers -> paths

Every stage is timed by the caller.
"""

from typing import Final

from raysvc.frame.antialias import antialias
from raysvc.frame.defocus import defocus
from raysvc.frame.paths import paths
from raysvc.frame.peel import peel
from raysvc.frame.probe_capture import probe
from raysvc.frame.shared_rays import trace_beyond
from raysvc.frame.stages import light, occlusion, rasterise, shadows, write_layers

STAGES: Final = {
    "hybrid": (
        ("rasterise", rasterise),
        ("peel", peel),
        ("layers", write_layers),
        ("shadows", shadows),
        ("occlusion", occlusion),
        ("probe", probe),
        ("reflections", trace_beyond),
        ("light", light),
        ("edges", antialias),
        ("lens", defocus),
    ),
    "reference": (
        ("rasterise", rasterise),
        ("layers", write_layers),
        ("paths", paths),
    ),
}
"""What is done in each mode, in order."""
