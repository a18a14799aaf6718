"""Fixtures for all tests: seeded randomness, and the real assets beside the checkout."""

import os
from pathlib import Path

import numpy as np
import pytest


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20091123)


def _assets_dir() -> Path | None:
    chosen = os.environ.get("RAYSVC_ASSETS")
    folder = Path(chosen) if chosen else Path(__file__).resolve().parents[2] / "shared" / "assets"
    return folder if (folder / "INDEX.tsv").is_file() else None


@pytest.fixture(scope="session")
def assets() -> Path:
    """Folder of real scenes and environments; see RAYSVC_ASSETS."""
    folder = _assets_dir()
    if folder is None and os.environ.get("RAYSVC_REQUIRE_ASSETS"):
        pytest.fail("RAYSVC_REQUIRE_ASSETS is set, and there are no assets; see RAYSVC_ASSETS")
    if folder is None:
        pytest.skip("no assets beside the checkout; set RAYSVC_ASSETS")
    return folder


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--regenerate-golden",
        action="store_true",
        help="write the golden pictures anew instead of comparing with them",
    )
