"""The function of all Taylor coefficients in C: a loop over the orders.

Its body is one pass over the operations by the rules of `codegen.derivatives.taylor`. Sums of products are
added up four at a time, one in each place of a vector (`codegen.loops.packs`).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from codegen.derivatives.taylor import RULES, Order, Prepared, Series, residuals
from codegen.ir.groups import RATES
from codegen.ir.ops import Instruction
from codegen.ir.program import Builder, Program
from codegen.loops.jet_text import DECLARATIONS, ZERO, Text, four, inverses, needed
from codegen.loops.jet_vectors import Vectors
from codegen.loops.packs import WIDTH, Group, Sum, part_groups, steps, whole_group
from codegen.loops.products import forms, linear_in_time, wide
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
