"""Compile systems of equations of motion, and integrate them."""

from codegen.accuracy import accuracy
from codegen.card import Card
from codegen.compiled import Compiled, compile
from codegen.drift import Drift
from codegen.ensemble import Ensemble, ensemble
from codegen.equilibria import equilibria, equilibrium
from codegen.events import Event
from codegen.exact import FreeMotion, free_body, free_motion
from codegen.integrate.methods import METHODS
from codegen.integrate.trajectory import Stop
from codegen.linear import Linear, compiled_jacobian, linearise
from codegen.linear_motion import LinearMotion, linearise_about
from codegen.run_accuracy import Accuracy
from codegen.sampler import Grid, Normal, Sampler, Uniform, UniformQuaternion
from codegen.sensitivity import Sensitivities, sensitivities
from codegen.signals import Signal
from codegen.simulation import Result, simulate
from codegen.sparse import SparseJacobian
from codegen.steady import Equilibrium
from codegen.tallies import Statistics, Summary

__all__ = [
    "METHODS",
    "Accuracy",
    "Card",
    "Compiled",
    "Drift",
    "Ensemble",
    "Equilibrium",
    "Event",
    "FreeMotion",
    "Grid",
    "Linear",
    "LinearMotion",
    "Normal",
    "Result",
    "Sampler",
    "Sensitivities",
    "Signal",
    "SparseJacobian",
    "Statistics",
    "Stop",
    "Summary",
    "Uniform",
    "UniformQuaternion",
    "accuracy",
    "compile",
    "compiled_jacobian",
    "ensemble",
    "equilibria",
    "equilibrium",
    "free_body",
    "free_motion",
    "linearise",
    "linearise_about",
    "sensitivities",
    "simulate",
]
