"""Time to generate and compile a program against its size: 1,000 to 50,000 operations.

The programs are forward dynamics of chains of bodies (`chains`), as many bodies as give the size, so
that they are neither all one sum nor without structure. Every size gets a cache of its own. Times
are those of the processor, the compiler's included, so that other jobs count little.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import log2

from benchmarks import chains
from benchmarks.native_rates import empty_cache
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen.ir.program import RATES, Program
from codegen.native import native
from codegen.targets import c

SIZES = (1_000, 2_000, 4_000, 8_000, 16_000, 32_000, 50_000)
QUICK_SIZES = (1_000, 2_000, 4_000)
EXPONENT = log2(2.3)
"""Time grows at most by this power of the size: 2.3 times where the size doubles."""
LONGEST_SECONDS = 10.0
LARGE = 8_000
"""Programs of more operations are compiled once."""
EACH_BODY = 420
"""Operations of a further body, about, but not fewer."""


@dataclass(frozen=True)
class Measured:
    """Operations, seconds to build and write the text, seconds to compile, bytes of the text."""

    operations: int
    generation: float
    compiler: float
    size: int

    @property
    def total(self) -> float:
        """Seconds from the recursion to loaded code."""
        return self.generation + self.compiler


def measure(settings: Settings) -> Section:
    """Return one row a size: times, the ratio to the size before, targets."""
    title = "generation + compilation by size, time of the processor"
    if settings.quick:
        return Section(title, tuple(_bytes()))
    found = [_measured(size) for size in SIZES]
    return Section(title, tuple(_rows(found)))


def _rows(found: list[Measured]) -> Iterator[Row]:
    yield _row(found[0], "", "", None)
    for before, now in pairwise(found):
        growth = now.operations / before.operations
        limit = growth**EXPONENT
        ratio = now.total / before.total
        met = ratio <= limit
        yield _row(now, f"{ratio:.2f}", f"<= {limit:.2f} for {growth:.2f} times the size", met)
    last = found[-1]
    met = last.total <= LONGEST_SECONDS
    what = f"{last.operations} operations in all"
    yield Row(what, time_text(last.total), target=f"<= {time_text(LONGEST_SECONDS)}", met=met)


def _row(now: Measured, ratio: str, target: str, met: bool | None) -> Row:
    mine = f"{time_text(now.generation)} + {time_text(now.compiler)}"
    return Row(f"{now.operations} operations", mine, f"{now.size} bytes", ratio, target, met)


def _bytes() -> Iterator[Row]:
    """Judge how the text grows, without a compiler or a clock."""
    sizes = []
    for size in QUICK_SIZES:
        program, bodies = of_size(size)
        text = c.single_text(program, chains.layout(bodies))
        sizes.append((sum(program.counts().values()), len(text)))
    for (n, before), (m, now) in pairwise(sizes):
        limit = (m / n) ** EXPONENT
        ratio = now / before
        target = f"<= {limit:.2f}"
        yield Row(f"{m} operations", f"{now} bytes", "", f"{ratio:.2f}", target, ratio <= limit)


def of_size(operations: int) -> tuple[Program, int]:
    """Return the chain of about so many operations, and the number of its bodies."""
    bodies = max(2, operations // EACH_BODY)
    program = chains.program(bodies)
    while sum(program.counts().values()) < operations:
        bodies += 1
        program = chains.program(bodies)
    return program, bodies


def _measured(size: int) -> Measured:
    """Return the quickest of a few runs, fewer for large programs."""
    _, bodies = of_size(size)
    runs = [_run(bodies) for _ in range(1 if size > LARGE else 3)]
    return min(runs, key=lambda run: run.total)


def _run(bodies: int) -> Measured:
    marks = [sum(os.times()[:4])]
    program = chains.program(bodies)
    text = c.single_text(program, chains.layout(bodies))
    marks.append(sum(os.times()[:4]))
    with empty_cache():
        flags = native.flags_for(len(program.results[RATES]), len(program.instructions))
        native.load(native.compile_library(text, flags), text, flags)
        marks.append(sum(os.times()[:4]))
    operations = sum(program.counts().values())
    return Measured(operations, marks[1] - marks[0], marks[2] - marks[1], len(text))
