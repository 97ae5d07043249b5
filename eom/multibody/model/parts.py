"""Fields of the parts of a tree: the shape of their values, and what formulas in them may speak of.

A field says both once, in its annotation. By it what a part is made of is checked (`Part`), the numbers
that it holds are found (`Part.values`), and scene files are described and read (`eom.multibody.files`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, ClassVar, get_args, get_type_hints

from eom.multibody.algebra import values
from eom.multibody.algebra.values import Value
from eom.multibody.model import checks
from eom.quantities import Quantity

PLAIN, CONSTANTS, MOVING, ACTING = "plain", "constants", "moving", "acting"
"""Over parameters and time; what bodies define, but no time; time, too; inputs and states, too."""
CENTRE, ORIGIN = "centre", "origin"


@dataclass(frozen=True)
class Kind:
    """What a field holds.

    ``shape``: a row of `SHAPES`; ``each`` (one value, or one a speed), ``ratios`` (by name), ``body`` (its
    name), ``axes`` (whose), ``word``; or the class of a part in it. ``scope``: what formulas may be over.
    ``keys``: what scene files call it, where that is not the field's name; of several the field is the
    tuple. ``needed``: files must say it; ``optional``: it may be None. ``unit``: of its values, nothing
    where they may have any; ``each``: of one at a turning speed (rad/s) and of one at a sliding speed
    (m/s).
    """

    shape: str | type
    scope: str = CONSTANTS
    keys: tuple[str, ...] = ()
    needed: bool = False
    optional: bool = False
    unit: str = ""
    each: tuple[str, str] = ("", "")

    def units(self, speeds: Sequence[Quantity]) -> tuple[str, ...]:
        """Return the unit of one value a speed.

        Parameters
        ----------
        speeds : sequence of Quantity
            Of a joint.

        Returns
        -------
        tuple of str
            In the order of the speeds.
        """
        return tuple(self.each[0 if s.unit == "rad/s" else 1] for s in speeds)


def _place(given: Any, where: str) -> Any:
    """Return centre or origin as they are, else three components."""
    named = isinstance(given, str) and given in {CENTRE, ORIGIN}
    return given if named else values.triple(given, where)


SHAPES: Mapping[str, Callable[[Any, str], Any]] = {
    "number": values.value,
    "vector": values.triple,
    "axis": values.unit,
    "rotation": values.rotation,
    "inertia": values.symmetric,
    "place": _place,
}
"""What makes values of a shape of what is given, or raises `InputError` with its place."""

Length = Annotated[Value, Kind("number", unit="m")]
Position = Annotated[Any, Kind("vector", unit="m")]
Axis = Annotated[Any, Kind("axis", unit="1")]
BodyName = Annotated[str, Kind("body")]


class Part:
    """A part of a tree, as a frozen dataclass whose annotations hold a `Kind`; its name, if it has one."""

    noun: ClassVar[str] = ""

    @property
    def where(self) -> str:
        """How errors name it."""
        return f"{self.noun} {self.name!r}" if hasattr(self, "name") else self.noun

    def __post_init__(self) -> None:
        if hasattr(self, "name"):
            checks.name(self.name, self.where)
        for name, kind in self._kinds.items():
            given = getattr(self, name)
            if kind.shape in SHAPES and not kind.keys and not (kind.optional and given is None):
                self._keep(name, SHAPES[str(kind.shape)](given, f"{self.where}: {name}"))
        self.complete()

    @property
    def _kinds(self) -> dict[str, Kind]:
        own: type = type(self)
        return kinds(own)

    def _keep(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)

    def complete(self) -> None:
        """Derive what else a field is, and raise `InputError` for what does not go together."""

    def measured(self, speeds: Sequence[Quantity] = ()) -> Iterator[tuple[str, Value, str]]:
        """Return values with places and units, these as far as they are known; ``speeds``: of a joint.

        Parameters
        ----------
        speeds : sequence of Quantity, optional
            Of a joint, whose units depend on them.

        Returns
        -------
        iterator of tuple of str, number or expression, str
            Each value with the place at which it was given, and its unit, as far as that is known.
        """
        for name, kind in self._kinds.items():
            held, where = getattr(self, name), f"{self.where}: {name}"
            if isinstance(held, Part):
                yield from held.measured(speeds)
            elif kind.shape == "each" and held is not None:
                yield from ((where, x, u) for x, u in zip(held, kind.units(speeds), strict=True))
            else:
                yield from ((where, x, kind.unit) for x in _values(held))

    @property
    def values(self) -> Iterator[Value]:
        """All numbers and expressions that it holds."""
        return _values(tuple(getattr(self, name) for name in self._kinds))


def _values(given: Any) -> Iterator[Value]:
    if isinstance(given, Part):
        yield from given.values
    elif isinstance(given, tuple):
        for entry in given:
            yield from _values(entry)
    elif given is not None and not isinstance(given, str):
        yield given


@cache
def kinds(part: type) -> dict[str, Kind]:
    """Return what the fields of a part hold, by name."""
    hints = get_type_hints(part, include_extras=True)
    found = {n: [k for k in get_args(hint) if isinstance(k, Kind)] for n, hint in hints.items()}
    return {n: own[0] for n, own in found.items() if own}
