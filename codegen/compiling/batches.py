"""Functions of many points: in vector lanes, divided among threads.

Points are independent, and no point's result depends on its neighbours or its place: the results are
the same to the last bit for any number of threads.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from functools import cache
from typing import Any

from numpy.typing import ArrayLike

from codegen.compiling.checked import Array, CheckedFunction, Function, Kernel
from codegen.compiling.compiled import Compiled, batch_kernel
from codegen.ir.names import identifier
from codegen.ir.passes import prune
from codegen.native import native
from codegen.targets import lanes
from eom.errors import InputError, unknown_name

BLOCK = 64
"""Threads take whole multiples of so many points: of any number of lanes, and of lines of the cache."""
FEWEST = 1024
"""Points of a share, at least."""
LEAST_WORK = 500_000
"""Additions of a share, at least: about a tenth of a millisecond, which a thread takes to wake up."""


@dataclass(frozen=True)
class Batch:
    """A function ``f(t, x, p, u, out=None)`` like those of `Compiled`, for many points at once.

    ``compiled``, ``group``: of what; ``threads``: how many work at once; ``function``: what they run.
    ``form``: ``lanes``, or the target whose plain form it is. ``notice``: why, in that case.
    """

    compiled: Compiled
    group: str
    threads: int
    form: str
    notice: str
    function: CheckedFunction

    def __call__(
        self,
        t: ArrayLike,
        x: ArrayLike,
        p: ArrayLike | None = None,
        u: ArrayLike | None = None,
        out: Array | None = None,
    ) -> Array:
        """Return the results, (k,) or (k, N), in ``out`` where it is given.

        ``t``, ``x``, ``p``, ``u``: as of `Function`. Raises `InputError` for wrong shapes and types.
        """
        return self.function(t, x, p, u, out)

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
    checked = CheckedFunction(group, compiled.layout, divided(kernel, threads, fewest))
    return Batch(compiled, group, threads, form, notice, checked)


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
