"""Scenes of one body under loads of every kind: trees of one, by one translation."""

import pytest
import sympy as sp
from click.testing import CliRunner

import codegen
import eom
from eom.__main__ import main
from eom.errors import InputError
from eom.kinematics.coordinates import attitude, quaternion
from eom.mechanics.gyrostat import gyrostat
from eom.multibody import Body, Joint, Rotor, Spring, Tree, derive
from eom.multibody.files.scene import TreeScene
from eom.scenes.scene import Scene
from eom.views.tree.sketches import sketch

DIGITS = 50
MOMENTS = (1.0, 2.0, 2.5)
TOP = {"mass": 2.0, "gravity": 10.0, "centre_of_mass": (0.05, 0.1, 0.2)}
FIELD = ((-1.5, 0.3, 0.1), (0.3, -0.5, 0.2), (0.1, 0.2, 2.0))
RATES = ("omega_1", "omega_2", "omega_3")
SYMBOLS = {n: sp.Symbol(n, real=True) for n in (*RATES, "q0", "q1", "q2", "q3", "t", "g", "m")}
OMEGA = sp.Matrix([SYMBOLS[n] for n in RATES])
C = quaternion().matrix.xreplace({s: SYMBOLS[s.name] for s in quaternion().symbols})


def scene(**data):
    own = {} if "weight" in data.get("torque", {}) else {"mass": 2.0}
    return TreeScene(**{"body": {"moments": MOMENTS, **own}, "attitude": "quaternion", **data})


def exactly(value):
    """A number as the decimal that it is written as."""
    return sp.Rational(str(value))


def numbers(system, values):
    """Return exact numbers for the symbols of a system, by name; states are any, unless given."""
    names = (*system.state_names, *system.parameter_names, *system.input_names, "t")
    numbered = {n: sp.Rational(3 + 2 * k, 7 + k * k) for k, n in enumerate(names)}
    return {**numbered, **{n: exactly(v) for n, v in values.items()}}


def at(expression, known):
    by_symbol = {s: known[s.name] for s in expression.free_symbols}
    return sp.N(expression.xreplace(by_symbol), DIGITS)


def rates_at(system, known):
    return {n: at(system.expand(r), known)
            for n, r in zip(system.state_names, system.rates, strict=True)}  # fmt: skip


def same(found, expected):
    return abs(found - expected) <= sp.Float(10, DIGITS) ** (5 - DIGITS) * (1 + abs(expected))


def moment_gives(system, known, J, moment):
    """Whether J omega' + omega x J omega is the moment, to 45 digits."""
    rates, omega = rates_at(system, known), OMEGA.subs({SYMBOLS[n]: known[n] for n in RATES})
    J = sp.Matrix(J).applyfunc(exactly)
    left = J * sp.Matrix([rates[n] for n in RATES]) + omega.cross(J * omega)
    return all(same(a, at(b, known)) for a, b in zip(left, moment, strict=True))


def test_wheels_are_those_of_the_gyrostat():
    """Momenta p_k are J_k Omega_k of the whole angular velocity along the axis."""
    wheels = {n: {"inertia": 0.25, "axis": n, "motor": True} for n in "xyz"}
    system = scene(rotors=wheels).full_system
    other = gyrostat(3, attitude=attitude("quaternion"))
    known = numbers(system, dict(zip(("I1", "I2", "I3"), MOMENTS, strict=True)))
    for k, n in enumerate("xyz", 1):
        known |= {f"Js_{k}": sp.Rational(1, 4), f"u_{k}": known[f"tau_{n}"]}
        known[f"p_{k}"] = known[f"Omega_{n}"] / 4
    found, expected = rates_at(system, known), rates_at(other, known)
    masses = other.mass_matrix
    moving = (
        sp.eye(len(expected))
        if masses is None
        else masses.applyfunc(lambda e: at(other.expand(e), known))
    )
    expected = dict(zip(expected, moving.LUsolve(sp.Matrix([*expected.values()])), strict=True))
    for name in (*RATES, "q0", "q1", "q2", "q3"):
        assert same(found[name], expected[name])
    for k, n in enumerate("xyz", 1):
        assert same(found[f"Omega_{n}"] / 4, expected[f"p_{k}"])


def test_a_spring_pulls_the_body_about_its_point():
    """r x F, F along the line to the ground's point, of size k (d - length); tree by hand the same."""
    hook, tip = (0.5, 0, 1.5), (0.1, -0.2, 0.3)
    given = scene(
        springs={"cord": {"first_point": hook, "second_point": tip, "stiffness": 3, "length": 0.5}}
    )
    system = given.full_system
    known = numbers(system, dict(zip(("I1", "I2", "I3"), MOMENTS, strict=True)))
    r = sp.Matrix(tip).applyfunc(exactly)
    line = C * sp.Matrix(hook).applyfunc(exactly) - r
    d = sp.sqrt(line.dot(line))
    norm = {
        n: x / 1 for n, x in zip(("q0", "q1", "q2", "q3"), map(exactly, (0.5,) * 4), strict=True)
    }
    assert moment_gives(
        system, known | norm, sp.diag(*MOMENTS), r.cross(3 * (d - sp.Rational(1, 2)) / d * line)
    )
    by_hand = Tree(
        "hand", (Body("body", 2, inertia=MOMENTS),), (Joint("root", "spherical", "ground", "body"),),
        springs=(Spring("cord", ("ground", "body"), (hook, tip), stiffness=3, length=0.5),),
    )  # fmt: skip
    other = derive(by_hand)
    values = [(known | norm)[n] for n in system.state_names]
    expected = rates_at(other, dict(zip(other.state_names, values, strict=True)))
    found = rates_at(system, known | norm)
    assert all(same(a, b) for a, b in zip(found.values(), expected.values(), strict=True))


def test_weight_and_gradient_act_about_the_fixed_point():
    """The integral of r x (g + G r) dm over the body: the force of the gradient at G is in it."""
    given = scene(torque={"weight": TOP}, gravity_gradient=FIELD)
    system = given.full_system
    values = {**dict(zip(("I1", "I2", "I3"), MOMENTS, strict=True)), "m": 2, "g": 10}
    values |= {f"r{k}": c for k, c in enumerate(TOP["centre_of_mass"], 1)}
    known = numbers(system, values) | dict.fromkeys(("q0", "q1", "q2", "q3"), sp.Rational(1, 2))
    exact = lambda rows: sp.Matrix(rows).applyfunc(exactly)  # noqa: E731
    J, r, G = (
        sp.diag(*map(exactly, MOMENTS)),
        exact(TOP["centre_of_mass"]),
        C * exact(FIELD) * C.T,
    )
    second = J.trace() / 2 * sp.eye(3) - J  # integral of r r^T dm
    turned = G * second
    spread = sp.Matrix(
        [turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]]
    )
    weight = (2 * r).cross(C * sp.Matrix([0, 0, -10]))
    assert moment_gives(system, known, J, weight + spread)
    assert not moment_gives(system, known, J, weight)
    assert "energy" in system.invariant_names


def test_an_orbit_is_that_of_the_scene_without_more():
    """Attitude in the orbit frame; omega is the speed relative to it and n along its third axis."""
    ORBIT = {"gravity_gradient": {"orbital_rate": 0.5}}
    tree = scene(model="tree", torque=ORBIT).full_system
    plain = Scene(body={"moments": MOMENTS}, attitude="quaternion", torque=ORBIT).full_system
    assert scene(model="tree", torque=ORBIT, angles="3-2-1").derive().output_names[0] == "psi"
    assert tree.state_names == ("q0", "q1", "q2", "q3", "w_body_1", "w_body_2", "w_body_3")
    turn = dict(
        zip(("q0", "q1", "q2", "q3"), (sp.Rational(k, 10) for k in (1, 5, 5, 7)), strict=True)
    )
    known = numbers(tree, dict(zip(("I1", "I2", "I3", "n"), (*MOMENTS, 0.5), strict=True))) | turn
    n = sp.Rational(1, 2) * C[:, 2].subs({SYMBOLS[k]: v for k, v in turn.items()})
    w = sp.Matrix([known[f"w_body_{k}"] for k in (1, 2, 3)])
    known |= {f"omega_{k}": (w + n)[k - 1] for k in (1, 2, 3)}
    found, expected = rates_at(tree, known), rates_at(plain, known)
    assert all(same(found[k], expected[k]) for k in turn)
    for k in (1, 2, 3):
        carried = n.cross(w)[k - 1]  # rate of n C a3
        assert same(found[f"w_body_{k}"] + carried, expected[f"omega_{k}"])


def test_what_is_on_the_ground_of_an_orbit_turns_with_it():
    """A damper to a point of the orbit frame, about which the body rests, does nothing."""
    hook = {"first_point": (1, 0.3, 0.2), "second_point": (0.1, 0.2, 0), "damping": 5.0}
    orbit = {"gravity_gradient": {"orbital_rate": 0.5}}
    held, left = (scene(model="tree", torque=orbit, springs=s) for s in ({"d": hook}, {}))
    assert held.tree.springs[0].bodies == ("orbit", "body")
    at_rest = dict.fromkeys(("w_body_1", "w_body_2", "w_body_3"), 0)
    at_rest |= dict.fromkeys(("q0", "q1", "q2", "q3"), 0.5)
    known = numbers(held.full_system, {**at_rest, "n": 0.5})
    found, expected = (rates_at(s.full_system, known) for s in (held, left))
    assert all(same(found[n], expected[n]) for n in found)
    assert sp.Symbol("t", real=True) not in set().union(
        *(r.free_symbols for r in held.derive().rates)
    )


def test_formulas_name_what_the_scene_defines():
    data = {
        "body": {"solid": "cylinder", "mass": 0.5, "size": {"radius": 0.05, "length": 0.02}},
        "torque": {"weight": {"mass": 0.5, "gravity": 10.0, "centre_of_mass": (0, 0, 0.1)},
                   "components": ("-k*omega_1", "Omega_wheel*I3", "u*m*g*radius")},
        "parameters": {"k": 0.1}, "inputs": {"u": 1.0},
        "rotors": {"wheel": {"inertia": "I3/4", "damping": "mass*radius^2"}},
        "springs": {"cord": {"first_point": (0, 0, "3*r3"), "second_point": (0, 0, "r3"),
                             "stiffness": "m*g/length"}},
        "loads": {"push": {"force": ("m*g/10", 0, 0), "point": (0, 0, "length")}},
        "points": {"tip": {"position": (0, 0, "length")}},
        "initial": {"omega_3": "k/I3"},
    }  # fmt: skip
    given = scene(**data)
    one = Scene(
        **{k: data[k] for k in ("body",)},
        attitude="quaternion",
        torque={"weight": data["torque"]["weight"]},
    )
    assert {n: given.numbers[n] for n in one.numbers} == one.numbers
    assert given.start["omega_3"] == pytest.approx(0.1 / one.numbers["I3"], rel=1e-15)
    (spring,), (wheel,), (couple, push) = given.tree.springs, given.tree.rotors, given.tree.loads
    assert spring.bodies == ("ground", "body")
    assert wheel.body == push.body == "body"
    assert couple.axes == "body"
    assert couple.torque[2] == sp.prod(sp.symbols("u m g radius", real=True))
    assert {"u", "radius", "length"} <= {
        *given.derive().parameter_names,
        *given.derive().input_names,
    }
    assert "x_tip_3" in given.derive().output_names
    assert given.changed(outputs=("omega_3",)).requested == ("omega_3",)


@pytest.mark.parametrize(
    ("chosen", "names"),
    [
        ({"attitude": "3-1-3"}, ("psi", "theta", "phi")),
        ({"attitude": "none"}, ("q0", "q1", "q2", "q3")),
        ({"attitude": "3-2-1", "integrate": "quaternion"}, ("q0", "q1", "q2", "q3")),
    ],
    ids=["angles", "none", "integrated"],
)
def test_states_have_the_names_of_one_body(chosen, names):
    given = scene(rotors={"w": {"inertia": 0.1}}, **chosen)
    assert given.derive().state_names == (*names, *RATES, "Omega_w")
    turned = ("psi", "theta", "phi") if "integrate" in chosen else ()
    assert given.derive().output_names == turned


def test_a_free_body_falls_on_its_spring():
    given = scene(
        joint={"kind": "free"}, gravity=(0, 0, -9.81), springs={"s": {"stiffness": 10.0}},
        initial={"x_body": 0.3}, initial_attitude={"sequence": "3-2-1", "degrees": (0, 20, 0)},
    )  # fmt: skip
    system = given.derive()
    known = numbers(system, {"mass": 2}) | dict.fromkeys(
        ("q0", "q1", "q2", "q3"), sp.Rational(1, 2)
    )
    found = rates_at(system, known)
    v, w = (sp.Matrix([known[n.format(k)] for k in (1, 2, 3)]) for n in ("v_body_{}", "omega_{}"))
    x = sp.Matrix([known[f"{a}_body"] for a in "xyz"])
    force = C.subs({SYMBOLS[k]: known[k] for k in ("q0", "q1", "q2", "q3")}) * (
        sp.Matrix([0, 0, -exactly(9.81)]) - 5 * x
    )
    for k, a in enumerate(force - w.cross(v), 1):
        assert same(found[f"v_body_{k}"], sp.N(a, DIGITS))
    assert given.start["q2"] == pytest.approx(0.17364817766693033)


WRONG = {
    "two points": ({"torque": {"weight": TOP, "gravity_gradient": {"orbital_rate": 1.0}},
                    "rotors": {"w": {"inertia": 1}}}, "about different points"),
    "gravity twice": ({"torque": {"weight": TOP}, "gravity": (0, 0, -9.81)}, "gravity is given twice"),
    "a name twice": ({"parameters": {"I1": 2.0}, "gravity": (0, 0, "I1")}, "I1 is given twice"),
    "no mass": ({"body": {"moments": MOMENTS}}, "the joint moves no mass"),
    "two masses": (
        {"body": {"moments": MOMENTS, "mass": 2.0}, "torque": {"weight": TOP}}, "mass is given twice",
    ),
    "no solid": ({"body": {"moments": MOMENTS, "size": {"radius": 1}}}, "size belong to a solid"),
    "a key": ({"rotors": {"w": {"inertia": 1, "axes": "x"}}}, "unknown key 'axes'"),
    "no table": ({"rotors": 3}, "unusable value"),
    "no loads": ({"loads": 3, "torque": {"components": (1, 0, 0)}}, "unusable value"),
    "a law": ({"torque": {"weight": {**TOP, "gravty": 3.0}}}, "unknown key 'gravty'"),
    "a joint": ({"joint": {"kind": "hinge"}}, "unknown kind of joint 'hinge'"),
    "cosines": ({"attitude": "dcm"}, "unknown attitude"),
    "spinner": ({"model": "spinner"}, "unusable value"),
    "a model": ({"model": 3}, "unusable value"),
    "input and parameter": ({"parameters": {"k": 1.0}, "inputs": {"k": 1.0}}, "a parameter has this name"),
    "input and moment": ({"inputs": {"I1": 1.0}}, "a parameter has this name"),
    "joints": ({"joints": {}}, "joints is given twice"),
    "bodies": ({"bodies": {}}, "unknown key 'body'"),
    "an unused name": ({"parameters": {"k": 1.0}}, "no formula uses 'k'"),
    "a state": ({"initial": {"omega_4": 1.0}}, "unknown state 'omega_4'"),
    "a formula": ({"loads": {"f": {"force": ("m*g", 0, 0)}}}, "unknown name"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_one_error(name):
    data, words = WRONG[name]
    with pytest.raises(InputError, match=words):
        scene(**{"model": "tree", **data})


FILE = """
title = "Satellite with a wheel and a damper"
attitude = "3-2-1"
integrate = "quaternion"
[body]
solid = "cylinder"
mass = 5.0
size = { radius = 0.2, length = 0.4 }
[torque]
components = ["-k*omega_1", 0, "u"]
[parameters]
k = 0.01
[inputs]
u = 0.001
[rotors.wheel]
inertia = "I3/10"
motor = true
[initial]
omega_1 = 0.1
Omega_wheel = 20.0
[initial_attitude]
sequence = "3-2-1"
degrees = [10, 20, 30]
[integration]
t_end = 2.0
points = 5
"""


@pytest.fixture
def file(tmp_path):
    found = tmp_path / "satellite.toml"
    found.write_text(FILE, encoding="utf-8")
    return found


def run(*words):
    done = CliRunner().invoke(main, [str(w) for w in words], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.output


def test_a_file_goes_all_the_way(file, tmp_path):
    assert "Omega_wheel" in run("derive", file)
    assert "reached t = 2 s" in run("run", file, "--out", tmp_path / "out")
    for command, name in (("live", "l.html"), ("animate", "a.html"), ("plot", "p.svg")):
        run(command, file, "--out", tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000
    run("generate", file, "--out", tmp_path / "code")
    assert (tmp_path / "code" / "satellite.c").exists()


def test_a_file_is_opened_by_what_is_in_it(file):
    found = eom.load_scene(file)
    assert found.is_tree
    assert [b.name for b in found.tree.bodies] == ["body"]
    with pytest.raises(InputError, match="this scene is a tree of bodies"):
        Scene.from_toml(file)


def test_a_motor_hands_momentum_to_its_wheel():
    """Without other torque the momentum in space stays."""
    given = scene(
        rotors={"wheel": {"inertia": 0.1, "motor": True}}, outputs=("momentum", "omega_3")
    )
    start = {**given.initial_values(), "omega_1": 0.1, "omega_3": 0.2}
    run = codegen.simulate(
        codegen.compile(given.derive(), "numpy"), start, (0, 2), given.parameter_values(),
        inputs={"tau_wheel": 0.01}, method="DOP853", rtol=1e-11, outputs=["L_1", "L_3", "omega_3"],
    )  # fmt: skip
    for name in ("L_1", "L_3"):
        assert run[name][-1] == pytest.approx(run[name][0], rel=1e-9)
    assert run["omega_3"][-1] < 0.195


def test_sketches_tell_of_a_gradient():
    plain, varied = scene(model="tree"), scene(gravity_gradient=FIELD)
    assert "gradient" in sketch(varied).caption
    assert "gradient" not in sketch(plain).caption


def test_rotors_of_python_are_the_same():
    given = scene(rotors={"w": {"inertia": 0.1, "axis": "y"}})
    assert given.tree.rotors == (Rotor("w", "body", "y", 0.1),)
