"""Lines about a system that carry a slip forward: they hold in the system that the wrong line describes.

A line that is wrong gives, solved for the one rate or the one named quantity that it tells, a system
with the slip in it. Later lines that are wrong of the system itself and hold on the solutions of that
one follow from the slip, however they are derived from it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import sympy as sp

from eom.checker.judge.judge import WRONG
from eom.checker.judge.systems import HOLDS, decide_within, equations, on_solutions
from eom.checker.judge.verdicts import Judged, Verdict
from eom.checker.mean.claims import CONSTANT, Claim
from eom.checker.mean.model import Model
from eom.errors import InputError
from eom.exact.solutions import rate
from eom.fields import Singular
from eom.system import Expr, System

MAX_EARLIER = 4
"""Wrong lines that a later one is compared with, the last ones first."""


def carried_on_solutions(
    verdicts: Sequence[Verdict], given: Iterable[str] = ()
) -> Mapping[int, int]:
    """Return numbers of formulas whose wrong claims all follow from one that is wrong before.

    To each number that of the formula with the slip. A formula that adds a slip of its own is absent.
    """
    given = tuple(given)
    own: list[tuple[int, Model]] = []
    found: dict[int, int] = {}
    for number, verdict in enumerate(verdicts):
        wrong = [j for j in verdict.claims if j.verdict == WRONG]
        if not wrong or not all(map(_refuted, wrong)):
            continue
        sources = [_source(j.claim, own, given) for j in wrong]
        if None not in sources:
            found[number] = min(s for s in sources if s is not None)
        else:
            before = [m for _, m in own[-1:]]
            slips = [m for j in wrong for m in _slipped(j.claim)]
            both = [m for b in before for j in wrong for m in _slipped(replace(j.claim, model=b))]
            own += [(number, m) for m in (*slips, *both)]
    return found


def _refuted(judged: Judged) -> bool:
    """Whether a claim was found wrong on the solutions of a system, not by its form."""
    return (
        on_solutions(judged.claim)
        and judged.judgement.verdict == WRONG
        and not judged.claim.verdict
    )


def _source(claim: Claim, own: Sequence[tuple[int, Model]], given: tuple[str, ...]) -> int | None:
    """Return the number of the wrong formula in whose system a wrong claim holds, or None."""
    for number, model in own[: -MAX_EARLIER - 1 : -1]:
        try:
            if decide_within(claim, model, (), given).verdict == HOLDS:
                return number
        except (InputError, Singular, ValueError):
            continue
    return None


def _slipped(claim: Claim) -> Iterator[Model]:
    """Yield the models that a wrong claim describes: with another rate, or another definition."""
    model = claim.model
    if model is None or claim.kind == CONSTANT or model.system.mass_matrix is not None:
        return
    try:
        pairs = equations(claim, model)
    except InputError:
        return
    for left, right in pairs:
        for system in (
            *_other_rate(model.system, left, right),
            *_renamed(model.system, left, right),
        ):
            yield replace(model, system=system, drawn={})


def _other_rate(system: System, left: Expr, right: Expr) -> Iterator[System]:
    """Yield the system in which an equation holds that is linear in the rate of one state."""
    known = {rate(q.symbol): r for q, r in zip(system.states, system.rates, strict=True)}
    speeds = {e: r for e, r in known.items() if r.is_Symbol}
    difference = _named(left - right, speeds)
    for place, q in enumerate(system.states):
        unknown = rate(q.symbol)
        if unknown in speeds or not difference.has(unknown):
            continue
        mark = sp.Dummy("rate")
        plain = difference.xreplace({unknown: mark})
        slope = plain.diff(mark)
        if slope.has(mark) or slope == 0 or plain.has(rate):
            continue
        value = sp.together(-plain.xreplace({mark: sp.Integer(0)}) / slope)
        yield replace(
            system,
            rates=(*system.rates[:place], value, *system.rates[place + 1 :]),
            invariants=(),
            attitudes=(),  # what holds of the bodies need not with the writer's rate
        )


def _named(expression: Expr, speeds: Mapping[Expr, Expr]) -> Expr:
    """Replace rates that are states themselves, from inside out."""
    if not expression.args:
        return expression
    inner = expression.func(*(_named(a, speeds) for a in expression.args))
    return speeds.get(inner, inner)


def _renamed(system: System, left: Expr, right: Expr) -> Iterator[System]:
    """Yield the system in which a named quantity is what an equation says that it is."""
    for name, value in ((left, right), (right, left)):
        if not name.is_Symbol or value.has(rate) or name in value.free_symbols:
            continue
        named = (system.definitions, system.outputs, system.invariants)
        if any(d.symbol == name for rows in named for d in rows):
            own = [
                tuple(replace(d, expression=value) if d.symbol == name else d for d in rows)
                for rows in named
            ]
            with suppress(InputError):  # a value in quantities that are defined behind it
                definitions, outputs, invariants = own
                yield replace(
                    system,
                    definitions=definitions,
                    outputs=outputs,
                    invariants=invariants,
                    attitudes=(),
                )
