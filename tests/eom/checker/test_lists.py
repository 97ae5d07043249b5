r"""Letters that formulas and words bring in: entries of columns, diagonals and sums, one turn, leads."""

from time import process_time

import pytest

from eom.checker.infer.attitude import single_turns
from eom.checker.infer.draft import propose
from eom.checker.infer.sayings import prose, said
from eom.checker.infer.systems import is_claimed, led
from eom.checker.note.checking import check
from eom.checker.read.documents import Text, document_of


def _document(text):
    return document_of(Text(text), "markdown")


def _symbols(text):
    return {d.latex: d.meaning for d in propose(_document(text)).drafts if d.table == "symbols"}


def _verdicts(text):
    return [f.verdict for f in check(text, kind="markdown").findings if f.kind == "display"]


RATES = r"""The frame $B$ is fixed in the body, $N$ is inertial. $\boldsymbol\omega$ is the angular velocity
of $B$ relative to $N$, with %s its components in $B$. The 3-2-1 Euler angles are $\psi$, $\theta$, $\phi$.

$$p = \dot\phi %s \dot\psi\sin\theta$$
"""


@pytest.mark.parametrize(
    "list_", [r"$\boldsymbol\omega=(p,q,r)^T$", r"$\boldsymbol\omega=[p\ q\ r]^T$"]
)
def test_letters_of_a_column_are_the_components(list_):
    text = RATES % (list_, "-")
    assert _symbols(text)["p"].endswith("in B component 1")
    assert _verdicts(text) == ["holds"]
    assert _verdicts(RATES % (list_, "+")) == ["wrong"]


def test_letters_beside_unit_vectors_are_components():
    text = r"""The body axes have the unit vectors $\mathbf i,\mathbf j,\mathbf k$; $\boldsymbol\omega$ is
the angular velocity of the body.

$$\boldsymbol\omega = p\,\mathbf i+q\,\mathbf j+r\,\mathbf k$$
"""
    found = _symbols(text)
    assert found["p"] == r"= \boldsymbol{\omega} \cdot \mathbf{i}"
    assert found[r"\mathbf{k}"] == "unit B 3"


EULER = r"""With $\mathbf J=\operatorname{diag}(A,B,C)$, the inertia matrix about the mass centre,
and the angular velocity $\boldsymbol\omega$ of the body, no torque acts about the mass centre:

$$A\dot\omega_1 = (%s)\,\omega_2\omega_3$$
"""


def test_letters_of_a_diagonal_are_moments_of_inertia():
    found = _symbols(EULER % "B-C")
    assert found["A"].startswith("inertia C")
    assert found["A"].endswith("component 1 1")
    assert found["C"].endswith("component 3 3")


TURNS = r"""$R$ is the matrix that takes the components of a vector in the body frame to its components in
the inertial frame. It is a turn about some unit vector $\mathbf n$ through some angle $\alpha$:

$$R=\cos\alpha\,1+(1-\cos\alpha)\,\mathbf n\mathbf n^T%s\sin\alpha\,[\mathbf n]_\times$$

$$\operatorname{tr}R=1+2\cos\alpha$$

$$R^TR=1$$
"""


def test_one_turn_in_words_has_an_axis_and_an_angle():
    assert _verdicts(TURNS % "+") == ["holds", "holds", "holds"]
    assert _verdicts(TURNS % "-")[0] != "holds"


def test_a_turn_about_an_axis_of_a_frame_is_none_about_a_letter():
    text = r"A rotation about the third axis $\mathbf e_3$ through the angle $\alpha$ follows."
    assert not list(single_turns(prose(_document(text))))


@pytest.mark.parametrize(("sign", "name"), [("-", "active_turn"), ("", "turn")])
def test_tables_of_elementary_rotations_say_what_they_turn(sign, name):
    other = "" if sign else "-"
    text = rf"""The elementary matrices are

$$R_3(\psi)=\begin{{pmatrix}}\cos\psi&{sign}\sin\psi&0\\{other}\sin\psi&\cos\psi&0\\0&0&1\end{{pmatrix}}$$

$$R_1(\phi)=\begin{{pmatrix}}1&0&0\\0&\cos\phi&{sign}\sin\phi\\0&{other}\sin\phi&\cos\phi\end{{pmatrix}}$$
"""
    assert _symbols(text)["R_{<k>}"] == f"{name} <k>"


PRODUCT = r"""$I_x,I_y,I_z$ are the moments of inertia about the body axes $x,y,z$ at the mass centre, and

$$I_{xz}:=%s\int xz\,dm$$
"""


def test_the_sign_of_a_product_of_inertia_is_that_of_its_definition():
    assert _verdicts(PRODUCT % "")[0] in {"definition", "holds", "holds under"}
    assert _verdicts(PRODUCT % "-")[0] != "wrong"


def test_leads_say_what_stands_alone_on_the_left():
    text = "For the total kinetic energy we find\n\n$$T=\\frac12mv^2$$\n\nand so\n\n$$V=mgh$$\n"
    found = list(led(_document(text)))
    assert [(s.look.name, s.words.startswith("For the total")) for s in found] == [
        ("T", True),
        ("V", False),
    ]


def test_what_words_claim_is_no_definition():
    assert is_claimed("The frequency of small librations is")
    assert not is_claimed("with the abbreviation")
    assert not is_claimed("We introduce the frequency")


PARTICLES = r"""A system of particles of masses $m_a$ at $\vec r_a$, measured from the fixed point $O$.
$M$ is the total mass and $\vec r_C$ the position of the centre of mass $C$ from $O$.

$$M=\sum_a m_a$$
"""


def test_particles_are_counted_by_any_letter():
    assert _symbols(PARTICLES)["m_{<i>}"] == "mass <i>"
    assert _verdicts(PARTICLES) != ["wrong"]


def test_another_one_is_what_the_first_is():
    text = r"Let $O$ be a point of the body, $P$ another one, and $\mathbf r$ the vector from $O$ to $P$."
    found = [(m.look.name, s.words) for s in said(prose(_document(text))) for m in s.of]
    assert ("P", "another point of the body") in found


SYSTEM = r"""A cart of mass $M$ can slide without friction on a horizontal rail. A uniform rod (mass $m$,
length $\ell$) hangs from a pin on the cart. $x$ is the displacement of the cart, $\theta$ the angle of the
rod from the vertical.

$$T=\frac12(M+m)\dot x^2+\frac12m\ell\dot x\dot\theta\cos\theta+\frac16m\ell^2\dot\theta^2$$

$$V=-\frac12mg\ell\cos\theta$$

%s
"""


def test_a_remark_that_is_not_understood_leaves_the_system():
    remark = "This goes, for a very heavy cart, to the ordinary swinging rod."
    (one,) = propose(_document(SYSTEM % remark)).systems
    assert one.until > 0
    assert _verdicts(SYSTEM % remark) == ["holds", "holds"]


def test_long_sentences_are_read_in_time():
    text = "The body moves with $v$, the speed, and $m$ the mass of it and we see that " * 400
    document = prose(_document(text))
    begun = process_time()
    assert list(said(document))
    assert process_time() - begun < 5
