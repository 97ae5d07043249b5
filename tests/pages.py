"""Run the blocks of a page of the documentation, in order, in the current folder.

``python tests/pages.py PAGE``: blocks ``python`` share their names; blocks ``bash`` are commands of
``eom``, called through the command line in this process, or of a shell; a block ``text`` or ``json``
that follows is what they must have printed, where ``...`` stands for anything, and numbers agree if they
are as near as their digits say; a block with a caption is a file of that name. A block ``console`` is not
run: `NOT_RUN` says what may stand there. A block of the class ``with-NAME``, and the text that it prints,
is passed over where the module NAME is not installed: it shows another program. With several pages each
runs in a process and a folder of its own, and what was wrong with each is printed as JSON.
"""

import contextlib
import difflib
import importlib
import importlib.util
import io
import json
import logging
import os
import re
import shlex
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

FENCE = re.compile(
    r"^(?P<mark>`{3,}|:{3,})(?P<kind>[^\n`]*)\n(?P<body>.*?)^(?P=mark)$", re.MULTILINE | re.DOTALL
)
CAPTION = re.compile(r"\A(?::\w+:.*\n)*:caption: (?P<name>\S+)\n(?::\w+:.*\n)*\n*")
WITH = re.compile(r"\A(?::\w+:.*\n)*:class: with-(?P<name>\w+)\n\n*")
NUMBER = re.compile(
    r"(?<![\w.])[-+]?(?:\d{1,3}(?:,\d{3})+|\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)(?![\w.]*[A-Za-z_])"
)
VARYING = re.compile(r" (?:bytes|s|ms|us|ns)\b")
"""What follows a number that differs from run to run, or from machine to machine: sizes and times."""
ROUNDING = 1e-12
"""Numbers up to this are rounding errors: they agree with each other."""
NOT_RUN = ("pip install", "python3 -m venv", "dask ", "eom run bicycle-wheel")
"""Commands that set up, wait for a cluster, or are run by the tests of the command line."""
SHELL = ("cc ", "make ", "./", "cat ", "cp ", "ls", "mkdir ")


@dataclass(frozen=True)
class Block:
    """What stands between fences: its language, the file it is (or nothing), its text, its line.

    ``needs``: the module without which it is passed over, if there is one.
    """

    language: str
    file: str
    text: str
    line: int
    needs: str = ""


def blocks(page: str) -> Iterator[Block]:
    """Yield the blocks of a page that have a language."""
    for found in FENCE.finditer(page):
        language = found["kind"].removeprefix("{code-block}").strip()
        if not language or language.startswith("{"):
            continue
        caption = CAPTION.match(found["body"])
        needs = WITH.match(found["body"])
        options = caption or needs
        text = found["body"][options.end() :] if options else found["body"]
        line = page.count("\n", 0, found.start()) + 1
        yield Block(
            language,
            caption["name"] if caption else "",
            text,
            line,
            needs["name"] if needs else "",
        )


def there(found: Iterator[Block]) -> Iterator[Block]:
    """Yield the blocks but those of programs that are absent, and the texts that these would print."""
    absent = False
    for block in found:
        answer = block.language in {"text", "json"} and not block.file
        absent = (
            absent if answer else bool(block.needs) and not importlib.util.find_spec(block.needs)
        )
        if not absent:
            yield block


def agrees(shown: str, printed: str) -> bool:
    """Return whether what a page shows is what was printed, but for ``...`` and digits beyond."""
    pattern, wanted = [], []
    for k, part in enumerate(shown.strip().split("...")):
        pattern.append(".*?" if k else "")
        found = list(NUMBER.finditer(part))
        wanted += [(m[0], bool(VARYING.match(part, m.end()))) for m in found]
        spaced = [
            r"\s+".join(map(re.escape, re.split(r"\s+", words))) for words in NUMBER.split(part)
        ]
        pattern.append(f"({NUMBER.pattern})".join(spaced))
    match = re.fullmatch("".join(pattern), printed.strip(), re.DOTALL)
    if match is None:
        return False
    pairs = zip(wanted, match.groups(), strict=True)
    return all(varies or _near(number, other) for (number, varies), other in pairs)


def _near(shown: str, printed: str) -> bool:
    a, b = (float(number.replace(",", "")) for number in (shown, printed))
    digits = len(re.sub(r"[eE].*|\D", "", shown).lstrip("0"))
    allowed = 1.5 * abs(a) * 10.0 ** (1 - max(digits, 4))
    return a == b or abs(a - b) <= allowed or max(abs(a), abs(b)) <= ROUNDING


def _called(words: list[str]) -> None:
    """Call the command line; a status other than 0 is reported, as a shell would not."""
    from eom.__main__ import main

    try:
        main(words, prog_name="eom")
    except SystemExit as done:
        if done.code:
            print(f"(exit status {done.code})")


def _bash(text: str) -> None:
    for command in text.replace("\\\n", " ").splitlines():
        if not command.strip() or command.startswith("#"):
            continue
        words, _, file = command.partition(" > ")
        if words.startswith("eom "):
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                _called(shlex.split(words)[1:])
            if file:
                Path(file.strip()).write_text(out.getvalue(), encoding="utf-8")
            else:
                print(out.getvalue(), end="")
        else:
            assert command.startswith(SHELL), f"what is {command!r}?"
            done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr
            print(done.stdout, end="")


def _python(name: str, names: dict[str, object]) -> Callable[[Block], None]:
    def run(block: Block) -> None:
        code = "\n" * block.line + block.text
        exec(compile(code, name, "exec"), names)

    return run


def run(path: Path) -> int:
    """Run a page, and return how many of its blocks were run. Raises what a block raises."""
    names: dict[str, object] = {"__name__": "__main__"}
    python = _python(path.name, names)
    runs: dict[str, Callable[[Block], None]] = {"python": python, "bash": lambda b: _bash(b.text)}
    printed, count = "", 0
    for block in there(blocks(path.read_text(encoding="utf-8"))):
        place = f"{path.name}, line {block.line}"
        if block.file:
            Path(block.file).write_text(block.text, encoding="utf-8")
        elif block.language in runs:
            _check_status(printed, place)
            out = io.StringIO()
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
                runs[block.language](block)
            printed, count = out.getvalue(), count + 1
        elif block.language == "console":
            assert all(any(n in line for n in NOT_RUN) for line in block.text.splitlines()), place
        elif block.language in {"text", "json"}:
            if not agrees(block.text, printed):
                lines = difflib.unified_diff(
                    block.text.splitlines(), printed.splitlines(), "shown", "printed", lineterm=""
                )
                raise AssertionError("\n".join([place, *lines]))
            printed = ""
        else:
            assert block.language in {"toml", "markdown", "c", "matlab", "xml", "latex"}, place
    _check_status(printed, path.name)
    return count


def _check_status(printed: str, place: str) -> None:
    """A command that failed must be shown to fail."""
    assert "(exit status" not in printed, f"before {place}: {printed}"


def apart(path: Path) -> str:
    """Run a page in a process and a folder of its own; return what is wrong, or nothing."""
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile("w+") as report:
        child = os.fork()
        if child == 0:
            wrong = 1
            try:
                os.chdir(folder)
                assert run(path) > 0, "nothing was run"
                wrong = 0
            except BaseException:
                traceback.print_exc(file=report)
            finally:
                report.flush()
                os._exit(wrong)
        _, status = os.waitpid(child, 0)
        report.seek(0)
        return (report.read() or f"status {status}") if status else ""


def main(pages: list[Path]) -> None:
    """Run one page here, or several apart: what they all import is imported once."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it talks of the machine's fonts
    if len(pages) == 1:
        print(run(pages[0]))
        return
    for name in (
        "codegen",
        "eom.__main__",
        "eom.scenes.scene",
        "eom.multibody",
        "eom.checker.note.checking",
    ):
        importlib.import_module(name)
    print(json.dumps({str(page): apart(page) for page in pages}))


if __name__ == "__main__":
    os.environ |= {"COLUMNS": "100", "NO_COLOR": "1", "MPLBACKEND": "agg"}
    main([Path(word) for word in sys.argv[1:]])
