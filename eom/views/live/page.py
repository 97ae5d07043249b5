"""The page itself: one file of HTML that asks for nothing, from a subject and its scripts.

What the scene brings along (titles, names, meanings) is escaped here, or set as text by the script. Some
scripts need no document: data, right-hand sides, integrator. The equations of a choice are HTML: the
statement of vector mechanics in a notation, and components.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from typing import Any

from codegen.frontend.layout import Layout
from codegen.ir.passes import prune
from codegen.ir.program import INVARIANTS, RATES, Program
from codegen.loops import javascript as integrators
from codegen.loops import projection
from codegen.loops.tableaux import DOP853
from codegen.passes.pipeline import specialised
from codegen.targets import javascript
from codegen.targets.javascript import JAVASCRIPT
from codegen.targets.target import refuse_unsupported
from eom.errors import InputError
from eom.multibody.system.vectors import VectorOf
from eom.opening import AnyScene
from eom.quantities import Definition, Sampling
from eom.system import System
from eom.terms.terms import Equation
from eom.typeset import printing
from eom.typeset.blocks import Block, Display, Heading, Line
from eom.typeset.boxes import row, symbol
from eom.typeset.letters import Notation
from eom.typeset.markup import render
from eom.typeset.notation import NOTATIONS, equation_parts
from eom.typeset.pages import html_body
from eom.views.animation import acting
from eom.views.animation.acting import STYLES
from eom.views.draw import pages
from eom.views.draw.formulas import as_html, as_runs
from eom.views.draw.pages import web
from eom.views.live.scenes import subject_of
from eom.views.live.subject import ALL, Choice, Knob, Subject, Switch, Variant

SPEEDS = (0.1, 0.25, 0.5, 1, 2, 4, 10)
LONG = 120.0
"""Motions that take longer (s) are shown faster."""
GROUPS = {
    "inertia": "Moments of inertia",
    "parameters": "Parameters",
    "torque": "Torque",
    "start": "Start",
}
SHOWN = {
    **{
        name: STYLES[kind].words
        for name, kind in (("omega", "omega"), ("H", "momentum"), ("torque", "torque"))
    },
    **{f"{ALL}{kind}": style.words for kind, style in STYLES.items()},
    "trails": "trail",
    "body frames": "axes of the body",
    "space frame": "axes of space",
    "camera": "camera follows the body that floats",
}
"""What can be hidden, by the names of the viewer."""


def page(scene: AnyScene) -> str:
    """Return the live page of ``scene``, one file of HTML; the same scene gives the same bytes.

    Parameters
    ----------
    scene : Scene or TreeScene
        Of any model. Numbers are in SI units, the angles of a body's attitude at the start in
        degrees.

    Returns
    -------
    str
        One file of HTML; the same scene gives the same bytes.

    Raises
    ------
    InputError
        For scenes that a page cannot hold: motion backwards in time, and operations that JavaScript
        has none for.

    Notes
    -----
    Under constraints start values are made consistent on the page, and states brought back after
    each step. Laws of control run on it.

    Examples
    --------
    >>> import eom
    >>> made = page(eom.load_scene("t-handle"))
    >>> made[:15], "<title>Tumbling T-handle" in made
    ('<!DOCTYPE html>', True)
    """
    end = scene.integration.t_end
    if end < 0:
        raise InputError("a live page runs forward in time", where=scene.name, got=end)
    return written(subject_of(scene), speed_of(end))


def written(subject: Subject, speed: float = 1.0) -> str:
    """Return the page of a subject; ``speed``: seconds of motion a second. Raises as `page` does."""
    core, data = script(subject)
    texts = _Templates()
    data |= {
        "equations": {key(c): equations_of(subject, c, texts) for c in subject.variants},
        "none": key(tuple(False for _ in subject.switches)),
        "meanings": {d.name: d.quantity.description for d in _invariants(subject)},
        "speed": speed,
    }
    scripts = [web("three.js"), web("words.js"), web("viewer.js"), core, web("live.js")]
    lawful = bool(subject.variants[subject.choice].law)
    parts = {
        "title": html.escape(subject.title),
        "words": "\n".join(
            f"<p>{w}</p>"
            for w in (html.escape(subject.description), *map(as_html, subject.notes))
            if w
        ),
        "picture": html.escape(f"{subject.title}: the motion in three dimensions"),
        "caption": subject.caption,
        "speeds": _speeds(speed),
        "tolerance": f"{TOLERANCE:.0e}".replace("e-", "e\u2212"),
        "switches": _switches(subject.switches),
        "knobs": "\n".join(_groups(subject)),
        "shown": _shown(subject),
        "notation": _notation() if lawful else "",
        "with_attitude": "attitude included, " if lawful else "",
        "templates": "\n".join([*texts.elements(), *_symbols(subject)]),
    }
    return pages.page("live", parts, data, scripts, "data: blob:")


def speed_of(t_end: float) -> float:
    """Return seconds of motion a second of the page: one, but for long motions a minute for all.

    >>> speed_of(10.0), speed_of(55603.4)
    (1.0, 900.0)
    """
    return 1.0 if t_end <= LONG else float(f"{t_end / 60:.0e}") + 0.0


class _Templates:
    """Texts of equations as elements that the script copies in, each once."""

    def __init__(self) -> None:
        self.names: dict[str, str] = {}

    def name(self, text: str) -> str:
        """Return the id of a text, or nothing for no text."""
        return self.names.setdefault(text, f"equations-{len(self.names)}") if text else ""

    def elements(self) -> list[str]:
        return [f'<template id="{name}">{text}</template>' for text, name in self.names.items()]


def equations_of(subject: Subject, choice: Choice, texts: _Templates) -> dict[str, Any]:
    """Return what the page says of a choice: equations by notation, operations, what is left out."""
    variant = subject.variants[choice]
    laws = {n: statements(variant, n) for n in notations() if variant.law} or {"": ""}
    return {
        "statements": {n: texts.name(text) for n, text in laws.items()},
        "components": texts.name(components(variant.own)),
        "left_out": list(variant.left_out),
        "general": variant.general,
        "after": variant.after,
    }


# -- controls -----------------------------------------------------------------------------------------


def _speeds(base: float) -> str:
    return "".join(
        f'<option value="{factor}"{" selected" * (factor == 1)}>{factor * base:g} s a second</option>'
        for factor in SPEEDS
    )


def _switches(switches: tuple[Switch, ...]) -> str:
    if not switches:
        return ""
    rows = "\n".join(
        f'<label class="check"><input type="checkbox" data-switch="{k}"{" checked" * s.on}> '
        f"{html.escape(s.words)}</label>"
        for k, s in enumerate(switches)
    )
    hint = (
        '<p class="hint">The equations change with it; numbers that no longer occur are grey.</p>'
    )
    return f"<fieldset><legend>Leave out</legend>\n{rows}\n{hint}\n</fieldset>"


def _shown(subject: Subject) -> str:
    return "\n".join(
        f'<label class="check"><input type="checkbox" data-show="{name}"{" checked" * on}> '
        f"{as_html(SHOWN[name])}</label>"
        for name, on in subject.shown.items()
    )


def _groups(subject: Subject) -> Iterator[str]:
    for group, title in GROUPS.items():
        rows = "\n".join(_knob(k) for k in subject.knobs if k.group == group)
        if rows:
            yield f"<fieldset><legend>{title}</legend>\n{rows}\n</fieldset>"


def _knob(knob: Knob) -> str:
    name, meaning = html.escape(knob.name), html.escape(knob.meaning)
    unit = html.escape({"deg": "°", "1": ""}.get(knob.unit, knob.unit.replace("^2", "²")))
    return (
        f'<div class="knob"><label for="knob-{name}">{_math(knob.name)} '
        f'<span class="words">{meaning}</span></label>'
        f'<input type="range" id="knob-{name}" data-knob="{name}" min="{knob.low!r}" max="{knob.high!r}" '
        f'step="any" value="{knob.value!r}">'
        f'<input type="number" data-knob="{name}" step="any" value="{knob.value!r}" '
        f'aria-label="{name}, {meaning}{f", in {unit}" if unit else ""}">'
        f'<span class="unit">{unit}</span></div>'
    )


def _math(name: str) -> str:
    if name.startswith("attitude_"):
        return ""
    return f"<math>{render(symbol(name), 'mathml')}</math>"


def _symbols(subject: Subject) -> Iterator[str]:
    """Yield the names of the constants of the motion as formulas."""
    names = dict.fromkeys(d.name for d in _invariants(subject))
    yield from (f'<template id="symbol-{html.escape(n)}">{_math(n)}</template>' for n in names)


def _invariants(subject: Subject) -> Iterator[Definition]:
    return (d for v in subject.variants.values() for d in v.drawn.invariants)


def _notation() -> str:
    options = "".join(
        f'<option value="{name}">{html.escape(title)}</option>'
        for name, title in notations().items()
    )
    return f'<p><label>Notation <select id="notation">{options}</select></label></p>'


TOLERANCE = 1e-12
"""Relative, of every step. A frame of one body then takes 10 to 20 right-hand sides at DOP853's order."""


@dataclass(frozen=True)
class Compiled:
    """What a variant is compiled to, once for equal ones: its number, operations of its rates.

    ``held``: the invariants that its constraints keep at zero, each with its words, its unit and whether it
    is one of speeds.
    """

    system: int
    operations: int
    held: tuple[Mapping[str, Any], ...]


def script(subject: Subject) -> tuple[str, dict[str, Any]]:
    """Return the script that defines ``EOM_SYSTEMS``, ``EOM_METHOD`` and ``createMotion``, and the data.

    Raises `InputError` for operations that JavaScript cannot compute.
    """
    texts: dict[str, int] = {}
    compiled = {choice: _compiled(subject, v, texts) for choice, v in subject.variants.items()}
    systems = ",\n".join(texts)
    method = re.sub(r"^export ", "", integrators.text(DOP853), flags=re.MULTILINE)
    parts = [
        f"const EOM_METHOD = (() => {{\n{method}\nreturn {DOP853.name};\n}})();",
        f"const EOM_SYSTEMS = [\n{systems}\n];",
        web("live_start.js"),
        web("live_samples.js"),
        web("live_core.js"),
    ]
    return "\n".join(parts), _data(subject, compiled)


def _compiled(subject: Subject, variant: Variant, texts: dict[str, int]) -> Compiled:
    program, layout = specialised(variant.drawn)
    operations = sum(prune(program, [RATES]).counts().values())
    kept = variant.drawn.maintained
    if kept:
        program, layout = projection.extended(program, layout, kept)
    refuse_unsupported(JAVASCRIPT, program, layout)
    number = texts.setdefault(_text(program, layout), len(texts))
    return Compiled(number, operations, tuple(_held(subject, kept, layout)))


def _held(subject: Subject, kept: Sequence[str], layout: Layout) -> Iterator[Mapping[str, Any]]:
    """Yield what constraints keep at zero; it is one of speeds if it depends on one."""
    names = [q.name for q in layout.states]
    pattern = layout.patterns.get(projection.GROUP, ())
    of_speeds = {row for row, column in pattern if names[column] in subject.speeds}
    meanings = {q.name: q.meaning for q in layout.described[INVARIANTS]}
    for k, name in enumerate(kept):
        words = meanings[name].removeprefix("what is left of ")
        yield {"name": name, "words": words, "speeds": k in of_speeds}


def _text(program: Program, layout: Layout) -> str:
    """Return the functions of a system; nothing in a comment can end the script that they stand in."""
    return re.sub(r"<(?=[A-Za-z/!?])", "< ", javascript.function(program, layout))


def _data(subject: Subject, compiled: Mapping[Choice, Compiled]) -> dict[str, Any]:
    """Return what the page's scripts are given, as JSON can hold it."""
    return {
        "kind": subject.kind,
        "name": subject.name,
        "tolerance": TOLERANCE,
        "knobs": [asdict(k) for k in subject.knobs],
        "switches": [asdict(s) for s in subject.switches],
        "attitudes": [asdict(a) for a in subject.attitudes],
        "inertia": subject.inertia,
        "centre": subject.centre,
        "bodies": subject.bodies,
        "joints": subject.joints,
        "fittings": list(_fittings(subject)),
        "speeds": subject.speeds,
        "keep": subject.keep,
        "follow": subject.follow,
        "up": list(subject.up),
        "arrows": 12 * len(subject.bodies)
        + sum(10 + 3 * count for count in subject.joints)
        + sum(len(f.values) for f in subject.fittings),
        "variants": {
            key(choice): {
                "system": compiled[choice].system,
                "operations": compiled[choice].operations,
                "equal": dict(v.equal),
                "free": v.free,
                "held": compiled[choice].held,
                "vectors": [_vector(one) for one in v.vectors],
                "sampled": [_sampled(s) for s in v.drawn.sampled],
                "singular": [s.meaning for s in v.drawn.singularities],
            }
            for choice, v in subject.variants.items()
        },
    }


def _vector(one: VectorOf) -> dict[str, Any]:
    """Return how a vector is drawn; where its values are among the outputs, its number says."""
    kind, style = acting.group(one), STYLES[acting.group(one)]
    told = {"text": as_runs(acting.label(one)), "words": acting.words(one)}
    return {"layer": f"{ALL}{kind}", "unit": style.unit, "colour": style.colour, **told}


def _sampled(law: Sampling) -> dict[str, Any]:
    """Return when a law is sampled, and what it sets."""
    names = {"inputs": law.laws, "states": law.states}
    found = {key: [d.name for d in rows] for key, rows in names.items()}
    return {"period": law.period, "delay": law.delay, **found}


def _fittings(subject: Subject) -> Iterator[dict[str, Any]]:
    """Yield what is drawn on bodies, with the place of its values among the outputs of any choice."""
    place = 12 * len(subject.bodies) + sum(10 + 3 * count for count in subject.joints)
    for f in subject.fittings:
        yield {
            "kind": f.kind,
            "name": f.name,
            "bodies": f.bodies,
            "at": place,
            "size": len(f.values),
        }
        place += len(f.values)


def key(choice: Choice) -> str:
    """Return a choice as scripts name it.

    >>> key((True, False))
    '10'
    """
    return "".join("01"[on] for on in choice)


# -- equations ----------------------------------------------------------------------------------------

SECTIONS = ("Definitions", "Equations of motion", "Constants of the motion", "Singular where")
"""What is shown of a system's page, by how the headings begin."""
MOST_LINES = 64
"""Systems with more definitions are counted and not shown."""
MOST_OPEN = 12
"""Sections of more lines are closed at first."""


def notations() -> dict[str, str]:
    """Return the titles of the notations by name."""
    return {name: notation.title for name, notation in NOTATIONS.items()}


def statements(variant: Variant, notation: str) -> str:
    """Return the law of motion of a choice as HTML, in a notation; empty where none is stated."""
    written = NOTATIONS[notation]
    lines = tuple(_line(e, written, words) for e, words in variant.law)
    return html_body([Display(lines)]) if lines else ""


def _line(equation: Equation, notation: Notation, words: str) -> Line:
    left, relation, right = equation_parts(equation, notation)
    return Line(row(*left), relation, right, words, broken_left=left)


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
        return html_body([heading, block])
    words = f"{count} {heading.words.lower()}"
    return f"<details><summary>{words}</summary>{html_body([block])}</details>"
