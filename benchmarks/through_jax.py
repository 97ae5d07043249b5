"""``python -m benchmarks.through_jax [SCENE ...]``: the target jax beside ours, for every ready scene.

Values of the rates, each operation on its own as the module has them, and compiled; gradients of
trajectories, by `jax.jacrev` back through diffrax and by our sensitivities forwards; 10,000 trajectories
by `jax.vmap` and by `codegen.ensemble`. Runs go to a twentieth of the scene's own time. Differences are
printed as they fall, with the seconds of both sides (the second call, compiled), and judged. Rates that
XLA compiled contract products and sums to one operation (fused multiply-add): where they differ by more
than asked, the errors of both to 50 digits are printed, and judged by the bound of the interpreter.

Each scene is a process of its own with a time limit, ``--limit=SECONDS``; what was not reached is said.
Programs of more than `LONG` operations are compiled without XLA's fusion, which takes minutes there, and
run `WIDTH` trajectories a call, as many as fit into `BUDGET`. ``--gradients`` leaves them out.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from time import perf_counter
from typing import Any

import numpy as np
from rich.console import Console

from benchmarks.table import Row, Section, missed, table, time_text
from codegen import compile as compile_system
from codegen import ensemble, integrator, sensitivities
from codegen.frontend.layout import names_of
from codegen.ir.interpret import Point, interpret_with_bound
from codegen.ir.program import RATES
from eom import load_scene
from eom.scenes import catalogue
from eom.system import System

Array = Any
Found = dict[str, Any]
SHARE = 20
MANY = 10_000
VALUES, GRADIENTS, TRAJECTORIES = 1e-14, 1e-9, 1e-7
"""Largest differences: of rates, of gradients, of many trajectories (both at a tolerance of 1e-10)."""
LEAST = 1e-6
LIMIT = 1500.0
"""Seconds for a scene, in which XLA compiles its programs."""
LONG = 500
"""Operations of a program from which on it is compiled without fusion: backwards that takes minutes."""
UNFUSED = {"xla_disable_hlo_passes": "fusion"}
WIDTH, BUDGET = 1000, 240.0
"""Trajectories a call of a long program, and the seconds after which no other call begins."""
STAGES = ("values", "gradients", "many")
RATES_OF_CHANGE = {"rad/s", "m/s"}


class Compared:
    """A scene with its numbers, compiled for jax and for C."""

    def __init__(self, name: str) -> None:
        scene = load_scene(name)
        self.system: System = scene.derive()
        self.end = scene.integration.t_end / SHARE
        self.start, self.parameters = scene.initial_values(), scene.parameter_values()
        self.inputs = scene.input_values()
        self.theirs = compile_system(self.system, "jax")
        self.module = self.theirs.module
        self.ours = compile_system(self.system, "c")
        self.long = len(self.theirs.program.instructions) > LONG

    def jit(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return a function compiled by XLA."""
        import jax

        return jax.jit(function, compiler_options=UNFUSED if self.long else None)

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

    def values(self) -> Found:
        """Return the largest differences of a rate, over the largest rate, at 1000 points near the start.

        ``written``: operation by operation. Where the compiled rates differ by more than asked, errors to
        50 digits at the worst point besides, and whether all are within their bounds.
        """
        import jax

        x, p, u = self.vectors()
        points = x[:, None] + np.random.default_rng(1).uniform(-0.01, 0.01, (len(x), 1000))
        expected = self.ours.rhs(0.3, points, p, u)
        written = np.asarray(self.module.rhs(0.3, points, p, u))
        got = np.asarray(
            self.jit(jax.vmap(self.module.rhs, (None, 1, None, None), 1))(0.3, points, p, u)
        )
        found = {"written": worst(written, expected, 0), "values": worst(got, expected, 0)}
        if max(found.values()) < VALUES:
            return found
        apart = np.abs([got - expected, written - expected]).max(axis=(0, 1))
        k = int(np.argmax(apart / np.abs(expected).max(axis=0)))
        point = Point(0.3, points[:, k], p, u)
        return found | self.exactly(point, expected[:, k], got[:, k], written[:, k])

    def exactly(self, point: Point, ours: Array, *theirs: Array) -> Found:
        """Return the largest errors at a point over the largest rate, to 50 digits, and their bound."""
        exact = interpret_with_bound(self.theirs.program, point)[RATES]
        scale = np.abs(ours).max()

        def errors(rates: Array) -> Array:
            return np.array(
                [float(abs(float(v) - e.value)) for v, e in zip(rates, exact, strict=True)]
            )

        bound = np.array([float(e.error) for e in exact])
        of_both = [errors(ours), np.max([errors(r) for r in theirs], axis=0)]
        sizes = [float(e.max() / scale) for e in (*of_both, bound)]
        within = bool(all((e <= bound).all() for e in of_both))
        return {
            **dict(zip(("our error", "their error", "bound"), sizes, strict=True)),
            "within": within,
        }

    def gradients(self) -> Found:
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
        back = self.jit(jax.jacrev(self.last(1e-11), argnums=(1, 0)))
        got, theirs = twice(lambda: [np.asarray(m) for m in back(x, p)])
        sizes = np.abs([*p, *x])
        sizes[sizes == 0] = 1.0
        least = LEAST * np.abs(expected * sizes).max()
        difference = worst(np.hstack(got) * sizes, expected * sizes, axis=0, least=least)
        return {"gradients": difference, "ours": ours, "theirs": theirs}

    def many(self) -> Found:
        """Return the largest difference of a state at the end, over its largest size, and of how many."""
        import jax

        x, p, _ = self.vectors()
        moving = [k for k, q in enumerate(self.system.states) if q.unit in RATES_OF_CHANGE]
        first = np.repeat(x[:, None], MANY, axis=1)
        first[moving] += np.random.default_rng(3).uniform(-0.01, 0.01, (len(moving), MANY))
        mapped = self.jit(jax.vmap(self.last(1e-10), (1, None), 1))
        got, theirs = in_calls(
            lambda x0: np.asarray(mapped(x0, p)), first, WIDTH if self.long else MANY
        )
        count = got.shape[1]
        initial = dict(zip(names_of(self.ours.layout.states), first[:, :count], strict=True))
        fleet, ours = twice(
            lambda: ensemble(
                self.ours, initial, (0.0, self.end), self.parameters, rtol=1e-10, keep=True,
                inputs=self.inputs or None,
            ).columns["y_stop"]
        )  # fmt: skip
        return {"many": worst(got, fleet, axis=1), "fleet": ours, "vmap": theirs, "count": count}


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


def in_calls(call: Callable[[Array], Array], columns: Array, width: int) -> tuple[Array, float]:
    """Return what a call gives for columns, ``width`` at once, and the seconds, once it is compiled.

    No other call begins after `BUDGET` seconds: then the first columns are there alone.
    """
    call(columns[:, :width])
    found, began = list[Array](), perf_counter()
    for start in range(0, columns.shape[1], width):
        if perf_counter() - began < BUDGET:
            found.append(call(columns[:, start : start + width]))
    return np.hstack(found), perf_counter() - began


def compared(name: str, stages: Sequence[str] = STAGES) -> Iterator[Found]:
    """Yield differences and seconds of a scene, stage by stage."""
    import jax

    with jax.enable_x64(True):
        scene = Compared(name)
        for stage in stages:
            yield getattr(scene, stage)()


def rows(name: str, found: Found) -> list[Row]:
    """Return what was found of a scene as rows: the difference, both times, whether it is small."""
    made = _values(name, found) if "values" in found else []
    count = f", {found['count']:,.0f} of {MANY:,}" if "count" in found else ""
    stages = (
        ("gradients", "", GRADIENTS, "ours", "theirs"),
        ("many", count, TRAJECTORIES, "fleet", "vmap"),
    )
    for what, how_many, most, ours, theirs in stages:
        if what in found:
            times = found[ours], found[theirs]
            made.append(_judged(f"{name}, {what}{how_many}", found[what], most, times))
    return made


def _values(name: str, found: Found) -> list[Row]:
    """Return the rows of the rates; errors to 50 digits and their bound where they differ by more."""
    made = []
    for kind, what in (("written", "rates as written"), ("values", "rates compiled")):
        row = _judged(f"{name}, {what}", found[kind], VALUES)
        if not row.met and "bound" in found:
            ours, theirs = (f"error {found[k]:.1e}" for k in ("our error", "their error"))
            target = f"< {VALUES:.0e} or {found['bound']:.1e}"
            row = Row(row.what, ours, theirs, "", target, found["within"])
        made.append(row)
    return made


def _judged(what: str, difference: float, most: float, times: tuple[float, ...] = ()) -> Row:
    shown = map(time_text, times)
    beside = (next(shown), next(shown), f"{times[0] / times[1]:.2g}") if times else ("", "", "")
    return Row(f"{what}: {difference:.1e}", *beside, f"< {most:.0e}", difference < most)


def apart(name: str, limit: float, stages: Sequence[str]) -> list[Row]:
    """Return the rows of a scene, measured in a process of its own, and what was not reached."""
    command = [sys.executable, "-m", "benchmarks.through_jax", f"--one={','.join(stages)}", name]
    try:
        done = subprocess.run(command, capture_output=True, check=False, timeout=limit)
        told, error = (
            done.stdout,
            done.stderr.decode().strip().splitlines() if done.returncode else [],
        )
    except subprocess.TimeoutExpired as stopped:
        told, error = stopped.stdout or b"", [f"not reached in {limit:.0f} s"]
    found = [json.loads(line) for line in told.decode().splitlines() if line.endswith("}")]
    made = [row for one in found for row in rows(name, one)]
    left = ", ".join(stages[len(found) :])
    return made + ([Row(f"{name}, {left}: {error[-1][:100]}", "", met=False)] if error else [])


def main(arguments: list[str]) -> None:
    """Print a row as soon as it is there, and all of them as a table."""
    options = dict(a.partition("=")[::2] for a in arguments if a.startswith("--"))
    names = [a for a in arguments if not a.startswith("--")] or list(catalogue.names())
    if "--one" in options:
        for found in compared(names[0], options["--one"].split(",")):
            print(json.dumps(found), flush=True)
        return
    stages = STAGES[:2] if "--gradients" in options else STAGES
    found_rows: list[Row] = []
    for name in names:
        made = apart(name, float(options.get("--limit", LIMIT)), stages)
        print(*(f"{r.what}  {r.ours} | {r.beside}  {r.target}" for r in made), sep="\n", flush=True)
        found_rows += made
    section = Section("largest difference to JAX; ours | JAX", tuple(found_rows))
    Console(width=160).print(table([section]))
    sys.exit(1 if missed([section]) else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
