"""The methods of `codegen.simulate` by name, and how each comes to its integrator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Generic, TypeVar

from codegen.compiled import Compiled
from codegen.integrate import runge_kutta, scipy_, taylor
from codegen.integrate.dop853 import DOP853
from codegen.integrate.trajectory import Problem, Trajectory
from eom.errors import InputError, unknown_name

METHODS = ("auto", "DOP853", "taylor", *(f"scipy:{m}" for m in scipy_.METHODS))
"""``auto`` is DOP853; DOP853 runs in generated C on the target c, by SciPy otherwise. ``taylor`` runs
in generated C beside every target; its order follows from the relative tolerance."""

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class SameObject(Generic[T]):
    """A value as a key by identity, kept alive while it is in a cache."""

    value: T

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SameObject) and other.value is self.value

    def __hash__(self) -> int:
        return id(self.value)


@lru_cache(maxsize=64)
def _build_once(key: SameObject[Compiled]) -> runge_kutta.NativeMethod:
    return runge_kutta.build(DOP853, key.value.program, key.value.layout)


@lru_cache(maxsize=64)
def _build_taylor_once(key: SameObject[Compiled], order: int) -> runge_kutta.NativeMethod:
    return taylor.build(key.value.program, key.value.layout, order)


def integrator_of(
    compiled: Compiled, method: str, signals: scipy_.Inputs | None, rtol: float
) -> tuple[Callable[[Problem], Trajectory], str]:
    """Choose the integrator; return it, ready to run, and what it is called."""
    if method not in METHODS:
        raise unknown_name("method", method, METHODS)
    if method == "taylor":
        return _taylor(compiled, signals, taylor.order_of(rtol))
    own = method in {"auto", "DOP853"}
    if own and compiled.target == "c" and signals is None:
        native = _build_once(SameObject(compiled))
        return lambda problem: runge_kutta.integrate(native, problem), "DOP853 in generated C"
    name = "DOP853" if own else method.removeprefix("scipy:")
    reason = " (inputs are Python functions)" if own and signals is not None else ""
    used = f"{name} of SciPy over {compiled.target} functions{reason}"
    return lambda problem: scipy_.integrate(compiled, problem, name, signals), used


def _taylor(
    compiled: Compiled, signals: scipy_.Inputs | None, order: int
) -> tuple[Callable[[Problem], Trajectory], str]:
    if signals is not None:
        raise InputError(
            "method taylor cannot differentiate inputs that are Python functions",
            hint="write them into the system as functions of time, or choose DOP853",
        )
    native = _build_taylor_once(SameObject(compiled), order)
    used = f"Taylor series of order {order} in generated C"
    return lambda problem: runge_kutta.integrate(native, problem), used
