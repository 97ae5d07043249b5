"""What each method shows of its way: stages with a reason and lines (left side, value).

A value is an expression, or three of them: components in the axes that the reason names. How symbols are
shown: speeds as rates of coordinates, numbers as decimals where the tree says so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.multibody.algebra.scalars import is_zero
from eom.multibody.closed.bonds import Bound
from eom.multibody.closed.forms import ClosedForm
from eom.multibody.closed.lagrange import Kane, Lagrange, NewtonEuler
from eom.multibody.closed.mechanism import Mechanism, dotted
from eom.multibody.closed.polynomials import Scalar
from eom.multibody.closed.readable import by_motion
from eom.typeset.boxes import (
    Box,
    Formula,
    Fraction,
    Operator,
    Row,
    Scripts,
    Symbol,
    Words,
    row,
    symbol,
)
from eom.typeset.writing import Names, expression_pieces

Expr = Any


def display_names(form: ClosedForm) -> Names:
    """Return how speeds and accelerations are shown: those of a coordinate q as rates of q.

    A prescribed rate is shown as the symbol that it is, or by the name that was chosen.
    """
    found = Names()
    found.decimals = form.tree.numbers == "decimals"
    given = form.whole
    for u, a, moved in zip(given.speeds, given.accelerations, given.basis, strict=True):
        if len(moved) == 1 and set(moved.values()) == {1} and u.symbol not in given.named:
            q = next(iter(moved)).name
            found[u.symbol] = sp.Symbol(dotted(q), real=True)
            found[a] = sp.Symbol(dotted(dotted(q)), real=True)
    prescribed = {d.symbol: d.expression for d in form.prescribed}
    known = {s: prescribed[s] for u in given.speeds if (s := u.symbol) in prescribed}
    found.update({s: rate for s, rate in known.items() if rate.is_Symbol})
    return found


Value = Expr | tuple[Expr, ...]


@dataclass(frozen=True)
class Stage:
    """A step of a method: why, and what it gives."""

    reason: str
    lines: tuple[tuple[Box, Value], ...]


def stages(form: ClosedForm) -> list[Stage]:
    """Return the stages of the method of a closed form; those without lines are left out."""
    return [stage for stage in _stages(form, form.steps) if stage.lines]


def _stages(form: ClosedForm, steps: Any) -> Iterator[Stage]:
    return _STAGES_OF[type(steps)](form, steps)


@dataclass(frozen=True)
class _Pen:
    """Writes scalars of a mechanism, by the products of speeds in them."""

    form: ClosedForm
    mechanism: Mechanism

    def __call__(self, x: Scalar) -> Expr:
        return by_motion(self.mechanism, self.form.write)(x)

    def vector(self, v: Sequence[Scalar]) -> tuple[Expr, ...]:
        return tuple(map(self, v))


def _lines(pairs: Iterator[tuple[Box, Value]]) -> tuple[tuple[Box, Value], ...]:
    """Return the lines whose value is not zero."""
    return tuple((left, value) for left, value in pairs if not _nothing(value))


def _nothing(value: Value) -> bool:
    return all(x == 0 for x in value) if isinstance(value, tuple) else bool(value == 0)


def _of(letter: str, body: str, *more: str) -> Box:
    """Return a letter with the name of a body below it, and a speed's number."""
    below: list[Box] = [_name(body)]
    for m in more:
        below += [Operator("comma"), Symbol(m)]
    return Scripts(Symbol(letter), sub=Row(tuple(below)))


def _name(body: str) -> Box:
    """Return the name of a body, however it is made up of letters, digits and underscores."""
    return Words(body)


def _by(above: Box, below: Expr) -> Box:
    """Return a partial derivative."""
    partial = Operator("partial")
    return Fraction(Row((partial, above)), Row((partial, symbol(str(below)))))


def _d_dt(inner: Box) -> Box:
    d = Operator("d")
    return Row((Fraction(d, Row((d, Symbol("t")))), Operator("times"), inner))


# -- Lagrange ----------------------------------------------------------------------------------


def _lagrange(form: ClosedForm, steps: Lagrange) -> Iterator[Stage]:
    pen, links = _Pen(form, steps.mechanism), steps.mechanism.links
    heavy = [k for k, link in enumerate(links) if not is_zero(link.mass)]
    yield Stage(
        "positions of the centres of mass, in the ground's axes",
        _lines((_of("r", links[k].name), pen.vector(steps.centres[k])) for k in heavy),
    )
    yield Stage(
        "their derivatives in time",
        _lines((_of("v", links[k].name), pen.vector(steps.motions[k].linear)) for k in heavy),
    )
    turning = [k for k in heavy if not all(is_zero(x) for row in links[k].inertia for x in row)]
    yield Stage(
        "angular velocities, in the bodies' axes, from the derivatives of the rotations",
        _lines(
            (_of("omega", links[k].name), pen.vector(steps.motions[k].angular)) for k in turning
        ),
    )
    yield Stage(
        "kinetic energies: half of m v.v and omega.J omega about the centre of mass; rotors add to T",
        _lines((_of("T", links[k].name), pen(steps.energies[k])) for k in heavy)
        + _lines(iter([(Symbol("T"), pen(steps.kinetic))])),
    )
    yield Stage(
        "potential energies of gravity and springs; Rayleigh's function of the dampers",
        _lines(
            iter(
                [
                    (symbol("V_gravity"), pen(steps.gravity)),
                    (symbol("V_springs"), pen(steps.springs)),
                    (Symbol("R"), pen(steps.dissipation)),
                ]
            )
        ),
    )
    yield from _differentiated(form, steps, pen)


def _differentiated(form: ClosedForm, steps: Lagrange, pen: _Pen) -> Iterator[Stage]:
    given, shown = steps.mechanism, _shown(form)
    rows = [(s, shown(given.speeds[s].symbol)) for s in given.free]
    yield Stage(
        "momenta",
        _lines((_by(Symbol("T"), u), pen(steps.momenta[s])) for s, u in rows),
    )
    yield Stage(
        "their derivatives in time",
        _lines((_d_dt(_by(Symbol("T"), u)), pen(given.rate(steps.momenta[s]))) for s, u in rows),
    )
    yield Stage(
        "how the kinetic energy changes with the coordinates",
        _lines((_turned(form, "T", s), pen(steps.moved(steps.kinetic, s))) for s, _ in rows),
    )
    yield Stage(
        "speeds that are no rates of coordinates: the terms of Boltzmann and Hamel",
        _lines((_of("B", str(u)), pen(steps.brackets(s))) for s, u in rows),
    )
    yield Stage(
        "how the potential energy changes with the coordinates",
        _lines(
            (_turned(form, "V", s), pen(steps.moved(steps.gravity + steps.springs, s)))
            for s, _ in rows
        ),
    )


def _turned(form: ClosedForm, letter: str, s: int) -> Box:
    """Return dT/dq where the speed is the rate of q, else X_s T."""
    given = form.whole
    moved = given.basis[s]
    if len(moved) == 1 and set(moved.values()) == {1}:
        return _by(Symbol(letter), next(iter(moved)))
    return Row((Scripts(Symbol("X"), sub=symbol(given.speeds[s].name)), Symbol(letter)))


# -- Kane --------------------------------------------------------------------------------------


def _kane(form: ClosedForm, steps: Kane) -> Iterator[Stage]:
    pen, given = _Pen(form, steps.mechanism), steps.mechanism
    heavy = [(k, link.name) for k, link in enumerate(given.links) if not is_zero(link.mass)]
    yield Stage(
        "angular velocities and velocities of the centres of mass, in the bodies' axes",
        _pairs(
            pen, "omega", "v", ((n, steps.origins[k].angular, steps.centres[k]) for k, n in heavy)
        ),
    )
    partials = (
        (n, str(row), steps.partial(k, s)) for row, s in enumerate(given.free, 1) for k, n in heavy
    )
    yield Stage(
        "partial angular velocities and partial velocities: the coefficients of the speeds",
        _lines(
            (_of(letter, name, row), pen.vector(v))
            for name, row, pair in partials
            for letter, v in zip(("omega", "v"), pair, strict=True)
        ),
    )
    yield Stage(
        "angular accelerations and accelerations, by differentiation in turning axes",
        _pairs(pen, "alpha", "a", ((n, *steps.accelerations[k]) for k, n in heavy)),
    )
    yield _generalised(
        form, steps, pen, "motion", "generalised inertia forces, less their sign", "F*"
    )
    for source, words in _ACTIVE:
        yield _generalised(form, steps, pen, source, words, "F")


def _pairs(
    pen: _Pen, first: str, second: str, found: Iterable[tuple[str, Sequence[Any], Sequence[Any]]]
) -> tuple[tuple[Box, Value], ...]:
    """Return two vectors of each body, with their letters."""
    return _lines(
        (_of(letter, name), pen.vector(v))
        for name, *vectors in found
        for letter, v in zip((first, second), vectors, strict=True)
    )


_ACTIVE = (
    ("gravity", "generalised active forces of gravity, less their sign"),
    ("spring", "generalised active forces of springs, less their sign"),
    ("damper", "generalised active forces of dampers, less their sign"),
    ("applied", "generalised active forces that are applied"),
)


def _generalised(
    form: ClosedForm, steps: Kane, pen: _Pen, source: str, reason: str, letter: str
) -> Stage:
    found = [
        (
            Row((Words(f"{c.label}, "), symbol(str(_shown(form)(form.speeds[c.row].symbol))))),
            c.value,
        )
        for c in steps.contributions()
        if c.source == source and not is_zero(c.value)
    ]
    return Stage(f"{reason} ({letter})", _lines((left, pen(x)) for left, x in found))


# -- Newton-Euler ------------------------------------------------------------------------------


def _newton_euler(form: ClosedForm, steps: NewtonEuler) -> Iterator[Stage]:
    pen, links = _Pen(form, steps.mechanism), steps.mechanism.links
    heavy = [(k, link) for k, link in enumerate(links) if not is_zero(link.mass)]
    moving = (
        (link.name, steps.motions[k].alpha, steps.acceleration(k, link.centre)) for k, link in heavy
    )
    yield Stage(
        "angular accelerations, and accelerations of the centres of mass, in the bodies' axes",
        _pairs(pen, "alpha", "a", moving),
    )
    rates = ((link.name, steps.momentum_rate(k)) for k, link in heavy)
    balances = ((name, rate.linear, rate.angular) for name, rate in rates)
    yield Stage(
        "balances of each body: force m a, and moment J alpha + omega x J omega about the centre",
        _pairs(pen, "f", "n", balances),
    )
    yield Stage(
        "moments and forces are handed on towards the ground; along the directions that a joint leaves "
        "free it carries no reaction, and what the bodies beyond it ask there is",
        _asked(form, steps, pen),
    )


def _asked(form: ClosedForm, steps: NewtonEuler, pen: _Pen) -> tuple[tuple[Box, Value], ...]:
    named = form.whole.algebra.named
    own = [named(u.symbol) for link in steps.mechanism.links for u in link.joint.speeds]
    shown = _shown(form)
    return _lines(
        (Row((Words(f"{label}, at "), symbol(str(shown(own[s]))))), pen(x))
        for s, _, label, x in steps.joint_rows()
        if not is_zero(x)
    )


# -- constraints -------------------------------------------------------------------------------


def _bound(form: ClosedForm, steps: Bound) -> Iterator[Stage]:
    pen, held = _Pen(form, steps.bonds.whole), steps.bonds
    if steps.combined:
        yield from _stages(form, steps.whole)
    closed = (b.value for b in held.kept if b.value is not None)
    yield Stage("constraints: what is zero between coordinates", _zeros(pen, closed))
    yield Stage("what is zero between speeds", _zeros(pen, (b.rate for b in held.kept)))
    speeds = [_shown(form)(u.symbol) for u in held.whole.speeds]
    if steps.combined:
        yield _with_multipliers(steps, pen)
    yield Stage(
        "solved for the speeds that follow",
        _lines((Formula(speeds[k]), pen(held.follower(k))) for k in held.dependent),
    )
    yield Stage(
        "coordinates that closures give outright, put in below",
        tuple((Formula(d.symbol), d.expression) for d in form.placed),
    )
    if not steps.combined:
        yield from _stages(form, steps.steps)
        return
    yield Stage(
        "how often each follows the independent ones: so often its equation is added to theirs, and "
        "the multipliers drop out",
        _lines(
            (_by(Formula(speeds[d]), speeds[s]), pen(row[s]))
            for d, row in held.dependent.items()
            for s in held.independent
            if s in row
        ),
    )


def _zeros(pen: _Pen, values: Iterable[Scalar]) -> tuple[tuple[Box, Value], ...]:
    return _lines((Formula(sp.S.Zero), pen(x)) for x in values)


def _with_multipliers(steps: Bound, pen: _Pen) -> Stage:
    """Return the equations of all speeds: forces of constraints, and what they must give."""
    held = steps.bonds
    forces = [sp.Symbol(f"lambda_{b.name}", real=True) for b in held.kept]
    lines = []
    for k in held.whole.free:
        left = sp.Add(
            *(f * pen(b.row[k]) for f, b in zip(forces, held.kept, strict=True) if k in b.row)
        )
        lines.append((row(*expression_pieces(left)), pen(steps.needed(k))))
    return Stage(
        "Lagrange's equations with multipliers: forces of constraints along each speed are inertia and "
        "what else resists, less what is applied",
        tuple(lines),
    )


def _shown(form: ClosedForm) -> Callable[[Expr], Expr]:

    names = display_names(form)
    return names.of


_STAGES_OF: dict[type, Callable[[ClosedForm, Any], Iterator[Stage]]] = {
    Bound: _bound,
    Lagrange: _lagrange,
    Kane: _kane,
    NewtonEuler: _newton_euler,
}
