"""The three lectures' displayed equations, and the derivation step that states each of them.

Lectures: 000, more rigid-body dynamics; 001, energy dissipation and the spinning symmetric body; 002,
dynamics from a point mass to a rigid body. An equation is known by its place among the displays of
its lecture (``002:E16``) and by its number where it has one. Where a lecture is wrong or damaged,
the step states the corrected equation, and a note here says what was changed.
"""

from __future__ import annotations

from dataclasses import dataclass

from eom.derivations import derive, names
from eom.derivations.corrections import CLAIMS, NOTES

DISPLAYS = {"000": 39, "001": 14, "002": 39}
"""How many equations each lecture displays."""

NUMBERS = {
    **{f"002:E{k}": f"(3.{k})" for k in range(1, 5)},
    **{f"002:E{k + 1}": f"(3.{k})" for k in range(5, 36)},
    **{f"002:E{37 + k}": f"(3.36{letter})" for k, letter in enumerate("abc")},
}
"""The numbers that lecture 002 gives; its fifth display has none."""

NO_EQUATION = {"001:E9": "a remark that the missing term is no slip, not an equation"}
"""Displays that state nothing."""

_REMARKS = {**NOTES, **NO_EQUATION, **CLAIMS}


@dataclass(frozen=True)
class Entry:
    """A displayed equation or claim of a lecture, and where it is derived.

    ``identifier``: as 002:E17. ``number``: of the equation, where it is known. ``steps``: (derivation,
    label) of those that state it. ``note``: what is to be said of it.
    """

    identifier: str
    number: str
    steps: tuple[tuple[str, str], ...]
    note: str = ""


def identifiers() -> list[str]:
    """Return the displays of all lectures, in order, then the claims.

    >>> identifiers()[0], len(identifiers())
    ('000:E1', 102)
    """
    displays = [f"{lecture}:E{k}" for lecture, n in DISPLAYS.items() for k in range(1, n + 1)]
    return [*displays, *CLAIMS]


def equation_map() -> dict[str, Entry]:
    """Return every displayed equation and claim with the steps, (derivation, label), that state it.

    By identifier, in the order of the lectures; makes all derivations, which takes some seconds. Raises
    `DerivationError` if a step fails, and `InputError` as `eom.derive`.
    Source: lectures 000, 001 and 002, as identifiers such as 002:E17 say.
    """
    found: dict[str, list[tuple[str, str]]] = {i: [] for i in identifiers()}
    for name in names():
        if name.startswith("inertia-of-"):
            continue
        for step in derive(name).steps:
            for identifier in step.states:
                found[identifier].append((name, step.label))
    return {
        i: Entry(i, NUMBERS.get(i, ""), tuple(steps), _REMARKS.get(i, ""))
        for i, steps in found.items()
    }
