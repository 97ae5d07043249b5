"""The accuracy report: known cancellations, its condition numbers and bounds, its points and words."""

import json
import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import eom
from codegen import accuracy
from codegen import compile as compile_system
from codegen.frontend.layout import Layout
from codegen.frontend.lower import lower_expressions, lower_system
from codegen.ir.interpret import Point, interpret_exactly
from codegen.precision import accuracy_report
from codegen.precision.accuracy import MAX_LENGTH, formula
from codegen.precision.conditioning import MAX_LOST, Trace, everything, operations
from codegen.precision.domain import (
    ACCURATE,
    DISTANCES,
    EXACT,
    EXTREME,
    ILL,
    NOT_A_NUMBER,
    OVERFLOWS,
    REGIONS,
    SINGULAR,
    TYPICAL,
    UNDERFLOWS,
    UNSTABLE,
    VERDICTS,
    ZERO,
    domain_of,
    places,
)
from eom import Scene, load_scene
from eom.errors import InputError
from eom.quantities import TIME, Quantity
from eom.system import System
from tests.codegen.scenes import SCENES

pytestmark = pytest.mark.sparse

x, y, a, b, c, u = sp.symbols("x y a b c u", real=True)


def system_of(**outputs):
    """A system at rest with outputs; numbers a, b, c are parameters."""
    rates = {x: sp.Integer(0) * x, y: sp.Integer(0) * y}
    return System.from_rates("given", rates, outputs=outputs)


def report_of(domain, stable=False, target="numpy", samples=40, **outputs):
    compiled = compile_system(system_of(**outputs), target, stable=stable)
    return accuracy(compiled, domain, samples)


def verdicts(report, result, group="outputs"):
    return {r.region: r.verdict for r in report.rows if (r.group, r.result) == (group, result)}


KNOWN = {
    "versine": ((1 - sp.cos(x)) / y**2, {"x": (1e-6, 1e-2), "y": (1, 2)}, "1 - cos(x)", 4),
    "roots": (sp.sqrt(x + 1) - sp.sqrt(x), {"x": (1e6, 1e12)}, "sqrt(x + 1) - sqrt(x)", 6),
    "quadratic formula": (
        (-b + sp.sqrt(b**2 - 4 * a * c)) / (2 * a),
        {"a": (0.5, 2), "b": (1e4, 1e7), "c": (0.5, 2)},
        "sqrt(b**2 - ...*4) - b",
        7,
    ),
    "inverse cosine": (sp.acos(1 - x), {"x": (1e-12, 1e-8)}, "acos(1 - x)", 6),
}


@pytest.mark.parametrize("name", KNOWN)
def test_known_cancellations_are_found_named_and_cured(target, name):
    expression, domain, place, digits = KNOWN[name]
    plain = report_of(domain, target=target, f=expression)
    row = plain.row("f", TYPICAL, "outputs")
    assert row.verdict == UNSTABLE
    assert row in plain.unstable
    assert row.worst.ulps > 10.0**digits / 100
    assert row.judged.cause.formula == place
    assert digits <= row.judged.cause.digits <= MAX_LOST
    (gain,) = [g for g in plain.possible.gains if g.result == "f"]
    assert gain.before > 1e4 * gain.after
    stable = report_of(domain, stable=True, target=target, f=expression)
    assert verdicts(stable, "f")[TYPICAL] == ACCURATE
    assert stable.row("f", TYPICAL, "outputs").worst.ulps < 20
    assert [g.result for g in stable.made.gains] == ["f"]
    assert stable.possible.identities == ()


def test_ill_conditioned_is_distinguished_from_unstable():
    """x cos x next to its zero at pi/2 is sensitive to x; the same digits lost by 1 - cos x are not."""
    near = {"x": (1.5, 1.6), "y": (1e-3, 1e-2)}
    report = report_of(near, f=sp.sin(x) * y - a * y, g=1 - sp.cos(y))
    assert verdicts(report, "g")[TYPICAL] == UNSTABLE
    report = report_of({"x": (1.0, 1.0 + 1e-6), "a": (1.0, 1.0 + 1e-6)}, samples=100, f=x**3 - a**3)
    row = report.row("f", TYPICAL, "outputs")
    assert row.verdict == ILL
    assert row.worst.ulps > 1e5
    assert row.worst.condition > 1e5
    assert row.judged.cause.digits > 4


def test_well_conditioned_polynomial_and_exact_results(target):
    report = report_of({"x": (0.0, 1.0)}, target=target, f=3 * x**3 + x + 1, g=2 * x, h=-y)
    for row in report.rows:
        assert row.verdict == (ACCURATE if row.result == "f" else EXACT)
        if row.result == "f":
            assert 0 < row.typical <= 1.0 <= row.worst.bound
            assert row.worst.ulps <= row.worst.bound
        else:
            assert row.worst.ulps == row.typical == 0.0
    assert report.row("f", TYPICAL, "outputs").worst.condition < 4
    assert report.made == report.possible
    assert report.unstable == ()


@pytest.mark.sparse(1)
@pytest.mark.parametrize("name", SCENES)
def test_ready_scenes_are_stable_and_never_exceed_the_bound(target, name):
    scene = load_scene(name)
    if scene.derive().maintained:
        pytest.skip("points are drawn that do not meet the constraints")
    around = {**scene.initial_values(), **scene.parameter_values()}
    report = accuracy(compile_system(scene.derive(), target), samples=25, around=around)
    assert report.unstable == ()
    found = [f for r in report.rows for f in (r.worst, r.judged) if f is not None]
    assert len(found) > len(report.rows) / 2
    assert all(f.ulps <= f.bound for f in found)
    usual = [r for r in report.rows if r.region != EXTREME]
    assert max(VERDICTS.index(r.verdict) for r in usual) <= VERDICTS.index(ILL)
    assert all(r.typical < 4 for r in usual)


def test_tilted_wheel_is_measured_up_to_its_singular_angle():
    scene = Scene.ready("lecture-wheel")
    around = {**scene.initial_values(), **scene.parameter_values()}
    compiled = compile_system(scene.derive(), "numpy")
    report = accuracy(compiled, samples=3, around=around, jacobians=["states"])
    drawn = [
        p
        for p in places(
            compiled.program,
            compiled.layout,
            domain_of(compiled.program, compiled.layout, {}, around),
            3,
            0,
        )
        if p.region == SINGULAR
    ]
    angles = np.array([p.point.x[0] for p in drawn])
    distances = np.abs(np.abs(angles) - np.pi / 2)
    assert len(angles) == 4 * len(DISTANCES)  # two angles, both sides
    assert distances.min() < 2e-15
    assert distances.max() == pytest.approx(0.1)
    assert {"-", "+"} == {"-" if v < 0 else "+" for v in angles}
    for result in ("theta_dot", "psi_dot"):
        assert report.row(result, SINGULAR).verdict == ACCURATE
    entry = report.row("d psi_dot'/d theta", SINGULAR, "jacobian by states")
    assert entry.verdict == ACCURATE
    assert entry.worst.ulps <= entry.worst.bound


def test_worst_points_can_be_reproduced():
    compiled = compile_system(system_of(f=(1 - sp.cos(x)) * a + y), "numpy")
    report = accuracy(compiled, {"y": (0, 1e-9)}, 30, seed=3)
    found = report.row("f", TYPICAL, "outputs").worst
    got = compiled.outputs(0.0, [found.at["x"], found.at["y"]], [found.at["a"]])
    assert got[0] == found.value
    exact = mpmath.mpf(found.at["a"]) * (1 - mpmath.cos(mpmath.mpf(found.at["x"]))) + found.at["y"]
    assert float(exact) == pytest.approx(found.exact, rel=1e-10)
    again = accuracy(compiled, {"y": (0, 1e-9)}, 30, seed=3)
    assert again == report
    assert again.rows == report.rows
    assert accuracy(compiled, {"y": (0, 1e-9)}, 30, seed=4).rows != report.rows


EXTREMES = {
    "overflow of a square": (sp.sqrt(x**2 + y**2 + a), OVERFLOWS),
    "overflow of exp": (sp.exp(x * 1000) / sp.exp(x * 1000 + y), OVERFLOWS),
    "underflow of a square": (x**2 / sp.Abs(x), OVERFLOWS),
    "denormal product": (x * y / sp.Abs(x), OVERFLOWS),
    "pole at zero": (1 / x, ACCURATE),
    "root of negatives": (sp.sqrt(x), ACCURATE),
    "logarithm": (sp.log(sp.Abs(x)), ACCURATE),
}


@pytest.mark.parametrize("name", EXTREMES)
def test_denormals_and_overflow_are_verdicts_not_crashes(target, name):
    expression, worst = EXTREMES[name]
    report = report_of({"x": (-2, 2), "y": (-2, 2)}, target=target, samples=10, f=expression)
    found = verdicts(report, "f")
    assert set(found) == {TYPICAL, ZERO, EXTREME}
    assert found[TYPICAL] in {EXACT, ACCURATE, ILL, OVERFLOWS}
    allowed = {EXACT, ACCURATE, ILL, UNDERFLOWS, OVERFLOWS, NOT_A_NUMBER}
    assert set(found.values()) <= allowed
    assert found[EXTREME] == worst
    assert json.loads(json.dumps(accuracy_report.as_data(report), allow_nan=False))
    assert list(accuracy_report.sentences(report))


def test_underflow_has_its_own_verdict():
    tiny = (1e-170, 1e-160)
    report = report_of({"x": tiny, "y": tiny}, samples=10, f=sp.sqrt(x**2 + x * y + y**2))
    assert verdicts(report, "f")[TYPICAL] == UNDERFLOWS


def test_results_that_leave_the_domain_by_rounding_are_not_numbers():
    """A square, multiplied out, leaves less than zero under the root."""
    root = sp.sqrt((x + 1) ** 2 - x**2 - 2 * x - 1 + y)
    report = report_of({"x": (0.1, 1), "y": (1e-20, 1e-19)}, samples=60, f=root)
    row = report.row("f", TYPICAL, "outputs")
    assert row.failed.verdict == NOT_A_NUMBER
    assert math.isnan(row.failed.value)
    assert 0 < row.failed.exact < 1e-9
    assert row.verdict == UNSTABLE  # where it is a number, it is zero


# --- the analysis itself --------------------------------------------------------------------------


SMOOTH = (
    x * y + sp.sin(x),
    sp.exp(x - y) / (2 + y**2),
    sp.sqrt(x**2 + 1) * sp.atan2(y, x),
    x**5 - y**3,
)


@settings(max_examples=40)
@given(st.sampled_from(SMOOTH), st.floats(0.1, 3), st.floats(0.1, 3))
def test_condition_numbers_are_those_of_sympy(expression, vx, vy):
    program = lower_expressions({"f": [expression]}, (x, y))
    trace = Trace(everything(program), Point(x=[vx, vy]))
    values = {x: sp.Rational(vx), y: sp.Rational(vy)}
    size = sum(abs(s * sp.diff(expression, s)) for s in (x, y))
    expected = sp.N((size / abs(expression)).subs(values), 30)
    assert trace.condition(program.results["f"][0]) == pytest.approx(float(expected), rel=1e-12)


@settings(max_examples=40)
@given(st.floats(0.1, 3), st.floats(0.1, 3))
def test_own_errors_times_adjoints_add_up_to_the_error(vx, vy):
    """To first order: Higham, sect. 3.3."""
    expression = (1 - sp.cos(x * y)) / (x**2 + sp.exp(y)) + sp.sin(x + y) / 3
    program = lower_expressions({"f": [expression]}, (x, y))
    trace = Trace(everything(program), Point(x=[vx, vy]))
    result = program.results["f"][0]
    predicted = sum(bar * trace.own_error(k) for k, bar in trace.adjoint(result).items())
    observed = trace.doubles[result] - trace.values[result]
    assert abs(predicted - observed) <= 1e-28


def test_operations_leave_constants_out():
    program = lower_expressions({"f": [sp.sqrt(2) * x + 1, x]}, (x,))
    assert [operations(program, k) for k in program.results["f"]] == [2, 0]


def test_formulas_have_names_brackets_and_bounded_length():
    system = system_of(f=(x + y) * a - x / (y * a), g=-((x - y) ** 2), h=sp.atan2(x, y) * 2 * TIME)
    program, layout = lower_system(system), Layout.of(system)
    texts = [formula(program, k, layout) for k in program.results["outputs"]]
    assert texts[1] == "-(x - y)**2"
    assert texts[2] in {"2*t*atan2(x, y)", "t*atan2(x, y)*2", "atan2(x, y)*t*2", "t*2*atan2(x, y)"}
    assert (
        sp.simplify(
            sp.sympify(texts[0], locals={"x": x, "y": y, "a": a}) - system.outputs[0].expression
        )
        == 0
    )
    deep = x
    for _ in range(60):
        deep = sp.sin(deep) * y + a
    program = lower_system(system_of(f=deep))
    assert len(formula(program, program.results["outputs"][0], layout)) <= MAX_LENGTH


def test_named_values_are_called_by_name():
    system = eom.gravity_gradient_satellite()
    program, layout = lower_system(system), Layout.of(system)
    assert "torque_1" in formula(program, program.results["rates"][0], layout)


# --- where it measures ----------------------------------------------------------------------------


def test_default_ranges_are_what_a_user_expects():
    scene = Scene.ready("heavy-top")
    system = scene.derive()
    program, layout = lower_system(system), Layout.of(system)
    around = {**scene.initial_values(), **scene.parameter_values()}
    domain = domain_of(program, layout, {}, around)
    ranges = domain.ranges()
    assert ranges["omega_1"] == (-0.4, 0.4)  # twice the largest of its unit
    assert ranges["g"] == pytest.approx((9.0, 11.0))
    drawn = [p.point for p in places(program, layout, domain, 30, 1) if p.region == TYPICAL]
    quaternions = np.array([p.x[2:6] for p in drawn])
    np.testing.assert_allclose(np.sum(quaternions**2, axis=0 + 1), 1.0, rtol=1e-14)
    assert all(9 <= p.p[layout_names(layout).index("g")] <= 11 for p in drawn)
    wheel = Scene.ready("lecture-wheel").derive()
    angles = domain_of(lower_system(wheel), Layout.of(wheel), {}, {}).ranges()
    assert angles["theta"] == angles["psi"] == (-math.pi, math.pi)
    assert angles["C"] == (-2.0, 2.0)
    assert angles["I1"] == (0.5, 2.0)


def layout_names(layout):
    return [q.name for q in layout.parameters]


def test_stated_ranges_and_held_numbers_are_kept():
    system = replace(
        System.from_rates("driven", {x: u * a + TIME}, inputs=[u]), inputs=(Quantity(u, "N"),)
    )
    program, layout = lower_system(system), Layout.of(system)
    domain = domain_of(program, layout, {"x": (3, 4), "a": 2, "t": (5, 6)}, {"u": -3.0})
    drawn = [p.point for p in places(program, layout, domain, 20, 0) if p.region == TYPICAL]
    assert all(3 <= p.x[0] <= 4 and p.p[0] == 2 and 5 <= p.t <= 6 for p in drawn)
    assert all(-6 <= p.u[0] <= 0 for p in drawn)
    report = accuracy(compile_system(system, "numpy"), {"t": (5, 6)}, 5)
    assert report.domain["t"] == (5, 6)
    assert "t" in report.row("x").worst.at


def test_regions_hold_zeros_and_every_magnitude():
    system = system_of(f=x * y)
    program, layout = lower_system(system), Layout.of(system)
    drawn = list(places(program, layout, domain_of(program, layout, {}, {}), 1, 0))
    assert [r for r in REGIONS if any(p.region == r for p in drawn)] == [TYPICAL, ZERO, EXTREME]
    zero = [p.point.x for p in drawn if p.region == ZERO]
    assert [0.0, 0.0] in zero
    assert any(v[0] == 0 != v[1] for v in zero)
    assert any(v[1] == 0 != v[0] for v in zero)
    sizes = [max(map(abs, p.point.x)) for p in drawn if p.region == EXTREME]
    assert min(sizes) < 1e-299
    assert max(sizes) > 1e299


def test_angles_are_not_made_huge():
    wheel = Scene.ready("lecture-wheel").derive()
    program, layout = lower_system(wheel), Layout.of(wheel)
    drawn = list(places(program, layout, domain_of(program, layout, {}, {}), 1, 0))
    extreme = [p.point.x for p in drawn if p.region == EXTREME]
    assert max(abs(v[0]) for v in extreme) <= math.pi
    assert max(abs(v[2]) for v in extreme) > 1e290


BAD = {
    "unknown name": ({"thta": (0, 1)}, "unknown name 'thta'"),
    "reversed": ({"x": (2, 1)}, "range is reversed"),
    "empty": ({"x": (1, 1)}, "range is empty"),
    "nan": ({"x": (math.nan, 1)}, "range is not finite"),
    "infinite": ({"x": (0, math.inf)}, "range is not finite"),
    "too wide": ({"x": (-1.7e308, 1.7e308)}, "range is not finite"),
    "text": ({"x": "ab"}, "domain is of the wrong type\n.*entry str 'x'\n.*str 'ab'"),
    "three numbers": ({"x": (1, 2, 3)}, "domain is of the wrong type\n.*entry str 'x'\n"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_domains_are_refused(case):
    domain, message = BAD[case]
    compiled = compile_system(system_of(f=x), "numpy")
    with pytest.raises(InputError, match=message):
        accuracy(compiled, domain, 3)


def test_other_bad_input_is_refused():
    wheel = compile_system(Scene.ready("lecture-wheel").derive(), "numpy")
    with pytest.raises(InputError, match="I1 is not positive"):
        accuracy(wheel, {"I1": (0, 1)}, 3)
    for samples in (0, -1, True):
        with pytest.raises(InputError, match="number of samples"):
            accuracy(wheel, samples=samples)
    with pytest.raises(InputError, match="samples is of the wrong type"):
        accuracy(wheel, samples=2.5)
    with pytest.raises(InputError, match="kind of variable"):
        accuracy(wheel, samples=1, jacobians=["state"])
    with pytest.raises(InputError, match="unknown name"):
        accuracy(wheel, samples=1, around={"phi": 1.0})
    with pytest.raises(InputError, match="no such row"):
        accuracy(wheel, samples=1).row("nobody")


# --- what is printed --------------------------------------------------------------------------------


def test_the_text_names_cause_and_advice(capsys):
    report = report_of({"x": (1e-6, 1e-2)}, f=(1 - sp.cos(x)) / (2 + y), g=x)
    accuracy_report.show(report, as_json=False)
    text = capsys.readouterr().out
    assert "1 - cos(x) loses" in text
    assert "compile with stable=True" in text
    assert "by 1 - cos x = 2 sin^2(x/2)" in text
    assert "unstable" in text
    accuracy_report.show(report_of({}, samples=5, g=x), as_json=False)
    assert "rewritten: nothing" in capsys.readouterr().out


def test_json_holds_every_number(capsys):
    report = report_of({"x": (-1, 1)}, samples=5, f=sp.sqrt(x**2 + y**2))
    accuracy_report.show(report, as_json=True)
    data = json.loads(capsys.readouterr().out)
    assert len(data["rows"]) == len(report.rows)
    for plain, row in zip(data["rows"], report.rows, strict=True):
        assert plain["verdict"] == row.verdict
        assert plain["worst"]["at"] == row.worst.at
        assert plain["worst"]["value"] == row.worst.value


def test_progress_goes_from_nothing_to_all():
    seen = []
    compiled = compile_system(system_of(f=x * y), "numpy")
    accuracy(compiled, samples=5, jacobians=["states"], progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    assert len(seen) > 10


def test_values_at_50_digits_are_those_of_the_interpreter():
    program = lower_expressions({"f": [x - sp.sin(x)]}, (x,))
    point = Point(x=[0.25])
    trace = Trace(everything(program), point)
    assert trace.values[program.results["f"][0]] == interpret_exactly(program, point)["f"][0]
