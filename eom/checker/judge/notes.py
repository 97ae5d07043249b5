"""A note with its lexicon: every formula with its claims, each read where it stands.

The literal reading comes first. Where it leaves something ill-formed, ambiguous or without a meaning,
the repairs of `eom.checker.read.damage` are tried; the first reading that leaves least is taken, and says
what was read otherwise.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import inf

from eom.checker.judge.coordinates import covered
from eom.checker.judge.judge import HOLDS, judge, row_of
from eom.checker.judge.laws import firsts
from eom.checker.judge.scalars import Known
from eom.checker.judge.systems import LEVELS, Solutions, agreeing, levelled
from eom.checker.judge.worlds import apart
from eom.checker.mean.calculus import MINUS, PLUS, POISSON, is_fundamental
from eom.checker.mean.claims import DEFINITION, Claim, Relation, claims, defined
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.indices import free
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.model import Model
from eom.checker.mean.moving import Moving, moving
from eom.checker.mean.parameters import limited, named, read, tied
from eom.checker.mean.roles import (
    CLAIM,
    LAW,
    Named,
    brings,
    first,
    in_a_case,
    labelled,
    listed,
    otherwise_named,
    roles,
    running,
    says,
    unnamed,
)
from eom.checker.mean.solid_words import Beside, Taken, beside, readings
from eom.checker.mean.values import UNDECIDED, WRONG, Finding, Value, atoms_in
from eom.checker.read.damage import Repair, Variant, apply, cross_before_column, variants
from eom.checker.read.documents import Document, Piece
from eom.checker.read.grammar import Reading
from eom.checker.read.spans import Source
from eom.checker.read.statements import Formula, Statement, read_piece, split
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.syntax import Node, Scripts, children
from eom.checker.read.tokens import tokenize
from eom.errors import InputError
from eom.limits import Overdue, deadline


@dataclass(frozen=True)
class Scalars:
    """Letters that a note names alone, relations between them so far, whether a formula defines one."""

    named: frozenset[Look] = frozenset()
    relations: tuple[Relation, ...] = ()
    defining: bool = False


@dataclass(frozen=True)
class Around:
    """What a formula may refer to: what the note has defined before it, the display that it continues.

    ``trees``: those of all formulas of the note, in order, so that what is written elsewhere can be
    proposed; ``number``: which of them is the formula's own; ``scalars``: letters of its own.
    """

    definitions: Mapping[Look, Value] = field(default_factory=dict)
    before: tuple[Claim, ...] = ()
    previous: tuple[Statement, ...] = ()
    trees: tuple[Node, ...] = ()
    number: int = 0
    scalars: Scalars = field(default_factory=Scalars)


@dataclass(frozen=True)
class Understood:
    """A formula with its claims, the lexicon that holds there, and the headings above it.

    ``repairs``: what was read otherwise than it stands; none for the literal reading. ``role``: by the
    words around it, see `eom.checker.mean.roles`; ``solid``: what words about a solid were taken to mean;
    ``doubtful``: letters that the system has for energies and the note perhaps for something else, with
    whether its words say so.
    """

    formula: Formula
    claims: tuple[Claim, ...]
    lexicon: Lexicon
    headings: tuple[str, ...]
    repairs: tuple[Repair, ...] = ()
    role: str = CLAIM
    solid: Taken | None = None
    doubtful: Mapping[str, bool] = field(default_factory=dict)
    around: Around = field(default_factory=Around, compare=False, repr=False)


def understand(
    document: Document, lexicon: Lexicon, seconds: float = inf
) -> tuple[Understood, ...]:
    """Return every formula of a document with its claims, in order.

    A display may continue the display before; what the note defines holds from there on. What takes
    more than ``seconds`` claims something undecided. Words about a solid are read in one way throughout a
    section: that in which most of its lines hold.
    """
    solids = _Solids()
    found = _understood(document, lexicon, seconds, solids)
    if not solids.disagree:
        return found
    every = _Solids(every=True)
    _understood(document, lexicon, seconds, every)
    settled = _Solids(settled=every.most())
    return _understood(document, lexicon, seconds, settled) if settled.settled else found


Group = tuple[tuple[str, ...], str]
"""The headings above, and the pattern of the noun that names a solid."""


@dataclass
class _Solids:
    """How words about solids were taken in the lines that hold, by section and noun.

    ``every``: whether all readings of a line are looked at, not only the first in which it holds;
    ``settled``: the reading of a section.
    """

    every: bool = False
    settled: Mapping[Group, Taken] = field(default_factory=dict)
    held: dict[Group, list[list[Taken]]] = field(default_factory=dict)

    def allows(self, group: Group, taken: Taken) -> bool:
        """Return whether a reading is that of the section, where that is settled."""
        return group not in self.settled or self.settled[group].fits(taken)

    @property
    def disagree(self) -> bool:
        """Whether lines of one section hold in readings that exclude each other."""
        rows = ([t for line in lines for t in line] for lines in self.held.values())
        return any(not a.fits(b) for row in rows for a in row for b in row)

    def most(self) -> Mapping[Group, Taken]:
        """Return the readings in which most lines of a section hold, two at least."""
        found: dict[Group, Taken] = {}
        for group, lines in self.held.items():
            tried = dict.fromkeys(t for line in lines for t in line)
            holding = {t: sum(any(t.fits(o) for o in line) for line in lines) for t in tried}
            best = max(holding, key=lambda t: holding[t])
            if max(2, len(lines) / 2 + 0.5) <= holding[best]:
                found[group] = best
        return found


def _understood(
    document: Document, lexicon: Lexicon, seconds: float, taken: _Solids
) -> tuple[Understood, ...]:
    """Return the formulas, with words about solids read in the ways that are allowed."""
    found: list[Understood] = []
    headings: list[tuple[int, str]] = []
    scoped = _Scoped(lexicon)
    definitions: dict[Look, Value] = {}
    previous: tuple[Statement, ...] = ()
    before: tuple[Claim, ...] = ()
    letters, relations, named_here, new_names = _named(document), Known(), Named(), False
    solids, levels = beside(document.pieces), _Levels()
    for number, (piece, role) in enumerate(
        zip(document.pieces, roles(document.pieces), strict=True)
    ):
        if piece.kind == "heading":
            headings = [h for h in headings if h[0] < piece.level]
            headings.append((piece.level, piece.body.strip("# \n\t")))
        if not piece.is_formula:
            continue
        display = piece.kind == "display"
        titles = tuple(h[1] for h in headings)
        here = levels.known(scoped.at(titles, piece.source, piece.span.start))
        known, earlier = dict(definitions), previous if display else ()
        new_names = brings(document.pieces, number, role, new_names)
        known |= named_here.at(titles)
        scalars = Scalars(letters, relations.at(titles), new_names)
        context = _Context(here, known, before if display else (), scalars)
        general = _timely(read_piece(piece, earlier), earlier, context, seconds)
        new = _of_solid(solids.get(number, ()), general, earlier, context, seconds, taken, titles)
        new = levels.counted(new, titles)
        if display:
            previous, before = new.formula.statements, new.claims
        if new_names:
            named_here.add(titles, new.claims)
        if not in_a_case(document.pieces, number):
            definitions |= _lasting(new.claims, new.lexicon, new_names)
        relations.add(titles, general.claims)
        around = Around(known, context.before, earlier, (), len(found), scalars)
        found.append(replace(new, headings=titles, role=role, around=around))
    return _doubted(_finished(found), document.pieces)


def _doubted(found: tuple[Understood, ...], pieces: tuple[Piece, ...]) -> tuple[Understood, ...]:
    """Return formulas with the letters that need not be the energies which the system has by them.

    They are those that words under the same heading give to something else, and those that no words
    name, until a line holds with them.
    """
    places, without_words = {id(p): k for k, p in enumerate(pieces)}, unnamed(pieces)
    others = [
        (u.headings, u.formula.piece.body.strip()[0])
        for u in found
        if otherwise_named(pieces, places[id(u.formula.piece)])
    ]
    loose = without_words if any(u.claims and _misfits(u) for u in found) else frozenset()
    held = {k for k in loose for u in found for c in u.claims if _mentions(c, k) and _true(c)}
    return tuple(
        replace(u, doubtful={k: True for t, k in others if t == u.headings and _by_letter(u, k)})
        if any(t == u.headings for t, _ in others)
        else replace(u, doubtful={k: False for k in loose - held if _by_letter(u, k)})
        for u in found
    )


def _misfits(u: Understood) -> bool:
    """Return whether dimensions in a formula differ."""
    return any(f.verdict == WRONG for c in u.claims for f in c.findings)


def _mentions(claim: Claim, letter: str) -> bool:
    atoms = (a for m in claim.members for a in atoms_in(m.term, claim.scalars))
    return any(a.data[:2] == ("system", letter) for a in atoms)


def _true(claim: Claim) -> bool:
    return not claim.findings and judge(claim).verdict == HOLDS


def _by_letter(u: Understood, letter: str) -> bool:
    """Return whether a formula has an energy of the system by a letter that the lexicon says nothing of."""
    found, model, reading = u.lexicon.find(Look(letter)), u.lexicon.system, u.formula.reading
    if found is None or model is None or reading is None or found.entry.where.endswith(letter):
        return False
    energies = {d.name for d in model.system.outputs}
    return (
        found.meaning.labels == (letter,)
        and letter in energies
        and Look(letter) in _symbols(reading.tree)
    )


def _symbols(node: Node) -> Iterator[Look]:
    """Yield the symbols of a formula; indices and the mark of a transpose are none."""
    found = seen(node)
    if found is not None:
        yield found.look
        return
    for inside in (node.base,) if isinstance(node, Scripts) else children(node):
        yield from _symbols(inside)


@dataclass
class _Levels:
    """From where a note counts potential energy: systems in the place of others, by the places of these.

    The first line that says it does so, once under each heading; other lines have to agree.
    """

    moved: dict[int, tuple[Model, Model, tuple[str, ...]]] = field(default_factory=dict)
    places: dict[int, tuple[Lexicon, Lexicon]] = field(default_factory=dict)

    def known(self, here: Lexicon) -> Lexicon:
        """Return a lexicon with the system as the note counts its energy."""
        old, new, _ = self.moved.get(id(here.system), (None, None, ()))
        if old is None:
            return here
        kept = self.places.get(id(here))
        if kept is None or kept[1].system is not new:
            self.places[id(here)] = kept = (here, replace(here, system=new))
        return kept[1]

    def counted(self, new: Understood, titles: tuple[str, ...]) -> Understood:
        """Return a formula with the system in which it holds, where a constant is all that it may lack."""
        now = new.lexicon.system
        first = next((k for k, (_, m, _) in self.moved.items() if m is now), id(now))
        if now is None or (first in self.moved and self.moved[first][2] == titles):
            return new
        for claim in new.claims:
            other = _level(claim)
            if other is not None:
                old = self.moved[first][0] if first in self.moved else now
                self.moved[first] = (old, other, titles)
                claims = tuple(replace(c, model=c.model and other) for c in new.claims)
                return replace(new, claims=claims, lexicon=replace(new.lexicon, system=other))
        return new


def _level(claim: Claim) -> Model | None:
    """Return the system in which a claim on energies holds, by a constant; None where it holds in none."""
    atoms = (a for m in claim.members for a in atoms_in(m.term, claim.scalars))
    levels = any(a.data[0] == "system" and a.data[1] in LEVELS for a in atoms)
    if not levels or claim.findings or row_of(claim) is not Solutions:
        return None
    other = levelled(claim)
    held = other is not None and judge(replace(claim, model=other)).verdict == HOLDS
    return other if held else None


def _finished(found: Iterable[Understood]) -> tuple[Understood, ...]:
    """Return formulas with the trees of all of them around, and laws of the writer's own marked as such."""
    found = tuple(found)
    trees = tuple(u.formula.reading.tree for u in found if u.formula.reading is not None)
    placed = [replace(u, around=replace(u.around, trees=trees)) for u in found]
    return tuple(
        replace(u, role=LAW) if law and u.role == CLAIM else u
        for u, law in zip(placed, firsts(u.claims for u in placed), strict=True)
    )


def _lasting(found: Iterable[Claim], here: Lexicon, scoped: bool) -> dict[Look, Value]:
    """Return what claims define beyond their heading; ``scoped``: only what the lexicon leaves to them."""
    return {k: v for k, v in defined(found).items() if not scoped or here.find(k) is not None}


def _named(document: Document) -> frozenset[Look]:
    """Return the letters that stand alone in the sentences of a note."""
    short = (p for p in document.pieces if p.kind == "inline" and len(p.body) <= MAX_LETTER)
    readings = (read_piece(p, ()).reading for p in short)
    return named(r.tree for r in readings if r is not None)


MAX_LETTER = 40
"""Characters of a formula that is looked at for a letter alone."""


def reread(understood: Understood, tree: Node) -> tuple[Claim, ...]:
    """Return the claims of another tree that stands in the place of a formula."""
    reading, around = understood.formula.reading, understood.around
    tags = [text for text, _ in reading.tags] if reading is not None else []
    context = _Context(understood.lexicon, dict(around.definitions), around.before, around.scalars)
    return context.claims(split(tree, around.previous, tags))


@dataclass(frozen=True)
class _Context:
    """What a formula may refer to."""

    lexicon: Lexicon
    definitions: dict[Look, Value]
    before: tuple[Claim, ...]
    scalars: Scalars

    def claims(self, statements: Iterable[Statement]) -> tuple[Claim, ...]:
        """Return the claims of statements; each may use what the others define, those before it first."""
        given = tuple(statements)
        statements, index = [s for s in given if not listed(s)], running(given)
        known = dict(self.definitions)
        rows: list[tuple[Claim, ...]] = []
        for statement in statements:
            before = (*self.before, *(c for found in rows for c in found))
            found = self._indexed(statement, known, before, index)
            rows.append(self._signs(statement, known, found) or found)
            known |= defined(rows[-1])
        for n, statement in enumerate(statements):
            later = defined(c for found in rows[n + 1 :] for c in found if c.kind == DEFINITION)
            if later and _gaps(rows[n]):
                before = (*self.before, *(c for found in rows[:n] for c in found))
                own = {**self.definitions, **defined(c for f in rows[:n] for c in f), **later}
                rows[n] = min((rows[n], self._indexed(statement, own, before, index)), key=_gaps)
        return tuple(c for found in rows for c in found)

    def _signs(
        self, statement: Statement, known: dict[Look, Value], found: tuple[Claim, ...]
    ) -> tuple[Claim, ...]:
        """Return that a bracket of a coordinate and a momentum gives all their sign, or nothing."""
        if all(c.otherwise is None for c in found):
            return ()
        axes = found[0].indices
        if not is_fundamental(elaborator(self.lexicon, known).bound(**axes), statement.members):
            return ()
        rows = {
            PLUS: [replace(c, otherwise=None) for c in found],
            MINUS: [c.otherwise or c for c in found],
        }
        held = [s for s, row in rows.items() if all(judge(c).verdict == HOLDS for c in row)]
        if len(held) != 1:
            return ()
        (sign,) = held
        made = Claim((sign, sign), ("=",), DEFINITION, defines=POISSON, span=statement.span)
        return (made,)

    def _indexed(
        self, statement: Statement, known: dict[Look, Value], before: tuple[Claim, ...], index: str
    ) -> tuple[Claim, ...]:
        """Return what a statement claims, where it has free indices for each of their values."""
        new = self._claims(statement, known, before)
        if index and _gaps(new) and labelled(statement, index):
            axes: tuple[Mapping[str, str], ...] = tuple({index: k} for k in "123")
        else:
            axes = free(statement, elaborator(self.lexicon, known)) if _gaps(new) else ()
        return min((new, self._each(statement, known, before, axes)), key=_gaps) if axes else new

    def _each(
        self,
        statement: Statement,
        known: dict[Look, Value],
        before: tuple[Claim, ...],
        axes: tuple[Mapping[str, str], ...],
    ) -> tuple[Claim, ...]:
        """Return what a statement claims for each of the axes that its indices run over."""
        found = (c for a in axes for c in claims(statement, self.lexicon, known, before, a))
        return tuple(_with_motion(c, self.lexicon.moving) for c in found)

    def _claims(
        self, statement: Statement, known: dict[Look, Value], before: tuple[Claim, ...]
    ) -> tuple[Claim, ...]:
        """Return what a statement claims: of the note's system, or of bodies in general.

        What is not about scalars of the system alone is read without it, if that leaves no more without
        a meaning.
        """
        new = self._general(statement, known, before)
        if not _gaps(new) and (not limited(statement) or all(map(_of_system, new))):
            return new
        own = self.scalars
        brought = first(statement, self.lexicon) if own.defining else None
        if brought is not None:
            other = self._general(brought, known, before)
            if not _gaps(other) and says(other):
                return other
        scalars = read(statement, self.lexicon, own.named, own.relations, defining=own.defining)
        if scalars is not None and all(judge(c).verdict != UNDECIDED for c in scalars):
            return scalars
        if _gaps(new):
            return new
        what = Finding(UNDECIDED, "what this integral says is no identity", statement.span)
        return tuple(replace(c, findings=(*c.findings, what)) for c in new)

    def _general(
        self, statement: Statement, known: dict[Look, Value], before: tuple[Claim, ...]
    ) -> tuple[Claim, ...]:
        new = claims(statement, self.lexicon, known, before)
        new = tuple(_with_motion(c, self.lexicon.moving) for c in new)
        if self.lexicon.system is None or all(covered(c) or c.numbers for c in new):
            return new
        other = claims(statement, self.lexicon.without_system(), known, before)
        return min((other, new), key=_gaps)


def _with_motion(claim: Claim, moving: Moving | None) -> Claim:
    """Return a claim that knows what the note declares to move, if it speaks of that.

    It is undecided where letters clash.
    """
    if moving is None:
        return claim
    known = moving.scalars
    clash = [s for s, t in claim.scalars.items() if known.get(s, t) != t]
    if clash:
        what = "a letter has another meaning where motions are declared"
        finding = Finding(UNDECIDED, what, claim.span, str(clash[0]))
        claim = replace(claim, findings=(*claim.findings, finding))
    told = replace(claim, moving=moving, scalars={**claim.scalars, **known})
    return apart(told) or told


def _of_system(claim: Claim) -> bool:
    return claim.model is not None and covered(claim)


def _decided(claim: Claim) -> bool:
    """Return whether a claim is one that the solutions of its system decide."""
    with suppress(InputError):
        return _of_system(claim) and bool(Solutions(claim, claim.scalars).said)
    return False


def _of_solid(
    said: tuple[Beside, ...],
    general: Understood,
    previous: tuple[Statement, ...],
    context: _Context,
    seconds: float,
    solids: _Solids,
    titles: tuple[str, ...],
) -> Understood:
    """Return a formula about the solid that the words beside it name, by the reading that suits it best.

    A formula that the words make nothing of, or whose lexicon names a system, stays as it is; so does what
    holds in no reading where the words leave it open, or are about several solids.
    """
    formula, best, most = general.formula, general, -1
    if formula.reading is None or context.lexicon.system is not None:
        return general
    tree = formula.reading.tree
    for one in (s for s in said if s.concerns(tree)):
        group, held = (titles, one.noun.pattern.pattern), list[Taken]()
        for lexicon, sure, taken in readings(context.lexicon, one, tree):
            if not solids.allows(group, taken):
                continue
            new = _timely(formula, previous, replace(context, lexicon=lexicon), seconds)
            about = [c for c in new.claims if _decided(c)]
            if not about or _left(new) > _left(general):
                break
            new = replace(new, solid=taken)
            count = sum(map(agreeing, about))
            if sure and len(said) == 1 and count > most:
                best, most = new, count
            if all(agreeing(c) == len(c.members) - 1 for c in about):
                best, most = (best, most) if held else (new, len(formula.piece.body))
                held.append(taken)
                if not solids.every:
                    break
        if held:
            solids.held.setdefault(group, []).append(held)
            return best
    return best


def _gaps(found: Iterable[Claim]) -> int:
    """Return how many places of claims have no meaning."""
    return sum(f.verdict != WRONG for c in found for f in c.findings)


def _timely(
    formula: Formula, previous: tuple[Statement, ...], context: _Context, seconds: float
) -> Understood:
    """Return the best reading, or say why there is none in time."""
    try:
        with deadline(seconds, "the meaning of this formula"):
            return _best(formula, previous, context)
    except Overdue as error:
        why = str(error)
    except RecursionError:
        why = "the formula is too long a chain of operations"
    finding = Finding(UNDECIDED, why, formula.piece.span)
    claim = Claim((), findings=(finding,), span=formula.piece.span)
    return Understood(formula, (claim,), context.lexicon, ())


def _best(formula: Formula, previous: tuple[Statement, ...], context: _Context) -> Understood:
    """Return the reading that leaves least without a meaning; the literal one if it leaves nothing."""
    literal = Understood(formula, context.claims(formula.statements), context.lexicon, ())
    if formula.reading is None or not _left(literal):
        return literal
    piece = formula.piece
    tokens = tokenize(piece.source, piece.body, piece.span.start, piece.macros)
    tried = [literal]
    for variant in (*variants(piece.source, tokens), *_columns(formula.reading)):
        tags = [text for text, _ in variant.reading.tags]
        statements = split(variant.reading.tree, previous, tags)
        other = Formula(piece, variant.reading, statements)
        new = context.claims(statements)
        tried.append(Understood(other, new, context.lexicon, (), variant.repairs))
    return min(tried, key=_left)


_CROSS = ("cross of columns", "a cross between columns read as a superscript", cross_before_column)


def _columns(reading: Reading) -> tuple[Variant, ...]:
    """Return the reading in which every cross is one of columns and matrices."""
    tree, repairs = apply(reading.tree, (_CROSS,))
    return (Variant(replace(reading, tree=tree), repairs),) if repairs else ()


def _left(understood: Understood) -> int:
    """Return how many places have no meaning as they are read."""
    return _gaps(understood.claims)


class _Scoped:
    """A lexicon at every place; places with the same parts of the note share one."""

    def __init__(self, lexicon: Lexicon) -> None:
        self.lexicon = lexicon
        self.known: dict[tuple[tuple[str, ...], frozenset[str]], Lexicon] = {}
        self.begins: dict[tuple[int, str], int] = {}
        self.passed: set[str] = set()

    def at(self, headings: tuple[str, ...], source: Source, place: int) -> Lexicon:
        for scope in self.lexicon.scopes:
            if scope.after and self._begin(scope.after, source) <= place:
                self.passed.add(scope.after)
        key = (headings, frozenset(self.passed))
        if key not in self.known:
            here = self.lexicon.at(headings, key[1])
            if any(r[1] for r in here.own_laws):
                here = replace(here, tied=tied(here))
            if here.moving_data:
                here = replace(here, moving=moving(here))
            self.known[key] = here
        return self.known[key]

    def _begin(self, phrase: str, source: Source) -> int:
        key = (id(source), phrase)
        if key not in self.begins:
            pattern = r"\s+".join(re.escape(w) for w in phrase.split())
            match = re.search(pattern, source.text, re.IGNORECASE)
            self.begins[key] = match.end() if match else len(source.text) + 1
        return self.begins[key]
