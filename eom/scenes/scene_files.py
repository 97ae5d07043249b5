"""Scenes of every model: what they answer, their files, and findings of pydantic as one readable error."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self, get_args

import pydantic
import sympy as sp
from pydantic_core import ErrorDetails

from eom.displays import display
from eom.errors import InputError, entries, near_matches, quoted
from eom.quantities import Quantity
from eom.scenes import catalogue, given, parse, reduce
from eom.scenes.description import Control, Request
from eom.scenes.reduce import Explanation, Pass, Step
from eom.scenes.start import pick
from eom.scenes.stated import Stated
from eom.system import System
from eom.units import in_unit

Expr = Any
MAX_FILE_BYTES = 1_000_000


def data_of(file: Path) -> dict[str, Any]:
    """Return what a TOML file says; its ``name`` is the file's unless it has one.

    Raises `InputError` with the file's name for a file that cannot be read.
    """
    text = text_of(file, "*.toml")
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # a huge integer, deep nesting
        raise InputError("not a valid TOML file", where=str(file), got=str(error)) from None
    data.setdefault("name", file.stem)
    return data


def text_of(file: Path, pattern: str) -> str:
    """Return the text of a file; ``pattern``: files whose names are near matches."""
    if not file.is_file():
        folder, name = (file, "") if file.is_dir() else (file.parent, file.name)
        known = [p.name for p in folder.glob(pattern)] if folder.is_dir() else []
        raise InputError(
            "no such scene file", where=str(file), got="" if name else "a folder",
            hint=near_matches(name, known) or "eom list names the scenes that are ready",
        )  # fmt: skip
    if file.stat().st_size > MAX_FILE_BYTES:
        raise InputError(
            "scene file is too large", where=str(file), expected=f"at most {MAX_FILE_BYTES} bytes"
        )
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("scene file cannot be read", where=str(file), got=str(error)) from None


class BaseScene(Request):
    """What scenes of every model answer, so that nobody needs to know which of them they have.

    Fields: see `eom.scenes.description.Request`. Raises `InputError` for anything that is misspelt, missing
    or impossible.
    """

    is_tree: ClassVar[bool] = False
    """Whether its files say so."""
    _file: ClassVar[str] = ""
    """The file that it is from; a scene that knows its own has it in its place."""

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**_with_inputs(self._written_out(limited(data))))
        except pydantic.ValidationError as error:
            raise readable(error, type(self)) from None

    def __repr__(self) -> str:
        """Name it; its fields are many."""
        return (
            f"{type(self).__name__}({self.name!r}: {self.title})"
            if self.title
            else (f"{type(self).__name__}({self.name!r})")
        )

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """Return what a notebook displays: the system that is derived."""
        return str(display("system as page", self.derive(), "html"))

    def __eq__(self, other: object) -> bool:
        """Scenes are equal if their fields are: what was worked out from them is no part of it."""
        if type(other) is not type(self):
            return NotImplemented
        return all(getattr(self, name) == getattr(other, name) for name in type(self).model_fields)

    def __hash__(self) -> int:
        """Scenes are values; hash by content that matters for lookup only."""
        return hash((type(self), self.title, self.outputs))

    @classmethod
    def from_toml(cls, path: str | Path) -> Self:
        """Return the scene of a TOML file.

        Parameters
        ----------
        path : str or path
            Of the file.

        Returns
        -------
        the same class
            Of the model that the file names.

        Raises
        ------
        InputError
            With the file's name for whatever is wrong in it.
        """
        file = Path(path)
        data = data_of(file)
        with in_file(file):
            if catalogue.is_tree(data) != cls.is_tree:
                own, found = ("one body", "a tree of bodies")[:: -1 if cls.is_tree else 1]
                raise InputError(
                    f"this scene is {found}, not {own}",
                    where="model",
                    hint="eom.load_scene opens scenes of every model",
                )
            return cls(**data)._from(str(file))

    @classmethod
    def ready(cls, name: str) -> Self:
        """Return one of the scenes that ship with the package; ``eom list`` names them.

        Parameters
        ----------
        name : str
            One of those that ``eom list`` prints.

        Returns
        -------
        the same class
            As its file says; nothing is derived yet.

        Raises
        ------
        InputError
            For other names.
        """
        return cls.from_toml(catalogue.path_of(name))

    @classmethod
    def _written_out(cls, data: dict[str, Any]) -> dict[str, Any]:
        """Return what a file says with what it abbreviates."""
        return data

    def changed(self, **changes: Any) -> Self:
        """Return the scene with other values of its fields.

        Parameters
        ----------
        changes : object, optional
            Values by the names of fields.

        Returns
        -------
        the same class
            A new scene, checked as a whole.

        Raises
        ------
        InputError
            As its class raises it.
        """
        return type(self)(**{**self.model_dump(exclude_unset=True), **changes})._from(self._file)

    def with_values(self, values: Mapping[str, float | str]) -> Self:
        """Return the scene with other values of parameters, inputs and initial values.

        Parameters
        ----------
        values : mapping of str to float or str
            By name. Numbers in SI units, or texts: numbers with units, as "30 deg", formulas of
            numbers, as "pi/2", for initial values also formulas over parameters. Names are those of
            the scene's systems; values of a body's own, such as I1 or a weight's m and g, too.

        Returns
        -------
        the same class
            An attitude coordinate at the start takes the others as they are. What is set under
            constraints is kept, and the rest made consistent.

        Raises
        ------
        InputError
            For other names, numbers that follow from others, inputs that follow a law of control,
            other dimensions, and for what is no scene.

        Examples
        --------
        >>> from eom import load_scene
        >>> other = load_scene("double-pendulum").with_values({"q_elbow": "30 deg"})
        >>> round(other.initial_values()["q_elbow"], 6)
        0.523599
        """
        places = self._places()
        data, start = given.placed(self, self.model_dump(exclude_unset=True), values, places)
        known = self._starting() if start else ()
        if not {*start} <= {*known}:
            units = {q.name: q.unit for q in self.derive().inputs}
            held = {n: given.number_of(start.pop(n), units[n], n) for n in {*start} & {*units}}
            data["inputs"] = {**data.get("inputs", {}), **held}
        for name in start:
            if name not in known:
                raise given.unknown(name, self, places, known)
        if start:
            data = self._started(data, start)
        return type(self)(**data)._from(self._file)

    def _places(self) -> Mapping[str, given.Place]:
        """Return where the numbers of its body are said, by name."""
        return {}

    def _starting(self) -> Collection[str]:
        """Return the names of what it may start at."""
        raise NotImplementedError

    def _started(self, data: dict[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
        """Return its data with other values at the start, of such names."""
        raise NotImplementedError

    def _from(self, file: str) -> Self:
        """Return the scene, which from now on knows its file."""
        if file:
            self.__dict__["_file"] = file
        return self

    def _told(self) -> AbstractContextManager[None]:
        """Put its file before the place of errors, if it is from one."""
        return in_file(Path(self._file)) if self._file else nullcontext()

    def as_stated(self) -> Self:
        """Return the scene over its own coordinates, whatever it is integrated in."""
        return self

    def in_attitude(self, attitude: str) -> Self:
        """Return the scene in other coordinates of attitude, all of which are asked for.

        Parameters
        ----------
        attitude : str
            Of a scene of one body: ``quaternion``, ``dcm`` or one of the 12 sequences.

        Returns
        -------
        the same class
            Of a tree there is none: its attitudes are those of joints.

        Raises
        ------
        InputError
            Where they are not the scene's to choose.
        """
        raise InputError("attitudes of a tree belong to its joints", got=attitude)

    @property
    def tree(self) -> Any:
        """The tree of its bodies and joints; None where it is one body by itself."""
        return None

    @property
    def full_system(self) -> System:
        """The system with every state and output that can be asked for."""
        raise NotImplementedError

    @property
    def requested(self) -> tuple[str, ...]:
        """What is asked for: the outputs, or all states and more where none are named."""
        raise NotImplementedError

    def _closed_loop(self, system: System, names: Mapping[str, Expr]) -> System:
        """Return a system under the laws of the scene's control.

        ``names``: what its formulas may speak of beside what the control defines. Raises `InputError` for
        names that are taken, and as `eom.system.System.with_control` does.
        """
        if self.control == Control():
            return system
        self._check_control(system)
        read = self._control_over(names)
        if system.numbers == "values" and parse.has_decimals(self.control.formulas):
            system = replace(system, numbers="decimals")
        own, shared = (
            {n: Quantity(sp.Symbol(n, real=True), s.unit, s.meaning) for n, s in group.items()}
            for group in (self.control.states, self.control.definitions)
        )
        gains = (
            Quantity(sp.Symbol(n, real=True), v.unit, v.meaning or "of the control")
            for n, v in self.parameters.items()
        )
        stepped = self.control.stepped
        return system.with_control(
            read["laws"],
            {own[n]: e for n, e in read["states"].items() if n in stepped},
            definitions={shared[n]: e for n, e in read["definitions"].items()},
            parameters=gains,
            period=self.control.period,
            delay=self.control.delay,
            rates={own[n]: e for n, e in read["states"].items() if n not in stepped},
            dimensions=False,
        )

    def _control_over(self, names: Mapping[str, Expr]) -> dict[str, dict[str, Expr]]:
        """Return the formulas of the control, by section. Raises `InputError` with their places."""
        own = (*self.control.states, *self.control.definitions)
        for name in own:
            if name in names:
                raise InputError(f"name {name!r} is used twice",
                                 where="[control.states] and [control.definitions]",
                                 expected="names that the scene does not have otherwise")  # fmt: skip
        known = {**names, **{n: sp.Symbol(n, real=True) for n in own}}
        return {
            section: {
                n: _read(f, known, f"[control.{section}] {n}", self._unit_of(section, n))
                for n, f in group.items()
            }
            for section, group in self.control.formulas.items()
        }

    def _unit_of(self, section: str, name: str) -> str:
        """Return the unit of a formula of the control, as far as it is known here."""
        if section == "definitions":
            return self.control.definitions[name].unit
        unit = self.control.states[name].unit if section == "states" else ""
        return f"({unit})/s" if unit and name not in self.control.stepped else unit

    def _check_control(self, system: System) -> None:
        """Raise `InputError` for a formula of the control of another dimension than it is to have."""
        groups = (system.states, system.parameters, system.inputs)
        units = {
            q.name: q.unit for q in (*(q for g in groups for q in g), *system.output_quantities)
        }
        units |= {n: d.unit for n, d in self.control.definitions.items()} | {"t": "s"}
        units |= {n: s.unit for n, s in self.control.states.items()}
        own = {n: v.unit for n, v in {**self.parameters, **self.inputs}.items()}
        stated = Stated(units, own)
        for section in ("definitions", "laws", "states"):
            for name, formula in self.control.formulas[section].items():
                of = units.get(name, "") if section == "laws" else self._unit_of(section, name)
                stated.check(formula, f"[control.{section}] {name}", of)
                if section == "laws" and isinstance(formula, str):
                    in_unit(formula, of, f"[control.laws] {name}")

    def _general(self) -> System:
        """Return the system that passes make smaller."""
        raise NotImplementedError

    def _passes(self) -> Mapping[str, Pass]:
        """Return what leaves out what is not needed, by name, in order."""
        raise NotImplementedError

    @cached_property
    def _reduced(self) -> tuple[System, tuple[Step, ...]]:
        return reduce.reduced(self._general(), self._passes())

    def derive(self, off: Collection[str] = ()) -> System:
        """Return the smallest system that the requested outputs need.

        Parameters
        ----------
        off : collection of str, optional
            Names of passes that are not applied, such as ``outputs``.

        Returns
        -------
        System
            What is asked for can be computed of it; what nothing needs is left out.

        Raises
        ------
        InputError
            For names of no pass.
        """
        if not off:
            return self._reduced[0]
        return reduce.reduced(self._general(), self._passes(), off)[0]

    def explain(self) -> Explanation:
        """Return what was skipped, why, and the operations saved; print it to read it."""
        system, steps = self._reduced
        return Explanation(
            reduce.reductions(steps), reduce.cost(steps[0].before), reduce.cost(system)
        )

    def requested_names(self) -> tuple[str, ...]:
        """Return what is asked for that varies: frozen states are constants of the motion."""
        system = self.derive()
        return tuple(n for n in self.requested if n in (*system.state_names, *system.output_names))

    @property
    def numbers(self) -> dict[str, float]:
        """The value of each parameter of the scene, by name, in SI units."""
        return {n: v.value for n, v in self.parameters.items()}

    @property
    def start(self) -> dict[str, float]:
        """The value at t = 0 of each state that the scene determines, by name, in SI units.

        Raises `InputError` for an attitude that is no rotation.
        """
        raise NotImplementedError

    def initial_values(self) -> dict[str, float]:
        """Return the value at t = 0 of each state of `derive`, by name, in SI units.

        Raises `InputError` for missing ones, and for an attitude that is no rotation.
        """
        with self._told():
            return pick(self.start, self.derive().state_names, "initial value", "[initial]")

    def parameter_values(self) -> dict[str, float]:
        """Return the value of each parameter of `derive`, by name, constants of the motion included.

        SI units. Raises `InputError` for missing ones.
        """
        names = self.derive().parameter_names
        with self._told():
            return pick(self.start | self.numbers, names, "parameter", "[parameters] or [initial]")

    def input_values(self) -> dict[str, float]:
        """Return the value at which each input of `derive` is held, by name; 0 where none is given.

        Where laws are sampled, what is held before the first sample: states of the control at the start.
        """
        names = self.derive().input_names
        given = {n: v.value for n, v in self.inputs.items()}
        if any(n in names for n in self.control.stepped):
            given |= {n: v for n, v in self.start.items() if n in self.control.stepped}
        return {n: given.get(n, 0.0) for n in names}

    @property
    def attitudes(self) -> tuple[tuple[str, ...], ...]:
        """Names of the states that are one attitude together, and cannot vary alone."""
        raise NotImplementedError


def _with_inputs(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data of a scene whose controlled inputs are inputs, at zero where no law sets them."""
    control, inputs = data.get("control", {}), data.get("inputs", {})
    laws = control.laws if isinstance(control, Control) else dict(control).get("laws", {})
    if not laws or not isinstance(laws, Mapping) or not isinstance(inputs, Mapping):
        return data
    return {**data, "inputs": {**dict.fromkeys(laws, 0.0), **inputs}}


def _read(formula: str | float, names: Mapping[str, Expr], where: str, unit: str) -> Expr:
    if not isinstance(formula, str):
        return exact(formula)
    return parse.parse(formula, names, where, unit=unit)


def exact(number: float) -> Expr:
    """Return a number of a file as the fraction that is written there."""
    return sp.Rational(str(number))


@contextmanager
def in_file(file: Path) -> Iterator[None]:
    """Put the file's name before the place of errors."""
    try:
        yield
    except InputError as error:
        where = f"{file}: {error.where}" if error.where else str(file)
        raise error.at(where) from None


def limited(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parts of a scene, lists as lists. Raises `InputError` for what may have no end."""
    kinds = (str, bytes, type, Mapping, pydantic.BaseModel)
    return {
        k: entries(v, k) if isinstance(v, Iterable) and not isinstance(v, kinds) else v
        for k, v in data.items()
    }


def readable(error: pydantic.ValidationError, model: type[pydantic.BaseModel]) -> InputError:
    """Turn the first finding about ``model`` into one error; count the others."""
    findings = error.errors(include_url=False)
    ours = [(f, f["ctx"]["error"]) for f in findings if "error" in f.get("ctx", {})]
    if ours and isinstance(ours[0][1], InputError):
        own: InputError = ours[0][1]
        return own if own.where else own.at(".".join(map(str, ours[0][0]["loc"])))
    first, *others = sorted(findings, key=lambda f: f["type"] != "extra_forbidden")
    place = ".".join(str(part) for part in first["loc"])
    more = f" (and {len(others)} more: {_places(others)})" if others else ""
    if first["type"] == "extra_forbidden":
        key = str(first["loc"][-1])
        return InputError(
            f"unknown key {key!r}{more}",
            where=place,
            hint=near_matches(key, _keys_at(model, first["loc"][:-1])),
        )
    if first["type"] == "missing":
        return _missing(first, findings)
    said = _EXPECTED.get(first["type"], "")
    expected = said.format(place=place, **first.get("ctx", {})) or re.sub(
        "^(Input should be|Value error, expected) ", "", first["msg"]
    )
    keys = ", ".join(_keys_at(model, first["loc"])) if first["type"].startswith("model_") else ""
    return InputError(
        f"unusable value{more}", where=place, got=quoted(first["input"]), expected=expected,
        hint=f"its keys: {keys}" if keys else "",
    )  # fmt: skip


def _place(finding: ErrorDetails) -> str:
    return ".".join(str(part) for part in finding["loc"])


def _places(findings: Sequence[ErrorDetails]) -> str:
    """Return where findings are, as far as they are few."""
    places = list(dict.fromkeys(map(_place, findings)))
    return ", ".join(places[:FEW]) + ", ..." * (len(places) > FEW)


def _missing(first: ErrorDetails, findings: Sequence[ErrorDetails]) -> InputError:
    """Return the error for a key that is missing, or for a list that is too short."""
    *place, last = first["loc"]
    lacking = [f for f in findings if f["type"] == "missing" and f["loc"][:-1] == first["loc"][:-1]]
    others = [f for f in findings if f not in lacking]
    more = f" (and {len(others)} more: {_places(others)})" if others else ""
    if isinstance(last, int):
        return InputError(
            f"too few values{more}", where=".".join(map(str, place)), got=quoted(first["input"]),
            expected=f"{last + len(lacking)} values",
        )  # fmt: skip
    names = " and ".join(repr(f["loc"][-1]) for f in lacking)
    return InputError(f"missing key {names}{more}", where=_place(first))


FEW = 4
"""Places of further findings that are named."""
_TABLE = "a table: keys with values, as [{place}] or {{ key = value }}"
_EXPECTED: Mapping[str, str] = {
    **dict.fromkeys(("dict_type", "model_type", "model_attributes_type"), _TABLE),
    **dict.fromkeys(("list_type", "tuple_type"), "a list, as [1, 2, 3]"),
    "string_type": "a text in quotes",
    **dict.fromkeys(("bool_type", "bool_parsing"), "true or false"),
    **dict.fromkeys(("float_type", "float_parsing"), "a number"),
    **dict.fromkeys(("int_type", "int_parsing", "int_from_float"), "a whole number"),
    "finite_number": "a finite number",
    "greater_than": "a number greater than {gt}",
    "greater_than_equal": "{ge} or more",
    "less_than": "a number less than {lt}",
    "less_than_equal": "{le} or less",
    "too_long": "at most {max_length} entries",
    "too_short": "at least {min_length} entries",
}
"""What is expected in the place of what was found, by the kind of the finding."""


def _keys_at(model: type[pydantic.BaseModel], place: tuple[int | str, ...]) -> list[str]:
    """Field names of the part at ``place``; keys of tables by name are passed over."""
    for step in place:
        field = model.model_fields.get(str(step))
        if field is not None:
            model = next(_models(field.annotation), model)
    return list(model.model_fields)


def _models(annotation: Any) -> Iterator[type[pydantic.BaseModel]]:
    """Yield the parts that an annotation speaks of."""
    if isinstance(annotation, type) and issubclass(annotation, pydantic.BaseModel):
        yield annotation
    for inner in get_args(annotation):
        yield from _models(inner)
