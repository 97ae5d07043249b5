"""The page itself: one file of HTML that asks for nothing, from a subject and its scripts.

Scripts and style are allowed by their hashes alone, so that nothing else on the page can run. What the
scene brings along (titles, names, meanings) is escaped here, or set as text by the script.
"""

from __future__ import annotations

import base64
import hashlib
import html
from collections.abc import Iterator, Mapping
from typing import Any

from eom.boxes import symbol
from eom.errors import InputError
from eom.markup import render
from eom.multibody.scene import TreeScene
from eom.opening import AnyScene
from eom.views.live import code, equations, single, trees
from eom.views.live.subject import Choice, Knob, Subject, Switch

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

DOCUMENT = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<title>{title}</title>
<style>{style}</style>
</head>
<body>
<a class="skip" href="#controls">Skip to the numbers</a>
<header>
<h1>{title}</h1>
{words}
</header>
<main>
<section class="stage" aria-label="Motion">
<div class="pictures">
<figure><canvas id="body" tabindex="0" role="img" aria-label="{picture}. Arrow keys turn it, plus and minus come nearer and go away."></canvas>
<figcaption>{caption}</figcaption></figure>
<figure id="poinsot-figure" hidden><canvas id="poinsot" tabindex="0" role="img" aria-label="Poinsot's construction: the energy ellipsoid rolls on the invariable plane. Arrow keys turn it."></canvas>
<figcaption>Poinsot: the energy ellipsoid rolls on the invariable plane without slip, its centre fixed. <span class="ink-red">Polhode</span> on the ellipsoid, <span class="ink-blue">herpolhode</span> on the plane; H points down here.</figcaption></figure>
</div>
<div class="bar">
<button type="button" id="play">Pause</button>
<button type="button" id="reset">Restart</button>
<label>Speed <select id="speed">{speeds}</select></label>
<output id="time" aria-label="Time">0 s</output>
<span id="work"></span>
</div>
<p class="note" id="note" role="status"></p>
<div class="below">
<section class="card" aria-labelledby="drift-title"><h2 id="drift-title">Constants of the motion</h2>
<p class="hint" id="no-invariants">With these forces none is known.</p>
<table id="invariants-table"><thead><tr><th scope="col">constant</th><th scope="col">now</th><th scope="col">relative drift</th></tr></thead><tbody id="invariants"></tbody></table>
<details><summary>States</summary><pre id="states" tabindex="0" aria-label="Values of the states"></pre></details>
</section>
<figure class="card"><canvas id="drift" role="img" aria-label="Relative drift of the constants over time, on a logarithmic scale; the numbers are in the table."></canvas><figcaption>Relative drift since the start, at the tolerance {tolerance} of the steps.</figcaption></figure>
</div>
</section>
<section class="controls" id="controls" tabindex="-1" aria-label="Numbers">
<p id="fault" role="alert"></p>
{switches}
{knobs}
<fieldset><legend>Shown</legend>
{shown}
</fieldset>
<button type="button" id="original">Numbers of the scene</button>
</section>
<section class="equations card" aria-labelledby="equations-title"><h2 id="equations-title">Equations</h2>
<div class="halves">
<div>
{notation}
<div class="scroll" id="statements" tabindex="0" role="group" aria-label="Law of motion"></div>
<h3>What is left out</h3>
<div class="saved"><div class="track"><div id="bar"></div></div><span><strong id="operations">0</strong> of <strong id="general">0</strong> operations</span></div>
<p class="hint">Operations of the right-hand side as it is derived, and with nothing left out. The page's own, as generated, {with_attitude}has <strong id="generated">0</strong>.</p>
<ul id="left-out"></ul>
<p class="hint" id="nothing">Nothing.</p>
</div>
<div class="scroll" id="components" tabindex="0" role="group" aria-label="Equations in components"></div>
</div>
</section>
</main>
{templates}
<script type="application/json" id="scene">{data}</script>
{scripts}
</body>
</html>
"""


def page(scene: AnyScene) -> str:
    """Return the live page of a scene; the same scene gives the same bytes.

    Raises `InputError` for scenes that a page cannot hold: constraints, and operations that JavaScript
    has none for.
    """
    subject = subject_of(scene)
    core, data = code.script(subject)
    texts = _Templates()
    data |= {
        "told": {code.key(c): told(subject, c, texts) for c in subject.variants},
        "none": code.key(tuple(False for _ in subject.switches)),
        "speed": speed_of(scene.integration.t_end),
    }
    scripts = [code.web("three.js"), code.web("viewer.js"), core, code.web("live.js")]
    style = code.web("live.css")
    return DOCUMENT.format(
        policy=_policy(scripts, style),
        style=style,
        title=html.escape(subject.title),
        words="\n".join(f"<p>{html.escape(w)}</p>" for w in (subject.description, *subject.notes) if w),
        picture=html.escape(f"{subject.title}: the motion in three dimensions"),
        caption=_caption(subject),
        speeds=_speeds(data["speed"]),
        tolerance=f"{code.TOLERANCE:.0e}".replace("e-", "e\u2212"),
        switches=_switches(subject.switches),
        knobs="\n".join(_groups(subject)),
        shown=_shown(subject),
        notation="" if subject.kind == "tree" else _notation(),
        with_attitude="" if subject.kind == "tree" else "attitude included, ",
        templates="\n".join([*texts.elements(), *_symbols(subject)]),
        data=code.as_json(data),
        scripts="\n".join(f"<script>{s}</script>" for s in scripts),
    )


def subject_of(scene: AnyScene) -> Subject:
    """Return what a page about a scene needs. Raises `InputError` where there is no page."""
    if scene.integration.t_end < 0:
        raise InputError("a live page runs forward in time", where=scene.name, got=scene.integration.t_end)
    return trees.subject(scene) if isinstance(scene, TreeScene) else single.subject(scene)


def _policy(scripts: list[str], style: str) -> str:
    def digest(text: str) -> str:
        made = hashlib.sha256(text.encode()).digest()
        return f"'sha256-{base64.b64encode(made).decode()}'"

    return (
        f"default-src 'none'; script-src {' '.join(map(digest, scripts))}; style-src {digest(style)}; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )


def speed_of(t_end: float) -> float:
    """Return seconds of motion a second of the page: one, but for long motions a minute for all.

    >>> speed_of(10.0), speed_of(55603.4)
    (1.0, 1000.0)
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
        return "Boxes and cylinders have the mass and the moments of inertia of the bodies; the line is the path of the last one."
    shapes = {
        "spinner": "A wheel about b2; its proportions are those of a picture.",
        "body": "A solid with the moments of inertia of the body.",
    }
    shape = "A picture of a top, its point fixed." if subject.centre else shapes[subject.kind]
    axis = 2 if subject.kind == "spinner" else 3
    return f"{shape} Arrows: ω, H and the torque τ, each as long as its largest value so far allows; the line is the path of b{axis}."


def _switches(switches: tuple[Switch, ...]) -> str:
    if not switches:
        return ""
    rows = "\n".join(
        f'<label class="check"><input type="checkbox" data-switch="{k}"{" checked" * s.on}> '
        f"{html.escape(s.words)}</label>"
        for k, s in enumerate(switches)
    )
    return f"<fieldset><legend>Leave out</legend>\n{rows}\n</fieldset>"


def _shown(subject: Subject) -> str:
    single_body = subject.kind != "tree"
    return "\n".join(
        f'<label class="check"><input type="checkbox" data-show="{name}"'
        f'{" checked" * (single_body or name != "body frames")}> {words}</label>'
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
    names = dict.fromkeys(n for v in subject.variants.values() for n in v.drawn.invariant_names)
    yield from (f'<template id="symbol-{html.escape(n)}">{_math(n)}</template>' for n in names)


def _notation() -> str:
    options = "".join(
        f'<option value="{name}">{html.escape(title)}</option>'
        for name, title in equations.notations().items()
    )
    return f'<p><label>Notation <select id="notation">{options}</select></label></p>'
