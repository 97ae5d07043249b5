"""Forward dynamics of chains: one recursion, fed with CasADi's scalars and with ours.

`eom.multibody` runs on both, for ours also by way of a `System` with named intermediates: from the
description to a program, which has to take time in proportion to the bodies. Operations are counted
alike: instructions that are no inputs, outputs or constants. Both C texts are compiled by the same
compiler with the same flags, those of `codegen.compile`, and timed in the same loop; values are
compared, and with Pinocchio's where it is installed.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from time import process_time
from timeit import timeit
from typing import Any

import numpy as np
import sympy as sp

from benchmarks.articulated import accelerations, chain
from benchmarks.native_rates import ALIGNED, Points, Rates, empty_cache, sampler
from benchmarks.pairs import paired, settled
from benchmarks.peers import absent, missing
from benchmarks.rates import largest_difference
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, alone, time_text
from codegen.frontend.layout import Layout
from codegen.frontend.lower import lower_system
from codegen.ir.passes import prune
from codegen.ir.program import INVARIANTS, OUTPUTS, RATES, SINGULARITIES, Program
from codegen.native import native
from codegen.targets import c
from eom.multibody import derive
from eom.quantities import Quantity

BODIES = (7, 20, 50, 100)
LARGEST_RATIO = 0.9
LARGEST_GENERATION = 0.2
LARGEST_DIFFERENCE = 1e-10
"""Relative; the last of 50 bodies accelerates by the differences of large numbers."""
KNOWN = {7: 2015, 20: 6855, 50: 18028, 100: 36647}
"""Operations that CasADi 3.8.2 left of the recursion: the short form needs no peer."""
LONGEST_COMPILATION = {100: 10.0}
"""Seconds of the C compiler's processor time, with the flags of `codegen.compile`."""
REPEATS = 5
CALLS = 200
LARGEST_OF_PINOCCHIO = 1 / 3
DERIVED = (50, 100)
LONGEST_DERIVATION = 3.0
"""Seconds of processor time from a description of 100 bodies to a program."""
LARGEST_GROWTH = 2.3
"""From 50 to 100 bodies."""

Text = tuple[str, str]
"""C source, and the name of its function."""


@dataclass(frozen=True)
class Made:
    """Operations of the right-hand side, its C text, and the seconds that it took to make it."""

    operations: int
    text: Text
    seconds: float


def measure(settings: Settings) -> Section:
    """Return three rows a size: operations, generation, time in C."""
    title = "chains of bodies, articulated-body algorithm: ours | CasADi SX"
    if settings.quick:
        return Section(title, tuple(_known(count) for count in KNOWN))
    rows = [*_derivations(), *(row for count in BODIES for row in _rows(count))]
    lacking = [n for n in ("casadi", "pin") if missing(n)]
    return Section(title, (*rows, *(absent(name, [name]) for name in lacking)))


def _derivations() -> list[Row]:
    """Return rows of the time from a description to a program, by a `System`."""
    seconds = [min(_derivation(count) for _ in range(REPEATS)) for count in DERIVED]
    rows = [
        Row(f"{count} bodies: description to program", time_text(s))
        for count, s in zip(DERIVED, seconds, strict=True)
    ]
    growth = seconds[1] / seconds[0]
    limit = f"<= {time_text(LONGEST_DERIVATION)}"
    rows[1] = replace(rows[1], target=limit, met=seconds[1] <= LONGEST_DERIVATION)
    return [*rows, _judged(f"{DERIVED[1]} bodies | {DERIVED[0]}: the same", tuple(
        time_text(s) for s in seconds[::-1]), growth, LARGEST_GROWTH)]  # fmt: skip


def _derivation(count: int) -> float:
    chain.cache_clear()
    start = process_time()
    program(count)
    return process_time() - start


def _known(count: int) -> Row:
    operations = sum(program(count).counts().values())
    known = KNOWN[count]
    ratio = f"{operations / known:.3f}"
    what = f"{count} bodies: operations, CasADi's as recorded"
    return Row(what, str(operations), str(known), ratio, "<= 1", operations <= known)


def _rows(count: int) -> list[Row]:
    mine = fastest(lambda: ours(count))
    flags = flags_of(count)
    rates, seconds = _compiled(mine.text, flags)
    points = Points.for_layout(layout(count))
    if missing("casadi"):
        time = time_text(min(sampler(rates, points)() for _ in range(REPEATS)))
        return [Row(f"{count} bodies", f"{mine.operations} operations, {time}")]
    other = fastest(lambda: casadi(count))
    beside, their_seconds = _compiled(other.text, flags)
    difference = largest_difference(rates, beside, points)
    if not difference <= LARGEST_DIFFERENCE:
        return [Row(f"{count} bodies", f"differs by {difference:.1e}", target="same", met=False)]
    pairs = settled(
        lambda: paired(sampler(rates, points), sampler(beside, points), 5),
        lambda p: p.ratio,
        LARGEST_RATIO,
    )
    shared = f"{other.operations} ({casadi_shared(count)} by its cse)"
    generated = (time_text(mine.seconds), time_text(other.seconds))
    timed = tuple(time_text(s) for s in pairs.typical)
    rows = [
        _judged(f"{count} bodies: operations", (str(mine.operations), shared),
                mine.operations / other.operations, LARGEST_RATIO),
        _judged(f"{count} bodies: to C text", generated,
                mine.seconds / other.seconds, LARGEST_GENERATION),
        _compilation(count, seconds, their_seconds),
        _judged(f"{count} bodies: in C", timed, pairs.ratio, LARGEST_RATIO),
    ]  # fmt: skip
    return rows if missing("pin") else [*rows, *_pinocchio(count, rates, points)]


def _judged(what: str, cells: tuple[str, ...], ratio: float, limit: float) -> Row:
    return Row(what, *cells, f"{ratio:.3f}", f"<= {limit}", ratio <= limit)


def fastest(make: Callable[[], tuple[int, Text]]) -> Made:
    """Make a text several times; return it with the least processor time."""
    times = []
    for _ in range(REPEATS):
        start = process_time()
        operations, text = make()
        times.append(process_time() - start)
    return Made(operations, text, min(times))


def program(count: int) -> Program:
    """Return our program: states are angles and rates, inputs the torques."""
    return prune(lower_system(derive(chain(count), invariants=False)), [RATES])


def layout(count: int) -> Layout:
    """Return names of states and torques."""
    x, u = (
        tuple(Quantity(sp.Symbol(f"{letter}{k}", real=True)) for k in range(n))
        for letter, n in (("x", 2 * count), ("u", count))
    )
    names = tuple(q.name for q in x)
    return Layout(
        "chain", "chain", x, (), u, {RATES: names, OUTPUTS: (), INVARIANTS: (), SINGULARITIES: ()}
    )


def ours(count: int) -> tuple[int, Text]:
    """Return operations and C text, by our scalars."""
    made = program(count)
    return sum(made.counts().values()), (c.single_text(made, layout(count)), f"chain_{RATES}")


def casadi(count: int) -> tuple[int, Text]:
    """Return operations and C text, by CasADi's scalars; a wrapper gives it our signature."""
    function = _casadi(count)
    with tempfile.TemporaryDirectory() as folder:
        generator = _generator(function)
        generator.generate(f"{folder}/")
        text = (Path(folder) / "chain.c").read_text("utf-8")
    wrapper = (
        "\nvoid chain_wrapped(double t, const double *x, const double *p, const double *u, double *dx) {\n"
        "    const double *arg[2] = {x, u};\n    double *res[1] = {dx};\n"
        f"    double w[{function.sz_w()} + 1];\n"
        "    (void)t, (void)p;\n    chain(arg, res, 0, w, 0);\n}\n"
    )
    return _casadi_operations(function), (text + wrapper, "chain_wrapped")


def _casadi(count: int, share: bool = False) -> Any:
    import casadi as ca

    x, u = ca.SX.sym("x", 2 * count), ca.SX.sym("u", count)
    listed = [x[k] for k in range(2 * count)]
    q, rates = listed[:count], listed[count:]
    torques = [u[k] for k in range(count)]
    found = ca.vertcat(*rates, *accelerations(chain(count), q, rates, torques, ca.sin, ca.cos))
    return ca.Function("chain", [x, u], ca.cse([found]) if share else [found])


def _casadi_operations(function: Any) -> int:
    import casadi as ca

    leaves = {ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST}
    return sum(function.instruction_id(k) not in leaves for k in range(function.n_instructions()))


def casadi_shared(count: int) -> int:
    """Return the operations that CasADi leaves when it is asked to share equal subexpressions."""
    return _casadi_operations(_casadi(count, share=True))


def _generator(function: Any) -> Any:
    import casadi as ca

    generator = ca.CodeGenerator("chain.c")
    generator.add(function)
    return generator


def flags_of(count: int) -> tuple[str, ...]:
    """Return what `codegen.compile` adds to the flags of all generated code, for both sides alike."""
    chosen = native.flags_for(2 * count, len(program(count).instructions))
    return (*chosen, *ALIGNED)


def _compiled(text: Text, flags: tuple[str, ...]) -> tuple[Rates, float]:
    """Compile a text; return its function, and the processor time of the compiler."""
    source, symbol = text
    with empty_cache():
        before = getrusage(RUSAGE_CHILDREN)
        library = native.load(native.compile_library(source, flags), source, flags)
        after = getrusage(RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Rates(source, symbol, library, flags=flags), seconds


def _compilation(count: int, ours: float, theirs: float) -> Row:
    cells = (time_text(ours), time_text(theirs), f"{ours / theirs:.3f}")
    limit = LONGEST_COMPILATION.get(count)
    if limit is None:
        return Row(f"{count} bodies: C compiler", *cells)
    return Row(f"{count} bodies: C compiler", *cells, f"<= {time_text(limit)}", ours <= limit)


def _pinocchio(count: int, rates: Rates, points: Points) -> list[Row]:
    """Compare values and times with Pinocchio's; the time of a call is taken out of its own."""
    model, data, aba = pinocchio(count)
    worst = 0.0
    for x in points.x[:8]:
        found = rates(x, points.p, points.u)[count:]
        expected = aba(model, data, x[:count], x[count:], points.u)
        worst = max(worst, float(np.abs(found - expected).max() / np.abs(expected).max()))
    x = points.x[0].copy()
    q, v, tau = x[:count], x[count:], np.array(points.u)
    empty, nothing = pinocchio(0), np.zeros(0)

    def theirs() -> float:
        whole = timeit(lambda: aba(model, data, q, v, tau), number=CALLS) / CALLS
        call = timeit(lambda: aba(*empty[:2], nothing, nothing, nothing), number=CALLS) / CALLS
        return whole - call

    pairs = settled(
        lambda: paired(sampler(rates, points), theirs, 5), lambda p: p.ratio, LARGEST_OF_PINOCCHIO
    )
    timed = tuple(time_text(s) for s in pairs.typical)
    what = f"{count} bodies: values against Pinocchio"
    met = worst <= LARGEST_DIFFERENCE
    return [
        Row(what, f"{worst:.1e}", "", "", f"<= {LARGEST_DIFFERENCE:g}", met),
        _judged(
            f"{count} bodies: in C | Pinocchio's aba", timed, pairs.ratio, LARGEST_OF_PINOCCHIO
        ),
    ]


def pinocchio(count: int) -> tuple[Any, Any, Any]:
    """Return Pinocchio's model of the chain, its data, and its articulated-body algorithm."""
    import pinocchio as pin

    model = pin.Model()
    tree = chain(count)
    model.gravity.linear = np.array(tree.gravity, dtype=float)
    joint = 0
    for body, hinge in zip(tree.bodies, tree.ordered, strict=True):
        seat = hinge.on_parent
        place = pin.SE3(
            np.array(seat.rotation, dtype=float).T, np.array(seat.position, dtype=float)
        )
        joint = model.addJoint(joint, pin.JointModelRZ(), place, hinge.name)
        rigid = np.array(body.centre, dtype=float), np.array(body.central_inertia, dtype=float)
        model.appendBodyToJoint(joint, pin.Inertia(float(body.mass), *rigid), pin.SE3.Identity())
    return model, model.createData(), pin.aba


if __name__ == "__main__":
    alone(measure)
