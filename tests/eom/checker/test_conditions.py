"""Conditions that are formulas: put into the claim, or fulfilled by motions; else nothing is decided."""

from __future__ import annotations

import pytest

from eom import check
from tests.eom.rows import every, only

FRONT = r"""+++
[check]
preset = "arrow-tilde"
[check.symbols]
'\vec a' = "vector a"
'\vec b' = "vector b"
'N_{<k>}' = "torque body C in B component <k>"
'\psi' = "turn_angle 1 313 B I"
'\theta' = "turn_angle 2 313 B I"
'\phi' = "turn_angle 3 313 B I"
+++

Let the axes be principal.

"""


def verdict(text: str) -> str:
    """Return the verdict on the only display of a note."""
    found = check(FRONT + text + "\n", kind="markdown", seconds=100.0).findings
    return next(f.verdict for f in found if f.kind == "display")


TRUE = [
    r"$$\vec a\cdot\vec b = 0 \quad\text{if}\quad \vec a = \vec\omega\times\vec b$$",
    r"$$\vec a\times\vec b = 0 \quad\text{for } \vec a = 3\vec b$$",
    r"$$\vec a\times(\vec a\times\vec b) = -\vec b \quad \text{if } |\vec a| = 1, \vec a\cdot\vec b = 0$$",
    r"If $\vec a\times\vec b = 0$, then $$\vec a\times\vec\omega\cdot\vec b = 0$$",
    r"$$I_2\dot\omega_2 = N_2 \quad\text{if}\quad \omega_3 = 0$$",
    r"For $\omega_2 = 0$ we have $$I_1\dot\omega_1 = N_1.$$",
    r"When $\omega_3$ is constant, $$(I_2 - I_1)\omega_1\omega_2 = N_3$$",
    r"$$(I_2 - I_1)\omega_1\omega_2 = N_3 \quad \text{if } \omega_3 = \text{const}$$",
    r"$$\vec H_C = I_1\vec\omega \quad\text{for } I_1 = I_2 = I_3$$",
    r"$$I_3\dot\omega_3 = N_3 \quad\text{if}\quad I_1 = I_2$$",
]
FALSE = [
    r"$$\vec a\cdot\vec b = 1 \quad\text{if}\quad \vec a = \vec\omega\times\vec b$$",
    r"$$\vec a\times(\vec a\times\vec b) = -\vec b \quad\text{for } \vec a\cdot\vec b = 0$$",
    r"$$\vec a\times(\vec a\times\vec b) = \vec b \quad \text{if } |\vec a| = 1, \vec a\cdot\vec b = 0$$",
    r"If $\vec a = 2\vec b$: $$\vec a\times\vec\omega = \vec b\times\vec\omega$$",
]
OPEN = [
    r"For $\theta = \pi/2$: $$\omega_3 = \dot\phi$$",
    r"$$\omega_3 = \dot\phi + \dot\psi \quad\text{for } \theta = 0$$",
    r"When $\omega_1$ is constant, $$(I_2 - I_1)\omega_1\omega_2 = N_3$$",
]


@pytest.mark.parametrize("text", every(2, TRUE))
def test_what_holds_under_its_condition_holds(text: str) -> None:
    """With what has to be assumed besides."""
    assert verdict(text) in {"holds", "holds under"}


@pytest.mark.parametrize("text", every(2, FALSE))
def test_what_fails_under_its_condition_is_wrong(text: str) -> None:
    """Worlds that fulfil the condition refute it."""
    assert verdict(text) == "wrong"


@pytest.mark.parametrize("text", only(OPEN, OPEN[1]))
def test_a_condition_that_no_world_is_known_for_leaves_it_open(text: str) -> None:
    """Some are true: none may be called wrong, and none be said to hold without more."""
    assert verdict(text) in {"undecided", "holds under"}
