"""Derivations on paper: every format and notation, chains, assumptions, results."""

import re
import shutil
import subprocess
from xml.etree import ElementTree

import pytest
import sympy as sp

from eom import derivations
from eom.derivations.derivation import Derivation
from eom.derivations.forms import show_derivation
from eom.derivations.showing import FORMATS, chains
from eom.errors import InputError
from eom.mechanics.rigidbody import free_rigid_body
from eom.terms.rules import transport
from eom.terms.terms import Equation, cross, der, dot, entries, mul, number
from eom.terms.vocabulary import mass, omega, position, quantity
from eom.typeset.notation import NOTATIONS
from tests.eom.rows import DERIVED

KINDS = [n for n in derivations.names() if not n.startswith("inertia-of-")]
EVERY = pytest.param((*KINDS, "inertia-of-torus"), marks=pytest.mark.slow)
"""Every kind of derivation; of the solids, one with long integrals."""
V = quantity("vector", "v")
M = sp.Symbol("mass_1", positive=True)


def made():
    """A small derivation with all that can be shown."""
    d = Derivation("small", "A small <derivation> & more", "Tests")
    d.name_scalar(M, mass("P"), "mass of 100% steel")
    d.define(quantity("linear_momentum", "P"), "linear momentum", label="p", states=["002:E2"])
    d.start(der(V)).then("as seen from B", transport("B"), label="seen")
    d.only("one_particle", "newton_2", "constant_mass")
    d.law(
        Equation(quantity("force", "P"), mul(mass("P"), der(position("P", "OI"), times=2))),
        "Newton",
    )
    d.only("constant_mass")
    d.state(Equation(cross(V, V), mul(number(0), V)), "omega x omega, a vector with itself")
    return d.finish(
        system=free_rigid_body(),
        J=sp.diag(1, 2, M),
        energy=M / 2,
        spin_axis=3,
        law=Equation(omega(), omega()),
        roots=(M, M**2),
        parts={"first": dot(V, V)},
    )


@pytest.fixture(scope="module")
def small():
    return made()


def test_text_of_a_small_derivation(small):
    shown = show_derivation(small, "text", "underline")
    for words in (
        "A small <derivation> & more\n",
        "mass₁ := m  mass of 100% steel",
        "p̲ := m r̲^•",
        "linear momentum of the point mass",
        "002:E2; definition",
        "v̲^• = v̲^∘ + ω̲ × v̲",
        "by transport theorem",
        "Newton's second law holds",
        "Assumed: (A1) there is one point mass, P; (A2)",
        "[law; under A1, A2; held in 3 random worlds]",
        "ω̲ × ω̲, a vector",
        "rate of change of the vector as seen from frame B",
        "spin axis: 3",
        "energy = mass₁/2",
        "roots 1 = mass₁",
        "parts: first = v̲ · v̲",
        "J = [[1, 0, 0], [0, 2, 0], [0, 0, mass₁]]",
        "Equations of motion",
    ):
        assert words in shown, words
    assert not re.search(r"[\\{}$]", shown)


def test_markdown_has_displays_and_balanced_dollars(small):
    shown = show_derivation(small, "markdown", "superscript")
    assert shown.startswith("# A small <derivation> & more\n")
    assert shown.count("$") % 2 == 0
    assert r"$${}^{\mathcal{B}}" not in shown
    assert r"\frac{\mathrm{d}}{\mathrm{d}t} \mathbf{v} = " in shown.replace("&=", "=")
    assert small._repr_markdown_() == show_derivation(small, "markdown")


def test_html_is_one_escaped_page_without_scripts(small):
    shown = show_derivation(small, "html", "kane")
    ElementTree.fromstring(shown.split("\n", 1)[1])
    assert "<title>A small &lt;derivation&gt; &amp; more</title>" in shown
    assert "<script" not in shown
    assert "http" not in shown
    assert "prefers-color-scheme: dark" in shown


def test_statements_alone_are_the_ends_of_chains():
    derivation = derivations.derive("particle-system")
    shown = show_derivation(derivation, "text", "underline", steps=False)
    assert "τ̲_O = h̲_O^• + c̲_O × r̲_O^••" in " ".join(shown.split())
    assert "random worlds" not in shown
    assert "Derivation" not in shown.splitlines()


def test_chains_share_a_left_side():
    steps = derivations.derive("particle-system").steps
    groups = chains(steps)
    assert [s for group in groups for s in group] == list(steps)
    assert any(len(group) > 2 for group in groups)
    for group in groups:
        assert len({s.statement.left for s in group}) == 1


def test_a_chain_is_aligned():
    shown = show_derivation(derivations.derive("particle-system"), "latex", "underline")
    chain = re.search(
        r"\\begin\{align\*\}\n\\underline\{H\}_\{O\}.*?\\end\{align\*\}", shown, re.DOTALL
    )
    assert chain is not None
    assert chain[0].count("&") == 4
    assert chain[0].count(r"\intertext") == 3


def test_a_wide_matrix_is_stated_entry_by_entry():
    wide = sp.Matrix(3, 3, [sp.Add(*sp.symbols("x1:25")), *[0] * 7, sp.Symbol("z")])
    d = Derivation("wide", "Wide", "Tests")
    d.state(Equation(entries(2 * wide), mul(number(2), entries(wide))), "twice the same")
    shown = show_derivation(d.finish(J=wide), "text")
    assert "(J)₁₁ = x₁ + x₁₀" in shown
    assert "(J)₃₃ = z" in shown
    assert "(J)₁₂" not in shown


def test_same_bytes_twice():
    first, second = (show_derivation(made(), "html", "arrow") for _ in range(2))
    assert first == second


def test_unknown_choices_are_refused(small):
    with pytest.raises(InputError, match="did you mean latex"):
        show_derivation(small, "latx")
    with pytest.raises(InputError, match="did you mean kane"):
        show_derivation(small, "text", "cane")


@pytest.fixture(scope="module", params=[DERIVED, EVERY], ids=["some", "every kind"])
def some(request):
    return [derivations.derive(n) for n in request.param]


@pytest.mark.sparse(2)
@pytest.mark.parametrize("notation", NOTATIONS)
def test_every_derivation_in_every_format(some, notation):
    for derivation in some:
        shown = {style: show_derivation(derivation, style, notation) for style in FORMATS}
        assert not re.search(r"[\\{}$]", shown["text"])
        ElementTree.fromstring(shown["html"].split("\n", 1)[1])
        for state in {s for step in derivation.steps for s in step.states}:
            assert all(state in text for text in shown.values())


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no LaTeX here")
def test_every_derivation_compiles(some, small, tmp_path):
    pages = [show_derivation(d, "latex", n) for n in NOTATIONS for d in (*some, small)]
    bodies = [p.split(r"\begin{document}")[1].split(r"\end{document}")[0] for p in pages]
    head = pages[0].split(r"\begin{document}")[0]
    document = "\n".join([head, r"\begin{document}", *bodies, r"\end{document}"])
    (tmp_path / "all.tex").write_text(document, encoding="utf-8")
    done = subprocess.run(
        ["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "all.tex"],
        cwd=tmp_path,
        capture_output=True,
        check=False,
    )
    log = (tmp_path / "all.log").read_text(errors="replace")
    assert done.returncode == 0, log[-1500:]
    too_wide = [float(w) for w in re.findall(r"Overfull \\hbox \(([\d.]+)pt", log)]
    assert [w for w in too_wide if w > 20] == []
