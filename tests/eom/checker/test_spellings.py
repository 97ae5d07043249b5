"""Usual spellings that were once called ill-formed."""

import pytest

from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import verdict
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document

LEXICON = parse_lexicon(r"""
preset = "schaub-junkins"
[symbols]
'\mathbf{u}' = "vector u"
'I_{3\times3}' = "identity_matrix"
""")

RATE = r"\!\left(\frac{d\mathbf u}{dt}\right)"


def judged(formula):
    (understood,) = understand(read_document(f"$${formula}$$"), LEXICON)
    return verdict(understood, ("constant_mass",)).verdict


@pytest.mark.parametrize(
    "formula",
    [
        r"\boldsymbol\omega = (\omega_1, \omega_2, \omega_3)^T",
        r"\boldsymbol\omega = [\omega_1\ \omega_2\ \omega_3]^T",
        r"\boldsymbol\omega = [\omega_1 \quad \omega_2 \quad \omega_3]^\top",
        r"[C]^T - [C] = -([C] - [C]^T)",
        r"[C][C]^T = [I_{3\times 3}]",
        rf"{{}}^{{N}}{RATE} = {{}}^{{B}}{RATE} + \boldsymbol\omega\times\mathbf u",
        r"\dot{\mathbf u} = \mathring{\mathbf u} + \boldsymbol\omega\times\mathbf u",
    ],
)
def test_true_equations(formula):
    assert judged(formula) == "holds"


@pytest.mark.parametrize(
    "formula",
    [
        r"\boldsymbol\omega = [\omega_1\ \omega_3\ \omega_2]^T",
        r"[C]^T - [C] = [C] - [C]^T",
        r"\dot{\mathbf u} = \mathring{\mathbf u} - \boldsymbol\omega\times\mathbf u",
        rf"{{}}^{{B}}{RATE} = {{}}^{{N}}{RATE} + \boldsymbol\omega\times\mathbf u",
    ],
)
def test_false_equations(formula):
    assert judged(formula) == "wrong"


def test_components_in_two_frames_do_not_meet():
    assert judged(r"[C] = [C]^T") == "ill-formed"
    assert judged(r"[C]\boldsymbol\omega = \mathbf u") == "ill-formed"
