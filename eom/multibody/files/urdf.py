"""Robots from URDF files as scenes of trees; yourdfpy (extra ``urdf``) reads the elements.

The root link is fixed to the ground, or floats. Joints of one degree of freedom have a motor, the input
``tau_<joint>``. Damping is used; what is not used (friction, limits, shapes) stands in the scene's notes.

What a URDF file may hold, asked before any parser of robots sees it: XML without entities, known tags.

Nothing is opened but the file: meshes and ``package://`` names stay text.

Lenient reading mends what other readers let pass, by the passes of `MENDING`; what it did are `Repair`s.
"""

from __future__ import annotations

import importlib
import io
import logging
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.parsers import expat

import mpmath

from eom.errors import InputError
from eom.multibody.algebra.spatial import IDENTITY, Matrix, cross, product, transposed
from eom.multibody.algebra.values import value
from eom.multibody.files.scene import Repair, TreeScene
from eom.multibody.model import checks
from eom.multibody.model.bodies import GROUND
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
FURTHER_KINDS: Mapping[str, str] = {"spherical": "spherical"}
"""Kinds that some programs write, and lenient reading takes."""
RESERVED = frozenset({GROUND})
"""Names that no body may have."""

TURNING = ("revolute", "continuous")
"""Types of joints that turn about one axis."""
SINGLE = (*TURNING, "prismatic")
"""Types of joints of one degree of freedom."""
DIGITS = 30
"""Of nearest inertias on the way."""

_UNREADABLE = (AttributeError, IndexError, KeyError, SyntaxError, TypeError, ValueError)
"""What the parser raises for elements that it cannot read."""


def load_urdf(
    path: str | Path,
    gravity: Sequence[float] = GRAVITY,
    *,
    strict: bool = True,
    floating: bool = False,
) -> TreeScene:
    """Return the robot of a URDF file as a scene; ``gravity`` in the ground's axes (m/s^2).

    ``strict``: refuse what no body or tree is; otherwise mend it (`MENDING`), and say so in the scene's
    ``repairs``, which also name the limits and the dry friction of joints, that are left out.
    ``floating``: free the root link, by a joint of kind ``free`` to the ground.

    Raises `InputError` with the file's name for files that are no URDF, entities, unknown types of joints,
    loops, a floating root without mass; if strict also for mimicking joints, inertias that no body has,
    names that no symbol has, and movable joints that move no mass.
    """
    file = Path(path)
    with in_file(file):
        data, left_out = checked(file, strict=strict)
        robot = parsed(moving_part(data, file.stem))
        _check(robot, strict)
        lacking = tuple(_left_out(robot, data))
        repairs = (*(() if strict else _mended(robot, data, floating)), *lacking)
        scene = _scene(file.stem, robot, gravity, strict, floating)
        notes = tuple(_notes(robot, gravity, left_out, floating))
        return TreeScene(**scene, notes=notes, repairs=repairs)


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


def _check(robot: Any, strict: bool) -> None:
    """Refuse what a tree cannot have."""
    known = KINDS if strict else {**KINDS, **FURTHER_KINDS}
    for joint in robot.joints:
        where = f"joint {joint.name!r}"
        if joint.type not in known:
            raise InputError(
                "unknown type of joint", where=where, got=joint.type, expected=", ".join(KINDS)
            )
        if strict and joint.mimic is not None:
            raise InputError(
                "joints that mimic others are not read",
                where=where,
                got=f"mimic of {joint.mimic.joint!r}",
                hint="read it leniently, or remove <mimic> and couple the two joints otherwise",
            )
    children = {j.child for j in robot.joints}
    roots = [link.name for link in robot.links if link.name not in children]
    if len(roots) != 1:
        raise InputError(
            "a robot has one root link",
            got=", ".join(roots) or "none",
            expected="one link without a parent",
        )


def _root(robot: Any) -> str:
    children = {joint.child for joint in robot.joints}
    return str(next(link.name for link in robot.links if link.name not in children))


def _scene(
    name: str, robot: Any, gravity: Sequence[float], strict: bool, floating: bool
) -> dict[str, Any]:
    links = names_of("link", [link.name for link in robot.links], strict)
    joints = names_of("joint", [joint.name for joint in robot.joints], strict)
    if floating:
        _check_floating(robot)
    first = {
        "kind": "free" if floating else "fixed",
        "parent": GROUND,
        "child": links[_root(robot)],
    }
    made = {joints[j.name]: _joint(j, links) for j in robot.joints}
    bound = [j for j in robot.joints if j.mimic is not None and j.mimic.joint]
    coupled = {f"mimic_{joints[j.name]}": _coupling(j, joints) for j in bound}
    starts = {joints[j.name]: float(j.mimic.offset) for j in bound}
    return {
        "name": name,
        "title": f"{robot.name}, from {name}.urdf",
        "model": "tree",
        "gravity": [*gravity],
        "bodies": {links[link.name]: _body(link) for link in robot.links},
        "joints": {free_name("root", made): first, **made},
        "constraints": coupled,
        "initial": {f"q_{joint}": offset for joint, offset in starts.items() if offset},
    }


def _coupling(joint: Any, names: Mapping[str, str]) -> dict[str, Any]:
    ratios = {names[joint.name]: 1, names[joint.mimic.joint]: -float(joint.mimic.multiplier)}
    return {"kind": "coupling", "ratios": ratios, "follower": names[joint.name]}


def _check_floating(robot: Any) -> None:
    """Refuse a root that has no mass, and nothing heavy fixed to it: nothing would hold it back."""
    links = {link.name: link for link in robot.links}
    root = _root(robot)
    if not any(mass_of(links[name]) > 0 for name in _rigid(robot, root)):
        raise InputError(
            "a base that floats has no mass", where=f"link {root!r}",
            hint="give it mass, or leave it fixed to the ground",
        )  # fmt: skip


def free_name(name: str, taken: Iterable[str]) -> str:
    """Return a name that is not taken: itself, or with as many ``_0`` behind it as that takes."""
    return name if name not in set(taken) else free_name(f"{name}_0", taken)


def names_of(kind: str, names: Sequence[str], strict: bool = True) -> dict[str, str]:
    """Return each name in letters that symbols can have; ``kind``: link or joint.

    Unless ``strict``, names that begin with no letter, reserved ones and those that would be alike are
    changed. Raises `InputError` for repeated names.
    """
    found = {name: spelling(name) for name in names}
    taken: set[str] = set()
    for name, spelt in () if strict else tuple(found.items()):
        letters = spelt if re.match("[A-Za-z]", spelt) else f"{kind}_{spelt}"
        letters = f"{kind}_{spelt}" if letters in RESERVED else letters
        found[name] = free_name(letters, taken)
        taken.add(found[name])
    if len(set(found.values())) < len(names):
        raise InputError(
            f"repeated name of a {kind}", got=", ".join(sorted(names)),
            expected="names that differ in letters and digits",
        )  # fmt: skip
    return found


def _notes(
    robot: Any, gravity: Sequence[float], left_out: Iterable[str], floating: bool
) -> Iterable[str]:
    held = "floats" if floating else "fixed to the ground"
    yield f"URDF: root link {_root(robot)} {held}; gravity {tuple(gravity)} m/s^2"
    for place in left_out:
        yield f"URDF: not used: {place}"
    bare = [link.name for link in robot.links if link.inertial is None]
    if bare:
        yield f"URDF: links without <inertial>, of mass 0: {', '.join(bare)}"


def _left_out(robot: Any, data: bytes) -> Iterator[Repair]:
    """Yield what acts on the motion by the file, and not in the scene: limits of joints, dry friction."""
    root = ElementTree.fromstring(data)  # noqa: S314 - no document type, so no entities
    for joint in root.findall("joint"):
        if joint.get("type") != "fixed" and joint.find("limit") is not None:
            yield Repair("limit", f"joint {joint.get('name')!r}", "left out")
    for joint in robot.joints:
        if _dynamics(joint, "friction"):
            yield Repair("friction", f"joint {joint.name!r}", "left out")


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
    kind = {**KINDS, **FURTHER_KINDS}[joint.type]
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
        found["motor"] = joint.mimic is None
        if joint.mimic is not None and not joint.mimic.joint:
            found["motion"] = {"position": [float(joint.mimic.offset)]}
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
"""Elements that say something of the motion. Others are left out, and listed, limits joint by joint."""


class _Reader:
    """Walks the elements: where it is, the link or joint it is in, what is left out."""

    def __init__(self, parser: expat.XMLParserType, strict: bool) -> None:
        self.parser = parser
        self.strict = strict
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
        elif "/".join(self.path[:-1]) in USED and place != "robot/joint/limit":
            self.left_out[place.removeprefix("robot/")] += 1

    def _check(self, place: str, attributes: dict[str, str]) -> None:
        for name in NEEDED.get(place, ()):
            if name not in attributes and (self.strict or place != "robot"):
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


def checked(file: Path, *, strict: bool = True) -> tuple[bytes, tuple[str, ...]]:
    """Return the bytes of a URDF file, and what in it says nothing of the motion.

    Unless ``strict``, blank lines may stand before the declaration, and the robot needs no name. Raises
    `InputError` for what is no XML, has a document type, is nested or large beyond reason, or lacks an
    attribute of `NEEDED`.
    """
    text = text_of(file, "*.urdf")
    data = (text if strict else text.lstrip()).encode()
    parser = expat.ParserCreate("utf-8", " ")
    reader = _Reader(parser, strict)
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


def moving_part(data: bytes, name: str) -> bytes:
    """Return what checked bytes say of the motion alone, of a robot that has at least this ``name``."""
    root = ElementTree.fromstring(data)  # noqa: S314 - no document type, so no entities
    root.attrib.setdefault("name", name)
    _keep_used(root, "robot")
    return ElementTree.tostring(root)


def _keep_used(element: ElementTree.Element, place: str) -> None:
    for child in [*element]:
        inner = f"{place}/{child.tag}"
        if inner in USED:
            _keep_used(child, inner)
        else:
            element.remove(child)


# -- what lenient reading mends ------------------------------------------------------------------------


def _mended(robot: Any, data: bytes, floating: bool) -> Iterator[Repair]:
    """Mend a robot that was parsed for this; yield what was done."""
    if not re.search(rb"<robot[^>]*\sname", data):
        yield Repair("name", "robot", f"no name: it is called {robot.name!r}")
    for kind, parts in (("link", robot.links), ("joint", robot.joints)):
        names = [part.name for part in parts]
        for name, spelt in names_of(kind, names, strict=False).items():
            if spelt != spelling(name):
                yield Repair("name", f"{kind} {name!r}", f"called {spelt}")
    for mend in MENDING:
        yield from mend(robot, floating)


def _mend_types(robot: Any, floating: bool) -> Iterator[Repair]:  # noqa: ARG001
    """Take types of joints that some programs write; damping at fixed joints says nothing."""
    for joint in robot.joints:
        where = f"joint {joint.name!r}"
        if joint.type in FURTHER_KINDS:
            yield Repair("type", where, f"{joint.type} is no type of URDF, read as {joint.type}")
        if KINDS.get(joint.type) in {"fixed", "free"} and _dynamics(joint, "damping"):
            yield Repair("damping", where, f"ignored at a {joint.type} joint")
            joint.dynamics = None


def _mend_mimics(robot: Any, floating: bool) -> Iterator[Repair]:  # noqa: ARG001
    """Couple joints that mimic others to one that mimics none."""
    joints = {joint.name: joint for joint in robot.joints}
    resolved = {j.name: _driver(j, joints) for j in robot.joints if j.mimic is not None}
    for name, (driver, multiplier, offset) in resolved.items():
        joint, where = joints[name], f"joint {name!r}"
        given, joint.mimic = joint.mimic, None
        if joint.type not in SINGLE:
            yield Repair("mimic", where, f"ignored at a {joint.type} joint")
        elif driver is None:
            lacking = f"it mimics {given.joint!r}, which is not there or mimics it"
            yield Repair("mimic", where, f"{lacking}: it moves by itself")
        elif joints[driver].type not in SINGLE or not multiplier:
            _fix(joint, replace(given, joint="", offset=offset) if offset else None)
            yield Repair("mimic", where, f"held at {offset:g}, as {driver!r} does not move it")
        else:
            joint.mimic = replace(given, joint=driver, multiplier=multiplier, offset=offset)
            rule = f"{multiplier:g} q_{driver}" + (f" + {offset:g}" if offset else "")
            yield Repair("mimic", where, f"coupled: {rule}")


def _driver(joint: Any, joints: Mapping[str, Any]) -> tuple[str | None, float, float]:
    """Return the joint at the end of a chain of mimics, or None, with multiplier and offset to it."""
    multiplier, offset = 1.0, 0.0
    seen: set[str] = set()
    while joint.mimic is not None:
        own = 1.0 if joint.mimic.multiplier is None else float(joint.mimic.multiplier)
        offset += multiplier * float(joint.mimic.offset or 0.0)
        multiplier *= own
        seen.add(joint.name)
        if joint.mimic.joint in seen or joint.mimic.joint not in joints:
            return None, 0.0, 0.0
        joint = joints[joint.mimic.joint]
    return joint.name, multiplier, offset


def _fix(joint: Any, held: Any = None) -> None:
    """Fix a joint at zero; or ``held`` at a constant, as what mimics nothing, with an offset."""
    joint.type, joint.dynamics, joint.mimic = joint.type if held else "fixed", None, held


def mass_of(link: Any) -> float:
    """Return the mass of a link (kg); 0 where none is given."""
    return float(getattr(link.inertial, "mass", None) or 0.0)


def _mend_inertias(robot: Any, floating: bool) -> Iterator[Repair]:  # noqa: ARG001
    """Take the nearest inertia that a body has."""
    for link in robot.links:
        if mass_of(link) > 0 and link.inertial.inertia is not None:
            given = [[float(x) for x in row] for row in link.inertial.inertia]
            if not _possible(given):
                near, share = nearest_inertia(given)
                link.inertial.inertia = near
                done = f"nearest possible inertia taken, {share:.2g} of its size away"
                yield Repair("inertia", f"link {link.name!r}", done)


def _possible(J: Sequence[Sequence[float]]) -> bool:
    """Return whether a body has this inertia about its centre of mass; one that is not finite waits."""
    try:
        exact = tuple(tuple(value(x, "inertia") for x in row) for row in J)
    except InputError:
        return True
    try:
        checks.body(1, exact, "inertia")
    except InputError:
        return False
    return True


def nearest_inertia(J: Sequence[Sequence[float]]) -> tuple[list[list[float]], float]:
    """Return the nearest inertia that a body has about its centre of mass, and how far it is.

    ``J``: symmetric, 3 x 3 (kg m^2). Near is meant of the second moments of mass S = tr(J)/2 1 - J, in the
    Frobenius norm: negative principal second moments become zero. The distance is relative to the norm
    of the given S. A body has an inertia if no principal second moment is negative.

    Source: Higham, Linear Algebra and its Applications 103, 1988, p. 103, theorem 2.1, for the nearest
    matrix; Wensing, Kim and Slotine, IEEE Robotics and Automation Letters 3(1), 2018, p. 60, for S.

    >>> nearest_inertia([[1, 0, 0], [0, 1, 0], [0, 0, 4]])
    ([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 4.0]], 0.3333333333333333)
    """
    half = sum(J[k][k] for k in range(3)) / 2
    S = [[(half if i == j else 0.0) - J[i][j] for j in range(3)] for i in range(3)]
    with mpmath.workdps(DIGITS):
        values, axes = mpmath.eigsy(mpmath.matrix(S))
        kept = [max(v, mpmath.mpf(0)) for v in values]
        lost = mpmath.norm([v - k for v, k in zip(values, kept, strict=True)])
        near = axes * mpmath.diag(kept) * axes.T
        inertia = [
            [float((sum(kept) if i == j else 0) - (near[i, j] + near[j, i]) / 2) for j in range(3)]
            for i in range(3)
        ]
        size = mpmath.norm(list(values))
        return inertia, float(lost / size) if size else 0.0


def _mend_massless(robot: Any, floating: bool) -> Iterator[Repair]:
    """Add inertia without mass to a link with mass that is fixed to it, or drop it."""
    links = {link.name: link for link in robot.links}
    grounded = {} if floating else _rigid(robot, _root(robot))
    for link in robot.links:
        own = link.inertial
        if own is None or mass_of(link) or not any(x for row in _rows(own) for x in row):
            continue
        turns = _rigid(robot, link.name)
        heavy = [
            n for n in turns if mass_of(links[n]) > 0 and links[n].inertial.inertia is not None
        ]
        done = "dropped"
        if link.name in grounded:
            done += ": it is fixed to the ground, and moves nothing"
        elif heavy:
            _lump(own, links[heavy[0]].inertial, turns[heavy[0]])
            done = f"lumped with link {heavy[0]!r}, to which it is fixed"
        own.inertia = [[0.0] * 3] * 3
        yield Repair("massless", f"link {link.name!r}", done)


def _rows(inertial: Any) -> Matrix:
    return () if inertial.inertia is None else [[float(x) for x in r] for r in inertial.inertia]


def _lump(light: Any, heavy: Any, turn: Matrix) -> None:
    """Add the inertia of a link without mass to another; ``turn``: from its axes to those of the other."""
    outer, inner = _frame(light.origin, "inertia")[1], _frame(heavy.origin, "inertia")[1]
    C = product(inner, product(turn, transposed(outer)))
    more = product(C, product(_rows(light), transposed(C)))
    heavy.inertia = [
        [(a + b) / 2 for a, b in zip(*rows, strict=True)]
        for rows in zip(_sum(_rows(heavy), more), transposed(_sum(_rows(heavy), more)), strict=True)
    ]


def _sum(A: Matrix, B: Matrix) -> Matrix:
    return [[a + b for a, b in zip(*rows, strict=True)] for rows in zip(A, B, strict=True)]


def _rigid(robot: Any, link: str) -> dict[str, Matrix]:
    """Return the links that fixed joints hold to a link, itself first: C from its axes to theirs."""
    found: dict[str, Matrix] = {link: IDENTITY}
    waiting = [link]
    fixed: list[tuple[Any, Matrix]] = [
        (j, _frame(j.origin, f"joint {j.name!r}")[1]) for j in robot.joints if j.type == "fixed"
    ]
    while waiting:
        name = waiting.pop()
        steps = [(j.child, C) for j, C in fixed if j.parent == name]
        steps += [(j.parent, transposed(C)) for j, C in fixed if j.child == name]
        for other, C in steps:
            if other not in found:
                found[other] = product(C, found[name])
                waiting.append(other)
    return found


def _mend_idle(robot: Any, floating: bool) -> Iterator[Repair]:  # noqa: ARG001
    """Fix joints that move no mass, and those at ends that turn point masses on their axes alone."""
    moving = _heavy(robot)
    idle = [j for j in robot.joints if j.type != "fixed" and j.child not in moving]
    for joint in idle:
        _fix(joint)
        yield Repair("idle", f"joint {joint.name!r}", "fixed, as it moves no mass")
    gone = {joint.name for joint in idle}
    while turning := [j for j in robot.joints if _turns_points(robot, j)]:
        _fix(turning[0])
        gone.add(turning[0].name)
        done = "fixed, as the mass that it turns is a point on its axis"
        yield Repair("idle", f"joint {turning[0].name!r}", done)
    for joint in (j for j in robot.joints if j.mimic is not None and j.mimic.joint in gone):
        done = f"moves by itself, as {joint.mimic.joint!r} is fixed"
        joint.mimic = None
        yield Repair("mimic", f"joint {joint.name!r}", done)


def _turns_points(robot: Any, joint: Any) -> bool:
    """Return whether a joint at an end of the tree turns a point mass on its axis, and nothing else."""
    coupled = {j.mimic.joint for j in robot.joints if j.mimic is not None}
    if joint.type not in TURNING or joint.mimic is not None or joint.name in coupled:
        return False
    held, moving = _rigid(robot, joint.child), _heavy(robot)
    carried = [link.inertial for link in robot.links if link.name in held and link.inertial]
    heavy = {link.name for link in robot.links if link.name in held and mass_of(link)}
    further = any(
        j.type != "fixed" and j.parent in held and j.child in moving for j in robot.joints
    )
    if (
        further
        or heavy != {joint.child}
        or any(x for own in carried for r in _rows(own) for x in r)
    ):
        return False
    point = next(link.inertial.origin for link in robot.links if link.name == joint.child)
    centre = _frame(point, f"link {joint.child!r}")[0]
    return not any(cross(centre, [float(x) for x in joint.axis]))


def _heavy(robot: Any) -> set[str]:
    """Return the links that have mass, or carry some."""
    leading = {j.child: j.parent for j in robot.joints}
    found: set[str] = set()
    for link in robot.links:
        name: str | None = link.name if mass_of(link) else None
        while name is not None and name not in found:
            found.add(name)
            name = leading.get(name)
    return found


MENDING: tuple[Callable[[Any, bool], Iterator[Repair]], ...] = (
    _mend_types, _mend_mimics, _mend_idle, _mend_inertias, _mend_massless,
)  # fmt: skip
"""What lenient reading does, in this order: each changes a robot, and yields what it did."""
