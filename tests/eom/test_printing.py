"""Systems on paper: names, meanings with units, long lines."""

import re

import pytest
import sympy as sp

from eom import Scene, load_scene
from eom.derivations import derive
from eom.errors import InputError
from eom.quantities import Definition, Quantity
from eom.scenes import catalogue
from eom.system import System
from eom.typeset.printing import FORMATS, show
from eom.typeset.sentences import phrases
from tests.eom.rows import only

SHORT = (("heavy-top", "text"), ("double-pendulum", "latex"), ("lecture-wheel", "markdown"))
"""Each format once, and each kind of scene."""


@pytest.mark.parametrize(
    ("name", "style"), only(((n, s) for n in catalogue.names() for s in FORMATS), *SHORT)
)
def test_meanings_and_units_are_printed(name, style):
    system = load_scene(name).derive()
    shown = show(system, style).replace("\\^{}", "^").replace("\\_", "_")
    for d in (*system.definitions, *system.outputs, *system.invariants):
        words = (
            phrases(d.quantity.description, {}) if style != "text" else (d.quantity.description,)
        )
        assert all(w in shown for w in words if isinstance(w, str))


def test_words_are_not_products_of_letters():
    shown = show(Scene.ready("gravity-gradient-satellite").derive(), "latex")
    assert r"\mathrm{radial}_{2}" in shown
    assert not re.search(r"(?<![\w{\\])(radial|normal)_", shown)


def test_constants_keep_the_names_of_definitions():
    shown = show(Scene.ready("gravity-gradient-satellite").derive(), "text")
    energy = next(line for line in shown.splitlines() if line.startswith("  E "))
    assert "radial_1**2" in energy
    assert "q0" not in energy


def test_an_output_that_is_defined_is_not_told_twice():
    system = next(r for r in derive("gyrostat").result.values() if isinstance(r, System))
    shown = show(system, "text")
    assert [shown.count(f"# angular momentum along b{k}") for k in (1, 2, 3)] == [1, 1, 1]


def test_long_equations_are_broken_between_terms():
    x = sp.Symbol("x")
    long = sp.Add(*(sp.Symbol(f"a_{k}") * x for k in range(40)))
    system = System.from_rates("long", {x: -x}, outputs={"total": long})
    shown = show(system, "latex")
    assert shown.count(r"&\quad{} + ") > 1
    assert max(map(len, shown.splitlines())) < 500
    assert shown.count("{") == shown.count("}")


def test_a_mass_matrix_is_printed():
    x, y = sp.symbols("x y")
    system = System(
        "coupled",
        (Quantity(x), Quantity(y)),
        (y, -x),
        mass_matrix=sp.Matrix([[2, 1], [1, 2]]),
    )
    assert "mass matrix = [[2, 1], [1, 2]]" in show(system)
    assert "times the rates of x, y = right sides" in show(system)
    assert r"\begin{bmatrix} 2 & 1" in show(system, "latex")


def test_own_latex_is_used_unless_it_is_a_bare_word():
    x, y = sp.symbols("speed word_1")
    system = System(
        "names",
        (Quantity(x, "m/s", "speed of A & B", r"\dot{s}"),),
        (-1.0 * x,),
        outputs=(Definition(Quantity(y, latex="word_1"), x),),
    )
    shown = show(system, "latex")
    assert r"\item $\dot{s}$: speed of A \& B [m/s]" in shown
    assert r"\mathrm{word}_{1} &=" in shown


def test_unknown_formats_are_refused():
    with pytest.raises(InputError, match="unknown format"):
        show(System.from_rates("x", {sp.Symbol("x"): sp.S.One}), "pdf")
