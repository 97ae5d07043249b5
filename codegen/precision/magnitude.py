"""Sizes of the terms that results are made of: what a small result is small beside.

The size of a sum is the sum of the sizes of its terms; that of a product is what the terms of one factor
make with the other as it is, the larger of both; and so on through nested sums and products. Of what is
neither it is the size of the value. Sizes of two factors are not multiplied: where both cancel, as in the
square of a difference, that would be a size which no term has. A closure of a linkage that is 4e-16 m of
terms of 1 m has the size 2 m or so, and a kinetic energy, whose terms are all positive, its own. Source:
the condition number of a sum, sum |x_i| / |sum x_i| (Higham, Accuracy and Stability of Numerical
Algorithms, 2nd ed., sect. 4.2), taken through a program.

A constant of the motion that is zero because the states in it are, but for rounding, has terms of the size
of that rounding alone. It is measured by what it would be if these states had the size of others of their
unit (`Sizes.reach`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import TARGETS, Compiled
from codegen.frontend.layout import Layout
from codegen.ir.groups import INVARIANTS, OUTPUTS
from codegen.ir.ops import Instruction
from codegen.ir.passes import prune
from codegen.ir.program import Builder, Program

Array = NDArray[np.float64]
SMALL = 1e-8
"""Part of the size of their unit by which states are moved, to see how far a constant reaches."""
GENEROUS = 1 + 2.0**-45
"""A change is taken away with what its own rounding may be."""
POINTS = 64
"""Stored points of a run at most at which terms are looked at, evenly, both ends among them."""

_Rule = Callable[[Builder, Sequence[int], Sequence[int]], int]
"""``(builder, values of arguments, sizes of arguments)`` to the size."""


def _same(op: str) -> _Rule:
    return lambda b, args, sizes: b.add(op, *sizes)


def _of_product(b: Builder, args: Sequence[int], sizes: Sequence[int]) -> int:
    """Return the larger of what the terms of one factor make, the other as it is."""
    first, second = (b.add("abs", k) for k in args)
    return b.add("max", b.add("mul", sizes[0], second), b.add("mul", first, sizes[1]))


_RULES: dict[str, _Rule] = {
    "add": _same("add"),
    "sub": _same("add"),
    "mul": _of_product,
    "hypot": _same("hypot"),
    "sqrt": _same("sqrt"),
    "neg": lambda b, args, sizes: sizes[0],
    "abs": lambda b, args, sizes: sizes[0],
    "div": lambda b, args, sizes: b.add("div", sizes[0], b.add("abs", args[1])),
    "select": lambda b, args, sizes: b.add("select", args[0], *sizes[1:]),
}
"""Sizes of what is made of terms; of every other operation the size is that of its value."""


def sizes_program(program: Program, group: str) -> Program:
    """Return the program of the sizes of a group of results. Law: each is at least the result's."""
    source = prune(program, [group])
    b = Builder(program.rules)
    values: list[int] = []
    sizes: list[int] = []
    for instruction in source.instructions:
        value = b.again(instruction, values)
        args = [values[a] for a in instruction.args]
        below = [sizes[a] for a in instruction.args]
        rule = _RULES.get(instruction.op)
        values.append(value)
        sizes.append(rule(b, args, below) if rule else _own(b, instruction, value))
    return prune(b.program({group: [sizes[k] for k in source.results[group]]}))


def _own(b: Builder, instruction: Instruction, value: int) -> int:
    """Return the size of a value by itself; factorisations and solutions are no numbers and have none."""
    return value if instruction.op in {"factor", "back"} else b.add("abs", value)


@dataclass(frozen=True)
class Sizes:
    """Sizes of the terms of a group of results of a system, by default the constants of the motion.

    They are found by functions in NumPy, which ``compiled`` keeps.
    """

    compiled: Compiled
    group: str = INVARIANTS

    def terms(self, t: Array | float, x: Array, p: Array, u: Array) -> Array:
        """Return the sizes (k, N) at N points; shapes as of the functions of ``compiled``."""
        return np.asarray(_function(self.compiled, self.group)(t, x, p, u))

    def reach(self, t: Array | float, x: Array, p: Array, u: Array) -> Array:
        """Return by how much each constant would change, to first order, by states of full size, (k, N).

        ``x`` (n, N). States of one unit have one size at a point, the largest of them.
        """
        size = of_unit(self.compiled.layout, np.abs(x))
        function = self.compiled.functions[self.group]
        start = function(t, x, p, u)
        total = np.zeros_like(start)
        for k in range(len(x)):
            moved = x.copy()
            moved[k] += SMALL * size[k]
            total += np.abs(function(t, moved, p, u) - start)
        return np.asarray(total / SMALL)


def of_unit(layout: Layout, sizes: Array) -> Array:
    """Return for each state (n, ...) the largest of the sizes of the states of its unit."""
    found = np.empty_like(sizes)
    units = [q.unit for q in layout.states]
    for unit in dict.fromkeys(units):
        rows = [k for k, own in enumerate(units) if own == unit]
        found[rows] = np.max(sizes[rows], axis=0)
    return found


def scale_of(terms: Array, change: Array, reach: Array) -> Array:
    """Return what changes of constants are compared with, (k,).

    ``terms``, ``change``, ``reach`` (k, N): sizes, changes and reaches at N points. The largest size on the
    way counts less the change there: terms that are wrong do not hide that they are. Constants whose
    terms are a part of `SMALL` of their reach are made of rounding; they are compared with that.
    """
    with np.errstate(invalid="ignore"):
        right = np.where(np.isfinite(terms), terms - GENEROUS * np.abs(change), -np.inf)
    at = np.argmax(right, axis=1)[:, None]
    size, full = (np.take_along_axis(a, at, axis=1)[:, 0] for a in (right, reach))
    return measured(size, full)


def measured(size: Array, reach: Array) -> Array:
    """Return the size, or the reach of what is made of rounding."""
    return np.asarray(np.where(size > SMALL * reach, size, reach))


def _function(compiled: Compiled, group: str) -> Callable[..., Array]:
    """Return the sizes as a function of NumPy; ``compiled`` keeps it."""
    key = ("sizes", group)
    if key not in compiled.derived:
        layout = compiled.layout
        own = replace(
            layout,
            results={OUTPUTS: (), INVARIANTS: (), group: layout.results[group]},
            coordinates=(),
            name=f"{layout.name}_sizes",
        )
        program = sizes_program(compiled.program, group)
        _, functions, _ = TARGETS["numpy"](program, own)
        compiled.derived[key] = functions[group]
    found = compiled.derived[key]
    assert callable(found)
    return found
