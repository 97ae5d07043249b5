"""Compile systems of equations of motion, and integrate them."""

from codegen.closed.exact import FreeMotion, free_body, free_motion
from codegen.compiling.compiled import Compiled, compile, compiled_jacobian
from codegen.compiling.events import Event
from codegen.compiling.sampled import Sampled
from codegen.compiling.signals import Signal
from codegen.compiling.sparse import SparseJacobian
from codegen.ensembles.ensemble import Ensemble, ensemble
from codegen.ensembles.sampler import Grid, Normal, Sampler, Uniform, UniformQuaternion
from codegen.ensembles.statistics import Statistics, Summary
from codegen.integrate.methods import METHODS
from codegen.linearisation.equilibria import equilibria, equilibrium
from codegen.linearisation.linear_motion import Linear, LinearMotion, linearise, linearise_about
from codegen.linearisation.sensitivity import Sensitivities, sensitivities
from codegen.linearisation.unknowns import Equilibrium
from codegen.native.native import CompilerError
from codegen.native.trajectory import Stop
from codegen.precision.accuracy import accuracy
from codegen.precision.domain import AccuracyReport
from codegen.runs.pruning import Drift
from codegen.runs.run_accuracy import Accuracy
from codegen.runs.simulation import Result, simulate

__all__ = [
    "METHODS",
    "Accuracy",
    "AccuracyReport",
    "Compiled",
    "CompilerError",
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
    "Sampled",
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


def __dir__() -> list[str]:
    """Show the public names alone, not the folders that they come from."""
    return sorted(__all__)
