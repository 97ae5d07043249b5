"""Compile systems of equations of motion, and integrate them."""

from codegen.accuracy import accuracy
from codegen.card import Card
from codegen.compiled import Compiled, compile
from codegen.exact import FreeMotion, free_body, free_motion
from codegen.integrate.methods import METHODS
from codegen.integrate.trajectory import Stop
from codegen.linear import Linear, compiled_jacobian, linearise
from codegen.sensitivity import Sensitivities, sensitivities
from codegen.simulation import Drift, Result, simulate
from codegen.sparse import SparseJacobian

__all__ = [
    "METHODS",
    "Card",
    "Compiled",
    "Drift",
    "FreeMotion",
    "Linear",
    "Result",
    "Sensitivities",
    "SparseJacobian",
    "Stop",
    "accuracy",
    "compile",
    "compiled_jacobian",
    "free_body",
    "free_motion",
    "linearise",
    "sensitivities",
    "simulate",
]
