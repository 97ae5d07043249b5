"""Every option and argument of every command, from the tree of commands, given what it cannot be."""

import tomllib
import warnings

import click
import pytest
from click.testing import CliRunner

from eom.__main__ import main
from tests.hostile_calls import Unending, within

LONGEST = 60.0
"""Seconds for one command; most take a tenth of one."""

SCENE = """
outputs = ["omega_1"]
[body]
moments = [1.0, 2.0, 2.5]
[initial]
omega_1 = 1
omega_2 = 0.1
omega_3 = 0
[integration]
t_end = 0.5
points = 3
max_steps = 300
"""
TREE = """
model = "tree"
gravity = [0, 0, "-g"]
outputs = ["q_hinge"]
[parameters]
g = 9.81
[bodies.bob]
mass = 1
centre = [0, 0, -1]
moments = [1, 1, 1]
[joints.hinge]
kind = "revolute"
parent = "ground"
child = "bob"
axis = "x"
[initial]
q_hinge = 0.1
[integration]
t_end = 0.5
points = 3
max_steps = 300
"""
SAMPLES = """
count = 3
seed = 0
[values]
omega_1 = { normal = [1.0, 0.1] }
"""

RIGHT = {
    "list": (),
    "derive": ("{scene}",),
    "generate": ("{scene}", "--out", "{out}", "--target", "numpy"),
    "accuracy": ("{scene}", "--samples", "1", "--target", "numpy"),
    "simulate": ("{scene}", "--target", "numpy", "--method", "scipy:RK45"),
    "run": ("{scene}", "--target", "numpy", "--out", "{out}"),
    "ensemble": ("{scene}", "--vary", "omega_1=grid(1,2,2)", "--points", "2"),
    "linearise": ("{tree}", "--target", "numpy", "--starts", "2"),
    "analyse": ("{tree}", "--small", "1"),
    "check": ("{note}", "--jobs", "1"),
    "convert": ("--quaternion", "1,0,0,0"),
    "bench": ("nobody",),
    "stress": ("nobody",),
    "animate": ("{scene}", "--out", "{file}.html", "--seconds", "0.1", "--target", "numpy"),
    "live": ("{scene}", "--out", "{file}.html"),
    "plot": ("{scene}", "--out", "{file}.html", "--points", "10"),
    "exercise": ("point-mass",),
    "completion": ("bash",),
}  # fmt: skip
"""Right arguments of each command, cheap ones; the two that measure for minutes end at a wrong name."""
SAME = {"linearize": "linearise"}

TEXTS = ("", "x", "1e400", "a=1:0:-1", "\udcff", "a\x1b[2J", "{folder}", "{empty}", "{binary}")
NUMBERS = ("", "nan", "inf", "-1", "0", "1e300", "9" * 400)
COUNTS = ("1.5", "-1", "0", "1000000000000", "9" * 400)
PLACES = ("", "{folder}", "{empty}/x.csv", "{folder}/\udcff.csv", "x" * 5000, "{folder}/x.npz")
KINDS = {"float": NUMBERS, "float range": NUMBERS, "integer": COUNTS, "integer range": COUNTS}
"""What is given, by the type of a parameter; texts to every other."""
LONG = {("ensemble", "count")}
"""Where huge numbers are right, and take as long as they say."""


def parameters():
    for name, command in main.commands.items():
        for parameter in () if name in SAME else command.params:
            if not getattr(parameter, "is_flag", False):
                yield pytest.param(name, parameter, id=f"{name}-{parameter.name}")


@pytest.fixture(scope="module")
def places(tmp_path_factory):
    """Files and folders by the words of the tables above."""
    folder = tmp_path_factory.mktemp("hostile")
    texts = {"scene.toml": SCENE, "tree.toml": TREE, "note.tex": "$\\vec H = \\vec H$", "empty": ""}
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "binary").write_bytes(bytes(range(256)) * 4)
    (folder / "unreadable").write_bytes(b"\xff\xfe\x00[")
    (folder / "unreadable").chmod(0)
    found = {name.partition(".")[0]: folder / name for name in (*texts, "binary", "unreadable")}
    return {**found, "folder": folder, "out": folder / "out", "file": folder / "page"}


def run(words, places):
    """The result of a command; what is no ordinary end of it fails."""
    filled = [w.format(**places) if "{" in w else w for w in words]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            with within(LONGEST):
                done = CliRunner().invoke(main, filled)
        except Unending:
            pytest.fail(f"no end: eom {' '.join(filled)[:200]!r}")
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        pytest.fail(f"eom {' '.join(filled)[:200]!r}: {done.exception!r}")
    assert done.exit_code in {0, 1, 2}, filled
    if done.exit_code == 2:
        said = done.stderr.lower()
        assert said.strip(), filled
        assert said.count("error:") <= 1, (filled, said)
        assert "traceback" not in said
    return done


def words_with(name, parameter, value):
    """The words of a command with one parameter put to a value."""
    right = list(RIGHT[SAME.get(name, name)])
    if isinstance(parameter, click.Argument):
        first = right and not right[0].startswith("-")
        return [name, *right[1 if first else 0 :], "--", value]
    option = parameter.opts[-1]
    if option in right:
        place = right.index(option)
        right[place : place + 2] = []
    return [name, *right, f"{option}={value}"]


@pytest.mark.slow
def test_every_command_has_right_arguments(places):
    assert {SAME.get(name, name) for name in main.commands} == set(RIGHT)
    for name, words in RIGHT.items():
        wrong = "nobody" in words
        assert run([name, *words], places).exit_code == (2 if wrong else 0), name


@pytest.mark.sparse(8)
@pytest.mark.parametrize(("name", "parameter"), [*parameters()])
def test_whatever_an_option_is_there_is_one_message(name, parameter, places, monkeypatch):
    monkeypatch.chdir(places["folder"])
    is_place = isinstance(parameter.type, click.Path)
    values = PLACES if is_place else KINDS.get(parameter.type.name, TEXTS)
    for value in values[: 3 if (name, parameter.name) in LONG else None]:
        run(words_with(name, parameter, value), places)


# --- files of the wrong shape -----------------------------------------------------------------------


VALUES = ("-1", "nan", '"x"', "true", "[1]", "{ a = 1 }", '[["x"]]', "1979-05-27", "1000000000000",
          "9999999999999999999999", '"\\u0000"')  # fmt: skip


def toml(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return repr(value).lower() if isinstance(value, bool) else repr(value)


def changed(data, path, text):
    """TOML of tables in which the value at a path is a text of TOML."""
    if not path:
        return text
    parts = {k: changed(v, path[1:], text) if k == path[0] else toml(v) for k, v in data.items()}
    return "{ " + ", ".join(f"{k} = {v}" for k, v in parts.items()) + " }"


def paths(data, before=()):
    for key, value in data.items():
        yield (*before, key)
        if isinstance(value, dict):
            yield from paths(value, (*before, key))


@pytest.mark.sparse(only=("tree", "samples"))
@pytest.mark.parametrize(
    ("text", "words"),
    [
        (SCENE, ["simulate", "{given}", "--target=numpy"]),
        (TREE, ["derive", "{given}"]),
        (SAMPLES, ["ensemble", "{scene}", "--points=2", "--samples", "{given}"]),
    ],
    ids=["scene", "tree", "samples"],
)
def test_each_key_of_a_file_may_be_anything(text, words, places):
    data = tomllib.loads(text)
    file = places["folder"] / "given.toml"
    refused = 0
    for path in paths(data):
        for value in VALUES:
            rest = {k: v for k, v in data.items() if k != path[0]}
            lines = [f"{k} = {toml(v)}" for k, v in rest.items()]
            lines += [f"{path[0]} = {changed(data[path[0]], path[1:], value)}"]
            file.write_text("\n".join(lines), encoding="utf-8")
            tomllib.loads(file.read_text(encoding="utf-8"))
            refused += run(words, {**places, "given": file}).exit_code == 2
    assert refused > len(VALUES)
