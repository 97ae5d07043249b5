"""Relations of constraints: rows and drifts are the derivatives of values, for every kind."""

import math
import random
from dataclasses import replace

import pytest
import sympy as sp

from eom.errors import InputError
from eom.multibody import (
    GROUND,
    Body,
    Coupling,
    Distance,
    Equation,
    Joint,
    KnifeEdge,
    Loop,
    Placement,
    Rolling,
    SpeedEquation,
    Tree,
)
from eom.multibody.algebra.scalars import Dual, DualWork, parts
from eom.multibody.constrained.dependence import FLOATS
from eom.multibody.constrained.equations import components, plane_directions
from eom.multibody.constrained.relations import Arithmetic, scene
from eom.multibody.model.constraints import CLOSING
from eom.multibody.recursion.lumped_tree import lumped_tree
from eom.multibody.recursion.motion import coordinate_rates
from tests.eom.multibody.trees import MOVING, axis, state, tree, turned
from tests.eom.rows import every

BODY = {"first": "b1", "second": "b3"}


def floats(x):
    return x if x in {0, 1, -1} else float(x)


def root(x):
    value, rate = parts(x)
    found = math.sqrt(value)
    return Dual(found, rate / (2 * found)) if isinstance(x, Dual) else found


def placed(draw):
    return Placement([draw.uniform(-1, 1) for _ in range(3)], turned(draw))


def loop(kind):
    def made(draw, names):
        return Loop(
            "c", kind, *names, axis=axis(draw), second_axis=(3, 5, -7),
            on_first=placed(draw), on_second=placed(draw),
        )  # fmt: skip

    return made


def points(draw):
    return [[draw.uniform(-1, 1) for _ in range(3)] for _ in range(2)]


KINDS = {
    **{kind: loop(kind) for kind in CLOSING},
    "distance": lambda draw, names: Distance("c", *names, 2, *points(draw)),
    "wheel": lambda draw, names: Rolling(
        "c", names[1], 2, axis=axis(draw), centre=points(draw)[0], normal=(1, 2, 2)
    ),
    "ball": lambda draw, names: Rolling("c", names[1], 2, axis=None, centre=points(draw)[0]),
    "knife_edge": lambda draw, names: KnifeEdge("c", names[1], axis(draw), points(draw)[0]),
}


def two_bodies(given, draw):
    names = [b.name for b in given.bodies]
    first = draw.choice([GROUND, *names])
    return first, draw.choice([n for n in names if n != first])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", every(2, range(4)))
def test_rows_and_drifts_are_derivatives(kind, seed):
    """Values, and rates with the speeds held, are computed with their derivatives by time."""
    draw = random.Random(seed)
    given = replace(tree(seed, 5), loads=())
    given = replace(given, constraints=(KINDS[kind](draw, two_bodies(given, draw)),))
    q, u = ([float(x) for x in group] for group in state(given, seed))
    lumped = lumped_tree(given, floats, FLOATS)
    rates = coordinate_rates(lumped, q, u, FLOATS)
    moving = [Dual(x, rate) for x, rate in zip(q, rates, strict=True)]
    at = components(given, scene(lumped, q, u, Arithmetic(floats, FLOATS, root)))
    carried = components(
        given, scene(lumped, moving, None, Arithmetic(floats, DualWork(FLOATS), root))
    )
    assert at
    for here, along in zip(at, carried, strict=True):
        rate = sum(x * u[s] for s, x in here.relation.row().items()) + here.relation.offset()
        value = along.relation.value()
        if value is not None:
            assert parts(value)[1] == pytest.approx(rate, rel=1e-10, abs=1e-9)
        turned_rate = 0
        for s, x in along.relation.row().items():
            turned_rate = turned_rate + x * u[s]
        assert parts(turned_rate)[1] == pytest.approx(here.relation.drift(), rel=1e-10, abs=1e-8)


@pytest.mark.parametrize("kind", [k for k in MOVING if k != "helical"])
def test_equations_of_the_user_have_the_derivatives_of_what_they_say(kind):
    """One equation over all coordinates of a joint: its speeds' row and drift, by central differences."""
    joint = Joint("j", kind, GROUND, "b1", axis="x", second_axis="y", attitude="2-3-1")
    names = [c.symbol for c in joint.coordinates]
    t = sp.Symbol("t", real=True)
    phi = sp.Add(*((k + 2) * x * names[0] for k, x in enumerate(names))) * sp.cos(t) - 1
    given = Tree("t", [Body("b1", 1)], [joint], constraints=[Equation("c", phi)])
    draw = random.Random(3)
    q, u = ([draw.uniform(0.2, 1) for _ in group] for group in (joint.coordinates, joint.speeds))
    lumped = lumped_tree(given, floats, FLOATS)

    def at(h):
        """Value and rate after h seconds with the speeds held, by small steps of fourth order."""
        x = list(q)
        for _ in range(4):
            x = _step(lambda y: coordinate_rates(lumped, y, u, FLOATS), x, h / 4)
        return _numbers(given, lumped, joint, x, u, 0.7 + h)

    h = 1e-3
    before, here, after = at(-h), at(0.0), at(h)
    assert (after[0] - before[0]) / (2 * h) == pytest.approx(here[1], rel=1e-4)
    assert (after[1] - before[1]) / (2 * h) == pytest.approx(here[2], rel=1e-4)


def _step(rate, x, h):
    def moved(k, part):
        return [a + part * h * b for a, b in zip(x, k, strict=True)]

    k1 = rate(x)
    k2 = rate(moved(k1, 0.5))
    k3 = rate(moved(k2, 0.5))
    k4 = rate(moved(k3, 1))
    return [a + h / 6 * (p + 2 * s + 2 * r + e)
            for a, p, s, r, e in zip(x, k1, k2, k3, k4, strict=True)]  # fmt: skip


def _numbers(given, lumped, joint, q, u, t):
    known = {c.symbol: x for c, x in zip(joint.coordinates, q, strict=True)}
    known[sp.Symbol("t", real=True)] = t

    def lift(x):
        return float(x.subs(known)) if isinstance(x, sp.Basic) else floats(x)

    (c,) = components(given, scene(lumped, q, u, Arithmetic(lift, FLOATS, math.sqrt)))
    rate = sum(x * u[s] for s, x in c.relation.row().items()) + c.relation.offset()
    return c.relation.value(), rate, c.relation.drift()


@pytest.mark.parametrize(
    "normal", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0, 3, 4), (1, 2, 2), (-2, 3, 6)]
)
def test_directions_of_a_plane_are_right_handed(normal):
    n = Rolling("c", "b", 1, normal=normal).normal
    e, f = plane_directions(n)
    cross = [e[i] * f[j] - e[j] * f[i] for i, j in ((1, 2), (2, 0), (0, 1))]
    assert [float(x) for x in cross] == pytest.approx([float(x) for x in n], abs=1e-15)


def bound(*constraints):
    joints = [Joint("j", "revolute", GROUND, "b"), Joint("k", "free", "b", "c")]
    return Tree("t", [Body("b", 1), Body("c", 1)], joints, constraints=constraints)


u, w = sp.symbols("u_j w_k_1", real=True)
ERRORS = {
    "unknown body 'x'": lambda: bound(Loop("c", "revolute", "b", "x")),
    "a body is bound to itself": lambda: bound(Distance("c", "b", "b", 1)),
    "no joint of kind 'free' closes a loop": lambda: bound(Loop("c", "free", "b", "c")),
    "the distance is not positive": lambda: bound(Distance("c", "b", "c", 0)),
    "the radius is not positive": lambda: bound(Rolling("c", "b", -1)),
    "the axis is zero": lambda: bound(KnifeEdge("c", "b", (0, 0, 0))),
    "the two axes are parallel": lambda: bound(
        Loop("c", "universal", "b", "c", axis="z", second_axis="z")
    ),
    "the equation has no coordinate": lambda: bound(Equation("c", sp.Symbol("x"))),
    "the equation has speeds": lambda: bound(Equation("c", sp.Symbol("q_j", real=True) - u)),
    "the equation has no speed": lambda: bound(SpeedEquation("c", sp.Symbol("q_j", real=True))),
    "the equation is not linear in the speeds": lambda: bound(SpeedEquation("c", u * w + u)),
    "unknown joint 'x'": lambda: bound(Coupling("c", {"j": 1, "x": 2})),
    "a coupling needs joints of one speed": lambda: bound(Coupling("c", {"j": 1, "k": 2})),
    "a coupling needs at least two joints": lambda: bound(Coupling("c", {"j": 1})),
    "repeated name of a constraint": lambda: bound(KnifeEdge("c", "b"), KnifeEdge("c", "c")),
    "a length or direction of a constraint is not constant": lambda: bound(
        Distance("c", "b", "c", 2 + u**2)
    ),
    "a symbolic normal": lambda: bound(
        Rolling("c", "b", 1, normal=(
            sp.sin(w) * sp.cos(u), sp.sin(w) * sp.sin(u), sp.cos(w)))
    ),
    "not a name": lambda: bound(KnifeEdge("a b", "b")),
}  # fmt: skip


@pytest.mark.parametrize("message", ERRORS)
def test_errors_name_the_constraint(message):
    with pytest.raises(InputError, match=r"c'|tree 't'|a b") as error:
        ERRORS[message]()
    assert error.value.what.startswith(message)
