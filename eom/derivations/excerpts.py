"""Some steps of a derivation, to be shown one question at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import EllipsisType
from typing import TYPE_CHECKING, Any

from eom.errors import unknown_name

if TYPE_CHECKING:
    from eom.derivations.derivation import Derivation, Step

Chosen = str | EllipsisType
"""A label of a step, or `...` for all steps between its neighbours."""


@dataclass(frozen=True)
class Excerpt:
    """Steps of a derivation, in its order, numbered as in the whole; it shows itself in notebooks.

    ``steps``: those that are shown; ``notation``: one of `eom.typeset.notation.NOTATIONS` or its aliases.
    """

    derivation: Derivation
    steps: tuple[Step, ...]
    notation: str = "arrow"

    def __str__(self) -> str:
        """Return the steps as text."""
        return self._shown("text")

    def _repr_markdown_(self) -> str:
        return self._shown("markdown")

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        del cycle
        printer.text(str(self))

    def _shown(self, style: str) -> str:
        from eom.derivations.showing import show_steps

        labels = [step.label for step in self.steps]
        return show_steps(self.derivation, labels, style, self.notation)


def chosen(derivation: Derivation, items: Sequence[Chosen]) -> tuple[Step, ...]:
    """Return the steps that labels and ranges name, each once, in the order of the derivation.

    ``"law", ..., "euler-matrix"`` is the range from one label to the other, both included; `...` at the
    beginning or the end runs from the first or to the last step. Raises `InputError` for labels that
    the derivation does not have.
    """
    labels = [step.label for step in derivation.steps]
    for item in items:
        if isinstance(item, str) and item not in labels:
            raise unknown_name("step", item, labels)
    places = set(_places(labels, items))
    return tuple(step for k, step in enumerate(derivation.steps) if k in places)


def _places(labels: list[str], items: Sequence[Chosen]) -> Iterator[int]:
    for k, item in enumerate(items):
        if isinstance(item, str):
            yield labels.index(item)
            continue
        before, after = items[:k][-1:], items[k + 1 :][:1]
        start = labels.index(before[0]) if before and isinstance(before[0], str) else 0
        stop = labels.index(after[0]) if after and isinstance(after[0], str) else len(labels)
        yield from range(start, stop)
