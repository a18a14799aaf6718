"""Draws docs/images/deforming.png by running the example of docs/deforming.md.

Run from the root of the repository: python -m docs.make_deforming_picture
"""

import os
import re
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

PAGE = Path(__file__).with_name("deforming.md")
COLUMNS = 4


def main() -> None:
    """Run the page's first example, and lay its frames out in rows."""
    example = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[0]
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            exec(compile(example, PAGE.name, "exec"), {})
            frames = [np.asarray(Image.open(path)) for path in sorted(Path().glob("*.png"))]
        finally:
            os.chdir(here)
    rows = [np.hstack(frames[at : at + COLUMNS]) for at in range(0, len(frames), COLUMNS)]
    sheet = Image.fromarray(np.vstack(rows))
    sheet.save(PAGE.parent / "images" / "deforming.png", optimize=True)


if __name__ == "__main__":
    main()
