"""A scene: body, attitude, torque, numbers and what is asked for, in Python or as a TOML file.

`Scene.derive` returns the smallest system that the requested outputs need; `Scene.explain` says
what was skipped and why. Every formula in a scene is read by the restricted parser of `eom.parse`.
"""

from __future__ import annotations

import re
import tomllib
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import pydantic

from eom import assembly, catalogue, start
from eom.description import Description, Value, check
from eom.errors import InputError, near_matches, unknown_name
from eom.reduce import Explanation
from eom.system import System

MAX_FILE_BYTES = 1_000_000


class Scene(Description):
    """A checked description, with the systems and numbers that follow from it.

    Fields: see `eom.description.Description`. Raises `InputError` for anything that is misspelt,
    missing or impossible.
    """

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except pydantic.ValidationError as error:
            raise _readable(error) from None

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
        """Read a scene file. Raises `InputError` with the file's name for whatever is wrong in it."""
        file = Path(path)
        text = _read(file)
        try:
            data = tomllib.loads(text)
        except (ValueError, RecursionError) as error:  # a huge integer, deep nesting
            raise InputError("not a valid TOML file", where=str(file), got=str(error)) from None
        data.setdefault("name", file.stem)
        try:
            return cls(**data)
        except InputError as error:
            where = f"{file}: {error.where}" if error.where else str(file)
            raise type(error)(
                error.what, where=where, got=error.got, expected=error.expected, hint=error.hint
            ) from None

    @classmethod
    def ready(cls, name: str) -> Scene:
        """Return one of the scenes that ship with the package. Raises `InputError` for other names.

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
        """What is asked for: the outputs, or all states where none are named."""
        return self.outputs or self.full_system.state_names

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
        """Return the initial value of each state of `derive`. Raises `InputError` for missing ones."""
        values = start.states(self, self.full_system)
        return start.pick(values, self.derive().state_names, "initial value", "[initial]")

    def parameter_values(self) -> dict[str, float]:
        """Return the value of each parameter of `derive`, constants of the motion included."""
        values = start.states(self, self.full_system) | start.constants(self)
        return start.pick(
            values, self.derive().parameter_names, "parameter", "[parameters] or [initial]"
        )

    def input_values(self) -> dict[str, float]:
        """Return the value at which each input of `derive` is held."""
        return {n: v.value for n, v in self.inputs.items() if n in self.derive().input_names}


def _read(file: Path) -> str:
    if not file.is_file():
        known = [p.name for p in file.parent.glob("*.toml")] if file.parent.is_dir() else []
        raise InputError("no such scene file", where=str(file), hint=near_matches(file.name, known))
    if file.stat().st_size > MAX_FILE_BYTES:
        raise InputError(
            "scene file is too large", where=str(file), expected=f"at most {MAX_FILE_BYTES} bytes"
        )
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("scene file cannot be read", where=str(file), got=str(error)) from None


def _readable(error: pydantic.ValidationError) -> InputError:
    """Turn the first finding into one error; count the others."""
    findings = error.errors(include_url=False)
    ours = [f["ctx"]["error"] for f in findings if "error" in f.get("ctx", {})]
    if ours and isinstance(ours[0], InputError):
        return ours[0]
    first, *others = sorted(findings, key=lambda f: f["type"] != "extra_forbidden")
    place = ".".join(str(part) for part in first["loc"])
    more = f" (and {len(others)} more)" if others else ""
    if first["type"] == "extra_forbidden":
        key = str(first["loc"][-1])
        return InputError(
            f"unknown key {key!r}{more}",
            where=place,
            hint=near_matches(key, _keys_at(Description, first["loc"][:-1])),
        )
    if first["type"] == "missing":
        last = first["loc"][-1]
        what = f"missing key {last!r}" if isinstance(last, str) else "too few values"
        return InputError(f"{what}{more}", where=place)
    expected = re.sub("^(Input should be|Value error, expected) ", "", first["msg"])
    return InputError(
        f"unusable value{more}", where=place, got=repr(first["input"])[:200], expected=expected
    )


def _keys_at(model: type[pydantic.BaseModel], place: tuple[int | str, ...]) -> list[str]:
    """Field names of the part at ``place``."""
    for step in place:
        field = model.model_fields.get(str(step))
        if field is None:
            return list(Value.model_fields) if model is Description else []
        parts = [
            a
            for a in (field.annotation, *getattr(field.annotation, "__args__", ()))
            if isinstance(a, type)
        ]
        model = next((p for p in parts if issubclass(p, pydantic.BaseModel)), model)
    return list(model.model_fields)
