"""A sheet of all pictures: every picture of every ready scene, and pairs of texts that overlap.

``python -m benchmarks.pictures --out FOLDER [SCENE ...]`` writes each picture as SCENE-NAME.png, and sheets
of them, to be looked at. It prints how many boxes of text each has, as Matplotlib draws it, and which pairs
overlap. Work-precision diagrams are measured, and left out unless ``--measured``.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

from PIL import Image

from eom import load_scene
from eom.scenes import catalogue
from eom.views import gallery
from eom.views.draw.placing import boxes, overlaps
from eom.views.draw.printed import figure

TILE, ACROSS, DOWN = 640, 3, 3
"""Pixels of a picture on a sheet at most, and pictures of a sheet."""


def main() -> int:
    """Write pictures and sheets; return how many pairs of texts overlap."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--what", default="")
    parser.add_argument("--measured", action="store_true")
    told = parser.parse_args()
    told.out.mkdir(parents=True, exist_ok=True)
    files, pairs = [], 0
    for name in told.scenes or catalogue.names():
        scene = load_scene(name)
        for what in gallery.available(scene):
            wanted = told.what.split(",") if told.what else [what]
            if what not in wanted or (what == "work-precision" and not told.measured):
                continue
            made = figure(gallery.picture(what, gallery.Ask(scene)))
            found = overlaps(made)
            print(
                f"{name} {what}: {len(boxes(made))} texts, {len(found)} pairs overlap {found[:4]}"
            )
            pairs += len(found)
            files.append(told.out / f"{Path(name).stem}-{what}.png")
            made.savefig(files[-1], dpi=100)
    _sheets(files, told.out)
    print(f"{len(files)} pictures, {pairs} pairs of texts overlap")
    return min(pairs, 1)


def _sheets(files: list[Path], folder: Path) -> None:
    each = ACROSS * DOWN
    for k in range(math.ceil(len(files) / each)):
        sheet = Image.new("RGB", (TILE * ACROSS, TILE * DOWN), "white")
        for n, file in enumerate(files[k * each : (k + 1) * each]):
            with Image.open(file) as image:
                small = image.convert("RGB")
                small.thumbnail((TILE - 10, TILE - 10))
                sheet.paste(small, (TILE * (n % ACROSS) + 5, TILE * (n // ACROSS) + 5))
        sheet.save(folder / f"sheet-{k + 1}.png")


if __name__ == "__main__":
    sys.exit(main())
