"""Integrators in JavaScript: the steps, the dense output and the stops of the loop in C."""

import json
import re
import subprocess

import numpy as np
import pytest
import sympy as sp

import codegen
import eom
from codegen.compiling.compiled import generate
from codegen.ir.interpret import Point, interpret
from codegen.loops import javascript, projection
from codegen.loops.written import Choice
from codegen.native import native
from codegen.watch.narrow import narrow
from eom.errors import InputError
from eom.system import System
from eom.tables import Table
from tests import node
from tests.codegen.test_narrow import STEPS, WALLS, oscillator, t, v, x

needs = pytest.mark.skipif(not (node.NODE and native.compiler()), reason="no Node.js or no C")

LINKED = ("slider-crank", "rolling-disc", "whipple-bicycle")
DRIVER = """\
import * as system from "./{module}";
import {{ {method} }} from "./{method}.mjs";
const job = {job};
const s = {method}(system, job.options);
s.start(job.times[0], job.x, Float64Array.from(job.p, (v) => v ?? NaN), []);
const y = new Float64Array(job.x.length), found = [], arrays = new Set([s.x.buffer]);
for (const t of job.times) {{
  if (!s.advance(t)) break;
  found.push(Array.from(s.at(t, y)));
  arrays.add(s.x.buffer);
}}
const {{ t, x, steps, rejected, status, which }} = s;
const last = Array.from(x), buffers = arrays.size;
console.log(JSON.stringify({{found, t, last, steps, rejected, status, which, buffers}}));
"""


def run(system, x, p, times, folder, method="dop853", **options):
    """Integrate a system, or a program with its layout, in Node.js; return what the driver prints."""
    if isinstance(system, System):
        compiled = codegen.compile(system, "python")
        system = compiled.program, compiled.layout
    return driven(
        generate(*system, "javascript", Choice(method)), x, p, times, folder, method, options
    )


def driven(files, x, p, times, folder, method, options):
    """Run the files of a system in Node.js; return what the driver prints."""
    module = next(name for name in files if name != f"{method}.mjs")
    for name, text in files.items():
        (folder / name).write_text(text, encoding="ascii")
    job = json.dumps({"x": list(x), "p": list(p), "times": list(times), "options": options})
    text = DRIVER.format(module=module, method=method, job=job)
    (folder / "driver.mjs").write_text(text)
    done = subprocess.run(
        [node.NODE, "driver.mjs"], cwd=folder, check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def pendulum():
    q, u, g = sp.symbols("q u g", real=True)
    return System.from_rates(
        "pendulum", {q: u, u: -g * sp.sin(q)}, invariants={"E": u**2 / 2 - g * sp.cos(q)}
    )


@needs
@pytest.mark.parametrize(
    ("method", "name"), [("dop853", "DOP853"), ("dp5", "DP5"), ("tsit5", "Tsit5")]
)
def test_steps_and_states_are_those_of_the_loop_in_c(method, name, tmp_path):
    times = np.linspace(0, 10, 301)
    problem = pendulum(), [1.2, 0.3]
    got = run(*problem, [9.81], times, tmp_path, method, rtol=1e-9)
    options = {"method": name, "rtol": 1e-9, "atol": 1e-12}  # the default of JavaScript
    longer = codegen.simulate(*problem, (0, 12), [9.81], t_eval=times, **options)
    assert np.max(np.abs(np.array(got["found"]).T - longer.y)) < 1e-12
    same = codegen.simulate(*problem, (0, got["t"]), [9.81], **options)
    assert got["rejected"] == same.rejected
    assert same.steps - got["steps"] in {0, 1}  # the end may lie a rounding behind the last step
    assert got["buffers"] == 1
    assert got["t"] >= 10


@needs
@pytest.mark.parametrize(
    ("method", "name"), [("dop853", "DOP853"), ("dp5", "DP5"), ("tsit5", "Tsit5")]
)
def test_states_are_projected_as_in_the_loop_in_c(method, name, tmp_path):
    """Onto the energy of a pendulum: steps, ends and points between are those of projection.c."""
    system, start, times = pendulum(), [1.2, 0.3], np.linspace(0, 10, 301)
    compiled = codegen.compile(system, "python")
    parts = projection.extended(compiled.program, compiled.layout, ["E"])
    energy = 0.3**2 / 2 - 9.81 * np.cos(1.2)
    got = run(parts, start, [9.81, energy], times, tmp_path, method, rtol=1e-6)
    options = {"method": name, "rtol": 1e-6, "atol": 1e-9, "project": "E"}
    kept = codegen.simulate(system, start, (0, 12), [9.81], t_eval=times, **options)
    found = np.array(got["found"]).T
    assert np.max(np.abs(found - kept.y)) < 1e-9
    assert np.max(np.abs(found[1] ** 2 / 2 - 9.81 * np.cos(found[0]) - energy)) < 1e-13
    free = run(system, start, [9.81], times, tmp_path, method, rtol=1e-6)
    assert np.max(np.abs(np.array(free["found"]).T - found)) > 1e-8


@needs
@pytest.mark.parametrize(
    "name", ["four-bar-linkage", *(pytest.param(n, marks=pytest.mark.slow) for n in LINKED)]
)
def test_what_is_exported_keeps_constraints_as_the_loop_in_c(name, tmp_path):
    """What they are to be is taken from the start where parameters end before it, or are no numbers."""
    scene = eom.load_scene(name)
    system, times = scene.derive(), np.linspace(0, scene.integration.t_end, 101)
    start, numbers = scene.initial_values(), scene.parameter_values()
    assert system.maintained
    files = codegen.generate(system, target="javascript", integrator="tsit5")
    options = {"rtol": 1e-6, "atol": 1e-9}
    parts = files, list(start.values())
    p = list(numbers.values())
    got = driven(*parts, p, times, tmp_path, "tsit5", options)
    unknown = [*p, *[None] * len(system.maintained)]
    assert driven(*parts, unknown, times, tmp_path, "tsit5", options)["found"] == got["found"]
    values = system, start, (0, 2 * times[-1]), numbers, "Tsit5"
    kept, drifting = (
        codegen.simulate(*values, t_eval=times, project=onto, **options) for onto in (None, False)
    )
    found = np.array(got["found"]).T
    assert np.max(np.abs(found - kept.y)) < 1e-7 * np.abs(kept.y).max()
    closure = codegen.compile(system, "numpy").invariants
    left = [np.abs(closure(times, y, numbers)) for y in (found, drifting.y)]
    rows = [system.invariant_names.index(n) for n in system.maintained]
    assert left[0][rows].max() < 1e-12 < 1e-2 * left[1][rows].max()


@needs
def test_every_tableau_takes_its_coefficients_from_the_one_table(tmp_path):
    for name, tableau in javascript.TABLEAUX.items():
        text = javascript.files(name)[f"{name}.mjs"]
        for row in (*tableau.stages, tableau.error_high, *tableau.dense):
            assert all(repr(abs(weight)) in text for weight in row if weight)


@needs
def test_a_run_stops_where_angles_are_singular_as_in_c(tmp_path):
    scene = eom.Scene(**eom.Scene.ready("t-handle-in-angles").model_dump(exclude={"integrate"}))
    system, values = scene.derive(), scene.initial_values()
    numbers = scene.parameter_values()
    options = {"rtol": 1e-9, "margin": 0.2}
    kept = codegen.simulate(system, values, (0, 4), numbers, method="DOP853", **options)
    assert kept.status == 1
    x, p = list(values.values()), list(numbers.values())
    got = run(system, x, p, [0, 4], tmp_path, **options)
    assert (got["status"], got["which"]) == (1, 0)
    assert got["t"] == pytest.approx(kept.t_stop, abs=1e-9)
    assert got["last"] == pytest.approx(list(kept.y_stop), abs=1e-6)


@needs
def test_a_run_that_becomes_infinite_says_which_state(tmp_path):
    y = sp.Symbol("y", real=True)
    system = System.from_rates("blow_up", {y: sp.Integer(1), x: x**2})
    got = run(system, [0.0, 1.0], [], [0, 2], tmp_path)
    assert got["status"] < 0
    assert got["t"] == pytest.approx(1.0, abs=1e-3)
    got = run(system, [0.0, float("1e200")], [], [0, 2], tmp_path)
    assert (got["status"], got["which"]) == (-2, 1)


def test_an_integrator_stands_beside_javascript_and_c_alone():
    compiled = codegen.compile(pendulum(), "python")
    parts = compiled.program, compiled.layout
    assert set(generate(*parts, "javascript", Choice("tsit5"))) == {"pendulum.mjs", "tsit5.mjs"}
    assert set(generate(*parts, "javascript")) == {"pendulum.mjs"}
    with pytest.raises(InputError, match="no such integrator in JavaScript"):
        generate(*parts, "javascript", Choice("taylor"))
    with pytest.raises(InputError, match="c and javascript alone"):
        generate(*parts, "numpy", Choice("dop853"))


# --- narrow features -------------------------------------------------------------------------------

a, b, w = sp.symbols("a b w", real=True)
KICKED = (
    System.from_rates("kicked", {x: v, v: -sp.sin(x) + a * sp.exp(-(((t - b) / w) ** 2))}, time=t),
    [0.3, 0.0],
    [20.0, 2.0, 0.02],
    10.0,
)
PEAK = Table("peak", [-9, 0.5, 0.505, 0.51, 9], [0, 0, 100, 0, 0])
IN_TIME = {"kicked": KICKED} | {
    name: (oscillator(force), [0.0, 0.0], [], float(pieces[-1]))
    for name, (force, pieces) in {"window": STEPS["window"], "table": STEPS["table"]}.items()
}
IN_STATES = {
    name: (oscillator(WALLS[name][0]), list(WALLS[name][2]), [], WALLS[name][1])
    for name in ("friction", "floor", "bump")
}
THROUGH = {
    "slab": sp.Piecewise((1000, (x > sp.Rational(1, 2)) & (x < sp.Rational(501, 1000))), (0, True)),
    "peak": PEAK(x),
}
IN_PIECES = {
    name: (System.from_rates("thrown", {x: v, v: force}, time=t), [-3.0, 2.0], [], 3.0)
    for name, force in THROUGH.items()
}
NARROW = IN_TIME | IN_STATES | IN_PIECES


@needs
@pytest.mark.sparse(4)
@pytest.mark.parametrize("name", NARROW)
def test_narrow_features_are_met_by_the_steps_of_the_loop_in_c(name, tmp_path):
    """The end of the run in C is far away: it bounds the last steps there, and JavaScript has none."""
    system, start, p, end = NARROW[name]
    for method, in_c in (("dop853", "DOP853"), ("tsit5", "Tsit5")):
        got = run(system, start, p, [0, end], tmp_path, method, rtol=1e-6)
        kept = codegen.simulate(system, start, (0, 40 * end), p, method=in_c, rtol=1e-6, atol=1e-9)
        assert kept.t[got["steps"]] == pytest.approx(got["t"], rel=1e-4)
        assert kept.y[:, got["steps"]] == pytest.approx(got["last"], rel=1e-3, abs=1e-3)
        same = codegen.simulate(
            system, start, (0, got["t"]), p, method=in_c, rtol=1e-12, atol=1e-14
        )
        assert got["last"] == pytest.approx(same.y[:, -1], abs=2e-4)


@needs
@pytest.mark.parametrize("name", ["kicked", "slab"])
def test_frames_do_not_change_the_motion(name, tmp_path):
    system, start, p, end = NARROW[name]
    once = run(system, start, p, [0, end], tmp_path, rtol=1e-9)
    often = run(system, start, p, np.linspace(0, end, 301), tmp_path, rtol=1e-9)
    assert {k: once[k] for k in ("t", "last", "steps")} == {
        k: often[k] for k in ("t", "last", "steps")
    }


@needs
def test_what_modules_export_to_be_watched_is_what_the_oracle_computes():
    """Every program of `codegen.watch.narrow`, with tables of its own, at random values of its slots."""
    force = a * sp.exp(-(((t - b) / w) ** 2)) + PEAK(t) * PEAK(x) + sp.sign(x - v) + sp.log(x / b)
    system = System.from_rates("watched", {x: v, v: force}, time=t)
    compiled = codegen.compile(system, "python")
    (text,) = generate(compiled.program, compiled.layout, "javascript").values()
    found, draw = narrow(compiled.program), np.random.default_rng(4)
    programs = {"ahead": found.ahead, "watched": found.watched, "verdict": found.verdict}
    slots = {"ahead": 4, "watched": 2, "verdict": 3 * found.columns + 1}
    jobs = []
    for group, program in programs.items():
        points = [
            (draw.uniform(0, 1), draw.uniform(0.1, 1, slots[group]), draw.uniform(0.1, 2, 3), [])
            for _ in range(20)
        ]
        jobs.append(node.Job(text, group, points, len(program.results[group])))
    for job, rows in zip(jobs, node.run(jobs), strict=True):
        for (at, xs, ps, us), row in zip(job.points, rows, strict=True):
            expected = interpret(programs[job.group], Point(at, xs, ps, us))[job.group]
            assert row == pytest.approx(expected, rel=1e-12)
    reported = json.loads(re.search(r"^export const WATCH = (.*);$", text, re.MULTILINE)[1])
    assert reported["columns"] == found.columns
    assert reported["guards"] == found.guards > 0
    assert reported["pieces"] == found.pieces > 0
    assert [tuple(pair) for pair in reported["always"]] == list(found.soon)
    assert tuple(reported["toZero"]) == found.to_zero


def test_modules_with_nothing_to_watch_have_no_word_of_it():
    compiled = codegen.compile(pendulum(), "python")
    (text,) = generate(compiled.program, compiled.layout, "javascript").values()
    assert re.findall(r"^export (?:const|function) (\w+)", text, re.MULTILINE) == [
        "TITLE", "STATES", "PARAMETERS", "INPUTS", "OUTPUTS", "INVARIANTS", "SIZES", "COORDINATES",
        "rates", "invariants",
    ]  # fmt: skip
