r"""Letters that formulas introduce as entries: of a column, of a diagonal, beside unit vectors.

``\omega = (p, q, r)^T`` makes ``p`` the first component of a vector that is known, ``I = diag(A, B, C)``
makes ``A`` a moment of inertia, ``I_1 = I_2 = A`` another name of one; tables of an elementary rotation
say whether it turns axes or vectors.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from eom.checker.infer.letters import DISPLAY, FORMULA, Draft
from eom.checker.infer.sayings import look_of
from eom.checker.mean.lexicon import Found, Lexicon
from eom.checker.read.statements import Formula, Statement
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.syntax import (
    Addition,
    Call,
    Group,
    Integral,
    Matrix,
    Node,
    Number,
    Product,
    Scripts,
    Symbol,
)
from eom.checker.read.syntax import Sequence as Items
from eom.checker.read.writing import latex, latex_of
from eom.terms.terms import INDICES, MATRIX, VECTOR

AXES = 3
PRODUCT = "by the integral that defines it"


def listed(statement: Statement, line: int, lexicon: Lexicon, *, shown: bool) -> Iterator[Draft]:
    """Yield what a formula says of letters without a meaning that are its entries.

    ``shown``: whether it is a display, which says less than the text.
    """
    if not statement.relational or {s.name for s in statement.signs} - {"=", ":=", "equiv"}:
        return
    why = DISPLAY if shown else FORMULA
    left, right = statement.members[0], statement.members[-1]
    look = look_of(left) if seen(left) is not None else None
    found = lexicon.find(look) if look is not None and not _dotted(left) else None
    if found is not None:
        for letter, means in (*_entries(found, right), *_beside(found, left, right, lexicon)):
            if _is_new(letter, lexicon):
                yield Draft("symbols", latex_of(letter), means, why, line)
    if not shown:
        yield from _renamed(statement, line, lexicon)


def _entries(found: Found, right: Node) -> Iterator[tuple[Look, str]]:
    """Yield the letters of a column of a vector, or of the diagonal of an inertia, with meanings."""
    means = found.meaning
    if means.formula or means.component:
        return
    words = " ".join((means.quantity, *means.labels))
    if means.quantity == "inertia":
        for k, look in enumerate(_diagonal(right), 1):
            yield look, f"{words} in {means.frame or 'B'} component {k} {k}"
    elif means.kind in {VECTOR, MATRIX} and means.quantity not in {"vector", "unit", "defined"}:
        if means.kind == MATRIX and not means.frame:
            return
        for k, look in enumerate(_column(right), 1):
            yield look, f"{words} in {means.frame or 'B'} component {k}"


def _column(node: Node) -> tuple[Look, ...]:
    """Return the letters of a column or list of three; nothing where one is no mere letter."""
    if isinstance(node, Scripts) and isinstance(node.base, Group) and node.sub is None:
        above = node.sup
        if not isinstance(above, Symbol) or above.name not in {"T", "top", "intercal"}:
            return ()
        node = node.base
    if isinstance(node, Group):
        body = node.body
        cells = body.items if isinstance(body, Items) else ()
        cells = body.factors if isinstance(body, Product) and not body.operator else cells
    elif isinstance(node, Matrix):
        cells = tuple(c for row in node.rows for c in row) if len(node.rows[0]) == 1 else ()
        cells = cells or (node.rows[0] if len(node.rows) == 1 else ())
    else:
        return ()
    return _three(cells)


def _diagonal(node: Node) -> tuple[Look, ...]:
    """Return the letters of a diagonal matrix."""
    if isinstance(node, Call) and node.function == "diag" and isinstance(node.argument, Group):
        body = node.argument.body
        return _three(body.items if isinstance(body, Items) else (), same=True)
    if not isinstance(node, Matrix) or [len(r) for r in node.rows] != [AXES] * AXES:
        return ()
    rest = (c for i, row in enumerate(node.rows) for j, c in enumerate(row) if i != j)
    if not all(isinstance(c, Number) and float(c.text) == 0 for c in rest):
        return ()
    return _three([node.rows[k][k] for k in range(AXES)], same=True)


def _three(cells: Sequence[Node], *, same: bool = False) -> tuple[Look, ...]:
    """Return three letters, different ones unless ``same``; nothing where there are not so many."""
    looks = [look_of(c) for c in cells if seen(c) is not None and not _dotted(c)]
    if len(cells) != AXES or len(looks) != AXES or None in looks:
        return ()
    whole = tuple(k for k in looks if k is not None)
    return whole if same or len(set(whole)) == AXES else ()


def _dotted(node: Node) -> bool:
    found = seen(node)
    return found is None or bool(found.dots)


def _is_new(look: Look, lexicon: Lexicon) -> bool:
    """Return whether a plain letter is to be explained: no index, no meaning that words give."""
    if look.accents or look.style or (look.name in INDICES and not look.sub):
        return False
    found = lexicon.find(look)
    return found is None or not found.entry.where.startswith("draft")


def _beside(found: Found, left: Node, right: Node, lexicon: Lexicon) -> Iterator[tuple[Look, str]]:
    """Yield the letters that stand beside two or three unit vectors of one frame in a sum."""
    if found.meaning.kind != VECTOR or found.meaning.component or found.meaning.formula:
        return
    if not isinstance(right, Addition) or not 1 < len(right.terms) <= AXES:
        return
    rows = []
    for sign, term in zip(right.signs, right.terms, strict=True):
        factors = term.factors if isinstance(term, Product) and not term.operator else ()
        if len(factors) != 2 or sign == "-" or any(map(_dotted, factors)):
            return
        letter, unit = look_of(factors[0]), lexicon.find(look_of(factors[1]) or Look(""))
        if letter is None or unit is None or unit.meaning.quantity != "unit":
            return
        rows.append((letter, unit.meaning.labels, latex(factors[1])))
    frames, axes = {r[1][0] for r in rows}, {r[1][1:] for r in rows}
    if len(frames) == 1 and len(axes) == len(rows):
        yield from ((k, rf"= {latex(left)} \cdot {unit}") for k, _, unit in rows)


def _renamed(statement: Statement, line: int, lexicon: Lexicon) -> Iterator[Draft]:
    """Yield a letter without a meaning that the text sets equal to components that have one."""
    looks = [
        look_of(m) if seen(m) is not None and not _dotted(m) else None for m in statement.members
    ]
    if None in looks or len(looks) < 2:
        return
    first = lexicon.find(looks[0]) if looks[0] is not None else None
    last = looks[-1]
    if first is None or last is None or not first.meaning.component:
        return
    if (
        first.meaning.quantity == "inertia"
        and lexicon.find(last) is None
        and _is_new(last, lexicon)
    ):
        yield Draft("symbols", latex_of(last), first.meaning.words, FORMULA, line)


def redefined(statement: Statement, line: int, lexicon: Lexicon) -> Iterator[Draft]:
    """Yield a product of inertia that an integral without a minus defines: minus an entry of the matrix."""
    if not any(s.name == ":=" for s in statement.signs):
        return
    look = look_of(statement.members[0])
    found = lexicon.find(look) if look is not None else None
    if look is None or found is None or found.meaning.quantity != "inertia":
        return
    other = replace(look, sub=look.sub[::-1])
    right = statement.members[-1]
    plain = len(set(found.meaning.component)) == 2 and lexicon.find(other) is not None
    if plain and not found.entry.where.startswith("draft") and isinstance(right, Integral):
        yield Draft("symbols", latex_of(look), f"= -{latex_of(other)}", PRODUCT, line)


def turns(formulas: Iterable[Formula]) -> Iterator[Draft]:
    r"""Yield elementary rotations by their tables: of axes, ``C_3(\psi)`` with sin above, or of vectors."""
    found: dict[str, list[int]] = {}
    lines: dict[str, int] = {}
    for formula in formulas:
        for statement in formula.statements if formula.relational else ():
            left, right = statement.members[0], statement.members[-1]
            look, axis = _called(left)
            if look is not None and isinstance(right, Matrix):
                base = latex_of(Look(look.name, look.style, look.accents))
                found.setdefault(base, []).append(_way(right, axis))
                lines.setdefault(base, formula.piece.line)
    for base, ways in found.items():
        if sum(ways) and len(ways) > 1:
            name = "turn" if sum(ways) > 0 else "active_turn"
            yield Draft("symbols", f"{base}_{{<k>}}", f"{name} <k>", DISPLAY, lines[base])


def _called(node: Node) -> tuple[Look | None, int]:
    """Return the letter with a number that is written as a function of an angle, and the number."""
    factors = node.factors if isinstance(node, Product) and not node.operator else ()
    if len(factors) != 2 or not isinstance(factors[1], Group):
        return None, 0
    found = seen(factors[0])
    if (
        found is None
        or found.dots
        or found.raised
        or found.look.sub not in {("1",), ("2",), ("3",)}
    ):
        return None, 0
    return found.look, int(found.look.sub[0])


def _way(table: Matrix, axis: int) -> int:
    """Return 1 where a table turns axes about one of them, -1 where it turns vectors, 0 for others."""
    if [len(r) for r in table.rows] != [AXES] * AXES:
        return 0
    row, column = axis % AXES, (axis + 1) % AXES
    one, other = table.rows[row][column], table.rows[column][row]
    signs = [_negative(one), _negative(other)]
    if signs[0] == signs[1] or any(isinstance(c, Number) for c in (one, other)):
        return 0
    return -1 if signs[0] else 1


def _negative(node: Node) -> bool:
    return isinstance(node, Addition) and node.signs[0] == "-"
