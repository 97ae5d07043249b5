"""Relations between free scalars, integrals with limits, indices over axes, symbols that words bring in."""

import mpmath
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import eom
from eom.checker.judge.judge import judge, models_of
from eom.checker.judge.models import Search
from eom.checker.judge.notes import understand
from eom.checker.judge.scalars import RELATIONS
from eom.checker.judge.verdicts import judge_chain
from eom.checker.mean.integrals import Unknown, between
from eom.checker.mean.lexicon_files import preset
from eom.checker.mean.roles import running
from eom.checker.read.documents import read_document
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import split
from tests.eom.rows import every

X, A, K = sp.symbols("x a k", positive=True)
PARTS = st.sampled_from(
    [sp.sin(K * X), sp.cos(2 * X + A), sp.exp(-K * X), sp.sin(X) ** 2 * sp.cos(X), sp.Integer(1)]
)


def verdicts(note, **settings):
    return [f.verdict for f in eom.check(note, notation="physics-bold", **settings).findings]


@given(PARTS, st.integers(0, 4), st.fractions(-3, 3, max_denominator=7))
def test_integrals_are_those_of_quadrature(part, power, scale):
    integrand = (scale + 1) * X**power * part + scale * X
    found = between(integrand, X, sp.Integer(0), A)
    at = {A: sp.Rational(6, 5), K: sp.Rational(7, 10)}
    values = sp.lambdify(X, integrand.subs(at), "mpmath")
    with mpmath.workdps(30):
        wanted = mpmath.quad(values, [0, mpmath.mpf(6) / 5])
        assert mpmath.almosteq(mpmath.mpf(found.subs(at).evalf(30)), wanted, 1e-15, 1e-15)


def test_the_integral_of_a_reciprocal_is_a_logarithm():
    assert between(3 * K / X, X, A, 2 * A) == 3 * K * sp.log(2)


@pytest.mark.parametrize(
    ("integrand", "lower"),
    [(1 / X, 0), (1 / X**2, 0), (sp.sqrt(A**2 - X**2), 0), (sp.exp(X**2), 0)],
)
def test_what_has_no_rule_is_refused(integrand, lower):
    with pytest.raises(Unknown):
        between(integrand, X, sp.sympify(lower), 2 * A)


PLATE = r"A plate with edges $a$ and $b$ and density $\sigma$ has "
CASES = {
    PLATE + r"$$\int_0^a\int_0^b \sigma x^2\,dy\,dx = \frac{\sigma a^3 b}{3}$$": ["holds"],
    PLATE + r"$$\int_0^a\int_0^b \sigma x^2\,dy\,dx = \frac{\sigma a^2 b}{3}$$": ["wrong"],
    PLATE + r"$$\int_{-a/2}^{a/2} \sigma x^2\,dx = \frac{\sigma a^3}{6}$$": ["wrong"],
    PLATE + r"$$J_\mathrm{edge} = \sigma a^3 b/3$$ $$3 J_\mathrm{edge} = \sigma b a^3$$": [
        "definition",
        "holds under",
    ],
    PLATE + r"$$\int_0^{2\pi}\sin^2 u\,du = \pi$$": ["holds"],
    r"A rod of length $b$ and density $\rho$ has, where $\mu = 3\rho$, "
    r"$$\int_0^b \rho x^2 dx = \frac{\mu b^3}{9}$$": ["definition", "holds under"],
    # what the integrand may hide is left open
    r"With a force $F$ and a way $a$ $$\int_0^a F\,dx = \frac12 F a$$": ["undecided"],
    r"With $f$ and $a$ $$\int_0^a f(x)\,dx = \frac12 f a$$": ["undecided"],
    # a relation that is no identity, and one under another heading, are none of ours
    r"A fall from $h$ with $v$ and $g$: $$\frac12 v^2 = g h$$": ["undecided"],
    "# One\n\nMass $s$, edge $a$, density $\\sigma$: $$J_\\mathrm{e} = 2 s a^2$$\n\n"
    "# Two\n\n$$J_\\mathrm{e} = 3 s a^2$$": ["undecided", "undecided"],
}


@pytest.mark.parametrize(("note", "wanted"), every(3, CASES.items()))
def test_relations_between_free_scalars(note, wanted):
    assert verdicts(note) == wanted


def claims_of(note):
    found = understand(read_document(note), preset("physics-bold"))
    return [c for u in found for c in u.claims if c.parameters is not None]


def test_each_link_of_a_chain_is_judged_as_within_it():
    (claim,) = claims_of(
        r"With $a$ and $\sigma$ $$\sigma a^3 = a^3\sigma = \int_0^a \sigma x^2\,dx$$"
    )
    assert judge(claim).verdict == "wrong"
    assert [link.verdict for _, _, link in judge_chain(claim).links] == ["holds", "wrong"]


def test_free_scalars_are_models_as_others_are():
    """Relations of a note are what is assumed; numbers that keep them agree to what they give."""
    new, old = claims_of(
        PLATE
        + r"$$J_\mathrm{edge} = \sigma a^3$$ $$2 J_\mathrm{edge} = 2\sigma a^3 = 2 a^3\sigma$$"
    )
    models = models_of(old)
    free, kept = (next(models.draw(names)) for names in (frozenset(), RELATIONS))
    assert [free.agrees(pair) for pair in models.said] == [False, True]
    assert [kept.agrees(pair) for pair in models.said] == [True, True]
    assert (judge(new).verdict, judge(old).verdict) == ("definition", "holds under")
    assert judge(old).reason == "by relations that the note states above"
    search = Search(models)
    assert search.sets() == (RELATIONS,)
    assert list(search.seeds) == [frozenset()]


@pytest.mark.sparse(2)
@pytest.mark.parametrize(
    ("formula", "wanted"),
    [
        (r"I_z = \int_V \rho\,(x^2 + y^2)\, dV", "holds under"),
        (r"I_z = \int (x^2 + y^2)\, dm", "holds under"),
        (r"I_{12} = \int x y\, dm", "wrong"),
        (r"I_x + I_y + I_z = 3\int_V \rho\, r^2\, dV", "wrong"),
        (r"\boldsymbol\omega^T = (\omega_1, \omega_2, \omega_3)", "holds"),
        (r"\boldsymbol\omega^T = (\omega_1, \omega_3, \omega_2)", "wrong"),
        (r"L_i = I_i\omega_i, \quad i = 1, 2, 3", "holds under"),
        (r"L_i = 2 I_i\omega_i \text{ for } i = 1, \ldots, 3", "wrong"),
        (r"\omega_s = \boldsymbol\omega\cdot\hat{\mathbf{e}}_s \qquad s \in \{x, y, z\}", "holds"),
    ],
)
def test_elements_of_a_body_rows_and_indices_over_axes(formula, wanted):
    assert verdicts(f"$${formula}$$")[0] == wanted


def test_a_symbol_is_brought_in_by_let():
    lead = r"Let $\mathbf{d} = \mathbf{r}_i - \mathbf{r}_j$ and so "
    assert verdicts(lead + r"$$\dot{\mathbf d} = \mathbf v_i - \mathbf v_j$$")[1] == "holds"
    assert verdicts(lead + r"$$\dot{\mathbf d} = \mathbf v_i + \mathbf v_j$$")[1] == "wrong"
    condition = r"For $e = 0$ we have $$e = 1$$"
    assert "wrong" not in verdicts(condition)


def test_lists_of_other_lengths_are_no_axes():
    for formula, letter in [(r"a_r = b_r \quad (r = 1, 2, 3)", "r"), (r"a_r = b_r, r = 1, 2", "")]:
        assert running(split(read_formula(formula).tree, (), [])) == letter
