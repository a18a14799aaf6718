"""Pictures as they were when somebody last looked at them and found them right.

`python3 dev.py test tests/golden --regenerate-golden` writes them anew: look at each before you
commit it. A picture that differs leaves itself, its reference and their difference in
tests/golden/diffs/.
"""

import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.golden.subjects import SUBJECTS

HERE = Path(__file__).parent
REFERENCES = HERE / "references"
DIFFS = HERE / "diffs"
LEAST_PSNR_DB = 38.0
"""Another processor may round differently and move a few pixels; another method moves many."""


def read(path: Path) -> np.ndarray:
    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB"))


def psnr_db(a: np.ndarray, b: np.ndarray) -> float:
    error = np.mean((a.astype(np.float64) - b) ** 2)
    return float(np.inf if error == 0 else 10 * np.log10(255.0**2 / error))


@pytest.mark.parametrize("name", SUBJECTS)
def test_a_picture_looks_as_it_did(name: str, pytestconfig: pytest.Config) -> None:
    picture = SUBJECTS[name].render().display()[..., :3]
    path = REFERENCES / f"{name}.png"
    if pytestconfig.getoption("--regenerate-golden"):
        if os.environ.get("CI"):
            pytest.fail("golden pictures are not regenerated where nobody looks at them")
        Image.fromarray(picture).save(path, optimize=True)
        return
    reference = read(path)
    assert reference.shape == picture.shape
    likeness = psnr_db(picture, reference)
    if likeness < LEAST_PSNR_DB:
        DIFFS.mkdir(exist_ok=True)
        difference = np.clip(np.abs(picture.astype(int) - reference) * 8, 0, 255).astype(np.uint8)
        Image.fromarray(np.hstack([picture, reference, difference])).save(DIFFS / f"{name}.png")
    assert likeness >= LEAST_PSNR_DB, f"see {DIFFS.name}/{name}.png: picture, reference, 8 x error"


def test_every_reference_has_a_subject_and_every_subject_a_reference() -> None:
    assert {path.stem for path in REFERENCES.glob("*.png")} == set(SUBJECTS)


def test_references_are_small() -> None:
    for path in REFERENCES.glob("*.png"):
        height, width, _ = read(path).shape
        assert width <= 96 and height <= 64


def test_the_likeness_tells_a_shifted_picture_from_the_same_one() -> None:
    reference = read(REFERENCES / "still_life.png")
    assert psnr_db(reference, reference) == np.inf
    assert psnr_db(np.roll(reference, 1, axis=1), reference) < LEAST_PSNR_DB
