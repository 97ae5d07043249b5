# ruff: noqa: E501
"""Lines with vectors, columns and matrices: what follows by components, what would but for a slip."""

import pytest

from tests.eom.checker.consequence.test_lines import found, note, shown

ROLLS = (
    r"#A ball of mass $m$ and radius $a$ rolls on a table that turns with constant rate $\Omega$;"
    r" $\mathbf v = \dot{\mathbf r}$."
)
TURNTABLE = [
    ROLLS,
    r"\mathbf v - a\,\boldsymbol\omega\times\hat{\mathbf z} = \Omega\,\hat{\mathbf z}\times\mathbf r",
    r"m\dot{\mathbf v} = \mathbf F, \quad \kappa m a^2\,\dot{\boldsymbol\omega} = -a\,\hat{\mathbf z}\times\mathbf F",
    r"\dot{\mathbf v} - a\,\dot{\boldsymbol\omega}\times\hat{\mathbf z} = \Omega\,\hat{\mathbf z}\times\mathbf v",
    r"#With $(\hat{\mathbf z}\times\mathbf F)\times\hat{\mathbf z} = \mathbf F$ this is",
    r"a\,\dot{\boldsymbol\omega}\times\hat{\mathbf z} = -\frac{1}{\kappa m}\mathbf F = -\frac1\kappa\,\dot{\mathbf v}",
]
LAST = r"\dot{\mathbf v} = \frac{%s}{1+\kappa}\,\hat{\mathbf z}\times\mathbf v"


def test_a_ball_on_a_turntable():
    lines = found(*TURNTABLE, LAST % r"\kappa\Omega")
    assert {k: lines.get(k) for k in (3, 4, 5)} == {3: "under", 4: "under", 5: "under"}
    assert shown(note(*TURNTABLE, LAST % r"\Omega"))[5][0] in {"wrong", "unsure"}
    assert found(*TURNTABLE, LAST % r"2\kappa\Omega")[5] in {"wrong", "unsure"}


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        (r"\mathbf v\cdot\mathbf v = \omega^2 r^2", None),
        (r"\mathbf v\cdot\mathbf v = |\boldsymbol\omega|^2|\mathbf r|^2 - (\boldsymbol\omega\cdot\mathbf r)^2", "follows"),
        (r"|\mathbf v|^2 = |\boldsymbol\omega|^2|\mathbf r|^2 + (\boldsymbol\omega\cdot\mathbf r)^2", "unsure"),
        (r"\dot{\mathbf v} = \dot{\boldsymbol\omega}\times\mathbf r + \boldsymbol\omega\times\dot{\mathbf r}", "follows"),
        (r"\dot{\mathbf v} = \dot{\boldsymbol\omega}\times\mathbf r - \boldsymbol\omega\times\dot{\mathbf r}", "unsure"),
        (r"\mathbf v\cdot\mathbf r = 0", "follows"),
        (r"\boldsymbol\omega\times\mathbf v = \boldsymbol\omega(\boldsymbol\omega\cdot\mathbf r) - |\boldsymbol\omega|^2\mathbf r", "follows"),
        (r"\boldsymbol\omega\times\mathbf v = \boldsymbol\omega(\boldsymbol\omega\cdot\mathbf r) + |\boldsymbol\omega|^2\mathbf r", "unsure"),
    ],
)  # fmt: skip
def test_the_velocity_of_a_point_of_a_body(line, expected):
    assert found(r"\mathbf v = \boldsymbol\omega\times\mathbf r", line).get(2) == expected


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        (r"(\vec a\times\vec b)\cdot(\vec c\times\vec d) = (\vec a\cdot\vec c)(\vec b\cdot\vec d) - (\vec a\cdot\vec d)(\vec b\cdot\vec c)", "follows"),
        (r"\vec a\times(\vec b\times\vec c) = \vec b(\vec a\cdot\vec c) - \vec c(\vec a\cdot\vec b)", "follows"),
        (r"\vec a\times(\vec b\times\vec c) + \vec b\times(\vec c\times\vec a) + \vec c\times(\vec a\times\vec b) = \vec 0", "follows"),
    ],
)  # fmt: skip
def test_identities_follow_from_nothing(line, expected):
    assert found(line).get(1) == expected
    turned = line.replace(r"= (", "= -(").replace(r"= \vec b", r"= -\vec b")
    assert turned == line or found(turned).get(1) != "follows"


EULER = [
    r"#The tensor of inertia is $\mathbf J$.",
    r"\mathbf H = \mathbf J\boldsymbol\omega",
    r"\dot{\mathbf H} + \boldsymbol\omega\times\mathbf H = \mathbf M",
    r"\mathbf J\dot{\boldsymbol\omega} + \boldsymbol\omega\times(\mathbf J\boldsymbol\omega) = \mathbf M",
]


def test_momentum_in_axes_of_the_body():
    power = r"\frac{d}{dt}\left(\tfrac12\boldsymbol\omega\cdot\mathbf J\boldsymbol\omega\right) = "
    assert found(*EULER, power + r"\boldsymbol\omega\cdot\mathbf M")[4] in {"follows", "under"}
    assert found(*EULER)[3] in {"follows", "under"}
    wrong = EULER[-1].replace(r"} + \bold", r"} - \bold")
    assert found(*EULER[:-1], wrong).get(3) == "unsure"


def test_a_tensor_that_turns_does_not_stay():
    """With derivatives in space Euler's line is right, though no such follows by components that stay."""
    space = [*EULER[:2], r"\dot{\mathbf H} = \mathbf M"]
    assert found(*space, EULER[-1]).get(3) not in {"wrong", "unsure"}
    assert found(*EULER[:2], r"\dot{\mathbf H} = \mathbf J\dot{\boldsymbol\omega}").get(2) is None


def test_the_derivative_in_another_frame_is_a_letter_of_its_own():
    moved = r"\dot{\mathbf c} = \mathring{\mathbf c} + \boldsymbol\omega\times\mathbf c"
    said = [moved, r"\mathbf c\cdot\dot{\mathbf c} = \mathbf c\cdot\mathring{\mathbf c}"]
    assert found(*said)[2] in {"follows", "under"}
    assert found(*said[:1], r"\dot{\mathbf c} = \mathring{\mathbf c}").get(2) != "follows"


POLAR = [
    r"\dot{\mathbf e}_r = \dot\theta\,\mathbf e_\theta, \qquad \dot{\mathbf e}_\theta = -\dot\theta\,\mathbf e_r",
    r"\mathbf r = r\,\mathbf e_r",
    r"\dot{\mathbf r} = \dot r\,\mathbf e_r + r\dot\theta\,\mathbf e_\theta",
]


def test_polar_coordinates():
    last = r"\ddot{\mathbf r} = (\ddot r %s r\dot\theta^2)\,\mathbf e_r + (r\ddot\theta + 2\dot r\dot\theta)\,\mathbf e_\theta"
    lines = found(*POLAR, last % "-")
    assert lines[3] in {"follows", "under"}
    assert lines[4] in {"follows", "under"}
    assert found(*POLAR, last % "+").get(4) not in {"follows", "under"}


def test_two_by_two():
    lines = [
        r"M = \begin{pmatrix} a & b \\ b & c \end{pmatrix}, \qquad q = \begin{pmatrix} x \\ y \end{pmatrix}",
        r"T = \tfrac12\,\dot q^T M\,\dot q",
    ]
    right = r"T = \tfrac12 a\dot x^2 + b\dot x\dot y + \tfrac12 c\dot y^2"
    assert found(*lines, right)[3] in {"follows", "under"}
    assert found(*lines, right.replace("+ b", r"+ \tfrac12 b"))[3] == "unsure"
    assert found(*lines, r"\det M = ac - b^2")[3] in {"follows", "under"}
    assert found(*lines, r"\det M = ac + b^2")[3] == "unsure"


def test_rotation_matrices():
    said = r"#The rotation matrix is $\mathbf R$."
    turned = r"\boldsymbol\Omega = \dot{\mathbf R}\mathbf R^T"
    assert found(said, turned, r"\boldsymbol\Omega^T = -\boldsymbol\Omega")[2] == "follows"
    assert found(turned, r"\boldsymbol\Omega^T = -\boldsymbol\Omega").get(2) != "follows"
    assert found(said, r"\mathbf R^T\mathbf R\mathbf a = \mathbf a")[1] == "follows"
    assert found(r"\mathbf R^T\mathbf R\mathbf a = \mathbf a").get(1) is None


def test_skew_matrices():
    twice = r"[\mathbf a]_\times[\mathbf a]_\times\mathbf b = \mathbf a(\mathbf a\cdot\mathbf b) %s (\mathbf a\cdot\mathbf a)\mathbf b"
    assert found(twice % "-") == {1: "follows"}
    assert found(twice % "+").get(1) != "follows"


def test_unit_vectors_of_a_triad():
    assert found(r"\hat{\mathbf x}\times\hat{\mathbf y} = \hat{\mathbf z}") == {1: "follows"}
    r = r"\mathbf r = x\,\hat{\mathbf x} + y\,\hat{\mathbf y}"
    moment = r"\mathbf r\times\dot{\mathbf r} = (x\dot y %s y\dot x)\,\hat{\mathbf z}"
    assert found(r, moment % "-")[2] == "follows"
    assert found(r, moment % "+").get(2) == "unsure"


def test_points_in_brackets_are_no_factors():
    """The velocities of a point in two frames are two letters."""
    assert (
        found(
            r"\vec V(M/R_0) = \vec V(M/R_1) + \vec u", r"\vec V(M/R_1) = \vec V(M/R_0) - \vec u"
        ).get(2)
        == "follows"
    )
    assert found(r"\vec V(M/R_0) = \vec a", r"\vec V(M/R_1) R_1 = \vec a R_0").get(2) is None


def test_labels_on_the_left_tell_letters_apart():
    turned = r"\begin{pmatrix} \cos a & -\sin a \\ \sin a & \cos a \end{pmatrix}"
    lines = [rf"{{}}^{{0}}_{{1}}R = {turned}", rf"{{}}^{{0}}_{{2}}R = {turned.replace('a ', 'b ')}"]
    assert found(*lines, r"\det {}^{0}_{2}R = 1").get(3) in {"follows", "under"}
    assert found(*lines, r"{}^{0}_{2}R = {}^{0}_{1}R").get(3) not in {"follows", "under", "wrong"}


def test_a_function_of_two_things_is_two_matrices():
    lines = [r"\dot{\mathbf R} = \mathbf S(a)\mathbf R", r"\dot{\mathbf R} = \mathbf S(b)\mathbf R"]
    assert found(*lines) == {}
