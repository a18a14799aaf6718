import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PYTHON_FILES = [
    *(ROOT / "raysvc").rglob("*.py"),
    *(ROOT / "api").rglob("*.py"),
    *(ROOT / "tests").rglob("*.py"),
    ROOT / "dev.py",
]
LONGEST_FILE = 400


def test_dependencies_fall_as_pyproject_says() -> None:
    linter = Path(sys.executable).with_name("lint-imports")
    done = subprocess.run(
        [linter, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("path", PYTHON_FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_file_holds_one_idea(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= LONGEST_FILE


@pytest.mark.parametrize("folder", ["raysvc", "api"])
def test_no_package_is_called_after_nothing(folder: str) -> None:
    vague = {
        "utils",
        "util",
        "common",
        "helpers",
        "helper",
        "core",
        "misc",
        "manager",
        "base_utils",
    }
    names = {path.stem for path in (ROOT / folder).rglob("*.py")}
    assert not names & vague


def test_modules_outside_the_doorways_do_not_compile_kernels() -> None:
    """`raysvc.jit` is the only place that knows Numba's options."""
    importers = [
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "raysvc").rglob("*.py")
        if "import numba" in path.read_text(encoding="utf-8")
    ]
    assert importers == ["raysvc/jit.py"]
