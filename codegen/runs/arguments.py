"""The arguments of runs, checked: one clear error each; and what is said of them, written once."""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen.native.trajectory import Array
from eom.errors import InputError, shown

LEAST_RTOL = 2.0**-52
"""Relative tolerance below which double precision holds nothing."""


def numbers(values: object, name: str) -> Array:
    """Return real numbers as an array of doubles. Raises `InputError` for others, which it names.

    Texts are no numbers, and rows of different lengths no array.
    """
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "fiubO" or (array.dtype.kind == "O" and _has_text(array)):
            raise TypeError
        return array.astype(np.float64)
    except (TypeError, ValueError, OverflowError, MemoryError):
        raise InputError(
            f"{name} does not fit", got=shown(values), expected="real numbers"
        ) from None


def _has_text(array: NDArray[Any]) -> bool:
    return any(isinstance(v, str | bytes) for v in array.reshape(-1))


def positive(value: float, name: str) -> float:
    """Return a positive number. Raises `InputError` for others, which it names."""
    number = float(value)
    if not number > 0:
        raise InputError(f"{name} is not positive", got=value)
    return number


def finite(value: float, name: str) -> float:
    """Return a finite number. Raises `InputError` for others, which it names."""
    number = float(value)
    if not math.isfinite(number):
        raise InputError(f"{name} is not finite", got=value)
    return number


def optional(value: float | None, name: str) -> float | None:
    """Return a positive number or None. Raises `InputError` for others, which it names."""
    return None if value is None else positive(value, name)


def relative(rtol: float) -> float:
    """Return a relative tolerance. Raises `InputError` for one that double precision cannot meet."""
    number = float(rtol)
    if not LEAST_RTOL <= number < math.inf:
        raise InputError(
            "rtol does not fit",
            got=rtol,
            expected="a finite number, at least 2^-52 = 2.2e-16, the spacing of doubles at 1",
        )
    return number


def count(value: int) -> int:
    """Return a positive whole number. Raises `InputError` for others."""
    if not isinstance(value, int) or value < 1:
        raise InputError("max_steps is not a positive whole number", got=value)
    return value


def span(t_span: tuple[float, float]) -> tuple[float, float]:
    """Return start and end of an interval of time. Raises `InputError` where it is none."""
    start, end = (float(t) for t in t_span)
    if not (math.isfinite(start) and math.isfinite(end)) or start == end:
        raise InputError(
            "t_span is not a time interval", got=t_span, expected="two different finite times"
        )
    return start, end


def tolerances(atol: ArrayLike, n: int) -> Array:
    """Return an absolute tolerance a state. Raises `InputError` for misfits; defaults: `scales`."""
    values = numbers(atol, "atol")
    if values.shape not in {(), (n,)} or not np.all((values > 0) & np.isfinite(values)):
        raise InputError(
            "atol does not fit", got=atol, expected=f"a positive number, or {n} of them"
        )
    return np.broadcast_to(values, (n,)).copy()


def grid(t_eval: ArrayLike, span: tuple[float, float]) -> Array:
    """Return times to store, in the direction of integration. Raises `InputError` for misfits."""
    grid = np.ascontiguousarray(numbers(t_eval, "t_eval"))
    direction = 1 if span[1] > span[0] else -1
    ordered = grid.ndim == 1 and bool(np.all(direction * np.diff(grid) > 0))
    if not ordered or (grid.size and not (min(span) <= grid.min() and grid.max() <= max(span))):
        raise InputError(
            "t_eval does not fit",
            got=f"{grid.size} times of shape {grid.shape}",
            expected="times inside t_span, each later than the one before (earlier, if backwards)",
        )
    return grid


F = TypeVar("F", bound=Callable[..., Any])


def arguments_of(other: Callable[..., Any]) -> Callable[[F], F]:
    """Let a function's docstring say of arguments that it takes too what another one's says of them.

    What its own section of parameters says stands; all are in the order of its signature.
    """

    def with_arguments(function: F) -> F:
        if function.__doc__ and other.__doc__:
            head, own, tail = _parameters(function.__doc__)
            said = {**_entries(_parameters(other.__doc__)[1]), **_entries(own)}
            listed = "".join(said[n] for n in inspect.signature(function).parameters if n in said)
            function.__doc__ = f"{head}{listed}\n{tail}"
        return function

    return with_arguments


def _parameters(words: str) -> tuple[str, str, str]:
    """Return what stands before the entries of the section of parameters, these, and the next section."""
    head, rule, rest = words.partition("Parameters\n    ----------\n")
    own, tail = rest.split("\n\n", 1)
    return head + rule, own + "\n", tail


def _entries(section: str) -> dict[str, str]:
    """Return the entries of a section by the name of their argument."""
    found = re.findall(r"^    (\w+) : .*\n(?:        .*\n)*", section, re.MULTILINE)
    return dict(zip(found, re.split(r"(?m)^(?=    \w+ : )", section)[1:], strict=True))
