"""The edge to the C compiler: compile into a private cache by content hash, and load.

A shared library is compiled into a temporary file and renamed into place, so that processes that
work at the same time never see half of one. The key, a folder's name, covers the source, the flags,
the compiler and, since the code is for this machine, the processor. The library in it is named by the
digest of its bytes: to load one that was damaged could end the process, so that one is built anew.
What is going to be asked for is begun ahead, beside this process, so that compilers work at the same time.

Quick calls of compiled functions from Python: a small extension, compiled once a machine.

It needs the headers of Python beside the C compiler; without them calls go through `ctypes`, are
slower by some microseconds and give the same results.
"""

from __future__ import annotations

import atexit
import ctypes
import errno
import hashlib
import importlib.machinery
import importlib.util
import os
import platform
import shlex
import shutil
import signal
import stat
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs

from codegen.native import children
from eom.errors import InputError

SUFFIXES = {"win32": ".dll", "cygwin": ".dll", "darwin": ".dylib"}
"""How shared libraries end, by `sys.platform`; elsewhere in .so."""


def library_suffix(system: str = sys.platform) -> str:
    """Return how the names of shared libraries end on a system, as `sys.platform` names it.

    >>> library_suffix("linux"), library_suffix("win32"), library_suffix("darwin")
    ('.so', '.dll', '.dylib')
    """
    return SUFFIXES.get(system, ".so")


def shared_flags(system: str = sys.platform) -> tuple[str, ...]:
    """Return what makes a compiler write a shared library; all code of Windows may be moved anyway.

    >>> shared_flags("win32"), shared_flags("linux")
    (('-shared',), ('-fPIC', '-shared'))
    """
    return ("-shared",) if library_suffix(system) == ".dll" else ("-fPIC", "-shared")


FLAGS = ("-std=c99", "-O3", *shared_flags(), "-fno-math-errno", "-fno-trapping-math")
NATIVE_FLAGS = ("-march=native", "-fno-semantic-interposition", "-ffp-contract=off")
"""Flags that some compilers lack. The second lets functions of one library be inlined; the third
keeps clang from fusing products into sums, so that every compiler gives the same numbers."""
MANY_RESULTS = 16
STORES_APART = ("-fno-tree-slp-vectorize",)
"""For functions of more than `MANY_RESULTS` results: there gcc packs little but the stores, in groups
of four, and runs out of registers (Jacobian of the satellite: 389 instructions with, 364 without). In loops
of Runge-Kutta methods, too: rates are read one by one behind their stores (ten scenes with DOP853 and DP5:
a step takes 0.88 to 1.04 of the time with packed stores, 0.96 in the middle)."""
MANY_INSTRUCTIONS = 2000
QUICKLY = ("-O1", "-ftree-vectorize")
"""For programs of more than `MANY_INSTRUCTIONS`: straight-line code gains nothing from -O3, whose time
grows faster (pendulum of 20 links: 1.24 s and 2.1 us a call with -O3, 0.89 s and 2.1 us with these)."""
QUICKEST = "-Og"
"""For the module of quick calls, which a first run waits for: 0.13 s of the processor, 0.36 s with -O3, for
runs that take as long."""
TIMEOUT_SECONDS = 600
CACHE_VARIABLE = "EOM_CACHE_DIR"


OR_NUMPY = ", or use the target numpy"
"""How hints end where another target does without a compiler."""
GET_COMPILER = "pip install 'eom-toolkit[compiler]', install gcc or clang, or set CC to its path"
"""What to do where there is no compiler."""


class CompilerError(InputError):
    """Say that there is no C compiler, or that it failed.

    An `InputError` with the same parts: ``got`` is what the compiler said.
    """

    @property
    def brief(self) -> str:
        """One line: what failed, and the first line of what was said."""
        said = self.got.splitlines()
        return f"{self.what} ({said[0]})" if said else self.what


class CacheError(CompilerError):
    """Say that compiled code cannot be kept: the cache cannot be made or written, or is full.

    A `CompilerError`, since nothing can be compiled then: target ``auto`` goes on with NumPy.
    """

    @classmethod
    def of(cls, error: OSError, folder: Path) -> CacheError:
        """Return the error for what the operating system said of a folder."""
        return cls(
            "compiled code cannot be kept in the cache",
            where=str(folder),
            got=error.strerror or str(error),
            hint=f"set {CACHE_VARIABLE} to a folder of your own with room in it{OR_NUMPY}",
        )


def words(command: str, system: str = sys.platform) -> list[str]:
    r"""Return the words of a command as a shell splits them; none where a quote is not closed.

    On Windows a backslash separates folders, elsewhere it quotes.

    >>> words(r'"C:\my tools\cc.exe" -O2', "win32")
    ['C:\\my tools\\cc.exe', '-O2']
    """
    try:
        if system != "win32":
            return shlex.split(command)
        return [w.strip('"') for w in shlex.split(command, posix=False)]
    except ValueError:
        return []


@cache
def _which(command: str, search: str | None) -> tuple[str, ...]:
    parts = words(command)
    found = shutil.which(parts[0], path=search) if parts else None
    return (found, *parts[1:]) if found else ()


def compiler() -> tuple[str, ...]:
    """Return the C compiler's command, or an empty tuple.

    The environment variable ``CC`` decides where it is set; otherwise cc, gcc or clang is taken, and
    where there is none of them, zig of the package ziglang (extra ``compiler``).
    """
    search = os.environ.get("PATH")
    if os.environ.get("CC"):
        return _which(os.environ["CC"], search)
    return next((c for name in ("cc", "gcc", "clang") if (c := _which(name, search))), ()) or zig()


ZIG_TARGETS = {
    "x86_64-linux": "x86_64-linux-gnu.2.17",
    "aarch64-linux": "aarch64-linux-gnu.2.17",
    "x86_64-windows": "x86_64-windows-gnu",
    "x86_64-darwin": "x86_64-macos",
    "aarch64-darwin": "aarch64-macos",
}
"""Machines and systems that zig compiles for, by its names of them; of Linux, those since 2012."""


def zig() -> tuple[str, ...]:
    """Return the command of zig's C compiler, of the package ziglang, or an empty tuple."""
    spec = importlib.util.find_spec("ziglang")
    folder = Path(spec.origin).parent if spec and spec.origin else None
    names = ("zig", "zig.exe")
    found = next((folder / n for n in names if folder and (folder / n).is_file()), None)
    return (str(found), "cc") if found else ()


def cross_compiler(name: str) -> tuple[str, ...]:
    """Return the command that compiles for another system, one of `ZIG_TARGETS`.

    Raises `CompilerError` where the package ziglang is not installed.
    """
    command = zig()
    if not command:
        raise CompilerError(
            f"no compiler for {name}",
            got="an installation without the package ziglang",
            hint="pip install 'eom-toolkit[compiler]'",
        )
    return (*command, "-target", ZIG_TARGETS[name])


def require_compiler() -> tuple[str, ...]:
    """Return the C compiler's command. Raises `CompilerError` where there is none."""
    command = compiler()
    if not command:
        asked = os.environ.get("CC")
        if asked and asked.strip() and not words(asked):
            raise CompilerError(
                "the variable CC is not a command: a quote is not closed",
                got=f"CC={asked}",
                hint="write it as in a shell, for example CC='gcc -O2'",
            )
        raise CompilerError(
            "no C compiler found",
            got=f"CC={asked}" if asked else "none of cc, gcc, clang on the PATH",
            hint=GET_COMPILER + OR_NUMPY,
        )
    return command


def cache_folder() -> Path:
    """Return the cache folder, made private to the user.

    Raises `CacheError` where it cannot be made or written, and another `InputError` where it belongs
    to somebody else.
    """
    folder = Path(os.environ.get(CACHE_VARIABLE) or platformdirs.user_cache_path("eom-toolkit"))
    hint = f"set {CACHE_VARIABLE} to a folder of your own"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        status = folder.stat()
    except OSError as error:
        raise CacheError.of(error, folder) from None
    if hasattr(os, "getuid"):
        if status.st_uid != os.getuid():
            raise InputError("cache folder belongs to another user", where=str(folder), hint=hint)
        if status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
            raise InputError(
                "others can write to the cache folder",
                where=str(folder),
                hint=f"chmod go-w it, or {hint}",
            )
    if not os.access(folder, os.W_OK):
        raise CacheError.of(PermissionError(errno.EACCES, os.strerror(errno.EACCES)), folder)
    return folder


@cache
def _processor() -> str:
    """Return what distinguishes this processor from others with another instruction set."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return f"{platform.machine()} {platform.processor()}"
    relevant = [
        line for line in lines if line.startswith(("model name", "flags", "Features", "CPU part"))
    ]
    return "\n".join([platform.machine(), *sorted(set(relevant))])


def _identity(command: Sequence[str]) -> str:
    """Return what changes when the compiler is replaced, without running it."""
    real = Path(command[0]).resolve()
    status = real.stat()
    return f"{real} {status.st_size} {status.st_mtime_ns} {' '.join(command[1:])}"


def flags_for(results: int, instructions: int = 0) -> tuple[str, ...]:
    """Return further flags that suit functions of at most so many results, and a program's length."""
    long = QUICKLY if instructions > MANY_INSTRUCTIONS else ()
    return long + (STORES_APART if results > MANY_RESULTS else ())


def flags_for_steps(instructions: int) -> tuple[str, ...]:
    """Return further flags that suit loops of steps over rates of a program's length."""
    return (*flags_for(0, instructions), *STORES_APART)


@dataclass(frozen=True)
class _Order:
    """A library that is wanted: how it is compiled, and its folder of the cache, which is its key."""

    command: tuple[str, ...]
    flags: tuple[str, ...]
    source: str
    folder: Path
    suffix: str


def _order(source: str, extra_flags: Sequence[str], suffix: str) -> _Order:
    command = require_compiler()
    flags = (*FLAGS, *NATIVE_FLAGS, *extra_flags)
    key = "\0".join([source, *flags, _identity(command), _processor()])
    folder = cache_folder() / hashlib.sha256(key.encode()).hexdigest()[:40]
    return _Order(command, flags, source, folder, suffix or library_suffix())


def compile_library(source: str, extra_flags: Sequence[str] = (), suffix: str = "") -> Path:
    """Return the shared library of a C source text, compiled if the cache does not have it.

    What was begun by `ahead` is waited for. Raises `CompilerError` where there is no compiler, it fails, or
    the cache cannot be written; the cache is then unchanged.
    """
    order = _order(source, extra_flags, suffix)
    try:
        return _found(order.folder, order.suffix) or _from_ahead(order) or _compile(order)
    except OSError as error:
        raise CacheError.of(error, order.folder.parent) from None


@dataclass(frozen=True)
class _Begun:
    """A compiler at work beside this process: where, and who began it."""

    process: subprocess.Popen[str]
    build: Path
    owner: int


_AHEAD: dict[Path, _Begun] = {}
"""What was begun and is not waited for yet, by folder of the cache."""


def ahead(source: str, extra_flags: Sequence[str] = (), suffix: str = "") -> None:
    """Begin to compile what `compile_library` is going to be asked for, and go on meanwhile.

    Nothing is raised: whatever fails is done again when it is asked for, and told there. What nobody asks
    for is ended with this process.
    """
    try:
        order = _order(source, extra_flags, suffix)
        if order.folder in _AHEAD or _found(order.folder, order.suffix):
            return
        build = Path(tempfile.mkdtemp(prefix="build-", dir=order.folder.parent))
    except (InputError, OSError):
        return
    try:
        command = _command(order, order.flags, build)
        process = children.begun(command, _environment(str(build)))
    except OSError:
        shutil.rmtree(build, ignore_errors=True)
        return
    _AHEAD[order.folder] = _Begun(process, build, os.getpid())


def _from_ahead(order: _Order) -> Path | None:
    """Return the library that was begun ahead; None where there is none, or it failed."""
    begun = _AHEAD.pop(order.folder, None)
    if begun is None or begun.owner != os.getpid():
        return None
    try:
        done = children.waited_for(begun.process, TIMEOUT_SECONDS)
        made = begun.build / MADE
        return _kept(made, order) if done.returncode == 0 and made.exists() else None
    except subprocess.TimeoutExpired:
        return None
    finally:
        shutil.rmtree(begun.build, ignore_errors=True)


@atexit.register
def _give_up() -> None:
    """End what was begun and nobody has asked for: with this process, or where the compiler fails."""
    for folder in [f for f, begun in list(_AHEAD.items()) if begun.owner == os.getpid()]:
        begun = _AHEAD.pop(folder)
        with begun.process:
            children.end(begun.process)
        shutil.rmtree(begun.build, ignore_errors=True)


def _digest(library: Path) -> str:
    return hashlib.blake2b(library.read_bytes(), digest_size=16).hexdigest()


def _is_whole(library: Path) -> bool:
    """Return whether a library is there and holds what was compiled."""
    try:
        return _digest(library) == library.name.partition(".")[0]
    except OSError:
        return False


def _found(folder: Path, suffix: str) -> Path | None:
    """Return the library of a folder of the cache, if there is a whole one; remove damaged ones."""
    for library in sorted(folder.glob(f"*{suffix}")):
        if _is_whole(library):
            return library
        library.unlink(missing_ok=True)
    return None


MADE = "library"
"""File that the compiler makes."""


def _command(order: _Order, flags: Sequence[str], build: Path) -> list[str]:
    """Write the source into a folder, and return the command that compiles it there."""
    text = build / "source.c"
    text.write_text(order.source, encoding="ascii")
    return [*order.command, *flags, "-o", str(build / MADE), str(text), "-lm"]


def _kept(made: Path, order: _Order) -> Path:
    """Move a library into its folder of the cache."""
    order.folder.mkdir(mode=0o700, exist_ok=True)
    return made.replace(order.folder / f"{_digest(made)}{order.suffix}")


def _compile(order: _Order) -> Path:
    """Return the library that the compiler makes, in its folder of the cache. Raises `CompilerError`."""
    with tempfile.TemporaryDirectory(prefix="build-", dir=order.folder.parent) as build:
        attempts = [order.flags, [f for f in order.flags if f not in NATIVE_FLAGS]]
        for attempt in attempts:
            run = _command(order, attempt, Path(build))
            failure = _run(run, build)
            if failure is None and (Path(build) / MADE).exists():
                return _kept(Path(build) / MADE, order)
        _give_up()
        raise CompilerError(
            "the C compiler failed",
            where=" ".join(run),
            got=(failure or "it made no file")[:2000],
            hint=f"set CC to another compiler{OR_NUMPY}",
        )


def _environment(folder: str) -> dict[str, str]:
    """Return what the compiler sees: its temporary files go into ``folder``.

    It cannot remove them itself where it is ended.
    """
    return {**os.environ, "LC_ALL": "C", **dict.fromkeys(("TMPDIR", "TMP", "TEMP"), folder)}


def _run(command: Sequence[str], folder: str) -> str | None:
    """Run a command; return what it printed if it failed, None if it succeeded."""
    environment = _environment(folder)
    try:
        done = children.finished(command, seconds=TIMEOUT_SECONDS, environment=environment)
    except OSError as error:
        return str(error)
    except subprocess.TimeoutExpired as error:
        said = (error.stderr or error.stdout or b"").decode(errors="replace").strip()
        return f"stopped after {TIMEOUT_SECONDS:g} s\n{said}".strip()
    if done.returncode == 0:
        return None
    return f"{_ending(done.returncode)}\n{(done.stderr or done.stdout).strip()}".strip()


def _ending(status: int) -> str:
    """Return how a command ended, in words; a negative status is a signal."""
    if status >= 0:
        return f"exit status {status}"
    name = next((s.name for s in signal.Signals if s == -status), "an unknown one")
    return f"ended by signal {-status} ({name})"


def build(files: Mapping[str, str], flags: Sequence[str], command: Sequence[str] = ()) -> bytes:
    """Return the shared library of several texts by file name, of which those of C are compiled.

    ``flags``: of the compiler; those of `NATIVE_FLAGS` are left out, so that it runs on other processors.
    ``command``: the compiler, by default that of `require_compiler`. Nothing is kept in the cache. Raises
    `CompilerError` where there is no compiler or it fails.
    """
    command = command or require_compiler()
    with tempfile.TemporaryDirectory(prefix="eom-") as folder:
        for name, text in files.items():
            (Path(folder) / name).write_text(text, encoding="ascii", newline="\n")
        made = Path(folder) / "library"
        sources = [str(Path(folder) / name) for name in sorted(files) if name.endswith(".c")]
        run = [*command, *flags, "-o", str(made), *sources, "-lm"]
        failure = _run(run, folder)
        if failure is None and made.exists():
            return made.read_bytes()
    raise CompilerError(
        "the C compiler failed",
        where=" ".join(run),
        got=(failure or "it made no file")[:2000],
        hint="set CC to another compiler",
    )


def load(library: Path, source: str, extra_flags: Sequence[str] = ()) -> ctypes.CDLL:
    """Load a compiled library; one that is damaged or cannot be loaded is compiled anew, once.

    Raises `CompilerError` where the new one cannot be loaded either; the cache then lacks it.
    """
    if _is_whole(library):
        try:
            return ctypes.CDLL(str(library))
        except OSError:
            library.unlink(missing_ok=True)
    made = compile_library(source, extra_flags)
    try:
        return ctypes.CDLL(str(made))
    except OSError as error:
        shutil.rmtree(made.parent, ignore_errors=True)
        raise CompilerError(
            "the C compiler made a library that cannot be loaded",
            where=str(made),
            got=str(error),
            hint=f"set CC to another compiler{OR_NUMPY}",
        ) from None


def python_headers() -> Path | None:
    """Return the folder of Python.h, or None where the headers are not installed."""
    folder = Path(sysconfig.get_paths()["include"])
    return folder if (folder / "Python.h").is_file() else None


@cache
def _extension_text() -> tuple[str, tuple[str, ...]] | None:
    """Return source and flags of the module of quick calls, None without the headers of Python."""
    headers = python_headers()
    if headers is None:
        return None
    calls, runs = (
        resources.files("codegen.native").joinpath(f"{name}.c").read_text(encoding="ascii")
        for name in ("fastcall", "runs")
    )
    return calls.replace("/* @RUNS@ */", runs), (QUICKEST, f"-I{headers}")


@cache
def begin_extension() -> None:
    """Begin to compile the module of quick calls where the cache does not have it; see `ahead`."""
    text = _extension_text()
    if text is not None:
        ahead(*text)


@cache
def _extension() -> Any | None:
    text = _extension_text()
    if text is None:
        return None
    try:
        library = compile_library(*text)
        loader = importlib.machinery.ExtensionFileLoader("eom_fastcall", str(library))
        spec = importlib.util.spec_from_loader("eom_fastcall", loader)
        assert spec is not None
        module = importlib.util.module_from_spec(spec)
        loader.exec_module(module)
    except (CompilerError, ImportError):
        return None
    return module


def extension() -> Any | None:
    """Return the module of quick calls, None without a compiler or the headers of Python.

    Beside ``bind`` it has what runs cost beside their loops (`runs.c`): ``taken``, ``scales``,
    ``steepest``, ``begun``; whoever calls these has a form of his own for where it is not there.
    """
    return _extension()


def bind(
    addresses: tuple[int, int],
    lengths: tuple[int, int, int, int],
    constants: int,
    fallback: Callable[..., Any],
) -> Callable[..., Any]:
    """Return a quick function for the C function and its preparation at ``addresses``.

    ``lengths``: numbers of states, parameters, inputs and results. ``constants``: doubles that the
    preparation fills. ``fallback`` serves every call
    that is not (float, contiguous arrays of doubles of these lengths); it must keep the code loaded.
    """
    quick = _extension()
    if quick is None:
        return fallback
    function: Callable[..., Any] = quick.bind(
        *addresses, lengths, constants, fallback, partial(np.empty, lengths[3])
    )
    return function
