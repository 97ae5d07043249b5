"""A finished derivation: verified steps and the result, and how they are shown.

Some steps of a derivation, to be shown one question at a time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import EllipsisType
from typing import Any

from eom.derivations.forms import show_derivation
from eom.derivations.showing import show_steps
from eom.derivations.standing import Stands
from eom.derivations.steps import Step
from eom.derivations.verification import Scalars
from eom.errors import unknown_name
from eom.system import System
from eom.terms.own import Own


@dataclass(frozen=True)
class Derived:
    """A derivation with its verified steps and its result as SymPy objects by name.

    Parameters
    ----------
    name : str
        How it is called in commands and files.
    title : str
        Its heading.
    group : str
        The chapter.
    steps : tuple of Step
        In order, each verified when it was made.
    scalars : mapping of symbols to terms
        What its own scalars are, as terms of vector mechanics.
    result : mapping of str to objects
        Expressions, matrices and systems by name, in SI units.
    own : Own, optional
        Frames, points, bodies and laws that it defines.
    letters : mapping of object to str, optional
        What other symbols are, in words.
    stands : mapping of str to Term, str or None, optional
        What results, and quantities of systems among them, are, by name: see
        `eom.derivations.derivation.Derivation.stands_for`.

    Notes
    -----
    In a notebook it shows itself as a page.
    """

    name: str
    title: str
    group: str
    steps: tuple[Step, ...]
    scalars: Scalars
    result: Mapping[str, Any]
    own: Own = field(default_factory=Own, repr=False)
    letters: Mapping[Any, str] = field(default_factory=dict)
    stands: Stands = field(default_factory=dict)

    def __getitem__(self, label: str) -> Step:
        """Return the step with a label.

        Parameters
        ----------
        label : str
            Of the step.

        Returns
        -------
        Step
            With its statement, reason and evidence.

        Raises
        ------
        KeyError
            For a label that no step has.
        """
        for step in self.steps:
            if step.label == label:
                return step
        raise KeyError(label)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Every assumption that some step makes, in the order of their first use."""
        return tuple(dict.fromkeys(a for s in self.steps for a in s.assumptions))

    @property
    def system(self) -> System | None:
        """The equations of motion among the results, if there are any."""
        return next((r for r in self.result.values() if isinstance(r, System)), None)

    def part(self, *labels: str | EllipsisType, notation: str = "arrow") -> Excerpt:
        """Return some steps, which show themselves in a notebook: ``part("law", ..., "momentum")``.

        Parameters
        ----------
        labels : str or ...
            Of steps; `...` between two labels is all that stands between them.
        notation : str, default "arrow"
            One of `eom.typeset.notation.NOTATIONS` or its aliases.

        Returns
        -------
        Excerpt
            It shows itself in a notebook, numbered as in the whole.

        Raises
        ------
        InputError
            For labels that no step has.
        """
        return Excerpt(self, chosen(self, labels), notation)

    def page(
        self,
        style: str = "text",
        notation: str = "arrow",
        steps: bool = True,
        *,
        form: str = "full",
    ) -> str:
        """Return the derivation as one document.

        Parameters
        ----------
        style : str, default "text"
            ``text``, ``latex``, ``markdown`` or ``html``.
        notation : str, default "arrow"
            One of `eom.typeset.notation.NOTATIONS` or its aliases, by which frames and vectors are
            written.
        steps : bool, default True
            Whether every step is shown, or the last statement of each chain alone.
        form : str, default "full"
            ``full``, or ``handout``: one page with the results and the reasons of the key steps.

        Returns
        -------
        str
            The same derivation gives the same text.

        Raises
        ------
        InputError
            For other styles, notations and forms.
        """
        return show_derivation(self, style, notation, steps, form=form)

    def _repr_markdown_(self) -> str:

        return show_derivation(self, "markdown")


Chosen = str | EllipsisType
"""A label of a step, or `...` for all steps between its neighbours."""


@dataclass(frozen=True)
class Excerpt:
    """Steps of a derivation, in its order, numbered as in the whole; it shows itself in notebooks.

    ``derivation``: the whole; ``steps``: those that are shown; ``notation``: one of
    `eom.typeset.notation.NOTATIONS` or its aliases.
    """

    derivation: Derived
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

        labels = [step.label for step in self.steps]
        return show_steps(self.derivation, labels, style, self.notation)


def chosen(derivation: Derived, items: Sequence[Chosen]) -> tuple[Step, ...]:
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
