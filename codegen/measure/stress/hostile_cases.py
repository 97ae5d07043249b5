"""Hostile but legal systems: equations, where they start, and where they are narrow.

Each is an initial value problem of a few lines that some integrator steps over, steps through, or
believes. They were written, and their references made (`benchmarks.hostile_references`), before any
method of this package was run on them. Units are SI where there are any; angles are in radians.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import sympy as sp

from eom.quantities import TIME
from eom.system import BodyAttitude, System
from eom.tables import Table

Expr = Any

t = TIME
x, v, y, w, z, u = sp.symbols("x v y w z u", real=True)
w1, w2, w3, q0, q1, q2, q3 = sp.symbols("w1 w2 w3 q0 q1 q2 q3", real=True)
R = sp.Rational
SATELLITE = (R(10), R(15), R(20))
REST = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Hostile:
    """A system as ``rates`` by state, ``start`` in the order of the states, and the ``span`` of time.

    ``fine``: instants with a width: what happens there is so narrow. ``knots``: instants where the
    rates jump or bend. ``step``: what is narrow in the states needs steps of at most so many
    seconds. ``stiff``: an implicit method confirms the reference. These four are for the reference
    alone: no method that is checked is given it. ``moments``: of the body whose angular velocity and, as a
    rule, attitude are among the states; the system states it, as one that a derivation makes does.
    """

    name: str
    family: str
    rates: Mapping[Expr, Expr]
    start: Sequence[float]
    span: tuple[float, float]
    fine: tuple[tuple[float, float], ...] = ()
    knots: tuple[float, ...] = ()
    step: float = float("inf")
    stiff: bool = False
    moments: Sequence[Expr] = ()

    @property
    def key(self) -> str:
        """Family and name: what the case is called."""
        return f"{self.family}: {self.name}"

    @property
    def system(self) -> System:
        """The equations of motion."""
        bodies = (_stated(self.moments, self.rates),) if self.moments else ()
        return System.from_rates(self.name, self.rates, attitudes=bodies)


Rows = Iterator[Hostile]
FAMILIES: dict[str, Callable[[], Rows]] = {}


def _family(name: str) -> Callable[[Callable[[], Rows]], Callable[[], Rows]]:
    def listed(rows: Callable[[], Rows]) -> Callable[[], Rows]:
        FAMILIES[name] = rows
        return rows

    return listed


@cache
def cases(family: str | None = None) -> tuple[Hostile, ...]:
    """Return the cases of a family, or all, in the order of the table."""
    chosen = FAMILIES if family is None else {family: FAMILIES[family]}
    return tuple(case for rows in chosen.values() for case in rows())


def _oscillator(force: Expr, stiffness: Expr = 1) -> dict[Expr, Expr]:
    return {x: v, v: force - stiffness * x}


def _body(moments: Sequence[Expr], torque: Sequence[Expr]) -> dict[Expr, Expr]:
    """Return Euler's equations in principal axes of the body, torque in N m by components there."""
    a, b, c = (sp.sympify(m, strict=True) for m in moments)
    first, second, third = torque
    return {
        w1: ((b - c) * w2 * w3 + first) / a,
        w2: ((c - a) * w3 * w1 + second) / b,
        w3: ((a - b) * w1 * w2 + third) / c,
    }


def _stated(moments: Sequence[Expr], rates: Mapping[Expr, Expr]) -> BodyAttitude:
    """Return what is known of a body in principal axes; its torque is what its rates leave of it."""
    omega = (w1, w2, w3)
    free = _body(moments, (0, 0, 0))
    first, second, third = (m * (rates[w] - free[w]) for m, w in zip(moments, omega, strict=True))
    turned = (q0, q1, q2, q3)
    kind, coordinates = ("quaternion", turned) if q0 in rates else ("none", ())
    torque = (first, second, third)
    return BodyAttitude(omega, kind, coordinates, inertia=sp.diag(*moments), torque=torque)


def _turning() -> dict[Expr, Expr]:
    """Return the rates of the quaternion, scalar first, body to space, by angular velocity in the body."""
    return {
        q0: -(q1 * w1 + q2 * w2 + q3 * w3) / 2,
        q1: (q0 * w1 + q2 * w3 - q3 * w2) / 2,
        q2: (q0 * w2 + q3 * w1 - q1 * w3) / 2,
        q3: (q0 * w3 + q1 * w2 - q2 * w1) / 2,
    }


def _free(moments: Sequence[Expr], torque: Sequence[Expr] = (0, 0, 0)) -> dict[Expr, Expr]:
    return {**_body(moments, torque), **_turning()}


def _spun(
    case: str, torque: Sequence[Expr], start: Sequence[float], until: float, **known: Any
) -> Hostile:
    """Return a body, with its attitude where the start has one; ``case``: family and name.

    ``known``: the moments, those of a satellite where they are left out, and what the reference knows.
    """
    family, _, name = case.partition(": ")
    moments = known.setdefault("moments", SATELLITE)
    rates = (_free if len(start) > 3 else _body)(moments, torque)
    return Hostile(name, family, rates, start, (0.0, until), **known)


def _top(
    name: str, third: Expr, weight: Expr, start: Sequence[float], until: float, **known: Any
) -> Hostile:
    """Return a symmetric top, its centre of mass on the third axis; ``weight``: m g l in N m."""
    up = (2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1))
    rubbing = known.pop("rubbing", 0)
    torque = (weight * up[1], -weight * up[0], rubbing)
    return _spun(f"top: {name}", torque, start, until, moments=(1, 1, third), **known)


def _tilted(angle: float) -> tuple[float, float, float, float]:
    """Return the quaternion of a rotation by ``angle`` about the first axis."""
    return float(sp.cos(sp.Float(angle, 30) / 2)), float(sp.sin(sp.Float(angle, 30) / 2)), 0.0, 0.0


# -- friction -------------------------------------------------------------------------------------

SHARP: dict[str, Callable[[Expr, Expr], Expr]] = {
    "tanh": lambda k, s: sp.tanh(k * s),
    "atan": lambda k, s: 2 / sp.pi * sp.atan(k * s),
    "root": lambda k, s: k * s / sp.sqrt(1 + (k * s) ** 2),
    "erf": lambda k, s: sp.erf(k * s),
    "logistic": lambda k, s: 2 / (1 + sp.exp(-k * s)) - 1,
    "rational": lambda k, s: k * s / (1 + (k * s) ** 2),
}
"""Smooth laws of friction that change sign within 1/k of rest."""


@_family("friction")
def _friction() -> Rows:
    for law, f in SHARP.items():
        for k in (30, 100, 400):
            rates = _oscillator(-f(k, v) / 2)
            yield Hostile(f"{law}({k} v)", "friction", rates, (1.0, 0.0), (0.0, 4.0), step=0.02)
    belt = _oscillator(
        -R(3, 10) * (1 + R(1, 2) * sp.exp(-abs_(v - R(1, 2)))) * sp.tanh(100 * (v - R(1, 2)))
    )
    yield Hostile("belt", "friction", belt, (0.0, 0.0), (0.0, 12.0), step=0.02)
    pendulum = {x: v, v: -sp.sin(x) - R(1, 5) * sp.tanh(80 * v)}
    yield Hostile("pendulum", "friction", pendulum, (2.8, 0.0), (0.0, 9.0), step=0.02)
    driven = _oscillator(2 * sp.cos(R(6, 5) * t) - sp.tanh(60 * v) / 2)
    yield Hostile("driven", "friction", driven, (0.3, 0.1), (0.0, 10.0), step=0.02)
    pair = {x: v, y: w, v: -x - sp.tanh(100 * (v - w)) / 2, w: -4 * y + sp.tanh(100 * (v - w)) / 2}
    yield Hostile("two masses", "friction", pair, (1.0, -0.5, 0.0, 0.0), (0.0, 5.0), step=0.02)
    spin = _body((10, 15, 20), tuple(-R(1, 2) * sp.tanh(50 * s) for s in (w1, w2, w3)))
    yield Hostile("bearing", "friction", spin, (0.5, -0.3, 0.4), (0.0, 8.0), step=0.02)


def abs_(s: Expr) -> Expr:
    """Return a smooth modulus, sqrt(s^2 + 1e-4)."""
    return sp.sqrt(s**2 + R(1, 10000))


# -- contacts ------------------------------------------------------------------------------------

CONTACTS: dict[str, Callable[[Expr], Expr]] = {
    "softplus 30": lambda s: 20 * sp.log(1 + sp.exp(-30 * s)),
    "softplus 100": lambda s: 20 * sp.log(1 + sp.exp(-100 * s)),
    "softplus 400": lambda s: 10 * sp.log(1 + sp.exp(-400 * s)),
    "exponential 20": lambda s: sp.exp(-20 * s),
    "exponential 60": lambda s: sp.exp(-60 * s),
    "logistic wall": lambda s: 400 / (1 + sp.exp(60 * s)),
    "tanh wall": lambda s: 200 * (1 - sp.tanh(50 * s)),
    "erfc wall": lambda s: 200 * sp.erfc(20 * s),
    "root": lambda s: 500 * (sp.sqrt(s**2 + R(1, 10000)) - s),
}
"""Repulsion by a floor at zero, from the height above it, in N."""


@_family("contact")
def _contact() -> Rows:
    for law, f in CONTACTS.items():
        for height in (1.0, 40.0):
            end = 2.6 * (2 * height / 9.81) ** 0.5
            rates = {x: v, v: -R(981, 100) + f(x)}
            name = f"{law} from {height:g} m"
            yield Hostile(name, "contact", rates, (height, 0.0), (0.0, end), step=0.01)
    f = CONTACTS["softplus 100"]
    box = {x: v, v: f(x + 1) - f(1 - x)}
    yield Hostile("box", "contact", box, (0.0, 3.0), (0.0, 3.0), step=0.01)
    pair = {x: v, y: w, v: -f(y - x), w: f(y - x)}
    yield Hostile("two bodies meet", "contact", pair, (-2.0, 1.0, 3.0, -1.0), (0.0, 2.0), step=0.01)
    yield Hostile(
        "stop of a pendulum", "contact",
        {x: v, v: -sp.sin(x) + R(1, 10) * f(x + R(1, 5))}, (1.5, 0.0), (0.0, 8.0), step=0.005,
    )  # fmt: skip
    yield Hostile(
        "damped floor", "contact",
        {x: v, v: -R(981, 100) + 2000 * sp.exp(-50 * x) * (1 - v / 20) / 100}, (3.0, 0.0), (0.0, 3.0), step=0.002,
    )  # fmt: skip


# -- pulses in time -------------------------------------------------------------------------------

PULSES: dict[str, Callable[[Expr], Expr]] = {
    "Gaussian": lambda s: sp.exp(-(s**2)),
    "window": lambda s: (sp.tanh(s + 2) - sp.tanh(s - 2)) / 2,
    "logistic": lambda s: 1 / (1 + sp.exp(-s - 3)) - 1 / (1 + sp.exp(-s + 3)),
    "erf": lambda s: (sp.erf(s + 1) - sp.erf(s - 1)) / 2,
    "Lorentz": lambda s: 1 / (1 + s**2),
    "sech^2": lambda s: 1 / sp.cosh(s) ** 2,
}
"""Pulses about zero, of width one."""


@_family("pulse")
def _pulse() -> Rows:
    for kind, f in PULSES.items():
        for centre, width in ((3, R(1, 2)), (5, R(1, 50)), (40, R(1, 100))):
            rates = _oscillator(f((t - centre) / width) / width)
            name, near = (
                f"{kind} at {centre} s, {float(width):g} s",
                ((float(centre), float(width)),),
            )
            yield Hostile(name, "pulse", rates, (1.0, 0.0), (0.0, centre + 4.0), fine=near)
    yield from _pulses_on_bodies()


def _pulses_on_bodies() -> Rows:
    g = 3 * sp.exp(-(((t - 20) / R(1, 2)) ** 2))
    start = (0.02, 0.3, -0.01, *REST)
    yield _spun("pulse: satellite", (g, -g / 2, g / 3), start, 30.0, fine=((20.0, 0.5),))
    window = (sp.tanh(10 * (t - 20)) - sp.tanh(10 * (t - 21))) / 2
    edges = ((20.0, 0.1), (21.0, 0.1))
    windowed, start = (window, 2 * window, 0), (0.1, 0.2, -0.1, *REST)
    yield _spun("pulse: windowed satellite", windowed, start, 30.0, fine=edges)
    late = (0, 5 * sp.exp(-(((t - 100) / R(1, 20)) ** 2)), 0)
    yield _spun("pulse: late torque", late, (0.1, 0.0, 0.0), 110.0, fine=((100.0, 0.05),))
    kick = {x: v, v: -sp.sin(x) + 20 * sp.exp(-(((t - 2) / R(1, 50)) ** 2))}
    yield Hostile("kicked pendulum", "pulse", kick, (0.5, 0.0), (0.0, 8.0), fine=((2.0, 0.02),))
    train = sum(sp.exp(-((50 * (t - k)) ** 2)) for k in range(1, 9))
    near = tuple((float(k), 0.02) for k in range(1, 9))
    yield Hostile("train", "pulse", _oscillator(10 * train), (0.0, 0.0), (0.0, 10.0), fine=near)
    teeth = sp.exp(-200 * (1 - sp.cos(2 * sp.pi * t)))
    near = tuple((float(k), 0.016) for k in range(1, 10))
    yield Hostile("repeated", "pulse", _oscillator(5 * teeth, 4), (0.0, 0.0), (0.0, 9.5), fine=near)
    very = {x: 1000 * sp.exp(-((1000 * (t - 500)) ** 2)) / sp.sqrt(sp.pi) - x / 100}
    yield Hostile(
        "a millisecond in 1000 s", "pulse", very, (1.0,), (0.0, 510.0), fine=((500.0, 0.001),)
    )
    gain = {x: x * 40 * sp.exp(-((20 * (t - 7)) ** 2))}
    yield Hostile("gain", "pulse", gain, (1.0,), (0.0, 10.0), fine=((7.0, 0.05),))


# -- what is small here and large elsewhere --------------------------------------------------------


def _brake(speed: Expr, k: int, limit: int) -> Expr:
    """Return a deceleration of 10 above the limit, over 1/k of a unit of speed."""
    return 10 * (1 + sp.tanh(k * (speed - limit))) / 2


@_family("governor")
def _governor() -> Rows:
    for k, limit in ((20, 2), (50, 2), (100, 3), (30, 4)):
        rates = {x: v, v: 1 - _brake(v, k, limit)}
        yield Hostile(
            f"overspeed {limit}, {k}", "governor", rates, (0.0, 0.0), (0.0, 2.0 * limit), step=0.01
        )
        braked, name = (0, 0, 20 - 2 * _brake(w3, k, limit)), f"body, overspeed {limit}, {k}"
        yield _spun(f"governor: {name}", braked, (0.1, 0.05, 0.5), 2.0 * limit, step=0.01)
    for power in (21, 101, 401):
        stop = {x: v, v: -((x / 5) ** power)}
        yield Hostile(f"(x/5)^{power}", "governor", stop, (0.5, 2.0), (0.0, 5.0), step=0.002)
        held, name = (0, 0, -10 * (w3 / 5) ** power), f"body, (w3/5)^{power}"
        yield _spun(f"governor: {name}", held, (1.0, 4.9, 1.5), 6.0, step=0.002)
    torque, start = (0, -sp.exp(40 * (w2 - R(3, 2))), R(1, 2)), (0.3, 1.3, 0.2, *REST)
    yield _spun("governor: satellite, braked", torque, start, 20.0, step=0.02)
    yield from _end_stops()


def _end_stops() -> Rows:
    """Yield masses that meet what is steep, or nothing else than near one place."""
    for k in (50, 200):
        end = sp.exp(k * (x - 3)) - sp.exp(-k * (x + 3))
        yield Hostile(
            f"end stops, {k}", "governor", {x: v, v: -end}, (0.0, 1.0), (0.0, 10.0), step=0.002
        )
        drive = {x: v, v: sp.cos(t) - x / 5 - end}
        yield Hostile(
            f"driven to end stops, {k}", "governor", drive, (0.0, 2.0), (0.0, 6.0), step=0.002
        )
    well = {x: v, v: sp.exp(-((20 * (x - 4)) ** 2)) * 30}
    yield Hostile("bump far away", "governor", well, (0.0, 1.0), (0.0, 5.0), step=0.005)
    drag = {x: v, v: 5 - sp.exp(30 * (v - 4))}
    yield Hostile("exponential drag", "governor", drag, (0.0, 0.0), (0.0, 2.0), step=0.005)


# -- branch points --------------------------------------------------------------------------------


@_family("branch")
def _branch() -> Rows:
    depth = {"far": R(1, 10), "near": R(1, 1000), "nearest": R(1, 10**6)}
    for name, gap in depth.items():
        root = sp.sqrt(1 + gap - sp.sin(t) ** 2)
        yield Hostile(f"root, {name}", "branch", {x: root}, (0.0,), (0.0, 8.0), step=0.01)
        swing = _oscillator(sp.log(gap + x**2) / 10)
        yield Hostile(f"logarithm, {name}", "branch", swing, (1.0, 0.0), (0.0, 6.0), step=0.002)
        arc = {x: sp.asin(sp.sin(t) / (1 + gap))}
        yield Hostile(f"arc sine, {name}", "branch", arc, (0.0,), (0.0, 8.0), step=0.01)
        power = _oscillator(-((gap + x**2) ** R(3, 10)) * x)
        yield Hostile(f"power 3/10, {name}", "branch", power, (1.0, 0.1), (0.0, 6.0), step=0.002)
        turn = {x: sp.atan2(sp.sin(t), sp.cos(t) + 1 + gap)}
        yield Hostile(f"atan2, {name}", "branch", turn, (0.0,), (0.0, 6.0), step=0.005)
        pole = {x: v, v: -x / (gap + x**2) ** R(3, 2)}
        yield Hostile(f"softened centre, {name}", "branch", pole, (1.0, 0.0), (0.0, 1.0), step=0.01)
    yield Hostile(
        "sqrt(1 - x^2) before its end",
        "branch",
        {x: sp.sqrt(1 - x**2)},
        (0.0,),
        (0.0, 1.5),
        step=0.01,
    )
    yield Hostile("sqrt(x), falling", "branch", {x: -sp.sqrt(x)}, (1.0,), (0.0, 1.99), step=0.005)
    yield Hostile(
        "x log x", "branch", {x: -x * sp.log(x**2 + R(1, 10**8))}, (-2.0,), (0.0, 5.0), step=0.01
    )
    yield Hostile(
        "acosh",
        "branch",
        {x: v, v: -sp.acosh(R(1001, 1000) + x**2) * x},
        (1.0, 0.0),
        (0.0, 6.0),
        step=0.005,
    )
    kepler = {x: v, y: w, v: -x / (x**2 + y**2) ** R(3, 2), w: -y / (x**2 + y**2) ** R(3, 2)}
    for e in (0.9, 0.99, 0.999):
        start = (1 + e, 0.0, 0.0, ((1 - e) / (1 + e)) ** 0.5)
        yield Hostile(f"Kepler, e = {e}", "branch", kepler, start, (0.0, 6.0), step=0.05)


# -- near separatrices ----------------------------------------------------------------------------


@_family("separatrix")
def _separatrix() -> Rows:
    pendulum = {x: v, v: -sp.sin(x)}
    for gap in (1e-3, 1e-6, 1e-9, -1e-3, -1e-6, -1e-9):
        end = 25.0 if abs(gap) > 1e-5 else 35.0
        yield Hostile(f"pendulum, {gap:g}", "separatrix", pendulum, (0.0, 2.0 + gap), (0.0, end))
    for gap in (1e-4, 1e-8):
        angle = float(sp.N(sp.pi - sp.Float(gap, 30), 30))
        yield Hostile(
            f"upright pendulum, {gap:g}", "separatrix", pendulum, (angle, 0.0), (0.0, 30.0)
        )
    for moments in ((1, 2, 3), (10, 15, 20), (R(1, 2), R(5, 2), R(26, 10))):
        for tilt in (1e-2, 1e-5, 1e-8):
            name = f"separatrix: middle axis of {', '.join(map(str, moments))}, {tilt:g}"
            yield _spun(name, (0, 0, 0), (tilt, 1.0, tilt / 3, *REST), 40.0, moments=moments)
    duffing = {x: v, v: x - x**3}
    for gap in (1e-4, 1e-8):
        yield Hostile(f"double well, {gap:g}", "separatrix", duffing, (gap, 0.0), (0.0, 45.0))
    cart = {x: v, v: sp.sin(x) * (1 - R(1, 20) * sp.cos(x)) - v / 100}
    yield Hostile("inverted, damped", "separatrix", cart, (1e-6, 0.0), (0.0, 30.0))


# -- tops ----------------------------------------------------------------------------------------


@_family("top")
def _tops() -> Rows:
    for spin in (2.0, 20.0, 100.0):
        for tilt in (1e-6, 1e-2, 0.6):
            end = 10.0 if spin < 50 else 4.0
            start = (0.0, 0.0, spin, *_tilted(tilt))
            yield _top(f"tilt {tilt:g}, spin {spin:g}", R(1, 2), 3, start, end)
    for spin in (6.8, 6.93, 7.0, 7.2):  # sleeping or not: 2 sqrt(I1 m g l) / I3 = 6.928
        start = (0.01, 0.0, spin, *_tilted(1e-3))
        yield _top(f"sleeping, {spin:g}", R(1, 2), 3, start, 20.0)
    for tilt in (3.1, 3.14159):
        start = (0.1, 0.2, 5.0, *_tilted(tilt))
        yield _top(f"hanging, {tilt:g}", R(3, 2), 5, start, 10.0)
    for third in (R(1, 100), R(199, 100)):
        start = (0.3, 0.0, 15.0, *_tilted(0.4))
        yield _top(f"moment {float(third):g}", third, 2, start, 8.0)
    yield _top("falls over", R(1, 2), 3, (1e-9, 0.0, 1e-3, *_tilted(1e-9)), 15.0)
    struck, start = 3 + 30 * sp.exp(-((20 * (t - 3)) ** 2)), (0.0, 0.0, 20.0, *_tilted(0.6))
    yield _top("struck", R(1, 2), struck, start, 6.0, fine=((3.0, 0.05),))
    rubbing, start = -sp.tanh(40 * (w3 - 10)) / 4, (0.0, 0.0, 12.0, *_tilted(0.5))
    yield _top("rubbed", R(1, 2), 3, start, 8.0, step=0.01, rubbing=rubbing)


# -- walls ---------------------------------------------------------------------------------------


@_family("wall")
def _walls() -> Rows:
    for power in (6, 12, 24):
        for speed in (1.0, 10.0, 100.0):
            rates = {x: v, v: x**-power}
            yield Hostile(
                f"x^-{power} at {speed:g} m/s",
                "wall",
                rates,
                (10.0, -speed),
                (0.0, 15.0 / speed),
                step=0.005 / speed,
            )
    for width in (R(1, 2), R(1, 20)):
        for speed in (1.0, 20.0):
            e = sp.exp(-x / width)
            rates = {x: v, v: 2 / width * (e**2 - e)}
            yield Hostile(
                f"Morse {float(width):g} at {speed:g} m/s", "wall", rates, (10.0, -speed), (0.0, 15.0 / speed),
                step=0.005 / speed,
            )  # fmt: skip
    for k in (10, 100):
        rates = {x: v, v: sp.exp(-k * x)}
        yield Hostile(f"exponential {k}", "wall", rates, (5.0, -10.0), (0.0, 1.0), step=0.002)
    jones = {x: v, v: 12 * (x**-13 - x**-7)}
    yield Hostile("Lennard-Jones, bound", "wall", jones, (1.6, 0.0), (0.0, 20.0), step=0.005)
    yield Hostile(
        "Lennard-Jones, met at speed", "wall", jones, (4.0, -30.0), (0.0, 0.3), step=0.0001
    )
    high = {x: v, v: -(x**41)}
    yield Hostile("x^41", "wall", high, (0.2, 1.0), (0.0, 8.0), step=0.005)
    yield Hostile("tangent", "wall", {x: v, v: -sp.tan(x)}, (0.0, 3.0), (0.0, 5.0), step=0.002)
    barrier = {x: v, v: -1 / (1 - x) ** 3 + 1 / (1 + x) ** 3}
    yield Hostile("between barriers", "wall", barrier, (0.0, 20.0), (0.0, 1.0), step=0.002)
    yield Hostile("sinh", "wall", {x: v, v: -sp.sinh(30 * x)}, (0.0, 5.0), (0.0, 3.0), step=0.002)
    yield Hostile(
        "coth", "wall", {x: v, v: sp.coth(x) - 2 + 1 / x**2}, (6.0, -4.0), (0.0, 3.0), step=0.002
    )


# -- late starts ----------------------------------------------------------------------------------


@_family("late")
def _late() -> Rows:
    for start in (1e6, 1.7e9, 1e12, 1e15, 1e16, 1e17):
        grain = max(1.0, start * 2.0**-52)
        end = start + 4 * max(8.0, grain * 4)
        slow = R(1, 1) / sp.Integer(max(1, int(grain)))
        yield Hostile(f"oscillator, {start:g}", "late", _oscillator(0), (1.0, 0.0), (start, end))
        yield Hostile(f"slow, {start:g}", "late", _oscillator(0, slow**2), (1.0, 0.0), (start, end))
        decay = {x: -x * slow / 8 + slow}
        yield Hostile(f"decay, {start:g}", "late", decay, (1.0,), (start, end))
        if start < 1e15:
            forced = _oscillator(sp.cos(t))
            yield Hostile(f"forced, {start:g}", "late", forced, (0.0, 0.0), (start, start + 16))
            near = ((start + 8, 0.25),)
            pulse = _oscillator(4 * sp.exp(-((4 * (t - sp.Integer(int(start)) - 8)) ** 2)))
            yield Hostile(
                f"pulse, {start:g}", "late", pulse, (1.0, 0.0), (start, start + 16), fine=near
            )
    back = _oscillator(-v / 10)
    yield Hostile("backwards, 1.7e9", "late", back, (1.0, 0.0), (1.7e9, 1.7e9 - 16))
    yield Hostile("before zero, -1e16", "late", back, (1.0, 0.0), (-1e16, -1e16 + 32))


# -- stiff ---------------------------------------------------------------------------------------


@_family("stiff")
def _stiff() -> Rows:
    for mu, end in ((10, 40.0), (100, 200.0), (1000, 900.0)):
        rates = {x: v, v: mu * (1 - x**2) * v - x}
        yield Hostile(f"Van der Pol, {mu}", "stiff", rates, (2.0, 0.0), (0.0, end), stiff=True)
    robertson = {
        x: -R(4, 100) * x + 10**4 * y * z,
        y: R(4, 100) * x - 10**4 * y * z - 3 * 10**7 * y**2,
        z: 3 * 10**7 * y**2,
    }
    for end in (0.4, 40.0, 400.0):
        yield Hostile(
            f"Robertson to {end:g}", "stiff", robertson, (1.0, 0.0, 0.0), (0.0, end), stiff=True
        )
    for rate in (100, 10**4):
        slow = {x: -rate * (x - sp.cos(t)) - sp.sin(t)}
        yield Hostile(f"Prothero-Robinson, {rate}", "stiff", slow, (0.0,), (0.0, 5.0), stiff=True)
        layer = _oscillator(-rate * v / 10 + sp.sin(3 * t), 25)
        yield Hostile(f"viscous layer, {rate}", "stiff", layer, (1.0, 0.0), (0.0, 5.0), stiff=True)
        film = _oscillator(-sp.tanh(rate * (v - R(1, 5))), 1)
        yield Hostile(f"film {rate}", "stiff", film, (0.5, 0.0), (0.0, 1.5), step=0.01, stiff=True)
        spring = {x: v, v: -rate * (x - y), y: w, w: rate * (x - y) / 1000 - y}
        yield Hostile(f"stiff spring, {rate}", "stiff", spring, (1.0, 0.0, 1.0, 0.0), (0.0, 4.0))
    yield from _reactions()


def _reactions() -> Rows:
    """Yield stiff systems of chemistry, and like them."""
    oregonator = {
        x: 77 * (y + x * (1 - x / 119000 - y)),
        y: (z - (1 + x) * y) / 77,
        z: R(161, 1000) * (x - z),
    }
    yield Hostile("Oregonator", "stiff", oregonator, (1.0, 2.0, 3.0), (0.0, 30.0), stiff=True)
    e5 = {
        x: -1000 * x + 1000 * y * x / (1 + y),
        y: x - y / 10 + sp.sin(t) / 10,
        z: -(10**4) * (z - x * y),
    }
    yield Hostile("slaved", "stiff", e5, (1.0, 0.5, 0.0), (0.0, 10.0), stiff=True)
    flame = {x: x**2 - x**3}
    for start in (1e-2, 1e-4):
        yield Hostile(
            f"flame from {start:g}", "stiff", flame, (start,), (0.0, 2 / start), stiff=True
        )
    fast = {x: -(10**5) * (x - y), y: -y * x}
    yield Hostile("fast and slow", "stiff", fast, (0.0, 1.0), (0.0, 2.0), stiff=True)
    hires = {
        x: -R(171, 100) * x + 280 * y * z,
        y: R(171, 100) * x - 280 * y * z - 8 * y,
        z: -280 * y * z + R(18, 10) * (R(57, 10000) - z) + 8 * y,
    }
    yield Hostile("after HIRES", "stiff", hires, (1.0, 0.0, 0.0057), (0.0, 50.0), stiff=True)


# -- chaotic --------------------------------------------------------------------------------------


@_family("chaotic")
def _chaotic() -> Rows:
    lorenz = {x: 10 * (y - x), y: x * (28 - z) - y, z: x * y - R(8, 3) * z}
    for end in (2.0, 10.0, 20.0, 40.0):
        yield Hostile(f"Lorenz to {end:g}", "chaotic", lorenz, (1.0, 1.0, 20.0), (0.0, end))
    roessler = {x: -y - z, y: x + y / 5, z: R(1, 5) + z * (x - R(57, 10))}
    for end in (20.0, 100.0):
        yield Hostile(f"Roessler to {end:g}", "chaotic", roessler, (1.0, 1.0, 0.0), (0.0, end))
    henon = {x: v, y: w, v: -x - 2 * x * y, w: -y - x**2 + y**2}
    for end in (20.0, 100.0, 300.0):
        yield Hostile(
            f"Henon-Heiles to {end:g}", "chaotic", henon, (0.0, -0.25, 0.42, 0.0), (0.0, end)
        )
    c, s = sp.cos(x - y), sp.sin(x - y)
    below = 2 - c**2
    double = {
        x: v, y: w,
        v: (-c * s * v**2 - s * w**2 - 2 * sp.sin(x) + c * sp.sin(y)) / below,
        w: (2 * s * v**2 + c * s * w**2 + 2 * c * sp.sin(x) - 2 * sp.sin(y)) / below,
    }  # fmt: skip
    for end in (3.0, 10.0, 30.0, 62.0):
        yield Hostile(
            f"double pendulum to {end:g}", "chaotic", double, (2.0, 2.5, 0.0, 0.0), (0.0, end)
        )
    duffing = {x: v, v: x - x**3 - R(1, 4) * v + R(3, 10) * sp.cos(t)}
    for end in (20.0, 100.0):
        yield Hostile(f"Duffing to {end:g}", "chaotic", duffing, (0.5, 0.0), (0.0, end))
    forced = {x: v, v: -sp.sin(x) - v / 2 + R(115, 100) * sp.cos(2 * t / 3)}
    for end in (30.0, 150.0):
        yield Hostile(f"driven pendulum to {end:g}", "chaotic", forced, (0.2, 0.0), (0.0, end))
    shaking, start = (R(1, 5) * sp.sin(t), R(1, 5) * q1, 0), (0.01, 1.0, 0.0, *REST)
    for end in (15.0, 60.0):
        name = f"chaotic: shaken body to {end:g}"
        yield _spun(name, shaking, start, end, moments=(1, 2, 3))
    yield Hostile("growth of 1e13", "chaotic", {x: v, v: x}, (1.0, -1.0), (0.0, 30.0))


# -- small beside large ---------------------------------------------------------------------------


@_family("small")
def _small() -> Rows:
    for size in (1e-6, 1e-12, 1e-20, 1e-30):
        beside = {x: v, v: -x, y: w, w: -4 * y}
        yield Hostile(f"beside, {size:g}", "small", beside, (1.0, 0.0, size, 0.0), (0.0, 10.0))
        driven = {x: v, v: -x, y: w, w: -4 * y + x * y}
        yield Hostile(f"modulated, {size:g}", "small", driven, (1.0, 0.0, size, 0.0), (0.0, 10.0))
        grown = {x: v, v: -x, y: y * (1 + x / 2)}
        yield Hostile(f"grows, {size:g}", "small", grown, (1.0, 0.0, size), (0.0, 12.0))
        fed = {x: -x, y: sp.Float(size) * x - 3 * y}
        yield Hostile(f"fed from zero, {size:g}", "small", fed, (1.0, 0.0), (0.0, 3.0))
    for size in (1e9, 1e20):
        wide = {x: v, v: -x, y: w, w: -4 * y + sp.sin(t) * y}
        yield Hostile(f"beside large, {size:g}", "small", wide, (size, 0.0, 1.0, 0.0), (0.0, 10.0))
    feedback = {x: v, v: -x + 10**12 * y, y: -2 * y}
    yield Hostile("small drives large", "small", feedback, (1.0, 0.0, 1e-12), (0.0, 8.0))
    chain = {x: -x, y: x * R(1, 10**8) - y / 2, z: y * 10**8 - z}
    yield Hostile("through a small one", "small", chain, (1.0, 0.0, 0.0), (0.0, 6.0))
    tiny = _body((1, 2, 3), (0, 0, 0))
    yield Hostile("slow body", "small", tiny, (1e-13, 2e-13, 1e-13), (0.0, 1e14))
    unstable = {x: v, v: -x, y: w, w: y * (1 + R(1, 10) * x)}
    yield Hostile("unstable from 1e-15", "small", unstable, (1.0, 0.0, 1e-15, 0.0), (0.0, 30.0))


# -- tables and windows ---------------------------------------------------------------------------


def _window(s: Expr, a: Expr, b: Expr, height: Expr) -> Expr:
    return sp.Piecewise((height, (s > a) & (s < b)), (0, True))


def _peak(name: str, at: float, width: float, height: float) -> Table:
    places = (at - 10 * width - 100, at - width, at, at + width, at + 10 * width + 100)
    return Table(name, places, (0.0, 0.0, height, 0.0, 0.0))


@_family("window")
def _windows() -> Rows:
    for at, width in ((2, R(1, 10)), (5, R(1, 100)), (50, R(1, 1000))):
        a, b = R(at), at + width
        edges = (float(a), float(b))
        rates = _oscillator(_window(t, a, b, 1 / width))
        name, until = f"{at} s, {float(width):g} s", (0.0, at + 3.0)
        yield Hostile(f"in time, {name}", "window", rates, (1.0, 0.0), until, knots=edges)
        table = _peak("peak", float(at), float(width), float(1 / width))
        corners = (float(at - width), float(at), float(at + width))
        yield Hostile(
            f"table in time, {name}",
            "window",
            _oscillator(table(t)),
            (1.0, 0.0),
            until,
            knots=table.breakpoints[1:-1],
        )
        ramp = sp.Max(0, 1 - sp.Abs(t - at) / width) / width
        yield Hostile(
            f"ramps in time, {name}", "window", _oscillator(ramp), (1.0, 0.0), until, knots=corners
        )
        spun = _body((10, 15, 20), (0, 0, _window(t, a, b, 20 / width)))
        yield Hostile(f"torque, {name}", "window", spun, (0.1, 0.2, 0.1), until, knots=edges)
    yield from _windows_in_state()


def _windows_in_state() -> Rows:
    """Yield windows, peaks and ramps of the place."""
    for at, width in ((1, R(1, 10)), (3, R(1, 100)), (9, R(1, 1000))):
        name, until = f"{at} m, {float(width):g} m", (0.0, at + 2.0)
        push = {x: v, v: _window(x, at, at + width, 1 / width)}
        yield Hostile(f"in state, {name}", "window", push, (0.0, 1.0), until, step=float(width) / 8)
        table = _peak("bump", float(at), float(width), float(1 / width))
        yield Hostile(
            f"table in state, {name}",
            "window",
            {x: v, v: table(x)},
            (0.0, 1.0),
            until,
            step=float(width) / 8,
        )
        hat = sp.Max(0, 1 - sp.Abs(x - at) / width) / width
        yield Hostile(
            f"ramps in state, {name}",
            "window",
            {x: v, v: hat},
            (0.0, 1.0),
            until,
            step=float(width) / 8,
        )
    square = {x: v, v: -x + _window(sp.sin(10 * t), R(99, 100), 2, 20)}
    yield Hostile("comb", "window", square, (1.0, 0.0), (0.0, 5.0), step=0.001)
    floor = {x: v, v: -R(981, 100) + 10**4 * sp.Max(0, -x)}
    yield Hostile("spring of a floor", "window", floor, (10.0, 0.0), (0.0, 4.0), step=0.001)
