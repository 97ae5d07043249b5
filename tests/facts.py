"""What the docstring of each public name must state, in these words: shapes, units, conventions, source.

`NONE` says that there is nothing to state: no arrays, no quantities, no frames or signs, no formula of
mechanics or numerics. What has arrays or numbers by its annotations may not say so (`test_reference.py`).
"""

from __future__ import annotations

import re

NONE = "-"

COLUMNS = {
    "shapes": re.compile(
        r"\(.*,.*\)|\d x \d|three|four numbers|numbers each|shapes|``shape``|as of `"
    ),
    "units": re.compile(
        r"\b(SI|rad|kg|N|m|s|J|ulps|units?)\b|1/s|relative to|radians|metres", re.IGNORECASE
    ),
    "conventions": re.compile(
        r"\b(frames?|axes|axis|b[123]|a3|in B|C_BA|components|"
        r"scalar first|right-handed|minus|signs?|opposites?|"
        r"along|towards|direction|turn|inertial|against|less|backwards|exerts|conventions)\b|"
        r"-integral|on a joint|on the child|on ``|from the first|by the (gradient|coefficients)|see `",
        re.IGNORECASE,
    ),
    "source": re.compile(
        r"\b(19|20)\d\d\b|lectures? 00\d|as (those )?of `|see `|are those of `|modules of"
    ),
}
"""What a fact of each kind looks like."""

INNER = frozenset(
    {
        "codegen.exact.Form",
        "codegen.polhode.Polhode",
        "codegen.program.Program",
        "codegen.tallies.Bins",
        "codegen.tallies.Moments",
        "eom.exercises.slips.Around",
        "eom.letters.Notation",
        "eom.multibody.closed.readable.Writer",
        "eom.multibody.dependence.Sample",
        "eom.multibody.joints.Kind",
        "eom.terms.Equation",
        "eom.terms.Term",
        "eom.views.figures.Figures",
    }
)
"""Classes that users come to and need not know: how results are computed, written or verified."""

NEVER = {
    "eom.Scene.attitudes": "the name of the attitude was checked when the scene was made",
}
"""What raises nothing though what it calls may, and why."""

FACTS = {
    # name: (shapes, units, conventions, source)
    "eom.__version__": (NONE, NONE, NONE, NONE),
    "eom.check": (NONE, "compared in SI", "frames and signs are those that the lexicon", "1980"),
    "eom.check_files": (NONE, NONE, NONE, NONE),
    "eom.Derivation": (NONE, "in SI units", NONE, NONE),
    "eom.derive": (NONE, "Frames, units and sources", "Frames, units and sources", NONE),
    "eom.AssumptionError": (NONE, NONE, NONE, NONE),
    "eom.InputError": (NONE, NONE, NONE, NONE),
    "eom.euler_equations": (
        "3 x 3",
        "(kg m^2)",
        "in B",
        "Goldstein, Classical Mechanics (2002), sect. 5.5",
    ),
    "eom.free_rigid_body": (NONE, "T (J)", "scalar first", "Goldstein, Classical Mechanics (2002)"),
    "eom.full_inertia": ("3 x 3", "kg m^2", "minus the products of inertia", NONE),
    "eom.gravity_gradient_satellite": (
        NONE,
        "(rad/s)",
        "a3 the orbit normal",
        "Hughes, Spacecraft Attitude Dynamics (1986), sect. 8.1",
    ),
    "eom.heavy_top": (
        NONE,
        "m (kg)",
        "under its weight along -a3",
        "Goldstein, Classical Mechanics (2002), sect. 5.7",
    ),
    "eom.principal_inertia": ("3 x 3", "kg m^2", "principal axes b1, b2, b3", NONE),
    "eom.rigid_body": (
        NONE,
        "(rad/s, of B in inertial space",
        "C_BA takes components in A to components in B",
        "Hughes, Spacecraft Attitude Dynamics (1986)",
    ),
    "eom.Scene": (
        NONE,
        "SI units, angles in radians",
        "C_BA from components in A to those in B",
        NONE,
    ),
    "eom.TreeScene": (
        NONE,
        "SI units, angles in radians",
        "frames are those of the ground, the bodies and the joints",
        NONE,
    ),
    "eom.load_scene": (NONE, NONE, NONE, NONE),
    "eom.SpinningSymmetricBody": (
        "(M1, M2, M3)",
        "Angles in rad",
        "Frames: I inertial",
        "lecture 001",
    ),
    "eom.lecture_torque": (NONE, "(N m)", "torque -M1 b1", "lecture 001"),
    "eom.Assumption": (NONE, "relative to the largest", NONE, NONE),
    "eom.Definition": (NONE, "SI unit", NONE, NONE),
    "eom.Quantity": (NONE, "SI unit", NONE, NONE),
    "eom.Singularity": (NONE, "in its own unit", NONE, NONE),
    "eom.System": ("(n, n)", "Units are SI", "Frames and signs are said", NONE),
    "eom.Table": (
        "K numbers each",
        "any consistent units",
        NONE,
        "SIAM J. Sci. Stat. Comput. 5, 1984",
    ),
    "eom.multibody.GROUND": (NONE, NONE, "axes that are inertial", NONE),
    "eom.multibody.Assembly": (NONE, "(rad, m)", NONE, NONE),
    "eom.multibody.BaseParameters": (NONE, "Units are those of `Regressor`", NONE, NONE),
    "eom.multibody.Body": (
        "``inertia`` (3,) or (3, 3)",
        "(kg m^2)",
        "J12 = -integral of r1 r2 dm",
        NONE,
    ),
    "eom.multibody.ClosedForm": (
        "(n, n)",
        "SI units",
        "frames and signs are those of `Joint`",
        NONE,
    ),
    "eom.multibody.Comparison": (NONE, NONE, NONE, NONE),
    "eom.multibody.Constraint": (NONE, "Units are SI", "its opposite on the first", NONE),
    "eom.multibody.Coupling": (NONE, "(N m or N)", "on a joint of ratio 1", NONE),
    "eom.multibody.Distance": (
        NONE,
        "(m)",
        "from the first point to the second; a pull is negative",
        NONE,
    ),
    "eom.multibody.Equation": (
        NONE,
        "any consistent units",
        "by the gradient of the expression",
        NONE,
    ),
    "eom.multibody.Examination": (NONE, NONE, NONE, NONE),
    "eom.multibody.Joint": (
        NONE,
        "(N m/rad or N/m)",
        "right-handed",
        "Featherstone, Rigid Body Dynamics Algorithms (2008), table 4.1",
    ),
    "eom.multibody.Load": (
        "(3,)",
        "A force (N)",
        "``axes``: those of ``force`` and ``torque``",
        NONE,
    ),
    "eom.multibody.Loop": (
        NONE,
        "force (N)",
        "on ``second``",
        "Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 8",
    ),
    "eom.multibody.Motion": (NONE, "(rad, m)", NONE, NONE),
    "eom.multibody.Placement": ("(3, 3)", "(m)", "axes to components in the joint's", NONE),
    "eom.multibody.Point": (NONE, "(m/s^2)", "in the ground's axes", NONE),
    "eom.multibody.Reaction": (
        NONE,
        "(N m)",
        "that the parent of a joint exerts on its child",
        "Featherstone, Rigid Body Dynamics Algorithms (2008), sec. 5.3",
    ),
    "eom.multibody.Regressor": ("(rows, columns)", "(N m or N)", NONE, NONE),
    "eom.multibody.Rolling": (NONE, "(m)", "towards the wheel", NONE),
    "eom.multibody.Rotor": (
        NONE,
        "(kg m^2)",
        "their opposites on the body",
        "Hughes, Spacecraft Attitude Dynamics (1986)",
    ),
    "eom.multibody.Skate": (NONE, "(m)", "along the direction", NONE),
    "eom.multibody.SpeedEquation": (
        NONE,
        "any consistent units",
        "by the coefficients of the speeds",
        NONE,
    ),
    "eom.multibody.Spring": (NONE, "(N/m)", "in its axes", NONE),
    "eom.multibody.Tree": ("(3,)", "(m/s^2)", "in the ground's axes", NONE),
    "eom.multibody.absolute_angles": (NONE, "(rad)", "against the ground", NONE),
    "eom.multibody.assemble": (NONE, "SI units", NONE, "Math. Anal. Appl. 15 (1966)"),
    "eom.multibody.base_parameters": (
        NONE,
        "Units are those of `Regressor`",
        NONE,
        "Gautier and Khalil, IEEE Trans. Robotics and Automation 6(3), 1990",
    ),
    "eom.multibody.closed_form": (
        NONE,
        "SI units",
        "frames and signs are those of `Joint`",
        "Kane and Levinson, Dynamics: Theory and Applications (1985)",
    ),
    "eom.multibody.compare": (
        NONE,
        "Units, frames, signs and sources",
        "Units, frames, signs and sources",
        "are those of `closed_form`",
    ),
    "eom.multibody.derive": (
        NONE,
        "SI units, angles in radians",
        "Quaternions are scalar first",
        "Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 7",
    ),
    "eom.multibody.examine": (NONE, "SI units", NONE, NONE),
    "eom.multibody.reaction": (NONE, "forces in N", "see `Reaction`", NONE),
    "eom.multibody.regressor": (
        NONE,
        "(kg m^2 or kg",
        NONE,
        "Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 5",
    ),
    "eom.multibody.tree_page": (
        NONE,
        "units, frames, signs and sources",
        "units, frames, signs and sources",
        "as of `closed_form`",
    ),
    "codegen.METHODS": (
        NONE,
        NONE,
        NONE,
        "Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993)",
    ),
    "codegen.Card": (
        NONE,
        "units in the last place (ulps)",
        NONE,
        "Higham, Accuracy and Stability of Numerical Algorithms (2002)",
    ),
    "codegen.Compiled": ("(n,) or (n, N)", "Units are those of the system", NONE, NONE),
    "codegen.Drift": ("(N,)", "in the unit of the invariant", "Value less first value", NONE),
    "codegen.Ensemble": ("``y`` (n, K, N)", "Units are those of the system", NONE, NONE),
    "codegen.Equilibrium": (NONE, "Units are those of the system", NONE, NONE),
    "codegen.Event": (NONE, "any consistent units", "in the direction of integration", NONE),
    "codegen.FreeMotion": (
        NONE,
        "Units, frames, signs and sources",
        "scalar first",
        "are those of `free_body`",
    ),
    "codegen.Grid": (NONE, "In the unit of what is sampled", NONE, NONE),
    "codegen.Linear": (
        "``A`` (n, n), ``B`` (n, m), ``C`` (o, n), ``D`` (o, m)",
        "Units are those of the system",
        NONE,
        NONE,
    ),
    "codegen.LinearMotion": ("A (k, k)", "Units are those of the system", NONE, NONE),
    "codegen.Normal": (NONE, "In the unit of what is sampled", NONE, NONE),
    "codegen.Result": ("``y`` (n, N)", "Units are those of the system", NONE, NONE),
    "codegen.Sampler": (NONE, "Units are those of what is sampled", NONE, "SC 2011"),
    "codegen.Sensitivities": (
        NONE,
        "Units are those of a state over those of a variable",
        NONE,
        "Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sect. I.14",
    ),
    "codegen.SparseJacobian": (
        "(entries, N)",
        "Units are those of the results over those of the variables",
        NONE,
        "see `codegen.compiled_jacobian`",
    ),
    "codegen.Statistics": (NONE, "in the unit of the quantity", NONE, NONE),
    "codegen.Stop": (NONE, "in the unit of the system (s)", NONE, NONE),
    "codegen.Summary": ("(K, bins)", "In the unit of the quantity", NONE, "Am. Stat. 37 (1983)"),
    "codegen.Uniform": (NONE, "In the unit of what is sampled", NONE, NONE),
    "codegen.UniformQuaternion": (NONE, "unit norm", "scalar first", "Graphics Gems III (1992)"),
    "codegen.accuracy": (
        NONE,
        "units in the last place (ulps)",
        NONE,
        "Higham, Accuracy and Stability of Numerical Algorithms (2002)",
    ),
    "codegen.compile": (NONE, "any consistent units", NONE, NONE),
    "codegen.compiled_jacobian": (
        NONE,
        "Units are those of the results over those of the variables",
        NONE,
        "Griewank and Walther, Evaluating Derivatives (2008)",
    ),
    "codegen.ensemble": ("(N,)", "Units are those of the system", NONE, "Am. Stat. 37 (1983)"),
    "codegen.equilibria": (NONE, "units", NONE, "see `equilibrium`"),
    "codegen.equilibrium": (
        NONE,
        "Units are those of the system",
        NONE,
        "Math. Anal. Appl. 15 (1966)",
    ),
    "codegen.free_body": (
        "shapes (3, ...) and (4, ...)",
        "rad/s",
        "scalar first",
        "Whittaker, Analytical Dynamics (1937), sec. 69",
    ),
    "codegen.free_motion": (
        NONE,
        "Arguments, units, conventions, errors and source",
        "conventions",
        "as those of `free_body`",
    ),
    "codegen.linearise": (
        "(n,) or (n, N)",
        "in the units of the system",
        NONE,
        "as of `compiled_jacobian`",
    ),
    "codegen.linearise_about": (
        NONE,
        "eigenvalues are in 1/s",
        "about the body's axes",
        "SIAM Review 40 (1998)",
    ),
    "codegen.sensitivities": (
        NONE,
        "Units are those of a state over those of a variable",
        NONE,
        "Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sect. I.14",
    ),
    "codegen.simulate": (
        "a number or (n,)",
        "Units are those of the system",
        "backwards if the end is earlier",
        "Jorba and Zou, Experimental Mathematics 14 (2005)",
    ),
    "eom.conventions.Convention": (NONE, NONE, "takes components in the reference axes", NONE),
    "eom.conventions.Stated": ("(3, 3)", "``inertia`` in kg m^2", "in the body's axes", NONE),
    "eom.conventions.attitude_of_angles": (
        "three ``angles``",
        "(rad)",
        "the angles turn about axes of the body",
        "Hughes, Spacecraft Attitude Dynamics (1986), ch. 2",
    ),
    "eom.conventions.attitude_of_matrix": (
        "three of three numbers",
        "no unit",
        "takes components in the reference axes (east, north, up)",
        NONE,
    ),
    "eom.conventions.attitude_of_quaternion": (
        "four numbers",
        "unit quaternion",
        "scalar first or last",
        "Shuster, J. Astronaut. Sci. 41 (1993)",
    ),
    "eom.conventions.book": (NONE, NONE, NONE, NONE),
    "eom.conventions.changed": (NONE, NONE, NONE, NONE),
    "eom.conventions.of_scene": (
        NONE,
        "units and axes as of `Stated`",
        "axes as of `Stated`",
        NONE,
    ),
    "eom.conventions.state": (
        "(3, 3)",
        "kg m^2",
        "minus the products of inertia",
        "Hughes, Spacecraft Attitude Dynamics (1986), ch. 2",
    ),
    "eom.derivations.lectures.equation_map": (NONE, NONE, NONE, "lectures 000, 001 and 002"),
    "eom.frames.vector": ("three numbers", "Any consistent units", "in a ``frame``", NONE),
    "eom.kinematics.attitude": (
        NONE,
        "(rad)",
        "scalar first",
        "Shuster, J. Astronaut. Sci. 41 (1993)",
    ),
    "eom.kinematics.elementary": (
        "3 x 3",
        "(rad)",
        "takes components in A to components in B",
        "Hughes, Spacecraft Attitude Dynamics (1986), eq. 2.2-10",
    ),
    "eom.mass.MassProperties": (
        "(3, 3)",
        "(kg m^2)",
        "in the body's axes",
        "Huygens and Steiner's theorem; lecture 002",
    ),
    "eom.multibody.from_sympy.tree_from_sympy": (
        NONE,
        "units, frames and signs stay",
        "units, frames and signs stay",
        NONE,
    ),
    "eom.multibody.to_sympy.lagranges_method": (
        NONE,
        "Units, frames and signs",
        "Units, frames and signs",
        "Goldstein, Classical Mechanics (2002), ch. 1",
    ),
    "eom.multibody.to_sympy.to_sympy": (NONE, "Units, frames and signs", "act on the child", NONE),
    "eom.principal.definiteness": ("as of `principal_axes`", "(kg m^2)", NONE, NONE),
    "eom.principal.principal_axes": (
        "3 x 3",
        "(kg m^2)",
        "minus the products of inertia",
        "lecture 002 eq. 3.28-3.35",
    ),
    "eom.printing.show": (NONE, "Units stand with the quantities", NONE, NONE),
    "eom.recognition.recognise": (
        "three of three",
        "angles in radians",
        "from reference to body components",
        "Hughes, Spacecraft Attitude Dynamics (1986), ch. 2",
    ),
    "eom.regions.Region": ("three expressions", "any consistent units", "in the body's axes", NONE),
    "eom.regions.properties": (
        "Units (kg, m where the region has them), shapes",
        "Units (kg, m",
        "axes as of `MassProperties`",
        NONE,
    ),
    "eom.regions.simplex": (
        "three coordinates",
        "any consistent units",
        "along the body's axes",
        NONE,
    ),
    "eom.rotations.matrix_of_quaternion": (
        "(3, 3)",
        "unit quaternion",
        "scalar first",
        "Hughes, Spacecraft Attitude Dynamics (1986), eq. 2.2-27",
    ),
    "eom.solids.inertia": (
        "3 x 3",
        "(kg m^2)",
        "minus the products of inertia",
        "as of `mass_properties`",
    ),
    "eom.solids.mass_properties": (
        NONE,
        "(kg, m)",
        "in axes whose third",
        "as of `eom.regions.properties`",
    ),
    "eom.torques.applied": (NONE, "(N m)", "in B", NONE),
    "eom.torques.gravity_gradient": (
        "3 x 3",
        "(kg m^2)",
        "a3 the orbit normal",
        "Hughes, Spacecraft Attitude Dynamics (1986), sect. 8.1",
    ),
    "eom.torques.weight": ("3 x 3", "in metres", "Gravity acts along -a3", "lecture 002 eq. 3.20"),
    "eom.verification.DerivationError": (NONE, NONE, NONE, NONE),
    "codegen.native.CompilerError": (NONE, NONE, NONE, NONE),
}
"""A row a public name."""
