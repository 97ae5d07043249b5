"""Point masses with forces between them: momentum, torque, energy; mass that comes and goes."""

import numpy as np
import sympy as sp

import codegen
import eom
from tests.statements.table import same, says

POINTMASSES = "notebooks/lecture-002-particles-to-euler.ipynb"
MANY = "docs/howto/many-bodies.md"


class Cloud:
    """Masses with places, velocities, forces from outside and between them.

    ``internal``: what forces between two masses are: ``central`` (opposite and along their line),
    ``opposite``, or ``any``.
    """

    def __init__(self, internal, seed=0, count=6):
        draw = np.random.default_rng(seed)
        self.m = draw.uniform(0.5, 2, count)
        self.r, self.v, self.outside = draw.normal(size=(3, count, 3))
        f = draw.normal(size=(count, count, 3))
        if internal != "any":
            f = f - f.transpose(1, 0, 2)
        if internal == "central":
            lines = self.r[:, None] - self.r[None]
            size = draw.normal(size=(count, count))
            f = (size + size.T)[..., None] * lines
        f[np.arange(count), np.arange(count)] = 0
        self.inside = f
        self.a = (self.outside + f.sum(axis=1)) / self.m[:, None]

    @property
    def centre(self):
        """The centre of mass."""
        return self.m @ self.r / self.m.sum()

    def momentum_rate(self, point, acceleration=(0, 0, 0)):
        """Return d/dt of the sum of m rho x rho' about a point with this acceleration."""
        return np.cross(self.r - point, self.m[:, None] * (self.a - np.asarray(acceleration))).sum(
            axis=0
        )

    def torque(self, point):
        """Return the torque of the outer forces."""
        return np.cross(self.r - point, self.outside).sum(axis=0)


@says(
    POINTMASSES,
    "**the centre of mass of anything moves like a point mass** under the external force. Nothing was rigid.",
)
@says(
    "derive particle-system internal-forces",
    "half the sum over both orders; opposite forces cancel",
)
@says(POINTMASSES, "The double sum would vanish as before if it were a sum of forces.")
@says(
    POINTMASSES,
    "the weak form of the third law is enough for the first line, the strong one is needed for the second",
)
def the_centre_moves_like_a_point_mass_where_forces_are_opposite():
    for kind, holds in (("opposite", True), ("central", True), ("any", False)):
        made = Cloud(kind)
        moved = made.m @ made.a
        assert np.allclose(moved, made.outside.sum(axis=0)) is holds
        turned = np.allclose(made.momentum_rate(made.centre), made.torque(made.centre))
        assert turned is (kind == "central")


@says(POINTMASSES, "opposite forces can form a couple")
@says("derive particle-system internal-torque", "so the terms of each pair cancel")
@says("derive particle-system along", "the force acts along the line between the masses")
def opposite_forces_can_form_a_couple():
    for kind, zero in (("opposite", False), ("central", True)):
        made = Cloud(kind, seed=1)
        assert np.allclose(made.inside.sum(axis=(0, 1)), 0)
        couple = np.cross(made.r[:, None], made.inside).sum(axis=(0, 1))
        assert np.allclose(couple, 0) is zero


@says(POINTMASSES, "It vanishes if $O$ does not accelerate, and if $O$ is the centre of mass.")
@says(
    POINTMASSES,
    "The second term is the moment of the inertia force: seen from an accelerated point, the body as a "
    "whole seems to be pulled the other way.",
)
@says("derive particle-system torque-law-of-centre", "whose first moment about itself is zero")
def the_law_of_torque_about_a_moving_point():
    made = Cloud("central", seed=2)
    point, acceleration = np.array([0.3, -1, 2]), np.array([1.0, 0.5, -2])
    first_moment = made.m.sum() * (made.centre - point)
    rate = made.momentum_rate(point, acceleration)
    second = np.cross(first_moment, acceleration)
    np.testing.assert_allclose(made.torque(point), rate + second)
    pulled = np.cross(made.centre - point, -made.m.sum() * acceleration)
    np.testing.assert_allclose(rate, made.torque(point) + pulled)
    assert not np.allclose(second, 0)
    np.testing.assert_allclose(made.momentum_rate(point), made.torque(point))
    np.testing.assert_allclose(
        made.momentum_rate(made.centre, acceleration), made.torque(made.centre), atol=1e-12
    )


@says(POINTMASSES, "Forces and momentum do not care where the origin is; angular momentum does.")
@says(
    POINTMASSES, "Books take either, often without saying so; they differ by the velocity of $O$."
)
@says("derive point-mass H-is-h", "no distinction about a fixed point")
@says("derive particle-system H-is-h", "no distinction about the centre of mass")
def the_two_angular_momenta():
    made, point, velocity = Cloud("central", seed=3), np.array([1.0, 2, -1]), np.array([0.5, -1, 3])
    p = made.m[:, None] * made.v

    def absolute(o):
        return np.cross(made.r - o, p).sum(axis=0)

    def relative(o, v):
        return np.cross(made.r - o, p - made.m[:, None] * v).sum(axis=0)

    assert not np.allclose(absolute(point), absolute(np.zeros(3)))
    differ = np.cross(made.m.sum() * (made.centre - point), velocity)
    np.testing.assert_allclose(absolute(point) - relative(point, velocity), differ)
    np.testing.assert_allclose(absolute(point), relative(point, np.zeros(3)))
    v_centre = made.m @ made.v / made.m.sum()
    np.testing.assert_allclose(absolute(made.centre), relative(made.centre, v_centre), atol=1e-12)


@says("derive point-mass power", "the energy changes at the power of the force")
@says("derive point-mass force-is-momentum-rate", "the mass is constant, and m r'' is the force")
def energy_of_a_mass_changes_at_the_power_of_the_force():
    t, m = sp.symbols("t m", positive=True)
    r = sp.Matrix([sp.Function(n)(t) for n in "xyz"])
    force = m * r.diff(t, 2)
    assert same(sp.diff(m * r.diff(t).dot(r.diff(t)) / 2, t), force.dot(r.diff(t)))
    assert same((m * r.diff(t)).diff(t), force)


def rocket(velocity, mass="100 - 5*t", **more):
    """Return a run of a body in free space that loses mass along its third axis."""
    scene = eom.TreeScene(
        bodies={"rocket": {"mass": mass, "moments": ["1", "1", "1"]}},
        joints={"rocket": {"kind": "free", "parent": "ground", "child": "rocket"}},
        jets={"nozzle": {"body": "rocket", "velocity": [0, 0, velocity], "point": [0, 0, 0]}},
        initial={"v_rocket_3": 3.0},
        **more,
    )
    system = codegen.compile(scene.derive(), "numpy")
    return codegen.simulate(system, scene.initial_values(), (0, 10), method="scipy:DOP853")


@says(
    "derive variable-mass meshchersky", "a rocket, whose mass falls, is driven against the stream"
)
@says(
    "derive variable-mass no-thrust",
    "there is no thrust: sand that trickles out of a cart does not drive it",
)
def rockets_and_sand():
    fast = rocket(-2000)["v_rocket_3"][-1]
    assert np.isclose(fast, 3 + 2000 * np.log(2), rtol=1e-6)
    assert np.isclose(rocket(0)["v_rocket_3"][-1], 3.0)


@says("derive variable-mass brake", "mass at rest that is taken in acts as a brake")
@says(
    "derive variable-mass whole-momentum",
    "it has no momentum: the law is that of the whole momentum",
)
def snow_on_a_sledge():
    t, m0, mu, p = sp.symbols("t m0 mu p", positive=True)
    m = m0 + mu * t
    v = p / m  # the whole momentum is that of the sledge
    assert same(m * v.diff(t), -mu * v)
    assert v.diff(t).is_negative
    # small inelastic collisions, one after the other, tend to it
    speed, mass, flake = 3.0, 100.0, 1e-3
    for _ in range(50_000):
        speed, mass = mass * speed / (mass + flake), mass + flake
    assert np.isclose(speed, 3.0 * 100 / 150)


@says(
    "derive transport-theorem second-five",
    "local, two equal Coriolis terms, Euler and centripetal acceleration: five terms",
)
@says(
    "derive transport-theorem transport",
    "the first three terms are the derivative in B; the sum in the product is v",
)
@says(POINTMASSES, "Twice, it gives four accelerations.")
@says("derive transport-theorem omega-rate", "omega x omega = 0")
def accelerations_in_a_turning_frame():
    t = sp.Symbol("t", real=True)
    angle = sp.Function("a")(t)
    x, y, z = (sp.Function(n)(t) for n in "xyz")
    C = sp.Matrix(
        [[sp.cos(angle), -sp.sin(angle), 0], [sp.sin(angle), sp.cos(angle), 0], [0, 0, 1]]
    )
    local, w = sp.Matrix([x, y, z]), sp.Matrix([0, 0, angle.diff(t)])
    first = C.T * (C * local).diff(t)
    assert same(first, local.diff(t) + w.cross(local))
    second = C.T * (C * local).diff(t, 2)
    terms = [
        local.diff(t, 2),
        2 * w.cross(local.diff(t)),
        w.diff(t).cross(local),
        w.cross(w.cross(local)),
    ]
    assert same(second, sum(terms, sp.zeros(3, 1)))
    assert all(not same(term, sp.zeros(3, 1)) for term in terms)
