"""The groups of results that the program of a system has."""

RATES, OUTPUTS, INVARIANTS, SINGULARITIES = "rates", "outputs", "invariants", "singularities"
GROUPS = (RATES, OUTPUTS, INVARIANTS, SINGULARITIES)
"""Groups of results of a lowered system."""
