r"""Laws of a lexicon: equations that tie scalars, coordinates and vectors of a note together."""

import json

import pytest

from eom.checker.mean.lexicon_files import parse_lexicon
from eom.errors import InputError
from tests.eom.checker.system_lines import judged


def symbols(kind: str, *rows: str) -> str:
    """Lines of a lexicon for quantities of a kind: letter, name and unit of each."""
    parted = (row.split() for row in rows)
    return "".join(
        f'{json.dumps(letter)} = {{ is = "{kind} {name}", unit = "{unit}" }}\n'
        for letter, name, unit in parted
    )


IMPACT = (
    r"""
laws = ["m u + M U = m u' + M U'", "u' - U' = -k (u - U)"]
[symbols]
'k' = "scalar k"
'\Delta T' = "= \\frac12 m (u^2 - u'^2) + \\frac12 M (U^2 - U'^2)"
"""
    + symbols(
        "scalar", "m m kg", "M M kg", "u u m/s", "U U m/s", "u' u_after m/s", "U' U_after m/s"
    )
    + symbols("scalar", "p p N*s")
)
ROLLING = (
    r"""
laws = ['x = R\varphi + c', 'z = \ell\cos\varphi']
[symbols]
"""
    + symbols("coordinate", "x x m", "z z m", r"\varphi phi rad")
    + symbols("scalar", "R R m", r"\ell l m", "c c m")
)
VECTORS = r"""
laws = ['\vec v = \vec\omega\times\vec r', '\vec r = a\,\vec n']
[symbols]
'\vec v' = { is = "vector v", unit = "m/s" }
'\vec r' = { is = "vector r", unit = "m" }
'\vec\omega' = "angular_velocity B I"
'\vec n' = "unit B 1"
'a' = { is = "scalar a", unit = "m" }
"""
LINES = (
    (IMPACT, r"u'=\frac{m-kM}{m+M}u+\frac{(1+k)M}{m+M}U", "holds"),
    (IMPACT, r"u'=\frac{m-kM}{m+M}u+\frac{(1-k)M}{m+M}U", "wrong"),
    (IMPACT, r"m(u'-u)=-M(U'-U)", "holds"),
    (IMPACT, r"m(u'-u)=M(U'-U)", "wrong"),
    (IMPACT, r"\Delta T=\frac{1-k^2}{2}\frac{mM}{m+M}(u-U)^2", "holds"),
    (IMPACT, r"\Delta T=\frac{(1-k)^2}{2}\frac{mM}{m+M}(u-U)^2", "wrong"),
    (IMPACT, r"p=m(u'-u)", "definition"),
    (ROLLING, r"\dot x=R\dot\varphi", "holds"),
    (ROLLING, r"\dot x=-R\dot\varphi", "wrong"),
    (ROLLING, r"\ddot z=-\ell\ddot\varphi\sin\varphi-\ell\dot\varphi^2\cos\varphi", "holds"),
    (ROLLING, r"\ddot z=-\ell\ddot\varphi\sin\varphi+\ell\dot\varphi^2\cos\varphi", "wrong"),
    (VECTORS, r"\vec v\cdot\vec r=0", "holds"),
    (
        VECTORS,
        r"\vec\omega\times\vec v=(\vec\omega\cdot\vec r)\vec\omega-\omega^2\vec r",
        "undecided",
    ),
    (
        VECTORS,
        r"\vec\omega\times\vec v=a(\vec\omega\cdot\vec n)\vec\omega-\vec\omega^2\vec r",
        "holds",
    ),
    (
        VECTORS,
        r"\vec\omega\times\vec v=a(\vec\omega\cdot\vec n)\vec\omega+\vec\omega^2\vec r",
        "wrong",
    ),
)


@pytest.mark.parametrize(("lexicon", "line", "verdict"), LINES)
def test_lines_are_judged_by_the_laws(lexicon, line, verdict):
    (found,) = judged(parse_lexicon(lexicon), line)
    assert found.verdict == verdict


@pytest.mark.parametrize("law", ["a + b", 3, "a = "])
def test_what_is_no_equation_is_refused(law):
    text = f"laws = [{law!r}]\n[symbols]\n'a' = 'scalar a'\n'b' = 'scalar b'\n"
    with pytest.raises(InputError):
        parse_lexicon(text)


@pytest.mark.parametrize("law", ["a = c", "a^2 = b^2", r"a = \vec b"])
def test_laws_that_cannot_be_used_are_told(law):
    text = (
        f"laws = ['{law}']\n[symbols]\n'a' = 'scalar a'\n'b' = 'scalar b'\n'\\vec b' = 'vector b'\n"
    )
    with pytest.raises(InputError, match="law"):
        judged(parse_lexicon(text), "a = b")
