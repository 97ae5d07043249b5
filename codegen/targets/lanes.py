"""The C target in lanes: batches of points, one vector of points an operation.

The text is C99 with the vector extensions of gcc and clang, for any processor: `LANES_` doubles a
vector, 8 where the compiler may use AVX-512, 2 where SSE2 is all there is and 4 elsewhere, or what the
user defines (gcc -Wno-psabi, if those are wider than the registers). It computes what the C target
computes, in the same order; only sine, cosine, exponential and logarithm are its own. The others, tables
and linear systems are computed lane by lane. Every point has the same result in any lane, beside any
neighbours: results do not depend on how points are divided among threads.

Functions over vectors of lanes that generated C defines for itself, without a branch a lane.

Sine and cosine: argument reduction by Cody and Waite (Software Manual for the Elementary Functions,
1980, ch. 8) with pi/2 in parts of 37, 37 and 53 bits, whose products with a quadrant of 16 bits are
exact; the remainder is kept with what rounding lost of it. Lanes beyond `LARGEST_ANGLE` go to the
library. Exponential and logarithm: halves of the interval around a power of two, the last sum
compensated. The coefficients interpolate the functions in Chebyshev points with 60 digits.

Errors in units in the last place, held by tests: `ULPS`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from codegen.frontend.layout import Layout
from codegen.ir.names import comment, identifier
from codegen.ir.passes import prune
from codegen.ir.program import Program
from codegen.passes.pipeline import CLOCK, CONSTANT, by_parameters, by_time
from codegen.targets import c_helpers
from codegen.targets.c import assigned, guarded, part_lines, variables
from codegen.targets.c_helpers import COSINE, LARGEST_ANGLE, SINE, horner
from codegen.targets.c_helpers import WHOLE as _WHOLE
from codegen.targets.render import (
    ARITHMETIC,
    ATOM,
    EVERY_NUMBER,
    Body,
    Names,
    Tables,
    Template,
    call,
    leaf_names,
    render,
    split,
    table_names,
    with_slots_of,
)
from codegen.targets.target import Target, words

ULPS: dict[str, float] = {
    "sin": 1.0,
    "cos": 1.0,
    "tan": 2.2,
    "exp": 1.0,
    "log": 1.0,
    "expm1": 1.5,
    "tanh": 2.5,
}
"""Largest error of each function that is not of the library."""

EXPONENTIAL = (
    0.5, 0.1666666666666667, 0.04166666666666667, 0.008333333333326136, 0.0013888888888883748,
    0.00019841269874820627, 2.4801587325547743e-05, 2.7557255400206422e-06, 2.75572736431103e-07,
    2.5105217004720745e-08, 2.0914686968086876e-09,
)  # fmt: skip
"""(exp x - 1 - x)/x^2 as a polynomial in x, |x| <= log(2)/2."""
LOGARITHM = (
    0.6666666666666666, 0.4000000000000088, 0.2857142857080285, 0.22222222391887064,
    0.18181795621632782, 0.15386240708969665, 0.13268746195596595, 0.13086907887965027,
)  # fmt: skip
"""(2 artanh s - 2 s)/s^3 as a polynomial in s^2, |s| <= 3 - sqrt(8)."""


TYPES = """\
/* Vectors go to static functions alone, which no other compiler sees. */
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wpsabi"
#elif __has_warning("-Wpsabi")
#pragma clang diagnostic ignored "-Wpsabi"
#endif

#ifndef LANES_
#ifdef __AVX512F__
#define LANES_ 8
#elif defined(__SSE2__) && !defined(__AVX__)
#define LANES_ 2
#else
#define LANES_ 4
#endif
#endif
#if defined(__AVX512F__) || defined(__AVX__)
#include <immintrin.h>
#endif

/* Numbers and their bits, one a point; comparisons give all bits or none. */
typedef double lane_ __attribute__((vector_size(8 * LANES_)));
typedef unsigned long long mask_ __attribute__((vector_size(8 * LANES_)));
#define INLINE_ static inline __attribute__((always_inline, unused))
#define APART_ static __attribute__((noinline, unused))

INLINE_ lane_ lanes_all_(double a) { return a - (lane_){0.0}; }
INLINE_ mask_ lanes_bits_(unsigned long long a) { return a + (mask_){0}; }
INLINE_ lane_ lanes_choose_(mask_ m, lane_ a, lane_ b) {
    return (lane_)((m & (mask_)a) | (~m & (mask_)b));
}
INLINE_ lane_ lanes_one_(mask_ m) { return (lane_)(m & (mask_)lanes_all_(1.0)); }
INLINE_ mask_ lanes_true_(lane_ a) { return (mask_)(a != 0.0); }
INLINE_ lane_ lanes_abs_(lane_ a) { return (lane_)((mask_)a & ~(mask_)lanes_all_(-0.0)); }
INLINE_ lane_ lanes_neg_(lane_ a) { return (lane_)((mask_)a ^ (mask_)lanes_all_(-0.0)); }
INLINE_ lane_ lanes_signed_(lane_ a, lane_ b) {
    const mask_ m = (mask_)lanes_all_(-0.0);
    return (lane_)(((mask_)a & ~m) | ((mask_)b & m));
}

/* Whether |a| is larger than the limit in any lane. */
INLINE_ int lanes_any_beyond_(lane_ a, double limit) {
#if defined(__AVX512F__) && LANES_ == 8
    return _mm512_cmp_pd_mask((__m512d)lanes_abs_(a), _mm512_set1_pd(limit), _CMP_GT_OQ) != 0;
#elif defined(__AVX__) && LANES_ == 4
    return _mm256_movemask_pd((__m256d)(lanes_abs_(a) > limit)) != 0;
#else
    int any = 0;
    for (int k = 0; k < LANES_; ++k) any |= fabs(a[k]) > limit;
    return any;
#endif
}

INLINE_ lane_ lanes_load_(const double *a) {
    lane_ r;
    memcpy(&r, a, sizeof r);
    return r;
}
INLINE_ void lanes_store_(double *a, lane_ v) { memcpy(a, &v, sizeof v); }
/* Copy rows of points to or from blocks; where fewer are left than lanes, the last one fills up. */
APART_ void lanes_pack_(double *block, int rows, const double *a, ptrdiff_t row, ptrdiff_t column,
                        int left) {
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k < LANES_; ++k)
            block[i * LANES_ + k] = a[i * row + (k < left ? k : left - 1) * column];
}
APART_ void lanes_unpack_(const double *block, int rows, double *a, ptrdiff_t row, ptrdiff_t column,
                          int left) {
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k < left; ++k) a[i * row + k * column] = block[i * LANES_ + k];
}
"""
"""What every text needs: types, selection, loads and stores."""
FEW_CALLS = 24
"""Own functions are written out where they are called, unless there are more calls than these."""

OWN = {
    "lanes_sqrt_": """\
INLINE_ lane_ lanes_sqrt_(lane_ a) {
#if defined(__AVX512F__) && LANES_ == 8
    return (lane_)_mm512_sqrt_pd((__m512d)a);
#elif defined(__AVX__) && LANES_ == 4
    return (lane_)_mm256_sqrt_pd((__m256d)a);
#else
    lane_ r;
    for (int k = 0; k < LANES_; ++k) r[k] = sqrt(a[k]);
    return r;
#endif
}""",
    "lanes_sign_": """\
INLINE_ lane_ lanes_sign_(lane_ a) {
    const lane_ unit = lanes_signed_(lanes_all_(1.0), a);
    return lanes_choose_((mask_)(a == 0.0), lanes_all_(0.0), lanes_choose_((mask_)(a == a), unit, a));
}""",
    "lanes_min_": """\
INLINE_ lane_ lanes_min_(lane_ a, lane_ b) {
    return lanes_choose_((mask_)(a < b) | (mask_)(a != a), a, b);
}""",
    "lanes_max_": """\
INLINE_ lane_ lanes_max_(lane_ a, lane_ b) {
    return lanes_choose_((mask_)(a > b) | (mask_)(a != a), a, b);
}""",
    "lanes_floor_": """\
INLINE_ lane_ lanes_floor_(lane_ a) {
    const lane_ big = lanes_signed_(lanes_all_(4503599627370496.0), a);
    const lane_ near = (a + big) - big;
    const lane_ down = lanes_signed_(near - lanes_one_((mask_)(near > a)), a);
    return lanes_choose_((mask_)(lanes_abs_(a) < 4503599627370496.0), down, a);
}""",
    "lanes_circle_": f"""\
/* Sine (turn 0) or cosine (turn 1). */
APART_ lane_ lanes_far_(lane_ a, lane_ r, int turn) {{
    for (int k = 0; k < LANES_; ++k)
        if (fabs(a[k]) > {LARGEST_ANGLE!r}) r[k] = turn ? cos(a[k]) : sin(a[k]);
    return r;
}}
INLINE_ lane_ lanes_circle_(lane_ a, int turn) {{
    const lane_ shifted = a * {0.6366197723675814!r} + {_WHOLE}, n = shifted - {_WHOLE};
    const lane_ first = a - n * {1.5707963267923333!r}, second = n * {2.5633441515839558e-12!r};
    const lane_ rest = first - second, back = rest - first;
    const lane_ lost = (first - (rest - back)) - (second + back);
    const lane_ third = n * {1.0562999066987428e-23!r} - lost;
    const lane_ x = rest - third, e = (rest - x) - third, z = x * x, cube = x * z;
    const lane_ s = {horner("z", SINE[1:])};
    const lane_ sine = x - ((z * (0.5 * e - cube * s) - e) - cube * ({SINE[0]!r}));
    const lane_ c = z * ({horner("z", COSINE)});
    const lane_ half = 0.5 * z, top = 1.0 - half;
    const lane_ cosine = top + (((1.0 - top) - half) + (z * c - x * e));
    const mask_ quadrant = (mask_)shifted + (unsigned long long)turn;
    const lane_ r = lanes_choose_(-(quadrant & 1), cosine, sine);
    const lane_ found = (lane_)((mask_)r ^ ((quadrant & 2) << 62));
    if (__builtin_expect(lanes_any_beyond_(a, {LARGEST_ANGLE!r}), 0)) return lanes_far_(a, found, turn);
    return found;
}}""",
    "lanes_sin_": "OFTEN_ lane_ lanes_sin_(lane_ a) { return lanes_circle_(a, 0); }",
    "lanes_cos_": "OFTEN_ lane_ lanes_cos_(lane_ a) { return lanes_circle_(a, 1); }",
    "lanes_tan_": "OFTEN_ lane_ lanes_tan_(lane_ a) { return lanes_circle_(a, 0) / lanes_circle_(a, 1); }",
    "lanes_power_": f"""\
/* exp(a) - 1 over 2^n, and 2^(n - 1) in two factors; a is at most 710 and at least -1490. */
INLINE_ lane_ lanes_power_(lane_ a, lane_ *one, lane_ *other) {{
    const lane_ shifted = a * {1.4426950408889634!r} + {_WHOLE}, n = shifted - {_WHOLE};
    const mask_ whole = (mask_)shifted - (mask_)lanes_all_({_WHOLE}) + 4096;
    const mask_ half = whole >> 1;
    *one = (lane_)((half - 1025) << 52);
    *other = (lane_)((whole - half - 1026) << 52);
    const lane_ high = a - n * {0.6931471805592082!r}, low = n * {7.371002565167799e-13!r}, r = high - low;
    const lane_ s = {horner("r", EXPONENTIAL)};
    return high + (r * r * s - low);
}}
INLINE_ lane_ lanes_within_(lane_ a, double least, double most) {{
    const lane_ b = lanes_choose_((mask_)(a < least), lanes_all_(least), a);
    return lanes_choose_((mask_)(b > most), lanes_all_(most), b);
}}""",
    "lanes_exp_": """\
OFTEN_ lane_ lanes_exp_(lane_ a) {
    lane_ one, other;
    const lane_ r = 1.0 + lanes_power_(lanes_within_(a, -750.0, 710.0), &one, &other);
    return (r + r) * one * other;
}""",
    "lanes_expm1_": """\
OFTEN_ lane_ lanes_expm1_(lane_ a) {
    lane_ one, other;
    const lane_ r = lanes_power_(lanes_within_(a, -60.0, 710.0), &one, &other);
    const lane_ power = one * other, found = r * power + (power - 0.5);
    return lanes_signed_(found + found, a);
}""",
    "lanes_tanh_": """\
OFTEN_ lane_ lanes_tanh_(lane_ a) {
    const lane_ e = lanes_expm1_(2.0 * lanes_within_(lanes_abs_(a), 0.0, 22.0));
    return lanes_signed_(e / (e + 2.0), a);
}""",
    "lanes_log_": f"""\
OFTEN_ lane_ lanes_log_(lane_ a) {{
    const mask_ small = (mask_)(a < {2.0**-1022!r});
    const lane_ scaled = lanes_choose_(small, a * {2.0**54!r}, a);
    /* The nearest power of two: the exponent of a over sqrt(1/2), rounded down. */
    const mask_ above = (mask_)scaled - 0x3fe6a09e667f3bcdULL, field = (above >> 52) + 2048;
    const lane_ n = (lane_)((field & 4095) | 0x4330000000000000ULL) - 4503599627370496.0
        - lanes_choose_(small, lanes_all_(2102.0), lanes_all_(2048.0));
    const lane_ m = (lane_)((above & 0x000fffffffffffffULL) + 0x3fe6a09e667f3bcdULL);
    const lane_ f = m - 1.0, s = f / (2.0 + f), z = s * s, half = 0.5 * f * f;
    const lane_ r = z * ({horner("z", LOGARITHM)});
    const lane_ low = n * {7.371002565167799e-13!r};
    const lane_ v = n * {0.6931471805592082!r} - ((half - (s * (half + r) + low)) - f);
    const lane_ bad = lanes_choose_((mask_)(a == 0.0), lanes_all_(-INFINITY), lanes_all_(NAN));
    const lane_ other = lanes_choose_((mask_)(a > 0.0), a, bad);
    return lanes_choose_((mask_)(a > 0.0) & (mask_)(a < INFINITY), v, other);
}}""",
}
"""Functions without a loop over lanes."""

LIBRARY = {
    "asin": "asin", "acos": "acos", "atan": "atan", "sinh": "sinh", "cosh": "cosh",
    "asinh": "asinh", "acosh": "acosh", "atanh": "atanh", "erf": "erf", "erfc": "erfc",
    "log1p": "log1p", "pow": "pow", "atan2": "atan2", "hypot": "hypot", "mod": "mod_",
}  # fmt: skip
"""Operations that are computed lane by lane, and the C functions of doubles that do it."""
BINARY = frozenset({"pow", "atan2", "hypot", "mod"})
ORDERED = {"besselj": "jn", "bessely": "yn", "stumpff": "stumpff_"}
"""The same, after an integer that all lanes share."""


def by_lane(name: str, function: str, arguments: str) -> str:
    """Return the function of lanes that calls a function of doubles for each."""
    arrays = arguments.split()
    declared = ", ".join(f"lane_ {a}" for a in arrays)
    inside = ", ".join(f"{a}[k]" for a in arrays)
    return (
        f"APART_ lane_ {name}({declared}) {{\n    lane_ r;\n"
        f"    for (int k = 0; k < LANES_; ++k) r[k] = {function}({inside});\n    return r;\n}}"
    )


def _of_order(name: str, function: str) -> str:
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
    **OWN,
    **{
        f"lanes_{f.rstrip('_')}_": by_lane(
            f"lanes_{f.rstrip('_')}_", f, "a b" if op in BINARY else "a"
        )
        for op, f in LIBRARY.items()
    },
    **{
        f"lanes_{f.rstrip('_')}_": _of_order(f"lanes_{f.rstrip('_')}_", f) for f in ORDERED.values()
    },
    **_SOLVERS,
}
"""Texts by name, each after those that it uses."""


SUFFIX = "lanes"
PART_LINES = 400
"""Functions with more assignments are split into parts of so many."""

_OWN = ("sqrt", "sin", "cos", "tan", "exp", "log", "expm1", "tanh", "sign", "floor", "abs")
TEMPLATES: dict[str, Template] = {
    **ARITHMETIC,
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
    **{op: call(f"lanes_{f.rstrip('_')}_", 2 if op in BINARY else 1) for op, f in LIBRARY.items()},
    **{op: call(f"lanes_{f.rstrip('_')}_", 2) for op, f in ORDERED.items()},
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
EARLY = ("const double *p",)
_TIMED = ("const double *t", "const lane_ *c")
LATE = (
    "const double *t",
    "const double *x",
    "ptrdiff_t xs",
    "const lane_ *c",
    "const lane_ *w",
    "const double *u",
    "ptrdiff_t us",
)
LOCAL = ("c[{0}] = {1};", "lane_ *c"), ("w[{0}] = {1};", "lane_ *w")
STORED = ("lanes_store_(y + {0} * ys, {1});", "double *y, ptrdiff_t ys")
_CARRIED = "lane_ *carried_"


_WORD = re.compile(r"[A-Za-z_]\w*")
_OWN_CALL = re.compile(rf"\blanes_({'|'.join(ULPS)})_\(")


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
    about = [
        f"/* {comment(layout.title)}: equations of motion for many points, generated by eom.",
        " *",
        " * count points; the element i of point k stands at a[i * a_row + k * a_column], time at",
        " * t[k * t_step]. A column of 0 is one vector for all points. All in SI units. y may be x",
        " * itself, with the same row and column; otherwise y overlaps no argument.",
        " * Results of a point do not depend on the other points: threads may divide them.",
        " */",
    ]
    return guarded(
        guard,
        about,
        [
            *(f"{_signature(name, group)};" for group in layout.sizes),
        ],
    )


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
    early = rendered(cut.early, CONSTANT, names, tables)
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
        *preamble(written),
    ]
    for table, n in tables.items():
        if f"lanes_{n}" in used:
            function = c_helpers.table_function(n, table)
            lines += [f"{function}\n", f"{by_lane(f'lanes_{n}', n, 'a')}\n"]
    if early.results:
        lines += [*kernel("APART_", f"{name}_constants_kernel", EARLY, early, *LOCAL[0]), ""]
    for group in groups:
        head = f"{name}_{group.name}"
        if group.timed.results:
            lines += [*kernel("APART_", f"{head}_clock", _TIMED, group.timed, *LOCAL[1]), ""]
        lines += [*kernel("INLINE_", f"{head}_kernel", LATE, group.late, *STORED), ""]
        lines += [*_lanes(name, group, len(early.results), layout), ""]
    return "\n".join(lines)


def preamble(written: Sequence[Body]) -> list[str]:
    """Return the types, and the helpers that bodies call."""
    return [
        TYPES,
        f"#define OFTEN_ {'INLINE_' if _calls(written) <= FEW_CALLS else 'APART_'}",
        "",
        *(f"{text}\n" for text in _helpers({w for b in written for w in words(b)})),
    ]


def rendered(program: Program, group: str, names: Names, tables: Tables) -> Body:
    """Render one group of results."""
    return render(program, group, names, TEMPLATES, _SLOTS, _NUMBERS, tables)


def _staged(program: Program, group: str, names: Names, tables: Tables) -> _Group:
    whole = prune(program, [group])
    cut = by_time(whole)
    rest = with_slots_of(cut, whole, names)
    timed = rendered(cut.early, CLOCK, names, tables)
    return _Group(group, timed, rendered(cut.late, group, rest, tables))


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


def kernel(
    kind: str, head: str, arguments: Sequence[str], body: Body, place: str, target: str
) -> list[str]:
    """A computation of one block: all loads, then all stores; a long one in parts, as in C.

    ``place``: how the result {0} is stored as {1}; ``target``: declaration of where results go.
    """
    stores = [f"    {place.format(k, r)}" for k, r in enumerate(body.results)]
    if len(body.lines) <= PART_LINES:
        return static(head, kind, (*arguments, target), [*assigned(body.lines, "lane_"), *stores])
    parts, size = split(body, PART_LINES)
    texts: list[str] = []
    calls = []
    for k, part in enumerate(parts):
        lines = part_lines(part, "lane_")
        last = k == len(parts) - 1
        declared = (*arguments, _CARRIED, *((target,) if last else ()))
        lines += stores if last else []
        texts += [*static(f"{head}_{k}", "static", declared, lines), ""]
        calls.append(f"    {head}_{k}({', '.join(variables(declared))});")
    room = f"    lane_ carried_[{size}];"
    return [*texts, *static(head, "static", (*arguments, target), [room, *calls])]


def static(name: str, kind: str, declared: Sequence[str], lines: Sequence[str]) -> list[str]:
    """Return a static function; arguments that it does not use give no warning."""
    return [
        f"{kind} void {name}({', '.join(declared)}) {{",
        f"    {', '.join(f'(void){a}' for a in variables(declared))};",
        *lines,
        "}",
    ]


def _signature(name: str, group: str) -> str:
    arrays = [f"const double *{a}, ptrdiff_t {a}_row, ptrdiff_t {a}_column," for a in "xpu"]
    head = f"void {name}_{group}_{SUFFIX}(size_t count, const double *t, ptrdiff_t t_step,"
    return "\n    ".join([head, *arrays, "double *y, ptrdiff_t y_row, ptrdiff_t y_column)"])


def _run(head: str) -> list[str]:
    """Blocks that stand one after another, with the same parameters and time."""
    return [
        f"static void {head}_run(size_t blocks, const double *t, const double *x, ptrdiff_t xs,",
        "    const lane_ *restrict c, const lane_ *restrict w, const double *u, ptrdiff_t us,",
        "    ptrdiff_t step, double *y, ptrdiff_t ys) {",
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
    """Return whether a block of an array must be copied."""
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
