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
from collections import Counter
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from eom.checker.infer.attitude import angles, components, single_turns, turned
from eom.checker.infer.books import TOPICS, taken
from eom.checker.infer.densities import densities
from eom.checker.infer.house import drafted, fit, houses, kept
from eom.checker.infer.in_text import by_formulas
from eom.checker.infer.letters import (
    ANY,
    BOOKS,
    CUSTOMARY,
    DISPLAY,
    FORMULA,
    GUESSED,
    LETTER,
    Draft,
    along,
    by_custom,
    derived,
    followed,
    free_vectors,
    introduced,
    is_any,
    labelled,
    said_by,
)
from eom.checker.infer.lists import listed, redefined, turns
from eom.checker.infer.phrases import Phrases, fits, fitting, slotted, spelt
from eom.checker.infer.places import DOT, marks, places
from eom.checker.infer.sayings import Prose, Said, look_of, prose, said
from eom.checker.infer.sections import sections
from eom.checker.infer.shown import bare, has_dyads, known, mended, primed, symbols
from eom.checker.infer.slots import by_places
from eom.checker.infer.systems import USUAL, Guess, is_name, led, with_systems
from eom.checker.infer.trials import systems
from eom.checker.mean.claims import claims
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
from eom.checker.read.documents import Document
from eom.checker.read.grammar import read_formula
from eom.checker.read.spans import printable
from eom.checker.read.statements import Formula, read
from eom.checker.read.symbol_shape import Look
from eom.checker.read.syntax import (
    Node,
    walk,
)
from eom.checker.read.writing import latex_of
from eom.errors import InputError
from eom.limits import Overdue

MAX_UNKNOWN = 40
"""Symbols that are looked for in books, those that stand in most places first."""


@dataclass(frozen=True)
class Proposal:
    """A preset, drafts of entries, symbols that the note defines, and those without a place.

    ``others``: other meanings that words of the note give the same symbols elsewhere; ``body``: whose
    mechanics it is about; ``confirmed``: patterns of the preset of which words say the same; ``systems``:
    what lines of scalars are about; ``words``: whether the note has any.
    """

    preset: str
    drafts: tuple[Draft, ...]
    defined: tuple[tuple[str, int], ...]
    unplaced: tuple[tuple[str, int], ...]
    others: tuple[Draft, ...] = ()
    body: str = "body"
    confirmed: frozenset[str] = frozenset()
    systems: tuple[Guess, ...] = ()
    parts: tuple[tuple[str, tuple[Draft, ...]], ...] = ()
    words: bool = True

    @property
    def toml(self) -> str:
        """The draft as a lexicon, with its sources as comments."""
        lines = [f'preset = "{self.preset}"'] if self.preset else []
        for table in ("notation", "frames", "points", "marks", "symbols"):
            rows = [d for d in self.drafts if d.table == table]
            lines += ["", f"[{table}]"] if rows else []
            lines += [_row(d) for d in rows]
        whole = [one for one in self.systems if one.whole_note]
        lines += [line for one in whole for line in _described(one)]
        for heading, own in self.parts:
            lines += ["", "[[scope]]", f"heading = {_text(heading)}", "[scope.symbols]"]
            lines += [_row(d) for d in own]
        own_systems = [one for one in self.systems if not one.whole_note]
        lines += [line for one in own_systems for line in _described(one)]
        if self.defined:
            lines += ["", "# defined by the note itself:"]
            lines += [f"#   {printable(latex)}  (line {line})" for latex, line in self.defined]
        if self.unplaced:
            lines += ["", "# without a meaning so far:"]
            lines += [f"#   {printable(latex)}  (line {line})" for latex, line in self.unplaced]
        return "\n".join(lines) + "\n"


def _described(one: Guess) -> Iterator[str]:
    """Yield the lines of the table of a system, at the top or of the part that is about it."""
    for heading in one.headings or ("",):
        scope = "" if one.whole_note else "scope."
        if scope:
            yield from ("", "[[scope]]")
        yield from (
            f"{k} = {_text(v)}" for k, v in (("heading", heading), ("after", one.after)) if v
        )
        why = f"the note says: {printable(one.words)}" if one.words else USUAL
        yield from ("", f"[{scope}system]  # {one.name}; {why}")
        yield from (f"{k} = {_inline(v)}" for k, v in one.table.items())
        yield from ("usual = false", "first = true", f"[{scope}system.symbols]")
        yield from (_row(Draft("symbols", t.latex, t.means, t.words, t.line)) for t in one.ties)


def _inline(value: Any) -> str:
    """Return a value of a description as TOML in one line."""
    if isinstance(value, Mapping):
        rows = ", ".join(f"{_key(k)} = {_inline(v)}" for k, v in value.items())
        return f"{{ {rows} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_inline, value))}]"
    return _text(value) if isinstance(value, str) else json.dumps(value)


def _text(value: str) -> str:
    """Return a text as TOML: JSON without halves of characters beyond 16 bits, and without DEL."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", r"\u007f")


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _text(name)


def _row(draft: Draft) -> str:
    """Return an entry as a line of TOML; patterns stand in simple quotes where they can."""
    words, meaning = printable(draft.words), _text(draft.meaning)
    plain = draft.latex.isprintable() and "'" not in draft.latex
    pattern = f"'{draft.latex}'" if plain else _text(draft.latex)
    where = f"line {draft.line}: " if draft.line else ""
    return f"{pattern} = {meaning}  # {where}{words}"


def propose(document: Document) -> Proposal:
    """Return a draft of the lexicon of a document.

    First what words say, on the preset that fits them best; then what letters and labels stand for that go
    with those; then formulas of the text and the usual books, for what is left.
    """
    with kept():
        return _proposed(document)


def _proposed(document: Document) -> Proposal:
    formulas, text = read(document), prose(document)
    named = frozenset((s.line, s.look) for s in led(document) if is_name(s.words))
    first = _Drafted(formulas, text, tuple(symbols(formulas)), named=named)
    first.by_words()
    first.by_systems(document)
    others = [
        replace(first, drafts={}, others=[], confirmed=set(), only=n, dropped={})
        for n in first.rivals
    ]
    others += [
        replace(
            note, drafts={PRIME: LABEL}, others=[], confirmed=set(), only=note.preset, dropped={}
        )
        for note in (first, *others[:1])
        if note.primed() and PRIME not in first.drafts
    ]
    for other in others:
        other.by_words()
    found = [(note, note.finished()) for note in (first, *others)]
    note, new = min(found, key=lambda f: f[0].cost)
    tied = {t.look for one in note.systems for t in one.ties}
    unknown = {
        note.lexicon.notation.plain(k): n for k, n in note.unknown().items() if k not in tied
    }
    return Proposal(
        note.preset,
        tuple(note.drafts.values()),
        tuple((latex_of(k), n) for k, n in new.items()),
        tuple((latex_of(k), n) for k, n in unknown.items() if k not in new),
        tuple(note.others),
        _body(text),
        frozenset(note.confirmed),
        note.systems,
        tuple(note.by_parts(document)),
        text.has_words,
    )


RIVALS = 2
"""Presets that are tried with the usual books; of those that go best with what words say."""
BESIDE = "beside what words call any vector, in identities"
PRIME = "marks", "prime"
LABEL = Draft(*PRIME, "", CUSTOMARY, 0)
"""That a prime is no derivative."""


@dataclass
class _Drafted:
    """A draft while it is made: its entries, the preset that goes with them, the lexicon of both.

    ``only``: the preset where no other is tried; ``ranked``: presets, those that go best with the entries
    in front; ``dropped``: what words say as one preset does, ``dropped_for``, which come back with another.
    """

    formulas: tuple[Formula, ...]
    text: Prose
    symbols: tuple[tuple[Node, int], ...]
    drafts: dict[tuple[str, str], Draft] = field(default_factory=dict)
    others: list[Draft] = field(default_factory=list)
    confirmed: set[str] = field(default_factory=set)
    preset: str = ""
    lexicon: Lexicon = field(default_factory=Lexicon)
    systems: tuple[Guess, ...] = ()
    only: str = ""
    ranked: tuple[str, ...] = ()
    named: frozenset[tuple[int, Look]] = frozenset()
    dropped: dict[tuple[str, str], Draft] = field(default_factory=dict)
    dropped_for: str = ""

    @cached_property
    def looks(self) -> Mapping[Look, int]:
        """What symbols look like, with the first line of each."""
        found: dict[Look, int] = {}
        for node, line in self.symbols:
            look = bare(node)
            if look is not None:
                found.setdefault(look, line)
        return found

    def unknown(self) -> dict[Look, int]:
        """Return the symbols that nothing gives a meaning so far, with the first line of each."""
        found: dict[Look, int] = {}
        for node, line in self.symbols:
            look = bare(node, self.lexicon)
            if look is not None and not known(self.lexicon, node):
                found.setdefault(look, line)
        return found

    def primed(self) -> list[Look]:
        """Return the symbols with a prime that is no label so far, those that stand most often first."""
        count = Counter(k for n, _ in self.symbols if (k := primed(n)) is not None)
        return sorted((k for k in count if self.lexicon.find(k) is None), key=lambda k: -count[k])

    def add(self, draft: Draft) -> None:
        """Add an entry that a lexicon takes; what is said first stays, the rest is kept beside it."""
        if _reads(draft) and not self._taken(draft):
            first = self.drafts.setdefault((draft.table, draft.latex), draft)
            self.others += [draft] if first.meaning != draft.meaning else []

    def _taken(self, draft: Draft) -> bool:
        """Return whether a letter means the same with another label already: labels tell things apart."""
        label = re.compile(r"[_^]").split(draft.latex, maxsplit=1)
        if len(label) < 2 or draft.table != "symbols" or draft.meaning.startswith(("=", "defined")):
            return False
        return any(
            d.meaning == draft.meaning and k[1] != draft.latex and "<" not in k[1] + draft.latex
            for k, d in self.drafts.items()
            if re.split(r"[_^]", k[1], maxsplit=1)[0] == label[0] and len(k[1]) > len(label[0])
        )

    def settle(self) -> None:
        """Choose the preset that goes with the entries."""
        every = dict.fromkeys((*self.looks, *(m.look for m in self.text.mentions)))
        tables = _tables(self.drafts.values())
        names = (self.only,) if self.only else (*([""] if self.systems else []), *PRESETS)
        found = houses(self.formulas, tables, every, self._added, names)
        self.preset, self.lexicon = found[0]
        self.ranked = tuple(n for n, _ in found if n)
        if self.dropped and self.preset != self.dropped_for:
            own = preset(self.preset) if self.preset else Lexicon()
            lost = {k: d for k, d in self.dropped.items() if not said_by(own, d)}
            self.drafts, self.dropped = {**lost, **self.drafts}, {}
            self.lexicon = self._added(drafted(self.preset, _tables(self.drafts.values())))

    @property
    def rivals(self) -> tuple[str, ...]:
        """The presets that are tried beside the one that was chosen, if one was."""
        found = [n for n in self.ranked[:RIVALS] if n != self.preset and self.preset]
        if (
            not self.text.has_words
            and any(map(has_dyads, self.formulas))
            and not self.lexicon.notation.dyads
        ):
            found += [n for n in PRESETS if preset(n).notation.dyads and n not in found]
        return tuple(found)

    @property
    def cost(self) -> int:
        """How many lines and symbols are left without a meaning, or with one that books alone give."""
        guesses = sum(d.words == BOOKS for d in self.drafts.values())
        return fit(self.formulas, self.lexicon).cost + len(self.unknown()) + guesses

    def finished(self) -> dict[Look, int]:
        """Take what letters, labels and books say where words are silent; return what the note defines."""
        said = {d.latex for d in self.drafts.values() if d.words not in GUESSED}
        for draft in followed(self.lexicon, self.looks, said):
            self.add(draft)
        for draft in derived(self.lexicon, (n for n, _ in self.symbols), self.text):
            self.add(draft)
        self.settle()
        self.refine()
        for draft in by_custom(self.lexicon, self.looks, self.drafts):
            self.drafts[draft.table, draft.latex] = draft
        self.settle()
        self.by_places()
        self.by_labels()
        new = _defined(self.formulas, self.lexicon)
        self.by_books(new)
        more = (
            *introduced(self.formulas, self.lexicon, self.named),
            *densities(self.formulas, self.lexicon, self.text),
        )
        for draft in more:
            self.add(draft)
        self.settle()
        return new

    def _added(self, lexicon: Lexicon) -> Lexicon:
        """Return a lexicon about the note's systems."""
        return with_systems(lexicon, self.systems)

    def by_systems(self, document: Document) -> None:
        """Take the systems that the note is about; other meanings of their letters hold elsewhere."""
        self.systems = systems(document, self.lexicon)
        if self.systems:
            self.settle()

    def by_words(self) -> None:
        """Take what words say, but for what the preset says as well, or more closely."""
        for draft in _by_words(self.text, tuple(said(self.text)), tuple(self.looks)):
            self.add(draft)
        self.settle()
        own = preset(self.preset)
        known = {k: said_by(own, d) for k, d in self.drafts.items()}
        self.confirmed = {p for p in known.values() if p}
        self.dropped = {k: d for k, d in self.drafts.items() if known[k]}
        self.dropped_for = self.preset
        self.drafts = {k: d for k, d in self.drafts.items() if not known[k]}
        self.settle()
        self.by_lists()
        for look in turned(self.text):
            found = self.lexicon.find(look)
            if found is not None and found.meaning.quantity in {"angle", "turn_angle"}:
                self.confirmed.add(found.entry.latex)

    def by_lists(self) -> None:
        """Take letters that columns, diagonals and sums along unit vectors have as their entries."""
        shown = (
            (s, f.piece.line, True)
            for f in self.formulas
            if f.piece.kind == "display"
            for s in f.statements
        )
        texts = ((*t, False) for t in zip(self.text.formulas, self.text.lines, strict=True))
        every = (*texts, *shown)
        found = [d for s, n, a in every for d in listed(s, n, self.lexicon, shown=a)]
        found += [d for s, n, _ in every for d in redefined(s, n, self.lexicon)]
        tables = list(turns(self.formulas))
        for draft in tables:
            self.drafts.pop((draft.table, draft.latex), None)
        for draft in (*found, *tables):
            self.add(draft)
        if found or tables:
            self.settle()

    def refine(self) -> None:
        """Take other shapes of what symbols are said to be, where more lines make sense with them."""
        for key, draft in tuple(self.drafts.items()):
            for means in _shapes(draft):
                other = {**self.drafts, key: replace(draft, meaning=means)}
                lexicon = self._added(drafted(self.preset, _tables(other.values())))
                new, here = fit(self.formulas, lexicon), fit(self.formulas, self.lexicon)
                if (new.ill, new.cost) < (here.ill, here.cost) and new.cost <= here.cost:
                    self.drafts, self.lexicon = other, lexicon

    def by_parts(self, document: Document) -> Iterator[tuple[str, tuple[Draft, ...]]]:
        """Yield what parts of the note say otherwise; letters of a part's own system are its."""

        def reads(latex: str, means: str) -> bool:
            return _reads(Draft("symbols", latex, means, "", 0))

        for heading, rows in sections(document, _body(self.text), self.lexicon, reads):
            ties = (t for one in self.systems if heading in one.headings for t in one.ties)
            own = {latex_of(tie.look) for tie in ties}
            told = (Draft("symbols", o.latex, o.means, o.words, o.line) for o in rows)
            if kept := tuple(d for d in told if d.latex not in own):
                yield heading, kept

    def by_labels(self) -> None:
        """Take what displays define by raised labels, and components of that as the text says."""
        for draft in labelled(self.formulas, self.lexicon):
            self.add(draft)
        self.settle()
        shown = [
            (s, f.piece.line)
            for f in self.formulas
            if f.piece.kind == "display"
            for s in (*f.statements, *mended(f))
        ]
        texts = zip(self.text.formulas, self.text.lines, strict=True)
        for statement, line in (*shown, *texts):
            for draft in along(statement, line, self.lexicon):
                self.add(draft)
        for statement, line in self.text.cases:
            self.others += along(statement, line, self.lexicon, known=True)
        for look, draft in by_formulas(self.text, self.lexicon).items():
            if "<k>" in draft.latex and look.sup and _reads(draft):
                one = lexicon_of(_tables((draft,)), DRAFT)[0]
                same = {
                    k: d for k, d in self.drafts.items() if d.words == DISPLAY and _is(one, d.latex)
                }
                self.drafts = {k: d for k, d in self.drafts.items() if k not in same}
                self.add(draft)
        self.settle()

    def any_vectors(self, *, told: bool) -> None:
        """Take letters of identities for any vectors; ``told``: only beside those that words call so."""
        for look, means in free_vectors(self.formulas, self.lexicon, self.unknown(), told=told):
            pattern = latex_of(look)
            words = BESIDE if told else CUSTOMARY
            self.drafts["symbols", pattern] = Draft("symbols", pattern, means, words, 0)

    def by_places(self) -> None:
        """Take labels for frames and points by where they stand, in a note without words."""
        members = [m for f in self.formulas for s in f.statements for m in s.members]
        nodes = [] if self.text.has_words else [n for m in members for n in walk(m)]
        for draft in by_places(self.lexicon, self.looks, nodes) if nodes else ():
            self.add(draft)
        self.settle()

    def last_vectors(self, defined: Container[Look]) -> None:
        """Take vectors of which no words speak for any: identities hold for all of them."""
        for look in () if self.text.has_words else self.unknown():
            pattern, plain = latex_of(look), self.lexicon.notation.plain(look)
            if is_any(look) and (look.accents or look.style) and plain not in defined:
                components = not self.lexicon.has_vector(look)
                means = f"vector {look.name}" + " in B" * components
                self.add(Draft("symbols", pattern, means, ANY, self.looks.get(look, 0)))
        self.settle()

    def by_books(self, defined: Container[Look]) -> None:
        """Take formulas of the text and the usual books for symbols without a meaning."""
        self.any_vectors(told=True)
        self.settle()
        plain = lexicon_of(_tables(self.drafts.values()), DRAFT)[0]
        own = {
            k: (d.latex, d.meaning)
            for k, d in by_formulas(self.text, self.lexicon).items()
            if plain.find(k) is None and _reads(d)
        }
        count = Counter(k for n, _ in self.symbols if (k := bare(n)) is not None)
        left = sorted((k for k in self.unknown() if k not in own), key=lambda k: -count[k])
        primes = self.primed()
        order = [*(k for k in (*self.looks, *primes) if k in own), *left[:MAX_UNKNOWN]]
        order += [k for k in primes if k not in own]
        order = [k for k in order if self.lexicon.notation.plain(k) not in defined]
        tables = _tables(self.drafts.values())
        body = _body(self.text)
        absent = _absent(self.text)
        books = taken(
            self.formulas, self.preset, tables, order, body, own, self._added, absent=absent
        )
        for pattern, (means, look) in books.items():
            words = FORMULA if own.get(look) == (pattern, means) else BOOKS
            line = self.looks.get(look, 0)
            self.drafts["symbols", pattern] = Draft("symbols", pattern, means, words, line)
        self.any_vectors(told=False)
        self.settle()
        self.last_vectors(defined)
        for draft in derived(self.lexicon, (n for n, _ in self.symbols), self.text):
            self.add(draft)
        self.settle()
        self.refine()


def _shapes(draft: Draft) -> Iterator[str]:
    """Yield a vector in the place of its norm by the letter, the matrix of an inertia in body axes."""
    if draft.words == LETTER and draft.meaning.startswith(r"= \left|"):
        yield draft.meaning.replace(r"\left|", "").replace(r"\right|", "")
    if draft.table == "symbols" and re.fullmatch(r"inertia \S+", draft.meaning):
        yield f"{draft.meaning} in B"


def _absent(text: Prose) -> frozenset[str]:
    """Return what a note with words says nothing of."""
    said = [p for p, (words, _) in TOPICS.items() if any(words.search(s) for s in text.sentences)]
    return frozenset(TOPICS) - {*said} if text.sentences else frozenset({"wheels"})


def _tables(drafts: Iterable[Draft]) -> dict[str, dict[str, str]]:
    """Return entries as tables of a lexicon."""
    found: dict[str, dict[str, str]] = {}
    for draft in drafts:
        found.setdefault(draft.table, {})[draft.latex] = draft.meaning
    return found


def _reads(draft: Draft) -> bool:
    """Return whether a lexicon takes an entry."""
    try:
        lexicon_of({"preset": PRESETS[0], draft.table: {draft.latex: draft.meaning}}, DRAFT)
    except InputError:
        return False
    return True


def _by_words(text: Prose, sayings: tuple[Said, ...], looks: tuple[Look, ...]) -> Iterator[Draft]:
    """Yield entries that the words of a note give, the plainest first."""
    found = places(text, sayings, looks)
    for table in ("frames", "points"):
        for label, name in getattr(found, table).items():
            words, line = found.words[table, label]
            yield Draft(table, spelt(label), name, words, line)
    yield from _attitude(text)
    for mark, name, words, line in marks(text, found):
        yield Draft("notation" if mark == DOT else "marks", mark, name, words, line)
    phrases = Phrases(text, found, _body(text))
    for one in sayings:
        for meant in fitting(phrases, one):
            for pattern, means in slotted(meant, found):
                yield Draft("symbols", pattern, means, meant.words, meant.line)
            for part, more in components(meant.look, meant.means):
                yield Draft("symbols", latex_of(part), more, meant.words, meant.line)


def _is(lexicon: Lexicon, latex: str) -> bool:
    """Return whether a lexicon knows a symbol by its LaTeX."""
    look = look_of(read_formula(latex).tree)
    return look is not None and lexicon.find(look) is not None


def _body(text: Prose) -> str:
    """Return whose mechanics a note is about: a body's, that of particles, or of one."""
    words = " ".join(text.sentences).lower()
    if words.count("particle") + words.count("point mass") <= words.count("body"):
        return "body"
    return "system" if re.search(r"particles|point masses|particle ⟦", words) else "P"


def _attitude(text: Prose) -> Iterator[Draft]:
    """Yield the angles of sequences that the note names, the axis and angle of one turn."""
    for look, means, words, line in (*angles(text), *single_turns(text)):
        yield Draft("symbols", latex_of(look), means, words, line)


# -- symbols -------------------------------------------------------------------------------------


def _defined(formulas: tuple[Formula, ...], base: Lexicon) -> dict[Look, int]:
    """Return what signs of definition say is new, with lines."""
    found: dict[Look, int] = {}
    for formula in formulas:
        line = formula.piece.line
        for statement in formula.statements:
            if any(s.name == ":=" for s in statement.signs):
                look = bare(statement.members[0])
                if look is not None and claims(statement, base):
                    found.setdefault(base.notation.plain(look), line)
    return {k: n for k, n in found.items() if base.find(k) is None}


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


LOADS = frozenset({"rotor_torque", "gravity", "weight"})
"""What words say so plainly that it adds to any lexicon."""


def _added(document: Document, lexicon: Lexicon, origin: str) -> Meanings:
    """Return the meanings of a lexicon with loads that only the note's words explain, as it says."""
    drafts: dict[Look, Draft] = {}
    scoped = [e.look for s in lexicon.scopes for e in s.entries]
    text = prose(document)
    sayings = tuple(said(text))
    phrases = Phrases(text, places(text, sayings))
    for one in sayings:
        for meant in phrases.meant(one):
            look = lexicon.notation.plain(meant.look)
            known = lexicon.find(look) is not None or look in scoped
            if meant.means.split()[0] in LOADS and fits(look, meant.mark) and not known:
                drafts.setdefault(
                    look, Draft("symbols", latex_of(look), meant.means, meant.words, meant.line)
                )
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
    names = [f"preset {proposal.preset}"] if proposal.preset else []
    names += dict.fromkeys(one.name for one in proposal.systems)
    scopes = [{"heading": h, "symbols": {d.latex: d.meaning for d in r}} for h, r in proposal.parts]
    lexicon = with_systems(drafted(proposal.preset, data, scopes), proposal.systems)
    return Meanings(lexicon, f"{DRAFT} on {', '.join(names)}", proposal)


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
