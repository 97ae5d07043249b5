"""Exercises for teaching: a few lines of a derivation of which exactly one is false, and its key.

A slip that people make is planted in a line of one of the derivations of this package; the checker of
hand derivations proves that it finds fault with that line and with no other, and gives a state in small
numbers at which the line fails. The same topic and seed give the same bytes.

Imports: `eom.checker.mean`, `eom.checker.note`, `eom.checker.read`, `eom.checker.report`,
`eom.derivations`, `eom.errors`, `eom.mass`, `eom.terms`, `eom.typeset`.

>>> made = exercise("point-mass", seed=1)
>>> made.number, made.planted.slip.name
(3, 'constant')
"""

from eom.exercises.lessons import Exercise, Lesson, lesson, marker, solutions, student, topics
from eom.exercises.making import exercise, planted_in, with_others
from eom.exercises.moodle import moodle

__all__ = [
    "Exercise",
    "Lesson",
    "exercise",
    "lesson",
    "marker",
    "moodle",
    "planted_in",
    "solutions",
    "student",
    "topics",
    "with_others",
]
