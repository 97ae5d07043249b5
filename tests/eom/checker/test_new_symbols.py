"""Symbols that a chain brings in behind its first place; lines of one model; matrices of eigenvectors."""

from __future__ import annotations

import pytest

from eom import check
from tests.eom.rows import every

VECTORS = """+++
[check]
preset = "arrow-tilde"
[check.symbols]
'\\vec a' = "vector a"
'\\vec b' = "vector b"
+++
"""


def verdicts(*lines: str, front: str = VECTORS, notation: str = "") -> list[str]:
    """Return the verdicts on displays of one note."""
    text = front.replace("\\\\", "\\") + "\n\n".join(f"$${line}$$" for line in lines)
    return [f.verdict for f in check(text, notation=notation).findings]


@pytest.mark.parametrize("sign", every(3, [r"\equiv", r"\triangleq", ":=", "=:"]))
def test_a_symbol_behind_a_sign_of_definition_is_defined(sign: str) -> None:
    """It stands for its neighbour in later lines; the rest of the chain is judged without it."""
    chain = rf"\vec a \times \vec b {sign} \vec d = -\vec b \times \vec a"
    assert verdicts(chain, r"\vec d \cdot \vec a = 0", r"\vec d = \vec a \times \vec b") == [
        "holds",
        "holds",
        "holds",
    ]
    assert verdicts(rf"\vec a \times \vec b {sign} \vec d = \vec b \times \vec a")[0] == "wrong"


def test_the_right_side_may_be_new() -> None:
    """A definition from left to right is one."""
    found = verdicts(r"\vec a \times \vec b \equiv \vec d", r"\vec d \cdot \vec b = 0")
    assert found == ["definition", "holds"]


def test_what_is_known_is_no_definition() -> None:
    """A symbol that the lexicon knows is judged where it stands."""
    assert verdicts(r"\vec a \equiv \vec b") == ["wrong"]


@pytest.mark.slow
def test_claims_of_one_line_hold_in_one_model() -> None:
    """Where one claim has a meaning in a model alone, one that fails in it is wrong."""
    rate = r"I_2 \frac{d}{dt}\left(\dot\phi + \dot\psi\sin\theta\right) = 0"
    for left, verdict in (
        (r"{}^{\mathcal{B}}\mathbf{h}_G \cdot \mathbf{b}_2 = 0", "wrong"),
        (r"\mathbf{M}_G \cdot \mathbf{b}_2 = 0", "holds under"),
    ):
        assert verdicts(rf"{left} \implies {rate}", front="", notation="left-superscript") == [
            verdict
        ]


EIGEN = """+++
[check]
preset = "underline-bullet"
[check.frames]
'P' = "B"
'B' = "A"
[check.symbols]
'\\\\mathbf{E}' = "eigenvectors A B"
'\\\\mathbf{J}_{<F>}' = "inertia O in <F>"
+++
"""


@pytest.mark.parametrize(
    ("line", "verdict"),
    [
        (r"\mathbf{J}_P = \mathbf{C}_{PB}\mathbf{J}_B\mathbf{C}_{BP}", "holds"),
        (r"\mathbf{E}^{-1}\mathbf{J}_B\mathbf{E} = \mathbf{J}_P", "holds under"),
        (r"\mathbf{E}^T\mathbf{E} = \mathbf{1}", "holds under"),
        (r"\mathbf{E} = \mathbf{C}_{BP}", "holds under"),
        (r"\mathbf{E} = \mathbf{C}_{PB}", "ill-formed"),
    ],
)
def test_eigenvectors_need_not_be_a_rotation(line: str, verdict: str) -> None:
    """Columns may be exchanged and stretched, unless they are assumed to be unit vectors."""
    text = EIGEN.replace("\\\\", "\\") + f"\n$${line}$$\n"
    found = check(text).findings[0]
    assert found.verdict == verdict, (found.reason, found.latex)
    if verdict == "holds under":
        assert all("unit_eigenvectors" in s for s in found.sets)
