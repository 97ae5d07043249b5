"""How `benchmarks.fuzz` gets numbers from each target, and which expressions a target refuses."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import sympy as sp

from benchmarks.expressions import PARAMETERS, STATES
from codegen.compiling.compiled import ROWS, TARGETS, batch_kernel, generate
from codegen.frontend.layout import Layout
from codegen.ir.interpret import Point, constants
from codegen.ir.names import identifier
from codegen.ir.passes import prune
from codegen.ir.program import INVARIANTS, OUTPUTS, RATES, SINGULARITIES, Program
from codegen.native import native
from codegen.targets import lanes
from eom.quantities import Quantity
from tests import node, octave
from tests.codegen.test_c_float import Single
from tests.codegen.test_compiled import DOUBLE, SINGLE

PRECISIONS = {"c_f32": SINGLE}
"""Targets that do not compute in double precision."""


def layout(count: int) -> Layout:
    """Return the layout of ``count`` expressions."""
    x, p = (
        tuple(Quantity(sp.Symbol(f"{letter}{k}", real=True)) for k in range(n))
        for letter, n in (("x", STATES), ("p", PARAMETERS))
    )
    names = tuple(f"f{k}" for k in range(count))
    results = {RATES: names, OUTPUTS: (), INVARIANTS: (), SINGULARITIES: ()}
    return Layout("fuzz", "fuzz", x, p, (), results)


def names() -> list[str]:
    """Return every target: those that run in this process, and those that are only written."""
    return sorted({*TARGETS, *ROWS} - {"auto"})


def refused(target: str, program: Program) -> list[set[str]]:
    """Return for each result the operations in it that the target lists as unsupported.

    What depends on constants alone is a number already, and is in no target refused.
    """
    unsupported = ROWS[target].unsupported if target in ROWS else {}
    known = constants(program) if unsupported else {}
    found: list[set[str]] = []
    for k, (op, args, _) in enumerate(program.instructions):
        own = {op} if op in unsupported else set()
        found.append(set() if k in known else own.union(*(found[a] for a in args)))
    return [found[k] for k in program.results[RATES]]


def subset(program: Program, which: Sequence[int]) -> Program:
    """Return the program of some results."""
    kept = tuple(program.results[RATES][k] for k in which)
    return prune(replace(program, results={RATES: kept}))


def values(target: str, program: Program, at: Sequence[Point]) -> Any:
    """Return the numbers of a target, in shape (expressions, points).

    Raises `InputError`, `ImportError` or `OSError` where the target does not work on this machine.
    """
    return RUNNERS.get(target, _in_this_process(target))(program, at)


def rounded(target: str, at: Sequence[Point]) -> list[Point]:
    """Return the points in the precision of the target, without those that are too large for it."""
    if target not in PRECISIONS:
        return list(at)
    found = []
    for point in at:
        with np.errstate(over="ignore", under="ignore"):
            t, *numbers = (float(v) for v in np.float32([point.t, *point.x, *point.p]))
        if np.all(np.isfinite([t, *numbers])):
            found.append(Point(t, numbers[:STATES], numbers[STATES:]))
    return found


def precision(target: str) -> Any:
    """Return the precision that a target computes in."""
    return PRECISIONS.get(target, DOUBLE)


Runner = Callable[[Program, Sequence[Point]], Any]


def _in_this_process(target: str) -> Runner:
    def run(program: Program, at: Sequence[Point]) -> Any:
        _, functions, _ = TARGETS[target](program, layout(len(program.results[RATES])))
        t = np.array([v.t for v in at])
        x, p = np.array([v.x for v in at]).T, np.array([v.p for v in at]).T
        return functions[RATES](t, x, p)

    return run


def _javascript(program: Program, at: Sequence[Point]) -> Any:
    if not node.NODE:
        raise OSError("no Node.js")
    count = len(program.results[RATES])
    (text,) = generate(program, layout(count), "javascript").values()
    (got,) = node.run([node.Job(text, RATES, [(v.t, v.x, v.p, []) for v in at], count)])
    return got.T


def _matlab(program: Program, at: Sequence[Point]) -> Any:
    if not octave.OCTAVE:
        raise OSError("no GNU Octave")
    count = len(program.results[RATES])
    (text,) = generate(program, layout(count), "matlab").values()
    ((together, _),) = octave.run(
        [octave.Job(text, RATES, [(v.t, v.x, v.p, []) for v in at], count)]
    )
    return together.T


def _single(program: Program, at: Sequence[Point]) -> Any:
    if not native.compiler():
        raise OSError("no C compiler")
    run = Single(program, layout(len(program.results[RATES])))
    return np.array([run(RATES, v.t, v.x, v.p, []) for v in at]).T


def _lanes(program: Program, at: Sequence[Point]) -> Any:
    here = layout(len(program.results[RATES]))
    text = lanes.single_text(program, here)
    library = native.load(native.compile_library(text), text)
    kernel = batch_kernel(library, f"{identifier(here.name)}_{RATES}_lanes")
    x, p = np.array([v.x for v in at]).T, np.array([v.p for v in at]).T
    out = np.empty((len(program.results[RATES]), len(at)))
    kernel(np.array([v.t for v in at]), x, p, np.empty((0, len(at))), out)
    return out


RUNNERS: Mapping[str, Runner] = {
    "javascript": _javascript,
    "matlab": _matlab,
    "c_f32": _single,
    "c_lanes": _lanes,
}
"""Targets that `codegen.compile` does not run."""
