"""The letters of a derivation in a notation: of frames, points, quantities and symbols, and in its words.

Reasons are written in plain letters: h the angular momentum, J the inertia. Each names a quantity of the
derivation, or a symbol of it, and a page has the letters of its notation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from eom.derivations import standing
from eom.derivations.standing import component_name, named_by, terms_in
from eom.system import System
from eom.terms.rules import entrywise
from eom.terms.terms import (
    DYADIC,
    INERTIAL,
    MATRIX,
    SCALAR,
    VECTOR,
    Equation,
    Term,
    column,
    der,
    expr,
    nodes,
    zero,
)
from eom.terms.vocabulary import CENTRE, quantity, unit
from eom.typeset.boxes import GREEK_NAMES, Box, Symbol, symbol
from eom.typeset.letters import ROLES, Notation, letter_box
from eom.typeset.notation import PLAIN, term_box, write
from eom.typeset.sentences import names_in

FRAME_LABELS: dict[str, tuple[int, ...]] = {
    "angular_velocity": (1, 2),
    "rotation": (1, 2),
    "unit": (1,),
}
"""Where the labels of a quantity are frames."""
POINT_LABELS: dict[str, tuple[int, ...]] = {"position": (1, 2)}
"""Where they are points, besides those by `eom.typeset.letters.ROLES`."""
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
    letters = (s for s in derivation.letters if not isinstance(s, Term))
    for s in (*derivation.scalars, *letters):
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


def nameable(derivation: Any) -> dict[str, Term]:
    """Return the quantities that words can name, by what they are called there.

    Words have the letters of `eom.typeset.notation.PLAIN`: h_C, f_ij, C_AB. h alone is that about the one
    point that is spoken of, R a position from the inertial origin, r from the centre of mass, rho from O,
    b1 an axis. A name for two quantities is one for neither.
    """
    found = terms_of(derivation)
    atoms = [n for n in dict.fromkeys(found) if n.head == "atom" and n.data[0] != "unit"]
    called: dict[str, set[Term]] = {}
    for atom in atoms:
        for name in (write(atom, PLAIN), *_short(atom)):
            called.setdefault(name, set()).add(atom)
    known = {name: one for name, (one, *others) in called.items() if not others}
    known |= {n.data[1]: n for n in atoms if ROLES.get(n.data[0], ())[:1] == ("letter",)}
    known |= _places(atoms) | _turned_forces(atoms)
    known |= {f"{f.lower()}{k}": unit(f, k) for f in frames_of(found) for k in (1, 2, 3)}
    return known | {write(t, PLAIN): t for t in derivation.letters if isinstance(t, Term)}


def _short(atom: Term) -> Iterator[str]:
    """Yield what a quantity is called besides: without its point, or by the letter of a whole mass."""
    roles = ROLES.get(atom.data[0], ())
    if roles[-1:] == ("point",):
        yield PLAIN.letters[atom.data[0]].partition("^")[0]
    if atom.data in _MASSES:
        yield _MASSES[atom.data]
    if atom.data == ("angular_velocity", "B", "I"):
        yield "omega"


def letters_in_words(derivation: Any, notation: Notation) -> dict[str, Box]:
    """Return the boxes of letters that reasons spell, in a notation.

    ``h_C'`` is the rate as seen from I, ``[h_C]_B`` the components in B; what stands under ``h_C = 0``
    is the zero of such a kind, under ``C_BA = 1`` the unit matrix.
    """
    found = terms_of(derivation)
    frames = frames_of(found)
    labels = {k for n in found if n.head == "atom" for k in n.data[1:]}
    indices = {"t", *_INDICES - {"k"}, *labels & {*_INDICES, "n"}}
    known: dict[str, Box] = {name: symbol(name) for name in sorted(indices)}
    known |= standing.spoken(derivation, notation)
    known |= {p: notation.point(p) for p in points_of(found)}
    if any(isinstance(value, System) for value in derivation.result.values()):
        known |= {CENTRES[1]: notation.point(CENTRE)}
    known |= {frame: notation.frame(frame) for frame in frames}
    for name, term in nameable(derivation).items():
        known |= _forms(name, term, frames, notation)
    symbols = {s for n in found if n.head == "expr" for s in n.data[0].free_symbols}
    own = {s for s in derivation.letters if not isinstance(s, Term)}
    names = {s.name for s in (*symbols, *derivation.scalars, *own)} - GREEK_NAMES
    return known | {name: symbol(name) for name in names.difference(frames)}


def _forms(name: str, term: Term, frames: list[str], notation: Notation) -> dict[str, Box]:
    """Return the boxes of a quantity and of what is made of it."""
    forms = {name: term}
    if term.kind in {SCALAR, VECTOR}:
        rate = der(term, INERTIAL)
        forms |= {f"{name}'": rate, f"{name}''": der(rate, INERTIAL)}
    if term.kind in {VECTOR, DYADIC}:
        forms |= {f"{n} = 0": zero(t.kind) for n, t in tuple(forms.items())}
        forms |= {f"[{name}]_{f}": column(term, f) for f in frames}
    if term.kind == MATRIX:
        forms[f"{name} = 1"] = quantity("identity_matrix")
    return {n: term_box(t, notation) for n, t in forms.items()}


def factors(notation: Notation) -> Mapping[str, Box]:
    """Return the letters of rules such as a.b = b.a, which hold for any vectors."""
    nought = term_box(zero(VECTOR), notation)
    letters = {name: letter_box(notation, name, VECTOR) for name in "ab"}
    return letters | {f"{name} = 0": nought for name in letters}


def spoken(derivation: Any, texts: Iterable[str], notation: Notation) -> Iterator[Any]:
    """Yield the quantities and symbols that texts name."""
    known = letters_in_words(derivation, notation)
    things = nameable(derivation) | {
        s.name: s for s in derivation.letters if not isinstance(s, Term)
    }
    names = {n for text in texts for n in names_in(text, known)}
    yield from (thing for name, thing in things.items() if name in names)


def _turned_forces(atoms: list[Term]) -> dict[str, Term]:
    """Return the forces of pairs by the name of the opposite one."""
    pairs = [n for n in atoms if n.data[0] == "internal_force" and _INDICES.issuperset(n.data[1:])]
    turned = [replace(n, data=(n.data[0], *reversed(n.data[1:]))) for n in pairs]
    return {write(n, PLAIN): n for n in turned}


def _places(atoms: list[Term]) -> dict[str, Term]:
    """Return positions as reasons spell them: r, R, rho, r_i.

    r is from the centre of mass where an element has such a position, else from the inertial origin.
    """
    places = [a for a in atoms if a.data[0] == "position"]
    own = any(a.data[1] in {"dm", "P"} and a.data[2] == "C" for a in places)
    origins = {"R": "OI", "r": "C" if own else "OI", "rho": "O"}
    return {
        letter if a.data[1] in {"dm", "P"} else f"{letter}_{a.data[1]}": a
        for letter, origin in origins.items()
        for a in places
        if a.data[2] == origin
    }
