"""How large the product is and how it hangs together: no figure gets worse."""

import ast
import dataclasses
import importlib
import re
from fnmatch import fnmatchcase
from functools import cache

import pytest

import codegen
import eom
from benchmarks import house


@pytest.mark.slow
def test_no_figure_of_the_house_gets_worse():
    found = house.figures()
    exceeded = {n: (found[n], most) for n, most in house.LIMITS.items() if found[n] > most}
    assert not exceeded, "lower the figure, or say in the commit why it has to grow"


def test_circles_are_the_strongly_connected_components():
    edges = {"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": {"e"}, "e": {"d"}, "f": {"a", "f"}}
    assert house.circles(edges) == [["a", "b", "c"], ["d", "e"]]
    chain = {str(k): {str(k + 1)} for k in range(3000)} | {"3000": {"0"}}
    assert [len(c) for c in house.circles(chain)] == [3001]


def test_every_import_counts_and_texts_do_not(tmp_path):
    """Late imports, those for types alone, relative ones; of a line what is no docstring or comment."""
    files = {
        "eom/__init__.py": "",
        "eom/a.py": '"""Text.\n\nMore.\n"""\n\ndef f():\n    """Text."""\n    from eom import b\n',
        "eom/b.py": "# nothing\nimport typing\nif typing.TYPE_CHECKING:\n    from .c.d import e\n",
        "eom/c/__init__.py": "",
        "eom/c/d.py": "from ..a import f\ne = f\n",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    found = house.modules(tmp_path)
    edges = house.graph(found)
    assert edges == {
        "eom": set(), "eom.a": {"eom.b"}, "eom.b": {"eom.c.d"}, "eom.c": set(), "eom.c.d": {"eom.a"},
    }  # fmt: skip
    assert house.circles(edges) == [["eom.a", "eom.b", "eom.c.d"]]
    assert house.circles(house.of_folders(found, edges)) == [["eom.a", "eom.b", "eom.c"]]
    assert [m.code for m in found] == [0, 2, 3, 0, 2]
    assert house.function_lengths(found) == [2]


def test_private_names_of_other_modules_are_found_by_import_and_as_attributes():
    text = "from eom import a\nfrom eom.b import _c, d as e\nfrom os import _exit\n"
    text += "a._f()\ne._g\na.__doc__\nself._h\n"
    module = house.Module("eom.x", False, text)
    assert sorted(module.private_names()) == ["eom.a._f", "eom.b._c", "eom.b.d._g"]


def test_packages_show_their_public_names_alone():
    for package in (codegen, eom):
        more = codegen.__all__ if package is eom else []  # one import is enough
        assert dir(package) == sorted([*package.__all__, *more])
        assert all(hasattr(package, name) for name in package.__all__)


FOUND = house.modules()
CONTRACTS = {m.name: ast.get_docstring(ast.parse(m.text)) or "" for m in FOUND if m.is_folder}


def named(contract):
    """What a folder says that it imports: stages, or all of a package."""
    *_, last = contract.rpartition("Imports: ")
    return re.findall(r"`([a-z_.]+\*?)`", last.partition(".\n\n")[0])


def test_each_folder_imports_what_its_contract_names_and_no_other():
    """The docstring of a folder says what comes in, what goes out, and what it may import."""
    wrong = {}
    for folder, imported in house.of_folders(FOUND, house.graph(FOUND)).items():
        if folder in CONTRACTS:
            may = named(CONTRACTS[folder])
            beyond = [n for n in imported if not any(fnmatchcase(n, m) for m in may)]
            in_vain = [m for m in may if not any(fnmatchcase(n, m) for n in imported)]
            if beyond or in_vain:
                wrong[folder] = {"imports beyond its contract": beyond, "named in vain": in_vain}
    assert wrong == {}
    assert [f for f, text in CONTRACTS.items() if "Imports: " not in text and "." in f] == []


def test_a_contract_is_ten_lines_at_most():
    folders = {f: c.partition("\n>>>")[0].splitlines() for f, c in CONTRACTS.items()}
    assert {f: len(lines) for f, lines in folders.items() if len(lines) > 10} == {}


@cache
def is_there(name):
    """Whether a dotted name is a module, or an attribute or a field of what it begins with."""
    home, _, last = name.rpartition(".")
    if not home:
        return True
    try:
        importlib.import_module(name)
    except ImportError:
        try:
            found = importlib.import_module(home)
        except ImportError:
            found = getattr(importlib.import_module(home.rpartition(".")[0]), home.split(".")[-1])
        fields = dataclasses.fields(found) if dataclasses.is_dataclass(found) else ()
        return hasattr(found, last) or last in {f.name for f in fields}
    return True


TEXTS = [
    f
    for part in (
        "eom",
        "codegen",
        "benchmarks",
        "docs",
        "README.md",
        "CONTRIBUTING.md",
        "CHANGELOG.md",
    )
    for f in ([house.ROOT / part] if "." in part else sorted((house.ROOT / part).rglob("*")))
    if f.suffix in {".py", ".md", ".c", ".h", ".mjs"}
]


def test_names_in_texts_exist():
    """What stands between backticks in docstrings, comments and documents: a move forgets none of it."""
    named = {
        (str(f.relative_to(house.ROOT)), name)
        for f in TEXTS
        for name in re.findall(r"`((?:eom|codegen)(?:\.\w+)+)`", f.read_text(encoding="utf-8"))
    }
    assert len(named) > 300
    assert [place for place in sorted(named) if not is_there(place[1])] == []


@pytest.mark.parametrize("name", ["codegen.compiled", "codegen.nobody", "codegen.Result.nothing"])
def test_a_name_that_moved_is_seen(name):
    assert not is_there(name)
