"""Taylor series of many trajectories in vector lanes: compiled for one system and one order.

Each lane has its own time and step; one whose trajectory ends takes the next from the queue. The
rule of the step is that of `codegen.loops.taylor`.

Kernels of lanes for the use inside a file: of programs other than those of a whole system.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from codegen.derivatives.taylor import JET, SWITCHES, Prepared, unrolled
from codegen.frontend.layout import Layout
from codegen.ir.names import comment, identifier
from codegen.ir.passes import prune
from codegen.ir.program import RATES, SINGULARITIES, Builder, Program
from codegen.ir.scalars import Scalar
from codegen.loops import switches, taylor
from codegen.loops.jets import limited
from codegen.loops.runge_kutta import fill
from codegen.loops.taylor import of_lanes
from codegen.native import native
from codegen.passes.pipeline import CONSTANT, by_parameters
from codegen.targets.c import assigned
from codegen.targets.lanes import EARLY, LATE, LOCAL, STORED, kernel, preamble, rendered, static
from codegen.targets.render import Body, table_names, with_slots_of
from codegen.watch.trust import built, longest


def kernels(programs: Mapping[str, Program]) -> tuple[str, dict[str, int]]:
    """Return static functions of programs by head, with types and helpers, for the use inside a file.

    ``head``_constants(p, c) fills lanes from the parameters; ``head``_``group``(t, x, xs, c, w, u, us,
    y, ys) computes the results of a group, w is not read. Also returned: the number of constants of
    each program. Programs with tables are refused by an assertion.
    """
    lines: list[str] = []
    bodies: list[Body] = []
    counts = {}
    for head, program in programs.items():
        assert not table_names(program)
        cut = by_parameters(program, list(program.results))
        counts[head] = len(cut.values)
        slots = with_slots_of(cut, program, {})
        early = rendered(cut.early, CONSTANT, {}, {})
        bodies.append(early)
        lines += [*kernel("APART_", f"{head}_constants", EARLY, early, *LOCAL[0]), ""]
        for group in program.results:
            bodies.append(rendered(prune(cut.late, [group]), group, slots, {}))
            lines += [
                *static(f"{head}_{group}", "INLINE_", (*LATE, STORED[1]), _at_once(bodies[-1])),
                "",
            ]
    return "\n".join([*preamble(bodies), *lines]), counts


def _at_once(body: Body) -> list[str]:
    """Return lines that store each result where it is computed, so that it need not be kept for that.

    The array of results must overlap no argument.
    """
    stores: dict[str, list[str]] = {}
    for k, result in enumerate(body.results):
        stores.setdefault(result, []).append(f"    {STORED[0].format(k, result)}")
    found = []
    for line, text in zip(body.lines, assigned(body.lines, "lane_"), strict=True):
        found += [text, *stores.pop(line.variable, [])]
    return [*found, *(text for rest in stores.values() for text in rest)]


FLAGS = ("-O2", "-ffp-contract=fast", "-fno-tree-vectorize")
MOVES = "moves"
"""Group of results: limits of arguments and their coefficients."""
CAUTION = taylor.CAUTION / 2
"""The largest of many errors is what counts: half of what one trajectory is allowed."""


def order_of(rtol: float) -> int:
    """Return the order that suits a tolerance where work grows with its square: lanes share the rest."""
    return taylor.order_of(max(rtol, taylor.FULL)) - taylor.FURTHER_ORDERS


def single_text(prepared: Prepared, program: Program, layout: Layout, order: int) -> str:
    """Return the integrator as one text that compiles by itself."""
    prefix = f"{identifier(layout.name)}_taylor_lanes"
    functions = prune(program, [g for g in (RATES, SINGULARITIES) if g in layout.sizes])
    series = _series(prepared, order)
    texts, counts = kernels({f"{prefix}_f": functions, f"{prefix}_s": series})
    values = {
        "TITLE": comment(layout.title),
        "KERNELS": texts,
        "PREFIX": prefix,
        "STATES": str(len(layout.states)),
        "SINGULARITIES": str(len(layout.results[SINGULARITIES])),
        "COORDINATES": ", ".join(map(str, layout.coordinates)),
        "PARAMETERS": str(len(layout.parameters)),
        "INPUTS": str(len(layout.inputs)),
        "ORDER": str(order),
        "BRANCHES": str(int(prepared.has_branches)),
        "CAUTION": repr(CAUTION),
        "CONSTANTS": str(max(1, counts[f"{prefix}_f"])),
        "SERIES_CONSTANTS": str(max(1, counts[f"{prefix}_s"])),
        "JET": _room(prepared, order),
        **switches.of_lanes(prepared, prefix, order),
        **of_lanes(prepared, order),
    }
    events = fill("lanes_events.c", values)
    return fill("taylor_lanes.c", {"LANES_EVENTS": events, "JOB": fill("job.c", {}), **values})


def _room(prepared: Prepared, order: int) -> str:
    """Return how many coefficients there are, as C."""
    straight, curved = limited(prepared, order)
    counts = ["N", *["SWITCHES"] * bool(prepared.switches), *[str(len(curved))] * bool(curved)]
    return " + ".join([*(f"P * {count}" for count in counts), *["1"] * bool(straight)])


def _series(prepared: Prepared, order: int) -> Program:
    """Return all coefficients, of switching functions and of arguments with limits behind the states'.

    The latter stand as `codegen.loops.jets.limited` says. Values of switching functions alone follow.
    """
    straight, curved = limited(prepared, order)

    def moves(b: Builder, series: Sequence[Sequence[Scalar]]) -> Mapping[str, Sequence[int]]:
        new = [row[0].number for row in series]
        found = [longest(b, new, prepared, straight, order)] if straight else []
        for bound, x in zip(built(b, new, prepared, curved, order), curved, strict=True):
            found += [bound, *(term.number for term in series[x.series][1:order])]
        return {MOVES: found}

    program = unrolled(prepared, RATES, order, moves if straight or curved else None)
    groups = program.results
    both = [n for group in (JET, SWITCHES, MOVES) for n in groups.get(group, ())]
    first = groups.get(SWITCHES, ())[: len(prepared.switches)]
    return replace(program, results={JET: tuple(both), **({"values": first} if first else {})})


def build(text: str, layout: Layout) -> tuple[Any, int]:
    """Compile for this machine; return the C function of a job and the number of lanes.

    Raises `CompilerError` where that fails, as with a compiler without vector extensions.
    """
    library = native.load(native.compile_library(text, FLAGS), text, FLAGS)
    prefix = f"{identifier(layout.name)}_taylor_lanes"
    return getattr(library, f"{prefix}_run"), int(getattr(library, f"{prefix}_lanes")())
