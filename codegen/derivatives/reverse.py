"""Derivatives along directions: gradients, products with Jacobians and Hessians, sparse Hessians.

Weights and directions are further inputs of the program: their slots follow the inputs that it has,
whose number the caller gives as ``inputs``, because a program does not tell of inputs that it does not
read. Everything else that holds for `codegen.derivatives.derivative.jacobian` holds here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from codegen.derivatives.derivative import JACOBIAN, UNIT, Jacobian, Seeds, derive, identity, slots
from codegen.derivatives.elimination import ORDERS
from codegen.ir.ops import Instruction
from codegen.ir.passes import prune
from codegen.ir.program import Program

GRADIENT, PRODUCT, HESSIAN = "gradient", "product", "hessian"
MODES = tuple(ORDERS)
REVERSE_FIRST = ("reverse", "mixed", "forward")


@dataclass(frozen=True)
class Product:
    """A program with the results of a group and a product with their derivatives.

    ``places``: for a product of weights with a Jacobian, or of a Hessian with a direction, the slot
    (kind, number) of each entry; for a product of a Jacobian with a direction, ("result", place).
    Entries that are zero everywhere are left out. ``extra``: slots of ``input`` that the weights,
    then the directions take, first and one after the last. ``mode``: as for a Jacobian.
    """

    program: Program
    places: tuple[tuple[str, int], ...]
    extra: tuple[int, int]
    mode: str


def vjp(
    program: Program,
    group: str,
    kinds: Sequence[str] = ("state",),
    inputs: int = 0,
    modes: Iterable[str] = REVERSE_FIRST,
) -> Product:
    """Return the results and ``w^T J``, for weights w that are inputs, one a result of the group.

    The entries, in the group `PRODUCT`, go by kinds, then by slots. Law: for constant w they are
    the derivatives of the sum of w times results. Griewank and Walther, sect. 3.2: the cost is
    that of a few evaluations of the program, however many slots there are.
    """
    count = len(program.results[group])
    weights = {k: _input(inputs + k) for k in range(count)}
    return _weighted(program, group, kinds, weights, (inputs, inputs + count), modes)


def gradient(
    program: Program,
    group: str,
    place: int = 0,
    kinds: Sequence[str] = ("state",),
    modes: Iterable[str] = REVERSE_FIRST,
) -> Product:
    """Return the results and the derivatives of one of them, in the group `PRODUCT`.

    Law: they are a row of the Jacobian.
    """
    return _weighted(program, group, kinds, {place: UNIT}, (0, 0), modes)


def _weighted(
    program: Program,
    group: str,
    kinds: Sequence[str],
    weights: Mapping[int, Instruction],
    extra: tuple[int, int],
    modes: Iterable[str],
) -> Product:
    places = _places(program, kinds)
    columns = [{_slot(*place): UNIT} for place in places]
    found = derive(program, group, [weights], columns, modes)
    return Product(
        _called(found, PRODUCT), tuple(places[c] for _, c in found.pattern), extra, found.mode
    )


def jvp(
    program: Program,
    group: str,
    sizes: Mapping[str, int],
    inputs: int = 0,
    modes: Iterable[str] = MODES,
) -> Product:
    """Return the results and ``J v``, for a direction v that is given as inputs.

    ``sizes``: how many slots of each kind the direction moves; v holds them kind by kind. Law: for
    constant v the entries are the derivatives of the results along v.
    """
    moved = [(kind, k) for kind, count in sizes.items() for k in range(count)]
    rates = {_slot(kind, k): _input(inputs + n) for n, (kind, k) in enumerate(moved)}
    found = derive(program, group, identity(program, group), [rates], modes)
    places = tuple(("result", row) for row, _ in found.pattern)
    extra = (inputs, inputs + len(moved))
    return Product(_called(found, PRODUCT), places, extra, found.mode)


def hessian_product(
    program: Program,
    group: str,
    size: int,
    kind: str = "state",
    inputs: int = 0,
    modes: Iterable[str] = MODES,
) -> Product:
    """Return the results and ``H v``, H the Hessian of ``w^T results`` by ``size`` slots of a kind.

    Weights w, one a result, are the first further inputs; the direction v, ``size`` numbers, those
    after them. Forward over reverse accumulation (Griewank and Walther, sect. 5.4): the cost is
    that of a few evaluations of the results. Law: u^T (H v) = v^T (H u).
    """
    first = vjp(program, group, (kind,), inputs)
    start = first.extra[1]
    direction = {_slot(kind, k): _input(start + k) for k in range(size)}
    second = _differentiated(first, group, [direction], modes)
    places = tuple(first.places[row] for row, _ in second.pattern)
    return Product(_called(second, PRODUCT), places, (inputs, start + size), second.mode)


def hessian(
    program: Program,
    group: str,
    kind: str = "state",
    inputs: int = 0,
    place: int | None = None,
    modes: Iterable[str] = MODES,
) -> Jacobian:
    """Return the results and the lower triangle of a Hessian, in the group `HESSIAN`.

    ``place``: which result, or None for ``w^T results``, with the weights w as further inputs from
    slot ``inputs``. The pattern holds (row, column) of entries that are not zero, column <= row;
    the others follow by symmetry. Law: H is the Jacobian of the gradient.
    """
    if place is None:
        first = vjp(program, group, (kind,), inputs)
    else:
        first = gradient(program, group, place, (kind,))
    second = _differentiated(first, group, slots(first.program, kind), modes)
    entries = second.program.results[JACOBIAN]
    below = [
        (entry, (first.places[row][1], column))
        for entry, (row, column) in zip(entries, second.pattern, strict=True)
        if column <= first.places[row][1]
    ]
    results = {group: second.program.results[group], HESSIAN: tuple(e for e, _ in below)}
    whole = prune(replace(second.program, results=results))
    return Jacobian(whole, tuple(place for _, place in below), second.mode)


def _differentiated(first: Product, group: str, columns: Seeds, modes: Iterable[str]) -> Jacobian:
    """Differentiate the entries of a product; the results of the group stay beside them."""
    values = first.program.results[group]
    together = {PRODUCT: (*values, *first.program.results[PRODUCT])}
    rows = [{len(values) + n: UNIT} for n in range(len(first.places))]
    found = derive(replace(first.program, results=together), PRODUCT, rows, columns, modes)
    kept = found.program.results[PRODUCT][: len(values)]
    results = {group: kept, JACOBIAN: found.program.results[JACOBIAN]}
    return replace(found, program=prune(replace(found.program, results=results)))


def _input(slot: int) -> Instruction:
    return Instruction("input", (), slot)


def _slot(kind: str, number: int) -> Instruction:
    return Instruction(kind, (), None if kind == "time" else number)


def _places(program: Program, kinds: Sequence[str]) -> list[tuple[str, int]]:
    """Return the slots of some kinds that a program reads, in order."""
    return [
        (kind, k)
        for kind in kinds
        for k in sorted(i.slot for i in program.instructions if i.op == kind)
    ]


def _called(found: Jacobian, name: str) -> Program:
    """Return the program with the entries under another name."""
    results = dict(found.program.results)
    results[name] = results.pop(JACOBIAN)
    return replace(found.program, results=results)
