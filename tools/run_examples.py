"""Run the examples and the first pages, and keep what they print and draw for the documentation: docs/examples/.

python tools/run_examples.py [NAME ...]        # a minute or two for all
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("[0-9]*.py"))
SHOWN = ROOT / "docs" / "examples"
START = {"start_map": ("map.md", "hall-plan.png"), "start_arm": ("arm.md", "desk.png")}
"""Picture -> the page below docs/start that draws it, and under which name."""
WIDTH = 1000
ANEW = "python tools/run_examples.py keeps it anew"
COLOURS = 256
LEGEND, TIMES = 48, 12
"""Height of a picture's legend [pixels], and how often it counts when colours are chosen."""


def keep(picture: Path, name: str) -> None:
    """Keep a picture of an example, small enough for a page; a moving one as it is, for the README, too."""
    if picture.suffix == ".gif":
        shutil.copy(picture, SHOWN.parent / picture.name)
        return
    image = Image.open(picture).convert("RGB")
    if image.width > WIDTH:
        image = image.resize((WIDTH, round(image.height * WIDTH / image.width)), Image.Resampling.LANCZOS)
    # A legend is small: its colours are kept only where it counts more than once.
    legend = image.crop((0, image.height - LEGEND, image.width, image.height))
    weighed = Image.new("RGB", (image.width, image.height + TIMES * LEGEND))
    weighed.paste(image)
    for i in range(TIMES):
        weighed.paste(legend, (0, image.height + i * LEGEND))
    palette = weighed.quantize(COLOURS)
    image.quantize(palette=palette, dither=Image.Dither.NONE).save(SHOWN / f"{name}.png", optimize=True)


def missing(script: Path) -> list[str]:
    """Return the packages of extras that an example needs and that are not installed."""
    return [name for name in re.findall(r"extra `(\w+)`", script.read_text()) if find_spec(name) is None]


def words(text: str) -> set[str]:
    """Return the words of what was printed, without the figures, which other processors round otherwise."""
    return set(re.findall(r"[a-z]{3,}", text))


def shown(script: Path) -> set[str]:
    """Return the words of what is kept of an example."""
    return words((SHOWN / f"{script.stem}.txt").read_text())


def run_example(script: Path) -> None:
    """Run an example in a folder of its own, and keep what it prints and the last picture that it draws."""
    with tempfile.TemporaryDirectory() as folder:
        ran = subprocess.run([sys.executable, script], cwd=folder, capture_output=True, text=True, check=True)
        (SHOWN / f"{script.stem}.txt").write_text(ran.stdout)
        pictures = [*Path(folder).rglob("*.png"), *Path(folder).rglob("*.gif")]
        for picture in sorted(pictures, key=lambda each: each.stat().st_mtime)[-1:]:
            keep(picture, script.stem)


def run_start(name: str) -> None:
    """Run the code of a page, and keep the picture that it draws."""
    import run_pages

    page, picture = START[name]
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for _ in run_pages.run_page(ROOT / "docs" / "start" / page):
            pass
        keep(Path(picture), name)
        os.chdir(before)


def main() -> None:
    """Run those that are named, or all."""
    SHOWN.mkdir(exist_ok=True)
    wanted = sys.argv[1:]
    for script in EXAMPLES:
        if lacking := missing(script):
            print(f"{script.stem}: left as it is, for want of {', '.join(lacking)}")
        elif not wanted or script.stem in wanted:
            print(script.stem, flush=True)
            run_example(script)
    for name in START:
        if not wanted or name in wanted:
            print(name, flush=True)
            run_start(name)


if __name__ == "__main__":
    main()
