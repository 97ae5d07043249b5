"""Derivations as users write them, each in at most 30 lines: Lagrange, Kane, Newton-Euler, Hamilton."""

from sympy import Rational, cos, pi, sin, symbols

import eom
from eom.terms.rules import differentiate_under
from eom.terms.terms import Equation, cross, der, dot, partial, total
from eom.terms.vocabulary import omega, position, quantity, unit, velocity


def disc():
    """A disc rolls down a slope: Newton and Euler."""
    d = eom.Derivation("disc", "A disc rolls down a slope", "My own")
    m, g, R, a = d.constants(m="mass", g="gravity", R="radius", a="slope of the plane")
    x, x_dot, x_ddot = d.coordinate("x", "way down the slope")
    q, q_dot = d.coordinate("q", "angle of the disc", 1)
    (f,), (n,) = d.coordinate("f", "friction", 0), d.coordinate("n", "normal force", 0)
    down, up, across = (unit("I", k) for k in (1, 2, 3))
    d.frame("K", q)
    d.body("D", m, x * down + R * up, "K", (m * R**2 / 4, m * R**2 / 4, m * R**2 / 2))
    d.rolls("D", -R * up, x)
    d.state(Equation(x_dot, -R * q_dot), "it does not slip")
    p, h = quantity("linear_momentum", "D"), quantity("angular_momentum", "D", "D")
    d.define(p, "momentum").equals(m * x_dot * down, "down the slope")
    d.define(h, "angular momentum about the centre").equals(m * R**2 / 2 * q_dot * across, "J3 q'")
    contact = f * down + n * up
    weight = m * g * (sin(a) * down - cos(a) * up)
    d.determine(Equation(der(p), contact + weight), f, n, reason="Newton's law")
    d.determine(Equation(der(h), cross(-R * up, contact)), q, reason="Euler's law")
    d.state(Equation(n, m * g * cos(a)), "nothing moves across the slope")
    d.state(Equation(f, -m * x_ddot / 2), "Euler's law, without slip")
    d.state(Equation(x_ddot, Rational(2, 3) * g * sin(a)), "Newton's law", label="motion")
    T = d.define(quantity("kinetic_energy", "D"), "kinetic energy")
    T.equals(Rational(3, 4) * m * x_dot**2, "of both motions", label="energy")
    return d


def moving_point():
    """Angular momentum about a point A that moves as it likes."""
    d = eom.Derivation("moving-point", "Angular momentum about a moving point A", "My own")
    d.assume("newton_2", "third_law_strong", "constant_mass")
    d.point("A", quantity("vector", "a"))
    H, M = (quantity(n, "system", "A") for n in ("absolute_angular_momentum", "torque"))
    p, p_i = (quantity("linear_momentum", who) for who in ("system", "i"))
    arm = position("i", "A")
    first, second = total(cross(der(arm), p_i)), total(cross(arm, der(p_i)))
    rate = d.define(H, "angular momentum about A").both("differentiate", der, differentiate_under)
    rate.equals(first + second, "product rule")
    d.state(Equation(der(arm), velocity("i") - velocity("A")), "velocity against A")
    d.state(Equation(first, -cross(velocity("A"), p)), "a momentum is along its velocity")
    d.define(M, "torque of the external forces about A")
    d.state(Equation(second, M), "internal forces have no torque")
    rate.equals(M - cross(velocity("A"), p), "both together", label="law")
    C = quantity("absolute_angular_momentum", "system", "C")
    d.state(Equation(der(C), quantity("torque", "system", "C")), "about the centre of mass")
    return d


def bead_by_lagrange():
    """A bead on a hoop that turns about its vertical diameter."""
    d = eom.Derivation("hoop-lagrange", "A bead on a hoop by Lagrange", "My own")
    m, g, R, w = d.constants(m="mass", g="gravity", R="radius of the hoop", w="its rate")
    q, q_dot, q_ddot = d.coordinate("q", "angle from the lowest point")
    (turn,) = d.coordinate("turn", "angle of the hoop", 0)
    d.determine(Equation(der(turn), w), turn, reason="the hoop turns steadily")
    d.frame("H", turn)
    d.body("Q", m, R * sin(q) * unit("H", 1) - R * cos(q) * unit("H", 3))
    T = m * R**2 * (q_dot**2 + w**2 * sin(q) ** 2) / 2
    d.define(quantity("kinetic_energy", "Q"), "kinetic energy").equals(T, "by the angle")
    V = d.let("V", m * g * dot(unit("I", 3), position("Q")), "potential energy")
    d.state(Equation(V, -m * g * R * cos(q)), "height")
    L = d.let("L", T + m * g * R * cos(q), "Lagrangian")
    p = d.let("p", partial(L, q_dot), "momentum")
    d.state(Equation(p, m * R**2 * q_dot), "slope by the rate")
    slope = m * R**2 * w**2 * sin(q) * cos(q) - m * g * R * sin(q)
    d.state(Equation(partial(L, q), slope), "slope by the angle")
    d.determine(Equation(der(partial(L, q_dot)), partial(L, q)), q, reason="Lagrange's equation")
    d.state(Equation(m * R**2 * q_ddot, slope), "both slopes")
    d.state(Equation(q_ddot, w**2 * sin(q) * cos(q) - g / R * sin(q)), "solved", label="motion")
    return d


def bead_by_kane():
    """The same by partial velocities, and the force of the hoop across."""
    d = eom.Derivation("hoop-kane", "A bead on a hoop by Kane", "My own")
    m, g, R, w = d.constants(m="mass", g="gravity", R="radius of the hoop", w="its rate")
    q, q_dot, q_ddot = d.coordinate("q", "angle from the lowest point")
    (turn,) = d.coordinate("turn", "angle of the hoop", 0)
    d.determine(Equation(der(turn), w), turn, reason="the hoop turns steadily")
    d.frame("H", turn)
    out, across, up = (unit("H", k) for k in (1, 2, 3))
    d.body("Q", m, R * sin(q) * out - R * cos(q) * up)
    v, along = velocity("Q"), cos(q) * out + sin(q) * up
    d.state(Equation(v, R * q_dot * along + R * w * sin(q) * across), "velocity")
    d.state(Equation(partial(v, q_dot), R * along), "partial velocity")
    active, inertial = (dot(partial(v, q_dot), f) for f in (-m * g * up, -m * der(v)))
    d.state(Equation(active, -m * g * R * sin(q)), "generalised active force")
    there = -m * R**2 * (q_ddot - w**2 * sin(q) * cos(q))
    d.state(Equation(inertial, there), "generalised inertia force")
    d.determine(Equation(active + inertial, 0), q, reason="Kane's equation")
    d.state(Equation(q_ddot, w**2 * sin(q) * cos(q) - g / R * sin(q)), "solved", label="motion")
    d.state(Equation(m * dot(der(v), across), 2 * m * R * w * q_dot * cos(q)), "force of the hoop")
    return d


def foucault():
    """A pendulum that swings little, at a place on the turning Earth."""
    d = eom.Derivation("foucault", "Foucault's pendulum", "My own")
    W, b, k = d.constants(W="rate of the Earth", b="latitude", k="gravity by length")
    x, x_dot, x_ddot = d.coordinate("x", "way to the south")
    y, y_dot, y_ddot = d.coordinate("y", "way to the east")
    turn, a = (
        d.coordinate(n, s, 0)[0] for n, s in [("turn", "of the Earth"), ("a", "of the swing")]
    )
    d.determine(Equation(der(turn), W), turn, reason="the Earth turns steadily")
    d.frame("E", turn)
    d.frame("L", pi / 2 - b, axis=2, base="E")
    south, east, up = (unit("L", n) for n in (1, 2, 3))
    d.state(Equation(omega("L"), W * (sin(b) * up - cos(b) * south)), "rate of the place")
    r = x * south + y * east
    coriolis = -2 * cross(omega("L"), der(r, "L"))
    seen, pull = der(r, "L", times=2), -k * r + coriolis
    d.determine(
        Equation(dot(south, seen), dot(south, pull)), x, reason="gravity and Coriolis, south"
    )
    d.determine(Equation(dot(east, seen), dot(east, pull)), y, reason="gravity and Coriolis, east")
    d.state(Equation(x_ddot, -k * x + 2 * W * sin(b) * y_dot), "south")
    d.state(Equation(y_ddot, -k * y - 2 * W * sin(b) * x_dot), "east")
    d.determine(Equation(der(a), -W * sin(b)), a, reason="let a frame turn back")
    d.frame("F", a, base="L")
    d.state(Equation(omega("F", "L"), -W * sin(b) * up), "it turns against the ground")
    plane = -(k + W**2 * sin(b) ** 2) * r
    d.state(Equation(der(r, "F", times=2), plane), "there it swings in a plane", label="plane")
    return d


def pendulum_by_hamilton():
    """A pendulum by its Hamiltonian, in coordinate and momentum."""
    d = eom.Derivation("pendulum-hamilton", "A pendulum by Hamilton", "My own")
    m, g, R = d.constants(m="mass", g="gravity", R="length")
    q, q_dot, q_ddot = d.coordinate("q", "angle from the vertical")
    d.body("Q", m, R * sin(q) * unit("I", 1) - R * cos(q) * unit("I", 3))
    T = d.define(quantity("kinetic_energy", "Q"), "kinetic energy")
    T.equals(m * R**2 * q_dot**2 / 2, "by the angle")
    L = d.let("L", m * R**2 * q_dot**2 / 2 + m * g * R * cos(q), "Lagrangian")
    p = d.let("p", partial(L, q_dot), "momentum")
    d.state(Equation(p, m * R**2 * q_dot), "slope by the rate")
    H = d.let("H", p**2 / (2 * m * R**2) - m * g * R * cos(q), "Hamiltonian")
    d.state(Equation(H, p * q_dot - L), "Legendre's transform")
    d.state(Equation(partial(H, p), q_dot), "first equation")
    d.determine(Equation(der(p), -partial(H, q)), q, reason="second equation of Hamilton")
    d.state(Equation(der(p), -m * g * R * sin(q)), "slope by the angle")
    d.state(Equation(q_ddot, -g / R * sin(q)), "equation of motion", label="motion")
    d.state(Equation(der(H), 0), "energy is conserved", label="energy")
    return d


OWN = {
    f.__name__: f
    for f in (disc, moving_point, bead_by_lagrange, bead_by_kane, foucault, pendulum_by_hamilton)
}

_SYMBOLS = "a W b k x y x_dot y_dot q m g R w"
a, W, b, k, x, y, x_dot, y_dot, q, m, g, R, w = symbols(_SYMBOLS, real=True)
BEAD = {("turn", 1): w, ("q", 2): w**2 * sin(q) * cos(q) - g / R * sin(q)}
MOTIONS = {
    "disc": {
        ("q", 1): -x_dot / R, ("x", 2): Rational(2, 3) * g * sin(a),
        ("n", 0): m * g * cos(a), ("f", 0): -m * g * sin(a) / 3,
    },
    "hoop-lagrange": BEAD,
    "hoop-kane": BEAD,
    "foucault": {
        ("turn", 1): W, ("a", 1): -W * sin(b),
        ("x", 2): -k * x + 2 * W * sin(b) * y_dot, ("y", 2): -k * y - 2 * W * sin(b) * x_dot,
    },
    "pendulum-hamilton": {("q", 2): -g / R * sin(q)},
}  # fmt: skip
"""Rates by name and order, of derivations by name, as textbooks have them.

Source: Goldstein, Poole, Safko, Classical Mechanics (2002). Bead and disc: ch. 2; Foucault: sec. 4.10,
with gravity that has the centrifugal part.
"""
