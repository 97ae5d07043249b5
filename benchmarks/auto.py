"""What choosing a method costs, and what cyclic angles cost: integrated, or by quadrature afterwards.

    python -m benchmarks.auto

Figures: the least of many interleaved runs, in microseconds.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

import codegen
import eom
from codegen.integrate import choice as stiffness
from codegen.runs.pruning import part

NODES, WEIGHTS = np.polynomial.legendre.leggauss(5)
RUNS = {"c": 60, "numpy": 3}


def least(jobs: Mapping[str, Callable[[], Any]], runs: int) -> dict[str, float]:
    """Return the least time of each job, microseconds; the jobs take turns."""
    times: dict[str, float] = dict.fromkeys(jobs, np.inf)
    for _ in range(runs):
        for name, job in jobs.items():
            began = time.perf_counter()
            job()
            times[name] = min(times[name], 1e6 * (time.perf_counter() - began))
    return times


def choosing(name: str) -> None:
    """Compare `auto` with the method that it takes."""
    scene = eom.Scene.ready(name)
    compiled = codegen.compile(scene.derive())
    end = scene.integration.t_end
    plan = compiled, scene.initial_values(), (0.0, end), scene.parameter_values()
    taken = codegen.simulate(*plan)
    if "Taylor" not in taken.method:
        print(f"{name}: {taken.method}")
        return
    jobs = {m: lambda m=m: codegen.simulate(*plan, m) for m in ("auto", "taylor")}
    found = least(jobs, 200)
    more = found["auto"] / found["taylor"] - 1
    print(
        f"{name}: taylor {found['taylor']:.0f}, auto {found['auto']:.0f}, {100 * more:.1f} % more"
    )


def quadrature(target: str, method: str, rtol: float) -> None:
    """Two cyclic angles of the bicycle wheel: integrated, left out, left out and found afterwards."""
    scene = eom.Scene.ready("lecture-wheel")
    data = scene.model_dump(exclude_unset=True)
    data |= {"outputs": ("theta", "psi", "phi"), "initial": {**scene.initial, "phi": 0.0}}
    scene = eom.Scene(**data)
    compiled = codegen.compile(scene.derive(), target)
    less = part(compiled, ["theta"])
    names = compiled.layout.results["rates"]
    gone = [names.index(n) for n in less.left_out if n in names]
    kept = [k for k in range(len(names)) if k not in gone]
    values, start = scene.parameter_values(), scene.initial_values()
    p = np.array([values[q.name] for q in compiled.layout.parameters])

    def run(**options: Any) -> codegen.Result:
        return codegen.simulate(compiled, start, (0, 10), values, method, rtol, **options)

    def afterwards() -> Any:
        made = run(outputs=["theta"], dense_output=True)
        h = np.diff(made.t)
        t = (made.t[:-1, None] + 0.5 * h[:, None] * (1 + NODES)).ravel()
        x = np.zeros((len(names), t.size))
        x[kept] = made.sol(t)
        rates = compiled.rhs(t, x, p)[gone].reshape(len(gone), -1, len(NODES))
        return np.cumsum(0.5 * h * (rates @ WEIGHTS), axis=1)

    whole = run()
    change = afterwards()[:, -1] - (whole.y[gone, -1] - whole.y[gone, 0])
    jobs = {"whole": run, "less": lambda: run(outputs=["theta"]), "quadrature": afterwards}
    found = least(jobs, RUNS[target])
    print(
        f"{target}, {method}, {rtol:g}: integrated {found['whole']:.0f}, left out {found['less']:.0f}, "
        f"afterwards {found['quadrature']:.0f}, ratio {found['quadrature'] / found['whole']:.2f}, "
        f"difference {np.abs(change).max():.1e}"
    )


def main() -> None:
    """Print both."""
    print(f"stiff from {stiffness.WORTH} explicit steps on (generated C, Python)")
    for name in ("heavy-top", "lecture-wheel", "gravity-gradient-satellite", "t-handle"):
        choosing(name)
    for target in RUNS:
        for method in ("DOP853", "scipy:LSODA", *(["taylor"] if target == "c" else [])):
            for rtol in (1e-6, 1e-9):
                quadrature(target, method, rtol)


if __name__ == "__main__":
    main()
