"""The one error that users see, the near matches that it offers, and arguments of the wrong type.

>>> print(InputError("unknown state", got="thta", expected="theta or psi", hint="theta?"))
unknown state
  got:      thta
  expected: theta or psi
  hint:     theta?
"""

from __future__ import annotations

import ast
import builtins
import difflib
import functools
import importlib
import inspect
import itertools
import math
import operator
import re
import sys
import types
import typing
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence, Sized
from collections.abc import Set as AbstractSet
from pathlib import Path
from typing import Any, ParamSpec, Self, TypeVar


class InputError(ValueError):
    """Say what is wrong with an input, where, what was got and expected, and what to do.

    The parts are kept as attributes (``what``, ``where``, ``got``, ``expected``, ``hint``), each a text; an
    empty part is left out of the message. A `ValueError`, so that it can be caught as one.

    >>> try:
    ...     raise InputError("unknown state", got="thta", hint="did you mean theta?")
    ... except ValueError as error:
    ...     print(error)
    unknown state
      got:      thta
      hint:     did you mean theta?
    """

    def __init__(
        self,
        what: str,
        *,
        where: str = "",
        got: object = "",
        expected: object = "",
        hint: str = "",
    ) -> None:
        self.what = what = printable(what)
        self.where = where = printable(where)
        self.got = printable(got)
        self.expected = printable(expected)
        self.hint = hint = printable(hint)
        parts = [("where", where), ("got", self.got), ("expected", self.expected), ("hint", hint)]
        super().__init__("\n".join([what, *(f"  {k + ':':<9} {v}" for k, v in parts if v)]))

    def at(self, where: str) -> Self:
        """Return the same error at a place.

        Parameters
        ----------
        where : str
            What a message calls the place: a file, a section, an argument.

        Returns
        -------
        the same class
            A new one; the rest of the message stays.
        """
        return type(self)(
            self.what, where=where, got=self.got, expected=self.expected, hint=self.hint
        )

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by parts, so that an error crosses process boundaries whole."""
        return (_rebuild, (type(self), self.what, self.where, self.got, self.expected, self.hint))


def _rebuild(
    kind: type[InputError], what: str, where: str, got: str, expected: str, hint: str
) -> InputError:
    return kind(what, where=where, got=got, expected=expected, hint=hint)


class AssumptionError(InputError):
    """Refuse values that contradict an assumption under which a system was derived.

    An `InputError` with the same parts: ``what`` names the assumption, ``got`` the values.
    """


def printable(value: object) -> str:
    r"""Return a value as text that can be written anywhere: a lone surrogate stands as its number.

    >>> printable("a\ud800b")
    'a\\ud800b'
    """
    try:
        text = str(value)
    except Exception:  # a foreign object, or a whole number of more digits than Python writes
        text = f"{type(value).__name__} that cannot be written: of very many digits, perhaps"
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def spelt(name: str, known: Iterable[str]) -> str:
    """Return a name as it is known, in whatever case it is given; others as they are.

    >>> spelt("dop853", ["auto", "DOP853"])
    'DOP853'
    """
    return {k.casefold(): k for k in known}.get(name.strip().casefold(), name)


def near_matches(name: str, known: Iterable[str]) -> str:
    """Return a hint that names the known spellings closest to ``name``, or all of a short list.

    >>> near_matches("omeg_1", ["omega_1", "omega_2", "psi"])
    'did you mean omega_1 or omega_2?'
    """
    names = sorted(known)
    folded = {n.casefold(): n for n in names}
    close = difflib.get_close_matches(name.casefold(), list(folded), n=3, cutoff=0.6)
    if close:
        return f"did you mean {' or '.join(folded[c] for c in close)}?"
    return f"known names: {', '.join(names)}" if 0 < len(names) <= 40 else ""


def unknown_name(kind: str, name: object, known: Iterable[str], where: str = "") -> InputError:
    """Build the error for a name, or something else, that is not among the known ones."""
    if not isinstance(name, str):
        return InputError(f"a {kind} has a name", where=where, got=shown(name), expected="a text")
    return InputError(f"unknown {kind} {name!r}", where=where, hint=near_matches(name, known))


# -- arguments of the wrong type -----------------------------------------------------------------

_UNIONS = (typing.Union, types.UnionType)
P = ParamSpec("P")
R = TypeVar("R")


def typed(function: Callable[P, R]) -> Callable[P, R]:
    """Return a function that refuses arguments which are not what its annotations say.

    Raises `InputError`, which names the argument, before anything is done. Numbers may be of any kind that
    a float is made of, also of SymPy and NumPy, and whole numbers reach the function as `int`; a text is no
    list of its letters. What can be gone through once is gone through here; what is neither a list nor an
    array has `MOST_ENTRIES` at most. What an annotation says of arrays and generic protocols is left to
    the function.
    """
    signature = inspect.signature(function)
    hints = functools.cache(lambda: _of_arguments(function, signature))
    known = functools.cache(lambda: _certain(signature, hints()))

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        if known()(args, kwargs):
            return function(*args, **kwargs)
        try:
            given = signature.bind(*args, **kwargs)
        except TypeError:  # the call itself is wrong: Python says how
            return function(*args, **kwargs)
        changed = False
        for name, value in given.arguments.items():
            hint = hints().get(name, Any)
            held = _held(value, hint)
            if _is_long(held) or not _fits(held, hint):
                written = signature.parameters[name].annotation
                called = given.arguments.get("name", "") if name != "name" else ""
                raise _misfit(function, name, held, _kind(written, hint), called)
            if held is not value:
                given.arguments[name], changed = held, True
        return function(*given.args, **given.kwargs) if changed else function(*args, **kwargs)

    return checked


Test = Callable[[Any], bool]


def _certain(
    signature: inspect.Signature, hints: Mapping[str, Any]
) -> Callable[[tuple[Any, ...], Mapping[str, Any]], bool]:
    """Return whether arguments certainly are what annotations say, and reach the function as they are.

    That is found by their types alone, in a few microseconds; what it does not say may fit all the same.
    """
    several = {inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD}
    if any(p.kind in several for p in signature.parameters.values()):
        return lambda args, kwargs: False
    rows = {name: _by_type(hints.get(name, Any)) for name in signature.parameters}
    ordered = tuple(rows.values())

    def certain(args: tuple[Any, ...], kwargs: Mapping[str, Any]) -> bool:
        if len(args) > len(ordered):
            return False
        for value, (plain, test) in zip(args, ordered, strict=False):
            if type(value) not in plain and not test(value):
                return False
        for name, value in kwargs.items():
            row = rows.get(name)
            if row is None or not (type(value) in row[0] or row[1](value)):
                return False
        return True

    return certain


def _by_type(hint: Any) -> tuple[frozenset[type], Test]:
    """Return types all of whose values fit, and a test of values of others.

    It holds of none that `_fits` refuses, or that `_held` changes.
    """
    kinds = typing.get_args(hint) if typing.get_origin(hint) in _UNIONS else (hint,)
    plain = frozenset(t for kind in kinds for t in _types_of(kind))
    anything = any(_is_open(kind) for kind in kinds)
    of_numbers = {own for kind in kinds if (own := _holds_numbers(kind))}
    pairs = {len(typing.get_args(k)) for k in kinds if _is_pair(k)}

    def test(value: Any) -> bool:
        kind = type(value)
        if kind is str:
            return kind in plain and bool(value.isascii())
        if kind is dict:
            return Mapping in of_numbers and _of_text(value) and _are_floats(value.values())
        if kind is tuple or kind is list:
            if anything:
                return kind is list or len(value) <= MOST_ENTRIES
            if len(value) in pairs or (Sequence in of_numbers and len(value) <= MOST_ENTRIES):
                return _are_floats(value)
        return False

    return plain - {str}, test


_FLOATS, _NUMBERS = frozenset({float}), frozenset({float, int})


def _are_floats(values: Collection[Any]) -> bool:
    """Return whether values are floats, or whole numbers that can be."""
    kinds = {*map(type, values)}
    if kinds <= _FLOATS:
        return True
    return kinds <= _NUMBERS and all(-(2**1000) < v < 2**1000 for v in values if type(v) is int)


def _is_open(kind: Any) -> bool:
    """Return whether an annotation is of a generic protocol, of which nothing is known."""
    own = typing.get_origin(kind)
    return own is not None and own not in _RULES and bool(getattr(own, "_is_protocol", False))


def _holds_numbers(kind: Any) -> Any:
    """Return what an annotation is of, a mapping from texts or a list, where its entries may be floats."""
    own, args = typing.get_origin(kind), typing.get_args(kind)
    if own is Mapping and args[0] is str:
        return own if _may_be_float(args[1]) else None
    return own if own is Sequence and args and _may_be_float(args[0]) else None


def _may_be_float(hint: Any) -> bool:
    return hint is float or (typing.get_origin(hint) in _UNIONS and float in typing.get_args(hint))


def _of_text(value: Mapping[Any, Any]) -> bool:
    return {*map(type, value)} <= {str} and all(map(str.isascii, value))


def _types_of(kind: Any) -> tuple[type, ...]:
    """Return types of which every value is what an annotation says; a text is looked at further."""
    if kind is float:
        return (float,)
    if kind in {bool, str}:
        return (kind,)
    if kind is None or kind is type(None):
        return (type(None),)
    own = typing.get_origin(kind) or kind
    if own in _RULES or not isinstance(own, type) or getattr(own, "_is_protocol", False):
        return ()
    return (own,)


def _is_pair(kind: Any) -> bool:
    """Return whether an annotation is that of so many floats."""
    return typing.get_origin(kind) is tuple and set(typing.get_args(kind)) == {float}


def _of_arguments(function: Callable[..., Any], signature: inspect.Signature) -> dict[str, Any]:
    """Return annotations by argument; one of any number is a tuple or a mapping of what is annotated."""
    found = _hints(function)
    for name, parameter in signature.parameters.items():
        if parameter.kind is parameter.VAR_POSITIONAL:
            found[name] = tuple[found.get(name, Any), ...]  # type: ignore[misc]
        elif parameter.kind is parameter.VAR_KEYWORD:
            found[name] = Mapping[str, found.get(name, Any)]  # type: ignore[misc]
    return found


MOST_ENTRIES = 10**6
"""How many entries an argument has at most that may have any number of them: a range, a generator."""


def _held(value: Any, hint: Any) -> Any:
    """Return an argument as the function gets it: a tuple of what can be gone through once, whole numbers.

    One entry more than `MOST_ENTRIES` shows that there are too many.
    """
    kinds = typing.get_args(hint) if typing.get_origin(hint) in _UNIONS else (hint,)
    if int in kinds and not isinstance(value, int) and _is_whole(value):
        return operator.index(value)
    if float in kinds and not isinstance(value, float | int) and _is_number(value):
        return math.nan if math.isnan(float(value)) else value  # SymPy's cannot be compared
    is_once = isinstance(value, Iterable) and not isinstance(value, Sized | type)
    if is_once and any(typing.get_origin(kind) is Iterable for kind in kinds):
        return tuple(itertools.islice(value, MOST_ENTRIES + 1))
    return value


C = TypeVar("C", bound=type)


def typed_fields(cls: C) -> C:
    """Return a class, as a rule a dataclass, which is made of fields as annotated alone: see `typed`."""
    cls.__init__ = typed(cls.__init__)  # type: ignore[misc]
    return cls


_ARRAYS = re.compile(r"numpy\.ndarray\[.*?numpy\.dtype\[[\w.]*\]\]")
_MODULES = re.compile(r"\b([a-z]\w*\.)+(?=[A-Z])")


def _kind(written: object, hint: object) -> str:
    """Return an annotation as it is written, and in place of a name for several types these."""
    text = str(written)
    if text.isidentifier() and typing.get_origin(hint) in {typing.Union, types.UnionType}:
        return _MODULES.sub("", _ARRAYS.sub("array", str(hint)))
    return text.replace("collections.abc.", "")


def _misfit(
    function: Callable[..., Any], name: str, value: object, kind: str, called: object
) -> InputError:
    """Return the error of an argument; ``called``: the name of what is made, if it has one."""
    owner = function.__qualname__.removesuffix(".__init__").rpartition(".")[2]
    owner += f" {called!r}" if called and is_text(called) else ""
    hint = ""
    if isinstance(value, str) and not is_text(value):
        hint = (
            "it holds a lone surrogate, which no file can: was it read with errors=surrogateescape?"
        )
    if _is_long(value):
        hint = f"it has more than {MOST_ENTRIES:,} entries"
    if name == "inputs" and callable(value):
        hint = 'one function gets a name, as in inputs={"M": f}'
    if name == "system" and hasattr(value, "derive"):
        hint = "call derive() of a scene"
    entry = _wrong_entry(value, _hints(function)[name])
    if entry is not None:
        key, value, annotation = entry
        kind, owner = _written(annotation), f"{owner}, entry {shown(key)}"
    return InputError(
        f"{name} is of the wrong type",
        where=owner,
        got=shown(value),
        expected=kind,
        hint=hint,
    )


def _written(annotation: object) -> str:
    name = annotation.__name__ if isinstance(annotation, type) else str(annotation)
    return name.replace("collections.abc.", "")


def _wrong_entry(value: object, hint: Any) -> tuple[object, object, Any] | None:
    """Return key, value and annotation of the first entry that makes a mapping wrong, if one does."""
    kinds = typing.get_args(hint) if typing.get_origin(hint) in _UNIONS else (hint,)
    mappings = [k for k in kinds if typing.get_origin(k) is Mapping]
    if not isinstance(value, Mapping) or len(mappings) != 1:
        return None
    key, entry = typing.get_args(mappings[0])
    wrong = (item for item in value.items() if _fits(item[0], key) and not _fits(item[1], entry))
    return next(((name, found, entry) for name, found in wrong), None)


def shown(value: object) -> str:
    """Return the type of a value, and the value as far as it is short, which may name its type itself."""
    kind, written = type(value).__name__, quoted(value)
    return printable(written if written.startswith(f"{kind}(") else f"{kind} {written}".strip())


def quoted(value: object) -> str:
    """Return a value as Python writes it, as far as it is short; nothing of one that cannot be written."""
    try:
        return printable(repr(value)[:200])
    except Exception:  # whatever a foreign object does
        return ""


def entries(value: Any, where: str) -> list[Any]:
    """Return what a user wrote as a list, at most `MOST_ENTRIES`. Raises `InputError` for what is none."""
    is_list = not isinstance(value, str | bytes | type)
    try:
        found = list(itertools.islice(iter(value), MOST_ENTRIES + 1)) if is_list else []
    except Exception:  # no list, or a foreign object, on the way to its entries
        is_list = False
    if not is_list or len(found) > MOST_ENTRIES:
        most = "" if not is_list else f"it has more than {MOST_ENTRIES:,} entries"
        raise InputError(
            "not a list", where=where, got=shown(value), hint=most or "one alone is written (x,)"
        )
    return found


class _Known(dict[str, Any]):
    """Names of a module, those that it imports for type checkers alone among them."""

    def __missing__(self, name: str) -> Any:
        if hasattr(builtins, name):
            return getattr(builtins, name)
        home, original = _for_checkers(self.get("__name__", "")).get(name, ("", ""))
        try:
            return getattr(importlib.import_module(home), original)
        except (ImportError, AttributeError, ValueError):  # not to be had here: it says nothing
            return Any


@functools.cache
def _for_checkers(module: str) -> Mapping[str, tuple[str, str]]:
    """Return what a module imports under TYPE_CHECKING: module and name there, by the name here."""
    try:
        body = ast.parse(inspect.getsource(sys.modules[module])).body
    except (KeyError, OSError, TypeError):  # typed in at a prompt
        return {}
    blocks = [n.body for n in body if isinstance(n, ast.If) and ast.unparse(n.test) in _CHECKING]
    lines = [n for block in blocks for n in block if isinstance(n, ast.ImportFrom) and n.module]
    return {a.asname or a.name: (str(n.module), a.name) for n in lines for a in n.names}


_CHECKING = {"TYPE_CHECKING", "typing.TYPE_CHECKING"}


def _hints(function: Callable[..., Any]) -> dict[str, Any]:
    return typing.get_type_hints(function, localns=_Known(function.__globals__))


def _fits(value: Any, hint: Any) -> bool:
    """Return whether a value is what an annotation says, as far as that can be known."""
    kind = typing.get_origin(hint) or hint
    rule = _RULES.get(kind)
    if rule is not None:
        return rule(value, typing.get_args(hint))
    if hint is None:
        return value is None
    if not isinstance(kind, type):
        return True
    if getattr(kind, "_is_protocol", False):
        return kind is not hint or _has_members(value, kind)
    return isinstance(value, kind)


def _has_members(value: Any, protocol: type) -> bool:
    """Return whether a value has what a protocol names, but for names with underscores."""
    names = [n for c in protocol.__mro__ for n in (*vars(c), *vars(c).get("__annotations__", ()))]
    return all(hasattr(value, n) for n in names if not n.startswith("_"))


def _is_number(value: Any, _: Any = ()) -> bool:
    if isinstance(value, str | bytes | bytearray) or getattr(value, "shape", ()) != ():
        return False
    try:
        return isinstance(float(value), float)
    except (TypeError, ValueError, OverflowError):
        return False


def _is_whole(value: Any, _: Any = ()) -> bool:
    """Return whether a value is a whole number: a count, a seed, none of more than 64 bits."""
    is_single = not isinstance(value, type) and getattr(value, "shape", ()) == ()
    if not (is_single and hasattr(value, "__index__")):
        return False
    try:
        return -(2**63) <= operator.index(value) < 2**64
    except TypeError:  # an array without dimensions that holds no whole number
        return False


def _is_flag(value: Any, _: Any = ()) -> bool:
    return type(value).__name__ in {"bool", "bool_"}


def is_text(value: Any, _: Any = ()) -> bool:
    """Return whether a value is a text that can be written: one without lone surrogates."""
    if not isinstance(value, str):
        return False
    return value.isascii() or not any("\ud800" <= c <= "\udfff" for c in value)


def _is_mapping(value: Any, kinds: Any) -> bool:
    if not isinstance(value, Mapping):
        return False
    key, entry = kinds or (Any, Any)
    return all(_fits(k, key) and _fits(v, entry) for k, v in value.items())


def _is_list(value: Any) -> bool:
    if isinstance(value, str | bytes | bytearray | Mapping | type):
        return False
    is_array = len(getattr(value, "shape", ())) == 1
    return is_array or isinstance(value, Sequence)


def _is_long(value: Any) -> bool:
    """Return whether a sequence that is no list has more than `MOST_ENTRIES`: it may have any number."""
    if not isinstance(value, Sequence) or isinstance(value, list | str | bytes | bytearray):
        return False
    try:
        return len(value) > MOST_ENTRIES
    except OverflowError:  # more than a length can be
        return True


def _is_sequence(value: Any, kinds: Any) -> bool:
    """Return whether a value is a list; one whose entries cannot be had, or too many, is none."""
    if not _is_list(value) or _is_long(value):
        return False
    try:
        return all(_fits(v, kinds[0] if kinds else Any) for v in value)
    except Exception:  # of a foreign object, on the way to its entries
        return False


def _is_iterable(value: Any, kinds: Any) -> bool:
    """Return whether a value can be gone through; of what is neither a list nor a set, alone that."""
    if isinstance(value, AbstractSet):
        return all(_fits(v, kinds[0] if kinds else Any) for v in value)
    if _is_list(value):
        return _is_sequence(value, kinds)
    is_other = isinstance(value, str | bytes | bytearray | type | Mapping)
    return isinstance(value, Iterable) and not is_other and getattr(value, "shape", None) is None


def _is_tuple(value: Any, kinds: Any) -> bool:
    if not kinds or kinds[-1] is Ellipsis:
        return _is_sequence(value, kinds[:1])
    if not _is_sequence(value, ()) or len(value) != len(kinds):
        return False
    return all(_fits(v, kind) for v, kind in zip(value, kinds, strict=True))


def _is_function(value: Any, kinds: Any) -> bool:
    """Return whether a value can be called with as many arguments as it will be, as far as it says."""
    if not callable(value):
        return False
    given = kinds[0] if kinds and isinstance(kinds[0], list) else None
    if given is None:
        return True
    try:
        inspect.signature(value).bind(*given)
    except TypeError:
        return False
    except ValueError:  # written in C, without a signature
        return True
    return True


def _is_one_of(value: Any, kinds: Any) -> bool:
    """Return whether a value is of one kind; the name of a file may hold bytes that are no text."""
    is_name = Path in kinds and isinstance(value, str)
    return is_name or any(_fits(value, kind) for kind in kinds)


_RULES: dict[Any, Callable[[Any, Any], bool]] = {
    Any: lambda value, _: True,
    object: lambda value, _: True,
    type(None): lambda value, _: value is None,
    float: _is_number,
    int: _is_whole,
    bool: _is_flag,
    str: is_text,
    Mapping: _is_mapping,
    dict: _is_mapping,
    Sequence: _is_sequence,
    Collection: lambda value, kinds: isinstance(value, Sized) and _is_iterable(value, kinds),
    list: _is_sequence,
    tuple: _is_tuple,
    Iterable: _is_iterable,
    Callable: _is_function,
    typing.Union: _is_one_of,
    types.UnionType: _is_one_of,
    typing.Literal: lambda value, kinds: any(value is k or value == k for k in kinds),
    typing.Annotated: lambda value, kinds: _fits(value, kinds[0]),
}
"""What an annotation of each kind asks for: (value, its arguments)."""
