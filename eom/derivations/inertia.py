"""Properties of the inertia matrix: symmetry, sign, rotation, shift, principal axes (002: 3.28-3.35)."""

from __future__ import annotations

import sympy as sp

from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.mass.inertia import principal_conditions
from eom.terms.rules import (
    associate,
    bac_cab,
    distribute,
    everywhere,
    fold_into,
    linear_in,
    put,
    scalar_triple,
    take_out,
    use,
)
from eom.terms.terms import (
    Equation,
    Term,
    add,
    column,
    cross,
    dot,
    entries,
    expr,
    integral,
    inverse,
    make,
    matmul,
    mul,
    number,
    tilde,
    transpose,
    zero,
)
from eom.terms.vocabulary import position, quantity, unit

RHO = position("dm", "O")
J = quantity("inertia", "O")
J_A, J_B = column(J, "A"), column(J, "B")
C_BA, C_AB = quantity("rotation", "B", "A"), quantity("rotation", "A", "B")
MASS = quantity("total_mass", "body")


def by_tildes(about: str, frame: str) -> Equation:
    """Return the inertia matrix as minus the integral of the squared tilde (002: 3.24)."""
    r = column(position("dm", about), frame)
    J_frame = column(quantity("inertia", about), frame)
    return Equation(J_frame, -integral(matmul(tilde(r), tilde(r))))


def inertia_properties() -> Derived:
    """Derive what holds for the inertia matrix of every body, and how it changes with axes and point."""
    d = Derivation("inertia-properties", "Properties of the inertia matrix", "Inertia")
    _sign(d)
    _triangle(d)
    _rotation(d)
    _shift(d)
    _principal(d)
    return d.finish()


def _sign(d: Derivation) -> None:
    d.only()
    d.law(
        Equation(transpose(J_B), J_B),
        "symmetric, as each integrand is",
        label="symmetric",
        states=["002:C1"],
    )
    x = quantity("vector", "x")
    square = integral(dot(cross(x, RHO), cross(x, RHO)))
    d.start(square).then(
        "(a x b).c = a.(b x c); x comes out of the integral", scalar_triple, take_out
    ).then(
        "r x (x x r) = x (r.r) - r (r.x), linear in x",
        bac_cab,
        linear_in(x),
        fold_into(J),
        label="quadratic-form",
    )
    d.state(
        Equation(square, number(0), ">="),
        "so x.J.x is not negative: zero only where all mass lies on the line of x through O",
        label="semi-definite",
        states=["002:C1"],
    )
    d.only("thin_rod", "about_centre")
    d.state(
        Equation(dot(J, RHO), zero("vector")),
        "the exception: along a thin rod through O the matrix is singular",
        label="thin-rod",
        states=["002:C1"],
    )


def _triangle(d: Derivation) -> None:
    """No moment exceeds the sum of the two others."""
    d.only()
    moments = []
    for k in (1, 2, 3):
        symbol = sp.Symbol(f"J_{k}{k}", positive=True)
        d.name_scalar(symbol, dot(unit("B", k), dot(J, unit("B", k))), f"moment about b{k}")
        moments.append(symbol)
    along = [dot(unit("B", k), RHO) for k in (1, 2, 3)]
    for k, condition in enumerate(principal_conditions(moments)):
        square = integral(number(2) * along[k] * along[k])
        d.state(
            Equation(expr(condition), square),
            "the two others less one moment is a sum of squares",
            label=f"triangle-{k + 1}",
        )
        d.state(Equation(square, number(0), ">="), "the triangle inequality")


def _rotation(d: Derivation) -> None:
    d.only()
    in_A, in_B = column(RHO, "A"), column(RHO, "B")
    turn = d.law(
        Equation(in_B, matmul(C_BA, in_A)),
        "the same vector in two frames",
        label="turn",
        states=["002:E29"],
    )
    start = d.state(by_tildes("O", "B"), "the inertia matrix in B", label="J-B", states=["002:E30"])
    inserted = start.then(
        "by components in A", use(turn.equation), label="J-B-inserted", states=["002:E30"]
    )
    identity = d.state(
        Equation(tilde(matmul(C_BA, in_A)), matmul(matmul(C_BA, tilde(in_A)), C_AB)),
        "a cross product may be formed in either frame",
        label="turned-tilde",
    )
    inserted.then(
        "for both factors", use(identity.equation), label="J-B-turned", states=["002:E31"]
    )
    _rotations_out(d, in_A)


def _rotations_out(d: Derivation, in_A: Term) -> None:
    d.law(
        Equation(matmul(C_AB, C_BA), quantity("identity_matrix")),
        "orthonormal",
        label="orthonormal",
    )
    outside = d.recall("J-B-turned").then(
        "C_AB C_BA = 1; the rotations come out of the integral",
        associate,
        put(matmul(matmul(matmul(C_BA, tilde(in_A)), C_AB), C_BA), matmul(C_BA, tilde(in_A))),
        to_the_right,
        take_out,
        associate,
        take_out,
        label="J-B-outside",
        states=["002:E31"],
    )
    outside.then(
        "the integral is minus the matrix in A",
        put(integral(matmul(tilde(in_A), tilde(in_A))), -J_A),
        distribute,
        associate,
        label="J-rotated",
        states=["002:E32"],
    )
    dyadic = quantity("dyadic", "D")
    d.state(
        Equation(column(dyadic, "B"), matmul(matmul(C_BA, column(dyadic, "A")), C_AB)),
        "as for every dyadic",
        label="dyadic-rotated",
    )


def _to_the_right(node: Term) -> Term:
    if node.head == "matmul" and node.args[0].head == "matmul":
        (a, b), c = node.args[0].args, node.args[1]
        return matmul(a, matmul(b, c))
    return node


def to_the_right(term: Term) -> Term:
    """Write (A B) C as A (B C), so that the first factor can come out of an integral."""
    return everywhere(_to_the_right)(everywhere(_to_the_right)(term))


def _shift(d: Derivation) -> None:
    d.only("rigid")
    a, b, step = position("dm", "OA"), position("dm", "OB"), position("OB", "OA")
    d.law(Equation(b, add(a, -step)), "the point O_B lies at r_BA from O_A", label="arm")
    start = d.state(by_tildes("OB", "B"), "the inertia matrix about O_B")
    columns = Equation(column(b, "B"), add(column(a, "B"), -column(step, "B")))
    d.state(columns, "in components", label="arm-columns")
    expanded = start.then(
        "multiplied out", use(columns), distribute, label="J-expanded", states=["002:E33"]
    )
    moment = quantity("first_moment", "body", "OA")
    first = d.state(
        Equation(integral(tilde(column(a, "B"))), tilde(column(moment, "B"))),
        "the first moment about O_A",
    )
    second = by_tildes("OA", "B")
    expanded.then(
        "what is the same for all elements comes out",
        take_out,
        use(first.equation),
        put(second.right.args[-1], -second.left),
        fold_into(MASS),
        distribute,
        label="J-shifted",
        states=["002:E34"],
    )
    from_C = tilde(column(position("OB", "C"), "B"))
    I_C, J_new = (column(quantity("inertia", p), "B") for p in ("C", "OB"))
    d.state(
        Equation(J_new, add(I_C, -mul(MASS, matmul(from_C, from_C)))),
        "from the centre of mass, whose first moment is zero: the parallel-axis theorem",
        label="J-parallel-axes",
        states=["002:E35"],
    )


def _principal(d: Derivation) -> None:
    d.only("principal_axes", "A_fixed_in_body")
    I_C = quantity("inertia", "C")
    symbols = sp.symbols("lambda_1:4", positive=True)
    for k, symbol in enumerate(symbols, 1):
        axis = unit("B", k)
        d.name_scalar(symbol, dot(axis, dot(I_C, axis)), f"principal moment about b{k}")
        column_of = column(axis, "A")
        d.law(
            Equation(matmul(column(I_C, "A"), column_of), expr(symbol) * column_of),
            "a principal axis is an eigenvector, the moment its eigenvalue",
            label=f"eigenvector-{k}",
        )
    d.state(
        Equation(C_BA, make("rows", [column(unit("B", k), "A") for k in (1, 2, 3)])),
        "unit eigenvectors in right-handed order are the rows of the rotation matrix",
        label="rows",
        states=["000:E17", "002:C2"],
    )
    diagonal = entries(sp.diag(*symbols))
    d.state(
        Equation(matmul(matmul(C_BA, column(I_C, "A")), C_AB), diagonal),
        "which takes the matrix to its diagonal form",
        label="diagonal",
        states=["000:E17", "000:E18"],
    )
    d.state(Equation(column(I_C, "B"), diagonal), "the principal inertia matrix", label="principal")
    d.state(
        Equation(matmul(matmul(inverse(C_AB), column(I_C, "A")), C_AB), diagonal),
        "with the eigenvectors as columns of E = C_AP",
        label="diagonalised",
        states=["002:E36", "002:C2"],
    )
