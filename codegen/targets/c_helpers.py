"""What generated C defines for itself: functions that C99 lacks, linear systems, tables.

Sine and cosine by polynomials: coefficients, and a function of C that computes many together.

The argument is reduced by Cody and Waite (Software Manual for the Elementary Functions, 1980, ch. 8)
with pi/2 in parts of 37, 37 and 53 bits, whose products with a quadrant of 16 bits are exact; the
remainder is kept with what rounding lost of it. Angles beyond `LARGEST_ANGLE` go to the library. The
coefficients interpolate the functions in Chebyshev points with 60 digits.

Programs with many angles get all of these before everything else (`circles`): a library computes one after
the other, and each call empties the registers; side by side, compilers compute several in one vector.
Systems of many bodies have an angle a joint, all known from the start.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from codegen.ir.linsolve import C_HELPERS
from codegen.ir.names import comment
from codegen.ir.ops import LEAVES, TURNED, Instruction
from codegen.ir.passes import pruned
from codegen.ir.program import Name, Program
from codegen.ir.stumpff import SERIES
from eom.tables import Table

LARGEST_ANGLE = 1e5
"""Up to it the quadrant has 16 bits."""

SINE = (
    -0.16666666666666655, 0.008333333333327302, -0.00019841269833447805, 2.7557314875573207e-06,
    -2.505093290062454e-08, 1.5906399268301887e-10,
)  # fmt: skip
"""(sin x - x)/x^3 as a polynomial in x^2, |x| <= pi/4."""
COSINE = (
    0.041666666666666664, -0.0013888888888887395, 2.4801587298763433e-05, -2.7557317270560326e-07,
    2.0876146024689747e-09, -1.1382614868556325e-11,
)  # fmt: skip
"""(cos x - 1 + x^2/2)/x^4 as a polynomial in x^2, |x| <= pi/4."""


def horner(variable: str, coefficients: Sequence[float]) -> str:
    """Write a polynomial by Horner's rule.

    >>> horner("z", [0.5, -0.25, 2.0])
    '0.5 + z * (-0.25 + z * 2.0)'
    """
    *rest, last = map(repr, coefficients)
    text = last
    for k, c in enumerate(reversed(rest)):
        text = f"{c} + {variable} * {text if k == 0 else f'({text})'}"
    return text


WHOLE = "6755399441055744.0"  # 1.5 * 2^52: the sum with a small number rounds it to a whole one

CIRCLE = f"""\
/* Sines and cosines of n angles a[k] to r[k] and r[n + k], within a unit in the last place. The
 * argument is reduced by Cody and Waite; there is no branch, so that compilers make vectors of it. */
#include <float.h>
static void circle_(int n, const double *restrict a, double *restrict r) {{
    int k = 0;
#if FLT_EVAL_METHOD == 0 && !defined(__FAST_MATH__)
    for (; k < n; ++k) {{
        const double q = (a[k] * {0.6366197723675814!r} + {WHOLE}) - {WHOLE};
        const double first = a[k] - q * {1.5707963267923333!r}, second = q * {2.5633441515839558e-12!r};
        const double rest = first - second, back = rest - first;
        const double lost = (first - (rest - back)) - (second + back);
        const double third = q * {1.0562999066987428e-23!r} - lost;
        const double x = rest - third, e = (rest - x) - third, z = x * x, cube = x * z;
        const double s = {horner("z", SINE[1:])};
        const double sine = x - ((z * (0.5 * e - cube * s) - e) - cube * ({SINE[0]!r}));
        const double c = z * ({horner("z", COSINE)});
        const double half = 0.5 * z, top = 1.0 - half;
        const double cosine = top + (((1.0 - top) - half) + (z * c - x * e));
        const double twice = (q * 0.5 - 0.25 + {WHOLE}) - {WHOLE};
        const double whole = (twice * 0.5 - 0.25 + {WHOLE}) - {WHOLE};
        const double sign = 1.0 - 2.0 * (twice - 2.0 * whole);
        const int odd = q != 2.0 * twice;
        r[k] = sign * (odd ? cosine : sine);
        r[n + k] = sign * (odd ? -sine : cosine);
    }}
#endif
    for (int j = 0; j < n; ++j)
        if (j >= k || !(fabs(a[j]) <= {LARGEST_ANGLE!r})) r[j] = sin(a[j]), r[n + j] = cos(a[j]);
}}"""


MANY_ANGLES = 4
"""Fewer angles are left to the library."""
BLOCK = 4
"""Angles are filled up with zeros to a multiple of so many."""
CIRCULAR = {"sin": 0, "cos": 1}
_FIXED = frozenset({"const", "pi"})
_EARLY = frozenset({*LEAVES, "add", "sub", "mul", "neg", "div"})
"""What angles are made of."""


@dataclass(frozen=True)
class Circles:
    """A program in two: ``angles``, and ``late``, which reads their sines and cosines.

    ``angles`` has one group of results, called `TURNED`. Leaf n of ``late`` is the sine of angle n, leaf
    ``room`` + n its cosine; ``names`` are those that the leaves had in the whole program.
    """

    angles: Program
    late: Program
    room: int
    names: tuple[Name, ...]


def circles(program: Program) -> Circles | None:
    """Return a program cut at the sines and cosines of its angles; None where there are few.

    Law: with the sines and cosines of the angles in its leaves, ``late`` gives the values of ``program``.
    """
    found = _found(program)
    angles = tuple(dict.fromkeys(program.instructions[k].args[0] for k in found))
    if len(angles) < MANY_ANGLES:
        return None
    room = -(-len(angles) // BLOCK) * BLOCK
    row = {angle: n for n, angle in enumerate(angles)}
    instructions = list(program.instructions)
    names = [Name("")] * (2 * room)
    for k in found:
        op, (angle,), _ = instructions[k]
        slot = CIRCULAR[op] * room + row[angle]
        instructions[k] = Instruction(TURNED, (), slot)
        names[slot] = program.names.get(k, names[slot])
    kept = {k: name for k, name in program.names.items() if k not in found}
    late = pruned(instructions, program.results, kept, program.rules)
    early = pruned(program.instructions, {TURNED: angles}, _NONE, program.rules)
    return Circles(early, late, room, tuple(names))


_NONE: Mapping[int, Name] = MappingProxyType({})


def _found(program: Program) -> dict[int, None]:
    """Return the sines and cosines of what is known from the start, in order."""
    late, fixed, early = 0, 1, 2
    when: list[int] = []
    found: dict[int, None] = {}
    for k, (op, args, _) in enumerate(program.instructions):
        own = late
        if op in _EARLY:
            given = [when[a] for a in args]
            own = late if late in given else max(given, default=fixed if op in _FIXED else early)
        elif op in CIRCULAR and when[args[0]] == early:
            found[k] = None
        when.append(own)
    return found


HELPERS = {
    "sign_": "static inline double sign_(double a) { "
    "return a > 0.0 ? 1.0 : a < 0.0 ? -1.0 : a == 0.0 ? 0.0 : a; }",
    "min_": "static inline double min_(double a, double b) { return a < b || a != a ? a : b; }",
    "max_": "static inline double max_(double a, double b) { return a > b || a != a ? a : b; }",
    "mod_": """\
/* a - b floor(a / b), with the sign of b; fmod is exact. */
static inline double mod_(double a, double b) {
    const double rest = fmod(a, b);
    return rest == 0.0 ? copysign(0.0, b) : (rest < 0.0) != (b < 0.0) ? rest + b : rest;
}""",
    "jn": "double jn(int n, double x); /* POSIX, not C99 */",
    "yn": "double yn(int n, double x); /* POSIX, not C99 */",
    "stumpff_": f"""\
/* The sum over j of (-z)^j / (2 j + k)!: a series near zero, sine or sinh and a recurrence elsewhere. */
static double stumpff_(int k, double z) {{
    static const double cutoff[] = {{{", ".join(repr(c) for c, _ in SERIES.values())}}};
    static const int terms[] = {{{", ".join(str(n) for _, n in SERIES.values())}}};
    const double s = sqrt(fabs(z));
    double c = 1.0, factorial = 1.0;
    if (fabs(z) < cutoff[k - 1]) {{
        for (int j = terms[k - 1]; j > 0; --j)
            c = 1.0 - z * c / ((2.0 * (double)j + (double)k - 1.0) * (2.0 * (double)j + (double)k));
        for (int n = 2; n <= k; ++n) factorial *= (double)n;
        return c / factorial;
    }}
    if (k % 2) {{
        c = (z > 0.0 ? sin(s) : sinh(s)) / s;
    }} else {{
        const double q = (z > 0.0 ? sin(0.5 * s) : sinh(0.5 * s)) / s;
        c = 2.0 * q * q;
        factorial = 2.0;
    }}
    for (int n = 2 - k % 2; n < k; n += 2) {{
        c = (1.0 / factorial - c) / z;
        factorial *= ((double)n + 1.0) * ((double)n + 2.0);
    }}
    return c;
}}""",
    **C_HELPERS,
    "circle_": CIRCLE,
}
"""Text of each by its name; one that a file does not call is left out."""


def table_function(name: str, table: Table) -> str:
    """Return the function of a table: a binary search, then a polynomial by Horner's rule."""
    first, last = table.breakpoints[0], table.breakpoints[-1]
    width = len(table.rows[0])
    polynomial = "row[0] + 0.0 * h" if width == 1 else _horner(width)
    inside = f"x < {first!r} ? {first!r} : x > {last!r} ? {last!r} : x"
    return "\n".join(
        [
            f"/* Table {comment(table.label)}: {table.kind}; outside: {table.outside}. */",
            f"static double {name}(double x) {{",
            f"    static const double start[] = {_list(table.breakpoints)};",
            f"    static const double rows[][{width}] = {{",
            *(f"        {_list(row)}," for row in table.rows),
            "    };",
            f"    size_t low = 0, high = {len(table.breakpoints)};",
            "    while (low < high) {",
            "        const size_t middle = (low + high) / 2;",
            "        if (start[middle] <= x) low = middle + 1;",
            "        else high = middle;",
            "    }",
            "    const double *const row = rows[low];",
            f"    const double inside = {inside if table.flat_outside else 'x'};",
            "    const double h = inside - start[low > 0 ? low - 1 : 0];",
            f"    return {polynomial};",
            "}",
        ]
    )


def _horner(width: int) -> str:
    """Write row[0] + h * (row[1] + ...)."""
    text = f"row[{width - 1}]"
    for k in range(width - 2, -1, -1):
        text = f"row[{k}] + h * {text if k == width - 2 else f'({text})'}"
    return text


def _list(numbers: Sequence[float]) -> str:
    return "{" + textwrap.fill(", ".join(map(repr, numbers)), 96) + "}"
