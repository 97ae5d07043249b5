"""``python -m benchmarks.sympy_mechanics [PART ...]``: the systems of SymPy's own tests of mechanics.

SymPy ships the tests of its mechanics. They are run, each system whose equations they form is compiled,
and its rates at random states are compared with SymPy's own equations, evaluated with 50 digits. The
error is relative to the largest rate and to the condition of the mass matrix. PART: of the names of the
tests, to run some of them alone.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import click
import mpmath
import numpy as np
import pytest
import sympy as sp
from rich.console import Console
from rich.table import Table
from sympy.core.function import AppliedUndef
from sympy.physics.mechanics import KanesMethod, LagrangesMethod, SymbolicSystem, dynamicsymbols

import codegen
from eom.errors import InputError

TESTS = ("sympy.physics.mechanics.tests", "sympy.physics.biomechanics.tests")
FORMED = (
    (KanesMethod, "kanes_equations"),
    (LagrangesMethod, "form_lagranges_equations"),
    (SymbolicSystem, "__init__"),
)
ENOUGH, OF = 66, 69
"""So many of so many systems are to compile."""
LARGEST = 1e-14
"""Of the errors, relative to rates and condition."""
DIGITS = 50
STATES = 3


@dataclass(frozen=True)
class Built:
    """A system that a test of SymPy's has formed."""

    test: str
    method: Any

    @property
    def kind(self) -> str:
        """Its method, and whether it has constraints or auxiliary speeds."""
        m = self.method
        marks = {
            "dependent speeds": len(getattr(m, "_udep", ())),
            "multipliers": len(getattr(m, "lam_vec", ())),
            "auxiliary speeds": len(getattr(m, "_uaux", ())),
        }
        return ", ".join([type(m).__name__, *(f"{n} {name}" for name, n in marks.items() if n)])


class Recorder:
    """A plugin of pytest that keeps the methods whose equations are formed."""

    def __init__(self) -> None:
        self.test, self.built = "", list[Built]()

    def pytest_runtest_setup(self, item: Any) -> None:
        """Note which test comes next: a hook of pytest."""
        self.test = item.nodeid.rpartition("/")[2]

    def keep(self, method: Any) -> None:
        """Keep a method once."""
        if not any(b.method is method for b in self.built):
            self.built.append(Built(self.test, method))

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Keep each method when its equations are formed, while this lasts."""
        before = [(kind, name, getattr(kind, name)) for kind, name in FORMED]
        for kind, name, old in before:
            setattr(kind, name, self._kept(old))
        try:
            yield
        finally:
            for kind, name, old in before:
                setattr(kind, name, old)

    def _kept(self, old: Any) -> Any:
        def formed(method: Any, *args: Any, **keywords: Any) -> Any:
            found = old(method, *args, **keywords)
            self.keep(method)
            return found

        return formed


def systems(parts: Sequence[str] = ()) -> list[Built]:
    """Run SymPy's tests, and return the systems that they form; ``parts``: of names of tests."""
    recorder = Recorder()
    chosen = ["-k", " or ".join(parts)] if parts else []
    quiet = "-q --noconftest --no-header --no-summary -p no:cacheprovider -p no:xdist -W ignore"
    with recorder.watching():
        pytest.main(
            [*quiet.split(), "-c", "/dev/null", *chosen, "--pyargs", *TESTS], plugins=[recorder]
        )
    return recorder.built


# -- SymPy's own numbers -------------------------------------------------------------------------------


def equations(method: Any) -> tuple[list[Any], Any, Any]:
    """Return states, and M and f of M (d(states)/dt, multipliers) = f, as SymPy has them."""
    t = dynamicsymbols._t
    if isinstance(method, LagrangesMethod):
        return [*method.q, *method.u], method.mass_matrix_full, method.forcing_full
    if isinstance(method, SymbolicSystem):
        return [*method.states], *_of_symbolic(method)
    zero = {x: 0 for u in method._uaux for x in (u.diff(t), u)}
    kinematics = {d: e.xreplace(zero) for d, e in method.kindiffdict().items()}
    return (
        [*method.q, *method.u],
        *(
            m.xreplace(zero).xreplace(kinematics).doit()
            for m in (method.mass_matrix_full, method.forcing_full)
        ),
    )


def _of_symbolic(system: Any) -> tuple[Any, Any]:
    """Return M and f of one of SymPy's forms of a system that was given by hand."""
    try:
        return system.comb_implicit_mat, system.comb_implicit_rhs
    except AttributeError:
        return sp.eye(len(system.states)), system.comb_explicit_rhs


def reference(method: Any, values: dict[str, float]) -> tuple[Any, float]:
    """Return rates by name at a point by name, with many digits, and the condition of M there."""
    states, mass, forcing = equations(method)
    whole = sp.Matrix(mass).row_join(sp.Matrix(forcing)).doit()
    functions = whole.atoms(AppliedUndef) | whole.atoms(sp.Derivative)
    plain = {f: sp.Symbol(spelt(f)) for f in functions}
    whole = whole.xreplace({f: s for f, s in plain.items() if isinstance(f, sp.Derivative)})
    whole = whole.xreplace(plain)
    symbols = sorted(whole.free_symbols, key=str)
    with mpmath.workdps(DIGITS):
        call = sp.lambdify(symbols, whole, "mpmath", cse=True)
        found = mpmath.matrix(call(*(mpmath.mpf(values[str(s)]) for s in symbols)))
        A, b = found[:, : found.cols - 1], found[:, found.cols - 1]
        rates = mpmath.lu_solve(A, b)
    condition = float(np.linalg.cond(np.array(A.tolist(), dtype=float)))
    return dict(zip(map(spelt, states), rates, strict=False)), condition


def spelt(f: Any) -> str:
    """Return the name of a state or input, as `codegen` has it."""
    if isinstance(f, sp.Derivative):
        return f"{spelt(f.expr)}_{'d' * sum(int(n) for _, n in f.variable_count)}ot"
    return str(getattr(f, "func", f).__name__) if isinstance(f, AppliedUndef) else str(f)


def error(built: Built, target: str = "numpy", states: int = STATES) -> float:
    """Return the largest error of the compiled rates; raises `InputError` where it does not compile.

    Where SymPy's own mass matrix is singular there are no rates: NaN if ours are not finite there, else an
    infinite error.
    """
    compiled = codegen.compile(built.method, target)
    system = compiled.system
    draw, worst = np.random.default_rng(5), np.nan
    for _ in range(states):
        groups = [
            draw.uniform(0.5, 1.5, len(g))
            for g in (system.states, system.parameters, system.inputs)
        ]
        names = [system.state_names, system.parameter_names, system.input_names]
        time = float(draw.uniform(0.5, 1.5))
        values = {
            n: float(x)
            for ns, xs in zip(names, groups, strict=True)
            for n, x in zip(ns, xs, strict=True)
        }
        ours = dict(zip(system.state_names, compiled.rhs(time, *groups), strict=True))
        try:
            wanted, condition = reference(built.method, values | {str(system.time): time})
        except ZeroDivisionError:  # SymPy's own mass matrix is singular: there are no rates
            off = np.nan if not np.all(np.isfinite([*ours.values()])) else np.inf
            worst = np.fmax(worst, off)
            continue
        size = max(abs(wanted[n]) for n in ours) or 1
        off = max(abs(mpmath.mpf(float(ours[n])) - wanted[n]) for n in ours)
        worst = np.fmax(worst, float(off / size) / condition)
    return float(worst)


@click.command()
@click.argument("parts", nargs=-1, metavar="[PART]...")
@click.option("--target", default="numpy", show_default=True, help="What they are compiled for.")
def main(parts: tuple[str, ...], target: str) -> None:
    """Compile the systems of SymPy's tests; exit with 1 where too few compile, or one is too far off."""
    console = Console() if sys.stdout.isatty() else Console(width=140)
    warnings.simplefilter("ignore")
    table = Table("test", "method", "error / condition")
    found, errors = systems(parts), list[float]()
    for built in found:
        try:
            errors.append(error(built, target))
            said = "singular in SymPy, too" if np.isnan(errors[-1]) else f"{errors[-1]:.1e}"
        except InputError as refused:
            said = f"refused: {refused.what}"
        table.add_row(built.test, built.kind, said)
    console.print(table)
    worst = max((e for e in errors if not np.isnan(e)), default=0.0)
    console.print(f"{len(errors)} of {len(found)} compile; worst error {worst:.1e}")
    enough = len(errors) >= (ENOUGH / OF) * len(found)
    sys.exit(0 if found and enough and worst <= LARGEST else 1)


if __name__ == "__main__":
    main()
