"""Every public function, each argument in turn what it cannot be: one clear error, or a result."""

import contextlib
import inspect
import itertools
import json
import warnings
from collections.abc import Callable, Iterable

import numpy as np
import pytest
import sympy as sp

import codegen
import eom
from codegen.native import native
from eom import multibody
from eom.checker.note import grading
from eom.errors import MOST_ENTRIES, InputError, printable, typed
from tests.hostile_calls import HOSTILE, MADE, METHODS, M, Unending, k, right, v, within, y

LONGEST = 10.0
"""Seconds for one call, of which most take a millisecond."""

PACKAGES = {"codegen": codegen, "eom": eom, "eom.multibody": multibody}
NAMES = [
    (package, name)
    for package, module in PACKAGES.items()
    for name in module.__all__
    if callable(getattr(module, name)) and name not in MADE[package].split()
]


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """Public functions with arguments that are right, by package and name."""
    return right(tmp_path_factory.mktemp("notes"))


@pytest.fixture
def calls(table):
    return table["codegen"]


def takes_nothing(function):
    return not inspect.signature(function).parameters


def test_every_public_function_has_a_row(table):
    """A new public name is tried, too, or is one of those that the package alone makes."""
    missing = {
        (package, name)
        for package, name in NAMES
        if name not in table[package] and not takes_nothing(getattr(PACKAGES[package], name))
    }
    assert missing == set()
    for package, module in PACKAGES.items():
        assert {*MADE[package].split(), *table[package]} <= set(module.__all__)
        for name, (function, arguments) in table[package].items():
            assert set(arguments) == set(inspect.signature(function).parameters) or (
                name in {"Scene", "TreeScene"}
            ), name


def unusable(function, arguments):
    """How often a call is refused in one clear error; anything else than that and a result fails."""
    refused = 0
    for argument in arguments:
        for place, value in enumerate(HOSTILE):
            try:
                with warnings.catch_warnings(), within(LONGEST):
                    warnings.simplefilter("ignore")  # of NumPy, on numbers that are not finite
                    function(**{**arguments, argument: value})
            except InputError as error:
                refused += len(str(error).encode()) > 0
            except (Unending, Exception) as error:
                pytest.fail(f"{argument} = HOSTILE[{place}] of {type(value)}: {error!r}")
    return refused


@pytest.mark.sparse(20)
@pytest.mark.parametrize("name", NAMES, ids=".".join)
def test_whatever_an_argument_is_there_is_a_result_or_one_clear_error(
    table, name, tmp_path, monkeypatch
):
    """A store may be made in a folder of any name; notes are not checked, in a process each."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(grading, "_crew", lambda count, settings: contextlib.nullcontext([]))
    monkeypatch.setattr(grading, "_graded", lambda crew, jobs, _: enumerate(jobs))
    package, word = name
    if takes_nothing(getattr(PACKAGES[package], word)):
        return
    function, arguments = table[package][word]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        function(**arguments)
    assert unusable(function, arguments) > len(HOSTILE) // 4 * len(arguments)


@pytest.mark.sparse(3)
@pytest.mark.parametrize("name", sorted(METHODS))
def test_methods_take_nothing_wrong_either(table, name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    save, where = table[""]["Result.save"]
    save(**where)
    function, arguments = table[""][name]
    function(**arguments)
    assert unusable(function, arguments) > len(HOSTILE) // 4 * len(arguments)


@pytest.mark.parametrize(
    ("argument", "value", "reported"),
    [
        ("t_span", None, "t_span is of the wrong type"),
        ("t_span", 10, "t_span is of the wrong type"),
        ("t_span", (0, 1, 2), "t_span is of the wrong type"),
        ("t_span", ("0", "1"), "t_span is of the wrong type"),
        ("t_span", (0, float("nan")), "t_span is not a time interval"),
        ("rtol", None, "rtol is of the wrong type"),
        ("rtol", "1e-9", "rtol is of the wrong type"),
        ("rtol", 1e-9j, "rtol is of the wrong type"),
        ("atol", [1e-9, None], "atol does not fit"),
        ("atol", "1e-9", "atol does not fit"),
        ("inputs", lambda t: 0.0, 'inputs={"M": f}'),
        ("outputs", "E", "outputs is of the wrong type"),
        ("method", None, "method is of the wrong type"),
    ],
)
def test_what_is_reported_arguments_of_runs(calls, argument, value, reported):
    simulate, right = calls["simulate"]
    with pytest.raises(InputError) as caught:
        simulate(**{**right, argument: value})
    assert reported in str(caught.value)


def test_symbols_and_plain_expressions_make_a_system():
    """What a user has at hand: symbols, numbers, a list; names for what is to be given out."""
    found = eom.System(
        "oscillator", (y, v), [v, -k * y - M], [k], [M],
        definitions=[("spring", k * y)], outputs={"force": M + sp.Symbol("spring", real=True)},
        invariants={"energy": (v**2 + k * y**2) / 2}, mass_matrix=[[1, 0], [0, 1]],
    )  # fmt: skip
    assert found.states == (eom.Quantity(y), eom.Quantity(v))
    assert (found.state_names, found.parameter_names, found.input_names) == (
        ("y", "v"),
        ("k",),
        ("M",),
    )
    assert (found.output_names, found.invariant_names) == (("force",), ("energy",))
    assert found.expand(found.outputs[0].expression) == M + k * y
    assert found.mass_matrix == sp.eye(2)
    for wrong in (y, "y", ("y",), (None,)):
        with pytest.raises(InputError, match=r"not a list|not a symbol"):
            eom.System("s", states=wrong, rates=(y,))


def test_a_dense_output_that_was_not_made_says_so(calls):
    simulate, right = calls["simulate"]
    run = simulate(**{**right, "outputs": None})
    assert not run.sol
    with pytest.raises(InputError, match="dense_output=True"):
        run.sol(0.5)
    assert simulate(**{**right, "outputs": None, "dense_output": True}).sol


def test_a_message_can_be_written_whatever_it_is_about():
    error = InputError("a\ud800", where="b\udfff", got=["\ud800"], hint="\ud9ab")
    assert json.dumps(str(error)).isascii()
    assert "\\ud800" in str(error)
    assert str(error).encode("utf-8")
    assert "digits" in printable(10**5000)


def test_annotations_say_what_is_refused():
    @typed
    def call(a: float, b: "tuple[int, ...]" = (), *, c: "str | None" = None, d: "Unknown" = 0):  # noqa: F821
        return a, b, c, d

    assert call(np.float32(1), [1, 2], c="x", d=object)[2] == "x"
    assert call(sp.pi)[0] is sp.pi
    for wrong in (
        {"a": "1"},
        {"a": 1j},
        {"a": 1, "b": (1.5,)},
        {"a": 1, "b": "12"},
        {"a": 1, "c": b""},
    ):
        with pytest.raises(InputError, match=f"{list(wrong)[-1]} is of the wrong type"):
            call(**wrong)
    with pytest.raises(TypeError, match="missing 1 required"):
        call()
    with pytest.raises(TypeError, match="unexpected keyword"):
        call(1, e=2)


def test_annotations_are_looked_into():
    """Functions by their arity, whole numbers as `int`, what may have no end, names for type checkers."""

    @typed
    def call(f: Callable[[float], float] = abs, n: "int" = 0, names: Iterable[str] = ()):
        return n, names

    assert type(call(n=np.int64(3))[0]) is int
    assert call(names=(c for c in "ab"))[1] == ("a", "b")
    for wrong in (
        {"f": lambda: 0},
        {"f": lambda a, b: 0},
        {"n": 2**64},
        {"names": itertools.repeat("a")},
        {"names": range(10**400)},
        {"names": (c for c in (1, 2))},
    ):
        with pytest.raises(InputError, match=f"{list(wrong)[-1]} is of the wrong type"):
            call(**wrong)
    with pytest.raises(InputError, match=f"more than {MOST_ENTRIES:,} entries"):
        call(names=itertools.repeat("a"))
    with pytest.raises(InputError, match="system is of the wrong type"):
        eom.check("note.tex", system=1.5)  # its annotation names classes for type checkers alone


def test_what_is_made_in_large_numbers_is_not_slowed():
    """A chain of bodies makes quantities by the thousand: none goes through the general check."""
    for light in (eom.Quantity, eom.Definition):
        assert not hasattr(light.__init__, "__wrapped__")


@pytest.mark.skipif(not native.compiler(), reason="runs C")
def test_checking_arguments_costs_nothing_beside_a_run(calls):
    """Annotations are read once: calls after the first look at no source."""
    from eom import errors

    asked = []
    original = errors._hints
    errors._hints = lambda function: asked.append(function) or original(function)
    try:

        @typed
        def call(a: float):
            return a

        for _ in range(3):
            call(1.0)
    finally:
        errors._hints = original
    assert len(asked) == 1
