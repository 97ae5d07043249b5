"""What the symbols of a derivation mean, as front matter that `eom check` reads.

A derivation knows its quantities; written into its page they make the page a note that can be checked,
changed by students, and checked again.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import replace
from typing import Any

from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import label_of, look_of, preset
from eom.checker.read.grammar import read_formula
from eom.checker.read.spans import ReadingError
from eom.checker.read.symbol_shape import Look, Seen, seen
from eom.derivations import standing
from eom.derivations.derived import Derived
from eom.derivations.verification import in_full
from eom.derivations.wording import factors, notation_of, spelt
from eom.errors import InputError
from eom.system import System
from eom.terms.rules import entrywise, slopes
from eom.terms.terms import VECTOR, Term, expr, nodes
from eom.typeset.letters import Notation
from eom.typeset.markup import render, symbol_latex
from eom.typeset.notation import NOTATIONS, notation_named, term_box
from eom.typeset.printing import latex_names
from eom.typeset.sentences import phrases

PRESETS: dict[str, tuple[str, dict[str, str]]] = {
    "arrow": ("arrow-tilde", {"dyads": "true", "juxtaposed": "true"}),
    "superscript": ("left-superscript", {}),
    "underline": ("underline-bullet", {"mixed": '"B"', "dyads": "true", "alike": "[]"}),
    "kane": ("kane", {}),
}
"""The preset that is nearest to each notation, and what else it says of the notation."""

_FRAMED = {"angular_velocity": 2, "rotation": 2, "unit": 1}
"""Quantities whose first labels are frames."""

_BRACKETS = re.compile(r"\\left\[ (.*) \\right\]")


def front_matter(derivation: Derived, notation: str = "arrow") -> str:
    """Return TOML between lines of +++: preset, frames and symbols of a derivation.

    notation: one of `eom.typeset.notation.NOTATIONS` or its aliases. What one pattern cannot say, such as
    dF, is left to the preset. Raises `InputError` for other notations, and for a derivation of the places
    of any masses as functions of coordinates, which no lexicon says.
    """
    chosen = notation_of(derivation, notation_named(notation))
    if derivation.own.configured:
        raise InputError(
            "no note can say this: places of all masses as functions of coordinates",
            where=derivation.name,
            got=", ".join(derivation.own.configured),
            hint="the page without front matter is written, as `eom derive` does without --lexicon",
        )
    derivation = spelt(derivation, chosen)
    base, besides = PRESETS[chosen.name]
    found = list(dict.fromkeys(n for n in _nodes(derivation) if n.head == "atom"))
    known = preset(base).frames
    frames = dict.fromkeys(f for t in found for f in _frames(t))
    named = {render(chosen.frame(f), "latex"): f for f in frames}
    lines = ["+++", "[check]", f'preset = "{base}"']
    lines += ["[check.notation]", *(f"{k} = {v}" for k, v in besides.items())] if besides else []
    lines += _table("frames", {k: f for k, f in named.items() if label_of(k) not in known})
    points = dict.fromkeys(p for t in found for p in _points(t))
    called = ((render(chosen.point(p), "latex"), p) for p in points)
    lines += _table("points", {k: p for k, p in called if _is_label(k)})
    rows = (_symbols(found, chosen), _columns(derivation, chosen), _rates(derivation, chosen))
    meant = {k: v for some in rows for k, v in some}
    meant |= dict(_scalars(derivation, chosen, preset(base)))
    given = _given_rates(derivation)
    meant |= {symbol_latex(s.name): f"coordinate {s.name}" for s in given}
    meant = dict(_any(derivation, preset(base))) | dict(_of_rules(derivation, chosen)) | meant
    meant |= dict(_outputs(derivation, chosen, {look_of(letter) for letter in meant}))
    lines += _table("symbols", meant)
    lines += _moving(derivation, chosen)
    for s, (rate, value) in given.items():
        law = f"{symbol_latex(rate.name)} = {render(term_box(value, chosen), 'latex')}"
        lines += ["[[check.determined]]", f"law = '{law}'", f"gives = ['{s.name}']"]
    return "\n".join([*lines, "+++", "", ""])


def _given_rates(derivation: Derived) -> dict[Any, tuple[Any, Term]]:
    """Return what is shown as changing by a rate that is defined, with the symbol of that and its value.

    The rate is a symbol of its own in the derivation; on the page it is read as the other with a dot.
    """
    shown = {s: _seen(symbol_latex(s.name)) for s in _free(derivation)}
    still = {found.look: s for s, found in shown.items() if found is not None and not found.dots}
    rates = {}
    for rate, found in shown.items():
        value, of = derivation.scalars.get(rate), None
        if found is not None and found.dots == 1 and value is not None and value.head == "expr":
            of = still.get(found.look)
        if of is not None and value is not None and of not in derivation.scalars:
            rates[of] = (rate, value)
    return dict(sorted(rates.items(), key=lambda row: str(row[0])))


def _free(derivation: Derived) -> set[Any]:
    return {s for n in _nodes(derivation) if n.head == "expr" for s in n.data[0].free_symbols}


def _seen(latex: str) -> Seen | None:
    try:
        return seen(read_formula(latex).tree)
    except (InputError, ReadingError):
        return None


def _moving(derivation: Derived, notation: Notation) -> list[str]:
    """Return tables of what the derivation declares to move, with formulas in LaTeX."""
    own, lines = derivation.own, list[str]()

    def latex(term: Term) -> str:
        return f"'{render(term_box(term, notation), 'latex')}'"

    carry = slopes(derivation.scalars, own)
    meant = {s: carry(t) for s, t in derivation.scalars.items()}
    known = {s: t.data[0] for s, t in meant.items() if t.head == "expr"}
    named = entrywise(lambda e: in_full(e, known))
    turned = {
        f: f"{{ from = '{row.base}', axis = {row.axis}, angle = {latex(expr(row.angle))} }}"
        for f, row in own.frames.items()
    }
    placed = {p: latex(place) for p, place in own.points.items()}
    bodies = {}
    for b, body in own.bodies.items():
        frame = f", frame = '{body.frame}'" if body.frame else ""
        moments = ", ".join(map(latex, body.moments))
        bodies[b] = f"{{ mass = {latex(body.mass)}{frame}, moments = [{moments}] }}"
    for name, rows in (("turned", turned), ("placed", placed), ("bodies", bodies)):
        lines += [f"[check.{name}]", *(f"{k} = {row}" for k, row in rows.items())] if rows else []
    for law in own.laws:
        gives = ", ".join(f"'{derivation.scalars[s].data[1]}'" for s in law.unknowns)
        sides = (latex(named(t))[1:-1] for t in (law.equation.left, law.equation.right))
        lines += ["[[check.determined]]", f"law = '{' = '.join(sides)}'", f"gives = [{gives}]"]
    return lines


def _table(name: str, rows: dict[str, str]) -> list[str]:
    return [f"[check.{name}]", *(f"'{k}' = '{v}'" for k, v in rows.items())] if rows else []


def _nodes(derivation: Derived) -> Iterator[Term]:
    sides = (t for s in derivation.steps for t in (s.statement.left, s.statement.right))
    own = derivation.own
    laws = (t for law in own.laws for t in (law.equation.left, law.equation.right))
    parts = (t for b in own.bodies.values() for t in (b.mass, *b.moments))
    for term in (*sides, *derivation.scalars.values(), *laws, *own.points.values(), *parts):
        yield from nodes(term)


def _frames(term: Term) -> tuple[str, ...]:
    name, *labels = term.data
    return tuple(map(str, labels[: _FRAMED.get(name, 0)]))


def _points(term: Term) -> tuple[str, ...]:
    name, *labels = term.data
    return tuple(map(str, labels)) if name == "position" else ()


def _rates(derivation: Derived, notation: Notation) -> Iterator[tuple[str, str]]:
    """Yield letters that stand for derivatives, such as those of velocities, with what they are of."""
    spelt = replace(notation, derivative=NOTATIONS["arrow"].derivative)
    for term in _nodes(derivation):
        if term.head == "der" and term.kind == VECTOR:
            letter, plain = (render(term_box(term, n), "latex") for n in (notation, spelt))
            if letter != plain and _is_pattern(letter):
                yield letter, f"= {plain}"


def _columns(derivation: Derived, notation: Notation) -> Iterator[tuple[str, str]]:
    """Yield letters of their own for the components of a quantity in a frame."""
    for term in _nodes(derivation):
        if term.head == "column" and term.args[0].head == "atom":
            letter = render(term_box(term, notation), "latex")
            if _is_pattern(letter):
                yield letter, " ".join(map(str, (*term.args[0].data, "in", *term.data)))


def _scalars(derivation: Derived, notation: Notation, known: Lexicon) -> Iterator[tuple[str, str]]:
    """Yield scalars of the derivation whose letters mean something else in the preset."""
    for name, meaning in derivation.scalars.items():
        letter, said = symbol_latex(name.name), render(term_box(meaning, notation), "latex")
        if letter != said and _is_pattern(letter) and known.find(look_of(letter)) is not None:
            yield letter, f"= {said}"


def _outputs(
    derivation: Derived, notation: Notation, taken: Collection[Look]
) -> Iterator[tuple[str, str]]:
    """Yield letters of what systems give by states whose rates a step defines, with the formulas.

    The preset knows of no such states, and so not what is made of them.
    """
    given = set(_given_rates(derivation))
    shown = ((_seen(symbol_latex(s.name)), s) for s in _free(derivation))
    known = {found.look: s for found, s in shown if found is not None and not found.dots}
    for system in (r for r in derivation.result.values() if isinstance(r, System)):
        shown_as = standing.letters_of(derivation, system, notation)
        names = latex_names(system) | {s: render(box, "latex") for s, box in shown_as.items()}
        letters = {s: _seen(letter) for s, letter in names.items()}
        same = {s: known[f.look] for s, f in letters.items() if f is not None and f.look in known}
        for d in system.outputs:
            letter = names[d.symbol]
            free, value = d.expression.free_symbols, expr(d.expression.xreplace(same))
            all_known = free <= same.keys() and given & value.data[0].free_symbols
            if all_known and _is_pattern(letter) and look_of(letter) not in taken:
                yield letter, f"= {render(term_box(value, notation), 'latex')}"


def _any(derivation: Derived, known: Lexicon) -> Iterator[tuple[str, str]]:
    """Yield symbols that stand for any number, where the preset has no such letter."""
    for s in sorted(_free(derivation) - set(derivation.scalars), key=str):
        letter = symbol_latex(s.name)
        if _is_pattern(letter) and known.find(look_of(letter)) is None:
            yield letter, f"scalar {s.name}"


def _of_rules(derivation: Derived, notation: Notation) -> Iterator[tuple[str, str]]:
    """Yield the letters of rules such as a.b = b.a that some line names: any vectors."""
    known = factors(notation)
    said = (part for s in derivation.steps for rule in s.by for part in phrases(rule, known))
    formulas = [render(part, "latex") for part in said if not isinstance(part, str)]
    for name in filter(str.isalpha, known):
        letter = render(known[name], "latex")
        if any(letter in formula for formula in formulas) and _is_pattern(letter):
            yield letter, f"vector {name}"


def _symbols(found: list[Term], notation: Notation) -> Iterator[tuple[str, str]]:
    """Yield patterns with their quantities; brackets around a letter are how matrices are shown."""
    for term in found:
        latex = render(term_box(term, notation), "latex")
        bracketed = _BRACKETS.fullmatch(latex)
        pattern = bracketed[1] if bracketed else latex
        if _is_pattern(pattern):
            yield pattern, " ".join(map(str, term.data))


def _is_label(latex: str) -> bool:
    try:
        label_of(latex)
    except (InputError, ReadingError):
        return False
    return True


def _is_pattern(latex: str) -> bool:
    try:
        look_of(latex)
    except (InputError, ReadingError):
        return False
    return True
