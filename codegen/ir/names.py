"""Identifiers for generated code, from whatever the quantities are called."""

from __future__ import annotations

import keyword
import re
import unicodedata
from collections.abc import Iterable

_C_KEYWORDS = frozenset(
    [
        "auto",
        "break",
        "case",
        "char",
        "const",
        "continue",
        "default",
        "do",
        "double",
        "else",
        "enum",
        "extern",
        "float",
        "for",
        "goto",
        "if",
        "inline",
        "int",
        "long",
        "register",
        "restrict",
        "return",
        "short",
        "signed",
        "sizeof",
        "static",
        "struct",
        "switch",
        "typedef",
        "union",
        "unsigned",
        "void",
        "volatile",
        "while",
        "bool",
        "true",
        "false",
        "nullptr",
        "alignas",
        "alignof",
        "constexpr",
        "static_assert",
        "thread_local",
        "typeof",
        "asm",
        "fortran",
    ]
)
_C_LIBRARY = frozenset(
    [
        "abs",
        "acos",
        "acosh",
        "asin",
        "asinh",
        "atan",
        "atan2",
        "atanh",
        "cbrt",
        "ceil",
        "copysign",
        "cos",
        "cosh",
        "div",
        "erf",
        "erfc",
        "exp",
        "exp2",
        "expm1",
        "fabs",
        "floor",
        "fma",
        "fmax",
        "fmin",
        "fmod",
        "frexp",
        "gamma",
        "hypot",
        "index",
        "isfinite",
        "isinf",
        "isnan",
        "j0",
        "j1",
        "jn",
        "ldexp",
        "lgamma",
        "log",
        "log10",
        "log1p",
        "log2",
        "main",
        "modf",
        "nan",
        "pow",
        "remainder",
        "rint",
        "round",
        "signbit",
        "sin",
        "sinh",
        "sqrt",
        "tan",
        "tanh",
        "tgamma",
        "time",
        "trunc",
        "y0",
        "y1",
        "yn",
        "size_t",
        "ptrdiff_t",
        "NAN",
        "HUGE_VAL",
        "HUGE_VALF",
        "HUGE_VALL",
        "FP_NAN",
        "FP_INFINITE",
        "FP_ZERO",
        "FP_NORMAL",
        "FP_SUBNORMAL",
        "DBL_EPSILON",
        "DBL_MAX",
        "DBL_MIN",
        "FLT_EPSILON",
        "FLT_MAX",
        "FLT_MIN",
        "math_errhandling",
        "MATH_ERRNO",
        "MATH_ERREXCEPT",
        "INFINITY",
        "NULL",
        "errno",
        "EOF",
        "stdin",
    ]
)
C_MATH = frozenset(
    """acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1 fabs
    fdim floor fma fmax fmin fmod hypot lgamma log log10 log1p log2 logb nan nearbyint nextafter pow
    remainder rint round sin sinh sqrt tan tanh tgamma trunc""".split()
)
"""Functions of <math.h> over doubles; those over floats have an f behind their name."""
_C_FLOAT = frozenset({*(f"{name}f" for name in C_MATH), "j0f", "j1f", "jnf", "y0f", "y1f", "ynf"})
_PYTHON = frozenset(
    {
        *keyword.kwlist,
        *keyword.softkwlist,
        "jax",
        "jnp",
        "np",
        "numpy",
        "scipy",
        "print",
        "min",
        "max",
        "sum",
        "float",
        "len",
        "map",
        "math",
        "ascii",
    }
)
_JAVASCRIPT = frozenset(
    """abstract arguments as async await boolean byte catch class debugger delete eval export extends
    final finally from function get globalThis implements import in instanceof interface let
    native new null of package private protected public set super switch synchronized this throw
    throws transient try typeof undefined var with yield
    Array Float64Array Infinity Math NaN Number Object""".split()
)
_MATLAB = frozenset(
    """classdef do elseif end end_try_catch end_unwind_protect endclassdef endenumeration endevents
    endfor endfunction endif endmethods endparfor endproperties endswitch endwhile function global
    otherwise parfor persistent spmd until unwind_protect unwind_protect_cleanup
    Inf nargin numel reshape sign size zeros""".split()
)
_FILES = frozenset(
    name
    for device in (
        "aux",
        "con",
        "nul",
        "prn",
        *(f"{d}{k}" for d in ("com", "lpt") for k in range(1, 10)),
    )
    for name in (device, device.upper(), device.capitalize())
)
"""No file of Windows is called so, whatever it ends in."""
_OWN = frozenset(
    {
        "t",
        "x",
        "p",
        "u",
        "y",
        "c",
        "w",
        "constants",
        "xs",
        "ps",
        "us",
        "ys",
        "out",
        "dx",
        "k",
        "n",
        "count",
        "select",
    }
)
HELPERS = ("sign_", "min_", "max_", "mod_", "stumpff_", "factor_", "back_", "circle_",
           "carried_", "angles_", "turned_", "k_")  # fmt: skip
"""Functions and arrays that generated code defines for itself."""

RESERVED = (
    _C_KEYWORDS | _C_LIBRARY | C_MATH | _C_FLOAT | _PYTHON | _JAVASCRIPT | _MATLAB | _FILES | _OWN
)
"""Identifiers that generated code gives another meaning in one of the languages."""


def identifier(name: str) -> str:
    """Spell ``name`` as an identifier that every target accepts.

    >>> identifier("θ'"), identifier("lambda"), identifier("2*/x")
    ('theta_dot', 'lambda_', 'v2_x')
    """
    if len(name) <= 60 and name not in RESERVED and _PLAIN.fullmatch(name):
        return name
    text = re.sub(
        r"['′’]+$", lambda m: "_" + "d" * len(m[0]) + "ot" if len(m[0]) > 1 else "_dot", name
    )
    spelt = "".join(_spell(c) for c in text)
    spelt = re.sub(r"[^A-Za-z0-9_]+", "_", spelt).strip("_")
    spelt = re.sub(r"_{2,}", "_", spelt) or "v"
    if not spelt[0].isalpha():
        spelt = "v" + spelt
    return spelt[:60] + "_" if spelt in RESERVED else spelt[:60]


_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*")
"""Names that are spelt as they are."""


def _spell(character: str) -> str:
    """Greek letters by name, everything else that is ASCII as it is."""
    if character.isascii():
        return character
    words = unicodedata.name(character, "").split()
    if words[:1] == ["GREEK"] and "LETTER" in words:
        return words[words.index("LETTER") + 1].lower().replace("lamda", "lambda")
    return unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode() or "_"


def identifiers(names: Iterable[str], taken: Iterable[str] = ()) -> list[str]:
    """Spell each of ``names``, all different from one another and from ``taken``.

    >>> identifiers(["x", "x_", "θ", "theta"])
    ['x_', 'x_2', 'theta', 'theta_2']
    """
    used = set(taken)
    result = []
    for name in names:
        base = spelt = identifier(name)
        count = 1
        while spelt in used:
            count += 1
            spelt = f"{base.rstrip('_')}_{count}"
        used.add(spelt)
        result.append(spelt)
    return result


_SPECIAL = frozenset("\\?*")
"""Characters that a comment has none of, or that may open or close one."""


def _is_comment(text: str) -> bool:
    """Return whether a text is one line of printable ASCII, with single spaces, that needs no change."""
    plain = len(text) <= 200 and text.isascii() and text.isprintable()
    return plain and _SPECIAL.isdisjoint(text) and "  " not in text and text == text.strip()


def comment(text: str) -> str:
    r"""Return ``text`` as the inside of a one-line comment in any language: printable ASCII only.

    >>> comment("area */ [m²] #define x")
    'area * / [m2] #define x'
    """
    if _is_comment(text):
        return text
    plain = unicodedata.normalize("NFKD", " ".join(text.split())).encode("ascii", "ignore").decode()
    plain = "".join(c for c in plain if c.isprintable() and c not in "\\?")
    return " ".join(plain.replace("*/", "* /").replace("/*", "/ *").split())[:200]
