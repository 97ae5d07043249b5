"""The torque-free rigid body in principal axes: constants, ellipsoids and polhode.

Everything follows from h = J omega, T = omega . h / 2 and dh/dt = 0 (Hughes, Spacecraft Attitude
Dynamics, 1986, ch. 4; Goldstein, Poole, Safko, 2002, sect. 5.6). Numbers are compared as
`eom.exact.numbers` says. The herpolhode is in `eom.mechanics.herpolhode`, steady spin in
`eom.mechanics.steady`, precession of the symmetric body in `eom.mechanics.precession`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact.numbers import number, sign, tolerance
from eom.kinematics.frames import Vector, vector
from eom.mass.inertia import check_principal_moments
from eom.mechanics.rigidbody import OMEGA, angular_momentum, principal_inertia
from eom.system import as_expression

Expr = Any

MOMENTS = tuple(q.symbol for q in principal_inertia()[1])
T, H = sp.Symbol("T", positive=True), sp.Symbol("H", positive=True)
SQUARES = tuple(sp.Symbol(f"s_{k}", nonnegative=True) for k in (1, 2, 3))
"""Squares of omega_1, omega_2, omega_3: 2 T and H^2 are linear in them."""


def constants(moments: Sequence[Expr] = MOMENTS, omega: Vector = OMEGA) -> tuple[Expr, Expr]:
    """Return kinetic energy T (J) and squared angular momentum H^2 (N^2 m^2 s^2) over omega.

    >>> constants()[1]
    I1**2*omega_1**2 + I2**2*omega_2**2 + I3**2*omega_3**2
    """
    h = angular_momentum(sp.diag(*moments), omega)
    return sp.expand(omega.dot(h) / 2), h.dot(h)


@dataclass(frozen=True)
class Ellipsoid:
    """The surface omega . form omega = level in the space of omega; semi-axes in rad/s."""

    form: Expr
    level: Expr

    @property
    def semi_axes(self) -> tuple[Expr, ...]:
        """Where the surface meets the axes b1, b2, b3."""
        return tuple(sp.sqrt(self.level) / sp.sqrt(self.form[k, k]) for k in range(3))


def energy_ellipsoid() -> Ellipsoid:
    """Return the surface of constant T: omega . J omega = 2 T.

    >>> energy_ellipsoid().semi_axes[0]
    sqrt(2)*sqrt(T)/sqrt(I1)
    """
    return Ellipsoid(sp.ImmutableMatrix(sp.diag(*linear_constants(MOMENTS).row(0))), 2 * T)


def momentum_ellipsoid() -> Ellipsoid:
    """Return the surface of constant H: (J omega) . (J omega) = H^2.

    >>> momentum_ellipsoid().semi_axes[2]
    H/I3
    """
    return Ellipsoid(sp.ImmutableMatrix(sp.diag(*linear_constants(MOMENTS).row(1))), H**2)


def linear_constants(moments: Sequence[Expr]) -> Expr:
    """Coefficients of the squares of omega in 2 T and H^2, as the rows of a 2 x 3 matrix."""
    energy, momentum = constants(moments)
    rows = ((2 * energy).as_poly(*OMEGA.components), momentum.as_poly(*OMEGA.components))
    return sp.Matrix([[row.coeff_monomial(w**2) for w in OMEGA.components] for row in rows])


@dataclass(frozen=True)
class Conic:
    """The curve ``a x^2 + b y^2 = level`` in the plane of omega_i and omega_j, (i, j) = ``axes``."""

    axes: tuple[int, int]
    coefficients: tuple[Expr, Expr]
    level: Expr


CONICS = {
    (1, 1, 1): "ellipse",
    (1, 1, 0): "point",
    (1, -1, 1): "hyperbola",
    (1, -1, -1): "hyperbola",
    (1, -1, 0): "two lines that cross",
    (1, 0, 1): "two parallel lines",
    (0, 1, 1): "two parallel lines",
    (1, 0, 0): "line",
    (0, 1, 0): "line",
    (0, 0, 0): "plane",
}
"""Kinds of `Conic` by the signs of its coefficients and its level; the first one not negative."""


def projection(
    eliminated: int,
    moments: Sequence[Expr] = MOMENTS,
    energy: Expr = T,
    squared_momentum: Expr = H**2,
) -> Conic:
    """Return the conic on which the polhode lies as seen along b_k, k = ``eliminated``.

    The square of omega_k is eliminated from 2 T and H^2, which are linear in it; the polhode covers
    that part of the conic where it is not negative (Hughes, 1986, ch. 4).

    >>> projection(3).level
    H**2 - 2*I3*T
    """
    rows = linear_constants(moments)
    k = eliminated - 1
    i, j = (n for n in range(3) if n != k)
    multiplier = rows[1, k] / rows[0, k]
    reduced = [sp.factor_terms(rows[1, n] - multiplier * rows[0, n]) for n in (i, j)]
    level = as_expression(squared_momentum) - multiplier * 2 * energy
    return Conic((i + 1, j + 1), (reduced[0], reduced[1]), level)


@dataclass(frozen=True)
class Polhode:
    """What the torque-free motion from given rates looks like in the body.

    ``kind``: see `KINDS`. ``axis``: the axis (1, 2, 3) that is spun about, encircled, or that of
    symmetry; None where there is none. ``role``: major, intermediate, minor, transverse or empty.
    ``order``: axis numbers by rising moment. ``extremes``: least and greatest abs(omega_k), rad/s,
    approached and not reached on the separatrix. ``projections``: kinds of conic, seen along
    b1, b2, b3. Floats where floats were given.
    """

    kind: str
    axis: int | None
    role: str
    order: tuple[int, int, int]
    energy: Expr
    momentum: Expr
    extremes: tuple[tuple[Expr, Expr], ...]
    projections: tuple[str, str, str]


@dataclass(frozen=True)
class Motion:
    """Exact numbers of one motion, and the tolerance under which they are compared."""

    moments: tuple[Expr, ...]
    omega: Vector
    tolerance: Expr

    def sign(self, value: Expr, scale: Expr) -> int:
        """Sign of ``value``: zero below the tolerance times ``scale``, which is not negative."""
        return sign(value, self.tolerance * scale)

    @property
    def order(self) -> tuple[int, int, int]:
        """Indices (0, 1, 2) by rising moment, equal ones in their own order."""
        a, b, c = sorted(range(3), key=lambda k: self.moments[k].evalf(40))
        return a, b, c

    @property
    def constants(self) -> tuple[Expr, Expr]:
        """Kinetic energy T and squared angular momentum H^2."""
        return constants(self.moments, self.omega)

    def unequal(self, i: int, j: int) -> int:
        """Sign of the difference of the moments with indices ``i`` and ``j``."""
        return self.sign(self.moments[i] - self.moments[j], self.moments[self.order[2]])

    @property
    def turning(self) -> tuple[bool, ...]:
        """Which components of h are not zero beside H."""
        h = angular_momentum(sp.diag(*self.moments), self.omega).components
        H2 = self.constants[1]
        return tuple(sign(c**2, self.tolerance**2 * H2) != 0 for c in h)

    @property
    def symmetry(self) -> int | None:
        """Index of the axis whose two other moments are equal; None where all three differ."""
        low, mid, high = self.order
        pairs = {high: (low, mid), low: (mid, high)}
        return next((k for k, pair in pairs.items() if not self.unequal(*pair)), None)

    @property
    def spherical(self) -> bool:
        """Whether all three moments are equal."""
        return not self.unequal(self.order[0], self.order[2])

    @property
    def steady(self) -> int | None:
        """Index of the axis that h lies along; -1 for a transverse one of a symmetric body."""
        if sum(self.turning) == 1:
            return self.turning.index(True)
        symmetry = self.symmetry
        return -1 if symmetry is not None and not self.turning[symmetry] else None

    @property
    def side(self) -> int:
        """Sign of H^2 - 2 T I_intermediate: positive around the major axis."""
        energy, squared = self.constants
        limit = 2 * energy * self.moments[self.order[1]]
        return self.sign(squared - limit, squared + limit)

    def root(self, square: Expr) -> Expr:
        """Square root, as a float where floats were given."""
        return float(sp.sqrt(sp.Float(square, 30))) if self.tolerance else sp.sqrt(square)

    def root_range(self, squares: Sequence[Expr]) -> tuple[Expr, Expr]:
        """Roots of the least and of the greatest of ``squares``."""
        ordered = sorted(squares, key=lambda e: e.evalf(40))
        return self.root(ordered[0]), self.root(ordered[-1])


KINDS: Mapping[str, Callable[[Motion], bool]] = {
    "spherical (omega constant)": lambda m: m.spherical,
    "spin about an axis": lambda m: m.steady is not None,
    "axisymmetric (oblate)": lambda m: m.symmetry == m.order[2],
    "axisymmetric (prolate)": lambda m: m.symmetry == m.order[0],
    "separatrix": lambda m: m.side == 0,
    "about the major axis": lambda m: m.side > 0,
    "about the minor axis": lambda m: m.side < 0,
}
"""Kinds of polhode and their conditions; the first that holds is the kind."""


def kind_of(motion: Motion) -> str:
    """Return the kind of polhode, a key of `KINDS`."""
    return next(k for k, holds in KINDS.items() if holds(motion))


def classify(moments: Sequence[Expr], omega: Sequence[Expr]) -> Polhode:
    """Classify the polhode of a body with principal ``moments`` (kg m^2) that starts at ``omega``.

    ``moments`` belong to b1, b2, b3 in any order; ``omega`` (rad/s) has components in B. Integers,
    fractions and SymPy numbers are compared exactly, floats within `eom.exact.numbers.TOLERANCE` of the
    largest moment, of H, and of H^2. Raises `InputError` for moments that no body has, for rates
    that are zero or not finite. (Hughes, 1986, ch. 4; Goldstein, Poole, Safko, 2002, sect. 5.6.)

    >>> p = classify((3, 1, 2), (0, 5, 1))
    >>> p.kind, p.axis, p.projections
    ('about the minor axis', 2, ('ellipse', 'ellipse', 'hyperbola'))
    """
    motion = motion_of(moments, omega)
    kind = kind_of(motion)
    axis = _axis_of(motion, kind)
    low, mid, high = motion.order
    energy, squared = motion.constants
    ends = ends_of(motion, kind)
    projections = [_conic_kind(motion, k) for k in (1, 2, 3)]
    return Polhode(
        kind=kind,
        axis=None if axis is None or axis < 0 else axis + 1,
        role=_role(motion, axis),
        order=(low + 1, mid + 1, high + 1),
        energy=float(energy) if motion.tolerance else energy,
        momentum=motion.root(squared),
        extremes=tuple(motion.root_range([end[k] for end in ends]) for k in range(3)),
        projections=(projections[0], projections[1], projections[2]),
    )


def _axis_of(motion: Motion, kind: str) -> int | None:
    low, _, high = motion.order
    axes = {"about the major axis": high, "about the minor axis": low}
    axes |= {"axisymmetric (oblate)": high, "axisymmetric (prolate)": low}
    return motion.steady if kind == "spin about an axis" else axes.get(kind)


def _role(motion: Motion, axis: int | None) -> str:
    if axis is None:
        return ""
    symmetry = motion.symmetry
    if symmetry is not None and axis != symmetry:
        return "transverse"
    return ("minor", "intermediate", "major")[motion.order.index(axis)]


def ends_of(motion: Motion, kind: str) -> list[list[Expr]]:
    """Squares of omega_1..3 at both ends of the segment that they run along.

    2 T and H^2 are linear in the squares, so that these run along a straight line, whose direction
    is normal to both rows of coefficients; it ends where the first of the squares is zero.
    """
    start = [w**2 for w in motion.omega.components]
    rows = linear_constants(motion.moments)
    direction = list(rows.row(0).cross(rows.row(1)))
    if kind in {"spherical (omega constant)", "spin about an axis"}:
        return [start]
    ends = []
    for sense in (1, -1):
        falling = [(k, -sense * d) for k, d in enumerate(direction) if sign(sense * d, 0) < 0]
        k, slope = min(falling, key=lambda f: (start[f[0]] / f[1]).evalf(40))
        way = sense * start[k] / slope
        ends.append([sp.expand(s + way * d) for s, d in zip(start, direction, strict=True)])
    return ends


def _conic_kind(motion: Motion, eliminated: int) -> str:
    energy, squared = motion.constants
    conic = projection(eliminated, motion.moments, energy, squared)
    largest = motion.moments[motion.order[2]]
    scales = [motion.moments[k - 1] * largest for k in conic.axes]
    scales.append(squared + 2 * energy * motion.moments[eliminated - 1])
    values = (*conic.coefficients, conic.level)
    signs = [motion.sign(v, s) for v, s in zip(values, scales, strict=True)]
    lead = next((s for s in signs if s), 1)
    return CONICS[lead * signs[0], lead * signs[1], lead * signs[2]]


def motion_of(moments: Sequence[Expr], omega: Sequence[Expr]) -> Motion:
    """Return the exact numbers of a motion; arguments and errors as in `classify`."""
    given = (*moments, *omega)
    if len(moments) != 3 or len(omega) != 3:
        got = f"{len(moments)} and {len(omega)}"
        raise InputError("three moments of inertia and three rates are needed", got=got)
    exact = [number(v) for v in given]
    check_principal_moments([float(m) for m in exact[:3]], "torque-free body")
    if all(w == 0 for w in exact[3:]):
        raise InputError("the body does not turn", got="omega = 0", expected="a rate")
    return Motion(tuple(exact[:3]), vector("B", exact[3:]), tolerance(given))
