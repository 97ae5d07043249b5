"""The letters of a derivation in a notation: of frames, points, quantities and symbols, and in its words.

Reasons are written in plain letters: h the angular momentum, J the inertia. A page has those of its
notation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from eom.derivations.standing import component_name, named_by, spoken, terms_in
from eom.system import System
from eom.terms.rules import entrywise
from eom.terms.terms import INERTIAL, Equation, Term, der, expr, nodes
from eom.terms.vocabulary import CENTRE, QUANTITIES, unit
from eom.typeset.boxes import GREEK_NAMES, Box, Symbol, symbol
from eom.typeset.letters import ROLES, Notation, letter_box
from eom.typeset.notation import term_box, write

FRAME_LABELS: dict[str, tuple[int, ...]] = {
    "angular_velocity": (1, 2),
    "rotation": (1, 2),
    "unit": (1,),
}
"""Where the labels of a quantity are frames."""
POINT_LABELS: dict[str, tuple[int, ...]] = {"position": (1, 2)}
"""Where they are points, besides those by `eom.typeset.letters.ROLES`."""
PLAIN_LETTERS = {
    "J": "inertia",
    "h": "angular_momentum",
    "p": "linear_momentum",
    "c": "first_moment",
}
"""The letters of reasons."""
_INDICES = frozenset("ijk")
_MASSES = {("total_mass", "system"): "M", ("total_mass", "body"): "M", ("mass", "P"): "m"}
"""The letters of masses in reasons."""
_POINTS = frozenset({"O", "C", "P", "OI", "OA", "OB"})


@dataclass(frozen=True)
class Named:
    """What a page calls by a ``box``: the ``thing``, its kind and name."""

    box: Box
    thing: tuple[str, ...]


CENTRES = ("C", "G")
"""The letters of the centre of mass in books; of a derivation that calls a number C, the second."""
FRAMES = ("C", "W")
"""The letter of a frame, and that of a derivation that calls a number C."""


def notation_of(derivation: Any, notation: Notation) -> Notation:
    """Return a notation in which no number has the letter of the centre of mass or of the frame C."""
    first, second = map(Symbol, CENTRES)
    names = {s.name for s in derivation.scalars}
    if CENTRES[0] not in names:
        return notation
    if notation.frame(FRAMES[0]) == first:
        notation = _with_frame(notation, *FRAMES)
    if notation.point(CENTRE) != first:
        return notation

    def point(label: str) -> Box:
        return second if label == CENTRE else notation.point(label)

    return replace(notation, point=point)


def _with_frame(notation: Notation, label: str, letter: str) -> Notation:
    """Return a notation that calls a frame and its axes by another letter."""
    axes = notation.atoms["unit"]

    def called(frame: str) -> str:
        return letter if frame == label else frame

    def unit_box(of: Notation, frame: str, axis: str) -> Box:
        return axes(of, called(frame), axis)

    return replace(
        notation,
        frame=lambda frame: notation.frame(called(frame)),
        atoms={**notation.atoms, "unit": unit_box},
    )


def spelt(derivation: Any, notation: Notation) -> Any:
    """Return a derivation whose symbols have the letters that a notation has for what they are.

    So are called the whole mass, torques, momenta and energies with their components, and quantities of a
    system that stand for one with a letter and but indices.
    """
    names = {
        s: type(s)(name, **s.assumptions0)
        for s, name in _renamed(derivation, notation)
        if name != s.name
    }
    if not names:
        return derivation
    renamed = entrywise(lambda e: e.xreplace(names))

    def called(equation: Equation) -> Equation:
        return replace(equation, left=renamed(equation.left), right=renamed(equation.right))

    return replace(
        derivation,
        steps=tuple(replace(s, statement=called(s.statement)) for s in derivation.steps),
        scalars={names.get(s, s): renamed(t) for s, t in derivation.scalars.items()},
        letters={names.get(s, s): words for s, words in derivation.letters.items()},
        result={
            name: _of_symbols(value, names, called) for name, value in derivation.result.items()
        },
        stands={n: renamed(t) if isinstance(t, Term) else t for n, t in derivation.stands.items()}
        | {s.name: expr(own) for s, own in names.items()},
    )


def _renamed(derivation: Any, notation: Notation) -> Iterator[tuple[Any, str]]:
    """Yield symbols with their names in a notation."""
    for s, meaning in derivation.scalars.items():
        if name := component_name(s.name, meaning, notation):
            yield s, name
        elif meaning.data[:1] == ("total_mass",):
            yield s, write(meaning, notation, "ascii")
    for s in (*derivation.scalars, *derivation.letters):
        term = derivation.stands.get(s.name)
        if isinstance(term, Term) and (name := named_by(s.name, term, notation)):
            yield s, name


def _of_symbols(
    value: Any, names: Mapping[Any, Any], called: Callable[[Equation], Equation]
) -> Any:
    """Return a result with other symbols; a system keeps those by which programs know it."""
    if isinstance(value, sp.Basic | sp.MatrixBase):
        return value.xreplace(names)
    if isinstance(value, Mapping):
        return {name: _of_symbols(part, names, called) for name, part in value.items()}
    if isinstance(value, tuple | list):
        return type(value)(_of_symbols(part, names, called) for part in value)
    if isinstance(value, Term):
        return called(Equation(value, value)).left
    return called(value) if isinstance(value, Equation) else value


def terms_of(derivation: Any) -> list[Term]:
    """Return every term within the steps and the meanings of the symbols of a derivation."""
    sides = [t for s in derivation.steps for t in (s.statement.left, s.statement.right)]
    stated = [n for t in (*sides, *derivation.scalars.values()) for n in nodes(t)]
    return [*stated, *terms_in(derivation)]


def frames_of(found: list[Term]) -> list[str]:
    """Return the labels of frames, in the order of their first use."""
    labels = [f for n in found if n.head in {"der", "column"} for f in n.data if f]
    for n in found:
        if n.head == "atom":
            labels += [n.data[k] for k in FRAME_LABELS.get(n.data[0], ())]
    return list(dict.fromkeys(labels))


def points_of(found: list[Term]) -> list[str]:
    """Return the labels of points, in the order of their first use."""
    labels: list[str] = []
    for n in found:
        if n.head == "atom":
            roles = enumerate(ROLES.get(n.data[0], ()), 1)
            places = [k for k, role in roles if role == "point"]
            labels += [n.data[k] for k in (*places, *POINT_LABELS.get(n.data[0], ()))]
    return [p for p in dict.fromkeys(labels) if p in _POINTS]


def named(derivation: Any, notation: Notation) -> Iterator[Named]:
    """Yield every letter of a page with what it names: frames, points, quantities, symbols."""
    found = terms_of(derivation)
    for frame in frames_of(found):
        yield Named(notation.frame(frame), ("frame", frame))
    for point in points_of(found):
        yield Named(notation.point(point), ("point", point))
    meanings = derivation.scalars
    for n in dict.fromkeys(n for n in found if n.head == "atom" and n not in meanings.values()):
        yield Named(term_box(n, notation), tuple(map(str, n.data)))
    for s, meaning in meanings.items():
        yield Named(symbol(s.name), ("scalar", s.name) if meaning.head != "atom" else meaning.data)
    used = {s for n in found if n.head == "expr" for s in n.data[0].free_symbols}
    for name in sorted(s.name for s in used - set(meanings)):
        yield Named(symbol(name), ("symbol", name))


def letters_in_words(derivation: Any, notation: Notation) -> dict[str, Box]:
    """Return the boxes of letters that reasons spell, in a notation."""
    found = terms_of(derivation)
    known: dict[str, Box] = {name: symbol(name) for name in ("t", *sorted(_INDICES - {"k"}))}
    known |= spoken(derivation, notation)
    for letter, name in PLAIN_LETTERS.items():
        known |= _plain_letter(letter, name, found, notation)
    known |= _places(found, notation)
    known |= {p: notation.point(p) for p in points_of(found)}
    if any(isinstance(value, System) for value in derivation.result.values()):
        known |= {CENTRES[1]: notation.point(CENTRE)}
    for frame in frames_of(found):
        known |= {frame: notation.frame(frame), **_axes(frame, notation)}
    known |= _indexed(found, notation)
    for n in found:
        if n.head == "atom" and ROLES.get(n.data[0], ())[:1] == ("letter",):
            known[n.data[1]] = term_box(n, notation)
        if n.head == "atom":
            known |= {k: symbol(k) for k in n.data[1:] if k in {*_INDICES, "n"}}
        if n.head == "atom" and n.data in _MASSES:
            known[_MASSES[n.data]] = term_box(n, notation)
        if n.head == "atom" and n.data[0] == "rotation":
            known["C_" + "".join(n.data[1:])] = term_box(n, notation)
    symbols = {s for n in found if n.head == "expr" for s in n.data[0].free_symbols}
    names = {s.name for s in (*symbols, *derivation.scalars)} - GREEK_NAMES
    return known | {name: symbol(name) for name in names.difference(frames_of(found))}


_INDEXED = {"linear_momentum": "p", "internal_force": "f", "external_force": "f"}
"""The letters by which reasons spell quantities of particles, with their indices: f_ij."""


def _indexed(found: list[Term], notation: Notation) -> dict[str, Box]:
    """Return the boxes of quantities of particles as reasons spell them, either way round."""
    known: dict[str, Box] = {}
    for n in found:
        letter = _INDEXED.get(n.data[0]) if n.head == "atom" else None
        labels = n.data[1:] if letter else ()
        if labels and _INDICES.issuperset(labels):
            for order in {tuple(labels), tuple(reversed(labels))}:
                turned = replace(n, data=(n.data[0], *order))
                known[f"{letter}_{''.join(order)}"] = term_box(turned, notation)
    return known


def _axes(frame: str, notation: Notation) -> dict[str, Box]:
    """Return the axes of a frame as reasons spell them: b1."""
    numbers = "123" if len(frame) == 1 else ""
    return {f"{frame.lower()}{k}": term_box(unit(frame, int(k)), notation) for k in numbers}


def _places(found: list[Term], notation: Notation) -> dict[str, Box]:
    """Return the boxes of positions as reasons spell them: r, R, rho, r_i; and of omega.

    r is from the centre of mass where an element has such a position, else from the inertial origin.
    """
    atoms = [n for n in dict.fromkeys(found) if n.head == "atom"]
    places = [a for a in atoms if a.data[0] == "position"]
    own = any(a.data[1] in {"dm", "P"} and a.data[2] == "C" for a in places)
    letters = {"R": "OI", "r": "C" if own else "OI", "rho": "O"}
    known: dict[str, Box] = {}
    for letter, origin in letters.items():
        for a in places:
            if a.data[2] == origin:
                of = a.data[1]
                name = letter if of in {"dm", "P"} else f"{letter}_{of}"
                known[name] = term_box(a, notation)
                known[f"{name}'"] = term_box(der(a, INERTIAL), notation)
                known[f"{name}''"] = term_box(der(der(a, INERTIAL), INERTIAL), notation)
    turning = next((a for a in atoms if a.data == ("angular_velocity", "B", "I")), None)
    return known if turning is None else known | {"omega": term_box(turning, notation)}


def _plain_letter(letter: str, name: str, found: list[Term], notation: Notation) -> dict[str, Box]:
    """Return the box of a plain letter, bare and with a point, where a derivation has the quantity.

    Where a notation has an inertia for each point, the bare one is that of the first that is spoken of.
    """
    atoms = [n for n in found if n.head == "atom" and n.data[0] == name]
    if not atoms:
        return {}
    own = name == "inertia" and name in notation.atoms
    bare = letter_box(notation, notation.letters[name], QUANTITIES[name].kind)
    boxes = {letter: term_box(atoms[0], notation) if own else bare}
    for n in atoms:
        if "point" in ROLES[name] and n.data[-1] in _POINTS:
            boxes[f"{letter}_{n.data[-1]}"] = term_box(n, notation)
    return boxes
