"""SymPy's pendulum of many links on a cart: from `KanesMethod` to numbers, beside PyDy with Cython.

The derivation is SymPy's own and is shown apart. Each size runs in processes and with a cache of
compiled code of its own, so that nothing is warm: one for our time and PyDy's, one for our stages.
"""

from __future__ import annotations

import json
import sys
from itertools import pairwise
from time import perf_counter
from timeit import timeit
from typing import Any

import numpy as np
from sympy.core.function import AppliedUndef
from sympy.physics.mechanics.models import n_link_pendulum_on_cart

from benchmarks.pairs import paired, settled
from benchmarks.peers import absent, measured_apart, missing
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text

LINKS = (5, 10, 20)
LONGEST_SECONDS = {20: 3.0}
LONGEST_FROM_TREE = {20: 2.0}
LARGEST_RATIO = 0.25
"""Of our right-hand side, called from Python, to PyDy's: 4 times faster."""
LARGEST_DIFFERENCE = 1e-10
CALLS = 200
PAIRS = 40
SEED = 20240229
STAGES = ("system", "program", "text", "compiler", "load")


def measure(settings: Settings) -> Section:  # noqa: ARG001 - all measurements are called alike
    """Return three rows a size: time to a callable, our stages, time of a call."""
    title = "pendulum of links on a cart, from KanesMethod: ours | PyDy with Cython"
    rows = [row for links in LINKS for row in _rows(links)]
    lacking = missing("pydy", "Cython")
    return Section(title, (*rows, *([absent("PyDy", lacking)] if lacking else [])))


def _rows(links: int) -> list[Row]:
    found = measured_apart("benchmarks.pendulum", "whole", str(links))
    stages = measured_apart("benchmarks.pendulum", "stages", str(links))
    ours, theirs = found["ours"], found.get("theirs")
    limit = LONGEST_SECONDS.get(links)
    beside = (time_text(theirs), f"{ours / theirs:.2f}") if theirs else ("", "")
    judged = (f"<= {time_text(limit)}", ours <= limit) if limit else ("", None)
    derived = f"after {time_text(found['derive'])} of SymPy"
    parts = ", ".join(f"{s} {time_text(stages[s])}" for s in STAGES)
    rows = [
        Row(f"{links} links: to a callable", f"{time_text(ours)} {derived}", *beside, *judged),
        Row(f"{links} links: stages", parts, f"{stages['operations']} operations"),
    ]
    return [*rows, _call(links, found), *_from_tree(links, found)]


def _from_tree(links: int, found: dict[str, Any]) -> list[Row]:
    """Return the rows of the same pendulum, described as a tree of bodies with relative angles."""
    tree = measured_apart("benchmarks.pendulum", "described", str(links))
    ours, limit = tree["seconds"], LONGEST_FROM_TREE.get(links)
    judged = (f"<= {time_text(limit)}", ours <= limit) if limit else ("", None)
    theirs = found["derive"] + found["theirs"] if "theirs" in found else None
    beside = (time_text(theirs), f"{ours / theirs:.2f}") if theirs else ("", "")
    made = Row(f"{links} links as a tree: to a callable", time_text(ours), *beside, *judged)
    what, call = f"{links} links as a tree: call from Python", tree["call"]
    if theirs is None:
        return [made, Row(what, time_text(call))]
    ratio = call / found["their_call"]
    target = (f"<= {LARGEST_RATIO}", ratio <= LARGEST_RATIO)
    return [
        made,
        Row(what, time_text(call), time_text(found["their_call"]), f"{ratio:.2f}", *target),
    ]


def _call(links: int, found: dict[str, Any]) -> Row:
    what = f"{links} links: call from Python"
    mine = time_text(found["call"])
    if "theirs" not in found:
        return Row(what, mine)
    if not found["difference"] <= LARGEST_DIFFERENCE:
        return Row(what, f"differs by {found['difference']:.1e}", target="the same", met=False)
    ratio = found["ratio"]
    beside = time_text(found["their_call"])
    return Row(what, mine, beside, f"{ratio:.2f}", f"<= {LARGEST_RATIO}", ratio <= LARGEST_RATIO)


def whole(links: int) -> dict[str, Any]:
    """Return seconds to derive, to compile and to call; PyDy's beside them where it is installed."""
    import codegen

    kane, derive = _derived(links)
    start = perf_counter()
    compiled = codegen.compile(kane, "c")
    found: dict[str, Any] = {"derive": derive, "ours": perf_counter() - start}
    draw = np.random.default_rng(SEED).uniform
    x = draw(-1.0, 1.0, len(compiled.layout.states))
    p = draw(0.5, 1.5, len(compiled.layout.parameters))
    u = draw(-1.0, 1.0, len(compiled.layout.inputs))

    def ours() -> float:
        return timeit(lambda: compiled.rhs(0.0, x, p, u), number=CALLS) / CALLS

    if missing("pydy", "Cython"):
        return found | {"call": min(ours() for _ in range(PAIRS))}
    start = perf_counter()
    peer = _pydy(kane, compiled.layout)
    found["theirs"] = perf_counter() - start

    def theirs() -> float:
        return timeit(lambda: peer(x, 0.0, u, p), number=CALLS) / CALLS

    expected = peer(x, 0.0, u, p)
    difference = np.abs(compiled.rhs(0.0, x, p, u) - expected).max() / np.abs(expected).max()
    pairs = settled(lambda: paired(ours, theirs, PAIRS), lambda k: k.ratio, LARGEST_RATIO)
    found |= {"difference": float(difference), "ratio": pairs.ratio}
    return found | dict(zip(("call", "their_call"), pairs.best, strict=True))


def described(links: int) -> dict[str, Any]:
    """Return seconds from the description of a tree to a callable, and of a call."""
    import codegen
    from eom.multibody import derive

    start = perf_counter()
    compiled = codegen.compile(derive(_tree(links), invariants=False), "c")
    seconds = perf_counter() - start
    draw = np.random.default_rng(SEED).uniform
    x = draw(-1.0, 1.0, len(compiled.layout.states))
    p = draw(0.5, 1.5, len(compiled.layout.parameters))
    u = draw(-1.0, 1.0, len(compiled.layout.inputs))
    calls = (timeit(lambda: compiled.rhs(0.0, x, p, u), number=CALLS) for _ in range(PAIRS))
    return {"seconds": seconds, "call": min(calls) / CALLS}


def _tree(links: int) -> Any:
    """Return point masses on rods without mass, hung one on the other, the first on a driven cart."""
    import sympy as sp

    from eom.multibody import Body, Joint, Placement, Tree

    masses, lengths = (sp.symbols(f"{n}0:{links + 1}", positive=True) for n in "ml")
    bodies = [Body("cart", masses[0])]
    joints = [Joint("rail", "prismatic", "ground", "cart", "x", motor=True)]
    for k in range(1, links + 1):
        bodies.append(Body(f"bob{k}", masses[k], (0, 0, lengths[k])))
        parent = f"bob{k - 1}" if k > 1 else "cart"
        place = Placement((0, 0, lengths[k - 1] if k > 1 else 0))
        joints.append(Joint(f"hinge{k}", "revolute", parent, f"bob{k}", "y", on_parent=place))
    return Tree("pendulum", bodies, joints, gravity=(0, 0, -sp.Symbol("g", positive=True)))


def _derived(links: int) -> tuple[Any, float]:
    start = perf_counter()
    kane = n_link_pendulum_on_cart(links)
    return kane, perf_counter() - start


def _pydy(kane: Any, layout: Any) -> Any:
    """Return PyDy's function of (x, t, specifieds, constants), in the order of our parameters."""
    from pydy.codegen.ode_function_generators import generate_ode_function

    symbols = {s.name: s for s in kane.mass_matrix.free_symbols | kane.forcing.free_symbols}
    moving = {*kane.q, *kane.u}
    given = {f.func.__name__: f for f in kane.forcing.atoms(AppliedUndef) if f not in moving}
    return generate_ode_function(
        kane.forcing_full,
        kane.q,
        kane.u,
        [symbols[q.name] for q in layout.parameters],
        mass_matrix=kane.mass_matrix_full,
        specifieds=[given[q.name] for q in layout.inputs],
        generator="cython",
        constants_arg_type="array",
        specifieds_arg_type="array",
    )


def stages(links: int) -> dict[str, Any]:
    """Return seconds by stage of our way to a callable, and operations of the right-hand side."""
    from codegen.compiling.compiled import TARGETS
    from codegen.frontend.from_sympy_mechanics import as_system
    from codegen.ir.passes import prune
    from codegen.ir.program import RATES
    from codegen.native import native
    from codegen.passes.pipeline import specialised
    from codegen.targets import c

    kane, _ = _derived(links)
    marks = [perf_counter()]

    def done(value: Any) -> Any:
        marks.append(perf_counter())
        return value

    system = done(as_system(kane))
    program, layout = done(specialised(system, {}))
    text = done(c.single_text(program, layout))
    flags = native.flags_for(max(layout.sizes.values()), len(program.instructions))
    done(native.compile_library(text, flags))
    done(TARGETS["c"](program, layout))
    found: dict[str, Any] = dict(zip(STAGES, (b - a for a, b in pairwise(marks)), strict=True))
    found["load"] -= found["text"]  # it writes the text anew, and finds its library in the cache
    return found | {"operations": sum(prune(program, [RATES]).counts().values())}


if __name__ == "__main__":
    print(
        json.dumps(
            {"whole": whole, "stages": stages, "described": described}[sys.argv[1]](
                int(sys.argv[2])
            )
        )
    )
