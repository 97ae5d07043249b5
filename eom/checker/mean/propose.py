"""A draft of a lexicon from a note's own words: what its symbols are said to be, and what is left.

The preset that knows most symbols is taken; symbols that it does not know are looked for in the text
beside them ("r points from the centre of mass to ...", "the angular velocity, w, of B"). The writer
confirms: nothing of this is used without being asked for.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from eom.checker.mean import attitude_words
from eom.checker.mean.attitude_words import angles, components
from eom.checker.mean.claims import claims
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import PRESETS, preset
from eom.checker.mean.symbols import FUNCTIONS
from eom.checker.mean.values import Refusal
from eom.checker.read.documents import Document
from eom.checker.read.latex import SCRIPT_MARKS, SYMBOLS
from eom.checker.read.looks import Labels, Look, seen
from eom.checker.read.places import printable
from eom.checker.read.reading import Formula, read
from eom.checker.read.statements import Statement
from eom.checker.read.syntax import Accent, Derivative, Differential, Integral, Node, Number, Symbol
from eom.checker.read.trees import children
from eom.checker.read.writing import latex
from eom.terms.terms import INDICES

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
    """Tell whether a draft with slots names this."""
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
"""Quantities that words tell apart worse than a preset does."""


def _names(lexicon: Lexicon, look: Look, draft: Draft) -> bool:
    """Tell whether a preset names this, as the words of the note do: they go before the preset.

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

PHRASES: tuple[tuple[str, str, str], ...] = (
    ("frames", r"inertial (?:reference )?frame|space(?:-fixed)? frame|newtonian frame", "I"),
    ("frames", r"body(?:-fixed)? (?:reference )?frame|frame (?:that is )?(?:fixed|attached)", "B"),
    *attitude_words.ATTITUDE_PHRASES,
    ("symbols", r"angular velocity", "angular_velocity B I"),
    ("symbols", rf"from {_CENTRE} to", "position dm C"),
    ("symbols", rf"relative to {_CENTRE}|with respect to {_CENTRE}", "position dm C"),
    ("symbols", rf"(?:position|location) (?:vector )?of {_CENTRE}", "position C OI"),
    (
        "symbols",
        r"position (?:vector )?of (?:the|a|an|each) (?:differential )?(?:mass )?element",
        "position dm OI",
    ),
    ("symbols", r"relative position of the point mass", "position P O"),
    ("symbols", r"relative position", "position dm O"),
    ("symbols", r"position (?:vector )?of the (?:point )?(?:mass|particle)", "position P OI"),
    ("symbols", r"position (?:vector )?of each", "position dm OI"),
    ("symbols", r"internal force", "internal_force i j"),
    ("symbols", r"angular momentum|moment of momentum", "angular_momentum body C"),
    ("symbols", r"linear momentum", "linear_momentum body"),
    ("symbols", r"(?:inertia|mass) (?:dyadic|tensor)", "inertia C"),
    ("symbols", r"inertia matrix|matrix of inertia", "inertia C in B"),
    ("symbols", r"rotational (?:kinetic )?energy", "rotational_energy body C"),
    ("symbols", r"kinetic energy", "kinetic_energy body"),
    ("symbols", r"first moment of mass", "first_moment body O"),
    ("symbols", r"torque|moment of (?:the )?(?:external )?forces?", "torque body C"),
    ("symbols", r"external force|(?:total|resultant) force", "external_force body"),
    ("symbols", rf"(?:total )?mass of {_BODY}|total mass", "total_mass body"),
    ("symbols", r"rotation matrix|direction cosine matrix|attitude matrix", "rotation B I"),
    (
        "symbols",
        r"precession angle|nutation angle|spin angle|(?:Euler|roll|pitch|yaw) angle",
        "angle {name}",
    ),
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
            means = attitude_words.ordered(meaning, f"{left} {right}")
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


_SCALARS = frozenset({"mass", "total_mass", "kinetic_energy", "rotational_energy", "angle"})
_TABLES = frozenset({"inertia", "rotation"})


def _fits(look: Look, table: str, meaning: str) -> bool:
    """Tell whether a symbol looks like what it would stand for: marked letters are vectors."""
    quantity = meaning.split(maxsplit=1)[0]
    marked = bool(look.accents) or look.style == "bold"
    if table != "symbols":
        return not look.accents and look.style in {"", "calligraphic", "fraktur"}
    if quantity in _SCALARS | attitude_words.SCALARS:
        return not marked
    tables = _TABLES | attitude_words.COLUMNS
    return marked or quantity in tables or look.name in {"omega", "tau", "alpha", "rho"}


# -- LaTeX ---------------------------------------------------------------------------------------

_SHAPES = {"cal": "mathcal", "bb": "mathbb", "frak": "mathfrak"}


def latex_of(look: Look) -> str:
    """Return a look as LaTeX that reads as the same look."""
    style = "roman" if len(look.name) > 1 and not _is_command(look.name) else ""
    node: Node = Symbol(look.name, look.style or style)
    for accent in look.accents:
        node = Accent(accent, node)
    before = f"{{}}^{{{_words(look.presup)}}}" if look.presup else ""
    below = f"_{{{_words(look.sub)}}}" if look.sub else ""
    above = f"^{{{_words(look.sup)}}}" if look.sup else ""
    return before + latex(node) + below + above


def _is_command(name: str) -> bool:
    return name in SYMBOLS or name in SCRIPT_MARKS


def _words(labels: Labels) -> str:
    return " ".join(_word(w) for w in labels)


def _word(word: str) -> str:
    shape, _, letter = word.partition(" ")
    if shape in _SHAPES and letter:
        return rf"\{_SHAPES[shape]}{{{letter}}}"
    for mark in "^_":
        base, found, rest = word.partition(mark)
        if found and base:
            return f"{_word(base)}{mark}{{{_word(rest)}}}"
    return f"\\{word}" if _is_command(word) else word
