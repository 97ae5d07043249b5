"""Symbolic analysis: what is cyclic, steady, stable, small and conserved, as formulas.

In: a closed form, or kinetic and potential energy by hand. Out: formulas that were proved.
Imports: `eom.derivations`, `eom.errors`, `eom.exact`, `eom.expressions`, `eom.fields`,
`eom.multibody.closed`, `eom.multibody.model`, `eom.quantities`, `eom.typeset`.
"""

from eom.multibody.analysis.conserved import Conserved, conserved_quantities
from eom.multibody.analysis.cyclic import Cyclic, Routhian, cyclic_coordinates, routh
from eom.multibody.analysis.energies import Equations, Lagrangian, equations_of, lagrangian
from eom.multibody.analysis.pages import analysis_page
from eom.multibody.analysis.steady import (
    Linearised,
    SmallMotion,
    Stability,
    SteadyMotion,
    linearised,
    small_motion,
    stability,
    steady_motion,
)

__all__ = [
    "Conserved",
    "Cyclic",
    "Equations",
    "Lagrangian",
    "Linearised",
    "Routhian",
    "SmallMotion",
    "Stability",
    "SteadyMotion",
    "analysis_page",
    "conserved_quantities",
    "cyclic_coordinates",
    "equations_of",
    "lagrangian",
    "linearised",
    "routh",
    "small_motion",
    "stability",
    "steady_motion",
]
