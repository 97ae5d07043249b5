"""Attitude in notes: what is true in textbooks holds in their notations, and slips in it are wrong."""

import itertools

import pytest
import sympy as sp

from eom.checker.infer.draft import propose
from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import verdict
from eom.checker.mean.lexicon_files import PRESETS, parse_lexicon
from eom.checker.read.documents import read_document
from tests.eom.checker.attitudes import ANGLES, SCHAUB, STILL_TRUE, TRUE, mutants
from tests.eom.rows import every, only

SEQUENCES = [
    "".join(p) for p in itertools.product("123", repeat=3) if p[0] != p[1] and p[1] != p[2]
]
PSI, THETA, PHI = sp.symbols("psi theta phi")
NAMES = {PSI: r"\psi", THETA: r"\theta", PHI: r"\phi"}


def judged(lexicon, latex, given=()):
    (found,) = understand(read_document(f"$${latex}$$\n"), parse_lexicon(lexicon))
    return verdict(found, given)


@pytest.mark.parametrize(("source", "lexicon", "latex"), TRUE)
def test_what_textbooks_say_holds(source, lexicon, latex):
    found = judged(lexicon, latex)
    assert found.verdict == "holds", (source, found.reason)


def test_every_preset_is_used():
    assert {name for name in PRESETS if any(f'"{name}"' in row[1] for row in TRUE)} == set(PRESETS)


@pytest.mark.parametrize(("source", "lexicon", "latex"), every(4, TRUE))
def test_slips_in_it_do_not_hold(source, lexicon, latex):
    found = {m: judged(lexicon, m).verdict for m in mutants(latex)}
    assert found or "=" in latex
    others = [m for m, v in found.items() if v not in {"wrong", "ill-formed"}]
    assert [found[m] for m in others] == ["holds"] * STILL_TRUE.get(source, 0), others


def test_slips_are_many():
    assert sum(len(list(mutants(latex))) for _, _, latex in TRUE) > 500


# -- all sequences, against matrices multiplied by SymPy ---------------------------------------------


def plane(axis, angle):
    """The rotation about an axis (from 1), written out."""
    c, s = sp.cos(angle), sp.sin(angle)
    i, j = axis % 3, (axis + 1) % 3
    m = sp.zeros(3)
    m[axis - 1, axis - 1] = 1
    m[i, i] = m[j, j] = c
    m[i, j], m[j, i] = s, -s
    return m


def of_sequence(axes):
    """C, and the matrix of the rates in the frame that is reached: each turn adds its own axis."""
    a, b, c = map(int, axes)
    first, second, third = plane(a, PSI), plane(b, THETA), plane(c, PHI)
    e = sp.eye(3)
    columns = (third * second * e[:, a - 1], third * e[:, b - 1], e[:, c - 1])
    return third * second * first, sp.Matrix.hstack(*columns)


def table(matrix):
    rows = (
        " & ".join(sp.latex(e, symbol_names=NAMES) for e in matrix.row(k))
        for k in range(matrix.rows)
    )
    return r"\begin{bmatrix}" + r"\\ ".join(rows) + r"\end{bmatrix}"


def with_axes(axes):
    return SCHAUB.replace("321", axes)


OMEGA = r"\begin{bmatrix}\omega_1\\ \omega_2\\ \omega_3\end{bmatrix}"
ANGLE_RATES = r"\begin{bmatrix}\dot\psi\\ \dot\theta\\ \dot\phi\end{bmatrix}"


@pytest.mark.parametrize("axes", only(SEQUENCES, "321", "313"))
def test_matrix_and_rates_of_every_sequence(axes):
    C, B = of_sequence(axes)
    assert judged(with_axes(axes), f"[C] = {table(C)}").verdict == "holds"
    assert judged(with_axes(axes), f"[C] = {table(C.T)}").verdict == "wrong"
    assert judged(with_axes(axes), f"{OMEGA} = {table(B)}{ANGLE_RATES}").verdict == "holds"
    singular = sp.sin(THETA) if axes[0] == axes[2] else sp.cos(THETA)
    assert sp.trigsimp(B.det() ** 2 - singular**2) == 0
    sign = sp.sign(B.det().subs({PSI: 1, THETA: 1, PHI: 1}))
    below = sp.latex(sign * singular, symbol_names=NAMES)
    inverse = rf"\frac{{1}}{{{below}}}{table(B.adjugate())}"
    assert judged(with_axes(axes), f"{ANGLE_RATES} = {inverse}{OMEGA}").verdict == "holds"
    assert judged(with_axes(axes), f"{ANGLE_RATES} = {table(B)}{OMEGA}").verdict == "wrong"
    assert judged(with_axes(axes), rf"\det{table(B)} = {below}").verdict == "holds"


@pytest.mark.parametrize("axes", only(SEQUENCES, "123", "232"))
def test_one_slip_in_every_sequence(axes):
    C, B = of_sequence(axes)
    places = [(r, c) for r in range(3) for c in range(3) if C[r, c] != 0]
    for r, c in places[::4]:
        slip = C.copy()
        slip[r, c] = -slip[r, c]
        assert judged(with_axes(axes), f"[C] = {table(slip)}").verdict == "wrong"
    slip = B.subs({sp.sin(THETA): sp.cos(THETA), sp.cos(THETA): sp.sin(THETA)}, simultaneous=True)
    assert judged(with_axes(axes), f"{OMEGA} = {table(slip)}{ANGLE_RATES}").verdict == "wrong"


@pytest.mark.parametrize("axes", ["321", "313", "123", "232"])
def test_turns_about_fixed_axes_are_those_about_moving_ones_backwards(axes):
    fixed = with_axes(f"space{axes}")
    a, b, c = axes
    first = rf"[C] = [M_{a}(\psi)][M_{b}(\theta)][M_{c}(\phi)]"
    assert judged(fixed, first).verdict == "holds"
    assert judged(fixed, rf"[C] = [M_{c}(\phi)][M_{b}(\theta)][M_{a}(\psi)]").verdict == "wrong"
    assert judged(with_axes(f"body{axes}"), first).verdict == "wrong"


def test_angles_of_two_sequences_at_once_are_undecided():
    lexicon = SCHAUB + "\n'\\alpha' = \"turn_angle 1 313 B I\""
    found = judged(lexicon, r"\alpha = \psi")
    assert found.verdict == "undecided"


def test_angles_and_a_body_together():
    """The kinetic energy of a symmetric top in the angles 3-1-3 (Goldstein, sect. 5.7)."""
    lexicon = with_axes("313")
    energy = (
        r"T_{rot} = \frac12 I_1(\dot\psi^2\sin^2\theta + \dot\theta^2)"
        r" + \frac12 I_3(\dot\psi\cos\theta + \dot\phi)^2"
    )
    assert judged(lexicon, energy, ["constant_mass"]).claims[0].judgement.sets == (("symmetric",),)
    slip = energy.replace(r"\sin^2", r"\cos^2")
    assert judged(lexicon, slip, ["constant_mass"]).verdict == "wrong"
    assert judged(lexicon, energy, ["symmetric", "torque_free"]).verdict == "holds"


# -- how it is written -------------------------------------------------------------------------------

SPELLINGS = {
    r"\mathrm{s}\theta = \sin\theta": "holds",
    r"c^2\theta + s^2\theta = 1": "holds",
    r"c_\theta^2 + s_\theta^2 = 1": "holds",
    r"c_{\theta/2}^2 = \frac{1 + c_\theta}{2}": "holds",
    r"\cos\frac{\theta}{2} = c_{\theta/2}": "holds",
    r"c\theta = s\theta": "wrong",
    r"\sec\theta\cos\theta = 1": "holds",
    r"\csc\theta\sin\theta = \cot\theta\tan\theta": "holds",
    r"\tan\theta = \frac{2\tan\frac\theta2}{1 - \tan^2\frac\theta2}": "holds",
    r"\sin(\psi - \theta) = \sin\psi\cos\theta - \cos\psi\sin\theta": "holds",
    r"[M_3(\psi)]^T = [M_3(-\psi)]": "holds",
    r"[M_3(\psi)]^{-1} = [M_3(\psi)]": "wrong",
    r"M_3(\psi)^T M_3(\psi) = [I_{3\times3}]": "holds",
    r"M_3(\omega_1) = [I_{3\times3}]": "wrong",
    r"M_3 = [I_{3\times3}]": "undecided",
    r"[NB] = [BN]^T": "holds",
    r"[BN] = [NB]": "ill-formed",
    r"[BA][BN] = [C]": "ill-formed",
    r"{}^{\mathcal N}[I_C] = [BN]^T\,{}^{\mathcal B}[I_C]\,[BN]": "holds",
    r"{}^{\mathcal N}[I_C] = [NB]\,{}^{\mathcal B}[I_C]\,[BN]": "holds",
    r"{}^{\mathcal N}[I_C] = [BN]\,{}^{\mathcal B}[I_C]\,[BN]^T": "ill-formed",
    r"\boldsymbol\beta = (\beta_0, \beta_1, \beta_2, \beta_3)^T": "ill-formed",
    r"\boldsymbol\beta = (\beta_0, \beta_1, \beta_2, \beta_3)": "holds",
    r"\boldsymbol\beta = [\beta_0, \beta_1, \beta_2, \beta_3]^T": "holds",
    r"\boldsymbol\beta = [\beta_1, \beta_2, \beta_3, \beta_0]^T": "wrong",
    r"\boldsymbol\beta^T\boldsymbol\beta - 1 = 0": "holds",
    r"\boldsymbol\beta\boldsymbol\beta^T\boldsymbol\beta = \boldsymbol\beta": "holds",
    r"\boldsymbol\beta\boldsymbol\beta = 1": "ill-formed",
    r"\boldsymbol\beta = \boldsymbol\omega": "ill-formed",
    r"\boldsymbol\beta - \boldsymbol\beta = 0": "holds",
    r"\|\boldsymbol\beta\|^2 = 1": "holds",
    r"|\hat{\mathbf e}| = 1": "holds",
    r"|\hat{\mathbf e}| = 2": "wrong",
    r"|\boldsymbol\omega| = \sqrt{\omega_1^2 + \omega_2^2 + \omega_3^2}": "holds",
    r"|\boldsymbol\omega| = \sqrt{\omega_1^2 + \omega_2^2 - \omega_3^2}": "wrong",
    r"\sigma_1 = e_1\tan\frac{\Phi}{4}": "holds",
    r"\sigma_1 = e_1\tan\frac{\Phi}{2}": "wrong",
    r"\sin\frac{\Phi}{3} = 0": "undecided",
}


@pytest.mark.parametrize("latex", SPELLINGS)
def test_spellings(latex):
    found = judged(SCHAUB, latex)
    assert found.verdict == SPELLINGS[latex], found.reason


def test_a_letter_that_means_something_is_no_abbreviation():
    lexicon = SCHAUB + "\n'c' = \"scalar c\"\n's_\\theta' = \"scalar s\""
    assert judged(lexicon, r"c\theta = \cos\theta").verdict == "wrong"
    assert judged(lexicon, r"s_\theta = \sin\theta").verdict == "wrong"
    assert ANGLES in lexicon


# -- drafts of lexica --------------------------------------------------------------------------------

NOTE = r"""
# Attitude of the satellite

Let $\psi$, $\theta$ and $\phi$ be the 3-2-1 Euler angles of the body. The rotation matrix $C$ is
$$C = C_1(\phi) C_2(\theta) C_3(\psi).$$
The quaternion $\mathbf{q}$, scalar last, has
$$q_4 = \cos\frac{\phi}{2}\cos\frac{\theta}{2}\cos\frac{\psi}{2} +
\sin\frac{\phi}{2}\sin\frac{\theta}{2}\sin\frac{\psi}{2}$$
$$q_4 = \cos\frac{\phi}{2}\cos\frac{\theta}{2}\cos\frac{\psi}{2} -
\sin\frac{\phi}{2}\sin\frac{\theta}{2}\sin\frac{\psi}{2}$$
The vector $\boldsymbol{\sigma}$ holds the modified Rodrigues parameters.
$$\boldsymbol{\sigma}^T\boldsymbol{\sigma} = \frac{1 - q_4}{1 + q_4}$$
"""


def test_a_note_is_judged_by_the_lexicon_drafted_from_its_words():
    document = read_document(NOTE)
    lexicon = parse_lexicon(propose(document).toml)
    found = [verdict(u) for u in understand(document, lexicon) if u.formula.piece.kind == "display"]
    assert [v.verdict for v in found] == ["holds", "holds", "wrong", "holds"], [
        v.reason for v in found
    ]


SAID = {
    r"Let $\psi$, $\theta$, $\phi$ be the 3-1-3 Euler angles.": "313",
    r"The body is reached by a 3-2-1 sequence of rotations through $(\psi,\theta,\phi)$.": "321",
    r"The 123 angles $\psi,\theta,\phi$ turn the frame.": "123",
    r"The angles $\psi$, $\theta$, and $\phi$ follow the $z$-axis.": None,
    r"$\psi, \theta, \phi$ are the yaw, pitch and roll angles.": "321",
    r"The yaw, pitch and roll $(\psi, \theta, \phi)$.": "321",
    r"The space-fixed 1-2-3 angles $\psi$, $\theta$, $\phi$.": "space123",
    r"The z-x-z angles $\psi$, then $\theta$, then $\phi$.": "313",
    r"The angles $\psi$, $\theta$, $\phi$ of an unknown sequence.": None,
    r"The 3-3-1 angles $\psi$, $\theta$, $\phi$.": None,
    r"The 3-2-1 angles $\psi$ and $\theta$.": None,
    r"Section 3-2-1 has masses $\psi$, $\theta$, $\phi$.": None,
}


@pytest.mark.parametrize("words", SAID)
def test_a_sequence_is_read_where_words_name_it(words):
    drafts = {d.latex: d.meaning for d in propose(read_document(words + "\n")).drafts}
    axes = SAID[words]
    wanted = {
        name: f"turn_angle {k} {axes} B I"
        for k, name in enumerate((r"\psi", r"\theta", r"\phi"), 1)
    }
    turned = {k: v for k, v in drafts.items() if v.startswith("turn_angle")}
    assert turned == (wanted if axes else {})


# -- gravity -----------------------------------------------------------------------------------------

ORBIT = r"""
preset = "hughes"
[symbols]
'\mu' = "gravity_parameter"
'R' = "orbit_radius"
'\mathbf{u}' = "orbit_direction in B"
'u_{<k>}' = "orbit_direction in B component <k>"
'\mathbf{R}_c' = "orbit_position in B"
'\mathbf{g}_g' = "gravity_torque in B"
'g_{g<k>}' = "gravity_torque in B component <k>"
'V_g' = "gravity_energy"
"""
GRAVITY = {
    r"\mathbf{g}_g = \frac{3\mu}{R^3}\mathbf{u}^\times\mathbf{I}\mathbf{u}": "holds",
    r"\mathbf{g}_g = \frac{3\mu}{R^5}\mathbf{R}_c^\times\mathbf{I}\mathbf{R}_c": "holds",
    r"\mathbf{u}^T\mathbf{g}_g = 0": "holds",
    r"V_g = -\frac{\mu m}{R} - \frac{\mu}{2R^3}(\operatorname{tr}\mathbf{I}"
    r" - 3\mathbf{u}^T\mathbf{I}\mathbf{u})": "holds",
    r"\mathbf{g}_g = \frac{3\mu}{R^3}\mathbf{u}^\times\mathbf{J}\mathbf{u}": "holds under",
    r"g_{g1} = \frac{3\mu}{R^3}(I_3 - I_2)u_2u_3": "holds under",
    r"g_{g1} = \frac{3\mu}{R^3}(I_2 - I_3)u_2u_3": "wrong",
    r"\mathbf{g}_g = -\frac{3\mu}{R^3}\mathbf{u}^\times\mathbf{I}\mathbf{u}": "wrong",
    r"\mathbf{g}_g = \frac{2\mu}{R^3}\mathbf{u}^\times\mathbf{I}\mathbf{u}": "wrong",
    r"\mathbf{g}_g = \frac{3\mu}{R^2}\mathbf{u}^\times\mathbf{I}\mathbf{u}": "wrong",
    r"V_g = -\frac{\mu m}{R} - \frac{\mu}{2R^3}(\operatorname{tr}\mathbf{I}"
    r" - \mathbf{u}^T\mathbf{I}\mathbf{u})": "wrong",
}


@pytest.mark.parametrize("latex", every(2, GRAVITY))
def test_gravity_gradient(latex):
    found = judged(ORBIT, latex, ["constant_mass"])
    assert found.verdict == GRAVITY[latex], found.reason
