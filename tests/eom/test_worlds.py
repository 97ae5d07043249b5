"""Each assumption is what the worlds satisfy, and nothing more than that."""

from itertools import combinations

import pytest

from eom.derivations.verification import decide
from eom.errors import InputError
from eom.exact import series
from eom.exact.series import Series
from eom.fields import RATIONALS
from eom.terms.terms import (
    Equation,
    add,
    column,
    cross,
    der,
    dot,
    integral,
    mul,
    number,
    outer,
    zero,
)
from eom.terms.vocabulary import mass, omega, position, quantity, unit, velocity
from eom.worlds.generators import world, worlds
from eom.worlds.worlds import ASSUMPTIONS, closure
from tests.eom.rows import every, only

NOUGHT = zero("vector")
B1, B2, B3 = (unit("B", k) for k in (1, 2, 3))
R = position("dm", "C")
J = quantity("inertia", "C")
TORQUE = quantity("torque", "body", "C")
EXHAUST = quantity("exhaust_velocity", "open")
F_IJ, F_JI = quantity("internal_force", "i", "j"), quantity("internal_force", "j", "i")


def is_zero(term):
    return Equation(term, zero(term.kind))


def distance(a, b):
    return dot(position(a, b), position(a, b))


CLAIMS = {
    "constant_mass": is_zero(der(mass("i"))),
    "newton_2": Equation(
        dot(quantity("external_force", "system"), quantity("vector", "v")),
        dot(der(quantity("linear_momentum", "system")), quantity("vector", "v")),
    ),
    "third_law_weak": Equation(F_IJ, -F_JI),
    "third_law_strong": is_zero(cross(position("i", "j"), F_IJ)),
    "rigid": is_zero(der(distance("i", "j"))),
    "body_frame": is_zero(der(position("i", "j"), "B")),
    "about_centre": Equation(position("O"), position("C")),
    "O_fixed_in_body": is_zero(der(distance("i", "O"))),
    "O_fixed_in_space": is_zero(velocity("O")),
    "O_at_origin": is_zero(position("O")),
    "principal_axes": is_zero(dot(B1, dot(J, B2))),
    "symmetric": Equation(dot(B1, dot(J, B1)), dot(B2, dot(J, B2))),
    "symmetric_1": Equation(dot(B2, dot(J, B2)), dot(B3, dot(J, B3))),
    "symmetric_2": Equation(dot(B3, dot(J, B3)), dot(B1, dot(J, B1))),
    "principal_at_O": is_zero(dot(B1, dot(quantity("inertia", "O"), B2))),
    "O_uniform": is_zero(der(velocity("O"))),
    "fixed_axis": is_zero(cross(der(omega()), omega())),
    "steady_turn": is_zero(der(omega())),
    "plane_body": is_zero(dot(B3, position("i", "O"))),
    "exhaust_at_rest": is_zero(add(EXHAUST, velocity("open"))),
    "exhaust_with_body": is_zero(EXHAUST),
    "steady_rotors": is_zero(der(quantity("rotor_speed", "k"))),
    "torque_free": is_zero(TORQUE),
    "A_fixed_in_body": is_zero(der(position("i", "j"), "A")),
    "thin_rod": is_zero(cross(position("i", "C"), position("j", "C"))),
    "no_torque_2": is_zero(dot(B2, TORQUE)),
    "no_torque_3": is_zero(dot(B3, TORQUE)),
}
"""A statement that an assumption makes true; `ALONG` is assumed beside, under which it is false."""
ALONG = {
    "newton_2": ("third_law_weak", "constant_mass"),
    "third_law_strong": ("third_law_weak",),
    "body_frame": ("rigid",),
    "principal_axes": ("body_frame",),
    **dict.fromkeys(("symmetric", "symmetric_1", "symmetric_2"), ("principal_axes",)),
    "principal_at_O": ("body_frame", "O_fixed_in_body"),
    "plane_body": ("body_frame", "O_fixed_in_body"),
    "steady_turn": ("fixed_axis",),
    "steady_rotors": ("rotors",),
    "torque_free": ("body_frame", "newton_2", "third_law_strong", "constant_mass"),
    "A_fixed_in_body": ("body_frame",),
    "thin_rod": ("body_frame",),
    "O_fixed_in_body": ("rigid",),
    "O_at_origin": ("O_fixed_in_space",),
    "no_torque_2": ("no_torque_3", "third_law_strong"),
    "no_torque_3": ("no_torque_2", "third_law_strong"),
}


@pytest.mark.parametrize("name", CLAIMS)
def test_an_assumption_makes_its_statement_true_and_is_needed(name):
    beside = ALONG.get(name, ())
    assert decide(CLAIMS[name], (name, *beside), {})
    assert not decide(CLAIMS[name], beside, {})


NOT_SO = {
    "O is not C unless it is said": (
        Equation(position("O"), position("C")),
        ("rigid", "O_fixed_in_body"),
    ),
    "weak law, central": (is_zero(cross(position("i", "j"), F_IJ)), ("third_law_weak",)),
    "no third law": (Equation(F_IJ, -F_JI), ("newton_2",)),
    "principal, not about O": (
        is_zero(dot(B1, dot(quantity("inertia", "O"), B2))),
        ("principal_axes",),
    ),
    "three different moments": (
        Equation(dot(B1, dot(J, B1)), dot(B2, dot(J, B2))),
        ("principal_axes",),
    ),
    "symmetric, no sphere": (Equation(dot(B1, dot(J, B1)), dot(B3, dot(J, B3))), ("symmetric",)),
    "a body in the plane": (is_zero(dot(B3, R)), ("body_frame",)),
    "A fixed in the body is not B": (Equation(unit("A", 1), B1), ("A_fixed_in_body",)),
    "torque_free, not at rest": (is_zero(omega()), ("torque_free",)),
    "torque_free, no constant rate": (is_zero(der(omega())), ("torque_free",)),
    "torque_free, no steady centre": (is_zero(der(velocity("C"))), ("torque_free",)),
    "rods lie anywhere": (is_zero(cross(B1, R)), ("thin_rod",)),
    "O fixed in the body moves": (is_zero(velocity("O")), ("O_fixed_in_body",)),
    "O fixed in space is no origin": (is_zero(position("O")), ("O_fixed_in_space",)),
    "C does not rest": (is_zero(velocity("C")), ("rigid",)),
    "no_torque_2 is about one axis": (
        is_zero(dot(B3, TORQUE)),
        ("no_torque_2", "third_law_strong"),
    ),
    "B of 3-1-2 does not spin": (Equation(omega("B"), omega("C")), ("spin_312",)),
    "rotors in the body": (is_zero(quantity("rotor_speed", "k")), ("rotors",)),
}


@pytest.mark.parametrize("name", NOT_SO)
def test_nothing_more_than_assumed(name):
    equation, assumed = NOT_SO[name]
    assert not decide(equation, assumed, {})


@pytest.mark.parametrize("assumption", ["principal_axes", "symmetric", "viscous_slug"])
def test_third_moments_do_not_vanish(assumption):
    along = dot(B1, R)
    assert not decide(is_zero(integral(mul(along, along, along))), (assumption,), {})


def test_fourth_moments_do_not_vanish():
    products = mul(dot(B1, R), dot(B1, R), dot(B2, R), dot(B2, R))
    assert not decide(is_zero(integral(products)), ("principal_axes", "A_fixed_in_body"), {})


def test_particles_may_lose_mass_and_a_rigid_body_does_not():
    assert not decide(is_zero(der(mass("i"))), ("newton_2",), {})
    assert "constant_mass" in closure(["rigid"])


@pytest.mark.parametrize(
    ("statement", "assumed"),
    [
        (is_zero(velocity("C")), ("C_at_rest",)),
        (is_zero(velocity("C")), ("C_at_rest", "rotors")),
        (is_zero(velocity("O")), ("about_centre", "O_fixed_in_space")),
        (is_zero(position("O")), ("about_centre", "O_at_origin")),
        (is_zero(velocity("C")), ("C_at_rest", "viscous_slug")),
    ],
)
def test_resting_points_of_any_system(statement, assumed):
    assert decide(statement, assumed, {})


def test_resting_points_of_a_rigid_body():
    assert decide(is_zero(velocity("C")), ("C_at_rest", "rigid"), {})
    both = ("rigid", "about_centre", "O_at_origin")
    assert decide(is_zero(position("C")), both, {})
    assert decide(is_zero(velocity("C")), both, {})


def test_the_twelve_conditions_of_a_frame():
    for assumed in (
        (),
        ("torque_free",),
        ("spin_312", "no_torque_2"),
        ("rotors",),
        ("viscous_slug",),
    ):
        w = world(closure(assumed), 1)
        for C in w.frames.values():
            square = series.product(C, series.transpose(C))
            assert all(
                (square[i][j] - w.constant(int(i == j))).is_zero for i in range(3) for j in range(3)
            )
            third = series.cross((C[0][0], C[0][1], C[0][2]), (C[1][0], C[1][1], C[1][2]))
            assert all((a - b).is_zero for a, b in zip(third, C[2], strict=True))


def test_the_3_1_2_sequence_by_its_angles():
    names = ("psi", "theta", "phi")
    psi, theta, phi = (mul(der(quantity("angle", n))) for n in names)
    turning = add(mul(psi, unit("I", 3)), mul(theta, unit("A", 1)), mul(phi, unit("B", 2)))
    assert decide(Equation(omega("C"), turning), ("spin_312",), {})
    assert decide(Equation(unit("C", 2), B2), ("spin_312",), {})
    inner = dot(unit("C", 1), dot(J, unit("C", 1)))
    assert decide(Equation(inner, dot(unit("C", 3), dot(J, unit("C", 3)))), ("spin_312",), {})
    assert not decide(Equation(inner, dot(B2, dot(J, B2))), ("spin_312",), {})


def test_rotors_turn_about_their_axes_without_moving_the_centre():
    axis, speed = quantity("rotor_axis", "k"), quantity("rotor_speed", "k")
    assert decide(is_zero(der(position("C", "O"), "B")), ("rotors", "about_centre"), {})
    assert decide(is_zero(der(axis, "B")), ("rotors",), {})
    assert decide(Equation(dot(axis, axis), number(1)), ("rotors",), {})
    spin = mul(quantity("rotor_inertia", "k"), add(speed, dot(axis, omega())))
    assert decide(Equation(dot(axis, quantity("rotor_momentum", "k")), spin), ("rotors",), {})


def test_the_slug_drags_on_the_body():
    slug = quantity("slug_momentum")
    drag = mul(number(-1), quantity("slug_damping"), omega("S", "B"))
    assert decide(Equation(der(slug), drag), ("viscous_slug",), {})
    assert decide(Equation(slug, mul(quantity("slug_inertia"), omega("S"))), ("viscous_slug",), {})
    assert decide(is_zero(der(quantity("angular_momentum", "system", "C"))), ("viscous_slug",), {})


def test_the_inertia_dyadic_is_symmetric_and_turns_with_the_body():
    assert decide(is_zero(der(J, "B")), ("body_frame",), {})
    assert not decide(is_zero(der(J, "B")), ("rigid",), {})
    a, b = quantity("vector", "a"), quantity("vector", "b")
    assert decide(Equation(dot(a, dot(J, b)), dot(b, dot(J, a))), (), {})
    assert not decide(is_zero(outer(a, b)), (), {})


def test_closure():
    needed = {"symmetric", "principal_axes", "body_frame", "rigid", "constant_mass"}
    assert closure(["symmetric"]) == needed
    special = ["C_at_rest", "O_fixed_in_body", "O_fixed_in_space"]
    with pytest.raises(InputError, match="no generator"):
        closure(special)
    assert "rigid" in closure([*special, "about_centre"])
    assert closure([]) == frozenset()
    with pytest.raises(InputError, match="rigidity"):
        closure(["rigidity"])
    for pair in (("rigid", "one_particle"), ("rotors", "rigid"), ("thin_rod", "symmetric"),
                 ("spin_312", "torque_free"), ("viscous_slug", "body_frame"),
                 ("thin_rod", "torque_free")):  # fmt: skip
        for order in (pair, pair[::-1]):
            with pytest.raises(InputError, match="cannot stand together"):
                closure(order)


def test_rows_of_the_table_speak_of_each_other():
    for row in ASSUMPTIONS.values():
        assert {*row.needs, *row.excludes} <= set(ASSUMPTIONS)


def allowed(size):
    for names in combinations(ASSUMPTIONS, size):
        try:
            yield closure(names)
        except InputError:
            continue


@pytest.mark.parametrize("size", only([0, 1, 2], 0, 1))
def test_every_allowed_set_has_worlds(size):
    for assumed in sorted(set(allowed(size)), key=sorted):
        if not {"thin_rod", "torque_free"} <= assumed:
            assert world(assumed, 7).masses


def test_a_seed_makes_the_same_world_and_another_one_does_not():
    assumed = closure(["torque_free", "symmetric"])
    first = world(assumed, 3)
    world.cache_clear()
    again = world(closure(["symmetric", "torque_free"]), 3)
    assert first is not again
    assert (first.places, first.forces, first.frames) == (again.places, again.forces, again.frames)
    assert world(assumed, 4).places != first.places
    assert len(list(worlds(["rigid"], 5))) == 5


def test_sizes_differ_between_worlds():
    assert len({len(w.masses) for w in worlds((), 8)}) > 1
    assert len({len(w.rotors) for w in worlds(["rotors"], 8)}) > 1
    assert {len(w.rotors) for w in worlds(["one_rotor"], 8)} == {1}
    assert all(len(w.masses) == 1 for w in worlds(["one_particle"], 3))


@pytest.mark.parametrize(
    "name",
    every(
        2, "constant_mass rigid thin_rod principal_axes rotors newton_2 symmetric spin_312".split()
    ),
)
def test_rational_worlds_have_positive_masses(name):
    for w in worlds([name], 12, RATIONALS):
        assert all(m.coefficients[0] > 0 for m in w.masses)


def test_what_is_not_there_is_refused():
    w = world(frozenset(), 0)
    with pytest.raises(InputError, match="frame"):
        w.rotation("C", "I")
    with pytest.raises(InputError, match="point"):
        w.place("Q")
    with pytest.raises(InputError, match="slug"):
        w.primitive("slug_momentum", ())


@pytest.mark.parametrize(("name", "labels"), [("angle", ["psi"]), ("rotor_speed", [0])])
def test_quantities_of_other_worlds_are_refused(name, labels):
    with pytest.raises(InputError):
        world(frozenset(), 0).primitive(name, labels)


def test_free_quantities_change_with_time_name_and_world():
    v = [world(frozenset(), s).primitive("vector", [n]) for s, n in ((0, "a"), (0, "b"), (1, "a"))]
    assert len({x[0].coefficients for x in v}) == 3
    assert not v[0][0].derivative().is_zero
    w = world(frozenset(), 0)
    assert w.primitive("scalar", ["s"]).derivative().is_zero
    fixed = w.primitive("fixed_vector", ["a", "B"])
    assert all(isinstance(c, Series) for c in fixed)
    assert decide(is_zero(der(quantity("fixed_vector", "a", "B"), "B")), (), {})
    assert not decide(is_zero(der(column(quantity("fixed_vector", "a", "B"), "I"))), (), {})
    assert not decide(Equation(integral(R), NOUGHT - quantity("vector", "a")), (), {})


def test_an_element_has_no_mass_of_its_own():
    with pytest.raises(InputError, match="under an integral alone"):
        world(frozenset(), 0).primitive("mass", ("dm",))
