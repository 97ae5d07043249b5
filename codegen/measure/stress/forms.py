"""Closed forms under perturbation: nothing that changes rates goes unseen, at any size and place."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import sympy as sp

from codegen.closed.closed_forms import ROWS
from codegen.closed.held import Held
from codegen.frontend.layout import Layout
from codegen.ir.passes import prune
from codegen.ir.program import RATES
from codegen.measure.stress.record import Figure, Findings, Material, Plan
from codegen.passes.pipeline import specialised
from eom.system import System

Expr = Any
LARGEST = 300
"""Amplitudes are 10^-LARGEST to 10^LARGEST."""


@dataclass(frozen=True)
class Known:
    """A system with a closed form, and numbers of its parameters and inputs."""

    name: str
    system: System
    layout: Layout
    parameters: tuple[float, ...]
    inputs: tuple[float, ...]

    def held(self, system: System) -> Held:
        """Return a system, which may be another, with these numbers and what this one states."""
        bare = replace(system, attitudes=(), outputs=(), invariants=(), singularities=())
        program, _ = specialised(bare)
        rates = prune(program, [RATES])
        count = len(self.layout.states)
        return Held(rates, count, self.parameters, self.inputs, self.layout.attitudes)

    def differs(self, rates: Sequence[Expr]) -> bool:
        """Return whether rates have other values than those of the system, as far as three points say."""
        given = [*self.system.parameters, *self.system.inputs]
        moving = [self.system.time, *(q.symbol for q in self.system.states)]
        values = dict(zip([q.symbol for q in given], [*self.parameters, *self.inputs], strict=True))
        draw = random.Random(0)  # noqa: S311 - reproducible points
        for _ in range(3):
            point = values | {v: draw.uniform(0.2, 1.2) for v in moving}
            for ours, theirs in zip(self.system.rates, rates, strict=True):
                difference = self.system.expand(ours - theirs).subs(point)
                if abs(sp.N(difference)) > 1e-9:
                    return True
        return False


def taken(held: Held) -> str:
    """Return the name of the closed form that the rates are proved to have, or nothing."""
    found = (row.name for row in ROWS if held.read(row.read) is not None)
    return next(found, "")


def perturbed_forms(material: Material, plan: Plan) -> Findings:
    """Count the forms that are lost without perturbation, and that are taken with one."""
    systems = list(known(material))
    lost = [k.name for k in systems if not taken(k.held(k.system))]
    draw = random.Random(plan.seed)  # noqa: S311 - reproducible perturbations
    count, wrong = plan.size.forms, []
    for n in range(count):
        chosen = draw.choice(systems)
        system, words = perturbed(chosen, draw)
        found = taken(chosen.held(system))
        if found:
            wrong.append(f"{found} taken of {chosen.name} with {words}")
        plan.progress((n + 1) / count)
    return Findings(
        (
            Figure(
                f"systems of {len(systems)} whose form is not found", len(lost), 0, ", ".join(lost)
            ),
            Figure(
                f"forms taken of {count} perturbed systems", len(wrong), 0, "; ".join(wrong[:3])
            ),
        )
    )


def known(material: Material) -> Iterator[Known]:
    """Yield the systems that have closed forms: those that must, and problems and scenes that do."""
    for case in (*material.closed, *material.problems, *material.scenes):
        numbers = (
            tuple(float(case.parameters[q.name]) for q in case.system.parameters),
            tuple(float(case.inputs[q.name]) for q in case.system.inputs),
        )
        found = Known(case.name, case.system, Layout.of(case.system), *numbers)
        if case in material.closed or taken(found.held(case.system)):
            yield found


def perturbed(chosen: Known, draw: random.Random) -> tuple[System, str]:
    """Return a system whose rates are changed by a term of time, states and parameters, and the words.

    The term is added to one rate, or one and the term is a factor of one rate, of all rates, or of a
    parameter wherever that stands, if that changes a value at all: not of a rate that is zero. No term is
    one that some closed form has room for: powers are above two.
    """
    system = chosen.system
    term = _amplitude(draw) * draw.choice(SHAPES)(_argument(system, draw), draw)
    way = draw.choice((_added, _scaled, _varied))
    changed, where = way(system, draw)
    if not chosen.differs(changed(sp.Integer(1))):
        changed, where = _added(system, draw)
    rates = changed(term)
    moved = replace(system, rates=rates, attitudes=(), numbers="values")
    return moved, f"{term} {where}"[:200]


Change = tuple[Callable[[Expr], tuple[Expr, ...]], str]
"""From a term to the rates that it changes; and where it is."""


def _added(system: System, draw: random.Random) -> Change:
    k = draw.randrange(len(system.states))

    def rates(term: Expr) -> tuple[Expr, ...]:
        return tuple(r + term if i == k else r for i, r in enumerate(system.rates))

    return rates, f"in the rate of {system.states[k].name}"


def _scaled(system: System, draw: random.Random) -> Change:
    k = draw.choice([*range(len(system.states)), None])

    def rates(term: Expr) -> tuple[Expr, ...]:
        return tuple(r * (1 + term) if k in (i, None) else r for i, r in enumerate(system.rates))

    place = "all rates" if k is None else f"the rate of {system.states[k].name}"
    return rates, f"as a factor of {place}"


def _varied(system: System, draw: random.Random) -> Change:
    if not system.parameters:
        return _scaled(system, draw)
    p = draw.choice([q.symbol for q in system.parameters])

    def rates(term: Expr) -> tuple[Expr, ...]:
        return tuple(system.expand(r).xreplace({p: p * (1 + term)}) for r in system.rates)

    return rates, f"as a factor of {p}"


def _amplitude(draw: random.Random) -> Expr:
    size = Fraction(draw.randint(1, 99), 10) * Fraction(10) ** draw.randint(-LARGEST, LARGEST)
    if draw.random() < 0.2:
        size = Fraction(2) ** draw.randint(-1000, 1000)
    return draw.choice((-1, 1)) * sp.Rational(size.numerator, size.denominator)


def _argument(system: System, draw: random.Random) -> Expr:
    """Return (v - place)/width of time or a state, at any place and width; or times another."""
    variables = [system.time, *(q.symbol for q in system.states)]
    place = sp.Rational(draw.randint(-500, 500), 10)
    width = sp.Rational(1, 10) * 10 ** draw.randint(-3, 4)
    z = (draw.choice(variables) - place) / width
    if draw.random() < 0.3:
        z *= draw.choice([*variables, *(q.symbol for q in system.parameters)])
    return z


Shape = Callable[[Expr, random.Random], Expr]
SHAPES: Sequence[Shape] = (
    lambda z, draw: z ** draw.randint(3, 9),
    lambda z, draw: z ** draw.choice((101, 401)),
    lambda z, draw: sp.exp(-(z**2)),
    lambda z, draw: sp.tanh(z) - sp.tanh(z - draw.randint(1, 9)),
    lambda z, draw: sp.tanh(draw.choice((1, 30, 1000)) * z),
    lambda z, draw: sp.exp(z),
    lambda z, draw: sp.log(1 + sp.exp(-100 * z)),
    lambda z, draw: sp.sin(z) ** draw.randint(1, 3),
    lambda z, draw: 1 / (1 + z ** (2 * draw.randint(1, 20))),
    lambda z, draw: sp.Max(z, 0) ** draw.randint(1, 3),
    lambda z, draw: sp.Piecewise((0, z < draw.randint(1, 9)), (z, True)),
)
"""Powers, pulses, windows, friction, exponentials, soft and hard stops, waves, resonances."""
