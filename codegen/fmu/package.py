"""The archive of a unit: description, sources in C, and shared libraries for one or more systems."""

from __future__ import annotations

import hashlib
import io
import platform
import tempfile
import zipfile
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

from codegen.compiling.compiled import Compiled, compile
from codegen.fmu import description
from codegen.fmu.unit import HELD, INDICATORS, INPUT, Unit, unit
from codegen.ir.names import comment, identifier
from codegen.ir.program import INVARIANTS, OUTPUTS, SAMPLES, SINGULARITIES
from codegen.loops import written
from codegen.native import native
from codegen.targets import c
from codegen.targets.c import string
from eom.errors import InputError, shown, typed, unknown_name
from eom.system import System

VERSIONS = ("3.0", "2.0")


class Platform(NamedTuple):
    """A system that units run on: its folder in an archive of FMI 2.0, and how a library ends there."""

    folder: str
    suffix: str


PLATFORMS: Mapping[str, Platform] = {
    "x86_64-linux": Platform("linux64", ".so"),
    "aarch64-linux": Platform("aarch64-linux", ".so"),
    "x86_64-windows": Platform("win64", ".dll"),
    "x86_64-darwin": Platform("darwin64", ".dylib"),
    "aarch64-darwin": Platform("aarch64-darwin", ".dylib"),
}
"""By the name of the folder in an archive of FMI 3.0; FMI 2.0 has none for ARM, there the name stands."""
_MACHINES = {"amd64": "x86_64", "x86-64": "x86_64", "arm64": "aarch64"}
FLAGS = ("-std=c99", "-O3", "-fvisibility=hidden", "-fno-math-errno", "-fno-trapping-math",
         "-ffp-contract=off")  # fmt: skip


def this_platform(system: str = "", machine: str = "") -> str:
    """Return the name of a platform in FMI 3.0, by default of this one.

    >>> this_platform("Windows", "AMD64"), this_platform("Darwin", "arm64")
    ('x86_64-windows', 'aarch64-darwin')
    """
    machine = (machine or platform.machine()).lower()
    return f"{_MACHINES.get(machine, machine)}-{(system or platform.system()).lower()}"


@typed
def write_fmu(
    system: System | Compiled | Any,
    path: str | Path,
    initial: Any,
    parameters: Any = None,
    inputs: Any = None,
    t_span: tuple[float, float] = (0.0, 10.0),
    rtol: float = 1e-9,
    version: str = "3.0",
    platforms: Sequence[str] | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Path:
    """Write a system as a functional mock-up unit, for Model Exchange and Co-Simulation.

    Parameters
    ----------
    system : System or Compiled or what SymPy has
        What `codegen.compile` takes, or a compiled system.
    path : path
        Of the archive, or a folder, which gets NAME.fmu.
    initial : mapping or sequence of float
        Start values of the states, as of `codegen.simulate`; whoever runs the unit may set others.
    parameters : mapping or sequence of float, optional
        Start values of the parameters, likewise.
    inputs : mapping, optional
        Start values of the inputs, likewise.
    t_span : (float, float), default (0, 10)
        Of the default experiment (s).
    rtol : float, default 1e-9
        Of the integrator inside, DOP853, for Co-Simulation.
    version : str, default "3.0"
        ``3.0`` or ``2.0``.
    platforms : sequence of str, optional
        Of `PLATFORMS`, those that it runs on; none: the archive holds sources alone; by default this
        one, where there is a C compiler. Others than this one are built by zig (extra ``compiler``).
    progress : callable, optional
        As of `codegen.compile`.

    Returns
    -------
    Path
        Of the archive.

    Raises
    ------
    InputError
        For wrong names and values, for inputs that are functions, for an operation that C lacks, and
        where the file cannot be written.
    CompilerError
        Where the compiler fails.

    Notes
    -----
    States are outputs with exact start values, parameters are tunable, what sampled laws hold is local;
    values have their units. Derivatives by states and inputs are exact. Branches of the rates are event
    indicators, samples are time events.

    References
    ----------
    Functional Mock-up Interface Specification 3.0.1 (2023) and 2.0.4.

    Examples
    --------
    >>> import sympy as sp, tempfile
    >>> y, v, k = sp.symbols("y v k", real=True)
    >>> oscillator = System.from_rates("oscillator", {y: v, v: -k * y})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_fmu(oscillator, folder, {"y": 1, "v": 0}, {"k": 4}, platforms=[]).name
    'oscillator.fmu'
    """
    if version not in VERSIONS:
        raise unknown_name("version of FMI", version, VERSIONS)
    for name in platforms or ():
        if name not in PLATFORMS:
            raise unknown_name("platform", name, PLATFORMS)
    compiled = system
    if not isinstance(compiled, Compiled):
        compiled = compile(system, "numpy", progress=progress)
    made = unit(compiled, initial, parameters, inputs, t_span, rtol)
    target = Path(path)
    if target.suffix != ".fmu":
        target /= f"{identifier(compiled.layout.name)}.fmu"
    _write(target, archive(files(made, version, platforms)))
    return target


def files(
    made: Unit, version: str = "3.0", platforms: Sequence[str] | None = None
) -> dict[str, bytes]:
    """Return the files of the archive by path; the same unit gives the same bytes, libraries apart."""
    texts = sources(made, version)
    token = _token(made, texts, version)
    texts = {n: t.replace("@TOKEN@", token) for n, t in texts.items()}
    listed = [n for n in texts if n.endswith(".c")]
    if version == "2.0":
        found = {"modelDescription.xml": description.of_version_2(made, token, listed)}
    else:
        found = {
            "modelDescription.xml": description.of_version_3(made, token),
            "sources/buildDescription.xml": description.build(made, listed),
        }
    found |= {f"sources/{n}": t for n, t in texts.items()}
    encoded = {n: t.encode() for n, t in found.items()}
    return {**encoded, **_libraries(made, texts, version, platforms)}


def sources(made: Unit, version: str) -> dict[str, str]:
    """Return the sources in C by file name; the token of the unit is left open."""
    program, layout = made.parts
    name = identifier(layout.name)
    jacobian = made.jacobian
    parts = ("unit.c", f"types{version[0]}.c", "calls.c", f"fmi{version[0]}.c")
    core = _filled(made, "".join(map(_template, parts)))
    return {
        **c.files(program, layout),
        **written.files(written.Choice("dop853"), program, layout),
        **c.files(jacobian.program, jacobian.layout),
        f"{name}_fmu.c": core,
    }


def archive(found: Mapping[str, bytes]) -> bytes:
    """Return files by path as an archive; without times, so that the same files give the same bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as packed:
        for name in sorted(found):
            entry = zipfile.ZipInfo(name)
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            packed.writestr(entry, found[name], zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def _token(made: Unit, texts: Mapping[str, str], version: str) -> str:
    """Return what tells units apart: a digest of all that is in them."""
    whole = "\0".join([version, *texts.values(), *map(repr, made.variables)])
    digest = hashlib.sha256(whole.encode()).hexdigest()
    return f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"


def _libraries(
    made: Unit, texts: Mapping[str, str], version: str, platforms: Sequence[str] | None
) -> dict[str, bytes]:
    """Return the shared libraries by path; none where there is no compiler, and none is asked for."""
    here = this_platform()
    if platforms is None:
        platforms = [here] if here in PLATFORMS and native.compiler() else []
    name, found = identifier(made.compiled.layout.name), {}
    for wanted in dict.fromkeys(platforms):
        row = PLATFORMS[wanted]
        command = () if wanted == here and native.compiler() else native.cross_compiler(wanted)
        system = "win32" if wanted.endswith("windows") else "linux"
        length = len(made.compiled.program.instructions)
        flags = [*FLAGS, *native.shared_flags(system), *native.flags_for(0, length)]
        folder = row.folder if version == "2.0" else wanted
        found[f"binaries/{folder}/{name}{row.suffix}"] = native.build(texts, flags, command)
    return found


def _template(name: str) -> str:
    return resources.files("codegen.fmu").joinpath(name).read_text(encoding="ascii")


def _filled(made: Unit, text: str) -> str:
    """Return the template of a unit with its keys replaced."""
    layout = made.parts[1]
    name, jacobian = identifier(layout.name), made.jacobian
    counts = {"OUTPUTS": OUTPUTS, "INVARIANTS": INVARIANTS, "INDICATORS": INDICATORS,
              "SINGULARITIES": SINGULARITIES}  # fmt: skip
    values = {
        **{key: str(len(layout.results[group])) for key, group in counts.items()},
        **_samples(made),
        "TITLE": comment(layout.title),
        "NAME": name,
        "UPPER": name.upper(),
        "DERIVATIVES": identifier(jacobian.layout.name),
        "STATES": str(len(layout.states)),
        "PARAMETERS": str(len(layout.parameters)),
        "INPUTS": str(len(layout.inputs)),
        "ROWS": str(len(layout.results.get(SAMPLES, ()))),
        "ENTRIES": str(len(jacobian.rows)),
        "ENTRY_ROWS": _list(jacobian.rows),
        "ENTRY_COLUMNS": _list(jacobian.columns),
        "NAMES": "\n".join(f"    {string(v.name[:200])}," for v in made.variables),
        "FIRST_X": _list(map(float, made.x)),
        "FIRST_P": _list(map(float, made.p)),
        "FIRST_U": _list(map(float, made.u)),
        "SMALLEST": _list(map(float, made.smallest)),
        "HELD": _list(int(v.kind == HELD) for v in made.of(INPUT, HELD)),
        "RTOL": repr(made.rtol),
    }
    for key, value in values.items():
        text = text.replace(f"@{key}@", value)
    return text


def _samples(made: Unit) -> dict[str, str]:
    """Return what the template needs of the laws that are sampled."""
    rows, places, room = [], list[int](), 0
    for law in made.laws:
        count, waits = len(law.applied), bool(law.whole or law.rest)
        ring = law.whole + 2 if waits else 0
        whole = count + len(law.stepped)
        numbers = law.period, law.rest, law.whole, int(waits), count, whole, len(places), ring
        rows.append(f"{{{_list(numbers)}}}")
        places += [*law.applied, *law.stepped]
        room += ring * count
    return {
        "LAWS": str(len(rows)),
        "LAW_ROWS": ", ".join(rows) or "{0}",
        "PLACES": _list(places),
        "ROOM": str(room),
    }


def _list(numbers: Any) -> str:
    return ", ".join(map(repr, numbers)) or "0"


def _write(target: Path, content: bytes) -> None:
    """Write a file whole or not at all. Raises `InputError`."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=target.parent, prefix=".eom-", delete=False) as made:
            made.write(content)
        Path(made.name).chmod(0o644)
        Path(made.name).replace(target)
    except (OSError, ValueError) as error:  # a name may hold what no file is called
        raise InputError(
            "the unit cannot be written",
            where=shown(str(target)),
            got=getattr(error, "strerror", None) or str(error),
            hint="choose a folder that you can write",
        ) from None
