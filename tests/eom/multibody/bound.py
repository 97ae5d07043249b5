"""Trees with constraints that several tests need."""

import sympy as sp

from eom.multibody import (
    GROUND,
    Body,
    Distance,
    Joint,
    KnifeEdge,
    Load,
    Loop,
    Placement,
    Rolling,
    Tree,
)

L1, L2, L3, d, g = sp.symbols("L1 L2 L3 d g", positive=True)
ROTATION = ((2 / 3, 2 / 3, 1 / 3), (-2 / 3, 1 / 3, 2 / 3), (1 / 3, -2 / 3, 2 / 3))
"""A rotation that leaves no axis in place; rounded."""
PLAIN = Placement()


def rod(name, mass, length):
    slender = mass * length**2 / 12
    return Body(name, mass, (length / 2, 0, 0), (0, slender, slender))


def four_bar(kind="revolute", coupler=2, rotation=PLAIN.rotation, extra=(), **options):
    """Crank, coupler and rocker about z; ``rotation`` turns the whole mechanism in space."""
    return Tree(
        "four_bar",
        [rod("crank", 1, L1), rod("coupler", coupler, L2), rod("rocker", 3, L3)],
        [
            Joint("a", "revolute", GROUND, "crank", on_parent=Placement(rotation=rotation), **options),
            Joint("b", "revolute", "crank", "coupler", on_parent=Placement((L1, 0, 0))),
            Joint("c", "revolute", GROUND, "rocker", on_parent=Placement(
                tuple(d * r for r in rotation[0]), rotation)),
        ],
        gravity=tuple(-g * r for r in rotation[1]),
        constraints=[
            Loop("pin", kind, "coupler", "rocker", on_first=Placement((L2, 0, 0)),
                 on_second=Placement((L3, 0, 0))),
            *extra,
        ],
    )  # fmt: skip


LENGTHS = {"L1": 0.4, "L2": 1.1, "L3": 0.9, "d": 1.2, "g": 9.81}
NEAR = {"q_a": 0.3, "q_b": 0.5, "q_c": 1.6}


def rod_instead_of_coupler():
    """The coupler without mass is a distance."""
    return Tree(
        "two_cranks",
        [rod("crank", 1, L1), rod("rocker", 3, L3)],
        [
            Joint("a", "revolute", GROUND, "crank"),
            Joint("c", "revolute", GROUND, "rocker", on_parent=Placement((d, 0, 0))),
        ],
        gravity=(0, -g, 0),
        constraints=[Distance("rod", "crank", "rocker", L2, (L1, 0, 0), (L3, 0, 0))],
    )


r, m = sp.symbols("r m", positive=True)


def disc(attitude="quaternion", **options):
    """A thin disc with axis y on a horizontal plane."""
    thin = (m * r**2 / 4, m * r**2 / 2, m * r**2 / 4)
    return Tree(
        "disc",
        [Body("disc", m, (0, 0, 0), thin)],
        [Joint("j", "free", GROUND, "disc", attitude=attitude)],
        gravity=(0, 0, -g),
        constraints=[Rolling("floor", "disc", r, axis=(0, 1, 0), **options)],
    )


b, J = sp.symbols("b J", positive=True)


def sleigh():
    """Chaplygin's: the centre of mass is ahead of the knife edge by b."""
    return Tree(
        "sleigh",
        [Body("sleigh", m, (b, 0, 0), (J / 2, J / 2, J))],
        [Joint("j", "planar", GROUND, "sleigh")],
        constraints=[KnifeEdge("edge", "sleigh")],
    )


# --- Andrews' squeezing mechanism -----------------------------------------------------------------

SQUEEZER = {
    "q_k1": -0.0617138900142764496358948458001, "q_k2": 0.0,
    "q_k3": 0.455279819163070380255912382449, "q_k4": 0.222668390165885884674473185609,
    "q_k5": 0.487364979543842550225598953530, "q_k6": -0.222668390165885884674473185609,
    "q_k7": 1.23054744454982119249735015568,
}  # fmt: skip
SQUEEZED = {
    "q_k1": 15.81077119629904, "q_k2": -15.75637105984298, "q_k3": 0.04082224013073101,
    "q_k4": -0.5347301163226948, "q_k5": 0.5244099658805304, "q_k6": 0.5347301163226948,
    "q_k7": 1.048080741042263,
}  # fmt: skip
"""Angles at t = 0.03 s, printed in Mazzia and Magherini, Test Set for IVP Solvers, rel. 2.4 (2008),
problem Andrews' squeezing mechanism."""


def squeezer():
    """Seven bodies in a plane: Hairer and Wanner, Solving ODEs II, 2nd ed. (1996), sec. VII.7.

    A link's frame has its x axis along the cosine of its angle. P, where three loops close, is the end
    of link 2, which points backwards.
    """
    A, B, C = (-0.06934, -0.00227, 0), (-0.03635, 0.03273, 0), (0.014, 0.072)
    c0, l0, sc, sd = 4530, 0.07785, 0.018, 0.02
    gamma = sp.Symbol("q_k3", real=True)
    D = [
        B[0] + sc * sp.sin(gamma) + sd * sp.cos(gamma),
        B[1] - sc * sp.cos(gamma) + sd * sp.sin(gamma),
    ]
    length = sp.sqrt((D[0] - C[0]) ** 2 + (D[1] - C[1]) ** 2)
    pull = [c0 * (length - l0) / length * (c - x) for c, x in zip(C, D, strict=True)]
    rows = (
        ("k1", 0.04325, (0.00092, 0, 0), 2.194e-6, GROUND, (0, 0, 0)),
        ("k2", 0.00365, (-0.0115, 0, 0), 4.410e-7, "k1", (0.007, 0, 0)),
        ("k3", 0.02373, (0.01043, -0.01874, 0), 5.255e-6, GROUND, B),
        ("k5", 0.07050, (0.02308, 0.00916, 0), 1.169e-5, GROUND, A),
        ("k4", 0.00706, (0, -(0.02 - 0.01421), 0), 5.667e-7, "k5", (0.04, 0, 0)),
        ("k7", 0.05498, (-0.00449, -0.01228, 0), 1.912e-5, GROUND, A),
        ("k6", 0.00706, (0.02 - 0.01421, 0, 0), 5.667e-7, "k7", (0, -0.04, 0)),
    )
    ends = (("k3", (0, -0.035, 0)), ("k4", (0, -0.02, 0)), ("k6", (0.02, 0, 0)))
    return Tree(
        "squeezer",
        [
            Body(name, mass, centre, (inertia / 2, inertia / 2, inertia))
            for name, mass, centre, inertia, _, _ in rows
        ],
        [
            Joint(name, "revolute", parent, name, on_parent=Placement(where),
                  force=0.033 if name == "k1" else 0)
            for name, _, _, _, parent, where in rows
        ],
        loads=[Load("k3", force=(*pull, 0), point=(sd, -sc, 0))],
        constraints=[
            Loop(f"p{name}", "revolute", "k2", name, on_first=Placement((-0.028, 0, 0)),
                 on_second=Placement(end))
            for name, end in ends
        ],
    )  # fmt: skip


def point_mass_free():
    """A body without constraints."""
    return Tree("free", [Body("b", 1)], [Joint("x", "prismatic", GROUND, "b", "x")])
