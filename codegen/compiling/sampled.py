"""Laws that are sampled: as a user gives them, and as a run has them.

A symbolic law is compiled with its system (`eom.quantities.Sampling`); a law in Python is called at each
sample. Both set inputs that are held in between, so that methods see nothing but these.
"""

from __future__ import annotations

import copy
import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.compiling.signals import Inputs, Signal, reads_state
from codegen.frontend.layout import names_of
from codegen.ir.program import SAMPLES, SameObject
from codegen.native.trajectory import Array, Held, Law
from eom.errors import InputError, shown, typed_fields, unknown_name
from eom.quantities import checked_times
from eom.system import System, as_expression

NOTHING = object()
"""No memory."""


@typed_fields
@dataclass(frozen=True)
class Sampled:
    """A law of control that is evaluated once a ``period`` (s), and whose value is held in between.

    Parameters
    ----------
    law : expression or callable
        Over states, outputs, parameters, inputs and time of the system, which is compiled with it,
        or a function of time, f(t), or of time and states by name, f(t, x). For
        ``inputs={"u": ...}`` it gives the one input, in its unit; for ``inputs=Sampled(...)``
        expressions by the names of the inputs, or a function that returns all inputs by name or in
        order. Symbols that the system does not have are further parameters of the run.
    period : float
        Between samples (s); the first is at the start of a run, and steps of every method end at
        samples.
    delay : float, default 0.0
        From a sample until its value takes effect (s), as for computing; it may be longer than the
        period. Until then an input is zero.
    states : mapping, optional
        Of a symbolic law itself (an integrator, observer, filter), the expression of the next value
        of each by its name; they start at zero, or where ``initial`` says, and change at the
        sample.
    memory : number, expression or several, optional
        Of a function, anything that it keeps from sample to sample: the law is then f(t, x, memory)
        and returns its value and the next memory. Every run starts with a copy of the first.

    Raises
    ------
    InputError
        For what is no law, a period that is not positive, a negative delay, ``states`` of a
        function and ``memory`` of expressions.

    Notes
    -----
    Laws read what is there just before the sample, the inputs that they set among it.

    Examples
    --------
    >>> Sampled(lambda t, x: -2 * x["angle"], period=0.01, delay=0.002).period
    0.01
    """

    law: Any
    period: float
    delay: float = 0.0
    states: Mapping[Any, Any] | None = None
    memory: Any = NOTHING

    def __post_init__(self) -> None:
        checked_times(self.period, self.delay, "Sampled")
        if self.is_function:
            self._check_function()
        elif self.memory is not NOTHING:
            raise InputError("a symbolic law has no memory", where="Sampled", got=shown(self.law),
                             hint="give states with their next values")  # fmt: skip
        elif not isinstance(self.law, Mapping):
            as_expression(self.law)

    def _check_function(self) -> None:
        if self.states is not None:
            raise InputError(
                "a function has no states by expressions",
                where="Sampled",
                got=f"states of {shown(self.law)}",
                hint="give a memory: f(t, x, memory) returns a value and the next one",
            )
        if isinstance(self.law, Signal):
            raise InputError("a Signal is not sampled", where="Sampled", got="a Signal",
                             hint="give its function; knots mean nothing between samples")  # fmt: skip
        if self.memory is NOTHING:
            reads_state(self.law, "the law of a Sampled")
        else:
            _check_takes(self.law)

    @property
    def is_function(self) -> bool:
        """Whether the law is called from Python."""
        return callable(self.law) and not hasattr(self.law, "free_symbols")

    def fresh(self) -> Callable[..., Any]:
        """Return the function for one run: of f(t, x, memory) one that keeps a copy of the memory."""
        if self.memory is NOTHING:
            return self.law  # type: ignore[no-any-return]
        return _Remembering(self.law, copy.deepcopy(self.memory))


def _check_takes(function: Callable[..., Any]) -> None:
    try:
        inspect.signature(function).bind(0.0, {}, None)
    except TypeError:
        raise InputError(
            "the law of a Sampled with memory is no such function",
            where="Sampled",
            got=f"f{inspect.signature(function)}",
            expected="f(t, x, memory)",
        ) from None
    except ValueError:  # written in C, without a signature
        return


class _Remembering:
    """A law f(t, x, memory) as one f(t, x), for one run."""

    def __init__(self, law: Callable[..., Any], memory: Any) -> None:
        self.law, self.memory = law, memory

    def __call__(self, t: float, x: Mapping[str, float]) -> Any:
        found = self.law(t, x, self.memory)
        if not isinstance(found, tuple) or len(found) != 2:
            raise InputError("a law with memory does not return its value and the next memory",
                             where=f"sample at t = {t:.9g} s", got=repr(found)[:200],
                             expected="a pair: value, memory")  # fmt: skip
        value, self.memory = found
        return value


@dataclass(frozen=True)
class Function:
    """A law in Python for some inputs of a system, as `codegen.native.trajectory.Called` wants it."""

    sampled: Sampled
    names: tuple[str, ...]
    states: tuple[str, ...]
    all: bool
    zero: tuple[float, ...] = ()

    def fresh(self) -> Callable[[float, Array, Array], None]:
        """Return f(t, x, out) of time (s) and states (n,), which puts the inputs into ``out``, in order."""
        function = self.sampled.fresh()
        given: Any = function if self.all else {self.names[0]: function}
        held = np.zeros(len(self.names))
        inputs = Inputs(held, self.names, given, self.states, self.zero, watched=False)

        def call(t: float, x: Array, out: Array) -> None:
            out[:] = inputs(t, x)

        return call if self.all else inputs.single

    def since(self, zero: tuple[float, ...]) -> Function:
        """Return the same over a time that is zero at ``zero``, a sum."""
        return replace(self, zero=(*self.zero, *zero))


# --- what a run has ---------------------------------------------------------------------------------


def split(compiled: Compiled, given: Any) -> tuple[Compiled, Any, dict[str, Sampled]]:
    """Return a system with the symbolic laws among ``given`` inputs, the other inputs, functions by name.

    One function for all inputs has the name ``""``. Raises `InputError` for laws that do not fit.
    """
    if isinstance(given, Sampled):
        if given.is_function:
            return compiled, {}, {"": given}
        if not isinstance(given.law, Mapping):
            raise InputError("one sampled expression for all inputs", got=shown(given.law),
                             expected='expressions by the names of inputs, {"u": ...}')  # fmt: skip
        return _under(compiled, ((given, tuple(given.law.items())),)), {}, {}
    if not isinstance(given, Mapping):
        return compiled, given, {}
    found = {n: law for n, law in given.items() if isinstance(law, Sampled)}
    rest = {n: v for n, v in given.items() if n not in found}
    symbolic = {n: law for n, law in found.items() if not law.is_function}
    for name, law in symbolic.items():
        if isinstance(law.law, Mapping):
            raise InputError("expressions by name for one input", where=f"input {name}",
                             got=shown(law.law), hint="inputs=Sampled({...}) sets several")  # fmt: skip
    if symbolic:
        rows = tuple((law, ((n, law.law),)) for n, law in symbolic.items())
        compiled = _under(compiled, rows)
    for name in found:
        if name not in names_of(compiled.layout.inputs):
            raise unknown_name("input", name, names_of(compiled.layout.inputs))
    return compiled, rest, {n: law for n, law in found.items() if law.is_function}


Rows = tuple[tuple[Sampled, tuple[tuple[Any, Any], ...]], ...]


class _Key:
    """A system and laws for it, equal to others by what these say."""

    def __init__(self, compiled: Compiled, rows: Rows) -> None:
        self.compiled, self.rows = compiled, rows
        said = [
            (law.period, law.delay, _texts(laws), _texts((law.states or {}).items()))
            for law, laws in rows
        ]
        self._said = (SameObject(compiled), tuple(said))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and self._said == other._said

    def __hash__(self) -> int:
        return hash(self._said)


def _texts(rows: Any) -> tuple[tuple[Any, Any], ...]:
    """Return names and expressions of laws, as SymPy's objects, by which they are compared."""
    return tuple((getattr(n, "name", n), as_expression(e)) for n, e in rows)


def _under(compiled: Compiled, rows: Rows) -> Compiled:
    """Return a compiled system under symbolic laws, made once for the same laws."""
    return _under_once(_Key(compiled, rows))


@lru_cache(maxsize=32)
def _under_once(key: _Key) -> Compiled:
    system: System = key.compiled.system
    for law, laws in key.rows:
        system = system.with_control(
            dict(laws), dict(law.states or {}), period=law.period, delay=law.delay
        )
    s = key.compiled.structure
    held: Mapping[str, float | str] = {**s.parameters, **s.equal}
    return compile_system(
        system, key.compiled.target, held, s.states, s.inputs,
        key.compiled.program.rules.name, key.compiled.stable,
    )  # fmt: skip


def laws_of(compiled: Compiled, functions: Mapping[str, Sampled]) -> tuple[Law, ...]:
    """Return the laws of a run: those of its system, then those in Python.

    Raises `InputError` for an input that has two.
    """
    names, states = names_of(compiled.layout.inputs), names_of(compiled.layout.states)
    held = compiled.system.held
    free = [n for n in names if n not in held]
    found = [
        Law.of(
            s.period, s.delay, [names.index(d.name) for d in s.laws],
            stepped=tuple(names.index(d.name) for d in s.states),
        )
        for s in compiled.system.sampled
    ]  # fmt: skip
    for name, law in functions.items():
        own = tuple(free) if not name else (name,)
        if not own or not set(own) <= {*free}:
            raise InputError("no input that a sampled function could set", where=f"input {name}".strip(),
                             got=f"inputs {', '.join(names) or 'none'}",
                             expected="inputs that no other law sets")  # fmt: skip
        called = Function(law, own, states, not name)
        found.append(Law.of(law.period, law.delay, [names.index(n) for n in own], called=called))
    return tuple(found)


def refuse(compiled: Compiled, what: str) -> None:
    """Raise `InputError` where laws are sampled: ``what`` sees inputs that are held for ever."""
    if compiled.system.sampled:
        raise InputError(
            f"{what} would take inputs for held that sampled laws change",
            where=f"system {compiled.layout.name!r}",
            got=f"sampled {', '.join(compiled.system.held)}",
            expected="a system without sampled laws: the open loop, or laws without a period",
        )


def start_values(compiled: Compiled, initial: Any, inputs: Any) -> tuple[Any, Any]:
    """Return initial values and inputs by name, with what is held before the first sample among the inputs.

    States of sampled laws may stand among the initial values. Raises `InputError` for one function of all
    inputs beside sampled laws.
    """
    system = compiled.system
    if not system.sampled:
        return initial, inputs
    if not isinstance(inputs, Mapping):
        raise InputError("values of inputs beside sampled laws are given by name", got=shown(inputs),
                         expected='inputs={"name": value or function}')  # fmt: skip
    own = {d.name for s in system.sampled for d in s.states}
    moved = {n: v for n, v in initial.items() if n in own} if isinstance(initial, Mapping) else {}
    rest = {n: v for n, v in initial.items() if n not in own} if moved else initial
    defaults = {q.name: q.default or 0.0 for q in system.inputs if q.name in system.held}
    for name in system.held:
        if callable(inputs.get(name)):
            raise InputError(f"input {name} is set by a sampled law", got="a function of time",
                             expected="its value before the first sample, or none")  # fmt: skip
    return rest, {**defaults, **inputs, **moved}


def compiled_in(compiled: Compiled, given: Any) -> tuple[Compiled, Mapping[str, float]]:
    """Return a system under the symbolic laws among inputs, and values of inputs by name.

    Raises `InputError` for functions, where nothing calls Python.
    """
    compiled, rest, functions = split(compiled, given)
    if callable(rest) or functions or any(map(callable, rest.values())):
        raise InputError(
            "an input is a function in Python",
            where="ensemble",
            expected="numbers, or laws that are compiled with the system",
            hint="write it as an expression: System.with_control, or codegen.Sampled of one",
        )
    return compiled, start_values(compiled, {}, rest)[1]


def first_inputs(
    compiled: Compiled, laws: Sequence[Law], at: tuple[float, Array, Array], u: Array
) -> Array:
    """Return inputs (m,) behind the first sample of the laws that are generated.

    ``at``: time, states, parameters; ``u``: the inputs before it.
    """
    function, first, found = compiled.functions.get(SAMPLES), 0, u.copy()
    for law in laws:
        if law.called is not None or function is None:
            continue
        places = (*law.applied, *law.stepped)
        values = function(*at, u)[first : first + len(places)]
        waits = len(law.applied) if law.whole or law.rest else 0
        found[list(places[waits:])] = values[waits:]
        first += len(places)
    return found


def check_laws(laws: Sequence[Law], t_span: tuple[float, float]) -> None:
    """Raise `InputError` for samples in a run backwards, or closer than times are told apart."""
    if not laws:
        return
    start, end = t_span
    if end < start:
        raise InputError("a run with sampled laws cannot go backwards", got=t_span,
                         hint="what a sample gives is known after it alone")  # fmt: skip
    finest = 1024 * float(np.spacing(max(abs(start), abs(end))))
    for law in laws:
        if law.period < finest:
            raise InputError(
                "the period of samples is below the resolution of time",
                got=f"{law.period!r} s",
                expected=f"at least {finest:.3g} s at t = {end:g} s",
            )


class Along:
    """Inputs along a run that has been made: what was held, and functions of time and states."""

    def __init__(self, held: Held, laws: Sequence[Law], signals: Inputs | None) -> None:
        self.held, self.signals = held, signals
        self.places = [k for law in laws for k in (*law.applied, *law.stepped)]

    def along(self, times: Array, states: Array) -> Array:
        """Return values (m, K) at times (K,) in ``states`` (n, K)."""
        held = self.held.at(times)
        if self.signals is None:
            return held
        values = self.signals.along(times, states)
        values[self.places] = held[self.places]
        return values
