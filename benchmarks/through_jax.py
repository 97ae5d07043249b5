"""``python -m benchmarks.through_jax [SCENE ...]``: the target jax beside ours, for every ready scene.

Values of the rates; gradients of trajectories, by `jax.jacrev` back through diffrax and by our
sensitivities forwards; 10,000 trajectories by `jax.vmap` and by `codegen.ensemble`. Runs go to a twentieth
of the scene's own time. Each scene is a process of its own; its differences are printed as they fall, with
the seconds of both sides (the second call, compiled), and judged. ``--gradients`` leaves the many
trajectories out.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np
from rich.console import Console

from benchmarks.table import Row, Section, missed, table, time_text
from codegen import compile as compile_system
from codegen import ensemble, integrator, sensitivities
from codegen.frontend.layout import names_of
from eom import load_scene
from eom.scenes import catalogue
from eom.system import System

Array = Any
SHARE = 20
MANY = 10_000
VALUES, GRADIENTS, TRAJECTORIES = 1e-14, 1e-9, 1e-7
"""Largest differences: of rates, of gradients, of many trajectories (both at a tolerance of 1e-10)."""
LEAST = 1e-6
LIMIT = 1500.0
"""Seconds for a scene, in which XLA compiles its programs."""
RATES = {"rad/s", "m/s"}


class Compared:
    """A scene with its numbers, compiled for jax and for C."""

    def __init__(self, name: str) -> None:
        scene = load_scene(name)
        self.system: System = scene.derive()
        self.end = scene.integration.t_end / SHARE
        self.start, self.parameters = scene.initial_values(), scene.parameter_values()
        self.inputs = scene.input_values()
        self.module = compile_system(self.system, "jax").module
        self.ours = compile_system(self.system, "c")

    def vectors(self) -> tuple[Array, Array, Array]:
        """Return first states (n,), parameters (m,) and inputs (k,)."""
        known = {**self.start, **self.parameters, **self.inputs}
        groups = (self.module.STATES, self.module.PARAMETERS, self.module.INPUTS)
        x, p, u = (np.array([known[n] for n in names], dtype=float) for names in groups)
        return x, p, u

    def last(self, rtol: float) -> Callable[[Array, Array], Array]:
        """Return the states at the end as a function of first states and parameters, by diffrax."""
        import diffrax

        _, _, u = self.vectors()
        term = diffrax.ODETerm(lambda t, x, p: self.module.rhs(t, x, p, u))
        steps = diffrax.PIDController(rtol=rtol, atol=rtol / 100)

        def end(x: Array, p: Array) -> Array:
            return diffrax.diffeqsolve(
                term, diffrax.Dopri8(), 0.0, self.end, self.end / 1000, x, p,
                stepsize_controller=steps, max_steps=20_000,
            ).ys[0]  # fmt: skip

        return end

    def values(self) -> float:
        """Return the largest difference of a rate, over the largest rate, at 1000 points near the start."""
        import jax

        x, p, u = self.vectors()
        points = x[:, None] + np.random.default_rng(1).uniform(-0.01, 0.01, (len(x), 1000))
        got = jax.jit(jax.vmap(self.module.rhs, (None, 1, None, None), 1))(0.3, points, p, u)
        expected = self.ours.rhs(0.3, points, p, u)
        return worst(np.asarray(got), expected, axis=0)

    def gradients(self) -> dict[str, float]:
        """Return the largest difference of a derivative, over the largest by the same variable.

        What moves nothing by more than `LEAST` of what others do is measured by that: a derivative that
        is zero is known to rounding alone.
        """
        import jax

        x, p, _ = self.vectors()
        by = [*self.module.PARAMETERS], [*self.module.STATES]
        grown = sensitivities(self.ours, *by)
        run = integrator(
            grown.compiled, method="DOP853", rtol=1e-12, t_span=(0.0, self.end),
            inputs=self.inputs or None,
        )  # fmt: skip
        first = grown.initial(self.start)
        found, ours = twice(lambda: run.run(first, self.parameters).y[:, -1])
        expected = grown.matrix(found)
        back = jax.jit(jax.jacrev(self.last(1e-11), argnums=(1, 0)))
        got, theirs = twice(lambda: [np.asarray(m) for m in back(x, p)])
        sizes = np.abs([*p, *x])
        sizes[sizes == 0] = 1.0
        least = LEAST * np.abs(expected * sizes).max()
        difference = worst(np.hstack(got) * sizes, expected * sizes, axis=0, least=least)
        return {"gradients": difference, "ours": ours, "theirs": theirs}

    def many(self) -> dict[str, float]:
        """Return the largest difference of a state at the end, over its largest size."""
        import jax

        x, p, _ = self.vectors()
        moving = [k for k, q in enumerate(self.system.states) if q.unit in RATES]
        first = np.repeat(x[:, None], MANY, axis=1)
        first[moving] += np.random.default_rng(3).uniform(-0.01, 0.01, (len(moving), MANY))
        initial = dict(zip(names_of(self.ours.layout.states), first, strict=True))
        fleet, ours = twice(
            lambda: ensemble(
                self.ours, initial, (0.0, self.end), self.parameters, rtol=1e-10, keep=True,
                inputs=self.inputs or None,
            ).columns["y_stop"]
        )  # fmt: skip
        mapped = jax.jit(jax.vmap(self.last(1e-10), (1, None), 1))
        got, theirs = twice(lambda: np.asarray(mapped(first, p)))
        return {"many": worst(got, fleet, axis=1), "fleet": ours, "vmap": theirs}


def worst(got: Array, expected: Array, axis: int, least: float = 0.0) -> float:
    """Return the largest difference over the largest entry along an axis, or over ``least``; NaN counts."""
    scale = np.maximum(np.abs(expected).max(axis=axis, keepdims=True), least)
    return float((np.abs(got - expected) / np.where(scale == 0, 1.0, scale)).max(initial=0.0))


def twice(call: Callable[[], Any]) -> tuple[Any, float]:
    """Return what a call gives, and the seconds of the second one."""
    call()
    began = perf_counter()
    found = call()
    return found, perf_counter() - began


def compared(name: str, many: bool = True) -> dict[str, float]:
    """Return differences and seconds of a scene, those that are there."""
    import jax

    with jax.enable_x64(True):
        scene = Compared(name)
        found = {"values": scene.values(), **scene.gradients()}
        return {**found, **(scene.many() if many else {})}


def rows(name: str, found: dict[str, float]) -> list[Row]:
    """Return what was found of a scene as rows: the difference, both times, whether it is small."""
    made = [_judged(f"{name}, rates", found["values"], VALUES)]
    pairs = (("gradients", GRADIENTS, "ours", "theirs"), ("many", TRAJECTORIES, "fleet", "vmap"))
    for what, most, ours, theirs in pairs:
        if what in found:
            times = found[ours], found[theirs]
            made.append(_judged(f"{name}, {what}", found[what], most, times))
    return made


def _judged(what: str, difference: float, most: float, times: tuple[float, ...] = ()) -> Row:
    shown = map(time_text, times)
    beside = (next(shown), next(shown), f"{times[0] / times[1]:.2g}") if times else ("", "", "")
    return Row(f"{what}: {difference:.1e}", *beside, f"< {most:.0e}", difference < most)


def apart(name: str, *options: str) -> list[Row]:
    """Return the rows of a scene, measured in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.through_jax", "--one", name, *options]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return [Row(name, f"not done in {LIMIT:.0f} s", met=False)]
    except subprocess.CalledProcessError as error:
        return [Row(name, error.stderr.strip().splitlines()[-1][:100], met=False)]
    return rows(name, json.loads(done.stdout.splitlines()[-1]))


def main(arguments: list[str]) -> None:
    """Print a row as soon as it is there, and all of them as a table."""
    options = [a for a in arguments if a.startswith("--")]
    names = [a for a in arguments if not a.startswith("--")] or list(catalogue.names())
    if "--one" in options:
        print(json.dumps(compared(names[0], many="--gradients" not in options)))
        return
    found: list[Row] = []
    for name in names:
        made = apart(name, *options)
        print(*(f"{r.what}  {r.ours} | {r.beside}" for r in made), sep="\n", flush=True)
        found += made
    section = Section("largest difference to JAX; ours | JAX", tuple(found))
    Console(width=160).print(table([section]))
    sys.exit(1 if missed([section]) else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
