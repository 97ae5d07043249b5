"""Every rule leaves the value of a term as it is: tried on random well-typed terms, in random worlds."""

import random

import pytest
import sympy as sp

from eom.derivations.verification import decide
from eom.terms import rules
from eom.terms.terms import (
    Equation,
    add,
    column,
    cross,
    der,
    dot,
    entries,
    expr,
    inner,
    integral,
    matmul,
    mul,
    nodes,
    number,
    outer,
    outer_column,
    tilde,
    total,
    transpose,
    zero,
)
from eom.terms.vocabulary import mass, omega, position, quantity, unit, velocity

A, B, V = (quantity("vector", n) for n in "abv")
D, J = quantity("dyadic", "d"), quantity("inertia", "C")
M, S = mass("j"), quantity("scalar", "s")
x, y, *rates_of_y = sp.symbols("x y y_1 y_2 y_3")
SCALARS = {x: S, y: dot(A, V)}
SCALARS |= {r: der(SCALARS[y], times=k) for k, r in enumerate(rates_of_y, 1)}
RATES = dict(zip((y, *rates_of_y), rates_of_y, strict=False))
LEAVES = {
    "scalar": (M, S, number(2), number(-1, 3), expr(x * y + 1), mass("i")),
    "vector": (
        A,
        B,
        V,
        V,
        omega(),
        position("i", "O"),
        position("j"),
        quantity("linear_momentum", "i"),
    ),
    "dyadic": (D, J, quantity("identity")),
    "column": (column(A, "B"), column(V, "B"), entries(sp.Matrix([x, y, 1]))),
    "matrix": (quantity("rotation", "B", "A"), tilde(column(V, "B")), quantity("identity_matrix")),
}


class Maker:
    """Random terms of a kind, with at most two derivatives one inside the other."""

    def __init__(self, seed):
        self.random = random.Random(seed)

    def term(self, kind, depth, rates=2):
        if depth == 0 or self.random.random() < 0.1:
            return self.random.choice(LEAVES[kind])
        head = self.random.choice(HEADS[kind])
        return getattr(self, head)(kind, depth - 1, rates)

    def add(self, kind, depth, rates):
        return add(*(self.term(kind, depth, rates) for _ in range(self.random.randint(2, 3))))

    def mul(self, kind, depth, rates):
        return mul(self.term("scalar", depth, rates), self.term(kind, depth, rates))

    def der(self, kind, depth, rates):
        frame = self.random.choice("IBA")
        return (
            der(self.term(kind, depth, rates - 1), frame) if rates else self.add(kind, depth, rates)
        )

    def sum(self, kind, depth, rates):
        return total(self.term(kind, depth, rates))

    def double_sum(self, kind, depth, rates):
        return total(total(self.term(kind, depth, rates), "j"))

    def integral(self, kind, depth, rates):
        weight = self.random.choice((position("dm", "C"), velocity("dm")))
        inside = dot(weight, self.term("vector", depth, rates)) if kind == "scalar" else None
        if kind == "vector":
            inside = self.random.choice((cross(weight, self.term("vector", depth, rates)), weight))
        return integral(mul(self.term("scalar", 0), inside or self.term(kind, depth, rates)))

    def dot(self, kind, depth, rates):
        pairs = {
            "scalar": [("vector", "vector")],
            "vector": [("dyadic", "vector"), ("vector", "dyadic")],
            "dyadic": [("dyadic", "dyadic")],
        }
        return dot(*(self.term(k, depth, rates) for k in self.random.choice(pairs[kind])))

    def cross(self, kind, depth, rates):
        return cross(self.term("vector", depth, rates), self.term("vector", depth, rates))

    def outer(self, kind, depth, rates):
        return outer(self.term("vector", depth, rates), self.term("vector", depth, rates))

    def column(self, kind, depth, rates):
        inside = "vector" if kind == "column" else "dyadic"
        return column(self.term(inside, depth, rates), self.random.choice("BBIA"))

    def matmul(self, kind, depth, rates):
        return matmul(self.term("matrix", depth, rates), self.term(kind, depth, rates))

    def transpose(self, kind, depth, rates):
        return transpose(self.term("matrix", depth, rates))

    def tilde(self, kind, depth, rates):
        return tilde(self.term("column", depth, rates))

    def inner(self, kind, depth, rates):
        return inner(self.term("column", depth, rates), self.term("column", depth, rates))

    def outer_column(self, kind, depth, rates):
        return outer_column(self.term("column", depth, rates), self.term("column", depth, rates))


HEADS = {
    "scalar": "add mul mul der sum double_sum integral dot dot inner".split(),
    "vector": "add mul mul der der sum integral dot cross cross".split(),
    "dyadic": "add mul der sum dot outer outer".split(),
    "column": "add mul der column column matmul matmul".split(),
    "matrix": "add mul der column matmul transpose tilde outer_column".split(),
}
RULES = {
    "distribute": rules.distribute,
    "differentiate": rules.differentiate,
    "differentiate_in": rules.differentiate_in("B"),
    "differentiate_under": rules.differentiate_under,
    "combine": rules.combine,
    "take_out": rules.take_out,
    "symmetrise": rules.symmetrise("i", "j"),
    "components": rules.components("B"),
    "scalars_in": rules.scalars_in("A"),
    "parallel": rules.parallel,
    "bac_cab": rules.bac_cab,
    "swap": rules.swap(A, V),
    "flip_crosses": rules.flip_crosses(lambda n: V in n.args),
    "factor_right": rules.factor_right(V),
    "factor_right cross": rules.factor_right(V, "cross"),
    "factor_left": rules.factor_left(V),
    "transport": rules.transport("B"),
    "transport A B": rules.transport("A", "B"),
    "commute": rules.commute,
    "order_dots": rules.order_dots(V),
    "symmetric": rules.symmetric(J),
    "triple_zero": rules.triple_zero(V),
    "regroup": rules.regroup(S),
    "regroup_right": rules.regroup_right(S),
    "associate": rules.associate,
    "unfold": rules.unfold("linear_momentum", "inertia"),
    "entrywise": rules.entrywise(sp.expand),
    "use": rules.use(Equation(position("i"), add(position("O"), position("i", "O")))),
    "put": rules.put(V, add(A, V) - A),
    "compute": rules.compute(RATES),
}
"""Rules that hold without any assumption, but for those of `NEEDS`."""
NEEDS = {"differentiate_under": ("constant_mass",)}


def redexes(maker):
    """Terms of each kind; some that rules for special patterns are made for."""
    for kind in LEAVES:
        for depth in (2, 3):
            yield maker.term(kind, depth)
    u, w = maker.term("vector", 1), maker.term("vector", 1)
    s = maker.term("scalar", 1)
    yield from (
        cross(u, cross(V, w)),
        cross(mul(s, V), V),
        cross(A, V),
        add(dot(D, V), mul(s, dot(J, V)), u),
        add(cross(u, V), cross(mul(s, w), V), w),
        add(cross(V, u), mul(s, cross(V, w))),
        dot(V, cross(u, V)),
        dot(u, V),
        dot(A, der(V, "B")),
        der(dot(u, w)),
        der(total(u), "B"),
        der(mul(s, V), "B"),
        dot(der(u), dot(J, V)),
        mul(S, s, cross(u, w)),
        total(total(mul(s, maker.term("scalar", 1)), "j")),
        matmul(tilde(column(u, "B")), matmul(quantity("rotation", "B", "A"), column(w, "A"))),
        expr((x + 1) * (y + x)),
        matmul(tilde(entries(sp.Matrix([x, y, 2]))), entries(sp.Matrix([y, x, x]))),
        column(dot(J, add(u, w)), "B"),
        integral(cross(position("dm", "C"), cross(u, position("dm", "C")))),
    )


@pytest.mark.parametrize("name", RULES)
def test_a_rule_does_not_change_the_value_of_a_term(name):
    changed = 0
    for seed in range(4):
        for term in redexes(Maker(seed)):
            new = RULES[name](term)
            assert new.kind == term.kind
            changed += new != term
            if new != term:
                assert decide(Equation(term, new), NEEDS.get(name, ()), SCALARS, 1), term
    assert changed >= 3


def test_random_terms_hold_every_head():
    seen = {n.head for seed in range(9) for t in redexes(Maker(seed)) for n in nodes(t)}
    assert seen >= {h for heads in HEADS.values() for h in heads} - {"double_sum"}


def same(term, new, assumptions=()):
    return new != term and decide(Equation(term, new), assumptions, SCALARS)


def test_dyadic_form_lets_a_vector_stand_at_the_end():
    arm = position("dm", "C")
    for term in (mul(dot(A, V), B), mul(M, dot(V, A), B), mul(S, V), mul(dot(V, V), A)):
        new = rules.dyadic_form(V)(term)
        assert new.head == "dot"
        assert new.args[1] == V
        assert same(term, new)
    spin = integral(add(mul(dot(arm, arm), V), -mul(dot(arm, V), arm)))
    new = rules.linear_in(V)(spin)
    assert new.args[1] == V
    assert same(spin, new)


def test_scalar_triple_moves_the_cross():
    assert rules.scalar_triple(dot(cross(A, B), V)) == dot(A, cross(B, V))
    assert same(dot(cross(A, B), V), dot(A, cross(B, V)))


def test_into_sums():
    term = cross(position("i"), total(quantity("force", "j"), "j"))
    new = rules.into_sums(term)
    assert new.head == "sum"
    assert same(term, new)


def test_by_way_of_a_frame():
    assert same(column(V, "I"), rules.by_way_of("B")(column(V, "I")))


def test_fold_into_undoes_unfold():
    for q in (
        quantity("torque", "system", "O"),
        quantity("inertia", "C"),
        quantity("linear_momentum", "P"),
    ):
        unfolded = rules.unfold(q.data[0])(q)
        assert unfolded != q
        assert rules.fold_into(q)(unfolded) == q


def test_use_renames_indices_and_goes_backwards():
    split = Equation(position("i"), add(position("O"), position("i", "O")))
    assert rules.use(split)(position("j")) == add(position("O"), position("j", "O"))
    assert rules.use(split)(position("P")) == add(position("O"), position("P", "O"))
    assert rules.use(split)(position("C")) == position("C")
    assert rules.use(split, backwards=True)(split.right) == position("i")


def test_match_binds_each_index_once():
    pattern = cross(position("i"), quantity("internal_force", "i", "j"))
    assert rules.match(pattern, cross(position("j"), quantity("internal_force", "j", "i")), {}) == {
        "i": "j",
        "j": "i",
    }
    crossed = cross(position("i"), quantity("internal_force", "j", "i"))
    assert (
        rules.match(cross(position("i"), quantity("internal_force", "i", "i")), crossed, {}) is None
    )
    assert rules.match(der(V), der(V, "B"), {}) is None
    assert rules.match(pattern, crossed, {}) is None


def test_vanish_at_and_inside_change_their_places_alone():
    term = add(cross(A, V), der(V))
    assert rules.vanish(A)(term) == der(V)
    assert rules.at(der(V), rules.vanish(V))(term) == cross(A, V)
    assert rules.inside("cross", rules.vanish(V))(term) == der(V)


def test_compute_uses_given_rates():
    fixed = entries(sp.Matrix([x, x**2, 3]))
    assert rules.compute({x: y})(der(fixed)) == entries(sp.Matrix([y, 2 * x * y, 0]))


def test_a_rule_that_never_ends_is_our_own_bug():
    endless = rules.until_stable(lambda n: number(n.data[0] + 1) if n.head == "expr" else n)
    with pytest.raises(AssertionError, match="come to an end"):
        endless(number(1))


CAPTURED = {
    "into_sums": (
        cross(position("j"), total(quantity("force", "j"), "j")),
        rules.into_sums,
    ),
    "fold_into another index": (
        mul(mass("j"), velocity("j")),
        rules.fold_into(quantity("linear_momentum", "i")),
    ),
    "by_way_of of a dyadic": (column(D, "I"), rules.by_way_of("B")),
}


@pytest.mark.parametrize("name", CAPTURED)
def test_no_index_is_captured(name):
    term, rule = CAPTURED[name]
    new = rule(term)
    assert new == term or decide(Equation(term, new), (), {}, 1)


def test_use_does_not_bind_a_free_index():
    row = total(cross(position("i"), quantity("internal_force", "i", "j")), "j")
    law = Equation(cross(position("i"), velocity("i")), row)
    new = rules.use(law)(cross(position("j"), velocity("j")))
    assert "j" in new.labels


RAISES = {
    "dyadic_form, a product of scalars": (rules.dyadic_form(V), mul(dot(A, V), dot(A, B))),
    "dyadic_form, a dyadic": (rules.dyadic_form(V), mul(dot(A, V), D)),
    "scalar_triple": (rules.scalar_triple, dot(cross(A, B), D)),
    "regroup": (rules.regroup(dot(A, B)), mul(M, dot(A, B))),
}


@pytest.mark.parametrize("name", RAISES)
def test_a_rule_leaves_alone_what_it_is_not_made_for(name):
    rule, term = RAISES[name]
    assert rule(term).kind == term.kind


def test_a_symbol_that_stands_for_a_component_of_an_element_stays_under_the_integral():
    r1 = sp.Symbol("r_1")
    term = integral(mul(expr(r1), position("dm", "C")))
    known = {r1: dot(unit("B", 1), position("dm", "C"))}
    assert decide(Equation(term, rules.take_out(term)), ("body_frame",), known, 1)


def test_zero_is_left_alone():
    for rule in RULES.values():
        assert rule(zero("vector")) == zero("vector")
