"""The pictures of an animation one by one, drawn by Matplotlib without a browser.

The painter's algorithm: triangles of all bodies are drawn from the farthest to the nearest, lit from above.

An animation as a moving picture for slides: GIF, APNG or WebP.

The same animation gives the same bytes with the same versions of Matplotlib and Pillow.
"""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eom.errors import InputError
from eom.views.animation.acting import FEW, STYLES, is_seen
from eom.views.animation.animation import Animation, Arrows, at, level, scales_of
from eom.views.animation.animation_page import PALETTE
from eom.views.animation.tracks import matrices, turned
from eom.views.draw import placing as labels
from eom.views.draw.depth import View, rgba
from eom.views.draw.picture import COLOURS
from eom.views.draw.printed import typeset

if TYPE_CHECKING:
    from PIL.Image import Image

Floats = NDArray[np.float64]

LONGEST_FILM = 8.0
"""Seconds that are shown unless more are asked for."""
FIELD = math.radians(32)
"""The camera's field of view, from top to bottom."""
TITLE = 44
"""Letters of a title in half a height of the picture."""
PALE = 0.62
GROUND, SQUARES = 1.6, 12
"""How far the ground goes from its middle, by the radius of what is seen, and its squares to a side."""


@dataclass(frozen=True)
class Film:
    """How an animation is filmed: size in pixels, pictures a second, seconds shown (at most all)."""

    width: int = 640
    height: int = 480
    fps: int = 15
    dark: bool = False
    length: float | None = None


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole in front of the motion, as the page's at its start."""

    place: Floats
    axes: Floats
    """Rows: to the right, up, towards the camera."""

    @classmethod
    def of(cls, animation: Animation, aspect: float, moved: Floats | None = None) -> Camera:
        """Return the camera that sees all of the motion; ``moved``: by how far it is from its start (m)."""
        view = animation.view
        up = np.array(view.up)
        across, along = level(up)
        azimuth, elevation = (math.radians(a) for a in view.camera)
        flat = math.cos(azimuth) * across + math.sin(azimuth) * along
        towards = math.cos(elevation) * flat + math.sin(elevation) * up
        distance = 1.14 * view.radius / math.sin(FIELD / 2) / min(1.0, aspect)
        right = np.cross(up, towards)
        right /= np.linalg.norm(right)
        axes = np.stack([right, np.cross(towards, right), towards])
        here = np.asarray(view.centre) + (0 if moved is None else moved)
        return cls(here + distance * towards, axes)

    @cached_property
    def view(self) -> View:
        """What is seen: half the height of the picture is 1."""
        return View.pinhole(self.place, self.axes, FIELD)


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles of one body in its axes, with a colour each, and whether their backs are hidden."""

    corners: Floats
    colours: Floats
    hidden: NDArray[np.bool_]


class Filming:
    """One animation, one film: what does not change from picture to picture."""

    def __init__(self, animation: Animation, film: Film) -> None:
        self.animation, self.film = animation, film
        self.scales = scales_of(animation)
        self.ways: dict[str, labels.Way] = {}
        """Where labels are in the picture before."""

    @cached_property
    def largest(self) -> dict[str, float]:
        """The greatest length of each kind of vector, in its unit."""
        found: dict[str, float] = {}
        for arrow in self.animation.arrows:
            size = float(np.linalg.norm(arrow.values, axis=1).max())
            found[arrow.kind] = max(size, found.get(arrow.kind, 0.0))
        return found

    def draws(self, arrow: Arrows) -> bool:
        """Return whether a vector is drawn: of several bodies what acts on them, reactions if few."""
        own = sum(a.kind == arrow.kind for a in self.animation.arrows)
        seen = arrow.kind not in FEW or is_seen(arrow.kind, own)
        return seen if arrow.words else len(self.animation.tracks.bodies) == 1

    def moved(self, place: float) -> Floats:
        """Return how far the body that the camera follows is from its start (m), (3,)."""
        body = self.animation.view.follow
        if body < 0:
            return np.zeros(3)
        way = self.animation.tracks.bodies[body].positions
        return np.asarray(_between(way, place) - way[0])

    def camera(self, place: float) -> Camera:
        """Return the camera at a place among the samples."""
        return Camera.of(self.animation, self.film.width / self.film.height, self.moved(place))

    @cached_property
    def count(self) -> int:
        """How many pictures there are."""
        times = self.animation.times
        whole = float(times[-1] - times[0]) / self.animation.speed
        shown = min(whole, self.film.length or LONGEST_FILM)
        return max(2, round(shown * self.film.fps) + 1)

    @cached_property
    def bodies(self) -> tuple[Triangles, ...]:
        """The triangles of all bodies."""
        figures = self.animation.figures.bodies
        return tuple(_triangles(f.shapes, PALETTE[k % len(PALETTE)]) for k, f in enumerate(figures))

    @cached_property
    def stand(self) -> Triangles:
        """The triangles of what does not move."""
        return _triangles(self.animation.figures.ground, "grey")

    @cached_property
    def tips(self) -> tuple[Floats, ...]:
        """The paths of the bodies' tips."""
        pairs = zip(self.animation.tracks.bodies, self.animation.figures.bodies, strict=True)
        return tuple(at(track, figure.tip) for track, figure in pairs)

    def moment(self, number: int) -> float:
        """Return the place of a picture among the samples."""
        times = self.animation.times
        shown = number / self.film.fps * self.animation.speed
        return min(shown / float(times[1] - times[0]), len(times) - 1.0)


def _triangles(shapes: Sequence[Any], colour: str) -> Triangles:
    corners, colours = [np.zeros((0, 3, 3))], [np.zeros((0, 4))]
    hidden = [np.zeros(0, dtype=np.bool_)]
    for shape in shapes:
        mesh = shape.mesh
        base = np.array(rgba(shape.colour or colour, opacity=shape.opacity))
        tones = np.tile(base, (len(mesh.faces), 1))
        if mesh.round:
            tones[mesh.octants, :3] += PALE * (1 - tones[mesh.octants, :3])
        corners.append(mesh.vertices[mesh.faces])
        colours.append(tones)
        hidden.append(np.full(len(mesh.faces), mesh.closed and shape.opacity == 1))
    return Triangles(np.concatenate(corners), np.concatenate(colours), np.concatenate(hidden))


def interpolated(quaternions: Floats, place: float) -> Floats:
    """Return the quaternion at a place between two samples, on the great circle."""
    k = min(int(place), len(quaternions) - 1)
    a, b = quaternions[k], quaternions[min(k + 1, len(quaternions) - 1)]
    part, angle = place - k, math.acos(min(1.0, float(a @ b)))
    if math.sin(angle) < 1e-5:
        return np.asarray(a + part * (b - a))
    p, q = math.sin((1 - part) * angle), math.sin(part * angle)
    return np.asarray((p * a + q * b) / math.sin(angle))


def _between(values: Floats, place: float) -> Floats:
    k = min(int(place), len(values) - 1)
    following = values[min(k + 1, len(values) - 1)]
    return np.asarray(values[k] + (place - k) * (following - values[k]))


# -- one picture -----------------------------------------------------------------------------------


def frames(filming: Filming) -> Iterator[Image]:
    """Yield the pictures."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from PIL import Image

    film = filming.film
    figure = Figure(figsize=(film.width / 100, film.height / 100), dpi=100)
    canvas = FigureCanvasAgg(figure)
    for number in range(filming.count):
        figure.clear()
        draw(filming, filming.moment(number), figure)
        canvas.draw()  # type: ignore[no-untyped-call]
        pixels = canvas.buffer_rgba()  # type: ignore[no-untyped-call]
        yield Image.fromarray(np.asarray(pixels)[..., :3].copy())


def draw(filming: Filming, place: float, figure: Any) -> None:
    """Draw one moment: ground, paths, bodies, vectors, the time."""
    from matplotlib.collections import PolyCollection

    film = filming.film
    back, ink = ("#15171b", "#ececec") if film.dark else ("#ffffff", "#1c1c1c")
    figure.set_facecolor(back)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    aspect = film.width / film.height
    axes.set_xlim(-aspect, aspect)
    axes.set_ylim(-1, 1)
    axes.set_axis_off()
    camera = filming.camera(place)
    _ground(filming, place, camera, axes)
    _paths(filming, place, camera, axes)
    corners, colours = _scene(filming, place, camera)
    view = camera.view
    flat, order = view.flat(corners), np.argsort(-view.depth(corners).mean(axis=1), kind="stable")
    shaded = _lit(corners, colours, filming, camera)[order]
    edges = shaded * np.where(shaded[:, 3:] == 1, 1.0, (1.0, 1.0, 1.0, 0.0))
    axes.add_collection(
        PolyCollection(
            list(flat[order]), facecolors=shaded, edgecolors=edges, linewidths=0.4, zorder=3
        )
    )
    _links(filming, place, camera, axes)
    _vectors(filming, place, camera, axes, back)
    times, title = filming.animation.times, filming.animation.title
    time = float(times[0]) + place * float(times[1] - times[0])
    label = {"color": ink, "va": "top", "zorder": 9, "parse_math": False}
    lines = textwrap.wrap(title, max(10, int(TITLE * aspect)))
    axes.text(-aspect + 0.04, 0.96, "\n".join(lines), fontsize=11, weight="bold", **label)
    axes.text(
        -aspect + 0.04,
        0.96 - 0.09 * len(lines),
        f"t = {time:.{_places(filming)}f} s",
        fontsize=10,
        **label,
    )
    _legend(filming, axes, aspect)
    labels.place(figure, covering=True, before=filming.ways)


def _legend(filming: Filming, axes: Any, aspect: float) -> None:
    """Write what the arrows are, with the length of the longest of each kind, at the lower left."""
    drawn = {a.kind for a in filming.animation.arrows if filming.draws(a)}
    kinds = [kind for kind in STYLES if kind in drawn and filming.largest[kind] > 0]
    for k, kind in enumerate(reversed(kinds)):
        style = STYLES[kind]
        words = f"{style.words}, at most {float(f'{filming.largest[kind]:.3g}'):g} {style.unit}"
        look = {"color": COLOURS[style.colour], "fontsize": 8.5, "va": "center", "zorder": 9}
        axes.text(-aspect + 0.04, -0.95 + 0.08 * k, typeset(words), **look)


def _places(filming: Filming) -> int:
    span = float(filming.animation.times[-1] - filming.animation.times[0])
    return max(0, min(6, 2 - math.floor(math.log10(span))))


def _scene(filming: Filming, place: float, camera: Camera) -> tuple[Floats, Floats]:
    """Return the triangles that are not turned away, where they are, and their colours."""
    groups = [filming.stand, *filming.bodies]
    corners = [filming.stand.corners]
    for track, body in zip(filming.animation.tracks.bodies, filming.bodies, strict=True):
        C = matrices(interpolated(track.quaternions, place))
        corners.append(body.corners @ C + _between(track.positions, place))
    points = np.concatenate(corners)
    normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    away = np.einsum("ni,ni->n", normals, camera.place - points[:, 0]) <= 0
    seen = ~(away & np.concatenate([g.hidden for g in groups]))
    return points[seen], np.concatenate([g.colours for g in groups])[seen]


def _lit(corners: Floats, colours: Floats, filming: Filming, camera: Camera) -> Floats:
    """Return colours by how a lamp above the camera's left shines on the triangles."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    towards = np.einsum("ni,ni->n", normals, camera.place - corners.mean(axis=1))
    normals *= np.where(towards < 0, -1.0, 1.0)[:, None]
    right, _, back = camera.axes
    lamp = -0.5 * right + 0.7 * np.array(filming.animation.view.up) + 0.55 * back
    lamp /= np.linalg.norm(lamp)
    shade = 0.55 + 0.45 * np.clip(normals @ lamp, 0, 1)
    return np.concatenate([np.clip(colours[:, :3] * shade[:, None], 0, 1), colours[:, 3:]], axis=1)


def foot_of(filming: Filming, place: float) -> Floats:
    """Return the middle of the squares of the ground (m), whole ones from that at the start, (3,)."""
    view, moved = filming.animation.view, filming.moved(place)
    up, cell = np.array(view.up), 2 * GROUND * view.radius / SQUARES
    foot = view.centre + ((view.ground or 0.0) - view.centre @ up) * up
    steps = [cell * round(float(moved @ way) / cell) * way for way in level(up)]
    return np.asarray(foot + steps[0] + steps[1])


def _ground(filming: Filming, place: float, camera: Camera, axes: Any) -> None:
    """Draw the squares of the ground below what is seen; they stay where they are."""
    from matplotlib.collections import LineCollection

    view = filming.animation.view
    if view.ground is None:
        return
    first, second = level(np.array(view.up))
    reach = np.linspace(-GROUND, GROUND, SQUARES + 1) * view.radius
    foot = foot_of(filming, place)
    lines = [[foot + a * u + b * reach[0] * v, foot + a * u - b * reach[0] * v]
             for a in reach for u, v, b in ((first, second, 1), (second, first, 1))]  # fmt: skip
    ends = np.array(lines)
    seen = camera.view.flat(ends)[np.all(camera.view.depth(ends) > 0, axis=1)]
    grey = "#343941" if filming.film.dark else "#d4d4ce"
    axes.add_collection(LineCollection(list(seen), colors=grey, linewidths=0.7, zorder=1))


def _paths(filming: Filming, place: float, camera: Camera, axes: Any) -> None:
    many = len(filming.tips) > 1
    for k, path in enumerate(filming.tips):
        done = np.concatenate([path[: int(place) + 1], _between(path, place)[None]])
        ahead = camera.view.depth(done) > 0.1 * filming.animation.view.radius
        flat = np.where(ahead[:, None], camera.view.flat(done), np.nan)
        colour = COLOURS[PALETTE[k % len(PALETTE)] if many else "orange"]
        axes.plot(flat[:, 0], flat[:, 1], color=colour, linewidth=1.2, alpha=0.7, zorder=2)


def _links(filming: Filming, place: float, camera: Camera, axes: Any) -> None:
    """Draw springs and rods without mass."""
    tracks = filming.animation.tracks.bodies
    for link in filming.animation.figures.links:
        ends = []
        for body, point in zip(link.bodies, link.points, strict=True):
            if body < 0:
                ends.append(point)
                continue
            q = interpolated(tracks[body].quaternions, place)
            ends.append(_between(tracks[body].positions, place) + turned(q[None], point[None])[0])
        flat = camera.view.flat(np.array(ends))
        axes.plot(flat[:, 0], flat[:, 1], color=COLOURS["grey"], linewidth=2, zorder=4)


def _vectors(filming: Filming, place: float, camera: Camera, axes: Any, back: str) -> None:
    """Draw omega, H and torque of a single body, and its axes; of many what acts on them."""
    from matplotlib import patheffects

    animation = filming.animation
    for origin, vector, text, colour in _shown_vectors(filming, place):
        if float(np.linalg.norm(vector)) < 0.02 * animation.view.radius:
            continue
        start, end, words = camera.view.flat(
            np.stack([origin, origin + vector, origin + 1.08 * vector])
        )
        ink = COLOURS[colour]
        style = {"arrowstyle": "-|>,head_width=0.25,head_length=0.5", "color": ink,
                 "linewidth": 1.2 if colour == "grey" else 2.4, "shrinkA": 0, "shrinkB": 0}  # fmt: skip
        axes.annotate("", end, start, arrowprops=style, zorder=5)
        halo = [patheffects.withStroke(linewidth=3, foreground=back)]
        style = {"color": ink, "ha": "center", "va": "center", "weight": "bold", "zorder": 6,
                 "path_effects": halo, "annotation_clip": False}  # fmt: skip
        axes.annotate(typeset(text), tuple(words), (0, 0), textcoords="offset points", **style)


def _shown_vectors(filming: Filming, place: float) -> Iterator[tuple[Floats, Floats, str, str]]:
    """Yield vectors at a moment: where from, components (m as they are drawn), words, colour."""
    animation = filming.animation
    several = len(animation.tracks.bodies) > 1
    if not several:
        (track,), (figure,) = animation.tracks.bodies, animation.figures.bodies
        origin = _between(track.positions, place)
        q = interpolated(track.quaternions, place)
        for k in range(3):
            axis = turned(q[None], (1.1 * figure.extent * np.eye(3)[k])[None])[0]
            yield origin, axis, figure.axes[k], "grey"
    for arrow in animation.arrows:
        if arrow.unit in filming.scales and filming.draws(arrow):
            vector = filming.scales[arrow.unit] * _between(arrow.values, place)
            here = _between(arrow.places, place) if several or arrow.words else origin
            yield here, vector, arrow.text, arrow.colour


KINDS: dict[str, tuple[str, dict[str, Any]]] = {
    ".gif": ("GIF", {"disposal": 1, "optimize": False}),
    ".png": ("PNG", {}),
    ".apng": ("PNG", {}),
    ".webp": ("WEBP", {"quality": 80, "method": 4}),
}
"""Kinds of files: Pillow's name and settings."""
MOST_FRAMES = 1200
LEAST_FPS, MOST_FPS = 1, 50
"""Pictures a second; GIF knows hundredths of a second, and browsers slow down at fewer than two."""
MOST_BYTES = 20_000_000
TONES = 64
"""Colours of a GIF."""


def film_bytes(
    animation: Animation,
    suffix: str,
    film: Film,
    progress: Callable[[float], None] = lambda _: None,
) -> bytes:
    """Return an animated picture as a file of the kind that ``suffix`` (a key of `KINDS`) says.

    Raises `InputError` for other kinds, unusable numbers, Matplotlib or Pillow missing, and a film of more
    than `MOST_FRAMES` pictures or 20 MB.
    """
    filming = Filming(animation, checked(film))
    if suffix not in KINDS:
        raise InputError("unknown kind of file", got=suffix, expected=", ".join(KINDS))
    if filming.count > MOST_FRAMES:
        raise InputError(
            "too many pictures", got=filming.count, expected=f"at most {MOST_FRAMES}",
            hint="fewer --seconds, fewer --fps, or a greater --speed",
        )  # fmt: skip
    taken = []
    for number, picture in enumerate(_drawn(filming), 1):
        taken.append(_palette(picture) if suffix == ".gif" else picture)
        progress(number / filming.count)
    data = _saved(taken, suffix, film.fps)
    if len(data) > MOST_BYTES:
        raise InputError(
            "the film is too large", got=f"{len(data):,} bytes", expected=f"at most {MOST_BYTES:,}",
            hint="a smaller --size, fewer --seconds or --fps",
        )  # fmt: skip
    return data


def checked(film: Film) -> Film:
    """Return a film if it can be made."""
    if not LEAST_FPS <= film.fps <= MOST_FPS:
        expected = f"{LEAST_FPS} to {MOST_FPS} pictures a second"
        raise InputError("unusable rate of pictures", where="fps", got=film.fps, expected=expected)
    if not (80 <= film.width <= 1920 and 80 <= film.height <= 1200):
        got = f"{film.width} by {film.height}"
        raise InputError(
            "unusable size", where="size", got=got, expected="80 to 1920 by 80 to 1200"
        )
    if film.length is not None and not (math.isfinite(film.length) and film.length > 0):
        raise InputError("unusable length", where="length", got=film.length, expected="seconds")
    return film


def _drawn(filming: Filming) -> Iterator[Image]:
    try:
        yield from frames(filming)
    except ImportError as error:
        raise InputError(
            "animated pictures need Matplotlib and Pillow",
            got=str(error),
            hint="pip install 'eom-toolkit[plot]'",
        ) from None


def _palette(picture: Image) -> Image:
    from PIL import Image

    return picture.quantize(TONES, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)


def _saved(pictures: list[Image], suffix: str, fps: int) -> bytes:
    kind, settings = KINDS[suffix]
    target = io.BytesIO()
    first, *rest = pictures
    first.save(
        target, format=kind, save_all=True, append_images=rest, duration=round(1000 / fps), loop=0,
        **settings,
    )  # fmt: skip
    return target.getvalue()
