import eom
from sympy import cos, sin
from eom.terms.terms import Equation, der, partial

d = eom.Derivation("swing", "A pendulum", "My own")
m, g, R = d.constants(m="mass", g="gravity", R="length")
q, q_dot, q_ddot = d.coordinate("q", "angle from the vertical")
L = d.let("L", m * R**2 * q_dot**2 / 2 + m * g * R * cos(q), "Lagrangian")
d.determine(Equation(der(partial(L, q_dot)), partial(L, q)), q, reason="Lagrange's equation")
d.state(Equation(q_ddot, -g / R * sin(q)), "solved", label="motion")
