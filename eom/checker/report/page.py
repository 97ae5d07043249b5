r"""The report as one page of HTML: the note with a verdict at every equation, and a summary on top.

The page holds no script and asks for nothing: formulas are MathML, styles are in the page, and what a note
brings along is escaped. Details open by click or key.

Formulas are MathML of the tree that the checker reads, `eom.checker.read.writing`; what cannot be read is
shown as it stands, as code.

The words of a note as HTML, with its formulas in their places.

Markdown is rendered by markdown-it with HTML switched off; LaTeX is first brought into Markdown, as far
as headings, lists, emphasis and paragraphs go. A formula is a mark while this is done.
"""

from __future__ import annotations

import html
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from importlib import resources
from itertools import groupby
from typing import TYPE_CHECKING
from urllib.parse import quote

from eom.checker.judge.judge import HOLDS, UNDECIDED, UNDER
from eom.checker.judge.verdicts import NONE
from eom.checker.mean.roles import ASSUMPTION, DEFINITION
from eom.checker.mean.values import AMBIGUOUS, ILL_FORMED, WRONG
from eom.checker.read.documents import Document, Piece, masked_markdown
from eom.checker.read.grammar import read_formula
from eom.checker.read.spans import ReadingError, Source, Span
from eom.checker.read.tokens import Macro
from eom.checker.read.writing import at_fault, box
from eom.checker.report.findings import (
    FAULTS,
    UNSURE,
    Correction,
    Counterexample,
    Finding,
    Graded,
    Report,
)
from eom.checker.report.questions import Question, Taken
from eom.typeset.markup import render
from eom.worlds.worlds import ASSUMPTIONS

if TYPE_CHECKING:
    from markdown_it.token import Token

SIGNS: dict[str, tuple[str, str]] = {
    WRONG: ("bad", "✗"),
    ILL_FORMED: ("bad", "⚠"),
    UNSURE: ("open", "✗?"),
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
    shown = [f for f in report.equations if f.verdict != NONE]
    findings = {(f.source.name, f.span.start): f for f in shown}

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
    return resources.files("eom.checker.report").joinpath("page.css").read_text(encoding="utf-8")


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
        ("Meanings taken from the note, unconfirmed", _list(map(_taken, report.drafts), "ul")),
        ("Assumed throughout", _assumptions(report.given)),
        ("Symbols without a meaning", ", ".join(mathml(s) for s in report.unplaced)),
        ("Questions that would decide more lines", _questions(report.questions)),
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


def _taken(one: Taken) -> str:
    """Return a meaning that was taken, with its evidence."""
    of = f"{mathml(one.latex)}: " if one.latex else ""
    return f"{of}{_worded(one.words)} <small>({_worded(one.why)})</small>"


def _questions(asked: Sequence[Question]) -> str:
    """Return what is open, and how to answer."""
    rows = _list(map(_question, asked), "ul")
    return f"<p>{ANSWER}</p>{rows}" if rows else ""


ANSWER = (
    "Say it in the note, in words (<q>q is the speed of the bob</q>), or answer at a terminal: "
    "<code>eom check NOTE --ask</code>."
)


PERHAPS = 3
"""Meanings that a question shows on the page; at the terminal there are more."""


def _question(one: Question) -> str:
    """Return an open meaning: the symbol, its lines, and what it may stand for."""
    taken = f", taken for {_worded(one.taken or one.guess)}" if one.guess else ""
    numbers = ", ".join(map(str, one.lines))
    lines = f"line{'s' * (len(one.lines) > 1)} {numbers}"
    others = [c for c in one.candidates if c.meaning != one.guess]
    may = "; ".join(_worded(str(c)) for c in others[:PERHAPS])
    perhaps = f"<br><small>perhaps {may}</small>" if may else ""
    return f"What is {mathml(one.latex)}{taken}? ({lines}){perhaps}"


FILTER = """<fieldset><legend>Show findings</legend>
<label><input type="radio" name="only" id="only-all" checked> all</label>
<label><input type="radio" name="only" id="only-bad"> what is wrong</label>
<label><input type="radio" name="only" id="only-none"> none</label>
</fieldset>"""


def _brief(finding: Finding) -> str:
    if finding.carried:
        return f"carries on {finding.carries}"
    reason = _worded(finding.reason.split("\n")[0])
    return f"{reason}, or state: {_worded(finding.special)}" if finding.special else reason


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
        math = mathml(piece.body, display=display, macros=piece.macros)
        return _display(math, "formula") if display else math
    lead = len(piece.body) - len(piece.body.lstrip())
    blamed = finding.explanation.blamed or ((finding.place,) if finding.place.start >= 0 else ())
    spans = [Span(s.start - piece.span.start, s.stop - piece.span.start) for s in blamed]
    inside = [s for s in spans if lead <= s.start < s.stop <= len(piece.body)]
    tone, sign = SIGNS[finding.verdict]
    math = mathml(piece.body, display=display, blamed=inside, macros=piece.macros)
    if display:
        return _display(math, _title(finding))
    label = html.escape(f"{finding.verdict}: {_title(finding)}")
    link = f'<a class="sign" href="#{_name(finding)}" aria-label="{label}">{sign}</a>'
    return f'<span class="formula inline {tone}">{math}{link}</span>'


def _display(math: str, label: str) -> str:
    """Return a displayed formula; one that is too wide scrolls by itself, by keys as well."""
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
    verdict = finding.verdict + " in general" * bool(finding.special)
    head = (
        f'<span class="verdict">{sign} {html.escape(verdict)}</span> '
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
    yield "Holds under", _sets(finding.sets)
    yield (
        "Reason",
        f'<span class="reason">{_worded(finding.reason)}</span>' * bool(finding.reason),
    )
    yield "Carries on", finding.carries
    yield "Left side minus right side", mathml(explanation.residual) if explanation.residual else ""
    yield "Convention", html.escape(explanation.convention)
    yield "What would make it right", _list(map(_correction, explanation.corrections), "ol")
    yield "Or state", _worded(finding.special)
    yield "Fails for", _counterexample(explanation.counterexample)
    yield "Remarks", _list((html.escape(r.text) for r in finding.remarks), "ul")
    yield "Read as", _list(map(html.escape, finding.read_as), "ul")


def _list(items: Iterable[str], tag: str) -> str:
    rows = "".join(f"<li>{item}</li>" for item in items)
    return f"<{tag}>{rows}</{tag}>" if rows else ""


def _correction(correction: Correction) -> str:
    under = f" It then holds under: {_sets(correction.sets)}" if correction.sets else ""
    shown = _display(mathml(correction.latex, display=True), "corrected")
    return f"{_worded(correction.change)}{shown}{under}"


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


MAX_LENGTH = 20_000
"""Longer formulas are shown as code."""


def mathml(
    latex: str,
    *,
    display: bool = False,
    blamed: Iterable[Span] = (),
    macros: Mapping[str, Macro] | None = None,
) -> str:
    """Return a formula as an element of HTML: MathML, or its source as code where it cannot be read.

    ``blamed``: places in ``latex`` to mark; a place that is no term of its own is left unmarked.
    """
    code = f"<code>{html.escape(latex.strip())}</code>"
    if len(latex) > MAX_LENGTH:
        return code
    try:
        reading = read_formula(latex, macros=macros)
    except ReadingError:
        return code
    spans = [b for b in blamed if latex.count("{", *b) == latex.count("}", *b)]
    inner = render(box(at_fault(reading.tree, spans)), "mathml")
    stop = latex.rstrip()[-1:]
    stop = f"<mtext>{stop}</mtext>" if stop in {".", ",", ";"} else ""
    tags = "".join(f"<mtext>\u2003({html.escape(t)})</mtext>" for t, _ in reading.tags)
    kind = "block" if display else "inline"
    return f'<math display="{kind}"><mrow>{inner}</mrow>{stop}{tags}</math>'


_MARK = "\ue020{}\ue021"
_MARKED = re.compile("\ue020(\\d+)\ue021")
_OPEN = re.compile(
    r"(?:\$\$|\$`|\$|\\\[|\\\(|\\begin\{[a-z]+\*?\}|^[ ]*(?:`{3,}|~{3,})[^\n]*\n?)\Z", re.MULTILINE
)
_CLOSE = r"(?:\$\$|`\$|\$|\\\]|\\\)|\\end\{[a-z]+\*?\}|(?:`{3,}|~{3,})[^\n]*)"
_HARMLESS = re.compile(r"&lt;(su[bp]|em|strong|[bi])&gt;([^&<>]*)&lt;/\1&gt;")
"""Elements of HTML that a note may use."""
_DROPPED = re.compile("[\ue020\ue021]|<!--.*?-->", re.DOTALL)

_SPECIAL = re.compile(r"([*_`#<>|~])")
_LEVELS = {"part": "#", "chapter": "#", "section": "##", "subsection": "###"}
_LATEX: tuple[tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]], ...] = (
    (re.compile(r"(?<!\\)%[^\n]*"), ""),
    (
        re.compile(r"\\(part|chapter|section|subsection|subsubsection)(?:\\\*)?\s*\{([^{}]*)\}"),
        lambda m: f"\n\n{_LEVELS.get(m[1], '####')} {m[2]}\n\n",
    ),
    (re.compile(r"\\(?:emph|textit|textsl)\s*\{([^{}]*)\}"), r"*\1*"),
    (re.compile(r"\\textbf\s*\{([^{}]*)\}"), r"**\1**"),
    (re.compile(r"\\texttt\s*\{([^{}]*)\}"), r"`\1`"),
    (re.compile(r"\\item\s*(?:\[([^\]]*)\])?"), r"\n- \1 "),
    (re.compile(r"\\(?:begin|end)\s*\{[^{}]*\}(?:\[[^\]]*\])?"), "\n\n"),
    (re.compile(r"\\(?:label|index|vspace|hspace|documentclass|usepackage)\*?\s*\{[^{}]*\}"), ""),
    (re.compile(r"\\(?:eqref|ref|cite)\s*\{([^{}]*)\}"), r"(\1)"),
    (re.compile(r"\\([%&$#_{}])"), r"\1"),
    (re.compile(r"\\\\|\\(?:par|newline)(?![A-Za-z])"), "\n\n"),
    (re.compile(r"(?<!\\)~"), " "),
    (re.compile(r"``|''"), '"'),
    (re.compile(r"\\[A-Za-z]+\*?\s*"), ""),
    (re.compile(r"[{}]"), ""),
)
"""How LaTeX around formulas becomes Markdown, in this order."""


def prose(
    document: Document, shown: Callable[[Piece], str], below: Callable[[Piece], str]
) -> Iterator[str]:
    """Yield the blocks of a note as HTML.

    ``shown``: HTML of a formula in its line; ``below``: what follows the block that holds it.
    """
    number = 0
    for _, group in groupby(document.pieces, lambda p: id(p.source)):
        pieces = list(group)
        formulas = {number + k: p for k, p in enumerate(p for p in pieces if p.is_formula)}
        text = _text(pieces[0].source, formulas, document)
        for block in _blocks(text):
            held = [formulas[int(n)] for n in _MARKED.findall(block) if int(n) in formulas]
            yield _MARKED.sub(lambda m, f=formulas: shown(f[int(m[1])]), block)  # type: ignore[misc]
            yield from filter(None, map(below, held))
        number += len(formulas)


def _text(source: Source, formulas: Mapping[int, Piece], document: Document) -> str:
    """Return Markdown with marks for the formulas of a source."""
    is_latex = document.kind == "latex"
    place = _start(source, is_latex)
    parts: list[str] = []
    for number, piece in formulas.items():
        gap = source.text[place : piece.span.start]
        parts += [_gap(gap, first=not parts), _mark(number, piece)]
        place = piece.span.stop
    gaps = [*parts, _gap(source.text[place:], first=not parts, last=True)]
    return "".join(_markdown(g) if is_latex and k % 2 == 0 else g for k, g in enumerate(gaps))


def _start(source: Source, is_latex: bool) -> int:
    """Return where the note begins, behind its front matter or preamble."""
    if is_latex:
        match = re.search(r"\\begin\{document\}", source.text)
        return match.end() if match else 0
    front = masked_markdown(source.text).front
    return source.text.find("\n", front[1] + 1) + 1 if front else 0


def _gap(text: str, *, first: bool, last: bool = False) -> str:
    """Return what stands between two formulas, without the delimiters and characters of marks."""
    text = text if first else re.sub(rf"\A\s*{_CLOSE}", "", text)
    text = text if last else _OPEN.sub("", text)
    return _DROPPED.sub("", text)


def _mark(number: int, piece: Piece) -> str:
    mark = _MARK.format(number)
    return mark if piece.kind == "inline" else f"\n\n{mark}\n\n"


def _markdown(text: str) -> str:
    """Return LaTeX as Markdown."""
    text = _SPECIAL.sub(r"\\\1", text)
    for pattern, replacement in _LATEX:
        text = pattern.sub(replacement, text)
    return text


def _blocks(text: str) -> Iterator[str]:
    """Yield the HTML of every block of Markdown that is in no other."""
    from markdown_it import MarkdownIt

    reader = MarkdownIt("commonmark", {"html": False, "linkify": False}).enable(["table"])
    reader.disable(["image", "link", "autolink", "reference"])
    tokens = _stepped(reader.parse(text))
    depth, begin = 0, 0
    for k, token in enumerate(tokens):
        depth += token.nesting
        if depth == 0:
            block = reader.renderer.render(tokens[begin : k + 1], reader.options, {})
            yield block if block.startswith("<pre") else _HARMLESS.sub(r"<\1>\2</\1>", block)
            begin = k + 1


def _stepped(tokens: list[Token]) -> list[Token]:
    """Number the levels of headings from 2, each at most one below the one before."""
    last, wanted = 1, {}
    for token in tokens:
        if token.type == "heading_open":
            wanted = {"tag": f"h{min(int(token.tag[1]) + 1, last + 1, 6)}"}
            last = int(wanted["tag"][1])
        if token.type in {"heading_open", "heading_close"}:
            token.tag = wanted["tag"]
    return tokens
