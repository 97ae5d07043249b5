r"""Index notation: sums over what stands twice, Kronecker's and Levi-Civita's symbols, tensors."""

import pytest

from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.note.checking import check
from tests.eom.checker.system_lines import judged

LEXICON = r"""
[symbols]
'x_{<k>}' = "position dm C in B component <k>"
'\omega_{<k>}' = "angular_velocity B I in B component <k>"
'L_{<k>}' = "angular_momentum body C in B component <k>"
'N_{<k>}' = "torque body C in B component <k>"
'I_{<k><l>}' = "inertia C in B component <k> <l>"
'T' = "rotational_energy body C"
'a_{<k>}' = "vector a in B component <k>"
'b_{<k>}' = "vector b in B component <k>"
'\mathbf{a}' = "vector a"
'\mathbf{b}' = "vector b"
"""
LINES = {
    r"I_{ij}=\int(x_kx_k\delta_{ij}-x_ix_j)\,dm": True,
    r"I_{ij}=\int(x_kx_k\delta_{ij}+x_ix_j)\,dm": False,
    r"I_{ij}=\int(\delta_{ij}x_lx_l-x_ix_j)\,dm": True,
    r"L_i=I_{ij}\omega_j": True,
    r"L_m=-I_{mn}\omega_n": False,
    r"T=\tfrac12I_{ij}\omega_i\omega_j": True,
    r"T=I_{ij}\omega_i\omega_j": False,
    r"\dot L_i+\epsilon_{ijk}\omega_jL_k=N_i": True,
    r"\dot L_i-\varepsilon_{ijk}\omega_jL_k=N_i": False,
    r"I_{ij}\dot\omega_j+\epsilon_{ijk}\omega_jI_{kl}\omega_l=N_i": True,
    r"I_{ij}\dot\omega_j+\epsilon_{ijk}\omega_kI_{jl}\omega_l=N_i": False,
    r"\epsilon_{ijk}\epsilon_{ilm}=\delta_{jl}\delta_{km}-\delta_{jm}\delta_{kl}": True,
    r"\epsilon_{ijk}\epsilon_{ilm}=\delta_{jm}\delta_{kl}-\delta_{jl}\delta_{km}": False,
    r"a_i(b_kb_k\delta_{ij}-b_ib_j)=a_jb_kb_k-a_ib_ib_j": True,
    r"a_i(b_kb_k\delta_{ij}-b_ib_j)=a_jb_kb_k-3a_ib_ib_j": False,
    r"L_i=\int(x_kx_k\omega_i-x_ix_j\omega_j)\,dm": True,
    r"L_i=\int(x_kx_k\omega_i+x_ix_j\omega_j)\,dm": False,
    r"\epsilon_{ijk}\epsilon_{ijl}=2\delta_{kl}": True,
    r"\epsilon_{ijk}\epsilon_{ijl}=\delta_{kl}": False,
    r"\delta_{ii}=3": True,
    r"\mathbf a\cdot\mathbf b=a_ib_i": True,
    r"I_{kk}=2\int x_ix_i\,dm": True,
    r"I_{kk}=3\int x_ix_i\,dm": False,
    r"a_ib_j\delta_{ij}=a_kb_k": True,
}


@pytest.mark.sparse(12)
@pytest.mark.parametrize("line", LINES)
def test_index_notation(line):
    (found,) = judged(parse_lexicon(LEXICON), line)
    assert {"wrong": False, "undecided": None}.get(found.verdict, True) is LINES[line]


def test_labels_of_particles_stay_such():
    lexicon = parse_lexicon(
        """
        preset = "arrow-tilde"
        [symbols]
        'm_{<i>}' = "mass <i>"
        '\\vec{r}_{<i>}' = "position <i> OI"
        '\\vec{F}_{<i>}' = "force <i>"
        """
    )
    lines = [r"m_i\vec r_i = \vec r_im_i", r"\sum_i m_i\vec r_i = \sum_j m_j\vec r_j"]
    assert [f.verdict for f in judged(lexicon, *lines)] == ["holds", "holds"]


TENSORS = {
    r"S_{ij}:=\int x_ix_j\,dm": "definition",
    r"I_{ij}=S_{kk}\delta_{ij}-S_{ij}": "holds",
    r"S_{ij}=\tfrac12I_{kk}\delta_{ij}-I_{ij}": "holds",
    r"S_{ij}=I_{kk}\delta_{ij}-I_{ij}": "wrong",
    r"W_{ij}:=-\epsilon_{ijk}\omega_k": "definition",
    r"\omega_k=-\tfrac12\epsilon_{ijk}W_{ij}": "holds",
    r"(W_{ij})=\begin{pmatrix}0&-\omega_3&\omega_2\\ \omega_3&0&-\omega_1\\"
    r"-\omega_2&\omega_1&0\end{pmatrix}": "holds",
    r"W_{ij}=\begin{bmatrix}0&\omega_3&-\omega_2\\-\omega_3&0&\omega_1\\"
    r"\omega_2&-\omega_1&0\end{bmatrix}": "wrong",
    r"(\omega_i)=(\omega_1,\omega_2,\omega_3)^T": "holds",
    r"\operatorname{tr}(I_{ij})=2S_{kk}": "holds",
}
"""Lines of one note, in which tensors are defined index by index."""


def test_tensors_that_the_note_defines():
    found = judged(parse_lexicon(LEXICON), *TENSORS)
    assert [f.verdict for f in found] == list(TENSORS.values())


REPAIRS = {
    r"L_i=-I_{ij}\omega_j": r"L_i=I_{ij}\omega_j",
    r"\dot L_i+\epsilon_{ijk}\omega_kL_j=N_i": r"\dot L_i-\epsilon_{ijk}\omega_kL_j=N_i",
    r"I_{ij}=\int(x_kx_k\delta_{ij}-2x_ix_j)\,dm": r"I_{ij}=\int(x_kx_k\delta_{ij}-x_{i}x_{j})\,dm",
}


@pytest.mark.parametrize("line", REPAIRS)
def test_what_holds_for_all_indices_is_offered(line, tmp_path):
    (tmp_path / "lexicon.toml").write_text(LEXICON)
    report = check(f"$${line}$$", lexicon=tmp_path / "lexicon.toml")
    (finding,) = report.findings
    offered = [c.latex.replace(" ", "") for c in finding.explanation.corrections]
    assert REPAIRS[line].replace(" ", "") in offered
