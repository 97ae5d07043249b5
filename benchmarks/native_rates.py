"""Right-hand sides in C by address, and the clock inside C that times them."""

from __future__ import annotations

import ctypes
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen import Compiled, SparseJacobian
from codegen.derivatives.derivative import JACOBIAN
from codegen.frontend.layout import Layout
from codegen.ir.names import identifier
from codegen.native import native
from codegen.targets import c

HERE = Path(__file__).parent
ALIGNED = ("-falign-functions=64",)
"""For both sides alike: where a function happens to start shall not be what is measured."""

CALLS = 4000
STATES = 64
CACHE_LINE = 64
ROOM = 256
"""Doubles that the constants of a right-hand side may take."""
SEED = 20240229

Array = NDArray[np.float64]


HANDWRITTEN = tuple(sorted(path.stem for path in (HERE / "handwritten").glob("*.c")))
"""Ready scenes whose rates someone wrote in C by hand."""


@dataclass(frozen=True)
class Rates:
    """A C function ``void f(double t, const double *x, const void *c, const double *u, double *dx)``.

    ``prepare``: the function ``void prepare(const double *p, void *c)`` that fills c from parameters;
    without it the function takes the parameters themselves.
    """

    text: str
    symbol: str
    library: ctypes.CDLL
    prepare: str = ""
    flags: tuple[str, ...] = ALIGNED

    @classmethod
    def of_text(cls, text: str, symbol: str, prepare: str, more: tuple[str, ...] = ()) -> Rates:
        """Compile C text, with the flags of generated code and ``more``, and load it."""
        flags = (*ALIGNED, *more)
        path = native.compile_library(text, flags)
        return cls(text, symbol, native.load(path, text, flags), prepare, flags)

    @classmethod
    def generated(cls, compiled: Compiled) -> Rates:
        """Return the generated right-hand side."""
        text = c.single_text(compiled.program, compiled.layout)
        name = identifier(compiled.layout.name)
        return cls.of_text(text, f"{name}_rates", f"{name}_prepare")

    @classmethod
    def jacobian(cls, jacobian: SparseJacobian) -> Rates:
        """Return the generated function of results and entries of their Jacobian."""
        text = c.single_text(jacobian.program, jacobian.layout)
        name = identifier(jacobian.layout.name)
        return cls.of_text(
            text,
            f"{name}_{JACOBIAN}",
            f"{name}_prepare",
            native.flags_for(jacobian.layout.sizes[JACOBIAN]),
        )

    @classmethod
    def handwritten(cls, name: str) -> Rates:
        """Return the hand-written right-hand side of a ready scene."""
        return cls.of_text((HERE / "handwritten" / f"{name}.c").read_text("utf-8"), "f", "prepare")

    def copies(self, count: int) -> list[Rates]:
        """Return the same function at other places of memory: its time depends on that a little."""
        path = native.compile_library(self.text, self.flags)
        with tempfile.TemporaryDirectory() as folder:
            files = [shutil.copy(path, Path(folder) / f"{k}{path.suffix}") for k in range(count)]
            return [replace(self, library=ctypes.CDLL(str(file))) for file in files]

    @property
    def address(self) -> int:
        """The function's address."""
        return ctypes.cast(getattr(self.library, self.symbol), ctypes.c_void_p).value or 0

    def constants(self, p: Array) -> Array:
        """Return what the function needs of the parameters."""
        if not self.prepare:
            return p
        prepare = getattr(self.library, self.prepare)
        prepare.argtypes = [ctypes.c_void_p] * 2
        prepare.restype = None
        made = aligned(np.zeros(ROOM))
        prepare(p.ctypes.data, made.ctypes.data)
        return made

    def __call__(self, x: Array, p: Array, u: Array) -> Array:
        """Return the rates at one point."""
        function = getattr(self.library, self.symbol)
        function.argtypes = [ctypes.c_double, *[ctypes.c_void_p] * 4]
        function.restype = None
        dx, c = np.empty_like(x), self.constants(p)
        function(0.0, x.ctypes.data, c.ctypes.data, u.ctypes.data, dx.ctypes.data)
        return dx


@dataclass(frozen=True)
class Points:
    """Random arguments: ``x`` (STATES, n), ``p``, ``u``, and room for the rates, all aligned."""

    x: Array
    p: Array
    u: Array
    dx: Array

    @classmethod
    def of(cls, compiled: Compiled) -> Points:
        """Draw arguments for a system: states in (-1, 1), parameters in (1/2, 3/2)."""
        return cls.for_layout(compiled.layout)

    @classmethod
    def for_layout(cls, layout: Layout) -> Points:
        """Draw arguments as `of` does."""
        draw = np.random.default_rng(SEED).uniform
        n = len(layout.states)
        arrays = (
            draw(-1.0, 1.0, (STATES, n)),
            draw(0.5, 1.5, len(layout.parameters)),
            draw(-1.0, 1.0, len(layout.inputs)),
            np.zeros(n),
        )
        return cls(*(aligned(a) for a in arrays))

    def with_room(self, results: int) -> Points:
        """Return the same arguments with room for so many results."""
        return replace(self, dx=aligned(np.zeros(results)))


def aligned(values: Array) -> Array:
    """Return a copy that starts a cache line, so that its place is the same in every run."""
    room = np.empty(values.size + CACHE_LINE // 8)
    start = (-room.ctypes.data % CACHE_LINE) // 8
    result = room[start : start + values.size].reshape(values.shape)
    result[...] = values
    return result


@cache
def _clock() -> Any:
    text = (HERE / "timer.c").read_text("utf-8")
    function = native.load(native.compile_library(text), text).nanoseconds
    function.restype = ctypes.c_double
    function.argtypes = [ctypes.c_void_p, *[ctypes.c_long] * 3, *[ctypes.c_void_p] * 4]
    return function


def sampler(rates: Rates, points: Points) -> Callable[[], float]:
    """Return a function that gives the seconds a call, over `CALLS` calls with varying states."""
    clock, address = _clock(), rates.address
    count, n = points.x.shape
    arrays = (points.x, rates.constants(points.p), points.u, points.dx)
    places = [a.ctypes.data for a in arrays]

    def sample() -> float:
        assert len(arrays) == len(places)  # the arrays live as long as their addresses
        return 1e-9 * float(clock(address, CALLS, count, n, *places))

    return sample


@contextmanager
def empty_cache() -> Iterator[None]:
    """Work with an empty cache of compiled code."""
    before = os.environ.get(native.CACHE_VARIABLE)
    with tempfile.TemporaryDirectory() as folder:
        os.environ[native.CACHE_VARIABLE] = folder
        try:
            yield
        finally:
            if before is None:
                del os.environ[native.CACHE_VARIABLE]
            else:
                os.environ[native.CACHE_VARIABLE] = before
