"""`eom derive` of what users keep: notes, and programs that are run when they say so."""

import shutil

import pytest
from click.testing import CliRunner

from eom.__main__ import main
from tests.eom.checker.test_kept import NOTE

PROGRAM = """\
import eom
from eom.terms.terms import Equation

open("ran", "w").close()
d = eom.Derivation("mine", "My own", "Trials")
m, = d.constants(m="mass")
d.state(Equation((m + 1) ** 2, m**2 + 2 * m + 1), "expanded", label="square")
done = d.finish()
"""


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runner = CliRunner()
    return lambda *words: runner.invoke(main, list(words), catch_exceptions=False)


def test_a_note_is_derived_by_steps_that_are_verified_again(run, tmp_path):
    (tmp_path / "note.md").write_text(NOTE, encoding="utf-8")
    done = run("derive", "note.md")
    assert done.exit_code == 0
    assert "each verified when it was made" in done.output
    assert "as the mass is constant" in done.output
    (tmp_path / "again.md").write_text(
        run("derive", "note.md", "--as", "markdown", "--lexicon").output, encoding="utf-8"
    )
    assert run("check", "again.md").exit_code == 0


def test_a_program_is_run_when_it_is_said_and_not_before(run, tmp_path):
    (tmp_path / "mine.py").write_text(PROGRAM, encoding="utf-8")
    refused = run("derive", "mine.py")
    assert refused.exit_code == 2
    assert "add --run" in refused.stderr
    assert not (tmp_path / "ran").exists()
    done = run("derive", "mine.py", "--run", "--as", "latex")
    assert done.exit_code == 0
    assert (tmp_path / "ran").exists()
    assert "\\documentclass" in done.output
    assert "My own" in done.output


@pytest.mark.parametrize(
    ("file", "text", "words", "said"),
    [
        ("none.md", None, [], "no such file"),
        ("wrong.md", NOTE.replace(r"m \ddot", r"3 m \ddot"), [], "not judged true"),
        ("empty.py", "x = 1\n", ["--run"], "no derivation in this program"),
        ("ends.py", "1 / 0\n", ["--run"], "ZeroDivisionError"),
        ("false.py", PROGRAM.replace("+ 1)\n", "+ 1)\n").replace("2 * m", "3 * m"), ["--run"], "false"),
        ("note.md", NOTE, ["--run"], "--run is for programs"),
        ("note.md", NOTE, ["--method", "kane"], "--method is for"),
    ],
)  # fmt: skip
def test_what_cannot_be_derived_says_so(run, tmp_path, file, text, words, said):
    if text is not None:
        (tmp_path / file).write_text(text, encoding="utf-8")
    done = run("derive", file, *words)
    assert done.exit_code == 2
    assert said in done.stderr


# -- forms, files, figures ---------------------------------------------------------------------


@pytest.mark.parametrize("ending", [".txt", ".tex", ".md", ".html"])
def test_a_page_is_written_to_a_file_whose_ending_is_its_format(tmp_path, ending):
    file = tmp_path / f"page{ending}"
    done = CliRunner().invoke(main, ["derive", "point-mass", "--out", str(file)])
    assert done.exit_code == 0, done.output
    shown = file.read_text(encoding="utf-8")
    marks = {
        ".txt": "Notation",
        ".tex": "\\begin{document}",
        ".md": "# Dynamics",
        ".html": "<!DOCTYPE",
    }
    assert marks[ending] in shown


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="LaTeX is not installed")
def test_a_handout_is_written_as_pdf(tmp_path):
    file = tmp_path / "page.pdf"
    done = CliRunner().invoke(
        main, ["derive", "point-mass", "--form", "handout", "--out", str(file)]
    )
    assert done.exit_code == 0, done.output
    assert file.read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--out", "page.doc"], "a name that ends in"),
        (["--out", "page.md", "--as", "html"], "another format"),
        (["--form", "half"], "full, handout"),
        (["--form", "handout", "--no-steps"], "a handout has steps"),
        (["--figures"], "no place for figures"),
        (["--out", "no/such/folder/page.md"], "cannot be written"),
    ],
)
def test_what_no_page_can_be_is_refused(options, said):
    done = CliRunner().invoke(main, ["derive", "point-mass", *options])
    assert done.exit_code != 0
    assert said in str(done.exception) + done.output


def test_figures_stand_where_frames_are_introduced():
    shown = {
        style: CliRunner().invoke(main, ["derive", "euler-equations", "--as", style, *more]).output
        for style, more in (("html", []), ("latex", []), ("markdown", ["--figures"]))
    }
    assert "<figure><svg" in shown["html"]
    assert "\\begin{picture}" in shown["latex"]
    assert "data:image/svg+xml;base64," in shown["markdown"]
    without = ["derive", "euler-equations", "--as", "html", "--no-figures"]
    assert "<svg" not in CliRunner().invoke(main, without).output


def test_scenes_have_no_handout():
    done = CliRunner().invoke(main, ["derive", "bicycle-wheel", "--form", "handout"])
    assert "--form is for derivations" in str(done.exception) + done.output
