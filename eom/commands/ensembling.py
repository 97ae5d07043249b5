"""Many trajectories of a scene: `eom ensemble`."""

from __future__ import annotations

import json
import math
import multiprocessing
import sys
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.options import FOLDER, chosen_values, option, options, scene_argument
from eom.commands.shared import Rows, WithTable, compiled_of, news, progress_of, scene_of
from eom.errors import InputError, printable, unknown_name

if TYPE_CHECKING:
    from codegen import Compiled, Ensemble, Sampler, Summary
    from codegen.ensembles.sampler import Samples
    from eom.opening import AnyScene
    from eom.system import SequenceAngles

MOST_POINTS = 1_000_000
"""Of times at which is counted."""
STOPPED = 1
"""Exit status where a trajectory ended before its time."""
LOCAL = "local"
WIDTH = 160
"""Columns of the table at least: no cell is cut."""
KNOWN = ("count", "seed", "vary")
"""What a file of distributions has."""


def _distributions() -> Rows:
    from codegen.ensembles.sampler import KINDS

    return [(kind.usage, kind.meaning) for kind in KINDS]


@click.command(cls=WithTable, title="Distributions", rows=_distributions)
@scene_argument
@click.option(
    "--vary",
    multiple=True,
    metavar="NAME=DISTRIBUTION",
    help="A state at the start, or a parameter; NAME,NAME,... for several that belong together.",
)
@click.option(
    "--samples",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    help="TOML file with count, seed and a table [vary] of distributions by name.",
)
@click.option(
    "--count", type=int, help="Trajectories.  [default: the file's, or each of a grid once]"
)
@click.option("--seed", type=int, help="Of the random numbers.  [default: the file's, or 0]")
@click.option(
    "--statistics",
    metavar="NAME,NAME,...",
    help="States and outputs.  [default: the scene's outputs]",
)
@click.option(
    "--quantiles", metavar="SHARE,SHARE,...", help="Shares from 0 to 1, as 0.05,0.5,0.95."
)
@option(
    "points",
    default=1,
    show_default=True,
    help="Times to count at; the last is the end.",
)
@option(
    "method", default="auto", show_default=True, metavar="auto|taylor|DOP853", help="Integrator."
)
@options("t_end", "rtol")
@click.option(
    "--out", "store", type=FOLDER, help="Folder for all trajectories, in chunks; "
    "a run that broke off goes on there.",
)  # fmt: skip
@click.option(
    "--format",
    "store_format",
    default="zarr",
    show_default=True,
    metavar="zarr|parquet",
    help="Of the chunks.",
)
@click.option(
    "--chunk", type=int, help="Trajectories of a chunk.  [default: by the memory they need]"
)
@click.option("--threads", type=int, help="By default as many as there are processors.")
@click.option(
    "--cluster", metavar="local|ADDRESS", help="Run on a Dask cluster instead of in threads."
)
@option("json")
def ensemble(
    scene: str, t_end: float | None, rtol: float | None, as_json: bool, **given: Any
) -> None:
    """Integrate SCENE from many starts and with many parameters, and print statistics.

    Trajectories are kept only with --out. The same seed gives the same numbers, whatever the threads.
    """
    chosen = scene_of(scene, t_end=t_end, rtol=rtol)
    shares = _shares(given.pop("quantiles"))
    plan = _plan(given.pop("samples"), given.pop("vary"), given.pop("count"), given.pop("seed"))
    found = _run(chosen, plan, quantiles=bool(shares), **given)
    if as_json:
        click.echo(json.dumps(_data(found, plan, shares), indent=1))
    else:
        _print(found, shares)
    if not found.success:
        sys.exit(STOPPED)


@dataclass(frozen=True)
class _Plan:
    """What varies, by name or names, in words; how many trajectories (0: as many as in the grids)."""

    vary: Mapping[str, str | float]
    count: int
    seed: int


def _plan(file: Path | None, vary: Sequence[str], count: int | None, seed: int | None) -> _Plan:
    """Return what a file and the options say; options come first. Raises `InputError`."""
    given = {} if file is None else _table(file)
    own: dict[str, str] = {}
    for text in vary:
        name, equals, words = text.partition("=")
        if not equals or name in own:
            what = f"{name} is varied twice" if equals else "nothing to vary by"
            raise InputError(
                what, where="--vary", got=text, expected="NAME=DISTRIBUTION, each once"
            )
        own[name] = words
    varied = {**given.get("vary", {}), **own}
    if not varied:
        raise InputError("nothing varies", hint="--vary NAME=DISTRIBUTION, or --samples FILE.toml")
    if twice := sorted(
        {n.strip() for names in varied for n in names.split(",")} & {*chosen_values()}
    ):
        raise InputError(
            f"{twice[0]} is set, and varied", where="--set and --vary", hint="leave one out"
        )
    return _Plan(
        varied,
        given.get("count", 0) if count is None else count,
        given.get("seed", 0) if seed is None else seed,
    )


def _table(file: Path) -> dict[str, Any]:
    try:
        found = tomllib.loads(file.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError("not a TOML file", where=str(file), got=str(error)) from None
    for name in found:
        if name not in KNOWN:
            raise unknown_name("entry", name, KNOWN, str(file))
    if not isinstance(found.get("vary", {}), dict):
        expected = "a table [vary] of distributions by name"
        raise InputError("not a table", where=str(file), got="vary", expected=expected)
    return found


def _shares(text: str | None) -> list[float]:
    try:
        found = [float(word) for word in text.split(",")] if text else []
    except ValueError:
        found = [math.nan]
    if not all(0 <= share <= 1 for share in found):
        raise InputError(
            "not shares",
            where="--quantiles",
            got=text,
            expected="numbers from 0 to 1, parted by commas",
        )
    return found


def _run(
    scene: AnyScene,
    plan: _Plan,
    statistics: str | None,
    quantiles: bool,
    points: int,
    cluster: str | None,
    **options: Any,
) -> Ensemble:
    import codegen

    compiled = compiled_of(scene, "auto")
    names = scene.requested_names() if statistics is None else tuple(statistics.split(","))
    sampler, parameters = _samples(scene, plan)
    end, settings = scene.integration.t_end, scene.integration
    times = _times(end, points)
    if options["store"] is not None:
        _say_what_is_stored(compiled, len(sampler), points, options["store"])
    with _client(cluster) as client, progress_of("integrating") as progress:
        found = codegen.ensemble(
            compiled,
            sampler,
            (0.0, end),
            parameters,
            rtol=settings.rtol,
            atol=settings.atol,
            t_eval=times,
            inputs=scene.input_values(),
            statistics=codegen.Statistics(names, quantiles),
            keep=False,
            max_step=settings.max_step or math.inf,
            max_steps=settings.max_steps,
            client=client,
            progress=progress,
            **options,
        )
    if notice := news(found.notice, compiled.notice):
        click.echo(f"note: {notice}", err=True)
    return found


def _say_what_is_stored(compiled: Compiled, count: int, points: int, store: Path) -> None:
    from codegen.ensembles.ensemble import size_of_one

    size = count * size_of_one(compiled, points)
    click.echo(f"note: {count:,} trajectories, {size:,} bytes, go to {printable(store)}", err=True)


def _times(end: float, points: int) -> list[float]:
    if not 1 <= points <= MOST_POINTS:
        raise InputError(
            "number of times does not fit",
            where="--points",
            got=points,
            expected=f"1 to {MOST_POINTS:,}",
        )
    return [end * k / points for k in range(1, points + 1)]


@dataclass(frozen=True)
class FromAngles:
    """Samples of a quaternion by those of the angles that a scene is shown in, as `codegen.Sampler`."""

    sampler: Samples
    angles: SequenceAngles

    @property
    def names(self) -> tuple[str, ...]:
        """What is sampled, with the quaternion in the place of the angles."""
        kept = (n for n in self.sampler.names if n not in self.angles.names)
        return (*kept, *self.angles.quaternion)

    def __len__(self) -> int:
        return len(self.sampler)

    def sample(self, first: int, last: int) -> Mapping[str, Any]:
        """Return arrays (last - first,) by name."""
        import numpy as np

        from eom.kinematics.coordinates import quaternion_of_sequence

        drawn = dict(self.sampler.sample(first, last))
        rows = zip(*(np.asarray(drawn.pop(n)).tolist() for n in self.angles.names), strict=True)
        q = np.array([quaternion_of_sequence(self.angles.sequence, row) for row in rows])
        return {**drawn, **dict(zip(self.angles.quaternion, q.T.copy(), strict=True))}


def _start_of(
    scene: AnyScene, varied: Sequence[str]
) -> tuple[dict[str, float], tuple[SequenceAngles, ...]]:
    """Return the values at the start, with angles in the place of a quaternion where one of them varies."""
    from eom.rotations import angles_of_matrix, matrix_of_quaternion
    from eom.scenes.start import pick

    values, start = scene.initial_values(), scene.start
    shown = tuple(a for a in scene.full_system.angles if set(a.names) & set(varied))
    for found in shown:
        q = pick(start, found.quaternion, "initial value", "[initial]").values()
        angles = angles_of_matrix(matrix_of_quaternion([*q]), found.sequence)
        values = {n: v for n, v in values.items() if n not in found.quaternion}
        values |= dict(zip(found.names, angles, strict=True))
    return values, shown


def _samples(scene: AnyScene, plan: _Plan) -> tuple[Samples, dict[str, float]]:
    """Return the sampler, which has every state, and the parameters that do not vary."""
    from codegen.ensembles.sampler import Sampler, sampler_of

    full = scene.full_system
    known = (*full.states, *full.parameters, *full.inputs, *full.output_quantities)
    units = {q.name: q.unit for q in known}
    varied = sampler_of(plan.vary, plan.count, plan.seed, units)
    if not len(varied):
        raise InputError("how many trajectories?", expected="--count N", hint="or a grid")
    _check_attitude(scene, varied)
    values = dict(varied.values)
    start, angles = _start_of(scene, varied.names)
    values |= {n: v for n, v in start.items() if n not in varied.names}
    held = scene.parameter_values().items()
    parameters = {n: v for n, v in held if n not in varied.names}
    sampler: Samples = Sampler(values, varied.count, varied.seed)
    for shown in angles:
        sampler = FromAngles(sampler, shown)
    return sampler, parameters


def _check_attitude(scene: AnyScene, sampler: Sampler) -> None:
    """Refuse to vary one component of a quaternion or a matrix: what results is no attitude."""
    for parts in scene.attitudes:
        for names in sampler.values:
            if isinstance(names, str) and names in parts:
                quaternion = len(parts) == 4
                hint = f"{','.join(parts)}=attitude()" if quaternion else "take Euler angles"
                raise InputError(
                    "one component of an attitude cannot vary alone", got=names, hint=hint
                )


@contextmanager
def _client(cluster: str | None) -> Iterator[Any]:
    """Connect with a cluster, or start one on this machine; None where there is none."""
    if cluster is None:
        yield None
        return
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            "a cluster needs dask.distributed", hint="pip install 'eom-toolkit[cluster]'"
        ) from None
    make: Callable[..., Any] = Client
    try:
        client = make() if cluster == LOCAL else make(cluster, timeout=10)
    except (OSError, ValueError) as error:
        raise InputError(
            "no cluster",
            where="--cluster",
            got=f"{cluster}: {error}",
            expected="local, or tcp://HOST:PORT",
        ) from None
    with client:
        try:
            yield client
        except KeyboardInterrupt:
            _end_workers()
            raise


def _end_workers() -> None:
    """End the processes of a cluster on this machine: one that is at work in C would not listen."""
    for process in multiprocessing.active_children():
        process.kill()


def _columns(summary: Summary, shares: Sequence[float]) -> dict[str, Any]:
    """Return arrays (K,) by the heading of their column."""
    found = {"mean": summary.mean, "deviation": summary.deviation, "least": summary.minimum}
    found |= {f"{share:g}": summary.quantile(share) for share in shares}
    return {**found, "greatest": summary.maximum}


def _print(found: Ensemble, shares: Sequence[float]) -> None:
    """Print how the trajectories ended, and a table of what was counted."""
    from rich.console import Console
    from rich.table import Table

    ends = ", ".join(f"{count:,} {reason}" for reason, count in found.counts.items())
    about = Table(box=None, show_header=False, pad_edge=False)
    about.add_row("trajectories", f"{found.count:,}: {ends}")
    about.add_row("method", found.method)
    about.add_row("steps", f"{found.steps:,}")
    about.add_row("time", f"{found.seconds:.3g} s")
    for name, drift in found.drift.items():
        about.add_row(f"drift of {name}", f"at most {drift.maximum[0]:.2e} relative")
    if found.store:
        about.add_row("trajectories in", printable(found.store))
    headings = ["mean", "deviation", "least", *(f"{s:g}" for s in shares), "greatest"]
    table = Table(box=None, pad_edge=False)
    table.add_column("")
    for heading in ("t", "trajectories", *headings):
        table.add_column(heading, justify="right")
    for name, summary in found.statistics.items():
        columns = _columns(summary, shares).values()
        for k, t in enumerate(found.t):
            numbers = (f"{column[k]:.6g}" for column in columns)
            table.add_row(name, f"{t:.6g}", f"{summary.count[k]:,}", *numbers)
    console = Console(width=max(WIDTH, Console().width), soft_wrap=True)
    console.print(about)
    if found.statistics:
        console.print()
        console.print(table)


def _data(found: Ensemble, plan: _Plan, shares: Sequence[float]) -> dict[str, Any]:
    """Return everything as what JSON has; numbers that are not finite are null."""

    def listed(array: Any) -> list[float | None]:
        return [v if math.isfinite(v) else None for v in map(float, array)]

    def summarised(summary: Summary) -> dict[str, Any]:
        columns = {k: listed(v) for k, v in _columns(summary, shares).items()}
        return {"count": summary.count.tolist(), **columns}

    return {
        "count": found.count,
        "seed": plan.seed,
        "vary": dict(plan.vary),
        "ends": dict(found.counts),
        "stopped": found.stopped.T.tolist(),
        "method": found.method,
        "steps": found.steps,
        "t": found.t.tolist(),
        "statistics": {n: summarised(s) for n, s in found.statistics.items()},
        "drift": {n: listed(d.maximum)[0] for n, d in found.drift.items()},
        "store": None if found.store is None else printable(found.store),
    }
