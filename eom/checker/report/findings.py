"""The report on a note: what was found of every formula, in order, and the same as lines of text.

How notes are checked.

Of a wrong line: what is left over, what would make it right, and where it fails. Of a note among many: its
report, or the error that left none. Lines of text have parts with a style that a terminal may show by
colour.

How notes are checked. Reports as data: JSON by the schema of `report.schema.json`, and a table with a
row for each note.
"""

from __future__ import annotations

import csv
import io
import json
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING, Any

from eom.checker.judge.judge import HOLDS, UNDER
from eom.checker.read.spans import NOWHERE, Source, Span, printable
from eom.checker.report.questions import Question, Taken
from eom.worlds.worlds import ASSUMPTIONS

if TYPE_CHECKING:
    from eom.opening import AnyScene
    from eom.system import System

GIVEN = ("constant_mass",)
"""What is assumed without being said, unless something else is given."""
FORMULA_SECONDS = 10.0
NOTE_SECONDS = 300.0


@dataclass(frozen=True)
class Settings:
    """How notes are checked.

    ``notation``: a preset, ``lexicon``: a TOML file, "" for neither; ``given``: assumptions made without
    being said; ``kind``: of texts that are no files, see `read_document`, "" for what they look like;
    ``system``: what scalar lines are about, a name, a scene file or an object, None for what the note says;
    ``seconds`` of processor time: for the meaning of a formula, and again for its judgement;
    ``note_seconds``: for a note; ``strict``: whether a line counts as wrong, and not as unsure, that is so
    by a meaning which neither words nor another line make sure; ``answers``: what symbols mean, pairs of
    patterns and meanings that go before what a draft says.
    """

    notation: str = ""
    lexicon: str = ""
    given: tuple[str, ...] = GIVEN
    kind: str = ""
    system: str | System | AnyScene | None = None
    seconds: float = FORMULA_SECONDS
    note_seconds: float = NOTE_SECONDS
    strict: bool = False
    answers: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Correction:
    """A line that holds, a slip or two away from the one that is wrong.

    ``latex``: the whole line in the writer's notation; ``span``: what of the note ``text`` replaces;
    ``change``: the slip undone, in words; ``slip``: its kind, a row of a table; ``sets``: the smallest
    sets of assumptions under which the corrected line holds, none where it always does.
    """

    latex: str
    change: str
    slip: str
    span: Span = NOWHERE
    text: str = ""
    sets: tuple[tuple[str, ...], ...] = ()


@dataclass(frozen=True)
class Counterexample:
    """Small numbers for which a line fails.

    ``values``: by the LaTeX of symbols; ``members``: what each member of the line then is. Both are texts,
    in any consistent units. ``assumptions``: under which the numbers stand.
    """

    values: tuple[tuple[str, str], ...]
    members: tuple[tuple[str, str], ...]
    assumptions: tuple[str, ...] = ()


@dataclass(frozen=True)
class Explanation:
    """Why a line is wrong.

    ``residual``: LaTeX of what is too much on the left side, in the writer's symbols, "" if no short one
    was found; ``blamed``: the places at fault; ``corrections``: the most plausible first;
    ``counterexample``: small numbers for which it fails, None if none was found;
    ``convention``: what other convention makes the line right, "" for none; ``reason``: in one sentence,
    with formulas between dollars, "" where none is known.
    """

    residual: str = ""
    blamed: tuple[Span, ...] = ()
    corrections: tuple[Correction, ...] = ()
    counterexample: Counterexample | None = None
    convention: str = ""
    reason: str = ""


UNEXPLAINED = Explanation()
"""Nothing is said."""


UNSURE = "unsure"
"""The verdict on a line that is wrong if a meaning is right which only letters and custom suggest."""
FAULTS = frozenset({"wrong", "ill-formed"})
"""Verdicts that say that something is wrong."""

VERDICTS: dict[str, tuple[str, str]] = {
    "wrong": ("bad", "wrong"),
    "ill-formed": ("bad", "ill-formed"),
    "unsure": ("unsure", "wrong if the draft is right"),
    "ambiguous": ("unsure", "ambiguous"),
    "undecided": ("unsure", "undecided"),
    "holds under": ("good", "hold under assumptions"),
    "holds": ("good", "hold"),
    "definition": ("", "definitions"),
    "assumption": ("", "assumptions"),
    "no claim": ("", "claim nothing"),
}
"""The style of a verdict, see `Part`, and as it is counted."""
ORDER = tuple(VERDICTS)
"""All verdicts, the gravest first; the last one is that of a display that claims nothing."""


CARRIED, CARRIED_AND_OWN = "carried", "carried and own"
"""Kinds of remarks on a slip that is carried forward."""
PROSE = "prose"
"""The kind of a finding on a claim in words."""


DECIDES: dict[str, tuple[str, ...]] = {
    "": (  # says itself what would
        *("symbol without a meaning", "this mark has no meaning", "its condition", "unknown "),
        *("not a unit", "not read", "ill-formed if the draft", "a number that is given"),
        *("not exactly true", "a body beside the single"),
    ),
    "a meaning of it in the lexicon, or a line above that defines it": (
        *("this is not defined yet", "no meaning is known", "the meanings of these symbols go"),
        *("a script on the left", "an accent without", "what stands above", "what stands at this"),
        *("what is raised here", "an operator without a", "a function without", "a list without"),
        *("angle brackets", "a table without", "a differential without", "a relation without"),
        *("what stands below this function", "a derivative by what", "wrong number of labels"),
        *("a condition in words", "cases of what", "a condition on what", "an angle of other than"),
        *("sine or cosine of what", "a matrix of", "the slopes of what is no column"),
    ),
    "a line above that defines it, or a system in the lexicon that says how it moves": (
        *("this is no quantity of the system", "no system says how", "only a system says"),
        *("it is not known how this depends", "no partial derivative", "this has no value on sol"),
        *("the coordinates of this system", "speeds that are not linear", "states on an unknown"),
        *("no body or motion is known", "this rotation was not", "there is no such angle"),
        *(
            "there are no rotors",
            "there is no slug",
            "nothing ties",
            "an instant that is not known",
        ),
        *("rates that are not explicit", "only a system says when"),
        "t is a coordinate",
    ),
    "in the lexicon, that it is left to the note (defined), or what of the system it is": (
        "any value is possible of",
    ),
    "a range, a sign or a value of what stands in it, as a condition of the line": (
        *(
            "this rests on the signs",
            "its roots leave open",
            "this power has no exact",
            "a condition:",
            "it holds for some values",
            "no values are known here",
        ),
        *("no value is known of this function", "the functions in this", "zero in special cases"),
        *("a root of higher degree", "a power of a function", "no counterexample among"),
        *("no bounds are known", "it has no value", "this has no value in a field"),
    ),
    "limits, or the range that it runs over": (
        *(
            "an integral without its",
            "not an integral over",
            "a limit of an integral",
            "a sum over",
        ),
        *(
            "a sum up to",
            "not an index",
            "a function under an integral",
            "no rule for this integral",
        ),
        *("the variable has a meaning", "the place of an element", "what this integral says"),
        *("a density under", "more than two instants", "a power of a density"),
        *("a limit of what", "no limit is known", "this goes to no limit"),
    ),
    'words that say what is small, as "for small theta"': (
        *("what is small here", "this is nothing that may be small", "this has no value where"),
        *("the order of the difference", "only scalars are compared nearly"),
    ),
    "what is held, as a function of coordinates and rates alone, or of coordinates and momenta alone": (
        *("whether rates or momenta", "this is not written in the momentum"),
    ),
    "a line above that says what these quantities are, or a law of motion that ties them": (
        *("this may be a law", "it may follow from the laws", "this is no identity"),
        *(
            "what leaves a body",
            "a relation continues nothing",
            "a condition that is no equation",
            "a condition that compares",
        ),
    ),
    "a condition that more motions fulfil, or a line that says what follows from it": (
        *("it does not hold without its condition", "under its conditions it holds"),
        *("no motion is known here that", "assumptions cannot stand", "no generator knows"),
        *("no solution of the system keeps", "unless more is assumed", "no counterexample in"),
    ),
    "the number of the one that is meant, from the slowest, or a word for the damping": (
        "more than one ",
    ),
    "the same as an equation, with the factor": ("in this proportion",),
    "a line of [notation] in the lexicon that says which": (
        *("what a product of quaternions is", "no spatial vector"),
    ),
    "a line above that defines them, or one such as {q, p} = 1, or `brackets` in [notation]": (
        "it rests on the sign of Poisson",
    ),
    "a line of [system.symbols] in the lexicon that says what the letter is": (
        "it fails with the energy of the system",
    ),
    "the same in components, with their frame": (
        "a derivative in another frame",
        *("a sum of unit vectors in", "a multiple of unit vectors", "derivatives of unit vectors"),
        *("the derivative of a matrix", "two sides have different", "tables of other sizes"),
        *("a diagonal of other", "only scalars are greater"),
    ),
    "the same written out, in shorter lines": (
        *("too long", "this is too large", "a number is too long", "a power is too large"),
        *(
            "a matrix that is too large",
            "an exponent is too large",
            "a determinant that is",
            "too many time",
            "more derivatives",
        ),
        *("something is left out", "words within a formula", "the order of a derivative"),
        *(
            "only equations between",
            "the formula is too long",
            "the meaning of this",
            "the judgement of this",
        ),
    ),
}
"""What would decide a line, and how the reasons begin for which it is undecided."""
SAME = "the same said of quantities that the lexicon or its system knows"
"""What would decide a line whose reason is none of these."""


def decided_by(reason: str) -> str:
    """Return why a line is undecided, with what would decide it."""
    if not reason:
        return f"to decide it: {SAME}"
    by = next((d for d, begins in DECIDES.items() if reason.startswith(begins)), SAME)
    return f"{reason}; to decide it: {by}" if by else reason


@dataclass(frozen=True)
class Remark:
    """What a formula has to do with the rest of the note.

    ``kind``: a row of a table, in words. ``text``: what is remarked. ``line``: of the note that it is
    about, from 1; 0 for none.
    """

    kind: str
    text: str
    line: int = 0


@dataclass(frozen=True)
class Finding:
    """A formula of a note, or a claim in words, with its verdict.

    ``number``: from 1, each kind apart; ``kind``: "display", "inline" or "prose"; ``line`` and
    ``column`` from 1; ``span``: place in ``source``; ``latex``: as it stands; ``verdict``: one of
    `ORDER`, "wrong" to "no claim"; ``remarks``: on its place in the note; ``sets``: smallest sets of
    assumptions under which it holds; ``reason``: of a verdict that needs one; ``place``: of the reason;
    ``read_as``: what was read otherwise than it stands; ``carried``: the line whose slip it carries
    forward, 0 for none; ``special``: of what is wrong in general, the special case in which it holds.
    """

    number: int
    kind: str
    source: Source
    span: Span
    latex: str
    verdict: str
    sets: tuple[tuple[str, ...], ...] = ()
    reason: str = ""
    place: Span = NOWHERE
    read_as: tuple[str, ...] = ()
    remarks: tuple[Remark, ...] = ()
    explanation: Explanation = UNEXPLAINED
    carried: int = 0
    special: str = ""

    @property
    def carries(self) -> str:
        """Whose slip it carries forward, in words, and whether it has one of its own; "" for none."""
        own = any(r.kind == CARRIED_AND_OWN for r in self.remarks)
        more = ", and has one of its own" if own else ""
        return f"the slip of line {self.carried}{more}" if self.carried else ""

    @property
    def line(self) -> int:
        """Line of the formula, from 1."""
        return self.source.line_column(self.span.start)[0]

    @property
    def column(self) -> int:
        """Column of the formula, from 1."""
        return self.source.line_column(self.span.start)[1]


@dataclass(frozen=True)
class Report:
    """What was found in a note.

    ``name``: of the note; ``findings``: in the order of the note; ``lexicon``: where the meanings of its
    symbols come from; ``drafts``: those that were taken from its words unconfirmed; ``unplaced``:
    symbols that the draft has no meaning for; ``given``: what was assumed without being said;
    ``notices``: what of the note was not read; ``questions``: which meanings would decide more lines, the
    most useful first.
    """

    name: str
    findings: tuple[Finding, ...]
    lexicon: str = ""
    drafts: tuple[Taken, ...] = ()
    unplaced: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
    notices: tuple[Remark, ...] = ()
    questions: tuple[Question, ...] = ()

    @property
    def equations(self) -> tuple[Finding, ...]:
        """The findings on formulas."""
        return tuple(f for f in self.findings if f.kind != PROSE)

    @property
    def claims(self) -> tuple[Finding, ...]:
        """The findings on claims in words."""
        return tuple(f for f in self.findings if f.kind == PROSE)

    @property
    def counts(self) -> dict[str, int]:
        """How many formulas and claims in words have each verdict, in the order of `ORDER`."""
        found = Counter(f.verdict for f in self.findings)
        return {v: found[v] for v in ORDER if found[v]}

    @property
    def faults(self) -> tuple[Finding, ...]:
        """What is wrong or ill-formed."""
        return tuple(f for f in self.findings if f.verdict in FAULTS)

    def __str__(self) -> str:
        """Return the report as text, as `eom check` prints it."""
        return "\n".join(text(line) for line in report_lines(Graded(self.name, self)))

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        """Print the report in a notebook."""
        del cycle
        printer.text(str(self))


@dataclass(frozen=True)
class Graded:
    """A note by its name with its ``report``, or with the ``error`` for which there is none."""

    name: str
    report: Report | None = None
    error: str = ""

    @property
    def status(self) -> str:
        """Return "nothing wrong", "wrong" or "unusable"."""
        if self.report is None:
            return "unusable"
        return "wrong" if self.report.faults else "nothing wrong"


Part = tuple[str, str]
"""Style ("title", "good", "bad", "unsure", "faint", "") and text."""
Line = tuple[Part, ...]

DETAILED = FAULTS | {UNSURE, "undecided", "ambiguous"}
"""Verdicts that are printed with the equation and the place."""

MAX_LINES = 24
"""Lines of one formula that are shown at most."""
WIDTH = 120
"""Characters of a formula that are shown at most where nothing is wrong."""
MAX_WIDTH = 2000
"""Characters of a line of a formula that are shown at most."""
CORRECTIONS = 3
"""Corrections that are printed at most."""
UNPLACED = 12
"""Symbols without a meaning that are listed at most."""
INDENT = "    "

UNCONFIRMED = (
    "    Nobody has confirmed these meanings: what is called wrong may be misread. --ask asks for",
    "    what is open; --propose prints the draft as a file for --lexicon; --notation names a preset.",
)


def text(line: Line) -> str:
    """Return a line without styles."""
    return "".join(part for _, part in line)


def report_lines(graded: Graded, only: Collection[str] = (), quiet: bool = False) -> Iterator[Line]:
    """Yield the lines on a note: where meanings come from, each formula, a summary.

    ``only``: verdicts of the formulas that are printed, all if empty; ``quiet``: faults alone.
    """
    report = graded.report
    if report is None:
        yield (("title", graded.name), ("", ": "), ("bad", "cannot be used"))
        yield from (_faint(INDENT + line) for line in printed(graded.error))
        return
    yield (("title", report.name or "note"),)
    yield from _head(report)
    chosen = only or (FAULTS if quiet else ())
    some = [f for f in report.findings if not chosen or f.verdict in chosen]
    for finding in some:
        yield ()
        yield from _finding(finding)
    if some:
        yield ()
    yield from _legend(some)
    yield _summary(report)


def total(graded: Sequence[Graded]) -> Line:
    """Return how many notes have something wrong, and how many cannot be used."""
    found = Counter(g.status for g in graded)
    return (
        ("title", f"{len(graded)} notes"),
        ("", f": {found['nothing wrong']} with nothing wrong, "),
        ("bad" if found["wrong"] else "", f"{found['wrong']} with something wrong"),
        ("", ", "),
        ("bad" if found["unusable"] else "", f"{found['unusable']} unusable"),
    )


def printed(message: str) -> list[str]:
    """Return the lines of a message as a terminal may print them."""
    return [printable(line) for line in message.splitlines()]


def _faint(words: str) -> Line:
    return (("faint", words),)


# -- head and summary ----------------------------------------------------------------------------


def _head(report: Report) -> Iterator[Line]:
    """Yield where meanings come from, what of the note was not read, and what was assumed."""
    draft = report.lexicon.startswith("draft")
    yield (("unsure" if draft else "faint", f"  meanings: {printable(report.lexicon)}"),)
    if draft:
        yield from map(_faint, UNCONFIRMED)
        yield from (_faint(f"    {printable(str(d))}") for d in report.drafts)
    if report.unplaced:
        names = ", ".join(report.unplaced[:UNPLACED])
        rest = len(report.unplaced) - UNPLACED
        more = f" and {rest} more" if rest > 0 else ""
        yield _faint(f"    without a meaning: {printable(names)}{more}")
    yield _faint(f"  given: {', '.join(report.given) or 'nothing'}")
    for notice in report.notices:
        yield (("unsure", f"  line {notice.line}, {notice.kind}: {printable(notice.text)}"),)


def _legend(findings: Iterable[Finding]) -> Iterator[Line]:
    """Yield the meanings of the assumptions that were named."""
    used = {n for f in findings for s in _all_sets(f) for n in s}
    names = [n for n in ASSUMPTIONS if n in used]
    width = max(map(len, names), default=0)
    if names:
        yield _faint("  assumptions")
        yield from (_faint(f"    {n:<{width}}  {ASSUMPTIONS[n].meaning}") for n in names)
        yield ()


def _all_sets(finding: Finding) -> Iterator[tuple[str, ...]]:
    yield from finding.sets
    for correction in finding.explanation.corrections[:CORRECTIONS]:
        yield from correction.sets
    if finding.explanation.counterexample is not None:
        yield finding.explanation.counterexample.assumptions


def _summary(report: Report) -> Line:
    """Return how many formulas and claims in words there are, and how many have each verdict."""
    total, claims = len(report.equations), len(report.claims)
    also = f" and {claims} claim{'' if claims == 1 else 's'} in words" if claims else ""
    parts: list[Part] = [("", f"  {total} equation{'' if total == 1 else 's'}{also}")]
    for verdict, count in report.counts.items():
        style, words = VERDICTS[verdict]
        parts += [("", ": " if len(parts) == 1 else ", "), (style, f"{count} {words}")]
    return tuple(parts)


# -- one formula ---------------------------------------------------------------------------------


def _finding(finding: Finding) -> Iterator[Line]:
    """Yield the verdict on a formula; of a fault the formula too, with carets, and what is known."""
    style = VERDICTS[finding.verdict][0]
    head: list[Part] = [("", f"  {_where(finding)}: "), (style, _verdict(finding))]
    yield tuple(head)
    if finding.verdict in DETAILED:
        yield from shown(finding.source, finding.span, _places(finding))
        if finding.reason:
            yield (("", f"{INDENT}why: {printable(finding.reason)}"),)
    else:
        yield _faint(f"{INDENT}{_one_line(finding.latex)}")
        if finding.verdict == UNDER and not finding.sets and finding.reason:
            yield (("", f"{INDENT}if {printable(finding.reason)}"),)
        if finding.verdict == HOLDS and finding.reason:
            yield (("", f"{INDENT}{printable(finding.reason)}"),)
    if finding.carried:
        yield (("", f"{INDENT}carries forward {finding.carries}"),)
    for words in dict.fromkeys(finding.read_as):
        yield _faint(f"{INDENT}{printable(words)}")
    yield from _explanation(finding)
    for remark in finding.remarks:
        if not (remark.kind in {CARRIED, CARRIED_AND_OWN} and finding.carried):
            whole = remark.text.startswith(remark.kind)
            words = remark.text if whole else f"{remark.kind}: {remark.text}"
            yield (("", f"{INDENT}{printable(words)}"),)


def _where(finding: Finding) -> str:
    """Return the place of a formula: its line, before that the cell of a notebook."""
    cell = finding.source.name.rpartition(", cell ")
    before = f"cell {cell[2]}, " if cell[1] or finding.source.name.startswith("cell ") else ""
    return f"{before}line {finding.line}"


def _verdict(finding: Finding) -> str:
    """Return the verdict with its sets of assumptions."""
    verdict = finding.verdict + " in general" * bool(finding.special)
    return " ".join([verdict, *(_sets(finding.sets) for _ in finding.sets[:1])])


def _sets(sets: Sequence[tuple[str, ...]]) -> str:
    return " or ".join("{" + ", ".join(s) + "}" if s else "what it rests on" for s in sets)


def _one_line(latex: str) -> str:
    return _cut(printable(" ".join(latex.split())), WIDTH)


def _whole(latex: str) -> str:
    return _cut(printable(" ".join(latex.split())), MAX_WIDTH)


def _cut(line: str, width: int) -> str:
    return line if len(line) <= width else line[: width - 3] + "..."


def _places(finding: Finding) -> tuple[Span, ...]:
    """Return what carets stand under: what is to blame, else an inline formula in its line."""
    blamed = (finding.place, *finding.explanation.blamed)
    found = tuple(dict.fromkeys(s for s in blamed if s != NOWHERE))
    return found or ((finding.span,) if finding.kind == "inline" else ())


def shown(source: Source, span: Span, places: Sequence[Span]) -> Iterator[Line]:
    """Yield the lines of a formula, with carets under places in it; a long one near the first place."""
    inside = source.text[span.start : span.stop]
    begins = span.start + len(inside) - len(inside.lstrip())
    first = source.line_column(begins)[0]
    last = source.line_column(max(span.stop - 1, begins))[0]
    by_line: dict[int, list[Span]] = {}
    for place in places:
        by_line.setdefault(source.line_column(place.start)[0], []).append(place)
    begin = max(first, min(by_line, default=first) - MAX_LINES // 2)
    lines = source.text.split("\n")
    for number in range(begin, min(last, begin + MAX_LINES) + 1):
        yield from _pointed(source, lines[number - 1], by_line.get(number, []))


def _pointed(source: Source, line: str, places: Sequence[Span]) -> Iterator[Line]:
    """Yield a line and carets under the places that begin in it; of a long line the first one alone."""
    if not places:
        yield from [(("", INDENT + _cut(printable(line), MAX_WIDTH)),)] if line.strip() else []
        return
    carets = [" "] * len(line) + [" "]
    for place in places:
        column = source.line_column(place.start)[1] - 1
        width = max(1, min(place.stop - place.start, len(line) - column))
        carets[column : column + width] = "^" * width
    text, marks = printable(line), "".join(carets).rstrip()
    if len(line) > WIDTH:
        text, column, width = source.shown(places[0])
        marks = " " * column + "^" * width
    yield (("", INDENT + text),)
    yield (("bad", INDENT + marks),)


def _explanation(finding: Finding) -> Iterator[Line]:
    """Yield what is too much, what would make it right, and where it fails."""
    explained = finding.explanation
    if explained.residual:
        yield (("", f"{INDENT}left side minus right side: {_whole(explained.residual)}"),)
    if explained.convention:
        yield (("unsure", f"{INDENT}{explained.convention}"),)
    for correction in explained.corrections[:CORRECTIONS]:
        under = f", under {_sets(correction.sets)}" if correction.sets else ""
        yield (("good", f"{INDENT}repair: {printable(correction.change)}{under}"),)
        yield (("", f"{INDENT}        {_whole(correction.latex)}"),)
    if finding.special:
        yield (("good", f"{INDENT}or state: {printable(finding.special)}"),)
    counter = explained.counterexample
    if counter is not None:
        under = f", under {_sets([counter.assumptions])}" if counter.assumptions else ""
        values = ", ".join(f"{_one_line(n)} = {v}" for n, v in counter.values)
        members = "; ".join(f"{_one_line(n)} = {v}" for n, v in counter.members)
        yield (("", f"{INDENT}it fails for {values}{under}"),)
        yield (("", f"{INDENT}  where {members}"),)


VERSION = 2
"""Of the schema; raised where a reader of an older one could go wrong. 2: findings of kind "prose"."""

Data = dict[str, Any]


def to_json(graded: Iterable[Graded]) -> str:
    """Return all reports as JSON; notes without a report with their error."""
    data = {"version": VERSION, "notes": [note(g) for g in graded]}
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def note(graded: Graded) -> Data:
    """Return the report on one note as data."""
    head = {"name": graded.name, "status": graded.status, "error": graded.error}
    return head | (_report(graded.report) if graded.report is not None else {})


def _report(report: Report) -> Data:
    return {
        "meanings": report.lexicon,
        "drafts": list(map(str, report.drafts)),
        "unplaced": list(report.unplaced),
        "given": list(report.given),
        "notices": [{"text": n.text, "line": n.line} for n in report.notices],
        "questions": [asdict(q) for q in report.questions],
        "counts": report.counts,
        "findings": [finding(f) for f in report.findings],
    }


def finding(found: Finding) -> Data:
    """Return what is said of a formula; places are lines and columns from 1, of first and last sign."""
    names = "kind number in place latex verdict sets reason at read_as remarks carried special explanation"
    own = {"in": found.source.name, "place": found.span, "at": found.place}
    values = {name: own[name] if name in own else getattr(found, name) for name in names.split()}
    return {name: _datum(value, found.source) for name, value in values.items()}


def _datum(value: Any, source: Source) -> Any:
    """Return a value of a finding as data."""
    if isinstance(value, Span):
        return place(source, value)
    if isinstance(value, tuple):
        return [_datum(v, source) for v in value]
    if isinstance(value, Remark | Correction | Counterexample | Explanation):
        names = {f.name: "at" if f.name == "span" else f.name for f in fields(value)}
        return {shown: _datum(getattr(value, name), source) for name, shown in names.items()}
    return value


def place(source: Source, span: Span) -> Data | None:
    """Return a place in a source, None for none."""
    if span == NOWHERE:
        return None
    line, column = source.line_column(span.start)
    last_line, last_column = source.line_column(max(span.stop - 1, span.start))
    return {"line": line, "column": column, "last_line": last_line, "last_column": last_column}


# -- tables --------------------------------------------------------------------------------------

COLUMNS = ("note", "status", "equations", *ORDER, "first_fault", "meanings", "error")


def rows(graded: Iterable[Graded]) -> list[Data]:
    """Return one row a note: counts of verdicts, and the line of the first fault, "" for none."""
    return [_row(g) for g in graded]


def _row(graded: Graded) -> Data:
    report = graded.report or Report(graded.name, ())
    faults = report.faults
    return {
        "note": graded.name,
        "status": graded.status,
        "equations": len(report.equations) - report.counts.get("no claim", 0),
        **{v: report.counts.get(v, 0) for v in ORDER},
        "first_fault": faults[0].line if faults else "",
        "meanings": report.lexicon,
        "error": "; ".join(" ".join(line.split()) for line in graded.error.splitlines()),
    }


def to_csv(graded: Iterable[Graded]) -> str:
    """Return the table as CSV; no cell is taken for a formula by a spreadsheet."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for row in rows(graded):
        writer.writerow({k: _cell(v) for k, v in row.items()})
    return stream.getvalue()


def to_table_json(graded: Iterable[Graded]) -> str:
    """Return the table as JSON: a list of objects with the columns of the CSV."""
    return json.dumps(rows(graded), indent=1, ensure_ascii=False) + "\n"


def _cell(value: object) -> object:
    """Return a cell; text that a spreadsheet would evaluate gets an apostrophe in front."""
    evaluated = isinstance(value, str) and value[:1] in {"=", "+", "-", "@", "\t", "\r"}
    return f"'{value}" if evaluated else value
