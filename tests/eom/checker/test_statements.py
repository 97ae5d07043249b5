"""Formulas as statements: links, continuations, conditions, definitions, tags."""

from eom.checker.read.documents import read_document
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import read, split
from tests.eom.checker.shape import shape


def chain(s):
    return " ".join([shape(s.members[0])] + [f"{x.sign.name} {shape(x.right)}" for x in s.links])


def statements(text):
    return split(read_formula(text).tree)


def chains(text):
    return [chain(s) for s in statements(text)]


def test_chains_have_links():
    (s,) = statements(r"T = a = b \le c")
    assert [(shape(x.left), x.sign.name, shape(x.right)) for x in s.links] == [
        ("T", "=", "a"),
        ("a", "=", "b"),
        ("b", "<=", "c"),
    ]


def test_quads_commas_rows_and_cases_part_statements():
    assert chains(r"a = b, \quad c = d \qquad e = f") == ["a = b", "c = d", "e = f"]
    assert chains(r"\begin{cases} a = b \\ c = d \end{cases}") == ["a = b", "c = d"]
    assert chains(r"a &= b \\ c &= d") == ["a = b", "c = d"]
    assert chains(r"\boxed{a = b} \quad \text{Valid about CM.}") == ["a = b"]


def test_arrows_are_kept():
    first, second = statements(r"p \triangleq m v \Rightarrow f = \dot p \quad (3.2)")
    assert first.links[0].defines
    assert not second.links[0].defines
    assert (first.joined, second.joined) == ("", "implies")
    assert second.tag == "3.2"


def test_rows_continue_what_is_above():
    first, second, third = statements(r"a &= b \\ &= c + d \\ &\quad + e \\ &= f")
    assert (chain(first), chain(second), chain(third)) == (
        "a = b",
        "b = [c + d + e]",
        "[c + d + e] = f",
    )
    assert [s.continues for s in (first, second, third)] == [False, True, True]


def test_a_sign_at_the_end_of_a_row_goes_on():
    first, second = statements(r"a = b = \\ c")
    assert (chain(first), chain(second)) == ("a = b", "b = c")


def test_a_display_continues_the_main_statement_of_the_one_before():
    text = r"$$T = a \quad v = w \times r$$ $$= b$$ $$p = q \Rightarrow r = s$$ $$= t$$"
    found = [f.statements for f in read(read_document(text))]
    assert chain(found[1][0]) == "a = b"
    assert [shape(n) for n in found[1][0].others] == ["[w x r]"]
    assert chain(found[3][0]) == "s = t"


def test_inline_formulas_do_not_continue_displays():
    text = "$$a = b$$ and $= c$"
    assert chain(read(read_document(text))[1].statements[0]) == "? = c"


def test_conditions():
    (s,) = statements(r"I = 0 \text{ if } M_2 = 0 \text{ and } \dot\Omega = 0")
    assert [(role, chain(c)) for role, c in s.conditions] == [
        ("if", "M{_2} = 0"),
        ("if", "dot(Omega) = 0"),
    ]
    (s,) = statements(r"\dot q_i = u_i, \quad \text{for } i = 1, 2, \ldots, n")
    assert [(role, chain(c)) for role, c in s.conditions] == [("for", "i = 1, 2, ..., n")]
    (s,) = statements(r"\text{If } \vec L = 0, \text{ then } \vec H = C")
    assert chain(s) == "vec(H) = C"
    assert [(role, chain(c)) for role, c in s.conditions] == [("if", "vec(L) = 0")]
    (s,) = statements(r"x^T J x > 0 \quad \forall x \neq 0")
    assert [(role, chain(c)) for role, c in s.conditions] == [("for", "x != 0")]


def test_lists_share_a_relation():
    assert chains(r"\lambda_1, \lambda_2 = \text{eigenvalues}") == [
        "lambda{_1}, lambda{_2} = 'eigenvalues'"
    ]
    assert chains(r"i = 1, 2, 3") == ["i = 1, 2, 3"]


def test_text_beside_a_statement_is_kept():
    (s,) = statements(r"\Omega = C \text{ (constant)}")
    assert s.words == ("(constant)",)
    (s,) = statements(r"\text{Momentum: } H = I \omega")
    assert s.words == ("Momentum:",)


def test_numbers_in_brackets_are_tags_only_at_the_end():
    (s,) = statements(r"a = b \quad (3.36a)")
    assert (chain(s), s.tag) == ("a = b", "3.36a")
    assert [s.tag for s in statements(r"a = b \quad (c + d)")] == ["", ""]
    text = r"\begin{align} a &= b \tag{1} \\ c &= d \tag{2} \end{align}"
    (formula,) = read(read_document(text))
    assert [s.tag for s in formula.statements] == ["1", "2"]


def test_expressions_claim_nothing():
    (s,) = statements(r"\vec r_O")
    assert not s.relational
    assert s.links == ()
