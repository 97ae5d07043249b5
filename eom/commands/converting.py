"""Attitude and inertia in other conventions: `eom convert`."""

from __future__ import annotations

import json
import math
import re
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from eom.commands.options import option, options
from eom.commands.shared import Rows, WithTable, scene_of
from eom.errors import InputError

if TYPE_CHECKING:
    from eom.rotations import Matrix
    from eom.scenes.conventions import Convention, Stated

MOST_READINGS = 3
DIGITS = 10
"""Digits that are shown; --json has all of them."""
ROUNDING = 1e-15
"""What is shown as zero."""
FIELDS = ("direction", "order", "scalar", "products", "reference", "body", "sequence")


def _books() -> Rows:
    from eom.scenes.conventions import BOOKS

    return [(name, title) for name, (title, _) in BOOKS.items()]


@click.command(cls=WithTable, title="Conventions", rows=_books)
@click.argument("scene", metavar="[SCENE]", default="")
@click.option(
    "--matrix", metavar="M", default="", help="A rotation matrix: rows by ;, entries by commas."
)
@click.option("--quaternion", metavar="Q", default="", help="Four numbers by commas.")
@click.option(
    "--angles", metavar="A", default="", help="Three angles by commas, of --from's sequence."
)
@click.option("--radians", is_flag=True, help="Angles are in radians.  [default: degrees]")
@click.option(
    "--recognise", metavar="M", default="", help="Say what a matrix is; symbols may stand in it."
)
@click.option(
    "--from",
    "source",
    default="eom",
    show_default=True,
    metavar="NAME",
    help="Convention in which M, Q, A are given.",
)
@click.option(
    "--to",
    "target",
    default="eom",
    show_default=True,
    metavar="NAME",
    help="Convention that is asked for; what follows changes it.",
)
@click.option(
    "--direction", metavar="passive|active", help="Which components the matrix takes to which."
)
@click.option("--order", metavar="body|space", help="What angles turn about.")
@click.option("--scalar", metavar="first|last", help="Where quaternions have the scalar part.")
@click.option("--products", metavar="minus|plus", help="Sign of products of inertia in the matrix.")
@click.option("--reference", metavar="enu|nwu|ned|...", help="Reference axes, by their letters.")
@click.option(
    "--body", metavar="flu|frd|...", help="Body axes: forward, back, left, right, up, down."
)
@click.option("--sequence", metavar="3-2-1|...", help="Sequence of the angles that are asked for.")
@options("set", "lenient", "floating")
@option("json", help="All digits, for programs.")
def convert(scene: str, recognise: str, as_json: bool, **options: Any) -> None:
    """State an attitude and inertia in another convention, or say what a rotation matrix is.

    SCENE gives attitude, inertia and angular velocity at t = 0; or give one of --matrix, --quaternion,
    --angles. Example: eom convert --angles 30,10,0 --from aircraft --to ros
    """  # fmt: skip
    given = {n: options[n] for n in ("matrix", "quaternion", "angles") if options[n]}
    if scene:
        given["SCENE"] = scene
    if recognise:
        given["recognise"] = recognise
    if len(given) != 1:
        raise InputError(
            "one attitude is needed",
            where="eom convert",
            got=", ".join(given) or "none",
            expected="SCENE, --matrix, --quaternion, --angles or --recognise",
        )
    if recognise:
        _recognise(recognise, as_json)
        return
    stated = _stated(next(iter(given)), next(iter(given.values())), options)
    click.echo(json.dumps(_data(stated), indent=1) if as_json else "\n".join(_lines(stated)))


def _stated(kind: str, text: str, options: dict[str, Any]) -> Stated:
    from eom.scenes import conventions

    chosen = {name: options[name] for name in FIELDS if options[name] is not None}
    target = conventions.changed(conventions.book(options["target"]), chosen)
    if kind == "SCENE":
        scene: Any = scene_of(text)
        if scene.tree is not None:
            hint = "give --quaternion, --angles or --matrix"
            raise InputError("a tree has no one attitude", where=text, hint=hint)
        return conventions.of_scene(scene, target)
    source = conventions.book(options["source"])
    return conventions.state(_attitude(kind, text, source, options["radians"]), target)


def _attitude(kind: str, text: str, source: Convention, radians: bool) -> Matrix:
    from eom.scenes import conventions

    if kind == "matrix":
        rows = [_numbers(row, "--matrix") for row in text.split(";")]
        return conventions.attitude_of_matrix(rows, source)
    numbers = _numbers(text, f"--{kind}")
    if kind == "quaternion":
        return conventions.attitude_of_quaternion(numbers, source)
    return conventions.attitude_of_angles(
        [a if radians else math.radians(a) for a in numbers], source
    )


def _numbers(text: str, where: str) -> list[float]:
    from eom.scenes.parse import parse

    return [float(parse(part, {}, where)) for part in text.split(",")]


def _recognise(text: str, as_json: bool) -> None:
    import sympy as sp

    from eom.mechanics.recognition import recognise
    from eom.scenes.parse import FUNCTIONS, parse

    entries = [[part.strip() for part in row.split(",")] for row in text.split(";")]
    words = set(re.findall(r"[A-Za-z_]\w*", text)) - {*FUNCTIONS, "pi"}
    symbols = {n: sp.Symbol(n, real=True) for n in words}
    readings = recognise([[parse(e, symbols, "--recognise") for e in row] for row in entries])
    said = [str(r) for r in readings[:MOST_READINGS]]
    if as_json:
        click.echo(json.dumps({"readings": said}, indent=1))
    elif said:
        click.echo("\n".join([said[0], *(f"  or {s}" for s in said[1:])]))
    else:
        click.echo("a rotation matrix, of no sequence by these symbols")


def _data(stated: Stated) -> dict[str, Any]:
    found = asdict(stated)
    found["degrees"] = [math.degrees(a) for a in stated.angles]
    return {name: value for name, value in found.items() if value is not None}


def _lines(stated: Stated) -> list[str]:
    made = stated.convention
    degrees = ", ".join(_shown(math.degrees(a)) for a in stated.angles)
    lines = [*(f"# {sentence}" for sentence in made.words())]
    lines += [f"# reference axes {made.reference}, body axes {made.body}", ""]
    lines += _rows("matrix", stated.matrix)
    lines += [f"{'quaternion':<16}{', '.join(map(_shown, stated.quaternion))}"]
    lines += [f"{'angles ' + made.sequence:<16}{degrees} deg"]
    if stated.inertia is not None:
        lines += _rows("inertia, kg m^2", stated.inertia)
    if stated.omega is not None:
        lines += [f"{'omega, rad/s':<16}{', '.join(map(_shown, stated.omega))}"]
    return lines


def _rows(name: str, matrix: Matrix) -> list[str]:
    heads = (name, "", "")
    return [
        f"{head:<16}" + "  ".join(f"{_shown(x):>14}" for x in row)
        for head, row in zip(heads, matrix, strict=True)
    ]


def _shown(x: float) -> str:
    return f"{0.0 if abs(x) < ROUNDING else x:.{DIGITS}g}"
