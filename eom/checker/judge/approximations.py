r"""Equations that hold nearly: where something is small, both sides agree to the order that is written.

``\sin\theta\approx\theta`` leaves out anything, ``1+\theta+O(\theta^2)`` says what. A side that is a
polynomial in what is small is written to its degree, of two such the shorter one; the difference has to be
of a higher order. What is small is what the note says, else an angle or a coordinate with its rates, or
all of them. Orders are found by the size of the difference for two small values, to many digits.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import sympy as sp

from eom.checker.judge.systems import on_solutions, written
from eom.checker.mean.claims import EQUALITIES, Claim
from eom.errors import InputError
from eom.terms.terms import SCALAR, Term, nodes
from eom.worlds.solutions import rate, real_point, without_rates

Expr = Any

NEARLY = frozenset({"approx", "simeq"})
DIGITS, FAR, NEAR = 150, -8, -12
EXACT = 99
"""Order of a difference that vanishes."""
FREELY = frozenset({"scalar", "coordinate", "free_angle", "angle", "turn_angle", "principal_angle"})
MAX_SIZE = 2000


@dataclass(frozen=True)
class Sides:
    """Two sides as they are written, and with all rates written out; symbols by what may be small."""

    shown: tuple[Expr, Expr]
    full: tuple[Expr, Expr]
    small: tuple[tuple[Expr, ...], ...]
    point: Mapping[Expr, Expr]


def is_nearly(claim: Claim) -> bool:
    """Return whether a claim has a sign of approximation, or says what it leaves out."""
    signs = set(claim.relations)
    plain = (
        bool(signs)
        and signs <= EQUALITIES | NEARLY
        and len(claim.members) == len(claim.relations) + 1
    )
    return plain and (bool(signs & NEARLY) or claim.order is not None)


def nearly(claim: Claim) -> tuple[bool, str]:
    """Return whether the links of a chain hold nearly, with the reason.

    Raises `InputError` where that is open: not all that may be small need be what the writer means.
    """
    reasons = []
    for (a, b), relation in zip(pairwise(claim.members), claim.relations, strict=True):
        if {a.shape, b.shape} != {SCALAR}:
            raise InputError("only scalars are compared nearly", got=f"{a.shape}, {b.shape}")
        exact = relation in EQUALITIES and claim.order is None
        sides = _sides(claim, a.term, b.term)
        found = [_orders(claim, sides, small) for small in ((),) if exact] or [
            _orders(claim, sides, small) for small in sides.small
        ]
        best = next((f for f in found if f.apart > f.wanted), None)
        if best is None:
            return False, _differs(found)
        reasons.append(
            f"to order {best.wanted} in small {_names(best.small)}" if best.small else ""
        )
    return True, "; ".join(dict.fromkeys(filter(None, reasons)))


@dataclass(frozen=True)
class Orders:
    """The order at which sides differ, that up to which they have to agree, and their own lowest ones."""

    small: tuple[Expr, ...]
    apart: int
    wanted: int
    own: tuple[int, int]

    @property
    def meant(self) -> bool:
        """Whether the writer means this to be small: both sides begin at one order, or with one term."""
        return self.own[0] == self.own[1] and (self.own[0] > 0 or self.apart > self.own[0])


def _differs(found: list[Orders]) -> str:
    """Return why two sides differ. Raises `InputError` where something else may be meant to be small."""
    meant = [f for f in found if f.meant or not f.small]
    if not meant:
        raise InputError("what is small here is not known")
    best = max(meant, key=lambda f: f.apart)
    return (
        f"the sides differ at order {best.apart} in small {_names(best.small)}"
        if best.small
        else ""
    )


def _names(small: tuple[Expr, ...]) -> str:
    return ", ".join(sorted({str(s) for s in small if not isinstance(s, sp.Dummy)}))


def _orders(claim: Claim, sides: Sides, small: tuple[Expr, ...]) -> Orders:
    left, right = sides.full
    first, second = (_vanishing(sides, (side, sp.Integer(0)), small) for side in (left, right))
    degrees = [_degree(s, small) for s in sides.shown]
    known = [d for d in degrees if d is not None] or [first]
    agreed = max(min(known), first if first == second else 0)
    wanted = agreed if claim.order is None else claim.order[1] - 1
    return Orders(
        small, _vanishing(sides, (left, right), small), wanted if small else 0, (first, second)
    )


def _degree(side: Expr, small: tuple[Expr, ...]) -> int | None:
    """Return the degree of a polynomial in what is small, None for anything else."""
    e = sp.Dummy("e")
    scaled = sp.expand(side.xreplace({s: e * s for s in small}))
    if not scaled.is_polynomial(e):
        return None
    return int(sp.degree(scaled, e)) if scaled.has(e) else 0


def _vanishing(sides: Sides, pair: tuple[Expr, Expr], small: tuple[Expr, ...]) -> int:
    """Return the order at which two expressions differ where something is small."""
    values = []
    for exponent in (FAR, NEAR):
        scale = sp.Integer(10) ** exponent
        at = {k: v * scale if k in small else v for k, v in sides.point.items()}
        a, b = (s.xreplace(at).evalf(DIGITS) for s in pair)
        if not (a.is_number and b.is_number and a.is_finite and b.is_finite):
            raise InputError("this has no value where something is small")
        values.append(abs(a - b))
    if max(values) < sp.Float(10, DIGITS) ** (-DIGITS + 20):
        return EXACT
    if not all(values):
        raise InputError("the order of the difference is not clear")
    return round(float(sp.log(values[0] / values[1], 10) / (FAR - NEAR)))


# -- sides ---------------------------------------------------------------------------------------------


def _sides(claim: Claim, a: Term, b: Term) -> Sides:
    made = _of_system if on_solutions(claim) else _of_scalars
    return made(claim, a, b)


def _of_system(claim: Claim, a: Term, b: Term) -> Sides:
    """Return sides over the states of the note's system."""
    model = claim.model
    assert model is not None
    system = model.system
    left, right = (written(t, claim.scalars, model) for t in (a, b))
    full = tuple(without_rates(system, s) for s in (left, right))
    if sum(int(s.count_ops()) for s in full) > MAX_SIZE:
        raise InputError("too long")
    states = [q.symbol for q in system.states]
    own = tuple(s for s in states if any(f.has(s) for f in (*full, left, right)))
    names: dict[Expr, Expr] = {}
    opaque = {d.symbol for d in (*system.outputs, *system.invariants)}
    pairs = zip((left, right), full, strict=True)
    shown = tuple(_flat(f if s.free_symbols & opaque else s, names) for s, f in pairs)
    rates = tuple(names.values())
    each = [(s, *(d for r, d in names.items() if _inner(r) == s)) for s in own]
    point = {**real_point(system, 0), **{d: sp.Integer(1) for d in rates}}
    every = (*own, *rates)
    return Sides(shown, full, tuple(dict.fromkeys([*each, every])), point)


def _flat(side: Expr, names: dict[Expr, Expr]) -> Expr:
    """Return a side with a symbol for every rate of a quantity."""

    def plain(e: Expr) -> Expr:
        if isinstance(e, rate) and _inner(e).is_Symbol:
            return names.setdefault(e, sp.Dummy(str(e), real=True))
        return e.func(*map(plain, e.args)) if e.args else e

    return plain(side)


def _inner(e: Expr) -> Expr:
    while isinstance(e, rate):
        e = e.args[0]
    return e


def _of_scalars(claim: Claim, a: Term, b: Term) -> Sides:
    """Return sides over free scalars, coordinates and their rates."""
    found: dict[Term, Expr] = {}
    full = tuple(_expression(t, claim.scalars, found) for t in (a, b))
    generator = random.Random("approximations")  # noqa: S311 - reproducible, no secret
    point = {s: sp.Rational(generator.randint(20, 90), 61) for s in found.values()}
    if claim.order is not None:
        small = [(_expression(claim.order[0].term, claim.scalars, found),)]
    else:
        groups: dict[Term, list[Expr]] = {}
        for term, symbol in found.items():
            groups.setdefault(_still(term), []).append(symbol)
        kinds = {t: t.data[0] for t in groups}
        angles = tuple(s for t, own in groups.items() if kinds[t] != "scalar" for s in own)
        small = [tuple(own) for own in groups.values()] + ([angles] if angles else [])
    return Sides(full, full, tuple(dict.fromkeys(small)), point)


def _still(term: Term) -> Term:
    while term.head == "der":
        term = term.args[0]
    return term


def _expression(term: Term, scalars: Mapping[Any, Term], found: dict[Term, Expr]) -> Expr:
    """Return a term over one symbol for each quantity and each of its rates."""
    if term.head in {"add", "mul"}:
        join = sp.Add if term.head == "add" else sp.Mul
        return join(*(_expression(t, scalars, found) for t in term.args))
    if term.head == "expr":
        inside = {
            s: _expression(scalars[s], scalars, found)
            for s in term.data[0].free_symbols
            if s in scalars
        }
        return term.data[0].xreplace(inside)
    inner = _still(term)
    if inner.head == "expr" and inner.data[0].is_Symbol and inner.data[0] in scalars:
        times = sum(1 for n in nodes(term) if n.head == "der")
        inner = scalars[inner.data[0]]
        term = inner
        for _ in range(times):
            term = Term("der", (term,), ("",))
    if inner.head != "atom" or inner.data[0] not in FREELY:
        raise InputError("this is nothing that may be small or fixed", got=term.head)
    name = "_".join(map(str, inner.data[1:2])) + "'" * sum(n.head == "der" for n in nodes(term))
    return found.setdefault(term, sp.Symbol(name, positive=True))
