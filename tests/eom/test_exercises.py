"""Exercises: one line is false and no other, the key is right, the same bytes, readable questions."""

import ast
import operator
import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import eom
from eom import derivations
from eom.derivations import derive
from eom.derivations.small_numbers import Judge
from eom.errors import InputError
from eom.exercises import (
    Exercise,
    exercise,
    lesson,
    lessons,
    making,
    marker,
    moodle,
    planted_in,
    solutions,
    student,
    topics,
    with_others,
)
from eom.exercises.moodle import RESERVED, maxima, names_for, typed_answer
from eom.exercises.slips import DIFFICULTIES, KINDS, LINE_SLIPS, SLIPS, around, names, planted
from eom.terms.terms import Equation, expr
from eom.typeset.notation import NOTATIONS
from tests.eom.rows import every, only

FAULTS = {"wrong", "ill-formed", "ambiguous"}
SHORT = ("point-mass", "tilde-identities", "inertia-of-rod")
LONG = {"inertia-of-frustum"}
"""Topics whose lines are quotients of long polynomials, and take the checker seconds."""
OWN = (
    "rocket-equation",
    "collisions",
    "virtual-work",
    "heavy-symmetric-top",
    "gravity-gradient-stability",
)
"""Topics whose chapters have laws of their own: judged where these hold, not by the checker."""


def displays(report):
    return [f for f in report.findings if f.kind == "display"]


@pytest.mark.parametrize(
    "topic",
    only((n for titles in topics().values() for n in titles if n not in {*LONG, *OWN}), *SHORT),
)
def test_the_checker_blames_the_planted_line_and_no_other(topic, monkeypatch):
    seen, check = [], making.checker.check

    def recorded(text):
        seen.append((text, check(text)))
        return seen[-1][1]

    monkeypatch.setattr(making.checker, "check", recorded)
    seed = len(topic)
    made = exercise(topic, seed, lines=2)
    text, report = seen[-1]
    assert text == student(made)
    blamed = [k for k, f in enumerate(displays(report), 1) if f.verdict in FAULTS]
    assert blamed == [made.number]
    assert not [f for f in report.findings if f.kind != "display" and f.verdict in FAULTS]
    assert len(displays(report)) == len(made.right.steps) <= 2
    assert making._is_small(made.finding)


@pytest.mark.parametrize(
    ("topic", "seed"),
    every(3, [("point-mass", 0), ("inertia-of-rod", 1), ("inertia-of-rod", 2)]),
)
def test_what_the_key_says_makes_the_page_right(topic, seed):
    made = exercise(topic, seed, lines=2)
    assert [f.verdict in FAULTS for f in displays(eom.check(student(made)))].count(True) == 1
    mended = replace(made, planted=replace(made.planted, equation=made.step.statement))
    assert eom.check(student(mended)).faults == ()
    assert made.planted.slip.words in marker(made)
    assert f"Line ({made.number}) is false" in marker(made)
    for latex, value in made.counterexample.members:
        assert latex in marker(made)
        assert value in marker(made)


@pytest.mark.slow
@pytest.mark.parametrize("notation", only((n for n in NOTATIONS if n != "arrow"), "kane"))
def test_every_notation(notation):
    made = exercise("point-mass", 1, notation=notation, lines=2)
    found = [k for k, f in enumerate(displays(eom.check(student(made))), 1) if f.verdict in FAULTS]
    assert found == [made.number]


def test_other_lines_are_those_of_the_derivation():
    made = exercise("euler-equations", 3)
    lines = zip(made.right.steps, made.wrong.steps, strict=True)
    changed = [k for k, (a, b) in enumerate(lines, 1) if a != b]
    assert changed == [made.number]
    assert set(made.right.steps) <= set(derivations.derive("euler-equations").steps)


def test_the_page_gives_the_meanings_that_its_lines_use_and_no_others():
    """The symbols of these meanings are given, too."""
    whole = lesson("energy-dissipation").derivation
    lines = tuple(whole[label] for label in ("hurwitz", "sink-effective"))
    used = lessons.only_scalars_of(replace(whole, steps=lines)).scalars
    assert {str(s) for s in used} == {*"p_0 p_1 p_2 p_3 p_4 I_e_dot T_dot T P J_s c".split()}
    one = lessons.only_scalars_of(replace(whole, steps=lines[:1])).scalars
    assert "I_e_dot" not in map(str, one)
    x, y, z = sp.symbols("x y z")
    step = replace(lines[0], statement=Equation(expr(x), expr(x)))
    scalars = {z: expr(x), y: expr(sp.Integer(1)), x: expr(y)}
    own = lessons.only_scalars_of(replace(whole, steps=(step,), scalars=scalars)).scalars
    assert {*own} == {x, y}


TOPICS_OF_ALL = (
    "point-mass", "tilde-identities", "transport-theorem", "spinning-symmetric-body",
    "inertia-properties", "inertia-of-rod",
)  # fmt: skip
"""Topics in which every kind of slip can be made."""


def candidates(topic, **options):
    return making._candidates(lessons.Asked(lesson(topic), **options))


def test_every_kind_of_slip_can_be_planted_somewhere():
    found = {name for topic in TOPICS_OF_ALL for name, _, _ in candidates(topic)}
    assert found == set(names()) == {s.name for s in (*SLIPS, *LINE_SLIPS)} == set(KINDS)


def test_a_difficulty_has_its_own_kinds_of_slips_alone():
    kinds = {
        d: {n for t in TOPICS_OF_ALL for n, _, _ in candidates(t, difficulty=d)}
        for d in DIFFICULTIES
    }
    assert all(kinds.values())
    assert set().union(*kinds.values()) == set(names())
    assert sum(map(len, kinds.values())) == len(names())
    with pytest.raises(InputError, match="did you mean hard"):
        exercise("point-mass", difficulty="hrad")
    with pytest.raises(InputError, match="a slip of the kind frame is hard"):
        exercise("point-mass", difficulty="easy", slip="frame")


def test_no_slip_stands_in_a_tautology():
    about = lesson("point-mass")
    x, y = sp.symbols("x y")
    idle = replace(
        about.derivation.steps[0], statement=Equation(expr(x * (x + y)), expr(x**2 + x * y))
    )
    useful = replace(idle, statement=Equation(expr(y), expr(x**2 + x)))
    assert making.is_tautology(idle)
    assert not making.is_tautology(useful)
    lines = replace(about, derivation=replace(about.derivation, steps=(idle, useful)))
    places = {k for _, k, _ in making._candidates(lessons.Asked(lines))}
    assert places == {1}


SLIPPED = {
    ("spinning-symmetric-body", "omega"): "angular_velocity",
    ("transport-theorem", "frame"): "der",
    ("particle-system", "point"): "atom",
    ("spinning-symmetric-body", "constant"): "_dot",
    ("inertia-of-cone", "axes"): "I_",
    ("spinning-symmetric-body", "function"): "theta",
    ("inertia-properties", "rotations"): "rotation",
    ("spinning-symmetric-body", "conserved"): "der",
}
"""What students do, and what of a line it touches."""


@pytest.mark.parametrize(
    ("topic", "slip"),
    only(SLIPPED, ("inertia-properties", "rotations"), ("inertia-of-cone", "axes")),
)
def test_slips_of_students_are_proved_false_and_the_other_lines_true(topic, slip):
    made = exercise(topic, 1, slip=slip, lines=4)
    report = eom.check(student(made))
    verdicts = [f.verdict in FAULTS for f in displays(report)]
    assert [k for k, wrong in enumerate(verdicts, 1) if wrong] == [made.number]
    assert made.planted.slip.name == slip
    part = str(made.planted.right)
    assert SLIPPED[topic, slip] in part or SLIPPED[topic, slip] in repr(made.planted.right)
    assert made.planted.slip.kind.sentence in marker(made)


def test_the_conserved_quantity_is_not_the_spin_rate():
    """The lecture's: Omega + psi' sin(theta) is constant, and Omega is not."""
    made = {p.equation.left for n, _, p in candidates("spinning-symmetric-body", slip="conserved")}
    assert {str(t.args[0].data[0]) for t in made if t.args[0].head == "expr"} >= {"Omega"}


@pytest.mark.slow
def test_a_slip_is_carried_on_for_three_lines():
    made = exercise("euler-equations", 0, slip="sign", lines=8, carried=3)
    report = eom.check(student(made))
    found = [f for f in displays(report) if f.verdict in FAULTS]
    slipped, *behind = found
    assert [f.carried for f in behind] == [slipped.line] * 3
    assert [n for n, _ in made.carried] == [
        k for k, f in enumerate(displays(report), 1) if f in behind
    ]
    key = marker(made)
    assert "no mark is to be taken off" in key
    assert "carry it on" in student(made)
    assert "Carried on, without another mistake" in solutions([made])


def test_a_slip_that_is_carried_on_once():
    made = exercise("euler-equations", 1, lines=8, carried=1)
    ((number, planted_),) = made.carried
    assert number > made.number
    assert planted_.slip == made.planted.slip
    mended = replace(
        made,
        planted=replace(made.planted, equation=made.step.statement),
        carried=((number, replace(planted_, equation=made.right.steps[number - 1].statement)),),
    )
    assert mended.wrong == mended.right
    for carried in (-1, 4):
        with pytest.raises(InputError, match="0 to 3"):
            exercise("euler-equations", carried=carried)
    with pytest.raises(InputError, match="0 to 1, of 2 lines"):
        exercise("euler-equations", carried=2, lines=2)


def test_numbers_that_show_a_slip_are_small_fractions():
    for topic, seed in (("point-mass", 1), ("inertia-of-rod", 2), ("tilde-identities", 3)):
        found = exercise(topic, seed, lines=2).counterexample
        texts = [v for pairs in (found.values, found.members) for _, v in pairs]
        assert texts
        assert all(int(n) <= making.SMALL for t in texts for n in re.findall(r"\d+", t))


def test_a_sheet_of_solutions():
    made = [exercise("inertia-of-rod", seed, lines=3) for seed in (1, 2)]
    sheet = solutions(made)
    assert sheet.count("## ") == 2
    for one in made:
        assert f"Line ({one.number}): {one.planted.slip.words}." in sheet
        assert one.planted.slip.kind.sentence in sheet
    with pytest.raises(InputError, match="no exercises"):
        solutions([])


def test_a_slip_changes_one_side_and_keeps_its_kind():
    steps = derivations.derive("rigid-body-momentum").steps
    given_ = around(t for s in steps for t in (s.statement.left, s.statement.right))
    count = 0
    for step in steps:
        old = step.statement
        for made in planted(old, given_):
            new = made.equation
            assert (new.left == old.left) != (new.right == old.right)
            assert (new.left.kind, new.right.kind) == (old.left.kind, old.right.kind)
            assert made.right != made.wrong
            count += 1
    assert count > 100


SCRIPT = """
import sys
from eom.exercises import *
made = exercise(sys.argv[1], 2, lines=2)
print(student(made), marker(made), moodle([made]))
"""


@pytest.mark.slow
@pytest.mark.parametrize("topic", ["kinetic-energy", "inertia-of-rod"])
def test_the_same_bytes_whatever_the_seed_of_hashes(topic):
    """Here, and in a process with another one."""
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT, topic],
        env={**os.environ, "PYTHONHASHSEED": "1"},
        capture_output=True,
        check=True,
        timeout=120,
    )
    made = exercise(topic, 2, lines=2)
    assert run.stdout == f"{student(made)} {marker(made)} {moodle([made])}\n".encode()
    assert len(run.stdout) > 5_000


def test_names_that_are_unknown_and_slips_that_cannot_be():
    with pytest.raises(InputError, match="point-mass"):
        exercise("point-mas")
    with pytest.raises(InputError, match="did you mean sign"):
        exercise("point-mass", slip="sgn")
    with pytest.raises(InputError, match="no line of this topic can have the slip transpose"):
        exercise("point-mass", slip="transpose")
    with pytest.raises(InputError, match="2 to 40"):
        exercise("point-mass", lines=1)
    with pytest.raises(InputError, match="notation"):
        exercise("point-mass", notation="arow")


def test_a_topic_without_lines_says_so():
    about = lesson("inertia-of-rod")
    empty = replace(about, derivation=replace(about.derivation, steps=()))
    with pytest.raises(InputError, match="no slip was found in this topic"):
        planted_in(empty)
    with pytest.raises(InputError, match="another topic"):
        planted_in(empty, slip="sign")


# -- Maxima ------------------------------------------------------------------------------------------

SYMBOLS = sp.symbols("x omega_1 lambda I_2")
LETTERS = st.sampled_from(SYMBOLS)
EXPRESSIONS = st.recursive(
    LETTERS | st.fractions(-5, 5, max_denominator=7).map(sp.Rational),
    lambda inner: (
        st.tuples(inner, inner).map(lambda p: p[0] + p[1])
        | st.tuples(inner, inner).map(lambda p: p[0] * p[1])
        | st.tuples(inner, LETTERS).map(lambda p: p[0] / (p[1] + 7))
        | st.tuples(inner, st.integers(-3, 3)).map(lambda p: (p[0] + SYMBOLS[0] + 11) ** p[1])
    ),
    max_leaves=8,
)
OPERATIONS = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow, ast.USub: operator.neg,
}  # fmt: skip


def value(node, at):
    if isinstance(node, ast.Constant):
        return Fraction(node.value)
    if isinstance(node, ast.Name):
        return at[node.id]
    operation = OPERATIONS[type(node.op)]
    if isinstance(node, ast.UnaryOp):
        return operation(value(node.operand, at))
    return operation(value(node.left, at), value(node.right, at))


@given(EXPRESSIONS)
def test_maxima_reads_the_same_value(expression):
    """Maxima binds + - * / ^ and the sign as Python does, so Python's grammar is the reader."""
    spelt = names_for(SYMBOLS)
    at = dict(
        zip(SYMBOLS, (Fraction(2, 3), Fraction(5), Fraction(1, 7), Fraction(13)), strict=True)
    )
    text = maxima(expression, spelt)
    read = ast.parse(text.replace("^", "**"), mode="eval").body
    wanted = expression.xreplace({s: sp.Rational(v) for s, v in at.items()})
    assert value(read, {spelt[s]: v for s, v in at.items()}) == Fraction(str(wanted))


def test_names_for_maxima():
    found = names_for(sp.symbols("e lambda pi R_i Omega_sk a&b"))
    assert len(set(found.values())) == 6
    assert not RESERVED & set(found.values())
    assert all(n.replace("_", "").isalnum() and n[0].isalpha() for n in found.values())
    x = sp.Symbol("x")
    assert maxima(sp.sqrt(x) * sp.sin(x) / 2, {x: "x"}) == "sqrt(x)*sin(x)/2"
    assert maxima(sp.pi * x, {x: "x"}) == "%pi*x"
    assert maxima(sp.Integral(x, (x, 0, 1)), {x: "x"}) is None
    assert maxima(sp.Function("f")(x), {x: "x"}) is None


@pytest.mark.skipif(shutil.which("maxima") is None, reason="Maxima is not installed")
def test_maxima_itself_reads_the_answers():
    answers = [a for t in ("inertia-of-cone", "inertia-of-disc") for a in typed(t)]
    lines = [f"print(ratsimp(({a.right})-({a.wrong})))$" for a in answers]
    run = subprocess.run(
        ["maxima", "--very-quiet", f"--batch-string={' '.join(lines)}"],
        capture_output=True, text=True, timeout=60, check=True,
    )  # fmt: skip
    assert len(answers) >= 2
    assert "incorrect syntax" not in run.stdout
    assert run.stdout.count("ratsimp") == len(answers)


def typed(topic):
    made = (exercise(topic, seed, lines=2) for seed in range(2))
    return [a for a in map(typed_answer, made) if a is not None]


# -- Moodle ------------------------------------------------------------------------------------------

HOSTILE = "]]> <script>alert(1)</script> & \x00 \ud800 [[input:x]] {@1@} ${x}$ \\(\n\"'"


@pytest.fixture(scope="module")
def scalar() -> Exercise:
    about = lesson("inertia-of-disc")
    named = replace(about, derivation=replace(about.derivation, title=HOSTILE))
    return with_others(planted_in(named, 1, lines=2, slip="square"), 3)


@pytest.fixture(scope="module")
def vectors() -> Exercise:
    return with_others(exercise("point-mass", 1, lines=2, slip="order"), 2)


def questions(*made):
    root = ET.fromstring(moodle(made))
    return {(q.get("type"), n): q for n, q in enumerate(root.iter("question"))}


def text(question, tag):
    return question.find(f"{tag}/text").text or ""


def test_questions_of_choice(vectors):
    found = questions(vectors)
    assert [kind for kind, _ in found] == ["category", "multichoice", "multichoice"]
    which, what = found["multichoice", 1], found["multichoice", 2]
    for question in (which, what):
        scores = [a.get("fraction") for a in question.iter("answer")]
        assert scores.count("100") == 1
        assert scores.count("0") == len(scores) - 1 >= 1
        assert question.findtext("single") == "true"
    right = [a.get("fraction") for a in which.iter("answer")].index("100")
    assert right == vectors.number - 1
    shown = [a.findtext("text") for a in what.iter("answer")]
    assert len(set(shown)) == len(shown)
    assert all(t.startswith(r"\(") and t.endswith(r"\)") for t in shown)
    lines = text(which, "questiontext")
    assert lines.count(r"\[") == lines.count(r"\]") == len(vectors.right.steps)
    assert "$" not in lines
    assert r"\times" in text(which, "generalfeedback")


def test_the_typed_question(scalar):
    found = questions(scalar)
    stack = next(q for (kind, _), q in found.items() if kind == "stack")
    answer = typed_answer(scalar)
    assert text(stack, "questionvariables") == f"ta1: {answer.right};"
    assert stack.findtext("input/tans") == "ta1" == stack.findtext("prt/node/tans")
    assert stack.findtext("prt/node/answertest") == "AlgEquiv"
    assert [t.findtext("testinput/value") for t in stack.iter("qtest")] == [
        answer.right,
        answer.wrong,
    ]
    assert [t.findtext("expected/expectedscore") for t in stack.iter("qtest")] == ["1", "0"]
    side = getattr(scalar.step.statement, answer.side)
    names_ = {name: symbol for symbol, name in answer.names.items()}
    values = {s: Fraction(k) for k, s in enumerate(names_, 2)}
    read = ast.parse(answer.right.replace("^", "**"), mode="eval").body
    wanted = side.data[0].xreplace({names_[n]: sp.Rational(v) for n, v in values.items()})
    assert value(read, values) == Fraction(str(wanted))


def test_hostile_titles(scalar):
    assert HOSTILE in scalar.right.title
    written = moodle([scalar])
    assert "<script>" not in written
    for (kind, _), question in questions(scalar).items():
        if kind == "category":
            continue
        name = text(question, "name")
        assert name.startswith("]]> <script>alert(1)</script> &")
        assert "\x00" not in name
        assert "\n" not in name
        asked = text(question, "questiontext")
        assert asked.count("[[") == (2 if kind == "stack" else 0)
        assert "<script>" not in asked
    assert student(scalar).count("\n# ") == 1


def test_what_stack_would_take_for_commands_is_put_apart():
    from eom.exercises.moodle import _apart

    assert _apart("[[a]] {@b@} {#c#} [[[") == "[ [a]] { @b@} { #c#} [ [["


def test_no_typed_question_for_vectors(vectors):
    assert typed_answer(vectors) is None
    assert vectors.planted.right.head != expr(1).head


def test_symbols_of_a_sheet_stand_in_its_lines_and_have_a_meaning():
    for lines in (4, 40):
        made = exercise("euler-equations", seed=3, lines=lines)
        shown, drawn = student(made, lexicon=False).split("## Lines")
        listed = [line[2:] for line in shown.splitlines() if line.startswith("- ")]
        assert not [line for line in listed if ": " not in line and "triangleq" not in line]
        scalars = [line for line in listed if "triangleq" in line]
        assert all(line[1:].split(" ")[0] in drawn for line in scalars)


@pytest.mark.sparse(2)
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("topic", OWN)
def test_chapters_with_laws_of_their_own_are_judged_where_these_hold(topic, seed):
    made = exercise(topic, seed=seed)
    derived = derive(topic)
    judge = Judge(derived.scalars, derived.own)
    step = made.step
    assert judge.refutes(made.planted.equation, step.assumptions)
    assert not judge.refutes(step.statement, step.assumptions)
    (_, a), (_, b) = made.counterexample.members
    assert a != b
    assert made.counterexample.values
    assert "should be equal" in marker(made)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("m*w_dot = -c*m_dot - m*g", "m*w_dot = -c*m_dot + m*g"),
        ("v_dot = -c*m_dot/m", "v_dot = -c*m_dot/m**2"),
        ("v = c*log(m_0/m) + v_0", "v = c*log(m/m_0) + v_0"),
    ],
)
def test_numbers_obey_the_laws_and_tell_the_false_line_from_the_right_one(right, wrong):
    derived = derive("rocket-equation")
    symbols = {s.name: s for s in derived.scalars}

    def line(words):
        sides = (expr(sp.parse_expr(side, symbols)) for side in words.split("="))
        return Equation(*sides)

    judge = Judge(derived.scalars, derived.own)
    assert judge.refutes(line(wrong), ())
    assert not judge.refutes(line(right), ())
    found = judge.numbers(line(wrong), line(right))
    if found is None:
        assert (
            "log" in wrong
        )  # what was integrated has no value by symbols, and logarithms none in a world
        return
    sides = line(wrong).left.expression, line(wrong).right.expression
    assert [(s.xreplace(found.values),) for s in sides] == list(found.sides)
    assert line(right).left.expression.xreplace(found.values) == line(
        right
    ).right.expression.xreplace(found.values)


def test_no_slip_is_carried_on_where_no_note_can_tell():
    with pytest.raises(InputError, match="cannot tell here"):
        exercise("collisions", carried=1)
