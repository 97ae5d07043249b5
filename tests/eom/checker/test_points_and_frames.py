r"""Vectors between two points, points that are fixed in any frame, frames with any label."""

import pytest

import eom
from eom.checker.mean.lexicon_files import parse_lexicon
from tests.eom.checker.system_lines import judged

FRENCH = r"""
[frames]
'\mathcal{R}_0' = "I"
'\mathcal{R}_1' = "A"
'\mathcal{R}_2' = "R2"
[points]
'O' = "OI"
'A' = "inA1"
'B' = "inA2"
'M' = "freeM"
'O_2' = "inR21"
[symbols]
'\vec{U}' = "vector U"
'\vec{V}(<P>/\mathcal{R}_0)' = "velocity <P> OI I"
'\vec{V}(M/\mathcal{R}_1)' = "velocity freeM inA1 A"
'\vec{\Gamma}(<P>/\mathcal{R}_0)' = '= \left(\frac{d}{dt} \vec{V}(<P>/\mathcal{R}_0)\right)_{\mathcal{R}_0}'
'\vec{\Gamma}(M/\mathcal{R}_1)' = '= \left(\frac{d}{dt} \vec{V}(M/\mathcal{R}_1)\right)_{\mathcal{R}_1}'
'\vec{\Omega}(<F>/<G>)' = "angular_velocity <F> <G>"
'\vec{\Omega}' = "angular_velocity A I"
"""
D0 = r"\left(\frac{d\overrightarrow{AB}}{dt}\right)_{\mathcal R_0}"
D1 = D0.replace("_0", "_1")
V0 = r"\vec V(M/\mathcal R_0)=\vec V(M/\mathcal R_1)+\vec V(A/\mathcal R_0)"
ROUND = r"+\left(\frac{d\vec\Omega}{dt}\right)_{\mathcal R_0}"
FRENCH_LINES = {
    r"\overrightarrow{AM}=\overrightarrow{OM}-\overrightarrow{OA}": True,
    r"\overrightarrow{AM}=\overrightarrow{OA}-\overrightarrow{OM}": False,
    r"\overrightarrow{O_2M}+\overrightarrow{MA}=\overrightarrow{O_2A}": True,
    D1 + r"=\vec 0": True,
    D0 + r"=\vec\Omega\wedge\overrightarrow{AB}": True,
    D0 + r"=\overrightarrow{AB}\wedge\vec\Omega": False,
    r"\vec V(B/\mathcal R_0)=\vec V(A/\mathcal R_0)+\overrightarrow{BA}\wedge\vec\Omega": True,
    V0 + r"+\vec\Omega\wedge\overrightarrow{AM}": True,
    V0 + r"+\vec\Omega\wedge\overrightarrow{MA}": False,
    r"\vec\Gamma(M/\mathcal R_0)=\vec\Gamma(M/\mathcal R_1)+\vec\Gamma(A/\mathcal R_0)"
    r"+\left(\frac{d\vec\Omega}{dt}\right)_{\mathcal R_0}\wedge\overrightarrow{AM}"
    r"+\vec\Omega\wedge(\vec\Omega\wedge\overrightarrow{AM})+2\vec\Omega\wedge\vec V(M/\mathcal R_1)": True,
    r"\vec\Gamma(M/\mathcal R_0)=\vec\Gamma(M/\mathcal R_1)+\vec\Gamma(A/\mathcal R_0)"
    r"+\left(\frac{d\vec\Omega}{dt}\right)_{\mathcal R_0}\wedge\overrightarrow{AM}"
    r"+\vec\Omega\wedge(\vec\Omega\wedge\overrightarrow{AM})+\vec\Omega\wedge\vec V(M/\mathcal R_1)": False,
    r"\vec\Omega(\mathcal R_2/\mathcal R_0)=\vec\Omega(\mathcal R_2/\mathcal R_1)+\vec\Omega": True,
    r"\left(\frac{d}{dt}\vec\Omega(\mathcal R_2/\mathcal R_0)\right)_{\mathcal R_0}"
    r"=\left(\frac{d}{dt}\vec\Omega(\mathcal R_2/\mathcal R_1)\right)_{\mathcal R_1}"
    + ROUND
    + r"+\vec\Omega\wedge\vec\Omega(\mathcal R_2/\mathcal R_1)": True,
    r"\left(\frac{d}{dt}\vec\Omega(\mathcal R_2/\mathcal R_0)\right)_{\mathcal R_0}"
    r"=\left(\frac{d}{dt}\vec\Omega(\mathcal R_2/\mathcal R_1)\right)_{\mathcal R_1}"
    r"+\left(\frac{d\vec\Omega}{dt}\right)_{\mathcal R_0}": False,
    r"\overrightarrow{AM}^2=|\overrightarrow{OM}-\overrightarrow{OA}|^2": True,
}
BOLD = r"""
[points]
'O' = "O"
'S' = "C"
'P' = "OA"
[symbols]
'\boldsymbol{\omega}' = "angular_velocity B I"
'\mathbf{v}_{<P>}' = "velocity <P> OI I"
"""
GERMAN = BOLD.replace(r"\boldsymbol{\omega}", r"\underline{\omega}").replace(
    r"\mathbf{v}", r"\underline{v}"
)
RUSSIAN = BOLD.replace(r"\boldsymbol{\omega}", r"\bar{\omega}").replace(r"\mathbf{v}", r"\bar{v}")
BODIES = (
    (BOLD, r"\mathbf v_P=\mathbf v_S+\boldsymbol\omega\times\mathbf{SP}", True),
    (BOLD, r"\mathbf v_P=\mathbf v_S+\boldsymbol\omega\times\mathbf r_{P/S}", True),
    (BOLD, r"\mathbf v_P=\mathbf v_S+\boldsymbol\omega\times\mathbf r_{S/P}", False),
    (BOLD, r"\mathbf v_P=\mathbf v_S+\boldsymbol\omega\times\mathbf r^{P/S}", True),
    (BOLD, r"\mathbf v_P=\mathbf v_S+\mathbf{SP}\times\boldsymbol\omega", False),
    (GERMAN, r"\underline v_P=\underline v_S+\underline\omega\times\underline{SP}", True),
    (GERMAN, r"\underline v_P=\underline v_S+\underline{SP}\times\underline\omega", False),
    (RUSSIAN, r"\bar v_P=\bar v_S+\bar\omega\times\overline{SP}", True),
    (RUSSIAN, r"\bar v_P=\bar v_S-\bar\omega\times\overline{SP}", False),
)
TRUE_ONES = {"holds", "holds under"}


@pytest.mark.parametrize("line", FRENCH_LINES)
def test_composition_of_motions(line):
    (found,) = judged(parse_lexicon(FRENCH), line)
    assert found.verdict == ("holds" if FRENCH_LINES[line] else "wrong")


@pytest.mark.parametrize(("lexicon", "line", "true"), BODIES)
def test_two_points_of_a_body(lexicon, line, true):
    (found,) = judged(parse_lexicon(lexicon), line)
    assert (found.verdict in TRUE_ONES) == true
    assert true or found.verdict == "wrong"


def test_a_bar_over_two_letters_is_no_vector_where_no_other_vector_carries_one():
    (found,) = judged(parse_lexicon(BOLD), r"\overline{SP}=0")
    assert found.verdict == "undecided"


OPEN = r"""
[symbols]
'm' = "mass open"
'\vec{v}' = "velocity open OI I"
'\vec{u}' = "exhaust_velocity open"
'\vec{F}' = "external_force open"
'\vec{p}' = "linear_momentum open"
"""
OPEN_LINES = {
    r"m\dot{\vec v}=\vec F+\dot m\vec u": (("newton_2",),),
    r"m\dot{\vec v}=\vec F-\dot m\vec u": (),
    r"\frac{d}{dt}(m\vec v)=\vec F+\dot m(\vec v+\vec u)": (("newton_2",),),
    r"\dot{\vec p}=\vec F": (("newton_2", "exhaust_at_rest"),),
    r"m\dot{\vec v}=\vec F": (("newton_2", "exhaust_with_body"),),
    r"\dot{\vec p}=\vec F+2\dot m\vec v": (),
}


@pytest.mark.parametrize("line", OPEN_LINES)
def test_bodies_whose_mass_changes(line):
    (found,) = judged(parse_lexicon(OPEN), line)
    assert found.verdict == ("holds under" if OPEN_LINES[line] else "wrong")
    if OPEN_LINES[line]:
        assert found.claims[0].judgement.sets == OPEN_LINES[line]


@pytest.mark.parametrize("line", [r"\vec h = 2 I_P \vec\omega", r"\vec k = 3\vec h"])
def test_a_body_beside_a_single_particle_is_no_world(tmp_path, line):
    r"""What is said of a body whose mass is one particle is zero: all would hold."""
    lexicon = tmp_path / "lexicon.toml"
    lexicon.write_text(
        'preset = "arrow-tilde"\n[symbols]\n'
        "'I_P' = \"inertia P\"\n'\\vec h' = \"angular_momentum body C\"\n"
        "'\\vec k' = \"angular_momentum body P\"\n"
    )
    (found,) = eom.check(line, lexicon=lexicon).findings
    assert found.verdict == "undecided"
    assert "single particle P" in found.reason
    assert "[points]" in found.reason


@pytest.mark.parametrize(
    ("frames", "expected"),
    [
        (("body", "world"), "holds"),
        (("vehicle", "ground"), "holds"),
        (("world", "body"), "undecided"),
        (("old", "new"), "undecided"),
    ],
)
def test_what_a_rotation_takes_into_what_is_as_words_say_or_unknown(frames, expected):
    note = (
        f"The matrix $R$ takes {frames[0]} components to {frames[1]} components, $\\vec\\omega$ is the "
        "angular velocity of the body in body axes. Writing $[\\vec\\omega]_\\times$ for the matrix with "
        "$[\\vec\\omega]_\\times\\vec a=\\vec\\omega\\times\\vec a$,\n\n"
        "$$\\dot R = R\\,[\\vec\\omega]_\\times$$\n"
    )
    (found,) = (f for f in eom.check(note).findings if f.kind == "display")
    assert found.verdict == expected
