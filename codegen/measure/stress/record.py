"""What a check is and what it finds: figures against bounds, and how much is measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import sympy as sp

from codegen.integrate.methods import METHODS
from codegen.measure.workprecision.case import Case
from eom.errors import unknown_name
from eom.system import System

EPSILON = 2.0**-52
ABSOLUTE = 1e-3
"""Absolute tolerances are this part of the relative one, times the size of a state where that is known."""
PASS, FAIL, ABSENT = "pass", "FAIL", "not measured"


@dataclass(frozen=True)
class Figure:
    """One number against its bound; without a bound it is printed for comparison. NaN never passes.

    ``shown``: printed even where it passes.
    """

    what: str
    value: float
    bound: float | None = None
    note: str = ""
    shown: bool = False

    @property
    def passed(self) -> bool:
        """Whether the number is at most its bound."""
        return self.bound is None or bool(self.value <= self.bound)


@dataclass(frozen=True)
class Findings:
    """The figures of a check, and what was not measured, each with its reason."""

    figures: tuple[Figure, ...]
    absent: tuple[str, ...] = ()

    @property
    def verdict(self) -> str:
        """One figure beyond its bound fails the check; without any that has one there is no verdict."""
        if not all(f.passed for f in self.figures):
            return FAIL
        return PASS if any(f.bound is not None for f in self.figures) else ABSENT

    @property
    def worst(self) -> Figure | None:
        """The figure that is nearest to its bound, or farthest beyond it."""
        held = [f for f in self.figures if f.bound is not None]
        return max(held, key=_share, default=None)


def _share(figure: Figure) -> float:
    """Return the value over the bound; what does not pass comes before what does."""
    if not figure.value >= 0 or not figure.bound:
        return 0.0 if figure.passed else float("inf")
    return figure.value / figure.bound


@dataclass(frozen=True)
class Size:
    """How much is measured. ``share``: of the end times of the problems that are swept.

    ``limit``: seconds of processor time after which one run is given up. ``trials``: of the estimate.
    ``apart``: of the hostile systems every so-many-th of each family is taken. ``forms``: systems that
    are nearly one with a closed form.
    """

    name: str
    rotations: float
    starts: int
    tolerances: tuple[float, ...]
    share: float
    limit: float
    scenes: int
    kinds: int
    steps: int
    trials: int = 30
    apart: int = 5
    forms: int = 2000


SIZES: Mapping[str, Size] = {
    size.name: size
    for size in (
        Size("quick", 1e3, 24, (1e-3, 1e-6, 1e-9, EPSILON), 0.05, 0.2, 20, 3, 20_000, 10, 20, 200),
        Size("default", 3e4, 24, (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, EPSILON), 0.25, 0.5, 100, 10, 30_000),
        Size("full", 1e6, 12, (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13, EPSILON),
             1.0, 2.0, 1000, 30, 100_000, 30, 1, 10_000),
    )
}  # fmt: skip
Progress = Callable[[float], None]


@dataclass(frozen=True)
class Plan:
    """What is measured: size, methods, seed; and where the fraction that is done is reported."""

    size: Size
    methods: tuple[str, ...] = METHODS
    seed: int = 0
    progress: Progress = lambda fraction: None

    def applicable(self, wanted: tuple[str, ...]) -> list[str]:
        """Return those of the wanted methods that are among the plan's, in order."""
        return [m for m in wanted if m in self.methods]


@dataclass(frozen=True)
class Trial:
    """A case, how it is run, and its states as expressions in the time where these are known."""

    case: Case
    method: str
    rtol: float
    solution: Mapping[str, sp.Expr]


@dataclass(frozen=True)
class Material:
    """What is measured on, derived elsewhere.

    ``free_body``: torque-free, principal moments I1, I2, I3, states omega_1 to omega_3, q0 to q3;
    invariants T, H, H_1, H_2, H_3. ``in_angles``: the same body with three angles, by the name of
    the sequence. ``problems``: to be swept; ``scenes``: ready ones. ``draw(seed, number, kinds)``
    returns a random scene; it is called in another process, and is a function of a module.
    ``trials()``: with known solutions, the quick ones first. ``closed``: one system of each kind that
    has a closed form.
    """

    free_body: System
    in_angles: Mapping[str, System]
    problems: tuple[Case, ...]
    scenes: tuple[Case, ...]
    draw: Callable[[int, int, int], Case]
    trials: Callable[[], tuple[Trial, ...]] = tuple
    closed: tuple[Case, ...] = ()


@dataclass(frozen=True)
class Check:
    """A row of the table: name, what it states, bound, how it is measured, where the bound comes from."""

    name: str
    states: str
    bound: str
    measured: str
    source: str
    run: Callable[[Material, Plan], Findings]


def methods_of(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the methods by name, in the order of the table; all of them without names."""
    for name in names:
        if name not in METHODS:
            raise unknown_name("method", name, METHODS)
    return tuple(m for m in METHODS if not names or m in names)
