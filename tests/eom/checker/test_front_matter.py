"""Front matter in YAML: the table of the checker is read, all else left alone, nothing is evaluated."""

from __future__ import annotations

import pytest

from eom import check
from eom.checker.mean.lexicon_files import MAX_FRONT, yaml_table
from eom.errors import InputError

NOTE = "\n$$\\vec u \\times \\vec u = 0$$\n"
TABLE = "eom:\n  preset: arrow-tilde\n  symbols:\n    '\\vec u': vector u\n"


@pytest.mark.parametrize(
    "front",
    [
        f"---\ntitle: Euler's equations\ntags: [a, b]\n{TABLE}---\n",
        f"---\n{TABLE}author: me\n---\n",
        f"---\n{TABLE.replace('eom', 'check')}---\n",
        "+++\ntitle = 'x'\n[check]\npreset = 'arrow-tilde'\nsymbols = { '\\vec u' = 'vector u' }\n+++\n",
    ],
)
def test_a_table_of_front_matter_is_the_lexicon(front: str) -> None:
    """In YAML and in TOML."""
    report = check(front + NOTE)
    assert report.lexicon == "front matter"
    assert [f.verdict for f in report.findings] == ["holds"]


def test_other_front_matter_is_left_alone() -> None:
    """What is no YAML at all may stand there where no table is meant for the checker."""
    report = check("---\n: : [unbalanced\nfoo: {\n---\n" + NOTE)
    assert report.lexicon != "front matter"


def test_macros_of_front_matter_hold() -> None:
    """As header lines of other programs define them."""
    front = f"---\nheader-includes: |\n  \\newcommand{{\\uu}}{{\\vec u}}\n{TABLE}---\n"
    assert check(front + NOTE.replace(r"\vec u", r"\uu")).findings[0].verdict == "holds"


BOMB = "eom: &a [x]\n" + "".join(f"  {k}: [*a, *a]\n" for k in "bcd")


@pytest.mark.parametrize(
    "block",
    [
        BOMB,
        "eom: *x\n",
        'eom: !!python/object/apply:os.system ["true"]\n',
        "eom: !!python/name:os.system\n",
        "eom: [1, 2]\n",
        "eom: {a: \n",
        "eom: " + "[" * 5000 + "\n",
        "eom:\n  preset: no such\n",
        "eom:\n  what: ever\n",
        f"eom: {'x' * (MAX_FRONT + 1)}\n",
    ],
)
def test_what_cannot_be_used_is_refused(block: str) -> None:
    """One clear error; nothing grows and nothing is run."""
    with pytest.raises(InputError):
        check(f"---\n{block}---\n{NOTE}")


def test_a_word_names_a_preset() -> None:
    """Without any other key."""
    assert yaml_table("title: x\neom: arrow-tilde\n") == {"preset": "arrow-tilde"}
