"""What stands beside generated C: it builds, its test program passes, and fails where C is wrong."""

import ctypes
import re
import shutil
import subprocess
from dataclasses import replace

import mpmath
import pytest
import sympy as sp

import eom
from codegen.compiling.compiled import generate, write_files
from codegen.derivatives.derivative import jacobian
from codegen.frontend.layout import Layout
from codegen.frontend.lower import lower_system
from codegen.ir.interpret import Point
from codegen.ir.names import identifier
from codegen.native import native
from codegen.passes.pipeline import specialised
from codegen.targets import c, packaging
from eom.quantities import Definition, Quantity
from eom.system import System
from tests.codegen.test_compiled import system_of as expressions_of
from tests.codegen.test_targets import (
    COMPILERS,
    STRICT,
    SYSTEMS,
    hostile_system,
    p,
    q,
    system_of,
    x,
    y,
)

needs_compiler = pytest.mark.skipif(not COMPILERS, reason="tests C itself")
needs_make = pytest.mark.skipif(not shutil.which("make"), reason="no make")
needs_cmake = pytest.mark.skipif(not shutil.which("cmake"), reason="no CMake")

ALL = {**SYSTEMS, "hostile": hostile_system, "test": lambda: system_of([x * y], "test")}


def package(system):
    """Everything there is for a system in C."""
    program, layout = specialised(system, {})
    files = {**c.files(program, layout), **packaging.descriptions(layout)}
    derived = jacobian(lower_system(system), "rates")
    files |= packaging.sparsity(layout, {"rates_by_states": derived.pattern, "none": ()})
    files |= packaging.checks(program, layout)
    return {**files, **packaging.build(layout, files)}


def run(command, folder):
    return subprocess.run(command, cwd=folder, check=False, capture_output=True, text=True)


def run_test_program(files, folder, compiler, *options):
    write_files(files, folder)
    (test,) = (name for name in files if name.endswith("_test.c"))
    sources = [name for name in files if name.endswith(".c")]
    built = run([compiler, *STRICT, *options, "-o", "checks", *sources, "-lm"], folder)
    assert built.returncode == 0, built.stderr
    assert built.stderr == ""
    assert test.removesuffix("_test.c") + ".c" in files
    return run([str(folder / "checks")], folder)


# --- the test program ------------------------------------------------------------------------------------


CASES = [(name, COMPILERS[0]) for name in ALL] + [("hostile", COMPILERS[-1])] if COMPILERS else []


@pytest.mark.sparse(1)
@pytest.mark.parametrize(("name", "compiler"), CASES)
def test_the_test_program_passes(name, compiler, tmp_path):
    done = run_test_program(package(ALL[name]()), tmp_path, compiler)
    assert done.returncode == 0, done.stdout
    lines = done.stdout.splitlines()
    assert [line.split(":")[0] for line in lines] == list(Layout.of(ALL[name]()).sizes)
    compared, of = zip(*(map(int, re.findall(r"\d+", line)[:2]) for line in lines), strict=True)
    assert sum(compared) >= 0.6 * sum(of), "most values are compared"


@needs_compiler
def test_the_test_program_passes_where_a_compiler_fuses_operations(tmp_path):
    options = ("-O3", "-ffp-contract=fast", "-march=native")
    done = run_test_program(
        package(eom.gravity_gradient_satellite()), tmp_path, COMPILERS[0], *options
    )
    assert done.returncode == 0, done.stdout


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize(
    ("right", "wrong", "group"),
    [
        ("x[3 * xs]", "x[2 * xs]", "outputs"),
        ("cos(", "sin(", "outputs"),
        ("0.5", "0.50000000000001", "outputs"),
        ("x + j * x_column", "x + 0 * x_column", "rates"),
        (" - ", " + ", "invariants"),
    ],
)
def test_the_test_program_fails_where_the_functions_are_wrong(right, wrong, group, tmp_path):
    files = dict(package(SYSTEMS["free"]() if right == "0.5" else SYSTEMS["singular"]()))
    source = files["free_rigid_body.c"]
    assert right in source
    files["free_rigid_body.c"] = source.replace(right, wrong)
    done = run_test_program(files, tmp_path, COMPILERS[0])
    assert done.returncode == 1
    assert re.search(rf"^{group}: .* [1-9]\d* wrong$", done.stdout, re.MULTILINE), done.stdout
    assert f"{group}[" in done.stdout


@needs_compiler
def test_values_that_are_not_finite_are_compared_by_kind(tmp_path):
    made = [1 / x, sp.log(x), sp.sqrt(-1 - x**2), -1 / x**2, sp.exp(1000 * (x + 1)), x + p]
    system = system_of(made)
    program, layout = specialised(system, {})
    zero = packaging.expect(program, packaging.points(layout)[1])["outputs"]
    assert [repr(e.value) for e in zero[:5]] == ["inf", "-inf", "nan", "-inf", "inf"]
    assert all(e.bound == 0 for e in zero[:5])
    files = dict(package(system))
    assert run_test_program(files, tmp_path / "a", COMPILERS[0]).returncode == 0
    for right, wrong in (("log(x_)", "-log(x_)"), ("1.0 / x_;", "2e9 * x_;")):
        broken = files["all_of_them.c"].replace(right, wrong)
        assert broken != files["all_of_them.c"]
        done = run_test_program(
            {**files, "all_of_them.c": broken}, tmp_path / right[0], COMPILERS[0]
        )
        assert done.returncode == 1


def test_nothing_is_compared_where_a_jump_is_in_doubt():
    """sin(x) - 1/2 near zero has an error, and its sign decides; a state compared with 1/2 has none."""
    in_doubt = [sp.sign(sp.sin(x) - sp.Rational(1, 2)), sp.sqrt(sp.sin(x) - sp.Rational(1, 2)),
                sp.Piecewise((p, sp.sin(x) < 0.5), (q, True)), 1 / (sp.sin(x) - 0.5)]  # fmt: skip
    sure = [
        sp.sign(y),
        sp.Piecewise((p, y < 0.5), (q, True)),
        sp.sqrt(y),
        x / y,
        y / (x - y),
    ]
    program, _ = specialised(system_of([*sure, *in_doubt]), {})
    at = Point(0.0, [float(mpmath.asin(0.5)), 0.5], [1.0, 3.0])
    found = packaging.expect(program, at)["outputs"]
    assert [e.bound < 1 for e in found[: len(sure)]] == [True] * len(sure)
    assert [e.bound for e in found[len(sure) :]] == [float("inf")] * len(in_doubt)
    away = replace(at, x=[0.6, 0.5])
    assert all(e.bound < 1 for e in packaging.expect(program, away)["outputs"])


@needs_compiler
def test_constants_and_quotients_beyond_doubles_are_no_obstacle(tmp_path):
    huge = sp.Integer(10) ** 400
    far = sp.Mod(sp.sin(x) * sp.Float(1e200), y * sp.Float(1e-200))
    files = dict(package(system_of([huge * x, x / huge, far, sp.floor(sp.sin(x) * 1e300), x + y])))
    assert run_test_program(files, tmp_path, COMPILERS[0]).returncode == 0


def test_expected_values_are_the_nearest_doubles_and_bounds_are_small():
    program, _ = specialised(expressions_of([sp.sin(x) * sp.exp(y)]), {})
    (found,) = packaging.expect(program, Point(0.0, [0.7, 1.9, 0.0], [0.0, 0.0]))["outputs"]
    with mpmath.workdps(50):
        exact = mpmath.sin(mpmath.mpf(0.7)) * mpmath.exp(mpmath.mpf(1.9))
        assert found.value == float(exact)
    assert 1e-17 < found.bound / found.value < 1e-14


def test_points_respect_what_is_positive_and_hold_zero_states():
    layout = Layout.of(eom.gravity_gradient_satellite())
    at = packaging.points(layout)
    assert len(at) == 2 + packaging.RANDOM_POINTS
    assert set(at[1].x) == {0.0}
    for quantity, *values in zip(layout.parameters, *(point.p for point in at), strict=True):
        assert not quantity.symbol.is_positive or min(values) > 0
    assert packaging.points(layout) == at


# --- build files ---------------------------------------------------------------------------------------


@pytest.mark.sparse(only=("test",))
@needs_compiler
@needs_make
@pytest.mark.parametrize("name", ["singular", "test"])
def test_make_check(name, tmp_path):
    files = package(ALL[name]())
    files |= generate(*specialised(ALL[name](), {}), "c")  # with the integrator
    files |= packaging.build(Layout.of(ALL[name]()), files)
    write_files(files, tmp_path)
    done = run(["make", "check", "all", f"CC={COMPILERS[-1]}"], tmp_path)
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr
    assert "0 wrong" in done.stdout
    library = identifier(ALL[name]().name)
    assert (tmp_path / f"lib{library}.so").exists()
    loaded = ctypes.CDLL(str(tmp_path / f"lib{library}.so"))
    assert getattr(loaded, f"{library}_rates")
    again = run(["make", "all"], tmp_path)
    assert "Nothing to be done" in again.stdout
    header = tmp_path / f"{library}.h"
    header.write_text(header.read_text())
    assert f"{library}.o" in run(["make", "all"], tmp_path).stdout  # built again
    assert run(["make", "clean"], tmp_path).returncode == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(files)


@needs_compiler
@needs_make
def test_make_check_fails_where_the_functions_are_wrong(tmp_path):
    files = dict(package(ALL["test"]()))
    files["test.c"] = files["test.c"].replace("-x_", "x_")
    write_files(files, tmp_path)
    assert run(["make", "check"], tmp_path).returncode != 0


@pytest.mark.slow
@needs_compiler
@needs_cmake
@pytest.mark.parametrize("name", ["test"])
def test_cmake_and_ctest(name, tmp_path):
    write_files(package(ALL[name]()), tmp_path)
    for command in (["cmake", "-B", "build"], ["cmake", "--build", "build"]):
        done = run(command, tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        assert "warning" not in (done.stdout + done.stderr).lower()
    done = run(["ctest", "--test-dir", "build", "--output-on-failure"], tmp_path)
    assert done.returncode == 0, done.stdout
    assert "100% tests passed, 0 tests failed out of 1" in done.stdout
    library = identifier(ALL[name]().name)
    built = {path.name for path in (tmp_path / "build").iterdir()}
    assert {f"lib{library}.a", f"lib{library}.so", f"{library}_test"} <= built


# --- descriptions and sparsity ---------------------------------------------------------------------------


def loaded(files, folder):
    """The C functions of some files through ctypes."""
    write_files(files, folder)
    text = "".join(text for name, text in files.items() if name.endswith(".h"))
    text += "".join(
        re.sub(r'#include "\w+_(descriptions|sparsity)\.h"\n', "", text)
        for name, text in files.items()
        if name.endswith(".c")
    )
    return native.load(native.compile_library(text), text)


@needs_compiler
@pytest.mark.parametrize("name", ["singular", "hostile", "satellite", "one state"])
def test_units_and_meanings_can_be_read_from_c(name, tmp_path):
    system = ALL[name]()
    layout = Layout.of(system)
    library = loaded(packaging.descriptions(layout), tmp_path)
    groups = {
        "state": system.states,
        "parameter": system.parameters,
        "input": system.inputs,
        "output": [d.quantity for d in system.outputs],
        "invariant": [d.quantity for d in system.invariants],
    }
    for kind, quantities in groups.items():
        for what, wanted in (
            ("unit", [quantity.unit for quantity in quantities]),
            ("description", [quantity.meaning for quantity in quantities]),
        ):
            function = getattr(library, f"{identifier(system.name)}_{kind}_{what}")
            function.restype = ctypes.c_char_p
            got = [function(k).decode() for k in range(len(quantities))]
            assert got == wanted
            assert function(-1) is None
            assert function(len(quantities)) is None


def test_long_meanings_are_cut_where_strings_of_c_end():
    theta = Quantity(x, "rad", "long " * 2000)
    files = packaging.descriptions(Layout.of(System("lengthy", (theta,), (-x,))))
    assert max(map(len, files["lengthy_descriptions.c"].splitlines())) < 4095
    assert '..."' in files["lengthy_descriptions.c"]


def test_outputs_of_a_layout_have_units():
    speed = Definition(Quantity(sp.Symbol("v", real=True), "m/s", "speed"), 1.0 * x)
    layout = Layout.of(System("s", (Quantity(x, "m"),), (-1.0 * x,), outputs=(speed,)))
    assert [q.unit for q in layout.quantities()["output"]] == ["m/s"]
    assert layout.quantities()["invariant"] == ()
    assert replace(layout, results={**layout.results, "outputs": ()}).quantities()["output"] == ()


@needs_compiler
def test_patterns_can_be_read_from_c(tmp_path):
    system = eom.heavy_top()
    layout = Layout.of(system)
    pattern = jacobian(lower_system(system), "rates").pattern
    files = packaging.sparsity(layout, {"rates_by_states": pattern, "none": ()})
    library = loaded(files, tmp_path)
    row, column = ctypes.c_int(-5), ctypes.c_int(-5)
    name = identifier(layout.name)
    function = getattr(library, f"{name}_rates_by_states_sparsity")
    got = []
    while function(len(got), ctypes.byref(row), ctypes.byref(column)):
        got.append((row.value, column.value))
    assert tuple(got) == tuple(pattern)
    assert len(got) > 10
    assert function(-1, ctypes.byref(row), ctypes.byref(column)) == 0
    empty = getattr(library, f"{name}_none_sparsity")
    assert empty(0, ctypes.byref(row), ctypes.byref(column)) == 0
    assert f"{name}_rates_by_states_n_nonzeros = {len(pattern)}" in files[f"{name}_sparsity.h"]


def test_packages_are_the_same_each_time_and_plain_ascii():
    for name in ("singular", "hostile"):
        first, second = package(ALL[name]()), package(ALL[name]())
        assert first == second
        assert all(text.isascii() and text.endswith("\n") for text in first.values())
        assert all("??" not in text for file, text in first.items() if file.endswith((".c", ".h")))
