"""A scene: body, attitude, torque, numbers and what is asked for, in Python or as a TOML file.

`Scene.derive` returns the smallest system that the requested outputs need; `Scene.explain` says
what was skipped and why. Every formula in a scene is read by the restricted parser of `eom.scenes.parse`.
"""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any, Self

import pydantic

from eom.errors import InputError, unknown_name
from eom.kinematics.coordinates import attitude
from eom.scenes import assembly, catalogue, start
from eom.scenes.description import Description, check
from eom.scenes.reduce import Explanation
from eom.scenes.scene_files import data_of, in_file, limited, readable
from eom.system import System


class Scene(Description):
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
        try:
            super().__init__(**limited(data))
        except pydantic.ValidationError as error:
            raise readable(error, Description) from None

    def __hash__(self) -> int:
        """Scenes are values; hash by content that matters for lookup only."""
        return hash((self.title, self.model, self.attitude, self.outputs))

    @pydantic.model_validator(mode="after")
    def _check(self) -> Self:
        """Check everything that one field alone cannot tell."""
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

    @classmethod
    def from_toml(cls, path: str | Path) -> Scene:
        """Return the scene of a TOML file at ``path``.

        Raises `InputError` with the file's name for whatever is wrong in it.
        """
        file = Path(path)
        data = data_of(file)
        with in_file(file):
            if data.get("model") == catalogue.TREE:
                raise _is_a_tree()
            return cls(**data)

    @classmethod
    def ready(cls, name: str) -> Scene:
        """Return one of the scenes that ship with the package; ``eom list`` names them.

        Raises `InputError` for other names.

        >>> Scene.ready("bicycle-wheel").derive().state_names
        ('theta', 'psi', 'theta_dot', 'psi_dot')
        """
        return cls.from_toml(catalogue.path_of(name))

    @cached_property
    def full_system(self) -> System:
        """The general system of this scene: every state and output that can be asked for."""
        return assembly.full_system(self)

    @cached_property
    def _derived(self) -> tuple[System, Explanation]:
        return assembly.derive(self, self.full_system, self.requested)

    @property
    def requested(self) -> tuple[str, ...]:
        """What is asked for: the outputs, or all states where none are named, and angles over them.

        Where angles are integrated in a quaternion they stand in its place.
        """
        full = self.full_system
        turned = {n for a in full.angles for n in a.quaternion if self.integrate}
        states = (n for n in full.state_names if n not in turned)
        return self.outputs or (*states, *(n for a in full.angles for n in a.names))

    def requested_names(self) -> tuple[str, ...]:
        """Return what is asked for that varies: frozen states are constants of the motion."""
        system = self.derive()
        return tuple(n for n in self.requested if n in (*system.state_names, *system.output_names))

    def derive(self) -> System:
        """Return the smallest system that the requested outputs need."""
        return self._derived[0]

    def explain(self) -> Explanation:
        """Return what was skipped, why, and the operations saved; print it to read it."""
        return self._derived[1]

    def initial_values(self) -> dict[str, float]:
        """Return the value at t = 0 of each state of `derive`, by name, in SI units.

        Raises `InputError` for missing ones, and for an attitude that is no rotation.
        """
        values, names = start.states(self, self.full_system), self.derive().state_names
        for angles in self.full_system.angles if self.integrate else ():
            if set(angles.quaternion) & {*names} - {*values}:
                names = angles.names  # what the scene would give
        return start.pick(values, names, "initial value", "[initial]")

    def parameter_values(self) -> dict[str, float]:
        """Return the value of each parameter of `derive`, by name, constants of the motion included.

        SI units. Raises `InputError` for missing ones.
        """
        values = start.states(self, self.full_system) | start.constants(self)
        return start.pick(
            values, self.derive().parameter_names, "parameter", "[parameters] or [initial]"
        )

    def input_values(self) -> dict[str, float]:
        """Return the value at which each input of `derive` is held, by name."""
        return {n: v.value for n, v in self.inputs.items() if n in self.derive().input_names}

    @property
    def attitudes(self) -> tuple[tuple[str, ...], ...]:
        """Names of the states that are one attitude together, and cannot vary alone."""
        if self.model == "spinner" or self.attitude == "none":
            return ()
        chosen = attitude(self.coordinates)
        return (tuple(q.name for q in chosen.coordinates),) if chosen.constraints else ()


def _is_a_tree() -> InputError:
    return InputError(
        "this scene is a tree of bodies, not one body",
        where="model",
        hint="eom.load_scene opens scenes of every model",
    )
