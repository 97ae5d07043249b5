"""Turning frames: Poisson's equation, the transport theorem, addition of angular velocities, tildes.

Lectures 000, 001 (transport in components) and 002 (3.17 and the forms that it recalls).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.mechanics.rigidbody import principal_inertia
from eom.mechanics.steady import ROOT, SPIN_RATE
from eom.terms.rules import (
    associate,
    at,
    bac_cab,
    by_axes,
    by_way_of,
    combine,
    components,
    compute,
    differentiate,
    distribute,
    factor_left,
    factor_right,
    fold_sum,
    inside,
    less,
    linear_in,
    no_turn_in_itself,
    orthonormal,
    parallel,
    put,
    scalar_triple,
    scalars_in,
    transport,
    use,
)
from eom.terms.rules import resolved as along_axes
from eom.terms.rules.inferences import cancelled, equal, instance, renamed, solved
from eom.terms.terms import (
    Equation,
    Term,
    add,
    column,
    cross,
    der,
    dot,
    expr,
    matmul,
    mul,
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
            Equation(der(b), cross(W, b)),
            f"the same for one axis: b{k} turns with omega",
            label=f"axis-{k}",
        ).equation
        for k, b in enumerate(AXES, 1)
    ]


def _first(d: Derivation, poisson: list[Equation]) -> None:
    symbols = name_components(d, V, "v", "B", "component of v along b{k}")
    resolved = d.start(V).then(
        "a vector by its components in B",
        along_axes(V, "B"),
        *(use(name, backwards=True) for name in symbols),
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
        fold_sum(local.equation),
        fold_sum(resolved.equation),
        label="transport",
    )
    d.recall("transport").infer(
        "v may be any vector: for the position of an element of a body",
        instance({V: position("dm", "C")}),
        label="transport-r",
        states=["000:E8", "000:E29"],
    )


def _second(d: Derivation) -> None:
    first = d.recall("transport")
    twice = first.both(
        "differentiate in I once more", der, distribute, differentiate, label="again"
    )
    of_rate = first.infer(
        "v may be any vector: for the derivative in B",
        instance({V: der(V, "B")}),
        label="transport-rate",
    )
    moved = twice.then(
        "the transport theorem for the derivative in B, and for v in the second product",
        use(of_rate.equation),
        inside("cross", use(first.equation)),
        distribute,
        label="second-terms",
    )
    same = first.infer(
        "the same theorem for omega",
        instance({V: W}),
        label="omega-rate-terms",
        states=["000:E22"],
    ).then("omega x omega = 0", parallel, distribute, label="omega-rate")
    moved.then(
        "local, two equal Coriolis terms, Euler and centripetal acceleration: five terms",
        use(same.equation),
        label="second-five",
    ).then("the Coriolis terms together", combine, label="second", states=["002:E18"])


def _addition(d: Derivation) -> None:
    from_B = d.recall("transport")
    inner = d.start(der(V, "A")).then("from A to B", transport("B", "A"), label="A-to-B")
    by_way = (
        d.start(der(V))
        .then("seen from A", transport("A"), label="from-A")
        .then("by way of A", use(inner.equation), factor_right(V, "cross"), label="by-way-of-A")
    )
    from_B.infer(
        "both are the same derivative: the terms without the derivative in B are equal",
        equal(less(der(V, "B"))),
        by_way,
        label="addition-crossed",
    ).infer("as v is any vector, angular velocities add", cancelled(V), label="addition").infer(
        "by way of I and back to B, which does not turn in itself",
        renamed({"A": "I", "I": "B"}, no_turn_in_itself),
        label="there-and-back",
    ).infer(
        "so the reverse rotation has the opposite angular velocity",
        solved(omega("I", "B")),
        label="reverse",
    )


def _referential(d: Derivation) -> None:
    first = d.recall("transport")
    d.in_components(first, "B", "components in B", label="transport-B")
    d.in_components(d.recall("second"), "B", "components in B", label="second-B")
    in_I = (
        d.start(column(der(V), "I"))
        .then(
            "the axes of I are fixed in I: components of a rate are rates of components",
            components("I"),
            label="axes-of-I",
        )
        .turned("so the rates of components in I are those of the vector", label="axes-of-I-turned")
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
    d.show(
        Equation(transpose(tilde(a)), -tilde(a)),
        "skew-symmetric: both sides have the same entries",
        use(known_a),
        compute(),
        label="skew",
    )
    d.start(matmul(tilde(a), a)).then("by the entries", use(known_a), compute(), label="kernel")
    _double_products(d, a, b)
    _turned(d, a)
    triple = d.start(dot(cross(A, B), C))
    triple.then("the scalar triple product", scalar_triple, label="triple", states=["000:E31"])
    d.stands_for("tilde", tilde(a))
    return d.finish(
        tilde=sp.Matrix(3, 3, [e.data[0] for e in d.recall("tilde").equation.right.args])
    )


def _double_products(d: Derivation, a: Term, b: Term) -> None:
    double = d.start(cross(A, cross(B, C))).then("a x (b x c)", bac_cab, label="bac-cab")
    any_column = column(C, "B")
    d.in_components(
        double, "B", "in components, for every c", scalars_in("B"), label="bac-cab-B"
    ).both(
        "written as matrices times c",
        associate,
        linear_in(any_column),
        label="double-tilde-of-c",
    ).infer("as c is any vector", cancelled(any_column), label="double-tilde")
    d.show(
        Equation(
            tilde(matmul(tilde(a), b)),
            add(matmul(tilde(a), tilde(b)), -matmul(tilde(b), tilde(a))),
        ),
        "the skew matrix of a cross product: both sides have the same entries",
        use(d.recall("column-of-a").equation),
        use(d.recall("column-of-b").equation),
        compute(),
        label="tilde-of-cross",
    )


def _turned(d: Derivation, a: Term) -> None:
    R = quantity("rotation", "B", "A")
    back = quantity("rotation", "A", "B")
    d.law(Equation(transpose(R), back), "the transpose is the reverse rotation", label="transpose")
    turn = Equation(a, matmul(R, column(A, "A")))
    d.law(turn, "components in B from those in A", label="turn")
    turned_tilde(d, A, turn)


def turned_tilde(d: Derivation, vector: Term, turn: Equation) -> Chain:
    """Derive that a cross product may be formed in either frame, A or B.

    ``turn``: the line that gives the components of ``vector`` in B by those in A.
    """
    product, any_column = column(cross(vector, C), "B"), column(C, "B")
    in_B = d.start(product).then(
        "a cross product with any vector c, formed in B", components("B"), use(turn)
    )
    in_A = d.start(product).then(
        "the same formed in A, c taken there and the product back",
        by_way_of("A", "B"),
        components("A"),
        at(column(C, "A"), by_way_of("B", "A")),
        associate,
    )
    return in_B.infer("both are the same product", equal(), in_A).infer(
        "as c is any vector, a cross product may be formed in either frame",
        cancelled(any_column),
        label="turned-tilde",
    )


# -- names of components ---------------------------------------------------------------------------


def name_components(
    d: Derivation, vector: Term, letter: str, frame: str, meaning: str
) -> list[Equation]:
    """Let letter_1, letter_2, letter_3 stand for the components of a vector; return the definitions."""
    named = []
    for k in (1, 2, 3):
        symbol = sp.Symbol(f"{letter}_{k}", real=True)
        along = dot(unit(frame, k), vector)
        made = d.name_scalar(symbol, along, meaning.format(k=k), label=symbol.name)
        named.append(made.equation)
    return named


PRINCIPAL = tuple(q.symbol for q in principal_inertia()[1])


def principal_matrix(
    d: Derivation, inertia: Term, symbols: Sequence[Any] = PRINCIPAL, end: str = "", **options: Any
) -> Chain:
    """Name the principal moments of ``inertia`` along b1, b2, b3, and derive its matrix in B.

    ``end``: of the labels of the lines that say so.
    """
    eigen = []
    for k, symbol in enumerate(symbols, 1):
        b = unit("B", k)
        d.name_scalar(symbol, dot(b, dot(inertia, b)), f"principal moment of inertia about b{k}")
        meaning = Equation(dot(inertia, b), mul(expr(symbol), b))
        words = f"b{k} is a principal axis"
        eigen.append(d.given(meaning, words, label=f"principal-axis-{k}{end}").equation)
    return d.start(column(inertia, "B")).then(
        "in principal axes the inertia matrix is diagonal",
        by_axes("B"),
        *(use(e) for e in eigen),
        distribute,
        orthonormal("B"),
        compute(),
        **options,
    )


def name_spin(d: Derivation) -> None:
    """Say what the symbols of a steady spin and of deviations from it are."""
    d.letter(SPIN_RATE, "rate of the steady spin")
    d.letter(ROOT, "exponent of a deviation, which goes as exp(lambda t)")


def explicit(d: Derivation, vector: Term, letter: str, frame: str, meaning: str) -> Equation:
    """Name the components of a vector and state its column."""
    named = name_components(d, vector, letter, frame, meaning)
    made = d.start(column(vector, frame)).then(
        f"components in {frame}",
        by_axes(frame),
        *(use(name, backwards=True) for name in named),
        label=f"column-of-{letter}",
    )
    return made.equation
