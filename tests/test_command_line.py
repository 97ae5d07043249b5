"""What all commands have in common: completion, JSON, colours, exit status, something that moves."""

import json
import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import click
import numpy as np
import pytest
from click.shell_completion import ShellComplete
from click.testing import CliRunner

from eom import derivations
from eom.__main__ import INTERRUPTED, UNUSABLE, Commands, main
from eom.commands import shared
from eom.commands.completing import SHELLS, VARIABLE, WORDS
from eom.errors import InputError
from eom.scenes import catalogue

COLOUR = re.compile(r"\x1b\[[0-9;]*(3[0-8]|4[0-8]|9[0-7]|10[0-7])[;0-9]*m")


def run(*words):
    return CliRunner().invoke(main, words)


# -- completion ----------------------------------------------------------------------------------------


def completed(*words, start=""):
    made = ShellComplete(main, {}, "eom", VARIABLE)
    return [c.value for c in made.get_completions(list(words), start) if c.type == "plain"]


@pytest.mark.parametrize(
    ("words", "start", "found"),
    [
        ((), "der", ["derive"]),
        (("derive",), "eul", ["euler-equations"]),
        (("derive",), "double", ["double-pendulum"]),
        (("simulate",), "t-handle-", ["t-handle-in-angles"]),
        (("simulate", "t-handle", "--method"), "DOP", ["DOP853"]),
        (("derive", "point-mass", "--notation"), "k", ["kane"]),
        (("check", "--notation"), "schaub", ["schaub-junkins"]),
        (("exercise",), "gyro", ["gyrostat"]),
        (("exercise", "gyrostat", "--slip"), "tr", ["transpose"]),
        (("generate", "t-handle", "--target"), "java", ["javascript"]),
        (("linearize",), "heavy", ["heavy-top"]),
        (("simulate", "t-handle"), "--js", ["--json"]),
    ],
)
def test_words_are_completed(words, start, found):
    assert completed(*words, start=start) == found


def test_every_scene_and_derivation_is_offered():
    assert completed("simulate") == catalogue.names()
    assert completed("derive") == [*catalogue.names(), *derivations.names()]


def test_rows_of_the_table_are_parameters_of_commands():
    known = {(name, p.name) for name, c in main.commands.items() for p in c.params}
    assert {w for w in WORDS if w[0]} <= known
    assert {w[1] for w in WORDS} <= {p for _, p in known}


def test_names_are_completed_without_heavy_packages():
    code = (
        "import os, sys\n"
        "os.environ.update(_EOM_COMPLETE='bash_complete', COMP_WORDS='eom derive eu', COMP_CWORD='2')\n"
        "from eom.__main__ import main\n"
        "try:\n    main(prog_name='eom')\nexcept SystemExit:\n    pass\n"
        "print(*sorted({'sympy', 'numpy', 'rich', 'pydantic'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                          timeout=60)  # fmt: skip
    assert done.stdout == "plain,euler-equations\nfile,eu\n\n"


@pytest.mark.parametrize("shell", SHELLS)
def test_scripts(shell, tmp_path):
    script = run("completion", shell)
    assert script.exit_code == 0
    assert VARIABLE in script.stdout
    if shutil.which(shell):
        file = tmp_path / "script"
        file.write_text(script.stdout, encoding="utf-8")
        subprocess.run([shell, "-n", str(file)], check=True, timeout=60)
    assert "did you mean bash or zsh?" in run("completion", "bsh").stderr


# -- JSON ----------------------------------------------------------------------------------------------


def test_list_as_json():
    found = json.loads(run("list", "--json").stdout)
    assert [s["name"] for s in found["scenes"]] == catalogue.names()
    assert [d["name"] for d in found["derivations"]] == derivations.names()
    assert all(row["title"] for row in (*found["scenes"], *found["derivations"]))


def test_simulate_as_json(tmp_path):
    file = tmp_path / "x.csv"
    done = run("simulate", "t-handle", "--points", "5", "--json", "--out", str(file))
    assert done.exit_code == 0
    found = json.loads(done.stdout)
    assert done.stderr.startswith(f"wrote {file}")
    header, *rows = file.read_text(encoding="utf-8").splitlines()
    table = np.array([[float(x) for x in row.split(",")] for row in rows]).T
    assert found["t"] == list(table[0])
    assert list(found["states"]) == header.split(",")[1:4]
    assert [*found["states"].values()] == table[1:4].tolist()
    assert found["status"] == 0
    assert found["drift"]["T"]["relative"] < 1e-12


def test_the_longest_step_is_that_of_the_option_and_of_the_scene():
    words = ("simulate", "t-handle", "--method", "DOP853", "--t-end", "1", "--json")
    steps = [
        json.loads(run(*words, *more).stdout)["steps"] for more in ((), ("--max-step", "0.01"))
    ]
    assert steps[0] < 50
    assert 100 <= steps[1] <= 103
    refused = run(*words, "--max-step", "0")
    assert refused.exit_code == 2
    assert "--max-step" in refused.stderr


def test_a_run_that_stops_early_says_so_in_json():
    done = run("simulate", "t-handle", "--method", "DOP853", "--max-steps", "3", "--json")
    assert done.exit_code == 1
    assert json.loads(done.stdout)["status"] == -1


def test_bench_and_stress_as_json(monkeypatch):
    """What is measured takes long; here the checks and problems are none."""
    from codegen.measure.stress import checks

    monkeypatch.setattr(checks, "chosen", lambda names: ())
    monkeypatch.setattr("eom.commands.stressing._material", lambda: None)
    done = run("stress", "--quick", "--json")
    assert json.loads(done.stdout)["checks"] == []
    monkeypatch.setattr("eom.commands.benching._chosen", lambda names, everything, t_end: [])
    done = run("bench", "t-handle", "--methods", "DOP853", "--json")
    assert json.loads(done.stdout) == {"problems": []}


def test_numbers_that_json_has_not():
    assert shared.finite([1, math.inf, [math.nan, 2.5]]) == [1.0, None, [None, 2.5]]
    assert shared.finite(np.float64(2)) == 2.0


def test_every_command_that_computes_has_json():
    computing = {"list", "accuracy", "simulate", "ensemble", "linearise", "check", "convert", "bench",
                 "stress", "exercise"}  # fmt: skip
    assert {
        n for n in computing if not any("--json" in p.opts for p in main.commands[n].params)
    } == set()


# -- colours -------------------------------------------------------------------------------------------


def in_terminal(*words, **environment):
    """Return what a command writes to a terminal of 100 columns."""
    pty = pytest.importorskip("pty")
    kept = {k: v for k, v in os.environ.items() if k not in {"NO_COLOR", "FORCE_COLOR", "CI"}}
    leader, follower = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "eom", *words], stdout=follower, stderr=follower, stdin=follower,
        env={**kept, "TERM": "xterm-256color", "COLUMNS": "100", **environment},
    )  # fmt: skip
    os.close(follower)
    shown = b""
    while True:
        try:
            part = os.read(leader, 65536)
        except OSError:
            break
        if not part:
            break
        shown += part
    os.close(leader)
    process.wait(timeout=60)
    return shown.decode("utf-8")


WRONG = ("check", r"I_1\dot\omega_1 = (I_3 - I_2)\omega_2\omega_3 + T_1", "--notation", "kane")


@pytest.mark.slow
def test_colours_in_a_terminal_and_none_with_no_color():
    assert COLOUR.search(in_terminal(*WRONG))
    assert COLOUR.search(in_terminal(*WRONG, NO_COLOR="1")) is None
    assert COLOUR.search(in_terminal("list", NO_COLOR="1")) is None


@pytest.mark.parametrize(
    "words",
    [
        WRONG,
        ("list",),
        ("simulate", "t-handle", "--points", "2"),
        ("convert", "--angles", "30,10,0"),
    ],
)
def test_no_escapes_where_no_terminal_reads(words):
    done = run(*words)
    assert "\x1b" not in done.output
    assert done.exit_code in {0, 1}


# -- exit status ----------------------------------------------------------------------------------------


def raising(error):
    @click.group(cls=Commands)
    def group():
        pass

    @group.command()
    def fail():
        raise error

    return CliRunner().invoke(group, ["fail"])


@pytest.mark.parametrize(
    ("error", "status", "reported"),
    [
        (InputError("bad", hint="worse"), UNUSABLE, "error: bad"),
        (FileNotFoundError(2, "No such file"), UNUSABLE, "error: No such file"),
        (KeyboardInterrupt(), INTERRUPTED, "interrupted"),
    ],
)
def test_exit_status(error, status, reported):
    done = raising(error)
    assert done.exit_code == status
    assert done.stderr.startswith(reported)
    assert done.stdout == ""


@pytest.mark.parametrize("command", sorted(main.commands))
def test_unknown_options_are_unusable_input(command):
    done = run(command, "--no-such-option")
    assert done.exit_code == UNUSABLE
    assert done.stdout == ""


def test_the_help_says_what_the_exit_status_means():
    text = " ".join(run("--help").stdout.split())
    assert "0 done; 1 the run stopped before its end, or something is wrong; 2 unusable" in text
    assert "130 interrupted" in text
    assert "NO_COLOR" in text


# -- something that moves --------------------------------------------------------------------------------


def test_waiting_shows_nothing_where_no_terminal_reads(capsys):
    with shared.waiting_for("a long work"):
        print("a result")
    assert capsys.readouterr() == ("a result\n", "")


WAITS = """
import time
from eom.commands import shared
shared.QUIET_SECONDS = {quiet}
with shared.waiting_for("a long work") as show:
    time.sleep({work} / 2)
    shared.compiling(show)("lowering", 0.25)
    time.sleep({work} / 2)
print("done")
"""


@pytest.mark.sparse(only=("60.0-0.0-False",))
@pytest.mark.parametrize(("quiet", "work", "shown"), [(0.0, 2.0, True), (60.0, 0.0, False)])
def test_waiting_in_a_terminal(quiet, work, shown, tmp_path):
    package = tmp_path / "eom_waits.py"
    package.write_text(WAITS.format(quiet=quiet, work=work), encoding="utf-8")
    pty = pytest.importorskip("pty")
    leader, follower = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, str(package)], stdout=subprocess.PIPE, stderr=follower,
        env={**os.environ, "TERM": "xterm", "PYTHONPATH": os.pathsep.join([str(Path.cwd()), *sys.path])},
    )  # fmt: skip
    os.close(follower)
    out = process.communicate(timeout=60)[0]
    reported = b""
    while True:
        try:
            part = os.read(leader, 65536)
        except OSError:
            break
        if not part:
            break
        reported += part
    os.close(leader)
    assert out == b"done\n"
    assert (b"a long work" in reported) == shown
    assert (b"compiling: lowering 25%" in reported) == shown
