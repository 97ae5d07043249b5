"""Forms: sums of products of values of a program, with exact coefficients; how derivatives are kept.

A chain rule multiplies and adds what programs have computed. As forms, equal products meet and cancel
exactly, signs and constants cost nothing on the way, and what is shared is found at the end, when
`Forms.numbers` appends the instructions.

Coefficients of long chains would grow without end. Law: the coefficient of a product of two forms
and of a value has `COEFFICIENT_BITS` bits at most; a larger number becomes a factor, a constant of the
program, and is as exact there. No number is rounded. Factors are shared: a
pair that several products hold is multiplied once.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from heapq import heapify, heappop, heappush
from itertools import combinations
from operator import and_

from codegen.ir.fold import bits, constant
from codegen.ir.ops import TRUTH_VALUES, Instruction
from codegen.ir.polynomials import added
from codegen.ir.program import Builder

Monomial = tuple[int, ...]
"""Numbers of values in order, one for each factor; a negative number is a sum of its own."""
Form = Mapping[Monomial, Fraction]
"""Coefficients of products; the empty product is one."""
Term = tuple[int, tuple[int, ...]]
"""Sign and factors."""

ONE: Form = {(): Fraction(1)}
COEFFICIENT_BITS = 4
"""Of numerator and denominator: what differentiation makes, such as 2 and 1/2, is carried through
products; numbers of the problem stay factors, as parameters do, and are shared as these are."""


class Forms:
    """Forms over the values of a builder, and the sums that became factors.

    Conditions (0 or 1) are gates, not factors: a product with a gate is selected by it, so that
    whatever stands on the other side, infinite or not a number, does not reach the sum.
    """

    def __init__(self, b: Builder) -> None:
        self.b = b
        self.given = len(b.instructions)
        """Values below this number are there anyway."""
        self.sums: list[Form] = []
        self._bindings: list[int] = []
        self._known: dict[frozenset[tuple[Monomial, Fraction]], int] = {}

    def of(self, number: int) -> Form:
        """Return a value as a form: constants, signs and products that are not yet needed come apart."""
        coefficient = Fraction(1)
        factors: list[int] = []
        stack = [number]
        while stack:
            k = stack.pop()
            op, args, _ = self.b.instructions[k]
            value = constant(self.b, k)
            if value is not None and _carried(coefficient * value):
                coefficient *= value
            elif value is not None and value < 0:
                coefficient = -coefficient
                factors.append(self.b.const(-value))
            elif op == "neg":
                coefficient = -coefficient
                stack.append(args[0])
            elif op == "mul" and (k >= self.given or 1 in {self.b.binding[a] for a in args}):
                stack.extend(args)
            else:
                factors.append(k)
        return {tuple(sorted(factors)): coefficient} if coefficient else {}

    def product(self, f: Form, g: Form) -> Form:
        """Return the product; a sum of several terms becomes a factor, unless the other is a number.

        The product with one is the form itself, not a copy.
        """
        for one, other in ((f, g), (g, f)):
            if one == ONE:
                return other
            if len(one) == 1 and () in one:
                scaled = {m: c * one[()] for m, c in other.items()}
                if all(map(_carried, scaled.values())):
                    return scaled
        (a, first), (c, second) = self._single(f), self._single(g)
        if not _carried(a * c):
            (a, first), (c, second) = self._held(a, first), self._held(c, second)
        return {self._joined(first, second): a * c}

    def _held(self, coefficient: Fraction, monomial: Monomial) -> tuple[Fraction, Monomial]:
        """Return the sign, and the product with the size of the coefficient as a factor."""
        if abs(coefficient) == 1:
            return coefficient, monomial
        size = self.b.const(abs(coefficient))
        return Fraction(1 if coefficient > 0 else -1), tuple(sorted((*monomial, size)))

    def _joined(self, first: Monomial, second: Monomial) -> Monomial:
        """Return the product of two products; the square of a gate is the gate."""
        gates = {k for k in first if self.is_gate(k)}
        return tuple(sorted((*first, *(k for k in second if k not in gates))))

    def is_gate(self, k: int) -> bool:
        """Return whether a factor is a condition."""
        return k >= 0 and self.b.instructions[k].op in TRUTH_VALUES

    def _single(self, form: Form) -> tuple[Fraction, Monomial]:
        """Return a form as one product, with a new number for what is left without common factors."""
        if len(form) == 1:
            ((monomial, coefficient),) = form.items()
            return coefficient, monomial
        scale, shared, rest = content(form)
        key = frozenset(rest.items())
        if key not in self._known:
            self._known[key] = ~len(self.sums)
            self.sums.append(rest)
            self._bindings.append(max(self.binding(k) for m in rest for k in m))
        return scale, tuple(sorted((*shared, self._known[key])))

    def binding(self, k: int) -> int:
        """Return when a factor is known, as `Builder.binding`."""
        return self.b.binding[k] if k >= 0 else self._bindings[~k]

    def numbers(self, forms: Sequence[Form]) -> list[int]:
        """Append the instructions of ``forms`` and return their numbers."""
        return _Writer(self, forms).write(forms)


def merged(f: dict[Monomial, Fraction], g: dict[Monomial, Fraction]) -> dict[Monomial, Fraction]:
    """Return the sum of two forms, made in place in the longer one.

    A sum of n terms that grows term by term is so built in n steps, not n^2.
    """
    return added(f, g) if len(f) >= len(g) else added(g, f)


def _carried(coefficient: Fraction) -> bool:
    """Return whether a coefficient is small enough to be multiplied on."""
    return bits(coefficient) <= COEFFICIENT_BITS


def content(form: Form) -> tuple[Fraction, Monomial, Form]:
    """Return a scale and the factors that all terms share, and the form without them.

    Law: the same for all multiples of a form, but for the scale, unless numbers are too large to be
    carried: then the scale is a sign. The first coefficient that is left is positive; but for that
    case one is 1 in size. To clear denominators instead, level by level, would make numbers without
    bound that overflow although the product of sum and scale does not.
    """
    common = reduce(and_, map(Counter, form))
    left_of = {m: tuple(sorted((Counter(m) - common).elements())) for m in form}
    order = sorted(form, key=left_of.__getitem__)
    size = _scale([abs(form[m]) for m in order])
    scale = size if form[order[0]] > 0 else -size
    left = [form[m] / scale for m in order]
    if not all(map(_carried, (scale, *left))):
        scale = scale / size
        left = [form[m] / scale for m in order]
    rest = {left_of[m]: c for m, c in zip(order, left, strict=True)}
    return scale, tuple(sorted(common.elements())), rest


def _scale(sizes: Sequence[Fraction]) -> Fraction:
    """Return the size that divides all others, else the most frequent one, else the largest."""
    counts = Counter(sizes)
    least = min(counts)
    if all((c / least).denominator == 1 for c in counts):
        return least
    return max(counts, key=lambda c: (counts[c], c))


class _Writer:
    """Appends what forms need: first shared products, then, sum by sum, the rest."""

    def __init__(self, forms: Forms, wanted: Sequence[Form]) -> None:
        self.forms, self.b = forms, forms.b
        self.sums = sorted(_needed(forms.sums, wanted))
        """Sums refer to older ones alone; an older one has a larger number."""
        self.built: dict[int, int] = {}
        exists = lambda x, y: self.b.find(Instruction("mul", (x, y))) is not None  # noqa: E731
        terms = [t for f in (*(forms.sums[k] for k in self.sums), *wanted) for t in f.items()]
        self.early = Products(exists, 2 * FIRST)
        """Of what is known with the parameters: shared first, as it may be computed once for all."""
        for monomial, coefficient in terms:
            self.early.use(self._early(monomial, coefficient))
        self.early.share()
        self.late = Products(exists)
        for monomial, coefficient in terms:
            self.late.use(self._factors(monomial, coefficient))
        self.late.share()

    def write(self, wanted: Sequence[Form]) -> list[int]:
        for k in self.sums:
            self.built[~k] = self._form(self.forms.sums[k])
        return [self._form(form) for form in wanted]

    def _early(self, monomial: Monomial, coefficient: Fraction) -> tuple[int, ...]:
        """Return the factors that are known with the parameters, the size of the coefficient too."""
        known = [k for k in monomial if k >= 0 and self.b.binding[k] <= 1]
        size = [self.b.const(abs(coefficient))] if abs(coefficient) != 1 else []
        return tuple(sorted((*size, *(k for k in known if not self.forms.is_gate(k)))))

    def _factors(self, monomial: Monomial, coefficient: Fraction) -> tuple[int, ...]:
        """Return the factors without gates; what is known with the parameters is one of them."""
        late = [
            k for k in monomial if (k < 0 or self.b.binding[k] > 1) and not self.forms.is_gate(k)
        ]
        early = self.early.left(self._early(monomial, coefficient))
        known = [self._product(early)] if early else []
        return tuple(sorted((*known, *late)))

    def _form(self, form: Form) -> int:
        """Append a form: its terms by gates, and for each gate what is selected."""
        by_gates: dict[tuple[int, ...], list[Term]] = {}
        for monomial, coefficient in sorted(form.items()):
            gates = tuple(k for k in monomial if self.forms.is_gate(k))
            factors = self.late.left(self._factors(monomial, coefficient))
            by_gates.setdefault(gates, []).append((1 if coefficient > 0 else -1, factors))
        return self._gated(by_gates)

    def _gated(self, by_gates: dict[tuple[int, ...], list[Term]]) -> int:
        """Select by the first gate that is left, positive or negated, and add what has none."""
        free = by_gates.get((), [])
        total = self._sum(free) if free else None
        rest = {gates: terms for gates, terms in by_gates.items() if gates}
        while rest:
            base = self._base(next(iter(rest))[0])[0]
            sides: dict[bool, dict[tuple[int, ...], list[Term]]] = {True: {}, False: {}}
            for gates in list(rest):
                for k in gates:
                    gate, positive = self._base(k)
                    if gate == base:
                        others = tuple(g for g in gates if g != k)
                        sides[positive].setdefault(others, []).extend(rest.pop(gates))
                        break
            arms = [self._gated(sides[s]) if sides[s] else self.b.const(0) for s in (True, False)]
            selected = self.b.add("select", base, *arms)
            total = selected if total is None else self.b.add("add", total, selected)
        return self.b.const(0) if total is None else total

    def _base(self, gate: int) -> tuple[int, bool]:
        op, args, _ = self.b.instructions[gate]
        negated = op == "not" and self.forms.is_gate(args[0])
        return (args[0], False) if negated else (gate, True)

    def _sum(self, terms: Iterable[Term]) -> int:
        """Add terms; a factor of several of them is taken out, the most frequent one first."""
        left = list(terms)
        while True:
            counts = Counter(k for _, factors in left if len(factors) > 1 for k in set(factors))
            best = min(counts, key=lambda k: (-counts[k], k), default=None)
            if best is None or counts[best] < 2:
                return self._total([(sign, self._product(factors)) for sign, factors in left])
            held = [len(factors) > 1 and best in factors for _, factors in left]
            holders = [term for term, holds in zip(left, held, strict=True) if holds]
            sign = holders[0][0]
            inner = self._sum((s * sign, _without(factors, best)) for s, factors in holders)
            left = [term for term, holds in zip(left, held, strict=True) if not holds]
            left.append((sign, tuple(sorted((self._value(best), inner)))))

    def _total(self, terms: Sequence[tuple[int, int]]) -> int:
        """Add the positive terms first; a sum of negative terms alone is negated as a whole."""
        positive = [k for sign, k in terms if sign > 0]
        negative = [k for sign, k in terms if sign < 0]
        if not positive:
            return self.b.add("neg", self._total([(1, k) for k in negative]))
        total = positive[0]
        for k in positive[1:]:
            total = self.b.add("add", total, k)
        for k in negative:
            total = self.b.add("sub", total, k)
        return total

    def _product(self, factors: Sequence[int]) -> int:
        product = self.b.const(1)
        for number in sorted(map(self._value, factors), key=lambda k: (self.b.binding[k], k)):
            product = self.b.add("mul", product, number)
        return product

    def _value(self, k: int) -> int:
        """Return the number of a factor: a value, a sum that is built, or a shared product."""
        if k >= 0:
            return k
        if k not in self.built:
            pairs = self.late.pairs if k in self.late.pairs else self.early.pairs
            self.built[k] = self._product(pairs[k])
        return self.built[k]


def _without(factors: tuple[int, ...], one: int) -> tuple[int, ...]:
    place = factors.index(one)
    return factors[:place] + factors[place + 1 :]


def _needed(sums: Sequence[Form], wanted: Iterable[Form]) -> set[int]:
    """Return which sums ``wanted`` are made of."""
    found = {~k for form in wanted for m in form for k in m if k < 0}
    for place in range(len(sums) - 1, -1, -1):
        if place in found:
            found.update(~k for m in sums[place] for k in m if k < 0)
    return found


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
        """Note that one more form uses the product of ``factors`` (in order)."""
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
