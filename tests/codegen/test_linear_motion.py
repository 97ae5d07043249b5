"""Linear motion about equilibria and steady motions; the complex step that checks it."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.derivatives.derivative import jacobian
from codegen.frontend.lower import lower_system
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.ops import OPS, Instruction
from codegen.linearisation.equilibria import equilibrium
from codegen.linearisation.linear_motion import (
    closed,
    complex_step,
    eigenvalues,
    free_states,
    independent,
    linearise_about,
    stability,
)
from codegen.linearisation.unknowns import leaves_of, tangents
from eom.errors import InputError
from eom.multibody import Body, Joint, Tree, derive
from eom.quantities import Definition, Quantity
from eom.system import System
from tests.codegen.test_derivative import POINTS, program_of_op
from tests.eom.multibody.trees import state, tree

x, y, v, w, psi, omega = sp.symbols("x y v w psi omega", real=True)
m, J, a, g, l, F = sp.symbols("m J a g l F", positive=True)


def compiled_of(rates, **more):
    return codegen.compile(System.from_rates("s", rates, **more), "numpy")


def string_pendulum():
    """A point mass on a rod, in Cartesian coordinates with the rod's force found; only the length given."""
    tension = (v**2 + w**2 - g * y) / (x**2 + y**2)
    rates = {x: v, y: w, v: -tension * x, w: -tension * y - g}
    return compiled_of(
        rates,
        invariants={"length": sp.sqrt(x**2 + y**2), "radius": x**2 + y**2},
        outputs={"height": y},
    )


def test_the_rate_of_a_constraint_is_found():
    """Two of four states are free: a pendulum, with the frequency sqrt(g/l)."""
    point = equilibrium(string_pendulum(), {"x": 0.1, "y": -2.0}, {"g": 9.81}, hold={"length": 2.0})
    near = linearise_about(string_pendulum(), point, constraints=["length"])
    assert near.states == ("x", "v")
    assert pytest.approx(np.array([[0, 1], [-9.81 / 2, 0]]), abs=1e-12) == near.A
    assert near.hidden == 1
    assert set(near.eliminated) == {"y", "w"}
    assert pytest.approx(np.zeros((1, 2)), abs=1e-12) == near.C
    assert near.eigenvalues.imag == pytest.approx([math.sqrt(9.81 / 2), -math.sqrt(9.81 / 2)])
    assert near.stability.kind == "undecided"
    assert near.agreement < 1e-15


def test_which_states_stay_can_be_said():
    point = equilibrium(string_pendulum(), {"x": 0.1, "y": -2.0}, {"g": 9.81}, hold={"length": 2.0})
    with pytest.raises(InputError, match="not independent"):
        linearise_about(string_pendulum(), point, constraints=["length"], independent_states=["y"])
    near = linearise_about(string_pendulum(), point, constraints=["length", "radius"],
                           independent_states=["v", "x"])  # fmt: skip
    assert near.states == ("x", "v")
    assert near.redundant == ("radius",)


def test_constraints_that_a_system_maintains_are_kept_by_themselves():
    """A rod held by its squared length less that at the start: met at zero, and found to be."""
    given = string_pendulum().system
    left = Definition(Quantity(sp.Symbol("closure", real=True)), x**2 + y**2 - 4)
    held = replace(given, invariants=(left,), maintained=("closure",))
    compiled = codegen.compile(held, "numpy")
    point = equilibrium(compiled, {"x": 0.1, "y": -1.0}, {"g": 9.81})
    assert point.states["y"] == pytest.approx(-2.0, rel=1e-14)
    near = linearise_about(compiled, point)
    assert near.states == ("x", "v")
    assert near.A[1, 0] == pytest.approx(-9.81 / 2, rel=1e-13)


def sleigh():
    """Chaplygin's sleigh with all speeds and its knife's force found: centre of mass a ahead of the knife.

    Neimark and Fufaev, Dynamics of Nonholonomic Systems (1972), ch. 3: along the knife V' = a omega^2,
    omega' = -m a V omega / (J + m a^2).
    """
    along = v * sp.cos(psi) + w * sp.sin(psi)
    spin = -m * a * along * omega / (J + m * a**2)
    push = a * omega**2
    rates = {
        x: v, y: w, psi: omega, omega: spin,
        v: push * sp.cos(psi) - along * omega * sp.sin(psi),
        w: push * sp.sin(psi) + along * omega * sp.cos(psi),
    }  # fmt: skip
    return compiled_of(rates, invariants={"slip": -v * sp.sin(psi) + w * sp.cos(psi)})


def test_a_knife_edge_at_speed_keeps_the_terms_of_its_turning():
    """The slip's derivative by the heading is -V: without it w would not follow the heading."""
    speed, values = 3.0, {"m": 2.0, "J": 0.5, "a": 0.25}
    point = equilibrium(sleigh(), {}, values, cyclic=["x", "y"], hold={"v": speed})
    assert point.states["psi"] == 0
    near = linearise_about(sleigh(), point, constraints=["slip"])
    assert near.eliminated == {
        "w": {"psi": pytest.approx(speed, rel=1e-14)}
    } or near.eliminated == {"psi": {"w": pytest.approx(1 / speed, rel=1e-14)}}
    expected = -2.0 * 0.25 * speed / (0.5 + 2.0 * 0.25**2)
    values = sorted(near.eigenvalues.real)
    assert values[0] == pytest.approx(expected, rel=1e-13)
    assert values[1:] == pytest.approx([0, 0], abs=1e-14)
    assert near.dropped == ("x", "y")
    assert near.hidden == 0
    kept = linearise_about(sleigh(), point, constraints=["slip"], independent_states=["psi"])
    assert kept.states == ("psi", "omega", "v")
    assert kept.A[1] == pytest.approx([0, expected, 0], rel=1e-13)


def ball(damping):
    bodies = [Body("bob", 2, (0, 0, -1), (Fraction(1, 2), 1, Fraction(3, 4)))]
    joints = [Joint("ball", "spherical", "ground", "bob", damping=damping, motor=True)]
    return codegen.compile(derive(Tree("ball", bodies, joints, gravity=(0, 0, -10))), "numpy")


def test_a_quaternion_has_three_small_angles():
    """(J + m l^2) theta'' = -m g l theta about the horizontal axes; nothing holds it about the vertical."""
    compiled = ball(0)
    point = equilibrium(compiled)
    near = linearise_about(compiled, point, attitude="angles")
    assert near.states == ("w_ball_1", "w_ball_2", "w_ball_3",
                           "angle_e_ball_1", "angle_e_ball_2", "angle_e_ball_3")  # fmt: skip
    stiffness = np.diag([-20 / 2.5, -20 / 3.0, 0])
    zero, one = np.zeros((3, 3)), np.eye(3)
    assert pytest.approx(np.block([[zero, stiffness], [one, zero]])) == near.A
    assert near.B[:3] == pytest.approx(np.diag([1 / 2.5, 1 / 3.0, 4 / 3]))
    states = linearise_about(compiled, point)
    assert set(states.eliminated) == {"e_ball_0"}
    assert states.states[:3] == ("e_ball_1", "e_ball_2", "e_ball_3")
    assert states.eigenvalues.imag == pytest.approx(near.eigenvalues.imag, abs=1e-7)


def test_small_angles_are_those_of_a_turned_body_too():
    """About a body that hangs turned by 90 degrees about the vertical, in its own axes."""
    s = math.sqrt(0.5)
    compiled = ball(Fraction(1, 2))
    point = equilibrium(
        compiled, {"e_ball_0": s, "e_ball_3": s}, hold={"e_ball_3": s, "e_ball_0": s}
    )
    near = linearise_about(compiled, point, attitude="angles")
    J = [2.5, 3.0, 0.75]
    stiffness = np.diag([-20 / J[0], -20 / J[1], 0])
    damping = -np.diag([0.5 / j for j in J])
    expected = np.block([[damping, stiffness], [np.eye(3), np.zeros((3, 3))]])
    assert pytest.approx(expected, abs=1e-12) == near.A
    assert near.stability.kind == "undecided"  # nothing turns it back about the vertical


def test_stability_is_reported_with_care():
    def of(A):
        return stability(*eigenvalues(np.array(A, float))).kind

    assert of([[-1, 5], [0, -2]]) == "asymptotically stable"
    assert of([[1e-6, 0], [0, -2]]) == "unstable"
    assert of([[0, 1], [-1, 0]]) == "undecided"
    assert of([[0, 1], [0, 0]]) == "undecided"  # grows in proportion to time
    assert of([[1e-17, 1], [0, -1]]) == "undecided"
    # a double root is known to half the digits (the bound of its group), less than its distance to zero
    assert of([[-1, 1], [0, -1]]) == "asymptotically stable"
    assert of([[-1e-7, 1], [0, -1e-7]]) == "undecided"
    assert of(np.zeros((0, 0))) == "undecided"


def test_errors_of_eigenvalues_cover_what_rounding_does():
    draw = np.random.default_rng(5)
    for _ in range(20):
        A = draw.normal(size=(5, 5))
        values, errors = eigenvalues(A)
        moved, _ = eigenvalues(A + np.finfo(float).eps * draw.normal(size=A.shape))
        for value, error in zip(values, errors, strict=True):
            assert np.min(np.abs(moved - value)) < 10 * error


@pytest.mark.parametrize("sizes", [(2,), (3,), (2, 2), (1, 3), (1, 1, 2), (4, 1, 1)])
def test_multiple_eigenvalues_are_within_their_errors(sizes):
    """The oracle: P J P^-1 with whole P of determinant 1 has the eigenvalues of J, exactly."""
    draw, n = np.random.default_rng(sizes), sum(sizes)
    for _ in range(10):
        known = sorted(draw.choice(np.arange(-3, 4), len(sizes), replace=False), reverse=True)
        J = sp.diag(*(sp.jordan_cell(int(v), k) for v, k in zip(known, sizes, strict=True)))
        lower, upper = (draw.integers(-1, 2, (n, n)) for _ in range(2))
        P = sp.Matrix(
            (np.tril(lower, -1) + np.eye(n, dtype=int)) @ (np.triu(upper, 1) + np.eye(n, dtype=int))
        )
        values, errors = eigenvalues(np.array(P * J * P.inv(), float))
        assert np.all(np.abs(values - np.repeat(known, sizes)) <= 3 * errors)
        assert np.max(errors) < 1e3 * np.finfo(float).eps ** (1 / max(sizes))


@pytest.mark.sparse
@pytest.mark.parametrize("op", sorted(set(OPS) - {"factor", "back", "item"}))
def test_the_complex_step_is_the_derivative_of_every_operation(op):
    program = program_of_op(op)
    if program is None:
        pytest.skip("no operands that vary")
    point = Point(x=POINTS[op])
    leaves = sorted({i for i in program.instructions if i.op == "state"}, key=lambda i: i.slot)
    found = complex_step(program, list(program.results), leaves, point)
    derived = jacobian(program, next(iter(program.results)))
    exact = interpret_exactly(derived.program, point)["jacobian"]
    expected = np.zeros_like(found)
    for (row, column), value in zip(derived.pattern, exact, strict=True):
        expected[row, [i.slot for i in leaves].index(column)] = float(value)
    assert np.allclose(found, expected, rtol=1e-13, atol=1e-15)
    _, carried = tangents(program, list(program.results), leaves, point)
    assert np.allclose(carried, expected, rtol=1e-12, atol=1e-15)


def test_the_complex_step_goes_through_linear_systems():
    M = sp.ImmutableMatrix([[2 + sp.cos(x), sp.sin(x) / 2], [sp.sin(x) / 2, 3]])
    system = System(
        "s", (Quantity(x), Quantity(v)), (v, -g * sp.sin(x)), (Quantity(g),), mass_matrix=M
    )
    program = lower_system(system)
    leaves = [Instruction("state", (), k) for k in range(2)]
    at = Point(0.0, [0.7, -0.3], [9.81])
    f = M.inv() * sp.Matrix([v, -g * sp.sin(x)])
    expected = f.jacobian([x, v]).subs({x: 0.7, v: -0.3, g: 9.81}).evalf()
    expected = pytest.approx(np.array(expected, float), rel=1e-13)
    assert complex_step(program, ["rates"], leaves, at) == expected
    assert tangents(program, ["rates"], leaves, at)[1] == expected


def test_a_singular_mass_matrix_has_no_derivatives():
    M = sp.ImmutableMatrix([[1, 1], [1, 1 + x]])
    program = lower_system(System("s", (Quantity(x), Quantity(v)), (v, -x), mass_matrix=M))
    found = tangents(program, ["rates"], leaves_of(2, 0), Point(0.0, [0.0, 1.0]))
    assert all(np.all(~np.isfinite(part)) for part in found)


@pytest.mark.sparse(1)
@pytest.mark.parametrize("seed", range(3))
def test_derivatives_of_trees_agree_with_the_complex_step(seed):
    """Two ways from the rules of differentiation, and one without any."""
    given = tree(seed, 3)
    compiled = codegen.compile(derive(given, ["energies"]), "numpy")
    at = [float(z) for group in state(given, seed) for z in group]
    leaves, groups = leaves_of(len(at), 0), ["rates", "outputs"]
    values, ours = tangents(compiled.program, groups, leaves, Point(0.0, at))
    assert values[: len(at)] == pytest.approx(compiled.rhs(0.0, at), rel=1e-11, abs=1e-9)
    steps = complex_step(compiled.program, groups, leaves, Point(0.0, at))
    size = np.max(np.abs(steps), axis=1, keepdims=True)
    assert np.max(np.abs(ours - steps) / np.where(size > 0, size, 1)) < 1e-11
    moved = complex_step(compiled.program, groups, leaves, Point(0.0, [k + 0.1 for k in at]))
    assert np.max(np.abs(ours - moved) / np.where(size > 0, size, 1)) > 1e-3


def test_the_matrices_are_those_of_the_generated_jacobian():
    point = equilibrium(sleigh(), {}, {"m": 2.0, "J": 0.5, "a": 0.25}, hold={"v": 0.0, "psi": 0.3})
    near = linearise_about(sleigh(), point)
    generated = codegen.linearise(sleigh(), [*point.states.values()], [*point.parameters.values()])
    assert pytest.approx(generated.A, rel=1e-14) == near.A
    assert near.states == generated.states


def test_a_row_without_derivative_is_reported():
    """An angle by its cosine has a corner at zero."""
    angle = {"tilt": sp.acos(1 - x**2 - v**2), "place": x}
    compiled = compiled_of({x: -x, v: -v}, outputs=angle)
    point = equilibrium(compiled)
    assert linearise_about(compiled, point).doubtful == ("tilt",)
    unchecked = linearise_about(compiled, point, check=False)
    assert unchecked.doubtful == ()
    assert math.isnan(unchecked.agreement)


def test_tangent_spaces_of_random_constraints():
    """Deviations keep the rows, S T = 1, and the basis spans what follows from the rows."""
    draw = np.random.default_rng(2)
    for _ in range(10):
        n, k = 7, 2
        inside = np.linalg.qr(draw.normal(size=(n, n)))[0]
        whole = draw.normal(size=(n, n))
        whole[:k, k:] = 0
        A = inside @ whole @ inside.T
        G = draw.normal(size=(k, k)) @ inside.T[:k]
        basis, redundant = closed(np.vstack([G, G.sum(axis=0)]), A)
        assert redundant == [2]
        assert basis.shape == (k, n)
        kept, reported = independent(
            free_states(np.zeros(n), [f"x{i}" for i in range(n)], ()), basis
        )
        assert pytest.approx(np.zeros((k, n - k)), abs=1e-10) == G @ kept.T
        assert pytest.approx(np.eye(n - k), abs=1e-12) == kept.S @ kept.T
        assert pytest.approx(kept.T @ kept.dynamics(A), abs=1e-9) == A @ kept.T
        assert len(reported) == k


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"constraints": ["width"]}, "unknown constraint"),
        ({"attitude": "vector"}, "attitude"),
        ({"independent_states": ["z"]}, "'z'"),
    ],
)
def test_wrong_arguments_are_refused(more, message):
    point = equilibrium(string_pendulum(), {"x": 0.1, "y": -2.0}, {"g": 9.81}, hold={"length": 2.0})
    with pytest.raises(InputError, match=message):
        linearise_about(string_pendulum(), point, **more)


def test_points_of_other_systems_and_parts_of_quaternions_are_refused():
    point = equilibrium(string_pendulum(), {"x": 0.1, "y": -2.0}, {"g": 9.81}, hold={"length": 2.0})
    with pytest.raises(InputError, match="another system"):
        linearise_about(sleigh(), point)
    compiled = ball(0)
    half = equilibrium(compiled)
    running = type(half)(**{**half.__dict__, "rates": {"e_ball_0": 0.0}})
    with pytest.raises(InputError, match="part of a quaternion"):
        linearise_about(compiled, running)
