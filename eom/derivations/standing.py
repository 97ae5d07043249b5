"""What results stand for: quantities of systems, and other results, by name, as terms of the page.

A program calls the torque about b1 ``torque_1``; a page writes what that is in its own letters. A chapter
says by name what each stands for (`eom.derivations.derivation.Derivation.stands_for`): a term; words; or
nothing that it speaks of, which its page leaves out. A vector stands for its magnitude.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.quantities import Definition, Quantity
from eom.system import System
from eom.terms.terms import SCALAR, VECTOR, Equation, Term, dot, entries, expr, nodes
from eom.terms.vocabulary import quantity, unit
from eom.typeset.boxes import Box, Fence, symbol
from eom.typeset.letters import ROLES, Notation
from eom.typeset.markup import symbol_latex
from eom.typeset.notation import PLAIN, term_box

Stands = Mapping[str, Term | str | None]
"""What results are, by name."""

_H, _TORQUE = (quantity(n, "body", "C") for n in ("angular_momentum", "torque"))
_AXES = (1, 2, 3)
MOMENTUM: Stands = {
    "H": _H,
    **{f"h_{k}": dot(unit("B", k), _H) for k in _AXES},
    "h": _H,
    "J": quantity("inertia", "C"),
}
"""Angular momentum, its magnitude and components, and inertia, as all systems of one body call them."""
IN_SPACE: Stands = {f"H_{k}": dot(unit("I", k), _H) for k in _AXES}
"""Its components along inertial axes."""
BODY: Stands = {
    **MOMENTUM,
    **IN_SPACE,
    "T": quantity("rotational_energy", "body", "C"),
    **{f"torque_{k}": dot(unit("B", k), _TORQUE) for k in _AXES},
    **{f"a{k}": unit("I", k) for k in _AXES},
    **{f"q{k}": quantity("euler_parameter", str(k), "B", "I") for k in range(4)},
    "tilt": None,
    "q_norm": None,
}
"""What `eom.mechanics.rigidbody.rigid_body` calls by name; its inertial axes are a1, a2, a3."""

_LETTERED = frozenset({"torque", "angular_momentum", "rotational_energy", "kinetic_energy"})
"""Quantities whose components and values are called by the letter that a notation has for them."""


def called(term: Term, notation: Notation) -> str:
    """Return the name of the letter of a quantity that has one and but indices, or nothing for others."""
    if term.head != "atom" or term.kind != SCALAR:
        return ""
    name, *labels = term.data
    roles = ROLES.get(name, ("point",))
    if name in notation.atoms or not {*roles} <= {"", "index"}:
        return ""
    shown = (label for role, label in zip(roles, labels, strict=True) if role == "index")
    return "_".join((notation.letters[name], *shown))


def component_name(name: str, meaning: Term, notation: Notation) -> str:
    """Return what a component or value of a quantity is called in a notation.

    ``name``: of the symbol; nothing for one that has not the plain letter of the quantity.
    """
    of = _measured(meaning)
    plain, own = (re.split("[_^]", n.letters.get(of, ""))[0] for n in (PLAIN, notation))
    letter, mark, rest = name.partition("_")
    return f"{own}{mark}{rest}" if of and letter == plain else ""


def named_by(name: str, term: Term, notation: Notation) -> str:
    """Return the name of the letter of what stands for a quantity, or for a component of one."""
    return called(term, notation) or component_name(name, term, notation)


def _measured(meaning: Term) -> str:
    """Return the name of the quantity that a term is, or of which it is a component along an axis."""
    parts = meaning.args if meaning.head == "dot" else (meaning,)
    names = [p.data[0] for p in parts if p.head == "atom"]
    of = [n for n in names if n in _LETTERED]
    whole = len(names) == len(parts) and all(n in _LETTERED or n == "unit" for n in names)
    return of[0] if whole and len(of) == 1 else ""


def quantities(system: System) -> Iterator[Quantity]:
    """Yield what a page shows of a system by letters, each once, in its order."""
    groups = (system.states, system.parameters, system.inputs)
    found = [q for group in groups for q in group]
    found += [d.quantity for d in _defined(system)]
    seen: set[str] = set()
    for q in found:
        if q.name not in seen:
            seen.add(q.name)
            yield q


def _defined(system: System) -> tuple[Definition, ...]:
    return (*system.definitions, *system.outputs, *system.invariants)


def _within(system: System) -> frozenset[str]:
    """Return the names of what formulas of a system are written with."""
    formulas = [*system.rates, *(d.expression for d in _defined(system))]
    formulas += [] if system.mass_matrix is None else [system.mass_matrix]
    own = (q.symbol for q in (*system.states, *system.parameters, *system.inputs))
    free = set(own).union(*(e.free_symbols for e in formulas))
    return frozenset(s.name for s in free)


def box_of(stands: Term, notation: Notation) -> Box:
    """Return the box of what a result stands for; of a vector it is the magnitude."""
    name = called(stands, notation)
    box = symbol(name) if name else term_box(stands, notation)
    return Fence(box, "|", "|") if stands.kind == VECTOR else box


def letters_of(derivation: Any, system: System, notation: Notation) -> dict[Any, Box]:
    """Return how the page of a derivation writes the symbols of a system, but for letters of its own."""
    within, listed_names = _within(system), {s.name for s in derivation.scalars}
    found: dict[Any, Box] = {}
    for q in quantities(system):
        term = derivation.stands.get(q.name)
        own = isinstance(term, Term) and q.name in within and not _is_letter(term, notation)
        if own or q.name in listed_names or _is_spelt(q, term):
            found[q.symbol] = symbol(q.name)
        elif isinstance(term, Term):
            found[q.symbol] = box_of(term, notation)
    return found


def _is_spelt(q: Quantity, term: Any) -> bool:
    """Return whether a quantity that stands for no term is called as its name says."""
    told, spelt = (re.sub("[{}]", "", latex) for latex in (q.latex, symbol_latex(q.name)))
    return not isinstance(term, Term) and told == spelt


def _is_letter(term: Term, notation: Notation) -> bool:
    return term.head == "expr" or bool(called(term, notation))


def shown_part(derivation: Any, system: System) -> System:
    """Return a system as its page shows it: without what the page does not speak of, or has said."""
    left_out = {name for name, term in derivation.stands.items() if term is None}

    def kept(d: Definition) -> bool:
        said = _meaning(derivation, d.expression)
        return d.name not in left_out and (said is None or said != derivation.stands.get(d.name))

    return replace(
        system,
        outputs=tuple(d for d in system.outputs if kept(d)),
        invariants=tuple(d for d in system.invariants if kept(d)),
    )


def _meaning(derivation: Any, symbol: Any) -> Term | None:
    """Return what a lone symbol of a system is on a page that may have renamed it."""
    if not isinstance(symbol, sp.Symbol):
        return None
    own = derivation.stands.get(symbol.name)
    name = own.data[0].name if isinstance(own, Term) and own.head == "expr" else symbol.name
    return next((t for s, t in derivation.scalars.items() if s.name == name), None)


def terms_in(derivation: Any) -> Iterator[Term]:
    """Yield the terms that results are written by."""
    for name in _shown_names(derivation):
        term = derivation.stands.get(name)
        if isinstance(term, Term) and not called(term, PLAIN):
            yield from nodes(term)


def _shown_names(derivation: Any) -> Iterator[str]:
    for name, value in derivation.result.items():
        if isinstance(value, System):
            yield from (q.name for q in quantities(shown_part(derivation, value)))
        yield name


def listed(derivation: Any, notation: Notation) -> Iterator[tuple[Any, Term | None, Quantity]]:
    """Yield the letters of systems with what they stand for, if that is more, and their quantities."""
    for value in derivation.result.values():
        if isinstance(value, System):
            shown = shown_part(derivation, value)
            letters = letters_of(derivation, shown, notation)
            for q in quantities(shown):
                term = derivation.stands.get(q.name)
                if not isinstance(term, Term) or called(term, notation):
                    yield letters.get(q.symbol), None, q
                elif q.name in _within(shown) and not _is_letter(term, notation):
                    yield letters[q.symbol], term, q


def spoken(derivation: Any, notation: Notation) -> dict[str, Box]:
    """Return the boxes of names in words about results: of scalars, of vectors and of axes."""
    systems = [value for value in derivation.result.values() if isinstance(value, System)]
    scalars = {q.name for system in systems for q in quantities(system)}
    return {
        name: box_of(term, notation) if name in scalars else term_box(term, notation)
        for name, term in derivation.stands.items()
        if isinstance(term, Term)
    }


def claims(stands: Stands, result: Mapping[str, Any]) -> Iterator[Equation]:
    """Yield what is claimed by saying what results stand for, of matrices, scalars and systems."""
    for name, value in (pair for row in result.items() for pair in _valued(*row)):
        term = stands.get(name)
        if isinstance(term, Term) and isinstance(value, sp.MatrixBase):
            yield Equation(term, entries(value))
        elif isinstance(term, Term) and isinstance(value, sp.Expr):
            square = term.kind == VECTOR
            yield Equation(dot(term, term) if square else term, expr(value**2 if square else value))


def _valued(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    if not isinstance(value, System):
        yield name, value
        return
    for d in (*value.definitions, *value.outputs):
        yield d.name, value.expand(d.expression)
