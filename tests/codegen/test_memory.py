"""What cannot fit into memory is refused before a run; what is counted alone has no bound."""

import re
import subprocess
import sys

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen import Grid, Sampler, Uniform
from codegen.ensembles import ensemble as memory
from codegen.ensembles.ensemble import size_of_one
from eom.errors import InputError
from eom.system import System

x, v = sp.symbols("x v", real=True)
SYSTEM = System.from_rates(
    "oscillator", {x: v, v: -x}, outputs={"sum": x + v}, invariants={"H": x**2 + v**2}
)
COMPILED = codegen.compile(SYSTEM, "numpy")
TIMES = [0.5, 0.75, 1.0]


class Begun(Exception):
    """The run has begun."""


def run(count, progress=None, **options):
    sampler = Sampler({"x": Uniform(1, 2), "v": 0.0}, count, 1)
    return codegen.ensemble(
        COMPILED, sampler, (0, 1), rtol=1e-2, atol=1e-2, t_eval=TIMES, progress=progress, **options
    )


def test_the_bytes_that_are_reported_are_those_of_the_columns():
    found = run(20)
    size = sum(column.nbytes for column in found.columns.values())
    assert size == 20 * size_of_one(COMPILED, len(TIMES))


def test_what_is_kept_is_refused_where_it_does_not_fit_before_anything_is_integrated(monkeypatch):
    """The count that the error gives fits, one more does not."""
    monkeypatch.setattr(memory, "available", lambda: 1e6)
    options = {"chunk": 256, "threads": 1}
    with pytest.raises(InputError, match="do not fit into memory") as caught:
        run(20_000, progress=lambda share: pytest.fail("begun"), **options)
    reported = caught.value
    each = size_of_one(COMPILED, len(TIMES))
    assert f"20,000 that are kept, {each} bytes each" in reported.got
    assert "1,000,000 bytes" in reported.expected
    assert "keep=False" in reported.hint
    most = int(re.search(r"([\d,]+) trajectories", reported.expected)[1].replace(",", ""))
    assert 1e6 / each / 2 < most < 1e6 / each
    with pytest.raises(InputError, match="do not fit into memory"):
        run(most + 1, **options)

    def begun(share):
        raise Begun

    with pytest.raises(Begun):
        run(most, progress=begun, **options)


def test_no_machine_keeps_so_many():
    with pytest.raises(InputError, match="do not fit into memory"):
        run(10**14)


@pytest.mark.parametrize("kind", ["statistics", "store"])
def test_what_is_not_kept_has_no_bound(kind, monkeypatch, tmp_path):
    """A hundred million trajectories and many more begin."""
    monkeypatch.setattr(memory, "available", lambda: 1e6)

    def begun(share):
        raise Begun

    options = {"statistics": ["x"], "keep": False} if kind == "statistics" else {"store": tmp_path}
    count = 10**18 if kind == "statistics" else 10**8
    with pytest.raises(Begun):
        run(count, progress=begun, chunk=256, threads=1, **options)


def test_chunks_at_work_must_fit(monkeypatch):
    """Many threads, or a large chunk, take more; the hint is about these."""
    monkeypatch.setattr(memory, "available", lambda: 1e6)
    for options in ({"chunk": 256, "threads": 64}, {"chunk": 10**6, "threads": 1}):
        with pytest.raises(InputError, match="do not fit into memory") as caught:
            run(10**8, keep=False, statistics=["x"], **options)
        assert "fewer threads" in caught.value.hint
        assert "kept" not in caught.value.got
        assert "trajectories" not in caught.value.expected


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """Files of Linux, with 1000 kB free and no limit; a function writes others."""
    monkeypatch.setattr(memory, "PROCESS", tmp_path / "proc")
    monkeypatch.setattr(memory, "GROUPS", tmp_path / "groups")
    monkeypatch.setattr(memory, "_own", lambda: ())

    def write(**files):
        for name, text in files.items():
            file = tmp_path / name.replace("__", "/").replace("_dot_", ".")
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)

    write(proc__meminfo="MemTotal: 9000 kB\nMemAvailable: 900 kB\nSwapFree: 100 kB\nHugePages: 1\n")
    return write


def test_the_memory_of_a_machine(machine):
    assert memory.available() == 1024 * 1000


@pytest.mark.parametrize(
    ("line", "files"),
    [
        ("0::/job", ("groups__job__", "memory_dot_max", "memory_dot_current", "inactive_file")),
        ("0::/elsewhere", ("groups__", "memory_dot_max", "memory_dot_current", "inactive_file")),
        (
            "9:cpu,cpuacct:/\n4:memory:/job",
            ("groups__memory__job__", "memory_dot_limit_in_bytes", "memory_dot_usage_in_bytes",
             "total_inactive_file"),
        ),
    ],
)  # fmt: skip
def test_the_limit_of_a_group(machine, line, files):
    folder, limit, use, freed = files
    machine(proc__self__cgroup=f"0::/\n{line}\n")
    machine(**{f"{folder}{limit}": "max", f"{folder}{use}": "7000"})
    assert memory.available() == 1024 * 1000
    machine(
        **{f"{folder}{limit}": "10000\n", f"{folder}memory_dot_stat": f"anon 4\n{freed} 2000\n"}
    )
    assert memory.available() == 5000
    machine(**{f"{folder}{limit}": "1000\n"})
    assert memory.available() == 0


def test_a_machine_that_says_nothing_has_all_that_it_has(machine, tmp_path, monkeypatch):
    (tmp_path / "proc" / "meminfo").unlink()
    monkeypatch.setattr(memory.os, "sysconf", lambda name: 100, raising=False)
    assert memory.available() == 10_000
    monkeypatch.delattr(memory.os, "sysconf")
    assert memory.available() == np.inf


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of Linux")
def test_the_limit_of_the_process_itself():
    code = (
        "import resource; from codegen.ensembles import ensemble as memory; before = memory.available();"
        "resource.setrlimit(resource.RLIMIT_AS, (2**32, 2**32)); print(memory.available(), before)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    after, before = map(float, done.stdout.split())
    assert 0 < after < 2**32
    assert after <= before


def test_samplers_have_as_many_samples_as_can_be_counted():
    for values, count in (
        ({"x": 1.0}, 2**63),
        ({"x": Grid(0, 1, 2**40), "v": Grid(0, 1, 2**40)}, 0),
    ):
        with pytest.raises(InputError, match="too many samples"):
            Sampler(values, count)
    assert len(Sampler({"x": 1.0}, 2**63 - 1)) == 2**63 - 1
