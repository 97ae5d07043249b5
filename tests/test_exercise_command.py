"""`eom exercise`: pages, keys, files, JSON, the list, options that do not go together."""

import json
import xml.etree.ElementTree as ET

import pytest
from click.testing import CliRunner

import eom
from eom.__main__ import main
from eom.derivations import names

ROD = ("exercise", "inertia-of-rod", "--lines", "3")


def run(*words):
    return CliRunner().invoke(main, words)


def test_a_page_that_check_can_judge_and_its_key():
    page = run(*ROD, "--seed", "5")
    assert page.exit_code == 0
    assert page.stderr == ""
    verdicts = [f.verdict for f in eom.check(page.stdout).findings if f.kind == "display"]
    assert verdicts.count("wrong") == 1
    key = run(*ROD, "--seed", "5", "--key").stdout
    assert f"Line ({verdicts.index('wrong') + 1}) is false" in key
    assert "--seed 5" in key
    assert run(*ROD, "--seed", "5").stdout == page.stdout
    bare = run(*ROD, "--seed", "5", "--no-lexicon").stdout
    assert page.stdout.endswith(bare)
    assert bare.startswith("# Which line is false?")


def test_files(tmp_path):
    done = run(*ROD, "--count", "2", "--out", str(tmp_path / "sheets"))
    assert done.exit_code == 0
    written = sorted(p.name for p in (tmp_path / "sheets").iterdir())
    keys = [f"inertia-of-rod-{k}{tail}.md" for k in (0, 1) for tail in ("-key", "")]
    assert written == sorted([*keys, "inertia-of-rod-0-solutions.md"])
    sheet = (tmp_path / "sheets" / "inertia-of-rod-0-solutions.md").read_text(encoding="utf-8")
    assert sheet.count("* stands: $") == sheet.count("* right: $") == 2
    questions = run(*ROD, "--as", "moodle", "--count", "2", "--out", str(tmp_path))
    assert questions.exit_code == 0
    quiz = ET.fromstring((tmp_path / "inertia-of-rod-0.xml").read_text(encoding="utf-8"))
    assert len(quiz.findall("question[@type='multichoice']")) == 4


def test_json_is_one_document():
    done = run(*ROD, "--count", "2", "--json")
    assert done.stderr == ""
    first, second = json.loads(done.stdout)["exercises"]
    assert (first["seed"], second["seed"]) == (0, 1)
    key = first["key"]
    assert first["lines"][key["line"] - 1]["latex"] == key["is"] != key["should_be"]
    assert key["counterexample"]["sides"]
    assert first["page"] == run(*ROD).stdout


def test_the_list():
    shown = run("exercise", "--list").stdout
    topics = names()
    assert all(name in shown for name in topics)
    listed = json.loads(run("exercise", "--list", "--json").stdout)
    assert sorted(t["name"] for t in listed["topics"]) == sorted(topics)
    assert {"name": "sign", "words": "a sign is wrong (easy)"} in listed["slips"]


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        ((), "no topic"),
        (("point-mas",), "did you mean point-mass?"),
        (("point-mass", "--as", "modle"), "did you mean moodle?"),
        (("point-mass", "--count", "2"), "--out"),
        (("point-mass", "--key", "--as", "moodle"), "--key"),
        (("point-mass", "--json", "--out", "x"), "--json"),
        (("point-mass", "--slip", "sgn"), "did you mean sign?"),
        (("point-mass", "--difficulty", "esy"), "did you mean easy?"),
        (
            ("point-mass", "--difficulty", "easy", "--slip", "frame"),
            "a slip of the kind frame is hard",
        ),
        (("point-mass", "--carried", "4"), "0 to 3"),
        (("point-mass", "--carried", "1", "--as", "moodle"), "--carried is for pages"),
        (("inertia-of-rod", "--slip", "transpose"), "no line of this topic can have the slip"),
    ],
)
def test_options_that_cannot_be_used(words, reported, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused = run("exercise", *words)
    assert refused.exit_code == 2
    assert ("error" in refused.stdout) == ("--json" in words)
    assert reported in refused.stderr
    assert list(tmp_path.iterdir()) == []
