"""Torque-free motion: constants, ellipsoids, polhodes, stability, precession (000, last page)."""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.derivations.rotation import explicit
from eom.mechanics import freebody, steady
from eom.mechanics.freebody import MOMENTS, herpolhode_rate
from eom.mechanics.rigidbody import OMEGA, angular_momentum, free_rigid_body
from eom.terms.rules import components, compute, scalars_in, use
from eom.terms.terms import (
    Equation,
    add,
    column,
    cross,
    der,
    dot,
    entries,
    expr,
    matmul,
    mul,
    number,
    tilde,
    zero,
)
from eom.terms.vocabulary import omega, quantity, unit

Expr = Any
W = omega()
J, H = quantity("inertia", "C"), quantity("angular_momentum", "body", "C")
ENERGY = quantity("rotational_energy", "body", "C")
TORQUE = quantity("torque", "body", "C")
AXES = tuple(unit("B", k) for k in (1, 2, 3))
H_SYMBOL, T_SYMBOL = freebody.H, freebody.T
PAIRS = tuple(zip(OMEGA.components, MOMENTS, strict=True))


def torque_free_motion() -> Derived:
    """Derive the constants of torque-free motion, and what they say about it."""
    d = Derivation("torque-free-motion", "Torque-free motion of a rigid body", "Torque-free motion")
    _constants(d)
    _ellipsoids(d)
    _polhode(d)
    _stability(d)
    _herpolhode(d)
    _precession(d)
    _constant_rates(d)
    return d.finish(equations=free_rigid_body("quaternion"), **_results())


def _results() -> dict[str, Expr]:
    return {
        f"squared growth rate about b{k}": steady.steady_spin(k).squared_growth_rate
        for k in (1, 2, 3)
    }


def _constants(d: Derivation) -> None:
    d.only("torque_free")
    d.law(
        Equation(TORQUE, zero("vector")),
        "no torque about the centre of mass",
        label="free",
        states=["000:E35"],
    )
    d.state(
        Equation(der(H), zero("vector")),
        "so the angular momentum is constant in I",
        label="H-constant",
        states=["000:E35"],
    )
    d.state(
        Equation(der(dot(H, H)), number(0)),
        "its magnitude is constant in every frame, though it may turn in B",
        label="magnitude",
        states=["000:C5"],
    )
    d.state(
        Equation(der(ENERGY), number(0)),
        "and the energy of rotation is constant",
        label="T-constant",
        states=["000:C6"],
    )


def _ellipsoids(d: Derivation) -> None:
    d.only("torque_free", "principal_axes")
    for symbol, b in zip(MOMENTS, AXES, strict=True):
        d.name_scalar(symbol, dot(b, dot(J, b)), "principal moment of inertia")
    diagonal = d.state(
        Equation(column(J, "B"), entries(sp.diag(*MOMENTS))), "principal axes"
    ).equation
    rates = explicit(d, W, "omega", "B", "component of omega along b{k}")
    law = d.law(Equation(H, dot(J, W)), "momentum of a rigid body")
    parts = d.in_components(law, "B", "components in B").then(
        "by components", use(diagonal), use(rates), compute(), label="h-columns"
    )
    terms = (expr(e.data[0]) * b for e, b in zip(parts.equation.right.args, AXES, strict=True))
    d.state(Equation(H, add(*terms)), "as a vector", label="h", states=["000:E36"])
    square = d.start(dot(H, H)).then(
        "its square",
        scalars_in("B"),
        components("B"),
        use(parts.equation),
        compute(),
        label="H-squared",
        states=["000:E37"],
    )
    energy = d.law(Equation(ENERGY, number(1, 2) * dot(W, dot(J, W))), "energy of a rigid body")
    level = energy.then(
        "by components",
        scalars_in("B"),
        components("B"),
        use(diagonal),
        use(rates),
        compute(),
        label="T",
        states=["000:E39"],
    )
    _normal_forms(d, square.equation.right.data[0], level.equation.right.data[0])


def _normal_forms(d: Derivation, square: Expr, level: Expr) -> None:
    T_form, H_form = freebody.constants()
    d.check(Equation(ENERGY, expr(T_form)), "the library has the same T")
    d.check(Equation(dot(H, H), expr(H_form)), "the library has the same H^2")
    d.state(
        Equation(
            expr(sum((w / (H_SYMBOL / moment)) ** 2 for w, moment in PAIRS)),
            expr(square / H_SYMBOL**2),
        ),
        "the momentum ellipsoid, of semi-axes H/I1, H/I2, H/I3 in the space of rates",
        label="momentum-ellipsoid",
        states=["000:E38"],
    )
    d.state(
        Equation(
            expr(sum(w**2 / (2 * T_SYMBOL / moment) for w, moment in PAIRS)),
            expr(level / T_SYMBOL),
        ),
        "the energy ellipsoid, of squared semi-axes 2T/I1, 2T/I2, 2T/I3",
        label="energy-ellipsoid",
        states=["000:E38"],
    )


def _polhode(d: Derivation) -> None:
    w = OMEGA.components
    for k in (1, 2, 3):
        conic = freebody.projection(k)
        (i, j), (a, b) = conic.axes, conic.coefficients
        level = add(dot(H, H), -(expr(2 * MOMENTS[k - 1]) * ENERGY))
        d.state(
            Equation(level, expr(a * w[i - 1] ** 2 + b * w[j - 1] ** 2)),
            f"omega_{k} eliminated from both constants: the polhode as seen along b{k}",
            label=f"polhode-{k}",
        )
        d.check(
            Equation(expr(conic.level), expr(H_SYMBOL**2 - 2 * MOMENTS[k - 1] * T_SYMBOL)), "level"
        )


def _stability(d: Derivation) -> None:
    for k in (1, 2, 3):
        spin = steady.steady_spin(k)
        A = steady.linearised(free_rigid_body(), k)
        d.state(
            Equation(
                expr(sp.Determinant(sp.ImmutableMatrix(steady.ROOT * sp.eye(3) - A))),
                expr(spin.characteristic),
            ),
            f"Euler's equations linearised at a spin about b{k}: characteristic polynomial",
            label=f"characteristic-{k}",
        )
        d.state(
            Equation(
                expr(spin.characteristic),
                expr(steady.ROOT * (steady.ROOT**2 - spin.squared_growth_rate)),
            ),
            "unstable where the squared growth rate is positive: about the intermediate axis",
            label=f"growth-{k}",
        )


def _herpolhode(d: Derivation) -> None:
    d.only("torque_free")
    d.state(Equation(dot(W, H), number(2) * ENERGY), "the projection of omega on h", label="plane")
    d.state(
        Equation(dot(der(W), H), number(0)),
        "is constant: the tip of omega stays in the invariable plane",
        label="invariable-plane",
    )
    d.assume("principal_axes")
    h = angular_momentum(sp.diag(*MOMENTS), OMEGA)
    rho = OMEGA - h.scaled(OMEGA.dot(h) / h.dot(h))
    swept = herpolhode_rate() * sp.sqrt(h.dot(h)) * rho.dot(rho)
    d.state(
        Equation(dot(H, cross(W, der(W))), expr(sp.factor(swept))),
        "the tip turns about h at the rate (rho x rho').h/(H rho^2): the herpolhode",
        label="herpolhode",
    )


def _precession(d: Derivation) -> None:
    d.only("torque_free", "symmetric")
    It, Ia = sp.symbols("I_t I_a", positive=True)
    b3 = AXES[2]
    d.name_scalar(It, dot(AXES[0], dot(J, AXES[0])), "moment across the axis of symmetry")
    d.name_scalar(Ia, dot(b3, dot(J, b3)), "moment about the axis of symmetry")
    spin = dot(W, b3)
    d.state(
        Equation(der(spin), number(0)),
        "the spin about the axis of symmetry is constant",
        label="spin",
    )
    d.state(
        Equation(W, add(expr(1 / It) * H, mul(expr(1 - Ia / It), spin, b3))),
        "omega lies in the plane of h and the axis",
        label="plane-of-h",
    )
    d.state(
        Equation(der(b3), expr(1 / It) * cross(H, b3)),
        "the axis turns about h at the rate H/I_t: the space cone",
        label="precession",
    )
    d.state(Equation(der(dot(H, b3)), number(0)), "at a constant angle", label="nutation")
    d.state(
        Equation(der(W, "B"), mul(expr((Ia - It) / It), spin, cross(b3, W))),
        "in the body omega turns about the axis: the body cone",
        label="body-cone",
    )


def _constant_rates(d: Derivation) -> None:
    """The claim of 000 that rates are constant only without torque and about one principal axis."""
    for k, (case, motion) in enumerate(steady.constant_rate_counterexamples().items(), 1):
        rates, inertia = entries(motion.omega.column), entries(sp.Matrix(motion.inertia))
        d.state(
            Equation(matmul(tilde(rates), matmul(inertia, rates)), entries(motion.torque.column)),
            f"rates stay constant, as omega x J.omega is the torque: {case}",
            label=f"constant-rates-{k}",
            states=["000:C2", "000:C3", "000:C4"],
        )
