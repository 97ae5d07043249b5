"""Descriptions of trees: what is refused, and which part the message names."""

import re
from fractions import Fraction

import pytest
import sympy as sp

from eom.errors import InputError
from eom.multibody import Body, Joint, Load, Motion, Placement, Tree, derive

q = sp.Symbol("q", real=True)
arm = Body("arm", 1, (0, 0, -1), (1, 1, 1))
hand = Body("hand", 1, (0, 0, -1), (1, 1, 1))


def hinge(name="hinge", parent="ground", child="arm", **rest):
    return Joint(name, "revolute", parent, child, **rest)


def tree(*joints, bodies=(arm, hand), **rest):
    return Tree("robot", bodies, joints, **rest)


REFUSED = {
    "mass is negative": (lambda: Body("arm", -1), "body 'arm'"),
    "no body has this inertia": (lambda: Body("arm", 1, inertia=(1, 1, 3)), "body 'arm'"),
    "no body has this inertia about": (
        lambda: Body("arm", 2, (1, 0, 0), (1, 1, 1), about="origin"), "body 'arm'"),
    "without mass has no inertia": (lambda: Body("arm", 0, inertia=(1, 1, 1)), "body 'arm'"),
    "is not symmetric": (
        lambda: Body("arm", 1, inertia=((1, 1, 0), (0, 1, 0), (0, 0, 1))), "body 'arm': inertia"),
    "not a name": (lambda: Body("left arm", 1), "body 'left arm'"),
    "not a number": (lambda: Body("arm", "1"), "body 'arm': mass"),
    "not a finite number": (lambda: Body("arm", float("nan")), "body 'arm': mass"),
    "not three components": (lambda: Body("arm", 1, (1, 2)), "body 'arm': centre"),
    "not a list": (lambda: Body("arm", 1, 3), "body 'arm': centre"),
    "rows are not orthonormal": (
        lambda: Placement(rotation=((1, 1, 0), (0, 1, 0), (0, 0, 1))), "joint: rotation"),
    "a reflection": (
        lambda: Placement(rotation=((-1, 0, 0), (0, 1, 0), (0, 0, 1))), "joint: rotation"),
    "the axis is zero": (lambda: hinge(axis=(0, 0, 0)), "joint 'hinge': axis"),
    "unknown axis": (lambda: hinge(axis="w"), "joint 'hinge': axis"),
    "squares that add to 1": (lambda: hinge(axis=(q, 0, 1)), "joint 'hinge': axis"),
    "axes are parallel": (
        lambda: Joint("cross", "universal", "ground", "arm", "x", second_axis="-x"), "joint 'cross'"),
    "unknown kind": (lambda: Joint("hinge", "revolut", "ground", "arm"), "joint 'hinge'"),
    "unknown attitude": (
        lambda: Joint("ball", "spherical", "ground", "arm", attitude="3-3-1"), "joint 'ball'"),
    "one value a speed": (lambda: hinge(damping=(1, 2)), "joint 'hinge': damping"),
    "a spring needs a coordinate": (
        lambda: Joint("ball", "spherical", "ground", "arm", stiffness=1), "joint 'ball'"),
    "prescribed motion needs": (
        lambda: Joint("ball", "spherical", "ground", "arm", motion=0), "joint 'ball'"),
    "unknown axes": (lambda: Load("arm", axes="world"), "load on 'arm'"),
    "unknown parent 'leg'": (lambda: tree(hinge(parent="leg"), bodies=(arm,)), "joint 'hinge'"),
    "unknown child 'leg'": (lambda: tree(hinge(child="leg"), bodies=(arm,)), "joint 'hinge'"),
    "repeated name of a body": (lambda: tree(hinge(), bodies=(arm, arm)), "tree 'robot'"),
    "repeated name of a joint": (
        lambda: tree(hinge(), hinge(parent="arm", child="hand")), "tree 'robot'"),
    "called ground": (lambda: tree(bodies=(Body("ground", 1),)), "tree 'robot'"),
    "'hand' hangs on nothing": (lambda: tree(hinge()), "tree 'robot'"),
    "two joints lead to body 'arm'": (
        lambda: tree(hinge(), hinge("other"), bodies=(arm,)), "tree 'robot'"),
    "they form a loop": (
        lambda: tree(hinge("a", "hand", "arm"), hinge("b", "arm", "hand")), "tree 'robot'"),
    "moves no mass": (
        lambda: tree(hinge(), hinge("wrist", "arm", "hand"), bodies=(arm, Body("hand"))),
        "joint 'wrist'"),
    "unknown body 'leg'": (lambda: tree(hinge(), bodies=(arm,), loads=[Load("leg")]), "tree 'robot'"),
    "accelerates no inertia": (
        lambda: derive(tree(hinge(), bodies=(Body("arm", 1, (0, 0, 1)),))), "joint 'hinge'"),
    "unknown output 'heat'": (lambda: derive(tree(hinge(), bodies=(arm,)), ["heat"]), "tree 'robot'"),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_refused_and_where(what):
    make, where = REFUSED[what]
    with pytest.raises(InputError, match=re.escape(what)) as caught:
        make()
    assert where in caught.value.where


def test_a_loop_names_its_joints():
    with pytest.raises(InputError) as caught:
        tree(hinge("a", "hand", "arm"), hinge("b", "arm", "hand"))
    assert caught.value.got == "a, b"


def test_numbers_are_exact_and_inertia_moves_to_the_centre():
    rod = Body("rod", 0.5, (0, 0, Fraction(-1, 2)), (1, 1, Fraction(1, 8)), about="origin")
    assert rod.mass == Fraction(1, 2)
    assert rod.central_inertia == (
        (Fraction(7, 8), 0, 0),
        (0, Fraction(7, 8), 0),
        (0, 0, Fraction(1, 8)),
    )


def test_inertia_in_other_axes():
    quarter = ((0, 1, 0), (-1, 0, 0), (0, 0, 1))
    assert Body("b", 1, inertia=(1, 2, 2), axes=quarter).central_inertia == (
        (2, 0, 0),
        (0, 1, 0),
        (0, 0, 2),
    )


def test_axes_have_length_one():
    assert hinge(axis=(1, 2, 2)).axis == (Fraction(1, 3), Fraction(2, 3), Fraction(2, 3))
    assert float(sum(x * x for x in hinge(axis=(1, 1, 0)).axis)) == pytest.approx(1, abs=1e-15)
    assert hinge(axis=(sp.sin(q), 0, sp.cos(q))).axis[1] == 0


def test_motion_by_an_expression_of_time():
    t = sp.Symbol("t", real=True)
    motion = Motion(sp.sin(2 * t))
    assert motion.rate == (2 * sp.cos(2 * t),)
    assert motion.acceleration == (-4 * sp.sin(2 * t),)
    assert Motion(3).rate == (0,)


def test_names_of_variables():
    given = Tree(
        "robot", [arm], [Joint("base", "free", "ground", "arm", attitude="3-2-1", motor=True)]
    )
    system = derive(given)
    assert system.state_names[:6] == (
        "x_base",
        "y_base",
        "z_base",
        "q_base_1",
        "q_base_2",
        "q_base_3",
    )
    assert system.state_names[6:8] == ("w_base_1", "w_base_2")
    assert system.input_names == tuple(f"tau_base_{n}{k}" for n in "wv" for k in (1, 2, 3))
    assert system.singularities[0].coordinate.name == "q_base_2"
