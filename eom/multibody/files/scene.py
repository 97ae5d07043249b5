"""A scene with many bodies: in Python or as a TOML file, with its systems and numbers.

It answers what `eom.scenes.scene.Scene` answers, so that commands need not know which of the two they have.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property, reduce
from pathlib import Path
from typing import Any, Self

import pydantic

from eom.errors import InputError, unknown_name
from eom.multibody.files.description import TreeDescription
from eom.multibody.files.joint_angles import JointAngles, angles_of
from eom.multibody.files.outputs import POINTS, Choice, Saved, smallest
from eom.multibody.files.repeats import written_out
from eom.multibody.files.sections import Reading, check_used, points_of, tree_of
from eom.multibody.files.starting import quaternions, start_values
from eom.multibody.model.model import Tree
from eom.multibody.recursion.tally import savings
from eom.multibody.system.derive import derive
from eom.scenes import catalogue
from eom.scenes.description import check_end
from eom.scenes.scene_files import data_of, in_file, limited, readable
from eom.scenes.start import pick
from eom.system import System


class TreeScene(TreeDescription):
    """A checked description, with the tree, systems and numbers that follow from it.

    Fields: see `eom.multibody.files.description.TreeDescription`; ``repeat`` writes out repeated parts
    first (`eom.multibody.files.repeats`). ``notes``: what a file said that is not used, for `explain`. SI
    units, angles in radians; frames are those of the ground, the bodies and the joints (`Joint`). Raises
    `InputError` for anything that is misspelt, missing or impossible.

    >>> rod = {"mass": "m", "centre": (0, 0, "-l/2"), "moments": ("m*l**2/12", "m*l**2/12", 0)}
    >>> hinge = {"kind": "revolute", "parent": "ground", "child": "rod", "axis": "x"}
    >>> TreeScene(bodies={"rod": rod}, joints={"hinge": hinge}, gravity=(0, 0, "-g"),
    ...     parameters={"m": 1, "l": 2, "g": 9.81}).derive()
    System('scene': states q_hinge, u_hinge; parameters g, l, m; invariants energy)
    """

    notes: tuple[str, ...] = ()

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**written_out(limited(data)))
        except pydantic.ValidationError as error:
            raise readable(error, TreeDescription) from None

    def __hash__(self) -> int:
        """Scenes are values; hash by content that matters for lookup only."""
        return hash((self.title, self.model, tuple(self.bodies), self.outputs))

    @pydantic.model_validator(mode="after")
    def _check(self) -> Self:
        """Check everything that one field alone cannot tell."""
        check_end(self)
        states, choice, angles = self._start, self._choice, self._angles
        check_used(self._reading)
        if self.keep and not self.tree.constraints:
            raise InputError("keep belongs to constraints", where="keep", got=", ".join(self.keep))
        for name in self.outputs:
            if not (name in states or name in angles or choice.is_known(name)):
                known = [*states, *angles, *choice.known()]
                raise unknown_name("output", name, known, "outputs")
        return self

    @classmethod
    def from_toml(cls, path: str | Path) -> TreeScene:
        """Return the scene of a TOML file at ``path``.

        Raises `InputError` with the file's name for whatever is wrong in it.
        """
        file = Path(path)
        data = data_of(file)
        with in_file(file):
            if data.get("model") != catalogue.TREE:
                raise InputError(
                    "this scene is one body, not a tree",
                    where="model",
                    hint="eom.load_scene opens scenes of every model",
                )
            return cls(**data)

    @classmethod
    def ready(cls, name: str) -> TreeScene:
        """Return one of the scenes that ship with the package; ``eom list`` names them.

        Raises `InputError` for other names.

        >>> TreeScene.ready("double-pendulum").derive().state_names
        ('q_shoulder', 'q_elbow', 'u_shoulder', 'u_elbow')
        """
        return cls.from_toml(catalogue.path_of(name))

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

    @property
    def _near(self) -> dict[str, float]:
        """Where constraints are tested for dependence: parameters and coordinates at the start."""
        return {**self.numbers, **self._start} if self.tree.constraints else {}

    @cached_property
    def _whole(self) -> System:
        """The system with the outputs asked for, and all states."""
        wanted = self._choice.needed(self._asked)
        return self._named(derive(self.tree, wanted, start=self._near))

    @cached_property
    def _derived(self) -> System:
        return smallest(self._whole, self.requested) if self.outputs else self._whole

    def _named(self, system: System) -> System:
        named = replace(system, name=self.name, title=self.title)
        return reduce(lambda whole, angles: angles.of(whole), self._joint_angles, named)

    @property
    def requested(self) -> tuple[str, ...]:
        """What is asked for: the outputs, or all states and points where none are named."""
        return self._choice.names(self._asked, self._whole)

    def requested_names(self) -> tuple[str, ...]:
        """Return what is asked for, groups of outputs by their names."""
        return self.requested

    def derive(self) -> System:
        """Return the smallest system that the requested outputs need."""
        return self._derived

    def explain(self) -> Saved:
        """Return what was skipped, why, and the operations saved; print it to read it."""
        kept = self.derive().state_names
        lost = tuple(n for n in self._whole.state_names if n not in kept)
        return Saved(savings(self.tree), lost, self.notes)

    def initial_values(self) -> dict[str, float]:
        """Return the value of each state of `derive` at t = 0, by name, in SI units."""
        return {n: self._start[n] for n in self.derive().state_names}

    @property
    def numbers(self) -> dict[str, float]:
        """The value of each parameter of the scene."""
        return {n: v.value for n, v in self.parameters.items()}

    def parameter_values(self) -> dict[str, float]:
        """Return the value of each parameter of `derive`, by name. Raises `InputError` for missing ones."""
        return pick(self.numbers, self.derive().parameter_names, "parameter", "[parameters]")

    def input_values(self) -> dict[str, float]:
        """Return the value at which each input of `derive` is held; of a motor 0 if none is given."""
        given = {n: v.value for n, v in self.inputs.items()}
        return {n: given.get(n, 0.0) for n in self.derive().input_names}

    @property
    def attitudes(self) -> tuple[tuple[str, ...], ...]:
        """Names of the states that are one attitude together, and cannot vary alone."""
        return tuple(quaternions(self.tree))
