"""What is shipped: every file of the repository in the sdist, metadata, citation, forms for issues."""

import subprocess
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
FORMS = sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml"))
ALWAYS = {"pyproject.toml", "README.md", "LICENSE", ".gitignore"}
"""What the build backend puts into every sdist."""
LEFT_OUT = (".github/",)


def test_the_sdist_holds_every_file_of_the_repository():
    found = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if found.returncode != 0:
        pytest.skip("this is no repository")
    include = PROJECT["tool"]["hatch"]["build"]["targets"]["sdist"]["include"]
    kept = tuple(entry.strip("/") for entry in include)
    missing = [
        name
        for name in found.stdout.splitlines()
        if name not in ALWAYS
        and not name.startswith(LEFT_OUT)
        and not any(name == k or name.startswith(k + "/") for k in kept)
    ]
    assert missing == []


def test_metadata():
    project = PROJECT["project"]
    trove = pytest.importorskip("trove_classifiers")
    assert set(project["classifiers"]) <= set(trove.classifiers)
    assert not [c for c in project["classifiers"] if c.startswith("License ::")]
    assert (ROOT / "eom" / "py.typed").exists()
    assert (ROOT / "codegen" / "py.typed").exists()
    extras = project["optional-dependencies"]
    own = {
        n for row in extras["dev"] if row.startswith("eom-toolkit[") for n in row[12:-1].split(",")
    }
    assert own == set(extras) - {"dev", "bench"}
    assert metadata.version("eom-toolkit")


def test_the_citation_is_that_of_the_package():
    """The required keys of the citation file format 1.2.0, and what the package says of itself."""
    found = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert found["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= set(found)
    assert found["type"] == "software"
    assert str(found["version"]) == PROJECT["project"]["version"]
    assert found["license"] == PROJECT["project"]["license"]
    assert [a["name"] for a in found["authors"]] == [
        a["name"] for a in PROJECT["project"]["authors"]
    ]


@pytest.mark.skipif(not FORMS, reason="the sdist has no forms for issues")
def test_forms_for_issues():
    names = {f.stem for f in FORMS}
    assert names == {"bug", "config", "feature", "wrong_verdict"}
    for file in FORMS:
        form = yaml.safe_load(file.read_text(encoding="utf-8"))
        if file.stem == "config":
            continue
        assert form["name"]
        assert form["description"]
        fields = [f for f in form["body"] if f["type"] != "markdown"]
        ids = [f["id"] for f in fields]
        assert len(set(ids)) == len(ids)
        assert all(f["type"] in {"textarea", "input", "dropdown"} for f in fields)
        assert all(f["attributes"]["label"] for f in fields)
        required = [f["id"] for f in fields if f.get("validations", {}).get("required")]
        assert len(required) >= 2
        if file.stem != "feature":
            assert "version" in required


def test_the_verdicts_of_the_form_are_those_of_the_checker():
    if not FORMS:
        pytest.skip("the sdist has no forms for issues")
    from eom.checker.report.findings import ORDER

    file = ROOT / ".github" / "ISSUE_TEMPLATE" / "wrong_verdict.yml"
    form = yaml.safe_load(file.read_text(encoding="utf-8"))
    (verdict,) = (f for f in form["body"] if f.get("id") == "verdict")
    options = " ".join(verdict["attributes"]["options"])
    assert [v for v in ORDER if v != "holds under" and v not in options] == []
