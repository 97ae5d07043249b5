"""Bodies whose mass changes in time: published laws, balances of momentum, other models of the same."""

import math
import random

import numpy as np
import pytest
import sympy as sp

import codegen
import eom
from eom.errors import InputError
from eom.multibody import Body, Jet, Joint, Motion, Placement, Tree, closed_form, derive
from eom.multibody.files.scene import TreeScene
from eom.quantities import TIME, Quantity

t = TIME
S = sp.Rational
HERE = S(7, 10)
"""A time at which nothing is special."""
FREE = Joint("base", "free", "ground", "hull")


def tree(body, *jets, joint=FREE, more=(), **given):
    return Tree("burning", (body, *(b for b, _ in more)), (joint, *(j for _, j in more)),
                jets=jets, **given)  # fmt: skip


def values(system, states, expressions, time=HERE, digits=40):
    """Return expressions of a system without parameters, at states by name and a time."""
    known = {q.symbol: sp.Float(states[q.name], digits) for q in (*system.states, *system.inputs)}
    known[TIME] = sp.Float(time, digits)
    for d in system.definitions:
        known[d.symbol] = sp.sympify(d.expression).xreplace(known).evalf(digits)
    return [sp.sympify(e).xreplace(known).evalf(digits) for e in expressions]


def somewhere(system, seed):
    """Return random states and inputs by name; quaternions of norm 1."""
    draw = random.Random(seed)
    found = {q.name: draw.uniform(-1, 1) for q in (*system.states, *system.inputs)}
    for joint in {n[:-2] for n in found if n.startswith("e_")}:
        norm = math.hypot(*(found[f"{joint}_{k}"] for k in range(4)))
        found |= {f"{joint}_{k}": found[f"{joint}_{k}"] / norm for k in range(4)}
    return found


def slopes(system, states, names):
    """Return how fast outputs grow in the motion, by differences in 60 digits."""
    of = {d.name: d.expression for d in system.outputs}
    h = sp.Float("1e-20", 60)
    rates = values(system, states, system.rates, digits=60)
    ends = []
    for sign in (-1, 1):
        moved = {
            q.name: sp.Float(states[q.name], 60) + sign * h * r
            for q, r in zip(system.states, rates, strict=True)
        }
        there = {**states, **moved}
        ends.append(values(system, there, [of[n] for n in names], HERE + sign * h, 60))
    return np.array([float((b - a) / (2 * h)) for a, b in zip(*ends, strict=True)])


def burning(shift=(0, 0, 0)):
    """Return a body whose mass, centre and inertia change, with an inlet and a nozzle off its axes.

    ``shift``: from its origin to where it would be without.
    """
    centre = [S(1, 5) + t / 50 + shift[0], t**2 / 40 + shift[1], -S(1, 10) + t / 30 + shift[2]]
    inertia = sp.Matrix([[3, S(1, 5), 0], [S(1, 5), 4, -t / 9], [0, -t / 9, 5]]) - t * sp.eye(3) / 4
    jets = (
        Jet("nozzle", "hull", (S(1, 2), 0, -9), (shift[0], S(1, 10) + shift[1], -2 + shift[2])),
        Jet("inlet", "hull", (0, 1, -3), (1 + shift[0], shift[1], 1 + shift[2]), rate=-S(1, 3) - t),
    )
    return Body("hull", 10 - t + t**2 / 6, centre, inertia), jets


# -- published laws --


ROCKET = {
    "gravity": (0, 0, "-g"),
    "parameters": {"m0": 100, "mu": 5, "v": 2000.0, "k": 1.2, "l": 2.0, "g": 9.81},
    "bodies": {"rocket": {
        "mass": "m0 - mu*t", "moments": ["(m0 - mu*t)*k^2", "(m0 - mu*t)*k^2", "0.3*(m0 - mu*t)"],
    }},
    "joints": {"rocket": {"kind": "free", "parent": "ground", "child": "rocket"}},
    "jets": {"nozzle": {"body": "rocket", "velocity": [0, 0, "-v"], "point": [0, 0, "-l"]}},
    "integration": {"t_end": 10},
}  # fmt: skip


def flown(**more):
    scene = TreeScene(**{**ROCKET, **more})
    compiled = codegen.compile(scene.derive(), "python")
    run = codegen.simulate(
        compiled, scene.initial_values(), (0, 10), scene.parameter_values(), "DOP853", 1e-12
    )
    return {n: x[-1] for n, x in zip(compiled.system.state_names, run.y, strict=True)}


def test_it_rises_by_tsiolkovskys_formula():
    """v ln(m0/m) - g t, and its integral."""
    end = flown()
    assert end["v_rocket_3"] == pytest.approx(2000 * math.log(2) - 98.1, rel=1e-11)
    height = 2000 * 10 - 2000 * (50 / 5) * math.log(2) - 9.81 * 50
    assert end["z_rocket"] == pytest.approx(height, rel=1e-11)


def test_the_jet_damps_pitch_and_not_spin():
    """Thomson, Introduction to Space Dynamics (1961): m k^2 w' = -mu (l^2 - k^2) w."""
    end = flown(initial={"w_rocket_1": 0.2})
    assert end["w_rocket_1"] == pytest.approx(0.2 * 0.5 ** ((2.0 / 1.2) ** 2 - 1), rel=1e-10)
    assert flown(initial={"w_rocket_3": 0.2})["w_rocket_3"] == pytest.approx(0.4, rel=1e-10)


def test_a_falling_drop_that_gathers_mist_at_rest():
    """What enters is at rest, so that it moves with -v relative to the drop: (m v)' = m g."""
    drop = Body("hull", 1 + t / 2)
    v = sp.Symbol("u_line", real=True)
    line = Joint("line", "prismatic", "ground", "hull", axis="-z")
    system = derive(tree(drop, Jet("mist", "hull", (0, 0, v)), joint=line, gravity=(0, 0, -10)))
    (found,) = values(system, {"q_line": 0.3, "u_line": 0.8}, [system.rates[1]], time=S(1, 2))
    assert found == pytest.approx(10 - S(1, 2) * S(8, 10) / S(5, 4), rel=1e-15)


# -- balances --


def test_momentum_and_angular_momentum_change_by_what_leaves_and_enters():
    """Of two bodies afloat, one of which burns: what the jets carry away is all that is lost."""
    hull, jets = burning()
    arm = Body("arm", 2, (S(1, 3), 0, S(1, 4)), (S(1, 5), S(1, 4), S(1, 6)))
    elbow = Joint("elbow", "universal", "hull", "arm", axis="y",
                  on_parent=Placement((0, S(1, 2), S(1, 3))), motor=True)  # fmt: skip
    given = tree(hull, *jets, more=((arm, elbow),), gravity=(0, 1, -3))
    seen = [eom.multibody.Point(j.name, "hull", j.point) for j in jets]
    system = derive(given, ("momentum", "centre_of_mass", *seen))
    x = somewhere(system, 1)
    names = [f"{letter}_{k}" for letter in ("p", "L") for k in (1, 2, 3)]
    lost = slopes(system, x, names)
    of = {d.name: d.expression for d in system.outputs}

    def now(name):
        return np.array(
            [float(e) for e in values(system, x, [of[f"{name}_{k}"] for k in (1, 2, 3)])]
        )

    q = [sp.Float(x[f"e_base_{k}"], 40) for k in range(4)]
    turn = np.array(eom.rotations.cosines(q), dtype=float)
    rates = {"inlet": -1 / 3 - 0.7, "nozzle": 1 - 0.7 / 3 + 1 / 3 + 0.7}
    weight = (10 - 0.7 + 0.49 / 6 + 2) * np.array([0, 1, -3])
    force, moment = weight, np.cross(now("centre"), weight)
    for jet in jets:
        place, fast = now(f"x_{jet.name}"), now(f"v_{jet.name}")
        gone = rates[jet.name] * (fast + turn.T @ np.array(jet.velocity, dtype=float))
        force, moment = force - gone, moment - np.cross(place, gone)
    assert lost == pytest.approx([*force, *moment], rel=1e-12)


def test_what_holds_a_rocket_takes_its_thrust():
    stand = Joint("stand", "prismatic", "ground", "hull", axis="z", motion=Motion((0,)))
    held = derive(tree(Body("hull", 8 - t), Jet("jet", "hull", (0, 0, -30)), joint=stand,
                       gravity=(0, 0, -10)), ["reactions"])  # fmt: skip
    of = {d.name: d.expression for d in held.outputs}
    (found,) = values(held, {}, [of["F_stand_3"]])
    assert found == pytest.approx(10 * (8 - HERE) - 30, rel=1e-15)


# -- other models of the same --


def rates_of(given, states):
    system = derive(given)
    found = values(system, states, system.rates)
    return {q.name: float(r) for q, r in zip(system.states, found, strict=True)}


def test_the_origin_of_the_body_is_of_no_matter():
    """The same body described from another origin, which the joint leads to."""
    shift = (S(3, 10), -S(1, 5), S(2, 5))
    (one, jets), (other, moved) = burning(), burning(shift)
    joint = Joint("base", "free", "ground", "hull", on_child=Placement(shift))
    first = tree(one, *jets, gravity=(0, 1, -3))
    x = somewhere(derive(first), 2)
    assert rates_of(tree(other, *moved, joint=joint, gravity=(0, 1, -3)), x) == pytest.approx(
        rates_of(first, x), rel=1e-12
    )


def test_a_mass_that_slides_within_is_a_body_that_changes():
    """Along a line through the centre of mass of the rest: without whirl about that of all."""
    way, start = sp.Matrix([2, -1, 2]) / 3, sp.Matrix([S(1, 5), 0, S(1, 10)])
    place = start + way * (t**2 / 3 + t / 5)
    rest, m = Body("hull", 5, tuple(start), (2, 3, 4)), 2
    slider = Body("bead", m)
    track = Joint("track", "prismatic", "hull", "bead", axis=tuple(way),
                  on_parent=Placement(tuple(start)), motion=Motion((t**2 / 3 + t / 5,)))  # fmt: skip
    apart = tree(rest, more=((slider, track),))
    centre = (5 * start + m * place) / 7
    d = [start - centre, place - centre]
    J = sp.diag(2, 3, 4) + sum(
        (k * (r.dot(r) * sp.eye(3) - r * r.T) for k, r in zip((5, m), d, strict=True)), sp.zeros(3)
    )
    still = (Jet("one", "hull", (1, 0, 0), rate=0), Jet("two", "hull", (0, 0, 0)))
    whole = tree(Body("hull", 7, tuple(centre), J), *still)
    x = somewhere(derive(whole), 3)
    assert rates_of(apart, x) == pytest.approx(rates_of(whole, x), rel=1e-12)


def test_bodies_that_are_fixed_to_each_other_are_one():
    """The ready rocket's casing and grain as one body, and the jet on it."""
    scene = eom.load_scene("rocket")
    casing, grain = scene.tree.bodies
    m = casing.mass + grain.mass
    inertia = sp.Matrix(casing.central_inertia) + sp.Matrix(grain.central_inertia)
    inertia += sp.diag(1, 1, 0) * casing.mass * grain.mass / m * casing.centre[2] ** 2
    whole = Body("casing", m, (0, 0, casing.mass * casing.centre[2] / m), inertia)
    (jet,) = scene.tree.jets
    one = Tree("one", (whole,), scene.tree.joints[:1], gravity=scene.tree.gravity,
               jets=(Jet("nozzle", "casing", jet.velocity, jet.point),))  # fmt: skip
    numbers = {s: sp.Float(v, 40) for s, v in
               ((sp.Symbol(n, real=True), x) for n, x in scene.numbers.items())}  # fmt: skip
    found = []
    for given in (scene.tree, one):
        system = derive(given)
        x = somewhere(system, 4)
        known = {
            **numbers,
            **{q.symbol: sp.Float(x[q.name], 40) for q in system.states},
            TIME: sp.Float(3, 40),
        }
        found.append([float(system.expand(r).xreplace(known)) for r in system.rates])
    assert found[0] == pytest.approx(found[1], rel=1e-12)


# -- what is refused, and where a run ends --


def refused(words, **more):
    with pytest.raises(InputError, match=words) as error:
        TreeScene(**{**ROCKET, **more}).tree  # noqa: B018
    return str(error.value)


def test_missing_and_impossible_jets_are_told():
    nozzle = ROCKET["jets"]["nozzle"]
    text = refused("no jet says with what velocity", jets={})
    assert "body 'rocket'" in text
    assert 'velocity = [0, 0, "-v"]' in text
    refused("velocity", jets={"nozzle": {"body": "rocket"}})
    refused("unknown body", jets={"nozzle": {**nozzle, "body": "rokcet"}})
    refused("one takes the rest", jets={"nozzle": {**nozzle, "rate": "mu"}})
    refused("one takes the rest", jets={"nozzle": nozzle, "other": nozzle})
    still = {"rocket": {"mass": "m0", "moments": ["mu*k", "mu*k", "mu*k"]}}
    refused("nothing goes through its jet", bodies=still)
    text = refused("mass is negative", bodies={"rocket": {"mass": "-1 - 2*t"}})
    assert "body 'rocket', at t = 0" in text
    flat = {"rocket": {"mass": "2 - t", "moments": ["1 - t/2", "1 - t/2", "3 - t"]}}
    refused("no body has this inertia", bodies=flat)
    refused("unknown name 'z_rocket'", jets={"nozzle": {**nozzle, "rate": "z_rocket"}})
    refused("too few values", jets={"nozzle": {**nozzle, "velocity": ["-v", 0]}})
    refused("unknown name 't'", jets={"nozzle": {**nozzle, "point": [0, 0, "-l*t"]}})


def test_a_kink_in_the_mass_is_refused_where_the_flow_would_jump():
    burnt = {"rocket": {"mass": "m0 - mu*min(t, 5)", "moments": ["m0*k", "m0*k", "m0*l"]}}
    text = refused("have a kink or a jump in time", bodies=burnt)
    assert "let it rise and die away smoothly" in text


def test_what_a_body_is_made_of_depends_on_no_state():
    q = FREE.coordinates[0].symbol
    with pytest.raises(InputError, match="depends on states or inputs"):
        tree(Body("hull", 3 + q))
    with pytest.raises(InputError, match="depends on states or inputs"):
        tree(
            Body("hull", 3 + sp.Symbol("F", real=True)),
            inputs=(Quantity(sp.Symbol("F", real=True)),),
        )


def test_a_negative_mass_is_refused_and_a_run_ends_where_it_is_used_up():
    scene = TreeScene(**{**ROCKET, "integration": {"t_end": 30}})
    compiled = codegen.compile(scene.derive(), "python")
    values = scene.parameter_values()
    run = codegen.simulate(compiled, scene.initial_values(), (0, 30), values)
    assert run.status == 1
    assert run.t_stop == pytest.approx(20, rel=1e-3)
    assert "of body rocket is used up" in run.message
    with pytest.raises(InputError, match="mass of body rocket is not negative"):
        codegen.simulate(compiled, scene.initial_values(), (21, 22), values)
    many = {**values, "m0": np.array([90.0, 106.0])}
    with pytest.raises(InputError, match="mass of body rocket is not negative"):
        codegen.ensemble(compiled, scene.initial_values(), (21, 22), many)
    with pytest.raises(InputError, match="mass of body rocket is not negative"):
        codegen.simulate(compiled, scene.initial_values(), (0, 1), {**values, "m0": -1.0})


def test_nothing_is_stated_as_constant_and_closed_forms_refuse():
    hull, jets = burning()
    assert {d.name for d in derive(tree(hull, *jets)).invariants} == {"norm_base"}
    still = tree(
        Body("hull", 3, inertia=(1, 1, 1)),
        Jet("in", "hull", (1, 0, 0), rate=-2),
        Jet("out", "hull", (-3, 0, 0)),
    )
    assert {d.name for d in derive(still).invariants} == {"norm_base"}
    line = Joint("line", "prismatic", "ground", "hull")
    with pytest.raises(InputError, match="jets"):
        closed_form(tree(Body("hull", 3 - t), Jet("jet", "hull", (0, 0, -1)), joint=line))
