"""Who does the chunks of an ensemble: threads of this process, or a Dask cluster.

Chunks are given out through a window of a few for each worker, so that memory does not grow with the
number of trajectories.
"""

from __future__ import annotations

import hashlib
import os
import pickle
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from typing import Any, Protocol

from codegen.ensembles.chunks import Piece, Plan
from codegen.ensembles.samples import Population
from codegen.native.halting import Flag, obey
from eom.errors import InputError

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
