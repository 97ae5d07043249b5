r"""Which letters of a note are vectors and matrices, and what is said of these.

A letter in a vector's dress is three functions of time, one that acts on such from the left nine. Columns
and matrices that are written out give others their sizes. Words, and the note's lexicon, say what is
constant, a rotation, symmetric; a basis of unit vectors that nothing moves is that of the components.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, pairwise, product

from eom.checker.infer.sayings import Prose, said
from eom.checker.mean.elaborator import FUNCTIONS, TRANSPOSED
from eom.checker.mean.lexicon import FREE, MAX_ROWS, TABLED, Entry, Lexicon, Meaning
from eom.checker.read.statements import Formula, Statement
from eom.checker.read.symbol_shape import Look, Seen, labels, named_in, seen
from eom.checker.read.syntax import (
    Addition,
    Call,
    Derivative,
    Group,
    Marks,
    Matrix,
    Node,
    Number,
    Product,
    Quotient,
    Relation,
    Scripts,
    Symbol,
    Words,
    children,
    walk,
)
from eom.checker.read.syntax import Sequence as Items
from eom.checker.read.writing import latex_of
from eom.terms.terms import DYADIC, MATRIX

STYLES = frozenset({"bold", "sans"})
ARROWS = frozenset({"vec", "underline", "harpoon", "underarrow", "undertilde"})
TRANSPOSES = frozenset({"T", "top", "intercal"})
NO_LABELS = TRANSPOSES | {"times", "-", "1", "2", "n", "bullet", "circ"}
VARIABLES = frozenset({"q", "x", "theta", "vartheta", "Theta"})
"""Columns that others are functions of."""
NO_LETTERS = frozenset({"nabla", "partial", "delta", "Delta", "d"})
FRAME = "B"
"""Name of the frame of all components, where the note's notation has none."""
AXES = ("1", "2", "3")
TRIADS = (("x", "y", "z"), ("i", "j", "k"), ("I", "J", "K"))
NAMED = (AXES, ("r", "theta", "phi"), ("rho", "varphi", "z"), ("t", "n", "b"))
"""Right-handed triads of unit vectors e."""

VECTORS, DYADICS, MATRICES = "vector", "dyadic", "matrix"


@dataclass(frozen=True)
class Kind:
    """What a letter is: a vector, a dyadic, a matrix or column with its size."""

    what: str
    rows: int = 3
    columns: int = 1


@dataclass(frozen=True)
class Arrays:
    """Letters that are no scalars: their entries, and by name which are what.

    ``units``: vectors of unit length; ``turns``: rotation matrices; ``symmetric``: matrices;
    ``triads``: of unit vectors that turn, with their axes; ``turning``: whether that of the components
    does; ``still``: what does not change; ``spellings``: LaTeX; ``frame``: that of all components.
    """

    entries: tuple[Entry, ...] = ()
    units: frozenset[str] = frozenset()
    turns: frozenset[str] = frozenset()
    symmetric: frozenset[str] = frozenset()
    triads: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    turning: bool = False
    still: frozenset[str] = frozenset()
    spellings: Mapping[str, str] = field(default_factory=dict)
    frame: str = FRAME

    @property
    def looks(self) -> frozenset[Look]:
        """Their looks."""
        return frozenset(e.look for e in self.entries)

    def has_entry(self, name: str) -> bool:
        """Return whether a letter is an entry of a column or matrix of any size."""
        sized = {e.meaning.labels[0] for e in self.entries if e.meaning.quantity in FREE}
        return name.rpartition("_")[0] in sized

    def stand_in(self, statement: Statement) -> bool:
        """Return whether vectors or matrices stand in a statement."""
        looks = self.looks
        if any(isinstance(n, Matrix) for m in statement.members for n in walk(m)):
            return True
        found = (s for m in statement.members for s in _letters(m))
        return any(s.look in looks or s.with_label() in looks for s in found)


def name_of(look: Look) -> str:
    """Return the name of a letter that is no scalar: that of its look, style and corners."""
    below = "".join(look.presub) + "," if look.presub else ""
    return f"{look.style} {below}{look.text}".strip()


# -- how letters stand in formulas ---------------------------------------------------------------------


@dataclass
class _Shown:
    """Letters of a note by how they stand: next to a cross, on the left of another, transposed, alone."""

    looks: dict[Look, None] = field(default_factory=dict)
    dotted: set[Look] = field(default_factory=set)
    crossed: set[Look] = field(default_factory=set)
    acting: set[Look] = field(default_factory=set)
    transposed: set[Look] = field(default_factory=set)
    inverted: set[Look] = field(default_factory=set)
    alone: set[Look] = field(default_factory=set)
    called: dict[Look, set[tuple[Look, ...]]] = field(default_factory=dict)
    sizes: dict[Look, tuple[int, int]] = field(default_factory=dict)
    marks: frozenset[str] = frozenset()

    def look(self, one: Seen) -> Look:
        """Return the look of a letter; what is raised at vectors is a label, but for powers and marks."""
        above = one.raised[0] if one.raised else None
        if above is None or not dressed(one.look) or not _is_label(above, self.marks):
            return one.look
        return one.with_label() or one.look

    def is_several(self, look: Look) -> bool:
        """Return whether a letter is a function of several things: at each it is another matrix."""
        return len(self.called.get(look, ())) > 1

    def looks_of(self, nodes: Iterable[Node]) -> set[Look]:
        """Return the looks of those that are letters."""
        return {self.look(s) for n in nodes if (s := seen(_bare(n))) is not None}


def _is_label(above: Node, marks: frozenset[str]) -> bool:
    words = _words(above)
    plain = isinstance(above, Group | Marks | Symbol | Quotient | Items | Words | Scripts | Product)
    return plain and not marks.intersection(words)


def _shown(members: Sequence[tuple[Node, ...]], marks: Iterable[str]) -> _Shown:
    found = _Shown(marks=frozenset(marks) | NO_LABELS)
    for chain in members:
        for node in chain:
            for one in _letters(node):
                look = found.look(one)
                found.looks[look] = None
                found.dotted |= {look} if one.dots else set()
                _note_raised(found, one, look)
            for inside in walk(node):
                _note(found, inside)
        _note_sides(found, chain)
    return found


def _letters(node: Node) -> Iterator[Seen]:
    one = None if isinstance(node, Number) else seen(node)
    if one is not None:
        yield one
        return
    inner: Iterable[Node | Seen] = children(node)
    if isinstance(node, Scripts) and TRANSPOSES & set(labels(node.sup)):
        inner = (node.base,)
    if isinstance(node, Product) and not node.operator:
        inner = _with_names(node.factors)
    for inside in inner:
        if isinstance(inside, Seen):
            yield inside
        else:
            yield from _letters(inside)


def _with_names(factors: Sequence[Node]) -> Iterator[Node | Seen]:
    r"""Yield factors, vectors with the points that are named in brackets behind them: \vec V(A/B)."""
    named: tuple[str, ...] = ()
    for one, following in zip(factors, (*factors[1:], None), strict=True):
        if named:
            named = ()
            continue
        given = seen(one)
        if given is not None and dressed(given.look) and isinstance(following, Group):
            named = named_in(following) if following.open == "(" else ()
        yield (
            replace(given, look=replace(given.look, sub=(*given.look.sub, *named)))
            if (named and given is not None)
            else one
        )


def _note_raised(found: _Shown, one: Seen, look: Look) -> None:
    for node in one.raised:
        words = _words(node)
        found.transposed |= {look} if set(words) & TRANSPOSES else set()
        found.inverted |= {look} if words[:2] == ("-", "1") else set()
        found.crossed |= {look} if "times" in words else set()


def _note(found: _Shown, node: Node) -> None:
    if isinstance(node, Call) and node.function in {"det", "tr", "Tr"}:
        found.inverted |= found.looks_of([node.argument])
    if isinstance(node, Derivative) and node.operand is not None:
        found.dotted |= found.looks_of([node.operand])
    if not isinstance(node, Product):
        return
    if node.operator in {"cross", "wedge"}:
        found.crossed |= found.looks_of(map(_last, node.factors))
    elif node.operator == "dot" and len(node.factors) > 2:
        found.acting |= found.looks_of(node.factors[1:-1])
    elif not node.operator:
        _note_factors(found, node.factors)


def _note_factors(found: _Shown, factors: Sequence[Node]) -> None:
    for one, following in pairwise(factors):
        given = seen(one)
        if given is None:
            continue
        if _is_called(following):
            found.called.setdefault(given.look, set()).add(_variables(following))
            continue
        look, nexts = found.look(given), seen(following)
        turned = any(set(_words(n)) & {*TRANSPOSES, "times"} for n in given.raised)
        if nexts is not None and dressed(nexts.look) and dressed(look) and not turned:
            found.acting.add(look)


def _words(node: Node) -> tuple[str, ...]:
    return node.names if isinstance(node, Marks) else labels(node)


def _inside(node: Group) -> list[Seen | None]:
    items = node.body.items if isinstance(node.body, Items) else (node.body,)
    return [seen(i.members[0] if isinstance(i, Relation) else i) for i in items]


def _variables(node: Node) -> tuple[Look, ...]:
    """Return the letters in the brackets behind a function."""
    return tuple(s.look for s in _inside(node) if s is not None) if isinstance(node, Group) else ()


def _is_called(node: Node) -> bool:
    """Return whether brackets hold letters alone, as those of the variables of a function do."""
    if not isinstance(node, Group) or node.open != "(":
        return False
    inside = _inside(node)
    return all(s is not None and (not dressed(s.look) or s.look.name in VARIABLES) for s in inside)


def _bare(node: Node) -> Node:
    while isinstance(node, Group) and node.open in {"", "("} and not isinstance(node.body, Items):
        node = node.body
    return node


def _last(node: Node) -> Node:
    return node.factors[-1] if isinstance(node, Product) and not node.operator else node


def _note_sides(found: _Shown, chain: Sequence[Node]) -> None:
    """Note letters alone on a side, with the size of what stands on another."""
    sizes = [s for s in map(_size, chain) if s is not None]
    for node in chain:
        given = seen(node)
        plain = node.factors if isinstance(node, Product) and len(node.factors) == 2 else ()
        if given is None and plain and _is_called(plain[1]):
            given = seen(plain[0])
        if given is None or given.dots > 0:
            continue
        look = found.look(given)
        if given.raised and look == given.look:
            continue
        if len(chain) > 1 and not _within_triad(look, chain):
            found.alone.add(look)
        if sizes:
            found.sizes.setdefault(look, sizes[0])


def _within_triad(look: Look, chain: Sequence[Node]) -> bool:
    """Return whether a line is about the unit vectors of one triad alone."""
    axis = _axis(look)
    every = [_axis(s.look) for node in chain for s in _letters(node)]
    return axis is not None and all(a is not None and a[0] == axis[0] for a in every)


def _size(node: Node) -> tuple[int, int] | None:
    """Return the size of a matrix, or of a column, that is written out; None for all else."""
    if isinstance(node, Addition):
        return next((s for t in node.terms if (s := _size(t)) is not None), None)
    if isinstance(node, Product):
        last = node.factors[-1]
        return None if node.operator or isinstance(last, Group) else _size(last)
    if isinstance(node, Scripts) and node.sub is None and isinstance(node.sup, Symbol):
        inside = _size(node.base) if node.sup.name in TRANSPOSED else None
        return None if inside is None else inside[::-1]
    if isinstance(node, Group) and node.open in {"(", "["} and isinstance(node.body, Items):
        return (1, len(node.body.items))
    if isinstance(node, Matrix) and node.environment not in {"vmatrix", "Vmatrix"}:
        first = [seen(c) for c in node.rows[0]]
        vectors = all(f is not None and dressed(f.look) for f in first)
        return len(node.rows) * (len(AXES) if vectors else 1), len(node.rows[0])
    return None


# -- kinds ---------------------------------------------------------------------------------------------


def dressed(look: Look) -> bool:
    """Return whether a letter is written as vectors and matrices are."""
    if not look.name.isalpha() or look.name in NO_LETTERS:
        return False
    return look.style in STYLES or bool(ARROWS & set(look.accents))


def _kind(look: Look, shown: _Shown, lexicon: Lexicon, others: set[str]) -> Kind | None:
    """Return what a letter is; None for a scalar."""
    by_name = _numbered(look, others)
    size = shown.sizes.get(look) or by_name
    if size is not None and (1 in size or dressed(look) or look in shown.sizes or by_name):
        return _of_size(look, size, shown, named=by_name is not None)
    matrix = look in shown.acting or look in shown.inverted or look.accents.count("underline") > 1
    matrix = matrix or bool({"double_bar"} & set(look.accents)) or look.style == "sans"
    entry = lexicon.find(look)
    kind = entry.meaning.kind if entry is not None else ""
    if not dressed(look):
        return Kind(VECTORS) if look in shown.crossed and not _is_tabled(entry) else None
    if look in shown.crossed and not matrix:
        return Kind(VECTORS)
    if matrix or kind in {DYADIC, MATRIX}:
        whole = bool({look} & (shown.transposed | shown.inverted)) or kind == MATRIX
        return Kind(MATRICES if whole else DYADICS, 3, 3)
    return Kind(VECTORS)


def _is_tabled(entry: object) -> bool:
    return getattr(getattr(entry, "meaning", None), "quantity", "") in TABLED


def _of_size(look: Look, size: tuple[int, int], shown: _Shown, *, named: bool) -> Kind:
    rows, columns = size
    if rows == 1:
        rows, columns = columns, 1
    if (rows, columns) == (3, 1):
        return Kind(VECTORS)
    if (rows, columns) == (3, 3) and not named:
        whole = look in shown.transposed | shown.inverted
        return Kind(MATRICES if whole else DYADICS, 3, 3)
    return Kind("column" if columns == 1 else "table", rows, columns)


def _numbered(look: Look, others: set[str]) -> tuple[int, int] | None:
    """Return the size of a matrix whose entries are letters of the note: M_11, M_12, M_22."""
    below = look.text + ("" if look.sub else "_")
    n = next((n for n in (3, 2) if f"{below}{n}{n}" in others), 0)
    return (n, n) if n and f"{below}11" in others and f"{below}12" in others else None


def _accented(look: Look, lexicon: Lexicon, looks: Iterable[Look]) -> bool:
    """Return whether an accent makes the skew matrix of another letter of the note."""
    for mark in lexicon.notation.skew:
        if mark in look.accents:
            left = list(look.accents)
            left.remove(mark)
            if replace(look, accents=tuple(left)) in looks:
                return True
    return False


# -- what is said of them ------------------------------------------------------------------------------

_STILL = re.compile(
    r"(?<!not )\b(?:constant|uniform)\b(?! (?:magnitude|length|size|norm|rate|speed))"
    r"|acceleration (?:of|due to) gravity",
    re.IGNORECASE,
)
_TURN = re.compile(
    r"\brotation matri|direction[- ]cosine|\borthogonal\b|attitude matri", re.IGNORECASE
)
_SYMMETRIC = re.compile(r"\binertia\b|\bsymmetric\b", re.IGNORECASE)
_BODY = re.compile(
    r"\bbody(?:[- ]fixed)?[- ](?:axes|frame|coordinates|components|axis)|\b(?:co)?-?rotating (?:frame|axes)"
    r"|\b(?:axes|frame) (?:fixed|that is fixed|attached) (?:in|to) the body|principal axes"
    r"|körperfest|corps",
    re.IGNORECASE,
)


def _of_words(text: Prose, pattern: re.Pattern[str]) -> frozenset[Look]:
    return frozenset(m.look for s in said(text) if pattern.search(s.words) for m in s.of)


def _triads(kinds: Mapping[Look, Kind], shown: _Shown) -> dict[Look, tuple[str, str]]:
    """Return the unit vectors of right-handed triads that are not given by others, with their axes."""
    found = {k: _axis(k) for k, kind in kinds.items() if kind.what == VECTORS}
    known = {k: a for k, a in found.items() if a is not None}
    given = {a[0] for k, a in known.items() if k in shown.alone}
    return {k: a for k, a in known.items() if a[0] not in given}


def _basis(
    triads: Mapping[Look, tuple[str, str]], shown: _Shown, *, moving: bool
) -> tuple[dict[Look, str], bool]:
    """Return the unit vectors of the one triad of a note, with their axes, and whether it turns."""
    one = len({t for t, _ in triads.values()}) == 1
    named = all(k.name in TRIADS[0] or t.endswith("e x") for k, (t, _) in triads.items())
    turning = bool(triads.keys() & shown.dotted) or (moving and not named)
    return ({k: a for k, (_, a) in triads.items()} if one else {}), one and turning


def _axis(look: Look) -> tuple[str, str] | None:
    """Return the triad that a unit vector is of, and its axis."""
    dress = f"{look.style} {' '.join(look.accents)}"
    name, hat = (look.name, "hat" in look.accents) if not look.sub else ("", False)
    if look.name == "e" and len(look.sub) == 1:
        name, dress, hat = look.sub[0], f"{dress} e", True
    for triad in (*TRIADS, *NAMED):
        if name in triad and (hat or triad == TRIADS[1]):
            return f"{dress} {triad[0]}", AXES[triad.index(name)]
    return None


def _is_euler(node: Node, tensor: Look) -> bool:
    r"""Return whether a sum has both J \dot\omega and a cross product with J \omega."""
    if not isinstance(node, Addition):
        return False
    acts = [
        [
            n
            for n in walk(t)
            if isinstance(n, Product)
            and any((s := seen(f)) and s.look == tensor for f in n.factors)
        ]
        for t in node.terms
    ]
    dots = [any((s := seen(f)) and s.dots for p in ps for f in p.factors) for ps in acts]
    cross = [
        any(isinstance(n, Product) and n.operator == "cross" for n in walk(t)) for t in node.terms
    ]
    return any(d and not c for d, c in zip(dots, cross, strict=True)) and any(
        bool(ps) and c for ps, c in zip(acts, cross, strict=True)
    )


def _is_in_space(chain: Sequence[Node], tensor: Look, chains: Sequence[Sequence[Node]]) -> bool:
    r"""Return whether H = J \omega is differentiated in a line without a cross product, as in space."""
    if any(isinstance(n, Product) and n.operator == "cross" for m in chain for n in walk(m)):
        return False
    if any("times" in _words(n) for m in chain for s in _letters(m) for n in s.raised):
        return False
    dotted = {s.look for m in chain for s in _letters(m) if s.dots}
    made = (
        seen(c[0])
        for c in chains
        if any(s.look == tensor for m in c[1:] for s in _letters(m)) and seen(c[0]) is not None
    )
    return any(m is not None and m.look in dotted for m in made)


# -- all together --------------------------------------------------------------------------------------


Reads = Callable[[Statement], bool]


@dataclass(frozen=True)
class Dress:
    """What letters are, from how they stand; what words say of them by pattern."""

    statements: tuple[Statement, ...]
    lexicon: Lexicon
    shown: _Shown
    kinds: Mapping[Look, Kind]
    still: frozenset[Look]
    inertias: frozenset[Look]
    steady: frozenset[Look]
    turns: frozenset[Look]
    triads: Mapping[Look, tuple[str, str]]
    basis: Mapping[Look, str]
    turning: bool

    def settled(self, reads: Callable[[Dress], Reads]) -> Dress:
        """Return the letters with others as columns and matrices where only so a statement can be read."""
        best, known = self, reads(self)
        if not self.kinds:
            return self
        read = {id(s): known(s) for s in self.statements}
        for one in self.statements:
            if read[id(one)] or not best.arrays.stand_in(one):
                continue
            for other in best._others(one):
                tried = reads(other)
                if tried(one) and all(
                    tried(s) for s in self.statements if read[id(s)] and s is not one
                ):
                    best = other
                    read = {id(s): tried(s) for s in self.statements}
                    break
        return best

    def _others(self, one: Statement) -> Iterator[Dress]:
        """Yield other kinds of the letters of a statement, the fewest changes first."""
        n = sorted({n for size in self.shown.sizes.values() for n in size} - {1, len(AXES)})
        looks = {self.shown.look(s) for m in one.members for s in _letters(m)}
        open_ = sorted((k for k in looks if _may_be_other(k, self)), key=lambda k: k.text)
        for count in (1, 2):
            for chosen in combinations(open_[:MAX_OPEN], count):
                for new in product(*(_choices(k, n) for k in chosen)):
                    other = dict(zip(chosen, new, strict=True))
                    if all(self.kinds.get(k) != kind for k, kind in other.items()):
                        yield replace(self, kinds={**self.kinds, **other})

    @property
    def arrays(self) -> Arrays:
        """The letters that are no scalars."""
        kinds, shown = self.kinds, self.shown
        frame = self.lexicon.notation.mixed or FRAME
        entries = [
            _entry(k, kind, frame, self.basis, called=k in shown.called)
            for k, kind in kinds.items()
        ]
        unit = (k for k in shown.looks if k.name == "1" and k.style)
        entries += [Entry(k, Meaning("identity_matrix"), k.text) for k in unit]
        vectors = {k for k, kind in kinds.items() if kind.what == VECTORS}
        given = shown.alone | shown.dotted | self.triads.keys()
        still = set() if self.turning else self.still | (self.steady & kinds.keys())
        return Arrays(
            tuple(entries),
            units=_names(k for k in vectors if "hat" in k.accents and k not in given),
            turns=_names((self.turns & kinds.keys()) - vectors - shown.alone),
            symmetric=_names((self.inertias & kinds.keys()) - vectors),
            turning=self.turning,
            still=_names(still & kinds.keys() - shown.dotted),
            triads={name_of(k): t for k, t in self.triads.items() if k not in self.basis},
            spellings={name_of(k): latex_of(k) for k in kinds},
            frame=frame,
        )


def _steady(
    tensors: Iterable[Look], statements: Iterable[Statement], *, body: bool
) -> frozenset[Look]:
    """Return tensors of inertia by components in axes of the body."""
    chains = [s.members for s in statements]
    wanted = list(tensors)
    sums = [n for c in chains for n in (*c, _zeroed(c)) if n is not None] if wanted else []
    told = {k for k in wanted if body or any(_is_euler(n, k) for n in sums)}
    return frozenset(k for k in told if not any(_is_in_space(c, k, chains) for c in chains))


MAX_OPEN = 5


def _may_be_other(look: Look, dress: Dress) -> bool:
    if not look.name.isalpha() or look in dress.triads or look in dress.shown.sizes:
        return False
    if dress.shown.is_several(look):
        return False
    return not look.accents or dressed(look)


def _choices(look: Look, counts: Iterable[int]) -> tuple[Kind, ...]:
    """Return what a letter may be: with three rows where it is dressed or nothing has others."""
    counts = [n for n in counts if n <= MAX_ROWS]
    others = tuple(k for n in counts for k in (Kind("column", n, 1), Kind("table", n, n)))
    three = (Kind(VECTORS), Kind(DYADICS, 3, 3), Kind(MATRICES, 3, 3))
    return (*three, *others) if dressed(look) or not others else others


def dress_of(formulas: Sequence[Formula], text: Prose, lexicon: Lexicon) -> Dress:
    """Return how the letters of formulas are dressed; ``lexicon``: of the note."""
    statements = tuple(s for f in formulas for s in f.statements if s.relational)
    shown = _shown([s.members for s in statements], lexicon.notation.marks)
    others = {k.text for k in shown.looks if not dressed(k)}
    kinds = {
        k: kind
        for k in shown.looks
        if k.name.isalpha()
        and not shown.is_several(k)
        and not _accented(k, lexicon, shown.looks)
        and (kind := _kind(k, shown, lexicon, others)) is not None
    }
    body = any(_BODY.search(s) for s in text.sentences)
    triads = _triads(kinds, shown)
    basis, turning = _basis(triads, shown, moving=body)
    gravity = {k for k in kinds if k.name == "g" and not body}
    meant = {k: found.meaning.quantity for k in kinds if (found := lexicon.find(k)) is not None}
    inertias = _of_words(text, _SYMMETRIC) | {k for k in kinds if meant.get(k) == "inertia"}
    return Dress(
        statements,
        lexicon,
        shown,
        kinds,
        still=frozenset(_of_words(text, _STILL) | gravity),
        inertias=inertias,
        steady=_steady(inertias & shown.looks.keys(), statements, body=body),
        turns=_of_words(text, _TURN) | {k for k in kinds if meant.get(k) == "rotation"},
        triads=triads,
        basis=basis,
        turning=turning,
    )


def _zeroed(chain: Sequence[Node]) -> Node | None:
    """Return the two sides of an equation as one sum."""
    if len(chain) != 2:
        return None
    terms = [t for n in chain for t in (n.terms if isinstance(n, Addition) else (n,))]
    return Addition(tuple(terms), ("+",) * len(terms))


def _names(looks: Iterable[Look]) -> frozenset[str]:
    return frozenset(map(name_of, looks))


def _entry(look: Look, kind: Kind, frame: str, basis: Mapping[Look, str], *, called: bool) -> Entry:
    name = name_of(look)
    if look in basis:
        meaning = Meaning("unit", ("I", basis[look]))
    elif kind.what == "column":
        meaning = Meaning("column", (name_of(look), str(kind.rows)))
    elif kind.what == "table":
        meaning = Meaning("matrix", (name_of(look), str(kind.rows), str(kind.columns)))
    else:
        quantity = "vector" if kind.what == VECTORS else "dyadic"
        meaning = Meaning(quantity, (name,), frame=frame if kind.what == MATRICES else "")
    return Entry(look, replace(meaning, function=called), look.text)


def kept(lexicon: Lexicon) -> tuple[Entry, ...]:
    """Return the functions of a note's lexicon, such as that which makes skew matrices."""
    return tuple(e for layer in lexicon.layers for e in layer if e.meaning.quantity in FUNCTIONS)
