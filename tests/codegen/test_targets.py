"""Generated text: strict compilers accept it, hostile names do no harm, a C program can use it."""

import re
import shutil
import subprocess

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from sympy.codegen import cfunctions

import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.compiling.compiled import generate, write_files
from codegen.frontend.lower import _CHAINS, _COMPARISONS, BESSEL, FUNCTIONS, lower_expressions
from codegen.ir.ops import BLOCKS, OPS, SOLVE
from codegen.native import native
from codegen.targets import c, load_module, numpy_
from codegen.targets.render import Body, Line, split
from eom.errors import InputError
from eom.quantities import Definition, Quantity
from eom.system import System
from eom.tables import Table

pytestmark = pytest.mark.shipped_flags

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="tests C itself")
COMPILERS = [n for n in ("gcc", "clang") if native.compiler() and shutil.which(n)]
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror", "-O2")

x, y, p, q = sp.symbols("x y p q", real=True)
LIFT = Table("lift", [0, 0.6, 2.4, 3], [1, -1, 2, 0.5])
DRAG = Table("drag */", [0, 0.6, 2.4, 3], [1, -1, 2, 0.5], "cubic", "linear")


def every_operation():
    """Expressions whose programs hold every operation there is."""
    several = {sp.atan2: (y, x), sp.Mod: (x, y), sp.Heaviside: (x, y), cfunctions.hypot: (x, y),
               cfunctions.fma: (x, y, p)}  # fmt: skip
    made = [f(*several.get(f, (x,))) for f in FUNCTIONS]
    made += [f(n, x) for f in BESSEL for n in (0, 1, 2, -3)]
    made += [sp.log(x), sp.log(1 + x), sp.exp(x) - 1, sp.sqrt(x**2 + y**2), sp.sinc(x), LIFT(x)]
    made += [LIFT(x).diff(x), DRAG(y), DRAG(y).diff(y, 2), (1 - sp.cos(x)) / x**2]
    made += [x + y, x - y, 3 * x * y, x / y, -x, sp.sqrt(x), x**y]
    made += [f(x, y) for f in (sp.Min, sp.Max)]
    tests = (sp.And, sp.Or, lambda a, b: sp.Not(sp.Eq(x, y)))
    for relation in (sp.Lt, sp.Le, sp.Eq, sp.Gt, sp.Ge, sp.Ne):
        made.append(sp.Piecewise((p, relation(x, y)), (q, True)))
    made += [sp.Piecewise((p, t(x < y, x < 2 * q)), (q, True)) for t in tests]
    return made


def plain(e):
    """The functions of C in SymPy's own; SymPy does not evaluate them."""
    return e.expand(func=True) if type(e).__module__ == cfunctions.__name__ else e


def system_of(expressions, name="all_of_them"):
    outputs = tuple(
        Definition(Quantity(sp.Symbol(f"f{k}", real=True)), e) for k, e in enumerate(expressions)
    )
    return System(
        name, (Quantity(x), Quantity(y)), (-x, -y), (Quantity(p), Quantity(q)), outputs=outputs
    )


def files_of(system):
    compiled = compile_system(system, "numpy")
    return generate(compiled.program, compiled.layout, "c")


def strictly_compile(files, folder, compiler, *more):
    for name, text in files.items():
        (folder / name).write_text(text)
    sources = [name for name in files if name.endswith(".c")]
    run = subprocess.run(
        [compiler, *STRICT, *more, "-c", *sources],
        cwd=folder, check=False, capture_output=True, text=True,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    assert run.stderr == ""


# --- the tables ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("templates", [numpy_.TEMPLATES, c.TEMPLATES], ids=["numpy", "c"])
def test_every_target_has_every_operation_and_no_other(templates):
    assert set(templates) == set(OPS)
    for name, template in templates.items():
        if name in BLOCKS:
            continue
        fields = set(re.findall(r"\{(\d)\}", template.text))
        assert fields == {str(k) for k in range(OPS[name].arity)}
        assert not template.needs or len(template.needs) == OPS[name].arity


def test_lowering_reaches_every_operation():
    reached = lower_expressions({"all": every_operation()}, (x, y), (p, q)).counts()
    assert set(reached) == set(OPS) - SOLVE
    tabled = {*BESSEL.values(), *_CHAINS.values(), *(op for op, _ in _COMPARISONS.values())}
    assert tabled <= set(OPS)


def test_every_operation_has_the_value_that_sympy_gives_it(target):
    expressions = every_operation()
    compiled = compile_system(system_of(expressions), target)
    for values in (
        (0.3, 0.8, 1.5, -2.0),
        (0.8, 0.3, 0.0, 7.0),
        (0.5, 0.5, 2.0, 3.0),
        (2.5, 1.5, 1, 1),
    ):
        numbers = dict(zip((x, y, p, q), map(sp.Rational, values), strict=True))
        got = compiled.outputs(0.0, values[:2], values[2:])
        for e, value in zip(expressions, got, strict=True):
            exact = sp.N(plain(e).xreplace(numbers), 30)
            if exact.is_real:
                assert value == pytest.approx(float(exact), rel=1e-14, abs=1e-300), e
            else:
                assert np.isnan(value), e


def test_conditions_that_hold_conditions_are_computed(target):
    """SymPy nests them as ITE where a Piecewise is compared."""
    nested = sp.Piecewise((1, sp.ITE(x < y, p > 0, q > 0)), (2, True))
    compiled = compile_system(system_of([nested]), target)
    for a, b, c_, d in [(0, 1, 1, -1), (0, 1, -1, 1), (1, 0, 1, -1), (1, 0, -1, 1)]:
        expected = 1 if (c_ > 0 if a < b else d > 0) else 2
        assert compiled.outputs(0.0, [a, b], [c_, d]) == [expected]


def test_brackets_are_where_the_order_of_operations_needs_them(target):
    cases = [x - (y - p), x / (y / p), x - (y + p), x * (y + p), -(x + y), -(x * y) + p, (x - y) * -p,
             (x + y) ** 2 / (p - q) ** 2, 1 / (x - y), sp.sin(-x) - -y, x * (y * p), x + (y + p),
             -(-x - y) / -(p - q)]  # fmt: skip
    values = (1.7, -2.3, 0.9, 3.1)
    compiled = compile_system(system_of(cases), target)
    got = compiled.outputs(0.0, values[:2], values[2:])
    for e, value in zip(cases, got, strict=True):
        expected = float(e.xreplace(dict(zip((x, y, p, q), map(sp.Float, values), strict=True))))
        assert value == pytest.approx(expected, rel=1e-14)


def test_constants_are_rounded_once(target):
    """pi^2/7, a product of three constants in doubles, is written as the nearest double."""
    constants = [sp.pi**2 / 7 + sp.sqrt(2), sp.E ** sp.Rational(1, 3), sp.Rational(1, 3), -sp.pi,
                 sp.Integer(10) ** 400, -sp.Integer(10) ** 400, sp.Rational(1, 10**400),
                 sp.Float("0.1"), sp.Integer(2) ** 60 + 1]  # fmt: skip
    compiled = compile_system(system_of(constants), target)
    got = compiled.outputs(0.0, [0.0, 0.0], [0.0, 0.0])
    expected = [float(sp.N(v, 50)) for v in constants]
    np.testing.assert_array_equal(got, expected)


# --- strict compilers -----------------------------------------------------------------------------------

SYSTEMS = {
    "free": eom.free_rigid_body,
    "dcm": lambda: eom.free_rigid_body("dcm"),
    "singular": lambda: eom.free_rigid_body("3-2-1"),
    "spinner": lambda: eom.lecture_torque().system(),
    "satellite": eom.gravity_gradient_satellite,
    "top": lambda: eom.Scene.ready("heavy-top").derive(),
    "all operations": lambda: system_of(every_operation()),
    "one state": lambda: System.from_rates("one", {x: sp.Integer(0)}),
}


@pytest.mark.sparse(1)
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("name", SYSTEMS)
def test_generated_c_passes_strict_compilers_without_a_warning(name, compiler, tmp_path):
    strictly_compile(files_of(SYSTEMS[name]()), tmp_path, compiler)


@pytest.mark.parametrize("compiler", COMPILERS)
def test_headers_can_be_included_alone_and_twice(compiler, tmp_path):
    files = files_of(SYSTEMS["singular"]())
    for header in [n for n in files if n.endswith(".h")]:
        twice = f'#include "{header}"\n' * 2
        files[f"alone_{header[:-2]}.c"] = f"{twice}int n_{header[:-2]};\n"
    strictly_compile(files, tmp_path, compiler)


# --- long functions are split --------------------------------------------------------------------------


@pytest.mark.sparse(6)
@needs_compiler
@pytest.mark.parametrize("most", [1, 3, 17])
@pytest.mark.parametrize("name", SYSTEMS)
def test_parts_give_the_same_numbers_to_the_last_bit(name, most, monkeypatch):
    system = SYSTEMS[name]()
    whole = compile_system(system, "c")
    monkeypatch.setattr(c, "PART_LINES", most)
    parts = compile_system(system, "c")
    rng = np.random.default_rng(4)
    sizes = len(system.states), len(system.parameters), len(system.inputs)
    xs, ps, us = (rng.uniform(0.2, 1.3, n) for n in sizes)
    batch = rng.uniform(0.2, 1.3, (sizes[0], 5))
    for group, function in whole.functions.items():
        np.testing.assert_array_equal(
            parts.functions[group](0.3, xs, ps, us), function(0.3, xs, ps, us)
        )
        np.testing.assert_array_equal(
            parts.functions[group](0.3, batch, ps, us), function(0.3, batch, ps, us)
        )
    state = xs.copy()
    assert np.array_equal(parts.rhs(0.3, state, ps, us, out=state), whole.rhs(0.3, xs, ps, us))


@pytest.mark.slow
@pytest.mark.parametrize("compiler", COMPILERS)
def test_parts_pass_strict_compilers(compiler, tmp_path, monkeypatch):
    monkeypatch.setattr(c, "PART_LINES", 2)
    strictly_compile(files_of(SYSTEMS["all operations"]()), tmp_path, compiler)
    strictly_compile(files_of(hostile_system()), tmp_path, compiler)


@given(st.integers(1, 40), st.integers(1, 9), st.randoms(use_true_random=False))
def test_parts_load_what_earlier_parts_stored(count, most, random):
    lines = []
    for k in range(count):
        used = random.sample(range(k), min(k, 2))
        lines.append(Line(f"v{k}_", " + ".join(["1.0", *(f"v{n}_" for n in used)])))
    body = Body(tuple(lines), ("v0_", f"v{count - 1}_"))
    parts, room = split(body, most)
    assert [line for part in parts for line in part.lines] == lines
    assert all(len(part.lines) <= most for part in parts)
    carried = {}
    for k, part in enumerate(parts):
        known = {line.variable: carried[slot] for line, slot in part.loads}
        assert all(known[v] == v for v in known)
        known |= {line.variable: line.variable for line in part.lines}
        texts = [line.expression for line in part.lines]
        texts += body.results if k == len(parts) - 1 else []
        assert {w for t in texts for w in re.findall(r"v\d+_", t)} <= set(known)
        carried |= {slot: line.variable for line, slot in part.stores}
    assert set(carried) == set(range(room)) or (room == 1 and not carried)


# --- hostile names ----------------------------------------------------------------------------------------

HOSTILE = [
    "int", "lambda", "θ'", "a*/ int x;", "x\ny", "sin", "x", "x_", "X", "θ", "theta", "np", "out",
    "dx", "", " ", "1", "*/", "/*", "//", "\\", '"', "';DROP", "%s%n", "{0}", "@NAME@", "??/",
    "v1_", "v2_", "for", "main", "π", "δ", "∂", "q̇", "xs", "ps", "us", "ys", "N", "S", "j", "count",
    "a" * 300, "a" * 300 + "b", "rates", "outputs", "None", "True", "True_", "sign_", "min_",
    "__import__('os')", "scipy", "jn", "erfc", "mod_", "stumpff_",
    "table_1_", "table_1_start", "double", "restrict", "INFINITY", "HUGE_VAL", "FP_NAN",
    "min", "sign", "_Bool", "complex", "k", "s", "carried_",
]  # fmt: skip


def hostile_system():
    """Each state is driven by the next; outputs have hostile names too."""
    names = list(dict.fromkeys(HOSTILE))
    states = [sp.Symbol(n, real=True) for n in names]
    gains = [sp.Symbol(f"{n} gain", real=True) for n in names]
    around = zip(states, states[1:] + states[:1], gains, strict=True)
    rates = [sp.sin(b) * g + sp.sign(a) for a, b, g in around]
    outputs = tuple(
        Definition(Quantity(sp.Symbol(f"{n}*", real=True), "", n), sp.Min(s, 1) ** 2 + s)
        for n, s in zip(reversed(names), states, strict=True)
    )
    quantities = tuple(Quantity(s, "", 'unit "*/ \\ \n #error') for s in states)
    return System(
        "evil */ name\n", quantities, tuple(rates), tuple(Quantity(g) for g in gains),
        outputs=outputs, title='title """ */ \\\n#error "no"',
    )  # fmt: skip


@pytest.mark.sparse(only=("c",))
def test_hostile_names_give_right_numbers(target):
    system = hostile_system()
    compiled = compile_system(system, target)
    rng = np.random.default_rng(1)
    n = len(system.states)
    xs, ps = rng.normal(size=n), rng.normal(size=n)
    expected = np.sin(np.roll(xs, -1)) * ps + np.sign(xs)
    np.testing.assert_allclose(compiled.rhs(0.0, xs, ps), expected, rtol=1e-14)
    expected = np.minimum(xs, 1) ** 2 + xs
    np.testing.assert_allclose(compiled.outputs(0.0, xs, ps), expected, rtol=1e-14)
    result = simulate(compiled, dict(zip(system.state_names, xs, strict=True)), (0, 0.1), ps)
    assert result.success
    np.testing.assert_array_equal(result.y[:, 0], xs)


@pytest.mark.slow
@pytest.mark.parametrize("compiler", COMPILERS)
def test_hostile_names_pass_strict_compilers(compiler, tmp_path):
    strictly_compile(files_of(hostile_system()), tmp_path, compiler)


@pytest.mark.sparse(5)
@pytest.mark.parametrize("name", ["1", "int", "θ", "", "*/", "main", "t", "a" * 300])
def test_hostile_names_of_systems_are_spelt(name, target, tmp_path):
    system = System(name, (Quantity(x),), (-x,), outputs=(Definition(Quantity(y), 2 * x),))
    compiled = compile_system(system, target)
    assert compiled.rhs(0.0, [2.0]).tolist() == [-2.0]
    for path in compiled.write(tmp_path):
        assert re.fullmatch(r"[A-Za-z]\w*\.(c|h|py|txt)|Makefile", path.name, re.ASCII)


def test_a_state_that_is_called_t_beside_another_time(target):
    """Time has a symbol of its own; the name t is then free for a state."""
    time, t = sp.Symbol("tau", real=True), sp.Symbol("t", real=True)
    system = System.from_rates("clash", {t: 2 * time - t}, time=time)
    compiled = compile_system(system, target)
    assert compiled.rhs(5.0, [3.0]).tolist() == [7.0]


def test_a_state_that_is_called_as_time_is_refused():
    with pytest.raises(InputError, match="repeated variable"):
        System.from_rates("clash", {sp.Symbol("t"): sp.Integer(1)})


def test_generated_texts_are_plain_ascii_without_trigraphs():
    compiled = compile_system(hostile_system(), "numpy")
    for target in ("c", "numpy"):
        for name, text in generate(compiled.program, compiled.layout, target).items():
            assert text.isascii()
            assert target != "c" or "??" not in text
            assert "\t" not in text or name == "Makefile"
            assert text.endswith("\n")


def test_names_can_be_read_from_the_numpy_module():
    compiled = compile_system(eom.free_rigid_body("3-1-2"), "numpy")
    module = load_module(compiled.source, "names")
    assert compiled.system.state_names == module.STATES
    assert compiled.system.parameter_names == module.PARAMETERS
    assert module.INPUTS == ()
    assert compiled.system.output_names == module.OUTPUTS
    assert compiled.system.invariant_names == module.INVARIANTS


def test_the_written_numpy_module_works_by_itself():
    compiled = compile_system(eom.free_rigid_body(), "numpy")
    module = load_module(compiled.source, "alone")
    states = np.array([[1.0, 2.0], [2.0, 3.0], [3.0, 4.0]])
    moments = np.array([1.0, 1.2, 1.5])
    np.testing.assert_array_equal(
        module.rates(0.0, states, moments), compiled.rhs(0.0, states, moments)
    )
    assert re.findall(r"^import (.*)$", compiled.source, re.MULTILINE) == ["numpy as np"]


# --- a C program ---------------------------------------------------------------------------------------

MAIN = r"""
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "free_rigid_body.h"
#include "free_rigid_body_dop853.h"

int main(void) {
    static double t[100000], x[100000][free_rigid_body_n_states];
    const double p[free_rigid_body_n_parameters] = {1.0, 1.2, 1.5};
    free_rigid_body_constants c;
    free_rigid_body_dop853 s;
    free_rigid_body_dop853_output o;
    double y[free_rigid_body_n_states];
    int status;
    memset(&s, 0, sizeof s);
    memset(&o, 0, sizeof o);
    s.t_end = 10.0, s.rtol = 1e-10, s.margin = 1e-6, s.h_max = HUGE_VAL;
    for (int i = 0; i < free_rigid_body_n_states; ++i) s.atol[i] = 1e-13, s.x[i] = 0.1 * (i + 1);
    o.t = t, o.x = &x[0][0], o.capacity = 100000;
    free_rigid_body_prepare(p, &c);
    free_rigid_body_rates(0.0, s.x, &c, NULL, y);
    for (int i = 0; i < free_rigid_body_n_states; ++i)
        printf("%s %.17g\n", free_rigid_body_state_name(i), y[i]);
    printf("%d\n", free_rigid_body_state_name(-1) == NULL && free_rigid_body_state_name(99) == NULL);
    status = free_rigid_body_dop853_start(&s, p, NULL);
    while (status == FREE_RIGID_BODY_DOP853_PAUSED) status = free_rigid_body_dop853_run(&s, NULL, &o, 5);
    printf("%d %zu %.17g\n", status, o.count, s.t);
    for (int i = 0; i < free_rigid_body_n_states; ++i) printf("%.17g\n", x[o.count - 1][i]);
    return free_rigid_body_dop853_size() == sizeof s ? 0 : 1;
}
"""


@pytest.mark.parametrize("compiler", COMPILERS)
def test_a_c_program_that_uses_the_written_files_agrees_with_python(compiler, tmp_path):
    compiled = compile_system(eom.free_rigid_body("3-1-2"))
    write_files(files_of(compiled.system), tmp_path)
    (tmp_path / "main.c").write_text(MAIN)
    sources = ["main.c", "free_rigid_body.c", "free_rigid_body_dop853.c"]
    build = subprocess.run(
        [compiler, *STRICT, "-o", "main", *sources, "-lm"],
        cwd=tmp_path, check=False, capture_output=True, text=True,
    )  # fmt: skip
    assert build.returncode == 0, build.stderr
    run = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True)
    lines = run.stdout.split("\n")
    states = 0.1 * np.arange(1, 7)
    rates = compiled.rhs(0.0, states, [1.0, 1.2, 1.5])
    for line, name, rate in zip(lines, compiled.system.state_names, rates, strict=False):
        assert line.split()[0] == name
        assert float(line.split()[1]) == pytest.approx(rate, rel=1e-14)
    assert lines[6] == "1"
    result = simulate(compiled, states, (0, 10), [1.0, 1.2, 1.5], "DOP853", 1e-10, 1e-13)
    status, count, end = lines[7].split()
    assert (int(status), float(end)) == (result.status, pytest.approx(result.t_stop, rel=1e-9))
    assert abs(int(count) - result.steps) <= 1
    np.testing.assert_allclose([float(v) for v in lines[8:14]], result.y_stop, rtol=1e-8)


@needs_compiler
def test_generated_c_can_be_called_from_cpp(tmp_path):
    if not shutil.which("g++"):
        return
    files = files_of(SYSTEMS["singular"]())
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "use.cpp").write_text('#include "free_rigid_body_dop853.h"\n')
    subprocess.run(["g++", "-Wall", "-Werror", "-c", "use.cpp"], cwd=tmp_path, check=True)
