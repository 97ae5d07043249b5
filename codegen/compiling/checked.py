"""Functions of one shape contract over any target: conversion, shapes and errors stand here.

Arrays are ``(n,)`` for one point or ``(n, N)`` for N points, in double precision; time is a number
or ``(N,)``. Whatever has no column axis is the same at every point.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen.frontend.layout import Layout, completed, in_order, names_of
from eom.errors import InputError, shown
from eom.quantities import Quantity

Array = NDArray[np.float64]
Values = ArrayLike | Mapping[str, ArrayLike]
"""Values of states, parameters or inputs: in order, (n,) or (n, N), or by name, each a number or (N,)."""
Kernel = Callable[[Any, Array, Array, Array, Array], None]
"""(t, x, p, u, out) with checked arrays; fills out."""


class Function(Protocol):
    """A function ``f(t, x, p, u, out=None)`` of one group of results, in shape (k,) or (k, N)."""

    def __call__(
        self,
        t: ArrayLike,
        x: Values,
        p: Values | None = None,
        u: Values | None = None,
        out: Array | None = None,
    ) -> Array:
        """Return the results at one point, (k,), or at N points, (k, N).

        Parameters
        ----------
        t : array
            Time, a number or (N,).
        x : mapping or array
            States, (n,) or (n, N), or by name, each a number or (N,); what has a default may be
            left out.
        p : mapping or array, optional
            Parameters, in the same forms.
        u : mapping or array, optional
            Inputs, in the same forms.
        out : array, optional
            An array that is filled and returned.

        Returns
        -------
        array
            (k,) or (k, N). What has no column axis is the same at every point.

        Raises
        ------
        InputError
            For wrong shapes and types, unknown and missing names.
        """


@dataclass(frozen=True)
class CheckedFunction:
    """The contract of a function of one ``group``: conversion, shapes, errors; then the ``kernel``.

    ``layout``: names in the order of its arrays.
    """

    group: str
    layout: Layout
    kernel: Kernel

    def __call__(
        self,
        t: ArrayLike,
        x: Values,
        p: Values | None = None,
        u: Values | None = None,
        out: Array | None = None,
    ) -> Array:
        """Return the results at one point or at many.

        Parameters
        ----------
        t : array
            Time, as of `Function`.
        x, p, u : mapping or array
            States, parameters and inputs, as of `Function`.
        out : array, optional
            An array that is filled and returned.

        Returns
        -------
        array
            (k,) or (k, N).

        Raises
        ------
        InputError
            For wrong shapes and types.
        """
        columns: dict[str, int] = {}
        time = _real(t, "t")
        if time.ndim > 1:
            raise InputError("t has the wrong shape", got=time.shape, expected="() or (N,)")
        if time.ndim == 1:
            columns["t"] = time.shape[0]
        states = _shaped("state", x, self.layout.states, columns)
        parameters = _shaped("parameter", p, self.layout.parameters, columns)
        inputs = _shaped("input", u, self.layout.inputs, columns)
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
    try:
        array = np.asarray(value)
    except ValueError:
        raise InputError(f"{name} is not an array: its rows differ", got=shown(value)) from None
    except MemoryError:
        raise InputError(f"{name} is too large for an array", got=shown(value)) from None
    if array.dtype.kind not in "fiub":
        raise InputError(f"{name} is not an array of real numbers", got=f"dtype {array.dtype}")
    return array.astype(np.float64, copy=False)


ARGUMENTS = {"state": "x", "parameter": "p", "input": "u"}
"""What quantities of each kind are called where functions take them."""


def _shaped(
    kind: str, value: Values | None, quantities: Sequence[Quantity], columns: dict[str, int]
) -> Array:
    name, names, n = ARGUMENTS[kind], names_of(quantities), len(quantities)
    value = completed(value, quantities)
    if value is None:
        if n:
            raise InputError(f"{name} is missing", expected=f"{n} values: {', '.join(names)}")
        return np.empty(0)
    array = _stacked(value, names, kind) if isinstance(value, Mapping) else _real(value, name)
    if array.ndim not in {1, 2} or array.shape[0] != n:
        expected = (
            f"({n},) or ({n}, N), in the order {', '.join(names)}" if n else "no values: (0,)"
        )
        raise InputError(f"{name} has the wrong shape", got=array.shape, expected=expected)
    if array.ndim == 2:
        columns[name] = array.shape[1]
    return array


def _stacked(values: Mapping[str, ArrayLike], names: Sequence[str], kind: str) -> Array:
    """Return values by name, each a number or (N,), as (n,) or (n, N)."""
    given = zip(names, in_order(values, names, kind), strict=True)
    rows = {n: _real(v, f"{kind} {n}") for n, v in given}
    for name, row in rows.items():
        if row.ndim > 1:
            raise InputError(
                f"{kind} {name} has the wrong shape", got=row.shape, expected="() or (N,)"
            )
    lengths = {n: row.size for n, row in rows.items() if row.ndim}
    if len(set(lengths.values())) > 1:
        raise InputError(
            f"numbers of columns of {kind}s differ",
            got=", ".join(f"{n}: {size}" for n, size in lengths.items()),
        )
    return np.stack(np.broadcast_arrays(*rows.values())) if rows else np.empty(0)


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


def in_whole_doubles(array: Array) -> bool:
    """Return whether the distances between elements are whole numbers of doubles."""
    return array.flags.aligned and all(s % array.itemsize == 0 for s in array.strides)


def _fills_in_place(out: Array, arguments: Sequence[Any]) -> bool:
    """Return whether no argument lies in ``out``, so that filling it changes none."""
    return in_whole_doubles(out) and not any(np.may_share_memory(out, a) for a in arguments)
