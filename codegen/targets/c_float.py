"""The C target in single precision: the text of the C target, token by token.

Law: the same operations in the same order, each on `float`; every constant is the `float` nearest to
the `double` that the C target writes. Comments and strings stay as they are. It cannot leave a token
out unseen: gcc and clang with ``-Wconversion -Wdouble-promotion -Werror`` refuse what is mixed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from codegen.frontend.layout import Layout
from codegen.ir.names import C_MATH, identifier
from codegen.ir.program import Program
from codegen.targets import c
from codegen.targets.target import Target

SUFFIX = "f32"
_NAME_LENGTH = 56

_TOKEN = re.compile(
    r"""(?P<kept>/\*.*?\*/ | "(?:[^"\\]|\\.)*" | ^[ ]*\#include[^\n]*)
      | (?P<word>[A-Za-z_]\w*)
      | (?P<number>\d+\.\d*(?:e[+-]?\d+)? | \d+e[+-]?\d+)""",
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)
_WORDS = {
    "double": "float",
    "HUGE_VAL": "HUGE_VALF",
    **{f"DBL_{limit}": f"FLT_{limit}" for limit in ("EPSILON", "MAX", "MIN")},
    **{name: f"{name}f" for name in sorted(C_MATH)},
}


def in_single_precision(text: str) -> str:
    """Return C text with its doubles made floats: types, constants and functions of the library.

    >>> in_single_precision("const double v = 0.1 * sin(x[2]); /* double 0.1 */")
    'const float v = 0.1f * sinf(x[2]); /* double 0.1 */'
    """
    return _TOKEN.sub(_single, text)


def _single(token: re.Match[str]) -> str:
    if token["word"] is not None:
        return _WORDS.get(token["word"], token["word"])
    return token["kept"] if token["number"] is None else _number(token["number"])


def _number(text: str) -> str:
    with np.errstate(over="ignore", under="ignore"):
        value = np.float32(float(text))
    if np.isinf(value):
        return "INFINITY"
    return f"{float(str(value))!r}f"


def files(program: Program, layout: Layout) -> Mapping[str, str]:
    """Return header and source by file name; the same input gives the same bytes."""
    texts = c.files(program, _named(layout))
    return {name: in_single_precision(text) for name, text in texts.items()}


def single_text(program: Program, layout: Layout) -> str:
    """Return header and source as one text that compiles by itself."""
    return in_single_precision(c.single_text(program, _named(layout)))


def prefix(layout: Layout) -> str:
    """Return the prefix of all names, NAME_f32: both precisions can be linked together."""
    return f"{identifier(layout.name)[:_NAME_LENGTH]}_{SUFFIX}"


def _named(layout: Layout) -> Layout:
    return replace(layout, name=prefix(layout), title=f"{layout.title}, in single precision")


C_FLOAT = Target(
    name="c_f32",
    extension="c",
    templates={
        op: template._replace(text=in_single_precision(template.text))
        for op, template in c.TEMPLATES.items()
        if op not in {"besselj", "bessely"}
    },
    slots=c._SLOTS,
    numbers=c._NUMBERS,
    files=files,
    unsupported=dict.fromkeys(
        ("besselj", "bessely"), "choose target c; POSIX has them for doubles"
    ),
)
