"""Terms in the notations of the lectures, by hand; precedence; every head and quantity."""

import random
import re
import shutil
import subprocess
from xml.etree import ElementTree

import pytest
import sympy as sp

from eom.errors import InputError
from eom.terms.terms import (
    COLUMN,
    DYADIC,
    HEADS,
    MATRIX,
    SCALAR,
    VECTOR,
    Equation,
    add,
    at,
    column,
    cross,
    der,
    dot,
    entries,
    expr,
    inner,
    integral,
    inverse,
    make,
    matmul,
    mul,
    number,
    outer,
    outer_column,
    partial,
    since,
    start,
    table,
    tilde,
    total,
    transpose,
    zero,
)
from eom.terms.vocabulary import QUANTITIES, definition, mass, omega, position, quantity, unit
from eom.typeset.blocks import Line
from eom.typeset.letters import ROLES
from eom.typeset.notation import (
    ALIASES,
    LETTERS,
    NOTATIONS,
    PLAIN,
    equation_parts,
    notation_named,
    write,
    write_equation,
)
from eom.typeset.pages import display_latex
from eom.typeset.writing import RULES

W = omega()
R_C = position("dm", "C")
A, B, C = (quantity("vector", n) for n in "abc")
S, T = (quantity("scalar", n) for n in "st")
J = quantity("inertia", "C")
J_O = quantity("inertia", "O")
H = quantity("angular_momentum", "body", "C")
TORQUE = quantity("torque", "body", "C")
J_B, W_B, TORQUE_B = (column(x, "B") for x in (J, W, TORQUE))
ALL = {**NOTATIONS, "plain": PLAIN}

EULER = Equation(add(dot(J, der(W, "B")), cross(W, dot(J, W))), TORQUE)
EULER_B = Equation(add(matmul(J_B, der(W_B)), matmul(tilde(W_B), matmul(J_B, W_B))), TORQUE_B)
ABOUT_O = [quantity(n, "system", "O") for n in ("torque", "angular_momentum", "first_moment")]
TORQUE_LAW = Equation(
    ABOUT_O[0], add(der(ABOUT_O[1]), cross(ABOUT_O[2], der(position("O"), times=2)))
)

GOLDEN = {
    "000 H_C": (
        "arrow",
        Equation(H, definition(H)),
        r"\vec{H}_{C} = \int_{B} \vec{r} \times \dot{\vec{r}} \, \mathrm{d}m",
    ),
    "000 position": (
        "arrow",
        Equation(position("dm"), add(position("C"), position("dm", "C"))),
        r"\vec{R} = \vec{R}_{C} + \vec{r}",
    ),
    "000 transport": (
        "arrow",
        Equation(der(R_C), add(der(R_C, "B"), cross(W, R_C))),
        r"\dot{\vec{r}} = \frac{{}^{B}\mathrm{d}}{\mathrm{d}t} \vec{r} + \vec{\omega} \times \vec{r}",
    ),
    "000 momentum": (
        "arrow",
        Equation(H, dot(J, W)),
        r"\vec{H}_{C} = \left[ I_{C} \right] \vec{\omega}",
    ),
    "000 energy": (
        "arrow",
        mul(
            number(1, 2),
            quantity("total_mass", "body"),
            dot(der(position("C")), der(position("C"))),
        ),
        r"\frac{1}{2} M \dot{\vec{R}}_{C} \cdot \dot{\vec{R}}_{C}",
    ),
    "000 tilde": ("arrow", tilde(W_B), r"\left[ \tilde{\vec{\omega}} \right]_{B}"),
    "001 Euler": (
        "superscript",
        Equation(der(H), EULER.left),
        (
            r"{}^{\mathcal{I}}\frac{\mathrm{d}}{\mathrm{d}t} {}^{\mathcal{I}}\mathbf{h}_{G} = "
            r"\mathbb{I}_{G} \cdot {}^{\mathcal{B}}\frac{\mathrm{d}}{\mathrm{d}t} "
            r"{}^{\mathcal{I}}\boldsymbol{\omega}^{\mathcal{B}} + "
            r"{}^{\mathcal{I}}\boldsymbol{\omega}^{\mathcal{B}} \times "
            r"\left( \mathbb{I}_{G} \cdot {}^{\mathcal{I}}\boldsymbol{\omega}^{\mathcal{B}} \right)"
        ),
    ),
    "001 in components": (
        "superscript",
        matmul(tilde(W_B), J_B),
        (
            r"\left[ {}^{\mathcal{I}}\boldsymbol{\omega}^{\mathcal{B}}\times \right]_{\mathcal{B}} "
            r"\left[ \mathbb{I}_{G} \right]_{\mathcal{B}}"
        ),
    ),
    "001 velocity": ("superscript", der(position("P", "O")), r"{}^{\mathcal{I}}\mathbf{v}_{P/O}"),
    "001 rotation": (
        "superscript",
        quantity("rotation", "B", "A"),
        r"{}^{\mathcal{B}}C^{\mathcal{A}}",
    ),
    "002 (3.15)": (
        "underline",
        TORQUE_LAW,
        (
            r"\underline{\tau}_{O} = \underline{h}_{O}^{\bullet} + "
            r"\underline{c}_{O} \times \underline{r}_{O}^{\bullet\bullet}"
        ),
    ),
    "002 (3.17)": (
        "underline",
        mul(number(2), cross(W, der(position("C"), "B"))),
        r"2 \underline{\omega} \times \underline{r}_{\bullet}^{\circ}",
    ),
    "002 (3.27)": (
        "underline",
        EULER_B,
        (
            r"\mathbf{I} \dot{\boldsymbol{\omega}} + "
            r"\boldsymbol{\omega}^{\times} \mathbf{I} \boldsymbol{\omega} = \boldsymbol{\tau}_{\bullet}"
        ),
    ),
    "002 (3.31)": (
        "underline",
        Equation(
            column(J_O, "B"),
            matmul(
                quantity("rotation", "B", "A"),
                matmul(column(J_O, "A"), quantity("rotation", "A", "B")),
            ),
        ),
        r"\mathbf{J}_{B} = \mathbf{C}_{BA} \mathbf{J}_{A} \mathbf{C}_{AB}",
    ),
    "002 (3.5)": (
        "underline",
        total(total(quantity("internal_force", "i", "j"), "j")),
        r"\sum_{i = 1}^{N} \sum_{j = 1}^{N} \underline{f}_{ij}",
    ),
    "002 (3.10)": (
        "underline",
        Equation(ABOUT_O[2], definition(ABOUT_O[2]), ":="),
        r"\underline{c}_{O} \triangleq \sum_{i = 1}^{N} m_{i} \underline{\rho}_{i}",
    ),
    "Kane": (
        "kane",
        Equation(W, mul(S, unit("I", 3))),
        r"{}^{N}\boldsymbol{\omega}^{B} = s \hat{\mathbf{n}}_{3}",
    ),
    "Kane's velocity": ("kane", der(position("C")), r"{}^{N}\mathbf{v}^{B^{*}}"),
    "Kane's position": ("kane", position("P", "O"), r"\mathbf{p}^{OP}"),
    "not negative": (
        "underline",
        Equation(dot(W, W), number(0), ">="),
        r"\underline{\omega} \cdot \underline{\omega} \ge 0",
    ),
}


@pytest.mark.parametrize("name", GOLDEN)
def test_the_lectures_notation(name):
    notation, statement, expected = GOLDEN[name]
    writer = write_equation if isinstance(statement, Equation) else write
    assert writer(statement, NOTATIONS[notation]) == expected


PRECEDENCE = {
    "a x (b x c)": cross(A, cross(B, C)),
    "(a x b) x c": cross(cross(A, B), C),
    "(a x b) . c": dot(cross(A, B), C),
    "a x b + c": add(cross(A, B), C),
    "a x (b + c)": cross(A, add(B, C)),
    "s (a + b)": mul(S, add(A, B)),
    "s (a . b) c": mul(S, dot(A, B), C),
    "(a . b) (b . c)": mul(dot(A, B), dot(B, C)),
    "(a . a)^2": mul(dot(A, A), dot(A, A)),
    "s^3 a": mul(S, S, S, A),
    "a . a": dot(A, A),
    "a - b": A - B,
    "-a": -A,
    "a - 2 b": add(A, mul(number(-2), B)),
    "a x (-b)": cross(A, -B),
    "1/2 s": mul(number(1, 2), S),
    "-1/2 s a": mul(number(-1, 2), S, A),
    "s - t": S - T,
    "(x + y) a": mul(expr(sp.Symbol("x") + sp.Symbol("y")), A),
    "a + x - y": None,
    "sum_i (f_i + a)": total(add(quantity("force", "i"), A)),
    "(sum_i f_i) x a": cross(total(quantity("force", "i")), A),
    "a x sum_i f_i": cross(A, total(quantity("force", "i"))),
    "sum_i m_i a + b": add(total(mul(mass("i"), A)), B),
    "integral_body a dm": integral(A),
    "integral_body (a + b) dm": integral(add(A, B)),
    "integral_body dm": integral(number(1)),
    "(integral_body a dm) . b": dot(integral(A), B),
    "a . integral_body b dm": dot(A, integral(B)),
    "sum_i (-f_i)": total(-quantity("force", "i")),
    "d_I(a + b)": der(add(A, B)),
    "d_I(d_B(a))": der(der(A, "B")),
    "(a b) . c": dot(outer(A, B), C),
    "[a + b]_B": column(add(A, B), "B"),
    "[a]_B^T": None,
    "[a]_B^T [b]_B": inner(column(A, "B"), column(B, "B")),
    "[a]_B [b]_B^T": outer_column(column(A, "B"), column(B, "B")),
    "skew([a]_B) [b]_B": matmul(tilde(column(A, "B")), column(B, "B")),
    "(C_BA + C_AB) [a]_A": matmul(
        add(quantity("rotation", "B", "A"), quantity("rotation", "A", "B")), column(A, "A")
    ),
    "C_BA^T": transpose(quantity("rotation", "B", "A")),
    "C_BA^(-1)": inverse(quantity("rotation", "B", "A")),
    "[[s], [t], [0]]": entries([[S], [T], [number(0)]]),
    "[[s, t], [0, s]]": table([[S, T], [number(0), S]]),
}


def test_precedence_in_plain_text():
    terms = {text: term for text, term in PRECEDENCE.items() if term is not None}
    assert [write(term, PLAIN) for term in terms.values()] == list(terms)


def test_symbols_of_sympy_join_a_sum():
    x, y = sp.symbols("x y")
    assert write(add(S, expr(x - y)), PLAIN) == "s + x - y"
    assert write(add(S, expr(-x / 2)), NOTATIONS["arrow"]) == r"s - \frac{x}{2}"


def test_a_long_product_breaks_within_its_sum():
    squares = sp.Add(*(x**2 for x in sp.symbols("x_1:30")))
    statement = Equation(S, expr(squares / sp.Symbol("m")))
    left, relation, right = equation_parts(statement, NOTATIONS["arrow"])
    written = display_latex([(Line(left[0], relation, right), "")])
    assert written.startswith("\\begin{aligned}\ns &= \\frac{1}{m} \\bigl( x_{1}^{2}")
    assert written.endswith("x_{9}^{2} \\bigr)\n\\end{aligned}")
    assert max(map(len, written.splitlines())) < 200


def test_derivatives_distinguish_columns_from_vectors():
    """d[h]_B/dt and [dh/dt]_B differ; no notation may write them alike."""
    for notation in ALL.values():
        kinds = {write(t, notation) for t in (der(column(H, "B")), column(der(H), "B"))}
        assert len(kinds) == 2


EXAMPLES = {
    "add": add(A, B),
    "mul": mul(S, A),
    "dot": dot(A, B),
    "cross": cross(A, B),
    "outer": outer(A, B),
    "der": der(A),
    "start": start(A),
    "since": since(A),
    "at": at(A, "end"),
    "partial": partial(S, T),
    "sum": total(quantity("force", "i")),
    "integral": integral(A),
    "column": W_B,
    "matmul": matmul(J_B, W_B),
    "transpose": transpose(J_B),
    "inverse": inverse(J_B),
    "tilde": tilde(W_B),
    "inner": inner(W_B, W_B),
    "outer_column": outer_column(W_B, W_B),
    "entries": entries(sp.eye(3)),
    "table": table([[S, number(0)], [T, S], [S, S], [S, T]]),
    "rows": make("rows", (W_B, W_B, TORQUE_B)),
    "expr": expr(sp.Symbol("x")),
    "zero": zero(VECTOR),
    "atom": A,
}


def atoms():
    """Every quantity, with labels that its words ask for."""
    labels = {"rotation": ("B", "A"), "unit": ("B", "2"), "angular_velocity": ("B", "A")}
    for name in QUANTITIES:
        for who in ("body", "system", "i", "P"):
            given = {"who": who, "point": "O", "index": "k", "letter": "v", "": "B"}
            roles = ROLES.get(name)
            chosen = [given[r] for r in roles] if roles is not None else labels.get(name)
            yield quantity(name, *((who, "O") if chosen is None else chosen))


def test_the_tables_cover_every_head_and_quantity():
    assert set(EXAMPLES) == set(RULES) == {*HEADS, "expr", "zero", "atom"}
    assert set(LETTERS) == set(QUANTITIES)
    assert set(ROLES) | {"position", "angular_velocity", "rotation", "unit"} == set(QUANTITIES)


@pytest.mark.parametrize("notation", ALL)
def test_every_head_and_quantity_is_written_in_every_markup(notation):
    kinds = [zero(k) for k in (VECTOR, DYADIC, COLUMN, MATRIX)]
    for term in [*EXAMPLES.values(), *atoms(), *kinds]:
        written = {m: write(term, ALL[notation], m) for m in ("latex", "text", "mathml", "ascii")}
        assert all(written.values())
        assert not re.search(r"[\\{}$]", written["text"])
        assert written["ascii"].isascii()
        ElementTree.fromstring(written["mathml"])


def test_names_and_aliases():
    assert all(notation_named(alias).name == name for alias, name in ALIASES.items())
    with pytest.raises(InputError, match="did you mean underline"):
        notation_named("underlined")


# -- random terms ------------------------------------------------------------------------------


def random_term(kind, depth, draw):
    """A random term of a kind; particles only under their sum."""

    def of(other):
        return random_term(other, depth - 1, draw)

    leaves = {
        SCALAR: [S, T, expr(-sp.Symbol("x") / 3), number(-2), mass("P")],
        VECTOR: [A, W, position("P", "O"), position("C"), H],
        DYADIC: [J, quantity("identity")],
        COLUMN: [W_B, TORQUE_B],
        MATRIX: [J_B, quantity("rotation", "B", "A")],
    }
    if depth == 0:
        return draw.choice(leaves[kind])
    rules = {
        SCALAR: [lambda: dot(of(VECTOR), of(VECTOR)), lambda: inner(of(COLUMN), of(COLUMN))],
        VECTOR: [
            lambda: cross(of(VECTOR), of(VECTOR)),
            lambda: dot(of(DYADIC), of(VECTOR)),
            lambda: der(of(VECTOR), draw.choice("IBA")),
        ],
        DYADIC: [lambda: outer(of(VECTOR), of(VECTOR)), lambda: dot(of(DYADIC), of(DYADIC))],
        COLUMN: [lambda: matmul(of(MATRIX), of(COLUMN)), lambda: column(of(VECTOR), "B")],
        MATRIX: [
            lambda: tilde(of(COLUMN)),
            lambda: transpose(of(MATRIX)),
            lambda: outer_column(of(COLUMN), of(COLUMN)),
            lambda: column(of(DYADIC), "A"),
        ],
    }[kind]
    common = [
        lambda: add(of(kind), of(kind)),
        lambda: mul(of(SCALAR), of(kind)),
        lambda: total(of(kind)),
        lambda: integral(of(kind)),
        lambda: der(of(kind)),
    ]
    return draw.choice([*rules, *rules, *common])()


def random_terms(count, depth):
    draw = random.Random(7)
    kinds = (SCALAR, VECTOR, DYADIC, COLUMN, MATRIX)
    return [random_term(draw.choice(kinds), depth, draw) for _ in range(count)]


def test_random_terms_differ_in_plain_text_unless_they_are_equal():
    """Plain text keeps every bracket that matters, up to associative juxtaposition."""
    seen = {}
    for term in random_terms(3000, 2):
        text = write(term, PLAIN)
        if any(m in text for m in ("^T", "]_B [", " s ", " t ", "C_BA", "J_C")):
            continue
        assert seen.setdefault(text, term) == term


@pytest.mark.parametrize("notation", ALL)
def test_random_terms_are_well_formed(notation):
    for term in random_terms(150, 4):
        ElementTree.fromstring(write(term, ALL[notation], "mathml"))
        latex = write(term, ALL[notation], "latex")
        assert latex.count("{") == latex.count("}")
        assert latex.count(r"\left") == latex.count(r"\right")
        assert not re.search(r"[\\{}$]", write(term, ALL[notation], "text"))


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no LaTeX here")
def test_random_terms_compile(tmp_path):
    formulas = [
        rf"\({write(t, n, 'latex')}\)\par" for n in ALL.values() for t in random_terms(60, 4)
    ]
    formulas += [rf"\({write(t, n, 'latex')}\)\par" for n in ALL.values() for t in atoms()]
    head = r"\documentclass{article}\usepackage{amsmath,amssymb}\begin{document}"
    (tmp_path / "terms.tex").write_text("\n".join([head, *formulas, r"\end{document}"]))
    done = subprocess.run(
        ["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "terms.tex"],
        cwd=tmp_path,
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-1500:].decode(errors="replace")


def test_the_partial_derivative_of_a_sum_stands_beside_it():
    chosen = notation_named("arrow")
    assert write(partial(S, T), chosen, "latex") == r"\frac{\partial s}{\partial t}"
    whole = write(partial(add(S, T), T), chosen, "latex")
    assert whole.startswith(r"\frac{\partial }{\partial t} \left( s + t")
