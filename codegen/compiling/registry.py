"""The table of targets: what `generate` and the command line know of languages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from codegen.frontend.layout import Layout
from codegen.ir.program import Program
from codegen.loops import javascript, written
from codegen.targets import c, checks, packaging
from codegen.targets.c_float import C_FLOAT
from codegen.targets.javascript import JAVASCRIPT
from codegen.targets.lanes import LANES
from codegen.targets.numpy_ import NUMPY
from codegen.targets.python_ import PYTHON
from codegen.targets.target import Target
from eom.errors import InputError, unknown_name


def _c_files(integrator: written.Choice, program: Program, layout: Layout) -> Mapping[str, str]:
    files = {
        **c.files(program, layout),
        **written.files(integrator, program, layout),
        **packaging.descriptions(layout),
        **(packaging.sparsity(layout, layout.patterns) if layout.patterns else {}),
        **checks.checks(program, layout),
    }
    return {**files, **packaging.build(layout, files)}


def _javascript_files(
    integrator: written.Choice, program: Program, layout: Layout
) -> Mapping[str, str]:
    return {**JAVASCRIPT.files(program, layout), **javascript.files(integrator.name)}


C = Target("c", "c", c.TEMPLATES, c._SLOTS, c._NUMBERS, partial(_c_files, written.Choice()))

ROWS: dict[str, Target] = {row.name: row for row in (C, C_FLOAT, LANES, JAVASCRIPT, NUMPY, PYTHON)}

_BESIDE = {C.name: _c_files, JAVASCRIPT.name: _javascript_files}
"""What writes functions and integrator, by target."""


def target_of(name: str, integrator: written.Choice | None = None) -> Target:
    """Return a target by name, which writes ``integrator`` beside the functions.

    Raises `InputError` for unknown names, and for an integrator where the target writes none.
    """
    if name not in ROWS:
        raise unknown_name("target", name, ROWS)
    if integrator is None:
        return ROWS[name]
    written.check(integrator)
    if name not in _BESIDE:
        raise InputError(
            f"integrators are written for the targets {' and '.join(_BESIDE)} alone",
            got=f"target {name}, integrator {integrator.name}",
            hint="leave out the integrator, or choose one of these targets",
        )
    return replace(ROWS[name], files=partial(_BESIDE[name], integrator))
