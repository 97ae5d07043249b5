"""Foreign code in files: run apart, within limits, and compared; nothing is left behind."""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from codegen.native import native
from eom.commands import black_box, code_checking
from eom.commands.code_checking import check_code, data_of, text_of
from eom.errors import InputError

RIGHT = """
def f(t, y, p):
    w1, w2, w3 = y
    I1, I2, I3 = p
    return [(I2 - I3) * w2 * w3 / I1, (I3 - I1) * w3 * w1 / I2, (I1 - I2) * w1 * w2 / I3]
"""
SCIPY = """
I1, I2, I3 = 1.5e-4, 4.0e-4, 5.2e-4
def f(t, y):
    w1, w2, w3 = y
    return [(I2 - I3) * w2 * w3 / I1, (I3 - I1) * w3 * w1 / I2, (I1 + I2) * w1 * w2 / I3]
"""
IN_C = """
void f(double t, const double *y, const double *p, double *dy) {
  dy[0] = (p[1] - p[2]) * y[1] * y[2] / p[0];
  dy[1] = (p[2] - p[0]) * y[2] * y[0] / p[1];
  dy[2] = @;
}
"""


@pytest.fixture
def checked(tmp_path, monkeypatch):
    """Check a source text; the folder of temporary files must be empty afterwards."""
    private = tmp_path / "tmp"
    private.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(private))

    def check(text, suffix=".py", **options):
        file = tmp_path / f"code{suffix}"
        file.write_text(text)
        try:
            return check_code(f"{file}:f", "t-handle", **options)
        finally:
            assert list(private.iterdir()) == []
            assert sorted(p.name for p in tmp_path.iterdir()) == [f"code{suffix}", "tmp"]

    return check


def test_right_code_in_python(checked):
    report = checked(RIGHT)
    assert report.is_right
    assert text_of(report).splitlines()[:2] == ["y = omega_1, omega_2, omega_3", "p = I1, I2, I3"]


def test_a_missing_term_is_named(checked):
    report = checked(RIGHT.replace("(I2 - I3) * w2 * w3 / I1", "0"))
    assert not report.is_right
    assert "missing term omega_2*omega_3*(I2 - I3)/I1 in output 0" in text_of(report)
    assert json.loads(json.dumps(data_of(report)))["mistakes"][0]["output"] == 0


def test_numbers_that_are_built_in(checked):
    report = checked(SCIPY)
    assert [m.output for m in report.mistakes] == [2]
    assert checked(SCIPY.replace("I1 + I2", "I1 - I2")).is_right


@pytest.mark.skipif(not native.compiler(), reason="no C compiler")
def test_code_in_c(checked):
    assert checked(IN_C.replace("@", "(p[0] - p[1]) * y[0] * y[1] / p[2]"), ".c").is_right
    report = checked(IN_C.replace("@", "(p[1] - p[0]) * y[0] * y[1] / p[2]"), ".c")
    assert [m.text for m in report.mistakes] == ["output 2 has the wrong sign"]
    with pytest.raises(InputError, match="does not compile"):
        checked("void g(void) {}", ".c")
    with pytest.raises(InputError, match="ended with an error"):
        checked(IN_C.replace("@", "*(volatile double *)0"), ".c")


@pytest.mark.sparse(1)
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("def f(t, y, p):\n    while True: pass", "too long"),
        ("def f(t, y, p):\n    return bytearray(10**11)", "fails at a point"),
        ("def f(t, y, p):\n    return [y[7]]", "fails at a point"),
        ("def g(t, y, p): pass", "cannot be run"),
        ("import os\nos._exit(3)", "exit status 3"),
        ("raise SystemExit", "cannot be run"),
        ("def f(t, y, p):\n    return [1.0]", "number of rates"),
        ("def f(", "cannot be run"),
        ("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)", "SIGSEGV"),
        ("open('big', 'wb').write(bytes(10**9))", "cannot be run|SIGXFSZ"),
    ],
)
def test_code_that_cannot_be_run_is_one_clear_error(checked, text, message):
    with pytest.raises(InputError, match=message):
        checked(text, seconds=2)


@pytest.fixture(params=["namespace", "plain"])
def place(request, monkeypatch):
    """Both ways to end what code has started: a namespace of its own, and orphans that are adopted."""
    monkeypatch.setattr(code_checking, "PLACE", request.param)
    return request.param


needs_proc = pytest.mark.skipif(not Path("/proc/self").exists(), reason="reads /proc")
NOTE = """
import os, signal, sys, time
def note(path=@):
    with open(path, "a") as file:
        file.write(os.readlink("/proc/self") + "\\n")  # the number outside of any namespace
"""
CHILDREN = {
    "of its own session": "if not os.fork():\n    os.setsid(); note(); time.sleep(60)\n",
    "twice forked": (
        "if not os.fork():\n    os.setsid()\n"
        "    if not os.fork():\n        note(); time.sleep(60)\n    os._exit(0)\n"
    ),
    "deaf": (
        "if not os.fork():\n    os.setsid()\n    for s in set(signal.Signals) - {9, 19}:\n"
        "        signal.signal(s, signal.SIG_IGN)\n    note(); time.sleep(60)\n"
    ),
    "stopped": "if not os.fork():\n    note(); os.kill(os.getpid(), signal.SIGSTOP)\n",
    "multiplying": (
        "if not os.fork():\n    os.setsid(); note()\n    for k in range(20):\n"
        "        time.sleep(0.02)\n        if not os.fork():\n            os.setsid(); note()\n"
        "            if k > 4:\n                time.sleep(60)\n    time.sleep(60)\n"
    ),
}  # fmt: skip


def is_gone(number):
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


def left(note):
    """Numbers of the processes that a note names and that are still there."""
    return [n for n in note.read_text().split() if not is_gone(n)]


@pytest.mark.sparse(2)
@needs_proc
@pytest.mark.parametrize("kind", [k for k in CHILDREN if k != "multiplying"])
def test_no_process_survives_the_command(checked, capfd, tmp_path_factory, place, kind):
    note = tmp_path_factory.mktemp("notes") / "children"
    begin = NOTE.replace("@", repr(str(note))) + CHILDREN[kind]
    waits = (
        f"print('noise', flush=True)\nwhile not os.path.exists({str(note)!r}): time.sleep(0.01)\n"
    )
    assert checked(f"{begin}{waits}{RIGHT}").is_right
    assert capfd.readouterr().out == ""
    assert note.read_text().split()
    assert left(note) == []


@pytest.mark.sparse(only=("plain",))
@needs_proc
def test_code_that_multiplies_is_ended_with_all_that_it_became(checked, tmp_path_factory, place):
    """Two hundred processes at most, should nothing stop them; the warden allows fewer at one time."""
    note = tmp_path_factory.mktemp("notes") / "children"
    begin = NOTE.replace("@", repr(str(note)))
    many = (
        "for k in range(200):\n    if not os.fork():\n        os.setsid(); note(); time.sleep(60)\n"
    )
    with pytest.raises(InputError, match=r"too many processes|cannot be run"):
        checked(f"{begin}{many}time.sleep(60)\n{RIGHT}")
    assert left(note) == []
    with pytest.raises(InputError, match=r"takes too long|too many processes"):
        checked(f"{begin}{CHILDREN['multiplying']}time.sleep(60)\n{RIGHT}", seconds=1)
    assert left(note) == []


def namespaces():
    """Whether a process of this user may make one."""
    flags = black_box.NEW_USER | black_box.NEW_PID
    code = f"import ctypes, sys; sys.exit(ctypes.CDLL(None).unshare({flags}) != 0)"
    return subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@needs_proc
def test_code_that_ends_its_warden_gets_no_result(checked, place):
    """It cannot reach one that stands outside of its namespace; elsewhere that is reported as it is."""
    begin = "import os, signal\nos.kill(os.getppid(), signal.SIGKILL)\n"
    if place == "namespace":
        if not namespaces():
            pytest.skip("no namespaces are allowed here")
        reported = checked(
            "import os\n"
            + RIGHT.replace("w1, w2, w3 = y", "os.getppid() == 1 or 1 / 0; w1, w2, w3 = y")
        )
        assert reported.is_right  # the warden is the first process there
        assert checked(begin + RIGHT).is_right
        return
    with pytest.raises(InputError, match="ended its warden"):
        checked(begin + RIGHT)


FORGED = {
    "deep": "'[' * 1_000_000", "no JSON": "'rows'", "a list": "'[1, 2]'", "null": "'null'",
    "few rows": """'{"rows": [[1, 2, 3]], "arguments": 3}'""",
    "words": """'{"rows": ' + str([["a"] * 3] * 24).replace("'", '"') + ', "arguments": 3}'""",
    "truths": """'{"rows": [' + '[true, 1, 2], ' * 23 + '[1, 2, 3]], "arguments": 3}'""",
    "huge numbers": """'{"rows": ' + str([[10**400] * 3] * 24) + ', "arguments": 3}'""",
    "long numbers": """'{"rows": [[' + '9' * 10**6 + ']], "arguments": 3}'""",
    "arguments": """'{"rows": ' + str([[1, 2, 3]] * 24) + ', "arguments": [3]}'""",
    "long": """'{"rows": [' + '1,' * 10**7 + '1]}'""",
    "surrogates": """'{"rows": "\\\\ud800"}'""",
}  # fmt: skip
FORGERY = """
import os, sys
open(sys.argv[-1], "w").write(@)
os._exit(0)
"""


@pytest.mark.sparse(4)
@pytest.mark.parametrize("forged", FORGED)
def test_a_forged_answer_is_no_result(checked, forged):
    with pytest.raises(InputError, match="ended without a result"):
        checked(FORGERY.replace("@", FORGED[forged]))


@pytest.mark.parametrize(
    "instead",
    [
        "os.mkfifo(f)",
        "os.mkdir(f)",
        "os.symlink('/dev/zero', f)",
        "os.symlink('/etc/passwd', f)",
        "0",
    ],
)
def test_what_stands_in_place_of_an_answer_is_not_read(checked, instead):
    begin = "import os, sys\nf = sys.argv[-1]\n"
    with pytest.raises(InputError, match="ended without a result"):
        checked(f"{begin}{instead}\nos._exit(0)\n")


def test_words_of_foreign_code_do_not_steer_the_terminal(checked):
    with pytest.raises(InputError) as caught:
        checked("raise ValueError('\\x1b[2J\\ud800\\n' * 200)")
    assert caught.value.got.isprintable()
    assert len(caught.value.got) <= 300


def test_rates_that_are_no_finite_numbers_are_wrong(checked):
    for value in ("float('nan')", "float('inf')", "1e308 * 10"):
        assert not checked(RIGHT.replace("(I2 - I3) * w2 * w3 / I1", value)).is_right


@pytest.mark.slow
@pytest.mark.skipif(not native.compiler(), reason="no C compiler")
@pytest.mark.parametrize(
    "text",
    [
        '#include "/dev/zero"\n',
        "#define A(x) x x x x x x x x\n#define B(x) A(A(A(A(x))))\nB(B(B(B(int x;))))\n",
        "static char big[1L << 40] = {1};\n",
    ],
)
def test_a_text_that_would_keep_a_compiler_busy_for_ever_is_one_clear_error(checked, text):
    with pytest.raises(InputError, match=r"takes too long|was ended|does not compile"):
        checked(text, ".c", seconds=3)


@pytest.mark.parametrize(
    "target",
    ["code.py", "code.py:f g", "code.txt:f", "nowhere.py:f", ":f", "a.py:__import__('os')"],
)
def test_bad_targets(target, tmp_path):
    with pytest.raises(InputError):
        check_code(str(Path(tmp_path, target)), "t-handle")
