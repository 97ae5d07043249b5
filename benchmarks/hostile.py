r"""``python -m benchmarks.hostile N``: N hostile inputs through the whole checker, from bytes to verdicts.

Judged notes with formulas cut, spliced, with tokens lost, doubled, exchanged; macro bombs, deep nesting,
formulas of a megabyte, ``x^{9^{9^9}}``, braces without a partner, binary, HTML, commands that read files;
broken lexica in front matter. Every input gives a verdict for each formula or one `InputError`, within
`MAX_SECONDS` of processor time and `MAX_MEMORY` more of memory; anything else is a failure. The seed
gives the same inputs; ``--start K`` goes on with the K-th one.
"""

from __future__ import annotations

import random
import resource
import signal
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from time import process_time
from types import FrameType

import click

from benchmarks import reading
from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import NONE, ORDER, verdict
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import lexicon_for, preset
from eom.checker.read.documents import KINDS, decoded, read_document
from eom.errors import InputError

MAX_SECONDS = 20
"""Of processor time for one input of many formulas; no formula of a note takes as long."""
MAX_MEMORY = 3_000_000_000
NOTES = Path("tests/eom/checker/unseen")
PRESETS = ("arrow-tilde", "left-superscript", "underline-bullet", "kane", "hughes", "physics-bold")
VERDICTS = {*ORDER, NONE}


@dataclass
class Found:
    """Inputs by what became of them, failures as texts, the slowest input."""

    outcomes: Counter[str] = field(default_factory=Counter)
    verdicts: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    slowest: tuple[float, str, str] = (0.0, "", "")


class TooSlow(BaseException):
    """An input takes longer than it may; no handler of the checker catches it."""


# -- inputs --------------------------------------------------------------------------------------


def sources(folder: Path = NOTES) -> list[tuple[str, str, str, Lexicon]]:
    """Return name, kind, text and lexicon of all notes of a folder."""
    found = []
    for path in sorted(p for p in folder.iterdir() if p.suffix in KINDS):
        text = path.read_text(encoding="utf-8")
        lexicon = lexicon_for(text, path)
        if lexicon is not None:
            found.append((path.stem, KINDS[path.suffix], text, lexicon))
    return found


SOURCES = sources()
FORMULAS = [
    (piece.body, lexicon)
    for _, kind, text, lexicon in SOURCES
    for piece in read_document(text, kind).formulas
    if "=" in piece.body
]


def _edited(rng: random.Random, text: str) -> str:
    """Lose, double, exchange or replace some tokens of a formula."""
    parts = reading.pieces(text)
    for _ in range(rng.randint(1, 3)):
        if not parts:
            break
        k, j = rng.randrange(len(parts)), rng.randrange(len(parts))
        how = rng.randrange(5)
        if how == 0:
            parts[k] = ""
        elif how == 1:
            parts[k] *= 2
        elif how == 2:
            parts[k], parts[j] = parts[j], parts[k]
        else:
            other = rng.choice(FORMULAS)[0]
            parts[k] = rng.choice(reading.WORDS) if how == 3 else rng.choice(reading.pieces(other))
    return " ".join(parts)


def formula(rng: random.Random) -> tuple[bytes, Lexicon]:
    """Return a true or false formula of a note with some damage."""
    text, lexicon = rng.choice(FORMULAS)
    return f"$${_edited(rng, text)}$$".encode(), lexicon


def joined(rng: random.Random) -> tuple[bytes, Lexicon]:
    """Return sides of two formulas as one equation."""
    (a, lexicon), (b, _) = rng.choice(FORMULAS), rng.choice(FORMULAS)
    return f"$${rng.choice(a.split('='))} = {rng.choice(b.split('='))}$$".encode(), lexicon


def damaged(rng: random.Random) -> tuple[bytes, Lexicon]:
    """Return a part of a note with bytes lost, doubled or changed."""
    _, _, text, lexicon = rng.choice(SOURCES)
    data = bytearray(text.encode())
    first = rng.randrange(len(data))
    data = data[first : first + rng.randint(20, 800)]
    for _ in range(rng.randint(0, 4)):
        k = rng.randrange(len(data))
        data[k : k + rng.randint(0, 3)] = bytes(
            rng.choice(b"\\{}$^_&<>=\x00\xff\n[]()") for _ in "ab"
        )
    return bytes(data), lexicon


def bomb(rng: random.Random) -> tuple[bytes, Lexicon]:
    """Return macros that grow, refer to themselves, or take too much."""
    depth = rng.choice([3, 12, 40])
    letters = [chr(97 + k % 26) * (1 + k // 26) for k in range(depth)]
    rows = [rf"\newcommand{{\z{letters[0]}}}{{\omega_1}}"]
    for a, b in pairwise(letters):
        rows.append(rf"\newcommand{{\z{b}}}{{\z{a} {rng.choice(['+', '', '='])} \z{a}}}")
    rows.append(rng.choice([r"\def\x{\x}", r"\def\y#1{\y{#1#1}}", r"\let\frac\sqrt", ""]))
    text = "\n".join(rows) + rf"$$\z{letters[-1]} = \x \y{{a}} {rng.choice(['', '1', '}'])}$$"
    return text.encode(), preset(rng.choice(PRESETS))


POWERS = [
    *(
        "x^{9^{9^9}}",
        r"\omega_1^{99999999999999999999}",
        r"2^{2^{2^{2^{2}}}}",
        r"(\omega_1+\omega_2)^{12}",
    ),
    *(
        r"\sin^{999}\theta",
        r"((\omega_1+1)^{12}+\omega_2)^{12}",
        r"\frac{1}{0}",
        r"0^{-1}",
        r"\sqrt[0]{\omega_1}",
    ),
    *(r"\omega_1^{1/99999}", "9" * 5000, "1." + "0" * 3000 + "1", r"\tan\tan\tan\theta", r"0^0"),
    *(r"\sum_{i=1}^{10^9} i", r"\sum_{k=1}^{3}\sum_{l=1}^{3}\omega_k^2\omega_l^2", r"|\omega_1|"),
]


def powers(rng: random.Random) -> tuple[bytes, Lexicon]:
    """Return numbers, powers and sums that must not be worked out."""
    a, b = rng.choice(POWERS), rng.choice(POWERS)
    return f"$${a} {rng.choice(['=', '+', ' '])} {b} = \\omega_2$$".encode(), preset(
        rng.choice(PRESETS)
    )


def deep(rng: random.Random) -> tuple[bytes, Lexicon]:
    """Return brackets, accents, fractions, sums within each other."""
    return f"$${reading.nested(rng)} = 0$$".encode(), preset(rng.choice(PRESETS))


MARKUP = [
    "<script>alert(1)</script> $a<b$",
    '<img src=x onerror="x"> $$<b>=c$$',
    r"\input{/etc/passwd} $$\input{/etc/passwd} = 1$$",
    r"\write18{ls} $\immediate\write18{ls} = 1$",
    r"$$\href{javascript:alert(1)}{x} = \text{<script>}$$",
    "+++\n[check]\npreset = 3\n+++\n$$a=b$$",
    "+++\n[check]\nsymbols = {'x' = '= x'}\n+++\n$$x=x+x$$",
    "---\n- [\n---\n$$a=b$$",
    "\ufeff$$\u202e=\u0000$$",
    "$" * 500,
    "```\n$$a=b$$\n~~~",
    r"\begin{equation}\begin{aligned}a&=b\\c&=\end{equation}",
]


def markup(rng: random.Random) -> tuple[bytes, Lexicon]:
    """Return HTML, commands for files, broken front matter."""
    return (rng.choice(MARKUP) + rng.choice(MARKUP)).encode(), preset(rng.choice(PRESETS))


def binary(rng: random.Random) -> tuple[bytes, Lexicon]:
    """Return bytes that are no text."""
    start = rng.choice([b"", b"\xff\xfe", b"\xef\xbb\xbf", b"$$", b"\x89PNG"])
    return start + rng.randbytes(rng.randint(0, 300)), preset("hughes")


def large(rng: random.Random) -> tuple[bytes, Lexicon]:
    """Return a formula of up to a megabyte."""
    unit = rng.choice(
        [r"\omega_1 + ", r"\omega_1 ", "(", r"\vec{r} \times ", "a = ", r"\frac{1}{2}", "x", "&"]
    )
    size = rng.choice([10_000, 100_000, 1_000_000])
    return f"$${unit * (size // len(unit))} = 0$$".encode(), preset("arrow-tilde")


MAKERS: dict[str, tuple[float, Callable[[random.Random], tuple[bytes, Lexicon]]]] = {
    "formulas with damage": (60, formula),
    "sides of two formulas": (12, joined),
    "notes with damage": (12, damaged),
    "macros": (3, bomb),
    "powers": (4, powers),
    "nested": (4, deep),
    "markup": (3, markup),
    "binary": (3, binary),
    "large": (0.01, large),
}
"""Kinds of input with their weights."""


# -- trying --------------------------------------------------------------------------------------


def try_one(data: bytes, lexicon: Lexicon) -> Counter[str]:
    """Return the verdicts on all formulas of an input. Raises `InputError`."""
    text = decoded(data)
    own = lexicon_for(text)
    document = read_document(text)
    found = Counter(
        verdict(u, ("constant_mass",)).verdict for u in understand(document, own or lexicon)
    )
    unknown = set(found) - VERDICTS
    if unknown:
        raise AssertionError(f"verdicts that there are none of: {unknown}")
    return found


def _stop(_: int, __: FrameType | None) -> None:
    raise TooSlow


def check(kind: str, data: bytes, lexicon: Lexicon, found: Found) -> None:
    """Try one input; note what is neither verdicts nor an `InputError`, and what takes too long."""
    start = process_time()
    before = signal.signal(signal.SIGVTALRM, _stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, MAX_SECONDS)
    try:
        found.verdicts += try_one(data, lexicon)
        found.outcomes[f"{kind}: judged"] += 1
    except InputError as error:
        str(error)
        found.outcomes[f"{kind}: refused"] += 1
    except TooSlow:
        found.failures.append(f"{kind}: more than {MAX_SECONDS} s: {data[:300]!r}")
    except Exception as error:
        found.failures.append(f"{kind}: {type(error).__name__}: {str(error)[:200]}: {data[:300]!r}")
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)
    seconds = process_time() - start
    if seconds > found.slowest[0]:
        found.slowest = (seconds, kind, repr(data[:200]))


def _used() -> int:
    """Return the bytes of address space that this process has, most of which nobody reads or writes."""
    pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[0]
    return int(pages) * resource.getpagesize()


def run(count: int, seed: int, start: int = 0, most: int = MAX_MEMORY) -> Found:
    """Try ``count`` inputs from number ``start`` on, with at most so much memory more than before."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (_used() + most, before[1]))
    found = Found()
    kinds, weights = list(MAKERS), [w for w, _ in MAKERS.values()]
    try:
        for k in range(start, start + count):
            rng = random.Random(f"{seed} {k}")
            kind = rng.choices(kinds, weights)[0]
            check(kind, *MAKERS[kind][1](rng), found)
            if (k + 1) % 1000 == 0:
                click.echo(f"{k + 1}: {len(found.failures)} failures", err=True)
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
    return found


@click.command()
@click.argument("count", type=int)
@click.option("--seed", default=0, show_default=True)
@click.option("--start", default=0, show_default=True, help="Number of the first input.")
def main(count: int, seed: int, start: int) -> None:
    """Try COUNT hostile inputs; exit with 1 where one fails otherwise than by a clear error."""
    found = run(count, seed, start)
    for outcome, number in sorted(found.outcomes.items()):
        click.echo(f"{outcome} {number}")
    words = ", ".join(f"{n} {text}" for text, n in sorted(found.verdicts.items()))
    click.echo(f"verdicts: {words}")
    for text in dict.fromkeys(found.failures):
        click.echo(text)
    seconds, kind, text = found.slowest
    click.echo(
        f"{len(found.failures)} failures in {count}; slowest {seconds:.2f} s, {kind}, {text}"
    )
    sys.exit(1 if found.failures else 0)


if __name__ == "__main__":
    main()
