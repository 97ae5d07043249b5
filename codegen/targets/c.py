"""The C99 target: a header and a source file; no malloc, no globals, memory owned by the caller."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence

from codegen.layout import Layout, names_of
from codegen.linsolve import C_HELPERS
from codegen.lower import INVARIANTS, OUTPUTS, RATES
from codegen.names import comment, identifier
from codegen.passes import prune
from codegen.program import Program
from codegen.stages import CLOCK, CONSTANT, by_parameters, by_time
from codegen.stumpff import SERIES
from codegen.targets.render import (
    ATOM,
    Body,
    Line,
    Names,
    Tables,
    Template,
    infix,
    leaf_names,
    render,
    split,
    table_names,
    with_slots_of,
)
from eom.system import Quantity
from eom.tables import Table


def _call(name: str, arity: int = 1) -> Template:
    return Template(f"{name}({', '.join(f'{{{k}}}' for k in range(arity))})")


TEMPLATES: dict[str, Template] = {
    "add": infix("+", 10),
    "sub": infix("-", 10),
    "mul": infix("*", 20),
    "div": infix("/", 20),
    "neg": Template("-{0}", 15, (20,)),
    "pow": _call("pow", 2),
    "sqrt": _call("sqrt"),
    "sin": _call("sin"),
    "cos": _call("cos"),
    "tan": _call("tan"),
    "asin": _call("asin"),
    "acos": _call("acos"),
    "atan": _call("atan"),
    "sinh": _call("sinh"),
    "cosh": _call("cosh"),
    "tanh": _call("tanh"),
    "asinh": _call("asinh"),
    "acosh": _call("acosh"),
    "atanh": _call("atanh"),
    "exp": _call("exp"),
    "log": _call("log"),
    "atan2": _call("atan2", 2),
    "abs": _call("fabs"),
    "sign": _call("sign_", 1),
    "min": _call("min_", 2),
    "max": _call("max_", 2),
    "lt": Template("(double)({0} < {1})", 50, (6, 6)),
    "le": Template("(double)({0} <= {1})", 50, (6, 6)),
    "eq": Template("(double)({0} == {1})", 50, (6, 6)),
    "and": Template("(double)({0} != 0.0 && {1} != 0.0)", 50, (6, 6)),
    "or": Template("(double)({0} != 0.0 || {1} != 0.0)", 50, (6, 6)),
    "not": Template("(double)({0} == 0.0)", 50, (6,)),
    "floor": _call("floor"),
    "mod": _call("mod_", 2),
    "hypot": _call("hypot", 2),
    "erf": _call("erf"),
    "erfc": _call("erfc"),
    "expm1": _call("expm1"),
    "log1p": _call("log1p"),
    "besselj": Template("jn((int){0}, {1})", ATOM, (ATOM, 0)),
    "bessely": Template("yn((int){0}, {1})", ATOM, (ATOM, 0)),
    "stumpff": Template("stumpff_((int){0}, {1})", ATOM, (ATOM, 0)),
    "table": Template("{data}({0})"),
    "factor": Template("double {v}[{room}] = {{{entries}}};\n    factor_({n}, {symmetric}, {v});"),
    "back": Template("double {v}[{n}] = {{{entries}}};\n    back_({n}, {factor}, {v});"),
    "item": Template("{0}[{data}]"),
    "select": Template("({0} != 0.0 ? {1} : {2})", 100, (6, 3, 3)),
}
"""Conditions are doubles, 0 or 1, so that every value has one type."""

PART_LINES = 400
"""Functions with more assignments are split into parts of so many."""

_HELPERS = {
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
        for (int j = terms[k - 1]; j > 0; --j) c = 1.0 - z * c / ((2.0 * j + k - 1.0) * (2.0 * j + k));
        for (int n = 2; n <= k; ++n) factorial *= n;
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
        factorial *= (n + 1.0) * (n + 2.0);
    }}
    return c;
}}""",
    **C_HELPERS,
}
_NUMBERS = {"inf": "INFINITY", "-inf": "(-INFINITY)", "nan": "NAN"}
_SLOTS = {
    "time": "t",
    "state": "x[{0} * xs]",
    "parameter": "p[{0} * ps]",
    "input": "u[{0} * us]",
    CONSTANT: "c[{0}]",
    CLOCK: "w[{0}]",
}
_EARLY = ("const double *p", "ptrdiff_t ps")
_TIMED = ("double t", "const double *c")
_LATE = (
    "double t",
    "const double *x",
    "ptrdiff_t xs",
    "const double *c",
    "const double *w",
    "const double *u",
    "ptrdiff_t us",
)
_CARRIED = "double *carried_"


def files(program: Program, layout: Layout) -> Mapping[str, str]:
    """Return header and source by file name; the same input gives the same bytes."""
    name = identifier(layout.name)
    return {f"{name}.h": header(program, layout), f"{name}.c": source(program, layout)}


def header(program: Program, layout: Layout) -> str:
    """Return the header: sizes, names and one function a group of results."""
    name = identifier(layout.name)
    constants = len(by_parameters(program, layout.sizes).values)
    guard = f"{name.upper()}_H"
    lines = [
        f"/* {comment(layout.title)}: equations of motion, generated by eom.",
        " *",
        " * t: time; x: states; p: parameters; u: inputs (NULL where there are none). All in SI units.",
        f" * {name}_prepare(p, &c)",
        " * computes what depends on parameters alone: call it first, and again only when p changes.",
        " * Every function writes its results to y, which may overlap x. The batch forms",
        " * evaluate count points, and prepare by themselves: the element i of point k stands at",
        " * a[i * a_row + k * a_column], time at t[k * t_step].",
        " */",
        f"#ifndef {guard}",
        f"#define {guard}",
        "",
        "#include <stddef.h>",
        "",
        "#ifdef __cplusplus",
        'extern "C" {',
        "#endif",
        "",
        *_index_comment("x", "states", layout.states),
        *_index_comment("p", "parameters", layout.parameters),
        *_index_comment("u", "inputs", layout.inputs),
        "",
        *(f"enum {{ {name}_n_{key} = {count} }};" for key, count in _counts(layout).items()),
        "",
        *(f"const char *{name}_{kind}_name(int k);" for kind in _named(layout)),
        "",
        f"typedef struct {{ double value[{max(1, constants)}]; }} {name}_constants;",
        f"{_prepare_signature(name)};",
        "",
    ]
    for group in layout.sizes:
        lines += [f"{_signature(name, group)};", f"{_batch_signature(name, group)};"]
    return "\n".join(
        [*lines, "", "#ifdef __cplusplus", "}", "#endif", "", f"#endif /* {guard} */", ""]
    )


def single_text(program: Program, layout: Layout) -> str:
    """Return header and source as one text that compiles by itself."""
    include = f'#include "{identifier(layout.name)}.h"\n'
    return header(program, layout) + source(program, layout).replace(include, "")


def source(program: Program, layout: Layout) -> str:
    """Return the source file of all groups of results."""
    name = identifier(layout.name)
    cut = by_parameters(program, layout.sizes)
    names = leaf_names(layout)
    tables = table_names(program)
    early = _render(cut.early, CONSTANT, names, tables)
    slots = with_slots_of(cut, program, names)
    groups = {g: _staged(cut.late, g, slots, tables) for g in layout.sizes}
    used = "\n".join(_texts(b) for b in (early, *(b for pair in groups.values() for b in pair)))
    lines = [
        f"/* {comment(layout.title)}: equations of motion, generated by eom. */",
        f'#include "{name}.h"',
        "",
        "#include <math.h>",
        "",
        *(f"{text}\n" for helper, text in _HELPERS.items() if f"{helper}(" in used),
        *(f"{_table(n, table)}\n" for table, n in tables.items() if f"{n}(" in used),
    ]
    for kind, listed in _named(layout).items():
        lines += [_name_function(name, kind, listed), ""]
    lines += [*_prepare(name, early), ""]
    for group, (timed, late) in groups.items():
        head, size = f"{name}_{group}", len(timed.results)
        if size:
            lines += [*_kernel(f"{head}_clock", _TIMED, timed, "double *w", "w[{0}]"), ""]
        lines += [
            *_kernel(f"{head}_kernel", _LATE, late, "double *y, ptrdiff_t ys", "y[{0} * ys]"),
            "",
            _scalar(name, group, size),
            "",
            _batch(name, group, bool(early.results), size),
            "",
        ]
    return "\n".join(lines)


def _render(program: Program, group: str, names: Names, tables: Tables) -> Body:
    return render(program, group, names, TEMPLATES, _SLOTS, _NUMBERS, tables)


def _staged(program: Program, group: str, names: Names, tables: Tables) -> tuple[Body, Body]:
    """Return what a group needs of time alone, and the rest."""
    whole = prune(program, [group])
    cut = by_time(whole)
    rest = with_slots_of(cut, whole, names)
    return _render(cut.early, CLOCK, names, tables), _render(cut.late, group, rest, tables)


def _texts(body: Body) -> str:
    return "\n".join((*(line.expression for line in body.lines), *body.results))


def _table(name: str, table: Table) -> str:
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


def _counts(layout: Layout) -> dict[str, int]:
    outer = {"states": layout.states, "parameters": layout.parameters, "inputs": layout.inputs}
    results = {g: len(names) for g, names in layout.results.items() if g != RATES}
    return {**{k: len(v) for k, v in outer.items()}, **results}


def _named(layout: Layout) -> dict[str, Sequence[str]]:
    return {
        "state": names_of(layout.states),
        "parameter": names_of(layout.parameters),
        "input": names_of(layout.inputs),
        "output": layout.results[OUTPUTS],
        "invariant": layout.results[INVARIANTS],
    }


def _index_comment(array: str, what: str, quantities: Sequence[Quantity]) -> list[str]:
    if not quantities:
        return []
    lines = [f"/* {array}: {what}"]
    for k, q in enumerate(quantities):
        lines.append(f" *   {array}[{k}] {comment(q.name)}: {comment(q.description)}".rstrip(": "))
    return [*lines, " */"]


def string(text: str) -> str:
    """Return a C string literal; everything but plain ASCII letters, digits and signs is escaped."""
    octal = "".join(
        chr(b)
        if (b < 128 and chr(b).isalnum()) or chr(b) in " _+-*/^()[]{}.,':;=<>"
        else f"\\{b:03o}"
        for b in text.encode()
    )
    return f'"{octal}"'


def _name_function(name: str, kind: str, names: Sequence[str]) -> str:
    head = f"const char *{name}_{kind}_name(int k) {{"
    if not names:
        return "\n".join([head, "    (void)k;", "    return NULL;", "}"])
    listed = ", ".join(string(n) for n in names)
    return "\n".join(
        [
            head,
            f"    static const char *const names[] = {{{listed}}};",
            f"    return k >= 0 && k < {len(names)} ? names[k] : NULL;",
            "}",
        ]
    )


def _prepare_signature(name: str) -> str:
    return f"void {name}_prepare(const double *p, {name}_constants *c)"


def _signature(name: str, group: str) -> str:
    head = f"void {name}_{group}(double t, const double *x,"
    return f"{head}\n    const {name}_constants *c, const double *u, double *y)"


def _batch_signature(name: str, group: str) -> str:
    arrays = [f"const double *{a}, ptrdiff_t {a}_row, ptrdiff_t {a}_column," for a in "xpu"]
    head = f"void {name}_{group}_batch(size_t count, const double *t, ptrdiff_t t_step,"
    return "\n    ".join([head, *arrays, "double *y, ptrdiff_t y_row, ptrdiff_t y_column)"])


def _stride(text: str) -> str:
    """Write the index 0 * xs as 0, and 1 * xs as xs."""
    return re.sub(r"\[0 \* \ws\]", "[0]", text).replace("[1 * ", "[")


def _prepare(name: str, early: Body) -> list[str]:
    """The first stage, over strided parameters, and its public form."""
    head = f"{name}_constants_kernel"
    return [
        *_kernel(head, _EARLY, early, "double *c", "c[{0}]"),
        "",
        f"{_prepare_signature(name)} {{",
        f"    {head}(p, 1, c->value);",
        "}",
    ]


def _kernel(
    head: str, arguments: Sequence[str], body: Body, target: str, place: str
) -> Sequence[str]:
    """A computation over strided arrays: all loads, then all stores, so that y may overlap x.

    ``target``: declaration of where results go; ``place``: how the result {0} is written there. A
    long computation is split into parts, so that the time of compilers stays linear; what a later
    part needs of an earlier one goes through an array on the stack.
    """
    stores = [f"    {_stride(place.format(k))} = {r};" for k, r in enumerate(body.results)]
    if len(body.lines) <= PART_LINES:
        return _static(head, "inline void", (*arguments, target), [*_assigned(body.lines), *stores])
    parts, size = split(body, PART_LINES)
    texts: list[str] = []
    calls = []
    for k, part in enumerate(parts):
        lines = [_load(line, slot) for line, slot in part.loads]
        lines += _assigned(part.lines)
        lines += [_store(line, slot) for line, slot in part.stores]
        last = k == len(parts) - 1
        declared = (*arguments, _CARRIED, *((target,) if last else ()))
        texts += [*_static(f"{head}_{k}", "void", declared, lines + (stores if last else [])), ""]
        calls.append(f"    {head}_{k}({', '.join(_variables(declared))});")
    return [
        *texts,
        *_static(head, "void", (*arguments, target), [f"    double carried_[{size}];", *calls]),
    ]


def _load(line: Line, slot: int) -> str:
    if line.room:
        return f"    const double *const {line.variable} = carried_ + {slot};"
    return f"    const double {line.variable} = carried_[{slot}];"


def _store(line: Line, slot: int) -> str:
    if line.room:
        copy = f"carried_[{slot} + k_] = {line.variable}[k_];"
        return f"    for (int k_ = 0; k_ < {line.room}; ++k_) {copy}"
    return f"    carried_[{slot}] = {line.variable};"


def _variables(declared: Sequence[str]) -> list[str]:
    """Return the names of declared arguments."""
    return [a.split()[-1].lstrip("*") for text in declared for a in text.split(",")]


def _static(name: str, kind: str, declared: Sequence[str], lines: Sequence[str]) -> list[str]:
    """Return a static function; arguments that it does not use give no warning."""
    return [
        f"static {kind} {name}(",
        f"    {', '.join(declared)}) {{",
        f"    {', '.join(f'(void){a}' for a in _variables(declared))};",
        *lines,
        "}",
    ]


def _assigned(lines: Sequence[Line]) -> list[str]:
    return [
        f"    {_stride(line.expression)}"
        if line.room
        else f"    const double {line.variable} = {_stride(line.expression)};"
        + (f" /* {line.comment} */" if line.comment else "")
        for line in lines
    ]


def _scalar(name: str, group: str, timed: int) -> str:
    head = f"{name}_{group}"
    return "\n".join(
        [
            f"{_signature(name, group)} {{",
            *([f"    double w[{timed}];", f"    {head}_clock(t, c->value, w);"] if timed else []),
            f"    {head}_kernel(t, x, 1, c->value, {'w' if timed else 'NULL'}, u, 1, y, 1);",
            "}",
        ]
    )


def _batch(name: str, group: str, prepared: bool, timed: int) -> str:
    """A loop over points; earlier stages run again only where parameters or times differ."""
    head = f"{name}_{group}"
    c, w = "c.value" if prepared else "NULL", "w" if timed else "NULL"
    declared, first, again = [], [], []
    if prepared:
        declared.append(f"    {name}_constants c;")
        first.append(f"    {name}_constants_kernel(p, p_row, c.value);")
        again += [
            "        if (k > 0 && p_column != 0)",
            f"            {name}_constants_kernel(p + j * p_column, p_row, c.value);",
        ]
    if timed:
        declared.append(f"    double w[{timed}];")
        first.append(f"    {head}_clock(t[0], {c}, w);")
        again += [
            "        if (k > 0 && (t_step != 0 || p_column != 0))",
            f"            {head}_clock(t[j * t_step], {c}, w);",
        ]
    return "\n".join(
        [
            f"{_batch_signature(name, group)} {{",
            *declared,
            *([] if prepared else ["    (void)p, (void)p_row, (void)p_column;"]),
            "    if (count == 0) return;",
            *first,
            "    for (size_t k = 0; k < count; ++k) {",
            "        const ptrdiff_t j = (ptrdiff_t)k;",
            *again,
            f"        {head}_kernel(t[j * t_step], x + j * x_column, x_row, {c}, {w},",
            "            u + j * u_column, u_row, y + j * y_column, y_row);",
            "    }",
            "}",
        ]
    )
