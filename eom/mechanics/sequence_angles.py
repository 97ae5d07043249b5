"""Angles of a rotation sequence over a unit quaternion: as outputs, and in formulas that name them.

A quaternion is the attitude without whole turns. As functions of it the first and the third angle are
between -pi and pi; whoever has them at many times counts the turns (`codegen.runs.turns`, and a function
beside generated C and JavaScript). Formulas may read these two in sines and cosines alone, where whole
turns do not matter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.kinematics.coordinates import RotationSequence
from eom.system import Definition, Quantity, SequenceAngles, Singularity, System

Expr = Any


def with_angles(
    system: System,
    angles: RotationSequence,
    quaternion: Sequence[Expr],
    named: Sequence[Quantity] = (),
) -> System:
    """Return a system whose outputs are also the ``angles`` (rad) of a ``quaternion`` among its states.

    ``named``: what the outputs are called, by default as the angles are.
    """
    quantities = tuple(named) or angles.coordinates
    first, second, third = angles.principal_of_quaternion(quaternion)
    values = (jumping(first), second, jumping(third))
    outputs = tuple(Definition(q, v) for q, v in zip(quantities, values, strict=True))
    (a, b, c), (d, e, f, g) = (q.name for q in quantities), (str(q) for q in quaternion)
    stated = SequenceAngles((a, b, c), angles.name, (d, e, f, g))
    return replace(system, outputs=(*system.outputs, *outputs), angles=(*system.angles, stated))


def jumping(angle: Expr) -> Expr:
    """Return an angle from -pi on below pi as such: the floor shows that it jumps by whole turns."""
    return angle - 2 * sp.pi * sp.floor((angle + sp.pi) / (2 * sp.pi))


def over_quaternion(
    expression: Expr, angles: RotationSequence, quaternion: Sequence[Expr], where: str
) -> Expr:
    """Return an expression in ``angles`` over a quaternion of unit norm.

    Raises `InputError` where it depends on whole turns of the first or the third.
    """
    first, second, third = angles.angles
    for angle in (first, third):
        inside = expression.atoms(sp.sin, sp.cos, sp.tan)
        hidden = {f: sp.Dummy() for f in inside if f.args[0].diff(angle).is_Integer}
        if angle in expression.xreplace(hidden).free_symbols:
            raise InputError(
                f"whole turns of {angle} are not known to a quaternion",
                where=where,
                got=expression,
                expected=f"{angle} in sines and cosines alone, times whole numbers",
                hint='leave out integrate = "quaternion"',
            )
    values = dict(zip((first, second, third), angles.of_quaternion(quaternion), strict=True))
    turned = sp.expand_trig(sp.expand(expression)).xreplace(values)
    return sp.expand_trig(turned)


def undirected(angles: RotationSequence, quaternion: Sequence[Expr]) -> Singularity:
    """Return where a law that reads the first or the third angle has no direction."""
    s = angles.singularities[0].expression
    over = sp.expand_trig(s).xreplace({angles.angles[1]: angles.of_quaternion(quaternion)[1]})
    meaning = f"the torque needs angles of the {angles.name} sequence that are undefined there"
    return Singularity(sp.expand_trig(over), quaternion[-1], meaning)
