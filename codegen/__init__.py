"""Compile systems of equations of motion, and integrate them."""

from codegen.accuracy import accuracy
from codegen.card import Card
from codegen.compiled import Compiled, compile
from codegen.integrate.trajectory import Stop
from codegen.linear import Linear, SparseJacobian, compiled_jacobian, linearise
from codegen.simulation import METHODS, Drift, Result, simulate

__all__ = [
    "METHODS",
    "Card",
    "Compiled",
    "Drift",
    "Linear",
    "Result",
    "SparseJacobian",
    "Stop",
    "accuracy",
    "compile",
    "compiled_jacobian",
    "linearise",
    "simulate",
]
