"""An accuracy report as tables and sentences for a terminal, and as plain data.

Size and cost of generated code before anything is compiled: what each stage leaves to do.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from html import escape
from typing import TYPE_CHECKING, Any

from codegen.compiling.compiled import Compiled
from codegen.frontend.notebook import table as html_table
from codegen.ir.program import RATES
from codegen.precision.accuracy import SAMPLES, accuracy
from codegen.precision.domain import (
    ACCURATE,
    ALL_DIGITS,
    EXACT,
    EXTREME,
    ILL,
    NOT_A_NUMBER,
    OVERFLOWS,
    REGIONS,
    SINGULAR,
    TYPICAL,
    UNDERFLOWS,
    UNSTABLE,
    VERDICTS,
    ZERO,
    AccuracyReport,
    Change,
    Finding,
    Gain,
    Range,
    Row,
)
from eom.errors import InputError

if TYPE_CHECKING:
    from rich.table import Table
from dataclasses import dataclass

import sympy as sp

from codegen.compiling.compiled import generate
from codegen.frontend.lower import lower_system
from codegen.frontend.structure import Structure, fit
from codegen.ir.passes import prune
from codegen.ir.program import Program
from codegen.loops.written import Choice
from codegen.passes.pipeline import formed, optimise, pressure, steps
from eom.system import System
from eom.units import in_unit, nearest

WIDTH = 132
"""Columns that a table may take, also where a terminal has fewer: nothing is cut off."""
MAX_POINTS = 6
"""Results whose worst points are printed; the worst verdicts first."""

TITLES: Mapping[str, str] = {ZERO: "at zero", SINGULAR: "near singular", EXTREME: "extreme"}
PLACES: Mapping[str, str] = {
    TYPICAL: "in the domain",
    ZERO: "at zero",
    SINGULAR: "near a singularity",
    EXTREME: "at an extreme",
}

ADVICE: Mapping[str, str] = {
    ILL: "a rounding error in the arguments changes the result as much: no formula cures that",
    UNSTABLE: "the formula loses digits that the arguments do not; no identity known here cures it",
    UNDERFLOWS: "an intermediate value is below the doubles: scale the states, or choose other units",
    OVERFLOWS: "an intermediate value is beyond the doubles: scale the states, or choose other units",
    NOT_A_NUMBER: "rounding leaves the domain of a function: bound its argument, or rewrite it",
}
"""What to do about a verdict where no rewriting helps."""


def table(report: AccuracyReport) -> Table:
    """Return one line a result: errors in ulps in the domain, and the worst of the other regions."""
    from rich.table import Table

    grid = Table(box=None, pad_edge=False)
    titles, lines = cells(report)
    for k, title in enumerate(titles):
        text = k == 0 or title in TEXTS
        grid.add_column(title, no_wrap=k == 0, justify="left" if text else "right")
    for line in lines:
        grid.add_row(*line)
    return grid


def notebook(report: AccuracyReport) -> str:
    """Return what a notebook displays of a report: the table and the sentences, in HTML."""
    first, *rest = heading(report)
    titles, lines = cells(report)
    told = "".join(f"<p>{escape(line.strip())}</p>" for line in (*rest, *sentences(report)) if line)
    return html_table(lines, titles, first) + told


TEXTS = ("verdict", "where")
"""Columns of words."""


def cells(report: AccuracyReport) -> tuple[list[str], list[list[str]]]:
    """Return the titles of the table and its lines, one a result."""
    shown = [r for r in TITLES if any(row.region == r for row in report.rows)]
    numbers = ("typical", "worst", "bound", "condition", *(TITLES[r] for r in shown))
    found: dict[tuple[str, str], dict[str, Row]] = {}
    for row in report.rows:
        found.setdefault((row.group, row.result), {})[row.region] = row
    return ["result", *numbers, *TEXTS], [_line(rows, shown) for rows in found.values()]


def _line(rows: Mapping[str, Row], shown: Sequence[str]) -> list[str]:
    first = rows[TYPICAL]
    worst = first.worst
    gravest = max(rows.values(), key=lambda r: VERDICTS.index(r.verdict))
    return [
        label(first),
        ulps(first.typical),
        "" if worst is None else ulps(worst.ulps),
        "" if worst is None else ulps(worst.bound),
        "" if worst is None else number(worst.condition),
        *(_worst(rows.get(region)) for region in shown),
        gravest.verdict,
        "" if gravest.verdict in {EXACT, ACCURATE} else PLACES[gravest.region],
    ]


def _worst(row: Row | None) -> str:
    if row is None or row.worst is None:
        return "-"
    return ulps(row.worst.ulps)


def label(row: Row | Gain) -> str:
    """Return what a result is called: the rate of theta is theta'."""
    return f"{row.result}'" if row.group == RATES else row.result


def number(value: float) -> str:
    """Return a number with two digits."""
    return f"{value:.2g}"


def ulps(value: float) -> str:
    """Return an error in ulps with two digits; beyond those that a double has, ``all``."""
    return number(value) if value < ALL_DIGITS / 2 else "all" if math.isfinite(value) else "-"


def _in_ulps(value: float) -> str:
    return f"{ulps(value)} ulps" if value < ALL_DIGITS / 2 else "no digit right"


def sentences(report: AccuracyReport) -> Iterator[str]:
    """Return what follows the table: the worst points with causes and advice, then rewritings."""
    grave = [r for r in report.rows if r.verdict not in {EXACT, ACCURATE}]
    order = sorted(grave, key=_gravity)
    first = {(r.group, r.result): r for r in reversed(order)}
    kept = [r for r in order if first[r.group, r.result] is r]
    for row in kept[:MAX_POINTS]:
        yield ""
        yield from _about(report, row)
    if len(kept) > MAX_POINTS:
        yield f"\n{len(kept) - MAX_POINTS} more results with such points: see --json"
    yield ""
    yield from _rewritings(report)


def _gravity(row: Row) -> tuple[int, int, float]:
    """Sort by verdict, the domain before other regions, then by size of the error."""
    size = row.worst.ulps if row.worst is not None else 0.0
    return -VERDICTS.index(row.verdict), REGIONS.index(row.region), -size


def _gravest(row: Row) -> Finding:
    found = [f for f in (row.judged, row.worst, row.failed) if f is not None]
    return next(f for f in found if f.verdict == row.verdict)


def _about(report: AccuracyReport, row: Row) -> Iterator[str]:
    finding = _gravest(row)
    where = f" ({finding.how})" if finding.how else ""
    yield f"{label(row)}: {finding.verdict} {PLACES[row.region]}{where}"
    yield f"  value:     {finding.value!r}, exact {finding.exact!r}"
    if math.isfinite(finding.ulps):
        yield (
            f"  error:     {_in_ulps(finding.ulps)}; condition {number(finding.condition)}, "
            f"{row.operations} operations, bound {_in_ulps(finding.bound)}"
        )
    yield f"  point:     {', '.join(f'{n}={v!r}' for n, v in finding.at.items())}"
    if finding.cause is not None:
        yield f"  cause:     {_cause(finding)}"
    yield f"  advice:    {_advice(report, row)}"


def _cause(finding: Finding) -> str:
    cause = finding.cause
    assert cause is not None
    given = ", ".join(f"{v:.6g}" for v in cause.operands)
    numbers = f"{given} give {cause.value:.6g}" if given else f"it is {cause.value:.6g}"
    if cause.digits >= 1:
        return f"{cause.formula} loses {cause.digits:.1f} digits: {numbers}"
    return f"{cause.formula} rounds ({cause.share:.0%} of the error): {numbers}"


def _advice(report: AccuracyReport, row: Row) -> str:
    for gain in report.possible.gains:
        if (gain.group, gain.result) == (row.group, row.result) and row.verdict != ILL:
            return f"compile with stable=True (eom: --stable): {_from_to(gain)}"
    return ADVICE[row.verdict]


def _from_to(gain: Gain) -> str:
    before = _in_ulps(gain.before)
    return f"{before} before, {number(gain.after)} after, {PLACES[gain.region]}"


def _rewritings(report: AccuracyReport) -> Iterator[str]:
    yield from _change(report.made, "rewritten", "gained")
    yield from _change(report.possible, "stable=True would rewrite", "would gain")
    if not report.made.identities and not report.possible.identities:
        yield "rewritten: nothing; no identity against cancellation fits this system"


def _change(change: Change, verb: str, gained: str) -> Iterator[str]:
    for identity, where in change.identities:
        yield f"{verb}: {where}, by {identity}"
    for gain in change.gains:
        yield f"  {label(gain)} {gained}: {_from_to(gain)}"
    if change.identities and not change.gains:
        yield f"  no result {gained} more than rounding on these points"


def heading(report: AccuracyReport) -> Iterator[str]:
    """Return what was measured and where."""
    form = ", stable forms" if report.stable else ""
    yield f"{report.system} for {report.target}{form}: errors in units in the last place (ulps)"
    unit = {name for names in report.unit for name in names}
    ranges = [
        f"{n} {_range(low, high)}" for n, (low, high) in report.domain.items() if n not in unit
    ]
    ranges += [f"({', '.join(names)}) of fixed norm" for names in report.unit]
    yield f"domain: {'; '.join(ranges)}; {report.samples} samples, seed {report.seed}"


def _range(low: float, high: float) -> str:
    return f"= {low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"


def as_data(report: AccuracyReport) -> dict[str, Any]:
    """Return a report as plain values for JSON; infinities and NaN as text."""
    data = _plain(asdict(report))
    assert isinstance(data, dict)
    for row, plain in zip(report.rows, data["rows"], strict=True):
        plain["verdict"] = row.verdict
    return {"regions": list(REGIONS), **data}


def _plain(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    if isinstance(value, Mapping):
        return {k: _plain(v) for k, v in value.items()}
    return [_plain(v) for v in value] if isinstance(value, list | tuple) else value


def measured(
    compiled: Compiled,
    values: Mapping[str, float],
    ranges: Sequence[str],
    samples: int | None,
    seed: int,
    jacobian: Sequence[str],
    progress: Callable[[float], None] | None,
) -> AccuracyReport:
    """Return the report for the words of a command line: ``ranges`` as name=low:high or name=value."""
    units = {q.name: q.unit for q in compiled.layout.known}
    domain = dict(_stated(text, units) for text in ranges)
    count = SAMPLES if samples is None else samples
    return accuracy(
        compiled, domain, count, seed, around=values, jacobians=jacobian, progress=progress
    )


def _stated(text: str, units: Mapping[str, str]) -> tuple[str, Range | float]:
    name, _, span = text.partition("=")
    unit = units.get(name.strip(), "s" if name.strip() == "t" else "")
    parts = span.split(":")
    found = [in_unit(part, unit, f"--range {text!r}") for part in parts]
    try:
        numbers = [
            float(part) if x is None else nearest(x) for part, x in zip(parts, found, strict=True)
        ]
    except ValueError:
        numbers = []
    if not name or len(numbers) not in {1, 2}:
        raise InputError(
            "not a range", where="--range", got=text, expected="NAME=LOW:HIGH or NAME=VALUE"
        )
    return name.strip(), numbers[0] if len(numbers) == 1 else (numbers[0], numbers[1])


def show(report: AccuracyReport, as_json: bool) -> None:
    """Print a report: as tables and sentences, or as JSON."""
    from rich.console import Console

    console = Console(soft_wrap=True, highlight=False, markup=False)
    if as_json:
        print(json.dumps(as_data(report), ensure_ascii=False, indent=1))
        return
    for line in heading(report):
        console.print(line)
    Console(width=max(console.width, WIDTH), highlight=False).print(table(report))
    for line in sentences(report):
        console.print(line)


@dataclass(frozen=True)
class Stage:
    """Operations of the right-hand side after a stage, and their cost in additions.

    ``pressure``: the largest number of values that wait for a later use.
    """

    name: str
    operations: int
    cost: int | None = None
    pressure: int | None = None


@dataclass(frozen=True)
class Report:
    """Stages of the right-hand side, its operations by kind, and the sizes of the files in bytes."""

    stages: tuple[Stage, ...]
    kinds: Mapping[str, int]
    sizes: Mapping[str, int]


def report(
    system: System,
    parameters: Mapping[str, float],
    target: str = "c",
    integrator: Choice | None = None,
) -> Report:
    """Return what generating code for ``system`` gives, with ``parameters`` fixed to numbers.

    Raises `InputError` as `codegen.compile` does.
    """
    structure = Structure.of(system, parameters)
    lowered = lower_system(system)
    folded, layout = fit(lowered, system, structure)
    final = prune(folded, [RATES])
    stages = [
        Stage("as written, every definition put in", tree_operations(system)),
        _stage("equal values shared, constants folded", prune(lowered, [RATES])),
        *([_stage("parameter values compiled in", final)] if structure.names else []),
    ]
    met: set[str] = set()
    kept = formed(folded, stable=False)
    final = prune(kept, [RATES])
    stages.append(_stage("forms that keep digits", final))
    for p, program in steps(final):
        stages.append(_stage(f"{p.name}, again" if p.name in met else p.name, program))
        met.add(p.name)
        final = program
    files = generate(optimise(kept), layout, target, integrator)
    sizes = {name: len(text.encode()) for name, text in files.items()}
    return Report(tuple(stages), final.counts(), sizes)


def _stage(name: str, program: Program) -> Stage:
    return Stage(name, sum(program.counts().values()), program.cost(), pressure(program))


def tree_operations(system: System) -> int:
    """Count operations of the right-hand side if nothing were shared; linear in distinct nodes."""
    known: dict[Any, int] = {}
    for definition in system.definitions:
        known[definition.symbol] = _operations(definition.expression, known)
    mass = () if system.mass_matrix is None else tuple(system.mass_matrix)
    return sum(_operations(e, known) for e in (*system.right_sides, *mass))


def _operations(expression: Any, known: dict[Any, int]) -> int:
    stack = [expression]
    while stack:
        node = stack[-1]
        if node in known:
            stack.pop()
            continue
        waiting = [a for a in node.args if a not in known]
        if waiting:
            stack.extend(waiting)
            continue
        own = len(node.args) - 1 if isinstance(node, sp.Add | sp.Mul) else int(bool(node.args))
        known[node] = own + sum(known[a] for a in node.args)
        stack.pop()
    return known[expression]


def show_operations(
    system: System,
    parameters: Mapping[str, float],
    target: str,
    integrator: Choice | None = None,
) -> None:
    """Print what code generation leaves to compute; nothing is compiled."""
    from rich.console import Console
    from rich.table import Table

    found = report(system, parameters, target, integrator)
    titles = ("right-hand side", "operations", "cost in additions", "live")
    stages = Table(*titles, box=None, pad_edge=False)
    for stage in found.stages:
        numbers = (stage.operations, stage.cost, stage.pressure)
        stages.add_row(stage.name, *("" if n is None else f"{n:,}" for n in numbers))
    console = Console(soft_wrap=True)
    console.print(stages)
    console.print("kinds: " + ", ".join(f"{n} {op}" for op, n in found.kinds.items()))
    for name, size in found.sizes.items():
        console.print(f"{name}: {size:,} bytes")
