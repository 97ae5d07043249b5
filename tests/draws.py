"""Strategies that several tests draw from; none of them draws and throws away."""

from hypothesis import strategies as st


def nonzero(low, high):
    """Floats of either sign whose magnitudes lie between ``low`` and ``high``."""
    return st.floats(low, high) | st.floats(-high, -low)
