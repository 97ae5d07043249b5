"""A gyrostat: a rigid body with any number of rotors, symmetric about their axes."""

from __future__ import annotations

import sympy as sp

from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.kinematics.frames import first_derivative, time_derivative, vector
from eom.mechanics.gyrostat import gyrostat
from eom.mechanics.rigidbody import OMEGA
from eom.system import System
from eom.terms.rules import (
    differentiate,
    differentiate_under,
    distribute,
    inside,
    into_sums,
    transport,
    use,
    vanish,
)
from eom.terms.terms import Equation, add, cross, der, dot, entries, expr, mul, number, total, zero
from eom.terms.vocabulary import omega, quantity

W = omega()
J, H = quantity("inertia", "C"), quantity("angular_momentum", "body", "C")
TORQUE = quantity("torque", "body", "C")
AXIS, SPEED, INERTIA, MOMENTUM = (
    quantity(n, "k") for n in ("rotor_axis", "rotor_speed", "rotor_inertia", "rotor_momentum")
)
ROTORS = total(mul(INERTIA, SPEED, AXIS), "k", "rotors")


def gyrostat_momentum() -> Derived:
    """Derive momentum and equations of motion of a body with rotors, for any number of them."""
    d = Derivation("gyrostat", "A gyrostat: a body with any number of rotors", "Spinning bodies")
    _body(d)
    _rotor(d)
    system = gyrostat(2)
    _check_equations(d, system)
    return d.finish(equations=system)


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
    d.law(Equation(der(AXIS, "B"), zero("vector")), "the axes are fixed in the body", label="axis")
    d.law(
        Equation(der(J, "B"), zero("dyadic")),
        "rotors are symmetric about their axes: the inertia of the whole is constant in B",
        label="J-constant",
    )
    momentum = d.state(
        Equation(H, add(dot(J, W), ROTORS)),
        "all turn with the body; each rotor adds its own spin",
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
    rate = d.start(der(H)).then(
        "the transport theorem, with h inserted",
        transport("B"),
        use(local.equation),
        use(momentum.equation),
        distribute,
        label="rate",
    )
    d.assume("newton_2", "third_law_strong")
    d.law(Equation(der(H), TORQUE), "the torque about the centre of mass", label="law")
    rate.both(
        "dh/dt is the torque: the equation of the whole",
        use(Equation(der(H), TORQUE)),
        into_sums,
        label="equation",
    )


def _rotor(d: Derivation) -> None:
    d.only("rotors")
    axial = dot(AXIS, MOMENTUM)
    d.state(
        Equation(axial, mul(INERTIA, add(SPEED, dot(AXIS, W)))),
        "the axial momentum of a rotor, about its own centre of mass",
        label="axial-momentum",
    )
    d.state(
        Equation(dot(AXIS, der(MOMENTUM)), der(axial)),
        "its rate is that of the whole momentum along the axis, as the rotor is symmetric",
        label="axial-rate",
    )
    written = add(mul(INERTIA, der(SPEED)), mul(INERTIA, dot(AXIS, der(W, "B"))))
    d.state(
        Equation(dot(AXIS, der(MOMENTUM)), written),
        "this is the torque of the motor: the equation of each rotor",
        label="rotor-equation",
    )
    d.state(
        Equation(dot(AXIS, cross(W, MOMENTUM)), number(0)),
        "no gyroscopic term acts along the axis",
        label="no-axial-term",
    )
