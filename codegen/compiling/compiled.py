"""A compiled system: functions of one shape contract over any target.

Arrays are ``(n,)`` for one point or ``(n, N)`` for N points, in double precision; time is a number
or ``(N,)``. Whatever has no column axis is the same at every point.

`ROWS` is the table of targets. Batches are functions of many points, in vector lanes, divided among
threads: points are independent, and no point's result depends on its neighbours or its place: the results
are the same to the last bit for any number of threads.
"""

from __future__ import annotations

import ctypes
import errno
import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache, partial
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from codegen.compiling.checked import Array, CheckedFunction, Function, Kernel, in_whole_doubles
from codegen.compiling.sparse import (
    KINDS,
    SparseJacobian,
    differentiated,
    layout_of_derivatives,
    one_group,
    slots,
)
from codegen.derivatives.derivative import JACOBIAN
from codegen.frontend.from_sympy_mechanics import as_system
from codegen.frontend.layout import Layout, names_of
from codegen.frontend.notebook import MOST, listed, table
from codegen.frontend.structure import Guard, Structure
from codegen.ir import compile_progress
from codegen.ir.names import identifier
from codegen.ir.passes import prune
from codegen.ir.program import (
    INVARIANTS,
    OUTPUTS,
    RATES,
    SINGULARITIES,
    Program,
    SameObject,
)
from codegen.loops import javascript, written
from codegen.loops.written import Choice
from codegen.native import native
from codegen.native.native import bind
from codegen.passes.pipeline import by_parameters, fitted, formed, optimise
from codegen.targets import c, jax_, lanes, load_module, packaging, python_
from codegen.targets.c import C_FLOAT
from codegen.targets.javascript import JAVASCRIPT
from codegen.targets.jax_ import JAX
from codegen.targets.lanes import LANES
from codegen.targets.matlab import MATLAB
from codegen.targets.numpy_ import NUMPY
from codegen.targets.python_ import PYTHON
from codegen.targets.target import Target, refuse_unsupported
from eom.errors import InputError, spelt, typed, unknown_name
from eom.limits import seldom_collected
from eom.system import BodyAttitude, System


@dataclass(frozen=True)
class Compiled:
    """A system compiled for a target, made by `codegen.compile`.

    Parameters
    ----------
    system : System
        What was compiled.
    layout : Layout
        The order of arrays.
    program : Program
        Its straight-line code.
    target : str
        ``c``, ``numpy``, ``python`` or ``jax``.
    structure : Structure
        What was compiled in.
    functions : mapping of str to Function
        By group: rates, outputs, invariants, singularities.
    notice : str, optional
        What the user should know, for example that there was no C compiler.
    stable : bool, default False
        Whether every identity against cancellation was applied, also those that cost time.

    Notes
    -----
    ``rhs(t, x, p, u, out=None)`` gives d(states)/dt; ``outputs``, ``invariants`` and
    ``singularities`` are like it, where the system has any. Shapes: ``t`` a number or (N,); ``x``,
    ``p``, ``u`` (n,) or (n, N), in the order of ``layout``; results (k,) or (k, N). Units are those
    of the system.
    """

    system: System
    layout: Layout
    program: Program
    target: str
    structure: Structure
    functions: Mapping[str, Function]
    notice: str = ""
    origin: tuple[Callable[..., Compiled], tuple[Any, ...]] | None = None
    """How it was made, where not by `compile`: a function of modules, and its arguments."""
    stable: bool = False

    def __repr__(self) -> str:
        """Name the system, the target and the functions."""
        names = self.structure.names
        fixed = f", with {', '.join(names)} fixed" if names else ""
        functions = ", ".join("rhs" if g == RATES else g for g in self.functions)
        return f"Compiled({self.layout.name!r} for {self.target}{fixed}: {functions})"

    def _repr_html_(self) -> str:
        """Return what a notebook displays: what it computes and of what, and the system."""
        kinds = {
            "states": self.layout.states,
            "parameters": self.layout.parameters,
            "inputs": self.layout.inputs,
        }
        rows = [(kind, listed([f"{q.name} [{q.unit}]" if q.unit else q.name for q in quantities], MOST))
                for kind, quantities in kinds.items() if quantities]  # fmt: skip
        rows += [("fixed", ", ".join(self.structure.names))] if self.structure.names else []
        costs = (
            f"{', '.join(self.functions)}: target {self.target}, {self.program.cost():,} operations"
        )
        rows.append(("functions", costs))
        page = f"<details><summary>equations</summary>{self.system._repr_html_()}</details>"
        return table(rows, (), repr(self)) + page

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by what it was compiled from; the other side compiles, or finds it in its cache."""
        if self.origin is not None:
            return self.origin
        s = self.structure
        held = ({**s.parameters, **s.equal}, dict(s.states), dict(s.inputs))
        return (compile, (self.system, self.target, *held, self.program.rules.name, self.stable))

    @property
    def fixed(self) -> Mapping[str, float]:
        """The parameters that were fixed to numbers."""
        return self.structure.parameters

    @property
    def rhs(self) -> Function:
        """The right-hand side d(states)/dt."""
        return self.functions[RATES]

    @property
    def outputs(self) -> Function:
        """The outputs, in the order of ``layout.results["outputs"]``.

        Raises `InputError` where the system has none.
        """
        return self._group(OUTPUTS)

    @property
    def invariants(self) -> Function:
        """The constants of the motion. Raises `InputError` where the system has none."""
        return self._group(INVARIANTS)

    @property
    def singularities(self) -> Function:
        """The expressions that are zero in singular configurations.

        Raises `InputError` where the system has none.
        """
        return self._group(SINGULARITIES)

    def _group(self, group: str) -> Function:
        if group not in self.functions:
            raise InputError(f"system {self.layout.name!r} has no {group}")
        return self.functions[group]

    @cached_property
    def guard(self) -> Guard:
        """Tests values against the system's assumptions."""
        guard = Guard.of(self.system)
        return replace(guard, known=guard.known | {*names_of(self.layout.states)})

    @cached_property
    def derived(self) -> dict[tuple[str, ...], object]:
        """What was made of this object, as Jacobians: it is derived and compiled once."""
        return {}

    @typed
    def jacobian(self, wrt: str = "states", of: str = RATES) -> SparseJacobian:
        """Return the compiled derivatives of a group of results, made at the first call and kept.

        Parameters
        ----------
        wrt : str, default "states"
            ``states``, ``parameters``, ``inputs`` or ``time``.
        of : str, default "rates"
            ``rates``, ``outputs``, ``invariants`` or ``singularities``.

        Returns
        -------
        SparseJacobian
            As of `codegen.compiled_jacobian`.

        Raises
        ------
        InputError
            For other words.
        """
        return compiled_jacobian(self, wrt, of)

    @typed
    def batch(self, group: str = RATES, threads: int | None = None) -> Batch:
        """Return ``f(t, x, p, u, out=None)`` for many points, in vector lanes and threads.

        Parameters
        ----------
        group : str, default "rates"
            ``rates``, ``outputs``, ``invariants`` or ``singularities``.
        threads : int, optional
            By default as many as there are processors; results do not depend on it.

        Returns
        -------
        Batch
            It works in vector lanes and threads, see `codegen.compiling.compiled`.

        Raises
        ------
        InputError
            For an unknown group and a number of threads that is none.
        """
        return batch(self, group, threads)

    @cached_property
    def files(self) -> Mapping[str, str]:
        """The generated files by name; the same system gives the same bytes."""
        return generate(self.program, self.layout, self.target)

    @property
    def source(self) -> str:
        """The generated source text of the functions."""
        name = identifier(self.layout.name)
        return self.files[f"{name}.{ROWS[self.target].extension}"]

    @cached_property
    def module(self) -> ModuleType:
        """The generated module of the targets jax, numpy and python: plain functions, as a file has them.

        ``rates(t, x, p, u)`` and so on, in the order of ``layout``; those of jax are pure, for ``jax.jit``,
        ``vmap``, ``jacfwd`` and ``grad``, and of the precision that JAX is set to. Raises `InputError` for
        target c, which has no module.
        """
        if ROWS[self.target].extension != "py":
            raise InputError(
                "there is no Python module of this target",
                where=f"system {self.layout.name!r}",
                got=f"target {self.target}",
                expected="target jax, numpy or python",
                hint="codegen.compile(system, 'jax').module",
            )
        return load_module(self.source, identifier(self.layout.name))

    def write(self, folder: str | Path) -> list[Path]:
        """Write the generated files into a folder, each whole or not at all.

        Parameters
        ----------
        folder : str or path
            It is made where it is not there.

        Returns
        -------
        list of paths
            The paths of the files.

        Raises
        ------
        InputError
            Where the folder cannot be made or written.
        """
        return write_files(self.files, folder)


@typed
def compile(  # noqa: A001 - the word that users expect
    system: System | Any,
    target: str = "auto",
    parameters: Mapping[str, float | str] | None = None,
    states: Mapping[str, float] | None = None,
    inputs: Mapping[str, float] | None = None,
    rules: str = "algebraic",
    stable: bool = False,
    attitudes: Sequence[BodyAttitude] = (),
    progress: Callable[[str, float], None] | None = None,
) -> Compiled:
    """Compile ``system`` for a target.

    Parameters
    ----------
    system : System or what SymPy has
        An `eom.System`, or what `codegen.frontend.from_sympy_mechanics.as_system` accepts: SymPy's
        KanesMethod, LagrangesMethod, SymbolicSystem or mechanics System, (states, rates), (states, mass
        matrix, forces).
    target : str, default "auto"
        ``c``, ``numpy``, ``python`` (plain floats), ``jax`` (see `Compiled.module`), or ``auto`` (C
        where a compiler works, else NumPy), in any case.
    parameters : mapping, optional
        Numbers for some or all parameters, which are then compiled in and folded; the name of another
        parameter makes the two equal. What has a number leaves the arrays.
    states : mapping, optional
        Values at which states stay, as in planar motion; they leave the arrays, too.
    inputs : mapping, optional
        Values of inputs that never change, likewise.
    rules : str, default "algebraic"
        The laws by which operations may be exchanged, of `codegen.ir.fold.RULE_SETS`: ``algebraic``, or
        ``exact`` for those that hold bit for bit, NaN and infinities included.
    stable : bool, default False
        Apply every identity of `codegen.passes.stable` against cancellation; those that cost no time
        are always applied. `codegen.accuracy` shows where it helps.
    attitudes : sequence of BodyAttitude, optional
        Bodies among the states of a system from elsewhere, see `eom.BodyAttitude`; what `eom` derives
        states them itself.
    progress : callable, optional
        Called with the stage, one of `codegen.ir.compile_progress.STAGES` in this order, and the share
        of it that is done, 0 to 1; where target auto finds no C compiler, text and compiler come once
        more, for NumPy. What it raises ends the compilation, and nothing of it is kept.

    Returns
    -------
    Compiled
        The functions ``rhs``, ``outputs`` and others, their layout of arrays, and their text.

    Raises
    ------
    InputError
        For unknown names, states that do not stay, values that contradict the system's assumptions,
        attitudes that are not so, and expressions without an operation.
    CompilerError
        Where target ``c`` cannot be compiled.

    Notes
    -----
    Units are those of the system, any consistent units.

    Examples
    --------
    >>> import sympy as sp
    >>> y, v, k = sp.symbols("y v k", real=True)
    >>> oscillator = compile(System.from_rates("oscillator", {y: v, v: -k * y}), "numpy")
    >>> oscillator.rhs(0, [1, 0], [4])  # t, x, p
    array([ 0., -4.])
    >>> oscillator.rhs(0, [[1, 2], [0, 3]], [4])  # two points: a column each
    array([[ 0.,  3.],
           [-4., -8.]])
    """
    build = TARGETS[_callable(target)]
    system = as_system(system, attitudes=attitudes)
    structure = Structure.of(system, parameters, states, inputs)
    in_c = build in (_automatic, _native)
    if in_c:
        native.begin_extension()
    with compile_progress.to(progress), seldom_collected():
        program, layout = fitted(system, structure, rules, stable)
        if in_c:
            compile_progress.fitted(program, layout)
        used, functions, notice = build(program, layout)
    return Compiled(system, layout, program, used, structure, functions, notice, stable=stable)


@seldom_collected()
def generate(
    program: Program, layout: Layout, target: str, integrator: Choice | None = None
) -> Mapping[str, str]:
    """Return the generated files of a target by name; needs no compiler.

    ``integrator``: what the target c writes beside the functions, by default DOP853.
    Raises `InputError` for an unknown target or integrator, and for an operation that the target
    cannot compute.
    """
    row = target_of(target, integrator)
    refuse_unsupported(row, program, layout)
    return row.files(program, layout)


Functions = Mapping[str, Function]


def _module_functions(
    program: Program, layout: Layout, target: str, kernel: Callable[[Any], Kernel]
) -> tuple[str, Functions, str]:
    """Load the generated module; ``kernel`` makes a kernel of one of its functions."""
    name = identifier(layout.name)
    with compile_progress.stage("text", lambda: len(program.instructions)):
        text = generate(program, layout, target)[f"{name}.{ROWS[target].extension}"]
    with compile_progress.stage("compiler"):
        module = load_module(text, name)
    functions = {g: CheckedFunction(g, layout, kernel(getattr(module, g))) for g in layout.sizes}
    return target, functions, ""


def _quiet(function: Any) -> Kernel:
    """Return a NumPy function without its warnings of values that are not finite."""

    def run(t: Any, x: Array, p: Array, u: Array, out: Array) -> None:
        with np.errstate(all="ignore"):
            function(t, x, p, u, out)

    return run


def _numpy(program: Program, layout: Layout) -> tuple[str, Functions, str]:
    return _module_functions(program, layout, "numpy", _quiet)


def _python(program: Program, layout: Layout) -> tuple[str, Functions, str]:
    return _module_functions(program, layout, "python", python_.over_columns)


def _jax(program: Program, layout: Layout) -> tuple[str, Functions, str]:
    jax_.require()
    return _module_functions(program, layout, "jax", jax_.in_doubles)


def _native(program: Program, layout: Layout) -> tuple[str, Functions, str]:
    with compile_progress.stage("text", lambda: len(program.instructions)):
        refuse_unsupported(ROWS["c"], program, layout)
        text = c.single_text(program, layout)
    flags = native.flags_for(max(layout.sizes.values()), len(program.instructions))
    with compile_progress.stage("compiler"):
        library = native.load(native.compile_library(text, flags), text, flags)
    name = identifier(layout.name)
    functions = {}
    prepare = _address(library, f"{name}_prepare")
    constants = max(1, len(by_parameters(program, layout.sizes).values))
    for group in layout.sizes:
        checked = CheckedFunction(group, layout, batch_kernel(library, f"{name}_{group}_batch"))
        lengths = (
            len(layout.states),
            len(layout.parameters),
            len(layout.inputs),
            layout.sizes[group],
        )
        addresses = _address(library, f"{name}_{group}"), prepare
        functions[group] = bind(addresses, lengths, constants, checked)
    return "c", functions, ""


def _address(library: ctypes.CDLL, symbol: str) -> int:
    return ctypes.cast(getattr(library, symbol), ctypes.c_void_p).value or 0


def batch_kernel(library: ctypes.CDLL, symbol: str) -> Kernel:
    """Return the kernel of a C function over strided arrays of points."""
    function = getattr(library, symbol)
    array = [ctypes.c_void_p, ctypes.c_ssize_t, ctypes.c_ssize_t]
    function.argtypes = [ctypes.c_size_t, ctypes.c_void_p, ctypes.c_ssize_t, *array * 4]
    function.restype = None

    def strided(a: Array) -> tuple[int, int, int]:
        steps = [s // a.itemsize for s in a.strides]
        return a.ctypes.data, steps[0], steps[1] if a.ndim == 2 else 0

    def run(t: Any, x: Array, p: Array, u: Array, out: Array) -> None:
        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        times, x, p, u = (a if in_whole_doubles(a) else a.copy() for a in (times, x, p, u))
        step = times.strides[0] // times.itemsize if np.ndim(t) else 0
        count = out.shape[1] if out.ndim == 2 else 1
        function(count, times.ctypes.data, step, *(v for a in (x, p, u, out) for v in strided(a)))

    return run


def _automatic(program: Program, layout: Layout) -> tuple[str, Functions, str]:
    try:
        return _native(program, layout)
    except native.CompilerError as error:
        _, functions, _ = _numpy(program, layout)
        remedy = error.hint.removesuffix(native.OR_NUMPY)
        return "numpy", functions, f"{error.brief}: using the NumPy target; for C {remedy}"


TARGETS: dict[str, Callable[[Program, Layout], tuple[str, Functions, str]]] = {
    "auto": _automatic,
    "c": _native,
    "numpy": _numpy,
    "python": _python,
    "jax": _jax,
}


def write_files(files: Mapping[str, str], folder: str | Path) -> list[Path]:
    """Write texts into ``folder``, made if need be; each file appears whole or not at all.

    Raises `InputError` where the folder cannot be made or written; no file is then changed.
    """
    target = Path(folder)
    try:
        target.mkdir(parents=True, exist_ok=True)
        taken = [name for name in files if (target / name).is_dir()]
        if taken:
            raise IsADirectoryError(errno.EISDIR, f"{taken[0]} is a folder")
        with tempfile.TemporaryDirectory(prefix=".eom-", dir=target) as staging:
            for name, text in files.items():
                (Path(staging) / name).write_text(text, encoding="utf-8", newline="\n")
            for name in files:
                (Path(staging) / name).replace(target / name)
    except (OSError, ValueError) as error:  # a name with a null byte is a wrong value
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            "files cannot be written",
            where=str(target),
            got=reason,
            hint="choose a folder that you can write",
        ) from None
    return [target / name for name in files]


def _c_files(integrator: written.Choice, program: Program, layout: Layout) -> Mapping[str, str]:
    files = {
        **c.files(program, layout),
        **written.files(integrator, program, layout),
        **packaging.descriptions(layout),
        **(packaging.sparsity(layout, layout.patterns) if layout.patterns else {}),
        **packaging.checks(program, layout),
    }
    return {**files, **packaging.build(layout, files)}


def _javascript_files(
    integrator: written.Choice, program: Program, layout: Layout
) -> Mapping[str, str]:
    return {**JAVASCRIPT.files(program, layout), **javascript.files(integrator.name)}


C = Target("c", "c", c.TEMPLATES, c.SLOTS, c.NUMBERS, partial(_c_files, written.Choice()))

ROWS: dict[str, Target] = {
    row.name: row for row in (C, C_FLOAT, LANES, JAVASCRIPT, NUMPY, PYTHON, JAX, MATLAB)
}

UNIT = "fmu"
"""What users call a target, too, and `codegen.fmu` writes."""

_BESIDE = {C.name: _c_files, JAVASCRIPT.name: _javascript_files}
"""What writes functions and integrator, by target."""


def target_of(name: str, integrator: written.Choice | None = None) -> Target:
    """Return a target by name, which writes ``integrator`` beside the functions.

    Raises `InputError` for unknown names, and for an integrator where the target writes none.
    """
    name = spelt(name, [*ROWS, UNIT])
    if name == UNIT:
        raise InputError("a functional mock-up unit is an archive, and no texts", where="target", got=name,
                         hint="write it by eom.write_fmu, or by eom generate --target fmu")  # fmt: skip
    if name not in ROWS:
        raise unknown_name("target", name, [*ROWS, UNIT])
    if integrator is None:
        return ROWS[name]
    written.check(integrator)
    if name not in _BESIDE:
        raise InputError(
            f"integrators are written for the targets {' and '.join(_BESIDE)} alone",
            got=f"target {name}, integrator {integrator.name}",
            hint="leave out the integrator, or choose one of these targets",
        )
    return replace(ROWS[name], files=partial(_BESIDE[name], integrator))


def compiled_of(
    system: System | Compiled, beside: compile_progress.Fitted | None = None
) -> Compiled:
    """Return a system compiled, the same again for the same object.

    ``beside``: what begins beside its compiler, if it is not compiled yet.
    """
    if isinstance(system, Compiled):
        return system
    with nullcontext() if beside is None else compile_progress.beside(beside):
        return compile_once(SameObject(system))


@lru_cache(maxsize=64)
def compile_once(key: SameObject[System]) -> Compiled:
    """Return a system compiled, the same again for the same object."""
    return compile(key.value)


def _callable(target: str) -> str:
    """Return a target that Python calls, in whatever case it is given. Raises `InputError` for others."""
    name = spelt(target, [*TARGETS, *ROWS, UNIT])
    if name in TARGETS:
        return name
    if name in ROWS or name == UNIT:
        raise InputError(
            f"the target {name} is written, and not run from Python", where="target", got=target,
            expected=f"one of {', '.join(TARGETS)}", hint="write it by eom generate",
        )  # fmt: skip
    raise unknown_name("target", target, TARGETS)


@typed
def compiled_jacobian(
    compiled: Compiled | System, by: str = "states", of: str = RATES, target: str = ""
) -> SparseJacobian:
    """Return the compiled derivatives of a group of results by states, parameters, inputs or time.

    Parameters
    ----------
    compiled : Compiled or System
        The system, compiled at the first call unless it is; it keeps what is compiled, so that the
        same arguments give the same object at once.
    by : str, default "states"
        states, parameters, inputs or time.
    of : str, default "rates"
        rates, outputs, invariants or singularities.
    target : str, optional
        That of ``compiled`` if left out.

    Returns
    -------
    SparseJacobian
        A function of the entries that are not zero everywhere, with their rows and columns.

    Raises
    ------
    InputError
        For other words and for groups that the system does not have.

    Notes
    -----
    Derivatives are exact up to rounding, as no differences are taken. Units are those of the
    results over those of the variables.

    References
    ----------
    Griewank and Walther, Evaluating Derivatives (2008), ch. 9 and 10: elimination of inner values.

    Examples
    --------
    >>> import sympy as sp, codegen, eom
    >>> y, v, k = sp.symbols("y v k", real=True)
    >>> oscillator = eom.System.from_rates("oscillator", {y: v, v: -k * y})
    >>> compiled_jacobian(codegen.compile(oscillator, "numpy")).dense(0, [1, 0], [4])
    array([[ 0.,  1.],
           [-4.,  0.]])
    """
    compiled = compiled_of(compiled)
    if by not in KINDS:
        raise unknown_name("kind of variable", by, KINDS)
    if of not in compiled.layout.sizes:
        raise unknown_name("group of results", of, compiled.layout.sizes)
    target = _callable(target) if target else target
    return kept_jacobian(compiled, (of,), (by,), target or compiled.target)


def known_jacobian(compiled: Compiled) -> SparseJacobian | None:
    """Return the Jacobian of the rates by the states if ``compiled`` keeps it already, else None."""
    found = compiled.derived.get((compiled.target, RATES, "states"))
    return found if isinstance(found, SparseJacobian) else None


def kept_jacobian(
    compiled: Compiled, of: tuple[str, ...], by: tuple[str, ...], target: str
) -> SparseJacobian:
    """Return the derivatives of groups by kinds of variables, from what ``compiled`` keeps."""
    key = (target, *of, *by)
    if key not in compiled.derived:
        compiled.derived[key] = _derived(compiled, of, by, target)
    found = compiled.derived[key]
    assert isinstance(found, SparseJacobian)
    return found


def _derived(
    compiled: Compiled, of: tuple[str, ...], by: tuple[str, ...], target: str
) -> SparseJacobian:
    layout = compiled.layout
    derived = differentiated(compiled.program, layout, of, by)
    results = tuple(n for group in of for n in layout.results[group])
    names = (*results, *(f"d{r}_{c}" for r, c in derived.pattern))
    own = layout_of_derivatives(layout, "_".join((*of, "by", *by)), names)
    whole = optimise(one_group(formed(derived.program, compiled.stable), JACOBIAN))
    _, functions, _ = TARGETS[target](whole, own)
    return SparseJacobian(
        (len(results), sum(slots(layout, kind) for kind in by)),
        tuple(r for r, _ in derived.pattern),
        tuple(c for _, c in derived.pattern),
        functions[JACOBIAN],
        whole,
        own,
        derived.mode,
    )


BLOCK = 64
"""Threads take whole multiples of so many points: of any number of lanes, and of lines of the cache."""
FEWEST = 1024
"""Points of a share, at least."""
LEAST_WORK = 500_000
"""Additions of a share, at least: about a tenth of a millisecond, which a thread takes to wake up."""


@dataclass(frozen=True, repr=False)
class Batch(CheckedFunction):
    """A function ``f(t, x, p, u, out=None)`` like those of `Compiled`, for many points at once.

    ``compiled``, ``group``: of what; ``threads``: how many work at once; ``kernel``: what they run.
    ``form``: ``lanes``, or the target whose plain form it is. ``notice``: why, in that case.
    """

    compiled: Compiled
    threads: int
    form: str
    notice: str

    def __repr__(self) -> str:
        """Name the system, the group, the form and the threads."""
        name = self.compiled.layout.name
        return f"Batch({name!r}, {self.group}: {self.form}, {self.threads} threads)"

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by what it was made from."""
        return (batch, (self.compiled, self.group, self.threads))


def batch(compiled: Compiled, group: str, threads: int | None = None) -> Batch:
    """Return the function of a group of results over many points.

    ``threads``: how many work at once, by default as many as this process has processors. Where there
    are no lanes (another target than C, or a compiler without vector extensions) the plain form is
    taken, and ``notice`` says so. Raises `InputError` for an unknown group or number of threads.
    """
    if group not in compiled.functions:
        raise unknown_name("group of results", group, compiled.functions)
    if threads is None:
        threads = processors()
    elif isinstance(threads, bool) or not isinstance(threads, int) or threads < 1:
        raise InputError("wrong number of threads", got=threads, expected="1 or more, or None")
    kernel, form, notice = _kernel(compiled, group)
    cost = prune(compiled.program, [group]).cost()
    fewest = max(FEWEST, LEAST_WORK // max(1, cost))
    shared = divided(kernel, threads, fewest)
    return Batch(group, compiled.layout, shared, compiled, threads, form, notice)


def divided(kernel: Kernel, threads: int, fewest: int = FEWEST) -> Kernel:
    """Divide the points among threads, ``fewest`` to each; the caller's own takes the first share."""

    def run(t: Any, x: Array, p: Array, u: Array, out: Array) -> None:
        count = out.shape[1] if out.ndim == 2 else 1
        share = max(fewest, -(-count // threads))
        share = -(-share // BLOCK) * BLOCK
        if share >= count:
            kernel(t, x, p, u, out)
            return

        def part(first: int) -> None:
            last = first + share
            arrays = (a[:, first:last] if a.ndim == 2 else a for a in (x, p, u, out))
            kernel(t[first:last] if t.ndim else t, *arrays)

        others = [_pool(threads, os.getpid()).submit(part, k) for k in range(share, count, share)]
        try:
            part(0)
        finally:
            wait(others)  # nothing writes into ``out`` after an error
        for other in others:
            other.result()

    return run


def processors() -> int:
    """Return the processors that this process may use."""
    allowed: Callable[[int], set[int]] | None = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed else os.cpu_count() or 1


@cache
def _pool(threads: int, process: int) -> ThreadPoolExecutor:  # noqa: ARG001 - a fork has no threads
    return ThreadPoolExecutor(threads - 1, "eom-batch")


def _kernel(compiled: Compiled, group: str) -> tuple[Kernel, str, str]:
    """Return the kernel, its form, and why it is not in lanes."""
    plain = _plain(compiled.functions[group])
    if compiled.target != "c":
        return plain, compiled.target, f"target {compiled.target} has no lanes: taking its own form"
    try:
        library = _library(compiled)
    except native.CompilerError as error:
        return plain, "c", f"{error.brief}: one point after the other"
    symbol = f"{identifier(compiled.layout.name)}_{group}_{lanes.SUFFIX}"
    return batch_kernel(library, symbol), lanes.SUFFIX, ""


def _plain(function: Function) -> Kernel:
    def run(t: Any, x: Array, p: Array, u: Array, out: Array) -> None:
        function(t, x, p, u, out)

    return run


def _library(compiled: Compiled) -> Any:
    """Compile and load the lanes of a system once."""
    key = (lanes.SUFFIX,)
    if key not in compiled.derived:
        text = lanes.single_text(compiled.program, compiled.layout)
        compiled.derived[key] = native.load(native.compile_library(text), text)
    return compiled.derived[key]
