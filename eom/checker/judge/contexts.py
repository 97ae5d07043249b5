"""Contexts: what a world must hold so that the quantities of a claim have values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from eom.terms.terms import Term, nodes
from eom.worlds.worlds import sequence_of

CONTEXTS: tuple[tuple[str, ...], ...] = (
    (),
    ("rigid",),
    ("one_particle",),
    ("spin_312",),
    ("rotors",),
    ("viscous_slug",),
)
"""Worlds in which more and more quantities exist; the first where all of a claim do is taken."""


def labels_in(terms: Iterable[Term]) -> frozenset[str]:
    """Return every label of terms."""
    return frozenset(str(d) for t in terms for n in nodes(t) for d in n.data if isinstance(d, str))


def contexts(terms: Sequence[Term]) -> Iterator[tuple[str, ...]]:
    """Yield the contexts in which terms may have values, the simplest first.

    Angles exist by the assumption of their sequence, a single particle by that of one.
    """
    found = [n.data[2] for t in terms for n in nodes(t) if n.data[:1] == ("turn_angle",)]
    sequences = tuple(dict.fromkeys(map(sequence_of, found)))
    single = [("one_particle",)] if "P" in labels_in(terms) else []
    for general in [*single, *CONTEXTS]:
        yield (*sequences, *general)
