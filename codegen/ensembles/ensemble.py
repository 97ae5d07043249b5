"""Many trajectories of one system: over initial states and parameters, in lanes, threads, a cluster.

Every trajectory's result is the same to the last bit for any chunking, any number of threads and any
cluster of equal machines, and so are the statistics.

Threads of this process, or a Dask cluster, do the chunks. These are given out through a window of a few
for each worker, so that memory does not grow with the number of trajectories.

Pieces are put together as they arrive, in any order.

How much memory a process can still have, as far as the system says.
"""

from __future__ import annotations

import hashlib
import math
import os
import pickle
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, field
from functools import lru_cache, partial
from html import escape
from itertools import islice
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen.compiling import sampled
from codegen.compiling.compiled import Compiled, compiled_of, processors
from codegen.ensembles import store as stores
from codegen.ensembles.sampler import Many, Population, Sampler, population
from codegen.ensembles.statistics import BLOCK, Bins, Counts, Statistics, Summary, Tree, summary
from codegen.ensembles.work_units import (
    DRIFT,
    MOST_LISTED,
    VALUES,
    Piece,
    Plan,
    clock_of_plan,
    integrator,
    run,
)
from codegen.frontend.layout import names_of, to_array
from codegen.frontend.notebook import number, sparkline, table
from codegen.integrate import fleet
from codegen.integrate.fleet import Shared
from codegen.ir.program import INVARIANTS, OUTPUTS
from codegen.native.children import Flag, obey
from codegen.native.trajectory import MAX_STEPS, Array
from codegen.runs.arguments import grid as grid_of
from codegen.runs.arguments import positive, relative
from codegen.runs.arguments import span as span_of
from codegen.runs.arguments import tolerances as tolerances_of
from codegen.runs.given import InputsGiven
from codegen.runs.prepared import DEFAULT_MARGIN
from eom.errors import InputError, typed, unknown_name
from eom.system import System

LARGEST_CHUNK = 8192
CHUNK_BYTES = 64_000_000
CHUNKS = 8
"""Chunks of a small ensemble: enough for the threads, and long enough that lanes are seldom empty."""


@dataclass(frozen=True)
class Ensemble:
    """What many trajectories came to; all arrays have the trajectories as their last axis.

    Parameters
    ----------
    count : int
        N, of trajectories.
    t : array
        The stored times, (K,).
    counts : mapping of str to ints
        How many trajectories ended by each reason: end, singular, not finite, step, max_steps.
    stopped : NDArray
        Numbers of the first 10,000 trajectories that did not reach the end, and their status, (2,
        M).
    statistics : mapping of str to Summary
        By name of the state or output.
    drift : mapping of str to Summary
        By name of the constant of the motion: largest change over its first value.
    columns : mapping of str to NDArray
        What is kept of each trajectory: ``y`` (n, K, N), ``outputs`` (o, K, N), ``y_stop`` (n, N),
        ``t_stop``, ``status``, ``which``, ``steps``, ``rejected``, ``continued`` (N,), ``drift``
        (i, N). NaN at times that a trajectory did not reach; ``continued`` is 1 where another
        method went on, 2 where it may have passed what is singular.
    names : tuple of str
        Of the n states, in order.
    outputs : tuple of str
        Names of the o outputs, in order.
    method : str
        What integrated.
    notice : str
        What the user should know.
    steps : int
        Of all trajectories.
    computed : int
        Chunks that were not read from the store.
    seconds : float
        What it took.
    store : path, optional
        The folder of the trajectories, if there is one.

    Notes
    -----
    All arrays have the trajectories as their last axis. Units are those of the system.
    """

    count: int
    t: Array
    counts: Mapping[str, int]
    stopped: NDArray[np.int64]
    statistics: Mapping[str, Summary]
    drift: Mapping[str, Summary]
    columns: Mapping[str, NDArray[Any]] = field(repr=False)
    names: tuple[str, ...]
    outputs: tuple[str, ...]
    method: str
    notice: str
    steps: int
    computed: int
    seconds: float
    store: Path | None = None

    def __repr__(self) -> str:
        """Say how the trajectories ended."""
        ends = ", ".join(f"{k}: {v:,}" for k, v in self.counts.items())
        drift = "".join(f"; drift of {n} at most {d.maximum[0]:.1e}" for n, d in self.drift.items())
        return f"Ensemble({self.count:,} trajectories, {ends}; {self.steps:,} steps{drift})"

    def _repr_html_(self) -> str:
        """Return what a notebook displays: how trajectories ended, statistics at the last stored time."""
        rows = [
            (
                n,
                *(number(v[-1]) for v in (s.mean, s.deviation, s.minimum, s.maximum)),
                sparkline(self.t, s.mean),
            )
            for n, s in self.statistics.items()
            if len(s.mean)
        ]
        rows = rows or [("no statistics: no times were stored", *[""] * 5)]
        header = ("at the end", "mean", "standard deviation", "least", "largest", "mean over time")
        told = f"<p>{escape(self.notice)}</p>" if self.notice else ""
        return table(rows, header, repr(self)) + told

    @property
    def success(self) -> bool:
        """Whether every trajectory reached the end."""
        return self.counts.get("end", 0) == self.count

    @property
    def y(self) -> Array:
        """The states at the stored times, (n, K, N)."""
        return self._column("y")

    @property
    def y_stop(self) -> Array:
        """The states where each trajectory stopped, (n, N)."""
        return self._column("y_stop")

    @property
    def t_stop(self) -> Array:
        """The times at which they stopped, (N,)."""
        return self._column("t_stop")

    @property
    def status(self) -> NDArray[np.int32]:
        """Why each stopped, by number, (N,): `STATUS` names them.

        Raises `InputError`, as all of these do, where the trajectories were not kept.
        """
        return self._column("status")

    def __getitem__(self, name: str) -> Array:
        """Return the values of a state or output at the stored times.

        Parameters
        ----------
        name : str
            Of the state or output.

        Returns
        -------
        array
            (K, N), for K times and N trajectories, in its unit.

        Raises
        ------
        InputError
            For others, and where the trajectories were not kept.
        """
        for column, names in (("y", self.names), ("outputs", self.outputs)):
            if name in names:
                values: Array = self._column(column)[names.index(name)]
                return values
        raise unknown_name("state or output", name, [*self.names, *self.outputs])

    def _column(self, name: str) -> NDArray[Any]:
        if name not in self.columns:
            raise InputError(
                "the trajectories were not kept",
                hint=f"they are in {self.store}" if self.store else "call ensemble with keep=True",
            )
        return self.columns[name]


@typed
def ensemble(
    system: System | Compiled,
    initial: Many,
    t_span: tuple[float, float],
    parameters: Many = None,
    method: str = "auto",
    rtol: float = 1e-9,
    atol: ArrayLike | None = None,
    t_eval: ArrayLike | None = None,
    *,
    inputs: InputsGiven | None = None,
    statistics: Statistics | Sequence[str] = (),
    keep: bool | None = None,
    store: str | Path | None = None,
    store_format: str = "zarr",
    chunk: int | None = None,
    threads: int | None = None,
    client: Any = None,
    max_step: float = math.inf,
    max_steps: int = MAX_STEPS,
    margin: float = DEFAULT_MARGIN,
    progress: Callable[[float], None] | None = None,
) -> Ensemble:
    """Integrate many trajectories of ``system`` over ``t_span`` (s).

    Parameters
    ----------
    system : System or Compiled
        What to integrate.
    initial : mapping, sequence or Sampler
        The states at the start, by name or in order, each a number for all or one a trajectory (N,); or
        a `Sampler` of states and parameters.
    t_span : (float, float)
        Start and end (s).
    parameters : mapping or sequence, optional
        As ``initial``.
    method : str, default "auto"
        ``auto`` (Taylor series where every operation has a rule, else DOP853), ``taylor`` or
        ``DOP853``.
    rtol : float, default 1e-9
        Relative tolerance of a step.
    atol : float or array, optional
        Absolute tolerance, as of `simulate`, by the scales of each trajectory.
    t_eval : array, optional
        Times to store (s); without it the end alone.
    inputs : mapping, optional
        Numbers by name, or symbolic laws that are sampled.
    statistics : Statistics or sequence of str, optional
        Names of states and outputs, or `Statistics`.
    keep : bool, optional
        Whether the trajectories are kept in memory; by default where there is no ``store``.
    store : path, optional
        A folder for the trajectories. A run that broke off is called again to go on.
    store_format : str, default "zarr"
        ``zarr`` or ``parquet``.
    chunk : int, optional
        Trajectories of a task, made a multiple of 256.
    threads : int, optional
        How many; by default one a processor.
    client : optional
        A client of `dask.distributed`, which does it instead of threads.
    max_step : float, default inf
        Longest step (s).
    max_steps : int
        Most steps of a trajectory.
    margin : float, default 1e-6
        A trajectory stops where a singularity's expression gets below it.
    progress : callable, optional
        Called with the share that is done, 0 to 1.

    Returns
    -------
    Ensemble
        States and outputs of all trajectories, why each stopped, and the statistics.

    Raises
    ------
    InputError
        For unusable arguments, samples that are not finite, a store that cannot be written or holds
        another ensemble, and before the run what cannot fit into memory: trajectories that are kept,
        chunks at work.
    AssumptionError
        For samples that contradict the system's assumptions.

    Notes
    -----
    Where auto's Taylor series is stuck DOP853 goes on, as in `simulate`; ``notice`` says so. Never
    raises for what happens on the way of a trajectory: its status says why it stopped. Units are those
    of the system.

    References
    ----------
    As of `simulate`; of means and variances Chan, Golub and LeVeque, Am. Stat. 37 (1983) 242; of random
    numbers Salmon, Moraes, Dror and Shaw, SC 2011.

    Examples
    --------
    >>> import sympy as sp, codegen
    >>> y, v, k = sp.symbols("y v k", real=True)
    >>> oscillator = codegen.compile(System.from_rates("oscillator", {y: v, v: -k * y}), "numpy")
    >>> found = ensemble(oscillator, {"y": [1, 2, 3], "v": 0}, (0, sp.pi), {"k": 4})
    >>> found.y.shape, found["y"].round(6)  # (n, K, N): one time, three trajectories
    ((2, 1, 3), array([[1., 2., 3.]]))
    """
    compiled = compiled_of(system)
    compiled, held = sampled.compiled_in(compiled, inputs or {})
    shared = _shared(compiled, t_span, held, rtol, atol, t_eval, max_step, max_steps, margin)
    some = population(compiled, initial, parameters)
    number = processors() if threads is None else _whole(threads, "threads")
    kept = store is None if keep is None else keep
    size = _chunk(chunk, some.count, shared, compiled)
    plan = Plan(compiled, method, shared, _statistics(compiled, statistics), size, kept)
    _refuse_what_does_not_fit(plan, some.count, number if client is None else 0)
    work, mended = (run, "") if store is None else _stored(plan, some, store, store_format)
    integrator(plan)  # before the threads that need it
    notes = (_doubt(plan, some), mended)
    began = time.perf_counter()
    chunks = -(-some.count // plan.chunk)
    gathered = _gathered(plan, some, work, min(number, max(1, chunks)), client, progress)
    return _result(gathered, time.perf_counter() - began, store, notes)


def _doubt(plan: Plan, some: Population) -> str:
    """Return what a user should know of how well time is resolved, by the first chunk."""
    clock = clock_of_plan(plan)
    if clock is None:
        return ""
    return clock.doubt(some.draw(0, min(plan.chunk, some.count))[1], plan.shared.rtol)


def _stored(
    plan: Plan, some: Population, folder: str | Path, store_format: str
) -> tuple[Work, str]:
    """Return what computes chunks and writes them, or reads those that are there; and what was mended."""
    found, mended = stores.opened(folder, _contents(plan, some, integrator(plan), store_format))
    return partial(stores.work, found), mended


def _gathered(
    plan: Plan,
    some: Population,
    work: Work,
    threads: int,
    client: Any,
    progress: Callable[[float], None] | None,
) -> Gathered:
    """Give out all chunks, and put together what comes back."""
    gathered = Gathered(plan, some.count)
    crew = (
        Threads(plan, some, work, threads) if client is None else Cluster(plan, some, work, client)
    )
    with crew:
        for piece in pieces(crew, iter(range(-(-some.count // plan.chunk)))):
            gathered.take(piece)
            if progress is not None:
                progress(gathered.done / some.count)
    return gathered


def _shared(
    compiled: Compiled,
    t_span: tuple[float, float],
    inputs: Mapping[str, float],
    rtol: float,
    atol: ArrayLike | None,
    t_eval: ArrayLike | None,
    max_step: float,
    max_steps: int,
    margin: float,
) -> Shared:
    span = span_of(t_span)
    names = names_of(compiled.layout.inputs)
    laws = sampled.laws_of(compiled, {})
    sampled.check_laws(laws, span)
    return Shared(
        t_span=span,
        inputs=to_array(compiled.structure.without("input", inputs), names, "input"),
        rtol=relative(rtol),
        atol=None if atol is None else tolerances_of(atol, len(compiled.layout.states)),
        margin=positive(margin, "margin"),
        t_eval=grid_of(span[1:] if t_eval is None else t_eval, span),
        max_step=positive(max_step, "max_step"),
        max_steps=min(_whole(max_steps, "max_steps"), 2**31 - 1),
        laws=laws,
    )


def _whole(value: int, name: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise InputError(f"{name} is not a positive whole number", got=value)
    return value


def _statistics(compiled: Compiled, asked: Statistics | Sequence[str]) -> Statistics:
    found = asked if isinstance(asked, Statistics) else Statistics(tuple(asked))
    known = (*names_of(compiled.layout.states), *compiled.layout.results[OUTPUTS])
    for name in found.names:
        if name not in known:
            raise unknown_name("state or output", name, known, "statistics")
    return found


def _chunk(asked: int | None, count: int, shared: Shared, compiled: Compiled) -> int:
    """Return the trajectories of a chunk: whole blocks, so that statistics do not depend on it."""
    if asked is None:
        results = compiled.layout.results
        rows = len(compiled.layout.states) + len(results[OUTPUTS])
        bytes_each = 8 * (2 * rows * len(shared.t_eval) + len(results[INVARIANTS]) + rows)
        asked = max(1, min(LARGEST_CHUNK, CHUNK_BYTES // bytes_each, count // CHUNKS))
    return -(-_whole(asked, "chunk") // BLOCK) * BLOCK


def size_of_one(compiled: Compiled, times: int) -> int:
    """Return the bytes that one trajectory takes where it is kept, with so many stored ``times``."""
    layout = compiled.layout
    states, rows = len(layout.states), len(layout.states) + len(layout.results[OUTPUTS])
    doubles = rows * times + states + len(layout.results[INVARIANTS]) + 1  # its end, and when
    return 8 * doubles + 4 * len(stores.INTEGERS)


def _refuse_what_does_not_fit(plan: Plan, count: int, threads: int) -> None:
    """Raise `InputError` where what is kept, or the chunks at work, cannot fit into memory.

    ``threads``: at work in this process. What is counted alone takes no room that grows with ``count``.
    """
    layout, times = plan.compiled.layout, len(plan.shared.t_eval)
    each, chunk = size_of_one(plan.compiled, times), min(plan.chunk, count)
    copies = 8 * times * (len(layout.states) + 2 * len(plan.statistics.names))
    parallel = min(threads, -(-count // chunk))
    working = parallel * chunk * (each + copies)
    kept = count * each if plan.columns else 0
    free = available()
    if working + kept <= free:
        return
    most, parts = int((free - working) // each), [f"{parallel} chunks of {chunk:,} at work"]
    if kept:
        parts.append(f"{count:,} that are kept, {each:,} bytes each")
    raise InputError(
        "the trajectories do not fit into memory",
        got=f"{working + kept:,} bytes: {' and '.join(parts)}",
        expected=f"at most {int(free):,} bytes" + (f", {most:,} trajectories" if most > 0 else ""),
        hint="keep=False, with statistics or a store"
        if working <= free
        else "a smaller chunk, fewer threads, or fewer times",
    )


def _contents(
    plan: Plan, some: Population, used: fleet.Built, store_format: str
) -> stores.Contents:
    """Return what a store of this ensemble holds."""
    layout, shared = plan.compiled.layout, plan.shared
    rows = {
        "y": names_of(layout.states),
        "outputs": layout.results[OUTPUTS],
        "y_stop": names_of(layout.states),
        "drift": layout.results[INVARIANTS],
    }
    digest = hashlib.sha256(used.text.encode())
    for group in sorted(plan.compiled.files.values()):
        digest.update(group.encode())
    sampler = (
        repr(some.sampler) if isinstance(some.sampler, Sampler) else type(some.sampler).__name__
    )
    digest.update(repr((shared, some.states, some.parameters, sampler)).encode())
    for array in (shared.atol, shared.t_eval, shared.inputs, *some.columns.values()):
        digest.update(b"" if array is None else array.tobytes())
    for first in (0, max(0, some.count - BLOCK)):
        for array in some.draw(first, min(first + BLOCK, some.count)):
            digest.update(array.tobytes())
    return stores.Contents(
        digest.hexdigest(),
        some.count,
        plan.chunk,
        tuple(shared.t_eval.tolist()),
        rows,
        store_format,
    )


def _wound(names: Sequence[str]) -> str:
    """Say of which outputs whole turns are not counted: the stored times are too few for that."""
    return f"{', '.join(names)}: from -pi to pi, without whole turns" if names else ""


def _result(
    gathered: Gathered, seconds: float, store: str | Path | None, notes: Sequence[str]
) -> Ensemble:
    plan, layout = gathered.plan, gathered.plan.compiled.layout
    used = integrator(plan)
    empty = np.empty((2, 0), dtype=np.int64)
    went_on, wound = fleet.continued_notice(gathered.continued), _wound(layout.winds)
    reasons = sorted(gathered.reasons.items(), key=lambda item: list(fleet.STATUS).index(item[0]))
    return Ensemble(
        count=gathered.total,
        t=plan.shared.t_eval,
        counts={fleet.STATUS[number]: count for number, count in reasons},
        stopped=gathered.stopped[0] if gathered.stopped else empty,
        statistics=gathered.statistics(),
        drift=gathered.drift(),
        columns=gathered.columns,
        names=names_of(layout.states),
        outputs=layout.results[OUTPUTS],
        method=used.method,
        notice="; ".join(filter(None, (plan.compiled.notice, used.notice, went_on, wound, *notes))),
        steps=gathered.steps,
        computed=gathered.computed,
        seconds=seconds,
        store=None if store is None else Path(store),
    )


A_WORKER = 3
"""Chunks that are given out for each worker."""

Work = Callable[[Plan, Population, int], Piece]


class Crew(Protocol):
    """Takes tasks and gives back what is done, in any order."""

    window: int

    def submit(self, number: int) -> Any:
        """Give out a chunk."""

    def finished(self, futures: Sequence[Any]) -> tuple[list[Any], list[Any]]:
        """Wait until one is done at least; return those that are, and the others."""


def pieces(crew: Crew, numbers: Iterator[int]) -> Iterator[Piece]:
    """Yield what the crew made of the chunks, in the order in which they are done."""
    pending = [crew.submit(k) for k in islice(numbers, crew.window)]
    while pending:
        done, pending = crew.finished(pending)
        for future in done:
            yield future.result()
        pending += [crew.submit(k) for k in islice(numbers, crew.window - len(pending))]


class Threads(AbstractContextManager["Threads"]):
    """Threads of this process; C code runs in them at the same time."""

    def __init__(self, plan: Plan, population: Population, work: Work, threads: int) -> None:
        self.window = A_WORKER * threads
        self._task = (plan, population, work)
        self._flag = Flag()
        self._pool = ThreadPoolExecutor(threads, "eom-ensemble", obey, (self._flag,))

    def submit(self, number: int) -> Any:
        """Give out a chunk."""
        plan, population, work = self._task
        return self._pool.submit(work, plan, population, number)

    def finished(self, futures: Sequence[Any]) -> tuple[list[Any], list[Any]]:
        """Wait until one is done at least."""
        done, _ = wait(futures, return_when=FIRST_COMPLETED)
        return [f for f in futures if f in done], [f for f in futures if f not in done]

    def __exit__(self, *_: object) -> None:
        """Forget what was not begun, end what was: after an interruption nothing of it is wanted."""
        self._flag.set()
        self._pool.shutdown(wait=True, cancel_futures=True)


@dataclass(frozen=True)
class _Packed:
    """A plan and its work as bytes: a worker that has them unpacked takes those."""

    data: bytes
    digest: str


@lru_cache(maxsize=4)
def _unpacked(packed: _Packed) -> tuple[Plan, Work]:
    plan, work = pickle.loads(packed.data)  # noqa: S301 - from the client of this very cluster
    return plan, work


def _on_worker(packed: _Packed, some: Population, number: int) -> Piece:
    plan, work = _unpacked(packed)
    return work(plan, some, number)


class Cluster(AbstractContextManager["Cluster"]):
    """A cluster by `dask.distributed`, which gives the chunk of a worker that dies to another."""

    def __init__(self, plan: Plan, population: Population, work: Work, client: Any) -> None:
        self._client = _checked(client)
        threads = sum(self._client.nthreads().values())
        self.window = A_WORKER * max(1, threads)
        data = pickle.dumps((plan, work))
        self._packed = _Packed(data, hashlib.sha256(data).hexdigest())
        self._population, self._chunk = population, plan.chunk
        self._run = os.urandom(8).hex()
        self._given: set[Any] = set()

    def submit(self, number: int) -> Any:
        """Give out a chunk with its own samples alone."""
        first = number * self._chunk
        last = min(first + self._chunk, self._population.count)
        some = self._population.part(first, last)
        key = f"eom-ensemble-{self._run}-{number}"
        future = self._client.submit(_on_worker, self._packed, some, number, key=key, pure=False)
        self._given.add(future)
        return future

    def finished(self, futures: Sequence[Any]) -> tuple[list[Any], list[Any]]:
        """Wait until one is done at least."""
        import distributed

        untyped: Any = distributed
        done = untyped.wait(futures, return_when="FIRST_COMPLETED").done
        self._given -= done
        return [f for f in futures if f in done], [f for f in futures if f not in done]

    def __exit__(self, *_: object) -> None:
        """Forget what is not needed any more."""
        self._client.cancel(list(self._given))


def _checked(client: Any) -> Any:
    """Return the client. Raises `InputError` where it is none, or there is no such package."""
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            "a cluster needs dask.distributed", hint="pip install 'eom-toolkit[cluster]'"
        ) from None
    if not isinstance(client, Client):
        raise InputError("not a client of dask.distributed", got=type(client).__name__)
    return client


BINS_TOGETHER = 64
"""Bins are joined when so many parts have come."""


@dataclass
class Gathered:
    """Columns of all trajectories, if they are wanted, and everything that is counted."""

    plan: Plan
    total: int
    columns: dict[str, NDArray[Any]] = field(default_factory=dict)
    trees: dict[str, Tree] = field(default_factory=dict)
    bins: list[Bins] = field(default_factory=list)
    histograms: dict[str, Counts] = field(default_factory=dict)
    reasons: Counter[int] = field(default_factory=Counter)
    continued: Counter[int] = field(default_factory=Counter)
    stopped: list[NDArray[np.int64]] = field(default_factory=list)
    steps: int = 0
    done: int = 0
    computed: int = 0

    def take(self, piece: Piece) -> None:
        """Add a piece."""
        for name, values in piece.columns.items():
            self._column(name, values)[..., piece.first : piece.first + values.shape[-1]] = values
        tallies = piece.tallies
        for name, nodes in tallies.nodes.items():
            tree = self.trees.setdefault(name, Tree())
            for (level, place), value in nodes.items():
                tree.add(level, place, value)
        for name, counts in tallies.histograms.items():
            self.histograms[name] = self.histograms.get(name, np.zeros_like(counts)) + counts
        if tallies.bins is not None:
            self.bins.append(tallies.bins)
            if len(self.bins) >= BINS_TOGETHER:
                self.bins = [Bins.joined(self.bins)]
        self._stop(tallies.stopped)
        self.reasons.update(tallies.reasons)
        self.continued.update(tallies.continued)
        self.steps += tallies.steps
        self.done += tallies.count
        self.computed += piece.computed

    def _column(self, name: str, values: NDArray[Any]) -> NDArray[Any]:
        if name not in self.columns:
            shape = (*values.shape[:-1], self.total)
            try:
                self.columns[name] = np.empty(shape, dtype=values.dtype)
            except MemoryError:
                raise InputError(
                    "the trajectories do not fit into memory",
                    got=f"{self.total:,} trajectories, {name} of shape {shape}",
                    hint="keep=False, with statistics or a store",
                ) from None
        return self.columns[name]

    def _stop(self, rows: NDArray[np.int64]) -> None:
        """Keep the first trajectories that did not reach the end."""
        if rows.shape[1]:
            joined = np.concatenate([*self.stopped, rows], axis=1)
            self.stopped = [joined[:, np.argsort(joined[0])[:MOST_LISTED]]]

    def statistics(self) -> dict[str, Summary]:
        """Return the statistics of states and outputs by name."""
        asked, times = self.plan.statistics, self.plan.shared.t_eval
        if VALUES not in self.trees:
            return {}
        moments = self.trees[VALUES].total()
        bins = Bins.joined(self.bins) if self.bins else None
        found = {}
        for k, name in enumerate(asked.names):
            rows = (k * len(times), (k + 1) * len(times))
            edges = np.array(asked.edges[name], dtype=float) if name in asked.edges else None
            counts = self.histograms.get(name)
            found[name] = summary(name, times, moments, rows, bins, edges, counts)
        return found

    def drift(self) -> Mapping[str, Summary]:
        """Return the statistics of the relative drift of each constant of the motion."""
        if DRIFT not in self.trees:
            return {}
        moments = self.trees[DRIFT].total()
        end = np.array(self.plan.shared.t_span[1:])
        names = self.plan.compiled.layout.results[INVARIANTS]
        return {n: summary(n, end, moments, (k, k + 1)) for k, n in enumerate(names)}


PROCESS, GROUPS = Path("/proc"), Path("/sys/fs/cgroup")
LIMITS = {
    "": ("memory.max", "memory.current", "inactive_file"),
    "memory": ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
}
"""Of groups of processes, by the name of their controller in versions 2 and 1 of Linux: files of the limit
and of the use, and what of the use can be given up, in memory.stat."""


def available() -> float:
    """Return the bytes that this process can still have, swap among them; infinity where nothing says."""
    return max(0.0, min((*_machine(), *_groups(), *_own()), default=math.inf))


def _machine() -> Iterator[float]:
    """Yield what is free in the machine, or else all that it has."""
    try:
        rows = _rows(PROCESS / "meminfo")
        yield 1024 * (rows["MemAvailable:"] + rows.get("SwapFree:", 0))
    except (OSError, ValueError, KeyError):
        with suppress(AttributeError, ValueError, OSError):  # of a system without such a number
            yield os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def _rows(file: Path) -> dict[str, int]:
    """Return a table of names and numbers."""
    words = (line.split() for line in file.read_text(encoding="ascii").splitlines())
    return {row[0]: int(row[1]) for row in words if len(row) > 1}


def _groups() -> Iterator[float]:
    """Yield what is left of the limits of the groups that the process is in."""
    with suppress(OSError):
        for line in (PROCESS / "self" / "cgroup").read_text(encoding="utf-8").splitlines():
            _, controllers, place = line.split(":", 2)
            for name in {*controllers.split(",")} & LIMITS.keys():
                for folder in (GROUPS / name / place.strip("/"), GROUPS / name):
                    limit, use, freed = LIMITS[name]
                    with suppress(OSError, ValueError, KeyError):  # no such file, or no limit
                        most = int((folder / limit).read_text())
                        used = int((folder / use).read_text())
                        yield most - used + _rows(folder / "memory.stat")[freed]


def _own() -> Iterator[float]:
    """Yield what is left of the limit of the process itself."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        most, _ = resource.getrlimit(resource.RLIMIT_AS)
        if most != resource.RLIM_INFINITY:
            pages = int((PROCESS / "self" / "statm").read_text().split()[0])
            yield most - pages * resource.getpagesize()
