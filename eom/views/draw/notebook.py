"""A picture in a notebook: an image with the words for those who do not see it."""

from __future__ import annotations

import base64
import io
import tempfile
from pathlib import Path

from eom.views.draw import printed
from eom.views.draw.formulas import as_text
from eom.views.draw.picture import Picture

DPI = 96.0

Bundle = tuple[dict[str, str], dict[str, dict[str, str]]]


def bundle(picture: Picture) -> Bundle:
    """Return what IPython's display takes: data and metadata by kind.

    PNG, and as text the title with the caption, which is also the image's text for screen readers. Raises
    `InputError` for a picture that cannot be drawn.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.png"
        printed.write(picture, file, "png", None, DPI)
        image = base64.b64encode(_smaller(file)).decode("ascii")
    words = ". ".join(as_text(part) for part in (picture.title, picture.caption) if part)
    return {"image/png": image, "text/plain": words}, {"image/png": {"alt": words}}


def _smaller(file: Path) -> bytes:
    """Return an image with a palette: a third of the bytes, and the same to the eye."""
    from PIL import Image

    made = io.BytesIO()
    with Image.open(file) as image:
        image.convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
            made, "PNG", optimize=True
        )
    return made.getvalue()
