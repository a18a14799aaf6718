import importlib

import pytest

PACKAGES = [
    "raysvc",
    "raysvc.access",
    "raysvc.builtin",
    "raysvc.client",
    "raysvc.jobs",
    "raysvc.loading",
    "raysvc.scene",
]


@pytest.mark.parametrize("package", PACKAGES)
def test_what_is_exported_is_listed_and_there(package: str) -> None:
    module = importlib.import_module(package)
    listed = list(module.__all__)
    assert listed == sorted(listed, key=str.lower) or listed == sorted(listed)
    assert len(set(listed)) == len(listed)
    for name in listed:
        assert getattr(module, name) is not None
