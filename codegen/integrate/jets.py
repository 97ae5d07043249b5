"""The function of all Taylor coefficients in C: straight-line code for small systems, loops for others.

The loop goes over the orders; its body is one pass over the operations, whose sums of products are
loops again. Both read the rules of `codegen.taylor`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from codegen.lower import RATES
from codegen.ops import OPS, Instruction
from codegen.program import Builder, Program
from codegen.targets import c
from codegen.taylor import JET, RULES, Order, Prepared, Series, residuals, unrolled

MOST_UNROLLED = 8000
"""Operations of straight-line code that a compiler takes about a second for. Heavy top with quaternion,
order 8 to 20: 129 to 364 us a run, loops 287 to 421 us, compiled in 1.2 s and 0.4 s at order 20."""
_LINEAR = frozenset({"add", "sub", "neg", "abs", "min", "max", "select", "item"})
START = "start"


def series(prepared: Prepared, head: str, order: int) -> tuple[list[str], int]:
    """Return the text of the functions ``head`` and ``head``_constants, and the number of constants.

    ``head``(t, x, xs, c, w, u, us, y, ys) gives x_1 of each state, then x_2, up to ``order``.
    """
    if operations(prepared, order) <= MOST_UNROLLED:
        return c.kernels(unrolled(prepared, RATES, order), JET, head)
    return looped(prepared, head, order)


def operations(prepared: Prepared, order: int) -> int:
    """Return about how many operations the straight-line code has."""
    pairs = zip(prepared.program.instructions, prepared.varies, strict=True)
    total = 0
    for (op, args, _), varies in pairs:
        if op in OPS and varies:
            is_product = op not in _LINEAR and sum(prepared.varies[a] for a in args) > (op == "mul")
            total += order * order * max(1, len(args) - 1) if is_product else order
    return total


def looped(prepared: Prepared, head: str, order: int) -> tuple[list[str], int]:
    """Return what `series` does, as loops over the orders."""
    loop = _Loop(prepared)
    body, firsts = loop.body(), [loop.first(r) for r in loop.rates]
    texts, constants = c.kernels(loop.start(), START, f"{head}_start")
    texts = [text.replace(f"{head}_start_constants", f"{head}_constants") for text in texts]
    room = max(1, len(loop.rows))
    n = len(prepared.program.results[RATES])
    lines = [
        "/* The sum of a[j] b[k - j] over j from low to high. */",
        f"static inline double {head}_dot(const double *a, const double *b, int low, int high, int k) {{",
        "    double one = 0.0, other = 0.0;",
        "    int j = low;",
        "    for (; j < high; j += 2) {",
        "        one += a[j] * b[k - j];",
        "        other += a[j + 1] * b[k - j - 1];",
        "    }",
        "    return j == high ? one + other + a[j] * b[k - j] : one + other;",
        "}",
        "",
        f"static void {head}(double t, const double *x, ptrdiff_t xs, const double *c, const double *w,",
        "    const double *u, ptrdiff_t us, double *y, ptrdiff_t ys) {",
        f"    double a[{room}][{order}], d[{room}][{order}], f[{max(1, len(loop.slots))}];",
        f"    {head}_start(t, x, xs, c, w, u, us, f, 1);",
        *(f"    {line}" for line in loop.before),
        *(f"    y[{i} * ys] = {first};" for i, first in enumerate(firsts)),
        f"    for (int k = 1; k < {order}; ++k) {{",
        "        const double part = 1.0 / k, next = 1.0 / (k + 1);",
        "        (void)part, (void)d, (void)f;",
        *(f"        {line}" for line in body),
        *(f"        y[({n} * k + {i}) * ys] = next * {loop.now(r)};" for i, r in enumerate(loop.rates)),
        "    }",
        "}",
        "",
    ]  # fmt: skip
    return [*texts, *(line.replace("HEAD", head) for line in lines)], constants


@dataclass(frozen=True)
class _Text:
    """A coefficient as a C expression in brackets; an empty one is zero."""

    text: str

    def __str__(self) -> str:
        return self.text or "0.0"

    def __neg__(self) -> _Text:
        return _Text(f"(-{self})") if self.text else self

    def __add__(self, other: _Text) -> _Text:
        if not (self.text and other.text):
            return self if self.text else other
        return _Text(f"({self} + {other})")

    def __sub__(self, other: _Text) -> _Text:
        return _Text(f"({self} - {other})") if self.text and other.text else self + -other

    def __rsub__(self, other: Fraction) -> _Text:
        return _Text(f"({float(other)!r} - {self})")

    def __mul__(self, other: _Text | Fraction) -> _Text:
        factor = other if isinstance(other, _Text) else _Text(repr(float(other)))
        return _Text(f"({self} * {factor})" if self.text and factor.text else "")


_ZERO = _Text("")


class _Loop(Order):
    """Order k as text: rows ``a`` of coefficients, ``d`` of j a_j, values ``f`` of order 0."""

    def __init__(self, prepared: Prepared) -> None:
        self.prepared = prepared
        self.instructions = prepared.program.instructions
        self.rates = prepared.program.results[RATES]
        blocks = {"factor", "back"}
        numbers = [
            k for k, v in enumerate(prepared.varies) if v and self.instructions[k].op not in blocks
        ]
        self.rows = {k: row for row, k in enumerate(numbers)}
        self.slots: dict[tuple[Series, bool], int] = {}
        self.before: list[str] = []
        self.weighted: set[int] = set()
        """Rows whose ``d`` some sum reads."""

    def body(self) -> list[str]:
        """Return the lines of one order; what comes before the loop is put into ``before``."""
        lines = []
        for n, instruction in enumerate(self.instructions):
            if n in self.rows:
                row = self.rows[n]
                self.before.append(f"a[{row}][0] = {self.first(n)};")
                lines.append(f"a[{row}][k] = {self._coefficient(n, instruction)};")
                lines.append(f"d[{row}][k] = k * a[{row}][k];")
            elif instruction.op == "back":
                lines += self._solve(n, instruction)
        unused = tuple(f"d[{row}][k] = " for row in self.rows.values() if row not in self.weighted)
        return [line for line in lines if not (unused and line.startswith(unused))]

    def start(self) -> Program:
        """Return the program of the values of order 0."""
        b = Builder(self.prepared.program.rules)
        new: list[int] = []
        for instruction in self.instructions:
            new.append(b.again(instruction, new))
        results = [
            b.add("div", b.const(1), new[k]) if inverted else new[k] for k, inverted in self.slots
        ]
        return b.program({START: results})

    def _coefficient(self, n: int, instruction: Instruction) -> str:
        op, args, value = instruction
        if op == "state":
            return f"y[({len(self.rates)} * (k - 1) + {value}) * ys]"
        if op == "time":
            return "k == 1 ? 1.0 : 0.0"
        if op == "item":
            return f"v{args[0]}[{value}]" if self.prepared.varies[args[0]] else "0.0"
        return str(RULES[op].coefficient(self, n, args, self.prepared.partner(n)))

    def _solve(self, n: int, instruction: Instruction) -> Sequence[str]:
        if not self.prepared.varies[n]:
            return []
        factor = instruction.args[0]
        shape = self.instructions[factor].value
        size = len(instruction.args) - 1
        entries = ", ".join(str(self.first(a)) for a in self.instructions[factor].args)
        symmetric = int(bool(getattr(shape, "symmetric", False)))
        self.before += [
            f"double v{n}_factor[{1 + size + size * size}] = {{{entries}}};",
            f"HEAD_start_factor_({size}, {symmetric}, v{n}_factor);",
        ]
        right = ", ".join(map(str, residuals(self, self.prepared, n)))
        return [
            f"double v{n}[{size}] = {{{right}}};",
            f"HEAD_start_back_({size}, v{n}_factor, v{n});",
        ]

    def _slot(self, a: Series, inverted: bool) -> _Text:
        return _Text(f"f[{self.slots.setdefault((a, inverted), len(self.slots))}]")

    def now(self, a: Series) -> _Text:
        return _Text(f"a[{self.rows[a]}][k]") if a in self.rows else _ZERO

    def first(self, a: Series) -> _Text:
        return self._slot(a, False)

    def inverse(self, a: Series) -> _Text:
        return self._slot(a, True)

    def dot(self, a: Series, b: Series, low: int = 0, high: int = 0) -> _Text:
        if a not in self.rows:
            return _ZERO if low else self.first(a) * self.now(b)
        if b not in self.rows:
            return _ZERO if high else self.now(a) * self.first(b)
        return self._call(f"a[{self.rows[a]}]", b, low, high)

    def moment(self, a: Series, b: Series, high: int = 0) -> _Text:
        if a not in self.rows:
            return _ZERO
        if b not in self.rows:
            return _ZERO if high else self.now(a) * self.first(b)
        self.weighted.add(self.rows[a])
        return self._call(f"d[{self.rows[a]}]", b, 1, high) * _Text("part")

    def _call(self, row: str, b: Series, low: int, high: int) -> _Text:
        end = f"k - {high}" if high else "k"
        return _Text(f"HEAD_dot({row}, a[{self.rows[b]}], {low}, {end}, k)")

    def choose(self, negative: _Text, a: _Text, b: _Text) -> _Text:
        return _Text(f"({negative} < 0.0 ? {a} : {b})")
