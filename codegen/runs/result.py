"""What a run gives: a `Result`, of which is evaluated what is read.

What decides whether there is a result at all is known when it is made: times, states, how it ended.
Outputs, drift, margins, the message and notices are found when they are first read, from arrays of their
own, so that nothing that is done to ``t`` and ``y`` meanwhile changes them.

A run that stops says in words when, which quantity failed, and what to do about it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from codegen.compiling import events as looked_for
from codegen.compiling.compiled import Compiled
from codegen.compiling.events import Occurrences
from codegen.compiling.sampled import Along
from codegen.compiling.signals import Followed
from codegen.frontend.layout import names_of
from codegen.frontend.notebook import listed, number, sparkline, table
from codegen.integrate.choice import Task
from codegen.ir.program import INVARIANTS, OUTPUTS, SINGULARITIES
from codegen.native.trajectory import Array, Problem, Trajectory
from codegen.runs.arguments import numbers
from codegen.runs.clock import Clock, Late
from codegen.runs.export import dataset, frame, read, save
from codegen.runs.pruning import Drift, Terms, drift_of
from codegen.runs.run_accuracy import Accuracy, Run, accuracy_of
from codegen.runs.second_run import Origin
from codegen.runs.turns import Sampled as AtSamples
from codegen.runs.turns import counted
from eom.displays import display
from eom.errors import InputError, typed, unknown_name
from eom.system import Singularity


@dataclass(frozen=True)
class NotKept:
    """What stands for a dense output that was not made: it is false, and says so when it is called.

    Raises `InputError` when it is called.
    """

    def __bool__(self) -> bool:
        """Return False."""
        return False

    def __call__(self, *_: ArrayLike) -> Array:
        """Raise `InputError`: there are no values at any time (s)."""
        raise InputError(
            "the run has no dense output",
            hint="simulate with dense_output=True, or ask for times by t_eval",
        )


def _loaded(found: Mapping[str, Any]) -> Result:
    """Return a result from what a file holds."""
    drift = {n: Drift(d["start"], d["largest"], d["over_time"], partial(float, d["size"]))
             for n, d in found["drift"].items()}  # fmt: skip
    events = {n: Occurrences(e["t"], e["y"], e["direction"]) for n, e in found["events"].items()}
    return Result(**{**found, "sol": None, "drift": drift, "events": events})


def _nothing() -> None:
    """Return what a result that was put together came from."""


READ_LATER = frozenset(
    ("outputs", "drift", "margin", "message", "notice", "events", "origin", "units", "held")
)
"""Fields of a `Result` that are found when they are first read; see `Found`."""


@dataclass(frozen=True)
class Result:
    """A trajectory, with SciPy's field names and what belongs to mechanics.

    Parameters
    ----------
    t : array
        Stored times, (N,).
    y : array
        States at these: ``y`` (n, N).
    sol : callable
        Dense output, or `NotKept`, which is false.
    nfev : int
        Evaluations of the rates.
    status : int
        0: end reached; 1: stopped at a singular configuration; 2: at a terminal event; -1: stopped
        because numbers failed.
    message : str
        The same in words.
    outputs : mapping of str to array
        Arrays (N,) by name, angles of a quaternion with their whole turns (`codegen.runs.turns`).
    drift : mapping of str to Drift
        By name of the invariant.
    margin : mapping of str to floats
        Least distance from each singularity, by its expression.
    t_stop : float
        When the run stopped.
    y_stop : array
        Where it stopped, (n,).
    method : str
        What integrated.
    steps : int
        That were made.
    rejected : int
        Steps that were tried in vain.
    seconds : float, default 0.0
        What the run took.
    notice : str, optional
        What the user should know.
    why : str, optional
        The reason, where the method was chosen and not given.
    names : tuple of str, optional
        Of the states, in the order of ``y``.
    events : mapping of str to Occurrences, optional
        What was found, by name.
    held : mapping of str to floats, optional
        By name the states that became parameters, and what they kept.

    Notes
    -----
    ``success`` is status >= 0. ``t_events`` and ``y_events`` are what was found in order, as SciPy
    has them. ``result[name]`` gives one of the states, an output, or what kept its initial value:
    ``held``. Units are those of the system.
    """

    t: Array
    y: Array
    sol: Any
    nfev: int
    status: int
    message: str
    outputs: Mapping[str, Array]
    drift: Mapping[str, Drift]
    margin: Mapping[str, float]
    t_stop: float
    y_stop: Array
    method: str
    steps: int
    rejected: int
    seconds: float = 0.0
    notice: str = field(default_factory=str)
    why: str = ""
    names: tuple[str, ...] = field(default=())
    left_out: tuple[str, ...] = ()
    """States and constants of the motion that the requested outputs do not need."""
    events: Mapping[str, Occurrences] = field(default_factory=dict, repr=False)
    held: Mapping[str, float] = field(default_factory=dict, repr=False)
    origin: object = field(default_factory=_nothing, repr=False, compare=False)
    """What it came from, for `accuracy`; it stays behind when a result is pickled."""
    estimate: Accuracy | None = field(default=None, repr=False, compare=False)
    """What `with_accuracy` found."""
    units: Mapping[str, str] = field(default_factory=dict, repr=False, compare=False)
    """Unit of time (under ``t``), and of each state, held or not, and output, by name."""

    @typed
    def accuracy(self, limit: float | None = None) -> Accuracy:
        """Return an estimate of the error of every state, and of how errors grow.

        Parameters
        ----------
        limit : float, optional
            Seconds of processor time for that, by default five times what the run took, 2 s at
            least; where they do not do, the estimate says so.

        Returns
        -------
        Accuracy
            See `codegen.Accuracy`. Units are those of the system.

        Raises
        ------
        InputError
            For a result that was pickled, read or put together, and so does not know what it came
            from.

        Notes
        -----
        A second run, by another kind of method at a thousandth of the tolerance or less, gives the
        error; the derivative along it shows how errors grow.
        """
        if self.estimate is not None:
            return self.estimate
        run = Run(
            self.t, self.y, self.t_stop, self.y_stop,
            self.status, self.steps, self.seconds, self.origin,
        )  # fmt: skip
        return accuracy_of(run, limit)

    @typed
    def with_accuracy(self, limit: float | None = None) -> Result:
        """Return the same with the estimate of `accuracy`, whose warning then is in ``notice``.

        Parameters
        ----------
        limit : float, optional
            As of `accuracy`.

        Returns
        -------
        Result
            Its ``notice`` holds the estimate's warning where there is one.

        Raises
        ------
        InputError
            As of `accuracy`.
        """
        found = self.accuracy(limit)
        warning = "" if self.estimate else found.warning
        return replace(self, estimate=found, notice=joined_notices(self.notice, warning))

    def __getattr__(self, name: str) -> Any:
        """Find what is read for the first time."""
        found = self.__dict__.get("_found")
        if found is None or name not in READ_LATER:
            raise AttributeError(f"a Result has no attribute {name!r}", name=name, obj=self)
        value = self.__dict__[name] = getattr(found, name)
        return value

    def __getstate__(self) -> dict[str, Any]:
        """Pickle and copy what was found, not what it came from."""
        read = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "origin"}
        return {**read, "origin": None}

    def __copy__(self) -> Result:
        """Copy with what it came from."""
        return replace(self)

    def __post_init__(self) -> None:
        """Put in place of a dense output that was not made what says so."""
        if self.sol is None:
            object.__setattr__(self, "sol", NotKept())

    def __repr__(self) -> str:
        """Say how the run ended, what it holds, and what the user should know of it."""
        names = listed((*self.names, *self.outputs))
        drift = listed([f"{n} {d.relative:.1e}" for n, d in self.drift.items()])
        drifts = f"; drift {drift}" if drift else ""
        notice = f"; notice: {self.notice}" if self.notice else ""
        held = f"{len(self.t)} points of {names}; {self.steps} steps"
        return f"Result({self.message}; {held}{drifts}{notice})"

    def _repr_html_(self) -> str:
        """Return what a notebook displays: values at the ends, and lines over time."""
        rows = [
            (n, self.units.get(n, ""), *map(number, v[[0, -1]]), sparkline(self.t, v))
            for n, v in ((n, self[n]) for n in (*self.names, *self.outputs))
            if len(v)
        ]
        drift = [f"drift of {n} {d.relative:.1e}" for n, d in self.drift.items()]
        words = [f"{self.steps} steps, {self.method}", listed(drift), self.notice]
        told = "".join(f"<p>{escape(w)}</p>" for w in words if w)
        return table(rows, ("", "unit", "first", "last", "over time"), self.message) + told

    @typed
    def at(self, t: ArrayLike) -> dict[str, Array]:
        """Return the states by name at any times of the run.

        Parameters
        ----------
        t : array
            Times (s), a number or (K,).

        Returns
        -------
        dict of str to array
            Values of the dense output ``sol``, each of the shape of ``t``, () or (K,). Units are
            those of the system.

        Raises
        ------
        InputError
            Where no dense output was made, and for what are no numbers.
        """
        times = numbers(t, "t")
        if times.ndim > 1:
            raise InputError("t does not fit", got=times.shape, expected="a number, or (K,)")
        return dict(zip(self.names, np.asarray(self.sol(times)), strict=True))

    def to_pandas(self) -> Any:
        """Return a data frame of pandas: states and outputs in columns, by the time in its index.

        States that kept their initial values have columns, too. Their units stand in ``attrs["units"]``.
        Raises `InputError` where pandas is not installed (extra ``tables``).
        """
        return frame(self)

    def to_xarray(self) -> Any:
        """Return a data set of xarray: states and outputs over the time t, each with its unit as ``units``.

        Raises `InputError` where xarray is not installed (extra ``tables``).
        """
        return dataset(self)

    @typed
    def save(self, path: str | Path) -> Path:
        """Write all that was found into a file.

        Parameters
        ----------
        path : str or path
            A NumPy archive (.npz), which `load` reads, with time, states and outputs by name, units
            and the rest beside them; or a table (.csv) of time, states and outputs alone. States that
            kept their initial values are among them.

        Returns
        -------
        path
            Of the file.

        Raises
        ------
        InputError
            For other endings, and where the file cannot be written.
        """
        return save(self, path)

    @classmethod
    @typed
    def load(cls, path: str | Path) -> Result:
        """Return a result that `save` has written; nothing in the file is run, whoever wrote it.

        Parameters
        ----------
        path : str or path
            Of an archive (.npz).

        Returns
        -------
        Result
            It has no dense output, and does not know what it came from. Units are those of the
            system.

        Raises
        ------
        InputError
            For a file that is no such archive.
        """
        return _loaded(read(path))

    @typed
    def plot(self, *names: str) -> Any:
        """Return a picture of states and outputs over time; a notebook displays it.

        Parameters
        ----------
        names : str
            Of states and outputs, all unless given.

        Returns
        -------
        Picture
            Quantities of one unit are drawn together, the drift of constants of the motion below
            (`eom.views.time.histories`). Units are those of the system; angles in rad. Its
            ``save(path)`` writes a file .png, .svg, .pdf or .html, and its ``figure()`` is one of
            Matplotlib.

        Raises
        ------
        InputError
            For unknown names and fewer than two times.

        Notes
        -----
        Needs the extra ``plot``.
        """
        return display("result as histories", self, names)

    @typed
    def animate(self, scene: Any = None, speed: float | None = None) -> Any:
        """Return an animation of the motion in space; a notebook displays it, ``write(path)`` makes a page.

        Parameters
        ----------
        scene : Scene or TreeScene, optional
            That the system was derived from, whose bodies are drawn; without it a single body whose
            attitude among the states is a quaternion or angles, as a uniform body of its inertia
            (kg m^2).
        speed : float, optional
            Seconds of the motion that are shown in one.

        Returns
        -------
        animation
            ``write(path)`` makes a page of it. Vectors have components in A, the frame that
            attitude is measured in.

        Raises
        ------
        InputError
            For other systems, and for a result that does not know what it came from.
        """
        return display("result as animation", self, scene, speed)

    @property
    def success(self) -> bool:
        """True if the end, a singular configuration or a terminal event was reached."""
        return self.status >= 0

    @property
    def t_events(self) -> list[Array]:
        """Times (K,) of each event, in order."""
        return [found.t for found in self.events.values()]

    @property
    def y_events(self) -> list[Array]:
        """States (K, n) at each event, in order."""
        return [found.y.T for found in self.events.values()]

    def __getitem__(self, name: str) -> Array:
        """Return the values of a state or output.

        Parameters
        ----------
        name : str
            Of the state or output.

        Returns
        -------
        array
            (N,), at the stored times, in its unit.

        Raises
        ------
        InputError
            For others.
        """
        if name in self.outputs:
            return self.outputs[name]
        if name in self.names:
            row: Array = self.y[self.names.index(name)]
            return row
        if name in self.held:
            return np.full(len(self.t), self.held[name])
        raise unknown_name("state or output", name, [*self.names, *self.outputs, *self.held])


class Found:
    """What a result is made of, and what is found of it when it is read, by the names of its fields.

    ``make``: what returns, of ``given``, the task that was integrated; it is over the time of a clock, if
    there is one, beside the problem in the times of the user (``timing``). ``further``: notices that are
    known before.
    """

    def __init__(
        self,
        make: Callable[..., Task],
        trajectory: Trajectory,
        method: str,
        timing: tuple[Clock, Problem] | None,
        further: tuple[str, str],
        given: tuple[Any, ...] = (),
    ) -> None:
        self.make, self.given, self.trajectory, self.method = make, given, trajectory, method
        self.timing, self.further = timing, further

    @cached_property
    def task(self) -> Task:
        """What was integrated."""
        return self.make(*self.given)

    @property
    def message(self) -> str:
        """How the run ended, in words."""
        labels = [e.label for e in self.task.events]
        return message(self.task.compiled, self.trajectory, self.task.problem, labels)

    @cached_property
    def outputs(self) -> dict[str, Array]:
        """The outputs, angles of a quaternion with their whole turns."""
        return self._counted[0]

    @cached_property
    def _counted(self) -> tuple[dict[str, Array], str]:
        compiled, made = self.task.compiled, self.trajectory
        inputs, results = self.inputs, compiled.layout.results[OUTPUTS]
        named = {
            **_held(self.task, made),
            **dict(zip(results, self._evaluated(OUTPUTS), strict=True)),
        }
        if not compiled.system.angles:
            return named, ""
        return counted(AtSamples(compiled, self.task.problem, made, inputs), named)

    @property
    def drift(self) -> dict[str, Drift]:
        """The drift of every constant of the motion."""
        values, task = self._evaluated(INVARIANTS), self.task
        terms = Terms(task.compiled, task.problem, self.trajectory, values, self.inputs)
        rows = enumerate(zip(task.compiled.layout.results[INVARIANTS], values, strict=True))
        return {n: drift_of(v, partial(terms.scale, k)) for k, (n, v) in rows}

    @property
    def margin(self) -> dict[str, float]:
        """The least distance from each singularity."""
        results = self.task.compiled.layout.results[SINGULARITIES]
        return dict(zip(results, self.trajectory.closest, strict=True))

    @property
    def events(self) -> Mapping[str, Occurrences]:
        """What was found, in the times of the user."""
        found = looked_for.occurrences(self.task.events, self.trajectory.found)
        if self.timing is None:
            return found
        return {n: replace(e, t=self.timing[0].start + e.t) for n, e in found.items()}

    @property
    def notice(self) -> str:
        """All that the user should know of the run."""
        blind = self.task.signals.notice if self.task.signals else ""
        winding = self._counted[1] if self.task.compiled.system.angles else ""
        doubt, unknown = self.further
        own = (self.task.compiled.notice, self.trajectory.notice, blind, winding, doubt)
        return joined_notices(*own, self._coarse, unknown if self.trajectory.steps else "")

    @property
    def _coarse(self) -> str:
        if self.timing is None:
            return ""
        t = self.times
        again = len(t) - len(np.unique(t))
        coarse = f"{again} of {len(t)} times are stored like others: give t_span since an epoch"
        return coarse if again else ""

    @property
    def held(self) -> dict[str, float]:
        """The values of states that became parameters."""
        task = self.task
        rows = zip(task.compiled.layout.parameters, task.problem.parameters, strict=False)
        return {q.name: float(p) for q, p in rows if q.held}

    @property
    def units(self) -> dict[str, str]:
        """The unit of time, and of each state, held or not, and output."""
        layout = self.task.compiled.layout
        known = {q.name: q.unit for q in layout.known}
        names = (*names_of(layout.states), *self.held, *self.outputs)
        return {"t": "s", **{n: known.get(n, "") for n in names}}

    @property
    def origin(self) -> Origin:
        """What it came from."""
        task, made = self.task, self.trajectory
        return Origin(
            task.compiled,
            replace(task.problem, progress=None),
            task.signals,
            self.method,
            made.methods or (self.method,),
            None if made.held is None else self.inputs,
        )

    @property
    def times(self) -> Array:
        """The stored times, in those of the user."""
        if self.timing is None:
            return self.trajectory.t.copy()
        clock, asked = self.timing
        return clock.times(self.trajectory.t, asked, ended=self.trajectory.stop.kind == "end")

    @property
    def inputs(self) -> Followed | None:
        """The inputs along a run, None where they were held all the way."""
        held, task = self.trajectory.held, self.task
        return task.signals if held is None else Along(held, task.problem.laws, task.signals)

    def _evaluated(self, group: str) -> Array:
        """Evaluate a group of results at the stored points."""
        task, t, y, inputs = self.task, self.trajectory.t, self.trajectory.y, self.inputs
        function = task.compiled.functions.get(group)
        if function is None:
            return np.empty((0, len(t)))
        u = task.problem.inputs if inputs is None else inputs.along(t, y)
        return function(t, y, task.problem.parameters, u)


READ_AT_ONCE = ("outputs", "drift", "notice")
"""What is found at once where a function of the user's has a part in it: it may change, and fail."""
_NOT_KEPT = NotKept()
_STATUS = {"end": 0, "singular": 1, "event": 2}


def result_of(
    found: Found, used: str, seconds: float, names: tuple[str, ...], left_out: tuple[str, ...]
) -> Result:
    """Return the result of a run; ``used``: what its method is called in full; ``names``: of the states."""
    made, timing = found.trajectory, found.timing
    stop = made.stop
    result, own = object.__new__(Result), {
        "t": made.t.copy() if timing is None else found.times, "y": made.y.copy(),
        "sol": _NOT_KEPT, "nfev": made.evaluations,
        "status": _STATUS.get(stop.kind, -1), "t_stop": stop.t, "y_stop": made.state_at_stop,
        "method": made.method or used, "steps": made.steps, "rejected": made.rejected,
        "seconds": seconds, "why": made.why, "names": names, "left_out": left_out,
        "estimate": None, "_found": found,
    }  # fmt: skip
    object.__setattr__(result, "__dict__", own)
    if timing is not None:
        ended, start = stop.kind == "end", timing[0].start
        own["t_stop"] = timing[1].t_span[1] if ended else start + stop.t
    if made.solution is not None and found.task.problem.dense_output:
        late = timing is not None and timing[0].start
        own["sol"] = Late(made.solution, late) if late else made.solution
    if made.held is not None or (not found.given and found.task.signals is not None):
        for name in READ_AT_ONCE:
            getattr(result, name)
    return result


def joined_notices(*notices: str) -> str:
    """Return notices as one."""
    return "; ".join(n for n in notices if n)


def _held(task: Task, trajectory: Trajectory) -> dict[str, Array]:
    """Return the inputs that laws held, by name, at the stored points."""
    if trajectory.held is None:
        return {}
    names, values = names_of(task.compiled.layout.inputs), trajectory.held.at(trajectory.t)
    return {names[k]: values[k] for law in task.problem.laws for k in (*law.applied, *law.stepped)}


def message(
    compiled: Compiled, trajectory: Trajectory, problem: Problem, events: Sequence[str]
) -> str:
    """Return when a run ended, why, and what to do about it; ``events``: what they are called."""
    stop, names = trajectory.stop, names_of(compiled.layout.states)
    at = f"stopped at t = {problem.time_text(stop.t)}"
    if stop.kind == "end":
        return f"reached t = {problem.time_text(problem.t_span[1])}"
    if stop.kind == "event":
        return f"{at}: event {events[stop.which]}"
    if stop.kind == "singular":
        return f"{at}: {_singular(compiled.system.singularities[stop.which], names, trajectory)}"
    if stop.kind == "not finite":
        where = f"{at}: {names[stop.which]} or its rate is not finite (NaN or infinity) beyond it"
        if stop.t != problem.t_span[0]:
            return where
        return f"{where} (a division by zero at the start: parts without mass?)"
    if stop.kind in _WORDS:
        return f"{at}: {_WORDS[stop.kind].format(max_steps=f'{problem.max_steps:,}')}"
    return (
        f"{at}: all of max_steps = {problem.max_steps:,} were tried; look for a jump in the rates "
        "(friction, sign) or stiffness, or raise max_steps"
    )


def _singular(found: Singularity, names: Sequence[str], trajectory: Trajectory) -> str:
    """Return at which coordinate a run stopped, what is zero there, and the way out if one is known."""
    meaning = "; ".join(w for w in (found.meaning, found.hint) if w)
    if found.coordinate.name not in names:
        return f"{found.expression} = 0 is singular: {meaning}"
    angle = trajectory.state_at_stop[names.index(found.coordinate.name)]
    return (
        f"{found.coordinate} = {angle:.9g} rad ({math.degrees(angle):.6f} deg) "
        f"is singular, {found.expression} = 0: {meaning}"
    )


_WORDS = {
    "step": (
        "the step fell below the resolution of time; the tolerance cannot be met there, "
        "or the rates on both sides of a jump lead back to it (friction at rest)"
    ),
    "coarse": (
        "equal steps that keep the relative tolerance are more than max_steps = {max_steps}; "
        "raise rtol or max_steps, or choose a method whose steps change"
    ),
    "thin": (
        "about an axis of small moment the rate follows from the momentum with a rounding error "
        "above its tolerance; give atol for it, or choose splitting or taylor"
    ),
    "memory": "no memory for more steps; give t_eval to store less",
}
"""What is said of kinds of stops that need nothing from the system."""
