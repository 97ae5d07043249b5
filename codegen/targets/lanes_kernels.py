"""Kernels of lanes for the use inside a file: of programs other than those of a whole system."""

from __future__ import annotations

from collections.abc import Mapping

from codegen.ir.passes import prune
from codegen.ir.program import Program
from codegen.passes.stages import CONSTANT, by_parameters
from codegen.targets.c import assigned
from codegen.targets.lanes import EARLY, LATE, LOCAL, STORED, kernel, preamble, rendered, static
from codegen.targets.render import Body, table_names, with_slots_of


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
