"""Random trees of all joints that Pinocchio has too: its values beside ours.

Numbers and programs are those of the product's recursions: forward and inverse dynamics, mass matrix
and energies in double precision; derivatives from the generated programs of
`codegen.derivatives.derivative`, evaluated by the interpreter. Pinocchio's derivatives are by displacements
along its speeds; ours, by coordinates, are multiplied by N of q' = N u. ``python -m benchmarks.trees``
takes `COUNT` trees.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.peers import absent, missing
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, alone
from codegen.derivatives.derivative import JACOBIAN, jacobian
from codegen.ir import scalars
from codegen.ir.interpret import Point, interpret
from codegen.ir.program import RATES, Builder
from eom.multibody import Tree
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.recursion.lumped_tree import LumpedTree, lumped_tree
from eom.multibody.recursion.motion import coordinate_rates
from eom.multibody.recursion.quantities import flow, gravity_potential, kinetic_energy
from eom.multibody.recursion.recursions import forward_dynamics, inverse_dynamics, mass_matrix
from tests.eom.multibody.peer import SHARED, pinocchio, shared_tree, their_state

COUNT = 200
QUICK_COUNT = 4
SIZES = (3, 4, 5, 6)
LARGEST_DIFFERENTIATED = 4
"""Bodies of trees whose derivatives are compared."""
LARGEST = 1e-12
"""Of a difference, over the largest entry of the vector or matrix in question by size."""

Array = NDArray[np.float64]
Scalars = Sequence[float]
FLOATS = Numbers(math.sin, math.cos)


def measure(settings: Settings) -> Section:
    """Return a row a quantity: the largest relative difference over all trees."""
    count = QUICK_COUNT if settings.quick else COUNT
    title = f"{count} random trees of shared joints: largest relative difference from Pinocchio"
    if missing("pin"):
        return Section(title, (absent("Pinocchio", ["pin"]),))
    worst: dict[str, float] = {}
    for seed in range(count):
        for name, difference in differences(seed, SIZES[seed % len(SIZES)]).items():
            worst[name] = max(worst.get(name, 0.0), difference)
    return Section(
        title,
        tuple(
            Row(n, f"{d:.1e}", target=f"<= {LARGEST:g}", met=d <= LARGEST) for n, d in worst.items()
        ),
    )


def floats(x: Any) -> Any:
    """Return a number as a double; zero and one are structure."""
    return x if x in (0, 1) else float(x)


def differences(seed: int, count: int) -> Mapping[str, float]:
    """Return the relative differences of a random tree, by quantity."""
    import pinocchio as pin

    given, q, u = shared_tree(seed, count)
    lumped = lumped_tree(given, floats, FLOATS)
    model = pinocchio(pin, given)
    data = model.createData()
    theirs, v, order = their_state(given, q, u)
    square = np.ix_(order, order)
    tau, udot = _drawn(seed, len(u)), _drawn(seed + 1, len(u))
    motion = flow(lumped, q, u, FLOATS)
    found = forward_dynamics(lumped, q, u, list(tau), FLOATS)
    needed = inverse_dynamics(lumped, q, u, list(udot), FLOATS)
    M = pin.crba(model, data, theirs)
    return {
        "forward dynamics": relative(found, pin.aba(model, data, theirs, v, tau[order]), order),
        "inverse dynamics": relative(needed, pin.rnea(model, data, theirs, v, udot[order]), order),
        "mass matrix": relative(
            mass_matrix(lumped, q, FLOATS), np.triu(M) + np.triu(M, 1).T, square
        ),
        "kinetic energy": relative(
            [kinetic_energy(motion, u)], [pin.computeKineticEnergy(model, data, theirs, v)]
        ),
        "potential energy": relative(
            [gravity_potential(lumped, motion)], [pin.computePotentialEnergy(model, data, theirs)]
        ),
        **_of_derivatives(seed, min(count, LARGEST_DIFFERENTIATED)),
    }


def _of_derivatives(seed: int, count: int) -> Mapping[str, float]:
    """Return differences of derivatives, of a tree without universal joints.

    Pinocchio's derivatives leave out that the axes of a universal joint turn: they are not those of its
    own values, by differences.
    """
    import pinocchio as pin

    kinds = [kind for kind in SHARED if kind != "universal"]
    given, q, u = shared_tree(seed, count, kinds)
    model = pinocchio(pin, given)
    tau, udot = _drawn(seed, len(u)), _drawn(seed + 1, len(u))
    data = model.createData()
    theirs, v, order = their_state(given, q, u)
    square = np.ix_(order, order)
    N = _displacements(lumped_tree(given, floats, FLOATS), q)
    pin.computeABADerivatives(model, data, theirs, v, tau[order])
    by_q, by_u = derivatives(forward_dynamics, given, q, u, tau)
    pin.computeRNEADerivatives(model, data, theirs, v, udot[order])
    forces_by_q, forces_by_u = derivatives(inverse_dynamics, given, q, u, udot)
    return {
        "accelerations by displacements": relative(by_q @ N, data.ddq_dq, square),
        "accelerations by speeds": relative(by_u, data.ddq_dv, square),
        "forces by displacements": relative(forces_by_q @ N, data.dtau_dq, square),
        "forces by speeds": relative(forces_by_u, data.dtau_dv, square),
    }


def _drawn(seed: int, size: int) -> Array:
    return np.random.default_rng(seed).uniform(-9.0, 9.0, size)


def relative(ours: Any, theirs: Any, order: Any = slice(None)) -> float:
    """Return the largest difference over the largest size of an entry; ours in their ``order``."""
    mine, other = np.array(ours, float)[order], np.array(theirs, float)
    return float(np.abs(mine - other).max() / np.abs(other).max())


def _displacements(lumped: LumpedTree, q: Scalars) -> Array:
    """Return N of q' = N u."""
    unit = np.eye(lumped.speeds)
    return np.array([coordinate_rates(lumped, q, list(e), FLOATS) for e in unit], float).T


def derivatives(
    recursion: Callable[..., Sequence[Any]], given: Tree, q: Scalars, u: Scalars, rest: Array
) -> tuple[Array, Array]:
    """Return the derivatives of a recursion's program by q and u; the tree's numbers are parameters."""
    b = Builder()
    known: dict[Any, int] = {}
    x = scalars.scalars(b, "state", len(q) + len(u))
    work = Numbers(scalars.sin, scalars.cos)

    def lifted(number: Any) -> Any:
        if number in (0, 1, -1):
            return number
        return scalars.Scalar(b, b.leaf("parameter", known.setdefault(number, len(known))))

    lumped = lumped_tree(given, lifted, work)
    last = scalars.scalars(b, "input", len(u))
    made = scalars.program(b, {RATES: recursion(lumped, x[: len(q)], x[len(q) :], last, work)})
    found = jacobian(made, RATES, modes=("forward",))
    point = Point(x=[*q, *u], p=[float(n) for n in known], u=list(rest))
    J = np.zeros((len(u), len(x)))
    for (row, column), value in zip(
        found.pattern, interpret(found.program, point)[JACOBIAN], strict=True
    ):
        J[row, column] = value
    return J[:, : len(q)], J[:, len(q) :]


if __name__ == "__main__":
    alone(measure)
