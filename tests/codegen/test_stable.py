"""Identities against cancellation: equal in exact arithmetic, better in doubles, and mutants caught."""

import math
import pickle
from dataclasses import replace

import mpmath
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen import compile as compile_system
from codegen.frontend.lower import lower_expressions
from codegen.frontend.structure import Structure
from codegen.ir.interpret import Point, interpret, interpret_exactly
from codegen.ir.program import Builder
from codegen.passes.pipeline import as_written
from codegen.passes.stable import EVERY, IDENTITIES, RANGE, rewritten, rewritten_freely
from eom import load_scene
from eom.system import System
from tests.codegen.scenes import SCENES

x, y, a, b, c = VARIABLES = sp.symbols("x y a b c", real=True)
DIGITS = 120
SAME = mpmath.mpf(10) ** -60


def norm(b, x, y):
    return b.add("sqrt", b.add("add", b.add("mul", x, x), b.add("mul", y, y)))


EXAMPLES = {
    "1 - cos x = 2 sin^2(x/2)": (1 - sp.cos(x), [1e-7]),
    "cosh x - 1 = 2 sinh^2(x/2)": (sp.cosh(x) - 1, [1e-7]),
    "cos^2 x - sin^2 x = cos 2x": (sp.cos(x) ** 2 - sp.sin(x) ** 2, [math.pi / 4]),
    "1 - sin^2 x = cos^2 x": (1 - sp.sin(x) ** 2, [1.5707963]),
    "1 - cos^2 x = sin^2 x": (1 - sp.cos(x) ** 2, [1e-7]),
    "cosh^2 x - 1 = sinh^2 x": (sp.cosh(x) ** 2 - 1, [1e-7]),
    "1 - tanh^2 x = 1/cosh^2 x": (1 - sp.tanh(x) ** 2, [15.0]),
    "cos x - cos y = -2 sin((x + y)/2) sin((x - y)/2)": (sp.cos(x) - sp.cos(y), [1.0, 1.0 + 1e-9]),
    "sin x - sin y = 2 cos((x + y)/2) sin((x - y)/2)": (sp.sin(x) - sp.sin(y), [1.0, 1.0 + 1e-9]),
    "cosh x - cosh y = 2 sinh((x + y)/2) sinh((x - y)/2)": (sp.cosh(x) - sp.cosh(y), [1.0, 1.0 + 1e-9]),
    "sinh x - sinh y = 2 cosh((x + y)/2) sinh((x - y)/2)": (sp.sinh(x) - sp.sinh(y), [1.0, 1.0 + 1e-9]),
    "atan x - atan y = atan2(x - y, 1 + x y)": (sp.atan(x) - sp.atan(y), [1.0, 1.0 + 1e-9]),
    "x - sin x = x^3 c_3(x^2), c_3 of Stumpff": (lambda b, x, y: b.add("sub", x, b.add("sin", x)), [1e-4]),
    "exp x - 1 = expm1 x": (lambda b, x, y: b.add("sub", b.add("exp", x), b.const(1)), [1e-9]),
    "sqrt x - sqrt y = (x - y)/(sqrt x + sqrt y)": (sp.sqrt(x + 1) - sp.sqrt(x), [1e12]),
    "sqrt x - y = (x - y^2)/(sqrt x + y) for y > 0": (sp.sqrt(x**2 + y) - x, [1e6, 1.0]),
    "sqrt x + y = (x - y^2)/(sqrt x - y) for y < 0": (sp.sqrt(x**2 + y) + x, [-1e6, 1.0]),
    "1/sqrt x - 1/sqrt y = (y - x)/(sqrt x sqrt y (sqrt x + sqrt y))": (1 / sp.sqrt(1 + x) - 1, [1e-9]),
    "1/x - 1/y = (y - x)/(x y)": (1 / x - 1 / (x + 1), [1e9]),
    "x^2 - y^2 = (x - y)(x + y)": (x**2 - y**2, [1.0, 1.0 + 1e-9]),
    "acos(1 - x) = 2 asin sqrt(x/2)": (sp.acos(1 - x), [1.1e-12]),
    "acosh(1 + x) = 2 asinh sqrt(x/2)": (sp.acosh(1 + x), [1.1e-12]),
    "log(1 + x) = log1p x": (lambda b, x, y: b.add("log", b.add("add", x, b.const(1))), [1.1e-12]),
    "sqrt(x^2 + y^2) = hypot(x, y)": (norm, [1e200, 1e199]),
}  # fmt: skip
OTHERS = ([0.3, 0.7], [1.9, 0.2], [0.01, 1.5])
"""Points at which the forms are equal, too; in the domain of every example."""


def program_of(*expressions):
    """A program of expressions, or of one value that is built from x and y as it stands."""
    if not callable(expressions[0]):
        return lower_expressions({"f": expressions}, VARIABLES)
    builder = Builder()
    slots = [builder.leaf("state", k) for k in range(2)]
    return builder.program({"f": [expressions[0](builder, *slots)]})


def versine_over_square(b, x, _):
    return b.add("div", b.add("sub", b.const(1), b.add("cos", x)), b.add("mul", x, x))


def at(values):
    return Point(x=[*values, *[0.0] * (len(VARIABLES) - len(values))])


def equal(first, second, points):
    """The law: the same values, to 60 digits, wherever the first program has one."""
    compared = 0
    for point in points:
        pairs = zip(
            interpret_exactly(first, point, DIGITS)["f"],
            interpret_exactly(second, point, DIGITS)["f"],
            strict=True,
        )
        for p, q in pairs:
            if mpmath.isfinite(p):
                compared += 1
                if not abs(p - q) <= SAME * abs(p):
                    return False
    assert compared
    return True


def error(program, point):
    """Relative error of doubles."""
    (exact,) = interpret_exactly(program, point, DIGITS)["f"]
    (double,) = interpret(program, point)["f"]
    return float(abs(exact - double) / abs(exact)) if math.isfinite(double) else math.inf


def test_every_identity_has_an_example():
    assert {i.text for i in EVERY} <= set(EXAMPLES)
    assert len({i.text for i in EVERY}) == len(EVERY)


@pytest.mark.parametrize("identity", EVERY, ids=lambda i: i.text)
def test_identity_holds_to_60_digits_and_gains_in_doubles(identity):
    expression, hard = EXAMPLES[identity.text]
    before = program_of(expression)
    form = rewritten(before, [identity])
    assert [a.identity for a in form.applied] == [identity.text]
    assert equal(before, form.program, [at(v) for v in (hard, *OTHERS)])
    assert error(before, at(hard)) > 1e3 * error(form.program, at(hard))
    assert error(form.program, at(hard)) < 1e-15


class Flipped:
    """A builder in which one addition that a rule makes has the other sign, or the last value."""

    def __init__(self, b, chosen):
        self.b, self.chosen, self.calls = b, chosen, 0
        self.instructions, self.find, self.const = b.instructions, b.find, b.const

    def add(self, op, *args):
        if op in {"add", "sub"}:
            self.calls += 1
            if self.calls == self.chosen:
                op = "sub" if op == "add" else "add"
        return self.b.add(op, *args)


def mutants(identity):
    """The rule with each of its signs flipped in turn: of an addition, or of the whole."""
    counted = []

    def count(b, args):
        proxy = Flipped(b, 0)
        found = identity.rule(proxy, args)
        counted.append(proxy.calls if found is not None else 0)
        return found

    rewritten(program_of(EXAMPLES[identity.text][0]), [replace(identity, rule=count)])
    for chosen in range(1, max(counted) + 1):
        yield replace(identity, rule=lambda b, args, k=chosen: identity.rule(Flipped(b, k), args))

    def negative(b, args):
        found = identity.rule(b, args)
        return None if found is None else b.add("neg", found)

    yield replace(identity, rule=negative)


@pytest.mark.parametrize("identity", EVERY, ids=lambda i: i.text)
def test_a_rule_with_a_flipped_sign_breaks_the_law(identity):
    expression, hard = EXAMPLES[identity.text]
    before = program_of(expression)
    points = [at(v) for v in (hard, *OTHERS)]
    found = list(mutants(identity))
    assert found
    for mutant in found:
        form = rewritten(before, [mutant])
        assert form.applied
        assert not equal(before, form.program, points)


DEEPER = {
    "behind a factor": (a - a * sp.cos(x), [1e-7, 0, 3.0], 1),
    "behind two factors": (a * b * sp.cos(x) - a * b * sp.cos(y), [1.0, 1 + 1e-9, 3.0, 5.0], 1),
    "behind a number": (3 - 3 * sp.cos(x), [1e-7], 1),
    "turned around": (sp.cos(x) - 1, [1e-7], 1),
    "in a longer sum": (y - sp.cos(x) + 1 - b, [1e-7, 1e-14, 0, 0], 1),
    "with a shift that cancels": (sp.cos(x + y) - sp.cos(x), [1.0, 1e-9], 1),
    "below a quotient": (versine_over_square, [1e-7], 1),
    "two at once": ((1 - sp.cos(x)) * (sp.cosh(y) - 1), [1e-7, 1e-7], 2),
    "quadratic, b > 0": ((-b + sp.sqrt(b**2 - 4 * a * c)) / (2 * a), [0, 0, 1.0, 1e8, 1.0], 1),
    "quadratic, b < 0": ((-b - sp.sqrt(b**2 - 4 * a * c)) / (2 * a), [0, 0, 1.0, -1e8, 1.0], 1),
}


@pytest.mark.parametrize("name", DEEPER)
def test_patterns_are_found_inside_larger_expressions(name):
    expression, hard, count = DEEPER[name]
    before = program_of(expression)
    form = rewritten(before)
    assert len(form.applied) == count
    points = [at(v) for v in (hard, [0.3, 0.7, 1.1, 2.9, 0.4], [0.3, 0.7, 1.1, -2.9, 0.4])]
    assert equal(before, form.program, points)
    assert error(before, at(hard)) > 1e-9
    assert error(form.program, at(hard)) < 2e-15


def one_with_square(op, sign):
    def make(b, x, y):
        d = b.add("sub", x, y)
        return b.add(op, b.add(sign, b.const(1), b.add("mul", d, d)))

    return make


@pytest.mark.parametrize(("op", "sign"), [("acos", "sub"), ("log", "add")])
def test_squares_of_differences_are_not_multiplied_out(op, sign):
    """Multiplied out, x^2 - 2 x y + y^2 cancels where (x - y)^2 does not."""
    form = rewritten(program_of(one_with_square(op, sign)))
    known = op in {i.op for i in IDENTITIES}  # log1p is an operation of its own
    assert bool(form.applied) == known
    if known:
        assert error(form.program, at([1.0, 1.0 + 1e-9])) < 1e-15


def test_like_terms_cancel_however_they_are_written():
    """As derivatives of attitude rates hold them: 2 q (n p) - (2 n) (p q), which is zero."""

    def make(b, x, y):
        p, n = b.add("sin", x), b.add("cos", y)
        two = b.const(2)
        first = b.add("mul", two, b.add("mul", x, b.add("mul", n, p)))
        second = b.add("mul", b.add("mul", two, n), b.add("mul", p, x))
        return b.add("add", b.add("sub", b.add("mul", x, y), first), second)

    before = program_of(make)
    for form in (rewritten(before), rewritten_freely(before)):
        assert form.program.counts() == {"mul": 1}
        assert equal(before, form.program, [at(v) for v in OTHERS])


def test_products_of_small_differences_are_not_multiplied_out():
    before = program_of((x - y) * (x - c) - x * (x - a))
    close = at([1.0, 1.0 + 1e-9, 1.0 - 1e-9, 0, 5e6])
    assert error(rewritten(before).program, close) < 1e-14
    assert equal(before, rewritten(before).program, [close])


ATOMS = (
    sp.Integer(1), sp.cos(x), sp.cos(y), sp.sin(x), sp.sin(y), sp.cos(x) ** 2, sp.sin(x) ** 2, x**2,
    y**2, sp.sqrt(x + 1), sp.sqrt(x), sp.sqrt(x**2 + y), x, 1 / x, 1 / (x + 1), 1 / sp.sqrt(x + 1),
    sp.cosh(x), sp.cosh(y), sp.tanh(x) ** 2, sp.atan(x), sp.atan(y), sp.exp(x), a * sp.cos(x), a,
    a * sp.cosh(x), a * x**2,
)  # fmt: skip
sums = st.lists(
    st.tuples(st.sampled_from(ATOMS), st.sampled_from([1, -1, 1, -1, 2, -3])),
    min_size=2,
    max_size=6,
).map(lambda terms: sp.Add(*(k * e for e, k in terms)))
AROUND = (lambda e: e, sp.sin, lambda e: a * e, sp.exp, lambda e: e**2)
wrapped = st.tuples(st.sampled_from(AROUND), sums).map(lambda pair: pair[0](pair[1]))


@settings(max_examples=60)
@given(
    st.lists(wrapped, min_size=1, max_size=3),
    st.floats(0.1, 2),
    st.floats(0.1, 2),
    st.floats(-2, 2),
)
def test_laws_on_random_sums(expressions, vx, vy, va):
    before = program_of(*expressions)
    point = at([vx, vy, va])
    expected = interpret_exactly(before, point, DIGITS)["f"]
    for form in (rewritten(before), rewritten_freely(before)):
        for p, q in zip(expected, interpret_exactly(form.program, point, DIGITS)["f"], strict=True):
            assert abs(p - q) <= mpmath.mpf(10) ** -90
    free = rewritten_freely(before)
    assert free.program.cost() <= before.cost()
    assert str(rewritten(before).program) == str(rewritten(before).program)


def test_free_rewriting_takes_what_costs_nothing_and_leaves_the_rest():
    squares, versine = x**2 - y**2, 1 - sp.cos(x)
    assert rewritten_freely(program_of(squares)).applied
    assert not rewritten_freely(program_of(squares, x**2, y**2)).applied
    assert not rewritten_freely(program_of(versine)).applied
    assert rewritten_freely(program_of(sp.sin(x / 2), versine)).applied
    assert not rewritten_freely(program_of(sp.sin(x / 2), versine, sp.cos(x) ** 2)).applied


def test_programs_without_patterns_are_left_alone():
    before = program_of(x * y + a, x + sp.cos(y), x**2 + y**2 - a)
    assert rewritten(before, IDENTITIES).program is before
    assert rewritten(before, RANGE).applied == ()


def test_names_stay_with_their_values():
    system = System.from_rates("named", {x: y, y: -x}, outputs={"versine": 1 - sp.cos(x)})
    program = rewritten(as_written(system, Structure.of(system))[0]).program
    assert {n.name for n in program.names.values()} == {"versine"}


@pytest.mark.sparse(2)
@pytest.mark.parametrize("name", SCENES)
def test_ready_scenes_never_cost_more(name):
    system = load_scene(name).derive()
    before, _ = as_written(system, Structure.of(system))
    assert rewritten_freely(before).program.cost() <= before.cost()


def test_compiling_in_stable_form(target):
    system = System.from_rates("roots", {x: sp.sqrt(x + 1) - sp.sqrt(x)})
    plain, stable = (compile_system(system, target, stable=s) for s in (False, True))
    exact = float(1 / (mpmath.sqrt(mpmath.mpf(10) ** 15 + 1) + mpmath.sqrt(mpmath.mpf(10) ** 15)))
    assert plain.rhs(0, [1e15])[0] != pytest.approx(exact, rel=1e-3)
    assert stable.rhs(0, [1e15])[0] == pytest.approx(exact, rel=1e-15)
    assert pickle.loads(pickle.dumps(stable)).stable
