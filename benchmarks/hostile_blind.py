"""``python -m benchmarks.hostile_blind [METHOD ...]``: hostile systems by someone who knew no code.

103 initial value problems, written from the promise alone that no result is silently wrong, each with a
reference by two kinds of computation (extrapolation in 80-bit numbers, and SciPy's DOP853 at 1e-13 in
short pieces) and the growth of errors, by perturbation. They were judged once; what was wrong then is
mended, and they are tests since. Judged as in `codegen.measure.stress.hostile`.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp
from sympy.parsing.sympy_parser import parse_expr

import codegen
from codegen.measure.stress.hostile import RTOLS, Known, trusted
from codegen.native.children import TooLongError, watch
from eom.errors import InputError
from eom.quantities import TIME
from eom.system import BodyAttitude, System

STORE = Path(__file__).with_suffix(".json")
METHODS = (
    "auto", "taylor", "DOP853", "DP5", "Tsit5", "rkmk", "splitting",
    "scipy:RK45", "scipy:LSODA", "scipy:Radau",
)  # fmt: skip
SECONDS = 20.0
"""Processor time after which a run is given up."""
Case = Mapping[str, Any]


def cases() -> Mapping[str, Case]:
    """Return the problems by name: rates by state, start, span, moments of a body, end, sizes, growth."""
    found: Mapping[str, Case] = json.loads(STORE.read_text(encoding="ascii"))
    return found


def system_of(name: str, case: Case) -> System:
    """Return a problem as a system, which states its body where it has one."""
    known = {n: sp.Symbol(n, real=True) for n in case["rates"]} | {"t": TIME}
    rates = {
        known[n]: parse_expr(text, local_dict=dict(known)) for n, text in case["rates"].items()
    }
    if "moments" not in case:
        return System.from_rates(name, rates)
    J = sp.diag(*map(sp.Rational, case["moments"]))
    omega = sp.Matrix([known[f"w{k}"] for k in (1, 2, 3)])
    free = J.inv() * (-omega.cross(J * omega))
    torque = [J[k, k] * (rates[omega[k]] - free[k]) for k in range(3)]
    turned = [known[f"q{k}"] for k in range(4)] if "q0" in known else []
    kind = "quaternion" if turned else "none"
    a, b, c = omega
    body = BodyAttitude((a, b, c), kind, tuple(turned), inertia=J, torque=tuple(torque))
    try:
        return System.from_rates(name, rates, attitudes=(body,))
    except InputError:  # not proved by its form: then nothing is stated
        return System.from_rates(name, rates)


def known(case: Case) -> Known:
    """Return the reference of a problem, as the hostile table has them."""
    sizes = np.array([size or 1.0 for size in case["sizes"]])
    return Known(
        np.array(case["span"][1:]), np.array([case["end"]]), sizes, np.array([case["growth"]])
    )


def judged(name: str, case: Case, method: str, rtol: float) -> str:
    """Return ok, reported, stopped, refused or slow; or what is wrong."""
    compiled = codegen.compile(system_of(name, case))
    try:
        with np.errstate(all="ignore"):
            run = codegen.simulate(
                compiled, case["start"], tuple(case["span"]), method=method, rtol=rtol,
                t_eval=case["span"][1:], progress=watch(SECONDS),
            )  # fmt: skip
    except TooLongError:
        return "slow"
    except InputError:
        return "refused"
    if run.status < 0:
        return "stopped"
    off = known(case).share(run.y[:, -1:], rtol)
    if off <= 1:
        return "ok"
    return f"WRONG by {off:.1e}" if trusted(run, compiled) else "reported"


def verdicts(methods: Sequence[str]) -> Iterator[tuple[str, str, float, str]]:
    """Yield name, method, tolerance and verdict of every run."""
    for name, case in cases().items():
        for method in methods:
            for rtol in RTOLS:
                yield name, method, rtol, judged(name, case, method, rtol)


def main(methods: Sequence[str]) -> int:
    """Print what is wrong, and how many runs of each method end how; return 1 where something is wrong."""
    counts: dict[str, Counter[str]] = {}
    for name, method, rtol, verdict in verdicts(methods or METHODS):
        wrong = verdict.startswith("WRONG")
        counts.setdefault(method, Counter())["WRONG" if wrong else verdict] += 1
        if wrong:
            print(f"{name}: {method} at {rtol:.0e}: {verdict}", flush=True)
    for method, found in counts.items():
        print(f"{method:12s}", ", ".join(f"{n} {word}" for word, n in sorted(found.items())))
    return int(any("WRONG" in found for found in counts.values()))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
