r"""``python -m benchmarks.reading``: how the reader of notes stands up to good, bad and broken formulas.

``--fuzz N`` reads N inputs: formulas of many books cut short, spliced, with tokens lost, doubled or
exchanged; random tokens; random characters; deep nesting and long chains; documents of such pieces.
Each gives a tree or an `InputError`; nothing else. What is read is written as LaTeX and read again;
where that is another tree (a few in 10,000 of what is no mathematics), it is listed.
``--notes FOLDER`` reads all notes of a folder and says what could not be read.
"""

from __future__ import annotations

import json
import random
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter, process_time

import click

from eom.checker.read.damage import variants
from eom.checker.read.documents import KINDS, load, read_document
from eom.checker.read.grammar import read_formula
from eom.checker.read.spans import Source
from eom.checker.read.statements import read, split
from eom.checker.read.tokens import spelling, tokenize
from eom.checker.read.writing import latex
from eom.errors import InputError
from tests.eom.checker.formulas import BOOKS

GOOD = [text for rows in BOOKS.values() for text, _ in rows]
WORDS = r"""
    \frac \vec \dot \ddot \mathbf{ \boldsymbol \omega \theta \int \int_B \iiint \sum_i dm d t
    \times \cdot
    \left( \right) \left. \right| \left\{ \right. \begin{bmatrix} \end{bmatrix}
    \begin{aligned} \end{aligned}
    \begin{cases} \end{cases} \\ & { } ( ) [ ] | ^ _ ' = + - / , ; \text{if} \quad \Rightarrow \triangleq
    \neq < {}^A {}_B \prescript \sin \cos^2 \tilde \underline \bullet \circ ^\times ^{T} ^{-1} \boxed{
    \underbrace{ \overset
    \partial \dv \tag{1} \sqrt \bar x r m I 2 0.5 \rm \bf \mathrm{d} \hat{e} \tensor
    \foo % $ # ~ \, \% \forall \in \cdots := -> * ! \begin{array}{cc} \end{array} \operatorname{tr} \det
    \big| \Big( \over \substack{ \cancel
""".split()
MAX_WRITTEN = 10_000
MAX_SECONDS = 2.0
"""No input of this size may take more processor time. The command judges it, in a process of its own:
beside other tests a collection of garbage may fall on any input."""


@dataclass
class Findings:
    """Counts by kind, and what went wrong, as texts."""

    read: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    otherwise: list[str] = field(default_factory=list)
    """What reads as another tree when it is written as LaTeX."""
    slowest: tuple[float, str, str] = (0.0, "", "")


REPEATED = [
    *[("(", ")"), ("{", "}"), (r"\dot{", "}"), ("x^{", "}"), (r"\left[", r"\right]"), ("|", "|")],
    *[(r"\sum_i ", ""), (r"\int ", ""), ("- ", ""), (r"\frac{", "}{2}"), (r"a \times ", "b")],
    *[("x'^2", ""), ("a / ", "b"), (r"a \wedge b \times ", "c"), (r"\sqrt{", "}"), ("{}^{A}", "")],
    *[(r"\begin{bmatrix}", r"\end{bmatrix}"), (r"\frac{d}{dt}", ""), (r"x \Rightarrow ", "y")],
]
"""What is written many times before and behind a letter."""


def truncated(rng: random.Random) -> str:
    """Return a good formula without its end or its beginning."""
    text = rng.choice(GOOD)
    k = rng.randrange(len(text) + 1)
    return text[:k] if rng.random() < 0.7 else text[k:]


def spliced(rng: random.Random) -> str:
    """Return parts of two good formulas."""
    a, b = rng.choice(GOOD), rng.choice(GOOD)
    return a[: rng.randrange(len(a) + 1)] + b[rng.randrange(len(b) + 1) :]


def pieces(text: str) -> list[str]:
    """Return the tokens of a formula as texts."""
    return [spelling([t]) for t in tokenize(Source(""), text)[:-1]]


def edited(rng: random.Random) -> str:
    """Return a good formula with tokens lost, doubled, exchanged or replaced."""
    parts = [part + " " for part in pieces(rng.choice(GOOD))]
    for _ in range(rng.randint(1, 3)):
        k = rng.randrange(len(parts))
        how = rng.randrange(4)
        if how == 0:
            parts[k] = ""
        elif how == 1:
            parts[k] *= 2
        elif how == 2:
            j = rng.randrange(len(parts))
            parts[k], parts[j] = parts[j], parts[k]
        else:
            parts[k] = rng.choice(WORDS) + " "
    return "".join(parts)


def soup(rng: random.Random) -> str:
    """Return random tokens."""
    return " ".join(rng.choice(WORDS) for _ in range(rng.randint(1, 30)))


def characters(rng: random.Random) -> str:
    """Return random characters, of ASCII and beyond."""
    pool = "".join(chr(c) for c in range(32, 127)) + "ωθ×·ẋ²₁′\u0307\u20d7∫∑𝐫\t\n\\\\{{}}$$"
    wild = [chr(rng.randrange(1, 0x3000)) for _ in range(3)]
    return "".join(rng.choice([*pool, *wild]) for _ in range(rng.randint(1, 60)))


def nested(rng: random.Random) -> str:
    """Return something deep or long."""
    count = rng.choice([5, 20, 31, 200, 3000])
    opening, closing = rng.choice(REPEATED)
    tail = closing * rng.choice([count, count, count - 1, 0])
    return opening * count + "x" + tail


def document(rng: random.Random) -> str:
    """Return a document of broken pieces, in Markdown or LaTeX."""
    makers = [truncated, spliced, soup, characters]
    marks = [
        "$",
        "$$",
        r"\[",
        r"\]",
        "\n\n",
        "```",
        "`",
        "<!--",
        "-->",
        "> ",
        "# ",
        "\n",
        r"\(",
        "---\n",
    ]
    marks += [
        r"\begin{align}",
        r"\end{align}",
        r"\newcommand{\a}[1]{",
        r"\def\b#1{\b}",
        r"\input{x}",
    ]
    marks += [r"\let\c\d ", r"\a", r"\b", "% ", r"\verb|", r"\section{"]
    parts = [
        rng.choice(marks) if rng.random() < 0.6 else rng.choice(makers)(rng) for _ in range(20)
    ]
    return "".join(parts)


FORMULAS: dict[str, tuple[int, Callable[[random.Random], str]]] = {
    "truncated": (25, truncated),
    "spliced": (25, spliced),
    "edited": (25, edited),
    "random tokens": (15, soup),
    "random characters": (5, characters),
    "nested": (2, nested),
    "documents": (3, document),
}


class WrittenOtherwiseError(Exception):
    """A tree that reads differently when written."""


def check(kind: str, text: str, found: Findings) -> None:
    """Read one input in all ways; note what is not a tree or an `InputError`."""
    start = process_time()
    try:
        if kind == "documents":
            cell = {"cell_type": "markdown", "source": [text]}
            read(read_document(json.dumps({"cells": [cell]}), "notebook"))
            read(read_document(text, "markdown"))
            read(read_document(text, "latex"))
        else:
            _check_formula(text)
        found.read[kind] += 1
    except InputError as error:
        str(error)
        found.refused[kind] += 1
    except WrittenOtherwiseError as error:
        found.read[kind] += 1
        found.otherwise.append(f"{kind}: written otherwise: {error}\n  {text[:300]!r}")
    except Exception as error:
        found.failures.append(f"{kind}: {type(error).__name__}: {error}\n  {text[:300]!r}")
    seconds = process_time() - start
    if seconds > found.slowest[0]:
        found.slowest = (seconds, kind, text[:100])


def _check_formula(text: str) -> None:
    source = Source(text)
    tree = read_formula(text).tree
    split(tree)
    written = latex(tree)
    if len(written) > MAX_WRITTEN:
        return
    for variant in variants(source, tokenize(source, text)):
        split(variant.reading.tree)
    try:
        again = read_formula(written).tree
    except InputError as error:
        raise WrittenOtherwiseError(f"{written}\n{error}") from error
    if again != tree:
        raise WrittenOtherwiseError(written)


def fuzz(count: int, seed: int) -> Findings:
    """Read ``count`` inputs of all kinds; the same seed gives the same inputs."""
    rng = random.Random(seed)
    found = Findings()
    kinds = list(FORMULAS)
    weights = [FORMULAS[k][0] for k in kinds]
    for _ in range(count):
        kind = rng.choices(kinds, weights)[0]
        check(kind, FORMULAS[kind][1](rng), found)
    return found


def notes(folder: Path) -> int:
    """Read all notes of a folder; print what could not be read, and return its number."""
    unread = 0
    for path in sorted(p for p in folder.rglob("*") if p.suffix in KINDS):
        start = perf_counter()
        formulas = read(load(path))
        seconds = perf_counter() - start
        kinds = Counter(f.piece.kind for f in formulas)
        relational = Counter(f.piece.kind for f in formulas if f.relational)
        bad = [f for f in formulas if f.error is not None]
        unread += len(bad)
        counted = ", ".join(f"{kinds[k]} {k} ({relational[k]} relational)" for k in sorted(kinds))
        click.echo(f"{path.name}: {counted}; {len(bad)} not read; {seconds:.2f} s")
        for formula in bad:
            click.echo(str(formula.error))
    return unread


@click.command()
@click.option("--fuzz", "count", default=0, help="Number of broken inputs to read.")
@click.option("--seed", default=0, show_default=True)
@click.option("--notes", "folder", type=click.Path(path_type=Path), help="Folder of notes to read.")
def main(count: int, seed: int, folder: Path | None) -> None:
    """Read formulas; exit with 1 where one fails otherwise than by a clear error."""
    bad = notes(folder) if folder is not None else 0
    found = fuzz(count, seed)
    for kind in FORMULAS:
        if found.read[kind] + found.refused[kind]:
            click.echo(f"{kind}: {found.read[kind]} read, {found.refused[kind]} refused")
    for text in [*found.failures[:20], *found.otherwise[:20]]:
        click.echo(text)
    if count:
        seconds, kind, text = found.slowest
        click.echo(
            f"{len(found.failures)} failures in {count}; {len(found.otherwise)} written otherwise"
        )
        click.echo(f"slowest: {seconds:.3f} s, {kind}, {text!r}")
    slow = found.slowest[0] > MAX_SECONDS
    sys.exit(1 if bad or found.failures or slow else 0)


if __name__ == "__main__":
    main()
