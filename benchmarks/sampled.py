"""What laws that are sampled cost: in the loops in C, and called from Python.

    python -m benchmarks.sampled

In C: the time of a step with a sample at its end, over that of the same run with held inputs and steps that
are as many and as long (``max_step``). The laws give zero, so that both make the same motion. Beside it how
often each evaluates the rates in a step (of series: orders of coefficients): a law that changes an input
makes the rates at the end of a step worthless for the next one, which methods that estimate their error
by them (DP5, Tsit5) pay for by one more. In Python: what a call of f(t, x) costs beside the function
itself. Figures: least times of many interleaved runs.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

import codegen
import eom
from codegen.compiling.signals import Inputs

PERIOD, SAMPLES, RUNS = 0.01, 10_000, 80
METHODS = ("taylor", "DOP853", "DP5", "Tsit5")
LIMIT, CALL_LIMIT = 1.1, 3.0


@dataclass(frozen=True)
class Case:
    """A system with its numbers, and a law for each input that is zero for gains of zero."""

    name: str
    system: eom.System
    start: Mapping[str, float]
    parameters: Mapping[str, float]
    law: Mapping[str, Any]


def cases() -> Iterator[Case]:
    """Yield a pendulum, a satellite and an arm, under proportional and derivative feedback."""
    k, d = sp.symbols("k_gain d_gain")
    x, v, u = sp.symbols("x v u", real=True)
    pendulum = eom.System.from_rates("pendulum", {x: v, v: u - sp.sin(x)}, inputs=[u])
    yield Case("pendulum", pendulum, {"x": 1.0, "v": 0.0}, {}, {"u": -k * x - d * v})
    scene = eom.Scene(
        attitude="quaternion", body={"moments": (12.0, 14.0, 8.0)},
        torque={"components": ("u_1", "u_2", "u_3")},
        inputs=dict.fromkeys(("u_1", "u_2", "u_3"), 0.0),
        initial={"omega_1": 0.1, "omega_2": -0.1, "omega_3": 0.0},
        initial_attitude={"sequence": "3-2-1", "degrees": (0, 20, 50)},
    )  # fmt: skip
    q, w = ([sp.Symbol(f"{n}{i}") for i in range(f, 4)] for n, f in (("q", 0), ("omega_", 1)))
    law = {f"u_{i}": -k * q[0] * q[i] - d * w[i - 1] for i in (1, 2, 3)}
    yield Case("satellite", scene.derive(), scene.initial_values(), scene.parameter_values(), law)
    data = eom.load_scene("double-pendulum").model_dump(exclude_unset=True)
    for joint in data["joints"].values():
        joint["motor"] = True
    arm = eom.TreeScene(**data)
    system = arm.derive()
    x = [sp.Symbol(n) for n in system.state_names]
    law = {n: -k * x[i] - d * x[2 + i] for i, n in enumerate(system.input_names)}
    yield Case("arm", system, arm.initial_values(), arm.parameter_values(), law)


def ratio(case: Case, method: str) -> tuple[float, float, tuple[float, float]]:
    """Return the time of a step with a sample (us), and over that of one with held inputs.

    With evaluations a step, of both.
    """
    compiled, end = codegen.compile(case.system), PERIOD * SAMPLES
    gains = dict.fromkeys(("k_gain", "d_gain"), 0.0)
    plan: dict[str, Any] = {"method": method, "rtol": 1e-6, "t_eval": [end]}

    def sampled() -> codegen.Result:
        law = codegen.Sampled(case.law, PERIOD)
        return codegen.simulate(
            compiled, case.start, (0, end), {**case.parameters, **gains}, inputs=law, **plan
        )

    def held() -> codegen.Result:
        return codegen.simulate(
            compiled, case.start, (0, end), case.parameters, max_step=PERIOD,
            inputs=dict.fromkeys(case.law, 0.0), **plan,
        )  # fmt: skip

    counts = [r.nfev / (r.steps + r.rejected) for r in (sampled(), held())]
    pairs = [(sampled(), held()) for _ in range(RUNS)]
    one, other = (min(r[k].seconds / r[k].steps for r in pairs) for k in (0, 1))
    return 1e6 * one, one / other, (counts[0], counts[1])


def least(call: Callable[[], object], count: int = 500, runs: int = 500) -> float:
    """Return the least time of a call, us."""
    times = []
    for _ in range(runs):
        began = time.perf_counter()
        for _ in range(count):
            call()
        times.append(1e6 * (time.perf_counter() - began) / count)
    return min(times)


def called() -> tuple[float, float]:
    """Return what a call of f(t, x) costs beside f in a continuous run, and in all at a sample (us)."""

    def f(_: float, x: Mapping[str, float]) -> float:
        return -4.0 * x["x"] - 3.0 * x["v"]

    names, state, given = ("x", "v"), np.array([1.0, 0.0]), {"x": 1.0, "v": 0.0}
    inputs = Inputs(np.zeros(1), ("u",), {"u": codegen.Signal(f, max_step=1.0)}, names)
    beside = least(lambda: inputs(0.5, state)) - least(lambda: f(0.5, given))
    case = next(cases())
    compiled, end = codegen.compile(case.system), PERIOD * SAMPLES
    plan: dict[str, Any] = {"method": "DOP853", "rtol": 1e-6, "t_eval": [end]}

    def run(law: Any, **more: Any) -> float:
        made = codegen.simulate(compiled, case.start, (0, end), inputs={"u": law}, **plan, **more)
        return 1e6 * made.seconds / made.steps

    law = codegen.Sampled(lambda t, x: 0.0 * x["x"], PERIOD)
    rows = [(run(law), run(0.0, max_step=PERIOD)) for _ in range(RUNS)]
    return beside, min(a for a, _ in rows) - min(b for _, b in rows)


def main() -> None:
    """Measure, and print."""
    print(
        f"sampled in C, {SAMPLES:,} samples: us a step, over that with held inputs (at most {LIMIT})"
    )
    for case in cases():
        for method in METHODS:
            step, over, (one, other) = ratio(case, method)
            counts = f"{one:.2f} and {other:.2f} evaluations"
            print(f"  {case.name:10} {method:8} {step:6.3f} us  {over:5.2f}  {counts}")
    beside, sample = called()
    print(f"f(t, x) in Python: {beside:.2f} us a call beside the function (at most {CALL_LIMIT})")
    print(f"a sample that calls f(t, x) from C: {sample:.2f} us, the function in it")


if __name__ == "__main__":
    main()
