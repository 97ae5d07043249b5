"""Small trees of lectures, with symbols."""

from __future__ import annotations

import sympy as sp

from eom.multibody import Body, Joint, Load, Motion, Placement, Tree

m, M, l, J, g, k, c, Omega = sp.symbols("m M l J g k c Omega", positive=True)
m1, m2, m3, l1, l2, l3, J1, J2, J3 = sp.symbols("m1 m2 m3 l1 l2 l3 J1 J2 J3", positive=True)
I1, I2, I3, A = sp.symbols("I1 I2 I3 A", positive=True)
t, F = sp.Symbol("t", real=True), sp.Symbol("F", real=True)
DOWN = (0, 0, -g)


def hung(name, parent, child, at=0, axis="y", **options):
    """A joint at a distance ``at`` below the origin of its parent."""
    return Joint(name, "revolute", parent, child, axis, on_parent=Placement((0, 0, -at)), **options)


def pendulum(count=2, **options):
    """Links with mass at distances l1, l2, ... below their joints."""
    masses, lengths, moments = (m1, m2, m3), (l1, l2, l3), (J1, J2, J3)
    bodies = [Body(f"link{n + 1}", masses[n], (0, 0, -lengths[n]), (moments[n],) * 3)
              for n in range(count)]  # fmt: skip
    joints = [hung(f"j{n + 1}", f"link{n}" if n else "ground", f"link{n + 1}",
                   lengths[n - 1] if n else 0, **options)
              for n in range(count)]  # fmt: skip
    return Tree("pendulum", bodies, joints, gravity=DOWN)


def cart_pendulum():
    bodies = [Body("cart", M), Body("bob", m, (0, 0, -l))]
    joints = [
        Joint("rail", "prismatic", "ground", "cart", "x", motor=True, stiffness=k, damping=c),
        hung("pivot", "cart", "bob"),
    ]
    return Tree("cart_pendulum", bodies, joints, gravity=DOWN)


def spherical_pendulum():
    """Azimuth about the vertical, then the angle from the downward vertical."""
    joints = [Joint("azimuth", "revolute", "ground", "arm", "z"), hung("polar", "arm", "bob")]
    return Tree("spherical_pendulum", [Body("arm"), Body("bob", m, (0, 0, -l))], joints, DOWN)


def top(attitude):
    """Symmetric, its tip fixed, with angular velocity in its axes as speeds."""
    bodies = [Body("top", m, (0, 0, l), (I1, I1, I3))]
    return Tree(
        "top", bodies, [Joint("tip", "spherical", "ground", "top", attitude=attitude)], DOWN
    )


def top_by_angles():
    """The same by three revolute joints: precession, nutation, spin."""
    joints = [
        Joint("psi", "revolute", "ground", "outer", "z"),
        Joint("theta", "revolute", "outer", "inner", "x"),
        Joint("phi", "revolute", "inner", "top", "z"),
    ]
    bodies = [Body("outer"), Body("inner"), Body("top", m, (0, 0, l), (I1, I1, I3))]
    return Tree("top", bodies, joints, DOWN)


def arm():
    """Waist, shoulder and elbow, with motors, rotors, a damper and a tool force."""
    bodies = [Body("waist", m1, (0, 0, 0), (I1, I2, I3)), Body("upper", m2, (l2 / 2, 0, 0)),
              Body("lower", m3, (l3, 0, 0))]  # fmt: skip
    joints = [
        Joint("waist", "revolute", "ground", "waist", "z", motor=True, armature=A),
        Joint("shoulder", "revolute", "waist", "upper", "-y", motor=True, damping=c),
        Joint("elbow", "revolute", "upper", "lower", "-y", motor=True,
              on_parent=Placement((l2, 0, 0))),
    ]  # fmt: skip
    load = Load("lower", (0, 0, F), point=(l3, 0, 0))
    return Tree("arm", bodies, joints, DOWN, loads=(load,), inputs=(F,))


def rotating(motion=None):
    """A body on a universal joint on a table that turns as prescribed."""
    joints = [
        Joint("spin", "revolute", "ground", "table", "z", motion=motion or Motion(Omega * t)),
        Joint("flap", "universal", "table", "blade", "x", second_axis="y", stiffness=(k, 0)),
    ]
    bodies = [Body("table", M), Body("blade", m, (l, 0, 0), (I1, I2, I3))]
    return Tree("rotating", bodies, joints, gravity=DOWN)


SCENES = {
    "double pendulum": pendulum(2, damping=c),
    "triple pendulum": pendulum(3, stiffness=k),
    "cart and pendulum": cart_pendulum(),
    "spherical pendulum": spherical_pendulum(),
    "top by angles": top_by_angles(),
    "top by 3-1-3": top("3-1-3"),
    "top by 3-2-1": top("3-2-1"),
    "top by a quaternion": top("quaternion"),
    "arm": arm(),
    "rotating table": rotating(),
}
