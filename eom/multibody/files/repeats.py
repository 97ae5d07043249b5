"""Parts of a scene that come n times: ``[repeat] i = 5`` makes ``link1`` to ``link5`` of ``link{i}``.

A key with ``{i}`` becomes one key for each number; in what belongs to it ``{i}``, ``{i-1}`` and ``{i+1}``
are numbers. A key that is written out stands in place of the one that would be made.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from eom.errors import InputError, unknown_name

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

    def told(match: re.Match[str]) -> str:
        name, step = _step(match[1], value, place)
        if name != number[0]:
            raise unknown_name("index", name, (number[0],), place)
        return str(number[1] + step)

    return _INDEX.sub(told, value)
