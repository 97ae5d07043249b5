"""Time to the first result in a process of its own: ``python -m eom.commands.first NAME OTHERS [CHANGES]``.

It prints one line of JSON: seconds to import, to derive, to generate and compile the functions, to do
so for the method (taylor; Radau for stiff problems), and to integrate at 1e-9; with OTHERS = heyoka
and a problem that is not stiff, also heyoka's compilation and run from the same derived rates. CHANGES:
values by name and an end time, as JSON.
"""

from __future__ import annotations

import importlib
import importlib.util
import json
import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from codegen.measure.workprecision.case import Case

RTOL = 1e-9


def stages(name: str, others: str, changes: str = "[{}, null]") -> dict[str, float]:
    """Return seconds by stage."""
    clock = _Clock()
    from codegen import simulate
    from codegen.measure.workprecision.case import Case
    from eom import problems

    clock.lap("import")
    problem = problems.ready(name, *json.loads(changes))
    system = problem.system
    clock.lap("derive")
    numbers = (problem.start, problem.parameters, problem.inputs)
    case = Case(name, "", system, *numbers, problem.end)
    compiled = case.compiled()
    clock.lap("generate and compile")
    method = "scipy:Radau" if problem.stiff else "taylor" if compiled.target == "c" else "DOP853"
    span = (0.0, problem.end)
    run = simulate(compiled, case.start, span, None, method, RTOL, inputs=case.inputs)
    clock.lap("the method's code")
    clock.laps["the method's code"] -= run.seconds
    clock.laps["integrate"] = run.seconds
    wanted = others == "heyoka" and not problem.stiff
    if wanted and importlib.util.find_spec("heyoka") is not None:
        _heyoka(clock, case)
    return clock.laps


def _heyoka(clock: _Clock, case: Case) -> None:
    from codegen.measure.workprecision import programs

    importlib.import_module("heyoka")
    clock.lap("heyoka: import")
    integrator = programs.heyoka_builder(case)(RTOL)
    clock.lap("heyoka: compile")
    integrator.propagate_until(case.end, max_steps=programs.MAX_STEPS)
    clock.lap("heyoka: integrate")


class _Clock:
    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self.last = time.perf_counter()

    def lap(self, name: str) -> None:
        now = time.perf_counter()
        self.laps[name], self.last = now - self.last, now


if __name__ == "__main__":
    print(json.dumps(stages(*sys.argv[1:4])))
