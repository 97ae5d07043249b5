"""What generated C defines for itself: functions that C99 lacks, linear systems, tables."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from codegen.ir.linsolve import C_HELPERS
from codegen.ir.names import comment
from codegen.ir.stumpff import SERIES
from codegen.targets.sincos import CIRCLE
from eom.tables import Table

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
