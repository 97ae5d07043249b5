r"""The system of a note, from its words and letters: a pendulum, a cart, an incline, an orbit.

The table ``systems.toml`` has systems of the textbooks as a lexicon describes them, with the words that
name them and the letters that are usual for their quantities. A row is taken where words name it and its
letters are those of the note; of several rows, and of several ways to count an angle, that under which
most lines hold. Results are derived of the system, never taken from the table.
"""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from itertools import islice, product
from typing import Any

from eom.checker.infer.sayings import Prose, Said, look_of
from eom.checker.mean.lexicon import MATRICES, Lexicon, Scope
from eom.checker.mean.lexicon_files import about
from eom.checker.mean.model import Model
from eom.checker.read.documents import Document
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import read
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.writing import latex_of

USUAL = "by its usual letter"
MAX_ROWS, MAX_VARIANTS, MAX_CHOICES = 5, 8, 24
"""Rows that are tried for a part of a note, ways to count angles, choices of letters."""


IN_A_MOTION = re.compile(r" (?:at|before|after) |^impulse ")
"""How meanings say that they are values in a motion of the system, perhaps none that the note means."""


@dataclass(frozen=True)
class Letter:
    """A quantity of a system with the letters that are usual for it, words beside it, and its noun."""

    means: str
    usual: tuple[Look, ...]
    words: re.Pattern[str]
    noun: str = ""

    @property
    def derived(self) -> bool:
        """Whether it is a value in a motion of the system, which has no rate."""
        return IN_A_MOTION.search(self.means) is not None

    @property
    def marked(self) -> bool:
        """Whether its letters carry the mark of a vector or matrix."""
        return any(k.accents or k.style for k in self.usual[:1])


@dataclass(frozen=True)
class Tie:
    """A letter of the note with the quantity that it stands for, the words that say so, and their line."""

    look: Look
    means: str
    words: str
    line: int

    @property
    def latex(self) -> str:
        """The letter in LaTeX."""
        return latex_of(self.look)


@dataclass(frozen=True)
class Row:
    """A row of the table: what names it, what is left open in it, its letters, its description.

    One that is composed of the parts of a note has letters that words have ``bound`` to its quantities, the
    ``lines`` that it was read from, and the line from which on (``until``) the note changes it; 0 for none.
    ``turns``: from which directions its angles may be counted.
    """

    name: str
    words: re.Pattern[str]
    unless: re.Pattern[str] | None
    bare: bool
    needs: frozenset[str]
    angles: tuple[str, ...]
    optional: frozenset[str]
    sizes: tuple[str, ...]
    shapes: tuple[str, ...]
    letters: tuple[Letter, ...]
    table: Mapping[str, Any]
    bound: tuple[Tie, ...] = ()
    lines: tuple[int, ...] = ()
    until: int = 0
    turns: tuple[int, ...] = (0, 1, 2, 3)

    def named(self, words: str) -> re.Match[str] | None:
        """Return where words name this system."""
        if self.unless is not None and self.unless.search(words):
            return None
        return self.words.search(words)

    @property
    def usual(self) -> frozenset[Look]:
        """Letters that are usual for any of its quantities."""
        return frozenset(k for one in self.letters for k in one.usual)


@dataclass(frozen=True)
class Guess:
    """A system with the letters of a note: its description as a lexicon has it, and its evidence.

    ``words``: by which the note names it; ``headings``: the part that is about it, none for the whole
    note; ``after``: the phrase from which on the note, or that part, is about it, in line ``begins``;
    ``rivals``: others under which as many lines hold; ``letters``: what it has names for; ``lines``:
    where its parts were read, ``until``: from which line on the note changes it, 0 for none.
    """

    name: str
    table: Mapping[str, Any]
    ties: tuple[Tie, ...]
    words: str = ""
    headings: tuple[str, ...] = ()
    rivals: tuple[Guess, ...] = ()
    letters: tuple[Letter, ...] = ()
    lines: tuple[int, ...] = ()
    until: int = 0
    after: str = ""
    begins: int = 0

    @property
    def whole_note(self) -> bool:
        """Whether the whole note is about it, and no part alone."""
        return not self.headings and not self.after

    @property
    def symbols(self) -> Mapping[str, str]:
        """Meanings of letters, by their LaTeX."""
        return {t.latex: t.means for t in self.ties}

    @property
    def whole(self) -> Mapping[str, Any]:
        """The table of the system as it stands in a lexicon."""
        return {**self.table, "usual": False, "first": True, "symbols": dict(self.symbols)}

    def model(self) -> Model:
        """Return the system."""
        return _model(_key(self.table))

    def holds_in(self, lexicon: Lexicon) -> bool:
        """Return whether lines with a lexicon are about this system."""
        here = lexicon.system
        return here is not None and here.system is self.model().system

    def noun(self, means: str) -> str:
        """Return what a quantity is called, such as "length"; else its name in the system."""
        called = next((x.noun for x in self.letters if x.means == means), "")
        moment = re.fullmatch(r"([pQ])_(\w+)", means)
        if called or moment is None:
            return called or means
        kind = {"p": "generalised momentum", "Q": "generalised force"}[moment[1]]
        return f"{kind} of {self.noun(moment[2])}"

    def added(self, lexicon: Lexicon) -> Lexicon:
        """Return a lexicon about this system; its letters go first."""
        return about(lexicon, self.model(), self.symbols, first=True, usual=False)


def with_systems(lexicon: Lexicon, systems: Iterable[Guess]) -> Lexicon:
    """Return a lexicon about the systems of a note, each in its part."""
    for one in systems:
        if one.whole_note:
            lexicon = one.added(lexicon)
            continue
        made = one.added(Lexicon(lexicon.notation))
        for heading in one.headings or ("",):
            scope = Scope(heading, one.after, (), {}, {}, made.system, made.layers)
            lexicon = replace(lexicon, scopes=(*lexicon.scopes, scope))
    return lexicon


@cache
def rows() -> tuple[Row, ...]:
    """Return the table."""
    return tuple(_row(r, _data()["energies"]) for r in _data()["system"])


def _row(data: Mapping[str, Any], energies: Mapping[str, Any]) -> Row:
    return Row(
        data["name"],
        re.compile(data["words"], re.IGNORECASE),
        re.compile(data["unless"], re.IGNORECASE) if "unless" in data else None,
        data.get("bare", False),
        frozenset(data.get("needs", ())),
        tuple(data.get("angles", ())),
        frozenset(data.get("optional", ())),
        tuple(data.get("sizes", ())),
        tuple(data.get("shapes", ())),
        _letters({**energies, **data["letters"]}),
        data["is"],
    )


def _letters(rows: Mapping[str, Sequence[str]]) -> tuple[Letter, ...]:
    return tuple(
        Letter(
            k,
            tuple(_look(w) for w in usual.split()),
            re.compile(words, re.IGNORECASE),
            _noun(k, *noun or (words,)),
        )
        for k, (usual, words, *noun) in rows.items()
    )


_GROUPS = ((r"\(\?<?![^()]*\)", ""), (r"\((?:\?:)?([^|()]*)[^()]*\)", r"\1"), (r"s\?|\|.*", ""))
"""What makes a pattern its first words: no lookarounds, first alternatives, the singular."""
_STEMS = {"gravit": "acceleration of gravity", "frequenc": "angular frequency", "energ": "energy"}
_NUMBERED = re.compile(r"_([123])$|_([123])_dot")
_ORDINALS = {"1": "first", "2": "second", "3": "third"}


def _noun(means: str, words: str) -> str:
    """Return what a quantity is called: the first of its words, or the name; with its number in front."""
    first = words
    for pattern, put in _GROUPS:
        first = re.sub(pattern, put, first)
    plain = re.match(r"[A-Za-z][A-Za-z' -]*[A-Za-z]", first)
    noun = _STEMS.get(plain[0], plain[0]) if plain else ""
    number = _NUMBERED.search(means)
    told = not noun or any(w in noun.split() for w in _ORDINALS.values())
    return noun if told or number is None else f"{_ORDINALS[number[1] or number[2]]} {noun}"


def table_row(name: str, letters: Mapping[str, Sequence[str]], table: Mapping[str, Any]) -> Row:
    """Return a row as those of the table, with the letters of energies, that no words name."""
    own = _letters({**_data()["energies"], **letters})
    words = re.compile("(?!)")
    none = frozenset[str]()
    return Row(name, words, None, False, none, (), none, (), (), own, table)


@cache
def _data() -> Mapping[str, Any]:
    return tomllib.loads((files(__package__) / "systems.toml").read_text(encoding="utf-8"))


@cache
def _look(latex: str) -> Look:
    found = look_of(read_formula(latex).tree)
    assert found is not None, latex
    return found


# -- descriptions --------------------------------------------------------------------------------

_OPEN = frozenset("gravity potential forces bodies springs reactions values motions".split())
"""Keys under which names stand in formulas."""
_TURNS = (
    ("{0}", "{1}", "{2}", ""),
    ("({0} + pi)", "(-{1})", "(-{2})", ""),
    ("(pi/2 - {0})", "{2}", "{1}", "-"),
    ("({0} + pi/2)", "{2}", "(-{1})", ""),
)
"""An angle counted from the downward vertical, the upward one, up and down from the horizontal.

Itself, its sine, its cosine, the sign of its rate; by the angle, its sine and its cosine.
"""


DIRECTIONS = {"downward": (0,), "upward": (1,), "horizontal": (2, 3), "vertical": (0, 1)}
"""Words of directions that angles are counted from, with the rows of the table of these."""


def _key(table: Mapping[str, Any]) -> str:
    return repr(sorted(table.items()))


_TABLES: dict[str, Mapping[str, Any]] = {}


@cache
def _made(key: str) -> Model:
    from eom.checker.mean.described import model_in  # most notes need no scenes

    return model_in(_TABLES[key], None, "system")


def _model(key: str) -> Model:
    return _made(key)


def _put(value: Any, name: str, formula: str) -> Any:
    """Return a description with a formula in the place of a name."""
    if isinstance(value, str):
        return re.sub(rf"\b{name}\b", f"({formula})", value)
    if isinstance(value, list):
        found = [_put(v, name, formula) for v in value]
        return [v for v in found if v not in {"(0)", "((0))"}] or [0, 0, 0][: len(found)]
    if isinstance(value, Mapping):
        return {k: _put(v, name, formula) for k, v in value.items()}
    return value


def _replaced(table: Mapping[str, Any], name: str, formula: str) -> dict[str, Any]:
    return {k: _put(v, name, formula) if k in _OPEN else v for k, v in table.items()}


def _without(table: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Return a description in which a parameter or input is absent."""
    found = _replaced(table, name, "0")
    for key in ("parameters", "given"):
        if key in found:
            found[key] = {k: v for k, v in found[key].items() if k != name}
    return {k: v for k, v in found.items() if v != {} or k == "parameters"}


def descriptions(row: Row, used: Iterable[str], words: str) -> Iterator[Mapping[str, Any]]:
    """Yield descriptions of a system: what has no letter is absent; sizes by words; angles either way."""
    table: dict[str, Any] = dict(row.table)
    for name in sorted(row.optional - set(used)):
        table = _without(table, name)
    for sized in _sized(table, row, words):
        yield from islice(_turned(sized, row.angles, row.turns), MAX_VARIANTS)


def _sized(table: Mapping[str, Any], row: Row, words: str) -> Iterator[Mapping[str, Any]]:
    if not row.sizes:
        yield table
        return
    name, *others = row.sizes
    shapes = [bool(s) and re.search(s, words, re.IGNORECASE) is not None for s in row.shapes]
    order = sorted(range(len(others)), key=lambda k: not shapes[k])
    for k in order:
        if shapes[k] or not row.shapes[k] or not words.strip():
            yield table if others[k] == name else _replaced(table, name, others[k])


def _turned(
    table: Mapping[str, Any], angles: Sequence[str], turns: Sequence[int]
) -> Iterator[Mapping[str, Any]]:
    if not angles:
        yield table
        return
    for turn, back in product([_TURNS[k] for k in turns], (False, True)):
        found: Any = {k: v for k, v in table.items() if k in _OPEN}
        for name in angles:
            found = _by_angle(found, name, turn, "-" if back else "")
        yield {**table, **found}


def _by_angle(value: Any, name: str, turn: tuple[str, ...], back: str) -> Any:
    """Return a description with an angle counted in another way; ``back``: "-" for the other sense."""
    given = (f"({back}{name})", f"({back}sin({name}))", f"cos({name})")
    angle, sine, cosine = (t.format(*given) for t in turn[:3])
    rate = f"({turn[3]}{back}{name}_dot)".replace("--", "")
    by = {f"sin({name})": sine, f"cos({name})": cosine, f"{name}_dot": rate, name: angle}
    pattern = rf"\b(?:sin\({name}\)|cos\({name}\)|{name}(?:_dot)?\b(?!_))"
    if isinstance(value, str):
        return re.sub(pattern, lambda m: by[m[0]], value)
    if isinstance(value, list):
        return [_by_angle(v, name, turn, back) for v in value]
    if isinstance(value, Mapping):
        return {k: _by_angle(v, name, turn, back) for k, v in value.items()}
    return value


# -- letters -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Spoken:
    """A letter with what words say of it; ``told``: whether they say it plainly ("S is the ...").

    ``noun``: those of the words that have to name what it is; ``led``: whether they only lead to a display
    with the letter alone on its left ("for the kinetic energy one finds").
    """

    look: Look
    words: str
    line: int
    told: bool
    noun: str
    led: bool = False


_LAST = re.compile(r"\b(?:with|of a|whose|has|have|and|at|by|under|let|for|the other)\s+")
_BOTH = re.compile(
    r"\b(kinetic|potential) and (?:the )?(kinetic|potential) energ(?:y|ies)", re.IGNORECASE
)
_NOUN = re.compile(
    r"\b(?:mass|length|radius|distance|height|depth|angle|azimuth|forces?|tension|torque|moment|momentum|"
    r"energ(?:y|ies)|velocity|speed|acceleration|rate|frequency|period|time|stiffness|constant|position|"
    r"displacement|coefficient|parameter|work|power|point|frame|axis|origin|area|ratio|density)\b",
    re.IGNORECASE,
)
"""What letters stand for, in general."""
SHARE = 0.4
"""Of the places of symbols in displays, how many a system has to know."""
MOST = 0.7
"""The same, where no words name the system of several lines."""
HEAD = 60
"""Characters of what is said of a letter in which the noun stands that it is."""


def spoken(text: Prose, sayings: Iterable[Said]) -> tuple[Spoken, ...]:
    """Return what words say of letters: to each of a list its own, where they name as many."""
    found: list[Spoken] = []
    for one in sayings:
        if one.before:
            noun = _LAST.split(one.words)[-1]
            words = f"{noun} {one.behind}"
        else:
            noun = words = re.split(r"[;(]|, (?=⟦)", one.words)[0]
        words = _BOTH.sub(r"\1 energy and \2 energy", words)
        each = re.split(r",? and |, ", words) if len(one.of) > 1 else [words]
        apart = len(each) == len(one.of) and not _of_all(each)
        each = list(_whole(each)) if apart else [words] * len(one.of)
        for mention, own in zip(one.of, each, strict=True):
            shown = text.shown(own)
            near = text.shown(noun) if one.before else shown[:HEAD].split(", ")[0]
            told = not one.before and not mention.shown
            found.append(Spoken(mention.look, shown, mention.line, told, near))
    return tuple(found)


def led(document: Document) -> Iterator[Spoken]:
    """Yield letters that stand alone on the left of displays with the sentence that leads there."""
    shown = {id(f.piece): f for f in read(document) if f.piece.kind == "display"}
    before = ""
    for piece in document.pieces:
        formula = shown.get(id(piece))
        if formula is None:
            before = "" if piece.kind in {"display", "heading"} else before + piece.body
            continue
        words = [w.strip() for w in _SENTENCE.split(before[-MAX_LEAD:]) if w.strip()]
        for statement in formula.statements if words else ():
            left = seen(statement.members[0]) if statement.relational else None
            look = None if left is None or left.dots else look_of(statement.members[0])
            if look is not None:
                yield Spoken(look, words[-1], formula.piece.line, told=False, noun="", led=True)
        before = ""


def is_claimed(lead: str) -> bool:
    """Return whether words that lead to a letter alone say what it is, and bring in no new name for it."""
    return _PHYSICAL.search(lead) is not None and _INTRODUCED.search(lead) is None


def is_name(lead: str) -> bool:
    """Return whether the last words that lead to a display bring in a new name: "With", "we write"."""
    return _NAMING.search(lead) is not None


_NAMING = re.compile(
    r"\b(?:with|where|let|puts?|sets?|writ(?:e|ing)|abbreviat\w+|defin\w+|denot\w+|introduc\w+|call)\b"
    r"(?:\W+\w+){0,3}\W*$",
    re.IGNORECASE,
)
_PHYSICAL = re.compile(
    r"\b(?:frequenc(?:y|ies)|periods?|speeds?|velocit(?:y|ies)|accelerations?|forces?|torques?|moments?|"
    r"energ(?:y|ies)|moment(?:um|a)|compression|deflection|height|time|work|power|tension|angles?|rate|"
    r"amplitude|distance|displacement)\b",
    re.IGNORECASE,
)
_INTRODUCED = re.compile(
    r"\b(?:abbreviat\w+|defin\w+|denot\w+|call\w*|introduc\w+|puts?|sets?|let|writ\w+|short\w*|parameters?|"
    r"constants?|ratio|notation|nam(?:e|ed|ing)|new|choos\w+|chosen|takes?|us(?:e|ing)|with|where)\b",
    re.IGNORECASE,
)
MAX_LEAD = 400
"""Characters before a display that are read."""
_SENTENCE = re.compile(r"(?<=[.;:!?])\s+|\n\s*\n")
_PARTLY = re.compile(
    r"\b(?:energy|energies|momentum|force)\s+of\s+(?:the|each|one|its|a)\s+(?!(?:whole|system|motion|entire)\b)",
    re.IGNORECASE,
)
"""Words by which a quantity is that of a part."""
_SEVERAL = re.compile(
    r"\b(?:masses|lengths|angles|positions|displacements|coordinates|distances|velocities|radii)\b"
)


def _of_all(each: Sequence[str]) -> bool:
    """Return whether the first of several items names them all: "the angles of the rods, counted ..."."""
    return (
        len(each) > 1
        and _SEVERAL.search(each[0]) is not None
        and not any(_NOUN.search(e) or _SEVERAL.search(e) or _OF.match(e) for e in each[1:])
    )


_OF = re.compile(r"\s*(?:about|of|in|on|from|at|along|after|before|to)\b")


def _whole(each: Sequence[str]) -> Iterator[str]:
    """Yield items of a list; one that begins with a preposition goes on with the noun of the first."""
    noun = _OF.split(each[0])[0]
    for item in each:
        yield f"{noun} {item}" if _OF.match(item) else item


def _rate(letter: Letter, one: Spoken) -> float:
    """Return how much words say that a letter is this: 0 for nothing."""
    match = letter.words.search(one.words)
    if match is None or letter.marked != bool(one.look.accents or one.look.style):
        return 0
    rank = letter.usual.index(one.look) if one.look in letter.usual else -1
    if rank < 0 and (letter.derived or letter.words.search(one.noun) is None):
        return 0
    own = 3 - rank / 100 if rank >= 0 else 1.5 if one.told else 0.8
    return own + min(len(match[0]), 60) / 200 - match.start() / 500


def ties(
    row: Row,
    said: Sequence[Spoken],
    looks: Mapping[Look, int],
    dotted: Container[Look] = frozenset(),
) -> tuple[Tie, ...]:
    """Return letters with the quantities of a row: by words first, then those that are usual.

    A letter of which words say something else is not taken for what it usually is; one with a dot
    (``dotted``) is no value in a motion.
    """
    other = {s.look for s in said if s.told and _NOUN.search(s.noun)}
    rated: list[tuple[float, int, Look, str, str, int]] = []
    parts = len(row.table.get("bodies", {}))
    for number, letter in enumerate(row.letters):
        for one in (s for s in said if s.look in looks and not (parts > 1 and _is_part(s))):
            rate = _rate(letter, one)
            if rate > 0 and not (letter.derived and one.look in dotted):
                rated.append((rate, -number, one.look, letter.means, one.words, one.line))
        for n, look in enumerate(() if letter.means in MATRICES else letter.usual):
            if look in looks and look not in other and not (letter.derived and look in dotted):
                rated.append((1 - n / 100, -number, look, letter.means, USUAL, looks[look]))
    found = {t.means: t for t in row.bound if t.look in looks}
    for *_, look, means, words, line in sorted(rated, key=lambda r: (-r[0], -r[1], r[2].text)):
        if means not in found and all(t.look != look for t in found.values()):
            found[means] = Tie(look, means, words, line)
    return (*found.values(), *_momenta(row, found, said, looks))


def _is_part(one: Spoken) -> bool:
    return one.led and _PARTLY.search(one.words) is not None


_CONJUGATE = {"p": "moment", "Q": "force"}
"""Words beside the momentum of a coordinate, and beside its generalised force."""


def _momenta(
    row: Row, found: Mapping[str, Tie], said: Sequence[Spoken], looks: Mapping[Look, int]
) -> Iterator[Tie]:
    """Yield momenta and generalised forces with the letter of a coordinate below."""
    taken = {t.look for t in found.values()}
    alone = len(row.table["coordinates"]) == 1
    for name in row.table["coordinates"]:
        for letter in "pQ" if name in found else "":
            below = _look(f"{letter}_{{{found[name].latex}}}")
            written = [k for k in (below, Look(letter)) if k in looks and k not in taken]
            if written and (alone or written[0] == below):
                told = (s for s in said if s.look == written[0] and _CONJUGATE[letter] in s.words)
                own = next(((s.words, s.line) for s in told), (USUAL, looks[written[0]]))
                yield Tie(written[0], f"{letter}_{name}", *own)


def choices(row: Row, first: tuple[Tie, ...]) -> Iterator[tuple[Tie, ...]]:
    """Yield the letters, then those in which one that only is usual stands for something else."""
    yield first
    free = [t for t in first if t.words == USUAL]
    options = []
    for tie in free:
        others = [x.means for x in row.letters if tie.look in x.usual and x.means != tie.means]
        options.append([tie, *(replace(tie, means=m) for m in others)])
    fixed = tuple(t for t in first if t.words != USUAL)
    several = sorted(product(*(range(len(o)) for o in options)), key=lambda c: (sum(c), c))
    for chosen in islice(several, 1, MAX_CHOICES):
        made = (*fixed, *(o[k] for o, k in zip(options, chosen, strict=True)))
        if len({t.means for t in made}) == len(made):
            yield made


def candidates(
    words: str,
    said: Sequence[Spoken],
    looks: Counter[Look],
    lines: Mapping[Look, int],
    dotted: Container[Look] = frozenset(),
    *,
    several: bool = False,
) -> list[tuple[Row, tuple[Tie, ...], str]]:
    """Return the rows that words name, with letters, those first that know most places of a note.

    Without words those whose letters a formula has; ``several``: most of those of several formulas.
    """
    found = []
    for number, row in enumerate(rows()):
        match = row.named(words) if words.strip() else None
        if match is None and (words.strip() or not (row.bare or several)):
            continue
        tied = ties(row, said, lines, dotted)
        known = {t.look for t in tied}
        if match is None and not several and not row.needs <= {t.means for t in tied}:
            continue
        share = sum(n for k, n in looks.items() if k in known) / max(1, sum(looks.values()))
        if share >= (SHARE if words.strip() else MOST if several else 1):
            by_share = match is not None or several
            order = (-share, number) if by_share else (_size(row, tied), number)
            found.append((order, row, tied, "" if match is None else _said_by(match)))
    return [(row, tied, name) for _, row, tied, name in sorted(found, key=lambda f: f[0])]


def _said_by(match: re.Match[str]) -> str:
    """Return the words that name a system, the last one whole."""
    rest = re.match(r"\w*", match.string[match.end() :])
    return match[0] + (rest[0] if rest else "")


def _size(row: Row, tied: Sequence[Tie]) -> int:
    """Return how much a system has in it: coordinates, parameters, what is given."""
    absent = row.optional - {t.means for t in tied}
    tables = (row.table.get(k, {}) for k in ("coordinates", "parameters", "given"))
    return sum(name not in absent for table in tables for name in table)


def guesses(
    row: Row, tied: tuple[Tie, ...], words: str, name: str, *, turned: bool = True
) -> Iterator[Guess]:
    """Yield systems of a row with letters, the likeliest first; ``turned``: with angles either way."""
    plain = row if turned else replace(row, angles=())
    for table in descriptions(plain, {t.means for t in tied}, words):
        _TABLES[_key(table)] = table
        yield Guess(
            row.name, table, tied, name, letters=row.letters, lines=row.lines, until=row.until
        )
