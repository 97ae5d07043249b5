"""What exercises are made from: the steps of a topic as lines, and what their symbols mean.

A topic is a derivation. Those of the solids are told as a marker would: integrals over the mass, their
values, and the theorem of parallel axes; all others are the verified steps themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from eom import derivations
from eom.checker.note.derived import front_matter
from eom.derivations.derivation import Derivation, Step
from eom.derivations.showing import Item, only_names, symbols
from eom.errors import typed, unknown_name
from eom.exercises.solids import front_matter_of, legend, solid_of, told
from eom.typeset.notation import NOTATIONS, Notation

RELATIONS = ("=", ":=")


@dataclass(frozen=True)
class Lesson:
    """A ``topic``: its derivation, with the steps that can be lines of an exercise, and its lexicon.

    ``front``: from the name of a notation to front matter that `eom check` reads; ``legend``: from lines
    and a notation to symbols with their meanings.
    """

    topic: str
    derivation: Derivation
    front: Callable[[str], str]
    legend: Callable[[Derivation, Notation], Iterable[Item]] = symbols


def topics() -> dict[str, dict[str, str]]:
    """Return the title of each topic, by group and name: those of the derivations.

    >>> topics()["Particles"]["point-mass"]
    'Dynamics of a point mass'
    """
    return derivations.titles()


@typed
def lesson(topic: str) -> Lesson:
    """Return a ``topic`` by its name, one of `topics`. Raises `InputError` for others.

    >>> len(lesson("point-mass").derivation.steps)
    28
    """
    if topic not in derivations.names():
        raise unknown_name("topic", topic, derivations.names())
    solid = solid_of(topic)
    if solid:
        made = told(topic, solid)
        return Lesson(topic, made, lambda _: front_matter_of(solid), lambda *_: legend(solid))
    made = derivations.derive(topic)
    lines = tuple(s for s in made.steps if _is_line(s))
    return Lesson(topic, _with(made, lines), lambda notation: front_matter(made, notation))


def _is_line(step: Step) -> bool:
    """Tell whether a step claims something in every notation: no inequality, no mere name."""
    if step.statement.relation not in RELATIONS or step.statement.left == step.statement.right:
        return False
    return not any(only_names(step, n) for n in NOTATIONS.values())


def _with(made: Derivation, steps: tuple[Step, ...]) -> Derivation:
    return Derivation(made.name, made.title, made.group, steps, made.scalars, {})
