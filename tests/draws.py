"""Strategies that several tests draw from; none of them draws and throws away."""

from hypothesis import settings
from hypothesis import strategies as st


def nonzero(low, high):
    """Floats of either sign whose magnitudes lie between ``low`` and ``high``."""
    return st.floats(low, high) | st.floats(-high, -low)


def examples(count):
    """Settings of a property: ``count`` examples where the profile has 100, else in proportion."""
    return settings(max_examples=max(5, count * settings.default.max_examples // 100))
