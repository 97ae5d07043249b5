"""Work in another process, which is ended when it takes too long; it may also crash.

One run of a method, or the reason why there is none.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import warnings
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from typing import Any, Self

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.measure.stress.record import EPSILON, Figure, Findings
from codegen.native import children
from codegen.native.children import TooLongError, watch
from codegen.native.trajectory import Array
from codegen.runs.prepared import DEFAULT_MARGIN
from codegen.runs.result import Result
from codegen.runs.simulation import simulate
from eom import interrupts
from eom.errors import InputError

MAX_STEPS = 100_000_000
HELD = ("taylor",)
"""Methods with compensated sums all through: they run at full precision, where errors are a random walk."""
LOW_ORDER = ("scipy:RK23", "scipy:Radau", "scipy:BDF")
FINE, COARSE = 1e-12, 1e-6
PATIENCE = 3
"""A method that was given up so often is not tried again in the same check."""


def tolerance_of(method: str) -> float:
    """Return the relative tolerance at which a method is tried where one has to do."""
    if method in HELD:
        return EPSILON
    return COARSE if method in LOW_ORDER else FINE


@dataclass(frozen=True)
class Run:
    """What is integrated: from ``start`` at the first time of ``times`` to the last.

    It is stored at ``times``, or at every step where ``steps`` is true. ``atol``: one number a state, or
    None for rtol / 1000. ``limit``: seconds of processor time.
    """

    compiled: Compiled
    start: Mapping[str, float] | Array
    times: Array
    inputs: Mapping[str, float] = field(default_factory=dict)
    parameters: Mapping[str, float] | None = None
    atol: Array | None = None
    limit: float = np.inf
    margin: float = DEFAULT_MARGIN
    max_step: float = np.inf
    steps: bool = False
    max_steps: int = MAX_STEPS


@dataclass(frozen=True)
class Refusal:
    """Why there is no result; ``late``: because the run was given up."""

    reason: str
    late: bool = False


def attempt(run: Run, method: str, rtol: float) -> Result | Refusal:
    """Integrate; return the result, or why the method refuses or is given up.

    A warning that a tolerance is not kept counts as a refusal.
    """
    start = dict(run.start) if isinstance(run.start, Mapping) else run.start
    span = float(run.times[0]), float(run.times[-1])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)
            return simulate(
                run.compiled, start, span, run.parameters, method, rtol, run.atol,
                None if run.steps else run.times, inputs=run.inputs, margin=run.margin,
                max_step=run.max_step, max_steps=run.max_steps, progress=watch(run.limit),
            )  # fmt: skip
    except TooLongError:
        return Refusal(f"takes more than {run.limit:g} s", late=True)
    except (InputError, UserWarning) as error:
        return Refusal(str(error).splitlines()[0].partition(". ")[0])


@dataclass
class Collector:
    """Figures and refusals while a check runs."""

    figures: list[Figure] = field(default_factory=list)
    refused: dict[tuple[str, str], list[str]] = field(default_factory=dict)
    late: dict[str, int] = field(default_factory=dict)

    def result(self, run: Run, method: str, rtol: float, where: str) -> Result | None:
        """Return the result of a run, or None; the reason is then kept."""
        if self.late.get(method, 0) >= PATIENCE:
            return None
        found = attempt(run, method, rtol)
        if isinstance(found, Refusal):
            self.late[method] = self.late.get(method, 0) + found.late
            self.refused.setdefault((method, found.reason), []).append(where)
            return None
        return found

    def findings(self) -> Findings:
        """Return what was found; refusals of one method for one reason are one line."""
        lines = []
        for (method, reason), where in self.refused.items():
            more = f" and {len(where) - 1} more" if len(where) > 1 else ""
            given_up = self.late.get(method, 0) >= PATIENCE
            rest = "; not tried again" if given_up and reason.startswith("takes") else ""
            lines.append(f"{method}: {reason} ({where[0]}{more}{rest})")
        return Findings(tuple(self.figures), tuple(lines))


READY_SECONDS = 300.0
"""A new process that has not even begun by then counts as dead."""

LAST_SECONDS = 10.0
"""For a process that has closed its end to be over."""


@dataclass(frozen=True)
class Answer:
    """What became of a piece of work: ``value`` where ``trouble`` is empty."""

    value: Any
    trouble: str = ""


class Worker:
    """A process that calls ``work(argument)``, a function of a module; a new one after trouble."""

    def __init__(self, work: Callable[[Any], Any]) -> None:
        self.work = work
        self.process: Any = None
        self.connection: Connection | None = None

    def __enter__(self) -> Self:
        """Return self; the process starts with the first piece of work."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the process."""
        self._end()

    def ask(self, argument: Any, seconds: float) -> Answer:
        """Return the answer, or what went wrong: no answer in time, an exception, the process died."""
        connection = self.connection or self._begin()
        try:
            connection.send(argument)
            if not connection.poll(seconds):
                self._end()
                return Answer(None, f"no answer within {seconds:g} s")
            fine, value = connection.recv()
        except (EOFError, OSError):
            self.process.join(LAST_SECONDS)
            code = self.process.exitcode
            self._end()
            return Answer(None, f"the process died (exit code {code})")
        return Answer(value) if fine else Answer(None, value)

    def _begin(self) -> Connection:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs, self.work), daemon=True)
        with interrupts.not_interrupted():
            self.process.start()
        theirs.close()
        self.connection = ours
        if ours.poll(READY_SECONDS):
            ours.recv()
        return ours

    def _end(self) -> None:
        if self.connection is not None:
            self.connection.close()
            _end(self.process)
        self.connection = None


def _end(process: Any) -> None:
    """End a process, by an interruption where it heeds one, so that it ends its own children."""
    if process.is_alive():
        os.kill(process.pid, signal.SIGINT)
    process.join(children.PATIENCE_SECONDS)
    process.kill()
    process.join()


def _serve(connection: Connection, work: Callable[[Any], Any]) -> None:
    """Answer until the other side closes, or an interruption; an exception is an answer."""
    with suppress(KeyboardInterrupt):
        interrupts.interruptible()
        _answers(connection, work)


def _answers(connection: Connection, work: Callable[[Any], Any]) -> None:
    connection.send("ready")
    while True:
        try:
            argument = connection.recv()
        except EOFError:
            return
        try:
            answer: tuple[bool, Any] = (True, work(argument))
        except Exception as error:  # whatever it is, it is reported
            answer = (False, f"{type(error).__name__}: {error}")
        connection.send(answer)
