r"""Front matter in YAML: the table ``eom`` or ``check`` of it is the lexicon of the note.

    ---
    title: Lecture 3
    eom:
      preset: arrow-tilde
      symbols:
        '\vec{a}': vector a
    ---

That block alone is parsed; anchors, aliases and tags are refused, and nothing in it is evaluated.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import yaml

from eom.errors import InputError

MAX_FRONT = 100_000
"""Characters of the block that is parsed."""
_WHERE = "front matter"
_KEY = re.compile(r"^(eom|check)[ ]*:", re.MULTILINE)
_NEXT = re.compile(r"^[^\s#]", re.MULTILINE)


def in_yaml(front: str) -> bool:
    """Tell whether front matter has a YAML table for the checker."""
    return _KEY.search(front) is not None and "[check" not in front


def yaml_table(front: str) -> Mapping[str, Any]:
    """Return the table for the checker; a word alone names a preset. Raises `InputError`."""
    match = _KEY.search(front)
    if match is None:
        return {}
    end = _NEXT.search(front, match.end())
    block = front[match.start() : end.start() if end else len(front)]
    if len(block) > MAX_FRONT:
        raise InputError("too long", where=_WHERE, expected=f"at most {MAX_FRONT} characters")
    try:
        found = yaml.load(block, Loader=_Plain)[match[1]]  # noqa: S506 - a loader that is safer than safe
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise InputError("not YAML", where=_WHERE, got=_line(error), hint=_HINT) from error
    if isinstance(found, str):
        return {"preset": found}
    if not isinstance(found, Mapping):
        raise InputError("not a table", where=_WHERE, got=found, expected=f"{match[1]}: with keys")
    return found


_HINT = r"patterns stand in single quotes: '\vec{r}'"


def _line(error: Exception) -> str:
    mark = getattr(error, "problem_mark", None)
    problem = getattr(error, "problem", None) or type(error).__name__
    return f"{problem} (line {mark.line + 1} of the block)" if mark is not None else str(problem)


class _Plain(yaml.SafeLoader):
    """The safe loader without anchors and aliases, which can grow without bound."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()  # type: ignore[no-untyped-call]
        if getattr(event, "anchor", None) is not None:
            raise yaml.composer.ComposerError(
                None, None, "anchors and aliases are refused", event.start_mark
            )
        return super().compose_node(parent, index)
