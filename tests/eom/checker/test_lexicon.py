import importlib.util
from pathlib import Path

import pytest

from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import verdict
from eom.checker.mean.lexicon import OWN, TABLED
from eom.checker.mean.lexicon_files import (
    PRESETS,
    front_matter,
    lexicon_for,
    lexicon_of,
    look_of,
    parse_lexicon,
    preset,
)
from eom.checker.read.documents import read_document
from eom.checker.read.writing import latex_of
from eom.errors import InputError
from eom.terms.vocabulary import QUANTITIES


def meaning_of(lexicon, latex, **indices):
    found = lexicon.find(look_of(latex), indices)
    return None if found is None else (found.meaning.quantity, *found.meaning.labels)


@pytest.mark.parametrize("name", PRESETS)
def test_presets_load_and_every_pattern_reads_as_itself(name):
    lexicon = preset(name)
    assert lexicon.layers[0]
    for entry in lexicon.layers[0]:
        if not entry.slots:
            found = lexicon.find(entry.look)
            assert found is not None
            assert found.meaning == entry.meaning, entry.latex


@pytest.mark.parametrize("name", PRESETS)
def test_the_angular_velocity_of_every_preset_has_components(name):
    assert meaning_of(preset(name), r"\omega_2")[:3] == ("angular_velocity", "B", "I")


def test_frames_on_both_sides_and_below():
    left = preset("left-superscript")
    assert meaning_of(left, r"{}^{\mathcal{I}}\boldsymbol{\omega}^{\mathcal{B}}") == (
        "angular_velocity",
        "B",
        "I",
    )
    assert meaning_of(left, r"{}^{\mathcal{I}}\boldsymbol{\omega}^{\mathcal{Q}}") is None
    schaub = preset("schaub-junkins")
    expected = ("angular_velocity", "B", "I")
    assert meaning_of(schaub, r"\boldsymbol{\omega}_{\mathcal{B}/\mathcal{N}}") == expected
    assert meaning_of(schaub, r"\bm{\omega}_{B/N}") == expected


def test_fonts_of_labels_do_not_count_but_shapes_do():
    lexicon = parse_lexicon(
        "[frames]\n'\\mathcal{B}' = 'B'\n[symbols]\n'v_{<F>}' = 'vector v in <F>'\n"
        "'v_{ext}' = 'vector w'"
    )
    assert meaning_of(lexicon, r"v_{\mathcal{B}}") == ("vector", "v")
    assert meaning_of(lexicon, r"v_{\mathfrak{B}}") is None
    for spelling in (r"v_{ext}", r"v_{\text{ext}}", r"v_{\mathrm{ext}}"):
        assert meaning_of(lexicon, spelling) == ("vector", "w")


def test_a_pattern_without_slots_goes_first_and_repeated_slots_agree():
    lexicon = parse_lexicon(
        "[symbols]\n'I_{<k><l>}' = \"inertia C in B component <k> <l>\"\n"
        "'I_{<k><k>}' = \"inertia C in B component <k> <k>\"\n'I_{13}' = \"scalar odd\""
    )
    assert meaning_of(lexicon, "I_{13}") == ("scalar", "odd")
    assert lexicon.find(look_of("I_{22}")).meaning.component == ("2", "2")
    assert lexicon.find(look_of("I_{xy}")).meaning.component == ("1", "2")
    assert lexicon.find(look_of("I_{14}")) is None


def test_indices_stand_for_particles_or_for_numbers():
    lexicon = parse_lexicon("[symbols]\n'm_{<i>}' = \"mass <i>\"\n'w_{<k>}' = \"scalar w<k>\"")
    assert meaning_of(lexicon, "m_j") == ("mass", "j")
    assert meaning_of(lexicon, "m_j", j="i") == ("mass", "i")
    assert meaning_of(lexicon, "m_q") is None
    assert meaning_of(lexicon, "w_i", i="3") == ("scalar", "w3")


def test_scopes_by_heading_and_phrase():
    lexicon = parse_lexicon(
        '[symbols]\n\'I\' = "inertia C"\n[[scope]]\nheading = "Two  words"\n[scope.symbols]\n'
        '\'I\' = "inertia O"\n[[scope]]\nafter = "from here"\n[scope.symbols]\n\'I\' = "scalar I"\n'
        "[scope.points]\n'Q' = \"O\""
    )
    assert meaning_of(lexicon.at(), "I") == ("inertia", "C")
    assert meaning_of(lexicon.at(["Other"]), "I") == ("inertia", "C")
    assert meaning_of(lexicon.at(["Above", "two words"]), "I") == ("inertia", "O")
    late = lexicon.at(["two words"], {"from here"})
    assert meaning_of(late, "I") == ("scalar", "I")
    assert late.points[("Q",)] == "O"


def test_own_entries_go_before_those_of_the_preset():
    lexicon = parse_lexicon('preset = "kane"\n[symbols]\n\'K\' = "scalar K"')
    assert meaning_of(lexicon, "K") == ("scalar", "K")
    assert meaning_of(lexicon, r"\mathbf{p}^{OP}") == ("position", "P", "OI")


def test_nuclei_that_mean_the_same():
    lexicon = preset("underline-bullet")
    for spelling in (
        r"\underline{r}_\bullet",
        r"\mathbf{r}_\bullet",
        r"\underline{\mathbf{r}}_\bullet",
    ):
        assert meaning_of(lexicon, spelling) == ("position", "C", "OI")
    assert meaning_of(lexicon, r"\vec{r}_\bullet") is None


BAD = {
    "[symbols]\n'r' = \"positon dm C\"": ("unknown quantity", "position"),
    "[symbols]\n'r' = \"position dm\"": ("wrong number of labels", "2"),
    "[symbols]\n'r' = \"mass P in B\"": ("no components", "scalar"),
    "[symbols]\n'r' = \"position dm C in B component 4\"": ("components are", "4"),
    "[symbols]\n'r' = \"position dm C component 1\"": ("wrong components", "in FRAME"),
    "[symbols]\n'r' = \"position <P> C\"": ("slot is not in the pattern", "<P>"),
    "[symbols]\n'r_{<z>}' = \"scalar r\"": ("unknown slot", "<z>"),
    "[symbols]\n'a + b' = \"scalar r\"": ("one symbol", "a + b"),
    "[symbols]\n'\\dot r' = \"scalar r\"": ("one symbol", "without dots"),
    "[symbols]\n'r' = 3": ("not a meaning", "3"),
    "[symbols]\n'r' = { equals = \"\" }": ("empty formula", ""),
    '[symbols]\n\'r\' = { is = "scalar r", unit = "furlong" }': ("unknown unit", "furlong"),
    '[symbols]\n\'r\' = { is = "scalar r", equals = "x" }': ("one of is and equals", ""),
    "[symbols]\n'r' = { iz = \"scalar r\" }": ("unknown key", "is"),
    "[symbols]\n'{' = \"scalar r\"": ("", "1"),
    "[frames]\n'B' = \"\"": ("not a name", ""),
    "[marks]\ndot = 3": ("not a mark", "3"),
    '[notation]\ndots = "I"': ("unknown setting", "dot"),
    '[notation]\ndyads = "yes"': ("wrong type", "bool"),
    'preset = "kain"': ("unknown preset", "kane"),
    "symbols = 3": ("not a table", "[symbols]"),
    "[[scope]]\n[scope.symbols]": ("no place", "heading"),
    "symbls = 3": ("unknown key", "symbols"),
    "[symbols]\n'\\vec{r} = 3": ("not TOML", "single quotes"),
}


@pytest.mark.parametrize("text", BAD)
def test_every_bad_entry_is_one_clear_error(text):
    what, part = BAD[text]
    with pytest.raises(InputError) as caught:
        parse_lexicon(text, "lexicon.toml")
    assert what in str(caught.value)
    assert part in str(caught.value)


def test_all_bad_entries_are_listed_and_good_ones_are_kept():
    data = {"symbols": {"a": "scalar a", "b": "scaler b", "c": "position c"}, "frames": {"B": 1}}
    lexicon, errors = lexicon_of(data, "here")
    assert len(errors) == 3
    assert all("here" in e.where for e in errors)
    assert meaning_of(lexicon, "a") == ("scalar", "a")


def test_front_matter_and_files_beside_a_note(tmp_path):
    note = "+++\ntitle = 'x'\n[check]\npreset = 'kane'\n+++\n# Note\n"
    assert front_matter(note) == {"preset": "kane"}
    assert front_matter("# Note\n+++\n") == {}
    assert meaning_of(lexicon_for(note), "K") == ("kinetic_energy", "body")
    path = tmp_path / "spin.md"
    assert lexicon_for("# Note", path) is None
    (tmp_path / "lexicon.toml").write_text("preset = 'hughes'", encoding="utf-8")
    assert meaning_of(lexicon_for("# Note", path), "T") == ("rotational_energy", "body", "C")
    (tmp_path / "spin.lexicon.toml").write_text("[symbols]\n'T' = 'scalar T'", encoding="utf-8")
    assert meaning_of(lexicon_for("# Note", path), "T") == ("scalar", "T")
    with pytest.raises(InputError, match="front matter"):
        lexicon_for("+++\ncheck = 3\n+++\n")


@pytest.mark.parametrize("name", PRESETS)
def test_looks_are_written_as_they_read(name):
    for entry in preset(name).layers[0]:
        if not entry.slots:
            assert look_of(latex_of(entry.look)) == entry.look


def test_errors_stand_at_the_lines_of_the_lexicon():
    """In TOML, in front matter and in YAML, in scopes too."""
    above = "\n[symbols]\n'a' = \"scalar a\"\n'h' = \"no_such\"\n"
    text = above + "[[scope]]\nafter = \"x\"\n[scope.symbols]\n'k' = 3\n"
    with pytest.raises(InputError) as found:
        parse_lexicon(text, "n.toml")
    assert "n.toml, line 4, symbols > h" in str(found.value)
    assert "n.toml, line 8, scope 1 > symbols > k" in str(found.value)
    toml = "+++\n[check]\n[check.symbols]\n'h' = \"no_such\"\n+++\n$h = 1$\n"
    yaml = "---\ntitle: x\neom:\n  symbols:\n    '\\vec{h}': no_such\n---\n"
    for note, line in ((toml, 4), (yaml, 5)):
        with pytest.raises(InputError, match=f"line {line}, symbols > "):
            lexicon_for(note)


def test_turns_about_axes_that_are_no_sequence_are_refused_in_the_lexicon():
    with pytest.raises(InputError, match="unknown axes of turns") as found:
        parse_lexicon("[symbols]\n'q' = 'turn_angle 1 33 B I'", "n.toml")
    assert found.value.where == "n.toml, line 2, symbols > q"
    assert parse_lexicon("[symbols]\n'q' = 'turn_angle 1 space321 B I'").layers[0]


FRAMES = r"""
assume = ["one_particle"]
[frames]
'\mathcal{R}_0' = "I"
'\mathcal{R}_1' = "A"
'\mathcal{R}_2' = "D"
[points]
'O' = "OI"
'A' = "O"
'M' = "P"
[symbols]
'\overrightarrow{\Omega}(<F>/<G>)' = "angular_velocity <F> <G>"
'\overrightarrow{<P><Q>}' = "position <Q> <P>"
'\vec{V}(<P>/<F>)' = '= \left(\frac{d}{dt}\overrightarrow{O<P>}\right)_{<F>}'
'\vec{w}(M/\mathcal{R}_1)' = '= \left(\frac{d}{dt}\overrightarrow{AM}\right)_{\mathcal{R}_1}'
"""
OF_FRAMES = {
    r"\vec\Omega(\mathcal R_2/\mathcal R_0)=\vec\Omega(\mathcal R_2/\mathcal R_1)"
    r"+\vec\Omega(\mathcal R_1/\mathcal R_0)": "holds",
    r"\vec\Omega(\mathcal R_2/\mathcal R_0)=\vec\Omega(\mathcal R_0/\mathcal R_2)": "wrong",
    r"\overrightarrow{OM}=\overrightarrow{OA}+\overrightarrow{AM}": "holds",
    r"\overrightarrow{OM}=\overrightarrow{OA}-\overrightarrow{AM}": "wrong",
    r"\vec V(M/\mathcal R_0)=\vec w(M/\mathcal R_1)+\vec V(A/\mathcal R_0)"
    r"+\vec\Omega(\mathcal R_1/\mathcal R_0)\wedge\overrightarrow{AM}": "holds",
    r"\vec V(M/\mathcal R_0)=\vec w(M/\mathcal R_1)+\vec V(A/\mathcal R_0)"
    r"+\vec\Omega(\mathcal R_0/\mathcal R_1)\wedge\overrightarrow{AM}": "wrong",
    r"\vec V(M/\mathcal R_0)=\vec w(M/\mathcal R_2)": "undecided",
}


@pytest.mark.parametrize("line", OF_FRAMES)
def test_names_in_brackets_and_below_arrows_are_labels(line):
    one = understand(read_document(f"$$ {line} $$"), parse_lexicon(FRAMES))[0]
    assert verdict(one, ("one_particle",)).verdict == OF_FRAMES[line]


PLANE = r"""
[symbols]
'\hat{\mathbf{n}}_{<k>}' = "unit I <k>"
'\hat{\mathbf{a}}_{<k>}' = "unit A <k>"
'\hat{\mathbf{b}}_{<k>}' = "unit B <k>"
'\theta_1' = "turn_angle 1 3 A I"
'\theta_2' = "turn_angle 1 3 B A"
'l' = { is = "scalar l", unit = "m" }
'\mathbf{a}' = '= l\ddot{\hat{\mathbf{a}}}_1'
'\boldsymbol{\omega}' = "angular_velocity B I"
"""
IN_A_PLANE = {
    r"\hat{\mathbf a}_1 = \cos\theta_1\hat{\mathbf n}_1+\sin\theta_1\hat{\mathbf n}_2": "holds",
    r"\hat{\mathbf a}_1 = \cos\theta_1\hat{\mathbf n}_1-\sin\theta_1\hat{\mathbf n}_2": "wrong",
    r"\hat{\mathbf b}_1\cdot\hat{\mathbf n}_2=\sin(\theta_1+\theta_2)": "holds",
    r"\hat{\mathbf b}_1\cdot\hat{\mathbf n}_2=\sin(\theta_1-\theta_2)": "wrong",
    r"\mathbf a=-l\dot\theta_1^2\hat{\mathbf a}_1+l\ddot\theta_1\hat{\mathbf a}_2": "holds",
    r"\mathbf a=l\dot\theta_1^2\hat{\mathbf a}_1+l\ddot\theta_1\hat{\mathbf a}_2": "wrong",
    r"\boldsymbol\omega=(\dot\theta_1+\dot\theta_2)\hat{\mathbf n}_3": "holds",
    r"\boldsymbol\omega=\dot\theta_2\hat{\mathbf n}_3": "wrong",
}


@pytest.mark.parametrize("line", IN_A_PLANE)
def test_turns_about_one_axis_add_up(line):
    one = understand(read_document(f"$$ {line} $$"), parse_lexicon(PLANE))[0]
    assert verdict(one).verdict == IN_A_PLANE[line]


def test_a_symbol_without_a_meaning_comes_with_its_entry():
    line = r"\vec\Gamma(M/\mathcal R_7)=\overrightarrow{OA}"
    one = understand(read_document(f"$$ {line} $$"), parse_lexicon(FRAMES))[0]
    assert r"'\vec{\Gamma}( M / \mathcal{R}_{7} )' = ..." in verdict(one).reason


def test_looks_of_pairs_and_names_in_brackets_are_written_as_they_read():
    for latex in (r"\vec{OM}", r"\vec{\Omega}(B/\mathcal{R}_0)", r"\underline{SP}"):
        look = look_of(latex)
        assert look_of(latex_of(look)) == look


def test_a_dyadic_beside_a_vector_acts_on_it_without_a_preset():
    lexicon = parse_lexicon(
        "[symbols]\nh = 'angular_momentum body C'\nw = 'angular_velocity B I'\nJ = 'inertia C'"
    )
    one = understand(read_document("$$ h = J w $$"), lexicon)[0]
    assert verdict(one, ("body_frame",)).verdict == "holds"


def test_every_quantity_of_the_documentation_has_an_entry_that_reads():
    file = Path(__file__).parents[3] / "docs" / "_ext" / "shown_tables.py"
    spec = importlib.util.spec_from_file_location("shown_tables", file)
    tables = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tables)
    assert set(tables.entries()) == {*QUANTITIES, *OWN, *TABLED}
    for name, (latex, words, meaning) in tables.entries().items():
        assert words
        assert parse_lexicon(f"[symbols]\n'{latex}' = '{meaning}'").layers[0], name


def test_pi_is_a_number_of_which_nothing_rational_is_known():
    lines = {r"\pi (J w) = h \pi": "holds", r"\pi J w = 3 h": "wrong"}
    lexicon = parse_lexicon(
        "[symbols]\nh = 'angular_momentum body C'\nw = 'angular_velocity B I'\nJ = 'inertia C'"
    )
    for line, wanted in lines.items():
        one = understand(read_document(f"$$ {line} $$"), lexicon)[0]
        assert verdict(one, ("body_frame",)).verdict == wanted
