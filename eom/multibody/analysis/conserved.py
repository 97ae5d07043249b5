"""Conserved quantities by an ansatz: polynomials in speeds over sines and cosines of angles.

F = sum of c_k f_k is constant if sum of c_k f_k' = 0 along every motion. With the accelerations put in and
denominators cleared that is linear in the c_k, coefficient by coefficient of the products of speeds, sines
and cosines (of which sin^2 = 1 - cos^2 is the one relation). A prime field finds how many solutions there
are and which f_k they need; those are solved for exactly, over quotients of parameters, and F' = 0 is
proved. Products of what was found are left out. Source of the idea: Whittaker, Analytical Dynamics
(1937), ch. XII, on integrals that are polynomial in the velocities.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement, islice, product
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from eom.derivations.verification import DerivationError
from eom.errors import InputError, shown, typed
from eom.exact.identity import vanishes
from eom.fields import RESIDUES, Echelon
from eom.multibody.analysis.energies import Equations, Lagrangian, depends, equations_of
from eom.multibody.analysis.tidy import determinant, stand_ins, tidy
from eom.multibody.closed.forms import ClosedForm

Expr = Any
MOST = 400
"""Functions of an ansatz."""
LARGEST = 12
"""Degree in speeds, sines and cosines, and coordinates."""


@dataclass(frozen=True)
class Conserved:
    """A constant of the motion, proved: ``expression``, of ``degree`` in the speeds."""

    expression: Expr
    degree: int


@typed
def conserved_quantities(
    source: ClosedForm | Lagrangian | Equations,
    *,
    rates: int = 2,
    harmonics: int = 2,
    powers: int = 2,
) -> tuple[Conserved, ...]:
    """Return constants of the motion of a stated form, each proved; none of other forms are seen.

    Parameters
    ----------
    source : ClosedForm or Lagrangian or Equations
        A closed form, a Lagrangian or equations.
    rates : int, default 2
        Largest degree in the speeds.
    harmonics : int, default 2
        Largest degree in sines and cosines of coordinates.
    powers : int, default 2
        Largest degree in coordinates that stand in no sine or cosine.

    Returns
    -------
    tuple of Conserved
        Each proved, over the coordinates that occur in the equations or the Lagrangian, and their
        rates. Products and sums of those found are left out; constants of other forms are not seen.

    Raises
    ------
    InputError
        For degrees that are no whole numbers from 0 to 12, an ansatz too large, and equations that
        are no quotients of polynomials.
    DerivationError
        If a proof failed.

    Notes
    -----
    Units are those that follow from the source.

    References
    ----------
    Whittaker, Analytical Dynamics (1937), ch. XII.

    Examples
    --------
    >>> q, u = sp.symbols("q u", real=True)
    >>> m, k = sp.symbols("m k", positive=True)
    >>> oscillator = Lagrangian("oscillator", {q: u}, m * u**2 / 2, k * q**2 / 2)
    >>> [c.expression for c in conserved_quantities(oscillator)]
    [k*q**2 + m*u**2]
    """
    given = equations_of(source)
    check_degrees(given.name, rates=rates, harmonics=harmonics, powers=powers)
    ring = _Ring(given, _further(source))
    ansatz = [list(islice(ring.functions(n, harmonics, powers), MOST)) for n in range(rates + 1)]
    if sum(map(len, ansatz)) > MOST:
        raise InputError(
            "the ansatz is too large", where=given.name, got=f"over {MOST} functions",
            expected=f"at most {MOST}", hint="lower rates, harmonics or powers",
        )  # fmt: skip
    found: list[Conserved] = []
    columns: list[tuple[Expr, Any, Any]] = []
    for degree, new in enumerate(ansatz):
        columns += [(f, *ring.rate(f)) for f in new]
        known = [ring.coordinates_of(c, columns) for c in _products(found, degree)]
        beyond = ring.solve(columns, [k for k in known if k is not None])
        back = {x: sp.sin(a) / (1 + sp.cos(a)) for a, x in ring.halves.items()}
        found += [Conserved(_proved(given, F.xreplace(back)), degree) for F in beyond]
    return tuple(found)


def check_degrees(where: str, **degrees: Any) -> None:
    """Raise `InputError` for degrees of an ansatz that are no whole numbers up to `LARGEST`."""
    for name, n in degrees.items():
        if isinstance(n, bool) or not isinstance(n, int) or not 0 <= n <= LARGEST:
            raise InputError(
                f"{name} is no whole number from 0 to {LARGEST}", where=where, got=shown(n)
            )


def _further(source: Any) -> list[Expr]:
    """Return coordinates that a Lagrangian depends on, though its equations do not: as one that falls."""
    if not isinstance(source, Lagrangian):
        return []
    known = source.equations.occurring
    return [q for q in source.rates if q not in known and depends(source.expression, q)]


def _products(found: Sequence[Conserved], degree: int) -> Iterator[Expr]:
    """Yield the products of constants up to a degree."""
    for count in range(1, degree + 2):
        for chosen in combinations_with_replacement(found, count):
            if sum(c.degree for c in chosen) <= degree:
                yield sp.Mul(*(c.expression for c in chosen))


class _Ring:
    """Polynomials in speeds, sines and cosines, powers of coordinates, over rationals in parameters."""

    def __init__(self, given: Equations, further: Sequence[Expr] = ()) -> None:
        self.halves = _halves(given)
        self.given = given = _expanded(given, self.halves)
        parts = (*given.mass, *given.rest, *(given.rate(q) for q in given.occurring))
        self.angles = sorted({f.args[0] for e in parts for f in e.atoms(sp.sin, sp.cos)}, key=str)
        self.plain = [*(q for q in given.occurring if q not in self.angles), *further]
        self._refuse(parts)
        trigonometric = [f(a) for a in self.angles for f in (sp.sin, sp.cos)]
        self.names = {f: sp.Dummy(str(f)) for f in trigonometric}
        moving = {*self.angles, *self.plain, *given.speeds}
        free = set().union(*(e.free_symbols for e in parts)) - moving
        self.parameters = sorted(free, key=str)
        self.generators = [*given.speeds, *self.names.values(), *self.plain]
        field = sp.QQ.frac_field(*self.parameters) if self.parameters else sp.QQ
        self.ring = sp.polys.rings.PolyRing(self.generators, field, sp.polys.orderings.lex)
        gens = dict(zip(self.generators, self.ring.gens, strict=True))
        self.relations = [
            gens[self.names[sp.sin(a)]] ** 2 + gens[self.names[sp.cos(a)]] ** 2 - 1
            for a in self.angles
        ]
        self._motion()

    def _refuse(self, parts: Sequence[Expr]) -> None:
        for a in self.angles:
            if a not in self.given.occurring or any(
                e.xreplace({sp.sin(a): sp.Dummy(), sp.cos(a): sp.Dummy()}).has(a) for e in parts
            ):
                raise InputError(
                    "no ansatz: a coordinate stands in a sine and beside it, or something else than a "
                    "coordinate in one",
                    where=self.given.name,
                    got=str(a),
                )

    def _motion(self) -> None:
        """Keep the rates of everything times one denominator."""
        given = self.given
        whole = determinant(given.mass.tolist())
        right = [-x for x in given.rest]
        above = [
            determinant([[right[i] if j == k else x for j, x in enumerate(row)]
                         for i, row in enumerate(given.mass.tolist())])
            for k in range(len(given.speeds))
        ]  # fmt: skip
        rates = {
            u: sp.expand_trig(tidy(x / whole)) for u, x in zip(given.speeds, above, strict=True)
        }
        rates |= {q: given.rate(q) for q in (*self.angles, *self.plain)}
        pieces = {s: sp.fraction(sp.together(x)) for s, x in rates.items()}
        below = self.lift(sp.S.One)
        for _, d in pieces.values():
            below = below.lcm(self.lift(d))
        self.rates = {
            s: self.reduced(self.lift(n) * below.exquo(self.lift(d)))
            for s, (n, d) in pieces.items()
        }

    def lift(self, e: Expr) -> Any:
        """Return an expression as a polynomial. Raises `InputError` for what is none."""
        try:
            return self.ring.from_expr(sp.expand(e.xreplace(self.names)))
        except (ValueError, sp.CoercionFailed) as error:
            raise InputError(
                "the equations are no quotients of polynomials in rates, sines and cosines",
                where=self.given.name,
                got=str(e),
            ) from error

    def reduced(self, x: Any) -> Any:
        """Return a polynomial with every sin^2 replaced."""
        return x.rem(self.relations) if self.relations else x

    def functions(self, degree: int, harmonics: int, powers: int) -> Iterator[Expr]:
        """Yield the functions of the ansatz of one degree in the speeds; sines at most once each."""
        moved = [sp.Mul(*c) for c in combinations_with_replacement(self.given.speeds, degree)]
        waves = _bounded(len(self.angles), harmonics)
        places = _bounded(len(self.plain), powers)
        for u, n, p in product(moved, waves, places):
            sines = product(*((0, 1) if k else (0,) for k in n))
            power = sp.Mul(*(q**k for q, k in zip(self.plain, p, strict=True)))
            for s in sines:
                wave = sp.Mul(*(sp.sin(a) ** j * sp.cos(a) ** (k - j)
                                for a, j, k in zip(self.angles, s, n, strict=True)))  # fmt: skip
                if u * wave * power != 1:
                    yield u * power * wave

    def rate(self, f: Expr) -> tuple[Any, Any]:
        """Return a function, and its rate times the denominator, as polynomials."""
        total = self.ring.zero
        for s in f.free_symbols & self.rates.keys():
            total = total + self.lift(sp.diff(f, s)) * self.rates[s]
        return self.reduced(self.lift(f)), self.reduced(total)

    def coordinates_of(self, F: Expr, columns: Sequence[tuple[Expr, Any, Any]]) -> list[Any] | None:
        """Return what multiplies each function in a sum of them, its constant left out; or None."""
        left = self.reduced(self.lift(F))
        places = {next(iter(f.monoms())): k for k, (_, f, _) in enumerate(columns) if len(f) == 1}
        found = [self.ring.domain.zero] * len(columns)
        for monomial, coefficient in left.terms():
            if monomial in places:
                found[places[monomial]] = coefficient
            elif any(monomial):
                return None
        return found

    def solve(
        self, columns: Sequence[tuple[Expr, Any, Any]], known: Sequence[Sequence[Any]]
    ) -> Iterator[Expr]:
        """Yield sums of functions whose rate vanishes, beyond the span of the known ones."""
        monomials = sorted({m for _, _, r in columns for m in r.monoms()})
        matrix = [[r.get(m, self.ring.domain.zero) for _, _, r in columns] for m in monomials]
        used = self._support(matrix, len(columns))
        if not used:
            return
        rows = [[row[k] for k in used] for row in matrix] or [[self.ring.domain.zero] * len(used)]
        exact = DomainMatrix(rows, (len(rows), len(used)), self.ring.domain)
        kernel = exact.to_field().nullspace().to_Matrix().tolist()
        span = Echelon(RESIDUES, len(columns))
        point = self._point(1)
        for row in known:
            span.add([self._residue(x, point) for x in row])
        for row in kernel:
            full = dict(zip(used, row, strict=True))
            domain = self.ring.domain
            values = [
                domain.from_sympy(full[k]) if k in full else domain.zero
                for k in range(len(columns))
            ]
            before = len(span.rows)
            span.add([self._residue(x, point) for x in values])
            if len(span.rows) > before:
                yield sp.Add(*(c * columns[k][0] for k, c in full.items()))

    def _support(self, matrix: Sequence[Sequence[Any]], width: int) -> list[int]:
        """Return the functions that solutions need, by numbers in a prime field for parameters."""
        form, point = Echelon(RESIDUES, width), self._point(0)
        for row in matrix:
            form.add([self._residue(x, point) for x in row])
        free = [k for k in range(width) if k not in form.rows]
        needed = set(free)
        for k in free:
            needed |= {pivot for pivot, x in form.column(k).items() if x}
        return sorted(needed)

    def _point(self, seed: int) -> list[int]:
        generator = random.Random(seed)  # noqa: S311 - reproducible points, no secrets
        return [RESIDUES.draw(generator) for _ in self.parameters]

    def _residue(self, x: Any, point: Sequence[int]) -> int:
        if not self.parameters:
            return int(RESIDUES.of(int(x.numerator), int(x.denominator)))
        above, below = (_at(part, point) for part in (x.numer, x.denom))
        return int(RESIDUES.reduce(above * RESIDUES.inverse(below)))


def _halves(given: Equations) -> dict[Expr, Expr]:
    """Return the tangents of half of each angle that is constant: its sine and cosine are quotients."""
    parts = (*given.mass, *given.rest, *given.kinematics)
    moving = {*given.coordinates, *given.speeds}
    atoms = set().union(*(sp.expand_trig(e).atoms(sp.sin, sp.cos) for e in parts))
    angles = sorted({f.args[0] for f in atoms if not f.free_symbols & moving}, key=str)
    return {a: sp.Dummy("h", dummy_index=k) for k, a in enumerate(angles)}


def _expanded(given: Equations, halves: Mapping[Expr, Expr]) -> Equations:
    """Return equations in which no sum stands in a sine, and no constant."""
    known = {sp.sin(a): 2 * x / (1 + x**2) for a, x in halves.items()}
    known |= {sp.cos(a): (1 - x**2) / (1 + x**2) for a, x in halves.items()}

    def put(e: Expr) -> Expr:
        return sp.expand_trig(e).xreplace(known)

    return replace(
        given,
        mass=sp.ImmutableMatrix(given.mass.applyfunc(put)),
        rest=tuple(map(put, given.rest)),
        kinematics=tuple(map(put, given.kinematics)),
    )


def _at(x: Any, point: Sequence[int]) -> int:
    total = 0
    for monomial, c in x.terms():
        factors = [RESIDUES.power(v, n) for v, n in zip(point, monomial, strict=True)]
        number = RESIDUES.of(int(c.numerator), int(c.denominator))
        total = RESIDUES.reduce(total + number * RESIDUES.product(factors))
    return total


def _bounded(count: int, most: int) -> list[tuple[int, ...]]:
    """Return exponents of some factors with a sum up to ``most``."""
    return [n for n in product(range(most + 1), repeat=count) if sum(n) <= most]


def _primitive(F: Expr, moving: set[Expr], speeds: set[Expr]) -> Expr:
    """Return an expression without constant factors, most terms with speeds positive."""
    names = stand_ins(sorted(F.atoms(sp.sin, sp.cos), key=str))
    back = {v: k for k, v in names.items()}
    kept = {*names.values(), *moving}
    _, factors = sp.factor_list(F.xreplace(names))
    made = sp.expand(sp.Mul(*(b**n for b, n in factors if b.free_symbols & kept)))
    fast = [t for t in sp.Add.make_args(made) if t.free_symbols & speeds]
    minus = sum(t.as_coeff_Mul()[0].is_negative for t in fast)
    return tidy((-made if 2 * minus > len(fast) else made).xreplace(back))


def _proved(given: Equations, F: Expr) -> Expr:
    """Return a constant without denominators. Raises `DerivationError` if it is none."""
    moving, speeds = {*given.coordinates, *given.speeds}, {*given.speeds}
    leading = (
        c for c in sp.Poly(sp.expand(F), *given.speeds).coeffs() if not c.free_symbols & moving
    )
    first = next((c for c in leading if c.has(sp.sin, sp.cos)), sp.S.One)
    F = _primitive(tidy(sp.fraction(sp.together(tidy(F / first)))[0]), moving, speeds)
    rates: Mapping[Expr, Expr] = dict(zip(given.coordinates, given.kinematics, strict=True))
    moved = sum(sp.diff(F, q) * v for q, v in rates.items() if q in F.free_symbols)
    by_speed = sp.Matrix([sp.diff(F, u) for u in given.speeds])
    whole = determinant(given.mass.tolist())
    forced = by_speed.T * given.mass.adjugate() * sp.Matrix(given.rest)
    if not vanishes(moved * whole - forced[0]):
        raise DerivationError("a constant of the motion changes", where=given.name, got=F)
    return F
