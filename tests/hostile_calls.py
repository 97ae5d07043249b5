"""Values that nobody expects, and for every public function arguments that are right and cheap."""

from __future__ import annotations

import contextlib
import fractions
import itertools
import pathlib
import signal

import numpy as np
import sympy as sp

import codegen
import eom
from eom import multibody
from eom.checker.report.findings import Settings
from eom.kinematics.frames import vector
from eom.mechanics.torques import applied

y, v, k, M = sp.symbols("y v k M", real=True)
OSCILLATOR = eom.System.from_rates(
    "oscillator", {y: v, v: -k * y + M}, inputs=[M], outputs={"E": v**2}
)


class Odd:
    """Nothing that anybody expects; its text cannot be had."""

    def __repr__(self):
        raise RuntimeError("no text")


class Sized:
    """A sequence by its looks, whose entries cannot be had."""

    shape = (2,)
    dtype = float

    def __len__(self):
        return 2

    def __getitem__(self, place):
        raise KeyError(place)


class Endless:
    """Gives entries without end, each time it is asked."""

    def __iter__(self):
        return itertools.repeat("y")


class Unending(BaseException):
    """A call took too long; no handler of errors takes it for one."""


@contextlib.contextmanager
def within(seconds):
    """End what runs longer, where the system can."""

    def ring(number, frame):
        raise Unending

    if not hasattr(signal, "setitimer"):
        yield
        return
    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


HOSTILE = (
    None, "", "x", "\ud800", "a\x1b[2J", "\0", b"x", 1j, float("nan"), float("inf"), 1e308, -1, 0,
    10**400, 10**5000, True, fractions.Fraction(1, 3), [], (), {}, [1], [1, 2, 3], [None],
    [float("nan")] * 2, ["a", "b"], {"y": None}, {"y": "1"}, {1: 2}, {"\ud800": 1}, sp.Symbol("z"),
    sp.nan, sp.oo, sp.I, sp.zeros(2), np.float64(1), np.int64(1), np.array([[1.0]]), np.array(["a"]),
    np.array([None]), Odd(), Odd, Sized(), lambda: 1, lambda t: None, [[1, 2], [3]], range(3), {1, 2},
    Endless(), range(10**15), 10**12, pathlib.Path("/nonexistent/x"), {"y": [1, 2]}, [[0, 1], [1, 0]],
    [Odd()], ["\ud800"],
)  # fmt: skip
"""Without what is a value of every argument; a function's arity is asked where it is called."""

MADE = {
    "codegen": "Accuracy AccuracyReport Compiled CompilerError Drift Ensemble Equilibrium FreeMotion "
    "Integrator Linear LinearMotion Result Sensitivities SparseJacobian Stop Summary",
    "eom": "Derived AssumptionError InputError",
    "eom.multibody": "Assembly BaseParameters ClosedForm Comparison Constraint Examination Regressor "
    "TreeFunction",
}
"""What the package alone makes: results, errors, and the class that all constraints share."""


METHODS = (
    "System.from_rates", "System.expand", "System.rate_of", "System.with_control",
    "Table.__call__", "Compiled.rates",
    "Compiled.jacobian", "Compiled.batch", "Result.accuracy", "Result.with_accuracy",
    "Result.at", "Result.load", "Result.save", "Result.animate",
    "Integrator.run",
    "FreeMotion.__call__", "Sampler.sample", "Sensitivities.initial", "Sensitivities.matrix",
    "SparseJacobian.__call__", "SparseJacobian.dense",
)  # fmt: skip


def right(folder):
    """Public functions with right arguments, by package and name; stores go into ``folder``."""
    return {
        "codegen": _codegen(folder),
        "eom": _eom(folder),
        "eom.multibody": _multibody(),
        "": _methods(),
    }


def _codegen(folder):
    compiled = codegen.compile(OSCILLATOR, "numpy")
    run = {"initial": {"y": 1, "v": 0}, "t_span": (0, 1), "parameters": {"k": 1.0}, "rtol": 1e-6}
    run |= {"atol": 1e-9, "t_eval": [0.5, 1], "inputs": {"M": 0.0}, "max_step": 1.0, "margin": 1e-6}
    at = {"guess": {"y": 0.1, "v": 0}, "parameters": {"k": 1.0}, "inputs": {"M": 0.0}}
    point = codegen.equilibrium(compiled, **at)
    search = {**at, "free": [], "cyclic": [], "hold": None, "starts": 2, "seed": 0, "spread": 1.0}
    return {
        "simulate": (codegen.simulate, {
            "system": compiled, **run, "method": "scipy:RK45", "outputs": ["E"], "dense_output": False,
            "first_step": 0.1, "max_steps": 10, "project": None, "events": None, "epoch": 0.0,
            "accuracy": False, "progress": None,
        }),
        "integrator": (codegen.integrator, {
            "system": compiled, "t_span": (0, 1), "method": "scipy:RK45", "rtol": 1e-6, "atol": 1e-9,
            "t_eval": [0, 1], "inputs": {"M": 0.0}, "outputs": ["E"], "dense_output": False,
            "first_step": 0.1, "max_step": 0.5, "max_steps": 10, "margin": 1e-6, "project": None,
            "events": None, "epoch": 0.0,
        }),
        "generate": (codegen.generate, {
            "system": OSCILLATOR, "folder": None, "target": "numpy", "parameters": {"k": 1.0},
            "integrator": "", "rtol": 1e-9, "jacobian": ["states"], "stable": False,
        }),
        "ensemble": (codegen.ensemble, {
            "system": compiled, **run, "method": "auto", "statistics": ["y"], "keep": True, "store": None,
            "store_format": "zarr", "chunk": 256, "threads": 1, "client": None, "max_steps": 10,
            "progress": None,
        }),
        "compile": (codegen.compile, {
            "system": OSCILLATOR, "target": "numpy", "parameters": {"k": 1.0}, "states": {},
            "inputs": {}, "rules": "algebraic", "stable": False, "attitudes": (),
            "progress": None,
        }),
        "write_fmu": (codegen.write_fmu, {
            "system": compiled, "path": folder / "unit.fmu", "initial": {"y": 1, "v": 0},
            "parameters": {"k": 1.0}, "inputs": {"M": 0.0}, "t_span": (0.0, 1.0), "rtol": 1e-6,
            "version": "3.0", "platforms": [], "progress": None,
        }),
        "linearise": (codegen.linearise, {"compiled": compiled, "x": [1, 0], "p": [1], "u": [0], "t": 0.0}),
        "equilibrium": (codegen.equilibrium, {"compiled": compiled, **search}),
        "equilibria": (codegen.equilibria, {"compiled": compiled, **search}),
        "linearise_about": (codegen.linearise_about, {
            "compiled": compiled, "point": point, "constraints": [], "independent_states": [],
            "attitude": "states", "check": False,
        }),
        "compiled_jacobian": (codegen.compiled_jacobian, {
            "compiled": compiled, "by": "states", "of": "rates", "target": "",
        }),
        "sensitivities": (codegen.sensitivities, {
            "system": compiled, "parameters": ["k"], "initial_states": [],
        }),
        "accuracy": (codegen.accuracy, {
            "compiled": compiled, "domain": None, "samples": 1, "seed": 0, "around": None,
            "jacobians": (), "progress": None,
        }),
        "free_body": (codegen.free_body, {
            "moments": [1, 2, 3], "omega0": [1, 1, 1], "attitude0": [1, 0, 0, 0], "t": [0, 1],
        }),
        "free_motion": (codegen.free_motion, {
            "moments": [1, 2, 3], "omega0": [1, 1, 1], "attitude0": [1, 0, 0, 0],
        }),
        "Sampler": (codegen.Sampler, {"values": {"y": codegen.Normal(0, 1)}, "count": 3, "seed": 0}),
        "Normal": (codegen.Normal, {"mean": 0.0, "deviation": 1.0}),
        "Uniform": (codegen.Uniform, {"low": 0.0, "high": 1.0}),
        "Grid": (codegen.Grid, {"low": 0.0, "high": 1.0, "count": 3}),
        "Statistics": (codegen.Statistics, {"names": ("y",), "quantiles": False, "edges": {}}),
        "Event": (codegen.Event, {"expression": y, "direction": 0, "terminal": False, "name": "e"}),
        "Signal": (codegen.Signal, {"function": lambda t: t, "knots": None, "max_step": None}),
        "Sampled": (codegen.Sampled, {
            "law": lambda t, x, m: (0.0, m), "period": 0.1, "delay": 0.0, "states": None, "memory": 0,
        }),
    }  # fmt: skip


def _eom(folder):
    time = sp.Symbol("t", real=True)
    fields = {"rates": (y,), "parameters": (), "inputs": (), "time": time, "definitions": ()}
    fields |= {"mass_matrix": None, "outputs": (), "invariants": (), "singularities": ()}
    frame = eom.principal_inertia()
    moment = vector("B", (M, 0, 0))
    note_file = folder / "note.tex"
    note_file.write_text(r"$\vec H = \vec H$", encoding="utf-8")
    note = {"notation": "arrow-tilde", "lexicon": "", "given": ("constant_mass",), "kind": ""}
    scene = {"name": "s", "title": "", "description": "", "parameters": {},
             "inputs": {}, "outputs": (), "integration": {"t_end": 1.0}}  # fmt: skip
    return {
        "Derivation": (eom.Derivation, {
            "name": "d", "title": "", "group": "", "assumed": ("rigid",),
        }),
        "check": (eom.check, {"note": note_file, **note, "system": None, "seconds": 0.5, "answers": None,
                              "strict": False}),
        "check_files": (eom.check_files, {
            "notes": [], "settings": Settings(), "workers": 0, "progress": lambda _: None,
        }),
        "derive": (eom.derive, {"name": "point-mass"}),
        "euler_equations": (eom.euler_equations, {
            "J": frame[0], "torque": moment, "omega": vector("B", sp.symbols("w1:4")), "momentum": None,
        }),
        "free_rigid_body": (eom.free_rigid_body, {"attitude": None}),
        "gravity_gradient_satellite": (eom.gravity_gradient_satellite, {"attitude": "3-1-2"}),
        "heavy_top": (eom.heavy_top, {"attitude": "3-1-2"}),
        "rigid_body": (eom.rigid_body, {
            "inertia": frame, "torque": lambda C, J: applied((0, 0, 0)), "attitude": None,
            "name": "b", "title": "B",
        }),
        "Scene": (eom.Scene, {
            **scene, "model": "rigid body", "body": {"moments": [1, 2, 3]}, "attitude": "none",
        }),
        "TreeScene": (eom.TreeScene, {
            **scene, "model": "tree", "bodies": {"bob": {"mass": 1, "centre": [0, 0, -1]}},
            "joints": {"hinge": {"kind": "revolute", "parent": "ground", "child": "bob", "axis": "x"}},
        }),
        "load_scene": (eom.load_scene, {"name": "t-handle", "strict": True, "floating": False}),
        "saturate": (eom.saturate, {"value": y, "low": -1, "high": 1}),
        "SpinningSymmetricBody": (eom.SpinningSymmetricBody, {
            "torque": (0, 0, 0), "parameters": (), "inputs": (), "potential": 0,
            "reference_point": "centre of mass", "numbers": "counts",
        }),
        "Assumption": (eom.Assumption, {
            "name": "a", "meaning": "", "vanish": (), "nonnegative": (), "tolerance": 1e-9,
        }),
        "BodyAttitude": (eom.BodyAttitude, {
            "omega": (y, y, y), "kind": "none", "coordinates": (), "frame_rate": (0, 0, 0),
            "inertia": None, "torque": None, "directions": (), "unspun": False, "body": "",
        }),
        "Definition": (eom.Definition, {"quantity": eom.Quantity(y), "expression": y}),
        "Quantity": (eom.Quantity, {
            "symbol": y, "unit": "", "meaning": "", "latex": "", "default": None, "held": False,
        }),
        "Singularity": (eom.Singularity, {"expression": y, "coordinate": y, "meaning": "", "hint": ""}),
        "System": (eom.System, {
            "name": "s", "states": (eom.Quantity(y),), **fields, "assumptions": (), "maintained": (),
            "attitudes": (), "angles": (), "multipliers": (), "sampled": (), "title": "",
            "numbers": "counts",
        }),
        "Table": (eom.Table, {
            "name": "a", "breakpoints": (0.0, 1.0), "values": (0.0, 1.0), "kind": "linear",
            "outside": "hold", "order": 0,
        }),
    }  # fmt: skip


def _multibody():
    m = multibody
    bob, hinge = (
        m.Body("bob", 1, (0, 0, -1)),
        m.Joint("hinge", "revolute", "ground", "bob", axis="x"),
    )
    tree = m.Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -9.81))
    ends = {"first": "ground", "second": "bob"}
    wishes = {"coordinates": None, "names": None, "independent": ()}
    energies = m.Lagrangian("o", {y: v}, v**2 / 2, y**2 / 2)
    left = m.Lagrangian("k", {y: v, k: M}, v**2 / 2 + y**2 * M**2 / 2)
    steady = m.steady_motion(energies, {"y": 0})
    return {
        **{f: (getattr(m, f), {"tree": tree}) for f in (
            "mass_matrix", "inverse_dynamics", "forward_dynamics", "centre_of_mass", "energies",
        )},
        "jacobian": (m.jacobian, {"tree": tree, "body": "bob", "point": (0, 0, 0)}),
        "Body": (m.Body, {
            "name": "bob", "mass": 1, "centre": (0, 0, 0), "inertia": (1, 1, 1), "about": "centre",
            "axes": sp.eye(3).tolist(),
        }),
        "Placement": (m.Placement, {"position": (0, 0, 0), "rotation": sp.eye(3).tolist()}),
        "Motion": (m.Motion, {"position": (y,), "rate": None, "acceleration": None}),
        "Joint": (m.Joint, {
            "name": "j", "kind": "revolute", "parent": "ground", "child": "bob", "axis": "x",
            "second_axis": (1, 0, 0), "pitch": 0, "attitude": "quaternion", "on_parent": m.Placement(),
            "on_child": m.Placement(), "stiffness": 0, "rest": 0, "damping": 0, "armature": 0, "force": 0,
            "motor": False, "motion": None, "alone": False,
        }),
        "Load": (m.Load, {
            "body": "bob", "force": (0, 0, 0), "torque": (0, 0, 0), "point": (0, 0, 0), "axes": "ground",
        }),
        "Tree": (m.Tree, {
            "name": "p", "bodies": (bob,), "joints": (hinge,), "gravity": (0, 0, 0), "loads": (),
            "inputs": (), "parameters": (), "constraints": (), "rotors": (), "springs": (), "jets": (),
            "gravity_gradient": (0, 0, 0), "numbers": "",
        }),
        "Rotor": (m.Rotor, {
            "name": "r", "body": "bob", "axis": (0, 0, 1), "inertia": 1, "damping": 0, "torque": 0,
            "motor": False, "angle": False, "speed": None,
        }),
        "Jet": (m.Jet, {
            "name": "j", "body": "bob", "velocity": (0, 0, -1), "point": (0, 0, 1), "rate": None,
        }),
        "Spring": (m.Spring, {
            "name": "s", "bodies": ("ground", "bob"), "points": ((0, 0, 0), (0, 0, 1)), "stiffness": 1,
            "length": 1, "damping": 0,
        }),
        "Point": (m.Point, {
            "name": "p", "body": "bob", "position": (0, 0, 0), "quantities": ("position",),
        }),
        "Loop": (m.Loop, {
            "name": "l", "kind": "revolute", **ends, "axis": (0, 0, 1), "second_axis": (1, 0, 0),
            "on_first": m.Placement(), "on_second": m.Placement(),
        }),
        "Distance": (m.Distance, {
            "name": "d", **ends, "length": 1, "first_point": (0, 0, 0), "second_point": (0, 0, 0),
        }),
        "Equation": (m.Equation, {"name": "e", "expression": y}),
        "SpeedEquation": (m.SpeedEquation, {"name": "e", "expression": y}),
        "Coupling": (m.Coupling, {"name": "c", "ratios": {"a": 1, "b": 2}, "follower": "b"}),
        "Rolling": (m.Rolling, {
            "name": "r", "body": "bob", "radius": 1, "axis": (0, 0, 1), "centre": (0, 0, 0),
            "normal": (0, 0, 1), "origin": (0, 0, 0), "half_axis": 0,
        }),
        "KnifeEdge": (m.KnifeEdge, {
            "name": "s", "body": "bob", "direction": (0, 1, 0), "point": (0, 0, 0),
        }),
        "Reaction": (m.Reaction, {
            "joint": "hinge", "point": "joint", "body": "", "axes": "ground", "name": "",
        }),
        "reaction": (m.reaction, {
            "joint": "hinge", "point": "joint", "body": "", "axes": "ground", "name": "",
        }),
        "absolute_angles": (m.absolute_angles, {"tree": tree}),
        "assemble": (m.assemble, {
            "tree": tree, "values": {"q_hinge": 0.1}, "weights": None, "keep": (), "time": 0.0,
        }),
        "base_parameters": (m.base_parameters, {
            "tree": tree, "armature": False, "damping": False, "coulomb": False, "seed": 0,
        }),
        "closed_form": (m.closed_form, {"tree": tree, "method": "lagrange", "rates": False, **wishes}),
        "compare": (m.compare, {"tree": tree, "methods": ("lagrange",), "rates": False, **wishes}),
        "Lagrangian": (m.Lagrangian, {
            "name": "o", "rates": {y: v}, "kinetic": v**2 / 2, "potential": y**2 / 2, "dissipation": 0,
            "forces": {},
        }),
        "analysis_page": (m.analysis_page, {
            "source": tree, "style": "text", "names": None, "values": None, "solve": (), "order": 3,
            "rates": 2, "harmonics": 2, "positive": (),
        }),
        "conserved_quantities": (m.conserved_quantities, {
            "source": energies, "rates": 2, "harmonics": 2, "powers": 2,
        }),
        "cyclic_coordinates": (m.cyclic_coordinates, {"of": energies}),
        "equations_of": (m.equations_of, {"source": energies}),
        "lagrangian": (m.lagrangian, {"tree": tree, "names": None}),
        "linearised": (m.linearised, {"about": steady}),
        "routh": (m.routh, {"of": left, "coordinates": None}),
        "small_motion": (m.small_motion, {"source": energies, "order": 1, "about": None}),
        "stability": (m.stability, {"of": m.linearised(steady)}),
        "steady_motion": (m.steady_motion, {"source": energies, "values": None}),
        "derive": (m.derive, {
            "tree": tree, "outputs": (), "invariants": False, "start": None, "independent": None,
            "multipliers": None,
        }),
        "examine": (m.examine, {"tree": tree, "start": None}),
        "regressor": (m.regressor, {"tree": tree, "armature": False, "damping": False, "coulomb": False}),
        "tree_page": (m.tree_page, {
            "tree": tree, "method": "lagrange", "style": "text", "rates": False, **wishes,
        }),
    }  # fmt: skip


def _methods():
    """Methods, of classes that users make and of results, that take arguments."""
    compiled = codegen.compile(OSCILLATOR, "numpy")
    run = codegen.simulate(
        compiled, {"y": 1, "v": 0}, (0, 1), {"k": 1.0}, "scipy:RK45", inputs={"M": 0.0}
    )
    prepared = codegen.integrator(compiled, (0, 1), "scipy:RK45")
    dense = codegen.simulate(
        compiled, [1, 0], (0, 1), {"k": 1.0}, inputs={"M": 0.0}, dense_output=True
    )
    handle = eom.load_scene("t-handle")
    turning = codegen.simulate(
        handle.derive(), handle.initial_values(), (0, 1), handle.parameter_values(), "DOP853"
    )
    jacobian, sensitive = compiled.jacobian(), codegen.sensitivities(OSCILLATOR, ["k"])
    at = {"t": 0.0, "x": [1, 0], "p": [1], "u": [0]}
    start = {"y": 1.0, "v": 0.0}
    sampler = codegen.Sampler({"y": codegen.Normal(0, 1)}, 3)
    free = codegen.free_motion([1, 2, 3], [1, 1, 1])
    return {
        "System.from_rates": (eom.System.from_rates, {
            "name": "s", "rates": {y: v, v: -y}, "inputs": (), "time": sp.Symbol("t", real=True),
            "outputs": {}, "invariants": {}, "attitudes": (),
        }),
        "System.expand": (OSCILLATOR.expand, {"expression": y}),
        "System.rate_of": (OSCILLATOR.rate_of, {"expression": y}),
        "System.with_control": (OSCILLATOR.with_control, {
            "laws": {}, "states": {"integral": y}, "definitions": {"twice": 2 * y}, "parameters": (),
            "period": 0.1, "delay": 0.0, "rates": {"filter": y}, "dimensions": True,
        }),
        "Table.__call__": (eom.Table("a", (0, 1), (0, 1)), {"argument": y}),
        "Compiled.rates": (lambda **a: compiled.functions["rates"](a["t"], a["x"], a["p"], a["u"]), at),
        "Compiled.jacobian": (compiled.jacobian, {"wrt": "states", "of": "rates"}),
        "Compiled.batch": (compiled.batch, {"group": "rates", "threads": 1}),
        "Integrator.run": (prepared.run, {
            "initial": start, "parameters": {"k": 1.0}, "inputs": {"M": 0.0},
        }),
        "Result.at": (dense.at, {"t": [0.5]}),
        "Result.save": (run.save, {"path": "run.npz"}),
        "Result.load": (codegen.Result.load, {"path": "run.npz"}),
        "Result.animate": (turning.animate, {"scene": handle, "speed": 1.0}),
        "Result.accuracy": (run.accuracy, {"limit": 1.0}),
        "Result.with_accuracy": (run.with_accuracy, {"limit": 1.0}),
        "FreeMotion.__call__": (free, {"t": 0.5}),
        "Sampler.sample": (sampler.sample, {"first": 0, "last": 2}),
        "Sensitivities.initial": (sensitive.initial, {"values": start, "slopes": None}),
        "Sensitivities.matrix": (sensitive.matrix, {"y": [1.0] * len(sensitive.initial(start))}),
        "SparseJacobian.__call__": (jacobian, at),
        "SparseJacobian.dense": (jacobian.dense, at),
    }  # fmt: skip
