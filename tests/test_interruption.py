"""An interruption ends every command at once, with status 130 and one word; nothing is left half-written.

Each run would go on for hours: where it does not heed the interruption, the test waits in vain.
"""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import click
import numpy as np
import pytest
import sympy as sp
from click.testing import CliRunner

import codegen
from codegen.integrate import fleet
from codegen.loops import running
from codegen.native import children, native
from eom.__main__ import main
from eom.system import System

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
in_c = pytest.mark.skipif(not native.compiler(), reason="runs C")
EOM = [sys.executable, "-m", "eom"]
PATIENCE = 30
"""Seconds for what takes less than one on a machine that does nothing else."""


def _heedful():
    """What shells start in the background ignores interruptions, and so would what that starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


ENDED = {130, -signal.SIGINT}
"""Statuses of an interrupted command, 130 in a shell: Python ends itself by the signal, whatever was asked
for, where that came while it ran a text, as the making of a data class does while a command begins."""


def started(words, **environment):
    return subprocess.Popen(
        [*EOM, *map(str, words)], env={**os.environ, **environment},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        preexec_fn=_heedful,  # noqa: PLW1509 - no other thread of the tests runs at that time
    )  # fmt: skip


def waited(found, seconds=PATIENCE):
    """Wait until a function finds something; return that."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if value := found():
            return value
        time.sleep(0.02)
    raise AssertionError("waited in vain")


def interrupted(process, group=False):
    """Interrupt a command, or all processes of its terminal; return what it printed."""
    try:
        (os.killpg if group else os.kill)(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=PATIENCE)
    finally:
        process.poll() is None and os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode in ENDED, (out, err)
    return out, err


@pytest.mark.slow
@in_c
@pytest.mark.parametrize("method", ["auto", "DOP853"])
def test_an_ensemble_ends_in_the_middle_of_a_trajectory_and_its_store_goes_on(tmp_path, method):
    """One chunk of trajectories of some 1e10 steps each: there is no end of a chunk to wait for."""
    store = tmp_path / "runs"
    words = ["ensemble", "t-handle", "--vary", "omega_1=normal(0.05, 0.01)", "--count", 300]
    process = started([*words, "--t-end", 1e10, "--method", method, "--out", store])
    waited(lambda: (store / "manifest").is_dir() and (store / "data.zarr" / "zarr.json").is_file())
    time.sleep(1.0)  # the chunk has begun, or its code is being compiled
    out, err = interrupted(process)
    assert (out, *err.splitlines()[1:]) == ("", "interrupted")
    assert list((store / "manifest").iterdir()) == []
    assert [p for p in store.rglob("*") if p.name.endswith(".tmp")] == []


@in_c
def test_a_flag_ends_a_job_in_c_and_nothing_of_it_is_kept():
    y, v = sp.symbols("y v", real=True)
    compiled = codegen.compile(System.from_rates("oscillator", {y: v, v: -y}), "c")
    one, most = np.ones(1), 2**31 - 1
    for method in ("taylor", "DOP853"):
        built = fleet.build(compiled, method, 1e-9)
        span = (0.0, 1e12)
        shared = fleet.Shared(span, np.empty(0), 1e-9, 1e-12 * np.ones(2), 1e-6, one, 1.0, most)
        flag, ended = children.Flag(), []

        def work(built=built, shared=shared, flag=flag, ended=ended):
            children.obey(flag)
            try:
                built.run(shared, np.ones((2, 9)), np.empty(0))
            except children.Halt:
                ended.append("halt")

        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        thread.join(0.2)
        assert thread.is_alive()
        flag.set()
        thread.join(PATIENCE)
        assert ended == ["halt"]


@in_c
def test_what_ends_an_ensemble_ends_its_other_chunks():
    """The first chunk is short; the second, in another thread, is given up with it."""
    y, w = sp.symbols("y w", real=True)
    turning = codegen.compile(System.from_rates("turning", {y: sp.cos(w * y)}), "c")

    def reported(share):
        raise RuntimeError("enough")

    speeds = np.where(np.arange(512) < 256, 1.0, 1e9)
    with pytest.raises(RuntimeError, match="enough"):
        codegen.ensemble(
            turning, {"y": 0.0}, (0, 1e4), {"w": speeds}, "DOP853", chunk=256, threads=2,
            progress=reported,
        )  # fmt: skip


@pytest.mark.sparse(1)
@in_c
@pytest.mark.parametrize("method", ["DOP853", "taylor", "scipy:Radau"])
def test_one_long_run_ends(method):
    process = started(["simulate", "heavy-top", "--t-end", 1e9, "--method", method])
    time.sleep(2.0)
    assert interrupted(process) == ("", "interrupted\n")


@in_c
def test_calls_of_generated_code_are_cut_by_the_clock_and_numbers_do_not_depend_on_it(monkeypatch):
    y, v = sp.symbols("y v", real=True)
    compiled = codegen.compile(System.from_rates("oscillator", {y: v, v: -sp.sin(y)}), "c")
    for method in ("DOP853", "taylor"):
        for most in (10_000_000, 23):
            found = set()
            for seconds, call in ((1e9, 50_000), (0.0, 50_000), (1e9, 3)):
                monkeypatch.setattr(running, "CALL_SECONDS", seconds)
                monkeypatch.setattr(running, "STEPS_A_CALL", call)
                run = codegen.simulate(compiled, [1, 0], (0, 300), method=method, max_steps=most)
                found.add((run.t.tobytes(), run.y.tobytes(), run.steps, run.rejected, run.status))
            assert len(found) == 1
    assert running._next_call(800, 2 * running.CALL_SECONDS + 1e9) == 400
    assert running._next_call(1, 1e10) == 1


def gone(pid):
    stat = Path(f"/proc/{pid}/stat")
    try:
        return stat.read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


needs_proc = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")


@pytest.mark.slow
@needs_proc
def test_a_compiler_ends_with_its_children_and_the_cache_is_clean(tmp_path):
    """What the driver of a compiler starts outlives it unless somebody looks after that."""
    compiler, note, cache = tmp_path / "cc", tmp_path / "pid", tmp_path / "cache"
    compiler.write_text(
        f"#!/bin/sh\nsleep 1000 &\necho $! > {note}.tmp; mv {note}.tmp {note}\nwait\n"
    )
    compiler.chmod(0o755)
    process = started(["simulate", "t-handle"], CC=str(compiler), EOM_CACHE_DIR=str(cache))
    pid = int(waited(lambda: note.is_file() and note.read_text()))
    assert interrupted(process) == ("", "interrupted\n")
    waited(lambda: gone(pid))
    assert list(cache.iterdir()) == []


@needs_proc
def test_a_child_that_takes_too_long_ends_with_its_children(tmp_path):
    note = tmp_path / "pid"
    command = ["sh", "-c", f"trap '' INT; sleep 1000 & echo $! > {note}; wait"]
    with pytest.raises(subprocess.TimeoutExpired):
        children.finished(command, seconds=0.5)
    waited(lambda: gone(int(note.read_text())))


def test_an_interruption_while_a_class_is_made_is_one(monkeypatch):
    """Python before 3.12 wraps what an attribute raises that is given its name."""

    class Interrupting:
        def __set_name__(self, owner, name):
            raise KeyboardInterrupt

    def make(self, ctx):
        type("Made", (), {"attribute": Interrupting()})

    monkeypatch.setattr(click.Group, "invoke", make)
    done = CliRunner().invoke(main, ["list"])
    assert (done.exit_code, done.output) == (130, "interrupted\n")


@pytest.mark.slow
def test_many_notes_end_with_the_processes_that_check_them(tmp_path):
    """The terminal interrupts every process: those that load their modules say nothing of it."""
    for k in range(40):
        (tmp_path / f"{k}.md").write_text("$\\vec H_C = I_C \\vec\\omega$\n" * 300)
    process = started(["check", tmp_path, "--jobs", 2, "--notation", "arrow-tilde"])
    time.sleep(1.5)
    assert interrupted(process, group=True) == ("", "interrupted\n")


@pytest.mark.slow
@needs_proc
def test_foreign_code_ends_with_what_it_has_started(tmp_path):
    note, code = tmp_path / "pid", tmp_path / "code.py"
    code.write_text(
        "import os, time\nif not os.fork():\n    os.setsid()\n"
        f"    open({str(note)!r}, 'w').write(os.readlink('/proc/self'))\n    time.sleep(60)\n"
        "time.sleep(60)\n"
    )
    process = started(["check", "--code", f"{code}:f", "--system", "t-handle"])
    pid = int(waited(lambda: note.is_file() and note.read_text()))
    assert interrupted(process) == ("", "interrupted\n")
    assert gone(pid)
