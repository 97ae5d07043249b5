"""Share factors: a pair that several products hold is multiplied once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from heapq import heapify, heappop, heappush
from itertools import combinations

Factors = tuple[int, ...]
Pair = tuple[int, int]

FIRST = -(1 << 60)
"""New factors are numbered downwards from here: below every number of a sum."""


class Products:
    """Products of numbered factors, and the pairs of factors that they share.

    ``exists``: whether the product of two values is there anyway. ``first``: number of the first new
    factor; the others go down from it. Greedy: the pair that saves most
    multiplications is taken out again and again, ties by number (Breuer, Generation of optimal
    code for expressions via factorization, Comm. ACM 12 (1969) 333).
    """

    def __init__(self, exists: Callable[[int, int], bool], first: int = FIRST) -> None:
        self.exists = exists
        self.first = first
        self.pairs: dict[int, Factors] = {}
        """What each new factor is the product of."""
        self._uses: Counter[Factors] = Counter()
        self._left: dict[Factors, list[int]] = {}
        self._holders: dict[Pair, dict[Factors, None]] = {}
        self._heap: list[tuple[int, Pair]] = []

    def use(self, factors: Factors) -> None:
        """Tell that one more form uses the product of ``factors`` (in order)."""
        self._uses[factors] += 1
        self._left.setdefault(factors, list(factors))

    def left(self, factors: Factors) -> Factors:
        """Return the factors that remain; one, where the whole product is shared."""
        return tuple(self._left[factors])

    def share(self) -> None:
        """Take out all pairs that save multiplications, then products that several forms use."""
        for product in self._left:
            self._enter(product)
        self._heap = [(-self._saving(pair), pair) for pair in self._holders]
        heapify(self._heap)
        while self._heap:
            saving, pair = heappop(self._heap)
            now = self._saving(pair)
            if now <= 0:
                continue
            if now != -saving:
                heappush(self._heap, (-now, pair))
                continue
            self._take(pair)
        for product, left in self._left.items():
            if self._uses[product] > 1 and len(left) > 1:
                self._left[product] = [self._new(tuple(left))]

    def _new(self, factors: Factors) -> int:
        number = self.first - len(self.pairs)
        self.pairs[number] = factors
        return number

    def _saving(self, pair: Pair) -> int:
        there = min(pair) >= 0 and self.exists(*pair)
        return len(self._holders.get(pair, ())) - (not there)

    def _enter(self, product: Factors) -> None:
        for pair in _pairs(self._left[product]):
            self._holders.setdefault(pair, {})[product] = None

    def _take(self, pair: Pair) -> None:
        """Replace a pair by a new factor in all products that hold it."""
        number = self._new(pair)
        touched: dict[Pair, None] = {}
        for product in list(self._holders[pair]):
            left = self._left[product]
            for old in _pairs(left):
                del self._holders[old][product]
            for factor in pair:
                left.remove(factor)
            left.append(number)
            self._enter(product)
            touched |= dict.fromkeys(_pairs(left))
        for new in touched:
            heappush(self._heap, (-self._saving(new), new))


def _pairs(factors: list[int]) -> list[Pair]:
    return list(dict.fromkeys(combinations(sorted(factors), 2)))
