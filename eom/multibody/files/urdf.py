"""Robots from URDF files as scenes of trees; yourdfpy (extra ``urdf``) reads the elements.

The root link is fixed to the ground. Joints of one degree of freedom have a motor, the input
``tau_<joint>``. Damping is used; what is not used (friction, limits, shapes) stands in the scene's notes.

What a URDF file may hold, asked before any parser of robots sees it: XML without entities, known tags.

Nothing is opened but the file: meshes and ``package://`` names stay text.
"""

from __future__ import annotations

import importlib
import io
import logging
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.parsers import expat

from eom.errors import InputError
from eom.multibody.files.scene import TreeScene
from eom.scenes.naming import spelling
from eom.scenes.scene_files import in_file, text_of

GRAVITY = (0.0, 0.0, -9.81)
"""URDF says nothing of gravity."""

SNAP = 4 * 2.0**-52
"""Entries of rotations that are so close to 0 or 1 are rounded sines of right angles."""

KINDS: Mapping[str, str] = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "floating": "free",
    "planar": "planar",
}
"""Kinds of joints here by those of URDF."""

_UNREADABLE = (AttributeError, IndexError, KeyError, SyntaxError, TypeError, ValueError)
"""What the parser raises for elements that it cannot read."""


def load_urdf(path: str | Path, gravity: Sequence[float] = GRAVITY) -> TreeScene:
    """Return the robot of a URDF file as a scene; ``gravity`` in the ground's axes (m/s^2).

    Raises `InputError` with the file's name for files that are no URDF, entities, unknown and mimicking
    joints, loops, inertias that no body has, and movable joints that move no mass.
    """
    file = Path(path)
    with in_file(file):
        data, left_out = checked(file)
        robot = parsed(data)
        _check(robot)
        return TreeScene(**_scene(file.stem, robot, gravity, left_out))


def parsed(data: bytes) -> Any:
    """Return the elements of a checked URDF file; meshes stay names of files. Raises `InputError`."""
    try:
        parser = importlib.import_module("yourdfpy")
    except ImportError:
        raise InputError(
            "URDF files need the package yourdfpy", hint="pip install 'eom-toolkit[urdf]'"
        ) from None
    logging.getLogger("yourdfpy").addHandler(logging.NullHandler())
    try:
        found = parser.URDF.load(io.BytesIO(data), build_scene_graph=False, load_meshes=False)
    except (*_UNREADABLE, parser.URDFError) as error:
        raise InputError(
            "not a readable URDF file", got=f"{type(error).__name__}: {error}"
        ) from None
    return found.robot


def _check(robot: Any) -> None:
    """Refuse what a tree cannot have."""
    for joint in robot.joints:
        where = f"joint {joint.name!r}"
        if joint.type not in KINDS:
            raise InputError(
                "unknown type of joint", where=where, got=joint.type, expected=", ".join(KINDS)
            )
        if joint.mimic is not None:
            raise InputError(
                "joints that mimic others are not read",
                where=where,
                got=f"mimic of {joint.mimic.joint!r}",
                hint="remove <mimic>, and couple the two joints otherwise",
            )
    children = {j.child for j in robot.joints}
    roots = [link.name for link in robot.links if link.name not in children]
    if len(roots) != 1:
        raise InputError(
            "a robot has one root link",
            got=", ".join(roots) or "none",
            expected="one link without a parent",
        )


def _scene(
    name: str, robot: Any, gravity: Sequence[float], left_out: Iterable[str]
) -> dict[str, Any]:
    links = _spelt("link", [link.name for link in robot.links])
    joints = _spelt("joint", [joint.name for joint in robot.joints])
    children = {joint.child for joint in robot.joints}
    (root,) = (link.name for link in robot.links if link.name not in children)
    fixed = {"kind": "fixed", "parent": "ground", "child": links[root]}
    made = {joints[j.name]: _joint(j, links) for j in robot.joints}
    return {
        "name": name,
        "title": f"{robot.name}, from {name}.urdf",
        "model": "tree",
        "gravity": [*gravity],
        "bodies": {links[link.name]: _body(link) for link in robot.links},
        "joints": {_free_name("root", made): fixed, **made},
        "notes": tuple(_notes(robot, root, gravity, left_out)),
    }


def _free_name(name: str, taken: Iterable[str]) -> str:
    return name if name not in set(taken) else _free_name(f"{name}_0", taken)


def _spelt(kind: str, names: Sequence[str]) -> dict[str, str]:
    """Return each name in letters that symbols can have."""
    found = {name: spelling(name) for name in names}
    if len(set(found.values())) < len(names):
        raise InputError(
            f"repeated name of a {kind}", got=", ".join(sorted(names)),
            expected="names that differ in letters and digits",
        )  # fmt: skip
    return found


def _notes(
    robot: Any, root: str, gravity: Sequence[float], left_out: Iterable[str]
) -> Iterable[str]:
    yield f"URDF: root link {root} fixed to the ground; gravity {tuple(gravity)} m/s^2"
    for place in left_out:
        yield f"URDF: not used: {place}"
    rubbing = [j.name for j in robot.joints if _dynamics(j, "friction")]
    if rubbing:
        yield f"URDF: friction not used: {', '.join(rubbing)}"
    bare = [link.name for link in robot.links if link.inertial is None]
    if bare:
        yield f"URDF: links without <inertial>, of mass 0: {', '.join(bare)}"


def _body(link: Any) -> dict[str, Any]:
    given = link.inertial
    if given is None:
        return {}
    where = f"link {link.name!r}"
    if given.mass is None or given.inertia is None:
        lacking = "mass" if given.mass is None else "inertia"
        raise InputError(f"<inertial> without <{lacking}>", where=where)
    position, rotation = _frame(given.origin, where)
    return {
        "mass": float(given.mass),
        "centre": position,
        "matrix": [[float(x) for x in row] for row in given.inertia],
        "rotation": {"matrix": rotation},
    }


def _joint(joint: Any, links: Mapping[str, str]) -> dict[str, Any]:
    where = f"joint {joint.name!r}"
    for end in (joint.parent, joint.child):
        if end not in links:
            raise InputError(f"unknown link {end!r}", where=where)
    position, rotation = _frame(joint.origin, where)
    kind = KINDS[joint.type]
    found: dict[str, Any] = {
        "kind": kind,
        "parent": links[joint.parent],
        "child": links[joint.child],
        "on_parent": {"position": position, "rotation": {"matrix": rotation}},
    }
    if kind == "planar":
        across = _plane([float(x) for x in joint.axis], where)
        turned = [
            [sum(a * r[k] for a, r in zip(row, rotation, strict=True)) for k in range(3)]
            for row in across
        ]
        found["on_parent"]["rotation"] = {"matrix": turned}
        found["on_child"] = {"rotation": {"matrix": across}}
    elif kind in {"revolute", "prismatic"}:
        found["axis"] = [float(x) for x in joint.axis]
        found["motor"] = True
    if kind not in {"fixed", "free"}:
        found["damping"] = _dynamics(joint, "damping")
    elif _dynamics(joint, "damping"):
        raise InputError("damping at a joint that has none", where=where, got=joint.type)
    return found


def _dynamics(joint: Any, key: str) -> float:
    """Return damping or friction of a joint; 0 if it has none."""
    given = None if joint.dynamics is None else getattr(joint.dynamics, key)
    try:
        return float(given or 0.0)
    except ValueError:
        raise InputError("not a number", where=f"joint {joint.name!r}: {key}", got=given) from None


def _frame(origin: Any, where: str) -> tuple[list[float], list[list[float]]]:
    """Return position, and the rotation from the outer axes to those of the frame."""
    if origin is None:
        return [0.0] * 3, [[float(i == j) for j in range(3)] for i in range(3)]
    if origin.shape != (4, 4):
        raise InputError("not an origin", where=where)
    position = [float(origin[k, 3]) for k in range(3)]
    return position, [[_snapped(float(origin[j, i])) for j in range(3)] for i in range(3)]


def _snapped(x: float) -> float:
    return float(round(x)) if abs(x - round(x)) <= SNAP else x


def _plane(axis: Sequence[float], where: str) -> list[list[float]]:
    """Return the rotation to axes of which the third is the normal of a plane."""
    norm = sum(x * x for x in axis) ** 0.5
    if not norm > 0:
        raise InputError("the axis is zero", where=where, got=axis)
    third = [x / norm for x in axis]
    largest = max(range(3), key=lambda k: abs(third[k]))
    next_one = (largest + 1) % 3
    first = [float(k == next_one) - third[next_one] * third[k] for k in range(3)]
    length = sum(x * x for x in first) ** 0.5
    first = [x / length for x in first]
    a, b = third, first
    second = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    return [first, second, third]


MAX_DEPTH = 20
MAX_ELEMENTS = 100_000

NEEDED: Mapping[str, tuple[str, ...]] = {
    "robot": ("name",),
    "robot/link": ("name",),
    "robot/link/inertial/mass": ("value",),
    "robot/link/inertial/inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "robot/joint": ("name", "type"),
    "robot/joint/parent": ("link",),
    "robot/joint/child": ("link",),
    "robot/joint/mimic": ("joint",),
}
"""Attributes without which an element means nothing; its name stands in messages."""

USED = frozenset(
    {
        *NEEDED, "robot/link/inertial", "robot/link/inertial/origin", "robot/joint/origin",
        "robot/joint/axis", "robot/joint/dynamics",
    }
)  # fmt: skip
"""Elements that say something of the motion. Others are left out, and listed."""


class _Reader:
    """Walks the elements: where it is, the link or joint it is in, what is left out."""

    def __init__(self, parser: expat.XMLParserType) -> None:
        self.parser = parser
        self.path: list[str] = []
        self.part = ""
        self.elements = 0
        self.left_out: Counter[str] = Counter()

    def where(self) -> str:
        return f"{self.part or '/'.join(self.path)}, line {self.parser.CurrentLineNumber}"

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.path.append(tag)
        self.elements += 1
        if self.elements > MAX_ELEMENTS or len(self.path) > MAX_DEPTH:
            expected = f"at most {MAX_ELEMENTS} elements, {MAX_DEPTH} deep"
            raise InputError("too many elements", where=self.where(), expected=expected)
        if len(self.path) == 1 and tag != "robot":
            raise InputError("not a URDF file", where="first element", got=tag, expected="robot")
        if len(self.path) == 2:
            self.part = f"{tag} {attributes.get('name', '')!r}"
        place = "/".join(self.path)
        if place in USED:
            self._check(place, attributes)
        elif "/".join(self.path[:-1]) in USED:
            self.left_out[place.removeprefix("robot/")] += 1

    def _check(self, place: str, attributes: dict[str, str]) -> None:
        for name in NEEDED.get(place, ()):
            if name not in attributes:
                raise InputError(
                    f"missing attribute {name!r}", where=self.where(), got=f"<{self.path[-1]}>"
                )

    def end(self, tag: str) -> None:  # noqa: ARG002
        self.path.pop()

    def doctype(self, *_: object) -> None:
        raise InputError(
            "a URDF file declares no document type",
            where=f"line {self.parser.CurrentLineNumber}",
            got="<!DOCTYPE",
            hint="remove it; entities are not read",
        )

    def declaration(self, _: str, encoding: str | None, __: int) -> None:
        if (encoding or "utf-8").lower() not in {"utf-8", "us-ascii", "ascii"}:
            raise InputError("unusable encoding", got=encoding, expected="UTF-8")


def checked(file: Path) -> tuple[bytes, tuple[str, ...]]:
    """Return the bytes of a URDF file, and what in it says nothing of the motion.

    Raises `InputError` for what is no XML, has a document type, is nested or large beyond reason, or lacks
    an attribute of `NEEDED`.
    """
    data = text_of(file, "*.urdf").encode()
    parser = expat.ParserCreate("utf-8", " ")
    reader = _Reader(parser)
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.StartDoctypeDeclHandler = reader.doctype
    parser.XmlDeclHandler = reader.declaration
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise InputError("not valid XML", got=str(error)) from None
    ignored = tuple(f"<{place}>, {n} of them" for place, n in sorted(reader.left_out.items()))
    return data, ignored
