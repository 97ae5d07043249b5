"""Letters with their indices: what each quantity looks like in a notation.

A `Notation` is a table of letters, nuclei and ways to write what differs between books; the labels of
a quantity become indices by their `ROLES`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from eom.typeset.boxes import Box, Fence, Operator, Row, Scripts, Symbol, joined, row, symbol

if TYPE_CHECKING:
    from eom.terms.terms import Term

Written = tuple[Box, int]
Nucleus = Callable[[str], Box]


@dataclass(frozen=True)
class Notation:
    """A row of `notation.NOTATIONS`: letters, nuclei by kind, points, frames, and special cases.

    ``letters``: of each quantity; what follows ``_`` is an upright index, what follows ``^`` a raised
    one. ``atoms``: quantities that are written in their own way. ``derivative``, ``column``, ``tilde``:
    how the notation writes these heads.
    """

    name: str
    title: str
    letters: Mapping[str, str]
    nuclei: Mapping[str, Nucleus]
    point: Callable[[str], Box]
    frame: Callable[[str], Box]
    atoms: Mapping[str, Callable[..., Box]]
    derivative: Callable[[Any, Term], Written]
    column: Callable[[Any, Term], Written]
    tilde: Callable[[Any, Term], Written]
    domain: Box
    outer: str = "times"
    frames_outside: bool = True
    """Whether the frame of a derivative stands before the whole fraction, or within it."""
    juxtaposed: bool = False
    """Whether a dyadic stands beside its vector without a dot."""
    markup: str = "latex"


ROLES: dict[str, tuple[str, ...]] = {
    "mass": ("who",),
    "force": ("who",),
    "internal_force": ("who", "who"),
    "constraint_force": ("who",),
    "applied_force": ("who",),
    "identity": (),
    "identity_matrix": (),
    "angle": ("letter",),
    "scalar": ("letter",),
    "coordinate": ("letter",),
    "function": ("letter",),
    "vector": ("letter",),
    "fixed_vector": ("letter", ""),
    "dyadic": ("letter",),
    "exhaust_velocity": ("who",),
    "gravity": (),
    "gravity_parameter": (),
    "orbit_radius": (),
    "orbit_direction": (),
    "orbit_position": (),
    "gravity_torque": (),
    "gravity_energy": (),
    "turn_angle": ("index", "", "", ""),
    "free_angle": ("letter",),
    "principal_angle": ("", ""),
    "principal_axis": ("", ""),
    "euler_parameter": ("index", "", ""),
    "euler_vector": ("", ""),
    "rodrigues": ("", ""),
    "modified_rodrigues": ("", ""),
    "shadow_rodrigues": ("", ""),
    "eigenvectors": ("", ""),
    "rotor_axis": ("index",),
    "rotor_speed": ("index",),
    "rotor_inertia": ("index",),
    "rotor_momentum": ("index",),
    "rotor_torque": ("index",),
    "slug_momentum": (),
    "slug_inertia": (),
    "slug_damping": (),
    "total_mass": ("who",),
    "linear_momentum": ("who",),
    "external_force": ("who",),
    "first_moment": ("who", "point"),
    "absolute_angular_momentum": ("who", "point"),
    "angular_momentum": ("who", "point"),
    "torque": ("who", "point"),
    "weight": ("who",),
    "weight_torque": ("who", "point"),
    "weight_energy": ("who", "point"),
    "reaction": ("who",),
    "reaction_torque": ("who", "point"),
    "kinetic_energy": ("who",),
    "rotational_energy": ("who", "point"),
    "inertia": ("point",),
}
"""What the labels of a quantity are to its symbol: an index, a point, its letter, or nothing."""

SILENT = frozenset({"P", "body", "system"})
"""Owners that need no index: there is but one."""


def quantity_box(notation: Notation, name: str, labels: Iterable[str], kind: str) -> Box:
    """Return letter and indices of a quantity; of an element of mass it is a differential."""
    labelled = list(zip(ROLES[name], labels, strict=True))
    if [role for role, _ in labelled] == ["who", "point"] and labelled[0][1] == labelled[1][1]:
        labelled = labelled[:1]  # about its own centre of mass, whose name the body has
    letter = next((n for role, n in labelled if role == "letter"), notation.letters.get(name, name))
    subs = [_index(notation, role, label) for role, label in labelled]
    box = letter_box(notation, letter, kind, subs)
    element = any(role == "who" and label == "dm" for role, label in labelled)
    return Row((Operator("d"), box)) if element else box


def _index(notation: Notation, role: str, label: str) -> Box | None:
    if role == "point":
        return notation.point(label)
    silent = role not in {"who", "index"} or label in {*SILENT, "dm"}
    return None if silent else symbol(label)


def letter_box(
    notation: Notation, letter: str, kind: str, subs: Iterable[Box | None] = (), left: str = ""
) -> Box:
    """Return a letter in the nucleus of its kind with indices; ``left``: a frame to its upper left."""
    letter, _, above = letter.partition("^")
    spelt = symbol(letter) if "_" in letter or letter[-1].isdigit() else Symbol(letter)
    own = spelt.sub if isinstance(spelt, Scripts) else None
    base = spelt.base if isinstance(spelt, Scripts) else spelt
    name = base.name if isinstance(base, Symbol) else letter
    indices = [b for b in subs if b is not None]
    sub = _indices([own, *indices]) if own is None else joined([own, *indices])
    sup = Symbol(above, "roman") if above else None
    before = notation.frame(left) if left else None
    nucleus = notation.nuclei[kind](name)
    if isinstance(nucleus, Fence) and sub is not None:
        return Fence(Scripts(nucleus.inner, sub, sup, before), nucleus.opening)
    return Scripts(nucleus, sub, sup, before) if sub or sup or before else nucleus


def _indices(boxes: Iterable[Box | None]) -> Box | None:
    """Return indices side by side; a comma separates all but plain letters."""
    kept = [b for b in boxes if b is not None]
    plain = all(isinstance(b, Symbol) and len(b.name) == 1 for b in kept)
    return row(*kept) if plain and kept else joined(kept)
