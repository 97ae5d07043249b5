"""What is known of a note so far, and the sets of rules that a line may rest on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import groupby

from eom.checker.consequence.customs import (
    LAGRANGIANS,
    LAW,
    energies,
    is_moving,
    lagrange,
    meant,
)
from eom.checker.consequence.jets import MAY, Equal, Expr, derived, lettered
from eom.checker.consequence.rules import Rule, Rules, lone, solved
from eom.checker.consequence.slips import Slip
from eom.errors import InputError

FAILS = (InputError, ZeroDivisionError, ValueError, TypeError, OverflowError)
MAX_WEAK = 3
"""Lines on letters that stand before which are tried as premises, the last ones first."""


@dataclass(frozen=True)
class Followed:
    """What is found of a line: the formulas that it follows from, and its slip, if it has one.

    ``sure``: whether no line that it rests on is likelier to have the slip; ``under``: those of the
    formulas that nothing decides, and customs; ``held``: letters that are taken not to change; ``how``:
    `RATE`, `FIRST_ORDER`, or what of a linear system a letter is.
    """

    sources: frozenset[int]
    slip: Slip | None = None
    sure: bool = True
    under: frozenset[int] = frozenset()
    how: str = ""
    held: frozenset[Expr] = frozenset()


FIRST_ORDER = "first order"
"""How a line follows for small motions alone."""
RATE = "rate"
"""How a line follows of which only the derivative does: but for what it is at one time."""

Said = tuple[int, Equal]
"""What the formula with a number says."""


@dataclass
class Known:
    """What is known so far: of lines what was found of each of their equations, None for nothing.

    ``rules``: what lines say that bring a letter in; ``aside``: what sentences say; ``weak``: what lines
    say of letters that stand before, which may be meant of a special case. ``words``: what stands before
    each formula; ``letters``: of all formulas, but components of vectors; ``earlier``: letters that an
    earlier part gives, and this one may give anew.
    """

    words: Sequence[str] = ()
    letters: frozenset[Expr] = frozenset()
    rules: Rules = field(default_factory=Rules)
    seen: set[str] = field(default_factory=set)
    aside: list[Said] = field(default_factory=list)
    weak: list[Said] = field(default_factory=list)
    used: set[int] = field(default_factory=set)
    brought: set[int] = field(default_factory=set)
    vectors: set[int] = field(default_factory=set)
    found: dict[int, list[Followed | None]] = field(default_factory=dict)
    earlier: frozenset[str] = frozenset()
    lagrangian: Expr | None = None
    made: list[Rules] | None = None

    def begin_part(self) -> None:
        """Forget how what the last part was about moves; what letters were said to be is kept."""
        kept = {n: r for n, r in self.rules.known.items() if r.given and not r.order}
        self.rules = Rules(kept, list(self.rules.signs))
        self.weak, self.made = [], None
        self.earlier = frozenset(kept)

    def begin_display(self, first: int, kept: set[int]) -> None:
        """Forget what sentences said before the last display, but for conditions that are in use."""
        self.used &= kept
        self.aside = [(n, q) for n, q in self.aside if n > first or n in self.used]
        self.made = None

    def new_in(self, q: Equal) -> frozenset[str]:
        """Return the names that an equation brings, with what they mean by custom taken in."""
        names = {known.name for known in lettered(q.letters).values()}
        new = frozenset(names - self.seen)
        self.seen |= names
        for rule in meant(self.rules, q):
            self._add(rule)
        return new

    def put_aside(self, number: int, q: Equal) -> None:
        """Take in what a sentence says; a new condition on the same letters takes the place of the last."""
        self.aside = [(n, o) for n, o in self.aside if n == number or o.letters != q.letters]
        self.aside.append((number, q))
        self.made = None

    def learn(self, number: int, q: Equal, new: frozenset[str]) -> None:
        """Take in what a line says: of a letter that is ``new``, or as a premise that may be special."""
        with suppress(*FAILS):
            rule = solved(q, self.rules, number, new)
            if rule is None:
                return
            if rule.name not in new:
                self.weaken(number, q)
                return
            self._add(replace(rule, given=rule.name in set(lone(q))))
            if rule.name in LAGRANGIANS and is_moving(rule):
                own = next(s for s, k in lettered(q.letters).items() if k.name == rule.name)
                self.lagrangian = own

    def weaken(self, number: int, q: Equal) -> None:
        """Take in a premise that may be meant of a special case."""
        self.weak.append((number, q))
        self.made = None

    def sign(self, q: Equal) -> None:
        """Take in an equation that says which root of a square is meant."""
        self.rules.signs.append(q)
        self.made = None

    def _add(self, rule: Rule) -> None:
        self.rules.add(rule)
        self.made = None

    @property
    def sets(self) -> list[Rules]:
        """Rules: of lines that bring letters in, and with what else is said, the nearest first."""
        if self.made is None:
            self.made = list(self._sets())
        return self.made

    def _sets(self) -> Iterator[Rules]:
        yield self.rules
        function = self.lagrangian or energies(self.rules, self.letters)
        laws: list[Said] = []
        with suppress(*FAILS):
            laws = [(LAW, q) for q in lagrange(self.rules, function)] if function else []
        weak = [list(ws) for _, ws in groupby(self.weak, lambda w: w[0])][-MAX_WEAK:]
        last = [w for ws in weak[::-1] for w in ws[::-1]]
        more = (self.aside, *weak[::-1], laws, [*self.aside, *last], [*self.aside, *laws])
        for added in {tuple(id(q) for _, q in m): m for m in more if m}.values():
            yield self._with(added)

    def _with(self, added: Sequence[Said]) -> Rules:
        rules = self.rules.copy()
        for n, q in added:
            with suppress(*FAILS):
                rule = solved(q, rules, n, frozenset())
                if rule is not None:
                    rules.add(rule)
        return rules


def sources(rules: Rules, q: Equal) -> frozenset[int]:
    """Return the formulas that an equation rests on. Raises `InputError`."""
    return frozenset[int]().union(*(rules.normal(e)[1] for e in (q.left, q.right)))


def held(rules: Rules, q: Equal) -> frozenset[Expr]:
    """Return the letters without dots of which an equation has derivatives once rules are put in."""
    full = [rules.normal(e)[0] for e in (q.left, q.right)]
    known = lettered(s for e in full for s in e.free_symbols)
    return frozenset(derived(s, 0) for s, k in known.items() if k.kind == MAY and k.order)
