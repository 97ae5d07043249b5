"""A scene: body, attitude, torque, numbers and what is asked for, in Python or as a TOML file.

`Scene.derive` returns the smallest system that the requested outputs need; `Scene.explain` says
what was skipped and why. Every formula in a scene is read by the restricted parser of `eom.scenes.parse`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cached_property
from typing import Any, Self

import pydantic
import sympy as sp

from eom.errors import unknown_name
from eom.kinematics.coordinates import attitude
from eom.mechanics.torques import Torque
from eom.scenes import assembly, start
from eom.scenes.description import Body, Description, check
from eom.scenes.given import Place
from eom.scenes.reduce import Pass
from eom.scenes.scene_files import BaseScene
from eom.system import System


class Scene(BaseScene, Description):
    """A checked description, with the systems and numbers that follow from it.

    Fields: see `eom.scenes.description.Description` and `eom.scenes.description.Request`. SI units, angles
    in radians; frames: A reference, B body, with C_BA from components in A to those in B. Raises
    `InputError` for anything that is misspelt, missing or impossible.

    >>> top = Scene(body={"moments": (1, 1, 2)}, torque={"components": (0, 0, "M")},
    ...     parameters={"M": 0.1}, outputs=("omega_3",), initial={"omega_3": 5})
    >>> top.derive()
    System('scene': states omega_3; parameters I3, M)
    """

    def __init__(self, /, **data: Any) -> None:
        super().__init__(**data)

    @pydantic.model_validator(mode="after")
    def _check(self) -> Self:
        """Check everything that one field alone cannot show."""
        check(self)
        known = [*self.full_system.state_names, *self.full_system.output_names]
        for kind, names, where in (
            ("output", self.outputs, "outputs"),
            ("state", tuple(self.initial), "[initial]"),
        ):
            for name in names:
                if name not in known:
                    raise unknown_name(kind, name, known, where)
        return self

    def as_stated(self) -> Self:
        """Return the scene over its own coordinates, whatever it is integrated in."""
        return self.changed(integrate=None) if self.integrate else self

    def in_attitude(self, attitude: str) -> Self:
        """Return the scene in other coordinates of attitude, all of which are asked for.

        Parameters
        ----------
        attitude : str
            ``quaternion``, ``dcm`` or one of the 12 sequences.

        Returns
        -------
        the same class
            With the rates at the start; what was said of the attitude at the start is left out.

        Raises
        ------
        InputError
            As its class raises it, for other names.
        """
        if attitude == self.attitude:
            return self
        left_out = {"outputs", "initial_attitude", "attitude", "angles", "integrate"}
        data = {k: v for k, v in self.model_dump(exclude_unset=True).items() if k not in left_out}
        rates = {k: v for k, v in data.get("initial", {}).items() if k.startswith("omega_")}
        return type(self)(**{**data, "initial": rates, "attitude": attitude})

    @property
    def bodies(self) -> dict[str, Body]:
        """What is said of its body, by name."""
        return {"body": self.body}

    @property
    def loads(self) -> dict[str, Torque]:
        """The torques that act, by their keys."""
        return assembly.torques_of(self)

    @cached_property
    def full_system(self) -> System:
        """The general system of this scene: every state and output that can be asked for."""
        return self._closed(assembly.full_system(self))

    def _general(self) -> System:
        return self._closed(assembly.full_system(self, general_torque=True))

    def _closed(self, system: System) -> System:
        """Return the system of the body under the scene's control."""
        named = (*system.states, *system.parameters, *system.inputs)
        symbols = {q.name: q.symbol for q in named}
        outputs = (*system.output_names, *self.parameters, *self.inputs)
        others = {n: sp.Symbol(n, real=True) for n in outputs}
        names = {**others, **start.sizes(self), **symbols, "t": system.time}
        return self._closed_loop(system, names)

    def _passes(self) -> Mapping[str, Pass]:
        return assembly.passes(self, self.full_system, self.requested)

    @property
    def requested(self) -> tuple[str, ...]:
        """What is asked for: the outputs, or all states where none are named, and angles over them.

        Where angles are integrated in a quaternion they stand in its place.
        """
        full = self.full_system
        turned = {n for a in full.angles for n in a.quaternion if self.integrate}
        states = (n for n in full.state_names if n not in turned)
        return self.outputs or (*states, *(n for a in full.angles for n in a.names))

    @property
    def numbers(self) -> dict[str, float]:
        """The value of each parameter of the scene and of its body, by name, in SI units."""
        return start.constants(self)

    @property
    def start(self) -> dict[str, float]:
        """The value at t = 0 of each state that the scene determines, by name, in SI units.

        Raises `InputError` for an attitude that is no rotation.
        """
        return start.states(self, self.full_system)

    def initial_values(self) -> dict[str, float]:
        """Return the value at t = 0 of each state of `derive`, by name, in SI units.

        Raises `InputError` for missing ones, and for an attitude that is no rotation.
        """
        with self._told():
            values, names = self.start, self.derive().state_names
            for angles in self.full_system.angles if self.integrate else ():
                if set(angles.quaternion) & {*names} - {*values}:
                    names = angles.names  # what the scene would give
            return start.pick(
                values, names, "initial value", "[initial]", start.attitude_names(self)
            )

    def _places(self) -> Mapping[str, Place]:
        return start.places(self)

    def _starting(self) -> Collection[str]:
        full = self.full_system
        return (*full.state_names, *full.output_names, *self.control.stepped)

    def _started(self, data: dict[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
        groups = start.attitude_groups(self)
        chosen: tuple[str, ...] = next((g for g in groups if {*g} & {*values}), ())
        initial = dict(data.get("initial", {}))
        if chosen:
            stated = start.attitude_at_start(self, chosen)
            initial = {n: v for n, v in initial.items() if not any(n in g for g in groups)}
            initial |= stated
            data = {k: v for k, v in data.items() if k != "initial_attitude"}
        return {**data, "initial": {**initial, **values}}

    @property
    def attitudes(self) -> tuple[tuple[str, ...], ...]:
        """Names of the states that are one attitude together, and cannot vary alone."""
        if self.model == "spinner" or self.attitude == "none":
            return ()
        chosen = attitude(self.coordinates)
        return (tuple(q.name for q in chosen.coordinates),) if chosen.constraints else ()
