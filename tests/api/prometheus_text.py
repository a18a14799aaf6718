"""The slow and strict twin of api.exposition: reads Prometheus's text format back.

https://prometheus.io/docs/instrumenting/exposition_formats/
"""

import re

Samples = dict[tuple[str, frozenset[tuple[str, str]]], float]

_NAME = r"[a-zA-Z_:][a-zA-Z0-9_:]*"
_LABEL = re.compile(r'([a-zA-Z_][a-zA-Z0-9_]*)="((?:[^"\\\n]|\\\\|\\"|\\n)*)"')
_SAMPLE = re.compile(rf"({_NAME})(?:\{{(.*)\}})? (\+Inf|-?[0-9.e+-]+)")
_UNESCAPED = {r"\\": "\\", r"\"": '"', r"\n": "\n"}


def samples_of(text: str) -> Samples:
    """Every sample; fails on what Prometheus would refuse."""
    assert text.endswith("\n")
    samples: Samples = {}
    types: dict[str, str] = {}
    for line in text.splitlines():
        if line.startswith("# HELP "):
            assert re.fullmatch(rf"# HELP {_NAME} .+", line), line
        elif line.startswith("# TYPE "):
            found = re.fullmatch(rf"# TYPE ({_NAME}) (counter|gauge|histogram)", line)
            assert found, line
            assert found[1] not in types, line
            types[found[1]] = found[2]
        else:
            found = _SAMPLE.fullmatch(line)
            assert found, line
            name, inner, value = found.groups()
            labels = _LABEL.findall(inner or "")
            assert ",".join(f'{key}="{shown}"' for key, shown in labels) == (inner or ""), line
            family = re.sub(r"_(bucket|sum|count)$", "", name)
            assert types.get(name) in ("counter", "gauge") or types.get(family) == "histogram", line
            key = (name, frozenset((k, _unescape(v)) for k, v in labels))
            assert key not in samples, line
            samples[key] = float(value.replace("Inf", "inf"))
    return samples


def _unescape(text: str) -> str:
    return re.sub(r"\\.", lambda found: _UNESCAPED[found[0]], text)


def value(samples: Samples, name: str, **labels: str) -> float:
    """One sample; 0 where it was never counted."""
    return samples.get((name, frozenset(labels.items())), 0.0)
