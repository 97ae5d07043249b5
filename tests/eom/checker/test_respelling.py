r"""Usual spellings of one thing are read as one thing; what is not read says so, and nothing is dropped."""

from __future__ import annotations

import pytest

from eom import check
from eom.checker.read.grammar import read_formula
from eom.checker.read.syntax import walk

FRONT = r"""+++
[check]
preset = "arrow-tilde"
[check.symbols]
'\mathbf{H}' = "angular_momentum body C"
'\mathbf{M}' = "torque body C"
'\mathbf{J}' = "inertia C"
'\mathbf{w}' = "angular_velocity B I"
'\theta' = "free_angle theta"
'M' = "total_mass body"
+++

"""

HOLDS_UNDER = [
    r"\frac{d\mathbf{H}}{dt} = \mathbf{M}",
    r"\frac{\dd{\mathbf{H}}}{\dd{t}} = \mathbf{M}",
    r"\frac{\dd \mathbf{H}}{\dd t} = \mathbf{M}",
    r"\dv{\mathbf{H}}{t} = \mathbf{M}",
    r"{d\mathbf{H} \over dt} = \mathbf{M}",
    r"\frac{\mathop{}\!\mathrm{d}\mathbf{H}}{\mathop{}\!\mathrm{d}t} = \mathbf{M}",
    r"\dot{\vb*{H}} = \vb{M}",
    r"\begin{array}{rcl}\dot{\mathbf{H}} & = & \mathbf{M}\end{array}",
    r"\begin{array}{r@{}l}\dot{\mathbf{H}} &= \mathbf{M} \\ \mathbf{M} &= \dot{\mathbf{H}}\end{array}",
    r"\fbox{$\dot{\mathbf{H}} = \mathbf{M}$}",
    r"\left.\dot{\mathbf{H}} = \mathbf{M}\right\}",
    r"\left[\dot{\mathbf{H}} = \mathbf{M}\right]",
    r"\dot{\mathbf{H}} = \mathbf{M} \eqno(3)",
    r"\dot{\mathbf{H}} = \mathbf{M} \quad\blacksquare",
    r"\bigl(\dot{\mathbf{H}} - \mathbf{M}\bigr) = \Big[\mathbf 0\Big]",
    r"\dot{\mathbf{H}} \boldsymbol{=} \mathbf{M}",
]
"""One law in many spellings."""

HOLDS = [
    r"\mathbf{w}\boldsymbol\cdot\mathbf{w}\boldsymbol{\times}\mathbf{H} = 0",
    r"\mathbf{w}\vdot(\mathbf{w}\cp\mathbf{H}) = 0",
    r"\mathbf{w}\dotproduct(\mathbf{w}\crossproduct\mathbf{H}) = 0",
    r"\tan\theta = \sin\theta\big/\cos\theta",
    r"\left.\sin\theta\middle/\cos\theta\right. = \tan\theta",
    r"{1 \over 2}\sin 2\theta = \sin\theta\cos\theta",
    r"\num{2}\sin\theta\cos\theta = \sin 2\theta",
    r"\dot{\mathbf{H}} = \overset{\circ}{\mathbf{H}} + \mathbf{w}\times\mathbf{H}",
    r"\dot{\mathbf{H}} = \stackrel{\circ}{\mathbf{H}} + \mathbf{w}\times\mathbf{H}",
    r"\dot{\mathbf{H}} = \mathring{\mathbf{H}} + \mathbf{w}\times\mathbf{H}",
]

DATA = [
    r"M = 5",
    r"M = \SI{5}{\kilogram}",
    r"M = \qty{5}{\kilogram}",
    r"M = 5~\text{kg}",
    r"M = 5\,\mathrm{kg}",
    r"\theta = 30^\circ",
    r"\theta = \ang{30}",
    r"\theta = \frac{\pi}{6}",
    r"\omega_1 = \SI{2}{\radian\per\second}",
    r"\omega_1 \approx 2{,}5",
]
"""Numbers that are given, which no motion makes right or wrong."""


def verdict(line: str) -> str:
    """Return the verdict on a display."""
    (found,) = check(f"{FRONT}$${line}$$\n", seconds=100.0).findings
    return found.verdict


@pytest.mark.parametrize("line", HOLDS_UNDER)
def test_a_law_in_many_spellings(line: str) -> None:
    """It holds under the same assumptions, and a wrong sign is seen."""
    assert verdict(line) == "holds under"


@pytest.mark.parametrize("line", HOLDS)
def test_identities(line: str) -> None:
    """What is always true holds."""
    assert verdict(line) == "holds"


@pytest.mark.parametrize("line", [HOLDS_UNDER[k] for k in (1, 4, 5, 7, 8, 9, 10, 15)])
def test_a_slip_is_seen_in_every_spelling(line: str) -> None:
    """Twice the torque is wrong."""
    assert verdict(line.replace(r"\mathbf{M}", r"2\mathbf{M}")) == "wrong"


@pytest.mark.parametrize("line", DATA)
def test_numbers_that_are_given_are_not_called_wrong(line: str) -> None:
    """Nothing shows whether they are right."""
    assert verdict(line) == "undecided"


def test_every_node_has_a_place() -> None:
    """Spans lie within the formula."""
    for line in (*HOLDS_UNDER, *HOLDS):
        for node in walk(read_formula(line).tree):
            assert 0 <= node.span.start <= node.span.stop <= len(line) + 1, line
