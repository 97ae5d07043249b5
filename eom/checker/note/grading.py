"""Many notes at once: each is checked in a worker process, which may take its time, crash or hang alone.

A worker that dies, or exceeds the time for a note, leaves an error in place of the report and is
replaced. Results come in the order of the notes, whatever the number of workers.
"""

from __future__ import annotations

import multiprocessing as mp
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from time import monotonic
from typing import Any

from eom.checker.read.documents import Note, name_of, note_of, notes_of
from eom.checker.read.spans import printable
from eom.checker.report.findings import Graded, Settings
from eom.errors import InputError, typed
from eom.interrupts import not_interrupted
from eom.worlds.worlds import closure

GRACE_SECONDS = 5.0
"""What a worker may take, by the clock, beyond twice the time for a note before it is ended."""
START_SECONDS = 120.0
MEMORY = 4 * 2**30
"""Bytes that a worker may map, where the system can limit them."""

Progress = Callable[[float], None]


@typed
def check_files(
    notes: Iterable[str | Path],
    settings: Settings | None = None,
    workers: int = 0,
    progress: Progress = lambda _: None,
) -> tuple[Graded, ...]:
    r"""Return what became of each note, in order; folders stand for the notes in them.

    Parameters
    ----------
    notes : iterable of str or path
        As `eom.check` takes them; a folder stands for the notes in it.
    settings : Settings, optional
        How notes are read and how long each may take, as `eom.check` says.
    workers : int, default 0
        Processes, 0 for as many as there are cores.
    progress : Progress, optional
        Called with the fraction that is done, from 0 to 1.

    Returns
    -------
    tuple of Graded
        What became of each note, in order. A note that cannot be read has an error in place of a
        report.

    Raises
    ------
    InputError
        For settings that cannot be used, a folder with too many notes, where no worker can be
        started, and for fewer workers than none.

    Examples
    --------
    >>> graded = check_files([r"\vec H_C = I_C \vec\omega"], Settings("arrow-tilde"), workers=1)
    >>> [(one.status, one.report.counts) for one in graded]
    [('nothing wrong', {'holds under': 1})]
    """
    return check_notes([note_of(n) for n in notes], settings or Settings(), workers, progress)


def check_notes(
    notes: Iterable[Note], settings: Settings, workers: int = 0, progress: Progress = lambda _: None
) -> tuple[Graded, ...]:
    """Return what became of each note, as `check_files`."""
    closure(settings.given)
    if workers < 0:
        raise InputError("unusable number of workers", got=workers, expected="0 or more")
    jobs = notes_of(notes)
    count = min(workers or os.cpu_count() or 1, len(jobs))
    results: dict[int, Graded] = {}
    with _crew(count, settings) as crew:
        for number, graded in _graded(crew, jobs, settings):
            results[number] = graded
            progress(len(results) / len(jobs))
    return tuple(results[n] for n in range(len(jobs)))


# -- workers -------------------------------------------------------------------------------------


def _patience(settings: Settings) -> float:
    """Return how long a note may take by the clock, its own limit being one of processor time."""
    return 2 * settings.note_seconds + GRACE_SECONDS


@dataclass
class _Worker:
    """A process with the way to it, and the number of the note that it has, from when on."""

    process: Any
    pipe: Connection
    number: int = -1
    ends: float = field(default_factory=lambda: monotonic() + START_SECONDS)
    ready: bool = False


def _started(settings: Settings) -> _Worker:
    context = mp.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(theirs, settings), daemon=True)
    with not_interrupted():
        process.start()
    theirs.close()
    return _Worker(process, ours)


def _stopped(worker: _Worker) -> None:
    worker.process.kill()
    worker.process.join()
    worker.pipe.close()


@contextmanager
def _crew(count: int, settings: Settings) -> Iterator[list[_Worker]]:
    """Give workers, and end whichever are there afterwards."""
    crew: list[_Worker] = []
    try:
        with not_interrupted():  # one that is started is among those that are ended
            for _ in range(count):
                crew.append(_started(settings))  # noqa: PERF401 - each at once
        yield crew
    finally:
        for worker in crew:
            _stopped(worker)


def _graded(
    crew: list[_Worker], jobs: Sequence[Note], settings: Settings
) -> Iterator[tuple[int, Graded]]:
    """Yield numbers and results as they come; every idle worker gets the next note."""
    waiting = list(range(len(jobs)))[::-1]
    while waiting or any(w.number >= 0 for w in crew):
        now = monotonic()
        busy = [w for w in crew if w.number >= 0 or not w.ready]
        heard = wait([w.pipe for w in busy], max(0.0, min(w.ends for w in busy) - now))
        for k, worker in enumerate(crew):
            if worker.pipe in heard:
                answer = _answer(worker)
            elif worker in busy and monotonic() > worker.ends:
                answer = f"no answer within {_patience(settings):g} s"
            else:
                continue
            if worker.number >= 0:
                yield worker.number, _result(jobs[worker.number], answer)
                worker.number = -1
            if isinstance(answer, str):
                crew[k] = _replaced(worker, settings)
            _give(crew[k], waiting, jobs, settings)


def _give(worker: _Worker, waiting: list[int], jobs: Sequence[Note], settings: Settings) -> None:
    """Give an idle worker the next note, if there is one."""
    if worker.ready and waiting:
        worker.number = waiting.pop()
        worker.ends = monotonic() + _patience(settings)
        with suppress(OSError):  # it has died: its pipe shows it
            worker.pipe.send(jobs[worker.number])


def _answer(worker: _Worker) -> Graded | str | None:
    """Return what a worker says: a result, None for being ready; words where it has died."""
    try:
        answer: Graded | None = worker.pipe.recv()
    except (EOFError, OSError):
        worker.process.join()
        return f"the process that checked this died (status {worker.process.exitcode})"
    worker.ready = True
    return answer


def _replaced(worker: _Worker, settings: Settings) -> _Worker:
    """Return a new worker. Raises `InputError` where the old one never got ready."""
    _stopped(worker)
    if not worker.ready:
        raise InputError(
            "no process for checking can be started",
            hint="a script calls this under: if __name__ == '__main__'",
        )
    return _started(settings)


def _result(note: Note, answer: Graded | str | None) -> Graded:
    name = printable(name_of(note))
    return answer if isinstance(answer, Graded) else Graded(name, None, str(answer))


def _work(pipe: Connection, settings: Settings) -> None:
    """Check notes by name until there are no more; runs in a process of its own."""
    from eom.checker.note.checking import grade

    _limit_memory()
    try:
        pipe.send(None)
        while True:
            pipe.send(grade(pipe.recv(), settings))
    except (EOFError, OSError, KeyboardInterrupt):
        return


def _limit_memory() -> None:
    """Limit what this process maps, where the system can."""
    try:
        import resource
    except ImportError:
        return
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    limit = MEMORY if most == resource.RLIM_INFINITY else min(MEMORY, most)
    resource.setrlimit(resource.RLIMIT_AS, (limit, most))
