"""The torque-free rigid body in principal axes: constants, ellipsoids and polhode.

Everything follows from h = J omega, T = omega . h / 2 and dh/dt = 0 (Hughes, Spacecraft Attitude
Dynamics, 1986, ch. 4; Goldstein, Poole, Safko, 2002, sect. 5.6). Numbers are compared as
`eom.exact.numbers` says. The herpolhode is in `eom.mechanics.freebody`, steady spin in
`eom.mechanics.steady`, precession of the symmetric body in `eom.mechanics.freebody`.

The herpolhode: the curve of omega on the invariable plane of the torque-free body.

Source: Goldstein, Poole, Safko, Classical Mechanics, 2002, sect. 5.6 (Poinsot's construction).

Precession of a torque-free body with an axis of symmetry, which may carry a rotor about it.

Source: Hughes, Spacecraft Attitude Dynamics, 1986, ch. 4; with a rotor ch. 6.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact.numbers import number, sign, tolerance
from eom.kinematics.frames import Vector, first_derivative, unit_vector, vector
from eom.mass.inertia import check_principal_moments
from eom.mechanics.rigidbody import OMEGA, angular_momentum, euler_equations, principal_inertia
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


@dataclass(frozen=True)
class Herpolhode:
    """The curve of omega on the invariable plane, which stands normal to h (Poinsot).

    ``distance``: of the plane from the fixed point, 2 T/H; ``inner`` and ``outer``: least and
    greatest distance of the curve from the foot of h. All in rad/s.
    """

    distance: Expr
    inner: Expr
    outer: Expr


def herpolhode(moments: Sequence[Expr], omega: Sequence[Expr]) -> Herpolhode:
    """Return plane and radii of the herpolhode.

    Arguments, numbers and errors as in `eom.mechanics.freebody.classify`.

    >>> herpolhode((2, 2, 1), (3, 0, 4))
    Herpolhode(distance=17*sqrt(13)/13, inner=6*sqrt(13)/13, outer=6*sqrt(13)/13)
    """
    motion = motion_of(moments, omega)
    energy, squared = motion.constants
    foot = (2 * energy) ** 2 / squared
    ends = ends_of(motion, kind_of(motion))
    inner, outer = motion.root_range([sp.Add(*end) - foot for end in ends])
    return Herpolhode(motion.root(foot), inner, outer)


def turning_point(k: int, moments: Sequence[Expr] = MOMENTS) -> tuple[Expr, ...]:
    """Return the squares of omega_1..3 where the polhode crosses omega_k = 0, over T and H.

    They are points of the motion where none of them is negative.
    """
    equations = linear_constants(moments) * sp.Matrix(SQUARES) - sp.Matrix([2 * T, H**2])
    (solution,) = sp.linsolve([*equations, SQUARES[k - 1]], SQUARES)
    return tuple(solution)


def herpolhode_radius(k: int) -> Expr:
    """Return the radius where omega_k = 0; for I1 < I2 < I3 the extremes have k = 2 and 1 or 3.

    It is the length of omega less its part along h, 2 T/H.
    """
    return sp.sqrt(sp.Add(*turning_point(k)) - (2 * T / H) ** 2)


def herpolhode_rate() -> Expr:
    """Return the rate (rad/s) at which the herpolhode turns about h, over omega and the moments.

    rho = omega - (omega . h) h/H^2 has the inertial derivative of omega, since h and T are
    constant; the rate is (rho x rho') . h/(H rho^2). It is 0/0 in steady spin, where rho = 0.
    """
    J, _ = principal_inertia()
    _, rates = euler_equations(J, vector("B", (0, 0, 0)))
    h = angular_momentum(J, OMEGA)
    squared = h.dot(h)
    rho = OMEGA - h.scaled(OMEGA.dot(h) / squared)
    moving = dict(zip(OMEGA.components, rates, strict=True))
    rho_dot = first_derivative(OMEGA, OMEGA, moving).total
    return rho.cross(rho_dot).dot(h) / (sp.sqrt(squared) * rho.dot(rho))


TRANSVERSE, AXIAL = sp.Symbol("It", positive=True), sp.Symbol("Ia", positive=True)


@dataclass(frozen=True)
class Precession:
    """Steady precession of a torque-free body with I1 = I2, which may carry a rotor about b3.

    omega = ``rate`` h/H + ``spin`` b3 (rad/s): the body precesses about h and spins about its axis
    in the frame that precesses. ``body_cone_rate``: rate of omega about b3 as seen in the body,
    minus the spin. ``nutation``: angle between h and b3; ``body_cone``: half-angle of the cone of
    omega about b3, at most a right angle; ``space_cone``: angle between omega and h. In radians.
    """

    rate: Expr
    spin: Expr
    body_cone_rate: Expr
    nutation: Expr
    body_cone: Expr
    space_cone: Expr

    @property
    def sense(self) -> str:
        """Direct, retrograde, or none without spin or across the axis; numbers only."""
        about_axis = self.spin * self.rate * sp.cos(self.nutation)
        if not about_axis.is_number:
            raise InputError("the sense of precession needs numbers", got=about_axis)
        return SENSES[sign(about_axis)]


SENSES = {1: "direct", -1: "retrograde", 0: "none"}
"""By the sign of the spin about the axis times the axial part of the precession."""


def precession(
    transverse: Expr = TRANSVERSE,
    axial: Expr = AXIAL,
    omega: Sequence[Expr] = OMEGA.components,
    rotor_momentum: Expr = 0,
) -> Precession:
    """Return the precession of a symmetric body from its rates (Hughes, 1986, ch. 4; gyrostat ch. 6).

    ``transverse``, ``axial``: moments It = I1 = I2 and Ia = I3 (kg m^2), a rotor held fast;
    ``rotor_momentum``: Js Omega about b3 (N m s), constant. Without it the precession is direct if
    the body is prolate, retrograde if oblate. Raises `InputError` for h = 0 and impossible moments.

    >>> precession().spin
    omega_3*(-Ia + It)/It
    >>> precession(1, 2, (3, 0, 2)).sense
    'retrograde'
    """
    if len(omega) != 3:
        raise InputError("three rates are needed", where="precession", got=len(omega))
    values = [as_expression(v) for v in (transverse, axial, rotor_momentum, *omega)]
    for value in filter(lambda v: v.is_number, values):
        number(value)
    It, Ia, stored, w1, w2, w3 = values
    if It.is_number and Ia.is_number:
        check_principal_moments([float(It), float(It), float(Ia)], "precession")
    across = sp.sqrt(w1**2 + w2**2)
    turn = vector("P", (across, 0, w3))
    h = vector("P", (It * across, 0, Ia * w3 + stored))
    H = sp.sqrt(h.dot(h))
    if H == 0:
        raise InputError("no precession without angular momentum", where="precession", got="h = 0")
    given = dict(zip(_SYMMETRIC, (It, Ia, across, w3, stored, H), strict=True))
    rate, spin = (e.xreplace(given) for e in _along_h_and_axis())
    return Precession(
        rate=rate,
        spin=spin,
        body_cone_rate=-spin,
        nutation=sp.atan2(h.components[0], h.components[2]),
        body_cone=sp.atan2(across, sp.Abs(w3)),
        space_cone=sp.atan2(sp.Abs(turn.cross(h).components[1]), turn.dot(h)),
    )


_SYMMETRIC = (TRANSVERSE, AXIAL, *sp.symbols("omega_t omega_a p H", real=True))


@lru_cache
def _along_h_and_axis() -> tuple[Expr, Expr]:
    """Solve omega = rate h/H + spin b3 in the plane of omega, h and b3."""
    It, Ia, across, along, stored, H = _SYMMETRIC
    omega, axis = vector("P", (across, 0, along)), unit_vector("P", 3)
    h = angular_momentum(sp.diag(It, It, Ia), omega) + axis.scaled(stored)
    rate, spin = sp.symbols("rate spin", real=True)
    rest = omega - h.scaled(rate / H) - axis.scaled(spin)
    (found,) = sp.linsolve([rest.components[0], rest.components[2]], [rate, spin])
    return found[0], sp.factor_terms(sp.collect(found[1], along))
