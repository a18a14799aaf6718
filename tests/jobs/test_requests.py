"""What makes two requests one."""

from dataclasses import replace

from raysvc.frame.probe import Probe
from tests.jobs.requests import request


def test_a_probe_is_part_of_a_request_s_name() -> None:
    plain = request()
    probes = [
        Probe(probe_at=(0, 0, 0)),
        Probe(probe_at=(0, 0, 1)),
        Probe(probe_at=(0, 0, 0), size=64),
        Probe(probe_at=(0, 0, 0), without=()),
        Probe(probe_at=(0, 0, 0), without=(1,)),
        Probe(probe_at=(0, 0, 0), without=("1",)),
    ]
    names = {plain.name, *(replace(plain, probe=probe).name for probe in probes)}
    assert len(names) == 1 + len(probes)
    again = replace(plain, probe=Probe.model_validate({"probe_at": [0, 0, 1.0]}))
    assert again.name in names
