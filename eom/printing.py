"""A system as text, LaTeX or Markdown: variables, equations, constants, singularities, assumptions.

The layout is one list of sections; each format is a table of how sections and formulas are written.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.errors import unknown_name
from eom.system import Definition, Quantity, System

Expr = Any


@dataclass(frozen=True)
class Row:
    """One line of a section: a formula (left and right side) or a symbol, and words."""

    left: Expr | str
    right: Expr | None = None
    words: str = ""


@dataclass(frozen=True)
class Section:
    """A heading with its rows."""

    heading: str
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Rate:
    """The time derivative of a state, as the left side of an equation."""

    state: Quantity


def sections(system: System) -> list[Section]:
    """Return what there is to print, in reading order; empty sections are left out."""
    equations = [Row(Rate(q), r) for q, r in zip(system.states, system.rates, strict=True)]
    heading = "Equations of motion"
    mass: list[Row] = []
    if system.mass_matrix is not None:
        names, block = _coupled_block(system, system.mass_matrix)
        heading = f"Equations of motion; mass matrix times the rates of {names} = right sides"
        mass = [Row("mass matrix", block)]
    everything = [
        Section("States", _variables(system.states)),
        Section("Parameters", _variables(system.parameters)),
        Section("Inputs", _variables(system.inputs)),
        Section("Definitions", _definitions(system.definitions)),
        Section(heading, (*mass, *equations)),
        Section("Outputs", _definitions(system.outputs)),
        Section("Constants of the motion", _definitions(system.invariants)),
        Section(
            "Singular where",
            tuple(Row(s.expression, sp.Integer(0), s.meaning) for s in system.singularities),
        ),
        Section("Assumptions", tuple(Row(a.name, None, a.meaning) for a in system.assumptions)),
    ]
    return [s for s in everything if s.rows]


def _coupled_block(system: System, matrix: Expr) -> tuple[str, Expr]:
    """Return names and mass matrix of the states whose rows differ from those of the identity."""
    n = len(system.states)
    keep = [
        k for k in range(n) if matrix[k, :] != sp.eye(n)[k, :] or matrix[:, k] != sp.eye(n)[:, k]
    ]
    return ", ".join(system.states[k].name for k in keep), matrix.extract(keep, keep)


def _variables(quantities: Iterable[Quantity]) -> tuple[Row, ...]:
    return tuple(Row(q.symbol, None, q.description) for q in quantities)


def _definitions(definitions: Iterable[Definition]) -> tuple[Row, ...]:
    return tuple(Row(d.symbol, d.expression, d.quantity.description) for d in definitions)


def text(system: System) -> str:
    """Return a system as plain text, one equation a line.

    >>> x = sp.Symbol("x")
    >>> print(text(System.from_rates("decay", {x: -x})))
    decay
    <BLANKLINE>
    States
      x
    <BLANKLINE>
    Equations of motion
      x' = -x
    """

    def side(value: Expr | str | Rate) -> str:
        if isinstance(value, Rate):
            return f"{value.state.name}'"
        return str(value.tolist()) if isinstance(value, sp.MatrixBase) else str(value)

    lines = [system.title or system.name]
    for section in sections(system):
        lines += ["", section.heading]
        width = max((len(side(r.left)) for r in section.rows), default=0)
        for row in section.rows:
            formula = f"{side(row.left):<{width}}" + (
                f" = {side(row.right)}" if row.right is not None else ""
            )
            words = f"  # {row.words}" if row.right is not None and row.words else f"  {row.words}"
            lines.append(f"  {formula}{words}".rstrip())
    return "\n".join(lines)


def _latex_of(system: System) -> Callable[[Expr | str | Rate], str]:
    groups = (system.states, system.parameters, system.inputs)
    quantities = [q for group in groups for q in group]
    quantities += [d.quantity for d in (*system.definitions, *system.outputs, *system.invariants)]
    names = {q.symbol: q.latex for q in quantities if q.latex}

    def side(value: Expr | str | Rate) -> str:
        if isinstance(value, Rate):
            state = names.get(value.state.symbol, sp.latex(value.state.symbol))
            return f"\\frac{{\\mathrm{{d}}}}{{\\mathrm{{d}}t}} {state}"
        return (
            f"\\text{{{value}}}"
            if isinstance(value, str)
            else str(sp.latex(value, symbol_names=names))
        )

    return side


def latex(system: System) -> str:
    """Return a system as LaTeX: a heading and an aligned display a section (package amsmath)."""
    side = _latex_of(system)
    lines = [f"\\section*{{{_escape(system.title or system.name)}}}"]
    for section in sections(system):
        lines += [f"\\subsection*{{{_escape(section.heading)}}}"]
        if all(r.right is None for r in section.rows):
            lines += [
                "\\begin{itemize}",
                *(f"\\item {_item(r, side)}" for r in section.rows),
                "\\end{itemize}",
            ]
        else:
            rows = [f"{side(r.left)} &= {side(r.right)}" for r in section.rows]
            lines += ["\\begin{align*}", " \\\\\n".join(rows), "\\end{align*}"]
    return "\n".join(lines)


def _item(row: Row, side: Callable[[Expr | str | Rate], str]) -> str:
    name = _escape(row.left) if isinstance(row.left, str) else f"${side(row.left)}$"
    return f"{name}: {_escape(row.words)}" if row.words else name


_ESCAPES = {c: f"\\{c}" for c in "{}$&#%_"} | {
    "\\": "\\textbackslash{}",
    "^": "\\^{}",
    "~": "\\~{}",
}


def _escape(words: str) -> str:
    return "".join(_ESCAPES.get(c, c) for c in words)


def markdown(system: System) -> str:
    """Return a system as Markdown with formulas between dollar signs."""
    side = _latex_of(system)
    lines = [f"# {system.title or system.name}"]
    for section in sections(system):
        lines += ["", f"## {section.heading}", ""]
        for row in section.rows:
            if row.right is None:
                name = f"`{row.left}`" if isinstance(row.left, str) else f"${side(row.left)}$"
                lines.append(f"- {name}: {row.words}" if row.words else f"- {name}")
            else:
                words = [f"{row.words}:", ""] if row.words else []
                lines += [*words, f"$${side(row.left)} = {side(row.right)}$$", ""]
    return "\n".join(lines).rstrip() + "\n"


FORMATS: dict[str, Callable[[System], str]] = {"text": text, "latex": latex, "markdown": markdown}


def show(system: System, style: str = "text") -> str:
    """Return a system in one of `FORMATS`. Raises `InputError` for other formats."""
    if style not in FORMATS:
        raise unknown_name("format", style, FORMATS)
    return FORMATS[style](system)
