"""The contract between deriving and computing: what a system refuses and how it differentiates."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace

import pytest
import sympy as sp

from eom.errors import InputError
from eom.quantities import Definition, Quantity
from eom.system import System

x, y, k, u, d, e = sp.symbols("x y k u d e", real=True)
t = sp.Symbol("t", real=True)


def oscillator(**changes):
    parts = {
        "name": "oscillator",
        "states": (Quantity(x), Quantity(y)),
        "rates": (y, d * x + u),
        "parameters": (Quantity(k),),
        "inputs": (Quantity(u),),
        "definitions": (Definition(Quantity(d), -k), Definition(Quantity(e), d**2)),
        "outputs": (Definition(Quantity(sp.Symbol("out", real=True)), e * x),),
    }
    return System(**(parts | changes))


def test_names_are_listed_in_order():
    system = oscillator()
    assert system.state_names == ("x", "y")
    assert system.parameter_names == ("k",)
    assert system.input_names == ("u",)
    assert system.output_names == ("out",)
    assert system.invariant_names == ()


def test_definitions_are_put_in_to_the_bottom():
    system = oscillator()
    assert system.expand(e + d) == k**2 - k
    assert system.expand(x) == x
    assert system.expand(3) == 3


def test_rate_of_is_the_chain_rule_through_definitions_and_time():
    system = oscillator()
    assert sp.expand(system.rate_of(x * y) - (y**2 + x * (u - k * x))) == 0
    assert sp.expand(system.rate_of(e * x) - k**2 * y) == 0
    assert system.rate_of(t * k) == k
    assert system.rate_of(k) == 0


def test_rate_of_needs_explicit_rates():
    system = oscillator(mass_matrix=sp.ImmutableMatrix([[1, 0], [0, 2]]))
    with pytest.raises(InputError, match="mass matrix"):
        system.rate_of(x)


@pytest.mark.parametrize(
    ("changes", "what", "got"),
    [
        ({"parameters": (Quantity(k), Quantity(k))}, "repeated variable", "k"),
        ({"inputs": (Quantity(u), Quantity(x))}, "repeated variable", "x"),
        ({"inputs": (Quantity(u), Quantity(t))}, "repeated variable", "t"),
        ({"parameters": (Quantity(k), Quantity(d))}, "repeated variable", "d"),
        ({"parameters": (Quantity(k), Quantity(sp.Symbol("x")))}, "repeated variable", "x"),
        ({"rates": (y,)}, "one rate a state", "1 rates for 2 states"),
        ({"mass_matrix": sp.eye(3)}, "mass matrix", "(3, 3)"),
        ({"rates": (y, sp.Symbol("nobody"))}, "without a meaning", "nobody"),
        ({"mass_matrix": sp.diag(1, sp.Symbol("nobody"))}, "without a meaning", "nobody"),
        ({"rates": (y, sp.Function("f")(x))}, "", ""),
        ({"rates": (y, sp.Derivative(sp.Function("f")(x), x))}, "", ""),
        ({"definitions": (Definition(Quantity(d), e), Definition(Quantity(e), k))}, "meaning", "e"),
        (
            {"outputs": (Definition(Quantity(u), x), Definition(Quantity(u), y))},
            "repeated output",
            "u",
        ),
    ],
)
def test_broken_systems_are_refused(changes, what, got):
    with pytest.raises(InputError) as caught:
        oscillator(**changes)
    assert what in caught.value.what
    assert got in caught.value.got
    assert "oscillator" in caught.value.where


def test_symbols_of_one_name_but_other_assumptions_are_not_the_same():
    with pytest.raises(InputError, match="without a meaning"):
        oscillator(rates=(y, sp.Symbol("x")))


def test_systems_are_frozen_and_compared_by_content():
    assert oscillator() == oscillator(title="another title")
    assert oscillator() != replace(oscillator(), rates=(y, -x))
    with pytest.raises(FrozenInstanceError):
        oscillator().name = "other"


def test_free_symbols_become_parameters_in_order_of_names():
    b, a = sp.symbols("b a")
    system = System.from_rates(
        "made", {x: b * y + u, y: -a * x + t}, inputs=(u,), outputs={"sum": x + k}
    )
    assert system.parameter_names == ("a", "b", "k")
    assert system.input_names == ("u",)
    assert system.outputs[0].expression == x + k
    assert System.from_rates("constant", {x: 1}).rates == (sp.Integer(1),)


@pytest.mark.parametrize("text", ["x", "1", "__import__('os').getpid()", "x.diff(x)", ""])
def test_text_is_never_read_as_an_expression(text):
    x = sp.Symbol("x", real=True)
    with pytest.raises(InputError, match="not a number or a SymPy expression"):
        System.from_rates("text", {x: text})
    with pytest.raises(InputError, match="not a number or a SymPy expression"):
        System.from_rates("text", {x: -x}, outputs={"y": text})


def test_multipliers_stand_in_the_mass_matrix_and_in_outputs_alone():
    x, v, force = sp.symbols("x v force", real=True)
    given = {
        "name": "held",
        "states": [x, v],
        "rates": [v, 1],
        "mass_matrix": [[1, 0, 0], [0, 2, -1], [0, 1, 0]],
        "multipliers": {force: 0},
    }
    held = System(**given, outputs={"push": 3 * force})
    assert held.right_sides == (v, 1, 0)
    with pytest.raises(InputError, match="mass matrix of the wrong shape"):
        System(**given | {"mass_matrix": [[1, 0], [0, 2]]})
    with pytest.raises(InputError, match="multipliers need a mass matrix"):
        System(**given | {"mass_matrix": None})
    with pytest.raises(InputError, match="symbol without a meaning"):
        System(**given | {"rates": [v, force]})
    with pytest.raises(InputError, match="repeated variable or definition name"):
        System(**given | {"multipliers": {x: 0}})
