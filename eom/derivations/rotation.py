"""Turning frames: Poisson's equation, the transport theorem, addition of angular velocities, tildes.

Lectures 000, 001 (transport in components) and 002 (3.17 and the forms that it recalls).
"""

from __future__ import annotations

import sympy as sp

from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.terms.rules import (
    Rule,
    bac_cab,
    by_way_of,
    combine,
    components,
    compute,
    differentiate,
    distribute,
    factor_left,
    factor_right,
    inside,
    parallel,
    put,
    scalar_triple,
    transport,
    use,
)
from eom.terms.terms import (
    Equation,
    Term,
    add,
    column,
    cross,
    der,
    dot,
    entries,
    expr,
    matmul,
    mul,
    outer_column,
    tilde,
    transpose,
    zero,
)
from eom.terms.vocabulary import omega, position, quantity, unit

V, A, B, C = (quantity("vector", n) for n in ("v", "a", "b", "c"))
W = omega()
AXES = tuple(unit("B", k) for k in (1, 2, 3))
C_BI = quantity("rotation", "B", "I")
ONE = quantity("identity_matrix")


def transport_theorem() -> Derived:
    """Derive the first and second derivative in a turning frame from the turning of its axes."""
    d = Derivation("transport-theorem", "Derivatives as seen from a turning frame", "Rotation")
    poisson = _axes(d)
    _first(d, poisson)
    _second(d)
    _addition(d)
    _referential(d)
    return d.finish()


def _axes(d: Derivation) -> list[Equation]:
    """State how the axes of B turn: the meaning of the angular velocity."""
    d.law(
        Equation(matmul(C_BI, transpose(C_BI)), ONE),
        "the axes are orthonormal",
        label="orthonormal",
    )
    d.law(
        Equation(der(C_BI), -matmul(tilde(column(W, "B")), C_BI)),
        "Poisson's equation: the meaning of the angular velocity omega of B in I",
        label="poisson",
    )
    return [
        d.law(
            Equation(der(b), cross(W, b)), f"row {k} of it, as a vector", label=f"axis-{k}"
        ).equation
        for k, b in enumerate(AXES, 1)
    ]


def _first(d: Derivation, poisson: list[Equation]) -> None:
    symbols = name_components(d, V, "v", "B", "component of v along b{k}")
    resolved = d.state(
        Equation(V, add(*(mul(s, b) for s, b in zip(symbols, AXES, strict=True)))),
        "a vector by its components in B",
        label="resolved",
    )
    rate = resolved.both("differentiate in I, term by term", der, differentiate, label="rate-terms")
    for b in AXES:
        d.law(Equation(der(b, "B"), zero("vector")), "the axes of B are fixed in B")
    local = resolved.both(
        "differentiate in B, whose axes are fixed in it",
        lambda t: der(t, "B"),
        differentiate,
        *(put(der(b, "B"), zero("vector")) for b in AXES),
        distribute,
        label="local",
    )
    turned = rate.then(
        "the axes turn with omega",
        *(use(p) for p in poisson),
        factor_left(W),
        label="rate-turned",
    )
    turned.then(
        "the first three terms are the derivative in B; the sum in the product is v",
        _fold_sum(local.equation),
        _fold_sum(resolved.equation),
        label="transport",
    )
    position_r = position("dm", "C")
    d.state(
        Equation(der(position_r), add(der(position_r, "B"), cross(W, position_r))),
        "for the position of an element of a body",
        label="transport-r",
        states=["000:E8", "000:E29"],
    )


def _fold_sum(named: Equation) -> Rule:
    """Replace the terms of a named sum, where all of them occur, by its name."""
    from eom.terms.terms import replace

    wanted = named.right.args

    def rule(node: Term) -> Term:
        if node.head == "add" and all(t in node.args for t in wanted):
            return add(named.left, *(t for t in node.args if t not in wanted))
        return node

    return lambda term: replace(term, rule)


def _second(d: Derivation) -> None:
    first = d.recall("transport")
    twice = first.both(
        "differentiate in I once more", der, distribute, differentiate, label="again"
    )
    moved = twice.then(
        "the transport theorem for the derivative in B, and for v in the second product",
        put(der(der(V, "B")), add(der(der(V, "B"), "B"), cross(W, der(V, "B")))),
        inside("cross", put(der(V), first.equation.right)),
        distribute,
        label="second-terms",
    )
    same = d.state(
        Equation(der(W), add(der(W, "B"), cross(W, W))),
        "the same theorem for omega",
        label="omega-rate-terms",
        states=["000:E22"],
    ).then("omega x omega = 0", parallel, distribute, label="omega-rate")
    moved.then(
        "local, two equal Coriolis terms, Euler and centripetal acceleration: five terms",
        use(same.equation),
        label="second-five",
    ).then("the Coriolis terms together", combine, label="second", states=["002:E18"])


def _addition(d: Derivation) -> None:
    from_B = d.start(der(V)).then("seen from B", transport("B"), label="from-B")
    inner = d.start(der(V, "A")).then("from A to B", transport("B", "A"), label="A-to-B")
    d.start(der(V)).then("seen from A", transport("A"), label="from-A").then(
        "by way of A", use(inner.equation), factor_right(V, "cross"), label="by-way-of-A"
    )
    d.state(
        Equation(from_B.equation.right, d.recall("by-way-of-A").equation.right),
        "both are the same derivative, for every v",
        label="addition-crossed",
    )
    total = add(omega("B", "A"), omega("A", "I"))
    d.state(Equation(W, total), "as v is any vector, angular velocities add", label="addition")
    d.state(
        Equation(omega("I", "B"), -W), "the reverse rotation has the opposite one", label="reverse"
    )


def _referential(d: Derivation) -> None:
    first = d.recall("transport")
    d.in_components(first, "B", "components in B", label="transport-B")
    d.in_components(d.recall("second"), "B", "components in B", label="second-B")
    in_I = d.state(
        Equation(der(column(V, "I")), column(der(V), "I")), "the axes of I are fixed in I"
    )
    in_I.then(
        "by way of components in B",
        by_way_of("B"),
        inside("column", transport("B")),
        components("B"),
        label="transport-I",
    )
    momentum = quantity("angular_momentum", "body", "C")
    seen = d.start(der(momentum)).then("for the angular momentum", transport("B"))
    d.in_components(seen, "B", "components in B", label="momentum-B", states=["001:E10"])


def tilde_identities() -> Derived:
    """Derive the identities of the skew matrix of a cross product, from components and from vectors."""
    d = Derivation("tilde-identities", "The cross product as a matrix", "Rotation")
    a, b = (column(x, "B") for x in (A, B))
    known_a = explicit(d, A, "a", "B", "component of a along b{k}")
    known_b = explicit(d, B, "b", "B", "component of b along b{k}")
    d.start(tilde(a)).then(
        "the skew matrix, by its entries",
        use(known_a),
        compute(),
        label="tilde",
        states=["000:E12"],
    )
    product = d.start(column(cross(A, B), "B")).then(
        "the cross product as a matrix product", components("B"), label="cross", states=["000:E13"]
    )
    product.then("carried out", use(known_a), use(known_b), compute(), label="cross-entries")
    d.state(Equation(transpose(tilde(a)), -tilde(a)), "skew-symmetric", label="skew")
    d.start(matmul(tilde(a), a)).then("by the entries", use(known_a), compute(), label="kernel")
    _double_products(d, a, b)
    _turned(d, a)
    triple = d.start(dot(cross(A, B), C))
    triple.then("the scalar triple product", scalar_triple, label="triple", states=["000:E31"])
    return d.finish(
        tilde=sp.Matrix(3, 3, [e.data[0] for e in d.recall("tilde").equation.right.args])
    )


def _double_products(d: Derivation, a: Term, b: Term) -> None:
    double = d.start(cross(A, cross(B, C))).then("a x (b x c)", bac_cab, label="bac-cab")
    d.in_components(double, "B", "in components, for every c", label="bac-cab-B")
    d.state(
        Equation(
            matmul(tilde(a), tilde(b)),
            add(outer_column(b, a), -mul(dot(A, B), ONE)),
        ),
        "as c is any vector",
        label="double-tilde",
    )
    d.state(
        Equation(
            tilde(matmul(tilde(a), b)),
            add(matmul(tilde(a), tilde(b)), -matmul(tilde(b), tilde(a))),
        ),
        "the tilde of a cross product, by the same identity twice",
        label="tilde-of-cross",
    )


def _turned(d: Derivation, a: Term) -> None:
    R = quantity("rotation", "B", "A")
    back = quantity("rotation", "A", "B")
    d.law(Equation(transpose(R), back), "the transpose is the reverse rotation", label="transpose")
    in_A = column(A, "A")
    d.law(Equation(a, matmul(R, in_A)), "components in B from those in A", label="turn")
    d.state(
        Equation(tilde(matmul(R, in_A)), matmul(matmul(R, tilde(in_A)), back)),
        "a cross product may be formed in either frame",
        label="turned-tilde",
    )


# -- names of components ---------------------------------------------------------------------------


def name_components(
    d: Derivation, vector: Term, letter: str, frame: str, meaning: str
) -> tuple[Term, Term, Term]:
    """Let letter_1, letter_2, letter_3 stand for the components of a vector."""
    named = []
    for k in (1, 2, 3):
        symbol = sp.Symbol(f"{letter}_{k}", real=True)
        d.name_scalar(symbol, dot(unit(frame, k), vector), meaning.format(k=k))
        named.append(expr(symbol))
    return (named[0], named[1], named[2])


def explicit(d: Derivation, vector: Term, letter: str, frame: str, meaning: str) -> Equation:
    """Name the components of a vector and state its column."""
    named = name_components(d, vector, letter, frame, meaning)
    column_of = entries([[c] for c in named])
    return d.state(Equation(column(vector, frame), column_of), f"components in {frame}").equation
