"""Right-hand side and its Jacobian by the states in one function, beside the right-hand side alone."""

from __future__ import annotations

from benchmarks import instructions
from benchmarks.native_rates import Points, Rates, sampler
from benchmarks.pairs import paired
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen import Compiled, SparseJacobian
from codegen import compile as compile_system
from codegen.derivatives.derivative import JACOBIAN
from codegen.ir.passes import prune
from codegen.ir.program import RATES, Program
from codegen.passes.pipeline import by_parameters
from eom.scenes import catalogue
from eom.scenes.scene import Scene

LARGEST_RATIO = 3.0
"""Of both together to the right-hand side, by operations and by instructions of the processor."""
PAIRS = 400


def measure(settings: Settings) -> Section:
    """Return two rows a ready scene; the short form counts operations alone."""
    rows: list[Row] = []
    for name in catalogue.single():
        compiled = compile_system(Scene.ready(name).derive(), "c")
        jacobian = compiled.jacobian()
        rows.append(_operations(name, compiled, jacobian))
        if not settings.quick:
            rows.append(_in_c(name, compiled, jacobian, settings))
    return Section("value and Jacobian | value", tuple(rows))


def _operations(name: str, compiled: Compiled, jacobian: SparseJacobian) -> Row:
    both, value = operations(jacobian.program), operations(prune(compiled.program, [RATES]))
    ours = f"{both} operations, {len(jacobian.rows)} entries, {jacobian.mode}"
    return _row(name, ours, f"{value} operations", both / value)


def operations(program: Program) -> int:
    """Return how many operations of a program do not depend on parameters alone."""
    return sum(by_parameters(program).late.counts().values())


def _in_c(name: str, compiled: Compiled, jacobian: SparseJacobian, settings: Settings) -> Row:
    """Time both inside C; the target is that of the instructions, where these are counted."""
    both, value = Rates.jacobian(jacobian), Rates.generated(compiled)
    points = Points.of(compiled)
    wide = points.with_room(jacobian.layout.sizes[JACOBIAN])
    pairs = paired(sampler(both, wide), sampler(value, points), PAIRS)
    mine, other = (time_text(s) for s in pairs.typical)
    what = f"{name}, in C"
    if not settings.instructions:
        return Row(what, mine, other, f"{pairs.ratio:.3f}")
    counts = [instructions.per_call(rates) for rates in (both, value)]
    mine, other = (
        f"{time}, {'?' if n is None else n} instructions"
        for time, n in zip((mine, other), counts, strict=True)
    )
    if counts[0] is None or counts[1] is None:
        return Row(what, mine, other, f"{pairs.ratio:.3f}")
    return _row(what, f"{mine}, time {pairs.ratio:.2f}", other, counts[0] / counts[1])


def _row(what: str, ours: str, beside: str, ratio: float) -> Row:
    met = ratio <= LARGEST_RATIO
    return Row(what, ours, beside, f"{ratio:.3f}", f"<= {LARGEST_RATIO}", met)
