"""Functional mock-up units, run by FMPy: our own trajectories, and calls that no tool should make."""

import ctypes
import io
import shutil
import subprocess
import xml.etree.ElementTree as ET
import zipfile
from contextlib import contextmanager

import numpy as np
import pytest
import sympy as sp
from click.testing import CliRunner

import codegen
import eom
from codegen.fmu import package
from codegen.fmu.unit import INPUT, PARAMETER, STATE, unit
from codegen.native import native
from eom.__main__ import main
from eom.errors import InputError
from tests.codegen.test_targets import STRICT

X, V, U, K, D, Z, Y, W = sp.symbols("x v u k d z y w", real=True)
PENDULUM = eom.System.from_rates(
    "pendulum", {X: V, V: U - K * sp.sin(X)}, inputs=[U], outputs={"force": U - K * X**2}
)
FRICTION = eom.System.from_rates("friction", {X: V, V: U - K * X - sp.sign(V) / 4}, inputs=[U])
START, VALUES = {"x": 1.0, "v": 0.0}, {"k": 2.0}
SCENES = [
    "t-handle",
    "heavy-top",
    "double-pendulum",
    "reaction-wheels",
    "four-bar-linkage",
    "rocket",
]
SPAN = (0.0, 1.0)
fmpy = pytest.importorskip("fmpy")
needs_compiler = pytest.mark.skipif(not native.compiler(), reason="no C compiler")


def made(system=PENDULUM, initial=START, parameters=VALUES, inputs=None, **more):
    compiled = codegen.compile(system, "numpy")
    return unit(compiled, initial, parameters, inputs if inputs is not None else {"u": 0.5}, **more)


def described(text):
    return ET.fromstring(text)


# --- what is written -------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", package.VERSIONS)
def test_the_description_has_every_variable_with_unit_meaning_and_start(version):
    scene = eom.load_scene("heavy-top")
    whole = unit(codegen.compile(scene.derive(), "numpy"), scene.initial_values(),
                 scene.parameter_values(), scene.input_values())  # fmt: skip
    root = described(package.files(whole, version, ())["modelDescription.xml"])
    rows = root.findall("ModelVariables/*")
    names = {v.get("name"): v for v in rows}
    layout = whole.compiled.layout
    known = {q.name: q for q in (*layout.known,)}
    for v in whole.variables:
        row = names[v.name]
        real = row.find("Real") if version == "2.0" else row
        assert int(row.get("valueReference")) == v.reference
        assert real.get("unit") == (v.unit or "1")
        assert (real.get("start") is not None) == (v.kind in {STATE, PARAMETER, INPUT})
        if v.name in known:
            assert v.unit == known[v.name].unit
    units = {u.get("name"): u.find("BaseUnit") for u in root.findall("UnitDefinitions/Unit")}
    assert set(units) == {v.unit or "1" for v in whole.variables}
    assert units["rad/s"].attrib == {"s": "-1", "rad": "1"}
    assert units["kg m^2"].attrib == {"kg": "1", "m": "2"}
    assert names["der(omega_1)"].get("causality") == "local"


def test_dependencies_are_those_of_the_formulas_and_no_two_variables_have_one_name():
    system = eom.System.from_rates(
        "twins",
        {X: V, V: sp.sign(U) - X},
        inputs=[U],
        outputs={"der(x)": 3 * V, "y": sp.Integer(2)},
    )
    whole = made(system, parameters={}, inputs={"u": 0.0})
    assert len({v.name for v in whole.variables}) == len(whole.variables)
    states, (u,) = whole.of(STATE), whole.of(INPUT)
    assert whole.dependencies("rates", 0) == (states[1].reference,)
    assert whole.dependencies("rates", 1) == (states[0].reference, u.reference)
    assert whole.dependencies("outputs", 0) == (states[1].reference,)
    assert whole.dependencies("outputs", 1) == ()


def test_hostile_names_are_told_apart_and_do_no_harm():
    names = ["a<b>&\"'", "two\nlines", "two lines", "%s%n", "der(%s%n)", "*/ #error"]
    states = [sp.Symbol(n, real=True) for n in names]
    rates = dict(zip(states, [*states[1:], states[0]], strict=True))
    whole = made(eom.System.from_rates("hostile", rates), dict.fromkeys(names, 1.0), {}, {})
    for version in package.VERSIONS:
        files = package.files(whole, version, ())
        rows = described(files["modelDescription.xml"]).findall("ModelVariables/*")
        found = [row.get("name") for row in rows]
        assert len(set(found)) == len(found) == 1 + 2 * len(names)
        assert found[1:4] == ["a<b>&\"'", "two lines", "two lines (state)"]
        assert all(text.isascii() for text in package.sources(whole, version).values())


def test_files_of_the_archive_can_be_read_and_libraries_run():
    packed = package.archive({"binaries/x86_64-linux/a.so": b"", "sources/a.c": b""})
    listed = zipfile.ZipFile(io.BytesIO(packed)).infolist()
    assert [oct(entry.external_attr >> 16) for entry in listed] == ["0o755", "0o644"]


def test_the_command_line_refuses_what_does_not_go_with_units(tmp_path):
    for more in (["--fixed"], ["--jacobian", "states"], ["--fmi", "1.0"], ["--platform", "amiga"]):
        command = ["generate", "t-handle", "--target", "fmu", "--out", str(tmp_path), *more]
        assert CliRunner().invoke(main, command).exit_code == 2
    command = ["generate", "t-handle", "--target", "c", "--out", str(tmp_path), "--fmi", "2.0"]
    assert CliRunner().invoke(main, command).exit_code == 2
    assert list(tmp_path.iterdir()) == []


def test_the_same_values_give_the_same_bytes_and_other_values_another_token():
    first, again, other = made(), made(), made(parameters={"k": 3.0})
    texts = [package.sources(w, "3.0") for w in (first, again, other)]
    assert texts[0] == texts[1]
    assert texts[0]["pendulum_fmu.c"] != texts[2]["pendulum_fmu.c"]
    assert package.archive({"b": b"1", "a": b"2"}) == package.archive({"a": b"2", "b": b"1"})
    assert all(text.isascii() for text in texts[0].values())


@needs_compiler
@pytest.mark.parametrize("version", ["3.0", pytest.param("2.0", marks=pytest.mark.slow)])
def test_strict_compilers_accept_the_sources(version, tmp_path):
    sampled = PENDULUM.with_control({"u": -K * X - Z}, {"z": Z + X / 10}, period=0.1, delay=0.03)
    for k, whole in enumerate((made(sampled, inputs={}), made(FRICTION))):
        folder = tmp_path / str(k)
        folder.mkdir()
        texts = package.sources(whole, version)
        for name, text in texts.items():
            (folder / name).write_text(text)
        files = [n for n in texts if n.endswith(".c")]
        strict = [f for f in STRICT if f not in {"-O2", "-Wconversion"}]
        run = subprocess.run(
            [*native.compiler(), *strict, "-O0", "-c", *files],
            cwd=folder, check=False, capture_output=True, text=True,
        )  # fmt: skip
        assert run.stderr == ""


def test_what_is_refused_names_what_to_do(tmp_path):
    with pytest.raises(InputError, match="come from outside") as error:
        made(inputs={"u": lambda t: t})
    assert "formula of the system" in error.value.hint
    with pytest.raises(InputError, match="missing parameter"):
        made(parameters={})
    with pytest.raises(InputError, match="no tolerance"):
        made(rtol=0.0)
    with pytest.raises(InputError, match="ends before it begins"):
        made(t_span=(1.0, 0.0))
    with pytest.raises(InputError, match="version of FMI"):
        codegen.write_fmu(PENDULUM, tmp_path, START, VALUES, {"u": 0}, version="1.0")
    with pytest.raises(InputError, match="platform"):
        codegen.write_fmu(PENDULUM, tmp_path, START, VALUES, {"u": 0}, platforms=["amiga"])
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        codegen.write_fmu(PENDULUM, tmp_path / "file", START, VALUES, {"u": 0})


@pytest.mark.parametrize(
    ("system", "machine", "name"),
    [
        ("Linux", "x86_64", "x86_64-linux"),
        ("Windows", "AMD64", "x86_64-windows"),
        ("Darwin", "arm64", "aarch64-darwin"),
        ("Darwin", "x86_64", "x86_64-darwin"),
        ("Linux", "aarch64", "aarch64-linux"),
    ],
)
def test_platforms_have_the_names_of_the_standard(system, machine, name):
    assert package.this_platform(system, machine) == name
    assert name in package.PLATFORMS
    assert name in native.ZIG_TARGETS


def test_without_a_compiler_the_archive_holds_sources_alone(monkeypatch):
    monkeypatch.setattr(native, "compiler", tuple)
    found = package.files(made(), "3.0")
    assert not any(name.startswith("binaries") for name in found)
    assert "sources/pendulum_fmu.c" in found


# --- what FMPy makes of it -------------------------------------------------------------------------------


def ends(path, names, kind, **more):
    found = fmpy.simulate_fmu(
        str(path), fmi_type=kind, stop_time=SPAN[1], output_interval=0.1, relative_tolerance=1e-9, **more
    )  # fmt: skip
    return np.array([found[n][-1] for n in names])


def checked(path, run, kind, **more):
    """End values within what FMPy's solver, at its tolerance, makes of states of this size."""
    size = np.maximum(1.0, np.abs(run.y).max(axis=1))
    error = np.abs(ends(path, run.names, kind, **more) - run.y[:, -1]) / size
    assert error.max() < (1e-8 if kind == "CoSimulation" else 1e-5)


@needs_compiler
@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("version", package.VERSIONS)
def test_units_of_scenes_are_valid_and_end_where_our_trajectory_ends(name, version, tmp_path):
    from fmpy.validation import validate_fmu

    scene = eom.load_scene(name)
    values = scene.initial_values(), scene.parameter_values(), scene.input_values()
    path = codegen.write_fmu(scene.derive(), tmp_path, *values, SPAN, 1e-10, version)
    assert validate_fmu(str(path)) == []
    run = codegen.simulate(
        scene.derive(), values[0], SPAN, values[1], "DOP853", rtol=1e-12, inputs=values[2]
    )
    for kind in ("CoSimulation", "ModelExchange"):
        checked(path, run, kind)


@needs_compiler
@pytest.mark.parametrize("version", ["3.0", pytest.param("2.0", marks=pytest.mark.slow)])
def test_sampled_control_is_that_of_our_run(version, tmp_path):
    """Samples are time events in Model Exchange, and ends of steps inside in Co-Simulation."""
    from fmpy.validation import validate_fmu

    system = PENDULUM.with_control({"u": -K * X - Z}, {"z": Z + X / 10}, period=0.13, delay=0.05)
    start = {**START, "z": 0.2}
    path = codegen.write_fmu(system, tmp_path, start, VALUES, {}, SPAN, 1e-11, version)
    assert validate_fmu(str(path)) == []
    run = codegen.simulate(system, start, SPAN, VALUES, "DOP853", rtol=1e-12, inputs={})
    for kind in ("CoSimulation", "ModelExchange"):
        checked(path, run, kind)
    held = ends(path, ["u", "z"], "CoSimulation", output=["u", "z"])
    assert held[1] != 0.2


@needs_compiler
@pytest.mark.slow
def test_branches_are_event_indicators(tmp_path):
    path = codegen.write_fmu(FRICTION, tmp_path, START, VALUES, {"u": 0.0}, SPAN, 1e-10)
    root = described(zipfile.ZipFile(path).read("modelDescription.xml"))
    (indicator,) = root.findall("ModelStructure/EventIndicator")
    names = {v.get("valueReference"): v.get("name") for v in root.findall("ModelVariables/*")}
    assert names[indicator.get("valueReference")] == "indicator_1"
    run = codegen.simulate(FRICTION, START, SPAN, VALUES, "DOP853", rtol=1e-12, inputs={"u": 0.0})
    checked(path, run, "ModelExchange")


# --- calls one by one ------------------------------------------------------------------------------------


class Raised(Exception):
    pass


@contextmanager
def opened(path, kind=None, count=1, begin=True):
    """Instances of a unit in one process, initialised, and the list of what they say."""
    from fmpy.fmi2 import FMU2Model, FMU2Slave
    from fmpy.fmi3 import FMU3Model, FMU3Slave

    folder = fmpy.extract(str(path))
    model = fmpy.read_model_description(str(path))
    said, version = [], model.fmiVersion
    classes = {("2.0", None): FMU2Slave, ("3.0", None): FMU3Slave,
               ("2.0", "ME"): FMU2Model, ("3.0", "ME"): FMU3Model}  # fmt: skip
    units = []
    for k in range(count):
        one = classes[version, kind](
            guid=model.guid, unzipDirectory=folder, modelIdentifier=model.coSimulation.modelIdentifier,
            instanceName=f"instance_{k}",
        )  # fmt: skip
        if version == "2.0":
            one.instantiate(callbacks=heard(said))
            one.setupExperiment(startTime=0.0)
        else:
            one.instantiate(
                logMessage=lambda environment, status, category, text: said.append(text.decode())
            )
        units.append(one)
        if begin:
            started(one)
    try:
        yield units, {v.name: v.valueReference for v in model.modelVariables}, said
    finally:
        for one in units:
            one.terminate()
            one.freeInstance()
        shutil.rmtree(folder, ignore_errors=True)


def heard(said):
    """What a unit of FMI 2.0 is given to say something with."""
    from fmpy.fmi2 import defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
    from fmpy.logging import addLoggerProxy

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = fmi2CallbackLoggerTYPE(lambda *words: said.append(words[-1].decode()))
    callbacks.allocateMemory = defaultCallbacks.allocateMemory
    callbacks.freeMemory = defaultCallbacks.freeMemory
    addLoggerProxy(ctypes.byref(callbacks))
    return callbacks


def started(one):
    one.enterInitializationMode()
    one.exitInitializationMode()


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory):
    folder = tmp_path_factory.mktemp("unit")
    return codegen.write_fmu(PENDULUM, folder, START, VALUES, {"u": 0.5}, SPAN, 1e-11)


@needs_compiler
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_a_wrong_number_of_states_is_told_in_words_of_both_standards(version, tmp_path):
    from fmpy.fmi1 import FMICallException

    path = codegen.write_fmu(PENDULUM, tmp_path, START, VALUES, {"u": 0.5}, version=version)
    with opened(path, "ME") as ((one,), _, said):
        room = (ctypes.c_double * 3)(0.5, 0.25)
        rates = one.getDerivatives if version == "2.0" else one.getContinuousStateDerivatives
        for call in (one.setContinuousStates, one.getContinuousStates, rates,
                     one.getNominalsOfContinuousStates):  # fmt: skip
            with pytest.raises(FMICallException):
                call(room, 3)
            assert said[-1] == "this unit has 2 continuous states, and not 3"
        with pytest.raises(FMICallException):
            one.getEventIndicators(room, 1)
        assert said[-1] == "this unit has 0 event indicators, and not 1"
        one.setContinuousStates(room, 2)  # it goes on
        one.getContinuousStates(room, 2)
        assert list(room)[:2] == [0.5, 0.25]


@needs_compiler
def test_derivatives_in_directions_are_our_jacobian_both_ways(pendulum):
    with opened(pendulum) as ((one,), at, _):
        unknowns = [at[n] for n in ("der(x)", "der(v)", "force", "x")]
        knowns = [at[n] for n in ("x", "v", "u")]
        found = np.array([one.getDirectionalDerivative(unknowns, [k], [1.0]) for k in knowns]).T
        expected = [[0, 1, 0], [-2 * np.cos(1), 0, 1], [-4, 0, 1], [1, 0, 0]]
        np.testing.assert_allclose(found, expected, rtol=1e-15)
        back = [one.getAdjointDerivative([r], knowns, [1.0], len(knowns)) for r in unknowns]
        np.testing.assert_allclose(back, expected, rtol=1e-15)


@needs_compiler
def test_what_is_not_finite_or_not_there_is_an_error_with_a_message(pendulum):
    from fmpy.fmi1 import FMICallException

    with opened(pendulum) as ((one,), at, said):
        calls = {
            "not finite: nan": lambda: one.setFloat64([at["u"]], [float("nan")]),
            "k is given a value": lambda: one.setFloat64([at["k"]], [float("inf")]),
            "it cannot be set": lambda: one.setFloat64([at["force"]], [1.0]),
            "before the end of the initialization": lambda: one.setFloat64([at["x"]], [1.0]),
            "no variable with the value reference 99": lambda: one.getFloat64([99]),
            "this unit is at time 0": lambda: one.doStep(0.5, 0.1),
            "no step of -0.1": lambda: one.doStep(0.0, -0.1),
            "not variable 3": lambda: one.getDirectionalDerivative([at["der(x)"]], [3], [1.0]),
        }
        for words, call in calls.items():
            with pytest.raises(FMICallException):
                call()
            assert words in said[-1]
        one.doStep(0.0, 0.1)  # it goes on
        assert one.getFloat64([at["time"]]) == [0.1]


@needs_compiler
@pytest.mark.slow
def test_a_singular_configuration_ends_both_kinds_of_runs(tmp_path):
    from fmpy.fmi1 import FMICallException

    angle, rate = sp.symbols("theta rate", real=True)
    body = eom.System(
        "angles", (eom.Quantity(angle), eom.Quantity(rate)), (rate, sp.tan(angle)),
        singularities=(eom.Singularity(sp.cos(angle), angle),),
    )  # fmt: skip
    path = codegen.write_fmu(body, tmp_path, {"theta": 1.0, "rate": 1.0}, {}, {}, SPAN)
    with opened(path) as ((one,), _, said):
        with pytest.raises(FMICallException):
            one.doStep(0.0, 1.0)
        assert "singular at time 0." in said[-1]
    with opened(path, "ME", begin=False) as ((one,), at, said):
        one.setFloat64([at["theta"]], [np.pi / 2])
        started(one)
        one.updateDiscreteStates()
        one.enterContinuousTimeMode()
        assert one.completedIntegratorStep()[1]
        assert "singular at time 0" in said[-1]


@needs_compiler
def test_instances_know_nothing_of_each_other_and_parameters_may_change(pendulum):
    with opened(pendulum, count=2) as ((one, two), at, _):
        one.setFloat64([at["k"]], [3.0])
        for unit_, k in ((one, 3.0), (two, 2.0)):
            for step in range(10):
                unit_.doStep(0.1 * step, 0.1)
            run = codegen.simulate(PENDULUM, START, SPAN, {"k": k}, rtol=1e-12, inputs={"u": 0.5})
            got = unit_.getFloat64([at["x"], at["v"]])
            np.testing.assert_allclose(got, run.y[:, -1], rtol=1e-9)


@needs_compiler
def test_a_state_is_kept_written_as_bytes_and_taken_up_again(pendulum):
    with opened(pendulum) as ((one,), at, _):
        one.doStep(0.0, 0.3)
        state = one.getFMUState()
        one.doStep(0.3, 0.3)
        first = one.getFloat64([at["x"], at["v"]])
        bytes_ = one.serializeFMUState(state)
        one.freeFMUState(state)
        again = one.deserializeFMUState(bytes_)
        one.setFMUState(again)
        assert one.getFloat64([at["time"]]) == [0.3]
        one.doStep(0.3, 0.3)
        assert one.getFloat64([at["x"], at["v"]]) == first
        one.freeFMUState(again)


@needs_compiler
@pytest.mark.slow
def test_a_unit_with_a_controller_in_another_unit_is_our_sampled_run(tmp_path):
    """Inputs are held between communication points, so that the pair is a law with that period."""
    h = 0.1
    controller = eom.System.from_rates(
        "controller", {Z: Y}, inputs=[Y, W], outputs={"u": -K * Y - D * W - Z}
    )
    gains = {"k": 4.0, "d": 3.0}
    plant = codegen.write_fmu(PENDULUM, tmp_path, START, VALUES, {"u": 0}, SPAN, 1e-12)
    law = codegen.write_fmu(
        controller, tmp_path, {"z": 0}, gains, {"y": 0, "w": 0}, SPAN, 1e-12, "2.0"
    )
    with opened(plant) as ((a,), at, _), opened(law) as ((b,), of, _):
        for step in range(10):
            b.setReal([of["y"], of["w"]], a.getFloat64([at["x"], at["v"]]))
            a.setFloat64([at["u"]], b.getReal([of["u"]]))
            a.doStep(h * step, h)
            b.doStep(h * step, h)
        got = [*a.getFloat64([at["x"], at["v"]]), *b.getReal([of["z"]])]
    sampled = PENDULUM.with_control({"u": -4 * X - 3 * V - Z}, {"z": Z + X / 10}, period=h)
    run = codegen.simulate(sampled, START, SPAN, VALUES, "DOP853", rtol=1e-12, inputs={})
    np.testing.assert_allclose(got[:2], run.y[:, -1], atol=1e-10)
    assert got[2] != 0.0


@needs_compiler
@pytest.mark.slow
def test_another_guid_is_refused(pendulum):
    from fmpy.fmi3 import FMU3Slave

    folder = fmpy.extract(str(pendulum))
    said = []
    one = FMU3Slave(
        guid="{other}", unzipDirectory=folder, modelIdentifier="pendulum", instanceName="a"
    )
    with pytest.raises(Exception, match="instantiate"):
        one.instantiate(
            logMessage=lambda environment, status, category, text: said.append(text.decode())
        )
    assert "not that of this unit" in said[0]
    shutil.rmtree(folder, ignore_errors=True)
