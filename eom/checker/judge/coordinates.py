"""Partial derivatives of quantities of a system by its coordinates, rates, speeds and momenta.

Energies are functions of coordinates and speeds that need not be rates: those of a body are components of
its angular velocity. So speeds are written in coordinates and their rates first; what is held beside
the variable is then what the formula is written in. A momentum in a formula is a variable in the place of
the rate that belongs to it, as in Hamilton's equations with all of them, and in Routh's with some.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

import sympy as sp

from eom.checker.mean.claims import CONSTANT, DEFINITION, EQUALITIES, SAME_POINT, Claim
from eom.checker.mean.dimensions import dimension
from eom.checker.mean.model import PLACES, Model
from eom.checker.mean.solid_models import COORDINATES, integrated
from eom.checker.mean.values import atoms_in, inverse_of
from eom.errors import InputError
from eom.system import Expr, System
from eom.terms.terms import (
    INERTIAL,
    MATRIX,
    SCALAR,
    VECTOR,
    Term,
    add,
    at,
    der,
    expr,
    mul,
    nodes,
    number,
    partial,
)
from eom.terms.vocabulary import described
from eom.worlds.solutions import (
    anything,
    instant,
    rate,
    real_point,
    since,
    start,
)
from eom.worlds.worlds import SLOPE

MOMENTA = ("kg m/s", "kg m^2/s")
DIGITS = 30
_NEARLY = 1e-15


@dataclass(frozen=True)
class Chart:
    """Symbols for the rates of coordinates, and speeds in terms of coordinates and those symbols."""

    rates: Mapping[Expr, Expr]
    speeds: Mapping[Expr, Expr]
    kinematics: Mapping[Expr, Expr]


@lru_cache(maxsize=16)
def chart(system: System) -> Chart:
    """Return coordinates and speeds. Raises `InputError` where there are not as many of both."""
    named = enumerate(zip(system.states, system.rates, strict=True))
    found = {q.symbol: (k, r) for k, (q, r) in named if q.unit in PLACES}
    places = {s: system.expand(r) for s, (_, r) in found.items()}
    used = frozenset().union(*(r.free_symbols for r in places.values()))
    speeds = [q.symbol for q in system.states if q.unit not in PLACES and q.symbol in used]
    plain = bool(found) and all(_is_explicit(system, k) for k, _ in found.values())
    if len(found) != len(speeds) or not plain:
        raise InputError("the coordinates of this system are no independent ones", got=system.name)
    rates = {s: sp.Dummy(f"{s}_rate", real=True) for s in places}
    kinematic = sp.Matrix(list(places.values()))
    matrix = kinematic.jacobian(speeds)
    if matrix.free_symbols & set(speeds):
        raise InputError("speeds that are not linear in the rates of coordinates", got=system.name)
    rest = kinematic.subs(dict.fromkeys(speeds, 0))
    solved = matrix.LUsolve(sp.Matrix(list(rates.values())) - rest)
    spelt = dict(zip(speeds, map(sp.simplify, solved), strict=True))
    return Chart(rates, spelt, {d: places[s] for s, d in rates.items()})


def _is_explicit(system: System, k: int) -> bool:
    """Return whether the rate of a state stands alone in its equation."""
    matrix = system.mass_matrix
    return matrix is None or list(matrix[k, :]) == list(sp.eye(matrix.rows)[k, :])


Momenta = Mapping[Expr, tuple[Expr, Expr]]
"""Symbols of momenta, with what they are in speeds, and the coordinate of each."""


def derivative(
    system: System,
    f: Expr,
    variable: Expr,
    held: Momenta | None = None,
    canonical: Collection[str] = (),
) -> Expr:
    """Return the partial derivative of an expression over quantities of a system, rates among them.

    ``held``: symbols that the note has for momenta; ``canonical``: names of functions of coordinates and
    momenta. Raises `InputError` for what is no variable, and where it is open what is held beside it.
    """
    known, momenta = chart(system), {**_momenta(system), **(held or {})}
    own = {s: m for s, m in momenta.items() if s in f.free_symbols}
    by_all = not {str(s) for s in f.free_symbols}.isdisjoint(canonical)
    if by_all or (variable in momenta and variable not in own):
        own |= {variable: momenta[variable]} if variable in momenta else {}
        own = _all_momenta(system, own)
    loose = _loose(system, f) - own.keys()
    full = _written_out(system, f, {*own, *loose}).xreplace(
        {rate(s): d for s, d in known.rates.items()}
    )
    if variable in known.rates and not own and _is_energy(system, f, full):
        raise _open(str(f))
    by = known.rates.get(variable.args[0], variable) if isinstance(variable, rate) else variable
    if loose and full.free_symbols & {*known.speeds, *known.rates.values()}:
        raise _open(f"{f} has momenta beside other speeds")
    if own or by not in known.speeds:
        full = full.xreplace(known.speeds)
    full = full.xreplace(_without_rates(system, known, own)) if own else full
    if by in known.speeds:
        full = full.xreplace(known.kinematics)
    variables = {*known.rates, *known.rates.values(), *known.speeds, *own, *loose, system.time}
    if by not in variables or full.has(rate):
        raise InputError("no partial derivative of a quantity of this system", got=variable)
    return full.diff(by).xreplace({d: rate(s) for s, d in known.rates.items()})


@lru_cache(maxsize=16)
def _conjugate(system: System) -> frozenset[Expr]:
    """Return what is the derivative of an energy of the system by a rate."""
    known, point = chart(system), real_point(system, 0)
    named = (*system.outputs, *system.invariants)
    energies = [d for d in named if dimension(d.quantity.unit) == dimension("J")]
    at_rates = {d: r.evalf(DIGITS, subs=point) for d, r in known.kinematics.items()}

    def value(e: Expr) -> Expr:
        return e.xreplace(known.speeds).xreplace(at_rates).evalf(DIGITS, subs=point)

    rates = {rate(s): d for s, d in known.rates.items()}
    full = [_written_out(system, d.expression, ()).xreplace(rates) for d in energies]
    slopes = [value(e.xreplace(known.speeds).diff(d)) for e in full for d in rates.values()]
    likely = [d for d in named if dimension(d.quantity.unit) in map(dimension, MOMENTA)]
    values = {d.symbol: value(_written_out(system, d.expression, ())) for d in likely}
    return frozenset(s for s, v in values.items() if any(_same(v, w) for w in slopes))


def _momenta(system: System) -> dict[Expr, tuple[Expr, Expr]]:
    """Return the momenta of coordinates, by the names of both."""
    outputs = {d.quantity.name: d for d in (*system.outputs, *system.invariants)}
    named = ((outputs.get(f"p_{q}"), q) for q in chart(system).rates)
    return {
        d.symbol: (d.expression, q)
        for d, q in named
        if d is not None and d.symbol in _conjugate(system)
    }


def _all_momenta(system: System, own: Momenta) -> dict[Expr, tuple[Expr, Expr]]:
    """Return some momenta with those of all other coordinates. Raises `InputError` if one is not known."""
    places = set(chart(system).rates)
    missing = places - {q for _, q in own.values()}
    found = {**own, **{s: m for s, m in _momenta(system).items() if m[1] in missing}}
    if {q for _, q in found.values()} != places:
        raise _open("not all momenta are known")
    return found


def _loose(system: System, f: Expr) -> set[Expr]:
    """Return the momenta in a formula, whatever coordinates they belong to."""
    return set(f.free_symbols & _conjugate(system))


def _without_rates(system: System, known: Chart, own: Momenta) -> dict[Expr, Expr]:
    """Return the rates that belong to momenta in terms of these."""
    gone = [known.rates[q] for _, q in own.values()]
    if len(set(gone)) != len(gone):
        raise _open("two momenta of one coordinate")
    left = [
        _written_out(system, e, ())
        .xreplace({rate(s): d for s, d in known.rates.items()})
        .xreplace(known.speeds)
        for e, _ in own.values()
    ]
    matrix = sp.Matrix(left).jacobian(gone)
    rest = sp.Matrix(left).xreplace(dict.fromkeys(gone, sp.S.Zero))
    solved = matrix.LUsolve(sp.Matrix(list(own)) - rest)
    return dict(zip(gone, solved, strict=True))


def _open(got: str) -> InputError:
    return InputError(
        "whether rates or momenta are held is open",
        got=got,
        expected="a function of coordinates and rates alone, or one that is written with momenta",
    )


def _same(a: Expr, b: Expr) -> bool:
    return bool((a - b).is_number and abs(a - b) < _NEARLY * (1 + abs(a)))


def _written_out(system: System, f: Expr, own: Iterable[Expr]) -> Expr:
    """Return an expression over states, parameters and inputs, and what is a variable of its own."""
    found: dict[Any, Expr] = {}
    states = {q.symbol for q in (*system.states, *system.parameters, *system.inputs)}
    for d in (*system.outputs, *system.invariants):
        if d.symbol not in {*own, *states} and d.expression != d.symbol:
            found.setdefault(d.symbol, d.expression)
    while f.free_symbols & found.keys():
        f = f.xreplace(found)
    return system.expand(f)


def _is_energy(system: System, f: Expr, full: Expr) -> bool:
    """Return whether an expression is the total energy, and more than a kinetic one by its name."""
    energies = [
        d.expression for d in system.invariants if dimension(d.quantity.unit) == dimension("J")
    ]
    outputs = {d.name for d in system.outputs}
    if str(f) == next((n for n in ("kinetic_energy", "T") if n in outputs), ""):
        return False
    known, point = chart(system), real_point(system, 0)
    at_rates = {d: r.evalf(DIGITS, subs=point) for d, r in known.kinematics.items()}
    values = [full.xreplace(at_rates)] + [_written_out(system, e, ()) for e in energies]
    first, *rest = (v.evalf(DIGITS, subs=point) for v in values)
    return any(_same(v, first) for v in rest)


def share(left: Iterable[Term], right: Iterable[Term], free: Collection[str]) -> bool:
    """Return whether sides have the same coordinates (``free``: their kinds) and a function of these."""
    sides = [[tuple(map(str, a.data)) for a in side] for side in (left, right)]
    variables = [
        {tuple(v.split(" ", 1)) for d in s if d[0] == "function" for v in d[2:]} for s in sides
    ]
    moving = [v | {d for d in s if d[0] in free} for v, s in zip(variables, sides, strict=True)]
    functions = [{d[1].split(SLOPE)[0] for d in s if d[0] == "function"} for s in sides]
    return moving[0] == moving[1] and bool(functions[0] & functions[1])


def addends(term: Term) -> Iterator[Term]:
    """Yield the terms of a sum, those within an expression as well; none of a zero."""
    if term.head == "add":
        for a in term.args:
            yield from addends(a)
    elif term.head == "expr":
        yield from (expr(a) for a in sp.Add.make_args(term.data[0]))
    elif not term.is_zero:
        yield term


# -- claims as expressions ----------------------------------------------------------------------------


def of_system(term: Term) -> bool:
    """Whether a term is a quantity of the system."""
    return term.head == "atom" and term.data[:1] == ("system",)


def _atoms(claim: Claim) -> frozenset[Term]:
    return frozenset(a for m in claim.members for a in atoms_in(m.term, claim.scalars))


def on_solutions(claim: Claim) -> bool:
    """Whether a claim is judged on the solutions of the system of its note; no world has its values."""
    return claim.model is not None and any(map(of_system, _atoms(claim)))


ANYTHING = ("scalar", "coordinate", "free_angle")
"""Quantities that may stand beside those of a system, in what is true whatever they are."""


def covered(claim: Claim) -> bool:
    """Whether a claim is a relation between quantities of the system, besides scalars that are any."""
    atoms = _atoms(claim)
    known = all(of_system(a) or _is_axis(a) or a.data[0] in ANYTHING for a in atoms)
    return known and any(map(of_system, atoms)) and all(_listed(m.term) for m in claim.members)


def _is_axis(term: Term) -> bool:
    """Whether a term is a unit vector of the inertial frame."""
    return term.data[:2] == ("unit", INERTIAL)


def tells_time(claim: Claim, model: Model) -> bool:
    """Return whether a claim names the time, on which the laws of the system do not depend."""
    inside = (n for m in claim.members for n in nodes(m.term) if n.head == "expr")
    symbols = {s for n in inside for s in n.data[0].free_symbols - claim.scalars.keys()}
    laws = frozenset[Expr]().union(*(r.free_symbols for r in model.system.rates))
    return any(s.name == "t" for s in symbols) and model.system.time not in laws


def _listed(term: Term) -> bool:
    """Whether a term is a scalar, or its elements are known one by one."""
    if term.kind == VECTOR:
        with suppress(InputError):
            return bool(components(term))
        return False
    inertial = term.head != "column" or term.data == (INERTIAL,)
    return term.kind == SCALAR or (
        term.head in _TABLED and inertial and all(map(_listed, term.args))
    )


def components(term: Term) -> tuple[Term, ...]:
    """Return the components of a vector in inertial axes. Raises `InputError` where they are not known."""
    if term.kind == VECTOR and term.head in _VECTORS:
        return _VECTORS[term.head](term)
    raise InputError("this is no quantity of the system", got=described(term))


def _atom_components(term: Term) -> tuple[Term, ...]:
    """Return the components of a unit vector, or of a vector of the system, as atoms with a number."""
    if _is_axis(term):
        return tuple(number(int(str(k) == term.data[2])) for k in (1, 2, 3))
    if not of_system(term):
        raise InputError("this is no quantity of the system", got=described(term))
    return tuple(Term("atom", (), (*term.data, str(k))) for k in (1, 2, 3))


def _crossed(term: Term) -> tuple[Term, ...]:
    (a, b, c), (x, y, z) = map(components, term.args)
    pairs = ((b, z, c, y), (c, x, a, z), (a, y, b, x))
    return tuple(add(mul(p, q), mul(number(-1), r, s)) for p, q, r, s in pairs)


def _differentiated(term: Term) -> tuple[Term, ...]:
    if term.data != (INERTIAL,):
        raise InputError("a derivative in another frame than the inertial one", got=term.data[0])
    return tuple(map(der, components(term.args[0])))


_VECTORS: Mapping[str, Callable[[Term], tuple[Term, ...]]] = {
    "atom": _atom_components,
    "cross": _crossed,
    "der": _differentiated,
    "mul": lambda t: tuple(mul(*t.args[:-1], e) for e in components(t.args[-1])),
    "add": lambda t: tuple(add(*row) for row in zip(*map(components, t.args), strict=True)),
    "zero": lambda _: (number(0),) * 3,
    "at": lambda t: tuple(at(e, *t.data) for e in components(t.args[0])),
    "partial": lambda t: tuple(partial(e, t.args[1]) for e in components(t.args[0])),
}
"""Components of vectors in inertial axes, by head."""


def written(term: Term, scalars: Mapping[Any, Term], model: Model) -> Expr:
    """Return a scalar term as an expression over the system's symbols, with `rate` for derivatives.

    Raises `InputError` for what is no scalar of the system.
    """
    special = _WRITTEN.get(term.head)
    if special is not None:
        return special(term, scalars, model)
    inside = tuple(written(a, scalars, model) for a in term.args)
    if term.head == "integral" and model.body is not None:
        return integrated(model.body, inside[0])
    if term.head in _JOINED:
        return _JOINED[term.head](*inside)
    raise InputError("this is no quantity of the system", got=described(term))


def _plainly(term: Term, scalars: Mapping[Any, Term], model: Model) -> Expr:
    """Return an expression with what its symbols stand for."""
    free = term.data[0].free_symbols
    own = {s: written(scalars[s], scalars, model) for s in free if s in scalars}
    time = {s: model.system.time for s in free if s not in scalars and s.name == "t"}
    return term.data[0].xreplace(own | time)


def _quantity(term: Term, _: Mapping[Any, Term], model: Model) -> Expr:
    """Return a quantity of the system, the component of a vector of it, or a letter that is any."""
    if term.data[0] in ANYTHING:
        moving = int(term.data[0] != ANYTHING[0])
        return anything(sp.Symbol(term.data[1], real=True), moving)
    if not of_system(term):
        raise InputError("this is no quantity of the system", got=described(term))
    name, *place = term.data[1:]
    return model.vector(name)[int(place[0]) - 1] if place else model.symbol(name)


def _inner(term: Term, scalars: Mapping[Any, Term], model: Model) -> Expr:
    a, b = (elements(x, scalars, model) for x in term.args)
    return sp.Add(*map(sp.Mul, a, b))


def _then(term: Term, scalars: Mapping[Any, Term], model: Model) -> Expr:
    return instant(written(term.args[0], scalars, model), sp.Symbol(term.data[0]))


def _changing(e: Expr) -> Expr:
    return e if e == 0 else rate(e)


_JOINED = {
    "add": sp.Add,
    "mul": sp.Mul,
    "since": since,
    "start": start,
    "der": _changing,
    "zero": lambda: sp.S.Zero,
}

Rows = list[list[Expr]]


def elements(term: Term, scalars: Mapping[Any, Term], model: Model) -> tuple[Expr, ...]:
    """Return a scalar, the elements of a column, matrix or table row by row, or inertial components."""
    return tuple(e for row in _rows(term, scalars, model) for e in row)


def _rows(term: Term, scalars: Mapping[Any, Term], model: Model) -> Rows:
    if term.kind == SCALAR:
        return [[written(term, scalars, model)]]
    if term.kind == VECTOR:
        return [[written(c, scalars, model)] for c in components(term)]
    if not _listed(term):
        raise InputError("this is no quantity of the system", got=described(term))
    return _TABLED[term.head](term, [_rows(a, scalars, model) for a in term.args])


def _shaped(term: Term, parts: list[Rows]) -> Rows:
    """Return scalars in the rows and columns that a term has."""
    flat = [p[0][0] for p in parts]
    columns = term.data[1] if term.head == "table" else 3 if term.kind == MATRIX else 1
    return [flat[k : k + columns] for k in range(0, len(flat), columns)]


def _each(rule: Callable[..., Expr], *parts: Rows) -> Rows:
    return [[rule(*e) for e in zip(*rows, strict=True)] for rows in zip(*parts, strict=True)]


def _scaled(_: Term, parts: list[Rows]) -> Rows:
    *factors, last = parts
    return _each(lambda e: sp.Mul(*(f[0][0] for f in factors), e), last)


def _times(a: Rows, b: Rows) -> Rows:
    return [[sp.Add(*map(sp.Mul, row, column)) for column in zip(*b, strict=True)] for row in a]


def _turned(a: Rows) -> Rows:
    return [list(row) for row in zip(*a, strict=True)]


def _skew(a: Rows) -> Rows:
    (x,), (y,), (z,) = a
    return [[sp.S.Zero, -z, y], [z, sp.S.Zero, -x], [-y, x, sp.S.Zero]]


_TABLED: dict[str, Callable[[Term, list[Rows]], Rows]] = {
    "column": lambda _, parts: parts[0],
    "entries": _shaped,
    "table": _shaped,
    "rows": lambda _, parts: [_turned(p)[0] for p in parts],
    "zero": lambda t, _: [[sp.S.Zero] * (3 if t.kind == MATRIX else 1) for _ in range(3)],
    "add": lambda _, parts: _each(sp.Add, *parts),
    "mul": _scaled,
    "matmul": lambda _, parts: _times(*parts),
    "outer_column": lambda _, parts: _times(parts[0], _turned(parts[1])),
    "transpose": lambda _, parts: _turned(parts[0]),
    "inverse": lambda _, parts: inverse_of(parts[0]),
    "tilde": lambda _, parts: _skew(parts[0]),
    **{head: lambda t, parts: _each(_JOINED[t.head], *parts) for head in ("der", "since", "start")},
}
"""One rule a head of columns, matrices and tables: from the rows of its arguments to its own."""


def _partial(term: Term, scalars: Mapping[Any, Term], model: Model) -> Expr:
    """Return a partial derivative; symbols that stand for momenta are variables of their own."""
    momenta = {s: sp.Dummy(s.name, real=True) for s, t in scalars.items() if _is_slope(t)}
    own = {**scalars, **{s: expr(d) for s, d in momenta.items()}}
    function, variable = (written(a, own, model) for a in term.args)
    used = {s: d for s, d in momenta.items() if function.has(d) or variable == d}
    meanings = {d: written(scalars[s], scalars, model) for s, d in used.items()}
    rates = {d: written(scalars[s].args[1], scalars, model) for s, d in used.items()}
    held = {d: (meanings[d], r.args[0]) for d, r in rates.items() if isinstance(r, rate)}
    found = derivative(model.system, function, variable, held, model.canonical)
    return found.xreplace(meanings)


_WRITTEN: Mapping[str, Callable[[Term, Mapping[Any, Term], Model], Expr]] = {
    "expr": _plainly,
    "atom": _quantity,
    "partial": _partial,
    "dot": _inner,
    "inner": _inner,
    "at": _then,
}


def _is_slope(term: Term) -> bool:
    """Whether a term is the slope of an energy along a rate: a momentum."""
    return term.head == "partial" and term.args[1].head == "der" and term.args[0].head != "partial"


def equations(claim: Claim, model: Model) -> list[tuple[Expr, Expr]]:
    """Return the pairs of expressions that a claim says are equal. Raises `InputError` for others."""
    others = [r for r in claim.relations if r not in EQUALITIES]
    if others or claim.kind == SAME_POINT:
        raise InputError("only equations between these are judged", got=others[0] if others else "")
    members = [elements(m.term, claim.scalars, model) for m in claim.members]
    if model.body is not None and any(
        e.free_symbols & set(COORDINATES) for m in members for e in m
    ):
        raise InputError("the place of an element outside of an integral")
    if claim.kind == CONSTANT:
        return [(e, sp.Integer(0)) for e in members[0]]
    links = list(pairwise(members))[int(claim.kind == DEFINITION) :]
    if any(len(a) != len(b) for a, b in links):
        raise InputError("tables of other sizes")
    return [pair for a, b in links for pair in zip(a, b, strict=True)]
