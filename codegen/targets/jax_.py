"""The JAX target: a module of pure functions that imports JAX alone, for jit, vmap, jacfwd and grad.

An operation has the derivative zero where it has none, as in `codegen.ir.ops`: a root at zero, a
quotient by zero; helper functions, written only where they are used, say so. Backwards, JAX multiplies
zero with the derivative of the branch of a condition that is not taken: with such operations that is
zero, but a product with what is no number (x sqrt(x) for x < 0) makes ``jax.grad`` NaN; ``jax.jacfwd``
never does. Functions of XLA that lose digits (sinh, cosh, atanh, log1p: up to 250 units in the last
place) are written anew.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.frontend.layout import Layout
from codegen.ir.names import comment, identifier
from codegen.ir.program import RATES, Program
from codegen.ir.stumpff import SERIES
from codegen.targets.render import ARITHMETIC, Body, Template, call, calls, table_names
from codegen.targets.target import (
    Target,
    bodies,
    name_tables,
    nested,
    used_helpers,
    used_tables,
)
from eom.errors import InputError
from eom.tables import Table

TEMPLATES: dict[str, Template] = {
    **ARITHMETIC,
    **calls("jnp.{}", "sin cos tan exp expm1 abs floor"),
    **calls("_{}", "div sqrt pow asin acos acosh atanh log log1p atan2 hypot min max mod stumpff"),
    **calls("_{}", "sinh cosh tanh asinh erf erfc sign"),
    **calls("jnp.logical_{}", "and or not"),
    "atan": call("jnp.arctan"),
    "lt": call("jnp.less", 2),
    "le": call("jnp.less_equal", 2),
    "eq": call("jnp.equal", 2),
    "select": call("jnp.where", 3),
    "table": Template("{data}({0})"),
    "factor": Template("{v} = _factor({n}, {symmetric}, [{entries}])"),
    "back": Template("{v} = _back({factor}, [{entries}])"),
    "item": Template("{0}[{data}]"),
}

_SERIES = "\n".join(f"        {row!r}," for row in SERIES.values())
_RULES = {
    "div": ("jnp.divide", "a, b", "_over(1.0, b)", "-_over(v, b)"),
    "sqrt": ("jnp.sqrt", "a", "_over(0.5, v)"),
    "asin": ("jnp.arcsin", "a", "_over(1.0, _sqrt((1.0 - a) * (1.0 + a)))"),
    "acos": ("jnp.arccos", "a", "-_over(1.0, _sqrt((1.0 - a) * (1.0 + a)))"),
    "acosh": ("jnp.arccosh", "a", "_over(1.0, _sqrt((a - 1.0) * (a + 1.0)))"),
    "atanh": ("_atanh_value", "a", "_over(1.0, jnp.where(jnp.abs(a) < 1.0, 1.0 - a * a, 0.0))"),
    "log": ("jnp.log", "a", "_over(1.0, a)"),
    "log1p": ("_log1p_value", "a", "_over(1.0, jnp.where(a > -1.0, 1.0 + a, 0.0))"),
    "atan2": ("jnp.arctan2", "a, b", "_over(b, a * a + b * b)", "-_over(a, a * a + b * b)"),
    "hypot": ("jnp.hypot", "a, b", "_over(a, v)", "_over(b, v)"),
    "sinh": ("_sinh_value", "a", "jnp.hypot(1.0, v)"),
    "cosh": ("_cosh_value", "a", "_sinh(a)"),
    "tanh": ("jnp.tanh", "a", "(1.0 - v * v)"),
    "asinh": ("jnp.arcsinh", "a", "_over(1.0, jnp.hypot(1.0, a))"),
    "erf": ("jax.scipy.special.erf", "a", f"{2 / np.sqrt(np.pi)!r} * jnp.exp(-a * a)"),
    "erfc": ("jax.scipy.special.erfc", "a", f"-{2 / np.sqrt(np.pi)!r} * jnp.exp(-a * a)"),
}
"""Function, operands and partial derivatives; v is the value. Those of XLA lose digits where ours stand."""


def _rule(name: str, function: str, operands: str, *partials: str) -> str:
    rules = "".join(f"    lambda d, v, {operands}: d * {text},\n" for text in partials)
    return f"_{name} = jax.custom_jvp({function})\n_{name}.defjvps(\n{rules})\n"


_HELPERS: dict[str, str] = {
    "_real": """\
def _real(a):
    a = jnp.asarray(a)
    return a.astype(jnp.result_type(a, float))
""",
    "_results": """\
def _results(t, x, p, u, rows):
    shape = jnp.broadcast_shapes(t.shape, x.shape[1:], p.shape[1:], u.shape[1:])
    return jnp.stack([jnp.broadcast_to(row, shape) for row in rows]).astype(x.dtype)
""",
    "_over": """\
def _over(a, b):
    # a / b, and zero where b is zero or one of them is no number
    there = (jnp.abs(b) > 0.0) & jnp.isfinite(a)
    return jnp.where(there, jnp.where(there, a, 0.0) / jnp.where(there, b, 1.0), 0.0)
""",
    "_log1p_value": """\
def _log1p_value(a):
    # 2 atanh(a / (2 + a)) by its series near zero, where 1 + a would lose digits
    small = jnp.abs(a) < 0.5
    s = jnp.where(small, a, 0.0) / (2.0 + jnp.where(small, a, 0.0))
    c = 1.0 / 37.0
    for n in range(35, 0, -2):
        c = 1.0 / n + s * s * c
    return jnp.where(small, 2.0 * s * c, jnp.log(1.0 + jnp.where(small, 0.0, a)))
""",
    "_atanh_value": """\
def _atanh_value(a):
    return jnp.where(a == 0.0, a, 0.5 * jnp.sign(a) * _log1p_value(2.0 * jnp.abs(a) / (1.0 - jnp.abs(a))))
""",
    "_sinh_value": """\
def _sinh_value(a):
    x = jnp.abs(a)
    e, half = jnp.expm1(jnp.minimum(x, 20.0)), jnp.exp(0.5 * x)
    return jnp.copysign(jnp.where(x < 20.0, 0.5 * (e + e / (e + 1.0)), 0.5 * half * half), a)
""",
    "_cosh_value": """\
def _cosh_value(a):
    x = jnp.abs(a)
    e, half = jnp.exp(jnp.minimum(x, 20.0)), jnp.exp(0.5 * x)
    return jnp.where(x < 20.0, 0.5 * (e + 1.0 / e), 0.5 * half * half)
""",
    **{f"_{name}": _rule(name, *row) for name, row in _RULES.items()},
    "_pow": """\
_pow = jax.custom_jvp(jnp.power)


def _pow_by_base(d, v, a, b):
    none = ((a == 0.0) & (b < 1.0)) | jnp.isnan(v)
    return d * jnp.where(none, 0.0, b * _pow(jnp.where(none, 1.0, a), b - 1.0))


def _pow_by_exponent(d, v, a, b):
    there = (a > 0.0) & jnp.isfinite(v)
    return d * jnp.where(there, v, 0.0) * jnp.log(jnp.where(there, a, 1.0))


_pow.defjvps(_pow_by_base, _pow_by_exponent)
""",
    "_sign": """\
def _sign(a):
    return jnp.where(a == 0.0, 0.0, jnp.sign(a))
""",
    "_min": """\
def _min(a, b):
    return jnp.where((a <= b) | (a != a), a, b)
""",
    "_max": """\
def _max(a, b):
    return jnp.where((a >= b) | (a != a), a, b)
""",
    "_mod": """\
@jax.custom_jvp
def _mod(a, b):
    # with the sign of b
    rest = jnp.fmod(a, b)
    rest = jnp.where((rest != 0.0) & ((rest < 0.0) != (b < 0.0)), rest + b, rest)
    return jnp.where(rest == 0.0, jnp.copysign(0.0, b), rest)


_mod.defjvps(lambda d, v, a, b: d, lambda d, v, a, b: -d * jnp.round(_over(a - v, b)))
""",
    "_factor": """\
def _factor(n, symmetric, entries):
    # matrices of shape (..., n, n) from their entries, or their upper triangles, by rows
    places = [[0] * n for _ in range(n)]
    rows = [(i, j) for i in range(n) for j in range(i if symmetric else 0, n)]
    for k, (i, j) in enumerate(rows):
        places[i][j] = k
        if symmetric:
            places[j][i] = k
    return jnp.stack(jnp.broadcast_arrays(*entries), axis=-1)[..., jnp.array(places)]
""",
    "_back": """\
def _back(matrices, right):
    # solutions in shape (n, ...), by LU with pivots
    right = jnp.stack(jnp.broadcast_arrays(*right), axis=-1)[..., None]
    shape = jnp.broadcast_shapes(matrices.shape[:-1], right.shape[:-1])
    right = jnp.broadcast_to(right, (*shape, 1))
    matrices = jnp.broadcast_to(matrices, (*shape, shape[-1]))
    return jnp.moveaxis(jnp.linalg.solve(matrices, right)[..., 0], -1, 0)
""",
    "_stumpff": f"""\
def _stumpff(k, z):
    # sum over j of (-z)**j / (2*j + k)!: a series near zero, sine or sinh and a recurrence elsewhere
    k = int(k)
    end, terms = (
{_SERIES}
    )[k - 1]
    is_near = jnp.abs(z) < end
    near, far = jnp.where(is_near, z, 0.0), jnp.where(is_near, end, z)
    c = 1.0
    for j in range(terms, 0, -1):
        c = 1.0 - near * c / ((2.0 * j + k - 1.0) * (2.0 * j + k))
    series = c / float(math.factorial(k))
    s = jnp.sqrt(jnp.abs(far))
    angle = s if k % 2 else 0.5 * s
    c = jnp.where(far > 0.0, jnp.sin(angle), jnp.sinh(jnp.where(far > 0.0, 0.0, angle))) / s
    c = c if k % 2 else 2.0 * c * c
    for n in range(2 - k % 2, k, 2):
        c = (1.0 / float(math.factorial(n)) - c) / far
    return jnp.where(is_near, series, c)
""",
}

_DOCSTRING = '''\
"""{title}: equations of motion, generated by eom.

Every function takes time t, states x, parameters p, inputs u; arrays of shape (n,) or (n, N), t of
shape () or (N,). It returns an array of shape (k,) or (k, N) and changes nothing, so that jax.jit,
vmap, jacfwd and grad apply. JAX computes in single precision unless told otherwise, once, before
anything else: jax.config.update("jax_enable_x64", True).
"""

{imports}import jax
import jax.numpy as jnp
'''


def files(program: Program, layout: Layout) -> Mapping[str, str]:
    """Return the generated module by file name; the same input gives the same bytes."""
    return {f"{identifier(layout.name)}.{JAX.extension}": module(program, layout)}


def module(program: Program, layout: Layout) -> str:
    """Return the module: one function a group of results, and the names of everything."""
    written = bodies(JAX, program, layout)
    title = comment(layout.title).replace('"', "'")
    names = [f"{key} = {names!a}" for key, names in name_tables(layout).items()]
    functions = [_function(group, body) for group, body in written.items()]
    helpers = [_HELPERS["_real"], _HELPERS["_results"], *used_helpers(JAX, written)]
    helpers += used_tables(JAX, table_names(program), written)
    imports = "import math\n\n" if any("math." in text for text in helpers) else ""
    head = "\n".join([_DOCSTRING.format(title=title, imports=imports), *names, ""])
    other_name = ["rhs = rates\n"] if RATES in written else []
    return "\n\n".join([head, *helpers, *functions, *other_name])


def _table(name: str, table: Table) -> str:
    """Return the function of a table: a binary search, then a polynomial by Horner's rule."""
    first, last = table.breakpoints[0], table.breakpoints[-1]
    inside = f"jnp.where(x < {first!r}, {first!r}, jnp.where(x > {last!r}, {last!r}, x))"
    rows = "\n".join(f"        {list(row)!r}," for row in table.rows)
    return f"""\
def {name}(x):
    # Table {comment(table.label)}: {table.kind}; outside: {table.outside}.
    start = jnp.array({_list(table.breakpoints)}, x.dtype)
    rows = jnp.array([
{rows}
    ], x.dtype).T
    row = jnp.searchsorted(start, x, side="right")
    row = jnp.where(jnp.isnan(x), 0, row)
    h = {inside if table.flat_outside else "x"} - start[jnp.maximum(row - 1, 0)]
    c = rows[:, row]
    return {nested(len(table.rows[0]))}
"""


def _list(numbers: Sequence[float]) -> str:
    return "[" + textwrap.fill(", ".join(map(repr, numbers)), 96) + "]"


def _function(group: str, body: Body) -> str:
    lines = [
        f"def {group}(t, x, p=(), u=()):",
        "    t, x, p, u = _real(t), _real(x), _real(p), _real(u)",
    ]
    for line in body.lines:
        text = line.expression if line.room else f"{line.variable} = {line.expression}"
        lines.append(f"    {text}" + (f"  # {line.comment}" if line.comment else ""))
    results = [f"        {result}," for result in body.results]
    return "\n".join([*lines, "    return _results(t, x, p, u, [", *results, "    ])", ""])


JAX = Target(
    name="jax",
    extension="py",
    templates=TEMPLATES,
    slots={"time": "t", "state": "x[{0}]", "parameter": "p[{0}]", "input": "u[{0}]"},
    numbers={"inf": "jnp.inf", "-inf": "(-jnp.inf)", "nan": "jnp.nan"},
    files=files,
    helpers=_HELPERS,
    unsupported=dict.fromkeys(("besselj", "bessely"), "choose target c or numpy"),
    table=_table,
)


Array = NDArray[np.float64]


def available() -> bool:
    """Return whether JAX is installed."""
    return find_spec("jax") is not None


def require() -> None:
    """Raise `InputError`, which names the extra, where JAX is not installed."""
    if not available():
        raise InputError(
            "target jax needs the package jax",
            got="an installation without it",
            hint="pip install 'eom-toolkit[jax]'; eom generate --target jax writes the module without",
        )


def in_doubles(function: Callable[..., Any]) -> Callable[[Any, Array, Array, Array, Array], None]:
    """Return a kernel that fills ``out``, (k,) or (k, N), by a compiled call in double precision."""
    import jax

    compiled = jax.jit(function)

    def run(t: Any, x: Array, p: Array, u: Array, out: Array) -> None:
        with jax.enable_x64(True):
            out[...] = compiled(t, x, p, u)

    return run
