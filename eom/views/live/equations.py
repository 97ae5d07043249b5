"""The equations of a choice as HTML: the statement of vector mechanics in a notation, and components."""

from __future__ import annotations

import html
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

from eom.system import System
from eom.terms.terms import VECTOR, Equation, Term, add, cross, der, dot, zero
from eom.terms.vocabulary import omega, quantity
from eom.typeset import pages, printing
from eom.typeset.blocks import Block, Display, Heading, Line
from eom.typeset.boxes import row
from eom.typeset.letters import Notation
from eom.typeset.notation import NOTATIONS, equation_parts
from eom.views.live.subject import Subject, Variant

SECTIONS = ("Definitions", "Equations of motion", "Constants of the motion", "Singular where")
"""What is shown of a system's page, by how the headings begin."""
MOST_LINES = 64
"""Systems with more definitions are counted and not shown."""
MOST_OPEN = 12
"""Sections of more lines are closed at first."""


def notations() -> dict[str, str]:
    """Return the titles of the notations by name."""
    return {name: notation.title for name, notation in NOTATIONS.items()}


def statements(subject: Subject, variant: Variant, notation: str) -> str:
    """Return the law of motion of one body as HTML, in a notation; empty for trees."""
    if subject.kind == "tree":
        return ""
    found = list(_statements(subject, variant))
    written = NOTATIONS[notation]
    lines = tuple(_line(e, written, words) for e, words in found)
    return pages.html_body([Display(lines)])


def _line(equation: Equation, notation: Notation, words: str) -> Line:
    left, relation, right = equation_parts(equation, notation)
    return Line(row(*left), relation, right, words, broken_left=left)


def _statements(subject: Subject, variant: Variant) -> Iterator[tuple[Equation, str]]:
    """Yield the law, the momentum and the equation that follows, with words."""
    about = "O" if subject.centre else "C"
    J = quantity("inertia", about)
    h, torque = (quantity(n, "body", about) for n in ("angular_momentum", "torque"))
    if subject.centre:  # words for the angular momentum about a point, of all mass
        h = quantity("absolute_angular_momentum", "body", about)
    right = zero(VECTOR) if variant.free else torque
    law = "Angular momentum does not change" if variant.free else "Torque changes angular momentum"
    yield Equation(der(h), right), law
    if subject.kind == "spinner":
        yield Equation(h, dot(J, omega("C"))), "Momentum of the body C, which spins in B"
        yield Equation(_seen_from_b(h), right), "The same as seen from B, which does not spin"
        return
    yield Equation(h, dot(J, omega())), "Momentum of a rigid body"
    euler = add(dot(J, der(omega(), "B")), cross(omega(), dot(J, omega())))
    yield Equation(euler, right), "Euler's equation: the same as seen from the body"


def _seen_from_b(h: Term) -> Term:
    return add(der(h, "B"), cross(omega("B"), h))


def components(system: System) -> str:
    """Return the scalar equations of a system as HTML; long ones are counted."""
    if len(system.definitions) > MOST_LINES:
        count = len(system.definitions)
        return (
            f"<p>{count:,} definitions and {len(system.rates)} rates: "
            f"<code>eom derive {html.escape(system.name)}</code> prints them.</p>"
        )
    return "".join(_section(*section) for section in _sections(system))


def _sections(system: System) -> Iterator[tuple[Heading, Block]]:
    """Yield the headings that are shown, a level lower, with what stands under them."""
    blocks = printing.blocks(system)
    for heading, block in pairwise(blocks):
        if isinstance(heading, Heading) and heading.words.startswith(SECTIONS):
            yield replace(heading, level=3), block


def _section(heading: Heading, block: Block) -> str:
    """Return a section; where there are many lines, it is opened on demand."""
    count = len(block.lines) if isinstance(block, Display) else 0
    if count <= MOST_OPEN:
        return pages.html_body([heading, block])
    words = f"{count} {heading.words.lower()}"
    return f"<details><summary>{words}</summary>{pages.html_body([block])}</details>"
