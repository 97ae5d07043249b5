"""The edge to the compiler: without one, with one that fails, with a damaged or open cache."""

import ctypes
import errno
import os
import stat
import subprocess
import sys

import numpy as np
import pytest

import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.native import native
from eom.errors import InputError
from eom.opening import load_scene

pytestmark = pytest.mark.shipped_flags

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="tests C itself")
SOURCE = "double twice(double a);\ndouble twice(double a) { return 2.0 * a; }\n"


@pytest.fixture
def cache(tmp_path, monkeypatch):
    folder = tmp_path / "cache"
    folder.mkdir(mode=0o700)
    monkeypatch.setenv(native.CACHE_VARIABLE, str(folder))
    return folder


def script(path, text):
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return str(path)


def twice(library, value=21.0):
    function = library.twice
    function.argtypes, function.restype = [ctypes.c_double], ctypes.c_double
    return function(value)


def libraries(folder):
    return sorted(p.name for p in folder.iterdir())


# --- no compiler ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "environment",
    [{"CC": "/nowhere/cc"}, {"CC": "", "PATH": ""}, {"CC": "/nowhere/cc -O2", "PATH": ""}],
)
def test_without_a_compiler_c_is_refused_and_auto_takes_numpy(cache, monkeypatch, environment):
    for key, value in environment.items():
        monkeypatch.setenv(key, value)
    monkeypatch.setattr(native, "zig", tuple)
    assert native.compiler() == ()
    with pytest.raises(native.CompilerError, match="no C compiler") as error:
        compile_system(eom.free_rigid_body(), "c")
    assert "numpy" in error.value.hint
    compiled = compile_system(eom.free_rigid_body())
    assert compiled.target == "numpy"
    assert "no C compiler" in compiled.notice
    assert "\n" not in compiled.notice
    result = simulate(compiled, (1.0, 2.0, 3.0), (0, 1), (1.0, 1.2, 1.5))
    assert result.success
    assert result.notice == compiled.notice
    assert libraries(cache) == []


def test_files_of_c_are_generated_without_a_compiler(cache, monkeypatch):
    from codegen.compiling.compiled import generate

    monkeypatch.setenv("CC", "/nowhere/cc")
    compiled = compile_system(eom.free_rigid_body(), "numpy")
    files = generate(compiled.program, compiled.layout, "c")
    assert {"free_rigid_body.h", "free_rigid_body.c", "Makefile"} <= set(files)
    assert all(text.isascii() for text in files.values())


# --- a compiler that fails ----------------------------------------------------------------------------


def test_a_compiler_that_fails_is_quoted_and_leaves_nothing(cache, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", script(tmp_path / "cc", "echo 'licence expired' >&2; exit 1"))
    with pytest.raises(native.CompilerError) as error:
        compile_system(eom.free_rigid_body(), "c")
    assert "licence expired" in error.value.got
    assert "exit status 1" in error.value.got
    assert str(tmp_path / "cc") in error.value.where
    assert libraries(cache) == []
    compiled = compile_system(eom.free_rigid_body())
    assert compiled.target == "numpy"
    assert "the C compiler failed" in compiled.notice


def test_a_compiler_that_makes_no_file_has_failed(cache, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", script(tmp_path / "cc", "exit 0"))
    with pytest.raises(native.CompilerError, match="it made no file"):
        native.compile_library(SOURCE)
    assert libraries(cache) == []


def test_a_compiler_that_hangs_is_stopped(cache, tmp_path, monkeypatch):
    monkeypatch.setattr(native, "TIMEOUT_SECONDS", 0.2)
    monkeypatch.setenv("CC", script(tmp_path / "cc", "while :; do :; done"))
    with pytest.raises(native.CompilerError, match="stopped after"):
        native.compile_library(SOURCE)
    assert libraries(cache) == []


# --- compilers at work beside the process ------------------------------------------------------------


def counting(tmp_path, then):
    return script(tmp_path / "cc", f"echo x >> {tmp_path}/calls\n{then}")


@needs_compiler
def test_what_was_begun_ahead_is_waited_for_and_not_compiled_again(cache, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", counting(tmp_path, f'exec {" ".join(native.compiler())} "$@"'))
    for _ in range(2):
        native.ahead(SOURCE)
    made = native.compile_library(SOURCE)
    assert twice(native.load(made, SOURCE)) == 42.0
    native.ahead(SOURCE)
    assert native.compile_library(SOURCE) == made
    assert (tmp_path / "calls").read_text() == "x\n"
    assert libraries(cache) == [made.parent.name]
    monkeypatch.delenv("CC")
    other = native.compile_library(SOURCE)
    assert other.read_bytes() == made.read_bytes()


@pytest.mark.parametrize("then", ["exit 1", "exit 0", "kill -9 $$"])
def test_what_fails_ahead_is_told_where_it_is_asked_for(cache, tmp_path, monkeypatch, then):
    monkeypatch.setenv("CC", counting(tmp_path, then))
    native.ahead(SOURCE)
    native.ahead("int other;")
    with pytest.raises(native.CompilerError):
        native.compile_library(SOURCE)
    assert libraries(cache) == []
    monkeypatch.setenv("CC", "/nowhere/cc")
    native.ahead(SOURCE)
    assert libraries(cache) == []


def test_what_nobody_asks_for_ends_with_the_process(cache, tmp_path):
    compiler = script(tmp_path / "cc", f"echo $$ > {tmp_path}/number; exec sleep 300")
    code = (
        "import pathlib, time; from codegen.native import native; native.ahead('int a;')\n"
        f"while not pathlib.Path({str(tmp_path / 'number')!r}).exists(): time.sleep(0.01)"
    )
    environment = {**os.environ, "CC": compiler}
    subprocess.run([sys.executable, "-c", code], env=environment, check=True, timeout=100)
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "number").read_text()), 0)
    assert libraries(cache) == []


@needs_compiler
@pytest.mark.parametrize("method", ["taylor", "DOP853", "auto"])
def test_a_first_run_begins_its_loop_beside_its_functions(cache, monkeypatch, method):
    """One compiler after the other, or all at a time: the same numbers; nothing is compiled twice."""
    begun, own = [], native.ahead

    def ahead(source, *rest):
        begun.append(source)
        own(source, *rest)

    monkeypatch.setattr(native, "ahead", ahead)
    pendulum = load_scene("double-pendulum")
    plan = pendulum.initial_values(), (0, 1), pendulum.parameter_values(), method
    found = simulate(pendulum.derive(), *plan)
    count = len(libraries(cache))
    assert (
        len([s for s in begun if f"_{'taylor' if method == 'auto' else method.lower()}_run" in s])
        == 1
    )
    monkeypatch.setattr(native, "ahead", lambda *_: None)
    compiled = compile_system(pendulum.derive())
    again = simulate(compiled, *plan)
    assert (again.t.tobytes(), again.y.tobytes()) == (found.t.tobytes(), found.y.tobytes())
    assert len(libraries(cache)) == count


def test_output_that_is_no_text_does_not_hide_the_failure(cache, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", script(tmp_path / "cc", "printf '\\377\\376 bad' >&2; exit 3"))
    with pytest.raises(native.CompilerError, match="exit status 3"):
        native.compile_library(SOURCE)


def test_a_compiler_that_makes_rubbish_is_refused(cache, tmp_path, monkeypatch):
    text = 'while [ "$1" != -o ]; do shift; done; echo rubbish > "$2"'
    monkeypatch.setenv("CC", script(tmp_path / "cc", text))
    compiled = compile_system(eom.free_rigid_body())
    assert compiled.target == "numpy"
    with pytest.raises(native.CompilerError, match="cannot be loaded"):
        compile_system(eom.free_rigid_body(), "c")
    assert libraries(cache) == []


@needs_compiler
def test_source_that_is_wrong_is_quoted(cache):
    with pytest.raises(native.CompilerError, match="error"):
        native.compile_library("this is no C")
    assert libraries(cache) == []


@needs_compiler
def test_a_compiler_without_the_special_flags_is_used_without_them(cache, tmp_path, monkeypatch):
    command = " ".join(native.compiler())
    refuse = f"""
for a in "$@"; do case "$a" in {"|".join(native.NATIVE_FLAGS)}) exit 1;; esac; done
exec {command} "$@"
"""
    monkeypatch.setenv("CC", script(tmp_path / "cc", refuse))
    assert twice(ctypes.CDLL(str(native.compile_library(SOURCE)))) == 42


@needs_compiler
def test_a_command_with_arguments_and_spaces_is_understood(cache, tmp_path, monkeypatch):
    folder = tmp_path / "a folder"
    folder.mkdir()
    log = tmp_path / "log"
    command = " ".join(native.compiler())
    path = script(folder / "my cc", f'echo "$1" >> {log}; exec {command} "$@"')
    monkeypatch.setenv("CC", f"'{path}' -DOWN=1")
    native.compile_library(SOURCE + "/* spaces */")
    assert log.read_text().splitlines()[0] == "-DOWN=1"


# --- the cache ---------------------------------------------------------------------------------------


@needs_compiler
def test_what_is_in_the_cache_is_not_compiled_again(cache, monkeypatch):
    first = native.compile_library(SOURCE)
    before = first.stat()
    assert native.compile_library(SOURCE) == first
    assert first.stat().st_mtime_ns == before.st_mtime_ns
    assert native.compile_library(SOURCE + " ") != first
    assert native.compile_library(SOURCE, ("-DA=1",)) != first
    assert len(libraries(cache)) == 3


@needs_compiler
def test_another_compiler_does_not_get_the_first_ones_library(cache, tmp_path, monkeypatch):
    first = native.compile_library(SOURCE)
    command = " ".join(native.compiler())
    monkeypatch.setenv("CC", script(tmp_path / "other", f'exec {command} "$@"'))
    assert native.compile_library(SOURCE) != first


@needs_compiler
@pytest.mark.parametrize("rubbish", [b"", b"rubbish", b"\x7fELF" + b"\0" * 100])
def test_a_damaged_library_is_built_anew(cache, rubbish):
    library = native.compile_library(SOURCE)
    library.write_bytes(rubbish)
    assert twice(native.load(library, SOURCE)) == 42
    assert len(libraries(cache)) == 1


CUT = """
import ctypes, os, sys
from codegen.native import native
source, share = sys.stdin.read(), float(sys.argv[1])
library = native.compile_library(source)
whole = library.read_bytes()
os.truncate(library, int(share * len(whole)))
for again in (native.load(library, source), native.load(native.compile_library(source), source)):
    f = again.twice
    f.argtypes, f.restype = [ctypes.c_double], ctypes.c_double
    assert f(4.0) == 8.0
assert library.read_bytes() == whole
"""


@pytest.mark.slow
@needs_compiler
@pytest.mark.parametrize("share", [0.05, 0.3, 0.6, 0.99])
def test_a_library_that_was_cut_off_does_not_end_the_process(cache, share):
    """A page of a mapped file that is not there is a bus error, which no program survives."""
    command = [sys.executable, "-c", CUT, str(share)]
    done = subprocess.run(command, input=SOURCE, text=True, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@needs_compiler
def test_a_library_with_one_wrong_bit_is_built_anew(cache):
    library = native.compile_library(SOURCE)
    whole = library.read_bytes()
    wrong = bytearray(whole)
    wrong[len(wrong) // 2] ^= 1
    library.write_bytes(wrong)
    assert native.compile_library(SOURCE) == library
    assert library.read_bytes() == whole


@needs_compiler
def test_a_library_that_vanished_is_built_anew(cache):
    library = native.compile_library(SOURCE)
    library.unlink()
    assert twice(native.load(library, SOURCE)) == 42


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o722, 0o702])
def test_a_cache_that_others_can_write_is_refused(cache, mode):
    cache.chmod(mode)
    with pytest.raises(InputError, match="others can write") as error:
        native.cache_folder()
    assert "chmod go-w" in error.value.hint


@pytest.mark.parametrize("mode", [0o700, 0o755, 0o750])
def test_a_cache_that_others_can_only_read_is_used(cache, mode):
    cache.chmod(mode)
    assert native.cache_folder() == cache


def test_a_cache_of_another_user_is_refused(cache, monkeypatch):
    monkeypatch.setattr(os, "getuid", lambda: cache.stat().st_uid + 1)
    with pytest.raises(InputError, match="another user"):
        native.cache_folder()


@pytest.fixture(
    params=["a file", "below a file", "nowhere", "not allowed", "full", "cannot be read"]
)
def useless(request, cache, tmp_path, monkeypatch):
    """A cache that cannot be made, written or read, and what the system says of it."""
    (tmp_path / "file").write_text("mine")
    paths = {"a file": tmp_path / "file", "below a file": tmp_path / "file" / "below"}
    monkeypatch.setenv(native.CACHE_VARIABLE, str(paths.get(request.param, cache)))
    if request.param == "nowhere":
        monkeypatch.setenv(native.CACHE_VARIABLE, "/proc/nowhere")
    if request.param == "not allowed":
        monkeypatch.setattr(os, "access", lambda path, mode: False)
    number, call = {
        "full": (errno.ENOSPC, "write_text"),
        "cannot be read": (errno.EIO, "glob"),
    }.get(request.param, (0, ""))
    if call:

        def fails(path, *_, **__):
            raise OSError(number, os.strerror(number), str(path))

        monkeypatch.setattr(native.Path, call, fails)
    return cache


@needs_compiler
def test_where_the_cache_is_useless_c_is_refused_and_auto_takes_numpy(useless):
    with pytest.raises(native.CacheError, match="cannot be kept") as error:
        compile_system(eom.free_rigid_body(), "c")
    assert native.CACHE_VARIABLE in error.value.hint
    compiled = compile_system(eom.free_rigid_body())
    assert compiled.target == "numpy"
    assert error.value.brief in compiled.notice
    assert "\n" not in compiled.notice
    result = simulate(compiled, (1.0, 2.0, 3.0), (0, 1), (1.0, 1.2, 1.5))
    assert result.success
    assert result.notice == compiled.notice
    assert libraries(useless) == []


@pytest.mark.parametrize("command", ["gcc 'x", '"', "gcc -DX='a b"])
def test_a_command_whose_quote_is_not_closed_is_reported(cache, monkeypatch, command):
    monkeypatch.setenv("CC", command)
    assert native.compiler() == ()
    with pytest.raises(native.CompilerError, match="a quote is not closed") as error:
        compile_system(eom.free_rigid_body(), "c")
    assert error.value.got == f"CC={command}"
    compiled = compile_system(eom.free_rigid_body())
    assert compiled.target == "numpy"
    assert "a quote is not closed" in compiled.notice


def test_a_compiler_that_crashes_is_reported_by_its_signal_and_output(cache, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", script(tmp_path / "cc", "echo half >&2; kill -SEGV $$"))
    with pytest.raises(native.CompilerError, match="ended by signal 11") as error:
        native.compile_library(SOURCE)
    assert "half" in error.value.got
    assert "SIGSEGV" in compile_system(eom.free_rigid_body()).notice


def test_a_compiler_that_hangs_is_quoted(cache, tmp_path, monkeypatch):
    monkeypatch.setattr(native, "TIMEOUT_SECONDS", 0.3)
    monkeypatch.setenv("CC", script(tmp_path / "cc", "echo so far >&2; while :; do :; done"))
    with pytest.raises(native.CompilerError) as error:
        native.compile_library(SOURCE)
    assert "so far" in error.value.got


def test_a_cache_is_made_private(tmp_path, monkeypatch):
    monkeypatch.setenv(native.CACHE_VARIABLE, str(tmp_path / "a" / "b"))
    folder = native.cache_folder()
    assert folder == tmp_path / "a" / "b"
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700


@needs_compiler
def test_an_open_cache_is_an_error_and_no_reason_to_use_numpy_silently(cache):
    cache.chmod(0o777)
    with pytest.raises(InputError, match="others can write"):
        compile_system(eom.free_rigid_body("3-1-3"), "c")


RACE = """
import ctypes, sys
from codegen.native import native
source = sys.stdin.read()
library = native.compile_library(source)
f = ctypes.CDLL(str(library)).twice
f.argtypes, f.restype = [ctypes.c_double], ctypes.c_double
print(library, f(4.0))
"""


@pytest.mark.slow
@needs_compiler
def test_processes_that_compile_the_same_at_once_share_one_library(cache):
    runs = [
        subprocess.Popen(
            [sys.executable, "-c", RACE],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for _ in range(4)
    ]
    for run in runs:
        run.stdin.write(SOURCE + "/* race */\n")
        run.stdin.close()
    printed = {run.stdout.read() for run in runs}
    assert [run.wait() for run in runs] == [0] * 4
    for run in runs:
        run.stdout.close()
    assert len(printed) == 1
    assert printed.pop().split()[1] == "8.0"
    assert len(libraries(cache)) == 1


@needs_compiler
def test_with_and_without_the_quick_way_results_are_the_same(monkeypatch):
    from codegen.native import native as fastcall

    quick = compile_system(eom.free_rigid_body("3-1-2"), "c")
    monkeypatch.setattr(fastcall, "_extension", lambda: None)
    slow = compile_system(eom.free_rigid_body("3-1-2"), "c")
    rng = np.random.default_rng(3)
    x, p = rng.normal(size=6), np.array([1.0, 1.2, 1.5])
    for group in ("rhs", "outputs", "invariants", "singularities"):
        a, b = (getattr(c, group)(0.3, x, p) for c in (quick, slow))
        np.testing.assert_array_equal(a, b)
    out = np.empty(6)
    assert quick.rhs(0.3, x, p, None, out) is out
    assert quick.rhs(0.3, x, p, out=out) is out
    assert quick.rhs(t=0.3, x=x, p=p).tolist() == out.tolist()
    for wrong in ((0.3, x[:5], p), (0.3, x, p[:2]), (0.3, x)):
        with pytest.raises(InputError):
            quick.rhs(*wrong)
    with pytest.raises(TypeError):
        quick.rhs(0.3)
    with pytest.raises(TypeError):
        quick.rhs(0.3, x, p, speed=1)


# --- other systems, and the compiler from the package index ---------------------------------------------

needs_zig = pytest.mark.skipif(not native.zig(), reason="no package ziglang")


def test_zig_is_taken_where_there_is_no_other_compiler_and_none_is_asked_for(monkeypatch):
    monkeypatch.setattr(native, "zig", lambda: ("/somewhere/zig", "cc"))
    monkeypatch.setenv("CC", "")
    monkeypatch.setenv("PATH", "")
    assert native.compiler() == ("/somewhere/zig", "cc")
    monkeypatch.setenv("CC", "/nowhere/cc")  # what is asked for is not replaced
    assert native.compiler() == ()


def test_without_zig_no_other_system_is_compiled_for(monkeypatch):
    monkeypatch.setattr(native, "zig", tuple)
    with pytest.raises(native.CompilerError, match="no compiler for x86_64-windows") as error:
        native.cross_compiler("x86_64-windows")
    assert "eom-toolkit[compiler]" in error.value.hint


@pytest.mark.parametrize(
    ("command", "system", "expected"),
    [
        ("gcc -O2", "linux", ["gcc", "-O2"]),
        ("'/opt/my cc' -g", "darwin", ["/opt/my cc", "-g"]),
        (r"C:\\msys\\gcc.exe -O2", "win32", [r"C:\\msys\\gcc.exe", "-O2"]),
        (r'"C:\\Program Files\\zig.exe" cc', "win32", [r"C:\\Program Files\\zig.exe", "cc"]),
        ('"open', "win32", []),
        ("'open", "linux", []),
    ],
)
def test_commands_are_split_as_each_system_quotes(command, system, expected):
    assert native.words(command, system) == expected


@needs_zig
@pytest.mark.slow
def test_the_c_target_works_by_zig_alone(cache, monkeypatch):
    monkeypatch.setenv("CC", "")
    monkeypatch.setenv("PATH", "")
    compiled = compile_system(eom.free_rigid_body(), "c")
    expected = compile_system(eom.free_rigid_body(), "numpy").rhs(0.0, (1, 2, 3), (1, 1.2, 1.5))
    np.testing.assert_allclose(compiled.rhs(0.0, (1, 2, 3), (1, 1.2, 1.5)), expected, rtol=1e-15)
    run = simulate(compiled, (1.0, 2.0, 3.0), (0, 1), (1.0, 1.2, 1.5))
    assert run.success


MAGIC = {"linux": b"\x7fELF", "windows": b"MZ", "darwin": b"\xcf\xfa\xed\xfe"}


@needs_zig
@pytest.mark.slow
@pytest.mark.parametrize("name", [
    "x86_64-windows", "aarch64-darwin",
    *(pytest.param(n, marks=pytest.mark.long) for n in ("x86_64-linux", "aarch64-linux", "x86_64-darwin")),
])  # fmt: skip
def test_a_generated_library_is_built_for_other_systems(name):
    """Built, not run: functions and integrator of a scene, by the first bytes of the library."""
    from codegen.loops import runge_kutta
    from codegen.loops.tableaux import DOP853

    compiled = compile_system(eom.heavy_top(), "numpy")
    text = runge_kutta.single_text(DOP853, compiled.program, compiled.layout)
    system = name.partition("-")[2]
    flags = ("-std=c99", "-O2", *native.shared_flags("win32" if system == "windows" else "linux"))
    made = native.build({"heavy_top.c": text}, flags, native.cross_compiler(name))
    assert made.startswith(MAGIC[system])
    assert b"heavy_top_dop853_run" in made
