"""Animations and live pages: `eom animate`, `eom live`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.options import SECONDS, option, options, scene_argument
from eom.commands.shared import progress_of, report_files, scene_of
from eom.commands.simulating import job_of
from eom.errors import InputError

if TYPE_CHECKING:
    from codegen import Result
    from eom.opening import AnyScene
    from eom.views.animation.animation import Animation
    from eom.views.animation.filming import Film

PAGE = ".html"
FILMS = (".gif", ".png", ".apng", ".webp")


@click.command()
@scene_argument
@option(
    "file",
    required=True,
    help="Write FILE.html, or for slides FILE.gif, .apng, .png (animated) or .webp.",
)
@options("t_end", "method", "rtol")
@click.option(
    "--speed",
    type=float,
    default=None,
    help="Seconds of the motion in a second of the animation.  [default: 1, or as fits]",
)
@click.option(
    "--follow",
    metavar="BODY",
    default=None,
    help="Body that the camera goes with, or none.  [default: one, if the motion goes far]",
)
@click.option("--fps", type=int, default=None, help="Pictures a second, for slides.  [default: 15]")
@click.option(
    "--length", type=SECONDS, default=None, help="Longest film, for slides, in s.  [default: 8]"
)
@click.option("--size", default=None, metavar="WxH", help="Pixels, for slides.  [default: 640x480]")
@click.option("--dark", is_flag=True, help="A dark background, for slides.")
@option("target")
def animate(
    scene: str,
    file: Path,
    t_end: float | None,
    speed: float | None,
    follow: str | None,
    fps: int | None,
    length: float | None,
    size: str | None,
    dark: bool,
    target: str,
    **plan: Any,
) -> None:
    """Simulate SCENE and write its motion in space as one HTML page, or as an animated picture.

    The page is below 2 MB, asks nothing from the network, and has play, pause, speed, a time slider,
    trails, frames, vectors of omega and H, and forces and torques with their numbers. An animated
    picture is at most 20 MB. Bodies without a shape are drawn as uniform bodies of equal inertia; the
    page says which.
    """
    from codegen.runs.export import whole

    film = _film(file, fps, length, size, dark)
    chosen = scene_of(scene, **plan)
    found = _animation(chosen, scene, target, seconds=t_end, speed=speed, follow=follow)
    data = _filmed(found, file.suffix, film) if film else _page(found)
    whole(file, lambda part: part.write_bytes(data))
    report_files([file])
    for note in found.notes[:1]:
        if note.startswith("stopped"):
            click.echo(f"note: {note}", err=True)


def _film(
    file: Path, fps: int | None, length: float | None, size: str | None, dark: bool
) -> Film | None:
    """Return how slides are filmed, None for a page. Raises `InputError` before anything is computed."""
    if file.suffix not in {PAGE, *FILMS}:
        expected = ", ".join((PAGE, *FILMS))
        raise InputError("unknown kind of file", where="--out", got=file.name, expected=expected)
    given = {"--fps": fps, "--length": length, "--size": size, "--dark": dark or None}
    if file.suffix == PAGE:
        for name, value in given.items():
            if value is not None:
                raise InputError(
                    "this option is for slides", where=name, hint=f"--out FILE{FILMS[0]}"
                )
        return None
    from eom.views.animation.filming import Film, checked

    wide, high = _size(size) if size else (Film.width, Film.height)
    return checked(Film(wide, high, Film.fps if fps is None else fps, dark, length))


def _size(text: str) -> tuple[int, int]:
    wide, cross, high = text.lower().partition("x")
    if not (cross and wide.isdecimal() and high.isdecimal()):
        raise InputError("not a size", where="--size", got=text, expected="for example 640x480")
    return int(wide), int(high)


def _animation(scene: AnyScene, name: str, target: str, **told: Any) -> Animation:
    from eom.views.animation.animation import animation_of
    from eom.views.animation.figures import shapes_of_file

    with progress_of("integrating") as progress:

        def integrate(prepared: AnyScene) -> Result:
            return job_of(prepared, target, ()).integrate(progress)

        return animation_of(scene, integrate, robot=shapes_of_file(name), **told)


def _page(animation: Animation) -> bytes:
    from eom.views.animation.animation_page import page

    return page(animation).encode("utf-8")


def _filmed(animation: Animation, suffix: str, film: Film) -> bytes:
    from eom.views.animation.filming import film_bytes

    with progress_of("drawing") as progress:
        return film_bytes(animation, suffix, film, progress)


@click.command()
@scene_argument
@option("file", required=True, help="Page: FILE.html.")
def live(scene: str, file: Path) -> None:
    """Write SCENE as one page that integrates its equations where it is looked at.

    The page needs no network: sliders change numbers, boxes leave parts out, and equations and generated
    right-hand side change with them. Under constraints start values are made consistent whenever a number
    changes. Laws of control run on the page.
    """
    from codegen.compiling.compiled import write_files
    from eom.views.live.page import page

    if file.suffix != ".html":
        raise InputError("a page is HTML", where="--out", got=str(file), expected="FILE.html")
    report_files(write_files({file.name: page(scene_of(scene))}, file.parent))
