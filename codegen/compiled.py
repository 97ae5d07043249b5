"""A compiled system: functions of one shape contract over any target.

Arrays are ``(n,)`` for one point or ``(n, N)`` for N points, in double precision; time is a number
or ``(N,)``. Whatever has no column axis is the same at every point.
"""

from __future__ import annotations

import ctypes
import errno
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen import fastcall, native, passes
from codegen.elsewhere import as_system
from codegen.guard import Guard
from codegen.integrate import runge_kutta
from codegen.integrate.dop853 import DOP853
from codegen.layout import Layout, names_of, to_array
from codegen.lower import INVARIANTS, OUTPUTS, RATES, SINGULARITIES, lower_system
from codegen.names import identifier
from codegen.program import Program
from codegen.stable import rewritten, rewritten_freely
from codegen.sums import share_sums
from codegen.targets import c, load_module, numpy_
from eom.errors import InputError, unknown_name
from eom.system import System

Array = NDArray[np.float64]
Kernel = Callable[[Any, Array, Array, Array, Array], None]
"""(t, x, p, u, out) with checked arrays; fills out."""


class Function(Protocol):
    """``f(t, x, p, u, out=None)``: results of one group, in shape (k,) or (k, N)."""

    def __call__(
        self,
        t: ArrayLike,
        x: ArrayLike,
        p: ArrayLike | None = None,
        u: ArrayLike | None = None,
        out: Array | None = None,
    ) -> Array:
        """Evaluate; fill and return ``out`` where it is given."""


@dataclass(frozen=True)
class CheckedFunction:
    """The whole contract of a function: conversion, shapes, errors; then the target's kernel."""

    group: str
    layout: Layout
    kernel: Kernel

    def __call__(
        self,
        t: ArrayLike,
        x: ArrayLike,
        p: ArrayLike | None = None,
        u: ArrayLike | None = None,
        out: Array | None = None,
    ) -> Array:
        """Evaluate. Raises `InputError` for wrong shapes and types."""
        columns: dict[str, int] = {}
        time = _real(t, "t")
        if time.ndim > 1:
            raise InputError("t has the wrong shape", got=time.shape, expected="() or (N,)")
        if time.ndim == 1:
            columns["t"] = time.shape[0]
        states = _shaped("x", x, names_of(self.layout.states), columns)
        parameters = _shaped("p", p, names_of(self.layout.parameters), columns)
        inputs = _shaped("u", u, names_of(self.layout.inputs), columns)
        count = set(columns.values())
        if len(count) > 1:
            raise InputError(
                "numbers of columns differ", got=", ".join(f"{k}: {v}" for k, v in columns.items())
            )
        shape = (self.layout.sizes[self.group], *count)
        arguments = (time[()], states, parameters, inputs)
        if out is not None and _fills_in_place(_checked_out(out, shape), arguments):
            self.kernel(*arguments, out)
            return out
        result = np.empty(shape)
        self.kernel(*arguments, result)
        if out is None:
            return result
        out[...] = result
        return out


def _real(value: ArrayLike, name: str) -> Array:
    array = np.asarray(value)
    if array.dtype.kind not in "fiub":
        raise InputError(f"{name} is not an array of real numbers", got=f"dtype {array.dtype}")
    return array.astype(np.float64, copy=False)


def _shaped(
    name: str, value: ArrayLike | None, names: Sequence[str], columns: dict[str, int]
) -> Array:
    n = len(names)
    if value is None:
        if n:
            raise InputError(f"{name} is missing", expected=f"{n} values: {', '.join(names)}")
        return np.empty(0)
    array = _real(value, name)
    if array.ndim not in {1, 2} or array.shape[0] != n:
        expected = (
            f"({n},) or ({n}, N), in the order {', '.join(names)}" if n else "no values: (0,)"
        )
        raise InputError(f"{name} has the wrong shape", got=array.shape, expected=expected)
    if array.ndim == 2:
        columns[name] = array.shape[1]
    return array


def _checked_out(out: Array, shape: tuple[int, ...]) -> Array:
    if (
        not isinstance(out, np.ndarray)
        or out.dtype != np.float64
        or out.shape != shape
        or not out.flags.writeable
    ):
        got = (
            f"{out.dtype} array of shape {out.shape}"
            if isinstance(out, np.ndarray)
            else type(out).__name__
        )
        raise InputError(
            "out does not fit", got=got, expected=f"a writable float64 array of shape {shape}"
        )
    return out


def _in_whole_doubles(array: Array) -> bool:
    """Tell whether the distances between elements are whole numbers of doubles."""
    return array.flags.aligned and all(s % array.itemsize == 0 for s in array.strides)


def _fills_in_place(out: Array, arguments: Sequence[Any]) -> bool:
    """Tell whether no argument lies in ``out``, so that filling it changes none."""
    return _in_whole_doubles(out) and not any(np.may_share_memory(out, a) for a in arguments)


@dataclass(frozen=True)
class Compiled:
    """A system compiled for a target.

    ``rhs(t, x, p, u, out=None)`` gives d(states)/dt; ``outputs``, ``invariants`` and
    ``singularities`` are like it, where the system has any. ``fixed``: parameters that were
    compiled in. ``notice``: what the user should know, for example that there was no C compiler.
    ``stable``: whether every identity against cancellation was applied, also those that cost time.
    """

    system: System
    layout: Layout
    program: Program
    target: str
    fixed: Mapping[str, float]
    functions: Mapping[str, Function]
    notice: str = ""
    stable: bool = False

    def __repr__(self) -> str:
        """Name the system, the target and the functions."""
        fixed = f", with {', '.join(self.fixed)} fixed" if self.fixed else ""
        functions = ", ".join("rhs" if g == RATES else g for g in self.functions)
        return f"Compiled({self.layout.name!r} for {self.target}{fixed}: {functions})"

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by what it was compiled from; the other side compiles, or finds it in its cache."""
        return (compile, (self.system, self.target, dict(self.fixed), self.stable))

    @property
    def rhs(self) -> Function:
        """The right-hand side d(states)/dt."""
        return self.functions[RATES]

    @property
    def outputs(self) -> Function:
        """The outputs, in the order of ``layout.results["outputs"]``."""
        return self._group(OUTPUTS)

    @property
    def invariants(self) -> Function:
        """The constants of the motion."""
        return self._group(INVARIANTS)

    @property
    def singularities(self) -> Function:
        """The expressions that are zero in singular configurations."""
        return self._group(SINGULARITIES)

    def _group(self, group: str) -> Function:
        if group not in self.functions:
            raise InputError(f"system {self.layout.name!r} has no {group}")
        return self.functions[group]

    @cached_property
    def guard(self) -> Guard:
        """Tests values against the system's assumptions."""
        return Guard.of(self.system)

    @cached_property
    def files(self) -> Mapping[str, str]:
        """The generated files by name; the same system gives the same bytes."""
        return generate(self.program, self.layout, self.target)

    @property
    def source(self) -> str:
        """The generated source text of the functions."""
        name = identifier(self.layout.name)
        return self.files[f"{name}.{'c' if self.target == 'c' else 'py'}"]

    def write(self, folder: str | Path) -> list[Path]:
        """Write the generated files, each whole or not at all; return their paths."""
        return write_files(self.files, folder)


def compile(  # noqa: A001 - the word that users expect
    system: System | Any,
    target: str = "auto",
    parameters: Mapping[str, float] | None = None,
    stable: bool = False,
) -> Compiled:
    """Compile ``system`` for a target: ``c``, ``numpy``, or ``auto`` (C where a compiler works).

    ``system``: an `eom.System`, or what `codegen.elsewhere.as_system` accepts: SymPy's KanesMethod,
    LagrangesMethod or mechanics System, (states, rates), (states, mass matrix, forces).
    ``parameters``: numbers for some or all parameters, which are then compiled in and folded.
    ``stable``: apply every identity of `codegen.identities` against cancellation; those that cost no
    time are always applied. `codegen.accuracy` tells where it helps.
    Raises `InputError` for unknown names, values that contradict the system's assumptions and
    expressions without an operation; `CompilerError` where target ``c`` cannot be compiled.
    """
    system = as_system(system)
    program, layout = specialised(system, parameters or {}, stable)
    build = TARGETS.get(target)
    if build is None:
        raise unknown_name("target", target, TARGETS)
    used, functions, notice = build(program, layout)
    fixed = dict(parameters or {})
    return Compiled(system, layout, program, used, fixed, functions, notice, stable)


def specialised(
    system: System, parameters: Mapping[str, float], stable: bool = False
) -> tuple[Program, Layout]:
    """Return program and layout with ``parameters`` fixed to numbers, sums in stable forms."""
    program = as_written(system, parameters)
    form = rewritten(program) if stable else rewritten_freely(program)
    return share_sums(form.program, RATES), Layout.of(system).without(parameters)


def as_written(system: System, parameters: Mapping[str, float]) -> Program:
    """Return the program with ``parameters`` fixed to numbers, and nothing rewritten."""
    Guard.of(system).check(parameters)
    names = system.parameter_names
    given = {n: v for n, v in parameters.items() if n in names}
    to_array(list(given.values()), list(given), "parameter")
    fixed = {names.index(n): float(v) for n, v in given.items()}
    return passes.specialise(lower_system(system), fixed, len(names))


def generate(program: Program, layout: Layout, target: str) -> Mapping[str, str]:
    """Return the generated files of a target by name; needs no compiler.

    Raises `InputError` for an unknown target.
    """
    if target not in _GENERATORS:
        raise unknown_name("target", target, _GENERATORS)
    return _GENERATORS[target](program, layout)


def _c_files(program: Program, layout: Layout) -> Mapping[str, str]:
    return {**c.files(program, layout), **runge_kutta.files(DOP853, layout)}


_GENERATORS: dict[str, Callable[[Program, Layout], Mapping[str, str]]] = {
    "c": _c_files,
    "numpy": numpy_.files,
}


Functions = Mapping[str, Function]


def _numpy(program: Program, layout: Layout) -> tuple[str, Functions, str]:
    module = load_module(numpy_.module(program, layout), identifier(layout.name))

    def kernel(group: str) -> Kernel:
        function = getattr(module, group)

        def run(t: Any, x: Array, p: Array, u: Array, out: Array) -> None:
            with np.errstate(all="ignore"):
                function(t, x, p, u, out)

        return run

    return "numpy", {g: CheckedFunction(g, layout, kernel(g)) for g in layout.sizes}, ""


def _native(program: Program, layout: Layout) -> tuple[str, Functions, str]:
    text = c.single_text(program, layout)
    library = native.load(native.compile_library(text), text)
    name = identifier(layout.name)
    functions = {}
    for group in layout.sizes:
        checked = CheckedFunction(group, layout, _batch_kernel(library, f"{name}_{group}_batch"))
        address = ctypes.cast(getattr(library, f"{name}_{group}"), ctypes.c_void_p).value
        lengths = (
            len(layout.states),
            len(layout.parameters),
            len(layout.inputs),
            layout.sizes[group],
        )
        functions[group] = fastcall.bind(address or 0, lengths, checked)
    return "c", functions, ""


def _batch_kernel(library: ctypes.CDLL, symbol: str) -> Kernel:
    function = getattr(library, symbol)
    array = [ctypes.c_void_p, ctypes.c_ssize_t, ctypes.c_ssize_t]
    function.argtypes = [ctypes.c_size_t, ctypes.c_void_p, ctypes.c_ssize_t, *array * 4]
    function.restype = None

    def strided(a: Array) -> tuple[int, int, int]:
        steps = [s // a.itemsize for s in a.strides]
        return a.ctypes.data, steps[0], steps[1] if a.ndim == 2 else 0

    def run(t: Any, x: Array, p: Array, u: Array, out: Array) -> None:
        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        times, x, p, u = (a if _in_whole_doubles(a) else a.copy() for a in (times, x, p, u))
        step = times.strides[0] // times.itemsize if np.ndim(t) else 0
        count = out.shape[1] if out.ndim == 2 else 1
        function(count, times.ctypes.data, step, *(v for a in (x, p, u, out) for v in strided(a)))

    return run


def _automatic(program: Program, layout: Layout) -> tuple[str, Functions, str]:
    try:
        return _native(program, layout)
    except native.CompilerError as error:
        _, functions, _ = _numpy(program, layout)
        return (
            "numpy",
            functions,
            f"{error.what} ({error.got.splitlines()[0]}): using the NumPy target",
        )


TARGETS: dict[str, Callable[[Program, Layout], tuple[str, Functions, str]]] = {
    "auto": _automatic,
    "c": _native,
    "numpy": _numpy,
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
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            "files cannot be written",
            where=str(target),
            got=reason,
            hint="choose a folder that you can write",
        ) from None
    return [target / name for name in files]
