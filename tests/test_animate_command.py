"""`eom animate`: files that are whole or not there, and one clear message."""

import pytest
from click.testing import CliRunner

from eom.__main__ import main

PLATE = """
title = "Plate"
[body]
moments = [1.0, 2.0, 2.5]
[initial]
omega_1 = 0.4
omega_2 = 1.0
omega_3 = 0.5
[integration]
t_end = {t_end}
"""


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plate.toml").write_text(PLATE.format(t_end=2.0), encoding="utf-8")
    (tmp_path / "fast.toml").write_text(PLATE.format(t_end=1e6), encoding="utf-8")

    def called(*arguments):
        result = CliRunner().invoke(main, ["animate", *arguments, "--target", "numpy"])
        return result, sorted(p.name for p in tmp_path.iterdir() if p.suffix != ".toml")

    return called


def test_a_page_is_written(run, tmp_path):
    result, files = run("plate.toml", "--out", "plate.html", "--seconds", "1", "--speed", "0.5")
    assert (result.exit_code, files) == (0, ["plate.html"])
    text = (tmp_path / "plate.html").read_text(encoding="utf-8")
    assert result.output == f"wrote plate.html ({len(text.encode()):,} bytes)\n"
    assert '"end":1.0,' in text
    assert '"speed":0.5,' in text
    assert '"follow":-1,' in text


@pytest.mark.slow
def test_slides_are_written(run, tmp_path):
    image = pytest.importorskip("PIL.Image")
    pytest.importorskip("matplotlib")
    options = ("--fps", "4", "--length", "0.5", "--size", "120x100", "--dark")
    for name, kind in (("plate.gif", "GIF"), ("plate.webp", "WEBP"), ("plate.apng", "PNG")):
        result, files = run("plate.toml", "--out", name, *options)
        assert result.exit_code == 0
        with image.open(tmp_path / name) as picture:
            assert (picture.format, picture.size, picture.n_frames) == (kind, (120, 100), 3)
    assert files == ["plate.apng", "plate.gif", "plate.webp"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("plate.toml", "--out", "plate.svg"), "unknown kind of file"),
        (("plate.toml", "--out", "plate.html", "--follow", "plaet"), "unknown body 'plaet'"),
        (
            ("plate.toml", "--out", "plate.toml/plate.html"),
            "a folder is needed, and this is a file",
        ),
        (("plate.toml", "--out", "plate.html", "--fps", "10"), "this option is for slides"),
        (("plate.toml", "--out", "plate.gif", "--fps", "0"), "unusable rate of pictures"),
        (("plate.toml", "--out", "plate.gif", "--length", "-1"), "unusable length"),
        (("plate.toml", "--out", "plate.gif", "--size", "big"), "not a size"),
        (("plate.toml", "--out", "plate.gif", "--size", "9x9"), "unusable size"),
        (("plate.toml", "--out", "plate.html", "--speed", "0"), "not a positive number"),
        (("plate.toml", "--out", "plate.html", "--seconds", "nan"), "not a positive number"),
        (("plat.toml", "--out", "plate.html"), "no such scene file"),
        (("fast.toml", "--out", "plate.html", "--seconds", "40000"), "too many turns"),
    ],
)
def test_one_clear_message_and_no_file(run, arguments, message):
    result, files = run(*arguments)
    assert (result.exit_code, files) == (2, [])
    assert f"error: {message}" in result.output
    assert "Traceback" not in result.output


def test_a_file_that_stood_there_stays_where_something_fails(run, tmp_path):
    (tmp_path / "plate.html").write_text("old", encoding="utf-8")
    result, files = run("fast.toml", "--out", "plate.html", "--seconds", "40000")
    assert (result.exit_code, files) == (2, ["plate.html"])
    assert (tmp_path / "plate.html").read_text(encoding="utf-8") == "old"
