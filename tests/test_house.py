"""How large the product is and how it hangs together: no figure gets worse."""

import codegen
import eom
from benchmarks import house


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
    assert house.circles(house.of_folders(found, edges)) == [["eom", "eom.c"]]
    assert [m.code for m in found] == [0, 2, 3, 0, 2]
    assert house.function_lengths(found) == [3]


def test_packages_show_their_public_names_alone():
    for package in (codegen, eom):
        assert dir(package) == sorted(package.__all__)
        assert all(hasattr(package, name) for name in package.__all__)
