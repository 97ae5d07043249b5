"""A gyrostat: a rigid body with any number of rotors, symmetric about their axes."""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.derivations import standing
from eom.derivations.chapters.rotation import name_spin
from eom.derivations.conditions import let, so
from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.exact.algebra import gather_above
from eom.kinematics.frames import first_derivative, time_derivative, vector
from eom.mechanics.gyrostat import gyrostat
from eom.mechanics.rigidbody import OMEGA
from eom.mechanics.steady import ROOT, SPIN_RATE
from eom.system import System
from eom.terms.rules import (
    combine,
    differentiate,
    differentiate_in,
    differentiate_under,
    distribute,
    entrywise,
    inside,
    into_sums,
    put_in,
    transport,
    triple_in_order,
    use,
    vanish,
)
from eom.terms.rules.inferences import characteristic, equal, solved, summed
from eom.terms.terms import Equation, add, cross, der, dot, entries, expr, mul, number, total, zero
from eom.terms.vocabulary import omega, quantity

W = omega()
J, H = quantity("inertia", "C"), quantity("angular_momentum", "body", "C")
TORQUE = quantity("torque", "body", "C")
Expr = Any
AXIS, SPEED, INERTIA, MOMENTUM = (
    quantity(n, "k") for n in ("rotor_axis", "rotor_speed", "rotor_inertia", "rotor_momentum")
)
ALONG = sp.Symbol("h_a", real=True)
ROTORS = total(mul(INERTIA, SPEED, AXIS), "k", "rotors")


def gyrostat_momentum() -> Derived:
    """Derive momentum and equations of motion of a body with rotors, for any number of them."""
    d = Derivation("gyrostat", "A gyrostat: a body with any number of rotors", "Spinning bodies")
    _body(d)
    _rotor(d)
    system = gyrostat(2)
    _check_equations(d, system)
    _dual_spin(d)
    d.stands.update(_called(system))
    return d.finish(equations=system)


def _called(system: System) -> standing.Stands:
    """Return what the system's quantities are: those of the body, and of each rotor."""
    rotors = range(1, len(system.inputs) + 1)
    names = {"Js": "rotor_inertia", "Omega": "rotor_speed", "u": "rotor_torque"}
    own = {f"{s}_{k}": quantity(name, str(k)) for s, name in names.items() for k in rotors}
    speeds = [sp.Symbol(f"Omega_{k}", real=True) for k in rotors]
    rates = {f"rotor_rate_{k}": expr(s + OMEGA.components[k - 1]) for k, s in enumerate(speeds, 1)}
    return {
        "h": H,
        "J": J,
        "T": quantity("rotational_energy", "body", "C"),
        "T_omega": None,
        **own,
        **rates,
    }


def _check_equations(d: Derivation, system: System) -> None:
    """Two rotors about b1 and b2, in principal axes: dh/dt = 0, and each axial momentum has its motor."""
    full = map(system.expand, system.rates)
    rates = dict(zip((q.symbol for q in system.states), full, strict=True))
    outputs = {o.name: system.expand(o.expression) for o in system.outputs}
    h = vector("B", (outputs[f"h_{k}"] for k in (1, 2, 3)))
    rate = first_derivative(h, OMEGA, rates).total
    d.check(Equation(entries(rate.column), entries(sp.zeros(3, 1))), "momentum of the system")
    speeds = [outputs[f"Omega_{k}"] for k in (1, 2)]
    for k, (speed, motor) in enumerate(zip(speeds, system.inputs, strict=True)):
        inertia = sp.Symbol(f"Js_{k + 1}", positive=True)
        turning = inertia * time_derivative(speed + OMEGA.components[k], rates)
        d.check(Equation(expr(turning), expr(motor.symbol)), "a rotor of the system")


def _body(d: Derivation) -> None:
    d.only("rotors")
    d.given(
        Equation(der(AXIS, "B"), zero("vector")), "the axes are fixed in the body", label="axis"
    )
    d.given(Equation(der(INERTIA), number(0)), "rotors are rigid", label="rotor-inertia-constant")
    d.given(
        Equation(der(J, "B"), zero("dyadic")),
        "rotors are symmetric about their axes: the inertia of the whole is constant in B",
        label="J-constant",
    )
    rate = _rate(d)
    d.assume("newton_2", "third_law_strong")
    law = d.law(Equation(der(H), TORQUE), "the torque about the centre of mass", label="law")
    rate.both(
        "h_C' is the torque: the equation of the whole",
        use(law.equation),
        into_sums,
        label="equation",
    )


def _rate(d: Derivation) -> Chain:
    momentum = d.law(
        Equation(H, add(dot(J, W), ROTORS)),
        "momentum of a gyrostat: all turn with the body, and each rotor about its axis besides",
        label="momentum",
    )
    local = momentum.both(
        "differentiate in B",
        lambda t: der(t, "B"),
        differentiate,
        differentiate_under,
        inside("sum", differentiate),
        vanish(der(J, "B"), der(AXIS, "B"), der(INERTIA)),
        distribute,
        label="local-rate",
    )
    return d.start(der(H)).then(
        "the transport theorem, with h_C inserted",
        transport("B"),
        use(local.equation),
        use(momentum.equation),
        distribute,
        label="rate",
    )


def _rotor(d: Derivation) -> None:
    """Derive the equation of a rotor: its motor's torque is the rate of its axial momentum."""
    d.only("rotors")
    turning = d.start(der(AXIS)).then(
        "the axis turns with the body",
        transport("B"),
        use(d.recall("axis").equation),
        distribute,
        label="axis-turns",
    )
    plane = d.given(
        Equation(triple_in_order(dot(cross(W, AXIS), MOMENTUM)), number(0)),
        "a rotor is symmetric about its axis: its momentum, about its own centre of mass, lies in the "
        "plane of omega and the axis",
        label="rotor-plane",
    )
    axial = d.law(
        Equation(dot(AXIS, MOMENTUM), mul(INERTIA, add(SPEED, dot(AXIS, W)))),
        "its axial momentum: its moment times its own rate and that of the body",
        label="axial-momentum",
    )
    d.show(
        Equation(dot(AXIS, cross(W, MOMENTUM)), number(0)),
        "no gyroscopic term acts along the axis",
        triple_in_order,
        use(plane.equation),
        label="no-axial-term",
    )
    _motor(d, axial, turning, plane)
    _with_motors(d)


def _motor(d: Derivation, axial: Chain, turning: Chain, plane: Chain) -> None:
    """Derive that the motor's torque is the rate of the axial momentum."""
    d.define(quantity("rotor_torque", "k"), "torque of the motor", label="motor")
    rate = d.start(der(axial.equation.left)).then(
        "the axial rate is that of the whole momentum along the axis: the motor's torque",
        differentiate,
        use(turning.equation),
        triple_in_order,
        use(plane.equation),
        use(d.recall("motor").equation, backwards=True),
        label="axial-rate",
    )
    axial.both(
        "differentiate; the axis is fixed in B",
        der,
        distribute,
        differentiate_in("B"),
        use(d.recall("rotor-inertia-constant").equation),
        use(d.recall("axis").equation),
        distribute,
        label="axial-momentum-rate",
    ).infer("both are the same rate", equal(), rate, label="rotor-balance").turned(
        "the equation of each rotor: its motor changes its rate and that of the body along the axis",
        label="rotor-equation",
    )


def _with_motors(d: Derivation) -> None:
    """Put the motors' torques into the equation of the whole."""
    d.only("rotors", "newton_2", "third_law_strong")
    motors = d.recall("rotor-equation").both(
        "along the axes, for all rotors together",
        lambda t: distribute(total(mul(t, AXIS), "k", "rotors")),
        label="all-rotors",
    )
    d.recall("equation").infer(
        "less that of the rotors: the body feels the opposite torques of the motors, and its inertia "
        "is less what the rotors have about their axes",
        summed(number(1), number(-1), applied=(distribute, combine)),
        motors,
        label="equation-motors",
    )


def _by_powers(e: Expr) -> Expr:
    """Write a polynomial in lambda by its powers, with factored coefficients."""
    polynomial = sp.Poly(sp.expand(e), ROOT)
    return sp.Add(*(sp.factor(c) * ROOT**n for (n,), c in polynomial.terms()))


def _dual_spin(d: Derivation) -> None:
    """One rotor about b1: when a spin about its axis is stable, whatever the moments."""
    d.only()
    system = gyrostat(1)
    for q in (*system.parameters, *system.states):
        d.letter(q.symbol, q.meaning)
    name_spin(d)
    states = [q.symbol for q in system.states]
    named = _rates_with_rotor(d, system)
    spin = {states[0]: SPIN_RATE, states[1]: sp.Integer(0), states[2]: sp.Integer(0)}
    across = named[1].infer(
        "linearised at a spin nu of the body about the rotor's axis: characteristic polynomial",
        characteristic(states[1:3], spin, ROOT),
        named[2],
        label="dual-spin",
    )
    _by_axial_momentum(d, system, across)


def _rates_with_rotor(d: Derivation, system: System) -> list[Chain]:
    """State the rates in principal axes, and show that they keep the momentum of body and rotor."""
    quiet = {q.symbol: sp.Integer(0) for q in system.inputs}
    rates = [system.expand(r).xreplace(quiet) for r in system.rates]
    moving = {q.symbol: sp.Symbol(f"{q.symbol}_dot", real=True) for q in system.states[:3]}
    named = [
        d.name_scalar(
            symbol,
            expr(gather_above(rate, OMEGA.components)),
            f"rate of {w}, with a rotor about b1 whose motor gives no torque, in principal axes",
            label=f"{w}-rate",
        )
        for (w, symbol), rate in zip(moving.items(), rates, strict=False)
    ]
    outputs = {o.name: system.expand(o.expression) for o in system.outputs}
    h = vector("B", (outputs[f"h_{k}"] for k in (1, 2, 3)))
    moving[system.states[3].symbol] = sp.Integer(0)
    d.show(
        Equation(entries(first_derivative(h, OMEGA, moving).total.column), entries(sp.zeros(3, 1))),
        "they keep the momentum of body and rotor, as p_1 is constant: its rate in B and omega x h_C "
        "put together",
        put_in(*(line.equation for line in named)),
        label="momentum-kept",
    )
    return named


def _by_axial_momentum(d: Derivation, system: System, across: Chain) -> None:
    """Write the polynomial by the momentum along the axis, which decides about stability."""
    rotor = system.states[3].symbol
    I1, Js = (q.symbol for q in system.parameters if str(q.symbol) in {"I1", "Js_1"})
    h = d.name_scalar(
        ALONG,
        expr((I1 - Js) * SPIN_RATE + rotor),
        "angular momentum of body and rotor along the axis",
        label="axial",
    )
    momentum = h.infer("solved for the rotor's part", solved(expr(rotor)), label="rotor-part")
    across.then(
        "by the momentum along the axis: stable where it exceeds both I2 nu and I3 nu, or is less "
        "than both. A rotor that is fast enough steadies a spin about any principal axis, even the "
        "intermediate one",
        put_in(momentum.equation),
        entrywise(_by_powers),
        label="dual-spin-stability",
    )
    _dual_spin_sign(d, h.equation.left.expression)


def _dual_spin_sign(d: Derivation, h: Expr) -> None:
    """Derive that what is free of lambda is not negative where the momentum is large."""
    I2, I3 = (next(s for s in d.letters if s.name == name) for name in ("I2", "I3"))
    above = [h - moment * SPIN_RATE for moment in (I2, I3)]
    given = let(
        d,
        *(
            (e, words, f"above-{moment}")
            for e, words, moment in zip(
                above,
                ("let the momentum along the axis be no less than I2 nu", "nor less than I3 nu"),
                (I2, I3),
                strict=True,
            )
        ),
    )
    so(
        given,
        above[0] * above[1],
        ((above[0], above[1]),),
        "then -lambda^2 is not negative, whatever the order of the moments: dual spin is stable",
        "dual-spin-sign",
    )
