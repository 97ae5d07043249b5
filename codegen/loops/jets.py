"""The function of all Taylor coefficients in C: a loop over the orders.

Its body is one pass over the operations by the rules of `codegen.derivatives.taylor`. Sums of products are
added up four at a time, one in each place of a vector (`codegen.loops.products`).

Sums of products of Taylor coefficients in C, four in a vector, in the groups of `packs`.

Pieces of C text for Taylor coefficients: vectors of four numbers, expressions, lines that are needed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from codegen.derivatives.taylor import RULES, Order, Prepared, Series, residuals
from codegen.ir.ops import Instruction
from codegen.ir.program import RATES, Builder, Program
from codegen.loops.products import (
    WIDTH,
    Coefficient,
    Group,
    Pack,
    Sum,
    forms,
    linear_in_time,
    part_groups,
    steps,
    whole_group,
    wide,
)
from codegen.targets import c
from codegen.watch.trust import Limit, built, limits, longest

FEWEST_WHOLE = 2
"""Values in a whole group, at least: a vector with one costs more than it brings."""
START = "start"


def series(
    prepared: Prepared, head: str, order: int, further: int = 0, rests: bool = True
) -> tuple[list[str], int]:
    """Return the text of the functions ``head`` and ``head``_constants, and the number of constants.

    ``head``(t, x, xs, c, w, u, us, y, ys) gives x_1 of each state, then x_2, up to ``order``. The last
    ``further`` of the rates are those of no state: it has one more argument, where it puts their
    coefficients from 0 to ``order`` - 1. Switching functions likewise; ``head``_switches(t, x, c, u, g)
    gives their values alone. Where arguments have limits (`codegen.watch.trust`), the last argument takes
    these and the coefficients, as `limited` orders them. ``rests``: whether 1/k is taken in two doubles.
    The error of one adds up, as it is the same in every step; it is below tolerances that are not those of
    full precision.
    """
    found = forms(prepared)
    whole = [whole_group(some, [found[n] for n in some])
             for some in wide(prepared, WIDTH, FEWEST_WHOLE)]  # fmt: skip
    rules = _Rules(prepared, whole, order, further, rests)
    order_of_work = steps(prepared, whole)
    single = {n: rules.lines(n) for n in order_of_work if not isinstance(n, Group)}
    vectors = Vectors(rules, whole, part_groups(list(rules.sums)))
    body = [line for step in order_of_work
            for line in (vectors.whole(step) if isinstance(step, Group) else single[step])]  # fmt: skip
    lines = needed([
        *inverses(order, rests),
        *vectors.declarations(order),
        f"for (int k = 1; k < {order}; ++k) {{",
        "    const double part = inverse[k];",
        "    const double part_rest = rest[k];",
        "    const double next = inverse[k + 1];",
        "    const double next_rest = rest[k + 1];",
        *(f"    {line}" for line in (*vectors.sums(), *body, *vectors.stored(), *rules.results())),
        "}",
    ])  # fmt: skip
    texts, constants = c.kernels(rules.start(), START, f"{head}_start")
    texts = [text.replace(f"{head}_start_constants", f"{head}_constants") for text in texts]
    outputs = {"e": further, "g": prepared.switches, "q": rules.limits}
    more = "".join(f", double *{name}" for name, wanted in outputs.items() if wanted)
    function = [
        *DECLARATIONS.splitlines(),
        "",
        "static void HEAD(double t, const double *x, ptrdiff_t xs, const double *c, const double *w,",
        f"    const double *u, ptrdiff_t us, double *y, ptrdiff_t ys{more}) {{",
        *(f"    {line}" for line in lines),
        "}",
        "",
        *rules.switching(),
    ]
    return [*texts, *(line.replace("HEAD", head) for line in function)], constants


def limited(prepared: Prepared, order: int) -> tuple[tuple[Limit, ...], tuple[Limit, ...]]:
    """Return the limits of arguments that are linear in time, and those of others.

    For the former the longest step stands in the output, if there are any; then of each of the latter the
    limit and the coefficients of the orders 1 to ``order`` - 1.
    """
    linear, found = linear_in_time(prepared), limits(prepared, order)
    straight = tuple(x for x in found if x.series in linear)
    return straight, tuple(x for x in found if x.series not in linear)


class _Rules(Order):
    """The rules as text of order k, and what they read: values of order 0, sums of lower orders."""

    def __init__(
        self,
        prepared: Prepared,
        whole: Sequence[Group],
        order: int,
        further: int = 0,
        rests: bool = True,
    ) -> None:
        self.prepared, self.varies = prepared, prepared.varies
        self.instructions = prepared.program.instructions
        values = prepared.program.results[RATES]
        self.rates = values[: len(values) - further]
        self.further = values[len(self.rates) :]
        self.linear, self.rests = linear_in_time(prepared), rests
        self.straight, self.curved = limited(prepared, order)
        self.order, self.one = order, int(bool(self.straight))
        self.limits = self.one + len(self.curved)
        self.places = {n: (g, place) for g, group in enumerate(whole)
                       for place, n in enumerate(group.values)}  # fmt: skip
        self.first_part = len(whole)
        self.slots: dict[tuple[Series, bool], int] = {}
        self.sums: dict[Sum, int] = {}
        self.kept: dict[Series, int] = {}
        """Values whose coefficients of all orders are stored, with the row in which."""

    def lines(self, n: Series) -> list[str]:
        """Return the lines of the coefficient of one value."""
        instruction = self.instructions[n]
        if instruction.op == "back":
            return self._solve(n, instruction)
        if instruction.op == "factor":
            return []
        return [f"const double v{n} = {self._coefficient(n, instruction)};"]

    def _coefficient(self, n: Series, instruction: Instruction) -> str:
        op, args, value = instruction
        if op == "state":
            source = self.source(n)
            return "HEAD_PLACE({}, {})".format(*source) if source else f"x{value}"
        if op == "time":
            return "k == 1 ? 1.0 : 0.0"
        if op == "item":
            return f"v{args[0]}[{value}]"
        return str(RULES[op].coefficient(self, n, args, self.prepared.partner(n)))

    def _solve(self, n: Series, instruction: Instruction) -> list[str]:
        size = len(instruction.args) - 1
        right = ", ".join(map(str, residuals(self, self.prepared, n)))
        return [
            f"double v{n}[{size}] = {{{right}}};",
            f"HEAD_start_back_({size}, v{n}_factor, v{n});",
        ]

    def source(self, n: Series) -> tuple[str, int] | None:
        """Return the vector that holds the coefficient of a value, and the place in it."""
        instruction = self.instructions[n]
        is_state = instruction.op == "state"
        found = self.places.get(self.rates[instruction.slot] if is_state else n)
        return found and (f"{'s' if is_state else 'g'}{found[0]}", found[1])

    def first_order(self) -> list[str]:
        """Return the lines of the first coefficients of the states, alone or in vectors."""
        values: dict[int, list[str]] = {}
        for n, (g, _) in self.places.items():
            values.setdefault(g, []).append(str(self.first(n)))
        zeros = ["0.0"] * WIDTH
        lines = [
            f"HEAD_pack s{g} = {four([*texts, *zeros][:WIDTH])};" for g, texts in values.items()
        ]
        lines += [f"double x{i} = {self.first(rate)};" for i, rate in enumerate(self.rates)]
        lines += [f"y[{i} * ys] = x{i};" for i in range(len(self.rates))]
        lines += [f"e[{m}] = {self.first(n)};" for m, n in enumerate(self.further)]
        return lines + [f"g[{m}] = {self.first(n)};" for m, n in enumerate(self.prepared.switches)]

    def results(self) -> list[str]:
        """Return the lines of the next coefficients of the states."""
        groups = sorted({self.places[rate][0] for rate in self.rates if rate in self.places})
        scaled = "HEAD_SCALED(g{0}, next, next_rest)" if self.rests else "HEAD_BY(g{0}, next)"
        lines = [f"s{g} = {scaled.format(g)};" for g in groups]
        for i, rate in enumerate(self.rates):
            place = self.places.get(rate)
            lines.append(
                f"x{i} = HEAD_PLACE(s{place[0]}, {place[1]});"
                if place
                else f"x{i} = {self._over(self.now(rate), 'next')};"
            )
        lines += [f"y[({len(self.rates)} * k + {i}) * ys] = x{i};" for i in range(len(self.rates))]
        others = {"e": self.further, "g": self.prepared.switches}
        lines += [f"{name}[{len(some)} * k + {m}] = {self.now(n)};"
                  for name, some in others.items() for m, n in enumerate(some)]  # fmt: skip
        return lines + self._moves()

    def _moves(self) -> list[str]:
        """Return the lines that store the coefficients of arguments that have limits."""
        return [f"q[{self._row(m)} + k] = {self.now(x.series)};"
                for m, x in enumerate(self.curved)]  # fmt: skip

    def _row(self, m: int) -> int:
        return self.one + self.order * m

    def bounds(self) -> list[str]:
        """Return the lines that store the limits themselves."""
        places = [*[0] * self.one, *map(self._row, range(len(self.curved)))]
        return [f"q[{place}] = f[{n}];" for n, place in enumerate(places)]

    @property
    def room(self) -> int:
        """How many values of order 0 are read."""
        return self.limits + len(self.slots)

    def switching(self) -> list[str]:
        """Return the lines of the function of the switching functions, if there are any."""
        if not self.prepared.switches:
            return []
        values = [f"    g[{m}] = {self.first(n)};" for m, n in enumerate(self.prepared.switches)]
        return [
            "static void HEAD_switches(double t, const double *x, const double *c, const double *u,",
            "    double *g) {",
            f"    double f[{self.room}];",
            "    HEAD_start(t, x, 1, c, NULL, u, 1, f, 1);",
            *values,
            "}",
            "",
        ]

    def start(self) -> Program:
        """Return the program of the values of order 0 that are read, limits first."""
        b = Builder(self.prepared.program.rules)
        new: list[int] = []
        for instruction in self.instructions:
            new.append(b.again(instruction, new))
        results = [
            b.add("div", b.const(1), new[k]) if inverted else new[k] for k, inverted in self.slots
        ]
        bounds = built(b, new, self.prepared, self.curved, self.order)
        if self.straight:
            bounds.insert(0, longest(b, new, self.prepared, self.straight, self.order))
        return b.program({START: [*bounds, *results]})

    def matrices(self) -> list[str]:
        """Return the lines that factor the matrices of linear systems at order 0."""
        lines = []
        for n, (op, args, _) in enumerate(self.instructions):
            if op == "back" and self.varies[n]:
                shape, size = self.instructions[args[0]].value, len(args) - 1
                entries = ", ".join(str(self.first(a)) for a in self.instructions[args[0]].args)
                symmetric = int(bool(getattr(shape, "symmetric", False)))
                lines += [
                    f"double v{n}_factor[{1 + size + size * size}] = {{{entries}}};",
                    f"HEAD_start_factor_({size}, {symmetric}, v{n}_factor);",
                ]
        return lines

    def slot(self, a: Series, inverted: bool) -> Text:
        """Return where a value of order 0 stands, or its inverse."""
        return Text(f"f[{self.slots.setdefault((a, inverted), self.room)}]")

    def now(self, a: Series) -> Text:
        return Text(f"v{a}") if self.varies[a] else ZERO

    def first(self, a: Series) -> Text:
        return self.slot(a, False)

    def inverse(self, a: Series) -> Text:
        return self.slot(a, True)

    def dot(self, a: Series, b: Series, low: int = 0, high: int = 0) -> Text:
        total = self._between(Sum(a, b, weighted=False))
        if a == b and not low and not high:
            return total + self.first(a) * self.now(a) * Fraction(2)
        if not low:
            total = total + self.first(a) * self.now(b)
        if not high:
            total = total + self.now(a) * self.first(b)
        return total

    def moment(self, a: Series, b: Series, high: int = 0) -> Text:
        sums = self._between(Sum(a, b, weighted=True))
        total = self._over(sums, "part")
        return total if high else total + self.now(a) * self.first(b)

    def _over(self, a: Text, number: str) -> Text:
        """Return a coefficient times 1/k, or 1/(k + 1)."""
        rest = a * Text(f"{number}_rest")
        return a * Text(number) + rest if self.rests else a * Text(number)

    def _between(self, wanted: Sum) -> Text:
        """Return the sum over j from 1 to k - 1."""
        a, b = wanted.left, wanted.right
        if not (self.varies[a] and self.varies[b]):
            return ZERO
        if a in self.linear:
            return self._of_linear(a, b)
        if b in self.linear and not wanted.weighted:
            return self._of_linear(b, a)
        group, place = divmod(self.sums.setdefault(wanted, len(self.sums)), WIDTH)
        return Text(f"HEAD_PLACE(m{self.first_part + group}, {place})")

    def _of_linear(self, a: Series, b: Series) -> Text:
        rows = [self.kept.setdefault(n, len(self.kept)) for n in (a, b)]
        return Text(f"(k > 1 ? a[{rows[0]}][1] * a[{rows[1]}][k - 1] : 0.0)")

    def choose(self, negative: Text, a: Text, b: Text) -> Text:
        return Text(f"({negative} < 0.0 ? {a} : {b})")


AT_ONCE = 8
"""Sums of vectors that a loop makes at once, so that all stay in registers."""


class Vectors:
    """The groups of sums, whole ones first, with their packs by number."""

    def __init__(self, rules: _Rules, whole: Sequence[Group], parts: Sequence[Group]) -> None:
        self.rules, self.groups = rules, [*whole, *parts]
        packs = (pack for group in self.groups for pair in group.products for pack in pair)
        self.numbers = {pack: number for number, pack in enumerate(dict.fromkeys(packs))}
        pairs = (pair for group in whole for pair in group.products)
        self.pairs = {pair: number for number, pair in enumerate(dict.fromkeys(pairs))}
        added = (pack for group in whole for pack in group.added)
        scaled = (pack.factors for pack in (*self.numbers, *added) if not pack.is_plain)
        self.factors = {f: number for number, f in enumerate(dict.fromkeys(scaled))}
        self.stores: set[Pack] = set()

    def declarations(self, order: int) -> list[str]:
        """Return the lines before the first order."""
        rules = self.rules
        lines = [
            *rules.matrices(),
            *(f"const HEAD_pack c{number} = {four(map(self._coefficient, factors))};"
              for factors, number in self.factors.items()),
            *(f"p[{number}][0] = {self._scaled(pack, self._first(pack))};"
              for pack, number in self.numbers.items()),
            *(f"const HEAD_pack e{number} = {self._scaled(left, f'p[{self.numbers[right]}][0]')};"
              for (left, right), number in self.pairs.items()),
            *(f"a[{row}][0] = {rules.first(n)};" for n, row in rules.kept.items()),
            *rules.first_order(),
            *rules.bounds(),
        ]  # fmt: skip
        return [
            f"double f[{max(1, rules.room)}], a[{max(1, len(rules.kept))}][{order}];",
            f"HEAD_pack p[{max(1, len(self.numbers))}][{order}];",
            "(void)p, (void)a;",
            "HEAD_start(t, x, xs, c, w, u, us, f, 1);",
            *lines,
        ]

    def sums(self) -> list[str]:
        """Return the lines of m of each group: the terms from j = 1 to k - 1 of its sums.

        Each product has its own chain of additions. The latest coefficients come last, so that little
        waits for them.
        """
        chains = [(f"m{g}_{n}", *pair) for g, group in enumerate(self.groups)
                  for n, pair in enumerate(group.products)]  # fmt: skip
        parts = (chains[k : k + AT_ONCE] for k in range(0, len(chains), AT_ONCE))
        totals = (" ".join(f"m{g}_{n}" for n in range(len(group.products)))
                  for g, group in enumerate(self.groups))  # fmt: skip
        return [
            *(line for part in parts for line in self._chains(part)),
            *(f"const HEAD_pack m{g} = {summed(names.split())};" for g, names in enumerate(totals)),
        ]

    def _chains(self, chains: Sequence[tuple[str, Pack, Pack]]) -> list[str]:
        def more(left: str, right: str) -> list[str]:
            terms = ((m, f"p[{self.numbers[a]}][{left}], p[{self.numbers[b]}][{right}]")
                     for m, a, b in chains)  # fmt: skip
            return [*(f"    {m} = HEAD_MORE({m}, {term});" for m, term in terms), "}"]

        return [
            *(f"HEAD_pack {m} = HEAD_PACK(0.0, 0.0, 0.0, 0.0);" for m, _, _ in chains),
            "for (int j = 2; j < k - 1; ++j) {",
            *more("j", "k - j"),
            "if (k > 1) {",
            *more("1", "k - 1"),
            "if (k > 2) {",
            *more("k - 1", "1"),
        ]

    def whole(self, group: Group) -> list[str]:
        """Return the lines of a whole group: its values are its sums with what these lack."""
        g = self.groups.index(group)
        lines = [line for pair in group.products for pack in pair for line in self._store(pack)]
        total = f"m{g}"
        for left, right in group.products:
            total = f"HEAD_MORE({total}, p[{self.numbers[left]}][0], b{self.numbers[right]})"
        for pair in group.products:
            total = f"HEAD_MORE({total}, e{self.pairs[pair]}, b{self.numbers[pair[0]]})"
        for pack in group.added:
            total = f"HEAD_PLUS({total}, {self._scaled(pack, self._now(pack))})"
        places = (
            f"const double v{n} = HEAD_PLACE(g{g}, {at});" for at, n in enumerate(group.values)
        )
        return [*lines, f"const HEAD_pack g{g} = {total};", *places]

    def stored(self) -> list[str]:
        """Return the lines that keep what later orders read."""
        rows = (f"a[{row}][k] = {self.rules.now(n)};" for n, row in self.rules.kept.items())
        return [*rows, *(line for pack in self.numbers for line in self._store(pack))]

    def _store(self, pack: Pack) -> list[str]:
        """Return the lines that make a vector, without its coefficients, and store it, once."""
        if pack in self.stores:
            return []
        self.stores.add(pack)
        bare = f"b{self.numbers[pack]}"
        return [
            f"const HEAD_pack {bare} = {self._now(pack)};",
            f"p[{self.numbers[pack]}][k] = {self._scaled(pack, bare)};",
        ]

    def _scaled(self, pack: Pack, text: str) -> str:
        return text if pack.is_plain else f"HEAD_TIMES({text}, c{self.factors[pack.factors]})"

    def _first(self, pack: Pack) -> str:
        """Return the values of order 0 of a pack; times the order, where it is weighted."""
        pairs = zip(pack.places, pack.weighted, strict=True)
        return four(
            "0.0" if n is None or weighted else self.rules.first(n) for n, weighted in pairs
        )

    def _now(self, pack: Pack) -> str:
        """Return the coefficients of order k: chosen from one or two vectors where these hold them."""
        sources = [self.rules.source(n) for n in pack.places if n is not None]
        held = [source for source in sources if source]
        names = list(dict.fromkeys(name for name, _ in held))
        if len(held) < len(sources) or any(pack.weighted) or len(names) > 2:
            pairs = zip(pack.places, pack.weighted, strict=True)
            texts = ("0.0" if n is None else ("k * " if w else "") + str(self.rules.now(n))
                     for n, w in pairs)  # fmt: skip
            return four(texts)
        places = iter([place + WIDTH * names.index(name) for name, place in held])
        wanted = [at if n is None else next(places) for at, n in enumerate(pack.places)]
        if wanted == list(range(WIDTH)):
            return names[0]
        return f"HEAD_CHOSEN({names[0]}, {names[-1]}, {', '.join(map(str, wanted))})"

    def _coefficient(self, given: Coefficient | None) -> str:
        if given is None:
            return "0.0"
        factors = (str(self.rules.slot(*still)) for still in given.factors)
        return " * ".join([repr(float(given.number)), *factors])


_CONSTANT, _WORD = re.compile(r"\s*const \w+ (\w+) = "), re.compile(r"\w+")

DECLARATIONS = """\
/* Four numbers at once: vectors of the compiler, or what comes to the same. */
#if defined(__GNUC__)
typedef double HEAD_pack __attribute__((vector_size(32)));
#define HEAD_PACK(a, b, c, d) ((HEAD_pack){a, b, c, d})
#define HEAD_TIMES(a, b) ((a) * (b))
#define HEAD_PLUS(a, b) ((a) + (b))
#define HEAD_MORE(s, a, b) ((s) + (a) * (b))
#define HEAD_SCALED(a, factor, rest) ((a) * (factor) + (a) * (rest))
#define HEAD_BY(a, factor) ((a) * (factor))
#define HEAD_PLACE(a, n) ((a)[n])
#if defined(__clang__) || __GNUC__ >= 12
#define HEAD_CHOSEN __builtin_shufflevector
#endif
#else
typedef struct { double v[4]; } HEAD_pack;
#define HEAD_EACH(name, n, expression) \\
    static inline HEAD_pack name { HEAD_pack r; for (int n = 0; n < 4; ++n) r.v[n] = expression; return r; }
static inline HEAD_pack HEAD_PACK(double a, double b, double c, double d) {
    return (HEAD_pack){{a, b, c, d}};
}
HEAD_EACH(HEAD_TIMES(HEAD_pack a, HEAD_pack b), n, a.v[n] * b.v[n])
HEAD_EACH(HEAD_PLUS(HEAD_pack a, HEAD_pack b), n, a.v[n] + b.v[n])
HEAD_EACH(HEAD_MORE(HEAD_pack s, HEAD_pack a, HEAD_pack b), n, s.v[n] + a.v[n] * b.v[n])
HEAD_EACH(HEAD_SCALED(HEAD_pack a, double factor, double rest), n, a.v[n] * factor + a.v[n] * rest)
HEAD_EACH(HEAD_BY(HEAD_pack a, double factor), n, a.v[n] * factor)
#define HEAD_PLACE(a, n) ((a).v[n])
#endif
#ifndef HEAD_CHOSEN
#define HEAD_OF(a, b, n) ((n) < 4 ? HEAD_PLACE(a, (n) % 4) : HEAD_PLACE(b, (n) % 4))
#define HEAD_CHOSEN(a, b, i, j, k, l) \\
    HEAD_PACK(HEAD_OF(a, b, i), HEAD_OF(a, b, j), HEAD_OF(a, b, k), HEAD_OF(a, b, l))
#endif
"""
"""What every file of coefficients begins with."""


@dataclass(frozen=True)
class Text:
    """A coefficient as a C expression in brackets; an empty one is zero."""

    text: str

    def __str__(self) -> str:
        return self.text or "0.0"

    def __neg__(self) -> Text:
        return Text(f"(-{self})") if self.text else self

    def __add__(self, other: Text) -> Text:
        if not (self.text and other.text):
            return self if self.text else other
        return Text(f"({self} + {other})")

    def __sub__(self, other: Text) -> Text:
        return Text(f"({self} - {other})") if self.text and other.text else self + -other

    def __rsub__(self, other: Fraction) -> Text:
        return Text(f"({float(other)!r} - {self})")

    def __mul__(self, other: Text | Fraction) -> Text:
        factor = other if isinstance(other, Text) else Text(repr(float(other)))
        return Text(f"({self} * {factor})" if self.text and factor.text else "")


ZERO = Text("")


def four(texts: Iterable[object]) -> str:
    """Return the vector of four expressions."""
    return f"HEAD_PACK({', '.join(map(str, texts))})"


def summed(names: Sequence[str]) -> str:
    """Return the sum of vectors."""
    text = names[0]
    for name in names[1:]:
        text = f"HEAD_PLUS({text}, {name})"
    return text


def inverses(order: int, rests: bool) -> list[str]:
    """Return the lines of 1/k, and what one double lacks of it."""
    exact = [Fraction(1, max(1, k)) for k in range(order + 1)]
    lines = [
        f"static const double inverse[] = {{{', '.join(repr(float(e)) for e in exact)}}};",
    ]
    lacking = [float(e - Fraction(float(e))) for e in exact]
    rest = f"static const double rest[] = {{{', '.join(map(repr, lacking))}}};"
    return [*lines, rest] if rests else lines


def needed(lines: Sequence[str]) -> list[str]:
    """Leave out constants that no later line reads."""
    found: list[str] = []
    read: set[str] = set()
    for line in reversed(lines):
        made = _CONSTANT.match(line)
        if made is None or made[1] in read:
            found.append(line)
            read.update(_WORD.findall(line))
    return found[::-1]
