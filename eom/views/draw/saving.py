"""Save a picture to a file: what kind it is, the ending says; it appears whole or not at all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from codegen.runs.export import whole
from eom.errors import InputError
from eom.views.draw import printed, turned
from eom.views.draw.picture import Picture, check
from eom.views.draw.printed import installed, require

Size = tuple[float, float]
DPI = 150.0
MOST_INCHES, MOST_DPI = 100.0, 1200.0


@dataclass(frozen=True)
class Kind:
    """A kind of file: what it is, whether Matplotlib draws it, and what writes it."""

    meaning: str
    printed: bool
    write: Callable[[Picture, Path, Size | None, float], None]


def _print(kind: str) -> Callable[[Picture, Path, Size | None, float], None]:
    return lambda picture, file, size, dpi: printed.write(picture, file, kind, size, dpi)


def _page(picture: Picture, file: Path, size: Size | None, dpi: float) -> None:  # noqa: ARG001
    file.write_text(turned.page(picture, size), encoding="utf-8", newline="\n")


KINDS = {
    ".png": Kind("pixels", True, _print("png")),
    ".svg": Kind("lines, for pages", True, _print("svg")),
    ".pdf": Kind("lines, for print", True, _print("pdf")),
    ".html": Kind("a page on which it is turned by hand", False, _page),
}
"""Kinds of file by their ending."""


def kind_of(path: str | Path) -> Kind:
    """Return the kind of file that a name's ending says.

    Raises `InputError` for other endings, and where Matplotlib is needed and not installed.
    """
    file = Path(path)
    kind = KINDS.get(file.suffix.lower())
    if kind is None:
        *most, last = KINDS
        raise InputError(
            "unknown kind of picture",
            where=str(file),
            got=file.suffix or "no ending",
            expected=f"a name that ends in {', '.join(most)} or {last}",
        )
    if kind.printed:
        require(str(file))
    return kind


def can_write(path: str | Path) -> bool:
    """Return whether a picture's ending is known, and what it needs is installed."""
    kind = KINDS.get(Path(path).suffix.lower())
    return kind is not None and (installed() or not kind.printed)


def save(picture: Picture, path: str | Path, size: Size | None = None, dpi: float = DPI) -> Path:
    """Write a picture to ``path`` (.png, .svg, .pdf by Matplotlib, .html for a browser); return the path.

    Parameters
    ----------
    picture : Picture
        What is drawn.
    path : str or path
        Ends with .png, .svg, .pdf (by Matplotlib) or .html (for a browser). Folders are made.
    size : Size, optional
        Width and height in inches, by default as the panels need.
    dpi : float, default 150.0
        Pixels an inch (PNG).

    Returns
    -------
    path
        The path. The same picture gives the same bytes.

    Raises
    ------
    InputError
        For other endings, a missing Matplotlib, a size that no paper has, a picture that cannot be
        drawn, and where the file cannot be written; then nothing is.

    Examples
    --------
    >>> import tempfile
    >>> from eom.views.body.frame_sketches import frame_sketch
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = save(frame_sketch("3-1-2"), f"{folder}/frames.svg")
    ...     path.name, "<svg" in path.read_text(encoding="utf-8")
    ('frames.svg', True)
    """
    file = Path(path)
    kind = kind_of(file)
    check(picture)
    _check_size(size, dpi)
    return whole(file, lambda part: kind.write(picture, part, size, dpi))


def _check_size(size: Size | None, dpi: float) -> None:
    if size is not None and not all(0.5 <= s <= MOST_INCHES for s in size):
        raise InputError(
            "a picture of this size cannot be drawn",
            got=f"{size[0]:g} x {size[1]:g} inches",
            expected=f"0.5 to {MOST_INCHES:g} inches each way",
        )
    if not 10 <= dpi <= MOST_DPI:
        raise InputError(
            "too few or too many pixels an inch", got=f"{dpi:g}", expected=f"10 to {MOST_DPI:g}"
        )
