"""Numerical stability: checks that are measured, each against a bound that follows from something."""
