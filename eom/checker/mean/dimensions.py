"""Physical dimensions of the quantities of the vocabulary by name; those of units are `eom.units`.

Angles have none. What has no known dimension is ``None``, which agrees with every other one.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from eom.units import NONE, Dimension, dimension

__all__ = (
    "LENGTH", "MASS", "NONE", "QUANTITY_DIMENSIONS", "RATE", "TIME", "UNITS",
    "Dimension", "by_rows_and_columns", "dimension", "of_quantity", "power", "product",
)  # fmt: skip

MASS, LENGTH, TIME = dimension("kg"), dimension("m"), dimension("s")
RATE = dimension("1/s")

UNITS: dict[str, Dimension] = {
    name: dimension(name) for name in "1 rad deg kg m s Hz N J W Pa".split()
}
"""Units of SI that numbers in notes may have."""

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
        "N": "force internal_force external_force constraint_force applied_force weight reaction",
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


def of_quantity(name: str) -> Dimension | None:
    """Return the dimension of a quantity of the vocabulary, or None where it may have any."""
    unit = QUANTITY_DIMENSIONS.get(name)
    return None if unit is None else dimension(unit)


def by_rows_and_columns(grid: Sequence[Sequence[Dimension | None]]) -> bool:
    """Return whether each entry can be a product of one dimension of its row and one of its column.

    So are the coefficients of linear equations, and those in a determinant. None: any dimension.
    """
    sizes: dict[tuple[str, int], Dimension] = {}
    cells = [(i, j, d) for i, row in enumerate(grid) for j, d in enumerate(row) if d is not None]
    while cells:
        place = next(
            (c for c in cells if ("row", c[0]) in sizes or ("column", c[1]) in sizes), None
        )
        i, j, d = place or cells[0]
        cells.remove((i, j, d))
        row, column = sizes.get(("row", i)), sizes.get(("column", j))
        if row is not None and column is not None and row.times(column) != d:
            return False
        row = row or (NONE if column is None else d.times(column.power(-1)))
        sizes["row", i], sizes["column", j] = row, d.times(row.power(-1))
    return True
