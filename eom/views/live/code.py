"""The scripts of a live page that need no document: data, right-hand sides, integrator."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib import resources
from typing import Any

from codegen.frontend.layout import Layout
from codegen.ir.groups import RATES
from codegen.ir.passes import prune
from codegen.ir.program import Program
from codegen.loops import javascript as integrators
from codegen.loops.tableaux import DOP853
from codegen.passes.pipeline import specialised
from codegen.targets import javascript
from codegen.targets.javascript import JAVASCRIPT
from codegen.targets.target import refuse_unsupported
from eom.views.live.subject import Choice, Subject, Variant

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
