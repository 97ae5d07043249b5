"""The report on a note: what was found of every formula, in order.

What is said of a wrong line: what is left over, what would make it right, and where it fails.

What became of a note among many: its report, or the error that left none.

How notes are checked.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from eom.checker.read.places import NOWHERE, Source, Span

if TYPE_CHECKING:
    from eom.opening import AnyScene
    from eom.system import System


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
    ``convention``: what other convention makes the line right, "" for none.
    """

    residual: str = ""
    blamed: tuple[Span, ...] = ()
    corrections: tuple[Correction, ...] = ()
    counterexample: Counterexample | None = None
    convention: str = ""


UNEXPLAINED = Explanation()
"""Nothing is said."""


FAULTS = frozenset({"wrong", "ill-formed"})
"""Verdicts that say that something is wrong."""

ORDER = (
    "wrong",
    "ill-formed",
    "ambiguous",
    "undecided",
    "holds under",
    "holds",
    "definition",
    "assumption",
    "no claim",
)
"""All verdicts, the gravest first; the last one is that of a display that claims nothing."""


PROSE = "prose"
"""The kind of a finding on a claim in words."""


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
    forward, 0 for none.
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
    ``notices``: what of the note was not read.
    """

    name: str
    findings: tuple[Finding, ...]
    lexicon: str = ""
    drafts: tuple[str, ...] = ()
    unplaced: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
    notices: tuple[Remark, ...] = ()

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
        from eom.checker.report.report_text import text, told

        return "\n".join(text(line) for line in told(Graded(self.name, self)))

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
    ``note_seconds``: for a note.
    """

    notation: str = ""
    lexicon: str = ""
    given: tuple[str, ...] = GIVEN
    kind: str = ""
    system: str | System | AnyScene | None = None
    seconds: float = FORMULA_SECONDS
    note_seconds: float = NOTE_SECONDS
