"""``python -m benchmarks.robots [FOLDER|MODULE ...]``: robots of packages, read strictly and leniently.

Counts by reason what is refused, and compares accelerations at random states with Pinocchio, where it is
installed. Without arguments the packages of `PACKAGES` that can be imported are looked through. The
thousand shapes of `LEFT_OUT` are single bodies made by chance, and count with ``--all`` alone.
"""

from __future__ import annotations

import importlib.util
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
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

PACKAGES = ("pybullet_data", "example_robot_data", "rtbdata")
LEFT_OUT = "random_urdfs"
LARGEST = 1e-12
"""Of a difference of accelerations, over the largest of them."""
READ = "read"
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Found:
    """A file: why it is refused strictly and leniently, or `READ`; what was mended; what Pinocchio says."""

    file: Path
    strict: str
    lenient: str
    mended: tuple[str, ...] = ()
    peer: str = ""


def files_in(places: Iterable[str], everything: bool) -> list[Path]:
    """Return the URDF files of folders, and of modules that can be imported."""
    folders = [Path(p) if Path(p).is_dir() else _folder_of(p) for p in places]
    found = sorted({f for folder in folders if folder for f in folder.rglob("*.urdf")})
    return [f for f in found if everything or LEFT_OUT not in f.parts]


def _folder_of(module: str) -> Path | None:
    spec = importlib.util.find_spec(module)
    return Path(spec.origin).parent if spec and spec.origin else None


def read(file: Path) -> Found:
    """Read a file in both ways, and by Pinocchio."""
    strict, lenient = _reason(file, strict=True), _reason(file, strict=False)
    repairs = eom.load_scene(file, strict=False).repairs if lenient == READ else ()
    return Found(file, strict, lenient, tuple(sorted({r.reason for r in repairs})), _peer(file))


def _reason(file: Path, *, strict: bool) -> str:
    try:
        eom.load_scene(file, strict=strict)
    except InputError as error:
        return error.what
    return READ


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


def difference(file: Path, seed: int = 0) -> float | None:
    """Return the largest relative difference of accelerations; None where kinds of joints differ."""
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
        theirs = _theirs(mended_file(file, scene, Path(folder)), scene, joints, moving, state)
    return float(np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs)))


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
    for name, (driver, ratio) in state.couplings.items():
        if f"u_{joints[name]}" in rates:  # the speed that stays is one of those that are coupled
            rates[f"u_{joints[driver]}"] = rates[f"u_{joints[name]}"] / ratio
    return np.array([rates[f"u_{joints[n]}"] for n in moving if n not in state.couplings])


def _theirs(
    file: Path, scene: Any, joints: Mapping[str, str], moving: Sequence[str], state: State
) -> Array:
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
    if not state.couplings:
        return np.asarray(pinocchio.aba(model, data, x, v, force))[[places[n] for n in free]]
    G = np.zeros((model.nv, len(free)))
    for n in moving:
        driver, ratio = state.couplings.get(n, (n, 1.0))
        G[places[n], free.index(driver)] = ratio
    M = pinocchio.crba(model, data, x)
    M = np.triu(M) + np.triu(M, 1).T
    bias = pinocchio.nonLinearEffects(model, data, x, v)
    return np.asarray(np.linalg.solve(G.T @ M @ G, G.T @ (force - bias)))


# -- tables --------------------------------------------------------------------------------------------


def by_reason(found: Sequence[Found]) -> Table:
    """Return how many files each reason refuses strictly; of these, how many are read leniently."""
    table = Table("strictly", "files", "leniently read", "Pinocchio reads")
    for reason, count in Counter(f.strict for f in found).most_common():
        own = [f for f in found if f.strict == reason]
        mended = sum(f.lenient == READ for f in own)
        table.add_row(reason, str(count), str(mended), str(sum(f.peer == READ for f in own)))
    lenient, peer = sum(f.lenient == READ for f in found), sum(f.peer == READ for f in found)
    table.add_section()
    table.add_row("all", str(len(found)), str(lenient), str(peer))
    return table


def refused(found: Sequence[Found]) -> Table:
    """Return the files that are refused leniently, with the reasons."""
    table = Table("refused leniently", "why", "Pinocchio")
    for f in found:
        if f.lenient != READ:
            table.add_row(f.file.name, f.lenient, f.peer)
    return table


def compared(found: Sequence[Found], most: int) -> Iterator[tuple[str, str]]:
    """Yield robots with their largest relative difference from Pinocchio; those that were mended first."""
    order = sorted(found, key=lambda f: (f.strict == READ, f.file.name))
    left = most
    for f in (f for f in order if f.lenient == f.peer == READ):
        try:
            worst = difference(f.file) if left else None
        except InputError as error:
            yield f.file.name, f"not derived: {error.what}, {error.where}"
            continue
        if worst is not None:
            left -= 1
            yield f"{f.file.parent.parent.name}/{f.file.name}", f"{worst:.1e}"


@click.command()
@click.argument("places", nargs=-1, metavar="[FOLDER|MODULE]...")
@click.option("--all", "everything", is_flag=True, help=f"Count {LEFT_OUT}, too.")
@click.option("--most", default=20, show_default=True, help="Robots compared with Pinocchio.")
def main(places: tuple[str, ...], everything: bool, most: int) -> None:
    """Read robots; exit with 1 where a difference from Pinocchio is too large, or nothing was found."""
    console = Console() if sys.stdout.isatty() else Console(width=120)
    found = [read(file) for file in files_in(places or PACKAGES, everything)]
    console.print(by_reason(found))
    console.print(refused(found))
    rows = [] if missing("pin") else [*compared(found, most)]
    table = Table("robot", "largest relative difference from Pinocchio")
    for row in rows:
        table.add_row(*row)
    console.print(table)
    differences = [float(d) for _, d in rows if not d.startswith("not")]
    sys.exit(0 if found and all(d <= LARGEST for d in differences) else 1)


if __name__ == "__main__":
    main()
