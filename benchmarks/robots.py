"""``python -m benchmarks.robots [FOLDER|PACKAGE ...]``: robots of packages, read strictly and leniently.

Counts by reason what is refused and what can be derived, and compares accelerations at random states with
Pinocchio, where it is installed. Without arguments the packages of `PACKAGES` that are installed are
looked through. The thousand shapes of `LEFT_OUT` are single bodies made by chance, and count with ``--all``
alone.
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import click
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

import eom
from benchmarks.peers import missing
from codegen.frontend.lower import lower_system
from codegen.ir.interpret import Point, interpret
from eom.errors import InputError
from eom.multibody.files.urdf import SINGLE, checked, moving_part, names_of, parsed

PACKAGES = ("pybullet", "example-robot-data", "rtb-data")
LEFT_OUT = "random_urdfs"
LARGEST = 1e-12
"""Of a difference of accelerations, over the largest of them."""
ENOUGH = 20
"""Robots whose differences must be that small."""
READ = "read"
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Found:
    """A file: why it is refused strictly and leniently, or `READ`; what was mended; what Pinocchio says.

    ``derived``: why its equations are refused, or `READ`; nothing where not asked. ``detail``: what
    is read for what is refused leniently.
    """

    file: Path
    strict: str
    lenient: str
    mended: tuple[str, ...] = ()
    peer: str = ""
    derived: str = ""
    detail: str = ""


def files_in(places: Iterable[str], everything: bool) -> list[Path]:
    """Return the URDF files of folders, and of packages that are installed, by the names of the index."""
    found = {f for p in places for f in (Path(p).rglob("*") if Path(p).is_dir() else _files_of(p))}
    robots = sorted(f for f in found if f.suffix == ".urdf")
    return [f for f in robots if everything or LEFT_OUT not in f.parts]


def _files_of(package: str) -> list[Path]:
    try:
        listed = metadata.files(package) or []
    except metadata.PackageNotFoundError:
        return []
    return [Path(str(f.locate())).resolve() for f in listed]


def read(file: Path, derive: bool = True) -> Found:
    """Read a file in both ways, and by Pinocchio; derive its equations, unless that is left out."""
    (strict, _), (lenient, detail) = (_reason(file, strict=s) for s in (True, False))
    repairs = eom.load_scene(file, strict=False).repairs if lenient == READ else ()
    mended = tuple(sorted({r.reason for r in repairs}))
    derived = _derived(file) if derive and lenient == READ else ""
    return Found(file, strict, lenient, mended, _peer(file), derived, detail)


def _derived(file: Path) -> str:
    try:
        eom.load_scene(file, strict=False).derive()
    except InputError as error:
        return f"{error.what}, {error.where}"
    return READ


def _reason(file: Path, *, strict: bool) -> tuple[str, str]:
    """Return why a file is refused, or `READ`, and what was found there."""
    try:
        eom.load_scene(file, strict=strict)
    except InputError as error:
        return error.what, str(error.got)[:80]
    return READ, ""


def _peer(file: Path) -> str:
    if missing("pin"):
        return "not installed"
    import pinocchio

    try:
        pinocchio.buildModelFromUrdf(str(file))
    except ValueError:
        return "refused"
    return READ


# -- accelerations -------------------------------------------------------------------------------------


def mended_file(file: Path, scene: Any, folder: Path) -> Path:
    """Write the file with the inertias and fixed joints that lenient reading made, else as it is."""
    root = ElementTree.fromstring(checked(file, strict=False)[0])
    for kind in ("visual", "collision"):
        for link in root.iter("link"):
            for element in link.findall(kind):
                link.remove(element)
    names = names_of("link", [link.attrib["name"] for link in root.findall("link")], strict=False)
    for link in root.findall("link"):
        rows = scene.bodies[names[link.attrib["name"]]].matrix
        inertia = link.find("inertial/inertia")
        if inertia is not None and rows is not None:
            for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
                inertia.set(f"i{'xyz'[i]}{'xyz'[j]}", repr(float(rows[i][j])))
    idle = {r.part for r in scene.repairs if r.reason == "idle"}
    for joint in root.findall("joint"):
        if f"joint {joint.attrib['name']!r}" in idle:
            joint.set("type", "fixed")
    made = folder / "mended.urdf"
    made.write_bytes(ElementTree.tostring(root))
    return made


@dataclass(frozen=True)
class State:
    """Coordinates, speeds and forces by joint, as the file names them; couplings: driver and ratio."""

    q: Mapping[str, float]
    u: Mapping[str, float]
    tau: Mapping[str, float]
    couplings: Mapping[str, tuple[str, float]]


def difference(file: Path, seed: int = 0) -> tuple[float, float] | None:
    """Return the largest relative difference of accelerations, and the condition of the mass matrix there.

    None where kinds of joints differ.
    """
    scene = eom.load_scene(file, strict=False)
    robot = parsed(moving_part(checked(file, strict=False)[0], file.stem))
    joints = names_of("joint", [j.name for j in robot.joints], strict=False)
    kinds = {name: scene.joints[joints[name]] for name in joints}
    moving = [n for n, j in kinds.items() if j.kind != "fixed"]
    if not moving or any(j.type not in ("fixed", *SINGLE) for j in robot.joints):
        return None
    if any(j.motion is not None for j in kinds.values()):
        return None
    state = _state(scene, joints, moving, np.random.default_rng(seed))
    ours = _ours(scene, joints, moving, state)
    with tempfile.TemporaryDirectory() as folder:
        made = mended_file(file, scene, Path(folder))
        theirs, condition = _theirs(made, scene, joints, moving, state)
    return float(np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs))), condition


def _state(scene: Any, joints: Mapping[str, str], moving: Sequence[str], draw: Any) -> State:
    back = {own: name for name, own in joints.items()}
    couplings = {}
    for constraint in scene.constraints.values():
        (first, _), (second, ratio) = constraint.ratios.items()
        couplings[back[first]] = (back[second], -float(ratio))
    free = [n for n in moving if n not in couplings]
    q, u, tau = ({n: float(draw.normal()) for n in free} for _ in range(3))
    start = scene.initial_values()
    for name, (driver, ratio) in couplings.items():
        q[name] = start[f"q_{joints[name]}"] + ratio * q[driver]
        u[name] = ratio * u[driver]
    return State(q, u, tau, couplings)


def _ours(scene: Any, joints: Mapping[str, str], moving: Sequence[str], state: State) -> Array:
    system = scene.derive()
    values = {f"q_{joints[n]}": x for n, x in state.q.items()}
    values |= {f"u_{joints[n]}": x for n, x in state.u.items()}
    values |= {f"tau_{joints[n]}": x for n, x in state.tau.items()}
    point = Point(
        x=[values[n] for n in system.state_names], u=[values[n] for n in system.input_names]
    )
    found = interpret(lower_system(system), point)["rates"]
    rates = dict(zip(system.state_names, found, strict=True))
    return np.array([rates[f"u_{joints[n]}"] for n in moving if n not in state.couplings])


def _theirs(
    file: Path, scene: Any, joints: Mapping[str, str], moving: Sequence[str], state: State
) -> tuple[Array, float]:
    import pinocchio

    model = pinocchio.buildModelFromUrdf(str(file))
    x = pinocchio.neutral(model)
    v, force = np.zeros(model.nv), np.zeros(model.nv)
    places = {}
    for n in moving:
        j = model.joints[model.getJointId(n)]
        angle = state.q[n]
        x[j.idx_q : j.idx_q + j.nq] = [angle] if j.nq == 1 else [np.cos(angle), np.sin(angle)]
        v[j.idx_v], places[n] = state.u[n], j.idx_v
        damping = float(scene.joints[joints[n]].damping)
        force[j.idx_v] = state.tau.get(n, 0.0) - damping * state.u[n]
    data = model.createData()
    free = [n for n in moving if n not in state.couplings]
    G = np.zeros((model.nv, len(free)))
    for n in moving:
        driver, ratio = state.couplings.get(n, (n, 1.0))
        G[places[n], free.index(driver)] = ratio
    M = pinocchio.crba(model, data, x)
    M = np.triu(M) + np.triu(M, 1).T
    reduced = G.T @ M @ G
    condition = float(np.linalg.cond(reduced))
    if not state.couplings:
        found = np.asarray(pinocchio.aba(model, data, x, v, force))
        return found[[places[n] for n in free]], condition
    bias = pinocchio.nonLinearEffects(model, data, x, v)
    return np.asarray(np.linalg.solve(reduced, G.T @ (force - bias))), condition


# -- tables --------------------------------------------------------------------------------------------


def by_reason(found: Sequence[Found]) -> Table:
    """Return how many files each reason refuses strictly; of these, how many are read leniently."""
    table = Table("strictly", "files", "leniently read", "derived", "Pinocchio reads")
    for reason, count in Counter(f.strict for f in found).most_common():
        own = [f for f in found if f.strict == reason]
        table.add_row(reason, str(count), *_counts(own))
    table.add_section()
    table.add_row("all", str(len(found)), *_counts(found))
    return table


def _counts(found: Sequence[Found]) -> tuple[str, ...]:
    """Return how many are read leniently, derived, and read by Pinocchio."""
    return tuple(
        str(sum(getattr(f, key) == READ for f in found)) for key in ("lenient", "derived", "peer")
    )


def refused(found: Sequence[Found]) -> Table:
    """Return the files that are refused leniently, or cannot be derived, with the reasons."""
    table = Table("refused leniently", "why", "Pinocchio")
    for f in found:
        if f.lenient != READ or f.derived not in {"", READ}:
            why = f"{f.lenient}: {f.detail}" if f.lenient != READ else f"not derived: {f.derived}"
            table.add_row(f.file.name, why, f.peer)
    return table


def compared(found: Sequence[Found], most: int) -> Iterator[tuple[str, str, str]]:
    """Yield robots, their largest relative difference from Pinocchio, and the condition of M there.

    Those that were mended come first; what cannot be derived says so, without a condition.
    """
    order = sorted(found, key=lambda f: (f.strict == READ, f.file.name))
    left = most
    for f in (f for f in order if f.lenient == f.peer == READ):
        try:
            pair = difference(f.file) if left else None
        except InputError as error:
            yield f.file.name, f"not derived: {error.what}, {error.where}", ""
            continue
        if pair is not None:
            left -= 1
            worst, condition = pair
            name = f"{f.file.parent.parent.name}/{f.file.name}"
            yield name, f"{worst:.1e}", f"{condition:.1e}"


@click.command()
@click.argument("places", nargs=-1, metavar="[FOLDER|PACKAGE]...")
@click.option("--all", "everything", is_flag=True, help=f"Count {LEFT_OUT}, too.")
@click.option("--most", default=30, show_default=True, help="Robots compared with Pinocchio.")
@click.option("--derive/--no-derive", default=True, help="Count what can be derived, too.")
def main(places: tuple[str, ...], everything: bool, most: int, derive: bool) -> None:
    """Read robots; exit with 1 where nothing was found, or too few agree with Pinocchio.

    Enough are `ENOUGH`, or all that are compared where those are fewer; the others are printed as they are.
    """
    console = Console() if sys.stdout.isatty() else Console(width=120)
    found = [read(file, derive) for file in files_in(places or PACKAGES, everything)]
    console.print(by_reason(found))
    console.print(refused(found))
    rows = [] if missing("pin") else [*compared(found, most)]
    table = Table("robot", "largest relative difference from Pinocchio", "condition of M")
    for row in rows:
        table.add_row(*row)
    console.print(table)
    agreeing = sum(float(d) <= LARGEST for _, d, condition in rows if condition)
    whole = sum(bool(condition) for *_, condition in rows)
    sys.exit(0 if found and agreeing >= min(ENOUGH, whole) else 1)


if __name__ == "__main__":
    main()
