"""Properties of the inertia matrix: symmetry, sign, rotation, shift, principal axes (002: 3.28-3.35)."""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.derivations.chapters.rigid import inertia_by_definition, inertia_by_tildes
from eom.derivations.chapters.rotation import principal_matrix, turned_tilde
from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.terms.rules import (
    associate,
    at,
    bac_cab,
    by_way_of,
    combine,
    components,
    compute,
    determinants,
    distribute,
    everywhere,
    fold_into,
    inside,
    linear_in,
    orthonormal,
    resolved,
    reversed_rotation,
    rotations_in_turn,
    scalar_triple,
    scalars_in,
    take_out,
    through_sums,
    to_the_right,
    transposed,
    unfold,
    use,
)
from eom.terms.rules.inferences import (
    cancelled,
    equal,
    instance,
    renamed,
    solved,
    squares,
    squares_right,
    summed,
)
from eom.terms.terms import (
    Equation,
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
    number,
    tilde,
    transpose,
    zero,
)
from eom.terms.vocabulary import position, quantity, unit

RHO, PLACE = position("dm", "O"), position("i", "O")
X, V = quantity("vector", "x"), quantity("vector", "v")
J = quantity("inertia", "O")
J_A, J_B = column(J, "A"), column(J, "B")
C_BA, C_AB = quantity("rotation", "B", "A"), quantity("rotation", "A", "B")
MASS = quantity("total_mass", "body")


def inertia_properties() -> Derived:
    """Derive what holds for the inertia matrix of every body, and how it changes with axes and point."""
    d = Derivation("inertia-properties", "Properties of the inertia matrix", "Inertia")
    form = _sign(d)
    _thin_rod(d)
    _triangle(d, form)
    _places(d)
    _rotation(d)
    _shift(d)
    _principal(d)
    return d.finish()


def _sign(d: Derivation) -> Chain:
    d.only()
    d.define(J, "inertia dyadic about O", label="inertia")
    d.show(
        Equation(transpose(J_B), J_B),
        "symmetric, as each term of the integrand is its own transpose",
        unfold("inertia"),
        components("B"),
        scalars_in("B"),
        through_sums,
        transposed,
        label="symmetric",
        states=["002:C1"],
    )
    square = integral(dot(cross(X, RHO), cross(X, RHO)))
    form = (
        d.start(square)
        .then(
            "(x x rho).(x x rho) = x.(rho x (x x rho)); x comes out of the integral",
            scalar_triple,
            take_out,
        )
        .then(
            "rho x (x x rho) = x (rho.rho) - rho (rho.x), linear in x",
            bac_cab,
            linear_in(X),
            fold_into(J),
            label="quadratic-form",
        )
    )
    form.infer(
        "so x.J_O.x is not negative: zero only where all mass lies on the line of x through O",
        squares,
        label="semi-definite",
        states=["002:C1"],
    )
    return form


def _thin_rod(d: Derivation) -> None:
    """The exception: a thin rod through O has no moment about its own line."""
    product = d.start(dot(J, V)).then(
        "the definition, with any vector v", unfold("inertia"), label="J-of-v"
    )
    double = d.start(integral(cross(RHO, cross(V, RHO)))).then(
        "rho x (v x rho) = v (rho.rho) - rho (rho.v), linear in v",
        bac_cab,
        linear_in(V),
        label="double-of-v",
    )
    applied = d.show(
        Equation(product.equation.left, double.equation.left),
        "both are the same: J_O.v sums up rho x (v x rho)",
        use(product.equation),
        use(double.equation),
        label="J-double",
    )
    d.only("thin_rod", "about_centre")
    line = d.given(
        Equation(cross(PLACE, RHO), zero("vector")),
        "all mass lies on one line through O: places are parallel",
        label="on-a-line",
    )
    applied.infer("for a place on the rod itself", instance({V: PLACE}), label="J-of-place").then(
        "the exception: along a thin rod through O the matrix is singular",
        use(line.equation),
        label="thin-rod",
        states=["002:C1"],
    )


def _triangle(d: Derivation, form: Chain) -> None:
    """No moment exceeds the sum of the two others."""
    d.only()
    quadratic = form.turned("the quadratic form, turned round", label="quadratic-form-turned")
    lines = [_moment(d, quadratic, k) for k in (1, 2, 3)]
    for k in range(3):
        signs = [number(-1 if j == k else 1) for j in range(3)]
        lines[0].infer(
            "the two others less one moment is a sum of squares",
            summed(*signs, applied=(distribute, combine)),
            *lines[1:],
            label=f"triangle-{k + 1}",
        ).infer("the triangle inequality: it is not negative", squares_right)


def _moment(d: Derivation, quadratic: Chain, k: int) -> Chain:
    """Write the moment about b_k by squared distances from this axis."""
    b = unit("B", k)
    name = d.name_scalar(
        sp.Symbol(f"J_{k}{k}", positive=True), dot(b, dot(J, b)), f"moment about b{k}"
    )
    along = quadratic.infer(f"where the vector x is b{k}", instance({X: b}))
    return along.both(
        f"with rho by its components: squared distances from the axis b{k}",
        use(name.equation, backwards=True),
        inside("cross", everywhere(resolved(RHO, "B"))),
        *2 * (distribute, orthonormal("B")),
        distribute,
        label=f"moment-{k}",
    )


def _places(d: Derivation) -> None:
    """State the same place along the axes of both frames."""
    for frame in ("A", "B"):
        d.start(RHO).then(
            f"the place of an element, along the axes of {frame}",
            resolved(RHO, frame),
            label=f"place-{frame}",
            states=["002:E29"],
        )


def _rotation(d: Derivation) -> None:
    d.only()
    in_A, in_B = column(RHO, "A"), column(RHO, "B")
    turn = d.law(
        Equation(in_B, matmul(C_BA, in_A)),
        "the same vector in two frames",
        label="turn",
        states=["002:E29"],
    )
    written = inertia_by_definition(d, "O", "J-B-definition")
    start = inertia_by_tildes(d, written, "O", label="J-B", states=["002:E30"])
    inserted = start.then(
        "by components in A", use(turn.equation), label="J-B-inserted", states=["002:E30"]
    )
    identity = turned_tilde(d, RHO, turn.equation)
    turned = inserted.then(
        "for both factors", use(identity.equation), label="J-B-turned", states=["002:E31"]
    )
    outside = turned.then(
        "C_AB C_BA = 1; the rotations come out of the integral",
        to_the_right,
        rotations_in_turn,
        take_out,
        associate,
        take_out,
        label="J-B-outside",
        states=["002:E31"],
    )
    in_frame_A = inertia_by_definition(d, "O", "J-A-definition", "A")
    by_A = inertia_by_tildes(d, in_frame_A, "O", "A", label="J-A").infer(
        "solved for the integral", solved(integral(matmul(tilde(in_A), tilde(in_A))))
    )
    outside.then(
        "the integral is minus the matrix in A",
        use(by_A.equation),
        distribute,
        label="J-rotated",
        states=["002:E32", "002:E36"],
    )
    _every_dyadic(d)


def _every_dyadic(d: Derivation) -> None:
    """The same for every dyadic, from its product with any vector."""
    dyadic = quantity("dyadic", "D")
    product, any_column = column(dot(dyadic, V), "B"), column(V, "B")
    in_B = d.start(product).then("any dyadic times any vector, in B", components("B"))
    in_A = d.start(product).then(
        "the same formed in A, v taken there and the product back",
        by_way_of("A", "B"),
        components("A"),
        at(column(V, "A"), by_way_of("B", "A")),
        associate,
    )
    in_B.infer("both are the same product", equal(), in_A).infer(
        "as v is any vector: so every dyadic is turned",
        cancelled(any_column),
        label="dyadic-rotated",
    )


def _shift(d: Derivation) -> None:
    d.only("rigid")
    a, b, step = position("dm", "OA"), position("dm", "OB"), position("OB", "OA")
    arm = d.law(
        Equation(b, add(a, -step)),
        "a place from O_B is that from O_A less the place of O_B",
        label="arm",
    )
    written = inertia_by_definition(d, "OB", "J-OB-definition")
    start = inertia_by_tildes(d, written, "OB", label="J-OB")
    columns = d.in_components(arm, "B", "in components", distribute, label="arm-columns")
    expanded = start.then(
        "multiplied out", use(columns.equation), distribute, label="J-expanded", states=["002:E33"]
    )
    moment = quantity("first_moment", "body", "OA")
    first = d.start(tilde(column(moment, "B"))).then(
        "the first moment about O_A; the skew matrix is linear",
        unfold("first_moment"),
        components("B"),
        through_sums,
        label="first-moment-tilde",
    )
    about_A = inertia_by_tildes(d, inertia_by_definition(d, "OA", "J-OA-definition"), "OA")
    shifted = expanded.then(
        "what is the same for all elements comes out",
        take_out,
        use(first.equation, backwards=True),
        use(about_A.equation, backwards=True),
        fold_into(MASS),
        distribute,
        label="J-shifted",
        states=["002:E34"],
    )
    _from_centre(d, shifted)


def _from_centre(d: Derivation, shifted: Chain) -> None:
    of_centre = d.law(
        Equation(quantity("first_moment", "body", "C"), zero("vector")),
        "the first moment about the centre of mass is zero",
        label="first-moment-of-centre",
    )
    shifted.infer("O_A may be any point: from the centre of mass", renamed({"OA": "C"})).then(
        "whose first moment is zero: the parallel-axis theorem",
        use(of_centre.equation),
        distribute,
        label="J-parallel-axes",
        states=["002:E35"],
    )


def _principal(d: Derivation) -> None:
    d.only("principal_axes", "A_fixed_in_body")
    d.law(
        Equation(C_BA, make("rows", [column(unit("B", k), "A") for k in (1, 2, 3)])),
        "unit eigenvectors in right-handed order are the rows of the rotation matrix",
        label="rows",
        states=["000:E17", "002:C2"],
    )
    _principal_about(d, "C", sp.symbols("lambda_1:4", positive=True), ("000:E17", "000:E18"))
    _no_rotation(d)
    d.only("principal_at_O", "principal_axes", "A_fixed_in_body")
    _principal_about(d, "O", sp.symbols("mu_1:4", positive=True), ())


def _no_rotation(d: Derivation) -> None:
    """Refute that any matrix of eigenvectors is a rotation: one that is stretched, one left-handed."""
    values = sp.diag(*sp.symbols("lambda_1:4", positive=True))
    cases = (
        ("stretched", sp.diag(2, 1, 1), "with the first one twice as long"),
        ("exchanged", sp.Matrix([[0, 1, 0], [1, 0, 0], [0, 0, 1]]), "with the first two exchanged"),
    )
    for name, E, words in cases:
        d.start(matmul(matmul(entries(E.inv()), entries(values)), entries(E))).then(
            f"in place of C_AB other columns that are eigenvectors, {words}: the product is diagonal all "
            "the same",
            compute(),
            label=f"{name}-diagonal",
            states=["002:C2"],
        )
    stretched, exchanged = (E for _, E, _ in cases)
    d.start(matmul(transpose(entries(stretched)), entries(stretched))).then(
        "but of the first one the transpose is not the inverse: it is no rotation",
        compute(),
        label="stretched-no-rotation",
        states=["002:C2"],
    )
    d.start(expr(sp.Determinant(sp.ImmutableMatrix(exchanged)))).then(
        "and of the other the determinant is not 1: it mirrors",
        determinants,
        label="exchanged-no-rotation",
        states=["002:C2"],
    )


def _principal_about(
    d: Derivation, point: str, moments: tuple[Any, ...], states: tuple[str, ...]
) -> None:
    """Derive the diagonal form about a point along whose principal axes b1, b2, b3 are."""
    I_P, end = quantity("inertia", point), "" if point == "C" else f"-{point}"
    principal = principal_matrix(d, I_P, moments, end=end, label=f"principal{end}")
    for k in (1, 2, 3):
        d.in_components(
            d.recall(f"principal-axis-{k}{end}"),
            "A",
            "in components along any axes: a principal axis is an eigenvector, the moment its "
            "eigenvalue",
            distribute,
            label=f"eigenvector-{k}{end}",
        )
    turned = d.recall("dyadic-rotated").infer(
        f"for the inertia about {point}", instance({quantity("dyadic", "D"): I_P})
    )
    diagonal = turned.turned("turned round").then(
        "which takes the matrix to its diagonal form",
        use(principal.equation),
        label=f"diagonal{end}",
        states=states,
    )
    d.show(
        Equation(matmul(matmul(inverse(C_AB), column(I_P, "A")), C_AB), diagonal.equation.right),
        "with the eigenvectors as columns of C_AB, whose inverse is the reverse rotation",
        reversed_rotation,
        use(diagonal.equation),
        label=f"diagonalised{end}",
        states=["002:E36", "002:C2"],
    )
