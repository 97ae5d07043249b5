"""Compile systems of equations of motion, and integrate them.

The names below load on first use, as those of `eom` do.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from codegen.closed.exact import FreeMotion as FreeMotion
    from codegen.closed.exact import free_body as free_body
    from codegen.closed.exact import free_motion as free_motion
    from codegen.compiling.compiled import Compiled as Compiled
    from codegen.compiling.compiled import compile as compile
    from codegen.compiling.compiled import compiled_jacobian as compiled_jacobian
    from codegen.compiling.events import Event as Event
    from codegen.compiling.generated import generate as generate
    from codegen.compiling.sampled import Sampled as Sampled
    from codegen.compiling.signals import Signal as Signal
    from codegen.compiling.sparse import SparseJacobian as SparseJacobian
    from codegen.ensembles.ensemble import Ensemble as Ensemble
    from codegen.ensembles.ensemble import ensemble as ensemble
    from codegen.ensembles.sampler import Grid as Grid
    from codegen.ensembles.sampler import Normal as Normal
    from codegen.ensembles.sampler import Sampler as Sampler
    from codegen.ensembles.sampler import Uniform as Uniform
    from codegen.ensembles.sampler import UniformQuaternion as UniformQuaternion
    from codegen.ensembles.statistics import Statistics as Statistics
    from codegen.ensembles.statistics import Summary as Summary
    from codegen.fmu.package import write_fmu as write_fmu
    from codegen.integrate.methods import METHODS as METHODS
    from codegen.linearisation.equilibria import equilibria as equilibria
    from codegen.linearisation.equilibria import equilibrium as equilibrium
    from codegen.linearisation.linear_motion import Linear as Linear
    from codegen.linearisation.linear_motion import LinearMotion as LinearMotion
    from codegen.linearisation.linear_motion import linearise as linearise
    from codegen.linearisation.linear_motion import linearise_about as linearise_about
    from codegen.linearisation.sensitivity import Sensitivities as Sensitivities
    from codegen.linearisation.sensitivity import sensitivities as sensitivities
    from codegen.linearisation.unknowns import Equilibrium as Equilibrium
    from codegen.native.native import CompilerError as CompilerError
    from codegen.native.trajectory import Stop as Stop
    from codegen.precision.accuracy import accuracy as accuracy
    from codegen.precision.domain import AccuracyReport as AccuracyReport
    from codegen.runs.prepared import Integrator as Integrator
    from codegen.runs.pruning import Drift as Drift
    from codegen.runs.result import Result as Result
    from codegen.runs.run_accuracy import Accuracy as Accuracy
    from codegen.runs.simulation import integrator as integrator
    from codegen.runs.simulation import simulate as simulate

_HOME = {
    "Accuracy": "runs.run_accuracy",
    "AccuracyReport": "precision.domain",
    "Compiled": "compiling.compiled",
    "CompilerError": "native.native",
    "Drift": "runs.pruning",
    "Ensemble": "ensembles.ensemble",
    "Equilibrium": "linearisation.unknowns",
    "Event": "compiling.events",
    "FreeMotion": "closed.exact",
    "Grid": "ensembles.sampler",
    "Integrator": "runs.prepared",
    "Linear": "linearisation.linear_motion",
    "LinearMotion": "linearisation.linear_motion",
    "METHODS": "integrate.methods",
    "Normal": "ensembles.sampler",
    "Result": "runs.result",
    "Sampled": "compiling.sampled",
    "Sampler": "ensembles.sampler",
    "Sensitivities": "linearisation.sensitivity",
    "Signal": "compiling.signals",
    "SparseJacobian": "compiling.sparse",
    "Statistics": "ensembles.statistics",
    "Stop": "native.trajectory",
    "Summary": "ensembles.statistics",
    "Uniform": "ensembles.sampler",
    "UniformQuaternion": "ensembles.sampler",
    "accuracy": "precision.accuracy",
    "compile": "compiling.compiled",
    "compiled_jacobian": "compiling.compiled",
    "ensemble": "ensembles.ensemble",
    "equilibria": "linearisation.equilibria",
    "equilibrium": "linearisation.equilibria",
    "free_body": "closed.exact",
    "free_motion": "closed.exact",
    "generate": "compiling.generated",
    "integrator": "runs.simulation",
    "linearise": "linearisation.linear_motion",
    "linearise_about": "linearisation.linear_motion",
    "sensitivities": "linearisation.sensitivity",
    "simulate": "runs.simulation",
    "write_fmu": "fmu.package",
}

__all__ = list(_HOME)


def __getattr__(name: str) -> object:
    """Import the module that holds ``name`` on first use."""
    if name not in _HOME:
        raise AttributeError(f"module 'codegen' has no attribute {name!r}")
    found = globals()[name] = getattr(importlib.import_module(f"codegen.{_HOME[name]}"), name)
    return found


def __dir__() -> list[str]:
    """Show the public names alone, not the folders that they come from."""
    return sorted(__all__)
