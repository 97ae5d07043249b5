"""The JavaScript target: an ES module of one file, for browsers and Node.js; it imports nothing.

JavaScript's ``Math`` is IEEE 754 where C is, but for the zero of ``sign``, the powers of one and
minus one, and functions that it lacks; helper functions close the gaps.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import NamedTuple

from codegen.frontend.layout import Layout
from codegen.ir.names import comment, identifier
from codegen.ir.passes import prune
from codegen.ir.program import Name, Program
from codegen.ir.stumpff import SERIES
from codegen.targets.render import (
    ARITHMETIC,
    Body,
    Names,
    Template,
    calls,
    leaf_names,
    render,
    table_names,
)
from codegen.targets.target import (
    Target,
    bodies,
    name_tables,
    nested,
    used_helpers,
    used_tables,
)
from codegen.watch.narrow import AHEAD, VERDICT, WATCHED, Narrow, narrow
from eom.tables import Table

TEMPLATES: dict[str, Template] = {
    **ARITHMETIC,
    **calls("Math.{}", "sqrt sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh atan2"),
    **calls("Math.{}", "exp expm1 log log1p abs floor hypot"),
    **calls("_{}", "pow sign min max mod erf erfc stumpff"),
    "table": Template("{data}({0})"),
    "factor": Template("const {v} = _factor({n}, {symmetric}, [{entries}]);"),
    "back": Template("const {v} = _back({factor}, [{entries}]);"),
    "item": Template("{0}[{data}]"),
    "lt": Template("({0} < {1} ? 1 : 0)", 100, (6, 6)),
    "le": Template("({0} <= {1} ? 1 : 0)", 100, (6, 6)),
    "eq": Template("({0} === {1} ? 1 : 0)", 100, (6, 6)),
    "and": Template("({0} !== 0 && {1} !== 0 ? 1 : 0)", 100, (6, 6)),
    "or": Template("({0} !== 0 || {1} !== 0 ? 1 : 0)", 100, (6, 6)),
    "not": Template("({0} === 0 ? 1 : 0)", 100, (6,)),
    "select": Template("({0} !== 0 ? {1} : {2})", 100, (6, 3, 3)),
}
"""Conditions are numbers, 0 or 1."""

ERFC_MIDDLE = 3.75
ERFC_SERIES = (
    1.1775789345674017, -0.004590054580646478, -0.08424913336651792, 0.05920993999819189,
    -0.026658668435305753, 0.009074997670705265, -0.002413163540417608, 0.0004907758365258086,
    -6.916973302501207e-05, 4.13902798607301e-06, 7.74038306619849e-07, -2.1886401049234397e-07,
    1.076499946567091e-08, 4.521959811218287e-09, -7.754400208831351e-10, -6.318088340886684e-11,
    2.86879501093067e-11, 1.9455868545777347e-13, -9.65469674843344e-13, 3.25254814814874e-14,
    3.3478119482868056e-14, -1.864562880419313e-15, -1.2507950530688648e-15, 7.418235256624044e-17,
    5.0681489047961116e-17, -2.2370566594359995e-18, -2.1873429443030175e-18,
)  # fmt: skip
"""Chebyshev coefficients of (1 + 2 x) exp(x^2) erfc(x) in (x - 3.75) / (x + 3.75), x >= 0, the
first one halved; M. M. Shepherd and J. G. Laframboise, Math. Comp. 36 (1981) 249-253."""

ERROR_ULPS = 4.0
"""Error of `erf` and `erfc` in units in the last place, at most; a test measures it."""
_STUMPFF_ROWS = "\n".join(f"  [{end!r}, {terms}]," for end, terms in SERIES.values())
_ERFC_ROWS = "\n".join(f"  {c!r}," for c in ERFC_SERIES)

_HELPERS: dict[str, str] = {
    "_pow": """\
function _pow(a, b) { // 1 to any power is 1, and -1 to an infinite one
  return a === 1 || (a === -1 && Math.abs(b) === Infinity) ? 1 : Math.pow(a, b);
}
""",
    "_sign": """\
function _sign(a) {
  return a > 0 ? 1 : a < 0 ? -1 : a + 0;
}
""",
    "_min": """\
function _min(a, b) {
  return a < b || a !== a ? a : b;
}
""",
    "_max": """\
function _max(a, b) {
  return a > b || a !== a ? a : b;
}
""",
    "_mod": """\
function _mod(a, b) { // with the sign of b
  const r = a % b;
  if (r === 0) return b < 0 ? -0 : 0;
  return (r < 0) !== (b < 0) ? r + b : r;
}
""",
    "_ERFC": f"""\
const _ERFC = [
{_ERFC_ROWS}
];
""",
    "_erfcUpper": f"""\
function _erfcUpper(x) {{ // erfc(x) for x >= 0.5, by a Chebyshev series
  if (x > 28) return 0;
  const t = (x - {ERFC_MIDDLE}) / (x + {ERFC_MIDDLE});
  let a = 0, b = 0;
  for (let k = _ERFC.length - 1; k > 0; --k) {{
    const next = 2 * t * a - b + _ERFC[k];
    b = a;
    a = next;
  }}
  const h = Math.fround(x); // 24 bits, so that the square is exact
  return (t * a - b + _ERFC[0]) / (1 + 2 * x) * Math.exp(-h * h) * Math.exp((h - x) * (h + x));
}}
""",
    "_erfLower": f"""\
function _erfLower(x) {{ // erf(x) for |x| < 0.5, by its power series
  let term = 1, sum = 1;
  for (let n = 1; n < 14; ++n) {{
    term *= -x * x / n;
    sum += term / (2 * n + 1);
  }}
  return {2 / math.sqrt(math.pi)!r} * x * sum;
}}
""",
    "_erf": """\
function _erf(x) {
  if (Math.abs(x) < 0.5) return _erfLower(x);
  return x < 0 ? _erfcUpper(-x) - 1 : 1 - _erfcUpper(x);
}
""",
    "_erfc": """\
function _erfc(x) {
  if (Math.abs(x) < 0.5) return 1 - _erfLower(x);
  return x < 0 ? 2 - _erfcUpper(-x) : _erfcUpper(x);
}
""",
    "_STUMPFF": f"""\
const _STUMPFF = [
{_STUMPFF_ROWS}
];
""",
    "_factor": """\
// P A = L U by rows, with the order of the rows; a symmetric A is given as its upper triangle.
function _factor(n, symmetric, entries) {
  const a = Array.from({ length: n }, () => new Float64Array(n));
  let place = 0;
  for (let i = 0; i < n; ++i)
    for (let j = symmetric ? i : 0; j < n; ++j) {
      a[i][j] = entries[place++];
      if (symmetric) a[j][i] = a[i][j];
    }
  const order = Array.from({ length: n }, (_, i) => i);
  for (let k = 0; k < n; ++k) {
    let best = k;
    for (let i = k + 1; i < n; ++i) if (Math.abs(a[i][k]) > Math.abs(a[best][k])) best = i;
    [a[k], a[best]] = [a[best], a[k]];
    [order[k], order[best]] = [order[best], order[k]];
    for (let i = k + 1; i < n; ++i) {
      a[i][k] /= a[k][k];
      for (let j = k + 1; j < n; ++j) a[i][j] -= a[i][k] * a[k][j];
    }
  }
  return [a, order];
}
""",
    "_back": """\
function _back([a, order], right) {
  const n = order.length;
  const x = order.map((k) => right[k]);
  for (let i = 1; i < n; ++i) for (let j = 0; j < i; ++j) x[i] -= a[i][j] * x[j];
  for (let i = n - 1; i >= 0; --i) {
    for (let j = i + 1; j < n; ++j) x[i] -= a[i][j] * x[j];
    x[i] /= a[i][i];
  }
  return x;
}
""",
    "_stumpff": """\
// The sum over j of (-z)^j / (2 j + k)!: a series near zero, sine or sinh and a recurrence elsewhere.
function _stumpff(k, z) {
  const [end, terms] = _STUMPFF[k - 1];
  let c = 1, factorial = 1;
  if (Math.abs(z) < end) {
    for (let j = terms; j > 0; --j) c = 1 - z * c / ((2 * j + k - 1) * (2 * j + k));
    for (let n = 2; n <= k; ++n) factorial *= n;
    return c / factorial;
  }
  const s = Math.sqrt(Math.abs(z)), angle = k % 2 ? s : 0.5 * s;
  c = (z > 0 ? Math.sin(angle) : Math.sinh(angle)) / s;
  if (k % 2 === 0) {
    c = 2 * c * c;
    factorial = 2;
  }
  for (let n = 2 - k % 2; n < k; n += 2) {
    c = (1 / factorial - c) / z;
    factorial *= (n + 1) * (n + 2);
  }
  return c;
}
""",
}

_HEAD = """\
// {title}: equations of motion, generated by eom.
//
// Every function takes time t, states x, parameters p and inputs u (a number and arrays), and fills
// and returns y, which may be x. All in SI units.
"""

_ABOUT = {
    AHEAD: """\
// For integrators: what time alone brings from now on. x: now, both ends of a stretch of time, minus the
// logarithm of what is nothing; y: whether operations keep their character, and pieces stay.
""",
    WATCHED: """\
// For integrators: the rates, then the values that give narrow features of them away.
""",
    VERDICT: """\
// For integrators: how much of a step these values allow. x: each now, its least and largest, then what
// `ahead` has last; y: the share of each operation, and whether each piece stays.
""",
}


NEAREST = "nearestAngle"
"""Name of the function that undoes the jumps of outputs that are angles of a quaternion."""
_NEAREST = """\
// The angle that differs from {angles}
// by whole turns and is nearest to the previous one: call it from sample to sample, first with
// previous = 0, where the angle moves by less than pi in between. Nothing else counts whole turns.
{export}function {name}(angle, previous) {{
  return angle + 6.283185307179586 * Math.floor((previous - angle) / 6.283185307179586 + 0.5);
}}
"""


def files(program: Program, layout: Layout) -> Mapping[str, str]:
    """Return the generated module by file name; the same input gives the same bytes."""
    return {f"{identifier(layout.name)}.{JAVASCRIPT.extension}": module(program, layout)}


def module(program: Program, layout: Layout) -> str:
    """Return the module: sizes, names and one function a group of results."""
    return _text(_parts(program, layout), layout, "export ")


def function(program: Program, layout: Layout) -> str:
    """Return the module as one expression: a function that returns what the module exports.

    For scripts of pages, which hold several systems and load no modules.
    """
    parts = _parts(program, layout)
    names = ", ".join([*parts.constants, *parts.bodies, *([NEAREST] if layout.winds else [])])
    return f"function () {{\n{_text(parts, layout, '')}\nreturn {{ {names} }};\n}}"


class _Parts(NamedTuple):
    """What a module holds: constants and bodies of functions by name, texts of helpers and tables."""

    constants: Mapping[str, object]
    bodies: Mapping[str, Body]
    helpers: list[str]


def _parts(program: Program, layout: Layout) -> _Parts:
    found = narrow(program)
    further = {
        g: p
        for g, p in ((AHEAD, found.ahead), (WATCHED, found.watched), (VERDICT, found.verdict))
        if p is not None
    }
    tables = table_names(program, *further.values())
    names = _names_of_slots(layout)
    written = bodies(JAVASCRIPT, program, layout)
    for g, p in further.items():
        how = JAVASCRIPT.templates, JAVASCRIPT.slots, JAVASCRIPT.numbers, tables
        written[g] = render(prune(p, [g]), g, names[g], *how)
    constants = {
        "TITLE": layout.title,
        **name_tables(layout),
        "SIZES": layout.sizes,
        "COORDINATES": layout.coordinates,
        **({"UNITS": tuple(q.unit for q in layout.states)} if layout.patterns else {}),
        **({"WATCH": _numbers(found)} if found.watched else {}),
    }
    helpers = used_helpers(JAVASCRIPT, written), used_tables(JAVASCRIPT, tables, written)
    return _Parts(constants, written, [*helpers[0], *helpers[1]])


def _names_of_slots(layout: Layout) -> dict[str, Names]:
    """Return the names of the slots of each program of `codegen.watch.narrow`."""
    own = leaf_names(layout)
    times = [Name(name) for name in ("now", "earlier", "later", "depth")]
    return {AHEAD: {**own, "state": times}, WATCHED: own, VERDICT: {}}


def _numbers(found: Narrow) -> dict[str, object]:
    """Return what integrators are given of the columns that are watched, as `Narrow` says it."""
    return {
        "columns": found.columns,
        "guards": found.guards,
        "pieces": found.pieces,
        "always": found.soon,
        "toZero": found.to_zero,
    }


def _text(parts: _Parts, layout: Layout, export: str) -> str:
    constants = [f"{export}const {k} = {_json(v)};" for k, v in parts.constants.items()]
    head = "\n".join([_HEAD.format(title=comment(layout.title)), *constants, ""])
    functions = [
        _ABOUT.get(name, "") + export + _function(name, body) for name, body in parts.bodies.items()
    ]
    if layout.winds:
        listed = " or ".join(f"the output {comment(n)}" for n in layout.winds)
        functions.append(_NEAREST.format(angles=listed, export=export, name=NEAREST))
    return "\n".join([head, *parts.helpers, *functions])


def _table(name: str, table: Table) -> str:
    """Return the function of a table: a binary search, then a polynomial by Horner's rule."""
    first, last = table.breakpoints[0], table.breakpoints[-1]
    inside = f"x < {first!r} ? {first!r} : x > {last!r} ? {last!r} : x"
    rows = "\n".join(f"  {_json(row)}," for row in table.rows)
    return f"""\
// Table {comment(table.label)}: {table.kind}; outside: {table.outside}.
const {name}start = {_json(table.breakpoints)};
const {name}rows = [
{rows}
];
function {name}(x) {{
  let low = 0, high = {len(table.breakpoints)};
  while (low < high) {{
    const middle = (low + high) >> 1;
    if ({name}start[middle] <= x) low = middle + 1;
    else high = middle;
  }}
  const c = {name}rows[low];
  const h = ({inside if table.flat_outside else "x"}) - {name}start[Math.max(low - 1, 0)];
  return {nested(len(table.rows[0]))};
}}
"""


def _json(value: object) -> str:
    """Return a literal that cannot end a script element of a page either."""
    return json.dumps(value).replace("<", "\\u003c")


def _function(group: str, body: Body) -> str:
    y = f"y = new Float64Array({len(body.results)})"
    lines = [f"function {group}(t, x, p = [], u = [], {y}) {{"]
    for line in body.lines:
        text = line.expression if line.room else f"const {line.variable} = {line.expression};"
        lines.append(f"  {text}" + (f" // {line.comment}" if line.comment else ""))
    lines += [f"  y[{k}] = {result};" for k, result in enumerate(body.results)]
    return "\n".join([*lines, "  return y;", "}", ""])


JAVASCRIPT = Target(
    name="javascript",
    extension="mjs",
    templates=TEMPLATES,
    slots={"time": "t", "state": "x[{0}]", "parameter": "p[{0}]", "input": "u[{0}]"},
    numbers={"inf": "Infinity", "-inf": "(-Infinity)", "nan": "NaN"},
    files=files,
    helpers=_HELPERS,
    unsupported=dict.fromkeys(("besselj", "bessely"), "choose target c or numpy"),
    table=_table,
)
