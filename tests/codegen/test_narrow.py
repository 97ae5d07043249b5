"""Narrow features: no step of any method passes over a pulse, a wall, a window or a jump."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import sympy as sp
from numpy.typing import NDArray

import codegen
from codegen.compiling.compiled import generate
from codegen.ir import scalars
from codegen.ir.interpret import Point, interpret
from codegen.ir.program import Builder
from codegen.ir.scalars import Scalar
from codegen.loops import written
from codegen.native import native
from codegen.watch import intervals, trust
from codegen.watch.narrow import ORDER, SOON, narrow
from eom import Table
from eom.errors import InputError
from eom.structure import BodyAttitude
from eom.system import System

x, v, M = sp.symbols("x v M", real=True)
t = sp.Symbol("t", real=True)
R = sp.Rational
needs_compiler = pytest.mark.skipif(not native.compiler(), reason="methods in C")
Case = tuple[Any, float, tuple[float, float]]
EXPLICIT = ("DOP853", "DP5", "Tsit5")
OTHERS = ("scipy:RK45", "scipy:DOP853", "scipy:Radau", "scipy:BDF", "scipy:LSODA")
SUNDIALS = ("sundials:BDF", "sundials:Adams")


def oscillator(force: Any) -> System:
    """A mass on a spring with a further force."""
    return System.from_rates("driven", {x: v, v: -x + force}, time=t)


def error(
    system: System, case: Case, truth: NDArray[np.float64], method: str, rtol: float
) -> float:
    """The error at the end, over tolerance; a run that fails or warns has none."""
    _, end, start = case
    run = codegen.simulate(
        system, {"x": start[0], "v": start[1]}, (0, end), method=method, rtol=rtol
    )
    if run.status < 0 or run.notice:
        return 0.0
    return float(np.max(np.abs(run.y[:, -1] - truth))) / rtol


# --- functions of time alone: the truth is an integral ---------------------------------------------


def gauss(f: Callable[[float], float], pieces: list[float]) -> NDArray[np.float64]:
    """x and v at the last of the pieces of the oscillator from rest, by Gauss-Legendre in each piece."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    end, found = pieces[-1], np.zeros(2)
    for a, b in pairwise(pieces):
        at = a + (b - a) * (nodes + 1) / 2
        with np.errstate(all="ignore"):
            values = np.array([f(s) for s in at]) * weights * (b - a) / 2
        found += [np.sum(values * np.sin(end - at)), np.sum(values * np.cos(end - at))]
    return found


def _about(centre: float, width: float, end: float) -> list[float]:
    """Pieces that grow away from a place, up to both ends."""
    steps = [width * 1.4**k for k in range(60) if width * 1.4**k < max(centre, end - centre)]
    inner = [centre - s for s in steps[::-1]] + [centre] + [centre + s for s in steps]
    return [0.0, *(p for p in inner if 0 < p < end), end]


PULSES: dict[str, tuple[Any, list[float]]] = {
    "gauss": (20 * sp.exp(-(((t - 20) / R(1, 2)) ** 2)), _about(20, 0.1, 30)),
    "kick": (20 * sp.exp(-(((t - 2) / R(1, 50)) ** 2)), _about(2, 0.005, 10)),
    "late": (20 * sp.exp(-(((t - 1000) / R(1, 50)) ** 2)), _about(1000, 0.005, 1010)),
    "two": (
        9 * sp.exp(-(((t - 3) / R(1, 100)) ** 2)) - 5 * sp.exp(-(((t - 8) / R(1, 200)) ** 2)),
        sorted({*_about(3, 0.002, 11), *_about(8, 0.001, 11)}),
    ),
    "window": ((sp.tanh(50 * (t - 7)) - sp.tanh(50 * (t - R(71, 10)))) / 2, _about(7.05, 0.005, 12)),
    "logistic": (
        1 / (1 + sp.exp(-300 * (t - 5))) - 1 / (1 + sp.exp(-300 * (t - R(51, 10)))),
        _about(5.05, 0.001, 10),
    ),
    "erf": (sp.erf(50 * (t - 5)) - sp.erf(50 * (t - R(51, 10))), _about(5.05, 0.005, 10)),
    "lorentz": (1000 / (1 + (1000 * (t - 3)) ** 2), _about(3, 0.0005, 10)),
    "sech": (100 / sp.cosh(40 * (t - 7)) ** 2, _about(7, 0.005, 10)),
    "power": (30 * sp.cos(t / 2) ** 40 * sp.sin(t / 2), list(np.linspace(0, 20, 81))),
    "parabola": (20 * sp.exp(-100 * (t**2 - 25) ** 2), _about(5, 0.0005, 12)),
}  # fmt: skip


@pytest.mark.sparse(2)
@pytest.mark.parametrize("name", PULSES)
def test_pulses_in_time_are_met_by_every_method(name: str) -> None:
    """Every method, at two tolerances; growth of the oscillator is one."""
    force, pieces = PULSES[name]
    truth = gauss(sp.lambdify(t, force, ["scipy", "numpy"]), pieces)
    assert np.max(np.abs(truth)) > 1e-3
    system, case = oscillator(force), (force, pieces[-1], (0.0, 0.0))
    for method in EXPLICIT:
        assert error(system, case, truth, method, 1e-6) < 1000
        assert error(system, case, truth, method, 1e-9) < 1000
    for method in (*OTHERS, *SUNDIALS) if name == "kick" else ("scipy:LSODA",):
        assert error(system, case, truth, method, 1e-6) < 1000


STEPS: dict[str, tuple[Any, list[float]]] = {
    "window": (sp.Piecewise((100, (t > 5) & (t < R(501, 100))), (0, True)), [0, 5, 5.01, 10]),
    "periodic": (
        sp.Piecewise((10, sp.Mod(t, 2) < R(1, 100)), (0, True)),
        sorted([*range(0, 10, 2), *(k + 0.01 for k in range(0, 10, 2)), 9]),
    ),
    "square": (sp.sign(sp.sin(3 * t)), [*(k * math.pi / 3 for k in range(9)), 9]),
    "table": (
        Table("peak", [0, 5, 5.01, 5.02, 9], [0, 0, 100, 0, 0])(t),
        [0, 5, 5.01, 5.02, 9],
    ),
}  # fmt: skip


@pytest.mark.sparse(only=("square",))
@pytest.mark.parametrize("name", STEPS)
def test_steps_end_where_functions_of_time_change_their_piece(name: str) -> None:
    """The method has no error of its own there, so that few steps do."""
    force, pieces = STEPS[name]
    peak = [0.0, 0.0, 100.0, 0.0, 0.0]
    f = (lambda s: float(np.interp(s, pieces, peak))) if name == "table" else sp.lambdify(t, force)
    truth = gauss(f, [float(p) for p in pieces])
    system, case = oscillator(force), (force, float(pieces[-1]), (0.0, 0.0))
    for method in (*EXPLICIT, *OTHERS, *SUNDIALS) if name == "window" else (*EXPLICIT, "scipy:BDF"):
        assert error(system, case, truth, method, 1e-6) < 100
    assert error(system, case, truth, "DOP853", 1e-9) < 10


# --- states: the truth is another method's with steps that cannot miss ------------------------------


WALLS: dict[str, Case] = {
    "friction": (-sp.tanh(100 * v) / 2, 10.0, (1.0, 0.0)),
    "floor": (x - 1 + 100 * sp.exp(-100 * x) / (1 + sp.exp(-100 * x)), 6.0, (10.0, 0.0)),
    "wall": (x + 1 / x**12, 3.0, (10.0, -10.0)),
    "bump": (20 * sp.exp(-((500 * x) ** 2)), 10.0, (1.0, 0.0)),
    "well": (x - 4000 * sp.exp(-20 * (x - 1)) * (sp.exp(-20 * (x - 1)) - 1) * -1, 3.0, (5.0, -3.0)),
}  # fmt: skip
FINE = {"friction": 5e-3, "floor": 1e-2, "wall": 5e-3, "bump": 5e-4, "well": 5e-3}


@pytest.mark.sparse(only=("friction", "well"))
@pytest.mark.parametrize("name", WALLS)
def test_narrow_features_in_states_are_met_at_speed(name: str) -> None:
    """Against the same at 1e-13 with short steps; what a small error at the start grows to is allowed."""
    force, end, start = case = WALLS[name]
    system = oscillator(force)

    def reference(shift: float) -> NDArray[np.float64]:
        first = {"x": start[0] + shift, "v": start[1]}
        run = codegen.simulate(
            system, first, (0, end), method="DOP853", rtol=1e-13, max_step=FINE[name]
        )
        return run.y[:, -1]

    truth = reference(0.0)
    growth = 1 + float(np.max(np.abs(reference(1e-7) - truth))) / 1e-7
    for method in EXPLICIT:
        assert error(system, case, truth, method, 1e-6) < 1000 * growth
        assert error(system, case, truth, method, 1e-9) < 1000 * growth
    for method in (*OTHERS, *SUNDIALS) if name in {"wall", "bump"} else OTHERS[-1:]:
        assert error(system, case, truth, method, 1e-6) < 1000 * growth


@pytest.mark.slow
def test_windows_of_state_give_their_energy() -> None:
    """A force of 1000 over a window of 1/1000 adds 1 to the energy of a mass that is thrown through it."""
    force = sp.Piecewise((1000, (x > R(1, 2)) & (x < R(501, 1000))), (0, True))
    system = System.from_rates("thrown", {x: v, v: force})
    for method in (*EXPLICIT, *OTHERS, *SUNDIALS):
        run = codegen.simulate(system, {"x": -3, "v": 2}, (0, 3), method=method, rtol=1e-6)
        assert run.status == 0
        assert run.y[1, -1] == pytest.approx(math.sqrt(4 + 2), rel=1e-3), method


@pytest.mark.slow
def test_a_narrow_peak_of_a_table_over_a_state_is_met() -> None:
    """A peak of 1/100 in the way gives its area as energy, before the mass turns back."""
    peak = Table("peak", [-9, 0.5, 0.505, 0.51, 9], [0, 0, 100, 0, 0])
    system = System.from_rates("thrown", {x: v, v: peak(x)}, time=t)
    for method in (*EXPLICIT, "scipy:RK45", "scipy:Radau", "scipy:BDF", "sundials:BDF"):
        run = codegen.simulate(system, {"x": -3, "v": 2}, (0, 3), method=method, rtol=1e-6)
        assert run.status == 0
        assert run.y[1, -1] == pytest.approx(math.sqrt(4 + 2 * 0.5), rel=1e-4), method


def _satellite(torque: Any) -> System:
    q = sp.symbols("q0:4", real=True)
    w = sp.symbols("w1:4", real=True)
    J, h = (10, 15, 20), R(1, 2)
    rates = {
        q[0]: h * (-q[1] * w[0] - q[2] * w[1] - q[3] * w[2]),
        q[1]: h * (q[0] * w[0] + q[2] * w[2] - q[3] * w[1]),
        q[2]: h * (q[0] * w[1] + q[3] * w[0] - q[1] * w[2]),
        q[3]: h * (q[0] * w[2] + q[1] * w[1] - q[2] * w[0]),
        w[0]: ((J[1] - J[2]) * w[1] * w[2] + torque) / J[0],
        w[1]: (J[2] - J[0]) * w[2] * w[0] / J[1],
        w[2]: (J[0] - J[1]) * w[0] * w[1] / J[2],
    }
    body = BodyAttitude(omega=w, kind="quaternion", coordinates=q)
    return System.from_rates("satellite", rates, time=t, attitudes=(body,))


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize("method", EXPLICIT)
@pytest.mark.parametrize("start", [4, 5])
def test_the_step_over_a_jump_is_taken_whatever_its_error(method: str, start: int) -> None:
    """Ten units in the last place of time, no shorter, at tolerances that such a step does not meet."""
    window = sp.Gt(t, start) & sp.Lt(t, start + R(1, 100))
    system = oscillator(sp.Piecewise((5000, window), (0, True)))
    truth = gauss(lambda s: 5000.0 if start < s < start + 0.01 else 0.0, [start, start + 0.01, 8.0])
    for rtol in (1e-12, 1e-13):
        run = codegen.simulate(
            system, {"x": 0, "v": 0}, (0, 8), method=method, rtol=rtol, atol=1e-12
        )
        assert run.status == 0
        assert np.max(np.abs(run.y[:, -1] - truth)) < 1e-9


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize(
    "torque",
    [
        40 * sp.exp(-(((t - 20) / R(1, 2)) ** 2)),
        20 * (sp.tanh(10 * (t - 20)) - sp.tanh(10 * (t - 21))),
        50 * sp.exp(-((200 * (sp.Symbol("q1", real=True) - R(1, 4))) ** 2)),
    ],
)
def test_the_method_on_the_group_meets_pulses(torque: Any) -> None:
    """Two methods that share no formula of the attitude agree."""
    system = _satellite(torque)
    start = dict(zip(system.state_names, [1, 0, 0, 0, 0.1, 0.2, 0.3], strict=True))
    fine = codegen.simulate(system, start, (0, 30), method="DP5", rtol=1e-11, max_step=0.01)
    quiet = codegen.simulate(_satellite(sp.Integer(0)), start, (0, 30), method="DOP853", rtol=1e-10)
    assert np.max(np.abs(fine.y[:, -1] - quiet.y[:, -1])) > 1e-2
    for rtol in (1e-6, 1e-9):
        run = codegen.simulate(system, start, (0, 30), method="rkmk", rtol=rtol)
        assert run.status == 0
        assert np.max(np.abs(run.y[:, -1] - fine.y[:, -1])) < 1000 * rtol


# --- what must not change, and what is found by law ------------------------------------------------


def test_polynomial_rates_and_those_of_angles_have_nothing_watched() -> None:
    """The generated code of a loop has then no word of it."""
    angle, rate = sp.symbols("angle rate", real=True)
    pendulum = System.from_rates(
        "pendulum", {angle: rate, rate: -sp.sin(angle) / (1 + sp.cos(angle) ** 2)}
    )
    for system in (pendulum, System.from_rates("duffing", {x: v, v: -x - x**3})):
        compiled = codegen.compile(system, "numpy")
        found = narrow(compiled.program)
        assert found.ahead is None
        assert found.watched is None
        for row in ("dop853", "dp5", "tsit5"):
            texts = generate(compiled.program, compiled.layout, "c", written.Choice(row))
            assert "look_ahead" not in "".join(texts.values())
            assert "is_cut" not in "".join(texts.values())


def test_arguments_of_time_are_looked_ahead_of_and_others_watched() -> None:
    """One state in an argument is enough for it to be watched at the stages."""
    both = oscillator(sp.exp(-((t - 5) ** 2)) + sp.exp(-((x - t) ** 2)) + sp.Abs(v))
    found = narrow(codegen.compile(both, "numpy").program)
    assert found.ahead is not None
    assert (found.guards, found.pieces) == (1, 1)


def test_bounds_hold_wherever_leaves_move() -> None:
    """Random compositions of operations, at random places between the bounds of time."""
    draw = random.Random(5)
    unary = [op for op, rule in intervals.RULES.items() if rule.__code__.co_argcount == 1]
    binary = ["add", "sub", "mul", "div", "min", "max", "hypot", "lt", "le", "atan2"]
    for _ in range(150):
        b = Builder()
        values = [scalars.time(b), scalars.constant(b, draw.uniform(-2, 2))]
        for _ in range(6):
            if draw.random() < 0.5:
                values.append(scalars.apply(draw.choice(unary), draw.choice(values)))
            else:
                values.append(scalars.apply(draw.choice(binary), values[-1], draw.choice(values)))
        program = scalars.program(b, {"f": [values[-1]]})
        low, high = sorted((draw.uniform(-3, 3), draw.uniform(-3, 3)))
        _assert_within(program, low, high, draw)


def _assert_within(program: Any, low: float, high: float, draw: random.Random) -> None:
    b = Builder()
    ends = intervals.Interval(*scalars.scalars(b, "state", 2))

    def leaf(i: Any) -> intervals.Interval:
        own = Scalar(b, b.leaf(i.op, i.value))
        return ends if i.op == "time" else intervals.Interval(own, own)

    found = intervals.bounds(program, b, leaf, range(len(program.instructions)))
    wanted = found[program.results["f"][0]]
    if wanted is None:
        return
    inner = [e for i in found.values() if i is not None for e in (i.low, i.high)]
    both = scalars.program(b, {"f": [wanted.low, wanted.high, *inner]})
    least, most, *others = interpret(both, Point(x=(low, high)))["f"]
    if any(map(math.isnan, others)):  # infinite bounds that cancel say nothing
        return
    slack = 1e-9 * (1 + min(abs(least), 1e300) + min(abs(most), 1e300))
    for _ in range(20):
        at = draw.uniform(low, high)
        everything = {"all": tuple(range(len(program.instructions))), **program.results}
        values = interpret(replace(program, results=everything), Point(t=at))
        value = values["f"][0]
        assert not all(map(math.isfinite, values["all"])) or least - slack <= value <= most + slack


@pytest.mark.parametrize("op", SOON)
def test_what_is_always_allowed_is_within_the_reach(op: str) -> None:
    """The short way of most steps is a lower bound of the table's."""
    share, length = SOON[op]
    for u in (-700.0, -3.0, -0.5, 1e-6, 0.7, 20.0, 1e5):
        args = [1.0, u] if op == "div" else [abs(u)] if op == "log" else [u]
        assert max(share * abs(u), length) <= trust.reach_of(op, args, ORDER) * (1 + 1e-12)


@pytest.mark.parametrize(
    "f", [1 / x, 1 / x**3, sp.log(x), sp.atan(x), sp.exp(x), 1 / (x * sp.exp(v))]
)
def test_what_no_bounds_are_made_for_is_what_the_verdict_allows(f: Any) -> None:
    """The short way says of no movement that it is allowed where the whole law cuts the step."""
    system = System.from_rates("one", {x: f, v: x})
    found = narrow(codegen.compile(system, "numpy").program)
    assert found.verdict is not None
    draw, allowed = random.Random(3), 0
    for _ in range(300):
        slots: list[float] = []
        quiet = True
        for (share, length), one_sided in zip(found.soon, found.to_zero, strict=True):
            here = draw.choice((-1, 1)) * 10 ** draw.uniform(-2, 2)
            down, up = (10 ** draw.uniform(-3, 3) for _ in range(2))
            nearer, further = (up, down) if here < 0 else (down, up)
            move = nearer if one_sided else max(nearer, further)
            quiet &= move <= max(share * abs(here), length)
            slots += [here, here - down, here + up]
        shares = interpret(found.verdict, Point(x=[*slots, 30.0]))["verdict"]
        allowed += quiet
        assert not quiet or min(shares[: found.guards]) >= 1
    assert 10 < allowed < 290


# --- inputs that are Python functions ---------------------------------------------------------------


DRIVEN = System.from_rates("driven", {x: v, v: -x + M}, time=t, inputs=(M,))


def _kick(s: float) -> float:
    return 50.0 if 5 <= s < 5.01 else 0.0


@pytest.mark.parametrize("method", ["auto", *EXPLICIT, *OTHERS, *SUNDIALS])
def test_signals_state_where_they_jump(method: str) -> None:
    """Steps end at the knots, so that a kick of 10 ms is met by every method, and nothing is reported."""
    signal = codegen.Signal(_kick, knots=(5, 5.01))
    run = codegen.simulate(
        DRIVEN, {"x": 0, "v": 0}, (0, 10), method=method, rtol=1e-6, inputs={"M": signal}
    )
    truth = gauss(_kick, [0, 5, 5.01, 10])
    assert run.status == 0
    assert np.max(np.abs(run.y[:, -1] - truth)) < 1e-4
    assert "M" not in run.notice


def test_signals_state_the_longest_step() -> None:
    """A pulse between two steps is met where they are no longer than it is wide."""
    pulse = codegen.Signal(lambda s: 20 * math.exp(-(((s - 5) / 0.005) ** 2)), max_step=0.01)
    start = {"x": 0, "v": 0}
    run = codegen.simulate(DRIVEN, start, (0, 10), rtol=1e-6, atol=1e-9, inputs={"M": pulse})
    truth = gauss(pulse, _about(5, 0.001, 10))
    assert np.max(np.abs(run.y[:, -1] - truth)) < 1e-5
    assert run.steps >= 1000
    assert run.notice in {"", codegen.compile(DRIVEN).notice}


@pytest.mark.parametrize(
    "method", ["DOP853", "scipy:BDF", "scipy:LSODA", "scipy:Radau", "sundials:BDF"]
)
def test_plain_functions_are_sampled_within_steps_and_reported(method: str) -> None:
    """A pulse of 1/100 of the run is found, though the mass rests before; the run says what it trusts."""

    def pulse(s: float) -> float:
        return 20 * math.exp(-(((s - 5) / 0.05) ** 2))

    run = codegen.simulate(
        DRIVEN, {"x": 0, "v": 0}, (0, 10), method=method, rtol=1e-6, inputs={"M": pulse}
    )
    assert np.max(np.abs(run.y[:, -1] - gauss(pulse, _about(5, 0.01, 10)))) < 1e-4
    assert "M is a Python function" in run.notice


@pytest.mark.parametrize("function", [lambda: 1.0, lambda a, b, c: 1.0, lambda s: None, lambda s: "1",
                                      lambda s: 1j, lambda s: np.array([1.0])])  # fmt: skip
def test_functions_that_are_no_inputs_are_refused(function: Any) -> None:
    """Of the wrong arity, or without a number: one message that names the input."""
    with pytest.raises(InputError, match="input"):
        codegen.simulate(DRIVEN, {"x": 0, "v": 0}, (0, 1), inputs={"M": function})


@pytest.mark.parametrize("wrong", [{"knots": (0, math.nan)}, {"knots": 3}, {"knots": "ab"}, {"max_step": 0},
                                   {"max_step": "1"}])  # fmt: skip
def test_signals_are_checked(wrong: dict[str, Any]) -> None:
    """What they state are times."""
    with pytest.raises(InputError, match="Signal"):
        codegen.Signal(math.sin, **wrong)
    with pytest.raises(InputError, match="Signal"):
        codegen.Signal(3.0)  # type: ignore[arg-type]
