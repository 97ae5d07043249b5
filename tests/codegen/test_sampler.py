"""Samples: a pure function of seed and number, with the distributions that they claim."""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import kstest

from codegen import Grid, Normal, Sampler, Uniform, UniformQuaternion
from eom.errors import InputError

Q = ("q0", "q1", "q2", "q3")
MIXED = Sampler(
    {"a": Uniform(-1, 3), "b": Normal(2, 0.5), Q: UniformQuaternion(), "c": 7.0, "d": Grid(0, 1, 3)},
    40_000,
    seed=11,
)  # fmt: skip


@given(first=st.integers(0, 2**40), size=st.integers(0, 50), cut=st.integers(0, 50))
def test_a_sample_does_not_depend_on_the_range_it_is_drawn_in(first, size, cut):
    whole = MIXED.sample(first, first + size)
    middle = first + min(cut, size)
    parts = [MIXED.sample(first, middle), MIXED.sample(middle, first + size)]
    for name, values in whole.items():
        np.testing.assert_array_equal(values, np.concatenate([p[name] for p in parts]))


def test_seeds_differ_and_samples_survive_pickling():
    again = pickle.loads(pickle.dumps(MIXED))
    other = Sampler(MIXED.values, MIXED.count, seed=12)
    np.testing.assert_array_equal(again.sample(5, 9)["a"], MIXED.sample(5, 9)["a"])
    assert not np.isin(other.sample(0, 999)["a"], MIXED.sample(0, 999)["a"]).any()


def test_distributions():
    """Kolmogorov and Smirnov's test: a right sampler fails a seed in a thousand, and this one is fixed."""
    found = MIXED.sample(0, 40_000)
    assert kstest(found["a"], "uniform", (-1, 4)).pvalue > 1e-3
    assert kstest(found["b"], "norm", (2, 0.5)).pvalue > 1e-3
    q = np.stack([found[n] for n in Q])
    np.testing.assert_allclose((q**2).sum(axis=0), 1.0, rtol=1e-14)
    # of a uniform rotation w^2 + z^2 and the three entries of a row of the matrix / 2 + 1/2 are uniform
    w, x, y, z = q
    for entry in (w**2 + x**2 - y**2 - z**2, 2 * (x * y - w * z), 2 * (x * z + w * y)):
        assert kstest(entry, "uniform", (-1, 2)).pvalue > 1e-3
    assert abs(np.corrcoef([found["a"], found["b"], w, x, y, z]) - np.eye(6)).max() < 0.02
    assert (found["c"] == 7.0).all()
    np.testing.assert_array_equal(found["d"][:4], [0.0, 0.5, 1.0, 0.0])


def test_grids_are_crossed_once_each():
    sampler = Sampler({"a": Grid(0, 1, 2), "b": Grid(-1, 1, 3), "c": Grid(5, 9, 1)})
    found = sampler.sample(0, len(sampler))
    assert len(sampler) == 6
    assert found["a"].tolist() == [0, 0, 0, 1, 1, 1]
    assert found["b"].tolist() == [-1, 0, 1, -1, 0, 1]
    assert found["c"].tolist() == [5] * 6


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Uniform(2, 1), "limits"),
        (lambda: Uniform(0, float("nan")), "limits"),
        (lambda: Normal(0, -1), "deviation"),
        (lambda: Grid(0, 1, 0), "grid"),
        (lambda: Sampler({"a": UniformQuaternion()}, 3), "names do not fit"),
        (lambda: Sampler({("a", "b"): Uniform(0, 1)}, 3), "names do not fit"),
        (lambda: Sampler({"a": 1.0, ("q0", "a", "c", "d"): UniformQuaternion()}, 3), "two"),
        (lambda: Sampler({"a": Uniform(0, 1)}, -1), "count"),
        (lambda: Sampler({"a": Uniform(0, 1)}, 3, seed=-5), "seed"),
        (lambda: Sampler({"a": Uniform(0, 1)}, 3, seed=2**128), "seed"),
    ],
)
def test_what_cannot_be_sampled_is_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()
