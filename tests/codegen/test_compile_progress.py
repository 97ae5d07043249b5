"""What is reported of a compilation: stages in order, shares that grow, and what a listener may do."""

import contextlib
import subprocess

import pytest
import sympy as sp

import codegen
from codegen.frontend import lower
from codegen.ir import compile_progress
from codegen.ir.compile_progress import EVERY, STAGES, STEP
from codegen.native import native
from eom.errors import InputError
from eom.system import System

x, y, a, b = sp.symbols("x y a b", real=True)
in_c = pytest.mark.skipif(not native.compiler(), reason="runs C")


def long_system(terms):
    """A rate of many different terms, which share nothing."""
    total = sp.Add(
        *(sp.sin((k + 2) * x + a) * (x * y + b * sp.Integer(k) + 3) for k in range(terms))
    )
    return System.from_rates(f"long_{terms}", {x: total, y: x})


def reports_of(system, target, **options):
    reports = []
    made = codegen.compile(
        system, target, progress=lambda stage, share: reports.append((stage, share)), **options
    )
    return made, reports


@pytest.mark.parametrize("target", ["numpy", "python", pytest.param("c", marks=in_c)])
def test_stages_come_in_order_and_their_shares_grow(target):
    _, reports = reports_of(long_system(20), target)
    stages = [stage for stage, _ in reports]
    assert tuple(dict.fromkeys(stages)) == STAGES
    assert stages == sorted(stages, key=STAGES.index)
    for stage in STAGES:
        shares = [share for name, share in reports if name == stage]
        assert shares[0] == 0.0
        assert shares[-1] == 1.0
        assert shares == sorted(shares)


@pytest.mark.slow
def test_long_stages_are_reported_as_the_work_goes_on():
    """By shares in steps of a hundredth, and by calls alone where no share is known."""
    _, reports = reports_of(long_system(400), "python")
    for stage in ("lowering", "stable forms", "text"):
        shares = [share for name, share in reports if name == stage]
        assert len(set(shares)) > 50, stage
        assert len(shares) <= 2 / STEP
    passes = [share for stage, share in reports if stage == "passes"]
    assert len(passes) > len(set(passes)) > 5


def test_reports_are_bounded_by_the_work(monkeypatch):
    calls = []
    original = compile_progress._Listening.go_on
    monkeypatch.setattr(
        compile_progress._Listening,
        "go_on",
        lambda self, units: calls.append(original(self, units)),
    )
    _, reports = reports_of(long_system(300), "python")
    assert len(reports) <= len(STAGES) * (2 + 1 / STEP) + len(calls) / EVERY


def test_without_a_listener_nothing_is_counted_and_code_is_the_same(monkeypatch):
    system = long_system(20)
    heard, _ = reports_of(system, "python", stable=True)
    monkeypatch.setattr(lower, "nodes", None)
    monkeypatch.setattr("codegen.passes.pipeline.nodes", None)
    monkeypatch.setattr(compile_progress, "_Listening", None)
    assert codegen.compile(system, "python", stable=True).files == heard.files


def test_a_listener_may_compile_itself():
    """That is not reported to it, nor is what it compiles to somebody else."""
    stages = []

    def report(stage, share):
        stages.append(stage)
        codegen.compile(System.from_rates("other", {y: y**2}), "python")

    codegen.compile(System.from_rates("one", {x: sp.sin(x)}), "python", progress=report)
    assert tuple(dict.fromkeys(stages)) == STAGES
    assert stages == sorted(stages, key=STAGES.index)


RAISED = (KeyboardInterrupt, TimeoutError, native.CompilerError, InputError, AssertionError)


@pytest.mark.sparse(8)
@in_c
@pytest.mark.parametrize("stage", STAGES)
@pytest.mark.parametrize("kind", RAISED)
def test_what_a_listener_raises_comes_out_and_nothing_is_kept(stage, kind, tmp_path, monkeypatch):
    """Also what those on the way handle as errors of their own: no other target goes on."""
    monkeypatch.setenv(native.CACHE_VARIABLE, str(tmp_path))
    reason = kind("enough")

    def report(name, share):
        if name == stage:
            raise reason

    system = long_system(5)
    with pytest.raises(kind) as caught:
        codegen.compile(system, "auto", progress=report)
    assert caught.value is reason
    assert list(tmp_path.iterdir()) == []
    assert reports_of(system, "c")[1][-1] == ("compiler", 1.0)


@in_c
def test_a_compiler_that_takes_long_is_reported_and_ends_with_the_listener(tmp_path, monkeypatch):
    """A listener that gives up ends the process, and the cache stays as it was."""
    compiler, cache = tmp_path / "cc", tmp_path / "cache"
    compiler.write_text("#!/bin/sh\nsleep 1000\n")
    compiler.chmod(0o755)
    monkeypatch.setenv("CC", str(compiler))
    monkeypatch.setenv(native.CACHE_VARIABLE, str(cache))
    monkeypatch.setattr("codegen.native.children.HEARD_SECONDS", 0.01)
    started, popen = [], subprocess.Popen

    def start(*words, **options):
        started.append(popen(*words, **options))
        return started[-1]

    monkeypatch.setattr(subprocess, "Popen", start)
    reports = []

    def report(stage, share):
        reports.append((stage, share))
        if reports.count(("compiler", 0.0)) == 4:
            raise TimeoutError

    with pytest.raises(TimeoutError):
        codegen.compile(long_system(3), "auto", progress=report)
    assert reports[-4:] == [("compiler", 0.0)] * 4
    assert [process.returncode is None for process in started] == [False]
    assert list(cache.iterdir()) == []


def test_a_target_that_goes_on_with_another_reports_it(monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    made, reports = reports_of(long_system(3), "auto")
    assert made.target == "numpy"
    stages = [stage for k, (stage, _) in enumerate(reports) if k == 0 or reports[k - 1][0] != stage]
    assert stages == [*STAGES, *STAGES[-2:]]


@pytest.mark.parametrize("progress", [1, "x", lambda share: None])
def test_what_cannot_be_reported_is_refused(progress):
    with pytest.raises(InputError, match="progress is of the wrong type"):
        codegen.compile(long_system(1), "python", progress=progress)


def test_a_listener_inside_takes_the_place_of_one_outside():
    outer, inner = [], []
    with (
        compile_progress.to(lambda *reports: outer.append(reports)),
        compile_progress.stage("outer"),
    ):
        with (
            compile_progress.to(lambda *reports: inner.append(reports)),
            compile_progress.stage("inner"),
        ):
            compile_progress.done(1)
        with (
            contextlib.suppress(ZeroDivisionError),
            compile_progress.to(None),
            compile_progress.stage("none"),
        ):
            compile_progress.beat()
            raise ZeroDivisionError
    assert outer == [("outer", 0.0), ("outer", 1.0)]
    assert inner == [("inner", 0.0), ("inner", 1.0), ("inner", 1.0)]
