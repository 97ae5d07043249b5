"""Systems that were derived elsewhere: SymPy's mechanics, or bare states with rates or M and f.

Functions of time become plain symbols: coordinates and speeds are states, other functions of time
are inputs, and so are their derivatives (prescribed motion), each under a name of its own. A derivative
of a state is no input: its rate takes its place, or it is refused.

Constraints of SymPy's methods: KanesMethod has eliminated the forces by the dependent speeds that it
was given, and its last rows hold the accelerations; LagrangesMethod keeps its multipliers, which become
outputs. In both the constraints become invariants onto which integration brings the state back, and start
values must meet them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from eom.errors import InputError
from eom.quantities import Assumption, Definition, Quantity
from eom.system import BodyAttitude, System, as_expression, nodes

Expr = Any

CLOSURE = "closure"
"""How what is left of a constraint is called: closure_1 of a configuration, closure_rate_1 of speeds."""

ACCEPTED = (
    "an eom.System, SymPy's KanesMethod, LagrangesMethod, JointsMethod, SymbolicSystem or mechanics "
    "System, (states, rates), or (states, mass matrix, forces)"
)


@dataclass(frozen=True)
class Parts:
    """Equations over functions of time: mass (d(states)/dt, multipliers) = (rates, right).

    ``follows``: derivatives of coordinates, by what they are over coordinates and speeds. ``zero``: what
    is zero throughout, auxiliary speeds. ``held``: by name and meaning what the constraints keep at zero.
    ``outputs``: further expressions by name.
    """

    states: list[Expr]
    rates: list[Expr]
    mass: Expr | None = None
    multipliers: tuple[Expr, ...] = ()
    right: tuple[Expr, ...] = ()
    follows: Mapping[Expr, Expr] = field(default_factory=dict)
    zero: tuple[Expr, ...] = ()
    held: tuple[tuple[str, str, Expr], ...] = ()
    outputs: tuple[tuple[str, Expr], ...] = ()


def as_system(given: Any, name: str = "", attitudes: Sequence[BodyAttitude] = ()) -> System:
    """Return ``given`` as a system. Raises `InputError` for anything else than `ACCEPTED`.

    A pair is (states, rates); a triple (states, M, f) means M d(states)/dt = f. States may be
    symbols or functions of time, in a list or a matrix. ``attitudes``: bodies among the states, over the
    same; they are proved.
    """
    if isinstance(given, System):
        return replace(given, attitudes=(*given.attitudes, *attitudes)) if attitudes else given
    kind, reader = _method_of(given)
    if reader is not None:
        parts = reader(given)
    elif isinstance(given, tuple) and len(given) in {2, 3}:
        parts = _bare(*given)
    else:
        raise InputError(
            "not a system of equations",
            got=kind,
            expected=ACCEPTED,
            hint="call derive() of a scene" if hasattr(given, "derive") else "",
        )
    return _plain(name or kind.lower(), parts, attitudes)


def _method_of(given: Any) -> tuple[str, Any]:
    """Return the name of the type and what reads it: classes of SymPy's, and those made of them."""
    for base in type(given).__mro__:
        if base.__name__ in _METHODS and base.__module__.startswith("sympy.physics.mechanics"):
            return base.__name__, _METHODS[base.__name__]
    return type(given).__name__, None


def _bare(states: Any, *rest: Any) -> Parts:
    mass = _square(rest[0]) if len(rest) == 2 else None
    return Parts(_entries(states, "states"), _entries(rest[-1], "rates"), mass)


def _square(given: Any) -> Expr:
    try:
        return sp.Matrix(given)
    except (TypeError, ValueError) as error:
        raise InputError("the mass matrix is not a matrix", got=str(given)[:200]) from error


def _entries(values: Any, what: str) -> list[Expr]:
    if not isinstance(values, Iterable | sp.MatrixBase):
        raise InputError(f"{what} are not a list", got=type(values).__name__)
    found = list(values)
    if not all(isinstance(v, sp.Expr | int | float) for v in found):
        raise InputError(f"{what} are not expressions", got=str(found)[:200])
    return [as_expression(v) for v in found]


# -- methods of SymPy ----------------------------------------------------------------------------------


def _kane(method: Any) -> Parts:
    """Coordinates by their kinematics, solved by SymPy; speeds by mass matrix and forces."""
    _ready(method, "KanesMethod", "kanes_equations(bodies, loads)")
    kinematics = method.kindiffdict()
    velocities = [kinematics[_rate(c)] for c in method.q]
    auxiliary = [*method._uaux]
    return Parts(
        [*method.q, *method.u],
        [*velocities, *method.forcing],
        sp.diag(sp.eye(len(velocities)), method.mass_matrix),
        follows=kinematics,
        zero=(*auxiliary, *map(_rate, auxiliary)),
        held=_held(method._f_h, _speed_constraints(method)),
    )


def _speed_constraints(method: Any) -> list[Expr]:
    if not len(method._udep):
        return []
    return [*(method._k_nh * method.u + method._f_nh)]


def _lagrange(method: Any) -> Parts:
    """Coordinates and their rates; multipliers with the sign of ``eom`` and ``solve_multipliers``."""
    _ready(method, "LagrangesMethod", "form_lagranges_equations()")
    rates, n = [*method.u], len(method.q)
    mass, forcing = method.mass_matrix_full, method.forcing_full
    multipliers = tuple(method.lam_vec)
    if multipliers:
        mass = mass[:, : 2 * n].row_join(-mass[:, 2 * n :])
    return Parts(
        [*method.q, *rates],
        [*forcing][: 2 * n],
        mass,
        multipliers,
        tuple(forcing)[2 * n :],
        held=_held(method._hol_coneqs, method.coneqs),
    )


def _held(places: Iterable[Expr], speeds: Iterable[Expr]) -> tuple[tuple[str, str, Expr], ...]:
    """Return what constraints keep at zero, of configurations and of speeds, with names and meanings."""
    rows = [(CLOSURE, "configuration", places), (f"{CLOSURE}_rate", "velocity", speeds)]
    return tuple(
        (f"{name}_{k}", f"what is left of the {kind} constraint {k}", e)
        for name, kind, given in rows
        for k, e in enumerate(given, 1)
    )


def _rate(coordinate: Expr) -> Expr:
    return coordinate.diff(_usual_time())


def _usual_time() -> sp.Symbol:
    """Return SymPy's symbol of time; whoever has no object of its mechanics does not wait for that."""
    from sympy.physics.mechanics import dynamicsymbols

    time: sp.Symbol = dynamicsymbols._t
    return time


def _ready(method: Any, kind: str, call: str) -> None:
    """Refuse a method without equations."""
    try:
        _ = method.mass_matrix, method.forcing
    except (ValueError, AttributeError) as error:
        raise InputError(f"{kind} has no equations yet", hint=f"call {call} first") from error


def _mechanics_system(system: Any) -> Parts:
    if system.eom_method is None:
        raise InputError("the mechanics System has no equations yet", hint="call form_eoms() first")
    return _inner(system.eom_method)


def _joints(joints: Any) -> Parts:
    """The method that has formed the equations of SymPy's (deprecated) JointsMethod."""
    if joints.method is None:
        raise InputError("JointsMethod has no equations yet", hint="call form_eoms() first")
    return _inner(joints.method)


def _symbolic(system: Any) -> Parts:
    """Equations of a SymbolicSystem, in any of its forms.

    In the rows of ``alg_con`` stand algebraic equations: what M multiplies there is the variable itself, a
    multiplier, and not its rate.
    """
    try:
        mass, right = system.comb_implicit_mat, system.comb_implicit_rhs
    except AttributeError:  # the explicit form
        right = system.comb_explicit_rhs
        mass = sp.eye(len(right))
    algebraic = list(system.alg_con or ())
    moving = [k for k in range(len(right)) if k not in algebraic]
    order = [*moving, *algebraic]
    for k in algebraic:
        if all(e == 0 for e in mass[k, :]):
            raise InputError(
                "an algebraic equation without an unknown of its own",
                where=f"SymbolicSystem, row {k}", got=f"0 = {right[k]}",
                hint="differentiate the constraint until a multiplier or an acceleration is in it",
            )  # fmt: skip
    return Parts(
        [system.states[k] for k in moving],
        [right[k] for k in moving],
        mass.extract(order, order),
        tuple(system.states[k] for k in algebraic),
        tuple(right[k] for k in algebraic),
        outputs=tuple((str(name), e) for name, e in (system.output_eqns or {}).items()),
    )


def _inner(method: Any) -> Parts:
    kind, reader = _method_of(method)
    if reader is None:
        raise InputError("no such method", got=kind, expected=", ".join(_METHODS))
    found: Parts = reader(method)
    return found


_METHODS = {
    "KanesMethod": _kane,
    "LagrangesMethod": _lagrange,
    "System": _mechanics_system,
    "JointsMethod": _joints,
    "SymbolicSystem": _symbolic,
}


# -- over plain symbols --------------------------------------------------------------------------------


def _plain(name: str, parts: Parts, attitudes: Sequence[BodyAttitude]) -> System:
    """Exchange functions of time and derivatives for plain symbols, and sort these by role."""
    parts, attitudes = _unfolded(parts), tuple(attitudes)
    stated = [e for a in attitudes for e in a.expressions]
    sides = [*parts.rates, *parts.right, *(parts.mass if parts.mass is not None else ())]
    asked = [*parts.follows.values(), *(e for _, e in parts.outputs), *stated]
    everything = [*sides, *(e for *_, e in parts.held), *asked]
    time = _time(parts.states, everything)
    states, multipliers = _spelt(parts.states), _spelt(parts.multipliers)
    known = dict.fromkeys(parts.zero, sp.Integer(0)) | states | multipliers
    functions = _functions_of_time([*sides, *asked], time)
    inputs = _spelt(f for f in functions if f not in known and not _of_state(f, parts.states))
    _distinct([*states.values(), *multipliers.values(), *inputs.values()])
    known |= inputs
    _follow(_follows(parts), known)
    return _assembled(_Plain(name, known), parts, attitudes, time, inputs)


@dataclass(frozen=True)
class _Plain:
    """Makes plain expressions; ``known``: what stands for functions of time and derivatives, it grows."""

    name: str
    known: dict[Expr, Expr]

    def over(self, e: Expr) -> Expr:
        """Return an expression over plain symbols; rates of states that are left are refused."""
        found = _exchanged(e, self.known)
        left = (x for x in nodes((found,)) if isinstance(x, AppliedUndef | sp.Derivative))
        for rate in left:
            raise InputError(
                "a rate of a state stands on the right side",
                got=rate,
                where=self.name,
                expected="states, and rates that the equations give without a solve",
                hint="bring its coefficient into the mass matrix, or make it a state",
            )
        return found

    def all(self, expressions: Iterable[Expr]) -> tuple[Expr, ...]:
        """Return expressions over plain symbols."""
        return tuple(map(self.over, expressions))


def _assembled(
    plain: _Plain,
    parts: Parts,
    attitudes: Sequence[BodyAttitude],
    time: Expr,
    inputs: Mapping[Expr, Expr],
) -> System:
    """Return the system over plain symbols; what else is free in it becomes a parameter."""
    rates, right = plain.all(parts.rates), plain.all(parts.right)
    mass = None if parts.mass is None else sp.ImmutableMatrix(parts.mass.applyfunc(plain.over))
    made = tuple(a.over(plain.over) for a in attitudes)
    invariants = tuple(_constant(parts.held, plain, set(inputs.values())))
    states, multipliers = (plain.all(group) for group in (parts.states, parts.multipliers))
    forces = [_named(str(m), "multiplier of a constraint") for m in multipliers]
    asked = [Definition(_named(name, ""), plain.over(e)) for name, e in parts.outputs]
    stated = [e for a in made for e in a.expressions]
    named = (d.expression for d in (*asked, *invariants))
    everything = (*rates, *right, *(mass or ()), *stated, *named)
    free = {s for s in nodes(everything) if isinstance(s, sp.Symbol)}
    taken = {*states, *multipliers, *inputs.values(), time}
    return System(
        name=plain.name,
        states=tuple(map(Quantity, states)),
        rates=rates,
        mass_matrix=mass,
        multipliers=tuple(map(Definition, forces, right)),
        outputs=(*map(Definition, forces, multipliers), *asked),
        parameters=tuple(map(Quantity, sorted(free - taken, key=str))),
        inputs=tuple(map(Quantity, inputs.values())),
        time=time,
        attitudes=made,
        invariants=invariants,
        maintained=tuple(d.name for d in invariants),
        assumptions=_assumptions(parts, invariants),
    )


def _named(name: str, meaning: str) -> Quantity:
    return Quantity(sp.Symbol(name, real=True), "", meaning)


def _assumptions(parts: Parts, invariants: Sequence[Definition]) -> tuple[Assumption, ...]:
    """Return that start values meet the constraints, and which of these nobody can test."""
    kept = {d.name for d in invariants}
    untold = tuple(
        Assumption(
            f"{name}_open", f"{meaning}, which inputs move, is neither tested nor maintained"
        )
        for name, meaning, _ in parts.held
        if name not in kept
    )
    if not invariants:
        return untold
    words, vanish = "start values meet the constraints", tuple(d.expression for d in invariants)
    return (Assumption("assembled", words, vanish=vanish, tolerance=1e-9), *untold)


def _constant(
    held: Iterable[tuple[str, str, Expr]], plain: _Plain, inputs: set[Expr]
) -> Iterator[Definition]:
    """Yield what constraints hold constant over states and time; what inputs prescribe is left out.

    Functions of time that stand in constraints alone are inputs whose values nobody asks for.
    """
    for name, meaning, e in held:
        functions = {x for x in nodes((e,)) if isinstance(x, AppliedUndef | sp.Derivative)}
        inner = {x.expr for x in functions if isinstance(x, sp.Derivative) and x in plain.known}
        if functions <= {*plain.known, *inner}:
            found = plain.over(e)
            if not found.free_symbols & inputs:
                yield Definition(_named(name, meaning), found)


def _unfolded(parts: Parts) -> Parts:
    """Carry out derivatives of expressions, and what SymPy holds back otherwise."""
    known: dict[Expr, Expr] = {}

    def over(e: Expr) -> Expr:
        return _exchanged(as_expression(e), known, _done)

    return replace(
        parts,
        rates=[over(e) for e in parts.rates],
        right=tuple(over(e) for e in parts.right),
        mass=None if parts.mass is None else parts.mass.applyfunc(over),
        follows={d: over(e) for d, e in parts.follows.items()},
        held=tuple((name, meaning, over(e)) for name, meaning, e in parts.held),
        outputs=tuple((name, over(e)) for name, e in parts.outputs),
    )


def _done(node: Expr) -> Expr:
    held_back = isinstance(node, sp.Subs | sp.UnevaluatedExpr) or (
        isinstance(node, sp.Derivative) and not isinstance(node.expr, AppliedUndef)
    )
    return node.doit() if held_back else node


def _spelt(functions: Iterable[Expr]) -> dict[Expr, Expr]:
    return {f: sp.Symbol(_name_of(f), real=True) for f in functions}


def _time(states: Iterable[Expr], expressions: Sequence[Expr]) -> Expr:
    """Return the one symbol of time: the argument of functions, else the symbol of that name."""
    arguments = {a for f in (*states, *expressions) for x in nodes((f,))
                 if isinstance(x, AppliedUndef) for a in x.args if isinstance(a, sp.Symbol)}  # fmt: skip
    usual = _usual_time()
    names = {a.name for a in arguments} if len(arguments) == 1 else {usual.name}
    found = {
        s for s in nodes((*states, *expressions)) if isinstance(s, sp.Symbol) and s.name in names
    }
    if len(found) > 1:
        raise InputError(
            f"two symbols called {min(names)}: with other assumptions SymPy's symbols are not the same",
            got=", ".join(sorted(sp.srepr(s) for s in found)),
            expected=f"one symbol of time, as {sp.srepr(usual)}, which is dynamicsymbols._t",
        )  # fmt: skip
    return next(iter(found), usual)


def _of_state(f: Expr, states: Sequence[Expr]) -> bool:
    """Return whether ``f`` is a derivative of a state."""
    inner = {s.expr if isinstance(s, sp.Derivative) else s for s in states}
    return isinstance(f, sp.Derivative) and f.expr in inner


def _follows(parts: Parts) -> dict[Expr, Expr]:
    """Return what derivatives of states are, where the equations say so without a solve."""
    known = dict(parts.follows)
    for k, (s, rate) in enumerate(zip(parts.states, parts.rates, strict=False)):
        if isinstance(s, AppliedUndef | sp.Derivative) and _alone(parts.mass, k):
            derivative = s.diff(next(iter((s.expr if isinstance(s, sp.Derivative) else s).args)))
            if not rate.has(derivative):
                known.setdefault(derivative, rate)
    return known


def _follow(follows: Mapping[Expr, Expr], known: dict[Expr, Expr]) -> None:
    """Add to ``known`` what derivatives are, each behind those that it needs; circles are left out."""
    waiting = {d: e for d, e in follows.items() if d not in known}
    while waiting:
        ready = [d for d, e in waiting.items() if not any(e.has(other) for other in waiting)]
        for d in ready:
            known[d] = _exchanged(waiting.pop(d), known)
        if not ready:
            return


def _alone(mass: Expr | None, k: int) -> bool:
    """Return whether row ``k`` of a matrix is that of the identity."""
    return mass is None or (
        k < mass.rows and all(mass[k, j] == int(j == k) for j in range(mass.cols))
    )


def _exchanged(expression: Expr, known: dict[Expr, Expr], done: Any = lambda node: node) -> Expr:
    """Put what ``known`` says for its keys, a derivative before the function in it; it grows.

    ``done``: makes of each node what stands for it, from the leaves up. What a derivative is of is not
    looked into.
    """
    stack = [expression]
    while stack:
        node = stack[-1]
        inner = () if isinstance(node, sp.Derivative | sp.Subs) else node.args
        waiting = [] if node in known else [a for a in inner if a not in known]
        if waiting:
            stack += waiting
            continue
        stack.pop()
        if node not in known:
            args = [known[a] for a in inner]
            same = all(a is b for a, b in zip(args, inner, strict=True))
            known[node] = done(node if same else node.func(*args))
    return known[expression]


def _functions_of_time(expressions: Iterable[Expr], time: Expr) -> list[Expr]:
    """Return functions and derivatives, in the order of their names; others than of time are refused."""
    found = {e for e in nodes(expressions) if isinstance(e, AppliedUndef | sp.Derivative)}
    for f in found:
        inner = f.expr if isinstance(f, sp.Derivative) else f
        if inner.args != (time,):
            raise InputError("not a function of time alone", got=f, expected="f(t), or a symbol")
    inner = {f.expr for f in found if isinstance(f, sp.Derivative)}
    bare = {f for f in found if f not in inner or _occurs_alone(f, expressions)}
    return sorted(bare, key=_name_of)


def _occurs_alone(f: Expr, expressions: Iterable[Expr]) -> bool:
    """Return whether ``f`` is used other than under a derivative."""
    hidden = {d: sp.Integer(0) for e in expressions for d in e.atoms(sp.Derivative) if d.has(f)}
    return any(e.xreplace(hidden).has(f) for e in expressions)


def _name_of(e: Expr) -> str:
    """Return q1 for q1(t), q1_dot and q1_ddot for its derivatives."""
    if isinstance(e, sp.Derivative):
        count = sum(int(n) for _, n in e.variable_count)
        return f"{_name_of(e.expr)}_{'d' * count}ot"
    return str(e.func.__name__) if isinstance(e, AppliedUndef) else str(e)


def _distinct(spelt: Iterable[Expr]) -> None:
    names = [s.name for s in spelt]
    twice = sorted({n for n in names if names.count(n) > 1})
    if twice:
        raise InputError("two variables get one name", got=", ".join(twice))
