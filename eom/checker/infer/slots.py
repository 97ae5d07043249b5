r"""Frames and points of which no words speak: by the places in which their labels stand.

``{}^{A}\vec\omega^{D}`` has frames on both sides, ``{}^{A}\vec v^{Q}`` a frame and a point,
``\vec r_{P/Q}`` two points; ``X^*`` is the mass centre of ``X`` by custom.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator, Mapping

from eom.checker.infer.letters import PLACED, Draft
from eom.checker.infer.phrases import spelt
from eom.checker.infer.places import as_label
from eom.checker.infer.sayings import look_of
from eom.checker.mean.lexicon import Lexicon
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import Formula
from eom.checker.read.symbol_shape import Labels, Look
from eom.checker.read.syntax import Derivative, Node, walk

_TURNING = frozenset({"omega", "Omega", "alpha"})
_MOVING = frozenset({"v", "V", "a"})
_PLACES = frozenset({"r", "R", "p", "rho", "s", "d"})
_TABLES = frozenset({"I", "J", "H", "h", "L"})
_LABEL = re.compile(r"(?:cal )?[A-T](?:\^ast)?")
"""Labels that name something: no letters of any point, no points of a frame that others pass."""
_FRAMES = ("A", "C", "D", "E", "B")
_INSIDE = ("OA", "OB", "O")
_POINTS = ("O", "P", "OA", "OB")
"""Names of the house in the order in which they are given."""


def guessed_labels(drafts: Iterable[Draft]) -> frozenset[str]:
    """Return the labels of frames and points that only the places where they stand suggest."""
    names = (d.latex for d in drafts if d.table in {"frames", "points"} and d.words == PLACED)
    looks = (look_of(read_formula(n).tree) for n in names)
    return frozenset(as_label(k)[0] for k in looks if k is not None)


def labels_of(formula: Formula) -> frozenset[str]:
    """Return the labels of the symbols and derivatives in a formula."""
    nodes = [n for s in formula.statements for m in s.members for n in walk(m)]
    looks = [k for n in nodes if (k := look_of(n)) is not None]
    return frozenset(w for k in looks for corner in k.corners for w in corner)


def by_places(lexicon: Lexicon, looks: Iterable[Look], nodes: Iterable[Node]) -> Iterator[Draft]:
    """Yield frames and points that labels name by where they stand, where nothing else does."""
    looks = tuple(looks)
    seers = {as_label(k)[0] for n in nodes if (k := _observer(n)) is not None}
    frames = dict.fromkeys(w for k in looks for w in _frames(k))
    points = dict.fromkeys(w for k in looks for w in (*_welded(k), *_points(k, lexicon)))
    welded = {w for k in looks for w in _welded(k)}
    known = {k: n for k, n in lexicon.points.items() if n != "P" or k[0] not in welded}
    frames |= dict.fromkeys(sorted(seers))
    turning = {w for k in looks if k.name in _TURNING for w in (*k.sup, *k.sub[:1])}
    still = [w for w in frames if w not in turning and _LABEL.fullmatch(w)]
    named = lexicon.frames
    if len(still) == 1 and all(named.get((w,)) != "I" for w in frames):
        named = {k: n for k, n in named.items() if k != (still[0],)}
    yield from _named("frames", frames, named, lambda w: _frame(w, turning), _FRAMES)
    inside = [w for w in points if w in welded]
    outside = [w for w in points if w not in welded]
    first = [*_named("points", inside, known, lambda w: _point(w, welded), _INSIDE)]
    yield from first
    taken = {spelt((w,)): (w,) for w in inside}
    known = known | {taken[d.latex]: d.meaning for d in first}
    yield from _named("points", (*inside, *outside), known, lambda w: _point(w, welded), _POINTS)


def _observer(node: Node) -> Look | None:
    """Return the look of the frame in which a derivative is seen."""
    frame = node.frame if isinstance(node, Derivative) else None
    return look_of(frame) if frame is not None else None


def _frames(look: Look) -> Iterator[str]:
    """Yield labels of a symbol that stand where frames do."""
    marked = bool(look.accents or look.style)
    if not marked or look.name not in _TURNING | _MOVING | _TABLES:
        return
    yield from look.presup[:1]
    if look.name in _TURNING:
        yield from (w for corner in (look.sup, look.sub) if len(corner) in {1, 3} for w in corner)


def _points(look: Look, lexicon: Lexicon) -> Iterator[str]:
    """Yield labels of a symbol that stand where points do; one alone may be the frame of components."""
    marked = bool(look.accents or look.style)
    for corner in (look.sub, look.sup) if marked else ():
        alone = len(corner) == 1 and corner not in lexicon.frames
        if look.name in _PLACES | _MOVING and (alone or len(corner) == 3):
            yield from corner


def _welded(look: Look) -> Iterator[str]:
    """Yield labels of points about which a body has inertia: they are fixed in it."""
    table = look.name in _TABLES and bool(look.accents or look.style)
    yield from (c[2] for c in (look.sub, look.sup) if table and len(c) == 3 and c[1] == "/")


def _frame(label: str, turning: Container[str]) -> str:
    """Return what a frame is called by custom: the inertial one where nothing turns with it."""
    return label.removeprefix("cal ") if label in turning else "I"


def _point(label: str, welded: Container[str]) -> str:
    """Return what a point is called by custom."""
    if label.endswith("^ast"):
        return "C"
    return "OA" if label in welded else label


def _named(
    table: str,
    labels: Iterable[str],
    known: Mapping[Labels, str],
    usual: Callable[[str], str],
    names: tuple[str, ...],
) -> Iterator[Draft]:
    """Yield names for labels that have none: the usual one if it is free, else the next."""
    labels = [w for w in labels if _LABEL.fullmatch(w)]
    taken = {known[(w,)] for w in labels if (w,) in known}
    for label in (w for w in labels if (w,) not in known):
        free = [n for n in (usual(label), *names) if n in {*names, "C", "I"} and n not in taken]
        if free:
            taken.add(free[0])
            yield Draft(table, spelt((label,)), free[0], PLACED, 0)
