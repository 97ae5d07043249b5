"""Free-body sketch of one body: its centre of mass, its frames, and the forces and torques of its scene.

Forces and torques as arrows, with the numbers and formulas that they come from.

A torque's arrow is along the torque, by the right-hand rule; a ring round it turns the way that the torque
turns. Lengths of arrows say nothing of sizes: a sketch shows what acts, where, and which way.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from eom.errors import InputError
from eom.mechanics.torques import Torque
from eom.multibody.algebra.values import is_number
from eom.scenes import start
from eom.scenes.assembly import torques_of
from eom.scenes.description import inertia_values, principal_values
from eom.scenes.scene import Scene
from eom.views.animation.equivalents import central, equivalent
from eom.views.animation.tracks import matrices
from eom.views.body.frame_sketches import SPACE
from eom.views.body.turns import Frame, after_turns, arc_points, triads
from eom.views.draw.lettering import formula, plain
from eom.views.draw.picture import Arrow, Curve, Floats, Item, Marks, Panel, Picture, Words, check
from eom.views.draw.printed import solid
from eom.views.draw.solid_meshes import Mesh
from eom.views.draw.viewpoint import CROWDED, best_view

REACH = 1.0
"""Where the body ends in the sketch; other lengths are in proportion."""
SPIN = "3-1-2"
GRADIENT = "gravity_gradient"


@dataclass(frozen=True)
class _Sketch:
    """A scene of one body in numbers, at its start."""

    scene: Scene

    @cached_property
    def known(self) -> Mapping[str, float]:
        """The values of parameters, inputs and states by name."""
        inputs = {n: v.value for n, v in self.scene.inputs.items()}
        states = start.states(self.scene, self.scene.full_system)
        return {**start.constants(self.scene), **inputs, **states, "t": 0.0}

    @cached_property
    def C(self) -> Floats:
        """From the reference frame to the one that torque has its components in."""
        known, attitude = self.known, self.scene.coordinates
        if self.scene.model == "spinner":
            return after_turns(SPIN, (known.get("psi", 0.0), known.get("theta", 0.0), 0.0))[-1]
        if attitude == "none":
            return np.eye(3)
        if attitude == "quaternion":
            return matrices([known.get(f"q{k}", float(k == 0)) for k in range(4)])
        if attitude == "dcm":
            entries = [known.get(f"C{i}{j}", float(i == j)) for i in (1, 2, 3) for j in (1, 2, 3)]
            return np.reshape(entries, (3, 3))
        return after_turns(attitude, [known.get(n, 0.0) for n in ("psi", "theta", "phi")])[-1]

    @property
    def weight(self) -> Any:
        return self.scene.torque.weight

    @cached_property
    def centre(self) -> Floats:
        """The centre of mass in the sketch, from the fixed point, in the body's axes."""
        if self.weight is None:
            return np.zeros(3)
        r = np.array(self.weight.centre_of_mass)
        return REACH * r / (float(np.linalg.norm(r)) or 1.0)

    @cached_property
    def mesh(self) -> Mesh:
        """The body about its centre of mass, its surface through the fixed point if there is one."""
        matrix = inertia_values(self.scene)
        J = np.diag(principal_values(self.scene)) if matrix is None else np.array(matrix)
        mass = self.scene.body.mass
        if self.weight is not None:
            mass = self.weight.mass
            about = central(J, mass, self.weight.centre_of_mass)
            J = J if about is None else about
        mesh = equivalent(J, mass).mesh
        way = -self.centre
        reach = float(np.max(mesh.vertices @ way)) / REACH if np.any(way) else mesh.extent
        return Mesh(REACH * mesh.vertices / reach, mesh.faces)

    @property
    def axles(self) -> list[Floats]:
        """The axis that the body is best not seen from the side of: a spinner's, or a top's."""
        if self.scene.model == "spinner":
            return [self.C[1]]
        return [self.centre @ self.C] if self.weight is not None else []

    @cached_property
    def torques(self) -> dict[str, tuple[Any, ...]]:
        """The components of each torque in the body's axes, by the field that states it."""
        return {name: _expanded(torque) for name, torque in torques_of(self.scene).items()}

    @property
    def applied(self) -> list[tuple[int, Any]]:
        """The components that are stated and not zero, with the numbers of their axes."""
        return [(k, c) for k, c in enumerate(self.torques["components"]) if c != 0]


def body_sketch(scene: Scene) -> Picture:
    """Return the sketch of a scene's body at its start, with the forces and torques that the scene states.

    The reference frame has the axes a, the body (a spinner's frame that does not spin) the axes b. The
    body is drawn as a uniform solid of the same inertia, and nothing is to scale. Weight acts at the
    centre of mass G along -a3, with the reaction of the fixed point O; torque by components has an arrow
    along each of them, its sense that at the start; a gravity gradient one along its torque at the start.
    What acts together is drawn together.
    Raises `InputError` as the scene does whose numbers make no body.

    >>> import eom
    >>> body_sketch(eom.load_scene("heavy-top")).caption.split(". ")[1]
    'Its weight acts at the centre of mass G, a reaction at the fixed point O.'
    """
    s = _Sketch(scene)
    C = s.C
    frames = [Frame("b", C, "blue", 1.4)]
    if scene.attitude != "none" or scene.model == "spinner":
        frames.insert(0, Frame("a", np.eye(3), "black", 1.9))
    items = [
        *solid(s.mesh.moved(s.centre), C, np.zeros(3)),
        *triads(frames),
        *_points(s),
        *_loads(s),
    ]
    view = best_view(s.axles, items, CROWDED)
    panel = Panel(tuple(items), SPACE, equal=True, bare=True, height=1.3, view=view)
    return check(Picture(((panel,),), plain(scene.title or scene.name), _told(s)))


def _expanded(torque: Torque) -> tuple[Any, ...]:
    directions = {d.symbol: d.expression for d in torque.directions}
    return tuple(
        sp.sympify(c, strict=True).xreplace(directions) for c in torque.components.components
    )


def _told(s: _Sketch) -> str:
    acts = []
    if s.weight is not None:
        acts.append("Its weight acts at the centre of mass G, a reaction at the fixed point O.")
    if GRADIENT in s.torques:
        acts.append("The torque of the gravity gradient acts on it, at the start along the arrow.")
    if s.applied or not acts:
        acts.append(f"{len(s.applied) or 'No'} components of torque act on it.")
    return f"Free-body sketch at the start, not to scale. {' '.join(acts)}"


def _points(s: _Sketch) -> Iterator[Item]:
    away = np.array([0.0, 0.0, -0.14])
    yield from marked(s.centre @ s.C, "$G$", away)
    if s.weight is not None:
        yield from marked(np.zeros(3), "$O$", np.array([0.1, -0.1, 0.05]))


def _loads(s: _Sketch) -> Iterator[Item]:
    if s.weight is not None:
        down = np.array([0.0, 0.0, -1.0])
        yield from force(s.centre @ s.C, down, 0.8, "$m g$")
        yield from push(np.zeros(3), -down, 0.8, "$R$")
    if GRADIENT in s.torques:
        way = numbers(s.torques[GRADIENT], s.known)
        yield from torque(np.zeros(3), way @ s.C, 1.25, r"$\mathbf{M}$")
        yield Arrow(
            np.zeros(3), np.array([-1.75, 0.0, 0.0]), "grey", 1.6, "to the attracting centre"
        )
    for k, component in s.applied:
        yield from _component(s, k, component)


def _component(s: _Sketch, k: int, component: Any) -> Iterator[Item]:
    """Yield one component of the torque along its axis; its sense is that at the start."""
    sense = -1.0 if number(component, s.known) < 0 else 1.0
    shown = formula(component, f"$M_{k + 1}$").strip("$")
    bracketed = f"({shown})" if component.is_Add else shown
    yield from torque(np.zeros(3), sense * s.C[k], 1.2, rf"${bracketed}\,\mathbf{{b}}_{k + 1}$")


FORCE, TORQUE, REACTION = "red", "purple", "green"
LEGEND = {FORCE: "force", TORQUE: "torque", REACTION: "reaction"}
RING = 1.6 * math.pi
"""Angle of the ring round a torque."""


def number(value: Any, known: Mapping[str, float]) -> float:
    """Return the number that a value of a description has; symbols without one count as zero.

    Raises `InputError` where it is none.
    """
    if is_number(value):
        return float(value)
    at = {s: sp.Float(known.get(s.name, 0.0)) for s in value.free_symbols}
    found = sp.sympify(value, strict=True).xreplace(at).evalf()
    if not found.is_real or not math.isfinite(found):
        raise InputError("not a number at the start", where="sketch", got=f"{value} = {found}")
    return float(found)


def numbers(values: Any, known: Mapping[str, float]) -> Floats:
    """Return numbers of a vector or a matrix."""
    if isinstance(values, list | tuple):
        return np.array([numbers(v, known) for v in values])
    return np.asarray(number(values, known))


def unit(way: Floats) -> Floats | None:
    """Return the unit vector along a vector, None if it is zero."""
    size = float(np.linalg.norm(way))
    return way / size if size > 0 else None


def force(
    point: Floats, way: Floats, length: float, words: str, colour: str = FORCE
) -> Iterator[Item]:
    """Yield the arrow of a force that acts at a point, along a vector of any length."""
    along = unit(way)
    if along is not None:
        yield Arrow(point, point + length * along, colour, 2.4, words, LEGEND[colour])


def push(point: Floats, way: Floats, length: float, words: str) -> Iterator[Item]:
    """Yield the arrow of a reaction whose tip is at the point that it acts on."""
    along = unit(way)
    if along is not None:
        yield Arrow(point - length * along, point, REACTION, 2.4, label=LEGEND[REACTION])
        yield Words(point - 1.12 * length * along, words, REACTION)


def hang(point: Floats, way: Floats, length: float, words: str) -> Iterator[Item]:
    """Yield the arrow of a reaction that starts at the point that it acts on."""
    yield from force(point, way, length, words, REACTION)


def torque(point: Floats, way: Floats, length: float, words: str) -> Iterator[Item]:
    """Yield the arrow of a torque along a vector of any length, and its ring."""
    along = unit(way)
    if along is None:
        return
    yield Arrow(point, point + length * along, TORQUE, 2.4, words, LEGEND[TORQUE])
    across = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    radius = 0.16 * length / float(np.linalg.norm(across))
    ring = point + 0.6 * length * along + arc_points(along, radius * across, RING)
    yield Curve(ring, TORQUE, 1.8)
    yield Arrow(ring[-5], ring[-1], TORQUE, 1.8)


def marked(point: Floats, words: str, away: Floats, colour: str = "black") -> Iterator[Item]:
    """Yield a dot and its name, which stands ``away`` from it."""
    yield Marks(point[None], colour, 6.0)
    yield Words(point + away, words, colour)
