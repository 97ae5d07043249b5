"""Dimensions of formulas: what fits, what does not and which term, what follows from what."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import eom
from eom.dimensions import Dimensions, powers_of
from eom.errors import InputError
from eom.multibody import Body, Joint, Load, Spring, Tree
from eom.quantities import Definition, Quantity, Singularity
from eom.scenes import catalogue
from eom.system import System
from eom.units import dimension

m, g, l, x, v, k, c, theta, omega, t = sp.symbols("m g l x v k c theta omega t", real=True)
UNITS = {m: "kg", g: "m/s^2", l: "m", x: "m", v: "m/s", theta: "rad", omega: "rad/s", t: "s"}


def known(**units):
    own = {**UNITS, **{sp.Symbol(n, real=True): u for n, u in units.items()}}
    return Dimensions(own.items(), time=t)


FITS = [
    (m * g * l * sp.sin(theta), "N m"),
    (m * v**2 / 2 + m * g * x, "J"),
    (sp.sqrt(g / l), "rad/s"),
    (sp.sqrt(x**2 + l**2) - l, "m"),
    (sp.atan2(x, l) + theta, "rad"),
    (sp.Max(x, l, 0) - sp.Abs(x), "m"),
    (sp.exp(-x / l) * m * g, "N"),
    (k * x + m * g, "N"),
    (9.81 * m * sp.sin(theta), "N"),
    (x - 1, "m"),
    (sp.Integer(0), "N"),
    (sp.pi / 2 - theta, "rad"),
    (m * g * sp.sin(2 * t), "N"),
    (m * g * sp.Piecewise((1, x > l), (sp.cos(theta), True)), "N"),
    (m * v * omega + m * v**2 / l, "N"),
    ((x / l) ** sp.Rational(3, 2) * m * g, "N"),
    (m * g * sp.sign(v), "N"),
    ((1 + sp.sign(10 - t)) / 4, "N m"),
    (m * g - sp.sin(2 * t) * sp.exp(-t), "N"),
    (m * g * (1 + sp.sign(10 - t)) - sp.sin(3 * t) / 2, "N"),
    (sp.Max(m * g, sp.cos(t)), ""),
]
MISFITS = [
    (m * g * sp.sin(theta), "N m", "g*m*sin(theta), in kg m/s^2"),
    (m * v / 2, "J", "m*v/2, in kg m/s"),
    (m * v**2 / 2 + m * g, "J", "g*m, in kg m/s^2"),
    (m * g * sp.sin(x), "N", "x, in m"),
    (m * g * (x + v), "W", ", in m, in "),
    (2**x, "", "x, in m"),
    (x**theta, "", "x, in m"),
    (sp.Max(x, v), "", ", in m"),
    (sp.atan2(x, v), "", "in m/s"),
    (sp.log(m), "", "m, in kg"),
    (2 * x, "m/s^2", "2*x, in m"),
    (sp.Piecewise((x, x > l), (v, True)), "", "v, in m/s"),
    (m * g * t, "N", "in kg m/s"),
    (m * (1 + sp.sign(10 - t)), "N", ", in kg"),
    (m * g + 2 * t, "N", "2*t, in s"),
    (m * g - 2 * omega, "N", "2*omega, in 1/s"),
    (m * g * (x + sp.sin(theta)), "", "sin(theta), in 1"),
]


@pytest.mark.parametrize("case", FITS, ids=str)
def test_formulas_that_fit(case):
    formula, unit = case
    known().check(formula, "here", unit)


@pytest.mark.parametrize("case", MISFITS, ids=str)
def test_the_term_that_does_not_fit_is_named(case):
    formula, unit, words = case
    with pytest.raises(InputError, match="the dimension of a term does not fit") as caught:
        known().check(formula, "here", unit)
    assert words in caught.value.got
    assert caught.value.where == "here"


def test_what_follows_from_one_formula_holds_for_the_next():
    own = known()
    own.check(k * x + c * v, "force", "N")
    assert own.of(k) == {k: 1}  # as it stands; what it is comes out where it meets another
    own.check(k * l, "force", "N")
    with pytest.raises(InputError) as caught:
        own.check(c * x, "force", "N")
    assert caught.value.got.startswith("c*x, in kg m/s")


def test_nothing_follows_from_what_is_unknown():
    own = Dimensions([])
    own.check(k * x + c * v - m * sp.sin(g * l), "anything")
    own.check(k * x - c * v, "anything")
    own.check(k * l - m, "anything")
    own.check(k * x + c * v**2, "c v is k x, so that v is a number")
    with pytest.raises(InputError):
        Dimensions([(v, "m/s")]).check(k * x + c * v + k * x * v, "v would be a number")


units = st.sampled_from(["kg", "m", "s", "N", "N m", "rad/s", "kg m^2", "1"])


@settings(max_examples=60)
@given(
    st.lists(units, min_size=3, max_size=3), st.lists(st.integers(-3, 3), min_size=3, max_size=3)
)
def test_products_are_products_of_dimensions(own, powers):
    symbols = sp.symbols("a b c", real=True)
    formula = sp.Mul(*(s**p for s, p in zip(symbols, powers, strict=True)))
    expected = dimension("1")
    for unit, p in zip(own, powers, strict=True):
        expected = expected.times(dimension(unit).power(p))
    found = Dimensions(zip(symbols, own, strict=True))
    assert (found.of(formula) or {}) == powers_of(expected)
    found.check(formula + 2 * formula * sp.cos(formula / formula), "sum", expected.words)


@settings(max_examples=60)
@given(st.data())
def test_an_unknown_unit_is_that_which_makes_the_sum_fit(data):
    a, b, target = (data.draw(units) for _ in range(3))
    p = data.draw(st.integers(-3, 3).filter(bool))
    first, second, unknown = sp.symbols("a b u", real=True)
    own = Dimensions([(first, a), (second, b)])
    own.check(unknown**p * first + second, "sum")
    fitting = dimension(b).times(dimension(a).power(-1)).power(sp.Rational(1, p))
    own.check(unknown, "unknown", fitting.words)
    if dimension(target) != fitting:
        with pytest.raises(InputError):
            own.check(unknown, "unknown", target)


# -- systems --


FALL = -g / l * sp.sin(theta)


def pendulum(rate=FALL, **more):
    states = (Quantity(theta, "rad"), Quantity(omega, "rad/s"))
    parameters = (Quantity(g, "m/s^2"), Quantity(l, "m"), Quantity(m, "kg"), Quantity(k))
    return System("pendulum", states, (omega, rate), parameters, **more)


WRONG = {
    "rate": ({"rate": -g * sp.sin(theta)}, "rate of omega"),
    "output": ({"outputs": (Definition(Quantity(x, "N"), m * g * l),)}, "output x"),
    "invariant": ({"invariants": (Definition(Quantity(x, "J"), m * l * omega**2),)}, "invariant x"),
    "definition": ({"definitions": (Definition(Quantity(x, "m"), g * omega),)}, "definition x"),
    "use of a definition": (
        {"definitions": (Definition(Quantity(x), g * sp.sin(theta)),), "rate": -x},
        "rate of omega",
    ),
    "singularity": ({"singularities": (Singularity(theta - l, theta),)}, "singularity"),
    "mass matrix": (
        {"mass_matrix": sp.diag(1, m), "rate": -m * g * sp.sin(theta)},
        "rate of omega",
    ),
    "unit of a state": (
        {"rate": -g / l * theta, "outputs": (Definition(Quantity(x, "kg"), theta),)},
        "x",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_every_formula_of_a_system_is_checked(name):
    changed, where = WRONG[name]
    pendulum()
    with pytest.raises(InputError, match="the dimension of a term does not fit") as caught:
        pendulum(**changed)
    assert where in caught.value.where


def test_systems_that_fit():
    mass = sp.Matrix([[1, 0], [0, m * l**2]])
    pendulum(rate=-m * g * l * sp.sin(theta), mass_matrix=mass)
    pendulum(rate=-k * omega - 9.81 * sp.sin(theta))
    pendulum(definitions=(Definition(Quantity(x), g / l),), rate=-x * sp.sin(theta))


def test_a_system_without_units_of_time_may_have_time_without_one():
    states = (Quantity(x, "1"), Quantity(v, "1"))
    System("oscillator", states, (v, -x))
    with pytest.raises(InputError):
        System("oscillator", (Quantity(x, "m"), Quantity(v, "m")), (v, -x))


def test_units_of_variables_are_of_si():
    with pytest.raises(InputError, match="not a unit of SI") as caught:
        System("s", (Quantity(x, "mm"),), (sp.Float(1.0) * x,))
    assert caught.value.expected == "m"
    shown = Definition(Quantity(v, "deg"), 180 / sp.pi * theta)
    assert pendulum(outputs=(shown,)).outputs[0].quantity.unit == "deg"


def test_laws_of_control_are_checked():
    closed = {"T": -k * theta - c * omega}
    free = System(
        "wheel",
        (Quantity(theta, "rad"), Quantity(omega, "rad/s")),
        (omega, sp.Symbol("T", real=True) / l),
        (Quantity(l, "kg m^2"),),
        (Quantity(sp.Symbol("T", real=True), "N m"),),
    )
    for kind in ("counts", "values"):
        system = free if kind == "counts" else eom.System(**{**vars_of(free), "numbers": kind})
        gains = (Quantity(k, "N m/rad"), Quantity(c, "N m s"))
        assert system.with_control(closed, parameters=gains).parameter_names == ("l", "c", "k")
        assert system.with_control(closed).parameter_names == ("l", "c", "k")
        with pytest.raises(InputError, match="the dimension of a term"):
            system.with_control(closed, parameters=(Quantity(k, "N m s"), Quantity(c, "N m s")))


def vars_of(system):
    names = ("name", "states", "rates", "parameters", "inputs")
    return {n: getattr(system, n) for n in names}


# -- ready scenes --


@pytest.mark.parametrize("name", catalogue.names())
def test_ready_scenes_of_symbols_are_of_one_dimension_throughout(name):
    """What is derived over parameters with units alone fits, all of it: rates, outputs, constants.

    Numbers that a scene puts in for quantities have no unit there, and Gram determinants of constraints
    that turn and slide none at all.
    """
    scene = eom.load_scene(name)
    system = scene.full_system
    tree = scene.tree
    if tree is not None and (tree.constraints or tree.numbers == "decimals"):
        pytest.skip("numbers that stand for quantities, or constraints")
    fields = {f: getattr(system, f) for f in system.__dataclass_fields__}
    assert System(**{**fields, "numbers": "counts"}) == system


# -- trees in Python --

ROD = Body("rod", m, (0, 0, -l), (m * l**2 / 12, m * l**2 / 12, 0))
HINGE = Joint("hinge", "revolute", "ground", "rod", axis="x")
OWN = (Quantity(m, "kg"), Quantity(l, "m"), Quantity(g, "m/s^2"), Quantity(k, "N/m"))
q = HINGE.coordinates[0].symbol


def tree(**more):
    parts = {"bodies": (ROD,), "joints": (HINGE,), "gravity": (0, 0, -g), "parameters": OWN}
    return Tree("pendulum", **{**parts, **more})


TREES = {
    "mass": ({"bodies": (Body("rod", m * l),)}, "body 'rod': mass"),
    "inertia": ({"bodies": (Body("rod", m, inertia=(m * l, m * l, 0)),)}, "body 'rod': inertia"),
    "gravity": ({"gravity": (0, 0, -m * g)}, "gravity"),
    "stiffness": (
        {"joints": (Joint("hinge", "revolute", "ground", "rod", axis="x", stiffness=k),)},
        "joint 'hinge': stiffness",
    ),
    "spring": (
        {"springs": (Spring("s", ("ground", "rod"), stiffness=k * l),)},
        "spring 's': stiffness",
    ),
    "load": (
        {"loads": (Load("rod", (0, m * g * q, m * g * l), (0, 0, 0)),)},
        "load on 'rod': force",
    ),
    "torque": (
        {"loads": (Load("rod", torque=(m * g * l + k * l, 0, 0)),)},
        "load on 'rod': torque",
    ),
}


@pytest.mark.parametrize("name", TREES)
def test_parts_of_trees_are_checked(name):
    changed, where = TREES[name]
    tree()
    tree(**changed, parameters=())
    with pytest.raises(InputError, match="the dimension of a term does not fit") as caught:
        tree(**changed)
    assert where in caught.value.where


def test_numbers_in_trees_may_be_values():
    tree(loads=(Load("rod", (0, 2 * m, 0)),), gravity=(0, 0, -10))
