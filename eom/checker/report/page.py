"""The report as one page of HTML: the note with a verdict at every equation, and a summary on top.

The page holds no script and asks for nothing: formulas are MathML, styles are in the page, and what a note
brings along is escaped. Details open by click or key.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from importlib import resources
from urllib.parse import quote

from eom.checker.explanation import Correction, Counterexample
from eom.checker.graded import Graded
from eom.checker.judge.judge import HOLDS, UNDECIDED, UNDER
from eom.checker.judge.verdicts import NONE
from eom.checker.mean.roles import ASSUMPTION, DEFINITION
from eom.checker.mean.values import AMBIGUOUS, ILL_FORMED, WRONG
from eom.checker.read.documents import Document, Piece
from eom.checker.read.places import Span
from eom.checker.report.mathml import mathml
from eom.checker.report.prose import prose
from eom.checker.reports import FAULTS, Finding, Report
from eom.worlds.worlds import ASSUMPTIONS

SIGNS: dict[str, tuple[str, str]] = {
    WRONG: ("bad", "✗"),
    ILL_FORMED: ("bad", "⚠"),
    AMBIGUOUS: ("open", "⁇"),
    UNDECIDED: ("open", "?"),
    UNDER: ("good", "✓"),
    HOLDS: ("good", "✓"),
    DEFINITION: ("plain", "≔"),
    ASSUMPTION: ("plain", "▹"),
}
"""Tone and sign of a verdict, in the order of the summary."""

DOCUMENT = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>{title}</title>
<style>
{style}</style>
</head>
<body>
<a class="skip" href="#note">Skip to the note</a>
<header>
{summary}
</header>
<main id="note" tabindex="-1">
{note}
</main>
</body>
</html>
"""


def page(document: Document, report: Report) -> str:
    """Return the page of a note and its report; the same input gives the same text."""
    told = [f for f in report.equations if f.verdict != NONE]
    findings = {(f.source.name, f.span.start): f for f in told}

    def found(piece: Piece) -> Finding | None:
        return findings.get((piece.source.name, piece.span.start))

    note = prose(document, lambda p: _formula(p, found(p)), lambda p: _below(found(p)))
    return DOCUMENT.format(
        title=html.escape(f"{report.name or 'Formula'}: {_headline(report)}"),
        style=_style(),
        summary="\n".join(_summary(report)),
        note="".join(note) + _claims(report.claims),
    )


def _claims(found: Sequence[Finding]) -> str:
    """Return the cards of claims in words, each with its sentence."""
    rows = "".join(
        f"<blockquote>{html.escape(' '.join(f.latex.split()))}</blockquote>{_below(f)}"
        for f in found
    )
    return f"<section><h2>Claims in words</h2>{rows}</section>" if rows else ""


def index(rows: Sequence[tuple[str, Graded]]) -> str:
    """Return the page that leads to the pages of many notes: their file names, and what became of them."""
    cells = "".join(
        f'<tr class="{TONES[g.status]}"><th scope="row">{_linked(file, g)}</th>'
        f'<td class="verdict">{g.status}</td><td>{_outcome(g)}</td></tr>'
        for file, g in rows
    )
    head = '<tr><th scope="col">note</th><th scope="col">verdict</th><th scope="col">why</th></tr>'
    return DOCUMENT.format(
        title=f"{len(rows)} notes checked",
        style=_style(),
        summary=f"<h1>{len(rows)} notes checked</h1>",
        note=f"<table>{head}{cells}</table>",
    )


TONES = {"wrong": "bad", "unusable": "open", "nothing wrong": "good"}
"""Tone of what became of a note."""


def _linked(file: str, graded: Graded) -> str:
    name = html.escape(graded.name)
    return f'<a href="{html.escape(quote(file))}">{name}</a>' if graded.report else name


def _outcome(graded: Graded) -> str:
    if graded.report is None:
        return html.escape(graded.error)
    return ", ".join(f"{count} {verdict}" for verdict, count in graded.report.counts.items())


@cache
def _style() -> str:
    return resources.files("eom.checker").joinpath("page.css").read_text(encoding="utf-8")


# -- summary ---------------------------------------------------------------------------------------


def _headline(report: Report) -> str:
    return f"{len(report.faults)} wrong" if report.faults else "nothing wrong"


def _summary(report: Report) -> Iterator[str]:
    """Yield the lines of the summary."""
    counts = report.counts
    yield f"<h1>{html.escape(report.name or 'Formula')}</h1>"
    cells = [
        f'<tr class="{tone}"><th scope="row" class="verdict">{sign} {verdict}</th>'
        f"<td>{counts[verdict]}</td></tr>"
        for verdict, (tone, sign) in SIGNS.items()
        if verdict in counts
    ]
    yield f"<table><caption>Equations by verdict</caption>{''.join(cells)}</table>"
    for title, text in (
        ("Meanings of symbols", html.escape(report.lexicon)),
        ("Drafted from the words of the note", _list(map(html.escape, report.drafts), "ul")),
        ("Assumed throughout", _assumptions(report.given)),
        ("Symbols without a meaning", ", ".join(mathml(s) for s in report.unplaced)),
        (
            "Not read",
            _list((f"line {n.line}: {html.escape(n.text)}" for n in report.notices), "ul"),
        ),
    ):
        yield f"<div><strong>{title}:</strong> {text}</div>" if text else ""
    rows = "".join(
        f'<li class="bad"><a href="#{_name(f)}">{_title(f)}</a> {_brief(f)}</li>'
        for f in report.faults
    )
    yield (
        f'<nav aria-label="What is wrong"><h2>What is wrong</h2><ul>{rows}</ul></nav>'
        if rows
        else ""
    )
    yield FILTER


FILTER = """<fieldset><legend>Show findings</legend>
<label><input type="radio" name="only" id="only-all" checked> all</label>
<label><input type="radio" name="only" id="only-bad"> what is wrong</label>
<label><input type="radio" name="only" id="only-none"> none</label>
</fieldset>"""


def _brief(finding: Finding) -> str:
    if finding.carried:
        return f"carries on the slip of line {finding.carried}"
    first = next(iter(finding.explanation.corrections), None)
    if first is not None:
        return _worded(first.change)
    return html.escape(finding.reason.split("\n")[0])


# -- formulas and cards ------------------------------------------------------------------------------


def _name(finding: Finding) -> str:
    """Return the anchor of a finding; notebooks have a source a cell."""
    cell = "".join(c for c in finding.source.name.rpartition("cell ")[2] if c.isdigit())
    return f"{finding.kind}-{cell}-{finding.number}" if cell else f"{finding.kind}-{finding.number}"


def _title(finding: Finding) -> str:
    return f"{finding.kind} {finding.number}, line {finding.line}"


def _formula(piece: Piece, finding: Finding | None) -> str:
    """Return a formula in its place, with a sign that leads to its card."""
    display = piece.kind == "display"
    if finding is None:
        return _display(piece.body, "formula") if display else mathml(piece.body)
    lead = len(piece.body) - len(piece.body.lstrip())
    blamed = finding.explanation.blamed or ((finding.place,) if finding.place.start >= 0 else ())
    spans = [Span(s.start - piece.span.start, s.stop - piece.span.start) for s in blamed]
    inside = [s for s in spans if lead <= s.start < s.stop <= len(piece.body)]
    tone, sign = SIGNS[finding.verdict]
    if display:
        return _display(piece.body, _title(finding), inside)
    math = mathml(piece.body, blamed=inside)
    label = html.escape(f"{finding.verdict}: {_title(finding)}")
    link = f'<a class="sign" href="#{_name(finding)}" aria-label="{label}">{sign}</a>'
    return f'<span class="formula inline {tone}">{math}{link}</span>'


def _display(latex: str, label: str, blamed: Iterable[Span] = ()) -> str:
    """Return a displayed formula; one that is too wide scrolls by itself, by keys as well."""
    math = mathml(latex, display=True, blamed=blamed)
    return f'<span class="display" tabindex="0" role="group" aria-label="{label}">{math}</span>'


_SCROLLS = ' tabindex="0"'
"""Formulas may be wider than the screen; then they scroll, by keys as well."""


def _below(finding: Finding | None) -> str:
    """Return the card of a finding."""
    if finding is None:
        return ""
    tone, sign = SIGNS[finding.verdict]
    details = "".join(
        f"<dt>{term}</dt><dd{_SCROLLS if '<math' in text else ''}>{text}</dd>"
        for term, text in _details(finding)
        if text
    )
    head = (
        f'<span class="verdict">{sign} {html.escape(finding.verdict)}</span> '
        f"<small>{_title(finding)}</small>"
    )
    body = f"<dl>{details}</dl>"
    opened = " open" if finding.verdict in FAULTS else ""
    inner = f"<details{opened}><summary>{head}</summary>{body}</details>" if details else head
    where = f'id="{_name(finding)}" aria-label="{_title(finding)}"'
    return f'<section class="card {tone}" {where}>{inner}</section>\n'


def _details(finding: Finding) -> Iterator[tuple[str, str]]:
    """Yield what is said of a finding: a term and its text as HTML."""
    explanation = finding.explanation
    carried = f"the slip of line {finding.carried}" if finding.carried else ""
    yield "Holds under", _sets(finding.sets)
    yield (
        "Reason",
        f'<span class="reason">{html.escape(finding.reason)}</span>' * bool(finding.reason),
    )
    yield "Carries on", carried
    yield "Left side minus right side", mathml(explanation.residual) if explanation.residual else ""
    yield "Convention", html.escape(explanation.convention)
    yield "What would make it right", _list(map(_correction, explanation.corrections), "ol")
    yield "Fails for", _counterexample(explanation.counterexample)
    yield "Remarks", _list((html.escape(r.text) for r in finding.remarks), "ul")
    yield "Read as", _list(map(html.escape, finding.read_as), "ul")


def _list(items: Iterable[str], tag: str) -> str:
    rows = "".join(f"<li>{item}</li>" for item in items)
    return f"<{tag}>{rows}</{tag}>" if rows else ""


def _correction(correction: Correction) -> str:
    under = f" It then holds under: {_sets(correction.sets)}" if correction.sets else ""
    return f"{_worded(correction.change)}{_display(correction.latex, 'corrected')}{under}"


def _worded(words: str) -> str:
    """Return words with formulas between dollars."""
    parts = re.split(r"\$([^$]*)\$", words)
    return "".join(mathml(p) if k % 2 else html.escape(p) for k, p in enumerate(parts))


def _counterexample(example: Counterexample | None) -> str:
    if example is None:
        return ""
    values = ", ".join(mathml(f"{symbol} = {value}") for symbol, value in example.values)
    sides = "; ".join(mathml(f"{side} = {value}") for side, value in example.members)
    under = f" (under: {_assumptions(example.assumptions)})" if example.assumptions else ""
    return f"{values}{under}: {sides}"


def _sets(sets: Sequence[Sequence[str]]) -> str:
    """Return alternatives of assumptions in words."""
    if not sets:
        return ""
    return _assumptions(sets[0]) if len(sets) == 1 else _list(map(_assumptions, sets), "ul")


def _assumptions(names: Iterable[str]) -> str:
    return html.escape("; ".join(_meaning(n) for n in names))


def _meaning(name: str) -> str:
    return ASSUMPTIONS[name].meaning if name in ASSUMPTIONS else name
