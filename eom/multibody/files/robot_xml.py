"""What a URDF file may hold, asked before any parser of robots sees it: XML without entities, known tags.

Nothing is opened but the file: meshes and ``package://`` names stay text.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from xml.parsers import expat

from eom.errors import InputError
from eom.scenes.scene_files import text_of

MAX_DEPTH = 20
MAX_ELEMENTS = 100_000

NEEDED: Mapping[str, tuple[str, ...]] = {
    "robot": ("name",),
    "robot/link": ("name",),
    "robot/link/inertial/mass": ("value",),
    "robot/link/inertial/inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "robot/joint": ("name", "type"),
    "robot/joint/parent": ("link",),
    "robot/joint/child": ("link",),
    "robot/joint/mimic": ("joint",),
}
"""Attributes without which an element means nothing; its name stands in messages."""

USED = frozenset(
    {
        *NEEDED, "robot/link/inertial", "robot/link/inertial/origin", "robot/joint/origin",
        "robot/joint/axis", "robot/joint/dynamics",
    }
)  # fmt: skip
"""Elements that say something of the motion. Others are left out, and told."""


class _Reader:
    """Walks the elements: where it is, the link or joint it is in, what is left out."""

    def __init__(self, parser: expat.XMLParserType) -> None:
        self.parser = parser
        self.path: list[str] = []
        self.part = ""
        self.elements = 0
        self.left_out: Counter[str] = Counter()
        self.children: list[set[str]] = []

    def where(self) -> str:
        return f"{self.part or '/'.join(self.path)}, line {self.parser.CurrentLineNumber}"

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.path.append(tag)
        self.elements += 1
        if self.elements > MAX_ELEMENTS or len(self.path) > MAX_DEPTH:
            expected = f"at most {MAX_ELEMENTS} elements, {MAX_DEPTH} deep"
            raise InputError("too many elements", where=self.where(), expected=expected)
        if len(self.path) == 1 and tag != "robot":
            raise InputError("not a URDF file", where="first element", got=tag, expected="robot")
        if len(self.path) == 2:
            self.part = f"{tag} {attributes.get('name', '')!r}"
        place = "/".join(self.path)
        if place in USED:
            self._check(place, attributes)
        elif "/".join(self.path[:-1]) in USED:
            self.left_out[place.removeprefix("robot/")] += 1

    def _check(self, place: str, attributes: dict[str, str]) -> None:
        for name in NEEDED.get(place, ()):
            if name not in attributes:
                raise InputError(
                    f"missing attribute {name!r}", where=self.where(), got=f"<{self.path[-1]}>"
                )

    def end(self, tag: str) -> None:  # noqa: ARG002
        self.path.pop()

    def doctype(self, *_: object) -> None:
        raise InputError(
            "a URDF file declares no document type",
            where=f"line {self.parser.CurrentLineNumber}",
            got="<!DOCTYPE",
            hint="remove it; entities are not read",
        )

    def declaration(self, _: str, encoding: str | None, __: int) -> None:
        if (encoding or "utf-8").lower() not in {"utf-8", "us-ascii", "ascii"}:
            raise InputError("unusable encoding", got=encoding, expected="UTF-8")


def checked(file: Path) -> tuple[bytes, tuple[str, ...]]:
    """Return the bytes of a URDF file, and what in it says nothing of the motion.

    Raises `InputError` for what is no XML, has a document type, is nested or large beyond reason, or lacks
    an attribute of `NEEDED`.
    """
    data = text_of(file, "*.urdf").encode()
    parser = expat.ParserCreate("utf-8", " ")
    reader = _Reader(parser)
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.StartDoctypeDeclHandler = reader.doctype
    parser.XmlDeclHandler = reader.declaration
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise InputError("not valid XML", got=str(error)) from None
    told = tuple(f"<{place}>, {n} of them" for place, n in sorted(reader.left_out.items()))
    return data, told
