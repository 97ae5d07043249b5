"""Time to make and verify each derivation, what they assert, lengths of their pages; inertia of solids."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys

from benchmarks.pages import longest_formula, pdf_pages
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from eom.commands.paging import COMPILER
from eom.derivations import derive, names
from eom.derivations.deciding import surplus
from eom.derivations.reached import RESULT, asserted, is_tautology
from eom.mass.meshes import mesh_properties
from eom.mass.solids import SOLIDS
from tests.eom.test_meshes import icosphere
from tests.eom.test_solids import cubature_error

EACH_DERIVATION, ALL_DERIVATIONS, EACH_SOLID = 2.0, 15.0, 0.2
CUBATURE_ERROR, MESH_ORDER = 1e-10, 2.0
LONGEST_FORMULA = 200
"""Letters of LaTeX on a line."""

_DERIVATIONS = """
import time
from eom.commands.paging import COMPILER
from eom.derivations import derive, names
for name in names():
    start = time.process_time()
    derive(name)
    print(name, time.process_time() - start)
"""

_SOLIDS = """
import time
from sympy.core.cache import clear_cache
from eom.mass import solids
for name in solids.SOLIDS:
    clear_cache()
    start = time.process_time()
    solids.inertia(name)
    print(name.replace(" ", "-"), time.process_time() - start)
"""


def measure(settings: Settings) -> Section:  # noqa: ARG001 - all measurements are called alike
    """Return times on one core, each in a fresh process with SymPy's caches empty."""
    steps, moments = _seconds(_DERIVATIONS), _seconds(_SOLIDS)
    rows = (
        _slowest("derivation", steps, EACH_DERIVATION),
        _row(f"all {len(steps)} derivations", sum(steps.values()), ALL_DERIVATIONS),
        *_sound(),
        *_formulas(),
        _handouts(),
        _slowest("inertia of a solid", moments, EACH_SOLID),
        _row(f"all {len(moments)} solids", sum(moments.values()), None),
        _cubature(),
        _meshes(),
    )
    return Section("derivations: time on one core, the first call; errors of inertia", rows)


def _sound() -> tuple[Row, ...]:
    """Count results that no rule has reached, lines that say nothing, assumptions that are not needed."""
    made = [derive(name) for name in names()]
    steps = [s for d in made for s in d.steps]
    results = len([s for s in steps if s.kind == RESULT])
    counts = {
        f"results that are asserted, of {results}": sum(len(asserted(d)) for d in made),
        f"lines that are tautologies, of {len(steps)}": sum(
            is_tautology(s.statement) for s in steps
        ),
        "assumptions that a line does not need": sum(len(list(surplus(d))) for d in made),
    }
    return tuple(Row(what, str(n), target="0", met=n == 0) for what, n in counts.items())


def _formulas() -> tuple[Row, ...]:
    """Return the longest lines of formulas of all steps, in letters of LaTeX."""
    plain, where = longest_formula(matrices=False)
    matrix, there = longest_formula(matrices=True)
    target = f"< {LONGEST_FORMULA}"
    return (
        Row(
            f"longest line of a formula: {where}",
            str(plain),
            target=target,
            met=plain < LONGEST_FORMULA,
        ),
        Row(f"of one with a matrix: {there}", str(matrix)),
    )


def _handouts() -> Row:
    """Return the most pages that a handout takes as PDF."""
    what = "pages of PDF of a handout, at most"
    if shutil.which(COMPILER) is None:
        return Row(what, "no LaTeX here")
    most = max(pdf_pages(derive(name).page("latex", form="handout")) for name in names())
    return Row(what, str(most), target="1", met=most == 1)


def _cubature() -> Row:
    """Return the greatest error of the closed forms at three random sizes of each solid."""
    errors = {name: max(cubature_error(name, seed) for seed in range(3)) for name in SOLIDS}
    worst = max(errors, key=errors.__getitem__)
    what = f"closed forms against cubature, worst: {worst}"
    met = errors[worst] <= CUBATURE_ERROR
    return Row(what, f"{errors[worst]:.1e}", target=f"<= {CUBATURE_ERROR:g}", met=met)


def _meshes() -> Row:
    """Return the order in edge length at which meshes of a sphere converge."""
    exact = 8 * math.pi / 15
    errors = [1 - float(mesh_properties(*icosphere(k)).about_centre[2, 2]) / exact for k in (4, 5)]
    order = math.log2(errors[0] / errors[1])
    met = abs(order - MESH_ORDER) < 0.01
    return Row("meshes of a sphere: order of the inertia", f"{order:.3f}", target="2", met=met)


def _slowest(what: str, found: dict[str, float], limit: float) -> Row:
    name = max(found, key=found.__getitem__)
    return _row(f"slowest {what}: {name}", found[name], limit)


def _row(what: str, seconds: float, limit: float | None) -> Row:
    if limit is None:
        return Row(what, time_text(seconds))
    return Row(what, time_text(seconds), target=f"<= {time_text(limit)}", met=seconds <= limit)


def _seconds(code: str) -> dict[str, float]:
    run = subprocess.run(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, check=True
    )
    return {name: float(value) for name, value in map(str.split, run.stdout.splitlines())}
