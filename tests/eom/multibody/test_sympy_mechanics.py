"""Trees from and to SymPy's mechanics: its equations are ours, its frames turn the same way."""

import numpy as np
import pytest
import sympy as sp
from sympy.physics import mechanics as me

import codegen
from codegen.frontend.from_sympy_mechanics import as_system
from eom.errors import InputError
from eom.exact.identity import equal, vanishes
from eom.kinematics.coordinates import rotation_sequence
from eom.multibody import Body, Joint, Motion, Placement, Tree, derive
from eom.multibody.closed import closed_form
from eom.multibody.sympy.from_sympy import body_from_sympy, placement_from_sympy, tree_from_sympy
from eom.multibody.sympy.to_sympy import lagranges_method, to_sympy
from eom.quantities import TIME
from tests.eom.multibody.small_trees import SCENES, J, c, g, k, l, m, pendulum, rotating, top
from tests.eom.multibody.test_closed_forms import on_sphere
from tests.eom.multibody.trees import tree
from tests.eom.rows import but, every

T = me.dynamicsymbols._t


# -- to SymPy ----------------------------------------------------------------------------------


def assert_same_equations(given, made, mass, forcing):
    """Mass matrix and right sides of a method of SymPy are those of the closed form."""
    form, sphere = closed_form(given, "newton-euler"), on_sphere(given)
    for ours, theirs in ((form.mass_matrix, mass), (form.forcing, forcing)):
        expanded = form.system.expand(ours).xreplace(sphere)
        assert equal(made.plain(theirs).xreplace(sphere), expanded)


@pytest.mark.parametrize("name", every(3, [n for n in SCENES if n != "top by 3-1-3"]))
def test_kanes_method_of_sympy_on_every_small_scene(name):
    made = to_sympy(SCENES[name])
    kane = made.kane()
    assert_same_equations(SCENES[name], made, kane.mass_matrix, kane.forcing)


@pytest.mark.parametrize(
    "kind", but(["universal", "planar", "helical", "cylindrical", "free"], "free", "universal")
)
def test_kanes_method_of_sympy_on_tilted_joints(kind):
    given = tree(2, 1, kinds=(kind,), attitudes=("quaternion",))
    made = to_sympy(given)
    kane = made.kane()
    assert_same_equations(given, made, kane.mass_matrix, kane.forcing)


@pytest.mark.parametrize("name", ["cart and pendulum", "spherical pendulum"])
def test_lagranges_method_of_sympy(name):
    given = SCENES[name]
    made, method = to_sympy(given), lagranges_method(given)
    rates = {made.names[q.symbol].diff(T): made.names[u.symbol]
             for j in given.ordered for q, u in zip(j.coordinates, j.speeds, strict=True)}  # fmt: skip
    mass, forcing = (x.xreplace(rates) for x in (method.mass_matrix, method.forcing))
    assert_same_equations(given, made, mass, forcing)


def test_a_mechanics_system_is_ready_to_be_asked():
    made = to_sympy(pendulum(2))
    system = made.system()
    system.form_eoms()
    assert_same_equations(pendulum(2), made, system.mass_matrix, system.forcing)


def test_sympy_s_equations_of_a_tree_compile_to_the_same_rates():
    """By way of `codegen.frontend.from_sympy_mechanics`, which takes SymPy's methods."""
    given = pendulum(2)
    theirs, ours = as_system(to_sympy(given).kane()), derive(given, invariants=False)
    assert theirs.state_names == ours.state_names
    mass = theirs.mass_matrix
    named = {s: sp.Symbol(s.name, real=True) for s in mass.free_symbols if not s.is_positive}
    rates = sp.Matrix([ours.expand(r) for r in ours.rates])
    residual = mass.xreplace(named) * rates - sp.Matrix(theirs.rates).xreplace(named)
    assert equal(residual, sp.zeros(4, 1))
    assert codegen.compile(theirs, "numpy").rhs(0.0, [0.0] * 4, [1.0] * 7).tolist() == [0.0] * 4


def test_more_coordinates_than_speeds_compile():
    """A quaternion: seven states, of which three are speeds."""
    given = top("quaternion")
    theirs, ours = as_system(to_sympy(given).kane()), derive(given, invariants=False)
    assert theirs.state_names == ours.state_names
    x = [0.8, 0.36, -0.48, 0.0, 0.3, -0.2, 2.0]
    values = dict.fromkeys(("I1", "I3", "g", "l", "m"), 1.5)
    found = [
        codegen.compile(s, "numpy").rhs(0.0, x, [values[n] for n in s.parameter_names])
        for s in (theirs, ours)
    ]
    assert found[0] == pytest.approx(found[1], rel=1e-12)


def test_dependent_speeds_follow_by_their_accelerations():
    q, u = me.dynamicsymbols("q1:3"), me.dynamicsymbols("u1:3")
    N, P = me.ReferenceFrame("N"), me.Point("P")
    P.set_vel(N, u[0] * N.x + u[1] * N.y)
    kane = me.KanesMethod(
        N, q, u[:1], kd_eqs=[x.diff() - y for x, y in zip(q, u, strict=True)],
        u_dependent=u[1:], velocity_constraints=[u[0] - 2 * u[1]],
    )  # fmt: skip
    kane.kanes_equations([me.Particle("p", P, m)], [(P, -m * g * N.y)])
    compiled = codegen.compile(kane, "numpy")
    assert compiled.system.maintained == ("closure_rate_1",)
    x = np.array([0.0, 0.0, 2.0, 1.0])
    found = compiled.rhs(0.0, x, [3.0, 1.0])  # g, m
    # along (2, 1): 5 u2' = -g, as m (4 + 1) u2' = -m g
    assert found == pytest.approx([2.0, 1.0, -6 / 5, -3 / 5], rel=1e-15)
    start = {"q1": 0, "q2": 0, "u1": 2, "u2": 0.9}
    refused(
        lambda: codegen.simulate(compiled, start, (0, 1), {"g": 3, "m": 1}),
        "meet the constraints",
    )


@pytest.mark.parametrize("attitude", ["1-2-1"])
def test_direction_cosines_point_the_right_way(attitude):
    """``B.dcm(N)`` takes components in the ground to those in the body, as C of the sequence."""
    given = top(attitude)
    made = to_sympy(given)
    angles = [q.symbol for q in given.joints[0].coordinates]
    C = rotation_sequence(attitude, angles).matrix
    assert equal(made.plain(made.frames["top"].dcm(made.frame)), C)
    assert not equal(made.plain(made.frame.dcm(made.frames["top"])), C)
    centre = made.centres["top"].pos_from(made.origin).to_matrix(made.frame)
    assert equal(made.plain(centre), C.T * sp.Matrix([0, 0, l]))


def test_velocities_of_points_are_derivatives_of_positions():
    made = to_sympy(pendulum(2))
    rates = {q.diff(T): u for q, u in zip(made.q, made.u, strict=True)}
    for G in made.centres.values():
        moved = G.pos_from(made.origin).dt(made.frame).to_matrix(made.frame).xreplace(rates)
        assert equal(made.plain(moved - G.vel(made.frame).to_matrix(made.frame)), sp.zeros(3, 1))
    assert made.plain(made.timed(sp.sin(TIME))) == sp.sin(TIME)


# -- from SymPy --------------------------------------------------------------------------------


def wall_and_system():
    wall = me.RigidBody("wall")
    return wall, me.System.from_newtonian(wall)


def solid(name, moments=(1, 2, 2)):
    body = me.RigidBody(name, mass=m)
    body.central_inertia = me.inertia(body.frame, *(J * n for n in moments))
    return body


def assert_same_motion(system, imported):
    """M u' = f of SymPy for the accelerations of the tree, over the tree's symbols."""
    system.form_eoms()
    ours = derive(imported.tree, invariants=False)
    speeds = [imported.plain(u) for u in system.u]
    rates = sp.Matrix([ours.rate_of(u) for u in speeds])
    residual = imported.plain(system.mass_matrix) * rates - imported.plain(system.forcing)
    assert equal(residual.applyfunc(ours.expand), sp.zeros(len(speeds), 1))
    for q in system.q:
        assert vanishes(ours.rate_of(imported.plain(q)) - imported.plain(q.diff(T)))


JOINTS = {
    "pin": lambda a, b: me.PinJoint("j", a, b, child_point=l * b.y, joint_axis=a.z),
    "prismatic": lambda a, b: me.PrismaticJoint("j", a, b, joint_axis=a.x + a.y),
    "cylindrical": lambda a, b: me.CylindricalJoint("j", a, b, child_point=l * b.y, joint_axis=a.z),
    "planar": lambda a, b: me.PlanarJoint("j", a, b, child_point=l * b.y),
    "spherical body": lambda a, b: me.SphericalJoint(
        "j", a, b, child_point=l * b.z, rot_type="BODY", rot_order="ZXY"
    ),
    "spherical space": lambda a, b: me.SphericalJoint(
        "j", a, b, child_point=l * b.z, rot_type="SPACE", rot_order=312
    ),
}


@pytest.mark.parametrize("kind", every(2, JOINTS))
def test_every_joint_of_sympy(kind):
    wall, system = wall_and_system()
    body = solid("body")
    system.add_joints(JOINTS[kind](wall, body))
    system.apply_uniform_gravity(-g * system.y)
    imported = tree_from_sympy(system)
    assert imported.tree.gravity == (0, -g, 0)
    assert imported.tree.loads == ()
    assert_same_motion(system, imported)


def test_frames_and_points_become_placements():
    body, angle = solid("body"), sp.Symbol("alpha", real=True)
    frame = body.frame.orientnew("F", "Axis", (angle, body.z))
    point = body.masscenter.locatenew("P", l * frame.x)
    found = placement_from_sympy(frame, point, body.frame, body.masscenter)
    s, c = sp.sin(angle), sp.cos(angle)
    assert found == Placement((l * c, l * s, 0), ((c, s, 0), (-s, c, 0), (0, 0, 1)))
    turning = body.frame.orientnew("G", "Axis", (me.dynamicsymbols("q"), body.z))
    refused(
        lambda: placement_from_sympy(turning, point, body.frame, body.masscenter), "changes in time"
    )
    assert body_from_sympy(body) == Body("body", m, (0, 0, 0), (J, 2 * J, 2 * J))


def furnished():
    """Tilted interframes, a weld, a particle, a damper, an input and a spring."""
    wall, system = wall_and_system()
    link, plate = solid("link"), solid("plate", (2, 3, 4))
    bob = me.Particle("bob", mass=2 * m)
    tilted = me.ReferenceFrame("tilted")
    tilted.orient_axis(link.frame, link.z, sp.Symbol("alpha", real=True))
    joints = [
        me.PinJoint("first", wall, link, parent_point=l * wall.x, child_point=l * link.y,
                    joint_axis=wall.z),
        me.WeldJoint("weld", link, plate, parent_point=-l * link.y, child_interframe=None,
                     parent_interframe=tilted),
        me.PrismaticJoint("slide", plate, bob, joint_axis=plate.x),
    ]  # fmt: skip
    system.add_joints(*joints)
    system.apply_uniform_gravity(-g * system.y)
    push = me.dynamicsymbols("push")
    first, slide = joints[0], joints[2]
    system.add_loads(
        me.Torque(link.frame, -c * first.speeds[0] * wall.z),
        me.Force(plate.masscenter, push * plate.y),
        me.Force(bob, -k * slide.coordinates[0] * plate.x),
        me.Force(plate.masscenter, k * slide.coordinates[0] * plate.x),
    )
    system.add_actuators(me.TorqueActuator(sp.sin(T), wall.z, link.frame, wall.frame))
    return system


def test_loads_actuators_inputs_particles_and_welds():
    system = furnished()
    imported = tree_from_sympy(system, "furnished")
    assert [i.name for i in imported.tree.inputs] == ["push"]
    assert imported.tree.gravity == (0, -g, 0)
    system.form_eoms()
    ours = derive(imported.tree, invariants=False)
    accelerations = sp.Matrix([ours.expand(ours.rates[n]) for n in (2, 3)])
    residual = imported.plain(system.mass_matrix) * accelerations - imported.plain(system.forcing)
    assert equal(residual, sp.zeros(2, 1))


def test_there_and_back():
    """A tree that came from SymPy, by SymPy's Kane again."""
    imported = tree_from_sympy(furnished())
    made = to_sympy(imported.tree)
    kane = made.kane()
    assert_same_equations(imported.tree, made, kane.mass_matrix, kane.forcing)


# -- refusals ----------------------------------------------------------------------------------


def refused(call, words):
    with pytest.raises(InputError, match=words):
        call()


def pinned(**options):
    wall, system = wall_and_system()
    body = solid("body")
    system.add_joints(me.PinJoint("j", wall, body, **options))
    return wall, body, system


def test_what_is_no_tree_is_refused():
    refused(lambda: tree_from_sympy(3), "not a mechanics System")
    refused(lambda: tree_from_sympy(me.System()), "without joints")
    _, _, system = pinned()
    system.add_holonomic_constraints(system.q[0] - 1)
    refused(lambda: tree_from_sympy(system), "holonomic constraints")
    floating = me.System()
    floating.add_joints(me.PinJoint("j", solid("a"), solid("b")))
    refused(lambda: tree_from_sympy(floating), "no body is the ground(.|\n)*from_newtonian")
    wall, other = wall_and_system()
    other.add_joints(me.PinJoint("j", solid("a"), wall))
    refused(lambda: tree_from_sympy(other), "leads to the ground")


def test_bodies_and_kinematics_that_trees_do_not_have_are_refused():
    _, body, system = pinned()
    body.potential_energy = m * g
    refused(lambda: tree_from_sympy(system), "potential energy(.|\n)*'?body")
    _, body, system = pinned()
    body.mass = m * (1 + me.dynamicsymbols("burn"))
    refused(lambda: tree_from_sympy(system), "changes in time")
    _, _, system = pinned()
    system.kdes = [system.u[0] - 2 * system.q[0].diff(T)]
    refused(lambda: tree_from_sympy(system), "kinematic differential equations")
    wall, chain = wall_and_system()
    bead = me.Particle("bead", mass=m)
    chain.add_joints(
        me.PrismaticJoint("a", wall, bead), me.PrismaticJoint("b", bead, solid("body"))
    )
    refused(lambda: tree_from_sympy(chain), "a particle carries a joint")


def test_loads_that_trees_do_not_have_are_refused():
    _, body, system = pinned()
    system.add_loads(me.Torque(body.frame, system.u[0].diff(T) * body.x))
    refused(lambda: tree_from_sympy(system), "depends on accelerations")
    _, _, system = pinned()
    system.add_loads(me.Torque(me.ReferenceFrame("loose"), system.x))
    refused(lambda: tree_from_sympy(system), "frame that is fixed to no body")
    _, _, system = pinned()
    system.add_loads(me.Force(me.Point("loose"), system.x))
    refused(lambda: tree_from_sympy(system), "point that is fixed to no body")


def test_what_sympy_does_not_have_is_refused():
    refused(lambda: lagranges_method(top("quaternion")), "rates of coordinates(.|\n)*Boltzmann")
    angle, rate, change = sp.symbols("angle rate change", real=True)
    driven = rotating(Motion((angle,), (rate,), (change,)))
    refused(lambda: to_sympy(driven), "function of time")


def test_a_body_on_placed_joints_goes_over():
    """Centre of mass and joint away from the origin, a turned frame on the child."""
    turned = ((0, 1, 0), (-1, 0, 0), (0, 0, 1))
    cyclic = ((0, 1, 0), (0, 0, 1), (1, 0, 0))
    given = Tree(
        "placed",
        [Body("body", m, (l, 0, 0), (J, 2 * J, 2 * J))],
        [Joint("j", "revolute", "ground", "body", "z", stiffness=k, rest=1, armature=J,
               on_parent=Placement((0, l, 0), turned), on_child=Placement((0, 0, l), cyclic))],
        gravity=(0, -g, 0),
    )  # fmt: skip
    made = to_sympy(given)
    kane = made.kane()
    assert_same_equations(given, made, kane.mass_matrix, kane.forcing)
