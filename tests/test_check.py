"""`eom check`, as a user meets it."""

import csv
import io
import json
import subprocess
import sys
import tomllib
from importlib import resources

import pytest
from click.testing import CliRunner

from eom.__main__ import main
from eom.checker.report.findings import COLUMNS
from eom.worlds.worlds import ASSUMPTIONS

RIGHT, WRONG = r"\vec H_C = I_C\vec\omega", r"\vec H_C = I_C\vec\omega + \vec\omega"
NOTE = f"""# Note

$${RIGHT}$$

$${WRONG}$$

$$\\vec H_C = m$$ and $\\vec H_C = \\vec q$
"""
ARROWS = ("--notation", "arrow-tilde")


@pytest.fixture
def check():
    def run(*words, **options):
        words = ["check", *map(str, words)]
        return CliRunner().invoke(main, words, catch_exceptions=False, **options)

    return run


@pytest.fixture
def note(tmp_path):
    file = tmp_path / "note.md"
    file.write_text(NOTE)
    return file


def lines(done):
    return [line.rstrip() for line in done.output.splitlines()]


def test_a_wrong_formula_on_the_command_line(check):
    done = check(WRONG, *ARROWS)
    assert done.exit_code == 1
    reported = lines(done)
    assert reported[:8] == [
        "formula",
        "  meanings: preset arrow-tilde",
        "  given: constant_mass",
        "",
        "  line 1: wrong",
        f"    {WRONG}",
        "    " + " " * WRONG.rindex(r"\vec") + "^" * len(r"\vec\omega"),
        "    why: the dimensions differ; got 1/s; expected kg m^2/s",
    ]
    assert reported[8].startswith(r"    repair: a term is too much: $\vec{\omega}$")
    assert reported[9] == f"            {RIGHT}"
    assert reported[-1] == "  1 equation: 1 wrong"


def test_a_right_formula_names_the_assumptions_that_it_needs(check):
    done = check(RIGHT, *ARROWS)
    assert done.exit_code == 0
    assert "  line 1: holds under {body_frame}" in lines(done)
    assert "    body_frame  the frame B is fixed in the body" in lines(done)
    assert lines(done)[-1] == "  1 equation: 1 hold under assumptions"


def test_a_note_with_its_counts(check, note):
    done = check(note, *ARROWS)
    assert done.exit_code == 1
    assert "  line 3: holds under {body_frame}" in lines(done)
    assert "  line 5: wrong" in lines(done)
    assert "  line 7: ill-formed" in lines(done)
    assert (
        lines(done)[-1]
        == "  4 equations: 1 wrong, 1 ill-formed, 1 undecided, 1 hold under assumptions"
    )


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (["--quiet"], ["wrong", "ill-formed"]),
        (["--only", "wrong"], ["wrong"]),
        (
            ["--only", "holds-under", "--only", "undecided"],
            ["holds under {body_frame}", "undecided"],
        ),
        (["--only", "holds under"], ["holds under {body_frame}"]),
        (["--only", "definition"], []),
    ],
)
def test_only_and_quiet_print_less_and_change_no_status(check, note, words, reported):
    done = check(note, *ARROWS, *words)
    assert done.exit_code == 1
    heads = [line.partition(": ")[2] for line in lines(done) if line.startswith("  line ")]
    assert heads == reported
    assert "4 equations" in lines(done)[-1]


def test_standard_input_is_a_note(check, note):
    done = check("-", *ARROWS, input=NOTE)
    assert done.exit_code == 1
    assert lines(done)[0] == "standard input"
    assert lines(done)[1:] == lines(check(note, *ARROWS))[1:]
    alone = check("-", *ARROWS, input=RIGHT + "\n")
    assert alone.exit_code == 0
    assert "1 equation: 1 hold under assumptions" in alone.output
    latex = r"\section{A} % $x=y$" + f"\n\\[{WRONG}\\]"
    assert "1 equation: 1 wrong" in check("-", "--as", "latex", *ARROWS, input=latex).output


def test_json_is_that_of_the_schema(check, note):
    jsonschema = pytest.importorskip("jsonschema")
    file = resources.files("eom.checker.report") / "report.schema.json"
    schema = json.loads(file.read_text(encoding="utf-8"))
    done = check(note, *ARROWS, "--json")
    assert done.exit_code == 1
    data = json.loads(done.output)
    jsonschema.Draft202012Validator(schema).validate(data)
    (one,) = data["notes"]
    assert one["counts"] == {"wrong": 1, "ill-formed": 1, "undecided": 1, "holds under": 1}
    assert [f["place"]["line"] for f in one["findings"]] == [3, 5, 7, 7]
    assert check(note, *ARROWS, "--json").output == done.output
    unusable = check("nowhere.md", "--json")
    assert unusable.exit_code == 2
    jsonschema.Draft202012Validator(schema).validate(json.loads(unusable.output))


@pytest.mark.slow
def test_a_folder_with_a_table(check, note, tmp_path):
    (tmp_path / "good.md").write_text(f"$${RIGHT}$$")
    (tmp_path / "bad.md").write_bytes(b"\0")
    table = tmp_path / "table.csv"
    done = check(tmp_path, *ARROWS, "--jobs", 2, "--table", table, "--quiet")
    assert done.exit_code == 2
    assert lines(done)[-1] == "3 notes: 1 with nothing wrong, 1 with something wrong, 1 unusable"
    assert "the file is binary" in done.stderr
    rows = list(csv.DictReader(io.StringIO(table.read_text())))
    assert tuple(rows[0]) == COLUMNS
    assert [r["status"] for r in rows] == ["unusable", "nothing wrong", "wrong"]
    assert rows[0]["error"] == f"the file is binary; where: {tmp_path / 'bad.md'}"
    check(note, *ARROWS, "--table", tmp_path / "table.json")
    assert json.loads((tmp_path / "table.json").read_text())[0]["first_fault"] == 5


@pytest.mark.slow
def test_the_page_of_a_note_and_the_pages_of_several(check, note, tmp_path):
    file = tmp_path / "page.html"
    done = check(note, *ARROWS, "--html", file)
    assert done.exit_code == 1
    assert "2 wrong" in file.read_text()
    assert "wrote" in done.stderr
    (tmp_path / "bad.md").write_bytes(b"\0")
    folder = tmp_path / "pages"
    assert check(note, tmp_path / "bad.md", *ARROWS, "--html", folder, "--jobs", 1).exit_code == 2
    assert sorted(p.name for p in folder.iterdir()) == ["1-note.html", "index.html"]
    index = (folder / "index.html").read_text()
    assert 'href="1-note.html"' in index
    assert "the file is binary" in index


@pytest.mark.slow
def test_several_notes_of_all_kinds(check, note):
    done = check(note, RIGHT, "-", *ARROWS, "--quiet", input=f"Let ${RIGHT}$.")
    assert done.exit_code == 1
    assert [line for line in lines(done) if line and not line.startswith(" ")] == [
        str(note),
        "formula",
        "standard input",
        "3 notes: 2 with nothing wrong, 1 with something wrong, 0 unusable",
    ]


def test_a_draft_says_so_and_propose_prints_it(check, note, tmp_path):
    words = "The angular velocity, $\\mathbf{y}$, of the body.\n\n$$\\mathbf{y} = \\mathbf{z}$$\n"
    note.write_text(words)
    done = check(note)
    assert done.exit_code == 0
    assert "  meanings: draft on preset " in done.output
    assert "Nobody has confirmed these meanings" in done.output
    assert r"\mathbf{y}: angular velocity of the frame of the body" in done.output
    assert r"without a meaning: \mathbf{z}" in done.output
    proposed = check("--propose", note)
    assert proposed.exit_code == 0
    assert tomllib.loads(proposed.output)["symbols"] == {r"\mathbf{y}": "angular_velocity B I"}
    (tmp_path / "note.toml").write_text(proposed.output)
    assert "  meanings: note.toml" in lines(check(note))


def test_given_is_shown_and_can_be_nothing(check):
    law = r"\frac{d}{dt}(M \vec{R}_C) = M \dot{\vec R}_C"
    assert "line 1: holds\n" in check(law, *ARROWS).output
    bare = check(law, *ARROWS, "--given", "none")
    assert "given: nothing" in bare.output
    assert "holds under {constant_mass}" in bare.output
    rigid = check(law, *ARROWS, "--given", "rigid", "--given", "newton_2")
    assert "given: rigid, newton_2" in rigid.output


def test_help_lists_assumptions_presets_and_the_rule_for_words(check):
    output = " ".join(check("--help").output.split())
    assert all(name in output for name in ASSUMPTIONS)
    from eom.checker.mean.lexicon_files import PRESETS

    assert all(p in output.replace("- ", "-") for p in PRESETS)
    assert "[default: constant_mass]" in output
    assert "Exit status: 0 nothing wrong, 1 a line is wrong or ill-formed, 2 unusable" in output


def test_colours_are_for_terminals_without_no_color(check):
    plain = check(WRONG, *ARROWS).output
    assert "\x1b" not in plain
    coloured = check(WRONG, *ARROWS, color=True).output
    assert "\x1b[31m\x1b[1mwrong\x1b[0m" in coloured
    assert check(WRONG, *ARROWS, color=True, env={"NO_COLOR": "1"}).output == plain


@pytest.mark.sparse(8)
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nowhere.md"], "no such file or folder"),
        (["nowhere"], "no such file or folder"),
        (["{tmp}/empty"], "there are no notes here"),
        (["{tmp}/b.md"], "the file is binary"),
        (["{tmp}/note.pdf"], "unknown kind of document"),
        (["a=b", "--notation", "cane"], "unknown preset 'cane'"),
        (["a=b", "--lexicon", "{tmp}/no.toml"], "a lexicon cannot be read"),
        (["a=b", "--lexicon", "{tmp}/b.md"], "not TOML"),
        (["a=b", "--lexicon", "x.toml", "--notation", "kane"], "exclude each other"),
        (["a=b", "--given", "rigit"], "did you mean rigid"),
        (["a=b", "--given", "none", "--given", "rigid"], "excludes others"),
        (["a=b", "--given", "rotors", "--given", "rigid"], "cannot stand together"),
        (["a=b", "--only", "wrang"], "did you mean wrong"),
        (["a=b", "--as", "word"], "unknown kind of text 'word'"),
        (["a=b", "c=d", "--propose"], "a lexicon is proposed for one note"),
        (["a=b", "--seconds", "0"], "Invalid value for '--seconds'"),
        (["a=b", "--jobs", "-1"], "Invalid value for '--jobs'"),
        ([], "Missing argument"),
        (["a=b", "--code", "x.py:f"], "one of them"),
        (["--code", "x.py:f"], "code is checked against a system"),
        (["--code", "x.py:f", "--system", "t-handle"], "no such file"),
        (["a=b", "--system", "t-hadle"], "did you mean t-handle"),
        (["a=b", "--html", "{tmp}/empty"], "a file is needed"),
        (["a=b", "c=d", "--html", "{tmp}/b.md"], "a folder is needed"),
    ],
)
def test_what_cannot_be_used_is_one_message_and_status_2(check, tmp_path, words, said):
    (tmp_path / "b.md").write_bytes(b"\0")
    (tmp_path / "note.pdf").write_bytes(b"")
    (tmp_path / "empty").mkdir()
    done = check(*(w.format(tmp=tmp_path) if "{tmp}" in w else w for w in words))
    assert done.exit_code == 2
    assert said in done.stderr
    assert "Traceback" not in done.output


def test_names_and_formulas_are_printed_without_what_a_terminal_acts_on(check, tmp_path):
    file = tmp_path / "a\x1b[31m\udcff.md"
    file.write_text("$$\\vec H_C = \x1b[31m m$$")
    done = check(file, *ARROWS)
    assert "\x1b" not in done.output
    assert done.exit_code in {0, 1}
    assert "\x1b" not in check(file, *ARROWS, "--json").output


@pytest.mark.slow
def test_checking_takes_a_moment_in_a_process_of_its_own(note):
    command = [sys.executable, "-m", "eom", "check", str(note), *ARROWS]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1].startswith("  4 equations: 1 wrong, 1 ill-formed")
    assert done.stderr == ""


def test_starting_and_refusing_load_nothing_heavy():
    code = """
import sys
from eom.__main__ import main
try:
    main(["check", "x=y", "--given", "rigit"])
except SystemExit as error:
    assert error.code == 2
print(sorted({"sympy", "numpy", "scipy", "rich"} & set(sys.modules)))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


CODE = """def f(t, y, p):
    w1, w2, w3 = y
    I1, I2, I3 = p
    return [{0}(I2 - I3) / I1 * w2 * w3, (I3 - I1) / I2 * w3 * w1, (I1 - I2) / I3 * w1 * w2]
"""


@pytest.mark.parametrize(
    ("sign", "status", "said"), [("", 0, "right"), ("-", 1, "output 0 has the wrong sign")]
)
def test_code_is_checked_against_a_system(check, tmp_path, sign, status, said):
    (tmp_path / "rates.py").write_text(CODE.format(sign))
    done = check("--code", tmp_path / "rates.py:f", "--system", "free-rigid-body")
    assert done.exit_code == status
    assert said in done.output


def test_a_scalar_line_is_about_the_system_that_is_named(check):
    line = r"\dot\omega_1 = \frac{I_2-I_3}{I_1}\omega_2\omega_%s"
    assert check(line % 3, "--system", "free-rigid-body").exit_code == 0
    assert check(line % 1, "--system", "free-rigid-body").exit_code == 1
