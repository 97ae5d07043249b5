"""What is found of the claims that a note makes in words: sentences with their verdicts and places.

`SENTENCES` is the table of what is read as a whole: the stability of spins, the sense of precession, the
points about which an equation is valid ("(5) holds if taken about the centre of mass"), what an equation
shows. All other sentences are clauses, alone or under a condition (`quantified`). A claim is called wrong
only where nothing in its section hints at an assumption that is not understood.

Stability is judged by the linearised equations: the free rigid body (`eom.mechanics.steady`), the body with
a viscous slug (`eom.mechanics.dissipation`), the symmetric body in free precession
(`eom.mechanics.freebody`; Hughes, Spacecraft Attitude Dynamics, 1986, ch. 4 and 5). The sign that decides
is the same for all moments in one order, so one body stands for all. Quantities of an equation that are
about a point are taken about O, and judged in worlds where O is the point that the words name; an equation
with a slip stands for its most plausible repair. An equation does not show that a matrix is a rotation
where it holds as well with twice the matrix in its place; nothing else is decided of what equations show.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property

from eom.checker.judge.judge import HOLDS, UNDECIDED, UNDER, WRONG, judge, judge_within
from eom.checker.judge.models import equations
from eom.checker.judge.notes import Understood
from eom.checker.judge.verdicts import GRAVE, verdict
from eom.checker.mean.claims import EQUALITIES, STATEMENT, Claim
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.values import Refusal
from eom.checker.prose_claims.assumptions import Said, implied, said
from eom.checker.prose_claims.phrases import Formulas, Point, Subject, phrase, point
from eom.checker.prose_claims.propositions import All, Plain, Proposition, Reading, Test
from eom.checker.prose_claims.quantified import Decision, decide, quantified, stages
from eom.checker.prose_claims.sentences import Displays, Sentence, pointed, sentences
from eom.checker.read.documents import Document, Piece
from eom.checker.read.symbol_shape import labels
from eom.checker.repair.corrections import corrections, workshop
from eom.checker.repair.lines import line
from eom.checker.report.findings import PROSE, Counterexample, Explanation, Finding
from eom.errors import InputError
from eom.limits import Overdue, deadline
from eom.mechanics.dissipation import damped_stability
from eom.mechanics.freebody import precession
from eom.mechanics.steady import spin_stability
from eom.terms.terms import MATRIX, VECTOR, Term, add, atom, mul, nodes, number
from eom.terms.terms import replace as rewritten
from eom.worlds.worlds import closure


def in_words(
    document: Document,
    understood: Sequence[Understood],
    stated: Sequence[frozenset[str]],
    given: tuple[str, ...],
    seconds: float,
    drafted: bool = False,
) -> tuple[Finding, ...]:
    """Return what is found of the claims in words; ``stated``: what the note has stated at each formula.

    ``seconds``: for one sentence; what takes longer is left out. ``drafted``: nobody has confirmed the
    meanings of symbols, so that no sentence with formulas is called wrong.
    """
    pieces = document.pieces
    numbers = [k for k, p in enumerate(pieces) if p.is_formula]
    by_piece = {k: (u, s) for k, u, s in zip(numbers, understood, stated, strict=True)}
    phrases = said(pieces)
    displays = Displays(pieces, {k: u for k, (u, _) in by_piece.items()})
    found: list[Finding] = []
    for sentence in sentences(pieces):
        try:
            with deadline(seconds, "the judgement of this sentence"):
                text, terms = pointed(sentence.text, sentence.first, displays)
                formulas = _formulas(sentence, displays.understood, text, terms)
                names = _stated(sentence, by_piece, phrases)
                around = Around(displays.understood, formulas, names, given, sentence, pieces)
                decision = decided(text, around)
        except (Overdue, RecursionError):
            continue
        if decision is not None:
            decision = _softened(decision) if drafted and sentence.formulas else decision
            found.append(_finding(sentence, decision, len(found) + 1))
    return tuple(found)


def _finding(sentence: Sentence, decision: Decision, number: int) -> Finding:
    return Finding(
        number,
        PROSE,
        sentence.source,
        sentence.span,
        sentence.source.text[sentence.span.start : sentence.span.stop],
        decision.verdict,
        decision.sets,
        decision.reason,
        explanation=Explanation(counterexample=decision.counterexample),
    )


# -- formulas -------------------------------------------------------------------------------------


def _formulas(
    sentence: Sentence,
    understood: Mapping[int, Understood],
    text: str,
    terms: Mapping[int, Subject],
) -> Formulas:
    """Return what the formulas of a sentence say or stand for; ``text``: with marks of displays.

    ``terms``: what other marks stand for.
    """
    propositions: dict[int, Proposition] = {}
    subjects: dict[int, Subject] = dict(terms)
    points: dict[int, str] = {}
    marks = {int(n) for n in re.findall("\x02(\\d+)\x03", text)}
    for k in sorted({*sentence.formulas, *(marks & set(understood))}):
        one = understood[k]
        name, said_there, subject = _point(one), _said(one), _subject(one)
        propositions |= {} if said_there is None else {k: said_there}
        subjects |= {} if subject is None else {k: subject}
        points |= {} if name is None else {k: name}
    return Formulas(propositions, subjects, points)


def _said(one: Understood) -> Proposition | None:
    """Return what an inline formula says: equations that are understood without a flaw."""
    found = []
    for claim in one.claims:
        if claim.findings or claim.role or claim.model is not None or not claim.members:
            return None
        made = _proposition(claim, one.formula.piece.body.strip())
        if made is None:
            return None
        found.append(made)
    return found[0] if len(found) == 1 else All(tuple(found)) if found else None


def _proposition(claim: Claim, latex: str) -> Plain | None:
    try:
        tests = tuple(Test(add(q.left, -q.right)) for q in equations(claim))
    except InputError:
        return None
    return Plain(latex, (Reading((tests,)),), claim.scalars) if tests else None


def _subject(one: Understood) -> Subject | None:
    """Return what an inline formula without a relation stands for."""
    if one.formula.reading is None or one.formula.relational or one.lexicon.system is not None:
        return None
    e = elaborator(one.lexicon, dict(one.around.definitions))
    try:
        value = e.value(one.formula.reading.tree)
    except Refusal:
        return None
    return Subject(one.formula.piece.body.strip(), ((value.term, ""),), dict(e.scalars))


def _point(one: Understood) -> str | None:
    if one.formula.reading is None:
        return None
    return one.lexicon.points.get(labels(one.formula.reading.tree))


def _stated(
    sentence: Sentence,
    by_piece: Mapping[int, tuple[Understood, frozenset[str]]],
    phrases: Sequence[Said],
) -> frozenset[str]:
    """Return what has been stated before a sentence: what it says itself is left out."""
    start = (sentence.first, sentence.span.start)
    before = implied(
        n for s in phrases if s.start < start and sentence.first < s.stop for n in s.names
    )
    own = implied(
        n
        for s in phrases
        if s.source is sentence.source and sentence.span.start <= s.start[1] < sentence.span.stop
        for n in s.names
    )
    inside = [by_piece[k][1] for k in sentence.formulas[:1]]
    earlier = [by_piece[k][1] for k in sorted(by_piece) if k < sentence.first][-1:]
    there = (inside or earlier or [frozenset[str]()])[0]
    kept = before | (earlier[0] if earlier else frozenset[str]())
    return before | (there - (own - kept))


# -- what stands around ---------------------------------------------------------------------------

_LEADS = re.compile(
    r"\b(?:consider|suppose|assum\w+|let|restrict\w*|special case|in (?:the|this|that) case|for an?|take|"
    r"now|here)\b",
    re.IGNORECASE,
)
_CONDITIONS = re.compile(r"\b(?:if|when|while|where)\b")
"""Words that do so for their paragraph."""
_MOTIFS = re.compile(
    r"\b(?:spher\w+|cub\w+|spin\w*|rotat\w+ about|plan(?:e|ar) |tops?\b|dis[ck]s?\b|rods?\b|at rest|"
    r"constant (?:rate|speed|angular)|fixed ax\w+|hinge\w*|pivot\w*|gyro\w*|wheel\w*|rotor\w*|orbit\w*|"
    r"steady|uniform\w*|pendul\w+|damp\w+|dissipat\w+|pure|roll\w+|particle|point mass|deform\w+|"
    r"flexib\w+|elastic|fluid|variable mass|rocket)",
    re.IGNORECASE,
)
"""Words that may narrow down what is talked about in ways that are not understood here."""
_OTHERS = re.compile(
    r"\b(?:dissipat|damp|flexib|slosh|fluid|sink|dual|rotor|wheel|orbit|gravity|elastic)"
)
"""Words after which a sentence may be about some other body than a free one, rigid or with losses."""
_SIZES = re.compile(
    rf"{_OTHERS.pattern}|normali[sz]|orthonormal|unit (?:vector|length|norm)|right[- ]handed|orthogonal"
)
"""Words that may also say elsewhere what the equation does not show."""


@dataclass(frozen=True)
class Around:
    """What a note says around a sentence: displays by number, its formulas, assumptions, its pieces."""

    displays: Mapping[int, Understood] = field(default_factory=dict)
    formulas: Formulas = field(default_factory=lambda: Formulas({}, {}, {}))
    stated: frozenset[str] = frozenset()
    given: tuple[str, ...] = ()
    sentence: Sentence | None = None
    pieces: Sequence[Piece] = ()

    @cached_property
    def before(self) -> tuple[Sentence, ...]:
        """The sentences of the section that stand in front of this one."""
        if self.sentence is None:
            return ()
        begin, place = self.sentence.first, (self.sentence.source, self.sentence.span.start)
        while begin > 0 and self.pieces[begin].kind != "heading":
            begin -= 1
        run = self.pieces[begin : self.sentence.first + 1]
        found = sentences([p for p in run if p.source is place[0]])
        return tuple(one for one in found if one.span.start < place[1])

    @cached_property
    def hinted(self) -> bool:
        """Whether a sentence before this one in its section may assume what is not understood."""
        return any(
            _LEADS.search(s.text) or self.near(s) for s in self.before if _MOTIFS.search(s.text)
        )

    def near(self, one: Sentence) -> bool:
        """Whether a sentence has a condition and stands in the paragraph of this one."""
        assert self.sentence is not None
        between = one.source.text[one.span.stop : self.sentence.span.start]
        return not re.search(r"\n[ \t]*\n", between) and _CONDITIONS.search(one.text) is not None


NOTHING = Around()


def decided(text: str, around: Around = NOTHING) -> Decision | None:
    """Return the verdict on a sentence, None where it claims nothing that is understood.

    ``text``: small letters, formulas as marks, without brackets and full stop.

    >>> decided("rotation about the intermediate axis is stable").verdict
    'wrong'
    >>> decided("spin about the axis of minimum inertia is unstable with energy dissipation").verdict
    'holds under'
    """
    for words, _, refers in stages(text):
        for pattern, rule, doubts in SENTENCES:
            match = re.fullmatch(phrase(pattern), words)
            found = rule(match, around) if match else None
            if found is not None:
                doubted = refers or any(doubts.search(one.text) for one in around.before)
                return _softened(found) if doubted else found
    one = quantified(text, around.formulas)
    if one is None:
        return None
    decision = decide(one, around.stated, around.given, around.hinted)
    silent = decision.verdict == UNDECIDED and one.kind == "" and decision.counterexample is None
    return None if silent else decision


def _softened(found: Decision) -> Decision:
    """Return a verdict where the note may assume more than is understood."""
    return replace(found, verdict=UNDECIDED) if found.verdict == WRONG else found


# -- the stability of spins -----------------------------------------------------------------------

RANKS: dict[str, int] = {
    **dict.fromkeys(("smallest", "least", "minimum", "minimal", "minor", "min"), 1),
    **dict.fromkeys(("intermediate", "middle", "medium"), 2),
    **dict.fromkeys(("largest", "greatest", "maximum", "maximal", "major", "max"), 3),
}
"""Words for a principal moment among three different ones, and its place by size."""
MOMENTS = (2, 3, 4)
"""Principal moments of inertia of the body that stands for all with three different ones."""
SHAPES = {"prolate": (3, 3, 2), "oblate": (3, 3, 4)}
"""Moments of a body with an axis of symmetry, that about it last."""
SENSES = {"direct": "direct", "prograde": "direct", "retrograde": "retrograde"}

_INERTIA = r"(?: (?:principal )?(?:moment of inertia|inertia|principal moment))?"
_RANK = "|".join(RANKS)
_AXIS = (
    r"(?:the|its|an?) (?:ax[ie]s (?:of|with) (?:the )?)?"
    rf"(?P<first>{_RANK}){_INERTIA}(?:(?: ax[ie]s)? and(?: the)? (?P<second>{_RANK}){_INERTIA})?"
    r"(?: ax[ie]s)?|its (?:axis of symmetry|symmetry axis)"
)
_SHAPED = (
    rf"an? (?P<shape>{'|'.join(SHAPES)})(?: (?:axi)?symmetric)?(?: rigid)? "
    r"(?:body|spacecraft|satellite)"
)
_SPINNING = (
    rf"(?:(?:(?P<lost><loss>)|(?P<kept><lossless>)),? )?(?P<only>only )?<spin>"
    rf"(?: of (?:(?:a|the) (?:rigid )?body|{_SHAPED}))? about (?:{_AXIS}) "
    r"(?:is|are)(?: always| also)? (?:(?P<unstable>unstable|not stable)|(?:directionally )?stable)"
    r"(?:,? (?:(?P<losing><loss>)|(?P<rigid><lossless>)))?"
)
_MODELS = {
    False: ("rigid", "torque_free"),
    True: ("no torque acts from outside", "energy is lost inside"),
}
"""What is assumed of a body that loses no energy, and of one that does."""
_UNEQUAL = "three different principal moments of inertia"
_SYMMETRY = {False: "symmetric", True: "an axis of inertial symmetry"}


def _of_spins(match: re.Match[str], _: Around) -> Decision | None:
    """Return the verdict on "the spin about such axes is stable".

    What is wrong for a rigid body and right for one that loses energy, or the other way round, is
    undecided where the sentence names neither.
    """
    found = match.groupdict()
    shape = SHAPES.get(found["shape"] or "")
    ranks = {RANKS[found[n]] for n in ("first", "second") if found[n]}
    if (shape is None) != bool(ranks):
        return None
    moments, stable = shape or MOMENTS, not found["unstable"]
    ranks = ranks or {3}
    others = {1, 2, 3} - ranks if found["only"] else set[int]()
    claimed = {**dict.fromkeys(ranks, stable), **dict.fromkeys(others, not stable)}
    loses = bool(found["lost"] or found["losing"])
    against, elsewhere = (_against(moments, claimed, lost) for lost in (loses, not loses))
    if not against:
        return Decision(UNDER, ((*_MODELS[loses], _SYMMETRY[loses] if shape else _UNEQUAL),))
    rank, reason = next(iter(against.items()))
    named = loses or found["kept"] or found["rigid"]
    if named or elsewhere:
        return Decision(WRONG, (), reason, _body(moments, rank))
    reason = f"{reason} for a rigid body; it is right where {' and '.join(_MODELS[not loses])}"
    return Decision(UNDECIDED, (), reason, _body(moments, rank))


def _against(moments: tuple[int, ...], claimed: Mapping[int, bool], loses: bool) -> dict[int, str]:
    """Return the axes whose spin is not what is claimed, each with what it is."""
    kinds = {rank: _kind(moments, rank, loses) for rank in sorted(claimed)}
    wrong = [r for r, kind in kinds.items() if (kind == "stable") != claimed[r]]
    return {r: f"the spin about b{r} is {kinds[r]}" for r in wrong}


@cache
def _kind(moments: tuple[int, ...], rank: int, loses: bool) -> str:
    return damped_stability(moments, rank) if loses else spin_stability(moments, rank).kind


def _body(moments: tuple[int, ...], rank: int = 0) -> Counterexample:
    """Return a body in numbers, and its spin about an axis."""
    spin = tuple(int(k == rank) for k in (1, 2, 3))
    values = ((r"I_C", rf"\mathrm{{diag}}{moments}"), (r"\omega", str(spin)))
    return Counterexample(values if rank else values[:1], ())


def _of_sense(match: re.Match[str], _: Around) -> Decision:
    moments = SHAPES[match["shape"]]
    found = precession(moments[0], moments[2], (1, 0, 1)).sense
    if found == SENSES[match["sense"]]:
        return Decision(UNDER, ((*_MODELS[False], _SYMMETRY[False]),))
    return Decision(WRONG, (), f"it is {found}", _body(moments))


# -- points of an equation ------------------------------------------------------------------------

_QUANTITIES = frozenset({"torque", "inertia", "angular_momentum", "absolute_angular_momentum"})
_LAWS = ("body_frame", "newton_2", "third_law_strong")
_PLACES = frozenset({"about_centre", "O_fixed_in_space", "O_at_origin", "C_at_rest"})
"""What a note may state of the points, and the words of the claim say otherwise."""


def _at_points(match: re.Match[str], around: Around) -> Decision | None:
    """Return the verdict on "this holds about such points"."""
    one = around.displays.get(int(match["number"]))
    points = _points(match["points"])
    claim = _claim(one, around.given, around.stated) if one and points else None
    if points is None or claim is None:
        return None
    known = [n for n in around.stated if n not in _PLACES]
    decided = [_at(claim, words, row[1], known, around.given) for words, row in points]
    found = [d for d in decided if d is not None]
    if len(found) < len(decided):
        return None
    return next((d for d in found if d.verdict == WRONG), found[0])


def _points(words: str) -> list[tuple[str, Point]] | None:
    """Return the row of each of the points, None if one of them is not known here."""
    parts = re.split(r",? or (?:about |with respect to |relative to )?", words)
    found = [(part.strip(), point(part.strip())) for part in parts]
    known = [(words, row) for words, row in found if row is not None]
    return known if len(known) == len(found) else None


def _claim(one: Understood, given: tuple[str, ...], stated: frozenset[str]) -> Claim | None:
    """Return what a display says with all its points called O; of one with a slip, what was meant."""
    judged = verdict(one, given).claims
    if len(judged) != 1:
        return None
    claim = judged[0].claim
    if judged[0].verdict in GRAVE:
        wrong = line(one, claim)
        found = corrections(one, workshop(one, wrong, given), given, stated) if wrong else []
        if not found:
            return None
        claim = found[0].claim
    plain = claim.kind == STATEMENT and EQUALITIES.issuperset(claim.relations) and claim.members
    if claim.findings or claim.model is not None or not plain:
        return None
    terms = [*(m.term for m in claim.members), *claim.scalars.values()]
    names = {n.data[0] for t in terms for n in nodes(t) if n.head == "atom"}
    return _about_o(claim) if names & _QUANTITIES and "position" not in names else None


def _about_o(claim: Claim) -> Claim:
    def rule(term: Term) -> Term:
        about = term.head == "atom" and term.data[0] in _QUANTITIES and term.data[-1] == "C"
        return atom(*term.data[:-1], "O", kind=term.kind) if about else term

    members = tuple(replace(m, term=rewritten(m.term, rule)) for m in claim.members)
    scalars = {s: rewritten(t, rule) for s, t in claim.scalars.items()}
    return replace(claim, members=members, scalars=scalars)


def _at(
    claim: Claim, words: str, names: tuple[str, ...], known: list[str], given: tuple[str, ...]
) -> Decision | None:
    """Return whether a claim holds about one point, None where no world decides."""
    for assumed in _largest([*_LAWS, *names], known):
        found = judge_within(claim, assumed, given)
        if found.verdict == WRONG:
            return Decision(WRONG, (), _failing(claim, words, assumed, given))
        if found.sets:
            return Decision(UNDER, found.sets)
        return Decision(found.verdict, (), found.reason)
    return None


def _largest(names: list[str], known: list[str]) -> Iterator[frozenset[str]]:
    """Yield what is assumed: with all that is known if that can stand together, else without."""
    for more in (known, []):
        try:
            yield closure([*names, *more])
        except InputError:
            continue


def _failing(claim: Claim, words: str, assumed: frozenset[str], given: tuple[str, ...]) -> str:
    """Return that a claim fails about a point, and what else that needs to be."""
    for more, meaning in (
        ("O_fixed_in_body", "fixed in the body"),
        ("O_fixed_in_space", "fixed in space"),
    ):
        try:
            wider = closure([*assumed, more])
        except InputError:
            continue
        if more not in assumed and judge_within(claim, wider, given).verdict != WRONG:
            return f"about {words} it fails, unless that is {meaning} as well"
    return f"about {words} it fails"


# -- what an equation shows -----------------------------------------------------------------------

KINDS: tuple[tuple[str, str, str], ...] = (
    ((r"(?:an? )?(?:proper )?rotation(?: matrix)?|(?:an? )?direction cosine matrix|"
     r"(?:an? )?(?:proper )?(?:orthogonal|orthonormal)(?: matrix)?"), MATRIX, "rotation matrix"),
    (r"(?:an? )?unit vector|normali[sz]ed|of unit (?:length|magnitude|norm)", VECTOR, "unit vector"),
)  # fmt: skip
"""Properties that twice a quantity does not have, its kind, and the property in a word."""

FREE = frozenset({"eigenvectors", "vector"})
"""Quantities that have no such property by what they mean."""


def _shown(match: re.Match[str], around: Around) -> Decision | None:
    """Return that an equation does not show what is said, None where nothing is known."""
    one = around.displays.get(int(match["number"]))
    subject = around.formulas.subjects.get(int(match["subject"]))
    if one is None or subject is None:
        return None
    term = subject.terms[0][0]
    kind = next((k for k in KINDS if term.kind == k[1] and re.fullmatch(k[0], match["kind"])), None)
    free = term.head == "atom" and term.data[0] in FREE
    if kind is None or not free or not one.claims or not _unmoved(one, term, around.given):
        return None
    name, line = subject.text, one.formula.piece.line
    reason = f"line {line} holds with 2 {name} in place of {name} as well, which is no {kind[2]}"
    return Decision(WRONG, (), reason)


def _unmoved(one: Understood, term: Term, given: tuple[str, ...]) -> bool:
    """Return whether all claims that have a term hold, and hold no less with twice the term."""
    claims = [c for c in one.claims if _twice(c, term) != c]
    if not claims or any(c.findings or c.model is not None for c in claims):
        return False
    for claim in claims:
        before, behind = judge(claim, given), judge(_twice(claim, term), given)
        good = {before.verdict, behind.verdict} <= {HOLDS, UNDER}
        if not good or not set(before.sets) <= set(behind.sets or before.sets):
            return False
    return True


def _twice(claim: Claim, term: Term) -> Claim:
    def rule(node: Term) -> Term:
        return mul(number(2), node) if node == term else node

    members = tuple(replace(m, term=rewritten(m.term, rule)) for m in claim.members)
    return replace(claim, members=members)


# -- the table ------------------------------------------------------------------------------------

Rule = Callable[[re.Match[str], Around], Decision | None]

SENTENCES: tuple[tuple[str, Rule, re.Pattern[str]], ...] = (
    (_SPINNING, _of_spins, _OTHERS),
    (rf"(?:the )?(?:(?:free|torque-free) )?precession of {_SHAPED} is (?P<sense>{'|'.join(SENSES)})",
     _of_sense, _OTHERS),
    ((r"\x02(?P<number>\d+)\x03 holds (?:(?:if|when|provided) )?(?:it is |they are |both are )?"
     r"(?:(?:calculated|taken|computed|evaluated|written|expressed|formed|derived) )?"
     r"(?:about|with respect to|relative to) (?P<points>.+)"), _at_points, _OTHERS),
    ((r"\x02(?P<number>\d+)\x03 (?:shows|proves|demonstrates|implies|means)(?: that)? "
     r"(?:the (?:matrix|vector) )?\x02(?P<subject>\d+)\x03 (?:is|must be|has to be)<adverbs> (?P<kind>.+)"),
     _shown, _SIZES),
)  # fmt: skip
"""Sentences that are read as a whole, what judges them, and words before them that leave them open."""
