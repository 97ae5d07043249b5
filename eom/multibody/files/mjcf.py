"""Models of MuJoCo (MJCF, ``.xml``) as scenes of trees; MuJoCo's own parser (extra ``mujoco``) reads them.

Read are bodies, joints, inertias, gravity, and at hinges and slides springs; dampers and armatures of
joints. Hinges, slides and balls have motors, the inputs ``tau_<joint>``. Coordinates count from the pose
in which the file is written (MuJoCo's qpos0): there every angle and displacement is zero. A body with
several joints becomes a chain, with bodies without mass between.

Contacts, limits, friction, tendons, actuators, equalities and the like are no part of a tree: each that is
left out stands in the scene's ``repairs``. MuJoCo opens the files that a model names: meshes, textures and
what it includes.

Source: MuJoCo, Computation (kinematic tree, order of joints), and XML reference.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple
from xml.parsers import expat

from eom.errors import InputError
from eom.multibody.files.scene import Repair, TreeScene
from eom.multibody.files.urdf import free_name, names_of, nearest_inertia
from eom.multibody.model import checks
from eom.multibody.model.bodies import GROUND
from eom.rotations import cosines
from eom.scenes.naming import spelling
from eom.scenes.scene_files import in_file, text_of

KINDS = ("free", "spherical", "prismatic", "revolute")
"""Kinds of joints here by the numbers of MuJoCo's: free, ball, slide, hinge."""
SINGLE = frozenset({"prismatic", "revolute"})
"""Kinds of one degree of freedom."""


def load_mjcf(path: str | Path, *, strict: bool = True, floating: bool = False) -> TreeScene:
    """Return the model of an MJCF file as a scene; its ``repairs`` say what was left out.

    ``strict``: refuse inertias that no body has; otherwise the nearest possible ones are taken.
    ``floating``: free the one body that is fixed to the world. SI units; axes of the ground are those of
    the world.

    Raises `InputError` with the file's name for what is no MJCF, what MuJoCo refuses, in its words, and
    where ``floating`` has no one body to free.
    """
    file = Path(path)
    with in_file(file):
        _check_root(file)
        compiled, warnings = _compiled(file)
        model = _Model(file.stem, compiled)
        fixed = model.fixed_roots()
        if floating and len(fixed) != 1:
            raise InputError("floating frees the one body that is fixed to the world",
                             got=", ".join(model.bodies[b] for b in fixed) or "none",
                             hint="write <freejoint/> in the body that is to float")  # fmt: skip
        freed = fixed[0] if floating else 0
        scene, repairs = model.scene(freed), [*_renamed(model), *_left_out(model)]
        if not strict:
            repairs += _mended(scene["bodies"])
        return TreeScene(**scene, notes=(model.note(freed), *warnings), repairs=tuple(repairs))


def _check_root(file: Path) -> None:
    """Refuse what is no XML, and other roots, before any parser of robots sees the file."""
    roots: list[str] = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda tag, _: roots.append(tag)
    parser.StartDoctypeDeclHandler = _no_document_type
    try:
        parser.Parse(text_of(file, "*.xml").encode(), True)
    except expat.ExpatError as error:
        raise InputError("not valid XML", got=str(error)) from None
    if roots[0] != "mujoco":
        raise InputError(
            "not a MuJoCo model", where="first element", got=roots[0], expected="mujoco",
            hint="name a URDF file .urdf" if roots[0] == "robot" else "",
        )  # fmt: skip


def _no_document_type(*_: object) -> None:
    raise InputError(
        "an MJCF file declares no document type", got="<!DOCTYPE",
        hint="remove it; entities are not read",
    )  # fmt: skip


def _compiled(file: Path) -> tuple[Any, list[str]]:
    """Return MuJoCo's model of a file, and what it warns of, which otherwise goes to a file of its own.

    Raises `InputError` with its words for what it refuses.
    """
    mujoco, warnings = _package(), list[str]()
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(warnings.append)
    try:
        return mujoco.MjModel.from_xml_path(str(file)), [f"MuJoCo: {w}" for w in warnings]
    except (ValueError, mujoco.FatalError) as error:
        words = " ".join(str(error).split())
        lacking = "meshes and included files must lie where the model names them"
        hint = lacking if "opening file" in words else ""
        raise InputError("MuJoCo refuses the model", got=words, hint=hint) from None
    finally:
        mujoco.set_mju_user_warning(before)


def _package() -> Any:
    try:
        return importlib.import_module("mujoco")
    except ImportError:
        raise InputError(
            "MJCF files need the package mujoco", hint="pip install 'eom-toolkit[mujoco]'"
        ) from None


def _floats(row: Iterable[Any]) -> list[float]:
    return [float(x) for x in row]


@dataclass(frozen=True)
class _Model:
    """MuJoCo's arrays, with names of bodies and joints that symbols can have."""

    name: str
    m: Any

    def _names(self, kind: str, count: int) -> list[str]:
        """Return the names of a kind of things; those without are numbered."""
        mujoco = _package()
        code = getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}")
        given = [mujoco.mj_id2name(self.m, code, k) or "" for k in range(count)]
        for k, name in enumerate(given):
            if not name:
                given[k] = free_name(f"{kind}_{k}", given)
        return given

    def names(self, kind: str, count: int) -> list[str]:
        """Return the names of a kind of things as the file has them."""
        return self._names(kind, count)

    @cached_property
    def bodies(self) -> list[str]:
        """Names of bodies in symbols, by number; number 0 is the ground."""
        given = self._names("body", self.m.nbody)[1:]
        return [GROUND, *(names_of("body", given, strict=False)[n] for n in given)]

    @cached_property
    def joints(self) -> list[str]:
        """Names of joints in symbols, by number."""
        given = self._names("joint", self.m.njnt)
        found = names_of("joint", given, strict=False)
        return [found[n] for n in given]

    def kind(self, joint: int) -> str:
        """Return the kind of a joint."""
        return KINDS[int(self.m.jnt_type[joint])]

    def joints_of(self, body: int) -> range:
        """Return the joints of a body, in their order."""
        first, count = int(self.m.body_jntadr[body]), int(self.m.body_jntnum[body])
        return range(first, first + count) if count else range(0)

    def disabled(self, what: str) -> bool:
        """Return whether the file switches something off: a flag of ``<option>``."""
        bit = getattr(_package().mjtDisableBit, f"mjDSBL_{what}", None)
        if bit is None:  # before MuJoCo 3.3 one flag stood for springs and dampers
            bit = _package().mjtDisableBit.mjDSBL_PASSIVE
        return bool(int(self.m.opt.disableflags) & int(bit))

    def fixed_roots(self) -> list[int]:
        """Return the bodies that the world holds without a joint."""
        m = self.m
        return [b for b in range(1, m.nbody) if not m.body_parentid[b] and not m.body_jntnum[b]]

    def note(self, freed: int) -> str:
        """Return what was taken how, in words."""
        held = f"; {self.bodies[freed]} floats" if freed else ""
        return f"MJCF, read by MuJoCo {_package().__version__}{held}; zero is the pose of the file"

    # -- the scene -----------------------------------------------------------------------------

    def scene(self, freed: int) -> dict[str, Any]:
        """Return the data of a scene; ``freed``: the number of a body that floats, or 0."""
        gravity = [0.0] * 3 if self.disabled("GRAVITY") else _floats(self.m.opt.gravity)
        bodies: dict[str, Any] = {}
        joints: dict[str, Any] = {}
        for b in range(1, self.m.nbody):
            bodies[self.bodies[b]] = self._body(b)
        for b in range(1, self.m.nbody):
            for name, joint in self._chain(b, freed):
                joints[free_name(name, joints)] = joint
                bodies.setdefault(joint["child"], {})
        starts = [self._start(j) for j in range(self.m.njnt) if self.kind(j) == "free"]
        return {
            "name": self.name,
            "title": f"from {self.name}.xml",
            "model": "tree",
            "gravity": gravity,
            "bodies": bodies,
            "joints": joints,
            "initial": {name: x for places, _ in starts for name, x in places.items()},
            "initial_attitude": {name: turn for _, turns in starts for name, turn in turns.items()},
        }

    def _body(self, b: int) -> dict[str, Any]:
        m = self.m
        return {
            "mass": float(m.body_mass[b]),
            "centre": _floats(m.body_ipos[b]),
            "moments": _floats(m.body_inertia[b]),
            "rotation": {"matrix": _matrix(m.body_iquat[b])},
        }

    def _chain(self, b: int, freed: int) -> Iterator[tuple[str, dict[str, Any]]]:
        """Yield the joints of a body from the outermost in, each with the part that it carries."""
        m, own = self.m, list(self.joints_of(b))
        parent = self.bodies[int(m.body_parentid[b])]
        turned = {"matrix": _matrix(m.body_quat[b])}
        placed = {"position": _floats(m.body_pos[b]), "rotation": turned}
        if not own:
            kind = "free" if b == freed else "fixed"
            yield (
                free_name(f"root_{self.bodies[b]}", self.joints),
                {"kind": kind, "parent": parent, "child": self.bodies[b], "on_parent": placed},
            )
        for j in own:
            last = j == own[-1]
            child = self.bodies[b] if last else self._between(j)
            yield self.joints[j], self._joint(j, parent, child, placed if j == own[0] else None)
            parent = child

    def _between(self, joint: int) -> str:
        """Return the name of the part without mass that a joint carries before the next."""
        return free_name(f"behind_{self.joints[joint]}", self.bodies)

    def _joint(
        self, j: int, parent: str, child: str, placed: Mapping[str, Any] | None
    ) -> dict[str, Any]:
        m, kind = self.m, self.kind(j)
        found: dict[str, Any] = {"kind": kind, "parent": parent, "child": child}
        if kind == "free":
            found["damping"] = self._damping(j)
            return found
        at, turn = _floats(m.jnt_pos[j]), placed["rotation"]["matrix"] if placed else None
        here = at if placed is None else _moved(placed["position"], turn, at)
        found["on_parent"] = {"position": here} | ({"rotation": {"matrix": turn}} if turn else {})
        found["on_child"] = {"position": at}
        found |= {"motor": True, "damping": self._damping(j)}
        found["armature"] = float(m.dof_armature[m.jnt_dofadr[j]])
        if kind in SINGLE:
            found["axis"] = _floats(m.jnt_axis[j])
            found |= self._spring(j)
        return found

    def _damping(self, j: int) -> float:
        return 0.0 if self.disabled("DAMPER") else float(self.m.dof_damping[self.m.jnt_dofadr[j]])

    def _spring(self, j: int) -> dict[str, Any]:
        stiffness = 0.0 if self.disabled("SPRING") else float(self.m.jnt_stiffness[j])
        if not stiffness:
            return {}
        at = int(self.m.jnt_qposadr[j])
        return {"stiffness": stiffness, "rest": float(self.m.qpos_spring[at] - self.m.qpos0[at])}

    def _start(self, j: int) -> tuple[dict[str, float], dict[str, Any]]:
        """Return the start of a free joint: places by name, and the quaternion by joint."""
        name, at = self.joints[j], int(self.m.jnt_qposadr[j])
        x, y, z, *turn = _floats(self.m.qpos0[at : at + 7])
        return {f"x_{name}": x, f"y_{name}": y, f"z_{name}": z}, {name: {"quaternion": _unit(turn)}}


HIDDEN = 3
"""Groups of geoms from this on are not shown, as in MuJoCo's viewer: by custom those to touch."""


class Geom(NamedTuple):
    """A shape on a body: a ``solid`` of `eom.mass.solids` about its centre with its sizes (m), or a mesh.

    ``body``: its name in the scene. ``position`` of the centre (m) and ``rotation`` C from the body's axes
    to those of the shape. ``vertices`` (m) and ``faces``, indices of them: of a mesh.
    """

    body: str
    position: Sequence[float]
    rotation: Sequence[Sequence[float]]
    solid: str = ""
    sizes: Mapping[str, float] = {}
    vertices: Sequence[Sequence[float]] = ()
    faces: Sequence[Sequence[int]] = ()


def geoms_of(path: str | Path) -> tuple[Geom, ...]:
    """Return the shapes on the bodies of an MJCF file, those to be seen where there are such, else all.

    Raises `InputError` as `load_mjcf` does. Planes and height fields are left out.
    """
    file = Path(path)
    with in_file(file):
        _check_root(file)
        model = _Model(file.stem, _compiled(file)[0])
    m = model.m
    own = [g for g in range(m.ngeom) if m.geom_bodyid[g]]
    seen = [g for g in own if m.geom_group[g] < HIDDEN]
    return tuple(shape for g in seen or own for shape in _shapes(model, g))


def _shapes(model: _Model, g: int) -> Iterator[Geom]:
    """Yield what a geom looks like; a capsule is three solids."""
    m = model.m
    body, kind = model.bodies[int(m.geom_bodyid[g])], int(m.geom_type[g])
    at, C = _floats(m.geom_pos[g]), _matrix(m.geom_quat[g])
    types, size = _package().mjtGeom, _floats(m.geom_size[g])
    if kind == int(types.mjGEOM_MESH):
        k = int(m.geom_dataid[g])
        first, count = int(m.mesh_vertadr[k]), int(m.mesh_vertnum[k])
        vertices = [_floats(v) for v in m.mesh_vert[first : first + count]]
        first, count = int(m.mesh_faceadr[k]), int(m.mesh_facenum[k])
        faces = [[int(n) for n in f] for f in m.mesh_face[first : first + count]]
        yield Geom(body, at, C, vertices=vertices, faces=faces)
    elif kind == int(types.mjGEOM_BOX):
        yield Geom(body, at, C, "box", dict(zip("abc", (2 * x for x in size), strict=True)))
    elif kind == int(types.mjGEOM_ELLIPSOID):
        yield Geom(body, at, C, "ellipsoid", dict(zip("abc", size, strict=True)))
    elif kind == int(types.mjGEOM_SPHERE):
        yield Geom(body, at, C, "sphere", {"radius": size[0]})
    elif kind in {int(types.mjGEOM_CYLINDER), int(types.mjGEOM_CAPSULE)}:
        yield Geom(body, at, C, "cylinder", {"radius": size[0], "length": 2 * size[1]})
        for end in (1, -1) if kind == int(types.mjGEOM_CAPSULE) else ():
            place = _moved(at, C, (0.0, 0.0, end * size[1]))
            yield Geom(body, place, C, "sphere", {"radius": size[0]})


def _unit(quaternion: Sequence[float]) -> list[float]:
    size = sum(x * x for x in quaternion) ** 0.5
    return [x / size for x in quaternion]


def _matrix(quaternion: Iterable[Any]) -> list[list[float]]:
    """Return C that takes components outside to those in a frame turned by a quaternion."""
    return [_floats(row) for row in cosines(_unit(_floats(quaternion)))]


def _moved(
    position: Sequence[float], C: Sequence[Sequence[float]] | None, at: Sequence[float]
) -> Any:
    """Return ``position`` + C^T ``at``."""
    turned = at if C is None else [sum(C[k][i] * at[k] for k in range(3)) for i in range(3)]
    return [p + t for p, t in zip(position, turned, strict=True)]


def _renamed(model: _Model) -> Iterator[Repair]:
    """Yield the names that symbols cannot have, and what things are called instead."""
    for kind, called, given in (
        ("body", model.bodies[1:], model.names("body", model.m.nbody)[1:]),
        ("joint", model.joints, model.names("joint", model.m.njnt)),
    ):
        for name, spelt in zip(given, called, strict=True):
            if spelt != spelling(name):
                yield Repair("name", f"{kind} {name!r}", f"called {spelt}")


def _mended(bodies: Mapping[str, Any]) -> Iterator[Repair]:
    """Take the nearest inertia that a body has for those that none has."""
    for name, body in bodies.items():
        J = [
            [x if i == k else 0.0 for k in range(3)] for i, x in enumerate(body.get("moments", ()))
        ]
        if not J:
            continue
        try:
            checks.body(1, J, name)
        except InputError:
            near, share = nearest_inertia(J)
            body["moments"] = [near[k][k] for k in range(3)]
            done = f"nearest possible inertia taken, {share:.2g} of its size away"
            yield Repair("inertia", f"body {name!r}", done)


# -- what is left out ----------------------------------------------------------------------------------


def _of(
    kind: str, count: str, words: str = "left out"
) -> Callable[[_Model], Iterator[tuple[str, str]]]:
    """Return what names all things of a kind that MuJoCo counts."""

    def found(model: _Model) -> Iterator[tuple[str, str]]:
        for name in model.names(kind, int(getattr(model.m, count, 0))):
            yield f"{kind} {name!r}", words

    return found


def _joints_where(field: str, words: str) -> Callable[[_Model], Iterator[tuple[str, str]]]:
    """Return what names the joints of which a field of MuJoCo's is not zero, at their first speed."""

    def found(model: _Model) -> Iterator[tuple[str, str]]:
        values: Any = getattr(model.m, field, ())  # older versions have fewer fields
        for j, name in enumerate(model.names("joint", model.m.njnt) if len(values) else ()):
            k = int(model.m.jnt_dofadr[j]) if field.startswith("dof_") else j
            if _any(values[k]):
                yield f"joint {name!r}", words

    return found


def _any(given: Any) -> bool:
    with suppress(TypeError):
        return any(float(x) for x in given)
    return bool(float(given))


def _actuators(model: _Model) -> Iterator[tuple[str, str]]:
    m, muscle = model.m, int(_package().mjtDyn.mjDYN_MUSCLE)
    for k, name in enumerate(model.names("actuator", int(m.nu))):
        kind = "muscle" if int(m.actuator_dyntype[k]) == muscle else "actuator"
        yield f"{kind} {name!r}", "left out"


def _springs(model: _Model) -> Iterator[tuple[str, str]]:
    for j, name in enumerate(model.names("joint", model.m.njnt)):
        if model.m.jnt_stiffness[j] and model.kind(j) not in SINGLE:
            yield f"joint {name!r}", f"spring of a {model.kind(j)} joint left out"


def _armatures(model: _Model) -> Iterator[tuple[str, str]]:
    for j, name in enumerate(model.names("joint", model.m.njnt)):
        if model.kind(j) == "free" and model.m.dof_armature[model.m.jnt_dofadr[j]]:
            yield f"joint {name!r}", "armature of a free joint left out"


def _contacts(model: _Model) -> Iterator[tuple[str, str]]:
    m = model.m
    touching = sum(bool(m.geom_contype[g] or m.geom_conaffinity[g]) for g in range(m.ngeom))
    if (touching > 1 or m.npair) and not (
        model.disabled("CONTACT") or model.disabled("CONSTRAINT")
    ):
        pairs = f", {m.npair} named pairs" if m.npair else ""
        yield f"{touching} geoms that can touch{pairs}", "left out"


def _surroundings(model: _Model) -> Iterator[tuple[str, str]]:
    option = model.m.opt
    for name in ("density", "viscosity"):
        if getattr(option, name):
            yield f"option {name!r}", "forces of the medium left out"
    for b, name in enumerate(model.names("body", model.m.nbody)):
        if model.m.body_gravcomp[b]:
            yield f"body {name!r}", "compensation of gravity left out"
        if model.m.body_mocapid[b] >= 0:
            yield f"body {name!r}", "moved from outside (mocap): read as fixed"


LEFT_OUT: tuple[tuple[str, Callable[[_Model], Iterator[tuple[str, str]]]], ...] = (
    ("contact", _contacts),
    ("limit", _joints_where("jnt_limited", "left out")),
    ("friction", _joints_where("dof_frictionloss", "left out")),
    ("tendon", _of("tendon", "ntendon")),
    ("actuator", _actuators),
    ("equality", _of("equality", "neq")),
    ("spring", _springs),
    ("spring", _joints_where("jnt_stiffnesspoly", "the part of its spring that is not linear left out")),
    ("spring", _joints_where("jnt_springyield", "yielding of its spring left out")),
    ("damping", _joints_where("dof_dampingpoly", "the part of its damping that is not linear left out")),
    ("armature", _armatures),
    ("surroundings", _surroundings),
    ("flex", _of("flex", "nflex", "elasticity left out; its nodes are bodies")),
    ("plugin", _of("plugin", "nplugin")),
)  # fmt: skip
"""What of a model is no part of a tree: the reason of a `Repair`, and what yields part and words."""


def _left_out(model: _Model) -> Iterator[Repair]:
    for reason, found in LEFT_OUT:
        yield from (Repair(reason, part, done) for part, done in found(model))
