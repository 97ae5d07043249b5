"""Units in scenes: values with other units, formulas that do not fit, decimals as they were written."""

import math

import numpy as np
import pytest
import sympy as sp
from click.testing import CliRunner

import codegen
import eom
from codegen.ensembles.sampler import distribution
from eom.__main__ import main
from eom.errors import InputError
from eom.multibody import Body, Joint, Tree, closed_form, derive, tree_page
from eom.typeset.printing import show
from eom.typeset.writing import in_decimals

ONE = {
    "body": {"moments": (1, 1, 2)},
    "torque": {"components": (0, 0, "M")},
    "parameters": {"M": {"value": 0.1, "unit": "N m"}},
    "outputs": ("omega_3",),
    "initial": {"omega_3": 5},
}
ROD = {"mass": "m", "centre": (0, 0, "-l/2"), "moments": ("m*l**2/12", "m*l**2/12", 0)}
HINGE = {"kind": "revolute", "parent": "ground", "child": "rod", "axis": "x"}
MANY = {
    "bodies": {"rod": ROD},
    "joints": {"hinge": HINGE},
    "gravity": (0, 0, "-g"),
    "parameters": {"m": "500 g", "l": "2 ft", "g": "9.81 m/s^2"},
}


def one(**changes):
    return eom.Scene(**{**ONE, **changes})


def many(**changes):
    return eom.TreeScene(**{**MANY, **changes})


def test_parameters_are_kept_in_si():
    given = (
        {"M": "2 lbf ft"},
        {"M": {"value": "2 lbf ft", "unit": "N m"}},
        {"M": {"value": 2, "unit": "lbf ft"}},
    )
    for parameters in given:
        scene = one(parameters=parameters)
        assert scene.parameters["M"].value == 2 * 4.4482216152605 * 0.3048
        assert scene.parameters["M"].unit == "N m"
        assert scene.changed(title="again").parameters == scene.parameters
    assert many().numbers == {"m": 0.5, "l": 0.6096, "g": 9.81}


def test_every_value_of_one_body_may_have_a_unit():
    scene = eom.Scene(
        body={"solid": "cylinder", "mass": "2 lb", "size": {"radius": "3 cm", "length": "1 in"}},
        attitude="3-2-1",
        torque={
            "components": ("2 N cm", 0, 0),
            "weight": {
                "mass": "2 lb",
                "gravity": "1 ft/s^2",
                "centre_of_mass": ("1 mm", 0, "-2 mm"),
            },
        },
        initial={"omega_1": "60 rpm", "omega_2": "90 deg/s", "omega_3": 0},
        initial_attitude={"sequence": "3-2-1", "radians": ("30 deg", "45°", 0)},
        integration={"t_end": "2 min", "max_step": "5 ms"},
    )
    assert scene.body.size == {"radius": 0.03, "length": 0.0254}
    assert scene.body.mass == scene.torque.weight.mass == 0.90718474
    assert scene.torque.weight.centre_of_mass == (0.001, 0, -0.002)
    assert scene.torque.weight.gravity == 0.3048
    assert scene.initial_values()["omega_1"] == pytest.approx(2 * math.pi, rel=1e-15)
    assert scene.initial_values()["omega_2"] == pytest.approx(math.pi / 2, rel=1e-15)
    assert scene.initial_values()["psi"] == pytest.approx(math.pi / 6, rel=1e-15)
    assert (scene.integration.t_end, scene.integration.max_step) == (120, 0.005)
    assert sp.Rational(1, 50) in scene.full_system.definitions[-1].expression.atoms(sp.Rational) | {
        e for d in scene.full_system.definitions for e in d.expression.atoms(sp.Rational)
    }


def test_every_value_of_a_tree_may_have_a_unit():
    scene = many(
        bodies={
            "rod": {**ROD, "mass": "1 kg", "centre": (0, 0, "-1 ft")},
            "cart": {"mass": "2 kg"},
        },
        joints={
            "hinge": {
                **HINGE,
                "stiffness": "3 N cm/deg",
                "rest": "90 deg",
                "damping": "2 N mm s",
                "on_parent": {
                    "position": (0, 0, "2 cm"),
                    "rotation": {"radians": ("180 deg", 0, 0)},
                },
            },
            "rail": {
                "kind": "prismatic",
                "parent": "ground",
                "child": "cart",
                "stiffness": "3 N/cm",
                "rest": "1 in",
            },
        },
        springs={
            "s": {"first": "ground", "second": "rod", "stiffness": "5 N/cm", "length": "20 mm"}
        },
        loads={"f": {"body": "rod", "force": ("1 kN", 0, 0), "torque": ("1 lbf in", 0, 0)}},
        parameters={"m": 1, "l": "2 ft", "g": "9.81 m/s^2"},
        spare=("m",),
        initial={"q_hinge": "30 deg", "u_hinge": "10 rpm", "q_rail": "5 cm"},
    )
    rod, _ = scene.tree.bodies
    hinge, rail = scene.tree.joints
    assert rod.centre[2] == sp.Rational(-381, 1250)
    assert hinge.stiffness[0] == pytest.approx(0.03 * 180 / math.pi, rel=1e-15)
    assert hinge.rest[0] == pytest.approx(math.pi / 2, rel=1e-15)
    assert hinge.damping[0] == sp.Rational(1, 500)
    assert rail.stiffness == (300,)
    assert rail.rest == (sp.Rational(127, 5000),)
    assert scene.tree.springs[0].length == sp.Rational(1, 50)
    assert scene.tree.loads[0].force[0] == 1000
    assert scene.start == pytest.approx(
        {"q_hinge": math.pi / 6, "u_hinge": math.pi / 3, "q_rail": 0.05, "u_rail": 0}, rel=1e-15
    )


WRONG = {
    "unknown": (
        one,
        {"parameters": {"M": {"value": 1, "unit": "Nm"}}},
        "unknown unit",
        "parameters.M",
    ),
    "unknown in a value": (one, {"parameters": {"M": "1 furlong"}}, "unknown unit", "parameters.M"),
    "two units": (
        one,
        {"parameters": {"M": {"value": "1 m", "unit": "N m"}}},
        "another dimension",
        "parameters.M",
    ),
    "input": (one, {"inputs": {"u": "1 foo"}}, "unknown unit", "inputs.u"),
    "parameter": (
        one,
        {"parameters": {"M": "2 kg"}},
        "a term does not fit",
        "[torque] components, number 3",
    ),
    "moment": (one, {"body": {"moments": ("1 kg m", 1, 2)}}, "another dimension", "body.moments.0"),
    "end": (one, {"integration": {"t_end": "2 m"}}, "another dimension", "integration.t_end"),
    "factor": (
        one,
        {"torque": {"components": (0, 0, "M - 2*omega_3")}},
        "a term does not fit",
        "number 3",
    ),
    "state of a control": (
        one,
        {
            "control": {"laws": {"u": "-z"}, "states": {"z": {"rate": "omega_3", "unit": "Nms"}}},
            "torque": {"components": (0, 0, "M + u")},
        },
        "unknown unit",
        "control.states.z",
    ),
    "law": (
        one,
        {
            "control": {"laws": {"u": "-k*omega_3"}},
            "inputs": {"u": {"value": 0, "unit": "N m"}},
            "parameters": {"M": 1, "k": {"value": 1, "unit": "N m"}},
            "torque": {"components": (0, 0, "M + u")},
        },
        "a term does not fit",
        "[control.laws] u",
    ),
    "spring": (
        many,
        {"springs": {"s": {"first": "ground", "second": "rod", "stiffness": "m*g"}}},
        "a term does not fit",
        "spring 's': stiffness",
    ),
    "joint": (
        many,
        {"joints": {"hinge": {**HINGE, "stiffness": "3 N/m"}}},
        "another dimension",
        "joint 'hinge': stiffness",
    ),
    "load": (
        many,
        {"loads": {"f": {"body": "rod", "force": (0, "u_hinge*m", 0)}}},
        "a term does not fit",
        "load 'f'",
    ),
    "gravity": (many, {"gravity": (0, 0, "-m*g")}, "a term does not fit", "gravity"),
    "body": (
        many,
        {"bodies": {"rod": {**ROD, "moments": ("m*l", "m*l", 0)}}},
        "a term does not fit",
        "body 'rod'",
    ),
    "degrees": (
        many,
        {"joints": {"hinge": {**HINGE, "on_parent": {"rotation": {"degrees": ("1 rad", 0, 0)}}}}},
        "degrees have no other unit",
        "joint 'hinge'",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_does_not_fit_is_one_error(name):
    make, changed, what, where = WRONG[name]
    with pytest.raises(InputError, match=what) as caught:
        make(**changed)
    assert where in caught.value.where


@pytest.mark.parametrize(
    ("make", "initial"),
    [(one, {"omega_3": "60 deg"}), (many, {"q_hinge": "30 m"}), (many, {"q_hinge": "l"})],
)
def test_starts_of_another_dimension_are_refused(make, initial):
    with pytest.raises(InputError, match="dimension") as caught:
        make(initial=initial).start  # noqa: B018
    assert caught.value.where.startswith("[initial]")


FITS = [
    (one, {"torque": {"components": (0, 0, "M - 0.1*omega_3")}}),
    (one, {"torque": {"components": (0, 0, "M*sin(2*t) + M*cos(t)/3")}}),
    (one, {"torque": {"components": (0, 0, "-2*omega_3")}, "parameters": {}}),
    (
        one,
        {
            "torque": {"components": ("-k*omega_1", 0, "M - k*omega_3")},
            "parameters": {"M": "1 N m", "k": 1},
        },
    ),
    (many, {"loads": {"f": {"body": "rod", "force": (0, "mass_rod*g/3", 0)}}}),
    (
        many,
        {"loads": {"f": {"body": "rod", "torque": ("-m*g*l*sin(q_hinge) - 0.3*u_hinge", 0, 0)}}},
    ),
]


@pytest.mark.parametrize("case", FITS, ids=range(len(FITS)))
def test_what_fits_or_is_not_known_passes(case):
    make, changed = case
    make(**changed).derive()


def test_what_follows_in_one_formula_holds_in_the_next():
    """k is N m s by the first; as N m in the second it does not fit."""
    torque = {"components": ("M - k*omega_1", "M - k*omega_2*omega_1", 0)}
    with pytest.raises(InputError, match="a term does not fit") as caught:
        one(torque=torque, parameters={"M": "1 N m", "k": 1})
    assert "number 2" in caught.value.where


# -- where values are taken --


def test_runs_take_values_with_units():
    scene = many()
    start, values = (
        {"q_hinge": "30 deg", "u_hinge": "10 rpm"},
        {"m": "500 g", "l": "2 ft", "g": 9.81},
    )
    compiled = codegen.compile(scene.derive(), "numpy")
    run = codegen.simulate(compiled, start, (0, 0.1), values, "scipy:DOP853")
    plain = codegen.simulate(
        compiled,
        {"q_hinge": math.pi / 6, "u_hinge": math.pi / 3},
        (0, 0.1),
        {"m": 0.5, "l": 0.6096, "g": 9.81},
        "scipy:DOP853",
    )
    np.testing.assert_allclose(run["q_hinge"], plain["q_hinge"], rtol=1e-14)
    rates = compiled.rhs(0.0, start, values)
    np.testing.assert_allclose(
        rates, compiled.rhs(0.0, [math.pi / 6, math.pi / 3], values), rtol=1e-14
    )
    with pytest.raises(InputError, match="another dimension") as caught:
        codegen.simulate(compiled, {**start, "q_hinge": "30 m"}, (0, 1), values)
    assert caught.value.where == "value of q_hinge"
    with pytest.raises(InputError, match="not a number"):
        codegen.simulate(compiled, {**start, "q_hinge": "thirty"}, (0, 1), values)


def test_equilibria_and_ensembles_take_values_with_units():
    compiled = codegen.compile(many().derive(), "numpy")
    values = {"m": "500 g", "l": "2 ft", "g": "1 ft/s^2"}
    point = codegen.equilibrium(compiled, {"q_hinge": "170 deg"}, values, hold={"u_hinge": "0 rpm"})
    assert point.parameters["l"] == 0.6096
    found = distribution("normal(30 deg, 1 deg)", "q", "rad")
    assert (found.mean, found.deviation) == pytest.approx((math.pi / 6, math.pi / 180), rel=1e-15)
    with pytest.raises(InputError, match="another dimension"):
        distribution("normal(30 m, 1 deg)", "q", "rad")


@pytest.mark.parametrize(
    ("words", "code", "shown"),
    [
        (["simulate", "t-handle", "--t-end", "500 ms"], 0, "t = 0.5 s"),
        (["simulate", "t-handle", "--t-end", "5 m"], 1, "another dimension"),
        (["simulate", "t-handle", "--t-end", "soon"], 2, "'soon' is no time"),
        (["linearise", "double-pendulum", "--at", "q_shoulder=180 deg"], 0, "3.14159"),
        (["linearise", "double-pendulum", "--at", "q_shoulder=2 m"], 1, "another dimension"),
        (
            ["ensemble", "t-handle", "--vary", "omega_1=uniform(1 rpm, 2 rpm)", "--count", "3"],
            0,
            "omega_1",
        ),
        (
            ["ensemble", "t-handle", "--vary", "omega_1=uniform(1 m, 2 m)", "--count", "3"],
            1,
            "another dimension",
        ),
    ],
    ids=str,
)
def test_options_take_values_with_units(words, code, shown):
    found = CliRunner().invoke(main, words)
    text = found.output + str(found.exception or "")
    assert shown in text
    assert (found.exit_code == 0) == (code == 0)


# -- decimals --


def pendulum(**more):
    rod = Body("rod", 0.05, (0, 0, -0.3), (0.001, 0.001, 0))
    hinge = Joint("hinge", "revolute", "ground", "rod", axis="x", damping=0.2)
    return Tree("pendulum", (rod,), (hinge,), gravity=(0, 0, -9.81), **more)


@pytest.mark.parametrize("method", ["lagrange", "kane", "newton-euler"])
@pytest.mark.parametrize("style", ["text", "latex"])
def test_decimals_stay_decimals_in_closed_forms(method, style):
    page = tree_page(pendulum(), method, style)
    assert "0.14715" in page  # 0.05 * 0.3 * 9.81
    assert "0.0055" in page  # 0.001 + 0.05 * 0.3^2
    assert "0.2" in page
    assert not any(len(word) > 12 and word.isdigit() for word in page.replace("/", " ").split())


def test_decimals_are_exact_inside():
    form = closed_form(pendulum())
    assert form.mass_matrix[0] == sp.Rational(55, 10000)
    assert not form.mass_matrix.has(sp.Float)
    system = derive(pendulum())
    assert not any(d.expression.has(sp.Float) for d in system.definitions)
    assert "-0.2*u_hinge" in show(system)
    assert "3602879701896397" not in show(system) + show(system, "latex")


def test_decimals_of_torques_and_laws_stay():
    damped = one(torque={"components": ("-0.05*omega_1", 0, 0)}, parameters={}, outputs=("omega_1",),
                 initial={"omega_1": 1, "omega_2": 0, "omega_3": 0})  # fmt: skip
    assert "0.05 ω₁" in show(damped.derive()) or "0.05*omega_1" in show(damped.derive())
    assert damped.derive().rates[0].atoms(sp.Rational) or damped.derive().definitions
    law = {"laws": {"u": "-0.125*omega_3"}}
    held = one(control=law, torque={"components": (0, 0, "u")}, parameters={})
    assert "0.125*omega_3" in show(held.derive())
    assert not any(d.expression.has(sp.Float) for d in held.derive().definitions)


def test_fractions_of_symbols_stay_fractions():
    assert "1/3" in tree_page(many().tree, "lagrange", "text") or "/3" in tree_page(
        many().tree, "lagrange", "text"
    )
    assert many().derive().numbers == "values"
    assert many(joints={"hinge": {**HINGE, "damping": "0.05*m*l^2"}}).derive().numbers == "decimals"
    assert "0.05*" in show(many(joints={"hinge": {**HINGE, "damping": "0.05*m*l^2"}}).derive())


def test_decimal_numbers_are_those_that_were_written():
    x = sp.Symbol("x")
    for number in ("0.05", "9.81", "0.1234567890123456", "1.0e-9", "123456.789"):
        assert float(str(in_decimals(sp.Rational(number)))) == float(number)
        assert in_decimals(sp.Rational(number) * x).has(sp.Float)
    assert in_decimals(sp.sqrt(x) + x / 3 + 2 * x**2) == sp.sqrt(x) + x / 3 + 2 * x**2
    long = in_decimals(sp.Rational(10**20 + 1, 3**30))
    assert float(long) == pytest.approx((10**20 + 1) / 3**30, rel=1e-14)
