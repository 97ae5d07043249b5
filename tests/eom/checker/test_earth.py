r"""Lines about a frame that turns with the Earth: latitude, local axes, sines of constant angles."""

import pytest

from eom.checker.mean.lexicon_files import parse_lexicon
from tests.eom.checker.system_lines import judged

EAST = r"""
assume = ["steady_turn", "first_turn"]
[symbols]
'\beta' = "turn_angle 1 31 B I"
'\chi' = "turn_angle 2 31 B I"
'\Omega' = '= \dot{\beta}'
'\lambda' = '= \frac{\pi}{2} - \chi'
'\vec{\Omega}' = "angular_velocity B I"
'a' = { is = "scalar a", unit = "m" }
'\vec{e}_<k>' = "unit B <k>"
"""
SOUTH = EAST.replace(" 31 ", " 32 ")
PLANE = r"""
[symbols]
'\alpha' = { is = "scalar alpha", unit = "rad" }
'g' = { is = "scalar g", unit = "m/s^2" }
'\vec{g}' = '= -g(\sin\alpha\,\vec{e}_1 + \cos\alpha\,\vec{e}_2)'
'\vec{e}_<k>' = "unit B <k>"
"""
LINES = (
    (EAST, r"\vec\Omega=\Omega(\cos\lambda\,\vec e_2+\sin\lambda\,\vec e_3)", "holds"),
    (EAST, r"\vec\Omega=\Omega(\sin\lambda\,\vec e_2+\cos\lambda\,\vec e_3)", "wrong"),
    (EAST, r"\dot\lambda=0", "holds"),
    (EAST, r"\dot{\vec\Omega}=0", "holds"),
    (EAST, r"\dot{\vec e}_1=\Omega\sin\lambda\,\vec e_2-\Omega\cos\lambda\,\vec e_3", "holds"),
    (EAST, r"\dot{\vec e}_1=\Omega\sin\lambda\,\vec e_2+\Omega\cos\lambda\,\vec e_3", "wrong"),
    (SOUTH, r"\vec\Omega=\Omega(\sin\lambda\,\vec e_3-\cos\lambda\,\vec e_1)", "holds"),
    (SOUTH, r"\vec\Omega=\Omega(\sin\lambda\,\vec e_3+\cos\lambda\,\vec e_1)", "wrong"),
    (PLANE, r"\vec g\cdot\vec g=g^2", "holds"),
    (PLANE, r"\vec g\cdot\vec e_1=-g\sin\alpha", "holds"),
    (PLANE, r"\vec g\cdot\vec e_1=-g\cos\alpha", "wrong"),
    (PLANE, r"\sin2\alpha=2\sin\alpha\cos\alpha", "holds"),
    (PLANE, r"\sin2\alpha=\sin\alpha\cos\alpha", "wrong"),
)


@pytest.mark.parametrize(("lexicon", "line", "verdict"), LINES)
def test_lines_at_a_place_of_the_earth(lexicon, line, verdict):
    (found,) = judged(parse_lexicon(lexicon), line)
    assert found.verdict == verdict
