"""Where a long formula breaks: between terms, then between factors, then within brackets.

A piece that fits on a line is left whole. What has no place to break, such as a matrix, stays whole.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from eom.typeset.boxes import (
    Box,
    Fence,
    Form,
    Formula,
    Fraction,
    Grid,
    Operator,
    Row,
    Scripts,
    Symbol,
)
from eom.typeset.expressions import expression_box

Measure = Callable[[Box], int]
"""Returns how long a box is, in letters."""


def chunks(
    boxes: Iterable[Box], limit: int, measure: Measure, *, used: int = 0
) -> list[tuple[Box, ...]]:
    """Return boxes as lines of at most ``limit`` letters; one that is longer is opened if it can be.

    ``used``: how many letters the first line has besides.
    """
    found: list[tuple[Box, ...]] = [()]
    length = used
    for box in _fitted(boxes, limit - used, measure):
        needed = measure(box)
        if found[-1] and length + needed > limit:
            found.append(())
            length = 0
        found[-1] += (box,)
        length += needed
    return found


def _fitted(boxes: Iterable[Box], limit: int, measure: Measure) -> Iterator[Box]:
    for box in boxes:
        parts = (box,) if measure(box) <= limit else opened(box)
        if len(parts) == 1:
            yield from parts
        else:
            yield from _fitted(parts, limit, measure)


def opened(box: Box) -> tuple[Box, ...]:
    """Return the pieces between which a box may break; side by side they are the same formula."""
    if isinstance(box, Formula):
        inside = expression_box(box.value, box.names)
        return (box,) if isinstance(inside, Formula) else opened(inside)
    if isinstance(box, Row):
        return _parts(box)
    if isinstance(box, Fence):
        return _within(box, Operator("close"))
    if isinstance(box, Scripts) and isinstance(box.base, Fence) and not (box.left or box.left_sub):
        parts = _within(box.base, Scripts(Operator("close"), box.sub, box.sup))
        return parts if len(parts) > 1 else (box,)
    if isinstance(box, Fraction):
        return opened(box.beside) if box.beside else _opened_fraction(box)
    return (box,)


def _opened_fraction(box: Fraction) -> tuple[Box, ...]:
    """Return a fraction of what stands before the first bracket above, and then the brackets."""
    above = box.above
    if isinstance(above, Formula):
        above = expression_box(above.value, above.names)
    if len(opened(above)) < 2:
        return (box,)
    before: tuple[Box, ...] = ()
    behind: tuple[Box, ...] = (Fence(above) if _is_sum(above) else above,)
    if isinstance(above, Row) and not _is_sum(above):
        place = next((k for k, item in enumerate(above.items) if _is_fenced(item)), 0)
        before, behind = above.items[:place], above.items[place:]
    while before and isinstance(before[-1], Operator):
        before = before[:-1]
    first, *rest = opened(Row(behind))
    quotient = Fraction(Row(before) if before else Symbol("1"), box.below)
    return (quotient, Row((Operator("times"), first)), *rest)


def _is_fenced(item: Box) -> bool:
    return isinstance(item.base if isinstance(item, Scripts) else item, Fence)


def _is_sum(box: Box) -> bool:
    """Return whether a box is a sum, without brackets."""
    if isinstance(box, Formula):
        box = expression_box(box.value, box.names)
        return not isinstance(box, Formula) and _is_sum(box)
    if not isinstance(box, Row):
        return False
    first = box.items[:1]
    later = (i.items[0] if isinstance(i, Row) and i.items else i for i in box.items[1:])
    return any(i in _SIGNS for i in later) or (len(first) == 1 and _is_sum(first[0]))


_SIGNS = (Operator("plus"), Operator("minus"))


def _parts(box: Row) -> tuple[Box, ...]:
    """Return the items of a row; operators, signs of sums and of integrals stand with what follows."""
    found: list[tuple[Box, ...]] = []
    held: tuple[Box, ...] = ()
    for item in box.items:
        held += (item,)
        if not _leads(item):
            found.append(held)
            held = ()
    if held and found:
        found[-1] += held
    if len(found) != 1:
        return tuple(Row(part, box.gap) for part in found) or (box,)
    (only,) = found
    place = next(k for k, item in enumerate(only) if not _leads(item))
    first, *others = opened(only[place])
    if not others:
        return (box,)
    *middle, last = others
    start = Row((*only[:place], first), box.gap)
    return (start, *middle, Row((last, *only[place + 1 :]), box.gap))


_DIFFERENTIALS = (Operator("d"), Operator("partial"))


def _leads(item: Box) -> bool:
    base = item.base if isinstance(item, Scripts) else item
    if isinstance(base, Fraction):  # d/dt belongs to what it differentiates
        above = base.above.base if isinstance(base.above, Scripts) else base.above
        return above in _DIFFERENTIALS
    return isinstance(base, Operator) and base.name not in {"close", "bullet", "circle"}


def _within(box: Fence, closing: Box) -> tuple[Box, ...]:
    """Return what stands in round brackets, its first and last piece with a bracket."""
    parts = opened(box.inner) if box.opening == "(" and box.closing in {"", ")"} else ()
    if len(parts) < 2:
        return (box,)
    first, *middle, last = parts
    return (Row((Operator("open"), first)), *middle, Row((last, closing)))


# -- heights ---------------------------------------------------------------------------------

_FRACTION, _LIMITS = 0.9, 1.0
"""By how many lines a fraction, and a sum sign with its limits, is higher than a letter."""


def height(box: Box) -> float:
    """Return about how many lines a box is high."""
    return 1.0 + _excess(box)


def _excess(box: Box) -> float:
    if isinstance(box, Formula):
        box = expression_box(box.value, box.names)
    if isinstance(box, Grid):
        return sum(1.1 + max(map(_excess, cells)) for cells in box.rows) - 0.9
    if isinstance(box, Fraction) and box.beside:
        return _excess(box.beside)
    if isinstance(box, Fraction):
        return _FRACTION + max(_excess(box.above), _excess(box.below))
    if isinstance(box, Scripts):
        tall = box.stacked or box.base == Operator("integral")
        return max(_excess(box.base), _LIMITS if tall else 0.0)
    inside = {Row: "items", Form: "parts"}.get(type(box))
    if inside:
        return max(map(_excess, getattr(box, inside)), default=0.0)
    return _excess(box.inner) if isinstance(box, Fence) else 0.0
