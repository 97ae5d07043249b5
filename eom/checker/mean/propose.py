r"""A draft of a lexicon from a note's own words: what its symbols are said to be, and what is left.

The preset that knows most symbols is taken; symbols that it does not know are looked for in the text
beside them ("r points from the centre of mass to ...", "the angular velocity, w, of B"). The writer
confirms: nothing of this is used without being asked for.

What the words of a note say of its attitude coordinates: sequences of angles, quaternions, axes.

"the 3-2-1 Euler angles $\psi$, $\theta$, $\phi$", "$(\phi, \theta, \psi)$ are roll, pitch and yaw": three
angles belong to a sequence only where the words beside them name it.

Where the meanings of a note's symbols come from: a preset, a file, the note itself, or a draft.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from eom.checker.mean.claims import claims
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.elaborator import FUNCTIONS
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import (
    PRESETS,
    in_yaml,
    lexicon_found,
    lexicon_of,
    lexicon_text,
    parse_lexicon,
    preset,
)
from eom.checker.mean.values import Refusal
from eom.checker.read.documents import Document, Piece
from eom.checker.read.spans import printable
from eom.checker.read.statements import Formula, Statement, read
from eom.checker.read.symbol_shape import Labels, Look, seen
from eom.checker.read.syntax import (
    Derivative,
    Differential,
    Group,
    Integral,
    Node,
    Number,
    Sequence,
    Symbol,
    children,
)
from eom.checker.read.writing import latex_of
from eom.errors import InputError
from eom.limits import Overdue
from eom.terms.terms import INDICES

ATTITUDE_WINDOW = 110
"""Characters of prose on either side of a list of angles."""

Said = tuple[Look, str, str, int]
"""A symbol, what it means, the words that say so, their line."""

_ATTITUDES: tuple[tuple[str, str], ...] = (
    (r"shadow (?:set|parameters)", "shadow_rodrigues B I in B"),
    (r"modified rodrigues|\bMRPs?\b", "modified_rodrigues B I in B"),
    (r"rodrigues (?:parameters|vector)|gibbs(?:ian)? vector|\bCRPs?\b", "rodrigues B I in B"),
    (r"scalar part|scalar (?:euler|component of the quaternion)", "euler_parameter 0 B I"),
    (r"vector part", "euler_vector B I in B"),
    (r"quaternion,? (?:\w+ )*scalar[- ](?:part |component )?last", "quaternion_last B I"),
    (r"scalar[- ]last quaternion", "quaternion_last B I"),
    (r"quaternion|euler parameters", "quaternion B I"),
    (r"(?:principal|euler|rotation) axis|axis of (?:the )?rotation|euler vector",
     "principal_axis B I in B"),
    (r"principal (?:rotation )?angle|angle of (?:the )?rotation", "principal_angle B I"),
)  # fmt: skip
"""Words that say what a symbol of attitude is."""

COLUMNS = frozenset(
    "quaternion quaternion_last euler_vector rodrigues modified_rodrigues shadow_rodrigues "
    "principal_axis".split()
)
"""Quantities that are written as plain letters by some, as marked ones by others."""

_NUMBERS = re.compile(r"\b([123])\s?[-–—]\s?([123])\s?[-–—]\s?([123])\b|\b([123])([123])([123])\b")
_LETTERS = re.compile(r"\b([xyzXYZ])\s?[-–—]?\s?([xyzXYZ])\s?[-–—]?\s?([xyzXYZ])\b")
_YAW = (
    (re.compile(r"yaw\W+(?:and )?pitch\W+(?:and )?roll", re.IGNORECASE), "321"),
    (re.compile(r"roll\W+(?:and )?pitch\W+(?:and )?yaw", re.IGNORECASE), "space123"),
)
_FIXED = re.compile(
    r"space[- ](?:fixed|three|two|axes|order)|fixed axes|extrinsic|\bspace\b", re.IGNORECASE
)
_ANGLES = re.compile(r"angle|rotation|sequence|turn", re.IGNORECASE)
_BETWEEN = re.compile(r"^[\s,$]*(?:and|then)?[\s,$]*$")


def angles(formulas: tuple[Formula, ...]) -> Iterator[Said]:
    """Yield the angles of sequences that the words beside them name."""
    for looks, before, after, line in _lists(formulas):
        said = next(((s, text) for text in (before, after) if (s := _sequence(text))), None)
        if len(looks) == len(set(looks)) == 3 and said is not None:
            for k, look in enumerate(looks, 1):
                yield look, f"turn_angle {k} {said[0]} B I", said[1], line


def components(look: Look, meaning: str) -> Iterator[tuple[Look, str]]:
    """Yield the components that go with a letter: of a quaternion, of Rodrigues parameters."""
    quantity, *labels = meaning.split()
    if look.sub or look.sup:
        return
    bare = replace(look, accents=(), style="")
    if quantity in {"quaternion", "quaternion_last"}:
        last = quantity == "quaternion_last"
        yield replace(bare, sub=("4" if last else "0",)), f"euler_parameter 0 {' '.join(labels)}"
        yield replace(bare, sub=("<k>",)), f"euler_parameter <k> {' '.join(labels)}"
    elif quantity in COLUMNS:
        yield replace(bare, sub=("<k>",)), f"{meaning} component <k>"


def ordered(meaning: str, words: str) -> str:
    """Return the quaternion in the order that words say: the scalar first, unless it is last."""
    last = re.search(r"scalar[- ](?:part |component |element )?last|last .*\bscalar\b", words)
    return meaning.replace("quaternion ", "quaternion_last ") if last else meaning


def _sequence(words: str) -> str:
    """Return the sequence that words name, or nothing."""
    if not _ANGLES.search(words) and not any(p.search(words) for p, _ in _YAW):
        return ""
    digits = _NUMBERS.search(words)
    axes = "".join(d for d in digits.groups() if d) if digits else ""
    letters = _LETTERS.search(words)
    if not axes and letters:
        axes = "".join(str("xyz".index(c.lower()) + 1) for c in letters.groups())
    if axes and axes[0] != axes[1] != axes[2]:
        return f"space{axes}" if _FIXED.search(words) else axes
    return next((axes for pattern, axes in _YAW if pattern.search(words)), "")


def _lists(formulas: tuple[Formula, ...]) -> Iterator[tuple[list[Look], str, str, int]]:
    """Yield symbols that stand in a row in the text, with the words before and after them."""
    inline = [f for f in formulas if f.piece.kind == "inline" and f.reading is not None]
    k = 0
    while k < len(inline):
        looks = _looks(inline[k])
        first = last = inline[k].piece
        while looks and k + 1 < len(inline) and _adjoining(last, inline[k + 1].piece):
            more = _looks(inline[k + 1])
            if not more:
                break
            k, last = k + 1, inline[k + 1].piece
            looks += more
        k += 1
        if looks:
            text = first.source.text
            before = _sentence(
                text[max(0, first.span.start - ATTITUDE_WINDOW) : first.span.start], last=True
            )
            after = _sentence(text[last.span.stop : last.span.stop + ATTITUDE_WINDOW], last=False)
            yield looks, before, after, first.line


def _adjoining(a: Piece, b: Piece) -> bool:
    between = a.source.text[a.span.stop : b.span.start]
    return (
        a.source is b.source
        and _BETWEEN.match(between.replace("\\(", "").replace("\\)", "")) is not None
    )


def _looks(formula: Formula) -> list[Look]:
    """Return the symbols of a formula that is a list of them, in brackets or without."""
    node: Node | None = formula.reading.tree if formula.reading is not None else None
    if isinstance(node, Group):
        node = node.body
    items = node.items if isinstance(node, Sequence) else (node,) if node is not None else ()
    found = [seen(item) for item in items]
    return (
        [s.look for s in found if s is not None and not s.dots and not s.raised]
        if all(found)
        else []
    )


def _sentence(text: str, last: bool) -> str:
    """Return the part of a text in the sentence beside a formula."""
    plain = re.sub(r"\s+", " ", text.strip("$\\() "))
    parts = re.split(r"(?<=[.;:!?]) |\$\$", plain)
    return (parts[-1] if last else parts[0]).strip(" ,$")


WINDOW = 90
"""Characters of prose on either side of a symbol that may say what it is."""


@dataclass(frozen=True)
class Draft:
    """A proposed entry: table, pattern, meaning, the words that say so, and their line."""

    table: str
    latex: str
    meaning: str
    words: str
    line: int


@dataclass(frozen=True)
class Proposal:
    """A preset, drafts of entries, symbols that the note defines, and those without a place."""

    preset: str
    drafts: tuple[Draft, ...]
    defined: tuple[tuple[str, int], ...]
    unplaced: tuple[tuple[str, int], ...]

    @property
    def toml(self) -> str:
        """The draft as a lexicon, with its sources as comments."""
        lines = [f'preset = "{self.preset}"']
        for table in ("frames", "points", "symbols"):
            rows = [d for d in self.drafts if d.table == table]
            lines += ["", f"[{table}]"] if rows else []
            lines += [_row(d) for d in rows]
        if self.defined:
            lines += ["", "# defined by the note itself:"]
            lines += [f"#   {printable(latex)}  (line {line})" for latex, line in self.defined]
        if self.unplaced:
            lines += ["", "# without a meaning so far:"]
            lines += [f"#   {printable(latex)}  (line {line})" for latex, line in self.unplaced]
        return "\n".join(lines) + "\n"


def _row(draft: Draft) -> str:
    """Return an entry as a line of TOML; patterns stand in simple quotes where they can."""
    words, meaning = printable(draft.words), json.dumps(draft.meaning)
    plain = draft.latex.isprintable() and "'" not in draft.latex
    pattern = f"'{draft.latex}'" if plain else json.dumps(draft.latex)
    return f"{pattern} = {meaning}  # line {draft.line}: {words}"


def propose(document: Document) -> Proposal:
    """Return a draft of the lexicon of a document."""
    formulas = read(document)
    symbols = list(_symbols(formulas))
    name = max(PRESETS, key=lambda p: (_score(preset(p), symbols), -PRESETS.index(p)))
    base = preset(name)
    sayings = _sayings(formulas)
    new = _defined(formulas, base)
    drafts = _attitude(formulas, base)
    for given, said, line in sayings:
        look = base.notation.plain(given)
        draft = _draft(look, said, line)
        if draft is not None and not _names(base, look, draft):
            drafts.setdefault(look, draft)
            for part, means in components(look, draft.meaning):
                more = replace(draft, latex=latex_of(part), meaning=means)
                drafts.setdefault(part, more)
    unknown: dict[Look, int] = {}
    for node, line in symbols:
        bare = _bare(node)
        if bare is not None and not _known(base, node):
            unknown.setdefault(base.notation.plain(bare), line)
    unknown = {k: n for k, n in unknown.items() if k not in drafts}
    unknown = {k: n for k, n in unknown.items() if not _covered(k, drafts.values())}
    return Proposal(
        name,
        tuple(drafts.values()),
        tuple((latex_of(k), n) for k, n in new.items() if k not in drafts),
        tuple((latex_of(k), n) for k, n in unknown.items() if k not in new),
    )


def _attitude(formulas: tuple[Formula, ...], base: Lexicon) -> dict[Look, Draft]:
    """Return the angles of sequences that the note names, which go before what a preset says."""
    drafts: dict[Look, Draft] = {}
    for given, means, said, line in angles(formulas):
        look = base.notation.plain(given)
        drafts.setdefault(look, Draft("symbols", latex_of(look), means, said[-70:], line))
    return drafts


# -- symbols -------------------------------------------------------------------------------------


def _symbols(formulas: tuple[Formula, ...]) -> Iterator[tuple[Node, int]]:
    """Yield every symbol with its line, whole ones only."""
    for formula in formulas:
        stack = [m for s in formula.statements for m in _members(s)]
        while stack:
            node = stack.pop()
            if seen(node) is not None:
                yield node, formula.piece.source.line_column(node.span.start)[0]
            elif not isinstance(node, Number):
                stack += reversed(_operands(node))


def _members(statement: Statement) -> list[Node]:
    """Return the members of a statement and of its conditions; a lone symbol of the text is none."""
    own = list(statement.members) if statement.relational else []
    return own + [m for _, c in statement.conditions for m in _members(c)]


def _covered(look: Look, drafts: Iterable[Draft]) -> bool:
    """Return whether a draft with slots names this."""
    indexed = len(look.sub) in {1, 2} and set(look.sub) <= INDICES
    letters = {d.latex.partition("_")[0] for d in drafts if "_{<" in d.latex}
    return indexed and latex_of(replace(look, sub=())) in letters


def _operands(node: Node) -> tuple[Node, ...]:
    """Return what of a node has a value: no variables and bounds of integrals, no labels."""
    if isinstance(node, Integral):
        return (node.integrand,) if node.integrand is not None else ()
    if isinstance(node, Derivative):
        return (node.operand,) if node.operand is not None else ()
    if isinstance(node, Differential):
        return ()
    lower = getattr(node, "lower", None)
    upper, sub = getattr(node, "upper", None), getattr(node, "sub", None)
    return tuple(c for c in children(node) if c not in (lower, upper, sub))


def _bare(node: Node) -> Look | None:
    """Return the look without dots and with a raised label only if it is one letter."""
    found = seen(node)
    if found is None:
        return None
    raised = found.raised[0] if found.raised else None
    labelled = isinstance(raised, Symbol) and raised.name not in {"T", "top", "t", "intercal"}
    return found.with_label() if labelled else found.look


def _known(lexicon: Lexicon, node: Node) -> bool:
    look = _bare(node)
    names = {**lexicon.frames, **lexicon.points}
    if look is not None and (_as_label(look) in names or look.name in {"infty", "bullet"}):
        return True
    found = None if look is None else lexicon.find(look)
    if found is not None and found.meaning.quantity in FUNCTIONS:
        return True
    try:
        elaborator(lexicon).value(node)
    except Refusal:
        return False
    return True


def _score(lexicon: Lexicon, symbols: list[tuple[Node, int]]) -> int:
    looks = {_bare(node): node for node, _ in symbols}
    return sum(_known(lexicon, node) for node in looks.values())


_ALIKE: tuple[frozenset[str], ...] = (
    frozenset({"angular_momentum", "absolute_angular_momentum"}),
    frozenset({"kinetic_energy", "rotational_energy"}),
    frozenset({"mass", "total_mass"}),
    frozenset({"force", "external_force", "internal_force"}),
    frozenset({"angle", "turn_angle", "free_angle", "principal_angle"}),
    frozenset({"torque", "gravity_torque"}),
    frozenset({"euler_parameter", "euler_vector", "quaternion", "quaternion_last"}),
)
"""Quantities that words separate worse than a preset does."""


def _names(lexicon: Lexicon, look: Look, draft: Draft) -> bool:
    """Return whether a preset names this, as the words of the note do: they go before the preset.

    What a preset says more closely stays: of the same quantity, or by a formula.
    """
    if draft.table == "symbols":
        found = lexicon.find(look)
        if found is None:
            return False
        both = {found.meaning.quantity, draft.meaning.split(maxsplit=1)[0]}
        same = len(both) == 1 or any(both <= alike for alike in _ALIKE)
        return same or found.meaning.quantity == "equals"
    names = lexicon.frames if draft.table == "frames" else lexicon.points
    return _as_label(look) in names


def _as_label(look: Look) -> Labels:
    shaped = {"calligraphic": "cal ", "blackboard": "bb ", "fraktur": "frak "}
    word = shaped.get(look.style, "") + look.name
    return (word + (f"_{''.join(look.sub)}" if look.sub else ""),)


def _defined(formulas: tuple[Formula, ...], base: Lexicon) -> dict[Look, int]:
    """Return what signs of definition say is new, with lines."""
    found: dict[Look, int] = {}
    for formula in formulas:
        line = formula.piece.line
        for statement in formula.statements:
            if any(s.name == ":=" for s in statement.signs):
                look = _bare(statement.members[0])
                if look is not None and claims(statement, base):
                    found.setdefault(base.notation.plain(look), line)
    return {k: n for k, n in found.items() if base.find(k) is None}


# -- words ---------------------------------------------------------------------------------------


def _sayings(formulas: tuple[Formula, ...]) -> Iterator[tuple[Look, tuple[str, str], int]]:
    """Yield symbols that stand alone in the text, with the words before and after them."""
    for formula in formulas:
        piece = formula.piece
        if piece.kind != "inline" or formula.reading is None:
            continue
        look = _bare(formula.reading.tree)
        if look is not None:
            text, span = piece.source.text, piece.span
            left = _prose(text[max(0, span.start - WINDOW) : span.start], before=True)
            right = _prose(text[span.stop : span.stop + WINDOW], before=False)
            yield look, (left, right), piece.line


def _prose(text: str, before: bool) -> str:
    """Return the words up to the end of the sentence, in one line; formulas become a blank."""
    text = text.strip("$\\() ").replace("\n\n", ". ")
    turned = text[::-1] if before else text  # from the symbol on: a window may end within a formula
    turned = re.sub(r"\$[^$]*\$?", " … ", re.sub(r"\$\$[^$]*(?:\$\$)?", " ‡ ", turned))
    text = turned[::-1] if before else turned
    text = re.sub(r"‡\s*(?=[A-Z])", "…. ", text).replace("‡", "…")
    text = re.sub(r"\\\(.*?\\\)", " … ", text)
    text = re.sub(r"[*_`]|\s+", " ", text)
    parts = re.split(r"[.;:!?](?=\s|$)", text)
    return (parts[-1] if before else parts[0]).strip()


_IS = re.compile(
    r"^(?:\(?here\)?\s*)?(?:is|are|be|holds?|denotes?|represents?|stands? for|means|points?)\b\s*"
    r"(?:the|an?|its|our)?\s*(?P<what>.+)$",
    re.IGNORECASE,
)
_APPOSITION = re.compile(r"(?P<what>(?:[\w'’-]+ ){0,8}[\w'’-]+),?$")

_BODY = r"(?:the )?(?:rigid )?(?:body|spacecraft|satellite|system|top|gyrostat|rotor)"
_CENTRE = (
    r"(?:the )?(?:(?:\w+['’]s )?cent(?:re|er) of (?:mass|gravity)|CM\b|c\.?m\.?\b"
    r"|mass cent(?:re|er)|barycent(?:re|er))"
)

_ROTOR = r"(?:the|a|each|its) (?:wheel|rotor|flywheel)"
LOADS: tuple[tuple[str, str], ...] = (
    (rf"torque (?:that )?(?:\w+ ){{1,4}}exerts? on {_ROTOR}", "rotor_torque k"),
    (rf"torque (?:exerted )?(?:by \w+ \w+ )?on {_ROTOR}", "rotor_torque k"),
    (r"acceleration (?:of|due to) (?:uniform )?gravity|gravitational acceleration", "gravity"),
    (r"weight of (?:the )?body", "weight body"),
)
"""Words that say what a load is, so plainly that they add to any lexicon."""

_QUANTITIES: tuple[tuple[str, str], ...] = (
    *LOADS,
    (r"angular velocity", "angular_velocity B I"),
    (rf"from {_CENTRE} to", "position dm C"),
    (rf"relative to {_CENTRE}|with respect to {_CENTRE}", "position dm C"),
    (rf"(?:position|location) (?:vector )?of {_CENTRE}", "position C OI"),
    (r"position (?:vector )?of (?:the|a|an|each) (?:differential )?(?:mass )?element",
     "position dm OI"),
    (r"relative position of the point mass", "position P O"),
    (r"relative position", "position dm O"),
    (r"position (?:vector )?of the (?:point )?(?:mass|particle)", "position P OI"),
    (r"position (?:vector )?of each", "position dm OI"),
    (r"internal force", "internal_force i j"),
    (r"angular momentum|moment of momentum", "angular_momentum body C"),
    (r"linear momentum", "linear_momentum body"),
    (r"(?:inertia|mass) (?:dyadic|tensor)", "inertia C"),
    (r"inertia matrix|matrix of inertia", "inertia C in B"),
    (r"rotational (?:kinetic )?energy", "rotational_energy body C"),
    (r"kinetic energy", "kinetic_energy body"),
    (r"first moment of mass", "first_moment body O"),
    (r"torque|moment of (?:the )?(?:external )?forces?", "torque body C"),
    (r"external force|(?:total|resultant) force", "external_force body"),
    (rf"(?:total )?mass of {_BODY}|total mass", "total_mass body"),
    (r"rotation matrix|direction cosine matrix|attitude matrix", "rotation B I"),
    (r"precession angle|nutation angle|spin angle|(?:Euler|roll|pitch|yaw) angle", "angle {name}"),
)  # fmt: skip
"""Words that say what any other symbol is."""

PHRASES: tuple[tuple[str, str, str], ...] = (
    ("frames", r"inertial (?:reference )?frame|space(?:-fixed)? frame|newtonian frame", "I"),
    ("frames", r"body(?:-fixed)? (?:reference )?frame|frame (?:that is )?(?:fixed|attached)", "B"),
    *(("symbols", pattern, meaning) for pattern, meaning in (*_ATTITUDES, *_QUANTITIES)),
    ("points", _CENTRE, "C"),
    ("points", r"(?:the )?origin of the inertial frame|inertial origin", "OI"),
)
"""Words that say what a symbol is: table, pattern, meaning; the first that fits is taken."""


def _draft(look: Look, said: tuple[str, str], line: int) -> Draft | None:
    """Return the entry that the words beside a symbol suggest, or None."""
    left, right = said
    after = _IS.match(right)
    before = _APPOSITION.search(left)
    phrases = [m["what"] for m in (after, before) if m is not None]
    for words in phrases:
        for table, pattern, meaning in PHRASES:
            if not re.search(pattern, words, re.IGNORECASE):
                continue
            if not _fits(look, table, meaning):
                continue
            means = ordered(meaning, f"{left} {right}")
            slotted, filled = _indexed(look, means.format(name=look.name))
            return Draft(table, slotted, filled, words.strip(" ,…")[:70], line)
    return None


_OF_ONE = {"external_force body": "force <i>", "total_mass body": "mass <i>"}


def _indexed(look: Look, meaning: str) -> tuple[str, str]:
    """Return pattern and meaning; what carries the index of a particle is that of any particle."""
    slots = [f"<{'ij'[k]}>" for k in range(len(look.sub))] if len(look.sub) < 3 else []
    if not slots or not set(look.sub) <= INDICES:
        return latex_of(look), meaning
    latex = latex_of(replace(look, sub=())) + f"_{{{''.join(slots)}}}"
    if meaning == "internal_force i j":
        return latex, "internal_force <i> <j>"
    words = [("<i>" if w in {"dm", "body", "P"} else w) for w in meaning.split()]
    return latex, _OF_ONE.get(meaning, " ".join(words))


_SCALARS = frozenset(
    "rotor_torque mass total_mass kinetic_energy rotational_energy angle turn_angle principal_angle "
    "free_angle euler_parameter".split()
)
_TABLES = frozenset({"inertia", "rotation"})


def _fits(look: Look, table: str, meaning: str) -> bool:
    """Return whether a symbol looks like what it would stand for: marked letters are vectors."""
    quantity = meaning.split(maxsplit=1)[0]
    marked = bool(look.accents) or look.style == "bold"
    if table != "symbols":
        return not look.accents and look.style in {"", "calligraphic", "fraktur"}
    if quantity in _SCALARS:
        return not marked
    tables = _TABLES | COLUMNS
    return marked or quantity in tables or look.name in {"omega", "tau", "alpha", "rho"}


# -- LaTeX ---------------------------------------------------------------------------------------


DRAFT = "draft"


@dataclass(frozen=True)
class Meanings:
    """A lexicon, where it comes from in words, and the draft if it is one."""

    lexicon: Lexicon
    origin: str
    draft: Proposal | None = None


def meanings(
    document: Document, path: Path | None = None, notation: str = "", lexicon: str = ""
) -> Meanings:
    """Return the meanings of a note's symbols: what is asked for, else what the note says, else a draft.

    ``path``: where the note stands; ``notation``: a preset; ``lexicon``: a TOML file. Raises `InputError`
    for those that cannot be used.
    """
    if notation and lexicon:
        raise InputError(
            "a notation and a lexicon exclude each other", hint="a lexicon may name its preset"
        )
    if notation:
        return Meanings(preset(notation), f"preset {notation}")
    if lexicon:
        parsed = parse_lexicon(lexicon_text(Path(lexicon)), lexicon, Path(lexicon).parent)
        return _added(document, parsed, lexicon)
    found = lexicon_found(_front(document), path)
    return _drafted(document) if found is None else _added(document, found[1], found[0])


def _added(document: Document, lexicon: Lexicon, origin: str) -> Meanings:
    """Return the meanings of a lexicon with loads that only the note's words explain, as it says."""
    plain = {meaning for _, meaning in LOADS}
    drafts: dict[Look, Draft] = {}
    scoped = [e.look for s in lexicon.scopes for e in s.entries]
    for given, said, line in _sayings(read(document)):
        look = lexicon.notation.plain(given)
        draft = _draft(look, said, line)
        known = lexicon.find(look) is not None or look in scoped
        if draft is not None and draft.meaning in plain and not known:
            drafts.setdefault(look, draft)
    if not drafts:
        return Meanings(lexicon, origin)
    more, _ = lexicon_of({"symbols": {d.latex: d.meaning for d in drafts.values()}}, DRAFT)
    words = ", ".join(f"{d.latex} is {d.meaning} (line {d.line})" for d in drafts.values())
    whole = replace(lexicon, layers=(*lexicon.layers, *more.layers))
    return Meanings(whole, f"{origin}, and the note's words: {words}")


def _front(document: Document) -> str:
    """Return the front matter as the head of a note, if a table of it is meant for the checker."""
    if in_yaml(document.front):
        return f"---\n{document.front}\n---\n"
    toml = any(line.strip().startswith(("[check", "check")) for line in document.front.splitlines())
    return f"+++\n{document.front}\n+++\n" if toml else ""


def _drafted(document: Document) -> Meanings:
    """Return the draft of the lexicon; entries that cannot be used are left out."""
    proposal = proposed(document)
    data: dict[str, dict[str, str]] = {}
    for draft in proposal.drafts:
        data.setdefault(draft.table, {})[draft.latex] = draft.meaning
    lexicon, _ = lexicon_of({"preset": proposal.preset, **data}, DRAFT)
    return Meanings(lexicon, f"{DRAFT} on preset {proposal.preset}", proposal)


def proposed(document: Document) -> Proposal:
    """Return the draft of a lexicon. Raises `InputError` for a note that takes too long."""
    try:
        return propose(document)
    except (Overdue, RecursionError):
        raise InputError(
            "no notation can be proposed for this note in time",
            where=document.name,
            hint="name one: --notation",
        ) from None
