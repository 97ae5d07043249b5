r"""What the rules of elaboration share: lexicon, definitions of the note, names of scalars.

From a symbol with accents and scripts to its value, by the lexicon of the note.

Index notation: what stands twice in a term is summed, what stands once runs over the axes of a frame or the
coordinates of a system. An index is a letter below symbols that have no meaning with it, and one with a
number there: ``\epsilon_{ijk}x_jp_k``. So a letter that labels particles stays one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product
from typing import Any

import sympy as sp

from eom import limits
from eom.checker.mean import dimensions
from eom.checker.mean.dimensions import LENGTH, NONE, TIME, Dimension, dimension, of_quantity
from eom.checker.mean.lexicon import AXES, RATES, Found, Lexicon, Meaning
from eom.checker.mean.values import (
    ANY,
    ILL_FORMED,
    UNDECIDED,
    VECTRIX,
    WRONG,
    Refusal,
    Value,
    basis,
    components,
    made,
    overdot,
    rate,
    refuse,
    scalar,
    skew,
    transpose_of,
)
from eom.checker.read.grammar import read_formula
from eom.checker.read.spans import Span
from eom.checker.read.statements import Statement
from eom.checker.read.symbol_shape import Look, Seen, labels, seen
from eom.checker.read.syntax import (
    Addition,
    BigOperator,
    Group,
    Marks,
    Node,
    Product,
    Symbol,
    children,
)
from eom.checker.read.writing import latex_of
from eom.errors import InputError
from eom.terms.terms import (
    DYADIC,
    MATRIX,
    SCALAR,
    VECTOR,
    Term,
    atom,
    der,
    dot,
    expr,
    inner,
    inverse,
    matmul,
)
from eom.terms.terms import replace as rewritten
from eom.terms.vocabulary import position, quantity, unit

MAX_DEPTH = 12
"""How far meanings may refer to other formulas."""

MAX_SIZE = 20_000
"""Most nodes of a term."""

Rule = Callable[["Elaborator", Any], Value]


@dataclass(frozen=True)
class Elaborator:
    """The state of one elaboration; ``scalars`` collects what the symbols of SymPy stand for.

    ``definitions``: what the note itself has defined so far; ``indices``: numbers and labels that
    stand for bound indices; ``rules``: one a kind of node. ``times``: which instants the statement
    names, ``running``: the variable of an integral over time, see `eom.checker.mean.instants`.
    """

    lexicon: Lexicon
    rules: Mapping[type, Rule]
    definitions: Mapping[Look, Value] = field(default_factory=dict)
    indices: Mapping[str, str] = field(default_factory=dict)
    scalars: dict[Any, Term] = field(default_factory=dict)
    times: dict[str, str] = field(default_factory=dict)
    running: str = ""
    depth: int = 0
    sizes: dict[int, tuple[Term, int]] = field(default_factory=dict, repr=False)

    def value(self, node: Node) -> Value:
        """Return the typed value of a node. Raises `Refusal`."""
        limits.check()
        rule = self.rules.get(type(node))
        if rule is None:
            kind = type(node).__name__.lower()
            raise refuse(UNDECIDED, f"no meaning is known for this {kind}", node.span)
        found = rule(self, node)
        if self.size(found.term) > MAX_SIZE:
            raise refuse(UNDECIDED, "this is too large when it is written out", node.span)
        return found if found.span == node.span else replace(found, span=node.span)

    def size(self, term: Term) -> int:
        """Return how many nodes a term has when it is written out; shared parts are measured once."""
        known = self.sizes.get(id(term))
        if known is None:
            known = (term, 1 + sum(self.size(a) for a in term.args))
            self.sizes[id(term)] = known
        return known[1]

    def bound(self, **indices: str) -> Elaborator:
        """Return the elaborator where some indices stand for something else."""
        return replace(self, indices={**self.indices, **indices})

    def resolved(self, frame: str) -> Elaborator:
        """Return the elaborator inside a bracket of components: vectors beside columns are in its frame."""
        notation = self.lexicon.notation
        if notation.mixed in {"", frame}:
            return self
        return replace(self, lexicon=replace(self.lexicon, notation=replace(notation, mixed=frame)))

    def frame(self, node: Node) -> str:
        """Return the frame that a script names. Raises `Refusal` for unknown ones."""
        name = self.lexicon.frame(labels(node))
        if name is None:
            raise refuse(UNDECIDED, "unknown frame", node.span, "".join(labels(node)))
        return name

    def name(self, text: str, term: Term) -> Any:
        """Return the SymPy symbol that stands for a scalar term, named ``text`` where that is free."""
        symbol, count = sp.Symbol(text, real=True), 1
        while self.scalars.get(symbol, term) != term:
            count += 1
            symbol = sp.Symbol(f"{text}'{count}", real=True)
        self.scalars[symbol] = term
        return symbol

    def expression(self, term: Term) -> Any:
        """Return a scalar term as a SymPy expression; parts that are none get names."""
        if term.head == "expr":
            return term.data[0]
        if term.head == "zero":
            return sp.Integer(0)
        if term.head in {"mul", "add"} and all(a.kind == SCALAR for a in term.args):
            join = sp.Mul if term.head == "mul" else sp.Add
            return join(*(self.expression(a) for a in term.args))
        known = next((s for s, t in self.scalars.items() if t == term), None)
        return known or self.name(self._text(term), term)

    def _text(self, term: Term) -> str:
        inside = term.args[0] if term.head == "der" else None
        if inside is not None and inside.kind == SCALAR:
            rest = self.expression(inside)
            return f"{rest}_dot" if rest.is_Symbol else "rate"
        return "_".join(term.data) if term.head == "atom" else "s"


def quotient(e: Elaborator, above: Value, below: Value, span: Span) -> Value:
    """Return a value divided by a scalar."""
    if below.shape != SCALAR:
        raise refuse(ILL_FORMED, "a divisor is a scalar", below.span, below.words)
    divisor = e.expression(below.term)
    if divisor == 0:
        raise refuse(ILL_FORMED, "a division by zero", below.span)
    dimension = dimensions.product(above.dimension, dimensions.power(below.dimension, -1))
    return replace(
        above,
        term=expr(1 / divisor) * above.term,
        dimension=dimension,
        density=above.density - below.density,
        span=span,
    )


def number(value: Any, span: Span) -> Value:
    """Return a pure number."""
    return scalar(expr(value), NONE, span)


PER_VOLUME = LENGTH.power(-3)
MAX_POWER = 12
MAX_EXPONENT = 64
MAX_BITS = 2000
TRANSPOSED = frozenset({"T", "top", "intercal", "t", "mathsf T"})

ALIKE = frozenset(
    {"principal_axis", "euler_vector", "rodrigues", "modified_rodrigues", "shadow_rodrigues"}
)
"""Vectors along the axis of a rotation: their components before and after it are the same."""

FUNCTIONS = frozenset({"skew", "turn", "active_turn"})
"""Meanings that take an argument in brackets."""

QUATERNIONS: dict[str, tuple[str, ...]] = {
    "quaternion": ("0", "1", "2", "3"),
    "quaternion_last": ("1", "2", "3", "0"),
}
"""Columns of the Euler parameters, the scalar first or last."""

_ATOMS = frozenset({"mass", "total_mass", "kinetic_energy", "rotational_energy"})
"""Scalars that stay terms; all others are symbols of SymPy with a meaning."""


def symbol_value(e: Elaborator, node: Node) -> Value:
    """Return the value of a symbol, or of whatever else carries accents and scripts."""
    found = seen(node)
    assert found is not None
    value, rest = _found(e, found, node.span)
    return _dressed(e, value, found.dots, rest, node.span)


def of_meaning(e: Elaborator, found: Found, given: Seen, span: Span) -> Value:
    """Return the value of a meaning that has been found, with dots and what is raised."""
    return _dressed(e, meant(e, found, span), given.dots, given.raised, span)


def _dressed(e: Elaborator, value: Value, dots: int, above: Iterable[Node], span: Span) -> Value:
    """Return a value with dots and what is raised."""
    value = overdot(e.lexicon.notation, value, dots, span) if dots else value
    for node in above:
        value = raised(e, value, node, span)
    return value


def _found(e: Elaborator, given: Seen, span: Span) -> tuple[Value, tuple[Node, ...]]:
    """Return the value of the nucleus, and the raised nodes that act on it."""
    labelled = given.with_label()
    if labelled is not None:
        value = _look(e, labelled, span)
        if value is not None:
            return value, given.raised[1:]
    value = _look(e, given.look, span)
    if value is None:
        value = _accented(e, given.look, span)
    if value is None:
        value = _resolved(e, given.look, span) or _between_points(e, given.look, span)
    if value is None and labelled is not None:
        value = _between_points(e, labelled, span)
        if value is not None:
            return value, given.raised[1:]
    if value is None:
        raise without_meaning(e, labelled or given.look, span)
    return value, given.raised


def _look(e: Elaborator, look: Look, span: Span) -> Value | None:
    found = e.lexicon.find(look, e.indices)
    if found is not None:
        return meant(e, found, span)
    plain = look.numbered(e.indices)
    if e.lexicon.notation.plain(plain) in e.definitions:
        return _recalled(e, e.lexicon.notation.plain(plain), span)
    if look.name == "0" and not any(look.corners):
        return Value(expr(sp.Integer(0)), SCALAR, None, span=span)
    return number(sp.pi, span) if look == Look("pi") else None


def _recalled(e: Elaborator, look: Look, span: Span) -> Value:
    """Return what the note has defined."""
    return replace(_renamed(e, e.definitions[look]), span=span)


def _renamed(e: Elaborator, found: Value) -> Value:
    """Return a value that was found elsewhere with names that its symbols have here."""
    names: dict[Any, Any] = {}

    def renamed(node: Term) -> Term:
        return expr(node.data[0].xreplace(names)) if node.head == "expr" else node

    for symbol, term in found.scalars.items():
        names[symbol] = e.name(str(symbol), rewritten(term, renamed))
    return replace(found, term=rewritten(found.term, renamed), scalars={})


_ALIKE = {"circle": "ring"}
"""Accents that look the same."""


def _accented(e: Elaborator, look: Look, span: Span) -> Value | None:
    """Return the skew matrix of what stands below an accent that makes one, or its derivative."""
    notation = e.lexicon.notation
    for stands in look.accents:
        mark = _ALIKE.get(stands, stands) if stands not in notation.marks else stands
        if mark in notation.skew or mark in notation.marks:
            left = list(look.accents)
            left.remove(stands)
            below = replace(look, accents=tuple(left))
            inside = _look(e, below, span) or _resolved(e, below, span)
            if inside is None or mark in notation.skew:
                return inside and skew(notation, inside, span)
            return marked(e, inside, mark, span)
    return None


def _resolved(e: Elaborator, look: Look, span: Span) -> Value | None:
    """Return components where the last label below is a frame."""
    frame = e.lexicon.frames.get(look.sub[-1:]) if e.lexicon.notation.resolved else None
    if frame is None:
        return None
    inside = _look(e, replace(look, sub=look.sub[:-1]), span)
    if inside is None or inside.shape not in {VECTOR, DYADIC}:
        return None
    return components(inside, frame)


_ARROWS = frozenset({"vec", "underline", "bar", "harpoon"})
"""Accents over the letters of two points."""
_PLACES = frozenset("rR")
"""Letters of vectors that lead to the first of two points from the second, with a stroke between them."""


def _between_points(e: Elaborator, look: Look, span: Span) -> Value | None:
    r"""Return the vector from one point to another: ``\overrightarrow{AB}``, ``\mathbf{r}_{B/A}``.

    What is no arrow is the sign of a vector where the lexicon has one that carries it.
    """
    notation, pair = e.lexicon.notation, look.style != "" and len(look.name) > 1
    words = tuple(look.name) if pair else look.sub or look.sup
    beside = bool(look.accents) and not look.name and not look.sup
    if beside and not _ARROWS.issuperset(look.accents):
        return None
    if look.presub or look.presup or (look.sub and (look.sup or pair)):
        return None
    if not pair and not beside and not (look.name in _PLACES and "/" in words):
        return None
    dressed = replace(Look("", look.style, look.accents))
    if "vec" not in look.accents and not e.lexicon.has_vector(notation.plain(dressed)):
        return None
    found = [(words[:k], words[k:]) for k in range(1, len(words))]
    if not pair and not beside:
        place = words.index("/")
        found = [(words[place + 1 :], words[:place])]
    for start, end in found:
        origin, of = e.lexicon.point(start), e.lexicon.point(end)
        if origin is not None and of is not None:
            term = position(of, origin)
            return Value(term, term.kind, LENGTH, ANY, span=span)
    return None


def without_meaning(e: Elaborator, look: Look, span: Span) -> Exception:
    """Return that a symbol has no meaning, with the entry of a lexicon that would give it one."""
    latex, known = latex_of(look), ", ".join(e.lexicon.known(look.name)[:5])
    wanted = f"a line of the lexicon: '{latex}' = ..."
    if known:
        wanted += f" (which has {known})"
    return refuse(UNDECIDED, "symbol without a meaning", span, latex, wanted)


# -- meanings ------------------------------------------------------------------------------------


def own_look(found: Found, e: Elaborator) -> Look:
    """Return by what a note's definitions know a symbol that the lexicon leaves to it, or any vector."""
    look = found.look.numbered(e.indices)
    if found.meaning.quantity != "vector":
        return look
    return replace(look, accents=(*look.accents, *found.meaning.labels))


def meant(e: Elaborator, found: Found, span: Span) -> Value:
    """Return the value of what the lexicon says."""
    meaning = found.meaning
    look = own_look(found, e)
    tied = e.lexicon.tied.get((meaning.quantity, *meaning.labels, meaning.frame))
    if tied is not None:
        value = replace(_renamed(e, tied), dimension=_dimension(meaning), span=span)
        named = value.shape != SCALAR
        return value if named else replace(value, term=expr(e.name(found.look.text, value.term)))
    if meaning.quantity == "defined" or (meaning.quantity == "vector" and look in e.definitions):
        if look not in e.definitions:
            raise refuse(UNDECIDED, "this is not defined yet", span, found.look.text)
        return _recalled(e, look, span)
    if meaning.quantity == "equals":
        return _formula(e, found, span)
    if meaning.quantity == "vectrix":
        return Value(unit(meaning.labels[0], 1), VECTRIX, NONE, (meaning.labels[0], ""), span=span)
    if meaning.quantity == "time":
        return Value(expr(sp.Symbol("t", real=True)), SCALAR, TIME, span=span)
    if meaning.quantity in QUATERNIONS:
        return quaternion(e, meaning, span)
    if meaning.quantity in FUNCTIONS:
        raise refuse(UNDECIDED, "a function without an argument", span, found.look.text)
    return _quantity(e, found, span)


def quaternion(e: Elaborator, meaning: Meaning, span: Span) -> Value:
    """Return the column of the Euler parameters."""
    cells = [[_parameter(e, k, meaning)] for k in QUATERNIONS[meaning.quantity]]
    return made(cells, Value(cells[0][0], SCALAR, NONE, span=span))


def _parameter(e: Elaborator, k: str, meaning: Meaning) -> Term:
    return expr(e.name(f"q_{k}", quantity("euler_parameter", k, *meaning.labels)))


def _formula(e: Elaborator, found: Found, span: Span) -> Value:
    """Return the value of a formula that a symbol stands for; its places are those of the symbol."""
    if e.depth >= MAX_DEPTH:
        raise refuse(UNDECIDED, "the meanings of these symbols go in circles", span)
    tree = read_formula(found.meaning.formula).tree
    try:
        value = replace(e, depth=e.depth + 1).value(tree)
    except Refusal as refusal:
        raise Refusal(replace(refusal.finding, span=span)) from None
    if value.shape == SCALAR and value.term.head != "expr":
        symbol = e.name(found.look.text, value.term)
        value = replace(value, term=expr(symbol))
    return value


def _dimension(meaning: Meaning) -> Dimension | None:
    own = dimension(meaning.unit) if meaning.unit else of_quantity(meaning.quantity)
    if own is None or not meaning.density:
        return own
    return own.times(PER_VOLUME)


def _term(meaning: Meaning) -> Term:
    """Return the quantity that is meant, one of the vocabulary or of the note's system."""
    if meaning.quantity == "system":
        kind = VECTOR if ":" in meaning.labels[0] else SCALAR
        return atom("system", *meaning.labels, kind=kind)
    if meaning.quantity in RATES:
        of, origin, frame = meaning.labels
        return der(position(of, origin), frame, RATES[meaning.quantity])
    return quantity(meaning.quantity, *meaning.labels)


def _quantity(e: Elaborator, found: Found, span: Span) -> Value:
    meaning = found.meaning
    try:
        term = _term(meaning)
    except InputError as error:
        raise refuse(UNDECIDED, error.what, span, error.got, error.expected) from None
    value = Value(term, term.kind, _dimension(meaning), ANY, int(meaning.density), span)
    if meaning.component:
        value = replace(value, term=_component(term, meaning), shape=SCALAR)
    elif meaning.frame:
        value = components(value, meaning.frame)
        if meaning.quantity in ALIKE and meaning.frame in meaning.labels:
            value = replace(value, frames=ANY)
    if value.shape == MATRIX and meaning.quantity in {"rotation", "eigenvectors"}:
        value = replace(value, frames=(meaning.labels[0], meaning.labels[1]))
    if value.shape == SCALAR and meaning.quantity not in _ATOMS:
        name = found.look.numbered(e.indices).text
        value = replace(value, term=expr(e.name(name, value.term)))
    return value


def _component(term: Term, meaning: Meaning) -> Term:
    if term.kind == MATRIX:
        row, place = (basis(int(c)) for c in meaning.component)
        return inner(row, matmul(term, place))
    axes = [unit(meaning.frame, int(c)) for c in meaning.component]
    if term.kind == VECTOR:
        return dot(axes[0], term)
    return dot(axes[0], dot(term, axes[1]))


# -- what is raised ------------------------------------------------------------------------------


def raised(e: Elaborator, value: Value, above: Node, span: Span) -> Value:
    """Apply what stands above a symbol or bracket: a transpose, an inverse, a power, marks."""
    if isinstance(above, Group) and above.open == "":
        return raised(e, value, above.body, span)
    if isinstance(above, Marks):
        for mark in above.names:
            value = marked(e, value, mark, span)
        return value
    if isinstance(above, Symbol) and above.name in TRANSPOSED:
        return transpose_of(e.lexicon.notation, value, span)
    if isinstance(above, Addition) and labels(above) in {("-", "T"), ("-", "top")}:
        return transpose_of(e.lexicon.notation, inverted(e, value, span), span)
    if isinstance(above, Product) and all(isinstance(f, Marks | Symbol) for f in above.factors):
        for factor in above.factors:
            value = raised(e, value, factor, span)
        return value
    exponent = _exponent(above)
    if exponent is None:
        got = "".join(labels(above))
        raise refuse(UNDECIDED, "what is raised here has no meaning", span, got)
    return powered(e, value, exponent, span)


def marked(e: Elaborator, value: Value, mark: str, span: Span) -> Value:
    """Apply a raised mark: a derivative, or a cross."""
    frame = e.lexicon.notation.marks.get(mark)
    if mark == "times":
        return skew(e.lexicon.notation, value, span)
    if frame is None:
        raise refuse(UNDECIDED, "this mark has no meaning", span, mark, "an entry in [marks]")
    return rate(value, frame, 1, span)


def _exponent(above: Node) -> Fraction | None:
    text = "".join(labels(above)).replace("−", "-")
    try:
        return Fraction(text)
    except (ValueError, ZeroDivisionError):
        return None


def powered(e: Elaborator, value: Value, exponent: Fraction, span: Span) -> Value:
    """Return a power: of a scalar, a square of a vector, an inverse or power of a matrix."""
    if abs(exponent) > MAX_POWER or exponent.denominator > MAX_POWER:
        raise refuse(UNDECIDED, "an exponent is too large", span, str(exponent))
    if value.shape == SCALAR:
        if not _small(e.expression(value.term), exponent):
            raise refuse(UNDECIDED, "a power is too large", span)
        power = sp.Pow(
            e.expression(value.term), sp.Rational(exponent.numerator, exponent.denominator)
        )
        raised_to = dimensions.power(value.dimension, exponent)
        if value.density and exponent != 1:
            raise refuse(UNDECIDED, "a power of a density", span)
        return replace(value, term=expr(power), dimension=raised_to, span=span)
    if exponent == -1:
        return inverted(e, value, span)
    if value.shape == VECTOR and exponent == 2:
        squared = dimensions.power(value.dimension, 2)
        return Value(dot(value.term, value.term), SCALAR, squared, span=span)
    if value.shape in {MATRIX, DYADIC} and exponent in {2, 3, 4}:
        return _matrix_power(value, int(exponent), span)
    raise refuse(ILL_FORMED, "this has no such power", span, value.words)


def _small(base: Any, exponent: Fraction) -> bool:
    """Return whether a power has small exponents and no long numbers."""
    inside = [abs(p.exp) for p in sp.preorder_traversal(base) if p.is_Pow and p.exp.is_Rational]
    bits = [max(abs(n.p), n.q).bit_length() for n in base.atoms(sp.Rational)]
    largest = max([*inside, sp.Integer(1)]) * abs(exponent)
    return bool(largest <= MAX_EXPONENT) and max([*bits, 1]) * abs(exponent) <= MAX_BITS


def _matrix_power(value: Value, exponent: int, span: Span) -> Value:
    if value.frames[0] != value.frames[1]:
        raise refuse(ILL_FORMED, "a power of a matrix between two frames", span, value.words)
    term = value.term
    for _ in range(exponent - 1):
        term = term @ value.term if value.shape == MATRIX else dot(term, value.term)
    return replace(
        value, term=term, dimension=dimensions.power(value.dimension, exponent), span=span
    )


def inverted(e: Elaborator, value: Value, span: Span) -> Value:
    """Return the inverse of a matrix; of a scalar, one over it."""
    if value.shape == SCALAR:
        return powered(e, value, Fraction(-1), span)
    if value.shape != MATRIX:
        verdict = UNDECIDED if value.shape == DYADIC else ILL_FORMED
        raise refuse(verdict, "this has no inverse here", span, value.words)
    frames = (value.frames[1], value.frames[0])
    below = dimensions.power(value.dimension, -1)
    return replace(value, term=inverse(value.term), frames=frames, dimension=below, span=span)


def pure(value: Value, span: Span) -> None:
    """Require a scalar without dimension, as in a sine."""
    if value.shape != SCALAR:
        raise refuse(ILL_FORMED, "the argument of a function is a scalar", span, value.words)
    if value.dimension not in {None, NONE}:
        got = value.dimension.words if value.dimension is not None else ""
        raise refuse(WRONG, "the argument of a function has a dimension", span, got, "1")


# -- index notation ------------------------------------------------------------------------------

LETTERS = frozenset("ijklmn")
Known = Callable[[Look, Mapping[str, str]], bool]
"""Whether a symbol has a meaning where indices stand for numbers."""
COUNTS = tuple(map(str, range(1, 13)))
AXIAL = 3
"""How many numbers an index takes where no symbol limits it."""
MAX_DUMMIES, MAX_FREE = 4, 4
UNIT = ("delta", 2)
ALTERNATING = (("epsilon", 3), ("varepsilon", 3), ("e", 3))


def numbered(look: Look, indices: Mapping[str, str]) -> Any:
    """Return the number that Kronecker's or Levi-Civita's symbol is; None for anything else."""
    given = [indices.get(w, w) for w in look.sub]
    shape = (look.name, len(given))
    axes = given if shape == UNIT and all(map(str.isdigit, given)) else [AXES.get(g) for g in given]
    if None in axes or look.accents or look.sup or shape not in {UNIT, *ALTERNATING}:
        return None
    values = [int(a) for a in axes if a is not None]
    return sp.KroneckerDelta(*values) if shape == UNIT else sp.LeviCivita(*values)


def indexed(node: Node, known: Known) -> Iterator[tuple[Look, tuple[str, ...]]]:
    """Yield the symbols of a formula that have a meaning with numbers for indices below, and these."""
    found = seen(node)
    if found is not None:
        look = found.look
        letters = tuple(w for w in look.sub if w in LETTERS)
        if letters and not known(look, {}) and known(look, dict.fromkeys(letters, "1")):
            yield look, letters
    else:
        for part in children(node):
            yield from indexed(part, known)


def letters_of(node: Node, known: Known) -> Iterator[str]:
    """Yield the indices of a term as often as they stand there, of a sum those of its terms once."""
    if isinstance(node, Addition):
        yield from frozenset[str]().union(*(once(t, known) for t in node.terms))
    elif seen(node) is not None:
        yield from (w for _, letters in indexed(node, known) for w in letters)
    else:
        for part in children(node):
            yield from letters_of(part, known)


def numberings(
    letters: Iterable[str], trees: Iterable[Node], known: Known
) -> Iterator[dict[str, str]]:
    """Yield all numbers for letters with which every symbol that has them below has a meaning."""
    letters = tuple(letters)
    looks = [found for tree in trees for found in indexed(tree, known)]

    def runs(letter: str, number: str) -> bool:
        own = [(look, words) for look, words in looks if letter in words]
        return all(
            known(look, {**dict.fromkeys(words, "1"), letter: number}) for look, words in own
        )

    found = [[n for n in COUNTS if runs(letter, n)] for letter in letters]
    ranges = [numbers if len(numbers) < len(COUNTS) else COUNTS[:AXIAL] for numbers in found]
    yield from (dict(zip(letters, numbers, strict=True)) for numbers in product(*ranges))


def is_known(e: Elaborator, look: Look) -> bool:
    """Return whether a symbol has a meaning, or is defined."""
    return e.lexicon.find(look, e.indices) is not None or look.numbered(e.indices) in e.definitions


def knows(e: Elaborator) -> Known:
    """Return what tells whether a symbol has a meaning, with more indices given."""

    def known(look: Look, more: Mapping[str, str]) -> bool:
        indices = {**e.indices, **more}
        return numbered(look, indices) is not None or is_known(replace(e, indices=indices), look)

    return known


def summed(node: Node, e: Elaborator) -> Iterator[dict[str, str]]:
    """Yield the values of letters that stand twice in a term, one summand each; nothing for no sum."""
    if isinstance(node, Addition | BigOperator):
        return
    known = knows(e)
    counts = Counter(w for w in letters_of(node, known) if w not in e.indices)
    twice = sorted(w for w, n in counts.items() if n == 2)
    if 0 < len(twice) <= MAX_DUMMIES:
        yield from numberings(twice, (node,), known)


def free(statement: Statement, e: Elaborator) -> tuple[dict[str, str], ...]:
    """Return all values of the letters that stand once in each term of a statement; none for no such."""
    known = knows(e)
    shared = frozenset[str]().union(*(once(m, known) for m in statement.members))
    if not 0 < len(shared) <= MAX_FREE:
        return ()
    return tuple(numberings(sorted(shared), statement.members, known))


def once(node: Node, known: Known) -> frozenset[str]:
    """Return the letters that stand once in a term, or in the terms of a sum."""
    return frozenset(w for w, n in Counter(letters_of(node, known)).items() if n == 1)
