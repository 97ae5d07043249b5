r"""What a symbol of a note stands for: a quantity with its labels, in words of a lexicon.

``position dm C``, ``angular_velocity <F> <G>``, ``inertia C in B``, ``torque body C in B component 1``,
``force dm per volume``, ``= \dot{\vec r}`` (another formula of the note), ``defined`` (by the note
itself). A word in angle brackets is what stood in that place of the pattern.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from eom.checker.mean.dimensions import dimension
from eom.errors import InputError, unknown_name
from eom.terms.terms import DYADIC, MATRIX, SCALAR, VECTOR
from eom.terms.vocabulary import QUANTITIES

OWN: dict[str, int] = {
    "defined": 0,
    "equals": 0,
    "vectrix": 1,
    "time": 0,
    "skew": 0,
    "system": 1,
    "turn": 1,
    "active_turn": 1,
    "quaternion": 2,
    "quaternion_last": 2,
}
"""Meanings of the checker alone, with their number of labels.

``defined``: by the first equation of the note that has it alone on one side; ``equals``: what a
formula says; ``vectrix``: the column of the unit vectors of a frame; ``skew``: a function, S(a);
``system``: a quantity of the system that the note is about, by its name;
``turn``: a function, the rotation of components that turning the frame about an axis brings,
``active_turn``: its inverse; ``quaternion``, ``quaternion_last``: the column of the Euler parameters of
a frame in another one, the scalar first or last.
"""

MAX_FORMULA = 1000
SLOT = re.compile(r"<([A-Za-z])>")
_KEYWORDS = ("in", "component", "per", "unit")


@dataclass(frozen=True)
class Meaning:
    """A quantity (a row of `QUANTITIES` or `OWN`) with its labels, and how it is taken.

    ``frame``: components in it; ``component``: their numbers; ``density``: for each unit of volume;
    ``formula``: the LaTeX of ``equals``; ``function``: an argument in brackets may follow; ``unit``:
    of what has none of its own.
    """

    quantity: str
    labels: tuple[str, ...] = ()
    frame: str = ""
    component: tuple[str, ...] = ()
    density: bool = False
    formula: str = ""
    function: bool = False
    unit: str = ""

    def filled(self, bound: Mapping[str, str], written: Mapping[str, str] | None = None) -> Meaning:
        """Return the meaning with every slot replaced by what is bound to it.

        ``written``: what stands for it in a formula, where frames and points have the note's labels.
        """
        if not bound:
            return self

        def fill(text: str, names: Mapping[str, str] = bound) -> str:
            return SLOT.sub(lambda m: names.get(m[1], m[0]), text)

        return replace(
            self,
            labels=tuple(map(fill, self.labels)),
            frame=fill(self.frame),
            component=tuple(map(fill, self.component)),
            formula=fill(self.formula, {**bound, **(written or {})}),
        )

    @property
    def slots(self) -> frozenset[str]:
        """Letters of the slots that are used."""
        texts = (*self.labels, self.frame, *self.component, self.formula)
        return frozenset(letter for t in texts for letter in SLOT.findall(t))


_KEYS = {"is": str, "equals": str, "unit": str, "function": bool}


def meaning(value: Any, where: str) -> Meaning:
    """Return the meaning that an entry spells: a text, or a table with ``is`` or ``equals``.

    Raises `InputError` for everything else.

    >>> meaning("inertia C in B", "").frame
    'B'
    """
    if isinstance(value, str):
        return _worded(value, where)
    if not isinstance(value, Mapping):
        raise InputError("not a meaning", where=where, got=value, expected="a text or a table")
    for key, given in value.items():
        if key not in _KEYS:
            raise unknown_name("key", str(key), _KEYS, where)
        if not isinstance(given, _KEYS[key]):
            raise InputError(
                f"{key} is of the wrong type", where=where, got=given, expected=_KEYS[key].__name__
            )
    if ("is" in value) == ("equals" in value):
        raise InputError("a meaning takes one of is and equals", where=where, got=dict(value))
    unit = value.get("unit", "")
    dimension(unit, where)
    found = _worded(value["is"], where) if "is" in value else _formula(value["equals"], where)
    return replace(found, unit=unit or found.unit, function=value.get("function", found.function))


def _formula(text: str, where: str) -> Meaning:
    if not text.strip():
        raise InputError("an empty formula", where=where)
    if len(text) > MAX_FORMULA:
        raise InputError("a formula is too long", where=where, expected=f"at most {MAX_FORMULA}")
    return Meaning("equals", formula=text.strip())


def _worded(text: str, where: str) -> Meaning:
    if text.lstrip().startswith("="):
        return _formula(text.lstrip()[1:], where)
    words = text.split()
    if not words:
        raise InputError("an empty meaning", where=where, expected="such as position dm C")
    parts = _parted(words[1:], where)
    found = Meaning(
        words[0],
        tuple(parts[""]),
        frame=" ".join(parts["in"]),
        component=tuple(parts["component"]),
        density=parts["per"] == ["volume"],
        unit=" ".join(parts["unit"]),
    )
    _check(found, parts, where)
    return found


def _parted(words: list[str], where: str) -> dict[str, list[str]]:
    """Divide words at the keywords."""
    parts: dict[str, list[str]] = {"": [], **{k: [] for k in _KEYWORDS}}
    current = ""
    for word in words:
        if word in _KEYWORDS:
            if parts[word]:
                raise InputError(f"{word} stands twice", where=where, got=" ".join(words))
            current = word
        else:
            parts[current].append(word)
    if parts["per"] not in ([], ["volume"]):
        raise InputError("per what?", where=where, got=" ".join(words), expected="per volume")
    return parts


def _check(found: Meaning, parts: Mapping[str, list[str]], where: str) -> None:
    name = found.quantity
    if name not in QUANTITIES and name not in OWN:
        raise unknown_name("quantity", name, [*QUANTITIES, *OWN], where)
    wanted = QUANTITIES[name].words.count("{") if name in QUANTITIES else OWN[name]
    if len(found.labels) != wanted:
        says = QUANTITIES[name].words if name in QUANTITIES else name
        got = " ".join(found.labels) or "none"
        raise InputError(
            f"wrong number of labels of {name}", where=where, got=got, expected=f"{wanted}: {says}"
        )
    if len(parts["in"]) > 1:
        raise InputError("components are in one frame", where=where, got=" ".join(parts["in"]))
    kind = QUANTITIES[name].kind if name in QUANTITIES else SCALAR
    _check_components(found, kind, where)
    if found.unit:
        dimension(found.unit, where)


def _check_components(found: Meaning, kind: str, where: str) -> None:
    count = {VECTOR: 1, DYADIC: 2}.get(kind, 0)
    bare = kind == MATRIX and len(found.component) == 2
    if found.frame and not count:
        raise InputError(f"{found.quantity} has no components in a frame", where=where, got=kind)
    if found.component and not bare and (len(found.component) != count or not found.frame):
        raise InputError(
            f"wrong components of {found.quantity}",
            where=where,
            got=" ".join(found.component),
            expected=f"in FRAME component and {count} number(s)" if count else "none",
        )
    bad = [c for c in found.component if c not in {"1", "2", "3"} and not SLOT.fullmatch(c)]
    if bad:
        raise InputError("components are 1, 2, 3", where=where, got=bad[0])
