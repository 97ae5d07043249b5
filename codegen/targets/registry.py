"""The table of targets: what `generate` and the command line know of languages."""

from __future__ import annotations

from collections.abc import Mapping

from codegen.integrate import runge_kutta
from codegen.integrate.dop853 import DOP853
from codegen.layout import Layout
from codegen.program import Program
from codegen.targets import c, checks, packaging
from codegen.targets.c_float import C_FLOAT
from codegen.targets.javascript import JAVASCRIPT
from codegen.targets.lanes import LANES
from codegen.targets.numpy_ import NUMPY
from codegen.targets.python_ import PYTHON
from codegen.targets.target import Target


def _c_files(program: Program, layout: Layout) -> Mapping[str, str]:
    return c_files(program, layout, runge_kutta.files(DOP853, layout))


def c_files(program: Program, layout: Layout, integrator: Mapping[str, str]) -> Mapping[str, str]:
    """Return the files of the target c with those of an integrator among them, built and packaged."""
    written = {
        **c.files(program, layout),
        **integrator,
        **packaging.descriptions(layout),
        **(packaging.sparsity(layout, layout.patterns) if layout.patterns else {}),
        **checks.checks(program, layout),
    }
    return {**written, **packaging.build(layout, written)}


C = Target("c", "c", c.TEMPLATES, c._SLOTS, c._NUMBERS, _c_files)

ROWS: dict[str, Target] = {row.name: row for row in (C, C_FLOAT, LANES, JAVASCRIPT, NUMPY, PYTHON)}
