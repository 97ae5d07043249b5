"""The pictures that can be asked for by name: what each shows, what it needs, and how it is made."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from eom.errors import InputError, unknown_name
from eom.views.animation.bodies import bodies_of
from eom.views.body.cones import cones
from eom.views.body.frame_sketches import frame_sketch, sequence_of, wheel_of
from eom.views.body.free import free_body, not_free
from eom.views.body.poinsot import herpolhode
from eom.views.body.polhodes import ellipsoids, polhodes
from eom.views.body.rotating import sphere, turning
from eom.views.draw.formulas import plain
from eom.views.draw.picture import Panel, Picture
from eom.views.draw.printed import size_of
from eom.views.time.histories import histories_of
from eom.views.tree.joint_trees import joint_tree
from eom.views.tree.sketches import sketch, tree_frames

if TYPE_CHECKING:
    from eom.opening import AnyScene


@dataclass(frozen=True)
class Ask:
    """What is drawn: a scene, for how long and at how many times.

    Parameters
    ----------
    scene : Scene or TreeScene
        Of any model.
    seconds : float, optional
        End of the times: ``seconds`` (s), as the picture needs it or as the scene has it where it
        is None.
    points : int, optional
        Number of the times, in the same way; pictures of one instant leave both aside.
    """

    scene: AnyScene
    seconds: float | None = None
    points: int | None = None
    progress: Callable[[float], None] = field(default=lambda _: None, compare=False)
    """Called with how much is done, from 0 to 1."""


@dataclass(frozen=True)
class Entry:
    """A picture: its words, what it needs, why a scene cannot have it (empty if it can), its function."""

    words: str
    needs: str
    refused: Callable[[AnyScene], str]
    make: Callable[[Ask], Picture]


def _work_precision(ask: Ask) -> Picture:
    """Measure the scene by every method at few tolerances; `eom bench` measures with care."""
    from codegen.measure.workprecision.case import Case
    from codegen.measure.workprecision.measuring import QUICK, measure
    from codegen.measure.workprecision.programs import programs
    from eom.views.time.work_precision import work_precision

    scene = ask.scene
    numbers = (scene.initial_values(), scene.parameter_values(), scene.input_values())
    end = ask.seconds or scene.integration.t_end
    case = Case(scene.name, scene.title or scene.name, scene.derive(), *numbers, end)
    return work_precision(measure(case, programs([]), QUICK, ask.progress))


def _cones(ask: Ask) -> Picture:
    return cones(turning(ask.scene, ask.seconds, ask.points), ask.seconds)


def _joints(ask: Ask) -> Picture:
    assert ask.scene.model == "tree"
    return joint_tree(ask.scene.tree, ask.scene.title)


def _frames(ask: Ask) -> Picture:
    scene = ask.scene
    return tree_frames(scene) if scene.model == "tree" else frame_sketch(sequence_of(scene))


def _nothing(_: AnyScene) -> str:
    return ""


def _no_tree(scene: AnyScene) -> str:
    return "" if scene.model == "tree" else "it is one body, without joints"


def _no_spinner(scene: AnyScene) -> str:
    return "" if scene.model == "spinner" else 'it is not of the model "spinner"'


def _no_angles(scene: AnyScene) -> str:
    return "" if scene.model == "tree" or sequence_of(scene) else "its attitude has no angles"


def _no_single_body(scene: AnyScene) -> str:
    return "a tree has many bodies, and this is about one" if scene.model == "tree" else ""


def _no_cones(scene: AnyScene) -> str:
    if bodies_of(scene).orbit:
        return "its attitude is measured in a frame that turns with an orbit"
    return _no_single_body(scene)


FREE, ONE, ANY = "a torque-free body", "one body", "any scene"
PICTURES = {
    "polhodes": Entry(
        "ellipsoids of momentum and energy with polhodes by class and the separatrix",
        FREE,
        not_free,
        lambda ask: polhodes(free_body(ask.scene, "polhode")),
    ),
    "ellipsoids": Entry(
        "both ellipsoids, and the polhode where they meet",
        FREE,
        not_free,
        lambda ask: ellipsoids(free_body(ask.scene, "ellipsoid")),
    ),
    "herpolhode": Entry(
        "Poinsot's construction, and the herpolhode in its plane",
        FREE,
        not_free,
        lambda ask: herpolhode(free_body(ask.scene, "herpolhode"), ask.seconds, ask.points),
    ),
    "cones": Entry(
        "body cone and space cone, which the axis of rotation traces", ONE, _no_cones, _cones
    ),
    "sphere": Entry(
        "attitude: paths of the body axes on the unit sphere",
        ONE,
        _no_single_body,
        lambda ask: sphere(turning(ask.scene, ask.seconds, ask.points)),
    ),
    "histories": Entry(
        "states and outputs over time, the drift of the invariants below",
        ANY,
        _nothing,
        lambda ask: histories_of(ask.scene, ask.seconds, ask.points),
    ),
    "work-precision": Entry(
        "run time over error of every method, measured now (eom bench: with more care)",
        ANY,
        _nothing,
        _work_precision,
    ),
    "sketch": Entry(
        "the body or the bodies at the start, with the forces and torques on them",
        ANY,
        _nothing,
        lambda ask: sketch(ask.scene),
    ),
    "joints": Entry(
        "diagram of bodies, joints and constraints",
        "a tree",
        _no_tree,
        _joints,
    ),
    "frames": Entry(
        "frames of the rotation sequence, each turn as an arc; frames of a tree's bodies",
        "attitude by angles, or a tree",
        _no_angles,
        _frames,
    ),
    "wheel": Entry(
        "the wheel of the 3-1-2 spinning symmetric body, with its angles",
        "the model spinner",
        _no_spinner,
        lambda ask: wheel_of(ask.scene, ask.seconds),
    ),
}
"""Pictures by name: what each shows, what it needs (``words``, ``needs``), and what makes it."""
FIRST = ("polhodes", "sphere", "sketch")
"""What is drawn of a scene where nothing is asked for: the first that it can have.

Any scene can have the last.
"""


def default(scene: AnyScene) -> str:
    """Return the name of the picture that suits a scene best."""
    return next(name for name in FIRST if not PICTURES[name].refused(scene))


def available(scene: AnyScene) -> tuple[str, ...]:
    """Return the names of all pictures that ``scene`` can have, in the order of `PICTURES`.

    Parameters
    ----------
    scene : Scene or TreeScene
        Of any model.

    Returns
    -------
    tuple of str
        Keys of `PICTURES`, in their order.

    Examples
    --------
    >>> import eom
    >>> available(eom.load_scene("rolling-disc"))
    ('histories', 'work-precision', 'sketch', 'joints', 'frames')
    """
    return tuple(name for name, entry in PICTURES.items() if not entry.refused(scene))


def picture(name: str, ask: Ask) -> Picture:
    """Return the picture ``name``, a key of `PICTURES`, of what ``ask`` names.

    Parameters
    ----------
    name : str
        A key of `PICTURES`.
    ask : Ask
        The scene, and for how long and at how many times.

    Returns
    -------
    Picture
        As the function of the picture returns it.

    Raises
    ------
    InputError
        For other names, for a picture that the scene cannot have, and as the function of the
        picture does (`eom.views.body.polhodes.polhodes` and its like).

    Examples
    --------
    >>> import eom
    >>> made = picture("polhodes", Ask(eom.load_scene("t-handle")))
    >>> [panel.title for panel in made.rows[0]]
    ['same momentum $H$', 'same energy $T$']
    """
    if name not in PICTURES:
        raise unknown_name("picture", name, PICTURES, "--what")
    entry = PICTURES[name]
    if reason := entry.refused(ask.scene):
        raise InputError(
            f"no picture {name!r} of this scene: {reason}",
            where=ask.scene.title or ask.scene.name,
            expected=entry.needs,
            hint=f"it can have {', '.join(available(ask.scene)) or 'none'}",
        )
    return entry.make(ask)


def pictures(names: Sequence[str], ask: Ask) -> Picture:
    """Return one picture or several below each other, under the title of the scene.

    Parameters
    ----------
    names : sequence of str
        Keys of `PICTURES`, one at least.
    ask : Ask
        As of `picture`.

    Returns
    -------
    Picture
        Their panels below each other, under the title of the scene.

    Raises
    ------
    InputError
        As of `picture`.

    Examples
    --------
    >>> import eom
    >>> len(pictures(["sphere", "sketch"], Ask(eom.load_scene("t-handle"))).rows)
    2
    """
    made = [picture(name, ask) for name in names]
    if len(made) == 1:
        return made[0]
    rows: list[tuple[Panel, ...]] = []
    for one in made:
        own = one.title if one.title != made[0].title else ""
        first, *rest = one.rows
        titled = tuple(replace(p, title=p.title or own) for p in first)
        rows += [titled, *rest]
    captions = " ".join(one.caption for one in made if one.caption)
    title = made[0].title or plain(ask.scene.title)
    notices = "; ".join(one.notice for one in made if one.notice)
    return Picture(tuple(rows), title, captions, _size(made), notices)


def _size(made: Sequence[Picture]) -> tuple[float, float] | None:
    """Return the size of pictures below each other, if one of them needs a size of its own."""
    sizes = [size_of(one) for one in made]
    if all(one.size is None for one in made):
        return None
    return max(width for width, _ in sizes), sum(height for _, height in sizes)
