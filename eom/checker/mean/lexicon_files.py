r"""Lexica from TOML: files beside notes, front matter, and the presets.

Every bad entry is one error that says where, what was got and what is expected.

Patterns of a lexicon: LaTeX of one symbol with its labels, slots in angle brackets.

Front matter in YAML: the table ``eom`` or ``check`` of it is the lexicon of the note.

    ---
    title: Lecture 3
    eom:
      preset: arrow-tilde
      symbols:
        '\vec{a}': vector a
    ---

That block alone is parsed; anchors, aliases and tags are refused, and nothing in it is evaluated.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from eom.checker.mean.lexicon import (
    BRACKETS,
    QUATERNION_PRODUCTS,
    SLOT,
    SPATIAL_ORDERS,
    Entry,
    Lexicon,
    Notation,
    Scope,
    meaning,
)
from eom.checker.mean.moving import KEYS as MOVING
from eom.checker.mean.moving import checked
from eom.checker.read.grammar import read_formula
from eom.checker.read.symbol_shape import Labels, Look, Seen, grown, labels, named_in, seen
from eom.checker.read.syntax import Group, Missing, Node, Product, Relation, Scripts, children
from eom.errors import InputError, unknown_name
from eom.worlds.worlds import ASSUMPTIONS, closure

if TYPE_CHECKING:
    from eom.checker.mean.model import Model
    from eom.opening import AnyScene
    from eom.system import System

MAX_FRONT = 100_000
"""Characters of the block that is parsed."""
_WHERE = "front matter"
_KEY = re.compile(r"^(eom|check)[ ]*:", re.MULTILINE)
_NEXT = re.compile(r"^[^\s#]", re.MULTILINE)


def in_yaml(front: str) -> bool:
    """Return whether front matter has a YAML table for the checker."""
    return _KEY.search(front) is not None and "[check" not in front


def yaml_table(front: str) -> Mapping[str, Any]:
    """Return the table for the checker; a word alone names a preset. Raises `InputError`."""
    match = _KEY.search(front)
    if match is None:
        return {}
    end = _NEXT.search(front, match.end())
    block = front[match.start() : end.start() if end else len(front)]
    if len(block) > MAX_FRONT:
        raise InputError("too long", where=_WHERE, expected=f"at most {MAX_FRONT} characters")
    try:
        found = yaml.load(block, Loader=_Plain)[match[1]]  # noqa: S506 - a loader that is safer than safe
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise InputError("not YAML", where=_WHERE, got=_line(error), hint=_HINT) from error
    if isinstance(found, str):
        return {"preset": found}
    if not isinstance(found, Mapping):
        raise InputError("not a table", where=_WHERE, got=found, expected=f"{match[1]}: with keys")
    return found


_HINT = r"patterns stand in single quotes: '\vec{r}'"


def _line(error: Exception) -> str:
    mark = getattr(error, "problem_mark", None)
    problem = getattr(error, "problem", None) or type(error).__name__
    return f"{problem} (line {mark.line + 1} of the block)" if mark is not None else str(problem)


class _Plain(yaml.SafeLoader):
    """The safe loader without anchors and aliases, which can grow without bound."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()  # type: ignore[no-untyped-call]
        if getattr(event, "anchor", None) is not None:
            raise yaml.composer.ComposerError(
                None, None, "anchors and aliases are refused", event.start_mark
            )
        return super().compose_node(parent, index)


PRESETS = (
    "arrow-tilde",
    "left-superscript",
    "underline-bullet",
    "kane",
    "schaub-junkins",
    "hughes",
    "physics-bold",
)
"""Presets by name, each a file of `eom/checker/mean/presets`."""

MAX_LEXICON = 1_000_000
_TABLES = ("notation", "frames", "points", "marks", "symbols")
_SCOPE_KEYS = ("heading", "after", "frames", "points", "symbols", "system", "assume", "laws")
_YAML = re.compile(r"\A---[ ]*\n(.*?)^---[ ]*$", re.DOTALL | re.MULTILINE)
_FRONT = re.compile(r"\A\ufeff?\+\+\+[ \t]*\r?\n(.*?)^\+\+\+[ \t]*\r?$", re.DOTALL | re.MULTILINE)


@dataclass
class _Reader:
    """Collects the errors of one file."""

    name: str
    errors: list[InputError] = field(default_factory=list)

    def where(self, *keys: str) -> str:
        return ", ".join(p for p in (self.name, " > ".join(keys)) if p)

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Keep the error that what is within raises, and go on behind it."""
        try:
            yield
        except InputError as error:
            self.errors.append(error)

    def table(self, data: Mapping[str, Any], key: str, *above: str) -> Mapping[str, Any]:
        """Return a table of a table; what is none is an error."""
        value = data.get(key, {})
        if isinstance(value, Mapping):
            return value
        self.errors.append(
            InputError("not a table", where=self.where(*above, key), got=value, expected=f"[{key}]")
        )
        return {}

    def entries(self, data: Mapping[str, Any], notation: Notation, *above: str) -> list[Entry]:
        """Return the entries of a table of symbols."""
        found = []
        for latex, value in self.table(data, "symbols", *above).items():
            with self.kept():
                found.append(_entry(latex, value, notation, self.where(*above, "symbols", latex)))
        return found

    def names(self, data: Mapping[str, Any], key: str, *above: str) -> dict[Labels, str]:
        """Return a table of frames or points by their labels."""
        found = {}
        for latex, value in self.table(data, key, *above).items():
            where = self.where(*above, key, latex)
            with self.kept():
                if not (isinstance(value, str) and value.isalnum()):
                    raise InputError("not a name", where=where, got=value, expected="such as B")
                found[label_of(latex, where)] = value
        return found

    def notation(self, data: Mapping[str, Any], base: Notation) -> Notation:
        """Return the notation with what the file changes."""
        changed: dict[str, Any] = {}
        for key, value in self.table(data, "notation").items():
            with self.kept():
                changed[key] = _setting(key, value, self.where("notation", key))
        marks = dict(base.marks)
        for mark, frame in self.table(data, "marks").items():
            where = self.where("marks", mark)
            if frame == "":
                marks.pop(mark, None)
            elif isinstance(frame, str) and mark.isalpha():
                marks[mark] = frame
            else:
                self.errors.append(InputError("not a mark with a frame", where=where, got=frame))
        return replace(base, marks=marks, **changed)

    def scopes(
        self, data: Mapping[str, Any], notation: Notation, folder: Path | None
    ) -> list[Scope]:
        """Return the parts of the note that have entries of their own."""
        given = data.get("scope", [])
        if not isinstance(given, list) or not all(isinstance(g, Mapping) for g in given):
            self.errors.append(
                InputError("scopes are tables", where=self.where("scope"), expected="[[scope]]")
            )
            return []
        return [self.scope(g, notation, folder, f"scope {n}") for n, g in enumerate(given, 1)]

    def scope(
        self, data: Mapping[str, Any], notation: Notation, folder: Path | None, place: str
    ) -> Scope:
        self.unknown(data, _SCOPE_KEYS, place)
        texts = [data.get(k, "") for k in ("heading", "after")]
        if not all(isinstance(t, str) for t in texts) or not any(texts):
            self.errors.append(
                InputError(
                    "a scope has no place",
                    where=self.where(place),
                    got=texts,
                    expected="heading or after, a text",
                )
            )
            texts = ["", ""]
        system, spelt = self.system(data, notation, folder, place)
        return Scope(
            texts[0],
            texts[1],
            tuple(self.entries(data, notation, place)),
            self.names(data, "frames", place),
            self.names(data, "points", place),
            system,
            spelt,
            self.assumed(data, place),
            self.laws(data, place),
        )

    def assumed(self, data: Mapping[str, Any], *above: str) -> tuple[str, ...]:
        """Return names of assumptions that can stand together; none of what is no such list."""
        given, where = data.get("assume", []), self.where(*above, "assume")
        if not (isinstance(given, list) and all(isinstance(g, str) for g in given)):
            self.errors.append(InputError("not a list of assumptions", where=where, got=given))
            return ()
        unknown = [g for g in given if g not in ASSUMPTIONS]
        if unknown:
            self.errors.append(unknown_name("assumption", unknown[0], ASSUMPTIONS, where))
            return ()
        with self.kept():
            closure(given)
        return tuple(given)

    def laws(self, data: Mapping[str, Any], *above: str) -> tuple[str, ...]:
        """Return equations in LaTeX; none of what is no list of such."""
        given, where = data.get("laws", []), self.where(*above, "laws")
        found = []
        for law in given if isinstance(given, list) else [given]:
            with self.kept():
                if not isinstance(law, str) or not _is_equation(read_formula(law).tree):
                    raise InputError(
                        "not an equation", where=where, got=law, expected="such as a = b"
                    )
                found.append(law)
        return tuple(found)

    def moving(self, data: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return what the note declares to move; nothing of what is not in shape."""
        try:
            return checked(data, f"{self.name}, " if self.name else "")
        except InputError as error:
            self.errors.append(error)
            return {}

    def system(
        self, data: Mapping[str, Any], notation: Notation, folder: Path | None, *above: str
    ) -> tuple[Model | None, tuple[tuple[Entry, ...], ...]]:
        """Return the system that scalar lines are about, and its symbols: the note's own, the usual."""
        if "system" not in data:
            return None, ()
        from eom.checker.mean.described import model_in  # most notes need no scenes

        where = self.where(*above, "system")
        try:
            model = model_in(data["system"], folder, where)
            return _entries_of(model, data["system"], notation, where)
        except InputError as error:
            own = error.where.startswith(where)
            place = error.where if own else ", ".join(p for p in (where, error.where) if p)
            self.errors.append(error.at(place))
            return None, ()

    def unknown(self, data: Mapping[str, Any], known: Iterable[str], *above: str) -> None:
        """Note every key that is not known."""
        for key in data:
            if key not in known:
                self.errors.append(unknown_name("key", str(key), known, self.where(*above)))


_LINE = re.compile(
    r"""[ \t]*(?:(?P<many>\[\[)|\[)?[ \t]*
    (?P<key>'[^'\n]*'|"(?:[^"\\\n]|\\.)*"|[\w.-]+)[ \t]*(?P<end>\]|=|:)(?P<rest>.*)""",
    re.VERBOSE,
)


def lines_of(text: str) -> Mapping[tuple[str, ...], int]:
    """Return where the entries of a lexicon stand: keys, as errors name them, to lines from 1.

    The text is TOML, or a note with such front matter, or with YAML there.
    """
    found: dict[tuple[str, ...], int] = {}
    table: tuple[str, ...] = ()
    scopes = 0
    for number, line in enumerate(text.splitlines(), 1):
        match = _LINE.match(line)
        if match is None:
            continue
        key = match["key"]
        if match["end"] == "]":
            scopes += bool(match["many"])
            own = key.removeprefix("check.").removeprefix("eom.").split(".")
            table = (f"scope {scopes}", *own[1:]) if own[0] == "scope" else tuple(own)
            found.setdefault(table, number)
        elif key in _TABLES and match["end"] == ":":
            table = (key,)
        else:
            name = key[1:-1] if key[0] == "'" else json.loads(key) if key[0] == '"' else key
            found.setdefault((*table, name), number)
    return found


def lexicon_of(
    data: Mapping[str, Any], name: str = "", folder: Path | None = None
) -> tuple[Lexicon, tuple[InputError, ...]]:
    """Return the lexicon that a table holds, and one error for each entry that cannot be used.

    ``folder``: where the scene file of a note's system is looked for.
    """
    reader = _Reader(name)
    reader.unknown(data, _KEYS)
    base = Lexicon()
    if "preset" in data:
        if data["preset"] in PRESETS:
            base = preset(data["preset"])
        else:
            reader.errors.append(
                unknown_name("preset", str(data["preset"]), PRESETS, reader.where("preset"))
            )
    notation = reader.notation(data, base.notation)
    own = tuple(reader.entries(data, notation))
    system, spelt = reader.system(data, notation, folder)
    about = data.get("system")
    first = isinstance(about, Mapping) and about.get("first", False)
    lexicon = Lexicon(
        notation,
        {**base.frames, **reader.names(data, "frames")},
        {**base.points, **reader.names(data, "points")},
        (*spelt, own, *base.layers) if first else (own, *spelt, *base.layers),
        tuple(reader.scopes(data, notation, folder)),
        system,
        reader.assumed(data),
        reader.laws(data),
        moving_data=reader.moving(data),
    )
    return lexicon, tuple(reader.errors)


def _entries_of(
    model: Model, given: Any, notation: Notation, where: str
) -> tuple[Model, tuple[tuple[Entry, ...], ...]]:
    """Return a system with its letters, and its symbols: the note's own, then the usual ones."""
    from eom.checker.mean.described import symbols_in

    own, usual = symbols_in(given, model, where)
    if isinstance(given, Mapping) and not given.get("usual", True):
        usual = [row for row in usual if SLOT.search(row[0])]
    entries = tuple(_entry(latex, value, notation, place) for latex, value, place in own)
    known = {e.look for e in entries}
    spelt: list[Entry] = []
    for latex, value, place in usual:
        with suppress(InputError):  # a name that is printed with dots
            entry = _entry(latex, value, notation, place)
            spelt += [entry] if entry.look not in known else []
            known.add(entry.look)
    letters = {e.meaning.labels[0]: e.look.text for e in entries if e.meaning.labels}
    return replace(model, letters=letters), (entries, tuple(spelt))


def about(
    lexicon: Lexicon,
    system: str | System | AnyScene | Model,
    symbols: Mapping[str, str] | None = None,
    *,
    first: bool = False,
    usual: bool = True,
) -> Lexicon:
    """Return a lexicon whose scalar lines are about a system or scene; ``symbols``: LaTeX to its names.

    ``system``: the name of one, a scene file, or an object; ``first``: whether its letters go before the
    entries of the lexicon, as where those are only a draft; ``usual``: whether quantities have their usual
    letters besides. Raises `InputError` for systems that are not known and for names that the system has
    not.
    """
    from eom.checker.mean.model import model_from

    given = {"symbols": dict(symbols or {}), "usual": usual}
    model, spelt = _entries_of(model_from(system), given, lexicon.notation, "symbols")
    plain = lexicon.without_system()
    own = 0 if first else 1
    return replace(plain, layers=(*plain.layers[:own], *spelt, *plain.layers[own:]), system=model)


def parse_lexicon(text: str, name: str = "", folder: Path | None = None) -> Lexicon:
    """Return the lexicon that a TOML text spells. Raises `InputError`: all that is wrong with it."""
    return _usable(_toml(text, name), name, folder, text)


def _usable(data: Mapping[str, Any], name: str, folder: Path | None, text: str) -> Lexicon:
    """Return the lexicon that a table holds, which stands in a text. Raises `InputError` with its lines."""
    lexicon, errors = lexicon_of(data, name, folder)
    if errors:
        lines = lines_of(text)
        raise _joined(tuple(_lined(e, lines, name) for e in errors))
    return lexicon


def _lined(error: InputError, lines: Mapping[tuple[str, ...], int], name: str) -> InputError:
    """Return an error with the number of the line where its entry stands."""
    keys = tuple(error.where.removeprefix(name).lstrip(", ").replace(", ", " > ").split(" > "))
    line = next((lines[keys[:n]] for n in range(len(keys), 0, -1) if keys[:n] in lines), 0)
    if not line:
        return error
    where = (
        error.where.replace(name, f"{name}, line {line}", 1)
        if name
        else f"line {line}, {error.where}"
    )
    return error.at(where)


def _joined(errors: tuple[InputError, ...]) -> InputError:
    """Return one error that lists all."""
    first = errors[0]
    if len(errors) == 1:
        return first
    rest = "\n".join(str(e) for e in errors[1:])
    return InputError(f"{len(errors)} entries of a lexicon cannot be used\n{first}\n{rest}")


def _toml(text: str, name: str) -> Mapping[str, Any]:
    if len(text) > MAX_LEXICON:
        raise InputError("a lexicon is too long", where=name, got=f"{len(text)} characters")
    try:
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(
            "not TOML", where=name, got=error, hint="patterns stand in single quotes: '\\vec{r}'"
        ) from None


@lru_cache(maxsize=len(PRESETS))
def preset(name: str) -> Lexicon:
    """Return a preset by name. Raises `InputError` for unknown ones."""
    if name not in PRESETS:
        raise unknown_name("preset", name, PRESETS)
    file = resources.files("eom.checker.mean") / "presets" / f"{name}.toml"
    return parse_lexicon(file.read_text(encoding="utf-8"), f"preset {name}")


def front_matter(text: str) -> Mapping[str, Any]:
    """Return the table ``check`` of front matter between lines of ``+++``; none is empty.

    Between lines of ``---`` it is YAML. Raises `InputError` for what is neither.
    """
    match = _FRONT.match(text)
    if match is None:
        other = _YAML.match(text)
        return yaml_table(other[1]) if other is not None else {}
    found = _toml(match[1], "front matter").get("check", {})
    if not isinstance(found, Mapping):
        raise InputError("not a table", where="front matter", got=found, expected="[check]")
    return found


def lexicon_for(note: str, path: Path | None = None) -> Lexicon | None:
    """Return the lexicon of a note, None where it has none; see `lexicon_found`."""
    found = lexicon_found(note, path)
    return None if found is None else found[1]


def lexicon_found(note: str, path: Path | None = None) -> tuple[str, Lexicon] | None:
    """Return where the lexicon of a note stands, and the lexicon: front matter, else a file beside it.

    That is NAME.lexicon.toml, NAME.toml (without any key of a lexicon it is something else), or
    lexicon.toml. None where there is none. Raises `InputError` for entries that cannot be used.
    """
    data = front_matter(note)
    if data:
        name = "front matter"
        return name, _usable(data, name, path.parent if path else None, note)
    for file in _beside(path):
        text = lexicon_text(file) if file.is_file() else ""
        sure = file.name.endswith("lexicon.toml")
        if text and (sure or set(_KEYS).intersection(_toml(text, file.name))):
            return file.name, parse_lexicon(text, file.name, file.parent)
    return None


_KEYS = ("preset", "scope", "system", "assume", "laws", *_TABLES, *MOVING)


def lexicon_text(file: Path) -> str:
    """Return the text of a lexicon. Raises `InputError` for what cannot be read or is too long."""
    try:
        with file.open("rb") as stream:
            return stream.read(4 * MAX_LEXICON).decode()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("a lexicon cannot be read", where=str(file), got=error) from None


def _beside(path: Path | None) -> tuple[Path, ...]:
    if path is None:
        return ()
    names = (f"{path.stem}.lexicon.toml", f"{path.stem}.toml", "lexicon.toml")
    return tuple(path.with_name(name) for name in names)


# -- entries -------------------------------------------------------------------------------------


def _entry(latex: str, value: Any, notation: Notation, where: str) -> Entry:
    look = notation.plain(look_of(latex, where))
    found = meaning(value, where)
    used = {w for corner in look.corners for w in corner if SLOT.fullmatch(w)}
    unbound = sorted(f"<{s}>" for s in found.slots if f"<{s}>" not in used)
    if unbound:
        raise InputError("a slot is not in the pattern", where=where, got=unbound[0])
    if found.formula:
        read_formula(slotted(found.formula, where))
    return Entry(look, found, latex, where)


CHOICES: dict[str, Collection[str]] = {
    "quaternions": QUATERNION_PRODUCTS,
    "spatial": SPATIAL_ORDERS,
    "brackets": BRACKETS,
}
"""What settings may say."""
_SETTINGS: dict[str, type] = {
    "dot": str,
    "mixed": str,
    "skew": list,
    "dyads": bool,
    "juxtaposed": bool,
    "resolved": bool,
    "bracketed": bool,
    "quaternions": str,
    "spatial": str,
    "brackets": str,
    "alike": list,
}


def _setting(key: str, value: Any, where: str) -> Any:
    if key not in _SETTINGS:
        raise unknown_name("setting", key, _SETTINGS, where)
    if not isinstance(value, _SETTINGS[key]):
        raise InputError("wrong type", where=where, got=value, expected=_SETTINGS[key].__name__)
    if key in CHOICES and value not in CHOICES[key]:
        raise unknown_name(key, value, CHOICES[key], where)
    if not isinstance(value, list):
        return value
    return tuple(str(v) if key == "skew" else _nuclei(v, where) for v in value)


def _nuclei(value: Any, where: str) -> tuple[tuple[str, tuple[str, ...]], ...]:
    if not (isinstance(value, list) and all(isinstance(v, str) for v in value)):
        raise InputError("not a list of letters", where=where, got=value)
    looks = [look_of(v, where) for v in value]
    return tuple((look.style, look.accents) for look in looks)


_SLOTS = "FGPQijklc"


def slotted(latex: str, where: str) -> str:
    """Write slots as letters that no formula has."""
    unknown = [s for s in SLOT.findall(latex) if s not in _SLOTS]
    if unknown:
        raise InputError(
            "unknown slot",
            where=where,
            got=f"<{unknown[0]}>",
            expected=" ".join(f"<{s}>" for s in _SLOTS),
        )
    return SLOT.sub(lambda m: rf"\mathtt{{{m[1]}}}", latex)


@lru_cache(maxsize=4096)
def look_of(latex: str, where: str = "") -> Look:
    """Return the look of a pattern. Raises `InputError` for what is not one symbol."""
    tree = read_formula(slotted(latex, where)).tree
    change = tree.factors if isinstance(tree, Product) and not tree.operator else ()
    if (
        len(change) == 2
        and seen(change[0]) == Seen(Look("Delta"))
        and (of := seen(change[1])) is not None
    ):
        return grown(of)
    called = _is_call(tree)
    found = seen(tree.factors[0] if isinstance(tree, Product) and called else tree)
    if found is None or found.dots or len(found.raised) > 1:
        raise InputError(
            "a pattern is one symbol with its labels, without dots",
            where=where,
            got=latex,
            hint="the body of a formula that stands for something else goes into equals",
        )
    look = found.with_label() or found.look
    if called and isinstance(tree, Product) and (words := named_in(tree.factors[1])):
        return replace(look, sub=(*look.sub, *words))
    return replace(look, called=called)


def _is_equation(tree: Node) -> bool:
    plain = isinstance(tree, Relation) and [s.name for s in tree.signs] == ["="]
    return plain and not any(isinstance(m, Missing) for m in children(tree))


def _is_call(tree: Node) -> bool:
    """Whether this is a function with its argument: f(r)."""
    if not isinstance(tree, Product) or tree.operator or len(tree.factors) != 2:
        return False
    last = tree.factors[1]
    return isinstance(last, Group) and last.open == "("


def label_of(latex: str, where: str = "") -> Labels:
    """Return the words of a label. Raises `InputError` for what cannot be one."""
    tree = read_formula(f"x_{{{latex}}}").tree
    found = labels(tree.sub) if isinstance(tree, Scripts) else ()
    if not found:
        raise InputError("not a label", where=where, got=latex)
    return found
