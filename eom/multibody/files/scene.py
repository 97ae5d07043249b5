"""A scene with many bodies: in Python or as a TOML file, with its systems and numbers.

It answers what `eom.scenes.scene.Scene` answers, so that commands need not know which of the two they have.

Parts of a scene that come n times: ``[repeat] i = 5`` makes ``link1`` to ``link5`` of ``link{i}``.

A key with ``{i}`` becomes one key for each number; in what belongs to it ``{i}``, ``{i-1}`` and ``{i+1}``
are numbers. A key that is written out stands in place of the one that would be made.

Where a tree starts: coordinates and speeds at t = 0.

What can be asked of a tree by name, and the smallest system that gives it.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from typing import Any, Self

import pydantic
import sympy as sp

from eom.errors import InputError, unknown_name
from eom.multibody.constrained.consistent import assemble
from eom.multibody.files.description import TreeDescription
from eom.multibody.files.sections import JointAngles, Reading, angles_of, points_of, tree_of
from eom.multibody.model.bodies import GROUND, Joint
from eom.multibody.model.joints import QUATERNION
from eom.multibody.model.model import Tree
from eom.multibody.recursion.operation_count import savings
from eom.multibody.recursion.quantities import Point
from eom.multibody.system.derive import OUTPUTS, derive
from eom.multibody.system.reactions import Reaction, drives_of, of_all
from eom.multibody.system.vectors import Drawn
from eom.scenes.description import (
    Description,
    check_end,
    check_initial_attitude,
    of_norm_one,
)
from eom.scenes.given import number_of
from eom.scenes.naming import check_used
from eom.scenes.reduce import Explanation, Pass, Reduction, by_name, only, reductions
from eom.scenes.scene import Scene
from eom.scenes.scene_files import BaseScene
from eom.scenes.start import in_coordinates, number, sizes
from eom.system import System


@dataclass(frozen=True)
class Repair:
    """One thing of a file that was mended in reading it leniently, or left out, in words.

    ``reason``: a key of `REASONS`. ``part``: of the file. ``done``: to it, with the size of the change
    relative to what was given, where there is one.
    """

    reason: str
    part: str
    done: str


UNUSED = "use it in a formula of a body, joint, load, law of control or the like, or remove it"
"""What to do with a parameter or an input that nothing reads."""

REASONS: Mapping[str, str] = {
    "name": "names mapped",
    "type": "types of joints beyond the standard",
    "damping": "damping that brakes nothing",
    "mimic": "joints that mimic others",
    "idle": "joints without mass",
    "inertia": "inertias that no body has (nearest: Frobenius norm of second moments)",
    "massless": "inertia without mass",
    "contact": "contacts",
    "limit": "limits",
    "friction": "friction",
    "tendon": "tendons",
    "actuator": "actuators and muscles",
    "equality": "equalities",
    "spring": "springs that are not linear in one coordinate",
    "armature": "armatures",
    "surroundings": "forces of the surroundings",
    "flex": "flexible bodies",
    "plugin": "plugins",
}
"""Why something is mended or left out, in the words that are printed."""
SHOWN = 8
"""Repairs of one reason that are printed."""


def repair_notes(repairs: Sequence[Repair]) -> tuple[str, ...]:
    """Return what was mended or left out in words, a line a reason; of many the first."""
    lines = []
    for reason, words in REASONS.items():
        own = [r for r in repairs if r.reason == reason]
        more = f"; and {len(own) - SHOWN} more (repairs of the scene)" if len(own) > SHOWN else ""
        listed = "; ".join(f"{r.part}: {r.done}" for r in own[:SHOWN])
        lines += [f"{words}: {listed}{more}"] if own else []
    return tuple(lines)


class TreeScene(BaseScene, TreeDescription):
    """A checked description, with the tree, systems and numbers that follow from it.

    Fields: see `eom.multibody.files.description.TreeDescription`; ``repeat`` writes out repeated parts
    first (`eom.multibody.files.scene`), and ``body`` is a tree of one (`of_one`). ``notes``: what a file
    said that is not used, for `explain`; ``repairs``: what was mended in reading it leniently, or left
    out; ``spare``: parameters that no formula need use; ``implied``: those whose units the scene does not
    state itself. SI units, angles in radians; frames are those of the ground, the bodies and the joints
    (`Joint`). Raises `InputError` for anything that is misspelt, missing or impossible.

    >>> rod = {"mass": "m", "centre": (0, 0, "-l/2"), "moments": ("m*l**2/12", "m*l**2/12", 0)}
    >>> hinge = {"kind": "revolute", "parent": "ground", "child": "rod", "axis": "x"}
    >>> TreeScene(bodies={"rod": rod}, joints={"hinge": hinge}, gravity=(0, 0, "-g"),
    ...     parameters={"m": 1, "l": 2, "g": 9.81}).derive()
    System('scene': states q_hinge, u_hinge; parameters g, l, m; invariants energy)
    """

    is_tree = True
    notes: tuple[str, ...] = ()
    repairs: tuple[Repair, ...] = ()
    spare: tuple[str, ...] = ()
    implied: tuple[str, ...] = ()

    def __init__(self, /, **data: Any) -> None:
        super().__init__(**data)

    @classmethod
    def _written_out(cls, data: dict[str, Any]) -> dict[str, Any]:
        return written_out(of_one(data))

    @pydantic.model_validator(mode="after")
    def _check(self) -> Self:
        """Check everything that one field alone cannot show."""
        check_end(self)
        states, choice, angles = self._start, self._choice, self._angles
        read = self._reading
        names = (q.name for q in (*read.parameters, *read.inputs) if q.name not in self.spare)
        self._control_over(self._names)
        check_used(names, read.used | self.control.words, UNUSED)
        if self.keep and not self.tree.constraints:
            raise InputError("keep belongs to constraints", where="keep", got=", ".join(self.keep))
        for name in self.outputs:
            own = (*states, *angles, *self.control.laws, *self.control.definitions)
            if not (name in own or choice.is_known(name)):
                known = [*own, *choice.known()]
                raise unknown_name("output", name, known, "outputs")
        return self

    @cached_property
    def _reading(self) -> Reading:
        return Reading(self)

    @cached_property
    def tree(self) -> Tree:
        """The bodies and joints."""
        return tree_of(self._reading)

    @cached_property
    def _choice(self) -> Choice:
        return Choice(self.tree, points_of(self._reading))

    @property
    def _asked(self) -> tuple[str, ...]:
        return self.outputs or (*self._start, *self._angles, POINTS)

    def asking(self, more: Sequence[str]) -> Self:
        """Return the scene with all states and points asked for, and ``more`` outputs.

        Parameters
        ----------
        more : sequence of str
            Names of outputs, or words for several (`eom.multibody.files.scene.Choice`).

        Returns
        -------
        TreeScene
            The same scene otherwise; what was derived of it is derived anew.
        """
        wanted = (*self._start, *self._angles, POINTS, *more)
        return self.model_copy(update={"outputs": tuple(dict.fromkeys(wanted))})

    @cached_property
    def _joint_angles(self) -> tuple[JointAngles, ...]:
        return angles_of(self.joints, self.tree)

    @property
    def _angles(self) -> tuple[str, ...]:
        """Names of the angles that joints with a quaternion are shown in."""
        return tuple(q.name for a in self._joint_angles for q in a.quantities)

    @cached_property
    def _start(self) -> dict[str, float]:
        return start_values(self.tree, self._reading)

    @cached_property
    def full_system(self) -> System:
        """The system with every state and output that can be asked for.

        Raises `InputError` as `eom.multibody.derive` does.
        """
        return self._named(derive(self.tree, self._choice.everything, start=self._near))

    def of_tree(
        self, tree: Tree, wanted: Sequence[Source], independent: Sequence[str] | None = None
    ) -> System:
        """Return the system of a tree, which is the scene's with some of it left out, under its control.

        Parameters
        ----------
        tree : Tree
            As `TreeScene.tree` makes it, or with less.
        wanted : sequence of str
            Outputs beside those that laws of control read.
        independent : sequence of str, optional
            Speeds that stay where constraints eliminate others, as `eom.multibody.derive` takes
            them.

        Returns
        -------
        System
            The closed loop where the scene has laws of control.

        Raises
        ------
        InputError
            As `eom.multibody.derive` raises it.
        """
        read = (n for n in sorted(self.control.words) if n in self._choice.sources)
        asked = tuple(dict.fromkeys((*wanted, *self._choice.needed(tuple(read)))))
        return self._named(derive(tree, asked, start=self._near, independent=independent))

    @cached_property
    def _names(self) -> dict[str, Any]:
        """What formulas of its control may name: what loads may, what bodies define, and outputs."""
        outputs = (*self._choice.sources, *self._angles)
        return {**{n: sp.Symbol(n, real=True) for n in outputs}, **self._reading.acting.names}

    @property
    def _near(self) -> dict[str, float]:
        """Where constraints are tested for dependence: parameters and coordinates at the start."""
        return {**self.numbers, **self._start} if self.tree.constraints else {}

    @cached_property
    def _whole(self) -> System:
        """The system with the outputs asked for, and all states."""
        return self.of_tree(self.tree, self._choice.needed(self._asked))

    def _general(self) -> System:
        return self._whole

    def _passes(self) -> Mapping[str, Pass]:
        every: Pass = lambda system: (system, (), "")  # noqa: E731
        return {"outputs": only(self.requested, by_name) if self.outputs else every}

    def _named(self, system: System) -> System:
        named = replace(system, name=self.name, title=self.title)
        shown = reduce(lambda whole, angles: angles.of(whole), self._joint_angles, named)
        return self._closed_loop(shown, self._names)

    @property
    def requested(self) -> tuple[str, ...]:
        """What is asked for: the outputs, or all states and points where none are named."""
        return self._choice.names(self._asked, self._whole)

    def explain(self) -> Explanation:
        """Return what was skipped, why, and the operations saved; print it to read it."""
        saved = savings(self.tree)
        left_out = (*map(Reduction, saved.reasons), *reductions(self._reduced[1]))
        notes = tuple(map(Reduction, (*self.notes, *repair_notes(self.repairs))))
        return Explanation((*left_out, *notes), saved.without, saved.done, "without")

    def _starting(self) -> Collection[str]:
        return (*self._start, *self._angles)

    def _started(self, data: dict[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
        attitudes, initial = dict(data.get("initial_attitude", {})), dict(data.get("initial", {}))
        for shown in self._joint_angles:
            names = [q.name for q in shown.quantities]
            if {*names} & {*values}:
                angles = dict(zip(names, shown.at(self._start), strict=True))
                angles |= {n: number_of(values[n], "rad", n) for n in names if n in values}
                said = {"sequence": shown.sequence, "radians": [*angles.values()]}
                attitudes[shown.joint.name] = said
                for name in (c.name for c in shown.joint.coordinates[-4:]):
                    initial.pop(name, None)
        for joint in self.tree.ordered:
            names = [c.name for c in joint.coordinates if c.name in self._start]
            if joint.name in self.initial_attitude and {*names} & {*values}:
                attitudes.pop(joint.name)
                initial |= {n: self._start[n] for n in names}
        turned = {*self._angles}
        own = {n: v for n, v in values.items() if n not in turned}
        data = {**data, "initial": {**initial, **own}, "initial_attitude": attitudes}
        if self.tree.constraints:
            data["keep"] = tuple(dict.fromkeys((*self.keep, *own)))
        return data

    @property
    def start(self) -> dict[str, float]:
        """The value of each state at t = 0, by name, in SI units."""
        return self._start

    @property
    def attitudes(self) -> tuple[tuple[str, ...], ...]:
        """Names of the states that are one attitude together, and cannot vary alone."""
        return tuple(quaternions(self.tree))


ONE = "body"
"""The name of the body of a scene of one, and of its joint."""
_UNSAID: dict[str, dict[str, Any]] = {
    **{key: {"body": ONE} for key in ("rotors", "loads", "points", "jets")},
    "springs": {"first": GROUND, "second": ONE},
    "constraints": {},
}
"""What parts of a scene of one body need not say."""
_READ = {"body", "torque", "attitude", "angles", "integrate", "parameters"}
_TIDE = [["2*n^2", 0, 0], [0, "-n^2", 0], [0, 0, "-n^2"]]
_FIELDS = {"weight": ("gravity", [0, 0, "-g"]), "gravity_gradient": ("gravity_gradient", _TIDE)}
"""Gravity by what the torque of a scene of one body says; on a circular orbit n^2 (3 r r - 1)."""
_TURNING = {"position": (0,), "rate": ("n",), "acceleration": (0,)}
_ORBIT = {"kind": "revolute", "parent": GROUND, "child": "orbit", "motion": _TURNING}
"""The joint of the orbit frame, a body without mass: axes of the ground are those along it at any time."""


def of_one(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the data of a tree of one body for what `eom.scenes.description.Description` says of it.

    Its numbers become parameters, by the names that they have there. ``joint``: from the ground, or from
    the orbit frame; a spherical one about the point that the inertia is about, unless it says otherwise.
    Data with ``bodies`` are returned as they are. Raises `InputError` as `Scene` does, and for what is
    given twice.
    """
    if "body" not in data or "bodies" in data:
        return data
    said = Description(**{k: v for k, v in data.items() if k in _READ})
    base = _by_laws(said)
    torque, own = said.torque, _own(base, said)
    field = dict(row for law, row in _FIELDS.items() if getattr(torque, law))
    masses = {"mass"} if torque.weight and not said.body.solid else set()
    for name in sorted({*field, *own, "joints"} & {*data, *said.parameters, *masses}):
        raise InputError(f"{name} is given twice", where=f"{name}, and [body], [torque] or [joint]",
                         hint=f"rename yours: the scene has {name} itself")  # fmt: skip
    joint = {"kind": "spherical", "attitude": base.coordinates, "angles": base.sequence, "alone": True,
             "parent": GROUND, "child": ONE}  # fmt: skip
    frame = "orbit" if torque.gravity_gradient else GROUND
    bodies, joints = {ONE: _body_of(own)}, _filled({ONE: data.get("joint", {})}, joint, frame)
    if frame != GROUND:
        bodies["orbit"], joints["orbit"] = {}, _ORBIT
    read = {*_READ, "joint", *({"model"} if data.get("model") == "rigid body" else ())}
    found = {k: v for k, v in data.items() if k not in read}
    found |= {k: _filled(data.get(k, {}), unsaid, frame) for k, unsaid in _UNSAID.items()}
    if torque.components and isinstance(found["loads"], Mapping):
        couple = {"body": ONE, "torque": torque.components, "axes": "body"}
        found["loads"] = {"[torque] components": couple, **found["loads"]}
    if "initial_attitude" in data:
        found["initial_attitude"] = {ONE: data["initial_attitude"]}
    made = {"bodies": bodies, "joints": joints, "parameters": {**said.parameters, **own}}
    return {**found, **field, **made, "spare": tuple(sizes(said)), "implied": tuple(own)}


def _by_laws(said: Description) -> Scene:
    """Return the scene of the body under the torques that have laws, which is checked as such.

    The mass of a body that is no solid is of no use to it.
    """
    torque = said.torque.model_copy(update={"components": None})
    attitude = QUATERNION if said.attitude == "none" else said.attitude
    body = said.body if said.body.solid else said.body.model_copy(update={"mass": None})
    given = {"angles": said.angles, "integrate": said.integrate}
    return Scene(body=body, attitude=attitude, torque=torque, **given)


def _own(base: Scene, said: Description) -> dict[str, Any]:
    """Return what the body and its torques define, as parameters."""
    said_of = {q.name: {"unit": q.unit, "meaning": q.meaning} for q in base.full_system.parameters}
    values = {**base.numbers, **sizes(said)}
    return {n: {**said_of.get(n, {}), "value": float(v)} for n, v in values.items()}


def _body_of(own: Mapping[str, Any]) -> dict[str, Any]:
    """Return the body of a tree over the names of ``own``; inertia about the body's origin."""
    rows = [[f"J{min(i, j)}{max(i, j)}" for j in (1, 2, 3)] for i in (1, 2, 3)]
    inertia = {"moments": ("I1", "I2", "I3")} if "I1" in own else {"matrix": rows}
    mass = next((n for n in ("m", "mass") if n in own), 0)
    centre = [n if n in own else 0 for n in ("r1", "r2", "r3")]
    return {"mass": mass, "centre": centre, "about": "origin", **inertia}


def _filled(given: Any, unsaid: Mapping[str, Any], frame: str) -> Any:
    """Return the parts of a section with what they do not say; what is on the ground is on ``frame``."""
    if not isinstance(given, Mapping):
        return given
    return {
        n: _on(frame, {**unsaid, **p}) if isinstance(p, Mapping) else p for n, p in given.items()
    }


def _on(frame: str, part: Mapping[str, Any]) -> dict[str, Any]:
    named = (k for k in ("first", "second", "body", "parent") if part.get(k) == GROUND)
    return {**part, **dict.fromkeys(named, frame)}


MOST = 200
"""Numbers of an index at most."""
MOST_PARTS = 2000
"""Bodies, joints and other entries of a table at most, when it is written out."""

_INDEX = re.compile(r"\{([^{}]*)\}")
_STEP = re.compile(r"([A-Za-z]\w*)\s*(?:([+-])\s*1)?")


def written_out(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a scene without ``repeat``, every repeated key written out.

    Raises `InputError` for counts that are no numbers from 1 to `MOST`, and unknown indices.
    """
    counts = _counts(data.get("repeat", {}))
    rest = {k: v for k, v in data.items() if k != "repeat"}
    return {key: _table(value, counts, key) for key, value in rest.items()}


def _counts(given: Any) -> dict[str, int]:
    if not isinstance(given, Mapping):
        raise InputError("not a table", where="[repeat]", got=given, expected="[repeat] i = 5")
    for name, count in given.items():
        if not re.fullmatch(r"[A-Za-z]\w*", name):
            raise InputError("not a name", where="[repeat]", got=name, expected="letters")
        if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= MOST:
            raise InputError(
                "not a number of repetitions", where=f"[repeat] {name}", got=count,
                expected=f"a whole number from 1 to {MOST}",
            )  # fmt: skip
    return dict(given)


def _table(value: Any, counts: Mapping[str, int], place: str) -> Any:
    """Write out the keys of a table, and of a list the texts."""
    if isinstance(value, list):
        return [v for item in value for v in _items(item, counts, place)]
    if not isinstance(value, Mapping):
        return value
    found = {k: v for k, v in value.items() if not _INDEX.search(str(k))}
    for key, item in value.items():
        if _INDEX.search(str(key)):
            for number in _numbers(key, counts, place):
                found.setdefault(_put(key, number, place), _put(item, number, f"{place}.{key}"))
    if len(found) > MOST_PARTS:
        raise InputError(
            "too many entries", where=place, got=len(found), expected=f"at most {MOST_PARTS}"
        )
    return found


def _items(item: Any, counts: Mapping[str, int], place: str) -> list[Any]:
    if not isinstance(item, str) or not _INDEX.search(item):
        return [item]
    return [_put(item, number, place) for number in _numbers(item, counts, place)]


Number = tuple[str, int]


def _numbers(key: str, counts: Mapping[str, int], place: str) -> Iterator[Number]:
    """Yield the index of a key with each of its numbers."""
    names = {_step(text, key, place)[0] for text in _INDEX.findall(key)}
    if len(names) > 1:
        raise InputError("two indices in one name", where=place, got=key, expected="one")
    (name,) = names
    if name not in counts:
        raise unknown_name("index", name, counts or ("one in [repeat]",), f"{place}: {key}")
    return ((name, k) for k in range(1, counts[name] + 1))


def _step(text: str, whole: str, place: str) -> tuple[str, int]:
    match = _STEP.fullmatch(text.strip())
    if match is None:
        raise InputError("not an index", where=place, got=whole, expected="{i}, {i-1} or {i+1}")
    return match[1], {None: 0, "+": 1, "-": -1}[match[2]]


def _put(value: Any, number: Number, place: str) -> Any:
    """Replace an index by its number in texts, at all depths."""
    if isinstance(value, Mapping):
        return {_put(k, number, place): _put(v, number, place) for k, v in value.items()}
    if isinstance(value, list):
        return [_put(v, number, place) for v in value]
    if not isinstance(value, str):
        return value

    def numbered(match: re.Match[str]) -> str:
        name, step = _step(match[1], value, place)
        if name != number[0]:
            raise unknown_name("index", name, (number[0],), place)
        return str(number[1] + step)

    return _INDEX.sub(numbered, value)


def start_values(tree: Tree, reading: Reading) -> dict[str, float]:
    """Return the value of every state at t = 0: zero, and no turn, unless the scene says otherwise.

    Quaternions have norm 1 to rounding. Raises `InputError` for names of no state, joints without an
    attitude, and quaternions that are none.
    """
    free = [j for j in tree.ordered if j.motion is None]
    found = {q.name: 0.0 for j in free for q in (*j.coordinates, *j.speeds)}
    found |= {q.name: 0.0 for rotor in tree.rotors for q in rotor.states}
    for names in quaternions(tree):
        found[names[0]] = 1.0
    found |= dict.fromkeys(reading.scene.control.states, 0.0)
    parameters = {n: v.value for n, v in reading.scene.parameters.items()}
    units = {q.name: q.unit for q in reading.states}
    for name, given in reading.scene.initial.items():
        if name not in found:
            raise unknown_name("state", name, found, "[initial]")
        place = f"[initial] {name}"
        formula = sp.sympify(
            reading.constants.value(given, place, units.get(name, "")), strict=True
        )
        found[name] = number(formula, parameters, place)
    for name, value in _attitudes(reading, free):
        if name in reading.scene.initial:
            where = "[initial] and [initial_attitude]"
            raise InputError(f"{name} is given twice", where=where, got=name)
        found[name] = value
    for names in quaternions(tree):
        found |= _normalised({n: found[n] for n in names})
    return _assembled(tree, reading, found, parameters) if tree.constraints else found


def _assembled(
    tree: Tree, reading: Reading, found: dict[str, float], parameters: dict[str, float]
) -> dict[str, float]:
    """Return the nearest values that meet the constraints; rotors and control are as they are."""
    rotors = (q.name for rotor in tree.rotors for q in rotor.states)
    free = {name: found[name] for name in (*rotors, *reading.scene.control.states)}
    bound = {name: x for name, x in found.items() if name not in free}
    inputs = {q.name: reading.scene.inputs[q.name].value for q in reading.inputs}
    given = {**parameters, **inputs, **bound}
    values = assemble(tree, given, keep=reading.scene.keep).values
    return {name: values[name] for name in bound} | free


def quaternions(tree: Tree) -> list[tuple[str, ...]]:
    """Return the names of the parts of each quaternion among the states."""
    turning = (j for j in tree.ordered if j.row.attitude and j.attitude == QUATERNION)
    return [tuple(c.name for c in j.coordinates[-4:]) for j in turning if j.motion is None]


def _attitudes(reading: Reading, free: list[Joint]) -> Iterator[tuple[str, float]]:
    """Yield the attitude coordinates of joints that are given by angles or a quaternion."""
    joints = {j.name: j for j in free if j.row.attitude}
    for name, given in reading.scene.initial_attitude.items():
        where = f"[initial_attitude.{name}]"
        if name not in joints:
            raise unknown_name("joint with an attitude", name, joints, where)
        check_initial_attitude(given, where)
        joint = joints[name]
        values = in_coordinates(given, joint.attitude, where)
        names = [c.name for c in joint.coordinates[-len(values) :]]
        yield from zip(names, values, strict=True)


def _normalised(parts: dict[str, float]) -> dict[str, float]:
    unit = of_norm_one([*parts.values()], f"[initial] {', '.join(parts)}")
    return dict(zip(parts, unit, strict=True))


GROUPS: dict[str, tuple[str, ...]] = {
    "energies": ("kinetic_energy", "potential_energy"),
    "momentum": tuple(f"{letter}_{k}" for letter in "pL" for k in (1, 2, 3)),
    "centre_of_mass": tuple(f"centre_{k}" for k in (1, 2, 3)),
}
"""Names of the outputs that a row of `eom.multibody.system.derive.OUTPUTS` gives."""


FORCES, LAMBDA = "constraint_forces", "lambda_"
"""The row whose outputs depend on the constraints, and how their names begin."""
REACTIONS, DRIVES, POINTS = "reactions", "drives", "points"
"""Words for outputs whose names depend on the tree: of joints, of prescribed motions, of points."""
Source = str | Reaction | Point | Drawn


@dataclass(frozen=True)
class Choice:
    """What can be asked of a tree and of points of its bodies, by name."""

    tree: Tree
    points: tuple[Point, ...] = ()

    @cached_property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """The names that each word stands for; those of `FORCES` are the derived system's."""
        return {
            **GROUPS,
            FORCES: (),
            REACTIONS: tuple(n for r in of_all(self.tree) for n in r.names),
            DRIVES: tuple(d.name for j in self.tree.ordered for d in drives_of(j)),
            POINTS: tuple(n for p in self.points for n in p.names),
        }

    @cached_property
    def sources(self) -> dict[str, Source]:
        """What gives each output: a row of `OUTPUTS`, a reaction, a point."""
        found: dict[str, Source] = {}
        for row in OUTPUTS:
            found |= dict.fromkeys(self.groups[row], row)
        for reaction in of_all(self.tree):
            found |= dict.fromkeys(reaction.names, reaction)
        for point in self.points:
            found |= dict.fromkeys(point.names, point)
        return found

    @property
    def everything(self) -> tuple[Source, ...]:
        """All that can be asked for."""
        return (*OUTPUTS, *self.points)

    def needed(self, wanted: Sequence[str]) -> tuple[Source, ...]:
        """Return what gives the names and words that are asked for."""
        names = [n for w in wanted for n in self.groups.get(w, (w,))]
        forces = (FORCES,) if any(map(self._of_forces, wanted)) else ()
        given = (self.sources[n] for n in names if n in self.sources)
        return tuple(dict.fromkeys((*forces, *given)))

    def names(self, wanted: Sequence[str], system: System) -> tuple[str, ...]:
        """Return what is asked for with words written out."""
        forces = tuple(n for n in system.output_names if n.startswith(LAMBDA))
        known = {**self.groups, FORCES: forces}
        return tuple(dict.fromkeys(n for w in wanted for n in known.get(w, (w,))))

    def is_known(self, name: str) -> bool:
        """Return whether a name beside those of states can be asked for."""
        return name in self.groups or name in self.sources or self._of_forces(name)

    def known(self) -> tuple[str, ...]:
        """Return all names beside those of states."""
        return (*self.groups, *self.sources)

    def _of_forces(self, name: str) -> bool:
        """Return whether a name begins as the multipliers of a constraint do; or all are meant."""
        begins = tuple(f"{LAMBDA}{c.name}" for c in self.tree.constraints)
        return name == FORCES or name.startswith(begins)
