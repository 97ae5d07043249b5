"""A system as text, LaTeX or Markdown: variables, equations, constants, singularities, assumptions.

`blocks` lists what there is to print, in reading order; `eom.typeset.pages` writes it in each format.
Where an output or a constant of the motion holds the right side of a definition, its name is printed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.errors import typed, unknown_name
from eom.quantities import Definition, Quantity, Sampling
from eom.system import System
from eom.typeset import pages
from eom.typeset.blocks import EQUALS, Block, Bullets, Display, Heading, Line
from eom.typeset.boxes import Box, Formula, Fraction, Operator, Row, Symbol, Words
from eom.typeset.markup import symbol_latex
from eom.typeset.sentences import Prose
from eom.typeset.writing import expression_pieces, in_decimals

__all__ = ["FORMATS", "blocks", "latex", "markdown", "show", "symbol_latex", "text"]

Expr = Any
Names = Mapping[Expr, str | Box]
Worded = Callable[[str], Prose]
"""What sets the letters in words."""

_OWN_LATEX = re.compile(r"[A-Za-z](_([A-Za-z0-9]|\{\w+\}))?|.*\\.*")
"""A letter with an index, or commands; words that came as LaTeX would be set as products."""


def blocks(
    system: System,
    *,
    primes: bool = False,
    letters: Names | None = None,
    worded: Worded = str,
    codes: bool = True,
) -> list[Block]:
    """Return what there is to print; empty sections are left out. ``primes``: write x' for dx/dt.

    ``letters``: what quantities are called on a page that has letters of its own, ``worded``: what sets
    them in words; ``codes``: whether assumptions stand beside the names by which programs know them.
    """
    system = _as_decimals(system) if system.numbers == "decimals" else system
    shown = _blocks(system, {**_own_names(system), **(letters or {})}, primes, codes)
    return [_said(block, worded) for block in shown]


def _said(block: Block, worded: Worded) -> Block:
    """Return a list or display with the letters in its words set."""
    if isinstance(block, Bullets):
        return Bullets(tuple((n, worded(w) if isinstance(w, str) else w) for n, w in block.items))
    if isinstance(block, Display):
        lines = (
            replace(line, words=worded(line.words)) if isinstance(line.words, str) else line
            for line in block.lines
        )
        return Display(tuple(lines))
    return block


def _blocks(system: System, names: Names, primes: bool, codes: bool) -> list[Block]:
    return [
        *_variables("States", system.states, names),
        *_variables("Parameters", system.parameters, names),
        *_variables("Inputs", system.inputs, names),
        *_section("Definitions", _definitions(system.definitions, names)),
        *_section(*_equations(system, names, primes)),
        *(block for s in system.sampled for block in _section(*_samples(s, names))),
        *_section("Outputs", _definitions(_others(system), names, _named_parts(system))),
        *_section(
            "Constants of the motion",
            _definitions(system.invariants, names, _named_parts(system)),
        ),
        *_section(
            "Singular where",
            [
                _line(Formula(s.expression, names), sp.S.Zero, names, s.meaning)
                for s in system.singularities
            ],
        ),
        *_assumptions(system, codes),
    ]


def _as_decimals(system: System) -> System:
    """Return what is printed of a system with decimal numbers: the rest of it is left out."""
    groups = ("definitions", "outputs", "invariants")
    changed: dict[str, Any] = {
        group: tuple(
            replace(d, expression=in_decimals(d.expression)) for d in getattr(system, group)
        )
        for group in groups
    }
    changed["singularities"] = tuple(
        replace(s, expression=in_decimals(s.expression)) for s in system.singularities
    )
    if system.mass_matrix is not None:
        changed["mass_matrix"] = in_decimals(system.mass_matrix)
    rates = tuple(map(in_decimals, system.rates))
    return replace(system, rates=rates, attitudes=(), angles=(), **changed)


def _own_names(system: System) -> Names:
    """Return the LaTeX names that are others than those of the symbols."""
    names = latex_names(system)
    return {s: latex for s, latex in names.items() if latex != symbol_latex(s.name)}


def latex_names(system: System) -> dict[Expr, str]:
    """Return the letter of each symbol of a system, as LaTeX."""
    groups = (system.states, system.parameters, system.inputs)
    quantities = [q for group in groups for q in group]
    named = (*system.definitions, *system.multipliers, *system.outputs, *system.invariants)
    quantities += [d.quantity for d in named]
    return {
        q.symbol: q.latex if _OWN_LATEX.fullmatch(q.latex) else symbol_latex(q.name)
        for q in quantities
    }


def _variables(heading: str, quantities: Iterable[Quantity], names: Names) -> list[Block]:
    items = tuple((Formula(q.symbol, names), q.description) for q in quantities)
    return [Heading(heading), Bullets(items)] if items else []


def _assumptions(system: System, codes: bool) -> list[Block]:
    items = tuple((a.name if codes else None, a.meaning) for a in system.assumptions)
    return [Heading("Assumptions"), Bullets(items)] if items else []


def _section(heading: str, lines: Iterable[Line]) -> list[Block]:
    kept = tuple(lines)
    return [Heading(heading), Display(kept)] if kept else []


def _line(left: Box, right: Expr, names: Names, words: str = "") -> Line:
    return Line(left, EQUALS, expression_pieces(right, names), words)


def _samples(sampling: Sampling, names: Names) -> tuple[str, list[Line]]:
    """Return heading and lines of laws that are sampled: what each input becomes."""
    late = f"in effect {sampling.delay!r} s later" if sampling.delay else ""
    lines = [
        _line(Formula(d.symbol, names), d.expression, names, words)
        for group, words in ((sampling.laws, late), (sampling.states, ""))
        for d in group
    ]
    heading = (
        f"Held between samples; every {sampling.period!r} s they become, from what is there before"
    )
    return heading, lines


def _others(system: System) -> Iterator[Definition]:
    """Yield the outputs that are told nowhere else: what is held, or defined before, may be one."""
    told = {(d.symbol, d.expression) for d in system.definitions}
    outputs = ((d, (d.symbol, d.expression)) for d in system.outputs)
    return (d for d, said in outputs if d.expression != d.symbol and said not in told)


def _definitions(
    definitions: Iterable[Definition], names: Names, parts: Mapping[Expr, Expr] | None = None
) -> list[Line]:
    return [
        _line(
            Formula(d.symbol, names),
            d.expression.xreplace(parts or {}),
            names,
            d.quantity.description,
        )
        for d in definitions
    ]


def _named_parts(system: System) -> dict[Expr, Expr]:
    """Return the sums that definitions name, with their names."""
    sums = [d for d in system.definitions if isinstance(d.expression, sp.Add)]
    return {d.expression: d.symbol for d in sums}


def _equations(system: System, names: Names, primes: bool) -> tuple[str, list[Line]]:
    """Return heading and lines of the equations of motion, the mass matrix first."""
    lines = [
        _line(_rate(q, names, primes), r, names)
        for q, r in zip(system.states, system.rates, strict=True)
    ]
    if system.mass_matrix is None:
        return "Equations of motion", lines
    coupled, block = _coupled_block(system, system.mass_matrix)
    mass = Line(Words("mass matrix"), EQUALS, (Formula(block, names),))
    lines += [
        _line(Words(f"row of {d.name}"), d.expression, names, d.quantity.description)
        for d in system.multipliers
    ]
    heading = f"Equations of motion; mass matrix times the rates of {coupled} = right sides"
    return heading, [mass, *lines]


def _coupled_block(system: System, matrix: Expr) -> tuple[str, Expr]:
    """Return names and mass matrix of what has rows that differ from those of the identity."""
    n = matrix.rows
    keep = [
        k for k in range(n) if matrix[k, :] != sp.eye(n)[k, :] or matrix[:, k] != sp.eye(n)[:, k]
    ]
    states = ", ".join(q.name for k, q in enumerate(system.states) if k in keep)
    beside = "".join(f", and {d.name}" for d in system.multipliers)
    return f"{states}{beside}", matrix.extract(keep, keep)


def _rate(state: Quantity, names: Names, primes: bool) -> Box:
    """Return the time derivative of a state, as the left side of an equation."""
    name = Formula(state.symbol, names)
    if primes:
        return Row((name, Words("'")))
    d = Operator("d")
    return Row((Fraction(d, Row((d, Symbol("t")))), Operator("times"), name))


def _page(system: System, *, primes: bool = False) -> list[Block]:
    return [Heading(system.title or system.name, 1), *blocks(system, primes=primes)]


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
    return pages.text_page(_page(system, primes=True), "ascii")


def latex(system: System) -> str:
    """Return a system as LaTeX: a heading and an aligned display a section (package amsmath)."""
    return pages.latex_page(_page(system))


def markdown(system: System) -> str:
    """Return a system as Markdown with formulas between dollar signs."""
    return pages.markdown_page(_page(system))


LARGEST = 1500
"""Terms of all equations together up to which a notebook shows them."""


def notebook(system: System, style: str) -> str:
    """Return what a notebook displays of a system: a page in HTML, or the equations of motion in LaTeX.

    ``style``: html or latex. Of a system with very long equations names and meanings alone.
    """
    if not _is_short(system):
        few = [*_page(system)[:1], *_variables("States", system.states, _own_names(system))]
        told = Bullets(
            ((None, "equations too long to show: eom.typeset.printing.show writes them"),)
        )
        return "" if style == "latex" else pages.html_body([*few, told])
    if style == "latex":
        _, lines = _equations(system, _own_names(system), primes=False)
        return f"$${pages.display_latex([(line, '') for line in lines])}$$"
    return pages.html_body(_page(system))


def _is_short(system: System) -> bool:
    """Return whether all expressions together have few terms; that is counted no further."""
    stack: list[Any] = [
        *system.rates,
        *(d.expression for d in (*system.definitions, *system.outputs)),
    ]
    stack += [] if system.mass_matrix is None else list(system.mass_matrix)
    count = 0
    while stack and count <= LARGEST:
        stack += stack.pop().args
        count += 1
    return not stack


FORMATS: dict[str, Callable[[System], str]] = {"text": text, "latex": latex, "markdown": markdown}


@typed
def show(system: System, style: str = "text") -> str:
    """Return a system as a text, its ``style`` one of `FORMATS`: text, latex or markdown.

    Parameters
    ----------
    system : System
        What is shown: quantities with units and meanings, definitions, equations, outputs.
    style : str, default "text"
        One of `FORMATS`: text, latex or markdown.

    Returns
    -------
    str
        The same system gives the same text. Units stand with the quantities.

    Raises
    ------
    InputError
        For other formats.

    Examples
    --------
    >>> from eom.mechanics.rigidbody import free_rigid_body
    >>> print(show(free_rigid_body()).splitlines()[3])
      omega_1  angular velocity about b1 [rad/s]
    """
    if style not in FORMATS:
        raise unknown_name("format", style, FORMATS)
    return FORMATS[style](system)
