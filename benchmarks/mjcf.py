"""``python -m benchmarks.mjcf [FILE|FOLDER|MODULE ...]``: dynamics of MuJoCo's models beside its own.

Each model is read by `eom.load_scene` and by MuJoCo, in which everything that `eom` leaves out is switched
off: contacts, limits, friction, equalities, actuators, tendons, the medium. Accelerations at random
states, with random forces in hinges, slides and balls, are compared. Without arguments the models of the
suite of ``dm_control`` are looked through, where it can be found; it is not imported.
"""

from __future__ import annotations

import importlib.util
import sys
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import click
import mujoco
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

import eom
from codegen.frontend.lower import lower_system
from codegen.ir.interpret import Point, interpret
from codegen.ir.program import RATES
from eom.errors import InputError
from eom.rotations import matrix_of_quaternion

MODELS = ("dm_control/suite",)
ENOUGH, LARGEST = 10, 1e-12
"""So many models whose differences are so small, relative to the largest acceleration."""
STATES = 3
Array = NDArray[np.float64]


def files_in(places: Iterable[str]) -> list[Path]:
    """Return MJCF files: those given, those of folders, and of folders of modules, not imported."""
    found: list[Path] = []
    for place in places:
        path = Path(place) if Path(place).exists() else _folder_of(place)
        if path is not None:
            found += [path] if path.is_file() else sorted(path.glob("*.xml"))
    return found


def _folder_of(place: str) -> Path | None:
    module, _, inner = place.partition("/")
    spec = importlib.util.find_spec(module)
    places = (spec.submodule_search_locations or ()) if spec else ()
    return next((Path(p) / inner for p in places), None)


def bare(file: Path) -> Any:
    """Return MuJoCo's model of a file without what is no part of a tree."""
    mujoco.set_mju_user_warning(lambda words: None)
    m = mujoco.MjModel.from_xml_path(str(file))
    off = mujoco.mjtDisableBit
    m.opt.disableflags |= int(off.mjDSBL_CONSTRAINT) | int(off.mjDSBL_ACTUATION)
    m.opt.density = m.opt.viscosity = 0
    for name in ("tendon_stiffness", "tendon_damping", "tendon_armature", "body_gravcomp"):
        if hasattr(m, name):
            getattr(m, name)[:] = 0
    for j in range(m.njnt):
        if m.jnt_type[j] in {mujoco.mjtJoint.mjJNT_BALL, mujoco.mjtJoint.mjJNT_FREE}:
            m.jnt_stiffness[j] = 0
        if m.jnt_type[j] == mujoco.mjtJoint.mjJNT_FREE:
            m.dof_armature[m.jnt_dofadr[j] : m.jnt_dofadr[j] + 6] = 0
    return m


class State:
    """A random state and its forces: MuJoCo's arrays, values by our names, accelerations by these."""

    def __init__(self, m: Any, joints: list[str], draw: np.random.Generator) -> None:
        self.m, self.d = m, mujoco.MjData(m)
        self.values: dict[str, float] = {}
        self.d.qvel[:] = draw.normal(size=m.nv)
        self.d.qfrc_applied[:] = draw.normal(size=m.nv)
        self.turns: dict[str, Array] = {}
        for j, name in enumerate(joints):
            self._draw(j, name, draw)
        mujoco.mj_forward(m, self.d)
        self.wanted = {n: x for j, name in enumerate(joints) for n, x in self._rates(j, name)}
        mass = np.zeros((m.nv, m.nv))
        self._full_mass(mass)
        self.condition = float(np.linalg.cond(mass))

    def _full_mass(self, mass: Array) -> None:
        try:
            mujoco.mj_fullM(self.m, self.d, mass)
        except TypeError:  # before MuJoCo 4
            mujoco.mj_fullM(self.m, mass, self.d.qM)

    def _draw(self, j: int, name: str, draw: np.random.Generator) -> None:
        m, d = self.m, self.d
        q, v = int(m.jnt_qposadr[j]), int(m.jnt_dofadr[j])
        kind = int(m.jnt_type[j])
        if kind >= int(mujoco.mjtJoint.mjJNT_SLIDE):
            d.qpos[q] = m.qpos0[q] + draw.normal()
            self.values |= {f"q_{name}": d.qpos[q] - m.qpos0[q], f"u_{name}": d.qvel[v]}
            self.values[f"tau_{name}"] = d.qfrc_applied[v]
            return
        free = kind == int(mujoco.mjtJoint.mjJNT_FREE)
        turn = draw.normal(size=4)
        turn /= np.linalg.norm(turn)
        at, w = (q + 3, v + 3) if free else (q, v)
        d.qpos[at : at + 4] = turn
        self.values |= {f"e_{name}_{k}": x for k, x in enumerate(turn)}
        self.values |= {f"w_{name}_{k + 1}": d.qvel[w + k] for k in range(3)}
        if not free:
            self.values |= {f"tau_{name}_w{k + 1}": d.qfrc_applied[w + k] for k in range(3)}
            return
        d.qpos[q : q + 3] = draw.normal(size=3)
        d.qfrc_applied[v : v + 6] = 0
        C = self.turns[name] = np.array(matrix_of_quaternion(list(turn)))
        self.values |= {f"{x}_{name}": d.qpos[q + k] for k, x in enumerate("xyz")}
        speed = C @ d.qvel[v : v + 3]
        self.values |= {f"v_{name}_{k + 1}": speed[k] for k in range(3)}

    def _rates(self, j: int, name: str) -> list[tuple[str, float]]:
        """Return MuJoCo's accelerations as rates of our speeds."""
        m, d = self.m, self.d
        v, kind = int(m.jnt_dofadr[j]), int(m.jnt_type[j])
        if kind >= int(mujoco.mjtJoint.mjJNT_SLIDE):
            return [(f"u_{name}", d.qacc[v])]
        free = kind == int(mujoco.mjtJoint.mjJNT_FREE)
        w = v + 3 * free
        found = [(f"w_{name}_{k + 1}", d.qacc[w + k]) for k in range(3)]
        if free:
            C, omega = self.turns[name], d.qvel[w : w + 3]
            along = C @ d.qacc[v : v + 3] - np.cross(omega, C @ d.qvel[v : v + 3])
            found += [(f"v_{name}_{k + 1}", along[k]) for k in range(3)]
        return found


def difference(file: Path, states: int = STATES) -> tuple[float, float, int]:
    """Return the largest difference of accelerations, the condition of M there, and the degrees of freedom.

    The difference is relative to the largest acceleration.
    """
    m, scene = bare(file), eom.load_scene(file)
    moving = [n for n, j in scene.joints.items() if j.kind != "fixed"]
    order = sorted(range(m.njnt), key=lambda j: (int(m.jnt_bodyid[j]), j))
    named: list[str] = [""] * m.njnt
    for j, name in zip(order, moving, strict=True):
        named[j] = name
    system = scene.derive()
    program = lower_system(system)
    draw, worst = np.random.default_rng(7), (0.0, 1.0)
    for _ in range(states):
        state = State(m, named, draw)
        x = [state.values[n] for n in system.state_names]
        u = [state.values[n] for n in system.input_names]
        found = interpret(program, Point(x=x, u=u))[RATES]
        ours = dict(zip(system.state_names, found, strict=True))
        size = max(map(abs, state.wanted.values()))
        off = max(abs(ours[n] - a) for n, a in state.wanted.items()) / size
        worst = max(worst, (float(off), state.condition), key=lambda w: w[0] / w[1])
    return (*worst, m.nv)


def said(file: Path) -> str:
    """Return what was left out, counted by reason."""
    found = Counter(r.reason for r in eom.load_scene(file).repairs)
    return ", ".join(f"{n} {reason}" for reason, n in found.items())


@click.command()
@click.argument("places", nargs=-1, metavar="[FILE|FOLDER|MODULE]...")
@click.option("--most", default=90, show_default=True, help="Degrees of freedom at most.")
def main(places: tuple[str, ...], most: int) -> None:
    """Compare models with MuJoCo; exit with 1 where too few agree."""
    console = Console() if sys.stdout.isatty() else Console(width=150)
    table = Table("model", "speeds", "largest relative difference", "condition of M", "left out")
    agreeing = 0
    for file in files_in(places or MODELS):
        try:
            speeds = bare(file).nv
            if not 0 < speeds <= most:
                table.add_row(file.name, str(speeds), "not compared", "", "")
                continue
            off, condition, _ = difference(file)
            agreeing += off <= LARGEST
            table.add_row(file.name, str(speeds), f"{off:.1e}", f"{condition:.1e}", said(file))
        except (InputError, ValueError) as error:
            table.add_row(file.name, "", f"refused: {str(error).splitlines()[0][:60]}", "", "")
    console.print(table)
    console.print(f"{agreeing} agree to {LARGEST:.0e}")
    sys.exit(0 if agreeing >= ENOUGH else 1)


if __name__ == "__main__":
    main()
