import pytest
from hypothesis import given
from hypothesis import strategies as st

from eom.checker.mean import dimensions
from eom.checker.mean.dimensions import NONE, QUANTITY_DIMENSIONS, Dimension, dimension, of_quantity
from eom.errors import InputError
from eom.terms.vocabulary import QUANTITIES

ANYTHING = {"function", "scalar", "coordinate", "vector", "fixed_vector", "dyadic"}
powers = st.integers(-6, 6)


@given(powers, powers, powers)
def test_a_dimension_reads_its_own_words(mass, length, time):
    made = NONE
    for name, power in (("kg", mass), ("m", length), ("s", time)):
        made = made.times(dimension(name).power(power))
    assert dimension(made.words) == made


def test_derived_units():
    assert dimension("N m") == dimension("J") == dimension("kg m^2/s^2") == dimension("W s")
    assert dimension("kg m^2 / s") == dimension("N*m*s")
    assert dimension("1/s") == dimension("Hz")
    assert dimension("rad") == NONE


def test_every_quantity_has_a_dimension_unless_it_may_be_anything():
    assert set(QUANTITIES) - set(QUANTITY_DIMENSIONS) == ANYTHING
    assert of_quantity("vector") is None
    assert of_quantity("inertia") == dimension("kg m^2")


@pytest.mark.parametrize("unit", ["kilo", "kg^", "m^^2", "2 m", "kg m^999", "§"])
def test_other_units_are_refused(unit):
    with pytest.raises(InputError):
        dimension(unit, "here")


def test_powers_of_a_half():
    from fractions import Fraction

    half = dimension("m^2/s^2").power(Fraction(1, 2))
    assert half == Dimension(*dimension("m/s"))


KG, S, N1 = (dimensions.dimension(u) for u in ("kg", "s", "1"))


@pytest.mark.parametrize(
    ("grid", "fits"),
    [
        ([[KG, S], [KG, S]], True),
        ([[KG, KG.times(S)], [N1, S]], True),
        ([[KG, KG], [KG, S]], False),
        ([[None, KG], [S, None]], True),
        ([[KG, None, S], [None, KG, S], [KG, KG, None]], True),
        ([[KG, S, None], [None, KG, S], [KG, None, KG]], False),
        ([[KG, S], [S, KG]], False),
    ],
)
def test_coefficients_have_dimensions_by_rows_and_columns(grid, fits):
    assert dimensions.by_rows_and_columns(grid) is fits
