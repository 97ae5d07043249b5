"""Exercises for teaching: `eom exercise`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.options import option
from eom.commands.shared import Rows, WithTable, progress_of, report_files, waiting_for
from eom.errors import InputError, unknown_name

if TYPE_CHECKING:
    from eom.exercises import Exercise

STYLES = ("markdown", "moodle")
MOST = 200
"""Exercises of one command at most."""


def _slips() -> Rows:
    from eom.exercises.slips import LINE_SLIPS, SLIPS

    words = {s.name: f"{s.words} ({s.kind.difficulty})" for s in (*SLIPS, *LINE_SLIPS)}
    return list(words.items())


@click.command(cls=WithTable, title="Slips for --slip", rows=_slips)
@click.argument("topic", metavar="[TOPIC]", default="")
@click.option("--list", "listed", is_flag=True, help="List the topics, by groups.")
@option("seed", help="Which exercise; any number.")
@click.option(
    "--count",
    type=click.IntRange(1, MOST),
    default=1,
    show_default=True,
    help="So many exercises, of this seed and the next ones.",
)
@option(
    "style",
    default="markdown",
    metavar="markdown|moodle",
    help="Format; moodle: questions as Moodle XML, with STACK where the answer is an expression.",
)
@click.option(
    "--notation",
    default="arrow",
    show_default=True,
    metavar="arrow|superscript|underline|kane",
    help="How vectors and frames are written.",
)
@click.option("--lines", type=int, default=6, show_default=True, help="Lines at most: 2 to 40.")
@click.option("--slip", default="", metavar="KIND", help="The kind of the slip.  [default: any]")
@click.option(
    "--difficulty",
    default="",
    metavar="easy|medium|hard",
    help="What it takes to see the slip: the line, its neighbours, mechanics.  [default: any]",
)
@click.option(
    "--carried",
    type=int,
    default=0,
    show_default=True,
    help="Lines behind that carry the slip on: 0 to 3.",
)
@click.option("--key", is_flag=True, help="Print the key instead of the page for students.")
@click.option(
    "--lexicon/--no-lexicon",
    default=True,
    show_default=True,
    help="Front matter that says what symbols mean, so that eom check can judge the page. Where the"
    " checker needs laws of the topic, they stand in it: without it they are not told.",
)
@option(
    "folder",
    metavar="FOLDER",
    help="Write page and key, or the questions, to files there.",
)
@option("json", help="Print lines, key and pages as JSON.")
def exercise(
    topic: str,
    listed: bool,
    seed: int,
    count: int,
    style: str,
    key: bool,
    lexicon: bool,
    **rest: Any,
) -> None:
    """Make a derivation with exactly one planted slip, and its key.

    TOPIC is the name of a derivation (eom exercise --list). A few of its lines are shown, one of them
    false; eom check proves that it is that one and no other, or with --carried that those lines follow
    from it. Of several exercises --out also writes a sheet with all solutions. The same topic and seed
    give the same exercise. Example: eom exercise euler-equations --seed 3 --out sheet
    """
    out, as_json = rest.pop("folder"), rest.pop("as_json")
    if listed:
        _list(as_json)
        return
    _check(topic, style, key, count, out, as_json)
    if rest["carried"] and style == "moodle":
        raise InputError("--carried is for pages: a question has one answer", hint="--as markdown")
    made = _made(topic, range(seed, seed + count), style == "moodle" and not as_json, rest)
    if as_json:
        _print_json(made)
    elif out is None:
        click.echo(_printed(made, style, key, lexicon), nl=False)
    else:
        report_files(_written(made, style, lexicon, out))


def _check(topic: str, style: str, key: bool, count: int, out: Path | None, as_json: bool) -> None:
    """Raise `InputError` for options that do not go together."""
    if not topic:
        raise InputError("no topic", expected="TOPIC", hint="eom exercise --list shows them")
    if style not in STYLES:
        raise unknown_name("format", style, STYLES)
    if style == "markdown" and count > 1 and out is None and not as_json:
        raise InputError("--count is for --out, --as moodle, --json", hint="give --out FOLDER")
    if key and (style == "moodle" or out is not None or as_json):
        raise InputError(
            "--key is for one page on the screen", hint="leave out --key: keys are there"
        )
    if as_json and out is not None:
        raise InputError("--json is for the screen", hint="leave out --out or --json")


def _made(topic: str, seeds: range, others: bool, settings: dict[str, Any]) -> list[Exercise]:
    from eom.exercises import exercise as make
    from eom.exercises import with_others

    made: list[Exercise] = []
    if len(seeds) == 1:
        with waiting_for("looking for a slip that is proved"):
            one = make(topic, seeds[0], **settings)
            return [with_others(one) if others else one]
    with progress_of("exercises") as progress:
        for number, seed in enumerate(seeds, 1):
            one = make(topic, seed, **settings)
            made.append(with_others(one) if others else one)
            progress(number / len(seeds))
    return made


def _printed(made: list[Exercise], style: str, key: bool, lexicon: bool) -> str:
    from eom.exercises import marker, moodle, student

    if style == "moodle":
        return moodle(made)
    return marker(made[0]) if key else student(made[0], lexicon)


def _written(made: list[Exercise], style: str, lexicon: bool, out: Path) -> list[Path]:
    from codegen.compiling.compiled import write_files
    from eom.exercises import marker, moodle, solutions, student

    texts: dict[str, str] = {}
    for one in made:
        name = f"{one.asked.lesson.topic}-{one.asked.seed}"
        if style == "markdown":
            texts |= {f"{name}.md": student(one, lexicon), f"{name}-key.md": marker(one)}
    if style == "markdown" and len(made) > 1:
        texts[f"{made[0].asked.lesson.topic}-{made[0].asked.seed}-solutions.md"] = solutions(made)
    if style == "moodle":
        texts[f"{made[0].asked.lesson.topic}-{made[0].asked.seed}.xml"] = moodle(made)
    return write_files(texts, out)


def _print_json(made: list[Exercise]) -> None:
    from eom.exercises.moodle import as_data

    click.echo(json.dumps({"exercises": [as_data(one) for one in made]}, indent=2))


def _list(as_json: bool) -> None:
    from eom.exercises import topics

    groups = topics()
    if as_json:
        rows = [
            {"name": name, "title": title, "group": group}
            for group, titles in groups.items()
            for name, title in titles.items()
        ]
        slips = [{"name": name, "words": words} for name, words in _slips()]
        click.echo(json.dumps({"topics": rows, "slips": slips}, indent=2))
        return
    for group, titles in groups.items():
        click.echo(group)
        width = max(map(len, titles))
        for name, title in titles.items():
            click.echo(f"  {name:<{width}}  {title}")
        click.echo()
    click.echo("Try: eom exercise euler-equations --seed 3, then the same with --key")
