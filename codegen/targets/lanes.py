"""The C target in lanes: batches of points, one vector of points an operation.

The text is C99 with the vector extensions of gcc and clang, for any processor: `LANES_` doubles a
vector, 8 where the compiler may use AVX-512, 2 where SSE2 is all there is and 4 elsewhere, or what the
user defines (gcc -Wno-psabi, if those are wider than the registers). It computes what the C target
computes, in the same order; only the functions of `lanes_math` are its own. The others, tables and
linear systems are computed lane by lane. Every point has the same result in any lane, beside any
neighbours: results do not depend on how points are divided among threads.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from codegen.layout import Layout
from codegen.names import comment, identifier
from codegen.passes import prune
from codegen.program import Program
from codegen.stages import CLOCK, CONSTANT, by_parameters, by_time
from codegen.targets import c_helpers, lanes_math
from codegen.targets.render import (
    ATOM,
    EVERY_NUMBER,
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
from codegen.targets.target import Target, call, words

SUFFIX = "lanes"
PART_LINES = 400
"""Functions with more assignments are split into parts of so many."""

_OWN = ("sqrt", "sin", "cos", "tan", "exp", "log", "expm1", "tanh", "sign", "floor", "abs")
_LIBRARY = {
    "asin": "asin", "acos": "acos", "atan": "atan", "sinh": "sinh", "cosh": "cosh",
    "asinh": "asinh", "acosh": "acosh", "atanh": "atanh", "erf": "erf", "erfc": "erfc",
    "log1p": "log1p", "pow": "pow", "atan2": "atan2", "hypot": "hypot", "mod": "mod_",
}  # fmt: skip
"""Operations that are computed lane by lane, and the C functions of doubles that do it."""
_BINARY = frozenset({"pow", "atan2", "hypot", "mod"})
_ORDERED = {"besselj": "jn", "bessely": "yn", "stumpff": "stumpff_"}
"""The same, after an integer that all lanes share."""

TEMPLATES: dict[str, Template] = {
    "add": infix("+", 10),
    "sub": infix("-", 10),
    "mul": infix("*", 20),
    "div": infix("/", 20),
    "neg": call("lanes_neg_"),
    **{op: call(f"lanes_{op}_") for op in _OWN},
    "min": call("lanes_min_", 2),
    "max": call("lanes_max_", 2),
    "lt": Template("lanes_one_((mask_)({0} < {1}))", ATOM, (6, 6)),
    "le": Template("lanes_one_((mask_)({0} <= {1}))", ATOM, (6, 6)),
    "eq": Template("lanes_one_((mask_)({0} == {1}))", ATOM, (6, 6)),
    "and": Template("lanes_one_(lanes_true_({0}) & lanes_true_({1}))"),
    "or": Template("lanes_one_(lanes_true_({0}) | lanes_true_({1}))"),
    "not": Template("lanes_one_(~lanes_true_({0}))"),
    "select": Template("lanes_choose_(lanes_true_({0}), {1}, {2})"),
    **{
        op: call(f"lanes_{f.rstrip('_')}_", 2 if op in _BINARY else 1) for op, f in _LIBRARY.items()
    },
    **{op: call(f"lanes_{f.rstrip('_')}_", 2) for op, f in _ORDERED.items()},
    "table": Template("lanes_{data}({0})"),
    "factor": Template(
        "lane_ {v}[{room}] = {{{entries}}};\n    double {v}s_[{room}];\n"
        "    lanes_factor_({n}, {symmetric}, {room}, {v}, {v}s_);"
    ),
    "back": Template(
        "lane_ {v}[{n}] = {{{entries}}};\n    double {v}s_[{n} + 1 + {n} + {n} * {n}];\n"
        "    lanes_back_({n}, {factor}, {v}, {v}s_);"
    ),
    "item": Template("{0}[{data}]"),
}
"""Conditions are lanes of 0 and 1."""

_SLOTS = {
    "time": "lanes_load_(t)",
    "state": "lanes_load_(x + {0} * xs)",
    "parameter": "lanes_load_(p + {0} * LANES_)",
    "input": "lanes_load_(u + {0} * us)",
    CONSTANT: "c[{0}]",
    CLOCK: "w[{0}]",
}
_NUMBERS = {
    "inf": "INFINITY",
    "-inf": "-INFINITY",
    "nan": "NAN",
    EVERY_NUMBER: "lanes_all_({0})",
}
_EARLY = ("const double *p",)
_TIMED = ("const double *t", "const lane_ *c")
_LATE = (
    "const double *t",
    "const double *x",
    "ptrdiff_t xs",
    "const lane_ *c",
    "const lane_ *w",
    "const double *u",
    "ptrdiff_t us",
)
_LOCAL = ("c[{0}] = {1};", "lane_ *c"), ("w[{0}] = {1};", "lane_ *w")
_STORED = ("lanes_store_(y + {0} * ys, {1});", "double *y, ptrdiff_t ys")
_CARRIED = "lane_ *carried_"


def _by_lane(name: str, function: str, arguments: str) -> str:
    """Return the function of lanes that calls a function of doubles for each."""
    arrays = arguments.split()
    declared = ", ".join(f"lane_ {a}" for a in arrays)
    inside = ", ".join(f"{a}[k]" for a in arrays)
    return (
        f"APART_ lane_ {name}({declared}) {{\n    lane_ r;\n"
        f"    for (int k = 0; k < LANES_; ++k) r[k] = {function}({inside});\n    return r;\n}}"
    )


def _ordered(name: str, function: str) -> str:
    return (
        f"APART_ lane_ {name}(lane_ n, lane_ a) {{\n    lane_ r;\n"
        f"    for (int k = 0; k < LANES_; ++k) r[k] = {function}((int)n[k], a[k]);\n    return r;\n}}"
    )


_SOLVERS = {
    "lanes_factor_": """\
/* Lane by lane, through s. */
APART_ void lanes_factor_(int n, int symmetric, int room, lane_ *f, double *s) {
    const int given = symmetric ? n * (n + 1) / 2 : n * n;
    for (int k = 0; k < LANES_; ++k) {
        for (int i = 0; i < given; ++i) s[i] = f[i][k];
        factor_(n, symmetric, s);
        for (int i = 0; i < room; ++i) f[i][k] = s[i];
    }
}""",
    "lanes_back_": """\
APART_ void lanes_back_(int n, const lane_ *f, lane_ *x, double *s) {
    for (int k = 0; k < LANES_; ++k) {
        for (int i = 0; i < n; ++i) s[i] = x[i][k];
        for (int i = 0; i < 1 + n + n * n; ++i) s[n + i] = f[i][k];
        back_(n, s + n, s);
        for (int i = 0; i < n; ++i) x[i][k] = s[i];
    }
}""",
}

HELPERS: dict[str, str] = {
    **{
        name: c_helpers.HELPERS[name]
        for name in ("mod_", "jn", "yn", "stumpff_", "factor_", "back_")
    },
    **lanes_math.HELPERS,
    **{
        f"lanes_{f.rstrip('_')}_": _by_lane(
            f"lanes_{f.rstrip('_')}_", f, "a b" if op in _BINARY else "a"
        )
        for op, f in _LIBRARY.items()
    },
    **{
        f"lanes_{f.rstrip('_')}_": _ordered(f"lanes_{f.rstrip('_')}_", f) for f in _ORDERED.values()
    },
    **_SOLVERS,
}
"""Texts by name, each after those that it uses."""
_WORD = re.compile(r"[A-Za-z_]\w*")
_OWN_CALL = re.compile(rf"\blanes_({'|'.join(lanes_math.ULPS)})_\(")


def files(program: Program, layout: Layout) -> Mapping[str, str]:
    """Return header and source by file name; the same input gives the same bytes."""
    name = f"{identifier(layout.name)}_{SUFFIX}"
    return {f"{name}.h": header(layout), f"{name}.c": source(program, layout)}


def single_text(program: Program, layout: Layout) -> str:
    """Return header and source as one text that compiles by itself."""
    include = f'#include "{identifier(layout.name)}_{SUFFIX}.h"\n'
    return header(layout) + source(program, layout).replace(include, "")


def header(layout: Layout) -> str:
    """Return the header: one function a group of results."""
    name = identifier(layout.name)
    guard = f"{name.upper()}_{SUFFIX.upper()}_H"
    lines = [
        f"/* {comment(layout.title)}: equations of motion for many points, generated by eom.",
        " *",
        " * count points; the element i of point k stands at a[i * a_row + k * a_column], time at",
        " * t[k * t_step]. A column of 0 is one vector for all points. All in SI units. y may be x",
        " * itself, with the same row and column; otherwise y overlaps no argument.",
        " * Results of a point do not depend on the other points: threads may divide them.",
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
        *(f"{_signature(name, group)};" for group in layout.sizes),
        "",
        "#ifdef __cplusplus",
        "}",
        "#endif",
        "",
        f"#endif /* {guard} */",
        "",
    ]
    return "\n".join(lines)


@dataclass(frozen=True)
class _Group:
    """The bodies of a group of results: what depends on time alone, and the rest."""

    name: str
    timed: Body
    late: Body


def source(program: Program, layout: Layout) -> str:
    """Return the source file of all groups of results."""
    name = identifier(layout.name)
    cut = by_parameters(program, layout.sizes)
    names, tables = leaf_names(layout), table_names(program)
    early = _render(cut.early, CONSTANT, names, tables)
    slots = with_slots_of(cut, program, names)
    groups = [_staged(cut.late, g, slots, tables) for g in layout.sizes]
    written = [early, *(b for g in groups for b in (g.timed, g.late))]
    used = {w for b in written for w in words(b)}
    lines = [
        f"/* {comment(layout.title)}: equations of motion for many points, generated by eom. */",
        f'#include "{name}_{SUFFIX}.h"',
        "",
        "#include <math.h>",
        "#include <string.h>",
        "",
        lanes_math.TYPES,
        f"#define OFTEN_ {'INLINE_' if _calls(written) <= lanes_math.FEW_CALLS else 'APART_'}",
        "",
        *(f"{text}\n" for text in _helpers(used)),
    ]
    for table, n in tables.items():
        if f"lanes_{n}" in used:
            function = c_helpers.table_function(n, table)
            lines += [f"{function}\n", f"{_by_lane(f'lanes_{n}', n, 'a')}\n"]
    if early.results:
        lines += [*_kernel("APART_", f"{name}_constants_kernel", _EARLY, early, *_LOCAL[0]), ""]
    for group in groups:
        head = f"{name}_{group.name}"
        if group.timed.results:
            lines += [*_kernel("APART_", f"{head}_clock", _TIMED, group.timed, *_LOCAL[1]), ""]
        lines += [*_kernel("INLINE_", f"{head}_kernel", _LATE, group.late, *_STORED), ""]
        lines += [*_lanes(name, group, len(early.results), layout), ""]
    return "\n".join(lines)


def _render(program: Program, group: str, names: Names, tables: Tables) -> Body:
    return render(program, group, names, TEMPLATES, _SLOTS, _NUMBERS, tables)


def _staged(program: Program, group: str, names: Names, tables: Tables) -> _Group:
    whole = prune(program, [group])
    cut = by_time(whole)
    rest = with_slots_of(cut, whole, names)
    timed = _render(cut.early, CLOCK, names, tables)
    return _Group(group, timed, _render(cut.late, group, rest, tables))


def _calls(written: Iterable[Body]) -> int:
    """Count the calls of own functions."""
    texts = (text for b in written for text in (*(line.expression for line in b.lines), *b.results))
    return sum(len(_OWN_CALL.findall(text)) for text in texts)


def _helpers(called: set[str]) -> list[str]:
    """Return the texts of the helpers that are called, and of those that these call."""
    wanted = set(called)
    for name in reversed(list(HELPERS)):
        if name in wanted:
            wanted.update(_WORD.findall(HELPERS[name]))
    return [text for name, text in HELPERS.items() if name in wanted]


def _kernel(
    kind: str, head: str, arguments: Sequence[str], body: Body, place: str, target: str
) -> list[str]:
    """A computation of one block: all loads, then all stores; a long one in parts, as in C.

    ``place``: how the result {0} is stored as {1}; ``target``: declaration of where results go.
    """
    stores = [f"    {place.format(k, r)}" for k, r in enumerate(body.results)]
    if len(body.lines) <= PART_LINES:
        return _static(head, kind, (*arguments, target), [*_assigned(body.lines), *stores])
    parts, size = split(body, PART_LINES)
    texts: list[str] = []
    calls = []
    for k, part in enumerate(parts):
        lines = [_load(line, slot) for line, slot in part.loads]
        lines += _assigned(part.lines)
        lines += [_store(line, slot) for line, slot in part.stores]
        last = k == len(parts) - 1
        declared = (*arguments, _CARRIED, *((target,) if last else ()))
        lines += stores if last else []
        texts += [*_static(f"{head}_{k}", "static", declared, lines), ""]
        calls.append(f"    {head}_{k}({', '.join(_variables(declared))});")
    room = f"    lane_ carried_[{size}];"
    return [*texts, *_static(head, "static", (*arguments, target), [room, *calls])]


def _load(line: Line, slot: int) -> str:
    if line.room:
        return f"    const lane_ *const {line.variable} = carried_ + {slot};"
    return f"    const lane_ {line.variable} = carried_[{slot}];"


def _store(line: Line, slot: int) -> str:
    if line.room:
        copy = f"carried_[{slot} + k_] = {line.variable}[k_];"
        return f"    for (int k_ = 0; k_ < {line.room}; ++k_) {copy}"
    return f"    carried_[{slot}] = {line.variable};"


def _variables(declared: Sequence[str]) -> list[str]:
    return [a.split()[-1].lstrip("*") for text in declared for a in text.split(",")]


def _static(name: str, kind: str, declared: Sequence[str], lines: Sequence[str]) -> list[str]:
    """Return a static function; arguments that it does not use give no warning."""
    return [
        f"{kind} void {name}({', '.join(declared)}) {{",
        f"    {', '.join(f'(void){a}' for a in _variables(declared))};",
        *lines,
        "}",
    ]


def _assigned(lines: Sequence[Line]) -> list[str]:
    return [
        f"    {line.expression}"
        if line.room
        else f"    const lane_ {line.variable} = {line.expression};"
        + (f" /* {line.comment} */" if line.comment else "")
        for line in lines
    ]


def _signature(name: str, group: str) -> str:
    arrays = [f"const double *{a}, ptrdiff_t {a}_row, ptrdiff_t {a}_column," for a in "xpu"]
    head = f"void {name}_{group}_{SUFFIX}(size_t count, const double *t, ptrdiff_t t_step,"
    return "\n    ".join([head, *arrays, "double *y, ptrdiff_t y_row, ptrdiff_t y_column)"])


def _run(head: str) -> list[str]:
    """Blocks that stand one after another, with the same parameters and time."""
    return [
        f"static void {head}_run(size_t blocks, const double *t, const double *x, ptrdiff_t xs,",
        "    const lane_ *c, const lane_ *w, const double *u, ptrdiff_t us, ptrdiff_t step,",
        "    double *y, ptrdiff_t ys) {",
        "    for (size_t k = 0; k < blocks; ++k) {",
        f"        {head}_kernel(t, x, xs, c, w, u, us, y, ys);",
        "        x += LANES_, u += step, y += LANES_;",
        "    }",
        "}",
        "",
    ]


def _lanes(name: str, group: _Group, constants: int, layout: Layout) -> list[str]:
    """A loop over runs of blocks; what all points share is prepared in the first.

    Points that do not stand side by side, and the last ones, go through a block on the stack.
    """
    head = f"{name}_{group.name}"
    sizes = {
        "x": len(layout.states),
        "u": len(layout.inputs),
        "y": len(group.late.results),
        "p": len(layout.parameters),
    }
    prepare, clock = _early_stages(name, group, constants, sizes["p"])
    lines = [
        "double tb[LANES_];",
        *(f"double {a}b[{max(1, n)} * LANES_];" for a, n in sizes.items()),
        f"lane_ c[{max(1, constants)}], w[{max(1, len(group.timed.results))}];",
        "(void)xb, (void)ub, (void)pb, (void)c, (void)w;",
        "(void)x_column, (void)u_column, (void)p, (void)p_row, (void)p_column;",
        "if (count == 0) return;",
        "const int first = count < LANES_ ? (int)count : LANES_;",
        *(_first(line) for line in (*prepare, *clock)),
        "for (size_t k = 0; k < count;) {",
        "    const ptrdiff_t j = (ptrdiff_t)k;",
        "    const int left = count - k < LANES_ ? (int)(count - k) : LANES_, full = left == LANES_;",
        *_when("k > 0 && p_column != 0", prepare),
        *_when("k > 0 && (t_step != 0 || p_column != 0)", clock),
        *_blocks(head, sizes, "t_step == 0 && p_column == 0" if constants else "t_step == 0"),
        "}",
    ]
    body = [f"    {line}" for line in lines]
    return [*_run(head), f"{_signature(name, group.name)} {{", *body, "}"]


def _early_stages(
    name: str, group: _Group, constants: int, parameters: int
) -> tuple[list[str], list[str]]:
    """Return the statements that prepare parameters, and those that prepare times."""
    prepare = [
        f"lanes_pack_(pb, {parameters}, p + j * p_column, p_row, p_column, left);",
        f"{name}_constants_kernel(pb, c);",
    ]
    clock = ["lanes_pack_(tb, 1, t + j * t_step, 0, t_step, left);"]
    clock += [f"{name}_{group.name}_clock(tb, c, w);"] if group.timed.results else []
    return prepare if constants else [], clock


def _blocks(head: str, sizes: Mapping[str, int], shared: str) -> list[str]:
    """Compute one block, or all whole ones that lie side by side and share the early stages."""
    return [
        "    const double *xk = x + j * x_column, *uk = u + j * u_column;",
        "    ptrdiff_t xs = x_row, us = u_row, ys = y_row;",
        "    double *yk = y + j * y_column;",
        f"    const int x_packed = {_packed('x', sizes)};",
        f"    const int u_packed = {_packed('u', sizes)};",
        "    const int y_packed = y_column != 1 || !full;",
        f"    const int together = {shared} && !x_packed && !y_packed && (!u_packed || u_column == 0);",
        "    const size_t blocks = together ? (count - k) / LANES_ : 1;",
        *_block("x", sizes),
        *_block("u", sizes),
        "    if (y_packed) yk = yb, ys = LANES_;",
        f"    {head}_run(blocks, tb, xk, xs, c, w, uk, us, u_column == 0 ? 0 : LANES_, yk, ys);",
        f"    if (y_packed) lanes_unpack_(yb, {sizes['y']}, y + j * y_column, y_row, y_column, left);",
        "    k += blocks * LANES_;",
    ]


def _first(line: str) -> str:
    """Return a statement about the points from j on for the first ones."""
    return re.sub(r" \+ j \* \w+", "", line).replace("left", "first")


def _packed(a: str, sizes: Mapping[str, int]) -> str:
    """Tell whether a block of an array must be copied."""
    return f"{a}_column != 1 || !full" if sizes[a] else "0"


def _block(a: str, sizes: Mapping[str, int]) -> list[str]:
    """Copy the rows of a block; those that all points share once."""
    if not sizes[a]:
        return []
    pack = f"lanes_pack_({a}b, {sizes[a]}, {a} + j * {a}_column, {a}_row, {a}_column, left);"
    return [
        f"    if ({a}_packed && (k == 0 || {a}_column != 0)) {pack}",
        f"    if ({a}_packed) {a}k = {a}b, {a}s = LANES_;",
    ]


def _when(condition: str, lines: Sequence[str]) -> list[str]:
    if not lines:
        return []
    return [f"    if ({condition}) {{", *(f"        {line}" for line in lines), "    }"]


LANES = Target(
    name="c_lanes",
    extension="c",
    templates=TEMPLATES,
    slots=_SLOTS,
    numbers=_NUMBERS,
    files=files,
    helpers=HELPERS,
)
