"""The page itself: one file of HTML that asks for nothing, from a subject and its scripts.

Scripts and style are allowed by their hashes alone, so that nothing else on the page can run. What the
scene brings along (titles, names, meanings) is escaped here, or set as text by the script.

The scripts of a live page that need no document: data, right-hand sides, integrator.
"""

from __future__ import annotations

import html
import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from importlib import resources
from typing import Any

from codegen.frontend.layout import Layout
from codegen.ir.passes import prune
from codegen.ir.program import RATES, Program
from codegen.loops import javascript as integrators
from codegen.loops.tableaux import DOP853
from codegen.passes.pipeline import specialised
from codegen.targets import javascript
from codegen.targets.javascript import JAVASCRIPT
from codegen.targets.target import refuse_unsupported
from eom.errors import InputError
from eom.multibody.files.scene import TreeScene
from eom.opening import AnyScene
from eom.quantities import Definition
from eom.typeset.boxes import symbol
from eom.typeset.markup import render
from eom.typeset.policy import hashed, policy
from eom.views.live import equations, single, trees
from eom.views.live.subject import Choice, Knob, Subject, Switch, Variant

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
    "omega": "ω, angular velocity",
    "H": "H, angular momentum",
    "torque": "τ, torque",
    "trails": "trail",
    "body frames": "axes of the body",
    "space frame": "axes of space",
}
"""What can be hidden, by the names of the viewer."""


def page(scene: AnyScene) -> str:
    """Return the live page of ``scene``, one file of HTML; the same scene gives the same bytes.

    Numbers on it are in SI units, the angles of a body's attitude at the start in degrees. Raises
    `InputError` for scenes that a page cannot hold: constraints, motion backwards in time, and operations
    that JavaScript has none for.

    >>> import eom
    >>> made = page(eom.load_scene("t-handle"))
    >>> made[:15], "<title>Tumbling T-handle" in made
    ('<!DOCTYPE html>', True)
    """
    return written(subject_of(scene), speed_of(scene.integration.t_end))


def written(subject: Subject, speed: float = 1.0) -> str:
    """Return the page of a subject; ``speed``: seconds of motion a second. Raises as `page` does."""
    core, data = script(subject)
    texts = _Templates()
    data |= {
        "told": {key(c): told(subject, c, texts) for c in subject.variants},
        "none": key(tuple(False for _ in subject.switches)),
        "meanings": {d.name: d.quantity.description for d in _invariants(subject)},
        "speed": speed,
    }
    scripts = [web("three.js"), web("viewer.js"), core, web("live.js")]
    style = web("live.css")
    return web("live.html").format(
        policy=policy(scripts, hashed(style), "data: blob:"),
        style=style,
        title=html.escape(subject.title),
        words="\n".join(
            f"<p>{html.escape(w)}</p>" for w in (subject.description, *subject.notes) if w
        ),
        picture=html.escape(f"{subject.title}: the motion in three dimensions"),
        caption=_caption(subject),
        speeds=_speeds(speed),
        tolerance=f"{TOLERANCE:.0e}".replace("e-", "e\u2212"),
        switches=_switches(subject.switches),
        knobs="\n".join(_groups(subject)),
        shown=_shown(subject),
        notation="" if subject.kind == "tree" else _notation(),
        with_attitude="" if subject.kind == "tree" else "attitude included, ",
        templates="\n".join([*texts.elements(), *_symbols(subject)]),
        data=as_json(data),
        scripts="\n".join(f"<script>{s}</script>" for s in scripts),
    )


def subject_of(scene: AnyScene) -> Subject:
    """Return what a page about a scene needs. Raises `InputError` where there is no page."""
    if scene.integration.t_end < 0:
        raise InputError(
            "a live page runs forward in time", where=scene.name, got=scene.integration.t_end
        )
    return trees.subject(scene) if isinstance(scene, TreeScene) else single.subject(scene)


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


def told(subject: Subject, choice: Choice, texts: _Templates) -> dict[str, Any]:
    """Return what the page says of a choice: equations by notation, operations, what is left out."""
    variant = subject.variants[choice]
    statements: Mapping[str, str] = {"": ""}
    if subject.kind != "tree":
        statements = {n: equations.statements(subject, variant, n) for n in equations.notations()}
    return {
        "statements": {n: texts.name(text) for n, text in statements.items()},
        "components": texts.name(equations.components(variant.own)),
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


def _caption(subject: Subject) -> str:
    if subject.kind == "tree":
        return (
            "Boxes and cylinders have the mass and the moments of inertia of the bodies; the line is the "
            "path of the last one."
        )
    shapes = {
        "spinner": "A wheel about b2; its proportions are those of a picture.",
        "body": "A solid with the moments of inertia of the body.",
    }
    shape = "A picture of a top, its point fixed." if subject.centre else shapes[subject.kind]
    axis = 2 if subject.kind == "spinner" else 3
    return (
        f"{shape} Arrows: ω, H and the torque τ, each against its largest value so far; the line is the "
        f"path of b{axis}."
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
    single_body = subject.kind != "tree"
    return "\n".join(
        f'<label class="check"><input type="checkbox" data-show="{name}"'
        f"{' checked' * (single_body or name != 'body frames')}> {words}</label>"
        for name, words in SHOWN.items()
        if single_body or name not in {"omega", "H", "torque"}
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
        for name, title in equations.notations().items()
    )
    return f'<p><label>Notation <select id="notation">{options}</select></label></p>'


TOLERANCE = 1e-12
"""Relative, of every step. A frame of one body then takes 10 to 20 right-hand sides at DOP853's order."""


@dataclass(frozen=True)
class Compiled:
    """What a variant is compiled to, once for equal ones: its number, operations of its rates."""

    system: int
    operations: int


def script(subject: Subject) -> tuple[str, dict[str, Any]]:
    """Return the script that defines ``EOM_SYSTEMS``, ``EOM_METHOD`` and ``createMotion``, and the data.

    Raises `InputError` for operations that JavaScript cannot compute.
    """
    texts: dict[str, int] = {}
    compiled = {choice: _compiled(v, texts) for choice, v in subject.variants.items()}
    systems = ",\n".join(texts)
    method = re.sub(r"^export ", "", integrators.text(DOP853), flags=re.MULTILINE)
    parts = [
        f"const EOM_METHOD = (() => {{\n{method}\nreturn {DOP853.name};\n}})();",
        f"const EOM_SYSTEMS = [\n{systems}\n];",
        web("live_core.js"),
    ]
    return "\n".join(parts), _data(subject, compiled)


def _compiled(variant: Variant, texts: dict[str, int]) -> Compiled:
    program, layout = specialised(variant.drawn)
    refuse_unsupported(JAVASCRIPT, program, layout)
    number = texts.setdefault(_text(program, layout), len(texts))
    return Compiled(number, sum(prune(program, [RATES]).counts().values()))


def _text(program: Program, layout: Layout) -> str:
    """Return the functions of a system; nothing in a comment can end the script that they stand in."""
    return re.sub(r"<(?=[A-Za-z/!?])", "< ", javascript.function(program, layout))


def _data(subject: Subject, compiled: Mapping[Choice, Compiled]) -> dict[str, Any]:
    """Return what the page's scripts are told, as JSON can hold it."""
    return {
        "kind": subject.kind,
        "name": subject.name,
        "tolerance": TOLERANCE,
        "knobs": [asdict(k) for k in subject.knobs],
        "switches": [asdict(s) for s in subject.switches],
        "fixed": dict(subject.fixed),
        "sequence": subject.sequence,
        "inertia": subject.inertia,
        "centre": subject.centre,
        "bodies": subject.bodies,
        "joints": subject.joints,
        "up": list(subject.up),
        "variants": {
            key(choice): {
                "system": compiled[choice].system,
                "operations": compiled[choice].operations,
                "equal": dict(v.equal),
                "free": v.free,
                "singular": [s.meaning for s in v.drawn.singularities],
            }
            for choice, v in subject.variants.items()
        },
    }


def key(choice: Choice) -> str:
    """Return a choice as scripts name it.

    >>> key((True, False))
    '10'
    """
    return "".join("01"[on] for on in choice)


def as_json(data: object) -> str:
    """Return data as JSON that cannot end the element of a page that it stands in."""
    return json.dumps(data).replace("<", "\\u003c")


def web(name: str) -> str:
    """Return a file of `eom/views/web`."""
    return resources.files("eom.views").joinpath("web", name).read_text(encoding="utf-8")
