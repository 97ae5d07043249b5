"""Distributions in words, as ``normal(0, 0.1)``: the same on the command line and in files."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from codegen.ensembles.sampler import (
    Grid,
    Names,
    Normal,
    Sampler,
    Uniform,
    UniformQuaternion,
    Value,
)
from eom.errors import InputError, unknown_name

_CALL = re.compile(r"\s*([a-z]+)\s*(?:\(([^()]*)\))?\s*")


@dataclass(frozen=True)
class Kind:
    """A row: how a distribution is written, what it is, and what makes it of its numbers."""

    usage: str
    meaning: str
    make: Callable[..., Value]

    @property
    def name(self) -> str:
        """The word before the bracket."""
        return self.usage.partition("(")[0]

    @property
    def numbers(self) -> int:
        """How many numbers it takes."""
        return len([n for n in self.usage.partition("(")[2].rstrip(")").split(",") if n])


def _grid(low: float, high: float, count: float) -> Grid:
    return Grid(low, high, int(count) if count.is_integer() else -1)


KINDS = (
    Kind("uniform(LOW, HIGH)", "each value between as likely as the other", Uniform),
    Kind("normal(MEAN, DEVIATION)", "the normal distribution", Normal),
    Kind("grid(LOW, HIGH, COUNT)", "equal distances; grids of several names are crossed", _grid),
    Kind("attitude()", "of q0,q1,q2,q3: each attitude as likely as the other", UniformQuaternion),
)


def distribution(given: str | float, where: str) -> Value:
    """Return a distribution, or the number that stands for all.

    Raises `InputError` for what is neither, with ``where`` it stands.
    """
    if isinstance(given, int | float) and not isinstance(given, bool):
        return float(given)
    number = _number(given) if isinstance(given, str) else None
    if number is not None:
        return number
    call = _CALL.fullmatch(given) if isinstance(given, str) else None
    if call is None:
        expected = "a number or " + ", ".join(kind.usage for kind in KINDS)
        raise InputError("not a distribution", where=where, got=given, expected=expected)
    kind = next((kind for kind in KINDS if kind.name == call[1]), None)
    if kind is None:
        raise unknown_name("distribution", call[1], [kind.name for kind in KINDS], where)
    numbers = (
        [_number(word) for word in (call[2] or "").split(",")] if (call[2] or "").strip() else []
    )
    if len(numbers) != kind.numbers or None in numbers:
        raise InputError(
            "not the numbers of a distribution", where=where, got=given, expected=kind.usage
        )
    try:
        return kind.make(*numbers)
    except InputError as error:
        raise InputError(error.what, where=where, got=given, expected=error.expected) from None


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def names(text: str, where: str) -> Names:
    """Return a name, or several that are parted by commas. Raises `InputError` for an empty one."""
    found = tuple(name.strip() for name in text.split(","))
    if not all(found):
        raise InputError(
            "a name is missing", where=where, got=text, expected="NAME or NAME,NAME,..."
        )
    return found[0] if len(found) == 1 else found


def sampler(values: Mapping[str, str | float], count: int, seed: int) -> Sampler:
    """Return the sampler of distributions in words by name, or by names parted by commas.

    Raises `InputError` for what cannot be read and for names that do not fit.
    """
    found = {names(name, name): distribution(given, name) for name, given in values.items()}
    return Sampler(found, count, seed)
