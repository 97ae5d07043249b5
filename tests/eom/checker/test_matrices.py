r"""Matrices and columns: of a system, any ones, quaternions, spatial vectors, frames exchanged."""

from __future__ import annotations

import pytest

from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import verdict
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document
from eom.checker.repair.explaining import explain
from eom.errors import InputError

POLAR = r"""
[symbols]
't' = "time"
'q' = "coordinates"
'B' = "mass_matrix"
'C' = "coriolis_matrix"
'\mathbf{g}' = "gravity_column"
'\mathbf{F}' = "force_column"
'J' = "jacobian hand component x y"
'p' = "place hand component x y"
'\mathcal T' = "system T"
'\gamma' = "system g"
'K' = "matrix K 2 2 constant"
'a' = "column a 2"
'n' = "defined"
[system]
coordinates = { phi = "rad", r = "m" }
given = { M_phi = "N*m", F_r = "N" }
parameters = { m = "kg", J_0 = "kg*m^2", g = "m/s^2" }
gravity = [0, "-g", 0]
forces = { phi = "M_phi", r = "F_r" }
[system.bodies]
arm = { moments = ["J_0"], omega = ["phi_dot"] }
hand = { mass = "m", at = ["r*cos(phi)", "r*sin(phi)", 0] }
"""
"""An arm that turns and slides: its coordinates have different units."""

SPATIAL_ARM = r"""
[symbols]
't' = "time"
'q' = "coordinates"
'M' = "mass_matrix"
'C' = "coriolis_matrix"
'G' = "gravity_column"
'J' = "jacobian tip"
'p' = "place tip"
'\tau' = "force_column"
[system]
coordinates = { a = "rad", b = "rad", s = "m" }
given = { T_1 = "N*m", T_2 = "N*m", T_3 = "N" }
parameters = { m = "kg", g = "m/s^2" }
gravity = [0, 0, "-g"]
forces = { a = "T_1", b = "T_2", s = "T_3" }
[system.bodies]
tip = { mass = "m", at = ["s*cos(a)*cos(b)", "s*sin(a)*cos(b)", "s*sin(b)"] }
"""
"""Three coordinates, whose matrices have the size of those of vectors."""

ANY = r"""
[symbols]
't' = "time"
'q' = "column q 2"
'r' = "column r 2"
'M' = "matrix M 2 2 symmetric of q"
'G' = "column G 2 of q"
'V' = "function V of q"
'K_p' = "matrix K_p 2 2 constant symmetric"
'\tau' = "column tau 2"
'T' = '= \tfrac12 \dot q^T M(q) \dot q'
'A' = "matrix A 3 3"
'N' = "matrix N 3 3 skew"
'x' = "column x 3"
'e' = "defined"
'c_{ijk}' = "defined"
"""

ROTATIONS = r"""
[notation]
mixed = "B"
quaternions = "PRODUCT"
[frames]
'B' = "B"
'N' = "I"
[symbols]
't' = "time"
'q' = "QUATERNION B I"
'\omega' = "angular_velocity B I in B"
'\Omega' = "omega_matrix"
'\Xi' = "xi_matrix"
'E' = "identity_matrix"
'v' = "vector v in B"
'V' = "vector v in I"
'p' = "column p 4"
's' = "column s 4"
"""

TWISTS = r"""
[notation]
spatial = "ORDER"
mixed = "B"
[frames]
'B' = "B"
[symbols]
't' = "time"
'v' = "column v 6"
'm' = "column m 6"
'f' = "column f 6"
'I' = "matrix I 6 6 symmetric constant"
'\omega' = "angular_velocity B I in B"
'u' = "vector u in B"
'V' = '= \begin{bmatrix}\omega\\ u\end{bmatrix}'
'\operatorname{crf}' = "spatial_cross_dual"
'\operatorname{crm}' = "spatial_cross"
"""

POSES = r"""
[frames]
'a' = "D"
'b' = "E"
[points]
'a' = "OA"
'b' = "OB"
[symbols]
'{}^{<F>}_{<G>}R' = "rotation <F> <G>"
'{}^{a}p_b' = "position OB OA in D"
'{}^{<F>}_{<G>}H' = "defined"
"""
POSE = r"$${}^{a}_{b}H = \begin{bmatrix} {}^{a}_{b}R & {}^{a}p_b\\ 0\;\;0\;\;0 & 1\end{bmatrix}$$"


def _verdicts(lexicon: str, *lines: str) -> list[str]:
    note = "\n\n".join(line if line.startswith("$") else f"$${line}$$" for line in lines)
    found = understand(read_document(note), parse_lexicon(lexicon))
    return [verdict(u, ("constant_mass",)).verdict for u in found]


HOLDS, WRONG, OPEN, NEW = "holds", "wrong", "undecided", "definition"
SHUSTER = ROTATIONS.replace("PRODUCT", "shuster last").replace("QUATERNION", "quaternion_last")
HAMILTON = ROTATIONS.replace("PRODUCT", "hamilton first").replace("QUATERNION", "quaternion")
ANGULAR, LINEAR = (TWISTS.replace("ORDER", f"{w} first") for w in ("angular", "linear"))

LAGRANGE = (
    r"\frac{d}{dt}\frac{\partial\mathcal T}{\partial\dot q}-\frac{\partial\mathcal T}{\partial q}"
    r"=\mathbf F-\mathbf g(q)"
)
CHAIN = (
    r"\dot M_{12} = \frac{\partial M_{12}}{\partial q_1}\dot q_1 "
    r"+ \frac{\partial M_{12}}{\partial q_2}\dot q_1"
)
LINES = [
    (POLAR, r"q = \begin{bmatrix}\phi\\ r\end{bmatrix}", HOLDS),
    (POLAR, r"B(q) = \begin{bmatrix} J_0 + m r^2 & 0\\ 0& m\end{bmatrix}", HOLDS),
    (POLAR, r"B(q) = \begin{bmatrix} J_0 + 2 m r^2 & 0\\ 0& m\end{bmatrix}", WRONG),
    (POLAR, r"C(q,\dot q)\dot q = [2 m r\dot r\dot\phi,\ -m r\dot\phi^2]^T", HOLDS),
    (POLAR, r"C = \begin{bmatrix} m r\dot r & m r\dot\phi\\ m r\dot\phi & 0\end{bmatrix}", WRONG),
    (POLAR, r"\det J(q) = -r", HOLDS),
    (POLAR, r"\det J(q) = r", WRONG),
    (POLAR, r"rJ^{-1} = \begin{bmatrix}-\sin\phi&\cos\phi\\r\cos\phi&r\sin\phi\end{bmatrix}", HOLDS),
    (POLAR, r"\ddot p = J\ddot q + \dot J\dot q", HOLDS),
    (POLAR, r"\ddot p = J\ddot q - \dot J\dot q", WRONG),
    (POLAR, r"\dot B - 2 C = -(\dot B - 2 C)^T", HOLDS),
    (POLAR, r"\dot q^T(\dot B - C)\dot q = 0", WRONG),
    (POLAR, r"B(q)\ddot q + C(q,\dot q)\dot q + \mathbf g(q) = \mathbf F", HOLDS),
    (POLAR, r"B(q)\ddot q + C(q,\dot q)\dot q - \mathbf g(q) = \mathbf F", WRONG),
    (POLAR, r"\ddot q = B^{-1}(q)\left(\mathbf F - C\dot q - \mathbf g(q)\right)", HOLDS),
    (POLAR, LAGRANGE, HOLDS),
    (POLAR, r"B_{11} = J_0 + m r^2", HOLDS),
    (POLAR, r"\dot B_{ij} = \sum_k\frac{\partial B_{ij}}{\partial q_k}\dot q_k", HOLDS),
    (POLAR, r"n = K q", NEW),
    (POLAR, r"\mathbf F = K a", OPEN),
    (POLAR, r"\frac{d}{dt}(K q) = K\dot q", HOLDS),
    (SPATIAL_ARM, r"\dot p = J(q)\dot q", HOLDS),
    (SPATIAL_ARM, r"\dot M = C + C^T", HOLDS),
    (SPATIAL_ARM, r"M(q)\ddot q + C(q,\dot q)\dot q + G(q) = \tau", HOLDS),
    (SPATIAL_ARM, r"\tau = J(q)^T\left(m\ddot p\right) + G(q)", HOLDS),
    (SPATIAL_ARM, r"\tau = J(q)\left(m\ddot p\right) + G(q)", WRONG),
    (SPATIAL_ARM, r"M_{33} = m,\quad M_{13} = 0", HOLDS),
    (ANY, r"\frac{\partial T}{\partial \dot q} = M(q)\dot q", HOLDS),
    (ANY, r"\dot T = \dot q^T M(q)\ddot q + \tfrac12\dot q^T\dot M\dot q", HOLDS),
    (ANY, r"\dot T = \dot q^T M(q)\ddot q + \dot q^T\dot M\dot q", WRONG),
    (ANY, r"\dot V = \dot q^T\frac{\partial V}{\partial q}", HOLDS),
    (ANY, CHAIN, WRONG),
    (ANY, r"e = r - q", NEW),
    (ANY, r"\frac{d}{dt}\left(\tfrac12 r^T K_p r\right) = \dot r^T K_p r", HOLDS),
    (ANY, r"\frac{d}{dt}\left(\tfrac12 r^T M(q) r\right) = \dot r^T M(q) r", WRONG),
    (ANY, r"\frac{d}{dt} M^{-1} = -M^{-1}\dot M M^{-1}", HOLDS),
    (ANY, r"\frac{d}{dt} A^{-1} = A^{-1}\dot A A^{-1}", WRONG),
    (ANY, r"x^T N x = 0", HOLDS),
    (ANY, r"\cos(60^\circ)\,K_p = \tfrac12 K_p", HOLDS),
    (ANY, r"M(q)\ddot q + G(q) = \tau", OPEN),
    (HAMILTON, r"\dot q = \tfrac12 q\otimes\omega", HOLDS),
    (HAMILTON, r"\dot q = \tfrac12 \omega\otimes q", WRONG),
    (SHUSTER, r"\dot q = \tfrac12 \omega\otimes q", HOLDS),
    (SHUSTER, r"\dot q = \tfrac12 q\otimes\omega", WRONG),
    (HAMILTON, r"v = q^*\otimes V\otimes q", HOLDS),
    (HAMILTON, r"v = q\otimes V\otimes q^*", WRONG),
    (HAMILTON, r"p\otimes p^{-1} = [1,0,0,0]^T", HOLDS),
    *(
        (lexicon, line, said)
        for lexicon in (HAMILTON, SHUSTER)
        for line, said in (
            (r"\dot q = \tfrac12\Omega(\omega) q = \tfrac12\Xi(q)\omega", HOLDS),
            (r"\dot q = \tfrac12\Omega^T(\omega) q", WRONG),
            (r"\omega = 2\,\Xi^T(q)\,\dot q", HOLDS),
            (r"\Xi(q)^T\Xi(q) = E", HOLDS),
            (r"(p\otimes s)^* = s^*\otimes p^*", HOLDS),
            (r"(p\otimes s)^* = p^*\otimes s^*", WRONG),
        )
    ),
    *(
        (lexicon, line, said)
        for lexicon in (ANGULAR, LINEAR)
        for line, said in (
            (r"v\times m = -m\times v", HOLDS),
            (r"m^T(v\times^* f) = -(v\times m)^T f", HOLDS),
            (r"m^T(v\times^* f) = (v\times m)^T f", WRONG),
            (r"\operatorname{crf}(v) = -\operatorname{crm}(v)^T", HOLDS),
            (r"\dot v^T I v = v^T I\dot v", HOLDS),
        )
    ),
    (ANGULAR, r"[V\times] = \begin{bmatrix}\omega^\times&0\\u^\times&\omega^\times\end{bmatrix}", HOLDS),
    (LINEAR, r"[V\times] = \begin{bmatrix}\omega^\times&0\\u^\times&\omega^\times\end{bmatrix}", WRONG),
]  # fmt: skip


@pytest.mark.sparse(36)
@pytest.mark.parametrize(("lexicon", "line", "said"), LINES)
def test_a_line_of_matrices(lexicon: str, line: str, said: str):
    assert _verdicts(lexicon, line) == [said]


def test_symbols_with_indices_are_defined_by_one_line_for_all_numbers():
    christoffel = (
        r"c_{ijk} = \tfrac12\left(\frac{\partial M_{ij}}{\partial q_k}"
        r"+\frac{\partial M_{ik}}{\partial q_j}-\frac{\partial M_{jk}}{\partial q_i}\right)"
    )
    used = r"\dot M_{ij} = \sum_k (c_{ijk} + c_{jik})\dot q_k"
    slip = r"\dot M_{ij} = \sum_k (c_{ijk} - c_{jik})\dot q_k"
    assert _verdicts(ANY, christoffel, used, slip) == [NEW, HOLDS, WRONG]


def test_what_is_defined_for_two_frames_holds_for_others():
    right = r"{}^{b}_{a}H = \begin{bmatrix}{}^{b}_{a}R&-{}^{b}_{a}R\,{}^{a}p_b\\ 0\;\;0\;\;0&1\end{bmatrix}"
    slip = right.replace("&-", "&", 1)
    inverse = r"{}^{b}_{a}H = {}^{a}_{b}H^{-1}"
    found = _verdicts(POSES, POSE, right, inverse, slip)
    assert found[:3] == [NEW, HOLDS, HOLDS]
    assert found[3] in {WRONG, "ill-formed"}


CHAIN_OF_LINKS = r"""
[symbols]
'\theta_1' = "free_angle a"
'\theta_2' = "free_angle b"
'c_{<k>}' = '= \cos\theta_{<k>}'
's_{<k>}' = '= \sin\theta_{<k>}'
'c_{12}' = '= \cos(\theta_1+\theta_2)'
's_{12}' = '= \sin(\theta_1+\theta_2)'
'a_{<k>}' = "scalar a<k>"
'A_1' = "defined"
'A_2' = "defined"
"""


def test_transformations_of_links_multiply():
    one, two = (
        rf"A_{k} = \begin{{bmatrix}}c_{k}&-s_{k}&0&a_{k}c_{k}\\s_{k}&c_{k}&0&a_{k}s_{k}\\"
        r"0&0&1&0\\0&0&0&1\end{bmatrix}"
        for k in (1, 2)
    )
    both = (
        r"A_1A_2 = \begin{bmatrix}c_{12}&-s_{12}&0&a_1c_1+a_2c_{12}\\s_{12}&c_{12}&0&a_1s_1+a_2s_{12}"
        r"\\0&0&1&0\\0&0&0&1\end{bmatrix}"
    )
    slip = both.replace("a_1s_1", "a_1c_1")
    assert _verdicts(CHAIN_OF_LINKS, one, two, both, slip) == [NEW, NEW, HOLDS, WRONG]


def test_a_sine_for_short_that_should_be_a_cosine_is_corrected():
    short = POLAR.replace("[system]", "'c_1' = '= \\cos\\phi'\n's_1' = '= \\sin\\phi'\n[system]")
    claims = understand(
        read_document(
            r"$$\mathbf g(q) = \begin{bmatrix}m\gamma r c_1\\ m\gamma c_1\end{bmatrix}$$"
        ),
        parse_lexicon(short),
    )
    (judged,) = verdict(claims[0], ("constant_mass",)).claims
    found = explain(claims[0], judged)
    assert found.corrections[0].text == "s_{1}"


def test_what_follows_from_a_law_of_control_holds_where_it_does():
    known = """'q_d' = "column d 2"
'e' = "defined"
'K_p' = "matrix P 2 2 constant"
'K_v' = "matrix W 2 2 constant"
[system]"""
    law = r"\mathbf F = B(q)\left(\ddot q_d + K_v\dot e + K_p e\right) + C\dot q + \mathbf g(q)"
    loop = r"\ddot e + K_v\dot e + K_p e = 0"
    arrow = r" \quad\Longrightarrow\quad "
    lines = (law + arrow + loop, law + arrow + loop.replace("+ K_p", "- K_p"), law)
    found = _verdicts(POLAR.replace("[system]", known, 1), "e = q_d - q", *lines)
    assert found == [NEW, HOLDS, WRONG, OPEN]


def test_a_letter_may_be_explained_behind_its_use():
    line = r"C(q,\dot q)\dot q = [2 n\dot r,\ -n\dot\phi]^T,\qquad n = m r\dot\phi"
    assert _verdicts(POLAR, line) == [HOLDS]


@pytest.mark.parametrize(
    "entry",
    [
        "matrix M",
        "matrix M 2 9",
        "column q 2 wide",
        "place",
        "mass_matrix 3",
        "jacobian tip component 4",
    ],
)
def test_a_matrix_needs_a_size(entry: str):
    with pytest.raises(InputError):
        parse_lexicon(f"[symbols]\n'M' = \"{entry}\"")
