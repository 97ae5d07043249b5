"""Plain text of formulas: short, with the brackets that are needed, for every kind of node."""

import pytest

from eom.checker.read import plain as module
from eom.checker.read import syntax as s
from eom.checker.read.grammar import read_formula
from eom.checker.read.plain import plain
from tests.eom.checker.formulas import BOOKS


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            r"I_1 \dot\omega_1 + (I_3 - I_2)\omega_2\omega_3 = M_1",
            "I_1 ω̇_1 + (I_3 - I_2) ω_2 ω_3 = M_1",
        ),
        (r"{}^N\boldsymbol\omega^B \times \mathbf{r}", "^Nω^B × r"),
        (r"\frac{{}^{B}d\mathbf{v}}{dt} \neq \frac{a + b}{c} d", "^Bd/dt v ≠ ((a + b)/c) d"),
        (
            r"\vec a \times (\vec b \times \vec c) \Rightarrow \int_B r^2\,dm",
            "a⃗ × (b⃗ × c⃗) ⇒ ∫_B r^2 dm",
        ),
        (r"\mathbf{r}_O^{\bullet\bullet} - \mathbf{a}^\times", "r_O^{••} - a×"),
        (r"\sum_{i=1}^N m_i \quad \sin^2\theta", "Σ_{i=1}^N m_i   sin^2 θ"),
    ],
)
def test_plain_text(text, expected):
    assert plain(read_formula(text).tree) == expected


def test_every_kind_of_node_has_a_row():
    kinds = {n for n, k in vars(s).items() if isinstance(k, type) and issubclass(k, s.Node)}
    assert set(module._TABLE) == kinds - {"Node", "Sign"}


def test_books_have_plain_text():
    written = {t: plain(read_formula(t).tree) for rows in BOOKS.values() for t, _ in rows}
    assert [t for t, w in written.items() if not w.strip() or "\\" in w] == []
