"""Whether an expression stays constant along every solution of a system, exactly."""

from __future__ import annotations

from typing import Any

from eom.exact.identity import RandomPoint, zero_at_random_points
from eom.fields import PRIME, RESIDUES, solve
from eom.system import System

Expr = Any


def is_invariant(system: System, expression: Expr, *, points: int = 3, seed: int = 0) -> bool:
    """Return whether ``expression`` stays constant along every solution of ``system``.

    The time derivative is formed by the chain rule; where the system has a mass matrix, the
    accelerations come from solving it at each point modulo the prime. Inputs may change with time,
    so that nothing that contains one is constant.
    """
    full = system.expand(expression)
    if full.free_symbols & {q.symbol for q in system.inputs}:
        return False
    gradient = [full.diff(q.symbol) for q in system.states]
    explicit = full.diff(system.time)
    rates = [system.expand(r) for r in system.rates]
    mass = (
        None
        if system.mass_matrix is None
        else [[system.expand(e) for e in row] for row in system.mass_matrix.tolist()]
    )

    def residual(point: RandomPoint) -> int:
        velocity = [point.value(r) for r in rates]
        if mass is not None:
            velocity = solve([[point.value(e) for e in row] for row in mass], velocity, RESIDUES)
        work = sum(point.value(g) * v for g, v in zip(gradient, velocity, strict=True))
        return int(work + point.value(explicit)) % PRIME

    return zero_at_random_points(residual, points, seed)
