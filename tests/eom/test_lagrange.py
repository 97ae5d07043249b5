"""Mechanisms by coordinates and places: against a tree of the same bodies, and constants of the motion."""

import pytest
import sympy as sp

from eom.errors import InputError
from eom.mechanics.lagrange import Mechanism, Placed, Spring, lagrange_system, speed
from eom.multibody.files.scene import TreeScene
from eom.quantities import Quantity

X, A, B, G, M, N, L, K, R = sp.symbols("x a b g m n l k r", real=True)


def mechanism(coordinates, bodies, gravity=(0, 0, -G), **more):
    known = {
        s
        for b in bodies.values()
        for e in (b.mass, *b.at, *b.moments)
        for s in sp.sympify(e).free_symbols
    }
    known |= {s for g in gravity for s in sp.sympify(g).free_symbols} | more.pop("names", set())
    given = more.pop("given", {})
    parameters = tuple(Quantity(s) for s in sorted(known - {*coordinates, *given}, key=str))
    return Mechanism("test", coordinates, given, parameters, bodies, gravity, **more)


def rates(system, at):
    names = {q.symbol: at[q.name] for q in (*system.states, *system.parameters)}
    found = sp.Matrix([system.expand(r) for r in system.rates]).xreplace(names)
    whole = system.mass_matrix
    return list(found if whole is None else sp.Matrix(whole).xreplace(names).LUsolve(found))


def test_a_pendulum_on_a_cart_is_the_tree_of_the_same_bodies():
    bob = (X + L * sp.sin(A), 0, -L * sp.cos(A))
    own = lagrange_system(
        mechanism({X: "m", A: "rad"}, {"c": Placed(N, (X, 0, 0)), "b": Placed(M, bob)})
    )
    tree = TreeScene(
        bodies={"c": {"mass": "n"}, "b": {"mass": "m", "centre": (0, 0, "-l")}},
        joints={
            "x": {"kind": "prismatic", "parent": "ground", "child": "c", "axis": "x"},
            "a": {"kind": "revolute", "parent": "c", "child": "b", "axis": "-y"},
        },
        gravity=(0, 0, "-g"),
        parameters={"m": 1, "n": 1, "l": 1, "g": 1},
    ).full_system
    at = {"x": 2, "a": sp.Rational(1, 3), "x_dot": -1, "a_dot": 3, "m": 2, "n": 5, "l": 4, "g": 10}
    other = {"q_x": 2, "q_a": at["a"], "u_x": -1, "u_a": 3, "m": 2, "n": 5, "l": 4, "g": 10}
    both = [rates(own, at), rates(tree, {**at, **other})]
    assert all(abs((a - b).evalf(30)) < 1e-20 for a, b in zip(*both, strict=True))


def test_three_coordinates_keep_the_mass_matrix_and_the_energy():
    places = [(X, 0, 0), (X + L * sp.sin(A), 0, -L * sp.cos(A))]
    third = (places[1][0] + L * sp.sin(B), 0, places[1][2] - L * sp.cos(B))
    bodies = {"c": Placed(N, places[0]), "d": Placed(M, places[1]), "e": Placed(M, third)}
    spring = Spring(((0, 0, 0), places[0]), K, R, ("", "c"))
    system = lagrange_system(
        mechanism({X: "m", A: "rad", B: "rad"}, bodies, springs=(spring,), names={K, R})
    )
    assert system.mass_matrix is not None
    at = dict(zip(("x", "a", "b", "x_dot", "a_dot", "b_dot"), (2, 1, 3, 1, 2, -1), strict=True))
    at |= {"m": 2, "n": 3, "l": 1, "g": 10, "k": 7, "r": 5}
    energy = next(d for d in system.outputs if d.name == "E").expression
    slope = sum(
        energy.diff(q.symbol) * v for q, v in zip(system.states, rates(system, at), strict=True)
    )
    assert (
        abs(
            slope.xreplace(
                {q.symbol: at[q.name] for q in (*system.states, *system.parameters)}
            ).evalf(30)
        )
        < 1e-20
    )


def test_reactions_are_what_is_left():
    spring = Spring(((0, 0, 0), (X, 0, 0)), K, sp.S.Zero, ("", "c"))
    body = Placed(M, (X, 0, 0), force=(0, R, 0))
    made = mechanism({X: "m"}, {"c": body}, springs=(spring,), names={K, R})
    assert made.reaction("c")[1:] == (-R, G * M)
    along = sp.simplify(made.reaction("c")[0])
    assert along == M * sp.Symbol("x_ddot", real=True) + K * X
    with pytest.raises(InputError, match="potential"):
        mechanism({X: "m"}, {"c": body}, potential=K * X**2, names={K, R}).reaction("c")


def test_a_coordinate_that_moves_nothing():
    with pytest.raises(InputError, match="nothing moves"):
        lagrange_system(mechanism({X: "m", A: "rad"}, {"c": Placed(M, (X, 0, 0))}))


def test_a_rate_of_a_given_motion_is_an_input():
    turned = (X * sp.cos(A), X * sp.sin(A), 0)
    made = mechanism({X: "m"}, {"c": Placed(M, turned)}, gravity=(0, 0, 0), given={A: "rad"},
                     reactions={"S": ("c", (-sp.sin(A), sp.cos(A), 0))})  # fmt: skip
    system = lagrange_system(made)
    assert system.input_names == ("a_ddot",)
    assert sp.simplify(system.rates[1] - X * speed(A) ** 2) == 0
