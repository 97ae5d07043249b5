"""The page of an analysis: energies, what is cyclic, steady, stable, small and conserved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.derivations.showing import FORMATS
from eom.errors import InputError, typed, unknown_name
from eom.expressions import as_expression
from eom.multibody.analysis.conserved import check_degrees, conserved_quantities
from eom.multibody.analysis.cyclic import cyclic_coordinates, routh
from eom.multibody.analysis.energies import Equations, Lagrangian, equations_of, lagrangian
from eom.multibody.analysis.steady import (
    SteadyMotion,
    linearised,
    small_motion,
    stability,
    steady_motion,
)
from eom.multibody.closed.forms import closed_form, in_angles
from eom.multibody.closed.mechanism import dotted
from eom.multibody.model.model import Tree
from eom.typeset.blocks import EQUALS, Block, Bullets, Display, Heading, Line, Paragraph
from eom.typeset.boxes import Box, Formula, Grid, Sign, row, symbol
from eom.typeset.writing import expression_pieces, in_decimals

Expr = Any
ABOVE = Sign(" > ", " > ")


@typed
def analysis_page(
    source: Tree | Lagrangian,
    style: str = "text",
    *,
    names: Mapping[str, str] | None = None,
    values: Mapping[str, Any] | None = None,
    solve: Sequence[str] = (),
    order: int = 3,
    rates: int = 2,
    harmonics: int = 2,
    positive: Sequence[str] = (),
) -> str:
    """Return what analysis finds of a tree or Lagrangian, the ``source``, as a page.

    Parameters
    ----------
    source : Tree or Lagrangian
        What is analysed; quaternions of a tree are replaced by angles, which is told.
    style : str, default "text"
        A format of `eom.derivations.showing.FORMATS`.
    names : mapping of str to str, optional
        As of `closed_form`.
    values : mapping of str to objects, optional
        Of a steady motion, as of `steady_motion`.
    solve : sequence of str, optional
        Symbols that its conditions are solved for.
    order : int, default 3
        Of the equations for small changes; 0 leaves them out.
    rates, harmonics : int, default 2
        Of the ansatz for constants of the motion, as of `conserved_quantities`.
    positive : sequence of str, optional
        Names of parameters that are taken to be positive.

    Returns
    -------
    str
        Cyclic coordinates, constants of the motion, steady motions and their stability, as one
        text.

    Raises
    ------
    InputError
        As `closed_form`, `steady_motion` and `conserved_quantities` raise it, and for unknown
        formats.

    Notes
    -----
    Units and signs are those of the source, as are frames.

    Examples
    --------
    >>> q, u = sp.symbols("q u", real=True)
    >>> page = analysis_page(Lagrangian("free", {q: u}, u**2 / 2))
    >>> page.splitlines()[0]
    'free: analysis'
    """
    if style not in FORMATS:
        raise unknown_name("format", style, FORMATS)
    if isinstance(order, bool) or order < 0:
        raise InputError("the order is below zero", where="analysis", got=order)
    check_degrees("analysis", rates=rates, harmonics=harmonics)
    shown: list[Block] = [Heading(f"{source.name.replace('_', ' ')}: analysis", 1)]
    made, told = _source(source, names)
    shown += map(Paragraph, told)
    taken = _taken(made, positive)
    if taken:
        shown.append(Paragraph(f"Taken to be positive: {', '.join(map(str, taken.values()))}."))
    made = made.with_symbols(taken)
    equations = equations_of(made)
    decimals = isinstance(source, Tree) and source.numbers == "decimals"
    pen = _Pen(decimals, _dotted(equations))
    shown += _energies(pen, made) if isinstance(made, Lagrangian) else ()
    chosen = {n: as_expression(x).xreplace(taken) for n, x in dict(values or {}).items()}
    shown += _equations(pen, equations)
    shown += _steady(pen, equations, chosen, solve)
    shown += _small(pen, equations, order, chosen) if order else ()
    shown += _conserved(pen, made, rates, harmonics)
    return FORMATS[style](shown)


def _source(
    source: Tree | Lagrangian, names: Mapping[str, str] | None
) -> tuple[Lagrangian | Equations, tuple[str, ...]]:
    """Return the Lagrangian, or the equations and why there is none; with the angles that were chosen."""
    if isinstance(source, Lagrangian):
        return source, ()
    tree, sequences = in_angles(source)
    turns = ", ".join(dict.fromkeys(sequences))
    told = (f"Attitude by angles instead of a quaternion: {turns}.",) if turns else ()
    try:
        return lagrangian(tree, names=names), told
    except InputError as error:
        made = equations_of(closed_form(tree, names=names, rates=True))
        return made, (*told, f"No Lagrangian: {error.what}.")


def _taken(of: Lagrangian | Equations, positive: Sequence[str]) -> dict[Expr, Expr]:
    """Return symbols that are positive in place of parameters."""
    given = equations_of(of)
    parts = (*given.mass, *given.rest, *given.kinematics)
    free = set().union(*(e.free_symbols for e in parts)) - {*given.coordinates, *given.speeds}
    chosen = sorted((s for s in free if s.name in set(positive)), key=str)
    return {s: sp.Symbol(s.name, positive=True) for s in chosen if not s.is_positive}


def _dotted(of: Equations) -> dict[Expr, Expr]:
    """Return how speeds and their rates are shown that are rates of coordinates."""
    found: dict[Expr, Expr] = {}
    for u, a in zip(of.speeds, of.accelerations, strict=True):
        q = next((q for q in of.coordinates if of.rate(q) == u), None)
        if q is not None:
            rate = dotted(q.name)
            found |= {u: sp.Symbol(rate, real=True), a: sp.Symbol(dotted(rate), real=True)}
    return found


@dataclass(frozen=True)
class _Pen:
    """Writes lines; ``decimals``: whether numbers stay decimals; ``names``: of speeds that are rates."""

    decimals: bool
    names: Mapping[Expr, Expr]

    def put(self, e: Expr) -> Expr:
        found = e.xreplace(dict(self.names))
        return in_decimals(found) if self.decimals else found

    def line(self, left: Box, e: Expr, words: str = "") -> Line:
        return Line(left, EQUALS, expression_pieces(self.put(e)), words)

    def zero(self, e: Expr) -> Line:
        return self.line(Formula(sp.S.Zero), e)

    def grid(self, matrix: Expr) -> Box:
        rows = self.put(matrix).tolist()
        return Grid(tuple(tuple(row(*expression_pieces(x)) for x in line) for line in rows))


def _energies(pen: _Pen, of: Lagrangian) -> Iterator[Block]:
    yield Heading("Energies")
    lines = [pen.line(symbol("T"), of.kinetic), pen.line(symbol("V"), of.potential)]
    lines += (
        [pen.line(symbol("R"), of.dissipation, "Rayleigh's function")]
        if of.dissipation != 0
        else []
    )
    yield Display(tuple(lines))
    yield Heading("Cyclic coordinates")
    found = cyclic_coordinates(of)
    if not found:
        yield Paragraph("L depends on every coordinate.")
        return
    yield Display(tuple(pen.line(symbol(f"p_{c.coordinate}"), c.momentum, c.reason) for c in found))
    yield Bullets(
        tuple(
            (symbol(f"p_{c.coordinate}"), "is constant" if c.conserved else f"changes: {c.reason}")
            for c in found
        )
    )
    if 0 < sum(c.conserved for c in found) < len(of.rates):
        yield from _reduced(pen, of)


def _reduced(pen: _Pen, of: Lagrangian) -> Iterator[Block]:
    left = routh(of)
    yield Heading("Routh's reduction")
    yield Paragraph("At constant momenta, the rates of the cyclic coordinates are")
    yield Display(tuple(pen.line(Formula(pen.put(of.rates[q])), x) for q, x in left.rates.items()))
    yield Paragraph("and the others move as by the Lagrangian R = L - sum of p times rate, with")
    yield Display(
        (
            pen.line(symbol("T_left"), left.lagrangian.kinetic),
            pen.line(symbol("V_eff"), left.effective_potential, "effective potential"),
        )
    )


def _equations(pen: _Pen, of: Equations) -> Iterator[Block]:
    yield Heading("Equations of motion")
    yield Display(tuple(map(pen.zero, of.residuals)))
    occurring = ", ".join(map(str, of.occurring)) or "none"
    yield Paragraph(f"Coordinates that they depend on: {occurring}.")


def _steady(
    pen: _Pen, of: Equations, values: Mapping[str, Any], solve: Sequence[str]
) -> Iterator[Block]:
    yield Heading("Steady motion")
    found = steady_motion(of, values)
    if not found.conditions:
        yield Paragraph("These values are steady whatever the others are.")
    else:
        yield Display(tuple(map(pen.zero, found.conditions)))
    for name in solve:
        found = found.solved(name)
    known = [(q, x) for q, x in found.values.items() if q != x]
    if known:
        yield Display(tuple(pen.line(Formula(pen.put(q)), x) for q, x in known))
    if not found.placed:
        yield Paragraph(
            "Linear motion needs values that are steady, or conditions that are solved."
        )
        return
    if found.conditions:
        yield Paragraph("What is left closes the chain; what follows holds where it does.")
    yield from _linear(pen, found)


def _linear(pen: _Pen, about: SteadyMotion) -> Iterator[Block]:
    found = linearised(about)
    verdict = stability(found)
    yield Heading("Linear motion about it")
    yield Paragraph(
        f"Of changes of {', '.join(map(str, found.variables))}: P(s) = M s^2 + D s + K."
    )
    parts = (("M", found.mass), ("D", found.damping), ("K", found.stiffness))
    yield Display(tuple(Line(symbol(n), EQUALS, (pen.grid(x),)) for n, x in parts))
    apart = f", {found.zeros} zero roots put aside" if found.zeros else ""
    yield Paragraph(f"Characteristic polynomial{apart}:")
    yield Display((pen.line(symbol("p"), found.polynomial),))
    yield Heading("Stability")
    yield from _verdict(pen, verdict.conditions, verdict.asymptotic, verdict.never)


def _verdict(
    pen: _Pen, conditions: Sequence[Expr], asymptotic: bool, never: bool
) -> Iterator[Block]:
    what = "die out" if asymptotic else "stay small oscillations"
    if never:
        yield Paragraph("Never stable: a condition fails whatever the parameters are.")
    elif not conditions:
        yield Paragraph(f"Small changes {what}.")
    else:
        yield Paragraph(f"Small changes {what} where")
        yield Display(
            tuple(
                Line(row(*expression_pieces(pen.put(c))), ABOVE, expression_pieces(sp.S.Zero))
                for c in conditions
            )
        )


def _small(pen: _Pen, of: Equations, order: int, values: Mapping[str, Any]) -> Iterator[Block]:
    yield Heading(f"Small changes, to order {order}")
    found = small_motion(of, order, values)
    about = [(q, x) for q, x in found.about.items() if x != 0]
    if about:
        yield Display(tuple(pen.line(Formula(pen.put(q)), x, "near which it is") for q, x in about))
    yield Display(tuple(map(pen.zero, found.equations)))


def _conserved(
    pen: _Pen, of: Lagrangian | Equations, rates: int, harmonics: int
) -> Iterator[Block]:
    yield Heading("Conserved quantities")
    yield Paragraph(f"Of degree {rates} at most in the rates, {harmonics} in sines and cosines:")
    try:
        found = conserved_quantities(of, rates=rates, harmonics=harmonics)
    except InputError as error:
        yield Paragraph(f"Not looked for: {error.what}.")
        return
    if not found:
        yield Paragraph("None of this form.")
    else:
        lines = (pen.line(symbol(f"C_{k}"), c.expression) for k, c in enumerate(found, 1))
        yield Display(tuple(lines))
