"""Terms of vector mechanics: kinds are checked, constructors tidy, labels are exchanged."""

import os
import pickle
import subprocess
import sys
from itertools import product

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom.errors import InputError
from eom.terms import terms
from eom.terms.terms import (
    HEADS,
    add,
    at,
    column,
    cross,
    der,
    dot,
    entries,
    expr,
    inner,
    integral,
    inverse,
    make,
    matmul,
    mul,
    nodes,
    number,
    outer,
    outer_column,
    partial,
    rebuild,
    relabel,
    replace,
    since,
    start,
    table,
    tilde,
    total,
    transpose,
    zero,
)
from eom.terms.vocabulary import mass, position, quantity

A, B = quantity("vector", "a"), quantity("vector", "b")
D = quantity("dyadic", "d")
S = quantity("scalar", "s")
C = quantity("rotation", "B", "I")
COLUMN = column(A, "B")
OF_KIND = {"scalar": S, "vector": A, "dyadic": D, "column": COLUMN, "matrix": C}

KINDS = {
    "dot": {("vector", "vector"): "scalar", ("dyadic", "vector"): "vector",
            ("vector", "dyadic"): "vector", ("dyadic", "dyadic"): "dyadic"},
    "cross": {("vector", "vector"): "vector"},
    "outer": {("vector", "vector"): "dyadic"},
    "matmul": {("matrix", "matrix"): "matrix", ("matrix", "column"): "column"},
    "inner": {("column", "column"): "scalar"},
    "outer_column": {("column", "column"): "matrix"},
    "add": {(k, k): k for k in OF_KIND},
    "mul": {("scalar", k): k for k in OF_KIND} | {(k, "scalar"): k for k in OF_KIND},
    "partial": {(k, "scalar"): k for k in OF_KIND},
}  # fmt: skip
ONE = {
    "der": {k: k for k in OF_KIND},
    "start": {k: k for k in OF_KIND},
    "since": {k: k for k in OF_KIND},
    "at": {k: k for k in OF_KIND},
    "sum": {k: k for k in OF_KIND},
    "integral": {k: k for k in OF_KIND},
    "column": {"vector": "column", "dyadic": "matrix"},
    "transpose": {"matrix": "matrix"},
    "inverse": {"matrix": "matrix"},
    "tilde": {"column": "matrix"},
}
BUILT = {
    "dot": dot, "cross": cross, "outer": outer, "matmul": matmul, "inner": inner,
    "outer_column": outer_column, "add": add, "mul": mul, "der": der, "sum": total, "start": start,
    "since": since, "at": lambda t: at(t, "end"), "partial": partial,
    "integral": integral, "column": lambda t: column(t, "B"), "transpose": transpose,
    "inverse": inverse, "tilde": tilde,
}  # fmt: skip


@pytest.mark.parametrize("head", KINDS)
def test_products_take_their_kinds_and_no_others(head):
    for a, b in product(OF_KIND.values(), repeat=2):
        kinds = (a.kind, b.kind)
        if kinds in KINDS[head]:
            assert BUILT[head](a, b).kind == KINDS[head][kinds]
        else:
            with pytest.raises(InputError, match="does not take these arguments"):
                BUILT[head](a, b)


@pytest.mark.parametrize("head", ONE)
def test_operations_take_their_kinds_and_no_others(head):
    for kind, term in OF_KIND.items():
        if kind in ONE[head]:
            assert BUILT[head](term).kind == ONE[head][kind]
        else:
            with pytest.raises(InputError, match="does not take these arguments"):
                BUILT[head](term)


def test_every_head_is_tried():
    assert {*KINDS, *ONE, "entries", "rows", "table"} == set(HEADS)


def test_entries_and_rows():
    assert entries(sp.eye(3)).kind == "matrix"
    assert entries([[S], [S], [S]]).kind == "column"
    assert make("rows", [COLUMN] * 3).kind == "matrix"
    assert table([[S, S], [S, S]]).kind == "table"
    with pytest.raises(InputError, match="table"):
        table([[S, A]])
    for wrong in ([S] * 2, [S] * 6, [S, S, A], []):
        with pytest.raises(InputError, match="entries"):
            make("entries", wrong)


@pytest.mark.parametrize("kind", ["vector", "dyadic", "column", "matrix"])
def test_entries_are_scalars(kind):
    with pytest.raises(InputError):
        make("entries", [OF_KIND[kind]] * 3)


@pytest.mark.parametrize("kind", OF_KIND)
def test_zeros_vanish(kind):
    term, nought = OF_KIND[kind], zero(kind)
    assert nought.is_zero
    assert nought.kind == kind
    assert add(term, nought) == term == add(nought, term)
    assert add(nought, nought) == nought
    assert mul(number(0), term) == mul(S, nought) == nought
    assert der(nought) == total(nought) == integral(nought) == nought
    assert mul(number(1), term) == mul(term) == term
    negative = -term
    assert -negative == term


@pytest.mark.parametrize("head", ["dot", "cross", "outer", "matmul", "inner", "outer_column"])
def test_a_product_with_zero_is_the_zero_of_its_kind(head):
    for (a, b), kind in KINDS[head].items():
        assert BUILT[head](zero(a), OF_KIND[b]) == zero(kind) == BUILT[head](OF_KIND[a], zero(b))


def test_sums_and_products_are_flat():
    assert add(add(A, B), A) == add(A, add(B, A)) == make("add", [A, B, A])
    assert mul(S, mul(S, A)) == mul(mul(S, S), A) == make("mul", [S, S, A])
    assert mul(A, S, number(2)) == make("mul", [number(2), S, A])


plain = st.sampled_from([sp.Symbol("x"), sp.Symbol("y"), sp.Integer(2), sp.Rational(-1, 3)])


@given(st.lists(plain, min_size=1, max_size=5))
def test_plain_parts_are_gathered_in_one(values):
    parts = [expr(v) for v in values]
    assert add(*parts) == expr(sp.Add(*values))
    assert mul(*parts) == expr(sp.Mul(*values))
    assert sum(n.head == "expr" for n in nodes(add(*parts, S))) == (sp.Add(*values) != 0)
    assert add(*parts, *(-p for p in parts)).is_zero


def test_operators():
    assert add(A, B) == A + B
    assert add(A, mul(number(-1), B)) == A - B
    assert mul(S, A) == S * A
    assert matmul(C, COLUMN) == C @ COLUMN


def test_the_empty_sum_has_no_kind_and_the_empty_product_is_one():
    with pytest.raises(InputError):
        add()
    assert mul() == number(1)


def test_a_derivative_has_a_frame_where_it_matters():
    assert der(A, "B").data == ("B",)
    assert der(A).data == ("I",)
    assert der(S, "B").data == der(COLUMN, "B").data == der(C).data == ("",)
    assert der(A, "B", 2) == der(der(A, "B"), "B")
    assert der(A, times=0) == A


def test_rebuild_and_replace_tidy():
    term = cross(A, add(B, A))
    assert rebuild(term, [A, zero("vector")]) == zero("vector")
    assert rebuild(term, term.args) is term
    assert replace(term, lambda n: zero("vector") if n == B else n) == cross(A, A)
    assert [n for n in nodes(term) if not n.args] == [A, B, A]
    inverted = inverse(C)
    assert rebuild(inverted, [transpose(C)]) == inverse(transpose(C))


def test_labels_are_free_ones():
    force = quantity("internal_force", "i", "j")
    assert force.labels == {"i", "j"}
    assert total(force, "j").labels == {"i"}
    assert integral(position("dm", "C")).labels == {"C"}
    assert add(total(force, "j"), position("j")).labels == {"i", "j", "OI"}
    assert number(3).labels == frozenset()


def test_relabel_exchanges_free_labels_and_leaves_bound_ones():
    force = quantity("internal_force", "i", "j")
    swap = {"i": "j", "j": "i"}
    assert relabel(force, swap) == quantity("internal_force", "j", "i")
    assert relabel(total(total(force, "j"), "i"), swap) == total(total(force, "j"), "i")
    assert relabel(mul(mass("P"), position("P", "O")), {"P": "i"}) == mul(
        mass("i"), position("i", "O")
    )
    assert relabel(A, {}) == A


@pytest.mark.parametrize(
    ("term", "names"),
    [
        (total(quantity("internal_force", "i", "j"), "j"), {"i": "j"}),
        (integral(position("dm")), {"dm": "i"}),
    ],
)
def test_relabel_binds_nothing_and_frees_nothing(term, names):
    wanted = {names.get(label, label) for label in term.labels}
    assert relabel(term, names).labels == wanted


def test_equal_terms_have_equal_hashes():
    assert hash(cross(A, B)) == hash(cross(A, B))
    assert cross(A, B) != cross(B, A)
    assert terms.atom("mass", "i", kind="scalar") == mass("i")


def test_terms_are_found_again_in_another_process():
    """Texts have other hashes there, so that none may travel with a term."""
    force = quantity("internal_force", "i", "j")
    term = add(total(force, "j"), position("j"))
    hash(term)
    code = (
        "import pickle, sys\n"
        "from eom.terms.terms import add, total\n"
        "from eom.terms.vocabulary import position, quantity\n"
        "given = pickle.loads(sys.stdin.buffer.read())\n"
        "force = quantity('internal_force', 'i', 'j')\n"
        "assert given in {add(total(force, 'j'), position('j'))}\n"
    )
    environment = {**os.environ, "PYTHONHASHSEED": "77"}
    words = [sys.executable, "-c", code]
    subprocess.run(words, input=pickle.dumps(term), env=environment, check=True)
