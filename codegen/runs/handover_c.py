"""Hand-over of angles as generated C: two integrators, the transfers, and one function that runs them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from codegen.compiling.compiled import Compiled, generate
from codegen.frontend.layout import names_of
from codegen.ir.names import comment, identifier
from codegen.loops import runge_kutta, written
from codegen.loops.written import Choice
from codegen.runs.charts import TURN, CompiledCharts
from eom.errors import InputError

PLACES = {"branch": -1, "first_angle": -2}
"""Parameters that are no parameters of the first system."""


def files(made: CompiledCharts, integrator: Choice | None = None) -> Mapping[str, str]:
    """Return all C files of a pair of charts by name: ``NAME_handover.h`` is the one to include.

    ``integrator``: of both charts, by default DOP853; of Taylor series each has its own. The same
    charts give the same bytes. Raises `InputError` for an unknown integrator, for none, and where a
    value has no Taylor series.
    """
    choice = integrator or Choice()
    if written.check(choice).name == written.NONE:
        raise InputError("hand-over needs an integrator", got=choice.name, hint="taylor or dop853")
    found: dict[str, str] = {}
    for compiled in (made.first, made.second, made.forth, made.back):
        texts = generate(compiled.program, compiled.layout, "c")
        name = identifier(compiled.layout.name)
        found |= {n: texts[n] for n in (f"{name}.h", f"{name}.c")}
    for compiled in (made.first, made.second):
        found |= written.files(choice, compiled.program, compiled.layout)
    values = _values(made, choice.name)
    prefix = values["PREFIX"]
    return found | {f"{prefix}.{k}": runge_kutta.fill(f"handover.{k}", values) for k in ("h", "c")}


def _values(made: CompiledCharts, integrator: str) -> dict[str, str]:
    first, second = made.first.layout, made.second.layout
    name, other = (f"{identifier(layout.name)}_{integrator}" for layout in (first, second))
    prefix = f"{identifier(first.name)}_handover"
    parameters, inputs = names_of(first.parameters), names_of(first.inputs)
    return {
        "TITLE": comment(first.title),
        "PREFIX": prefix,
        "UPPER": prefix.upper(),
        "HEADER": f"{prefix}.h",
        "FIRST": name,
        "SECOND": other,
        "FIRST_UPPER": name.upper(),
        "SECOND_UPPER": other.upper(),
        "FORTH": identifier(made.forth.layout.name),
        "BACK": identifier(made.back.layout.name),
        "STATES": str(len(first.states)),
        "SECOND_STATES": str(len(second.states)),
        "PARAMETER_COUNT": str(len(parameters)),
        "PARAMETER_ROOM": str(max(1, len(parameters))),
        "INPUT_ROOM": str(max(1, len(inputs))),
        "SECOND_INPUT_COUNT": str(len(second.inputs)),
        "SECOND_INPUTS": _listed([inputs.index(n) for n in names_of(second.inputs)]),
        "SECOND_COUNT": str(len(second.parameters)),
        "FORTH_COUNT": str(len(made.forth.layout.parameters)),
        "SECOND_PARAMETERS": _from(made.second, parameters),
        "FORTH_PARAMETERS": _from(made.forth, parameters),
        "BACK_PARAMETERS": _from(made.back, parameters),
        "ANGLES": _listed(made.charts.angles),
        "SINE": "sin" if made.charts.symmetric else "cos",
        "ENTER": repr(made.charts.enter),
        "TURN": repr(TURN),
        "LOST": str(int(len(made.charts.second.singularities) > 1)),
    }


def _from(compiled: Compiled, names: Sequence[str]) -> str:
    own = names_of(compiled.layout.parameters)
    return _listed([PLACES[n] if n in PLACES else names.index(n) for n in own])


def _listed(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers)) or "0"
