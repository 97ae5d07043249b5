"""Scalar lines of particular systems: true ones hold, slips are wrong and told by their terms."""

import random

import pytest
import sympy as sp

from eom import catalogue
from eom.checker.lexicon_files import parse_lexicon
from eom.checker.model import BUILTIN, load_model
from tests.eom.checker.system_lines import is_same, judged, left_side, names_of, slips

UNDER = "holds under"
TOLD = {
    "sign": "wrong sign",
    "factor": "should be 1/2 times",
    "half": "should be 2 times",
    "dropped": "missing on the right side",
}
SYSTEMS = [*catalogue.names(), *BUILTIN]


def lexicon(name):
    return parse_lexicon(f'[system]\nis = "{name}"')


def latex(expression, names):
    return sp.latex(expression, symbol_names=names)


def rates(model):
    """States with their rates, where these are explicit."""
    s = model.system
    return [] if s.mass_matrix is not None else list(zip(s.states, s.rates, strict=True))


@pytest.mark.parametrize("name", SYSTEMS)
def test_all_equations_of_a_system_hold(name):
    model = load_model(name)
    names = names_of(model)
    lines = [f"{left_side(q, names)} = {latex(r, names)}" for q, r in rates(model)]
    lines += [
        rf"{latex(d.expression, names)} = \text{{const}}"
        for d in model.system.invariants
        if d.expression.is_polynomial(*d.expression.free_symbols)
    ]
    found = judged(lexicon(name), *lines)
    assert [v.verdict for v in found] == ["holds"] * len(lines), lines


def mutants(name, count):
    """Lines with a slip: the kind, the term, the line, whether it is true all the same."""
    model = load_model(name)
    names = names_of(model)
    generator = random.Random(name)
    for q, r in rates(model):
        if r == 0:
            continue
        for kind, term, changed in slips(r, generator, count):
            line = f"{left_side(q, names)} = {latex(changed, names)}"
            yield kind, term, line, is_same(model, r, changed)


@pytest.mark.parametrize("name", SYSTEMS)
def test_slips_are_wrong_and_what_is_true_is_not(name):
    made = list(mutants(name, 8))
    found = judged(lexicon(name), *(line for _, _, line, _ in made))
    missed, untold = [], []
    for (kind, _, line, true), v in zip(made, found, strict=True):
        if v.verdict == "wrong" and TOLD.get(kind, "") not in v.reason:
            untold.append((kind, line, v.reason))
        right = {"holds"} if true else {"wrong"} if name in catalogue.names() else {"wrong", UNDER}
        if v.verdict not in right:
            missed.append((kind, line, v.verdict, v.claims[0].judgement.sets))
    assert not missed
    assert len(untold) <= max(1, len(made) / 25), untold
    assert sum(v.verdict == "wrong" for v in found) > len(made) / 2 or not made
