"""The accuracy report of a compiled system: the error of every result against 50 digits, and its cause.

Errors are in units in the last place (ulps) of the exact value. Beside each stands the condition
number (Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed. 2002, sect. 1.6): an error of
at most `MULTIPLE` times (operations + condition number) ulps is what the arguments themselves allow,
and a larger one is the fault of the formula: it is unstable there. Messages name a
value by a short formula: names where there are names, bounded depth.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from codegen.compiling.checked import Array, Function
from codegen.compiling.compiled import TARGETS as BUILDERS
from codegen.compiling.compiled import Compiled, compiled_jacobian, compiled_of
from codegen.derivatives.derivative import JACOBIAN
from codegen.frontend.layout import Layout
from codegen.ir.interpret import interpret_exactly, interpret_with_bound
from codegen.ir.ops import LEAVES, SOLVE, Instruction
from codegen.ir.program import RATES, Program
from codegen.passes.pipeline import as_written, fitted
from codegen.passes.stable import Rewriting, rewritten, rewritten_freely
from codegen.precision.conditioning import ALL, Trace, everything, operations
from codegen.precision.domain import (
    ACCURATE,
    ALL_DIGITS,
    EXACT,
    ILL,
    NOT_A_NUMBER,
    OVERFLOWS,
    REGIONS,
    TIME,
    UNDERFLOWS,
    UNSTABLE,
    AccuracyReport,
    Cause,
    Change,
    Finding,
    Gain,
    Place,
    Range,
    Row,
    domain_of,
    places,
)
from eom.errors import InputError, typed
from eom.system import System

SAMPLES = 200
MOST_SAMPLES = 10**7
MULTIPLE = 4.0
JUDGED = 50
"""Points a result and region whose condition is computed: those with the largest errors."""
GAINED = 4.0
"""A rewriting is worth a word if it makes some error smaller by this factor, and half the digits right."""

HALF = math.sqrt(ALL_DIGITS)


@typed
def accuracy(
    compiled: Compiled | System,
    domain: Mapping[str, Range | float] | None = None,
    samples: int = SAMPLES,
    seed: int = 0,
    *,
    around: Mapping[str, float] | None = None,
    jacobians: Iterable[str] = (),
    progress: Callable[[float], None] | None = None,
) -> AccuracyReport:
    """Measure every result of a compiled system against 50 digits.

    Parameters
    ----------
    compiled : Compiled or System
        The system, compiled at the first call unless it is.
    domain : mapping, optional
        (low, high), or a number to hold, by name of state, parameter, input or ``t``.
    samples : int, default 200
        Random points in the domain; points at zero, near singular configurations and at extreme
        magnitudes come on top.
    seed : int, default 0
        By which they are drawn.
    around : mapping, optional
        Values by name from which the ranges of the others follow, see `domain.domain_of`.
    jacobians : iterable of str, optional
        What the rates are differentiated by: states, parameters, inputs, time.
    progress : callable, optional
        Called with the share that is done, 0 to 1.

    Returns
    -------
    AccuracyReport
        A row a result: typical and worst error, bound, condition, where it is worst and why.

    Raises
    ------
    InputError
        For unknown names, unusable ranges and a number of samples below one.

    Notes
    -----
    Values are in the units of the system; errors in units in the last place (ulps).

    References
    ----------
    Higham, Accuracy and Stability of Numerical Algorithms (2002), sect. 1.6.

    Examples
    --------
    >>> import sympy as sp, codegen, eom
    >>> x = sp.Symbol("x", real=True)
    >>> slow = codegen.compile(eom.System.from_rates("slow", {x: sp.sin(x) - x}), "numpy")
    >>> accuracy(slow, {"x": (0.1, 1)}, samples=20).row("x").verdict
    'ill-conditioned'
    """
    if isinstance(samples, bool) or not 1 <= samples <= MOST_SAMPLES:
        raise InputError(
            "unusable number of samples", got=samples, expected=f"1 to {MOST_SAMPLES:,}"
        )
    compiled = compiled_of(compiled)
    chosen = domain_of(compiled.program, compiled.layout, domain or {}, around or {})
    drawn = tuple(places(compiled.program, compiled.layout, chosen, samples, seed))
    parts = [_own(compiled, drawn), *(_jacobian(compiled, by, drawn) for by in jacobians)]
    total = len(drawn) * len(parts)
    for done, (part, k) in enumerate((p, k) for p in parts for k in range(len(drawn))):
        part.exact_at(k)
        if progress is not None:
            progress((done + 1) / total)
    rows = tuple(row for part in parts for row in part.rows())
    made, possible = _changes(compiled, parts[0])
    timed = any(i.op == "time" for i in compiled.program.instructions)
    return AccuracyReport(
        compiled.layout.name,
        compiled.target,
        compiled.stable,
        samples,
        seed,
        {n: r for n, r in chosen.ranges().items() if timed or n != TIME},
        tuple(tuple(compiled.layout.states[k].name for k in slots) for slots in chosen.unit),
        rows,
        made,
        possible,
    )


def _changes(compiled: Compiled, part: _Part) -> tuple[Change, Change]:
    """Return what was rewritten when the system was compiled, and what ``stable=True`` would add."""
    if compiled.origin is not None:
        return Change((), ()), Change((), ())
    rules = compiled.program.rules.name
    plain, _ = as_written(compiled.system, compiled.structure, rules)
    free, every = rewritten_freely(plain), rewritten(plain)
    made = every if compiled.stable else free
    first = _change(made, plain, part, part.computed_by(plain), part.got)
    if made.applied == every.applied:
        return first, Change((), ())
    stable, _ = fitted(compiled.system, compiled.structure, rules, stable=True)
    return first, _change(every, plain, part, part.got, part.computed_by(stable))


@dataclass(frozen=True, eq=False)
class _Part:
    """A program, the functions of its results, and where they are measured.

    ``functions``: group, names, numbers of the results in the program, and the function.
    """

    program: Program
    layout: Layout
    functions: tuple[tuple[str, tuple[str, ...], tuple[int, ...], Function], ...]
    drawn: tuple[Place, ...]

    @cached_property
    def keys(self) -> list[tuple[str, str, int]]:
        """Group, name and number of each result."""
        return [
            (group, name, number)
            for group, names, numbers, _ in self.functions
            for name, number in zip(names, numbers, strict=True)
        ]

    @cached_property
    def got(self) -> Array:
        """What the target computes, in shape (results, points)."""
        return self._stacked([f for _, _, _, f in self.functions])

    def computed_by(self, program: Program) -> Array:
        """Return what another program computes for the same results, by NumPy."""
        _, functions, _ = BUILDERS["numpy"](program, self.layout)
        return self._stacked([functions[group] for group, *_ in self.functions])

    def _stacked(self, functions: Sequence[Function]) -> Array:
        points = [place.point for place in self.drawn]
        times = np.array([p.t for p in points])
        arrays = [np.array([v(p) for p in points]).T for v in _VALUES]
        counts = (self.layout.states, self.layout.parameters, self.layout.inputs)
        x, p, u = (a if c else np.empty(0) for a, c in zip(arrays, counts, strict=True))
        return np.concatenate([f(times, x, p, u) for f in functions])

    @cached_property
    def _exact(self) -> dict[int, list[Any]]:
        return {}

    def exact_at(self, k: int) -> list[Any]:
        """Return all results at point ``k`` with 50 digits."""
        if k not in self._exact:
            self._exact[k] = interpret_exactly(self._asked, self.drawn[k].point)[ALL]
        return self._exact[k]

    @cached_property
    def _asked(self) -> Program:
        return replace(self.program, results={ALL: tuple(n for *_, n in self.keys)})

    @cached_property
    def every(self) -> Program:
        """The program with all values as results."""
        return everything(self.program)

    @cached_property
    def _traces(self) -> dict[int, Trace]:
        return {}

    def trace(self, k: int) -> Trace:
        """Return all values at point ``k``."""
        return self._traces.setdefault(k, Trace(self.every, self.drawn[k].point))

    def ulps(self, got: Array, result: int, k: int) -> float | None:
        """Return an error; infinite for an infinity or NaN, None where there is no finite target."""
        exact = self.exact_at(k)[result]
        nearest = float(exact)
        if not math.isfinite(nearest):
            return None
        value = float(got[result, k])
        return float(abs(exact - value) / math.ulp(nearest)) if math.isfinite(value) else math.inf

    def rows(self) -> Iterable[Row]:
        """Return a row for each result and region that has points."""
        regions = [
            (r, [k for k, place in enumerate(self.drawn) if place.region == r]) for r in REGIONS
        ]
        for result in range(len(self.keys)):
            for region, points in regions:
                if points:
                    yield self._row(result, region, points)

    def _row(self, result: int, region: str, points: Sequence[int]) -> Row:
        group, name, number = self.keys[result]
        count = operations(self.program, number)
        errors = {k: e for k in points if (e := self.ulps(self.got, result, k)) is not None}
        finite = sorted((k for k in errors if math.isfinite(errors[k])), key=lambda k: -errors[k])
        failed = [k for k in errors if not math.isfinite(errors[k])]
        doubtful = [k for k in finite[:JUDGED] if errors[k] > MULTIPLE * count]

        def excess(k: int) -> float:
            return errors[k] / (count + self.trace(k).condition(number))

        found = [finite[:1], sorted(doubtful, key=excess)[-1:], failed[:1]]
        worst, judged, wrong = (
            self._finding(result, k[0], errors[k[0]], count) if k else None for k in found
        )
        typical = statistics.median([errors[k] for k in finite]) if finite else 0.0
        return Row(group, name, region, len(errors), count, typical, worst, judged, wrong)

    def _finding(self, result: int, k: int, ulps: float, count: int) -> Finding:
        number, trace = self.keys[result][2], self.trace(k)
        exact = float(self.exact_at(k)[result])
        condition = trace.condition(number)
        verdict = _verdict(trace, number, ulps, condition, count)
        return Finding(
            self.at(k),
            self.drawn[k].how,
            float(self.got[result, k]),
            exact,
            ulps,
            float(self._bounds(k)[number]) / math.ulp(exact),
            condition,
            verdict,
            None if verdict in {EXACT, ACCURATE} else self._cause(trace, number),
        )

    def _cause(self, trace: Trace, number: int) -> Cause | None:
        cause = trace.cause(number)
        if cause is None:
            return None
        op, args, _ = self.program.instructions[cause.number]
        args = () if op == "item" else args
        return Cause(
            formula(self.program, cause.number, self.layout),
            cause.digits,
            cause.share,
            tuple(trace.doubles[a] for a in args),
            trace.doubles[cause.number],
        )

    def at(self, k: int) -> dict[str, float]:
        """Return the values of point ``k`` by name; time where the program reads it."""
        names = [
            q.name for q in (*self.layout.states, *self.layout.parameters, *self.layout.inputs)
        ]
        point = self.drawn[k].point
        found = dict(zip(names, (*point.x, *point.p, *point.u), strict=True))
        timed = any(i.op == "time" for i in self.program.instructions)
        return {**found, "t": point.t} if timed else found

    @cached_property
    def _known_bounds(self) -> dict[int, list[float]]:
        return {}

    def _bounds(self, k: int) -> list[float]:
        if k not in self._known_bounds:
            found = interpret_with_bound(self.every, self.drawn[k].point)[ALL]
            self._known_bounds[k] = [b.error for b in found]
        return self._known_bounds[k]


_VALUES: tuple[Callable[[Any], Sequence[float]], ...] = (
    lambda point: point.x,
    lambda point: point.p,
    lambda point: point.u,
)


def _own(compiled: Compiled, drawn: tuple[Place, ...]) -> _Part:
    layout, program = compiled.layout, compiled.program
    functions = tuple(
        (g, layout.results[g], program.results[g], f) for g, f in compiled.functions.items()
    )
    return _Part(program, layout, functions, drawn)


def _jacobian(compiled: Compiled, by: str, drawn: tuple[Place, ...]) -> _Part:
    """Return the derivatives of the rates by states, parameters, inputs or time."""
    found = compiled_jacobian(compiled, by, RATES)
    layout = compiled.layout
    columns = {
        "states": [q.name for q in layout.states],
        "parameters": [q.name for q in layout.parameters],
        "inputs": [q.name for q in layout.inputs],
        "time": ["t"],
    }[by]
    rates = [f"{q.name}'" for q in layout.states]
    names = tuple(
        f"d {rates[r]}/d {columns[c]}" for r, c in zip(found.rows, found.columns, strict=True)
    )

    def entries(t: Any, x: Any, p: Any = None, u: Any = None, out: Any = None) -> Array:  # noqa: ARG001
        return found(t, x, p, u)

    numbers = found.program.results[JACOBIAN][found.shape[0] :]
    return _Part(found.program, layout, ((f"{JACOBIAN} by {by}", names, numbers, entries),), drawn)


def _verdict(trace: Trace, number: int, ulps: float, condition: float, count: int) -> str:
    if not math.isfinite(ulps):
        found = ((OVERFLOWS, trace.overflows), (UNDERFLOWS, trace.underflows))
        return next((verdict for verdict, test in found if test(number)), NOT_A_NUMBER)
    if ulps == 0:
        return EXACT
    if ulps <= MULTIPLE * max(count, 1):
        return ACCURATE
    if ulps <= MULTIPLE * (count + condition):
        return ILL
    if trace.overflows(number):
        return OVERFLOWS
    return UNDERFLOWS if trace.underflows(number) else UNSTABLE


def _change(form: Rewriting, program: Program, part: _Part, before: Array, after: Array) -> Change:
    """Describe a rewriting of ``program`` by what it replaced and by the errors at all points."""
    if not form.applied:
        return Change((), ())
    identities = tuple((a.identity, formula(program, a.number, part.layout)) for a in form.applied)
    gains = [_gain(part, result, before, after) for result in range(len(part.keys))]
    return Change(identities, tuple(g for g in gains if g is not None))


def _gain(part: _Part, result: int, before: Array, after: Array) -> Gain | None:
    """Return the point at which the error of a result becomes smaller by the largest factor.

    Only errors beyond those of the operations count; below them a gain is chance.
    """
    errors = {
        k: (part.ulps(before, result, k), part.ulps(after, result, k))
        for k in range(len(part.drawn))
    }
    pairs = {k: (b, a) for k, (b, a) in errors.items() if b is not None and a is not None}
    group, name, number = part.keys[result]
    least = MULTIPLE * max(operations(part.program, number), 1)
    usable = {k: (b, a) for k, (b, a) in pairs.items() if b > least and a < HALF}
    best = max(usable, key=lambda k: usable[k][0] / max(usable[k][1], 1), default=None)
    if best is None or usable[best][0] < GAINED * max(usable[best][1], 1):
        return None
    return Gain(group, name, part.drawn[best].region, part.at(best), *usable[best])


DEPTH = 4
"""Operations below one another that are written out; those of one short sum count as one."""
MAX_LENGTH = 80
"""Longer texts are written less deep."""
CUT = "..."


class _Infix(NamedTuple):
    """How an operator is written, how tightly it binds, and what its operands must bind."""

    text: str
    power: int
    needs: tuple[int, ...]


_ATOM = 100
_INFIX: Mapping[str, _Infix] = {
    "add": _Infix("{0} + {1}", 10, (10, 10)),
    "sub": _Infix("{0} - {1}", 10, (10, 11)),
    "mul": _Infix("{0}*{1}", 20, (20, 20)),
    "div": _Infix("{0}/{1}", 20, (20, 21)),
    "neg": _Infix("-{0}", 15, (20,)),
    "pow": _Infix("{0}**{1}", 30, (31, 30)),
    "lt": _Infix("{0} < {1}", 5, (6, 6)),
    "le": _Infix("{0} <= {1}", 5, (6, 6)),
    "eq": _Infix("{0} == {1}", 5, (6, 6)),
}


def formula(program: Program, number: int, layout: Layout, depth: int = DEPTH) -> str:
    """Return the value ``number`` written over named values and at most ``depth`` levels.

    What lies deeper and has no name is written as ``...``; the value itself is always written out.
    """
    tries = [(d, False) for d in range(depth, 1, -1)] + [(d, True) for d in range(depth, 0, -1)]
    texts = [_written(program, number, layout, *t)[0] for t in tries]
    short = next((text for text in texts if len(text) <= MAX_LENGTH), None)
    return texts[-1] if short is None else short


def _written(
    program: Program, number: int, layout: Layout, depth: int, counted: bool
) -> tuple[str, int]:
    """Return the text and how tightly it binds; ``counted``: additions of one sum count, too."""
    op, args, value = instruction = program.instructions[number]
    if op in LEAVES:
        return _leaf(instruction, layout)
    steps = [int(counted or not _same_sum(program, op, a)) for a in args]
    below = [
        _operand(program, a, layout, depth - step, counted)
        for a, step in zip(args, steps, strict=True)
    ]
    if op == "mul" and args[0] == args[1]:
        return f"{_bracketed(below[0], 31)}**2", 30
    infix = _INFIX.get(op)
    if op in SOLVE:
        return f"entry {value} of the solution of a linear system", _ATOM
    if infix is None:
        return f"{op}({', '.join(text for text, _ in below)})", _ATOM
    return infix.text.format(*_in_brackets(below, infix.needs)), infix.power


def _same_sum(program: Program, op: str, operand: int) -> bool:
    return {op, program.instructions[operand].op} <= {"add", "sub"}


def _operand(
    program: Program, number: int, layout: Layout, depth: int, counted: bool
) -> tuple[str, int]:
    name = program.names.get(number)
    if name is not None:
        return name.name, _ATOM
    if depth <= 0 and program.instructions[number].op not in LEAVES:
        return CUT, _ATOM
    return _written(program, number, layout, depth, counted)


def _in_brackets(operands: Sequence[tuple[str, int]], needs: Sequence[int]) -> list[str]:
    return [_bracketed(operand, need) for operand, need in zip(operands, needs, strict=True)]


def _bracketed(operand: tuple[str, int], need: int) -> str:
    text, power = operand
    return text if power >= need else f"({text})"


def _leaf(instruction: Instruction, layout: Layout) -> tuple[str, int]:
    op, _, value = instruction
    groups = {"state": layout.states, "parameter": layout.parameters, "input": layout.inputs}
    if op in groups:
        return groups[op][instruction.slot].name, _ATOM
    if op == "const":
        assert isinstance(value, Fraction)
        text = str(value) if len(str(value)) <= 12 else f"{float(value):.6g}"
        return text, 15 if text.startswith("-") else 20 if "/" in text else _ATOM
    return {"pi": "pi", "time": "t"}.get(op, op if value is None else f"{op}{value}"), _ATOM
