"""Drawn trees: what is written reads again as the same tree."""

from hypothesis import given
from hypothesis import strategies as st

from eom.check import syntax as s
from eom.check.grammar import read_formula
from eom.check.trees import depth, transform, walk
from eom.check.writing import latex
from tests.eom.check.shape import shape

LETTERS = [*"abcefghijklmnpqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ", "omega", "theta", "rho", "Phi"]
symbols = st.builds(
    s.Symbol, st.sampled_from(LETTERS), st.sampled_from(["", "", "bold", "calligraphic"])
)
numbers = st.builds(s.Number, st.sampled_from(["0", "1", "2", "12", "0.5", "3.25"]))
words = st.builds(s.Words, st.sampled_from(["rot", "if ", "constant"]))
accents = st.sampled_from("vec hat bar tilde dot ddot underline ring check".split())
marks = st.builds(
    s.Marks,
    st.lists(
        st.sampled_from(["bullet", "circ", "times", "prime", "ast"]), min_size=1, max_size=2
    ).map(tuple),
)


def tuples(strategy, low=2, high=3):
    return st.lists(strategy, min_size=low, max_size=high).map(tuple)


def is_d(node):
    return isinstance(node, s.Symbol) and node.name == "d"


def trees():
    """Strategies by layer: atoms, factors, products, sums, relations; each holds those before."""
    atoms = symbols | numbers
    for _ in range(3):
        atoms = _more_atoms(atoms, *_layers(atoms))
    return _layers(atoms)


def _scripts(atoms, sums):
    sub = st.none() | symbols | numbers | st.builds(s.Quotient, symbols, symbols) | words
    sup = st.none() | symbols | numbers | marks | sums
    left = st.none() | symbols
    base = st.builds(s.Accent, accents, symbols) | symbols | st.builds(s.Group, sums)
    made = st.builds(s.Scripts, base, sub, sup, st.none(), left)
    return made.map(lambda n: n if any([n.sub, n.sup, n.presup]) else n.base)


def _more_atoms(atoms, factors, terms, sums, relations):
    brackets = st.sampled_from([("(", ")"), ("[", "]"), ("|", "|"), ("||", "||"), ("{", "}")])
    return st.one_of(
        atoms,
        st.builds(s.Accent, accents, atoms),
        _scripts(atoms, sums),
        st.builds(lambda body, b: s.Group(body, *b), sums | relations, brackets),
        st.builds(s.Fraction, sums, sums),
        st.builds(s.Root, sums, st.none() | numbers),
        st.builds(s.Matrix, st.lists(tuples(sums, 2, 2), min_size=1, max_size=2).map(tuple)),
        st.builds(s.Braced, terms, words),
        st.builds(s.Boxed, relations),
    )


def _layers(atoms):
    variables = symbols | st.builds(s.Accent, accents, symbols)
    orders = st.none() | st.just(s.Number("2"))
    group = st.builds(s.Group, atoms)
    factors = st.one_of(
        atoms,
        atoms,
        st.builds(s.Call, st.sampled_from(["sin", "cos", "tr", "atan2"]), group, st.none(), orders),
        st.builds(s.Call, st.sampled_from(["sin", "cos"]), symbols),
        st.builds(
            s.Derivative,
            atoms,
            tuples(variables, 1, 1),
            orders,
            st.none() | symbols,
            st.sampled_from(["d", "partial"]),
        ),
        st.builds(
            s.Integral, atoms, tuples(variables, 1, 1), st.none() | symbols, st.none() | symbols
        ),
    )
    last = factors | st.builds(
        s.BigOperator, st.sampled_from(["sum", "prod"]), atoms, symbols, st.none() | symbols
    )
    runs = factors | st.builds(lambda a, b: s.Product((*a, b)), tuples(factors, 1, 2), last)
    closed = factors | st.builds(s.Product, tuples(factors))
    tight = closed | st.builds(
        s.Product, tuples(closed), st.sampled_from(["cross", "tensor", "wedge"])
    )
    loose = runs | tight | st.builds(s.Product, tuples(tight), st.just("dot"))
    sums = loose | st.builds(
        _addition, tuples(loose), st.sampled_from(["", "-"]), st.sampled_from("+-±")
    )
    signs = st.builds(s.Sign, st.sampled_from(list(s.RELATIONS)))
    relations = st.builds(lambda a, x, b: s.Relation((a, b), (x,)), sums, signs, sums)
    return factors, loose, sums, relations


def _addition(terms, first, sign):
    return s.Addition(terms, (first, *(sign for _ in terms[1:])))


FACTORS, TERMS, SUMS, RELATIONS = trees()
arrows = st.builds(s.Sign, st.sampled_from(["implies", "equivalent", "therefore"]))
STATEMENTS = st.one_of(
    RELATIONS,
    st.builds(lambda a, x, b: s.Implication((a, b), (x,)), RELATIONS, arrows, RELATIONS),
    st.builds(
        lambda a, p, b: s.Sequence((a, b), (p,)),
        RELATIONS,
        st.sampled_from([",", "quad", ";"]),
        RELATIONS,
    ),
    st.builds(s.Rows, tuples(RELATIONS)),
    st.builds(lambda a: s.Cases(tuple((r,) for r in a)), tuples(RELATIONS)),
)


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


@given(STATEMENTS)
def test_drawn_trees_are_written_and_read(tree):
    tree = normal(tree)
    assert shape(read_formula(latex(tree)).tree) == shape(tree)
    assert read_formula(latex(tree)).tree == tree


def loosened(node):
    """A tree with sums where factors stood."""
    if isinstance(node, s.Symbol) and node.name in {"a", "b", "omega"} and not node.style:
        return s.Addition((node, s.Symbol("z")), ("", "-"))
    return node


def without_brackets(node):
    def rule(n):
        if isinstance(n, s.Group) and n.open in {"(", ""}:
            return n.body
        return n

    return shape(transform(node, rule))


@given(TERMS)
def test_changed_trees_get_the_brackets_that_they_need(tree):
    """A repair may put a sum into a product: it reads again, up to brackets."""
    tree = normal(tree)
    changed = s.Product((s.Addition((tree, s.Symbol("y")), ("", "+")), s.Symbol("x")), "cross")
    again = read_formula(latex(changed)).tree
    assert isinstance(again, s.Product)
    assert again.operator == "cross"
    assert without_brackets(again) == without_brackets(changed)


@given(SUMS)
def test_walking(tree):
    assert transform(tree, lambda n: n) is tree
    assert sum(1 for _ in walk(tree)) >= depth(tree) >= 1
