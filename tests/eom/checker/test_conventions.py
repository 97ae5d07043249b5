"""Lines that are right in the other one of two conventions, and slips, which are right in neither."""

import pytest

from eom.checker.mean.lexicon_files import parse_lexicon
from tests.eom.checker.attitudes import BOLD, HUGHES, KANE, SCHAUB
from tests.eom.checker.test_explaining import wrong
from tests.eom.rows import only

ACTIVE = "active and passive"
FIXED = "fixed and moving axes"
SCALAR = "scalar of quaternions"

LINES = {
    "Poisson's equation with the matrix of the other direction": (
        SCHAUB,
        r"[\dot C] = [C][\tilde{\boldsymbol\omega}]",
        r"[\dot C] = 2[C][\tilde{\boldsymbol\omega}]",
        ACTIVE,
    ),
    "the matrix of axis and angle that turns vectors": (
        HUGHES,
        (
            r"\mathbf{C} = \cos\phi\,\mathbf{1} + (1 - \cos\phi)\mathbf{a}\mathbf{a}^T"
            r" + \sin\phi\,\mathbf{a}^\times"
        ),
        (
            r"\mathbf{C} = \cos\phi\,\mathbf{1} + (1 + \cos\phi)\mathbf{a}\mathbf{a}^T"
            r" - \sin\phi\,\mathbf{a}^\times"
        ),
        ACTIVE,
    ),
    "an elementary turn of vectors": (
        HUGHES,
        (
            r"\mathbf{C}_3(\alpha) = \begin{bmatrix}\cos\alpha & -\sin\alpha & 0\\"
            r" \sin\alpha & \cos\alpha & 0\\ 0 & 0 & 1\end{bmatrix}"
        ),
        (
            r"\mathbf{C}_3(\alpha) = \begin{bmatrix}\cos\alpha & -\sin\alpha & 0\\"
            r" -\sin\alpha & \cos\alpha & 0\\ 0 & 0 & 1\end{bmatrix}"
        ),
        ACTIVE,
    ),
    "rates of a sequence about fixed axes": (
        KANE,
        r"\omega_1 = \dot\theta_3\sin\theta_2\sin\theta_1 + \dot\theta_2\cos\theta_1",
        r"\omega_1 = \dot\theta_3\sin\theta_2\sin\theta_1 - \dot\theta_2\cos\theta_1",
        FIXED,
    ),
    "rates of a sequence about moving axes": (
        HUGHES,
        r"\omega_1 = \dot\theta_1 c_2 c_3 + \dot\theta_2 s_3",
        r"\omega_1 = \dot\theta_1 c_2 c_3 + \dot\theta_2 c_3",
        FIXED,
    ),
    "the order of three turns": (
        SCHAUB,
        r"[BN] = [M_3(\psi)][M_2(\theta)][M_1(\phi)]",
        r"[BN] = [M_3(\psi)][M_1(\phi)][M_2(\theta)]",
        FIXED,
    ),
    "a column with the scalar last": (
        SCHAUB,
        (
            r"\boldsymbol\beta = \begin{bmatrix} e_1\sin\frac{\Phi}{2}\\ e_2\sin\frac{\Phi}{2}\\"
            r" e_3\sin\frac{\Phi}{2}\\ \cos\frac{\Phi}{2}\end{bmatrix}"
        ),
        (
            r"\boldsymbol\beta = \begin{bmatrix} e_1\sin\frac{\Phi}{2}\\ -e_2\sin\frac{\Phi}{2}\\"
            r" e_3\sin\frac{\Phi}{2}\\ \cos\frac{\Phi}{2}\end{bmatrix}"
        ),
        SCALAR,
    ),
    "rates of a column with the scalar first": (
        BOLD,
        (
            r"\dot{\mathsf{q}} = \frac12\begin{bmatrix} 0 & -\omega_1 & -\omega_2 & -\omega_3\\"
            r" \omega_1 & 0 & \omega_3 & -\omega_2\\ \omega_2 & -\omega_3 & 0 & \omega_1\\"
            r" \omega_3 & \omega_2 & -\omega_1 & 0\end{bmatrix}\mathsf{q}"
        ),
        (
            r"\dot{\mathsf{q}} = \frac12\begin{bmatrix} 0 & -\omega_1 & -\omega_2 & -\omega_3\\"
            r" \omega_1 & 0 & -\omega_3 & -\omega_2\\ \omega_2 & -\omega_3 & 0 & \omega_1\\"
            r" \omega_3 & \omega_2 & -\omega_1 & 0\end{bmatrix}\mathsf{q}"
        ),
        SCALAR,
    ),
}


SHORT = (
    "an elementary turn of vectors",
    "rates of a sequence about fixed axes",
    "a column with the scalar last",
)
"""One line of each convention."""


@pytest.mark.parametrize("name", only(LINES, *SHORT[:1]))
def test_a_convention_is_reported_apart_from_a_slip(name):
    lexicon, other, slip, which = LINES[name]
    assert which in wrong(other, parse_lexicon(lexicon))[1].convention
    assert not wrong(slip, parse_lexicon(lexicon))[1].convention


@pytest.mark.slow
def test_a_line_that_two_conventions_make_right_names_both():
    text = r"\mathbf{C}_{bi} = \mathbf{C}_3(\theta_3)\mathbf{C}_2(\theta_2)\mathbf{C}_1(\theta_1)"
    found = wrong(text, parse_lexicon(HUGHES))[1].convention
    assert ACTIVE in found
    assert FIXED in found
    assert SCALAR not in found


def test_a_zero_column_of_a_quaternion_has_its_size():
    """A factor zero is tried before everything: what is left must still have rows."""
    found = wrong(r"\boldsymbol\beta = 0\boldsymbol\beta", parse_lexicon(SCHAUB))[1]
    assert not found.convention
