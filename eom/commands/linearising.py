"""eom linearise: an equilibrium or a steady motion of a scene, and the linear motion about it."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

from eom.commands.options import option, options, scene_argument
from eom.commands.shared import compiling, finite, scene_of, waiting_for
from eom.errors import InputError

if TYPE_CHECKING:
    from codegen import LinearMotion


MOST_PLACES = 300
"""Decimals of an eigenvalue that is known exactly."""


@click.command("linearise")
@scene_argument
@option("at")
@click.option("--cyclic", multiple=True, metavar="STATE", help="A state that may run.")
@click.option("--free", multiple=True, metavar="INPUT", help="An input that is looked for (trim).")
@click.option(
    "--keep", multiple=True, metavar="NAME", help="Keep an output or a constant of the motion."
)
@click.option(
    "--attitude", default="states", show_default=True, metavar="states|angles",
    help="Quaternions lose one state, or become three small angles.",
)  # fmt: skip
@click.option("--starts", default=24, show_default=True, help="Points that are tried.")
@option("seed", help="Of the points after the first.")
@options("json", "target")
def linearise(
    scene: str,
    held: Sequence[str],
    cyclic: Sequence[str],
    free: Sequence[str],
    keep: Sequence[str],
    attitude: str,
    starts: int,
    seed: int,
    as_json: bool,
    target: str,
) -> None:
    """Find an equilibrium or steady motion of SCENE near its initial values; linearise about it."""
    import codegen

    opened = scene_of(scene).as_stated()
    guess, parameters = opened.initial_values(), opened.parameter_values()
    full = opened.full_system
    known = (*full.states, *full.output_quantities, *(d.quantity for d in full.invariants))
    units = {q.name: q.unit for q in known}
    fixed = dict(_value(given, parameters, units) for given in held)
    with waiting_for("deriving") as show:
        compiled = codegen.compile(opened.derive(), target, progress=compiling(show))
        show("looking for the point")
        point = codegen.equilibrium(
            compiled, guess, parameters, hold=fixed,
            cyclic=cyclic, free=free, starts=starts, seed=seed,
        )  # fmt: skip
        near = codegen.linearise_about(compiled, point, constraints=keep, attitude=attitude)
    if as_json:
        click.echo(json.dumps(finite(data(near, compiled.layout.name)), indent=2, allow_nan=False))
    else:
        click.echo(text(near))


def _value(
    given: str, parameters: Mapping[str, float], units: Mapping[str, str]
) -> tuple[str, float]:
    """Return a name and its value: with a unit, or a formula over the parameters."""
    import sympy as sp

    from eom.scenes.parse import parse

    name, sign, formula = (part.strip() for part in given.partition("="))
    where = f"--at {given!r}"
    if not sign or not name or not formula:
        raise InputError("not a value of a name", where=where, expected='as "omega_3=20"')
    symbols = {n: sp.Symbol(n, real=True) for n in parameters}
    found = parse(formula, symbols, where, unit=units.get(name, ""))
    value = found.subs({symbols[n]: sp.Rational(v) for n, v in parameters.items()}).evalf(30)
    if not value.is_real or not value.is_finite:
        raise InputError("a formula has no finite value", where=where, got=str(value))
    return name, float(value)


def data(near: LinearMotion, name: str) -> dict[str, Any]:
    """Return everything as values: matrices by rows, eigenvalues as (real, imaginary)."""
    point, verdict = near.point, near.stability
    return {
        "system": name,
        "states": list(near.states),
        "inputs": list(near.inputs),
        "outputs": list(near.outputs),
        **{letter: getattr(near, letter).tolist() for letter in "ABCD"},
        "eigenvalues": [[float(v.real), float(v.imag)] for v in near.eigenvalues],
        "errors": list(near.errors),
        "stability": {"kind": verdict.kind, "growth": verdict.growth, "error": verdict.error},
        "agreement": near.agreement,
        "doubtful": list(near.doubtful),
        "eliminated": {k: dict(v) for k, v in near.eliminated.items()},
        "cyclic": dict(point.rates or {}),
        "point": {
            "states": dict(point.states), "inputs": dict(point.inputs),
            "parameters": dict(point.parameters), "kind": point.kind, "residual": point.residual,
            "worst": point.worst, "rank": point.rank, "unknowns": point.unknowns,
        },
    }  # fmt: skip


def text(near: LinearMotion) -> str:
    """Return the point, the matrices with names and what the eigenvalues say."""
    point, verdict = near.point, near.stability
    title = "steady motion" if point.cyclic else "equilibrium"
    held = f"{point.kind}, rank {point.rank} of {point.unknowns}"
    parts = [
        _values(title, {**point.states, **point.inputs}),
        f"  {held}; largest rate {point.residual:.2g} ({point.worst})",
    ]
    if point.rates:
        parts.append(_values("running", point.rates))
    for letter, rows, columns in (
        ("A", near.states, near.states), ("B", near.states, near.inputs),
        ("C", near.outputs, near.states), ("D", near.outputs, near.inputs),
    ):  # fmt: skip
        if rows and columns:
            parts.append(_matrix(letter, getattr(near, letter), rows, columns))
    for name, others in near.eliminated.items():
        parts.append(f"{name} = " + (" + ".join(f"{f:.6g} {n}" for n, f in others.items()) or "0"))
    shown = map(_eigenvalue, near.eigenvalues, near.errors)
    parts += ["eigenvalues (1/s)", *shown]
    parts.append(
        f"{verdict.kind}: largest real part {verdict.growth:.3g} 1/s, known to {verdict.error:.1g}"
    )
    if near.doubtful:
        parts.append(f"no derivative there (a corner?): {', '.join(near.doubtful)}")
    parts.append(f"agreement with a complex step of 50 digits: {near.agreement:.1e}")
    return "\n".join(parts)


def _eigenvalue(value: complex, error: float) -> str:
    """Return an eigenvalue to the digits that are known; a part that is less than its error is zero."""
    places = -math.floor(math.log10(error)) if error > 0 else MOST_PLACES
    real, imaginary = (
        0.0 if abs(part) <= error else round(part, places) for part in (value.real, value.imag)
    )
    return f"  {real:+.10g}" + f" {imaginary:+.10g}i" * bool(imaginary)


def _values(title: str, values: Any) -> str:
    return "\n".join([title, *(f"  {name} = {value:.12g}" for name, value in values.items())])


def _matrix(letter: str, entries: Any, rows: Sequence[str], columns: Sequence[str]) -> str:
    """Return a table with names of rows and columns."""
    cells = [[f"{x:.6g}" if x else "0" for x in row] for row in entries]
    widths = [max(len(c), *(len(row[k]) for row in cells)) for k, c in enumerate(columns)]
    side = max(map(len, (letter, *rows)))
    lines = [
        " ".join([letter.ljust(side), *(c.rjust(w) for c, w in zip(columns, widths, strict=True))])
    ]
    for name, row in zip(rows, cells, strict=True):
        lines.append(
            " ".join([name.ljust(side), *(c.rjust(w) for c, w in zip(row, widths, strict=True))])
        )
    return "\n".join(lines)
