"""Redundant, contradicting and locking constraints; consistent start values."""

import math

import pytest
import sympy as sp

from eom.errors import InputError
from eom.multibody import (
    GROUND,
    Body,
    Distance,
    Equation,
    Joint,
    Loop,
    Motion,
    Placement,
    Rolling,
    SpeedEquation,
    Tree,
    assemble,
    derive,
    examine,
)
from tests.eom.multibody.bound import LENGTHS, NEAR, ROTATION, disc, four_bar

CORNERS = ((0, 0, 0), (1, 0, 0), (0, 1, 0))


@pytest.mark.parametrize("rotation", [Placement().rotation, ROTATION], ids=["plane", "tilted"])
def test_a_plane_linkage_of_spatial_hinges_needs_two_equations_of_five(rotation):
    found = examine(four_bar(rotation=rotation))
    assert found.freedom == 1
    assert len(found.kept) == 2
    assert len(found.remarks) == 3
    assert all("'pin'" in text for text in found.remarks)
    assert "redundant" in {a.name for a in derive(four_bar(rotation=rotation)).assumptions}


def test_every_joint_that_leaves_the_plane_free_gives_the_same_two_equations():
    for kind in ("spherical", "cylindrical"):
        assert len(examine(four_bar(kind)).kept) == 2
    with pytest.raises(InputError, match="leave no motion"):
        examine(four_bar("prismatic"))


def floating(*constraints):
    bodies = [Body("plate", 1, (0, 0, 0), (1, 1, 1))]
    return Tree("plate", bodies, [Joint("j", "free", GROUND, "plate")], constraints=constraints)


def rods(lengths, to=(0, 0, 3)):
    return [Distance(f"rod{k}", GROUND, "plate", n, to) for k, n in enumerate(lengths, 1)]


def test_a_rod_twice_is_named_with_what_it_depends_on():
    found = examine(floating(*rods((2, 2))))
    assert found.remarks == ("constraint 'rod2' depends on 'rod1'",)
    assert found.freedom == 5


def test_rods_that_contradict_each_other_are_refused():
    with pytest.raises(InputError, match=r"'rod1' left by .*'rod2' left by"):
        derive(floating(*rods((2, 3))))


def test_lengths_that_do_not_reach_are_refused():
    with pytest.raises(InputError, match="lengths do not reach"):
        assemble(four_bar(), {**LENGTHS, **NEAR, "L2": 2.8})


def test_rates_that_contradict_each_other_are_refused():
    u = sp.Symbol("u_a", real=True)
    pace = [SpeedEquation(n, u - x) for n, x in (("one", 1), ("two", 2))]
    with pytest.raises(InputError, match="contradict") as error:
        derive(four_bar(extra=pace))
    assert "'two'" in error.value.where
    assert "'one'" in error.value.expected


def test_a_frame_is_reported():
    with pytest.raises(InputError, match="leave no motion"):
        derive(floating(Loop("weld", "fixed", GROUND, "plate")))
    driven = four_bar(motion=Motion(sp.Symbol("t", real=True)))
    assert derive(driven).state_names == ("q_b", "q_c", "u_b", "u_c")


def test_six_rods_leave_a_plate_no_motion_and_five_one():
    ends = [(c, o) for c in CORNERS for o in ((0, 0, 2), (1, 1, 2))]
    legs = [
        Distance(f"leg{k}", GROUND, "plate", 2, (3 * a[0], 3 * a[1], 0), (b[0], a[1], b[2]))
        for k, (a, b) in enumerate(ends)
    ]
    assert examine(floating(*legs[:5])).freedom == 1
    with pytest.raises(InputError, match="leave no motion"):
        examine(floating(*legs))


def bennett():
    """Four hinges in space; lengths of links as the sines of their twists."""

    def twist(a):
        return ((1, 0, 0), (0, math.cos(a), math.sin(a)), (0, -math.sin(a), math.cos(a)))

    short, long, alpha = 1.0, 1.4, 0.7
    beta = math.asin(math.sin(alpha) * long / short)
    links = ((short, alpha), (long, beta), (short, alpha))
    place, before, joints = Placement(), GROUND, []
    for k, (length, angle) in enumerate(links, 1):
        joints.append(Joint(f"j{k}", "revolute", before, f"b{k}", on_parent=place))
        place, before = Placement((length, 0, 0), twist(angle)), f"b{k}"
    end = Placement((-long, 0, 0), twist(-beta))
    bodies = [Body(f"b{k}", 1, (0, 0, 0), (1, 1, 1)) for k in (1, 2, 3)]
    hinge = Loop("j4", "revolute", "b3", GROUND, on_first=place, on_second=end)
    return Tree("bennett", bodies, joints, constraints=[hinge])


def test_a_linkage_that_moves_against_the_count():
    """Three speeds and five equations, of which two are independent: Bennett (1903)."""
    found = examine(bennett())
    assert found.freedom == 1
    assert len(found.kept) == 2


# --- consistent start values ---------------------------------------------------------------------------


def test_what_is_kept_does_not_change_and_what_changes_is_reported():
    given = four_bar()
    found = assemble(given, {**LENGTHS, **NEAR, "u_a": 3.0}, keep=("q_a", "u_a"))
    assert found.values["q_a"] == NEAR["q_a"]
    assert found.values["u_a"] == 3.0
    assert set(found.changes) == {"q_b", "q_c", "u_b", "u_c"}
    assert found.left < 1e-14
    again = assemble(given, {**LENGTHS, **found.values})
    assert not again.changes
    assert str(again) == "start values meet the constraints as they are"


def test_speeds_are_the_nearest_in_their_weights():
    """On a line 4 u_x = 3 u_y the point nearest to (1, 0): by calculus, for any weights."""
    x, y = (sp.Symbol(f"u_{n}", real=True) for n in "xy")
    joints = [
        Joint("x", "prismatic", GROUND, "slide", "x"),
        Joint("y", "prismatic", "slide", "b", "y"),
    ]
    given = Tree("t", [Body("slide", 1), Body("b", 1)], joints,
                 constraints=[SpeedEquation("line", 4 * x - 3 * y)])  # fmt: skip
    plain = assemble(given, {"u_x": 1.0}).values
    assert (plain["u_x"], plain["u_y"]) == pytest.approx((0.36, 0.48), rel=1e-14)
    w = 2.0
    share = 9 * w**2 / (9 * w**2 + 16)
    heavy = assemble(given, {"u_x": 1.0}, weights={"u_x": w}).values
    assert (heavy["u_x"], heavy["u_y"]) == pytest.approx((share, share * 4 / 3), rel=1e-14)


def test_the_change_of_coordinates_is_the_least():
    """Onto a circle of radius 5: along its radius."""
    q = [sp.Symbol(f"q_{n}", real=True) for n in "xy"]
    joints = [
        Joint("x", "prismatic", GROUND, "slide", "x"),
        Joint("y", "prismatic", "slide", "b", "y"),
    ]
    given = Tree("t", [Body("slide", 1), Body("b", 1)], joints,
                 constraints=[Equation("circle", q[0] ** 2 + q[1] ** 2 - 25)])  # fmt: skip
    found = assemble(given, {"q_x": 3.3, "q_y": 4.4}).values
    assert (found["q_x"], found["q_y"]) == pytest.approx((3, 4), rel=1e-14)


def test_attitudes_stay_attitudes():
    found = assemble(disc(), {"r": 0.4, "m": 1, "g": 9.81, "z_j": 1.0, "e_j_0": 0.9, "e_j_1": 0.2})
    norm = sum(found.values[f"e_j_{k}"] ** 2 for k in range(4))
    assert norm == pytest.approx(1, rel=1e-15)
    assert found.left < 1e-14


def test_a_straight_linkage_is_reported():
    lengths = {"L1": 0.5, "L2": 1.0, "L3": 0.5, "d": 1.0, "g": 9.81}
    with pytest.raises(InputError, match="singular configuration"):
        assemble(four_bar(), {**lengths, "q_a": 0.0, "q_b": 0.0, "q_c": 0.0})


def test_a_joint_that_is_turned_round_is_reported():
    given = floating(Loop("hinge", "revolute", GROUND, "plate"))
    over = {"e_j_0": 0.0, "e_j_1": 1.0}
    with pytest.raises(InputError, match="turned round"):
        assemble(given, over)
    assert not assemble(given, {}).changes


def test_a_wheel_that_lies_flat_has_no_start():
    flat = {"r": 0.4, "m": 1, "g": 9.81, "e_j_0": math.sqrt(0.5), "e_j_1": math.sqrt(0.5)}
    with pytest.raises(InputError, match=r"lie flat|singular|meets the constraints"):
        assemble(disc(), flat)


@pytest.mark.parametrize(
    ("values", "options", "message"),
    [
        ({"x": 1.0}, {}, "unknown name"),
        ({"q_a": math.nan}, {}, "not a finite number"),
        ({}, {"keep": ("q_x",)}, "unknown speed or coordinate"),
        ({}, {"weights": {"u_a": 0.0}}, "not positive"),
        ({"L1": None}, {}, "no value"),
    ],
    ids=["name", "nan", "keep", "weight", "parameter"],
)
def test_start_values_that_cannot_be_used(values, options, message):
    given = {n: v for n, v in {**LENGTHS, **NEAR, **values}.items() if v is not None}
    with pytest.raises(InputError, match=message):
        assemble(four_bar(), given, **options)


def test_a_wheel_on_a_chain_of_joints_is_the_same_wheel():
    """Three slides and three turns in place of a free joint: as many equations are kept."""
    wheel = Body("wheel", 1, (0, 0, 0), (1, 2, 1))
    names = ("x", "y", "z")
    joints, before, bodies = [], GROUND, []
    for kind, axes in (("prismatic", "xyz"), ("revolute", "zxy")):
        for a in axes:
            child = "wheel" if (kind, a) == ("revolute", "y") else f"{kind[0]}{a}"
            joints.append(Joint(f"{kind[0]}_{a}", kind, before, child, a))
            bodies.append(wheel if child == "wheel" else Body(child))
            before = child
    given = Tree("chain", bodies, joints, constraints=[Rolling("floor", "wheel", 2, axis="y")])
    assert len(names) == examine(given).freedom == 3


def chain(n):
    """Links on universal joints, the last of which ends on the ground."""
    joints, before = [], GROUND
    for k in range(1, n + 1):
        place = Placement() if k == 1 else Placement((1, 0, 0))
        joints.append(Joint(f"j{k}", "universal", before, f"b{k}", "y", "z", on_parent=place))
        before = f"b{k}"
    bodies = [Body(f"b{k}", 1, (0.5, 0, 0), (0.01, 0.1, 0.1)) for k in range(1, n + 1)]
    end = Loop("end", "spherical", GROUND, before, on_first=Placement((n / 2, 0, 0)),
               on_second=Placement((1, 0, 0)))  # fmt: skip
    return Tree("chain", bodies, joints, constraints=[end])


def test_definitions_of_a_closed_chain_grow_linearly():
    """And what would grow exponentially, constraints written out, is left out."""
    short, middle, long = (derive(chain(n)) for n in (3, 6, 9))
    assert [a.name for a in short.assumptions] == ["assembled"]
    assert long.assumptions == ()
    first, second = (
        len(b.definitions) - len(a.definitions) for a, b in ((short, middle), (middle, long))
    )
    assert second <= 1.1 * first
