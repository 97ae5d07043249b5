"""Special motions are motions: Newton's laws, Euler's equations, and what each is said to fulfil."""

from itertools import islice

import sympy as sp

from eom.exact import series
from eom.terms.terms import Equation, der, dot, zero
from eom.terms.vocabulary import omega, position, quantity, unit
from eom.worlds.evaluate import Evaluator
from eom.worlds.special import FIRST_CASES, specials

H = quantity("angular_momentum", "body", "C")
M = quantity("torque", "body", "C")
I = quantity("inertia", "C")
FULFILLED = {
    "torque_free": M,
    "about_centre": position("C", "O"),
    "O_fixed_in_space": der(position("O", "OI")),
    "O_fixed_in_body": der(position("O", "C"), "B"),
    "C_at_rest": der(position("C", "OI")),
    "O_at_origin": position("O", "OI"),
}


def test_angular_momentum_changes_by_the_torque_and_follows_from_inertia():
    for special in islice(specials(), 0, None, 3):
        e = Evaluator(special.world, {})
        assert e.holds(Equation(der(H), M)), special.words
        assert e.holds(Equation(H, dot(I, omega()))), special.words
        assert all(m.coefficients[0] > 0 for m in special.world.masses)


def test_each_fulfils_what_it_says_and_nothing_else_of_the_kind():
    for special in specials():
        e = Evaluator(special.world, {})
        for name, term in FULFILLED.items():
            assert e.holds(Equation(term, zero("vector"))) == (name in special.assumed), (
                special.words
            )
        diagonal = all(
            e.value(dot(unit("B", a), dot(I, unit("B", b)))).is_zero
            for a, b in ((1, 2), (1, 3), (2, 3))
        )
        assert diagonal == bool({"principal_axes", "thin_rod"} & special.assumed)


def test_frames_are_rotations():
    for special in specials():
        B = special.world.rotation("B", "I")
        unity = series.product(B, series.transpose(B))
        for i, row in enumerate(unity):
            for j, entry in enumerate(row):
                assert entry.coefficients == (int(i == j), 0, 0, 0, 0)


def test_the_numbers_reported_fulfil_eulers_equations():
    for special in specials():
        inertia, rates, growth, torque = (text for _, text in special.data)
        if not inertia.startswith(r"\mathrm{diag}"):
            continue
        J = sp.diag(*map(sp.Rational, inertia[len(r"\mathrm{diag}") :].strip("()").split(", ")))
        w, a, m = (
            sp.Matrix([sp.Rational(c) for c in t.strip("()").split(", ")])
            for t in (rates, growth, torque)
        )
        assert J * a + w.cross(J * w) == m, special.words


def test_the_first_ones_have_the_centre_of_mass_as_reference_point():
    cases = list(specials())
    needed = {"about_centre", "O_fixed_in_space", "body_frame", "newton_2", "third_law_strong"}
    assert len(cases) > FIRST_CASES
    assert all(needed <= s.assumed for s in cases[:FIRST_CASES])
