"""Derivatives by elimination: a linearised graph loses its inner vertices, one after the other.

Vertices are values, columns (what is differentiated by) and rows (what is differentiated); edges
carry partial derivatives. Eliminating a vertex multiplies its edges in with its edges out and adds
the products to the edges from its predecessors to its successors; in the end edges lead from columns
to rows alone. From the first value to the last this is forward accumulation, from the last to the
first reverse accumulation (Griewank and Walther, Evaluating Derivatives, 2nd ed., ch. 9 and 10).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from heapq import heapify, heappop, heappush

from codegen.derivatives.forms import ONE, Form, Forms, Monomial, added, merged

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
