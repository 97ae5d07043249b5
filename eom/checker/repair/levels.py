"""Worlds in which repairs are looked for: from what derivations usually assume to special motions.

A repair that holds under some assumptions holds under more; so it is looked for where much is assumed,
and judged afterwards.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from eom.checker.judge.contexts import contexts
from eom.checker.repair.lines import Place, place
from eom.errors import InputError
from eom.terms.terms import Term
from eom.worlds.worlds import SEQUENCES, closure

LEVELS: tuple[tuple[str, ...], ...] = (
    ("body_frame", "newton_2", "third_law_strong", "about_centre"),
    ("body_frame", "newton_2", "third_law_strong", "O_fixed_in_body", "O_fixed_in_space"),
    ("body_frame", "newton_2", "third_law_strong", "about_centre", "principal_axes", "C_at_rest"),
    (
        *("body_frame", "newton_2", "third_law_strong", "about_centre", "principal_axes"),
        *("A_fixed_in_body", "OA_at_centre", "no_torque_2"),
    ),
    (
        *("body_frame", "newton_2", "third_law_strong", "about_centre", "principal_axes"),
        *("symmetric", "no_torque_2", "no_torque_3"),
    ),
    (
        *("body_frame", "newton_2", "third_law_strong", "about_centre", "torque_free"),
        *("principal_axes", "A_fixed_in_body"),
    ),
)
"""Sets of assumptions, the usual ones first; what cannot stand with the rest is left out."""

PENALTIES: dict[str, float] = {
    "constant_mass": 0.1,
    "newton_2": 0.1,
    "third_law_weak": 0.1,
    "third_law_strong": 0.1,
    "rigid": 0.15,
    "body_frame": 0.15,
    "one_particle": 0.3,
    "about_centre": 0.35,
    "O_fixed_in_body": 0.4,
    "O_fixed_in_space": 0.5,
    "C_at_rest": 0.5,
    "spin_312": 0.1,
    **dict.fromkeys(SEQUENCES, 0.1),
    "rotors": 0.1,
    "viscous_slug": 0.1,
    "principal_axes": 0.4,
    "A_fixed_in_body": 0.6,
    "OA_at_centre": 0.6,
    "no_torque_2": 0.6,
    "no_torque_3": 0.6,
}
UNUSUAL = 1.5
"""What an assumption weighs that is not in the table."""


def penalty(names: Iterable[str], stated: frozenset[str]) -> float:
    """Return what assumptions weigh that the note has not stated."""
    return sum(PENALTIES.get(n, UNUSUAL) for n in names if n not in stated)


def places(
    given: Iterable[str], scalars: dict[object, Term], terms: list[Term]
) -> Iterator[tuple[Place, Place]]:
    """Yield worlds where the terms have values: without more than is given, and one of each level."""
    given = tuple(given)
    for context in contexts([*terms, *scalars.values()]):
        try:
            base = closure([*given, *context])
        except InputError:
            continue
        free = place(base, scalars, terms)
        if free is None:
            continue
        done: set[frozenset[str]] = set()
        for level in LEVELS:
            names = filled(base, level)
            if names not in done:
                done.add(names)
                there = place(names, scalars, terms)
                if there is not None:
                    yield free, there
        return


def filled(base: frozenset[str], level: Iterable[str]) -> frozenset[str]:
    """Return a set with every name of a level that can stand with it."""
    for name in level:
        try:
            base = closure([*sorted(base), name])
        except InputError:
            continue
    return base
