"""A step of a derivation: a statement that has been verified, with its reason."""

from __future__ import annotations

from dataclasses import dataclass

from eom.terms.terms import Equation


@dataclass(frozen=True)
class Step:
    """A verified statement: its reason, where the lectures state it, and what it rests on.

    ``label``: by which `Derived` finds it. ``statement``: two sides and a relation. ``reason``: in
    words. ``kind``: law, definition, assumption or result; ``states``: the equations of the lectures that
    it states; ``assumptions``: a smallest set under which it holds; ``evidence``: how it was verified;
    ``follows``: labels of the lines from which it was reached, ``by``: the names of the rules.
    """

    label: str
    statement: Equation
    reason: str
    kind: str = "result"
    states: tuple[str, ...] = ()
    assumptions: tuple[str, ...] = ()
    evidence: str = ""
    follows: tuple[str, ...] = ()
    by: tuple[str, ...] = ()
