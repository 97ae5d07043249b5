r"""An exercise as questions in Moodle's XML: which line, what is right, and the same to be typed (STACK).

Formulas stand between \( and \), or \[ and \], which Moodle's MathJax filter and STACK both take. The
tree is written by the standard library, which escapes every text; letters that XML has no place for are
left out. The third question is there where the side with the slip is a scalar expression that Maxima can
read; STACK compares what is typed with it as an expression.

`maxima` spells them in the language of Maxima, which STACK takes. `as_data` is an exercise as plain data.
"""

from __future__ import annotations

import html
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from eom.derivations.derived import Derived
from eom.derivations.wording import notation_of
from eom.errors import typed
from eom.exercises.lessons import (
    DISPLAY,
    INLINE,
    WORDS,
    Exercise,
    Said,
    command,
    display,
    inline,
    key,
    line_latex,
    marker,
    said,
    spoken,
    steps,
    student,
    task,
)
from eom.typeset.markup import render, symbol_latex
from eom.typeset.notation import notation_named, write
from eom.typeset.sentences import sentence

CATEGORY = "$course$/top/Mechanics: find the false line"
STACK_VERSION = "2023010400"
"""The version of STACK whose fields are written; later ones import them."""

Rows = tuple[tuple[str, Any], ...]
"""Elements with their texts, None for an empty one."""

_SCORED = (
    ("correct", "Right."),
    ("partiallycorrect", "Partly right."),
    ("incorrect", "Not right."),
)

_LOOK: Rows = (
    ("multiplicationsign", "dot"),
    ("sqrtsign", 1),
    ("complexno", "i"),
    ("inversetrig", "cos-1"),
    ("logicsymbol", "lang"),
    ("matrixparens", "["),
    ("variantsselectionseed", None),
)

_INPUT: Rows = (
    ("name", "ans1"),
    ("type", "algebraic"),
    ("tans", "ta1"),
    ("boxsize", 40),
    ("strictsyntax", 1),
    ("insertstars", 0),
    ("syntaxhint", None),
    ("syntaxattribute", 0),
    ("forbidwords", None),
    ("allowwords", None),
    ("forbidfloat", 1),
    ("requirelowestterms", 0),
    ("checkanswertype", 1),
    ("mustverify", 1),
    ("showvalidation", 1),
    ("options", None),
)
"""What is typed: one expression, letters of several characters, no decimal numbers."""

_COMPARED: Rows = (
    ("name", 0),
    ("answertest", "AlgEquiv"),
    ("sans", "ans1"),
    ("tans", "ta1"),
    ("testoptions", None),
    ("quiet", 0),
)

# -- texts --------------------------------------------------------------------------------------------

_UNFIT = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_FORMULA = {INLINE: (r"\(", r"\)"), DISPLAY: (r"\[", r"\]")}


def clean(text: str) -> str:
    """Return a text without the letters that XML has no place for."""
    return _UNFIT.sub("", text)


def _html(paragraphs: Iterable[Said]) -> str:
    return "\n".join(f"<p>{_inner(p)}</p>" for p in paragraphs)


def _inner(paragraph: Said) -> str:
    return "".join(
        html.escape(part.text, quote=False)
        if part.kind == WORDS
        else html.escape(part.text, quote=False).join(_FORMULA[part.kind])
        for part in paragraph
    )


def _apart(text: str) -> str:
    """Return HTML in which nothing is a command of STACK's: [[...]], {@...@}, {#...#}."""
    for pair in ("[[", "{@", "{#"):
        text = text.replace(pair, f"{pair[0]} {pair[1]}")
    return text


# -- XML ----------------------------------------------------------------------------------------------


def _element(parent: ET.Element, tag: str, text: Any = None, **attributes: str) -> ET.Element:
    made = ET.SubElement(parent, tag, attributes)
    made.text = None if text is None else clean(str(text))
    return made


def _text(parent: ET.Element, tag: str, text: str, style: str = "") -> ET.Element:
    """Add an element that holds its text in an element of its own, as Moodle has it."""
    made = _element(parent, tag, **({"format": style} if style else {}))
    _element(made, "text", text)
    return made


@typed
def moodle(exercises: Sequence[Exercise]) -> str:
    """Return ``exercises`` as one file in Moodle's XML.

    Parameters
    ----------
    exercises : sequence of Exercise
        In the order in which questions are written.

    Returns
    -------
    str
        The text of the file. About each exercise there are two questions (which line is false? what
        is right?) and, where the answer can be typed, a third for the plugin STACK.

    Examples
    --------
    >>> from eom.exercises import exercise
    >>> moodle([exercise("point-mass", seed=1)]).count("<question ")  # the first is the category
    3
    """
    quiz = ET.Element("quiz")
    category = _element(quiz, "question", type="category")
    _text(category, "category", CATEGORY)
    for exercise in exercises:
        _which(quiz, exercise)
        _correction(quiz, exercise)
        _typed(quiz, exercise)
    ET.indent(quiz)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(quiz, encoding="unicode")}\n'


def _question(quiz: ET.Element, exercise: Exercise, kind: str, name: str, text: str) -> ET.Element:
    """Add what every question begins with."""
    made = _element(quiz, "question", type=kind)
    title = " ".join(exercise.right.title.split())
    _text(made, "name", f"{title}: {name} ({exercise.asked.seed})")
    _text(made, "questiontext", text, "html")
    solution = _html(key(exercise))
    _text(made, "generalfeedback", _apart(solution) if kind == "stack" else solution, "html")
    _element(made, "defaultgrade", 1)
    _element(made, "penalty", "0.3333333" if kind != "stack" else "0.1")
    _element(made, "hidden", 0)
    _element(made, "idnumber")
    return made


def _choice(
    quiz: ET.Element, exercise: Exercise, name: str, text: str, shuffle: bool
) -> ET.Element:
    made = _question(quiz, exercise, "multichoice", name, text)
    shuffled = "true" if shuffle else "false"
    _rows(made, (("single", "true"), ("shuffleanswers", shuffled)))
    _rows(made, (("answernumbering", "none"), ("showstandardinstruction", 0)))
    for tag, words in _SCORED:
        _text(made, f"{tag}feedback", words, "html")
    return made


def _answer(question: ET.Element, text: str, right: bool) -> None:
    made = _element(question, "answer", fraction="100" if right else "0", format="html")
    _element(made, "text", text)
    _text(made, "feedback", "", "html")


# -- questions ----------------------------------------------------------------------------------------


def _which(quiz: ET.Element, exercise: Exercise) -> None:
    """Add the question which line is false."""
    text = _html([*_symbols(exercise), *_lines(exercise), task(exercise)])
    made = _choice(quiz, exercise, "which line is false?", text, shuffle=False)
    for number in range(1, len(exercise.right.steps) + 1):
        _answer(made, f"Line ({number})", number == exercise.number)


def _correction(quiz: ET.Element, exercise: Exercise) -> None:
    """Add the question what stands rightly in the place of the false line."""
    notation = exercise.letters
    asked = said(f"Line ({exercise.number}) is false. What should stand in its place?")
    text = _html([*_symbols(exercise), *_lines(exercise), asked])
    made = _choice(quiz, exercise, "what is right?", text, shuffle=True)
    _answer(made, _inner(said(inline(_line(exercise, exercise.right)))), right=True)
    for equation in exercise.others:
        step = replace(exercise.step, statement=equation)
        latex = line_latex(exercise.right, step, notation)
        _answer(made, _inner(said(inline(latex))), right=False)


def _line(exercise: Exercise, lines: Any) -> str:
    step = lines.steps[exercise.number - 1]
    return line_latex(lines, step, exercise.letters)


def _symbols(exercise: Exercise) -> Iterator[Said]:
    """Yield the symbols with their meanings, one paragraph."""
    parts: list[Any] = ["Symbols: "]
    for box, words in exercise.legend:
        shown = box if isinstance(box, str) else inline(render(box, "latex")) if box else ""
        parts += [shown, " ", *spoken(words), "; "] if words else [shown, "; "]
    if len(parts) > 1:
        yield said(*parts[:-1], parts[-1].rstrip("; ") + ".")


def _lines(exercise: Exercise) -> Iterator[Said]:
    """Yield the lines: what is assumed anew, the reason, the formula."""
    wrong = exercise.wrong
    for step, block in zip(wrong.steps, steps(wrong, exercise.letters), strict=True):
        (note,) = block.notes
        if note.assumed:
            yield spoken(note.assumed)
        latex = line_latex(wrong, step, exercise.letters)
        yield said(f"({note.number}) ", *spoken(note.reason), ":", display(latex))


# -- STACK --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Typed:
    """An answer that is typed: which side of the line, as it is right, as it is false, for Maxima.

    ``names``: how symbols are typed.
    """

    side: str
    right: str
    wrong: str
    names: dict[Any, str]


def typed_answer(exercise: Exercise) -> Typed | None:
    """Return the side with the slip for Maxima.

    None where it is no scalar expression, or one that Maxima has no spelling for.
    """
    right, wrong = exercise.step.statement, exercise.planted.equation
    side = "left" if right.left != wrong.left else "right"
    terms = [getattr(e, side) for e in (right, wrong)]
    if any(t.head != "expr" for t in terms):
        return None
    symbols = terms[0].data[0].free_symbols | terms[1].data[0].free_symbols
    names = names_for(symbols)
    texts = [maxima(t.data[0], names) for t in terms]
    if texts[0] is None or texts[1] is None or not symbols:
        return None
    return Typed(side, texts[0], texts[1], names)


def _typed(quiz: ET.Element, exercise: Exercise) -> None:
    """Add the STACK question, where there is one."""
    answer = typed_answer(exercise)
    if answer is None:
        return
    letters: list[Any] = []
    for symbol, name in answer.names.items():
        letters += [inline(symbol_latex(symbol.name)), f" as {name}, "]
    asked = said(
        f"Line ({exercise.number}) is false. Write its {answer.side} side as it should be, in these "
        "letters: ",
        *letters[:-1],
        letters[-1].rstrip(", ") + ".",
    )
    text = _apart(_html([*_symbols(exercise), *_lines(exercise), asked]))
    text += "\n<p>[[input:ans1]] [[validation:ans1]]</p>"
    made = _question(quiz, exercise, "stack", "write it right", text)
    _text(made, "stackversion", STACK_VERSION)
    _text(made, "questionvariables", f"ta1: {answer.right};")
    _text(made, "specificfeedback", "[[feedback:prt1]]", "html")
    _text(made, "questionnote", command(exercise))
    _settings(made)
    _tree(made)
    _test(made, 1, answer.right, right=True)
    _test(made, 2, answer.wrong, right=False)


def _rows(parent: ET.Element, rows: Rows) -> None:
    for tag, value in rows:
        _element(parent, tag, value)


def _settings(question: ET.Element) -> None:
    _rows(question, (("questionsimplify", 1), ("assumepositive", 0), ("assumereal", 0)))
    for tag, words in _SCORED:
        _text(question, f"prt{tag}", words, "html")
    _rows(question, _LOOK)
    _rows(_element(question, "input"), _INPUT)


def _tree(question: ET.Element) -> None:
    """Add the tree of responses: one comparison, right or not."""
    made = _element(question, "prt")
    _rows(made, (("name", "prt1"), ("value", 1), ("autosimplify", 1), ("feedbackstyle", 1)))
    _text(made, "feedbackvariables", "")
    node = _element(made, "node")
    _rows(node, _COMPARED)
    for branch, score in (("true", 1), ("false", 0)):
        rows = {"scoremode": "=", "score": score, "penalty": None, "nextnode": -1}
        _rows(node, tuple((f"{branch}{tag}", value) for tag, value in rows.items()))
        _element(node, f"{branch}answernote", f"prt1-1-{branch[0].upper()}")
        _text(node, f"{branch}feedback", "", "html")


def _test(question: ET.Element, number: int, value: str, *, right: bool) -> None:
    """Add a test that STACK runs: the answer, and the score that it must get."""
    made = _element(question, "qtest")
    _element(made, "testcase", number)
    given = _element(made, "testinput")
    _element(given, "name", "ans1")
    _element(given, "value", value)
    expected = _element(made, "expected")
    _element(expected, "name", "prt1")
    _element(expected, "expectedscore", int(right))
    _element(expected, "expectedpenalty", "" if right else "0.1")
    _element(expected, "expectedanswernote", f"prt1-1-{'T' if right else 'F'}")


RESERVED = frozenset(
    "and array beta break catch cons define delta diff do e else elseif enhance error eval exp false "
    "first float for from gamma i if ind inf infinity int integrate j kronecker lambda last length "
    "limit list lhs log map matrix minf mod next not noun op or params part phi pi plus prime psi "
    "rand ratio rest return rhs second signum simp solve step subst sum tans tau then thru total true "
    "und unit units unless while zero zeta zeroa zerob".split()
)
"""Words that Maxima or STACK keep for themselves, or read as a number or a function."""

_KNOWN = frozenset(
    {sp.Add, sp.Mul, sp.Pow, sp.sin, sp.cos, sp.tan, sp.atan, sp.asin, sp.acos, sp.exp, sp.Abs}
)
"""Operations that Maxima spells as SymPy does, but for powers and magnitudes."""


def names_for(symbols: Iterable[Any]) -> dict[Any, str]:
    """Return a name for each symbol that Maxima reads as one, all different; letters stay if they can.

    >>> names_for(sp.symbols("I_1 lambda"))
    {I_1: 'I_1', lambda: 'lambda0'}
    """
    found: dict[Any, str] = {}
    for symbol in sorted(symbols, key=str):
        name = "".join(c if c.isascii() and c.isalnum() else "_" for c in symbol.name)
        name = name if name[:1].isalpha() else f"x{name}"
        while name in RESERVED or name in found.values():
            name += "0"
        found[symbol] = name
    return found


def maxima(expression: Any, names: Mapping[Any, str]) -> str | None:
    """Return an expression as Maxima reads it, None where it holds an operation that is not known here."""
    for part in sp.preorder_traversal(expression):
        if not (part.is_Symbol or part.is_Rational or part == sp.pi or part.func in _KNOWN):
            return None
    spelt = {s: sp.Symbol(name) for s, name in names.items()} | {sp.pi: sp.Symbol("%pi")}
    text: str = sp.sstr(expression.xreplace(spelt)).replace(" ", "")
    return text.replace("**", "^").replace("Abs(", "abs(")


def as_data(made: Exercise) -> dict[str, Any]:
    """Return an exercise as data for JSON: its lines, its key, both pages; formulas are LaTeX.

    ``maxima``: the side with the slip as it is right, null where it is no scalar expression.
    """
    notation = made.letters
    typed = typed_answer(made)
    return {
        "topic": made.asked.lesson.topic,
        "title": made.right.title,
        "group": made.right.group,
        "seed": made.asked.seed,
        "notation": made.asked.notation,
        "lines": _numbered(made.wrong, made.asked.notation),
        "key": {
            "line": made.number,
            "slip": made.planted.slip.name,
            "words": made.planted.slip.words,
            "difficulty": made.planted.slip.kind.difficulty,
            "sentence": made.planted.slip.kind.sentence,
            "carried": [number for number, _ in made.carried],
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


def _numbered(lines: Derived, notation: str) -> list[dict[str, Any]]:
    chosen = notation_of(lines, notation_named(notation))
    return [
        {
            "number": number,
            "reason": sentence(block.notes[0].reason, lambda b: render(b, "text")),
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
