"""An animation as a moving picture for slides: GIF, APNG or WebP.

The same animation gives the same bytes with the same versions of Matplotlib and Pillow.
"""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from eom.errors import InputError
from eom.views.animation.animation import Animation
from eom.views.animation.filming import Film, Filming, frames

if TYPE_CHECKING:
    from PIL.Image import Image

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
