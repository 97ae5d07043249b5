"""Drawn trees: what is written reads again as the same tree."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eom.checker.read import syntax as s
from eom.checker.read.grammar import read_formula
from eom.checker.read.syntax import depth, transform, walk
from eom.checker.read.writing import box, latex
from eom.typeset.markup import render
from tests.eom.checker.shape import shape

LETTERS = [*"abcefghijklmnpqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ", "omega", "theta", "rho", "Phi"]
ACCENTS = "vec hat bar tilde dot ddot underline ring check".split()
BRACKETS = [("(", ")"), ("[", "]"), ("|", "|"), ("||", "||"), ("{", "}")]


class Drawn:
    """Draws trees layer by layer: what a layer holds is of a tighter one, or in brackets."""

    def __init__(self, draw, size=12):
        self.draw = draw
        self.left = size
        """Nodes of several parts that may still come; then trees end."""

    def one(self, options):
        return self.draw(st.sampled_from(options))

    def some(self, make, depth, low=2, high=3):
        self.left -= 1
        if self.left < 0:
            return tuple(self.symbol() for _ in range(low))
        return tuple(make(depth) for _ in range(self.draw(st.integers(low, high))))

    def maybe(self, make):
        return make() if self.draw(st.booleans()) else None

    def symbol(self, _=0):
        return s.Symbol(self.one(LETTERS), self.one(["", "", "bold", "calligraphic"]))

    def number(self, _=0):
        return s.Number(self.one(["0", "1", "2", "12", "0.5", "3.25"]))

    def words(self, _=0):
        return s.Words(self.one(["rot", "if ", "constant"]))

    def marks(self, _=0):
        signs = ["bullet", "circ", "times", "prime", "ast"]
        return s.Marks(tuple(self.one(signs) for _ in range(self.draw(st.integers(1, 2)))))

    def accented(self, _=0):
        return (
            s.Accent(self.one(ACCENTS), self.symbol())
            if self.draw(st.booleans())
            else self.symbol()
        )

    def slash(self, _=0):
        return s.Quotient(self.symbol(), self.symbol())

    def scripts(self, depth):
        make = self.one([self.accented, self.accented, self.group])
        sub = self.maybe(
            lambda: self.one([self.symbol, self.number, self.slash, self.words])(depth)
        )
        sup = self.maybe(
            lambda: self.one([self.symbol, self.number, self.marks, self.sum])(depth - 1)
        )
        left = self.maybe(self.symbol)
        base = make(depth)
        return s.Scripts(base, sub, sup, None, left) if sub or sup or left else base

    def group(self, depth):
        if depth <= 0 or self.left < 0:
            return self.symbol()
        return s.Group(self.one([self.sum, self.relation])(depth - 1), *self.one(BRACKETS))

    def matrix(self, depth):
        rows = [self.some(self.sum, depth - 1, 2, 2) for _ in range(self.draw(st.integers(1, 2)))]
        return s.Matrix(tuple(rows))

    def atom(self, depth):
        if depth <= 0 or self.left < 0:
            return self.one([self.symbol, self.number])()
        makers = [
            *[self.symbol, self.number, self.scripts, self.scripts, self.group, self.matrix],
            lambda d: s.Accent(self.one(ACCENTS), self.atom(d - 1)),
            lambda d: s.Fraction(self.sum(d - 1), self.sum(d - 1)),
            lambda d: s.Root(self.sum(d - 1), self.maybe(self.number)),
            lambda d: s.Braced(self.term(d - 1), self.words()),
            lambda d: s.Boxed(self.relation(d - 1)),
        ]
        return self.one(makers)(depth)

    def order(self):
        return s.Number("2")

    def call(self, depth):
        argument = s.Group(self.sum(depth - 1))
        return s.Call(
            self.one(["sin", "cos", "tr", "atan2"]), argument, None, self.maybe(self.order)
        )

    def derivative(self, depth):
        operand, below, order = self.term(depth - 1), (self.accented(),), self.maybe(self.order)
        return s.Derivative(
            operand, below, order, self.maybe(self.symbol), self.one(["d", "partial"])
        )

    def integral(self, depth):
        bounds = self.maybe(self.symbol), self.maybe(self.number)
        return s.Integral(self.sum(depth - 1), (self.accented(),), *bounds)

    def factor(self, depth):
        if depth <= 0 or self.left < 0:
            return self.atom(depth)
        bare = lambda _: s.Call(self.one(["sin", "cos"]), self.symbol())  # noqa: E731
        makers = [self.atom, self.atom, self.call, bare, self.derivative, self.integral]
        return self.one(makers)(depth)

    def big(self, depth):
        return s.BigOperator(self.one(["sum", "prod"]), self.term(depth - 1), self.symbol())

    def run(self, depth):
        return s.Product(self.some(self.factor, depth))

    def tight(self, depth):
        factors = self.some(self.one([self.factor, self.run]), depth)
        return s.Product(factors, self.one(["cross", "tensor", "wedge"]))

    def dot(self, depth):
        return s.Product(self.some(self.one([self.factor, self.run, self.tight]), depth), "dot")

    def summed(self, depth):
        return s.Product((*self.some(self.factor, depth, 1, 2), self.big(depth)))

    def term(self, depth):
        makers = [self.factor, self.run, self.tight, self.dot]
        return self.one(
            [*makers, self.big, self.summed] if depth > 0 and self.left > 0 else makers
        )(depth)

    def sum(self, depth):
        terms = self.some(self.term, depth, 1, 3)
        first, sign = self.one(["", "", "-"]), self.one("+-±")
        if len(terms) == 1 and not first:
            return terms[0]
        return s.Addition(terms, (first, *(sign for _ in terms[1:])))

    def relation(self, depth):
        members = self.sum(depth), self.sum(depth)
        signs = tuple(s.Sign(self.one(list(s.RELATIONS))) for _ in members[1:])
        return s.Relation(members, signs)

    def statement(self, depth):
        items = self.relation(depth), self.relation(depth)
        rest = items[1:]
        made = [
            items[0],
            s.Implication(items, tuple(s.Sign(self.one(list(s.ARROWS))) for _ in rest)),
            s.Sequence(items, tuple(self.one([",", "quad", ";"]) for _ in rest)),
            s.Rows(items),
            s.Cases(tuple((r,) for r in items)),
        ]
        return self.one(made)


@st.composite
def drawn(draw, layer, depth=2):
    return normal(getattr(Drawn(draw), layer)(depth))


def normal(tree):
    """Return the one form of what can be built in two: scripts of scripts, derivatives in brackets."""

    def rule(n):
        if isinstance(n, s.Scripts) and isinstance(n.base, s.Scripts):
            inner = n.base
            if inner.sub is None and inner.sup is None and n.presup is None:
                return s.Scripts(inner.base, n.sub, n.sup, inner.presub, inner.presup)
            if n.sub is None and n.sup is None and inner.presup is None:
                return s.Scripts(inner.base, inner.sub, inner.sup, n.presub, n.presup)
        return n

    return transform(tree, rule)


@given(drawn("statement"))
def test_drawn_trees_are_written_and_read(tree):
    assert shape(read_formula(latex(tree)).tree) == shape(tree)
    assert read_formula(latex(tree)).tree == tree


def test_every_mark_is_written_and_read():
    for mark in s.MARKS:
        tree = s.Accent(mark, s.Symbol("x"))
        assert read_formula(latex(tree)).tree == tree
        assert render(box(tree), "mathml").count("<mo>") == 1


def without_brackets(node):
    def rule(n):
        if isinstance(n, s.Group) and n.open in {"(", ""}:
            return n.body
        return n

    return shape(transform(node, rule))


@given(drawn("term"))
def test_changed_trees_get_the_brackets_that_they_need(tree):
    """A repair may put a sum into a product: it reads again, up to brackets."""
    changed = s.Product((s.Addition((tree, s.Symbol("y")), ("", "+")), s.Symbol("x")), "cross")
    again = read_formula(latex(changed)).tree
    assert isinstance(again, s.Product)
    assert again.operator == "cross"
    assert without_brackets(again) == without_brackets(changed)


@pytest.mark.slow
@given(drawn("sum"))
def test_walking(tree):
    assert transform(tree, lambda n: n) is tree
    assert sum(1 for _ in walk(tree)) >= depth(tree) >= 1
