"""A sheet of all pictures: every picture of every ready scene, and pairs of texts that overlap.

``python -m benchmarks.pictures --out FOLDER [SCENE ...]`` writes each picture as SCENE-NAME.png, and sheets
of them, to be looked at. It prints how many boxes of text each has, as Matplotlib draws it, and which pairs
overlap. Work-precision diagrams are measured, and left out unless ``--measured``.

``--pages`` writes the pages to turn by hand instead: of each picture, the animation, and the live page; it
prints how many bytes each has.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator
from pathlib import Path

from PIL import Image

from eom import load_scene
from eom.scenes import catalogue
from eom.views import gallery
from eom.views.animation import animation_page
from eom.views.animation.animation import animation_of
from eom.views.animation.figures import shapes_of_file
from eom.views.draw import turned
from eom.views.draw.placing import boxes, overlaps
from eom.views.draw.printed import figure
from eom.views.live import page as live
from eom.views.time.histories import run

LARGEST = 2_000_000
"""Bytes that a page may have."""
SECONDS = 8.0
"""Of the motions in animations at most."""
TILE, ACROSS, DOWN = 640, 3, 3
"""Pixels of a picture on a sheet at most, and pictures of a sheet."""


def main() -> int:
    """Write pictures and sheets; return how many pairs of texts overlap."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--what", default="")
    parser.add_argument("--measured", action="store_true")
    parser.add_argument("--pages", action="store_true")
    told = parser.parse_args()
    told.out.mkdir(parents=True, exist_ok=True)
    return _pages(told) if told.pages else _printed(told)


def _printed(told: argparse.Namespace) -> int:
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


def _pages(told: argparse.Namespace) -> int:
    sizes = []
    for name in told.scenes or catalogue.names():
        for what, text in _made(name, told.what):
            file = told.out / f"{Path(name).stem}-{what}.html"
            file.write_text(text, encoding="utf-8")
            sizes.append(file.stat().st_size)
            print(f"{name} {what}: {sizes[-1]:,} bytes", flush=True)
    print(f"{len(sizes)} pages, the largest {max(sizes):,} bytes")
    return int(max(sizes) > LARGEST)


def _made(name: str, wanted: str) -> Iterator[tuple[str, str]]:
    """Yield the pages of a scene that are wanted, by name; all where none is named."""
    scene, robot = load_scene(name), shapes_of_file(name)
    pictures = [p for p in gallery.available(scene) if p != "work-precision"]
    chosen = wanted.split(",") if wanted else [*pictures, "animation", "live"]
    for what in (p for p in pictures if p in chosen):
        yield what, turned.page(gallery.picture(what, gallery.Ask(scene)))
    if "animation" in chosen:
        seconds = min(SECONDS, scene.integration.t_end)
        moving = animation_of(
            scene, lambda s: run(s, points=s.integration.points)[0], seconds=seconds, robot=robot
        )
        yield "animation", animation_page.page(moving)
    if "live" in chosen:
        yield "live", live.page(scene)


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
