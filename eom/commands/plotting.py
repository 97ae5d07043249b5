"""Pictures of scenes: `eom plot`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.options import SCENE, chosen_values, option, options
from eom.commands.shared import Rows, WithTable, progress_of, report_files, scene_of
from eom.errors import InputError

if TYPE_CHECKING:
    from eom.opening import AnyScene


def _pictures() -> Rows:
    from eom.views.gallery import PICTURES

    return [(name, f"{entry.words}; of {entry.needs}") for name, entry in PICTURES.items()]


@click.command(cls=WithTable, title="Pictures", rows=_pictures)
@click.argument("scene", metavar="[SCENE]", default="")
@options(*SCENE)
@click.option(
    "--what",
    "names",
    default="",
    metavar="NAME[,NAME]",
    help="Pictures, of those below; several stand below each other.  [default: what suits the scene]",
)
@option(
    "file",
    help="File .png, .svg, .pdf, or .html to turn by hand.  [default: SCENE-NAME.png]",
)
@click.option(
    "--moments",
    metavar="I1,I2,I3",
    default="",
    help="Instead of SCENE: a free body's moments, kg m^2.",
)
@click.option(
    "--omega", metavar="W1,W2,W3", default="", help="Its angular velocity at t = 0, rad/s."
)
@option("t_end", help="Time that is drawn, in seconds or with a unit.  [default: the scene's]")
@option("points", type=click.IntRange(2, 1_000_000), help="Number of times.")
@click.option("--size", metavar="WxH", default="", help="Width and height in inches, as 6x4.")
@click.option(
    "--dpi", type=float, default=150.0, show_default=True, help="Pixels an inch, of .png."
)
@click.option("--list", "listed", is_flag=True, help="List the pictures, or those SCENE can have.")
def plot(scene: str, names: str, file: Path | None, listed: bool, **given: Any) -> None:
    """Draw pictures of SCENE: for print by Matplotlib, or as a page to turn by hand.

    Examples: eom plot t-handle --out polhodes.svg; eom plot --moments 1,2,3 --omega 0.1,2,0.1 --what cones
    """
    from eom.views import gallery
    from eom.views.draw.saving import kind_of, save

    if listed and not (scene or given["moments"]):
        _list(tuple(gallery.PICTURES))
        return
    chosen = _chosen(scene, given["moments"], given["omega"])
    if listed:
        _list(gallery.available(chosen))
        return
    size = _size(given["size"])
    seconds = _seconds(given["t_end"])
    asked = [n.strip() for n in names.split(",") if n.strip()] or [gallery.default(chosen)]
    target = file or Path(f"{_stem(scene)}-{asked[0]}.png")
    kind_of(target)  # before any work
    with progress_of("drawing") as progress:
        ask = gallery.Ask(chosen, seconds, given["points"], lambda done: progress(0.7 * done))
        picture = gallery.pictures(asked, ask)
        progress(0.7)
        saved = save(picture, target, size, given["dpi"])
    report_files([saved])
    if picture.notice:
        click.echo(f"note: {picture.notice}", err=True)


def _list(names: tuple[str, ...]) -> None:
    from eom.views.gallery import PICTURES

    width = max(map(len, names), default=0)
    for name in names:
        click.echo(f"{name:<{width}}  {PICTURES[name].words} (of {PICTURES[name].needs})")


def _chosen(scene: str, moments: str, omega: str) -> AnyScene:
    """Return the scene that is named, or one of a free body in numbers."""
    if bool(scene) == bool(moments or omega):
        raise InputError(
            "one body is needed",
            where="eom plot",
            got="SCENE and --moments" if scene else "nothing",
            expected="SCENE, or --moments and --omega",
        )
    if scene:
        return scene_of(scene)
    from eom.scenes.scene import Scene

    if chosen_values():
        raise InputError("--set is for scenes", where="eom plot", hint="change --moments, --omega")
    rates = zip(("omega_1", "omega_2", "omega_3"), _three(omega, "--omega"), strict=True)
    return Scene(
        name="body",
        title="Torque-free body",
        attitude="quaternion",
        body={"moments": _three(moments, "--moments")},
        initial=dict(rates),
        initial_attitude={"quaternion": (1.0, 0.0, 0.0, 0.0)},
    )


def _three(text: str, where: str) -> list[float]:
    from eom.scenes.parse import parse

    numbers = [float(parse(part, {}, where)) for part in text.split(",")] if text else []
    if len(numbers) != 3:
        raise InputError(
            "three numbers are needed", where=where, got=text or "none", expected="as 1,2,3"
        )
    return numbers


def _size(text: str) -> tuple[float, float] | None:
    if not text:
        return None
    found = re.fullmatch(r"(\d+(?:\.\d*)?)x(\d+(?:\.\d*)?)", text)
    if found is None:
        raise InputError("not a size", where="--size", got=text, expected="as 6x4, in inches")
    return float(found[1]), float(found[2])


def _seconds(given: float | None) -> float | None:
    import math

    if given is not None and not 0 < given < math.inf:
        raise InputError("no time to draw", where="--t-end", got=given, expected="above 0")
    return given


def _stem(scene: str) -> str:
    return Path(scene).stem if scene else "body"
