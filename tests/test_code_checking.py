"""Foreign code in files: run apart, within limits, and compared; nothing is left behind."""

import json
import tempfile
import time
from pathlib import Path

import pytest

from codegen import native
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


def test_what_is_printed_goes_nowhere_and_children_end(checked, capfd, tmp_path_factory):
    note = tmp_path_factory.mktemp("notes") / "child"
    child = f"import os, time\nif not os.fork():\n    open({str(note)!r}, 'w').write(str(os.getpid()))\n"
    waits = "    print('noise', flush=True)\n    time.sleep(60)\ntime.sleep(0.3)\n"
    assert checked(f"{child}{waits}{RIGHT}").is_right
    assert capfd.readouterr().out == ""
    stat = Path(f"/proc/{note.read_text()}/stat")
    for _ in range(100):
        if not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] == "Z":
            break
        time.sleep(0.02)
    else:
        pytest.fail("a child of the code is still there")


@pytest.mark.parametrize(
    "target",
    ["code.py", "code.py:f g", "code.txt:f", "nowhere.py:f", ":f", "a.py:__import__('os')"],
)
def test_bad_targets(target, tmp_path):
    with pytest.raises(InputError):
        check_code(str(Path(tmp_path, target)), "t-handle")
