"""Statistics that merge: against exact arithmetic, the same bits in any order and division."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen import Statistics
from codegen.ensembles.statistics import BLOCK, Bins, Tree, bins_of, of_blocks, summary
from eom.errors import InputError

RNG = np.random.default_rng(3)


def tree_of(values, cuts=(), order=None):
    """The moments of values (rows, N), cut at blocks and added in some order."""
    edges = [0, *(c * BLOCK for c in cuts), values.shape[1]]
    parts = [(a, values[:, a:b]) for a, b in pairwise(edges)]
    tree = Tree()
    for k in order if order is not None else range(len(parts)):
        first, part = parts[k]
        inner = Tree()
        for number, moments in enumerate(of_blocks(part), first // BLOCK):
            inner.add(0, number, moments)
        for (level, number), moments in inner.nodes.items():
            tree.add(level, number, moments)
    return tree.total()


@settings(max_examples=20)
@given(data=st.data())
def test_moments_are_the_same_bits_in_any_division_and_order(data):
    blocks = data.draw(st.integers(1, 12))
    count = (blocks - 1) * BLOCK + data.draw(st.integers(1, BLOCK))
    values = RNG.normal(size=(3, count)) * 10.0 ** RNG.integers(-5, 5, (3, 1))
    values[RNG.random((3, count)) < 0.1] = np.nan
    cuts = sorted(data.draw(st.sets(st.integers(1, blocks - 1))) if blocks > 1 else ())
    order = data.draw(st.permutations(range(len(cuts) + 1)))
    whole, other = tree_of(values), tree_of(values, cuts, order)
    for field in ("count", "mean", "squares", "low", "high"):
        np.testing.assert_array_equal(getattr(whole, field), getattr(other, field))


@pytest.mark.parametrize("offset", [0.0, 1e9, -1e15])
def test_variance_is_right_where_the_mean_is_large(offset):
    """A sum of squares less the square of the sum would have lost all digits at 1e9."""
    values = offset + RNG.uniform(-1, 1, (1, 5000))
    exact = [Fraction(float(v)) for v in values[0]]
    mean = sum(exact) / len(exact)
    variance = sum((v - mean) ** 2 for v in exact) / (len(exact) - 1)
    found = summary("x", np.zeros(1), tree_of(values), (0, 1))
    assert float(abs(Fraction(float(found.mean[0])) - mean)) <= 4e-16 * abs(offset) + 1e-16
    assert abs(found.variance[0] / float(variance) - 1) < 1e-12 + 1e-15 * abs(offset)
    assert found.minimum[0] == values.min()
    assert found.maximum[0] == values.max()
    assert found.deviation[0] == np.sqrt(found.variance[0])


def test_nothing_and_one_value():
    values = np.full((3, 300), np.nan)
    values[1, 299] = 4.0
    values[2, :2] = np.inf, 5.0
    found = summary("x", np.zeros(3), tree_of(values), (0, 3))
    assert found.count.tolist() == [0, 1, 1]
    assert found.mean.tolist()[1:] == [4.0, 5.0]
    assert np.isnan(found.mean[0])
    assert np.isnan(found.variance).all()
    assert np.isnan(found.minimum[0])


@settings(max_examples=30)
@given(
    values=st.lists(st.floats(-1e300, 1e300, allow_subnormal=False), min_size=1, max_size=200),
    share=st.floats(0, 1),
    cut=st.integers(0, 200),
)
def test_quantiles_are_right_to_a_thousandth_of_themselves(values, share, cut):
    array = np.array(values)[None]
    parts = [bins_of(p) for p in (array[:, :cut], array[:, cut:])]
    found = summary("x", np.zeros(1), tree_of(array), (0, 1), Bins.joined(parts))
    exact = np.quantile(array, share, method="inverted_cdf")
    assert abs(found.quantile(share)[0] - exact) <= 1e-3 * abs(exact) + 1e-300
    assert found.quantile([0.0, 1.0])[0].tolist() == [array.min(), array.max()]


def test_refusals():
    with pytest.raises(InputError, match="ascending"):
        Statistics(("x",), edges={"x": [1, 1]})
    with pytest.raises(InputError, match="nothing is counted"):
        Statistics(("x",), edges={"y": [1, 2]})
    found = summary("x", np.zeros(1), tree_of(np.ones((1, 3))), (0, 1))
    with pytest.raises(InputError, match="no quantiles"):
        found.quantile(0.5)
    with pytest.raises(InputError, match="between 0 and 1"):
        summary(
            "x", np.zeros(1), tree_of(np.ones((1, 3))), (0, 1), bins_of(np.ones((1, 3)))
        ).quantile(2)
