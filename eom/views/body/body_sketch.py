"""Free-body sketch of one body: its centre of mass, its frames, and the forces and torques of its scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from eom.scenes import start
from eom.scenes.description import inertia_values, principal_values
from eom.scenes.scene import Scene
from eom.system import Definition
from eom.views.animation.equivalents import central, equivalent
from eom.views.animation.tracks import matrices
from eom.views.body.frame_sketches import SPACE
from eom.views.body.load_arrows import force, marked, number, push, torque
from eom.views.body.turns import Frame, after_turns, triads
from eom.views.draw.lettering import formula, plain
from eom.views.draw.outlines import solid
from eom.views.draw.picture import Arrow, Floats, Item, Panel, Picture, check
from eom.views.draw.solid_meshes import Mesh
from eom.views.draw.viewpoint import CROWDED, best_view

REACH = 1.0
"""Where the body ends in the sketch; other lengths are in proportion."""
SPIN = "3-1-2"


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

    @property
    def torques(self) -> list[Definition]:
        """The components of the torque in the body's axes, those that are not zero."""
        outputs = {d.name: d for d in self.scene.full_system.outputs}
        return [d for k in (1, 2, 3) if (d := outputs[f"torque_{k}"]).expression != 0]

    def value(self, torque: Definition) -> float:
        """Return a component of the torque at the start."""
        return number(self.scene.full_system.expand(torque.expression), self.known)


def body_sketch(scene: Scene) -> Picture:
    """Return the sketch of a scene's body at its start, with the forces and torques that the scene states.

    The reference frame has the axes a, the body (a spinner's frame that does not spin) the axes b. The
    body is drawn as a uniform solid of the same inertia, and nothing is to scale. Weight acts at the
    centre of mass G along -a3, with the reaction of the fixed point O; torque by components has an arrow
    along each of them, its sense that at the start; a gravity gradient one along the torque at the start.
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


def _told(s: _Sketch) -> str:
    if s.weight is not None:
        acts = "Its weight acts at the centre of mass G, a reaction at the fixed point O."
    elif s.scene.torque.gravity_gradient is not None:
        acts = "The torque of the gravity gradient acts on it, at the start along the arrow."
    else:
        acts = f"{len(s.torques) or 'No'} components of torque act on it."
    return f"Free-body sketch at the start, not to scale. {acts}"


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
    elif s.scene.torque.gravity_gradient is not None:
        way = np.zeros(3)
        for d in s.torques:
            way[int(d.name[-1]) - 1] = s.value(d)
        yield from torque(np.zeros(3), way @ s.C, 1.25, r"$\mathbf{M}$")
        yield Arrow(
            np.zeros(3), np.array([-1.75, 0.0, 0.0]), "grey", 1.6, "to the attracting centre"
        )
    else:
        for d in s.torques:
            yield from _component(s, d)


def _component(s: _Sketch, torque_k: Definition) -> Iterator[Item]:
    """Yield one component of the torque along its axis; its sense is that at the start."""
    k = int(torque_k.name[-1])
    sense = -1.0 if s.value(torque_k) < 0 else 1.0
    expression = s.scene.full_system.expand(torque_k.expression)
    shown = formula(expression, f"$M_{k}$").strip("$")
    bracketed = f"({shown})" if expression.is_Add else shown
    yield from torque(np.zeros(3), sense * s.C[k - 1], 1.2, rf"${bracketed}\,\mathbf{{b}}_{k}$")
