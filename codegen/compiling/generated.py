"""Code for a system as files: what `eom generate` writes, from Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from codegen.compiling.compiled import ROWS, write_files
from codegen.compiling.compiled import generate as texts_of
from codegen.compiling.sparse import with_jacobians
from codegen.frontend.from_sympy_mechanics import as_system
from codegen.loops import projection
from codegen.loops.written import Choice
from codegen.passes.pipeline import specialised
from eom.errors import spelt, typed
from eom.system import System


@typed
def generate(
    system: System | Any,
    folder: str | Path | None = None,
    target: str = "c",
    parameters: Mapping[str, float] | None = None,
    *,
    integrator: str = "",
    rtol: float = 1e-9,
    jacobian: Sequence[str] = (),
    stable: bool = False,
) -> Mapping[str, str]:
    """Return code for ``system`` as texts by file name, and write it into ``folder`` if one is given.

    Parameters
    ----------
    system : System or Compiled or what SymPy has
        As of `codegen.compile`; no compiler is needed.
    folder : path, optional
        Where the files are written, each whole or not at all.
    target : str, default "c"
        ``c`` (with an integrator), ``c_f32``, ``c_lanes``, ``numpy``, ``python``, ``javascript``,
        ``jax`` or ``matlab``, in any case.
    parameters : mapping, optional
        Numbers for some or all, which are compiled in.
    integrator : str, optional
        What stands beside the targets c and javascript; for c dop853 unless another is named. In
        JavaScript it brings states back onto what the system maintains, such as constraints.
    rtol : float, default 1e-9
        The relative tolerance that the order of taylor suits.
    jacobian : sequence of str, optional
        ``states``, ``parameters``, ``inputs`` or ``time``, by which derivatives of the rates are
        written too.
    stable : bool, default False
        Apply every identity against cancellation.

    Returns
    -------
    mapping of str to str
        The texts by the names of their files. The same arguments give the same bytes.

    Raises
    ------
    InputError
        For unknown names, targets and integrators, for what a target cannot compute, and where the
        folder cannot be written.

    Notes
    -----
    Units are those of the system.

    Examples
    --------
    >>> import sympy as sp
    >>> y, v, k = sp.symbols("y v k", real=True)
    >>> sorted(generate(System.from_rates("oscillator", {y: v, v: -k * y}), target="numpy"))
    ['oscillator.py']
    """
    found, target = as_system(system), spelt(target, ROWS)
    made = specialised(found, dict(parameters or {}), stable=stable)
    if integrator and target == "javascript" and found.maintained:
        made = projection.extended(*made, found.maintained, stable)
    made = with_jacobians(*made, jacobian, stable)
    files = texts_of(*made, target, Choice(integrator, rtol) if integrator else None)
    if folder is not None:
        write_files(files, folder)
    return files
