"""Physical dimensions: exponents of mass, length and time, and those of the quantities by name.

Angles have none. What has no known dimension is ``None``, which agrees with every other one.
"""

from __future__ import annotations

import re
from fractions import Fraction
from typing import NamedTuple

from eom.errors import InputError, unknown_name

MAX_EXPONENT = 64


class Dimension(NamedTuple):
    """Exponents of mass, length, time."""

    mass: Fraction = Fraction(0)
    length: Fraction = Fraction(0)
    time: Fraction = Fraction(0)

    def times(self, other: Dimension) -> Dimension:
        """Return the dimension of a product."""
        return Dimension(*(a + b if a and b else a or b for a, b in zip(self, other, strict=True)))

    def power(self, exponent: Fraction | int) -> Dimension:
        """Return the dimension of a power."""
        return Dimension(*(a * exponent for a in self))

    @property
    def words(self) -> str:
        """The unit in SI.

        >>> dimension("N m s").words, dimension("").words
        ('kg m^2/s', '1')
        """
        named = list(zip(("kg", "m", "s"), self, strict=True))
        above = " ".join(_spelt(n, e) for n, e in named if e > 0)
        below = " ".join(_spelt(n, -e) for n, e in named if e < 0)
        below = f"({below})" if " " in below else below
        return (above or "1") + (f"/{below}" if below else "")


def _spelt(name: str, exponent: Fraction) -> str:
    if exponent == 1:
        return name
    return f"{name}^{exponent}" if exponent.denominator == 1 else f"{name}^({exponent})"


def _row(*exponents: int) -> Dimension:
    return Dimension(*(Fraction(e) for e in exponents))


NONE = _row(0, 0, 0)
MASS, LENGTH, TIME = _row(1, 0, 0), _row(0, 1, 0), _row(0, 0, 1)
RATE = _row(0, 0, -1)

UNITS: dict[str, Dimension] = {
    "1": NONE,
    "rad": NONE,
    "deg": NONE,
    "kg": MASS,
    "m": LENGTH,
    "s": TIME,
    "Hz": RATE,
    "N": _row(1, 1, -2),
    "J": _row(1, 2, -2),
    "W": _row(1, 2, -3),
    "Pa": _row(1, -1, -2),
}
"""Units that a lexicon may use."""

QUANTITY_DIMENSIONS: dict[str, str] = {
    name: unit
    for unit, names in {
        "1": "unit identity identity_matrix rotation eigenvectors angle turn_angle free_angle "
        "principal_angle principal_axis euler_parameter euler_vector rodrigues modified_rodrigues "
        "shadow_rodrigues orbit_direction rotor_axis",
        "kg": "mass total_mass",
        "m": "position orbit_radius orbit_position",
        "1/s": "angular_velocity rotor_speed",
        "m^3/s^2": "gravity_parameter",
        "m/s": "velocity exhaust_velocity",
        "m/s^2": "gravity acceleration",
        "N": "force internal_force external_force weight reaction",
        "N m": "torque gravity_torque weight_torque reaction_torque rotor_torque",
        "J": "kinetic_energy rotational_energy gravity_energy weight_energy",
        "kg m": "first_moment",
        "kg m/s": "linear_momentum",
        "kg m^2": "inertia rotor_inertia slug_inertia",
        "kg m^2/s": "angular_momentum absolute_angular_momentum rotor_momentum slug_momentum "
        "slug_damping",
    }.items()
    for name in names.split()
}
"""Units of the quantities of `eom.terms.vocabulary`; those that stand for anything have none."""


def product(a: Dimension | None, b: Dimension | None) -> Dimension | None:
    """Return the dimension of a product, None where one is not known."""
    return None if a is None or b is None else a.times(b)


def power(base: Dimension | None, exponent: Fraction | int) -> Dimension | None:
    """Return the dimension of a power, None where that of its base is not known."""
    return None if base is None else base.power(exponent)


_FACTOR = re.compile(
    r"\s*(?P<over>/)?\s*(?P<name>[A-Za-z]+|1)(?:\s*(?:\^|\*\*)\s*(?P<power>-?[0-9]{1,2}))?\s*[*·]?"
)


def dimension(unit: str, where: str = "") -> Dimension:
    """Return the dimension of a unit; all that follows a stroke up to the next one is below it.

    Raises `InputError` for unknown units and for what is no product of powers.

    >>> dimension("kg m^2/s^2") == dimension("N m")
    True
    """
    found, place, sign = NONE, 0, 1
    text = unit.replace("(", " ").replace(")", " ").strip()
    while place < len(text):
        match = _FACTOR.match(text, place)
        if match is None:
            raise InputError("not a unit", where=where, got=unit, expected="such as kg m^2/s")
        if match["name"] not in UNITS:
            raise unknown_name("unit", match["name"], UNITS, where)
        sign = -1 if match["over"] else sign
        found = found.times(UNITS[match["name"]].power(sign * int(match["power"] or 1)))
        place = match.end()
    return found


def of_quantity(name: str) -> Dimension | None:
    """Return the dimension of a quantity of the vocabulary, or None where it may have any."""
    unit = QUANTITY_DIMENSIONS.get(name)
    return None if unit is None else dimension(unit)
