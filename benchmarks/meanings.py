r"""``python -m benchmarks.checking FOLDER --meanings``: meanings that were found, against ``symbols.json``.

``symbols.json`` says in words what each symbol of a note means (``latex``, ``meaning``; ``about`` a point,
``position`` in a sequence of turns). Counted are the symbols of displays, once a note, of which the table
`QUANTITIES_OF` knows what quantity the words name. A meaning is right
if it is one of the quantities of the row, about the same point, the same turn of a sequence; a formula, or
a quantity of the note's system, if it has the dimension and the shape of one. "Sure" are meanings by which
a verdict would not be a question (`eom.checker.infer.evidence`).
"""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eom.checker.infer.evidence import Evidence, evidence, misfit
from eom.checker.infer.sayings import look_of
from eom.checker.infer.shown import operands_of
from eom.checker.judge.judge import HOLDS, UNDER
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.lexicon import Found, Lexicon, meaning
from eom.checker.mean.lexicon_files import lexicon_of
from eom.checker.mean.values import Refusal, Value
from eom.checker.note.checking import Found as Judged
from eom.checker.note.checking import judged_note
from eom.checker.read.grammar import read_formula
from eom.checker.read.symbol_shape import Look
from eom.checker.read.writing import latex_of
from eom.checker.report.findings import Settings
from eom.errors import InputError

QUANTITIES_OF: tuple[tuple[str, tuple[str, ...]], ...] = (
    (r"angular momentum|momentum .*stored", ("angular_momentum", "absolute_angular_momentum")),
    (r"linear momentum", ("linear_momentum",)),
    (r"first moment of mass", ("first_moment",)),
    (r"gravitational parameter", ("gravity_parameter",)),
    (r"(moment|axial inertia|inertia) .*\bwheel'?s?\b.*axis|wheel's moment", ("rotor_inertia",)),
    (r"spin rate of the wheel", ("rotor_speed",)),
    (r"wheel axis", ("rotor_axis",)),
    (r"\binertia\b|off-diagonal|principal moments", ("inertia",)),
    (r"\btorques?\b|moments? of .*forces?", ("torque", "gravity_torque", "rotor_torque")),
    (r"kinetic energy", ("kinetic_energy", "rotational_energy")),
    (r"angular acceleration", ("angular_acceleration",)),
    (r"angular velocity", ("angular_velocity",)),
    (r"acceleration of gravity|gravitational acceleration", ("gravity",)),
    (r"acceleration", ("acceleration",)),
    (r"velocity|speed of", ("velocity",)),
    (r"scalar part of", ("euler_parameter",)),
    (r"vector part of", ("euler_vector",)),
    (r"quaternion", ("quaternion", "quaternion_last")),
    (r"modified Rodrigues", ("modified_rodrigues",)),
    (r"unit axis of the rotation", ("principal_axis",)),
    (r"angle of the rotation", ("principal_angle",)),
    (r"unit (matrix|dyadic)|identity", ("identity_matrix", "identity")),
    (r"frame rotation", ("turn",)),
    (r"components? into|direction cosine matrix", ("rotation",)),
    (
        r"(?:rotation|precession|inclination|spin|nutation).*(?:sequence|axis)",
        ("turn_angle", "angle"),
    ),
    (r"unit vectors? .*(?:frame|fixed|of [A-Z])", ("unit", "vectrix")),
    (r"position|vector from|leads from", ("position", "orbit_position")),
    (r"force", ("external_force", "force", "internal_force")),
    (r"\bmass\b(?! centre| element)", ("total_mass", "mass")),
)
"""Words of a meaning, and the quantities that they may name; the first row that fits."""
SAMPLE = {"angular_acceleration": r"= \dot{\vec Y}"}
"""Meanings that stand for a quantity where its dimension is asked for; Y is an angular velocity."""


@dataclass(frozen=True)
class Count:
    """A symbol of a note: its LaTeX, what truth says, what it was taken for, if that is right, and sure."""

    note: str
    latex: str
    truth: str
    taken: str
    right: bool
    sure: bool


def counted(folder: Path, name: str, path: Path, head: re.Pattern[str]) -> Iterator[Count]:
    """Yield the symbols of the displays of one note, each once, of which the table knows what they are."""
    rows = json.loads((folder / "symbols.json").read_text(encoding="utf-8"))[name]
    with tempfile.TemporaryDirectory() as place:
        bare = Path(place) / path.name
        bare.write_text(head.sub("", path.read_text(encoding="utf-8")), encoding="utf-8")
        whole = judged_note(bare, Settings())
    known, draft = whole.known.lexicon, whole.known.draft
    if draft is None:
        return
    formulas = [f.understood.formula for f in whole.found]
    hold = [f.finding.verdict in {HOLDS, UNDER} for f in whole.found]
    fails = [misfit(f.understood, known) for f in whole.found]
    said = evidence(formulas, hold, known, draft, fails)
    truth = dict(_spelt(rows))
    done: set[Look] = set()
    for number, one in enumerate(whole.found):
        if one.finding.kind == "display":
            for look in operands_of(one.understood.formula, one.understood.lexicon):
                if look in truth and look not in done:
                    done.add(look)
                    yield _count(name, look, truth[look], one, said, number)


def _spelt(rows: Sequence[Mapping[str, Any]]) -> Iterator[tuple[Look, Mapping[str, Any]]]:
    """Yield the symbols of the truth that the table knows, as they look."""
    for row in rows:
        if quantities(row):
            for latex in (*row["latex"], *row.get("instances", ())):
                look = _look(latex)
                if look is not None:
                    yield look, row


def _look(latex: str) -> Look | None:
    try:
        return look_of(read_formula(latex).tree)
    except InputError:
        return None


def quantities(row: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the quantities that a row of the truth may mean; none where the table knows none."""
    fits = (q for words, q in QUANTITIES_OF if re.search(words, row["meaning"], re.IGNORECASE))
    return (
        next(fits, ()) if row["kind"] not in {"operator", "point", "frame", "superscript"} else ()
    )


def _count(
    name: str, look: Look, row: Mapping[str, Any], one: Judged, said: Evidence, number: int
) -> Count:
    found = one.understood.lexicon.find(look)
    taken = found.meaning.words if found is not None else ""
    right = found is not None and _right(found, row, one.understood.lexicon)
    pattern = found.entry.latex if found is not None else ""
    sure = pattern in said.used[number] and said.is_sure(pattern, number)
    return Count(name, latex_of(look), row["meaning"], taken, right, sure)


def _right(found: Found, row: Mapping[str, Any], lexicon: Lexicon) -> bool:
    """Return whether a symbol was taken for what the truth says."""
    wanted, means = quantities(row), found.meaning
    if means.quantity in {"equals", "system", "scalar", "defined"}:
        return means.quantity != "defined" and _alike(found, wanted, row, lexicon)
    point = lexicon.points.get((row.get("about", ""),))
    placed = point is None or not means.labels or point in means.labels
    turn = (
        "position" not in row
        or means.quantity != "turn_angle"
        or means.labels[0] == str(row["position"])
    )
    return means.quantity in wanted and placed and turn


def _alike(found: Found, wanted: Sequence[str], row: Mapping[str, Any], lexicon: Lexicon) -> bool:
    """Return whether what a formula gives has the dimension, and the shape, of a quantity."""
    here = _value(latex_of(found.look), lexicon)
    scalar = row["kind"] in {"scalar", "angle", "length", "coordinate"}
    samples = (_sample(q) for q in wanted)
    return here is not None and any(
        s is not None
        and s.dimension == here.dimension
        and (here.shape == "scalar") == (scalar or s.shape == "scalar")
        for s in samples
    )


def _value(latex: str, lexicon: Lexicon) -> Value | None:
    try:
        return elaborator(lexicon).value(read_formula(latex).tree)
    except (Refusal, InputError):
        return None


def _sample(quantity: str) -> Value | None:
    """Return a value of a quantity."""
    labels = ("", "body", "C", "P OI", "P OI I", "B I", "body C", "1 321 B I", "k", "1 B I")
    for words in (SAMPLE.get(quantity, quantity), *(f"{quantity} {n}".strip() for n in labels)):
        try:
            meaning(words, "")
        except InputError:
            continue
        entries = {"Z": words, r"\vec Y": "angular_velocity B I"}
        lexicon, errors = lexicon_of({"symbols": entries}, "sample")
        return None if errors else _value("Z", lexicon)
    return None


def report(rows: Sequence[Count]) -> Iterator[str]:
    """Yield the lines of the count."""
    told = [r for r in rows if r.taken]
    sure = [r for r in told if r.sure]
    yield f"symbols of displays whose words the table knows: {len(rows)}"
    for title, some in (("all", rows), ("with a meaning", told), ("told as sure", sure)):
        yield f"right of {title}: {sum(r.right for r in some)} of {len(some)}"
    for r in rows:
        if not r.right:
            sure = " (sure)" * (r.sure and bool(r.taken))
            yield f"  {r.note}: {r.latex}: {r.taken or 'no meaning'}{sure}; is: {r.truth[:90]}"
