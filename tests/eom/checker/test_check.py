"""Notes in, reports out: `eom.check`."""

import json
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

import eom
from eom.checker.infer.draft import meanings, propose
from eom.checker.mean.roles import roles
from eom.checker.note import checking
from eom.checker.note.checking import check_note
from eom.checker.read.documents import Text, is_file, looks_like, note_of, notes_of, read_document
from eom.checker.read.spans import NOWHERE
from eom.checker.report.findings import FAULTS, ORDER, UNEXPLAINED, UNSURE, Explanation, Settings
from eom.errors import InputError
from eom.limits import Overdue, check, deadline
from tests.clock import growth_in_calls
from tests.draws import examples
from tests.eom.rows import but, only

NOTE = r"""# Momentum

The momentum $\vec H_C = I_C\vec\omega$ of a body; $\vec\omega$ alone claims nothing.

$$\frac{d\vec H_C}{dt} = \vec L_C$$

$$\vec H_C =
  I_C\vec\omega + \vec\omega$$

$$\vec H_C = I_C\vec\omega = -I_C\vec\omega$$

\input{secret}
"""
ARROWS = {"notation": "arrow-tilde"}


def one(formula, **options):
    (finding,) = eom.check(formula, **(options or ARROWS)).findings
    return finding


def test_a_note_is_reported_formula_by_formula():
    report = eom.check(NOTE, **ARROWS)
    reported = [(f.kind, f.number, f.line, f.verdict) for f in report.findings]
    assert reported == [
        ("inline", 1, 3, "holds under"),
        ("display", 1, 5, "holds under"),
        ("display", 2, 7, "wrong"),
        ("display", 3, 10, "wrong"),
    ]
    assert report.counts == {"wrong": 2, "holds under": 2}
    assert [f.line for f in report.faults] == [7, 10]
    assert (report.lexicon, report.given) == ("preset arrow-tilde", ("constant_mass",))
    assert [(n.kind, n.line) for n in report.notices] == [("not read", 12)]


def test_places_are_those_of_what_is_at_fault():
    report = eom.check(NOTE, **ARROWS)
    by_dimension, by_chain = report.faults
    assert NOTE[slice(*by_dimension.place)].strip() == r"\vec\omega"
    assert "dimensions" in by_dimension.reason
    assert NOTE[slice(*by_chain.place)].strip() == r"-I_C\vec\omega"
    ill = one(r"\vec H_C = m")
    assert (ill.verdict, ill.source.text[slice(*ill.place)]) == ("ill-formed", "m")
    unread = one(r"\vec r \times = 3")
    assert (unread.verdict, unread.source.text[slice(*unread.place)]) == ("undecided", "=")
    assert unread.reason.startswith("not read: ")
    assert "\n" not in unread.reason
    assert one(r"\vec H_C = \vec q").reason.startswith("symbol without a meaning; got")


EULER = r"I_1\dot\omega_1 = (I_2 - I_3)\omega_2\omega_3 + T_1"


def test_a_formula_of_kane_with_its_smallest_assumptions():
    found = one(EULER, notation="kane")
    assert found.sets == (("newton_2", "third_law_strong", "principal_axes"),)
    assert found.place == NOWHERE
    assert one(EULER.replace("I_2 - I_3", "I_3 - I_2"), notation="kane").verdict == "wrong"


def test_what_is_given_need_not_be_found():
    wanted = ("newton_2", "third_law_strong", "principal_axes")
    found = one(EULER, notation="kane", given=wanted)
    assert (found.verdict, found.sets) == ("holds", ())
    changing = r"\frac{d}{dt}(M \vec{R}_C) = M \dot{\vec R}_C"
    assert one(changing).verdict == "holds"
    assert one(changing, notation="arrow-tilde", given=()).sets == (("constant_mass",),)
    with pytest.raises(InputError, match="unknown assumption 'rigit'"):
        eom.check(EULER, notation="kane", given=["rigit"])


def test_several_claims_need_all_their_assumptions():
    both = r"\vec H_C = I_C\vec\omega, \quad \dot{\vec H}_C = \vec L_C"
    sets = one(both).sets
    single = [one(part).sets for part in both.split(r", \quad")]
    assert [frozenset(s) for s in sets] == [frozenset(single[0][0]) | frozenset(single[1][0])]


# -- where meanings come from ----------------------------------------------------------------------


def test_meanings_come_from_what_is_asked_for_then_from_the_note(tmp_path):
    path = tmp_path / "spin.md"
    path.write_text("$$K = T$$\n")

    def origin(**options):
        return eom.check(path, **options).lexicon

    assert origin().startswith("draft on preset ")
    (tmp_path / "lexicon.toml").write_text("preset = 'hughes'")
    assert origin() == "lexicon.toml"
    (tmp_path / "spin.toml").write_text("title = 'a scene of that name'")
    assert origin() == "lexicon.toml"
    (tmp_path / "spin.toml").write_text("preset = 'kane'")
    assert origin() == "spin.toml"
    (tmp_path / "spin.lexicon.toml").write_text("preset = 'kane'")
    assert origin() == "spin.lexicon.toml"
    path.write_text("+++\n[check]\npreset = 'kane'\n+++\n$$K = T$$\n")
    assert origin() == "front matter"
    assert origin(notation="hughes") == "preset hughes"
    assert origin(lexicon=tmp_path / "spin.toml") == str(tmp_path / "spin.toml")
    with pytest.raises(InputError, match="exclude each other"):
        origin(notation="hughes", lexicon="x.toml")


@pytest.mark.parametrize(
    ("name", "text", "what"),
    [
        ("n.lexicon.toml", "presett = 'kane'", "unknown key 'presett'"),
        ("n.toml", "preset = 'cane'", "unknown preset 'cane'"),
        ("n.toml", "preset = ", "not TOML"),
        ("n.toml", b"\xff\xfe", "cannot be read"),
        ("n.toml", "#" * 1_100_000, "too long"),
    ],
)
def test_bad_lexica_are_refused(tmp_path, name, text, what):
    (tmp_path / "n.md").write_text("$$a = b$$")
    (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError, match=what):
        eom.check(tmp_path / "n.md")
    with pytest.raises(InputError, match=what):
        eom.check("$$a = b$$", lexicon=tmp_path / name)


def test_front_matter_of_a_notebook_and_of_others():
    cells = [
        {"cell_type": "markdown", "source": ["+++\n[check]\npreset = 'kane'\n+++\n"]},
        {"cell_type": "code", "source": "$$a = b$$"},
        {"cell_type": "markdown", "source": "x\n\n$$" + EULER + "$$"},
    ]
    report = eom.check(json.dumps({"cells": cells}))
    (finding,) = report.findings
    assert (report.lexicon, finding.verdict, finding.line) == ("front matter", "holds under", 3)
    assert finding.source.name == "text, cell 3"
    assert "draft" in eom.check("---\ntitle: check\n---\n$$a = b$$").lexicon


DRAFTED = r"""
The angular velocity, $\mathbf{y}$, of the body. Let $\mathbf{z}$ be free.

$$\mathbf{y} + \mathbf{z} = 0$$
$$\mathbf{y} = m$$
"""


def test_a_draft_says_so_and_calls_nothing_ill_formed():
    report = eom.check(DRAFTED)
    assert report.lexicon.startswith("draft on preset ")
    assert any("angular velocity of the" in str(d) and "line 2" in str(d) for d in report.drafts)
    assert r"\mathbf{z}" in report.unplaced
    free, ill = [f for f in report.findings if f.kind == "display"]
    assert (free.verdict, ill.verdict) == ("undecided", "undecided")
    assert ill.reason.startswith("ill-formed if the draft is right: ")


def test_a_draft_is_the_lexicon_that_it_prints(tmp_path):
    document = read_document(DRAFTED)
    file = tmp_path / "n.toml"
    file.write_text(propose(document).toml)
    drafted = eom.check(DRAFTED)
    confirmed = eom.check(DRAFTED, lexicon=file)
    assert [f.verdict for f in drafted.findings][-1] == "undecided"
    assert [f.verdict for f in confirmed.findings][-1] == "ill-formed"
    assert meanings(document).lexicon.layers[0] != ()


@examples(60)
@given(st.text("\\'\"ab_^{}$ \x01\x7f#\néω", max_size=30))
def test_drafts_are_toml_whatever_the_note_says(words):
    note = (
        f"The angular velocity {words} $\\boldsymbol{{q}}'$ of the body, {words}.\n$$q' = {words}$$"
    )
    assert "preset" in tomllib.loads(propose(read_document(note)).toml)


# -- inputs ----------------------------------------------------------------------------------------


def test_files_and_formulas_are_distinguished(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a=b").write_text("")
    for word in ("n.md", "x/n.tex", "a=b", "notes", "deep/er", "$x.ipynb"):
        assert is_file(word), word
    for word in (r"\dot q = u", "a=c", "$x$", "x > 0", "Let $a=b$.\n", "a" * 5000 + "=b", "a=\0"):
        assert not is_file(word), word
    with pytest.raises(InputError, match="no such file or folder"):
        eom.check("notes")
    with pytest.raises(InputError, match="not a file"):
        eom.check(tmp_path)


def test_texts_are_what_they_look_like():
    for kind, text in (
        ("formula", r"\dot q = u"),
        ("markdown", "Let $a=b$."),
        ("markdown", "a = b\n\nc"),
        ("markdown", r"so \[a=b\]"),
        ("latex", r"\documentclass{article}\begin{document}$a=b$\end{document}"),
        ("notebook", '{"cells": []}'),
    ):
        assert looks_like(text) == kind, text
    assert looks_like("a = b\n") == "formula"
    line = eom.check("\n\n$$\\vec H_C = m$$", **ARROWS).findings[0].line
    assert line == 3


def test_folders_are_read_in_order_without_hidden_files_and_links_that_lead_out(tmp_path):
    (tmp_path / "secret.md").write_text("$a=b$")
    root = tmp_path / "notes"
    for name in ("b.md", "a.tex", "sub/c.ipynb", ".git/d.md", ".e.md", "f.py", "sub/g.md/h.md"):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text("")
    (root / "out.md").symlink_to(tmp_path / "secret.md")
    (root / "in.md").symlink_to(root / "b.md")
    found = [str(p.relative_to(root)) for p in notes_of([root])]
    assert found == ["a.tex", "b.md", "in.md", "sub/c.ipynb", "sub/g.md/h.md"]
    assert notes_of([Text("a=b"), root / "b.md"]) == [Text("a=b"), root / "b.md"]


def test_unusable_notes_are_refused(tmp_path):
    for name, data, what in (
        ("a.md", b"\0\1", "binary"),
        ("b.md", b"\xff\xe9x", "not encoded in UTF-8"),
        ("c.pdf", b"", "unknown kind"),
        ("d.ipynb", b"{}", "no notebook"),
        ("e.md", b"x" * 4_000_001, "too long"),
    ):
        (tmp_path / name).write_bytes(data)
        with pytest.raises(InputError, match=what):
            eom.check(tmp_path / name)


# -- bounds ----------------------------------------------------------------------------------------

HOSTILE = {
    "product": r"\times ".join([r"\vec r"] * 2000) + r" = \vec r",
    "tower": r"m^{9^{9^9}} = m",
    "sums": r"\sum_i \sum_j " * 12 + "m_i = m",
    "power": r"m^{999999999} = m",
    "nested": "(" * 5000 + "m" + ")" * 5000 + " = m",
    "script": r"<script>alert(1)</script> = \vec H_C",
}


@pytest.mark.parametrize("name", but(HOSTILE, "product", "sums"))
def test_hostile_formulas_are_undecided_or_judged(name):
    assert one(HOSTILE[name]).verdict in ORDER


def test_a_formula_that_takes_too_long_is_undecided_and_the_others_are_not():
    chain = "=".join([r"\vec{H}_C"] * 1500)
    report = eom.check(f"$${chain}$$\n\n$$\\vec H_C = m$$", **ARROWS, seconds=0.3)
    assert [f.verdict for f in report.findings] == ["undecided", "ill-formed"]
    assert "takes more than 0.3 s" in report.findings[0].reason


def test_the_time_of_a_note_holds_for_all_its_formulas():
    hurried = Settings("arrow-tilde", note_seconds=1e-9)
    report = check_note(note_of(NOTE), hurried)
    assert {f.verdict for f in report.findings} == {"undecided"}
    assert "this note takes more than 1e-09 s" in report.findings[0].reason
    with pytest.raises(InputError, match="no notation can be proposed"):
        check_note(note_of(NOTE), Settings(note_seconds=1e-9))


def test_the_sooner_of_two_deadlines_holds():
    with deadline(1e-9, "outer"), deadline(100, "inner"), pytest.raises(Overdue, match="outer"):
        check()
    with deadline(100, "outer"), pytest.raises(Overdue, match="inner"), deadline(1e-9, "inner"):
        check()
    check()


# -- what is added ---------------------------------------------------------------------------------


def test_explanations_add_to_findings_and_leave_them_where_they_take_too_long(monkeypatch):
    def explained(understood, judged, *_):
        assert judged.verdict in FAULTS
        return Explanation(residual=f"of {understood.formula.piece.kind}")

    def slow(*_):
        with deadline(1e-9, "explaining"):
            check()
        raise AssertionError("the time was not used up")

    monkeypatch.setattr(checking, "explain", explained)
    report = eom.check(NOTE, **ARROWS)
    assert [f.line for f in report.findings] == [3, 5, 7, 10]
    wrong = [f for f in report.findings if f.verdict in FAULTS]
    assert wrong
    assert {f.explanation.residual for f in wrong} == {"of display"}
    monkeypatch.setattr(checking, "explain", slow)
    found = eom.check(NOTE, **ARROWS).findings
    assert [f.verdict for f in found] == [f.verdict for f in report.findings]
    assert {f.explanation for f in found} == {UNEXPLAINED}


def test_every_verdict_is_in_the_order():
    from eom.checker.judge import verdicts

    assert set(ORDER) == {*verdicts.ORDER, verdicts.NONE, UNSURE}
    assert FAULTS == verdicts.GRAVE


@pytest.mark.parametrize("count", only([500, 1000], 500))
def test_the_roles_of_many_formulas_in_one_paragraph_take_time_in_proportion(count):
    pieces = {n: read_document("$a=b$ " * n).pieces for n in (count, 8 * count)}
    assert growth_in_calls(10, lambda n: roles(pieces[n]), count, 8 * count)


def test_the_letters_of_a_system_that_was_named_need_no_confirmation():
    """Only where every symbol is the system's; another one is guessed, and the report says so."""
    line = r"I_1\ddot\theta + I_1\dot\psi^2\sin\theta\cos\theta - C I_2 \dot\psi\cos\theta = -M_1"
    own = eom.check(line, system="lecture-wheel")
    assert own.lexicon == "letters of lecture-wheel"
    assert not own.unplaced
    assert eom.check(line).lexicon.startswith("draft")
    more = eom.check(f"$${line}$$ $$\\vec H_C = \\vec z$$", system="lecture-wheel")
    assert more.lexicon.startswith("draft")
    assert more.unplaced


def test_a_system_that_was_named_goes_before_any_draft():
    """Its letters mean its quantities, whatever words or books would say of them."""
    wrong = r"\frac{d}{dt}(h_1^2 + h_2^2 + h_3^2) = h_1\tau_1 + h_2\tau_2 + h_3\tau_3"
    euler = eom.derive("euler-equations").system
    found = eom.check(wrong, system=euler)
    assert found.lexicon == "letters of euler_equations"
    assert [f.verdict for f in found.findings] == ["wrong"]
    right = wrong.replace("= h_1", "= 2h_1").replace("+ h_2\\tau", "+ 2h_2\\tau")
    right = right.replace("+ h_3\\tau", "+ 2h_3\\tau")
    text = rf"$h_1$ is the height of the roof. $${right}$$"
    assert eom.check(text, system=euler).findings[-1].verdict in {"holds", "holds under"}
