r"""Known slips of the pen and of scans, each as a small edit that undoes it.

A row of `SLIPS` looks at one node and offers what may have been meant instead. ``weight``: the larger,
the less plausible; an offer may add to it. Rules are blind to meaning: an edit that gives no value, or
a false line, is dropped by those who apply them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace

from eom.checker.read.paths import Path, places, put, tidy
from eom.checker.read.syntax import Node
from eom.checker.repair import slips_letters as letters
from eom.checker.repair import slips_marks as marks
from eom.checker.repair import slips_terms as terms
from eom.checker.repair.offers import Offer, Palette

Rule = Callable[[Node, Palette], Iterable[Offer]]


@dataclass(frozen=True)
class Slip:
    """A row: name, what was done in words, weight, rule; ``uniform``: often done all over a line."""

    name: str
    words: str
    weight: float
    rule: Rule
    uniform: bool = False


@dataclass(frozen=True)
class Edit:
    """A slip undone at some places of a tree: the new tree, what stood there and what stands now."""

    slip: Slip
    weight: float
    tree: Node
    old: Node
    new: Node
    paths: tuple[Path, ...] = field(default=())


# -- the table -------------------------------------------------------------------------------------

SLIPS: tuple[Slip, ...] = (
    Slip("lost dot", "a dot was lost", 1.0, marks.more_dots, uniform=True),
    Slip("superfluous dot", "a dot is too much", 1.0, marks.fewer_dots, uniform=True),
    Slip("lost tilde", "a tilde or cross was lost", 1.0, marks.more_skew, uniform=True),
    Slip("superfluous tilde", "a tilde or cross is too much", 1.1, marks.fewer_skew, uniform=True),
    Slip("transpose", "a transpose was lost or is too much", 1.0, marks.transpose, uniform=True),
    Slip("sign", "a sign", 1.0, terms.signs),
    Slip("sine or cosine", "sine and cosine exchanged", 1.0, terms.functions, uniform=True),
    Slip("index", "another label: index, point or frame", 1.05, letters.labels, uniform=True),
    Slip("factor", "a number as a factor was lost", 1.1, terms.missing_number),
    Slip("number", "another number", 1.1, terms.other_number),
    Slip("exponent", "another exponent", 1.15, terms.exponent, uniform=True),
    Slip("frame of the derivative", "the frame of a derivative", 1.05, marks.frame_of_derivative),
    Slip("mark of the derivative", "the mark of a derivative", 1.1, marks.other_mark, uniform=True),
    Slip("order", "factors in another order", 1.1, terms.order),
    Slip("operator", "another product", 1.2, terms.operator),
    Slip("superfluous term", "a term is too much", 1.6, terms.superfluous_term),
    Slip("superfluous factor", "a factor is too much", 1.4, terms.superfluous_factor),
    Slip("lost factor", "a factor was lost", 1.4, terms.missing_factor),
    Slip("lost cross product", "omega times was lost", 1.4, terms.missing_cross),
    Slip("lost vector", "a vector with its product was lost", 1.5, terms.missing_vector),
    Slip("lost derivative", "a derivative was lost", 1.4, marks.derived),
    Slip("raised dot", "a dot on the line that was raised", 1.5, marks.raised_dot),
    Slip("upside down", "a fraction upside down", 1.3, terms.upside_down),
    Slip("symbol", "another symbol", 1.6, letters.letters, uniform=True),
)
"""Every slip, with its weight."""

TERM = Slip("sign", "a sign", 1.0, lambda _, __: ())
DROPPED = Slip("superfluous term", "a term is too much", 1.6, lambda _, __: ())
LOST = Slip("lost term", "a term was lost", 1.5, lambda _, __: ())
"""Slips of a whole term of a line."""

MANY = frozenset({"lost factor", "lost vector", "symbol"})
"""Slips that offer something for every symbol of the note."""
ALL_OVER = 0.35
"""What the same slip weighs at each place beyond the first."""
MAX_EDITS = 1200
"""Edits of one term that are tried at most."""


def _everywhere_tried(_: Path) -> bool:
    return False


def edits(
    node: Node, palette: Palette, spared: Callable[[Path], bool] = _everywhere_tried
) -> list[Edit]:
    """Return the slips undone in a tree, one each, and those of one kind at all equal places.

    ``spared``: tells at which places nothing need be tried.
    """
    found: dict[Node, Edit] = {}
    for edit in _single(node, palette, spared):
        _keep(found, edit, node)
        if len(found) >= MAX_EDITS:
            return _sorted(found)
    for edit in _everywhere(node, list(found.values()), spared):
        _keep(found, edit, node)
    return _sorted(found)


def _single(node: Node, palette: Palette, spared: Callable[[Path], bool]) -> Iterator[Edit]:
    """Yield edits of one place each; the slips that offer much come last, at all places."""
    here_and_below = [(p, n) for p, n in places(node) if not spared(p)]
    for many in (False, True):
        chosen = [s for s in SLIPS if (s.name in MANY) == many]
        for path, here in here_and_below:
            for slip in chosen:
                for new, extra in slip.rule(here, palette):
                    tree = put(node, path, new)
                    yield Edit(slip, slip.weight + extra, tree, here, tidy(new), (path,))


def _sorted(found: dict[Node, Edit]) -> list[Edit]:
    return sorted(found.values(), key=lambda e: e.weight)


def _keep(found: dict[Node, Edit], edit: Edit, before: Node) -> None:
    known = found.get(edit.tree)
    if edit.tree != before and (known is None or edit.weight < known.weight):
        found[edit.tree] = edit


def _everywhere(node: Node, single: list[Edit], spared: Callable[[Path], bool]) -> Iterator[Edit]:
    """Yield what was done at one place done at all places where the same stands."""
    done: set[tuple[str, Node, Node]] = set()
    standing: dict[Node, list[Path]] = {}
    for path, here in places(node):
        if not spared(path):
            standing.setdefault(here, []).append(path)
    for edit in single:
        paths = standing.get(edit.old, [])
        key = (edit.slip.name, edit.old, edit.new)
        if not edit.slip.uniform or len(paths) < 2 or key in done:
            continue
        done.add(key)
        tree = node
        for path in paths:
            tree = put(tree, path, edit.new)
        weight = edit.weight + ALL_OVER * (len(paths) - 1)
        yield replace(edit, tree=tree, weight=weight, paths=tuple(paths))
