"""Systems in residual form, F(t, y, y') = 0, by IDA of SUNDIALS with the generated Jacobian.

Hindmarsh et al., "SUNDIALS: suite of nonlinear and differential/algebraic equation solvers", ACM
Transactions on Mathematical Software 31 (2005) 363-396: backward differences of order 1 to 5. A residual
system has one output a state, F, and as its last inputs y', one a state.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.frontend.layout import names_of, to_array
from codegen.integrate import sundials
from codegen.ir.groups import OUTPUTS
from codegen.native.trajectory import Array
from codegen.runs.clock import clock_of
from eom.errors import InputError, unknown_name
from eom.system import System

Values = Mapping[str, float] | Sequence[float] | Array | None


@dataclass(frozen=True)
class Run:
    """Times (N,), states and their rates (n, N), names of the states, and how it went."""

    t: Array
    y: Array
    rates: Array
    names: tuple[str, ...]
    success: bool
    message: str
    evaluations: int
    jacobians: int

    def __getitem__(self, name: str) -> Array:
        """Return the values of a state by name."""
        if name not in self.names:
            raise unknown_name("state", name, self.names)
        found: Array = self.y[self.names.index(name)]
        return found


def solve(
    residual: System | Compiled,
    explicit: System | Compiled,
    initial: Values,
    times: ArrayLike,
    parameters: Values = None,
    *,
    inputs: Values = None,
    rtol: float = 1e-8,
    atol: float = 1e-10,
    max_steps: int = 100_000,
) -> Run:
    """Integrate F(t, y, y') = 0 over ``times`` (s), the first of which is the start.

    ``explicit``: a system with the same states and parameters, whose rates at the start are y' there.
    ``initial``: consistent values by name or in order; states left out are zero. ``inputs``: held
    values of those before y'. Raises `InputError` for unusable arguments, and where the package
    scikit-sundae is not installed; a run that fails says so in ``success`` and ``message``.
    """
    sundials.require("IDA")
    F, f = (x if isinstance(x, Compiled) else compile_system(x) for x in (residual, explicit))
    names = names_of(F.layout.states)
    _checked(F, f, names)
    given = dict.fromkeys(names, 0.0) | dict(initial) if isinstance(initial, Mapping) else initial
    y0 = to_array(given, names, "initial value")
    p = to_array(parameters, names_of(F.layout.parameters), "parameter")
    held = to_array(inputs, names_of(F.layout.inputs)[: -len(names)], "input")
    at = np.asarray(times, dtype=np.float64)
    if at.ndim != 1 or len(at) < 2 or not np.all(np.isfinite(at)):
        raise InputError("times of a run are at least two finite numbers", got=at.shape)
    slopes = f.rhs(float(at[0]), y0, p, held)
    clock = clock_of(F, (float(at[0]), float(at[-1])), 0.0, ())
    start = 0.0 if clock is None else clock.start
    if clock is not None:
        clock.doubt(p, rtol)
        F, p = clock.relative.compiled, clock.relative.completed(p, clock.zero)
    solver = _solver(F, p, held, rtol=rtol, atol=atol, max_num_steps=max_steps)
    found = solver.solve(at - start, y0, slopes)
    reached = at.copy() if found.success else start + np.asarray(found.t)
    return Run(
        reached, np.asarray(found.y).T, np.asarray(found.yp).T, names,
        bool(found.success), str(found.message), int(found.nfev), int(found.njev),
    )  # fmt: skip


def _checked(F: Compiled, f: Compiled, names: tuple[str, ...]) -> None:
    """Raise `InputError` for systems that are not a pair."""
    sizes = len(F.layout.results[OUTPUTS]), len(F.layout.inputs)
    if sizes[0] != len(names) or sizes[1] < len(names) or names_of(f.layout.states) != names:
        raise InputError(
            "not a residual form: one output and one input a state are needed, and the same states",
            where=f"system {F.layout.name!r}",
            got=f"{sizes[0]} outputs and {sizes[1]} inputs for {len(names)} states",
        )


def _solver(F: Compiled, p: Array, held: Array, **options: Any) -> Any:
    from sksundae.ida import IDA

    by_state, by_input = F.jacobian("states", OUTPUTS), F.jacobian("inputs", OUTPUTS)
    first = len(held)
    own = [k for k, c in enumerate(by_input.columns) if c >= first]
    rows = [by_input.rows[k] for k in own]
    columns = [by_input.columns[k] - first for k in own]

    def left(t: float, y: Array, slopes: Array, out: Array) -> None:
        out[:] = F.outputs(t, y, p, np.concatenate([held, slopes]))

    def fill(t: float, y: Array, slopes: Array, _: Array, factor: float, matrix: Array) -> None:
        u = np.concatenate([held, slopes])
        matrix[:] = 0.0
        matrix[list(by_state.rows), list(by_state.columns)] = by_state(t, y, p, u)
        matrix[rows, columns] += factor * by_input(t, y, p, u)[own]

    return IDA(left, jacfn=fill, linsolver="dense", **options)
