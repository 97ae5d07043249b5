"""Integrators in JavaScript: the steps, the dense output and the stops of the loop in C."""

import json
import subprocess

import numpy as np
import pytest
import sympy as sp

import codegen
import eom
from codegen import native
from codegen.compiled import generate
from codegen.integrate import javascript
from codegen.integrate.written import Choice
from eom.errors import InputError
from eom.system import System
from tests import node

needs = pytest.mark.skipif(not (node.NODE and native.compiler()), reason="no Node.js or no C")

DRIVER = """\
import * as system from "./{module}";
import {{ {method} }} from "./{method}.mjs";
const job = {job};
const s = {method}(system, job.options);
s.start(job.times[0], job.x, job.p, []);
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
    """Integrate in Node.js; return what the driver prints."""
    compiled = codegen.compile(system, "python")
    files = generate(compiled.program, compiled.layout, "javascript", Choice(method))
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
def test_every_tableau_takes_its_coefficients_from_the_one_table(tmp_path):
    for name, tableau in javascript.TABLEAUX.items():
        text = javascript.files(name)[f"{name}.mjs"]
        for row in (*tableau.stages, tableau.error_high, *tableau.dense):
            assert all(repr(abs(weight)) in text for weight in row if weight)


@needs
def test_a_run_stops_where_angles_are_singular_as_in_c(tmp_path):
    scene = eom.Scene.ready("t-handle-in-angles")
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
    x, y = sp.symbols("x y", real=True)
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
