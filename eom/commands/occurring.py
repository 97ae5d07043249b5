"""Events of `eom simulate`: how they are spelt, and how what was found is told."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

from eom.errors import InputError

if TYPE_CHECKING:
    from codegen import Event, Result
    from eom.system import System

event_option = click.option(
    "--event",
    "events",
    multiple=True,
    metavar='"EXPR [rising|falling] [stop [N]]"',
    help=(
        "Tell when EXPR, over states, parameters, outputs and t, is zero: where it rises or falls "
        'alone, with stop also end the run there, or at the Nth.  As: --event "theta - 0.5 rising stop".'
    ),
)
_DIRECTIONS = {"rising": 1, "falling": -1}
_END = re.compile(
    r"^(?P<text>.*?)(?:\s+(?P<direction>rising|falling))?(?:\s+(?P<stop>stop)(?:\s+(?P<times>\S+))?)?\s*$",
    re.DOTALL,
)
MOST_TIMES = 6
"""Times of an event that are told in the closing table."""


def events_of(texts: Sequence[str], system: System) -> tuple[Event, ...]:
    """Return events from what was given, each named by its text.

    Raises `InputError` for what is no formula over the names of the system, and for other numbers of
    times than whole ones from 1 on; `codegen.simulate` raises it for what cannot be an event.
    """
    groups = (system.definitions, system.outputs, system.states, system.parameters, system.inputs)
    names = {q.name: q.symbol for group in groups for q in group}
    names = {"t": system.time, **names}
    return tuple(_event(text, names) for text in texts)


def _event(text: str, names: Mapping[str, Any]) -> Event:
    from codegen import Event
    from eom.scenes.parse import parse

    where = f"--event {text!r}"
    found = _END.match(text)
    assert found is not None
    if not found["text"].strip():
        raise InputError("an event has no expression", where=where,
                         expected='as "theta - 0.5 rising stop"')  # fmt: skip
    expression = parse(found["text"], names, where)
    return Event(expression, _DIRECTIONS.get(found["direction"], 0), _times(found, where), text)


def _times(found: re.Match[str], where: str) -> int:
    if found["times"] is None:
        return int(found["stop"] is not None)
    if not found["times"].isdecimal() or int(found["times"]) < 1:
        raise InputError("an event cannot end a run so", where=where, got=f"stop {found['times']}",
                         expected="stop, or stop and a number of times from 1 on")  # fmt: skip
    return int(found["times"])


def rows(result: Result) -> list[tuple[str, str]]:
    """Return how often each event happened, and when, for the closing table."""
    return [(f"event {name}", _told(e.t)) for name, e in result.events.items()]


def _told(times: Any) -> str:
    if not len(times):
        return "never"
    shown = ", ".join(f"{t:.9g}" for t in times[:MOST_TIMES])
    more = ", ..." if len(times) > MOST_TIMES else ""
    return f"{len(times):,}, at t = {shown}{more} s"
