"""The table of statements: where a sentence stands, the sentence, and the function that computes it."""

import importlib
import inspect
import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import sympy as sp

import eom

ROOT = Path(__file__).parents[2]
ROWS: list["Statement"] = []
"""In the order in which their modules are read."""


@dataclass(frozen=True)
class Statement:
    """A sentence, or a part of one, ``where`` it stands, and the ``test`` that computes it.

    ``where``: a file of the repository; ``derive NAME LABEL``, the reason of a step; or the dotted name
    of what has it in its docstring. ``slow``: whether the test takes longer than the others.
    """

    where: str
    sentence: str
    test: Callable[[], None]
    slow: bool = False

    @property
    def name(self) -> str:
        """The name of the test, with its module."""
        return f"{self.test.__module__.rsplit('.', 1)[-1]}.{self.test.__name__}"


def says(where: str, sentence: str, *, slow: bool = False) -> Callable[..., Callable[[], None]]:
    """Return a decorator that enters a function into the table as the test of a sentence."""

    def entered(test: Callable[[], None]) -> Callable[[], None]:
        row = Statement(where, plain(sentence), test, slow)
        ROWS[:] = [
            r for r in ROWS if (r.name, r.where, r.sentence) != (row.name, where, row.sentence)
        ]
        ROWS.append(row)
        return test

    return entered


def plain(text: str) -> str:
    """Return a text with one space between its words."""
    return re.sub(r"\s+", " ", text).strip()


def stands(statement: Statement) -> bool:
    """Return whether a sentence stands, word for word, where its row says."""
    return statement.sentence in _text(statement.where)


@cache
def _text(where: str) -> str:
    if where.startswith("derive "):
        _, name, label = where.split(" ")
        return plain(eom.derive(name)[label].reason)
    path = ROOT / where
    if path.suffix == ".ipynb":
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        words = ("".join(c["source"]) for c in cells if c["cell_type"] == "markdown")
        return plain("\n\n".join(words))
    if path.is_file():
        return plain(path.read_text(encoding="utf-8"))
    return plain(inspect.getdoc(_object(where)) or "")


def _object(name: str) -> object:
    """Return what a dotted name means: a module, or what is in one."""
    parts = name.split(".")
    for k in range(len(parts), 0, -1):
        try:
            found: object = importlib.import_module(".".join(parts[:k]))
        except ModuleNotFoundError:
            continue
        for part in parts[k:]:
            found = getattr(found, part)
        return found
    raise ModuleNotFoundError(name)


def same(left: object, right: object) -> bool:
    """Return whether two expressions or matrices are equal for all values, by SymPy."""
    pairs = zip(sp.flatten(sp.Matrix([left])), sp.flatten(sp.Matrix([right])), strict=True)
    return all(sp.simplify(a - b) == 0 for a, b in pairs)
