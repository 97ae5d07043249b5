"""``python -m benchmarks``: measure everything side by side, print one table, judge the targets."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass

import click
from rich.console import Console

from benchmarks import (
    calls,
    chains,
    compile_time,
    counts,
    derivations,
    ensembles,
    exact,
    gradients,
    integration,
    jacobians,
    lanes,
    machine,
    pendulum,
    rates,
    runs,
    stages,
    startup,
    taylor,
    trees,
    waits,
)
from benchmarks.settings import Settings
from benchmarks.table import Section, missed, table
from codegen.native import native

WIDTH = 160


@dataclass(frozen=True)
class Measurement:
    """A section of the report: how to get it, whether it needs a C compiler, whether it is quick."""

    run: Callable[[Settings], Section]
    needs_compiler: bool = True
    quick: bool = True

    @property
    def name(self) -> str:
        """What it is called on the command line: its module."""
        return self.run.__module__.rpartition(".")[2]


MEASUREMENTS = (
    Measurement(rates.measure),
    Measurement(calls.measure),
    Measurement(runs.measure),
    Measurement(lanes.measure),
    Measurement(jacobians.measure),
    Measurement(integration.measure),
    Measurement(exact.measure, needs_compiler=False),
    Measurement(taylor.measure, quick=False),
    Measurement(ensembles.measure, quick=False),
    Measurement(gradients.measure, quick=False),
    Measurement(stages.measure, quick=False),
    Measurement(pendulum.measure, quick=False),
    Measurement(chains.measure),
    Measurement(trees.measure, needs_compiler=False),
    Measurement(counts.measure),
    Measurement(compile_time.measure),
    Measurement(waits.measure, quick=False),
    Measurement(startup.measure, needs_compiler=False, quick=False),
    Measurement(derivations.measure, needs_compiler=False, quick=False),
)


@click.command()
@click.option("--quick", is_flag=True, help="Check ratios alone, in less than a minute.")
@click.option("--instructions", is_flag=True, help="Count instructions too, with valgrind.")
@click.option(
    "--only",
    "names",
    multiple=True,
    type=click.Choice([m.name for m in MEASUREMENTS]),
    help="Measure this section; may be given more than once.",
)
def main(quick: bool, instructions: bool, names: tuple[str, ...]) -> None:
    """Measure; exit with 0 if every target is met and with 1 otherwise."""
    asked = [m for m in MEASUREMENTS if m.name in names or not names]
    settings = Settings(quick, instructions)
    console = Console() if sys.stdout.isatty() else Console(width=WIDTH)
    console.print(machine.header(), highlight=False, markup=False, soft_wrap=True)
    compiler = bool(native.compiler())
    if not compiler:
        console.print("There is no C compiler: nothing of C was measured.")
    chosen = [m for m in asked if (compiler or not m.needs_compiler) and (m.quick or not quick)]
    sections = [m.run(settings) for m in chosen]
    if not sections:
        return
    console.print(table(sections))
    misses = missed(sections)
    console.print(f"Missed: {', '.join(misses)}." if misses else "Every target is met.")
    sys.exit(1 if misses else 0)


if __name__ == "__main__":
    main()
