"""The MATLAB target: a function file that MATLAB and GNU Octave run alike; it needs no toolbox.

Both leave the real numbers where IEEE 754 has NaN (roots and logarithms of negative numbers), take
the minimum of a number and NaN for the number, and ``mod`` for inexact; helper functions, written only
where they are used, close the gaps. Their names hold two underscores, as no quantity is ever spelt so.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence

from codegen.frontend.layout import Layout
from codegen.ir.names import comment, identifier
from codegen.ir.program import Program
from codegen.ir.stumpff import SERIES
from codegen.targets.render import ARITHMETIC, Body, Template, calls, infix, table_names
from codegen.targets.target import (
    Target,
    bodies,
    name_tables,
    nested,
    used_helpers,
    used_tables,
)
from eom.tables import Table

TEMPLATES: dict[str, Template] = {
    **ARITHMETIC,
    "mul": infix(".*", 20),
    "div": infix("./", 20),
    **calls("{}", "sin cos tan atan sinh cosh tanh asinh atan2 exp expm1 abs sign floor hypot"),
    **calls("{}", "erf erfc"),
    **calls("{}__", "sqrt pow asin acos acosh atanh log log1p min max mod stumpff select"),
    "table": Template("{data}({0})"),
    "factor": Template("{v} = factor__({n}, {symmetric}, {{{entries}}});"),
    "back": Template("{v} = back__({factor}, {{{entries}}});"),
    "item": Template("{0}(1 + {data}, :)"),
    "lt": Template("({0} < {1})", 100, (6, 6)),
    "le": Template("({0} <= {1})", 100, (6, 6)),
    "eq": Template("({0} == {1})", 100, (6, 6)),
    "and": Template("({0} ~= 0 & {1} ~= 0)", 100, (6, 6)),
    "or": Template("({0} ~= 0 | {1} ~= 0)", 100, (6, 6)),
    "not": Template("({0} == 0)", 100, (6,)),
}
"""Conditions are logical arrays, or numbers of which NaN counts as true."""

_WITHIN = """\
function y = {name}__(a)
    a(~({domain})) = NaN;
    y = {name}(a);
end
"""
_DOMAINS = {
    "sqrt": "a >= 0",
    "asin": "abs(a) <= 1",
    "acos": "abs(a) <= 1",
    "acosh": "a >= 1",
    "atanh": "abs(a) <= 1",
    "log": "a >= 0",
    "log1p": "a >= -1",
}
_EXTREME = """\
function y = {name}__(a, b)
    y = {name}(a, b);
    y(isnan(a) | isnan(b)) = NaN;
end
"""
_SERIES = "; ".join(f"{end!r}, {terms}" for end, terms in SERIES.values())

_HELPERS: dict[str, str] = {
    **{f"{f}__": _WITHIN.format(name=f, domain=domain) for f, domain in _DOMAINS.items()},
    "pow__": """\
function y = pow__(a, b)
    one = ones(size(a + b));
    a = a .* one;
    b = b .* one;
    a(a < 0 & ~isinf(a) & b ~= floor(b)) = NaN;
    y = abs(a) .^ b;
    odd = (a < 0 | 1 ./ a < 0) & abs(rem(b, 2)) == 1;
    y(odd) = -y(odd);
    y(a == 1 | b == 0) = 1;
end
""",
    **{f"{f}__": _EXTREME.format(name=f) for f in ("min", "max")},
    "mod__": """\
function r = mod__(a, b)
    % with the sign of b; each difference is exact, so that quotients may be large
    one = ones(size(a + b));
    a = a .* one;
    b = b .* one;
    r = abs(a);
    m = abs(b);
    r(isinf(a) | m == 0 | isnan(m)) = NaN;
    high = r >= m;
    while any(high(:))
        [~, e] = log2(r(high));
        [~, f] = log2(m(high));
        part = fix((e - f) / 4);  % a power of two of its own may be infinite
        s = pow2(pow2(pow2(pow2(m(high), part), part), part), e - f - 3 * part);
        left = r(high);
        s(s > left) = 0.5 * s(s > left);
        r(high) = left - s;
        high = r >= m;
    end
    r(a < 0) = -r(a < 0);
    other = r ~= 0 & (r < 0) ~= (b < 0);
    r(other) = r(other) + b(other);
    r(r == 0 & b < 0) = -0.0;
    r(r == 0 & b > 0) = 0.0;
end
""",
    "stumpff__": f"""\
function y = stumpff__(k, z)
    % sum over j of (-z)^j / (2 j + k)!: a series near zero, sine or sinh and a recurrence elsewhere
    rows = [{_SERIES}];
    is_near = abs(z) < rows(k, 1);
    low = z;
    low(~is_near) = 0;
    c = ones(size(z));
    for j = rows(k, 2):-1:1
        c = 1 - low .* c / ((2 * j + k - 1) * (2 * j + k));
    end
    y = c / factorial(k);
    far = z;
    far(is_near) = rows(k, 1);
    s = sqrt(abs(far));
    angle = s;
    if mod(k, 2) == 0
        angle = 0.5 * s;
    end
    turned = sin(angle);
    turned(far < 0) = sinh(angle(far < 0));
    c = turned ./ s;
    if mod(k, 2) == 0
        c = 2 * c .^ 2;
    end
    for n = (2 - mod(k, 2)):2:(k - 1)
        c = (1 / factorial(n) - c) ./ far;
    end
    y(~is_near) = c(~is_near);
end
""",
    "select__": """\
function y = select__(c, a, b)
    one = ones(size(c + a + b));
    c = (c ~= 0) & (one == 1);
    y = b .* one;
    a = a .* one;
    y(c) = a(c);
end
""",
    "spread__": """\
function y = spread__(entries)
    % one row an entry, which may be one number for all points
    count = max(cellfun(@(e) size(e, 2), entries));
    y = zeros(numel(entries), count);
    for k = 1:numel(entries)
        y(k, :) = entries{k};
    end
end
""",
    "factor__": """\
function y = factor__(n, symmetric, entries)
    % matrices of shape (n, n, points) from their entries, or their upper triangles, by rows
    values = spread__(entries);
    y = zeros(n, n, size(values, 2));
    k = 0;
    for i = 1:n
        for j = (1 + symmetric * (i - 1)):n
            k = k + 1;
            y(i, j, :) = values(k, :);
            if symmetric
                y(j, i, :) = values(k, :);
            end
        end
    end
end
""",
    "back__": """\
function y = back__(matrices, right)
    % solutions in shape (n, points), by LU with pivots; infinite or NaN where a matrix is singular
    right = spread__(right);
    n = size(right, 1);
    count = max(size(right, 2), size(matrices, 3));
    y = right .* ones(n, count);
    for k = 1:count
        if size(matrices, 3) > 1 || k == 1
            [L, U, P] = lu(matrices(:, :, k));
        end
        b = P * y(:, k);
        for i = 2:n
            b(i) = b(i) - L(i, 1:i - 1) * b(1:i - 1);
        end
        for i = n:-1:1
            b(i) = (b(i) - U(i, i + 1:n) * b(i + 1:n)) / U(i, i);
        end
        y(:, k) = b;
    end
end
""",
}

_HEAD = """\
function model = {name}_system()
% {title}: equations of motion, generated by eom.
%
%   model = {name}_system() holds functions and names. Every function takes time t, states x, parameters p
%   and inputs u: model.rates(t, x, p, u), in the order of model.state_names and so on, in SI units.
%   Columns are points: x has shape (n, 1) or (n, N), the result (k, 1) or (k, N). An integration:
%
%   [t, x] = ode45(@(t, x) model.rates(t, x, p, u), [0, 10], x0);
{lines}
end
"""


def files(program: Program, layout: Layout) -> Mapping[str, str]:
    """Return the generated function file by name; the same input gives the same bytes.

    It is called NAME_system.m: many a name alone is that of a function of both programs, as ``full``.
    """
    return {f"{identifier(layout.name)}_system.{MATLAB.extension}": function_file(program, layout)}


def function_file(program: Program, layout: Layout) -> str:
    """Return the file: a function that returns a structure, one local function a group, helpers."""
    written = {g: _with_places(body) for g, body in bodies(MATLAB, program, layout).items()}
    tables = name_tables(layout)
    lines = [f"    model.{group} = @{group}_;" for group in written]
    lines += [f"    model.{_field(key)} = {_literal(values)};" for key, values in tables.items()]
    name = identifier(layout.name)
    head = _HEAD.format(name=name, title=comment(layout.title), lines="\n".join(lines))
    functions = [_function(group, body) for group, body in written.items()]
    used = [*used_helpers(MATLAB, written), *used_tables(MATLAB, table_names(program), written)]
    return "\n".join([head, *functions, *used])


def _field(key: str) -> str:
    """Return the name of a list of names, as ``state_names``; functions have those of their groups."""
    name = key.lower()
    return name if name.endswith("_pattern") else f"{name.removesuffix('s')}_names"


_PLACE = re.compile(r"\(1 \+ (\d+), :\)")


def _counted(text: str) -> str:
    """Write places from one: ``x(1 + 0, :)`` becomes ``x(1, :)``."""
    return _PLACE.sub(lambda m: f"({int(m[1]) + 1}, :)", text)


def _with_places(body: Body) -> Body:
    lines = tuple(line._replace(expression=_counted(line.expression)) for line in body.lines)
    return Body(lines, tuple(map(_counted, body.results)))


def _literal(values: Sequence[object]) -> str:
    """Write names as a cell array, and places as a matrix with a row each, from one."""
    if all(isinstance(v, str) for v in values):
        return "{" + ", ".join(_string(str(v)) for v in values) + "}"
    rows = "; ".join(", ".join(str(k + 1) for k in v) for v in values if isinstance(v, tuple))
    return f"[{rows}]"


def _string(text: str) -> str:
    """Write a string of ASCII; what is not ASCII as its bytes, which both programs decode."""
    if text.isascii() and text.isprintable():
        return "'" + text.replace("'", "''") + "'"
    return f"native2unicode(uint8([{' '.join(map(str, text.encode()))}]), 'UTF-8')"


def _function(group: str, body: Body) -> str:
    lines = [f"function y = {group}_(t, x, p, u)"]
    lines += [f"    if nargin < {k}, {a} = []; end" for k, a in ((3, "p"), (4, "u"))]
    lines += ["    t = reshape(t, 1, []);"]
    for line in body.lines:
        text = line.expression if line.room else f"{line.variable} = {line.expression};"
        lines.append(f"    {text}" + (f"  % {line.comment}" if line.comment else ""))
    count = "max([numel(t), size(x, 2), size(p, 2), size(u, 2)])"
    lines += [f"    y = zeros({len(body.results)}, {count});"]
    lines += [f"    y({k}, :) = {result};" for k, result in enumerate(body.results, 1)]
    return "\n".join([*lines, "end", ""])


def _table(name: str, table: Table) -> str:
    """Return the function of a table: the piece by comparison, then a polynomial by Horner's rule."""
    first, last = table.breakpoints[0], table.breakpoints[-1]
    polynomial = re.sub(
        r"c\[(\d+)\]", lambda m: f"c({int(m[1]) + 1}, :)", nested(len(table.rows[0]))
    )
    inside = f"min(max(x, {first!r}), {last!r}) + 0 * x" if table.flat_outside else "x"
    rows = "\n".join(f"        {', '.join(map(repr, row))};" for row in table.rows)
    start = textwrap.fill(", ".join(map(repr, table.breakpoints)), 90).replace(
        "\n", " ...\n        "
    )
    return f"""\
function y = {name}(x)
    % Table {comment(table.label)}: {table.kind}; outside: {table.outside}.
    start = [{start}];
    rows = [
{rows}
    ];
    row = sum(bsxfun(@ge, x, start.'), 1);
    h = {inside} - start(max(row, 1));
    c = rows(row + 1, :).';
    y = {polynomial.replace(" * ", " .* ")};
end
"""


MATLAB = Target(
    name="matlab",
    extension="m",
    templates=TEMPLATES,
    slots={
        "time": "t",
        "state": "x(1 + {0}, :)",
        "parameter": "p(1 + {0}, :)",
        "input": "u(1 + {0}, :)",
    },
    numbers={"inf": "Inf", "-inf": "(-Inf)", "nan": "NaN"},
    files=files,
    helpers=_HELPERS,
    unsupported=dict.fromkeys(("besselj", "bessely"), "choose target c or numpy"),
    table=_table,
)
