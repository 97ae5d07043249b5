"""Findings as a table, as lines of text, and as JSON data."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from rich.table import Table

from codegen.measure.stress.record import FAIL, PASS, Check, Figure, Findings, Plan

SCHEMA = 1
TOLD = 20
"""Failing figures of one check that are printed; the data hold all."""


@dataclass(frozen=True)
class Outcome:
    """A check, what it found, and how many seconds it took."""

    check: Check
    findings: Findings
    seconds: float


def all_passed(outcomes: Sequence[Outcome]) -> bool:
    """Whether every check passed; one that could not be measured has not."""
    return all(o.findings.verdict == PASS for o in outcomes)


def table(outcomes: Sequence[Outcome], plan: Plan) -> Table:
    """Return a row a check: verdict, figures that hold, the one nearest to its bound."""
    result = Table(
        box=None, pad_edge=False, title=f"eom stress, {plan.size.name}, seed {plan.seed}"
    )
    for column in ("check", "result", "within bound"):
        result.add_column(column, no_wrap=True)
    for column in ("nearest to its bound", "states", "bound"):
        result.add_column(column)
    for o in outcomes:
        held = [f for f in o.findings.figures if f.bound is not None]
        count = f"{sum(f.passed for f in held)} of {len(held)}"
        worst = o.findings.worst
        text = "-" if worst is None else _against(worst)
        result.add_row(o.check.name, o.findings.verdict, count, text, o.check.states, o.check.bound)
    return result


def _against(figure: Figure) -> str:
    bound = "" if figure.bound is None else f", bound {figure.bound:.3g}"
    return f"{figure.what}: {figure.value:.3g}{bound}"


def lines(outcomes: Sequence[Outcome]) -> list[str]:
    """Return what failed, what is told without a bound, and what was not measured, a line each."""
    found = []
    for o in outcomes:
        name, failing = o.check.name, [f for f in o.findings.figures if not f.passed]
        found += [f"{name}: {FAIL}: {_told(f)}" for f in failing[:TOLD]]
        if len(failing) > TOLD:
            found.append(f"{name}: {FAIL}: {len(failing) - TOLD} more")
        found += [f"{name}: {_told(f)}" for f in _notable(o.findings)]
        found += [f"{name}: not measured: {reason}" for reason in o.findings.absent]
    return found


def _notable(findings: Findings) -> list[Figure]:
    """Return figures without a bound, and those that are told in any case."""
    return [f for f in findings.figures if f.passed and (f.bound is None or f.told)]


def _told(figure: Figure) -> str:
    return _against(figure) + (f"; {figure.note}" if figure.note else "")


def data(outcomes: Sequence[Outcome], plan: Plan, about: Mapping[str, Any]) -> str:
    """Return all figures as JSON; ``about``: what stands beside them (machine, date)."""
    found = {
        "schema": SCHEMA,
        "plan": {"size": asdict(plan.size), "methods": plan.methods, "seed": plan.seed},
        "passed": all_passed(outcomes),
        "checks": [_check(o) for o in outcomes],
        **about,
    }
    return json.dumps(found, indent=1) + "\n"


def _check(o: Outcome) -> dict[str, Any]:
    words = {k: v for k, v in vars(o.check).items() if isinstance(v, str)}
    figures = [_figure(f) for f in o.findings.figures]
    rest = {"seconds": round(o.seconds, 3), "figures": figures, "absent": o.findings.absent}
    return {**words, "verdict": o.findings.verdict, **rest}


def _figure(f: Figure) -> dict[str, Any]:
    numbers = {"value": _number(f.value), "bound": _number(f.bound)}
    return {"what": f.what, **numbers, "passed": f.passed, "note": f.note}


def _number(value: float | None) -> float | str | None:
    """Return a number as JSON has it; infinity and NaN, which it has not, as text."""
    if value is None or math.isfinite(value):
        return None if value is None else float(value)
    return str(value)
