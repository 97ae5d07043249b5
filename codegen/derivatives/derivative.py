"""Derivatives of programs: Jacobians from instructions to instructions, sparse, value shared.

A program is linearised, each operation by its partial derivatives, and the inner values are
eliminated in the order that leaves the cheapest program (`codegen.derivatives.derivative`): forward,
reverse or mixed accumulation. Where an operation has no derivative, at zero of a root, of a norm or of
atan2, at the ends of asin, it counts as zero, so that nothing but the mathematics at hand can make a
derivative infinite; what a condition does not select cannot either.

Linear systems inside programs: A x = f gives A dx = df - dA x. The right-hand sides r_j of that become
vertices of the linearised graph: each depends on the entries of its row and of f with the solution as
weights, and the solution depends on it by the inverse of A, whose columns are solutions for unit vectors
with the factorisation that is there (Griewank and Walther, Evaluating Derivatives, 2nd ed., sect. 15.2).

Derivatives by elimination: a linearised graph loses its inner vertices, one after the other.

Vertices are values, columns (what is differentiated by) and rows (what is differentiated); edges
carry partial derivatives. Eliminating a vertex multiplies its edges in with its edges out and adds
the products to the edges from its predecessors to its successors; in the end edges lead from columns
to rows alone. From the first value to the last this is forward accumulation, from the last to the
first reverse accumulation (Griewank and Walther, Evaluating Derivatives, 2nd ed., ch. 9 and 10).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from heapq import heapify, heappop, heappush

from codegen.derivatives.forms import ONE, Form, Forms, Monomial, merged
from codegen.ir import fold, stumpff
from codegen.ir.fold import constant
from codegen.ir.linsolve import Shape
from codegen.ir.ops import OPS, Instruction
from codegen.ir.passes import depth_first, needed
from codegen.ir.polynomials import added
from codegen.ir.program import Builder, Program
from codegen.passes.chains import share_sums
from eom.errors import InputError
from eom.tables import Table

Edges = Mapping[int, Mapping[int, Form]]
"""Edges by the vertex where they end, then by the vertex where they start.

Columns are numbered -1, -2, ..., values from 0 in their order, rows after the last value."""
Structure = tuple[dict[int, dict[int, None]], dict[int, dict[int, None]]]
Order = Callable[[Structure, Sequence[int]], Sequence[int]]


def forward(_: Structure, inner: Sequence[int]) -> Sequence[int]:
    """Eliminate the first values first."""
    return inner


def reverse(_: Structure, inner: Sequence[int]) -> Sequence[int]:
    """Eliminate the last values first."""
    return inner[::-1]


def markowitz(structure: Structure, inner: Sequence[int]) -> Sequence[int]:
    """Eliminate next what makes fewest products, edges in times edges out; ties by number.

    Griewank and Walther, sect. 10.2.
    """
    into, out = structure
    heap = [(len(into[v]) * len(out[v]), v) for v in inner]
    heapify(heap)
    order: list[int] = []
    done: set[int] = set()
    while heap:
        degree, v = heappop(heap)
        if v in done or degree != len(into[v]) * len(out[v]):
            continue
        done.add(v)
        order.append(v)
        neighbours = [*into[v], *out[v]]
        _remove(structure, v)
        for n in neighbours:
            if n in out and n in into:
                heappush(heap, (len(into[n]) * len(out[n]), n))
    return order


ORDERS: Mapping[str, Order] = {"forward": forward, "reverse": reverse, "mixed": markowitz}
"""Orders of elimination by the name of the accumulation; mixed is Markowitz's."""


def structure_of(edges: Edges) -> Structure:
    """Return predecessors and successors of each vertex that has such."""
    into = {v: dict.fromkeys(row) for v, row in edges.items()}
    out: dict[int, dict[int, None]] = {}
    for v, row in edges.items():
        for u in row:
            out.setdefault(u, {})[v] = None
    return into, out


def inner_vertices(structure: Structure) -> list[int]:
    """Return the vertices with edges in and edges out, in order."""
    into, out = structure
    return sorted(v for v in into if v in out)


def _remove(structure: Structure, v: int) -> int:
    """Eliminate a vertex; return the number of products."""
    into, out = structure
    before, after = into.pop(v), out.pop(v)
    for u in before:
        del out[u][v]
        out[u].update(after)
    for w in after:
        del into[w][v]
        into[w].update(before)
    return len(before) * len(after)


def products(edges: Edges, order: Order) -> int:
    """Return how many products an order makes."""
    structure = structure_of(edges)
    inner = inner_vertices(structure)
    return sum(_remove(structure, v) for v in order(structure_of(edges), inner))


def eliminate(forms: Forms, edges: Edges, order: Order) -> dict[int, dict[int, Form]]:
    """Return the edges from columns to rows: derivatives by row, then by column."""
    structure = structure_of(edges)
    inner = inner_vertices(structure)
    out = structure[1]
    left: dict[int, dict[int, dict[Monomial, Fraction]]] = {
        v: {u: dict(form) for u, form in row.items()} for v, row in edges.items()
    }
    for v in order(structure_of(edges), inner):
        before, after = left.pop(v), out.pop(v)
        successors = sorted(after)
        for w in successors:
            outward = left[w].pop(v)
            for u, inward in before.items():
                known = left[w].get(u, {})
                if outward == ONE and w == successors[-1]:
                    entry = merged(known, inward)
                else:
                    entry = added(known, forms.product(inward, outward))
                if entry:
                    left[w][u] = entry
                    out[u][w] = None
                else:
                    left[w].pop(u, None)
                    out[u].pop(w, None)
        for u in before:
            out[u].pop(v, None)
    return {v: dict(row) for v, row in left.items()}


JACOBIAN = "jacobian"
Partial = Callable[[Builder, int, Sequence[int]], tuple[int | None, ...]]
"""From the numbers of value and arguments to those of the partial derivatives; None is zero."""
Seeds = Sequence[Mapping[Instruction, Instruction]]
"""Directions: for each column the slots that it moves, with the leaf that says how fast."""
Weights = Sequence[Mapping[int, Instruction]]
"""Sums of results: for each row the places of its results in their group, with their weights."""

PROMISING = 2.0
"""Orders are carried out that make at most so many times as many products as the best."""
SUMS_SHARED = 2000
"""Instructions up to which partial sums are shared: the search takes time by their square."""


@dataclass(frozen=True)
class Jacobian:
    """A program with the results of a group and the entries of their Jacobian that are not zero.

    ``pattern``: (row, column) of each entry, by rows: result and slot. ``mode``: the accumulation
    that was cheapest, one of `codegen.derivatives.derivative.ORDERS`.
    """

    program: Program
    pattern: tuple[tuple[int, int], ...]
    mode: str = "forward"


def jacobian(
    program: Program, group: str, kind: str = "state", modes: Iterable[str] = tuple(ORDERS)
) -> Jacobian:
    """Differentiate the results ``group`` with respect to all slots of ``kind``.

    ``kind``: state, parameter, input or time. ``modes``: what to choose from. Law: the entries are
    the derivatives of the results in exact arithmetic, wherever these exist; the results
    themselves do not change.
    """
    return derive(program, group, identity(program, group), slots(program, kind), modes)


def slots(program: Program, kind: str) -> Seeds:
    """Return one column a slot of ``kind``, up to the last one that the program reads."""
    found = {i.slot: i for i in program.instructions if i.op == kind}
    return [{found[k]: UNIT} if k in found else {} for k in range(max(found, default=-1) + 1)]


UNIT = Instruction("const", (), Fraction(1))


def identity(program: Program, group: str) -> Weights:
    """Return one row a result of the group."""
    return [{k: UNIT} for k in range(len(program.results[group]))]


def derive(
    program: Program,
    group: str,
    rows: Weights,
    columns: Seeds,
    modes: Iterable[str] = tuple(ORDERS),
) -> Jacobian:
    """Return the derivatives of weighted sums of results in given directions, mode by cost.

    Law: entry (row, column) is the sum over results and slots of weight times partial derivative
    times rate of the slot; ties between modes go to the first.
    """
    candidates = list(modes)
    if len(candidates) > 1:
        edges = _linearised(program, group, rows, columns)[2]
        counts = {m: products(edges, ORDERS[m]) for m in candidates}
        most = PROMISING * min(counts.values())
        candidates = [m for m in candidates if counts[m] <= most]
    found = [_by(mode, program, group, rows, columns) for mode in candidates]
    return min(found, key=lambda d: d.program.cost())


def _by(mode: str, program: Program, group: str, rows: Weights, columns: Seeds) -> Jacobian:
    forms, copied, edges = _linearised(program, group, rows, columns)
    b = forms.b
    left = eliminate(forms, edges, ORDERS[mode])
    first = vertices(program)[-1]
    entries = {
        (row, ~column): left[first + row][column]
        for row in range(len(rows))
        for column in sorted(left.get(first + row, {}), reverse=True)
    }
    numbers = dict(zip(entries, forms.numbers(list(entries.values())), strict=True))
    pattern = tuple(place for place, number in numbers.items() if constant(b, number) != 0)
    results = {group: [copied[k] for k in program.results[group]]}
    whole = b.program({**results, JACOBIAN: [numbers[place] for place in pattern]})
    return Jacobian(_finished(whole), pattern, mode)


def _finished(program: Program) -> Program:
    """Share partial sums of the entries where that is soon done and saves, and order everything."""
    plain = depth_first(program)
    if len(plain.instructions) > SUMS_SHARED:
        return plain
    return min(plain, depth_first(share_sums(plain)), key=Program.cost)


def _linearised(
    program: Program, group: str, rows: Weights, columns: Seeds
) -> tuple[Forms, dict[int, int], Edges]:
    """Copy the program and return its numbers and the edges between values that matter."""
    b = Builder(program.rules)
    copied: dict[int, int] = {}
    order = sorted(needed(program, [group]))
    for k in order:
        copied[k] = b.again(program.instructions[k], copied)
    for k, name in program.names.items():
        if k in copied:
            b.name(copied[k], name)
    forms = Forms(b)
    edges = _edges(forms, program, copied, columns)
    numbers = vertices(program)
    results = [numbers[k] for k in program.results[group]]
    for row, weights in enumerate(rows):
        sums: dict[int, dict[Monomial, Fraction]] = {}
        for place, weight in weights.items():
            if results[place] in edges:
                added(sums.setdefault(results[place], {}), _weight(forms, weight))
        edges[numbers[-1] + row] = sums
    return forms, copied, _reaching(edges, numbers[-1])


def _edges(
    forms: Forms, program: Program, copied: Mapping[int, int], columns: Seeds
) -> dict[int, Mapping[int, Form]]:
    """Return the edges into the values of a program that vary with the columns."""
    edges: dict[int, Mapping[int, Form]] = {}
    numbers = vertices(program)
    for k in copied:
        leaf = op, args, _ = program.instructions[k]
        if op == "back":
            edges |= right_hand_sides(forms, program, k, copied, numbers, edges)
            continue
        if op == "item":
            into = entry_of_solution(forms, program, k, copied, numbers, edges)
        elif op in OPS:
            varying = [numbers[a] if numbers[a] in edges else None for a in args]
            into = _chain(forms, op, copied[k], [copied[a] for a in args], varying)
        else:
            into = {
                ~j: _weight(forms, seeds[leaf]) for j, seeds in enumerate(columns) if leaf in seeds
            }
        if into:
            edges[numbers[k]] = into
    return edges


def _weight(forms: Forms, leaf: Instruction) -> Form:
    return forms.of(forms.b.leaf(leaf.op, leaf.value))


def _chain(
    forms: Forms, op: str, value: int, args: Sequence[int], varying: Sequence[int | None]
) -> dict[int, Form]:
    """Return the partial derivatives of an operation by the arguments that vary."""
    if not any(a is not None for a in varying):
        return {}
    found: dict[int, dict[Monomial, Fraction]] = {}
    for a, partial in zip(varying, PARTIALS[op](forms.b, value, args), strict=True):
        if a is not None and partial is not None:
            added(found.setdefault(a, {}), forms.of(partial))
    return {a: form for a, form in found.items() if form}


def _reaching(edges: Mapping[int, Mapping[int, Form]], first_row: int) -> Edges:
    """Leave out the vertices from which no row is reached."""
    reached: set[int] = set()
    for v in sorted(edges, reverse=True):
        if v >= first_row or v in reached:
            reached.update(edges[v])
    return {v: row for v, row in edges.items() if v >= first_row or v in reached}


def _one(b: Builder, _: int, args: Sequence[int]) -> tuple[int | None, ...]:
    return (b.const(1),) * len(args)


def _flat(_: Builder, __: int, args: Sequence[int]) -> tuple[int | None, ...]:
    return (None,) * len(args)


def _unary(rule: Callable[[Builder, int, int], int]) -> Partial:
    return lambda b, v, args: (rule(b, v, args[0]),)


def _square(b: Builder, x: int) -> int:
    return b.add("mul", x, x)


def _over(b: Builder, divisor: int, numerator: int = 1) -> int:
    return b.add("div", b.const(numerator), divisor)


def _unless_zero(b: Builder, test: int, value: int) -> int:
    """Return ``value``, or zero where ``test`` is zero."""
    return b.add("select", b.add("eq", test, b.const(0)), b.const(0), value)


def _div(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    """1 / y and -v / y, by one division where the numerator varies and needs 1 / y anyway."""
    x, y = args
    inverse = _over(b, y)
    quotient = b.add("mul", v, inverse) if b.binding[x] > 1 else b.add("div", v, y)
    return (inverse, b.add("neg", quotient))


def _sqrt(b: Builder, v: int, _: int) -> int:
    return _unless_zero(b, v, b.add("div", b.const(1), b.add("mul", b.const(2), v)))


def _pow(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    """Y x^(y - 1) for a base that is zero, too; the exponent's derivative where the base is positive."""
    x, y = args
    lower = b.add("pow", x, b.add("sub", y, b.const(1)))
    positive = b.add("lt", b.const(0), x)
    growth = b.add("select", positive, b.add("mul", v, b.add("log", x)), b.const(0))
    return (b.add("mul", y, lower), growth)


def _atan2(b: Builder, _: int, args: Sequence[int]) -> tuple[int | None, ...]:
    y, x = args
    square = b.add("add", _square(b, x), _square(b, y))
    return tuple(
        _unless_zero(b, square, b.add("div", part, square)) for part in (x, b.add("neg", y))
    )


def _arc(b: Builder, x: int) -> int:
    """1 / sqrt(1 - x^2), zero at the ends."""
    root = b.add("sqrt", b.add("sub", b.const(1), _square(b, x)))
    return _unless_zero(b, root, _over(b, root))


def _acosh(b: Builder, _: int, x: int) -> int:
    below, above = b.add("sub", x, b.const(1)), b.add("add", x, b.const(1))
    root = b.add("mul", b.add("sqrt", below), b.add("sqrt", above))
    return _unless_zero(b, root, _over(b, root))


def _smaller(first: str, b: Builder, args: Sequence[int]) -> tuple[int | None, ...]:
    x, y = args if first == "min" else args[::-1]
    chosen = b.add("le", x, y)
    return (chosen, b.add("not", chosen))


def _mod(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    """1 and -floor(a/b), where a/b may have been rounded to a whole number: (a - v)/b is close to one."""
    quotient = b.add("div", b.add("sub", args[0], v), args[1])
    whole = b.add("floor", b.add("add", quotient, b.const(Fraction(1, 2))))
    return (b.const(1), b.add("neg", whole))


def _hypot(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    return tuple(_unless_zero(b, v, b.add("div", a, v)) for a in args)


def _gauss(b: Builder, x: int) -> int:
    """2 exp(-x^2) / sqrt(pi)."""
    factor = b.add("div", b.const(2), b.add("sqrt", b.leaf("pi")))
    return b.add("mul", factor, b.add("exp", b.add("neg", _square(b, x))))


def _bessel(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    """(C_{n-1} - C_{n+1})/2, and -C_1 for n = 0 (DLMF 10.6.1)."""
    kind = b.instructions[v].op
    n, x = fold.constant(b, args[0]), args[1]
    assert n is not None
    after = b.add(kind, b.const(n + 1), x)
    if n == 0:
        return (None, b.add("neg", after))
    difference = b.add("sub", b.add(kind, b.const(n - 1), x), after)
    return (None, b.add("mul", b.const(Fraction(1, 2)), difference))


def _stumpff(b: Builder, _: int, args: Sequence[int]) -> tuple[int | None, ...]:
    """(k c_{k+2} - c_{k+1})/2. Raises `InputError` beyond the largest k that is tabulated."""
    k, z = fold.constant(b, args[0]), args[1]
    assert k is not None
    if k + 2 > stumpff.LARGEST:
        raise InputError("derivative of too high an order", got=f"Stumpff function c_{k + 2}",
                         expected=f"up to c_{stumpff.LARGEST}")  # fmt: skip
    second = b.add("mul", args[0], b.add("stumpff", b.const(k + 2), z))
    difference = b.add("sub", second, b.add("stumpff", b.const(k + 1), z))
    return (None, b.add("mul", b.const(Fraction(1, 2)), difference))


def _table(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    table = b.instructions[v].value
    assert isinstance(table, Table)
    derived = table.derivative
    return (b.add("table", args[0], value=derived) if derived.degree >= 0 else None,)


PARTIALS: dict[str, Partial] = {
    "add": _one,
    "sub": lambda b, v, args: (b.const(1), b.const(-1)),
    "mul": lambda b, v, args: (args[1], args[0]),
    "div": _div,
    "neg": lambda b, v, args: (b.const(-1),),
    "sqrt": _unary(_sqrt),
    "pow": _pow,
    "sin": _unary(lambda b, v, x: b.add("cos", x)),
    "cos": _unary(lambda b, v, x: b.add("neg", b.add("sin", x))),
    "tan": _unary(lambda b, v, x: b.add("add", b.const(1), _square(b, v))),
    "asin": _unary(lambda b, v, x: _arc(b, x)),
    "acos": _unary(lambda b, v, x: b.add("neg", _arc(b, x))),
    "atan": _unary(lambda b, v, x: _over(b, b.add("add", b.const(1), _square(b, x)))),
    "sinh": _unary(lambda b, v, x: b.add("cosh", x)),
    "cosh": _unary(lambda b, v, x: b.add("sinh", x)),
    "tanh": _unary(lambda b, v, x: b.add("sub", b.const(1), _square(b, v))),
    "asinh": _unary(
        lambda b, v, x: _over(b, b.add("sqrt", b.add("add", b.const(1), _square(b, x))))
    ),
    "acosh": _unary(_acosh),
    "atanh": _unary(lambda b, v, x: _over(b, b.add("sub", b.const(1), _square(b, x)))),
    "exp": _unary(lambda b, v, x: v),
    "log": _unary(lambda b, v, x: _over(b, x)),
    "atan2": _atan2,
    "abs": _unary(lambda b, v, x: b.add("sign", x)),
    "sign": _flat,
    "min": lambda b, v, args: _smaller("min", b, args),
    "max": lambda b, v, args: _smaller("max", b, args),
    **dict.fromkeys(("lt", "le", "eq", "and", "or", "not"), _flat),
    "floor": _flat,
    "mod": _mod,
    "hypot": _hypot,
    "erf": _unary(lambda b, v, x: _gauss(b, x)),
    "erfc": _unary(lambda b, v, x: b.add("neg", _gauss(b, x))),
    "expm1": _unary(lambda b, v, x: b.add("exp", x)),
    "log1p": _unary(lambda b, v, x: _over(b, b.add("add", b.const(1), x))),
    "besselj": _bessel,
    "bessely": _bessel,
    "stumpff": _stumpff,
    "table": _table,
    "factor": _flat,
    "select": lambda b, v, args: (
        None,
        b.add("not", b.add("eq", args[0], b.const(0))),
        b.add("eq", args[0], b.const(0)),
    ),
}
"""How each operation is differentiated, by further operations.

Solutions of linear systems are left to `codegen.derivatives.derivative`; a factorisation has no
derivative."""


def columns(pattern: Iterable[tuple[int, int]]) -> dict[int, frozenset[int]]:
    """Return the rows in which each column has an entry."""
    found: dict[int, set[int]] = {}
    for row, column in pattern:
        found.setdefault(column, set()).add(row)
    return {c: frozenset(rows) for c, rows in sorted(found.items())}


def colouring(pattern: Iterable[tuple[int, int]]) -> dict[int, int]:
    """Return a colour for each column so that columns of one colour share no row.

    As many directional derivatives as there are colours give the whole matrix (Curtis, Powell and
    Reid, 1974). Greedy, the fullest columns first; ties by number.
    """
    rows = columns(pattern)
    colours: dict[int, int] = {}
    taken: list[set[int]] = []
    for c in sorted(rows, key=lambda c: (-len(rows[c]), c)):
        free = next((k for k, used in enumerate(taken) if not used & rows[c]), len(taken))
        if free == len(taken):
            taken.append(set())
        taken[free] |= rows[c]
        colours[c] = free
    return dict(sorted(colours.items()))


def vertices(program: Program) -> list[int]:
    """Return a number for each value, with room before each solution for its right-hand sides.

    The last entry is the first number that is free.
    """
    numbers, room = [], 0
    for k, (op, args, _) in enumerate(program.instructions):
        room += len(args) - 1 if op == "back" else 0
        numbers.append(k + room)
    return [*numbers, len(program.instructions) + room]


def right_hand_sides(
    forms: Forms,
    program: Program,
    solution: int,
    copied: Mapping[int, int],
    numbers: Sequence[int],
    edges: Mapping[int, Mapping[int, Form]],
) -> dict[int, dict[int, Form]]:
    """Return the edges into the right-hand sides of the ``back`` instruction ``solution``.

    ``copied``: numbers in the builder of ``forms``; ``numbers``: those of `vertices`; ``edges``:
    the vertices that vary.
    """
    factor, *right = program.instructions[solution].args
    shape = program.instructions[factor].value
    assert isinstance(shape, Shape)
    b = forms.b
    x = [b.add("item", copied[solution], value=i) for i in range(shape.size)]
    rows: list[dict[int, dict[Monomial, Fraction]]] = [{} for _ in right]

    def weigh(row: int, entry: int, weight: int) -> None:
        vertex = numbers[entry]
        if vertex in edges:
            added(rows[row].setdefault(vertex, {}), forms.of(weight))

    for row, entry in enumerate(right):
        weigh(row, entry, b.const(1))
    for (i, j), entry in zip(shape.places, program.instructions[factor].args, strict=True):
        weigh(i, entry, b.add("neg", x[j]))
        if shape.symmetric and i != j:
            weigh(j, entry, b.add("neg", x[i]))
    first = numbers[solution] - shape.size
    return {first + row: dict(into) for row, into in enumerate(rows) if into}


def entry_of_solution(
    forms: Forms,
    program: Program,
    item: int,
    copied: Mapping[int, int],
    numbers: Sequence[int],
    edges: Mapping[int, Mapping[int, Form]],
) -> dict[int, Form]:
    """Return the edges from the right-hand sides to the ``item`` instruction ``item``."""
    (solution,), entry = program.instructions[item].args, program.instructions[item].slot
    b = forms.b
    factor = b.instructions[copied[solution]].args[0]
    size = len(program.instructions[solution].args) - 1
    first = numbers[solution] - size
    found: dict[int, Form] = {}
    for row in range(size):
        if first + row in edges:
            unit = (b.const(int(k == row)) for k in range(size))
            column = b.add("back", factor, *unit)
            found[first + row] = forms.of(b.add("item", column, value=entry))
    return found
