"""An exercise as plain data for programs."""

from __future__ import annotations

from typing import Any

from eom.derivations.derivation import Derivation
from eom.exercises.lessons import Exercise, line_latex, steps
from eom.exercises.moodle import typed_answer
from eom.exercises.page import marker, student
from eom.typeset.notation import notation_named, write


def as_data(made: Exercise) -> dict[str, Any]:
    """Return an exercise as data for JSON: its lines, its key, both pages; formulas are LaTeX.

    ``maxima``: the side with the slip as it is right, null where it is no scalar expression.
    """
    notation = notation_named(made.asked.notation)
    typed = typed_answer(made)
    return {
        "topic": made.asked.lesson.topic,
        "title": made.right.title,
        "group": made.right.group,
        "seed": made.asked.seed,
        "notation": made.asked.notation,
        "lines": _lines(made.wrong, made.asked.notation),
        "key": {
            "line": made.number,
            "slip": made.planted.slip.name,
            "words": made.planted.slip.words,
            "verdict": made.finding.verdict,
            "is": line_latex(made.wrong, made.wrong.steps[made.number - 1], notation),
            "should_be": line_latex(made.right, made.step, notation),
            "part": write(made.planted.wrong, notation, "latex"),
            "part_should_be": write(made.planted.right, notation, "latex"),
            "left_minus_right": made.finding.explanation.residual,
            "counterexample": _numbers(made),
            "maxima": typed and {"side": typed.side, "expression": typed.right},
        },
        "page": student(made),
        "key_page": marker(made),
    }


def _lines(lines: Derivation, notation: str) -> list[dict[str, Any]]:
    chosen = notation_named(notation)
    return [
        {
            "number": number,
            "reason": block.notes[0].reason,
            "assumptions": list(step.assumptions),
            "latex": line_latex(lines, step, chosen),
        }
        for number, (step, block) in enumerate(
            zip(lines.steps, steps(lines, chosen), strict=True), 1
        )
    ]


def _numbers(made: Exercise) -> dict[str, Any] | None:
    found = made.counterexample
    if found is None:
        return None
    return {
        "assumptions": list(found.assumptions),
        "values": dict(found.values),
        "sides": dict(found.members),
    }
