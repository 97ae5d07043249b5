"""Taylor series of many trajectories in vector lanes: compiled for one system and one order.

Each lane has its own time and step; one whose trajectory ends takes the next from the queue. The
rule of the step is that of `codegen.integrate.taylor`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from codegen import native
from codegen.integrate import switches, taylor
from codegen.integrate.runge_kutta import fill
from codegen.layout import Layout
from codegen.lower import RATES, SINGULARITIES
from codegen.names import comment, identifier
from codegen.passes import prune
from codegen.program import Program
from codegen.targets.lanes_kernels import kernels
from codegen.taylor import JET, SWITCHES, Prepared, unrolled

FLAGS = ("-O2", "-ffp-contract=fast", "-fno-tree-vectorize")
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
        "JET": "P * N + P * SWITCHES" if prepared.switches else "P * N",
        **switches.of_lanes(prepared, prefix, order),
    }
    events = fill("lanes_events.c", values)
    return fill("taylor_lanes.c", {"LANES_EVENTS": events, "JOB": fill("job.c", {}), **values})


def _series(prepared: Prepared, order: int) -> Program:
    """Return all coefficients, those of the switching functions last, and their values alone."""
    found = unrolled(prepared, RATES, order)
    if not prepared.switches:
        return found
    both = found.results
    first = both[SWITCHES][: len(prepared.switches)]
    return replace(found, results={JET: (*both[JET], *both[SWITCHES]), "values": first})


def build(text: str, layout: Layout) -> tuple[Any, int]:
    """Compile for this machine; return the C function of a job and the number of lanes.

    Raises `CompilerError` where that fails, as with a compiler without vector extensions.
    """
    library = native.load(native.compile_library(text, FLAGS), text, FLAGS)
    prefix = f"{identifier(layout.name)}_taylor_lanes"
    return getattr(library, f"{prefix}_run"), int(getattr(library, f"{prefix}_lanes")())
