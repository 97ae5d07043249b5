"""The three lectures' displayed equations, and the derivation step that states each of them.

Lectures: 000, more rigid-body dynamics; 001, energy dissipation and the spinning symmetric body; 002,
dynamics from a point mass to a rigid body. An equation is known by its place among the displays of
its lecture (``002:E16``) and by its number where it has one. Where a lecture is wrong or damaged,
the step states the corrected equation, and a note here says what was changed.
"""

from __future__ import annotations

from dataclasses import dataclass

from eom.derivations import derive, names

DISPLAYS = {"000": 39, "001": 14, "002": 39}
"""How many equations each lecture displays."""

NUMBERS = {
    **{f"002:E{k}": f"(3.{k})" for k in range(1, 5)},
    **{f"002:E{k + 1}": f"(3.{k})" for k in range(5, 36)},
    **{f"002:E{37 + k}": f"(3.36{letter})" for k, letter in enumerate("abc")},
}
"""The numbers that lecture 002 gives; its fifth display has none."""

NO_EQUATION = {"001:E9": "a remark that the missing term is no slip, not an equation"}
"""Displays that state nothing."""

NOTES = {
    "000:E1": "the momentum of an element is its velocity times dm: a dot is missing over R",
    "000:E3": "the second factor needs a dot; as written, a vector is crossed with itself",
    "000:E4": "four dots are missing, over R_C twice and over r twice",
    "000:E6": "dots are missing over the second R_C and the second r",
    "000:E14": "the tildes over both r are missing: a column times a column has no meaning",
    "000:E19": "the left side is the rate of H_C; the frames of both derivatives stand on the line",
    "000:E21": "the factor omega at the end needs a dot",
    "000:E22": "both derivatives lack their d: those of omega in I and in B",
    "000:E23": "the first omega needs a dot: J times the rate",
    "000:E24": "the dot belongs to omega on the left, a tilde to it on the right; and the remark "
    "beside it needs a point that is fixed in the body too",
    "000:E29": "frames I and B are missing at the derivatives",
    "000:E35": "the rate of H_C is zero, not H_C",
    "001:E2": "the derivative is that of omega of B in I",
    "001:E7": "three equations on three lines, set in one",
    "001:E11": "row 2 lacks I2 dOmega/dt; as written it holds for a constant spin rate only",
    "002:E6": "the double sum is struck out in the original: internal forces cancel in pairs",
    "002:E9": "the rate of the momentum equals the force, not the momentum itself",
    "002:E22": "the bullets are superscripts: the second inertial derivative",
    "002:E23": "the circle and the bullet stand as a dot product and a number",
    "002:E24": "both crosses are superscripts: rho^x rho^x omega, read from the right",
    "002:E25": "both crosses are superscripts",
    "002:E26": "the bullets are superscripts: inertial derivatives",
    "002:E27": "the subscript is the centre of mass, and the left side its inertial rate",
    "002:E28": "the cross is a superscript, the subscript the centre of mass",
    "002:E31": "the factor C_BA between C_AB and the second rho is missing",
}
"""What was corrected, or read through."""

CLAIMS = {
    "000:C1": "Euler's equation about an inertially fixed point: it must be fixed in the body, too",
    "000:C2": "free rates change unless omega is along a principal axis; of a sphere, never",
    "000:C3": "free rates are constant if omega is along a principal axis, not any one axis",
    "000:C4": "constant rates need neither: a torque omega x J.omega keeps any rates, and without "
    "torque degenerate bodies keep rates along axes of their choice",
    "000:C5": "the magnitude of H_C is constant in all frames: without torque",
    "000:C6": "the energy of rotation is constant: without torque",
    "002:C1": "J is symmetric; positive definite unless all mass lies on a line through O",
    "002:C2": "E is a rotation only for unit eigenvectors in right-handed order",
    "002:C3": "any continuum moves, in translation, like a point mass at its centre",
    "002:C4": "the second term of the torque vanishes about a fixed point and the centre of mass",
}
"""What the lectures claim in words, with what it takes to be true."""


_REMARKS = {**NOTES, **NO_EQUATION, **CLAIMS}


@dataclass(frozen=True)
class Entry:
    """A displayed equation or claim of a lecture, and where it is derived.

    ``identifier``: as 002:E17. ``number``: of the equation, where it is known. ``steps``: (derivation,
    label) of those that state it. ``note``: what is to be said of it.
    """

    identifier: str
    number: str
    steps: tuple[tuple[str, str], ...]
    note: str = ""


def identifiers() -> list[str]:
    """Return the displays of all lectures, in order, then the claims.

    >>> identifiers()[0], len(identifiers())
    ('000:E1', 102)
    """
    displays = [f"{lecture}:E{k}" for lecture, n in DISPLAYS.items() for k in range(1, n + 1)]
    return [*displays, *CLAIMS]


def equation_map() -> dict[str, Entry]:
    """Return every displayed equation and claim with the steps, (derivation, label), that state it.

    By identifier, in the order of the lectures; makes all derivations, which takes some seconds. Raises
    `DerivationError` if a step fails, and `InputError` as `eom.derive`.
    Source: lectures 000, 001 and 002, as identifiers such as 002:E17 say.
    """
    found: dict[str, list[tuple[str, str]]] = {i: [] for i in identifiers()}
    for name in names():
        if name.startswith("inertia-of-"):
            continue
        for step in derive(name).steps:
            for identifier in step.states:
                found[identifier].append((name, step.label))
    return {
        i: Entry(i, NUMBERS.get(i, ""), tuple(steps), _REMARKS.get(i, ""))
        for i, steps in found.items()
    }
