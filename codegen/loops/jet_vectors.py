"""Sums of products of Taylor coefficients in C, four in a vector, in the groups of `packs`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from codegen.loops.jet_text import four, summed
from codegen.loops.packs import WIDTH, Group, Pack
from codegen.loops.products import Coefficient

if TYPE_CHECKING:
    from codegen.loops.jets import _Rules as Rules

AT_ONCE = 8
"""Sums of vectors that a loop makes at once, so that all stay in registers."""


class Vectors:
    """The groups of sums, whole ones first, with their packs by number."""

    def __init__(self, rules: Rules, whole: Sequence[Group], parts: Sequence[Group]) -> None:
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
