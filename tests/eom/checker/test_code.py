"""Code for the rates of systems: right code is right, a slip is named by its term."""

import random

import pytest
import sympy as sp

from eom.checker.code.comparison import Numbers, argument_names, compare, points
from eom.checker.mean.model import BUILTIN, load_model, model_of
from eom.errors import InputError
from eom.scenes import catalogue
from tests.eom.checker.system_lines import is_same, slips
from tests.eom.rows import only
from tests.eom.test_solutions import cart

SYSTEMS = [*catalogue.single(), *BUILTIN]
WORDS = {
    "sign": ("wrong sign",),
    "factor": ("2 times",),
    "half": ("1/2 times",),
    "dropped": ("missing term",),
    "sine": ("instead of",),
    "index": ("instead of", "missing term", "sign", "times", "too much"),
}


def called(model, rates, at):
    """What code in doubles gives for some rates: SymPy's own functions of Python's floats."""
    system = model.system
    symbols = [q.symbol for q in (*system.states, *system.parameters, *system.inputs)]
    own = [system.expand(r) for r in rates]
    matrix = None if system.mass_matrix is None else system.mass_matrix.applyfunc(system.expand)
    left = own if matrix is None else list(matrix.LUsolve(sp.Matrix(own)))
    function = sp.lambdify([system.time, symbols], left, "math")
    return [function(p.time, (*p.states, *p.parameters)) for p in at]


@pytest.mark.parametrize("name", only(SYSTEMS, "t-handle", "spinner", "gyrostat"))
def test_right_code_is_right(name):
    model = load_model(name)
    at = points(model)
    report = compare(model, at, called(model, model.system.rates, at))
    assert report.is_right
    assert report.digits > 13


@pytest.mark.parametrize("name", only(["lecture-wheel", "heavy-top", "t-handle"], "t-handle"))
def test_a_slip_is_found_in_its_output_and_named(name):
    model = load_model(name)
    at = points(model)
    generator = random.Random(name)
    rates = list(model.system.rates)
    count, named, unnamed = 0, 0, []
    for k, rate in enumerate(rates):
        if rate == 0 or model.system.mass_matrix is not None:
            continue
        for kind, _, changed in slips(rate, generator, 3):
            report = compare(model, at, called(model, [*rates[:k], changed, *rates[k + 1 :]], at))
            assert report.is_right == is_same(model, rate, changed), (kind, changed)
            if report.is_right:
                continue
            assert {m.output for m in report.mistakes} == {k}
            count += 1
            words = report.mistakes[0].text
            if any(t in words for t in WORDS[kind]):
                named += 1
            else:
                unnamed.append((kind, str(changed), words))
    assert named >= 0.9 * count, unnamed


def test_slips_in_reading_the_arguments():
    model = load_model("heavy-body", attitude="3-1-3")
    at = points(model)
    s = model.system
    right = called(model, s.rates, at)
    exchanged = [[row[1], row[0], *row[2:]] for row in right]
    (mistake,) = compare(model, at, exchanged).mistakes
    assert mistake.kind == "outputs exchanged"
    I1, I3 = model.symbol("I1"), model.symbol("I3")
    rates = [s.expand(r).xreplace({I1: I3, I3: I1}) for r in s.rates]
    (mistake,) = compare(model, at, called(model, rates, at)).mistakes
    assert mistake.text == "arguments exchanged: I1 and I3"
    degrees = {q.symbol: q.symbol * sp.pi / 180 for q in s.states if q.unit == "rad"}
    rates = [s.expand(r).xreplace(degrees) for r in s.rates]
    (mistake,) = compare(model, at, called(model, rates, at)).mistakes
    assert mistake.kind == "units of angles"


def test_two_slips_in_one_output():
    model = load_model("heavy-body")
    at = points(model)
    rates = list(model.system.rates)
    first, second = sp.Add.make_args(sp.expand(rates[0]))[:2]
    rates[0] = rates[0] - 2 * first - second
    (mistake,) = compare(model, at, called(model, rates, at)).mistakes
    assert mistake.kind == "two slips"
    assert str(first) in mistake.text
    assert "missing term" in mistake.text


def test_what_no_term_explains_is_said_to_be_so():
    model = load_model("t-handle")
    at = points(model)
    rows = called(model, model.system.rates, at)
    strange = [[row[0] + 0.01 * k * k, *row[1:]] for k, row in enumerate(rows)]
    (mistake,) = compare(model, at, strange).mistakes
    assert mistake.kind == "unexplained"
    (mistake,) = compare(model, at, [[float("nan"), *row[1:]] for row in rows]).mistakes
    assert mistake.kind == "not a number"
    with pytest.raises(InputError, match="number of rates"):
        compare(model, at, [row[:2] for row in rows])


def test_code_in_single_precision_is_right_and_its_digits_are_reported():
    numpy = pytest.importorskip("numpy")
    model = load_model("t-handle")
    at = points(model)
    rows = [[float(numpy.float32(v)) for v in row] for row in called(model, model.system.rates, at)]
    report = compare(model, at, rows)
    assert report.is_right
    assert 6 < report.digits < 9


def test_points_satisfy_what_is_assumed():
    model = load_model("heavy-top")
    states, parameters = argument_names(model.system)
    assert states[3:] == ("q0", "q1", "q2", "q3")
    for p in points(model):
        assert sum(q * q for q in p.states[3:]) == pytest.approx(1)
        assert p.parameters[parameters.index("I1")] == p.parameters[parameters.index("I2")]
    with pytest.raises(InputError, match="without a value"):
        Numbers({}).value(sp.Function("f")(sp.Integer(1)))


def test_a_system_with_a_mass_matrix():
    system, *_ = cart()
    model = model_of(system)
    at = points(model)
    right = called(model, system.rates, at)
    assert compare(model, at, right).is_right
    wrong = [[*row[:3], -row[3]] for row in right]
    (mistake,) = compare(model, at, wrong).mistakes
    assert mistake.text == "output 3 has the wrong sign"
    assert compare(model, at, [[row[0], row[1], row[3], row[2]] for row in right]).mistakes
