"""Formulas of a scene with many bodies as values: over parameters, time, inputs and states."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

import sympy as sp

from eom.errors import InputError, unknown_name
from eom.kinematics.coordinates import SEQUENCES, rotation_sequence
from eom.multibody.algebra.spatial import IDENTITY, Matrix
from eom.multibody.algebra.values import Value, is_number, value
from eom.multibody.files.places import Turned
from eom.scenes import parse

Names = Mapping[str, Any]


class Formulas:
    """Reads formulas over names, and keeps which names were used."""

    def __init__(self, names: Names) -> None:
        self.names = names
        self.used: set[str] = set()

    def value(self, given: Any, where: str) -> Value:
        """Return a number or formula as a value. Raises `InputError` with its place."""
        if not isinstance(given, str):
            return value(given, where)
        found = parse.parse(given, self.names, where)
        self.used |= {str(s.name) for s in found.free_symbols}
        return rounded(found, where)

    def values(self, given: Iterable[Any], where: str) -> tuple[Value, ...]:
        """Return the value of each."""
        return tuple(self.value(g, where) for g in given)

    def matrix(self, given: Iterable[Iterable[Any]], where: str) -> tuple[tuple[Value, ...], ...]:
        """Return the values of rows."""
        return tuple(self.values(row, where) for row in given)

    def each(self, given: Any, where: str) -> Any:
        """Return one value, or those of a list."""
        if isinstance(given, tuple | list):
            return self.values(given, where)
        return self.value(given, where)

    def rotation(self, given: Turned | None, where: str) -> Matrix:
        """Return the matrix of a rotation. Raises `InputError` unless it is given in one way."""
        if given is None:
            return IDENTITY
        keys = ("matrix", "radians", "degrees")
        told = [k for k in keys if getattr(given, k) is not None]
        if len(told) != 1:
            got, expected = ", ".join(told) or "none", "matrix, radians or degrees"
            raise InputError(
                "a rotation needs exactly one description", where=where, got=got, expected=expected
            )
        if given.matrix is not None:
            return self.matrix(given.matrix, where)
        factor = sp.pi / 180 if given.degrees is not None else sp.Integer(1)
        angles = self.values(given.degrees or given.radians or (), where)
        return turned(
            given.sequence, [right(sp.sympify(a, strict=True) * factor) for a in angles], where
        )


def turned(sequence: str, angles: Iterable[Any], where: str) -> tuple[tuple[Value, ...], ...]:
    """Return the matrix of a rotation sequence (`eom.kinematics.coordinates`) for angles in radians."""
    if sequence not in SEQUENCES:
        raise unknown_name("rotation sequence", sequence, SEQUENCES, where)
    C = rotation_sequence(sequence, list(angles)).matrix
    return tuple(tuple(rounded(C[i, j], where) for j in range(3)) for i in range(3))


def rounded(expression: Any, where: str) -> Value:
    """Return a number that is no fraction as the nearest double, everything else as it is."""
    if expression.is_number and not expression.is_Rational:
        return value(float(expression), where)
    return value(expression, where)


RIGHT = 4
"""Spacings of doubles by which a right angle may be off and still have sines of exactly 0 and 1."""


def right(angle: Any) -> Any:
    """Return an angle that is a rounded multiple of a right angle as that multiple of pi."""
    if not (angle.is_Float or angle.is_Rational):
        return angle
    turns = round(float(angle) / float(sp.pi / 2))
    near = turns * sp.pi / 2
    close = abs(float(angle) - float(near)) <= RIGHT * 2.0**-52 * abs(float(near))
    return near if close else angle


def number(given: Value) -> float:
    """Return a value without symbols as a double."""
    return float(given) if is_number(given) else float(sp.N(given))


def numbered(expression: Value, values: Mapping[str, float]) -> float:
    """Return a value for numbers of its symbols by name."""
    if is_number(expression):
        return float(Fraction(expression))
    numbers = {s: sp.Float(values[s.name]) for s in expression.free_symbols}
    return float(expression.xreplace(numbers))
