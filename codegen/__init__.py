"""Compile systems of equations of motion, and integrate them."""

from codegen.compiled import Compiled, compile
from codegen.integrate.trajectory import Stop
from codegen.simulation import METHODS, Drift, Result, simulate

__all__ = ["METHODS", "Compiled", "Drift", "Result", "Stop", "compile", "simulate"]
