r"""What letters and labels stand for where words are silent: by others of the same letter, by custom.

``v_C`` is the norm of ``\vec v_C``, ``B`` a frame of the body; a letter that stands in identities alone is
any vector.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from eom.checker.infer.places import USUAL
from eom.checker.infer.sayings import LIST, Prose, look_of
from eom.checker.infer.shown import bare, known, operands_of, symbols_of
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.lexicon import AXES, Lexicon, Meaning
from eom.checker.mean.values import Refusal
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import Formula, Statement
from eom.checker.read.symbol_shape import Labels, Look, seen
from eom.checker.read.syntax import Addition, Group, Marks, Node, Product, Symbol, Words, walk
from eom.checker.read.writing import latex, latex_of
from eom.errors import InputError
from eom.terms.terms import INDICES, VECTOR

CUSTOMARY = "by custom"
LETTER = "by its letter"
FORMULA = "by its formula in the text"
BOOKS = "as in the usual books"
DISPLAY = "by its display"
PLACED = "by the place of the label"
ANY = "any vector, as nothing is said of it"
GUESSED = frozenset({CUSTOMARY, LETTER, BOOKS, DISPLAY, PLACED, ANY})
"""What stands in the place of words where they say nothing."""


@dataclass(frozen=True)
class Draft:
    """A proposed entry: table, pattern, meaning, the words that say so, and their line."""

    table: str
    latex: str
    meaning: str
    words: str
    line: int


def derived(lexicon: Lexicon, symbols: Iterable[Node], text: Prose) -> Iterator[Draft]:
    r"""Yield entries for symbols without a meaning that others of the same letter give.

    ``v_C`` the norm of the vector ``\vec v_C``, ``\hat r`` the direction of ``\vec r``, ``\omega_2`` a
    component, ``\mathbf u`` the column of ``\vec u``; ``s_\theta`` the sine of an angle where words say so.
    """
    short = any("sine" in s and "cosine" in s for s in text.sentences) or _shown_short(text)
    done = set(_sized(text))
    symbols = tuple(symbols)
    looks = {k for n in symbols if (k := bare(n, lexicon)) is not None}
    for node in symbols:
        found = bare(node, lexicon)
        if found is None or found in done or lexicon.find(found) or known(lexicon, node):
            continue
        done.add(found)
        means = _others(lexicon, found) or _of_letter(lexicon, found, looks)
        means = means or _norm(lexicon, found, text) or (_short(lexicon, found) if short else "")
        pattern, means = indexed(found, means)
        if means:
            yield Draft("symbols", pattern, means, LETTER, 0)


_SIZE = re.compile(
    rf"\b(?:radius|radii|height|length|width|side|edge|thickness|depth|diameter|density|ratio|coefficient)s?\s+"
    rf"(?:is\s+|are\s+)?({LIST})",
    re.IGNORECASE,
)


def _sized(text: Prose) -> Iterator[Look]:
    """Yield plain letters that words call a size, which are no norms of vectors."""
    for sentence in text.sentences:
        for match in _SIZE.finditer(sentence):
            if not re.search(r"\bits\s+$", sentence[: match.start()][-5:]):
                yield from (m.look for m in text.marked(match[1]))


def indexed(look: Look, means: str) -> tuple[str, str]:
    """Return the pattern of a symbol and its formula, for any particle where it carries an index."""
    if len(look.sub) != 1 or look.sub[0] not in INDICES:
        return latex_of(look), means
    pattern = latex_of(replace(look, sub=("<i>",)))
    return pattern, means.replace(f"_{{{look.sub[0]}}}", "_{<i>}")


_FUNCTIONS = {"s": "sin", "c": "cos"}


def _shown_short(text: Prose) -> bool:
    """Return whether a formula of the text says that a letter with an angle below is its sine or cosine."""
    for statement in text.formulas:
        look, right = look_of(statement.members[0]), latex(statement.members[1])
        of = _FUNCTIONS.get(look.name) if look is not None and len(look.sub) == 1 else None
        if of is not None and right.startswith(rf"\{of} "):
            return True
    return False


def _short(lexicon: Lexicon, look: Look) -> str:
    """Return the sine or cosine that a letter with an angle below it stands for."""
    angle = Look(look.sub[0]) if len(look.sub) == 1 and not look.accents else None
    known = angle is not None and lexicon.find(angle) is not None and look.name in _FUNCTIONS
    return rf"= \{_FUNCTIONS[look.name]} {latex_of(angle)}" if known and angle is not None else ""


def _others(lexicon: Lexicon, look: Look) -> str:
    """Return what a letter stands for that has a meaning with a point alone, or without its mark."""
    return _of_particle(lexicon, look) or _without_mark(lexicon, look)


def _of_letter(lexicon: Lexicon, look: Look, looks: Container[Look]) -> str:
    """Return what a letter stands for that a vector has, too: its norm, direction, component, column."""
    axis = AXES.get(look.sub[-1]) if look.sub else None
    bare = lexicon.find(replace(look, sub=())) if len(look.sub) == 1 else None
    if bare is not None and look.sub[0] in INDICES and bare.meaning.quantity == "linear_momentum":
        return "linear_momentum <i>"
    plain = not look.accents and not look.style
    table = (_moment(lexicon, look) or _entry(lexicon, look)) if plain else ""
    if table:
        return table
    unit = "hat" in look.accents
    for entry in (e for layer in lexicon.layers for e in layer):
        e = entry.look
        vector = replace(e, sub=look.sub, sup=look.sup)
        whole, said = latex_of(vector), entry.where.startswith("draft") or vector in looks
        if not _is_marked(e, look) or not _is_vector(lexicon, entry.meaning, whole):
            continue
        if plain and said and lexicon.find(vector) is not None and not _is_unit(entry.meaning):
            return rf"= \left|{whole}\right|"
        own = entry.meaning.quantity != "vector" and lexicon.find(vector) is not None
        if own and _is_skew(lexicon, look):
            return rf"= \{look.accents[0]}{{{whole}}}"
        if unit and lexicon.find(replace(e, sub=look.sub)) is not None:
            return rf"= {whole} / \left|{whole}\right|"
        if plain and axis and not entry.meaning.component and len(look.sub) == 1 and not e.sub:
            return f"{_worded(entry.meaning)} in B component {axis}"
        if (
            look.style == "bold"
            and not look.accents
            and not entry.meaning.frame
            and "vec" not in e.style
        ):
            return f"{_worded(entry.meaning)} in B" if not entry.slots and e.sub == look.sub else ""
    return ""


def _is_marked(vector: Look, look: Look) -> bool:
    """Return whether a symbol has the same letter with a mark that the other has not."""
    marked = bool(vector.accents or vector.style) and vector.name == look.name
    return marked and (vector.accents, vector.style) != (look.accents, look.style)


def _is_skew(lexicon: Lexicon, look: Look) -> bool:
    """Return whether a letter carries the mark of a matrix and none of a vector."""
    return len(look.accents) == 1 and look.accents[0] in lexicon.notation.skew and not look.style


def _norm(lexicon: Lexicon, look: Look, text: Prose) -> str:
    """Return the norm of the one vector of a letter of which the text has a norm in a formula."""
    if look.accents or look.style or any(look.corners):
        return ""
    members = (m for s in text.formulas for m in s.members)
    groups = (n for m in members for n in walk(m) if isinstance(n, Group) and n.open == "|")
    inside = {k.look for g in groups if (k := seen(g.body)) is not None and not k.dots}
    vectors = [k for k in inside if k.name == look.name and (k.accents or k.style)]
    known = vectors and lexicon.find(vectors[0]) is not None
    return rf"= \left|{latex_of(vectors[0])}\right|" if known and len(vectors) == 1 else ""


def _without_mark(lexicon: Lexicon, look: Look) -> str:
    """Return what words say of the same letter without its mark, where that is a vector all the same."""
    plain = replace(look, style="", accents=())
    found = lexicon.find(plain) if plain != look and "hat" not in look.accents else None
    means = found.entry.meaning if found is not None else None
    said = found is not None and found.entry.where.startswith("draft")
    if means is None or not said or means.formula or means.component or means.frame:
        return ""
    return means.words if means.kind == VECTOR and "<" not in means.words else ""


_LABELLED = re.compile(r"(?P<point>\w+?)_?(?P<index>[ijk])")
"""A point with the index of a particle behind it, as in ``H_{O_i}``."""
_ABOUT = frozenset({"angular_momentum", "absolute_angular_momentum", "torque"})


def _of_particle(lexicon: Lexicon, look: Look) -> str:
    """Return what a letter is of a particle that is of all of them with a point alone below it."""
    match = _LABELLED.fullmatch("".join(look.sub)) if look.accents or look.style else None
    whole = replace(look, sub=(match["point"],)) if match is not None else None
    found = lexicon.find(whole) if whole is not None and whole.sub in lexicon.points else None
    if match is None or found is None or found.meaning.quantity not in _ABOUT:
        return ""
    return f"{found.meaning.quantity} {match['index']} {found.meaning.labels[-1]}"


def followed(lexicon: Lexicon, looks: Iterable[Look], said: Container[str]) -> Iterator[Draft]:
    """Yield what a preset takes about another point than words do.

    These are components of a vector that words take about one, and positions where words see all that they
    name from one point. ``said``: the patterns that words give.
    """
    looks = tuple(looks)
    yield from _seen_from(lexicon, looks, said)
    whole = [
        e
        for layer in lexicon.layers
        for e in layer
        if e.latex in said and (e.look.accents or e.look.style) and not any(e.look.corners)
    ]
    for look in looks:
        found = lexicon.find(look)
        if found is None or not found.meaning.component or found.entry.latex in said:
            continue
        for entry in whole:
            means = entry.meaning
            same = entry.look.name == look.name and means.quantity == found.meaning.quantity
            if same and means.labels != found.entry.meaning.labels:
                new = replace(found.entry.meaning, labels=means.labels)
                yield Draft("symbols", found.entry.latex, new.words, LETTER, 0)


def _seen_from(lexicon: Lexicon, looks: Iterable[Look], said: Container[str]) -> Iterator[Draft]:
    """Yield positions that a preset sees from the inertial origin, from the point of which words speak."""
    entries = [e for layer in lexicon.layers for e in layer if e.where.startswith("draft")]
    placed = {e.meaning.labels[1] for e in entries if e.latex in said and _is_place(e.meaning)}
    if len(placed) != 1 or "OI" in placed:
        return
    for look in looks:
        found = lexicon.find(look)
        if found is None or found.entry.latex in said or not _is_place(found.entry.meaning):
            continue
        of, start = found.entry.meaning.labels
        if start == "OI" and of not in placed:
            new = replace(found.entry.meaning, labels=(of, *placed))
            yield Draft("symbols", found.entry.latex, new.words, LETTER, 0)


def _is_place(meaning: Meaning) -> bool:
    return meaning.quantity == "position" and len(meaning.labels) == 2


def solved(left: Node, right: Node) -> Iterator[tuple[Node, str]]:
    """Yield each term of a sum or difference of symbols with what the others make of it."""
    terms = right.terms if isinstance(right, Addition) and len(right.terms) > 1 else ()
    signs = ["-" if s == "-" else "+" for s in right.signs] if isinstance(right, Addition) else []
    for k, term in enumerate(terms if all(look_of(t) for t in terms) else ()):
        turned = "+-" if signs[k] == "+" else "-+"
        others = "".join(
            f" {turned[signs[j] == '+']} {latex(t)}" for j, t in enumerate(terms) if j != k
        )
        first = latex(left) if signs[k] == "+" else f"- {latex(left)}"
        yield term, f"{first}{others}"


_RATES = {"v": ("r", r"\dot"), "V": ("R", r"\dot"), "a": ("r", r"\ddot")}
"""Letters of rates of a position, with its letter."""


def rate(lexicon: Lexicon, look: Look) -> str:
    """Return the formula of the rate of a position with the marks and labels of a letter with a prime."""
    letter, dots = _RATES.get(look.name, ("", ""))
    of = replace(look, name=letter)
    marked = (look.accents or look.style) and any(look.corners)
    found = lexicon.find(of) if letter and marked else None
    if found is None or "prime" not in look.sup:
        return ""
    return rf"= {dots}{{{latex_of(of)}}}"


def turning(lexicon: Lexicon, look: Look) -> tuple[str, str]:
    r"""Return the formula of an angular acceleration between frames, with its pattern; "" where none is.

    ``{}^{A}\vec\alpha^{B}`` is the derivative in A of ``{}^{A}\vec\omega^{B}``, for any two frames.
    """
    of = replace(look, name="omega")
    found = lexicon.find(of) if look.name == "alpha" and look.presup and look.sup else None
    if found is None or found.meaning.quantity != "angular_velocity":
        return "", ""
    one, two = (replace(k, presup=("<F>",), sup=("<G>",)) for k in (of, look))
    return latex_of(two), rf"= \left(\frac{{d}}{{dt}} {latex_of(one)}\right)_{{<F>}}"


def _is_vector(lexicon: Lexicon, meaning: Meaning, latex: str) -> bool:
    """Return whether a symbol is a vector, by its meaning or its formula."""
    if meaning.kind == VECTOR or not meaning.formula:
        return meaning.kind == VECTOR
    try:
        return elaborator(lexicon).value(read_formula(latex).tree).shape == VECTOR
    except (Refusal, InputError):
        return False


def _is_unit(meaning: Meaning) -> bool:
    """Return whether a vector has the length one, which no letter stands for."""
    return meaning.quantity in {"unit", "principal_axis", "rotor_axis"}


def _entry(lexicon: Lexicon, look: Look) -> str:
    """Return the entry of a rotation that a letter with the numbers of two axes is."""
    axes = [AXES[w] for w in look.sub if w in AXES]
    if len(axes) != 2 or len(look.sub) != 2 or any((look.sup, look.presub, look.presup)):
        return ""
    found = (
        e.meaning
        for layer in lexicon.layers
        for e in layer
        if e.look.name == look.name and not any(e.look.corners) and e.where.startswith("draft")
    )
    table = next((m for m in found if m.quantity == "rotation" and not m.component), None)
    return f"{_worded(table)} component {' '.join(axes)}" if table is not None else ""


def _moment(lexicon: Lexicon, look: Look) -> str:
    """Return the moment or product of inertia that a table's letter with numbers of axes is."""
    axes = [AXES[w] for w in look.sub if w in AXES]
    tables = (
        e.meaning
        for layer in lexicon.layers
        for e in layer
        if e.look.name == look.name and not any(e.look.corners) and e.meaning.quantity == "inertia"
    )
    table = next((m for m in tables if not m.component), None)
    other = look.sup or look.presub or look.presup
    if table is None or other or len(axes) != len(look.sub) or not 1 <= len(axes) <= 2:
        return ""
    return f"{_worded(table)} in {table.frame or 'B'} component {axes[0]} {axes[-1]}"


def _worded(meaning: Meaning) -> str:
    """Return a meaning without frame and components in words of a lexicon."""
    return " ".join((meaning.quantity, *meaning.labels))


def by_custom(
    lexicon: Lexicon, looks: Iterable[Look], drafts: Mapping[tuple[str, str], Draft]
) -> Iterator[Draft]:
    """Yield frames and points that labels of the note name by custom."""
    labels = dict.fromkeys((w,) for look in looks for c in look.corners for w in c if w != "d")
    yield from _free_point(lexicon, looks)
    yield from _drawn_points(lexicon, labels)
    pairs = any(c[i : i + 2] == ("d", "m") for k in looks for c in k.corners for i in range(len(c)))
    if pairs and ("d", "m") not in lexicon.points:
        yield Draft("points", "dm", "dm", CUSTOMARY, 0)
    for table, names in USUAL.items():
        said = {d.meaning for d in drafts.values() if d.table == table}
        for label in labels:
            name = names.get("".join(label))
            known = label in lexicon.frames or label in lexicon.points
            known = known or (label[0] in INDICES and ("b",) not in labels)
            if name and not known and (table == "frames" or name not in said):
                word = "".join(label)
                yield Draft(table, rf"\{word}" if len(word) > 1 else word, name, CUSTOMARY, 0)


def _drawn_points(lexicon: Lexicon, labels: Iterable[Labels]) -> Iterator[Draft]:
    """Yield labels in another alphabet that name the point of their letter, and no frame."""
    for label in labels:
        plain = (label[0].removeprefix("cal "),)
        drawn = plain != label and label not in {*lexicon.points, *lexicon.frames}
        if drawn and plain in lexicon.points and plain not in lexicon.frames:
            yield Draft("points", rf"\mathcal{{{plain[0]}}}", lexicon.points[plain], CUSTOMARY, 0)


def _free_point(lexicon: Lexicon, looks: Iterable[Look]) -> Iterator[Draft]:
    """Yield the one label that stands where points do and that no words name: a point that moves freely."""
    open_ = {e.look.name for layer in lexicon.layers for e in layer if "<P>" in e.latex}
    labels = dict.fromkeys(
        w
        for k in looks
        if k.name in open_ and lexicon.find(k) is None
        for c in k.corners
        if c is not k.sup or "/" not in c
        for w in c
    )
    names = [w for w in labels if re.fullmatch("[A-Z]", w)]
    free = [w for w in names if not {(w,)} & {*lexicon.points, *lexicon.frames}]
    if len(free) == 1 and "P" not in lexicon.points.values():
        yield Draft("points", free[0], "P", CUSTOMARY, 0)


def along(
    statement: Statement, line: int, lexicon: Lexicon, *, known: bool = False
) -> Iterator[Draft]:
    r"""Yield a letter that a display defines as the factor of a unit vector, as in ``\vec a = s\hat b``.

    ``known``: of letters that have a meaning already, too.
    """
    if not statement.relational or len(statement.members) != 2:
        return
    left, right = statement.members
    vector = look_of(left) if seen(left) is not None else None
    found = lexicon.find(vector) if vector is not None else None
    if found is None or found.meaning.kind != VECTOR or found.meaning.component:
        return
    sign = ""
    if isinstance(right, Addition) and len(right.terms) == 1:
        sign = "-" if right.signs[0] == "-" else ""
        right = right.terms[0]
    factors = right.factors if isinstance(right, Product) and not right.operator else ()
    looks = [seen(f) for f in factors]
    if len(looks) != 2 or looks[0] is None or looks[1] is None or looks[0].dots or looks[0].raised:
        return
    letter, unit = looks[0].look, lexicon.find(looks[1].look)
    plain = not letter.accents and not letter.style
    new = known or lexicon.find(letter) is None
    if unit is not None and unit.meaning.quantity == "unit" and plain and new:
        formula = rf"= {sign}{latex(left)} \cdot {latex(factors[1])}"
        yield Draft("symbols", latex_of(letter), formula, DISPLAY, line)


def labelled(formulas: Iterable[Formula], lexicon: Lexicon) -> Iterator[Draft]:
    r"""Yield symbols with a raised label, as in ``\vec T^*``, that a display has alone on its left first.

    A label is a word, or a mark that is no derivative of the note. The display defines what that is.
    """
    done: set[Look] = set()
    for formula in formulas:
        for statement in formula.statements if formula.relational else ():
            look = _labelled(statement.members[0], lexicon)
            first = look is not None and look not in done and formula.piece.kind == "display"
            if first and look is not None and lexicon.find(look) is None:
                yield Draft("symbols", latex_of(look), "defined", DISPLAY, formula.piece.line)
            done |= {k for m in statement.members for n in walk(m) if (k := _labelled(n, lexicon))}


def introduced(
    formulas: Iterable[Formula], lexicon: Lexicon, named: Container[tuple[int, Look]]
) -> Iterator[Draft]:
    r"""Yield symbols that first stand alone on the left of a display in which all else has a meaning.

    ``named``: lines and letters of displays that words call new names.
    """
    new: dict[Look, Draft] = {}
    before: set[Look] = set()
    for formula in formulas:
        line = formula.piece.line
        for statement in formula.statements if formula.relational else ():
            first, *rest = statement.members
            others = tuple(symbols_of(rest))
            told = others and all(known(lexicon, n) or bare(n, lexicon) in new for n in others)
            equal = {g.name for g in statement.signs} == {"="}
            look = bare(first, lexicon)
            fresh = look is not None and look not in before and not known(lexicon, first)
            if look is not None and fresh and told and equal and (line, look) in named:
                new[look] = Draft("symbols", latex_of(look), "defined", DISPLAY, line)
            before.update(k for n in symbols_of(statement.members) if (k := bare(n, lexicon)))
    yield from new.values()


def _labelled(node: Node, lexicon: Lexicon) -> Look | None:
    """Return the look of a symbol with a raised label that is neither a mark of the note nor a power."""
    found = seen(node)
    first = found.raised[0] if found is not None and len(found.raised) == 1 else None
    if found is None or found.dots or first is None:
        return None
    mark = isinstance(first, Marks) and not {*first.names} & {*lexicon.notation.marks, "times"}
    word = isinstance(first, Words) or (
        isinstance(first, Symbol) and first.style == "roman" and len(first.name) > 1
    )
    return found.with_label() if mark or word else None


_ANY_VECTOR = re.compile("[abcuvwxy]")
"""Letters of vectors in an identity that holds for all of them."""


def free_vectors(
    formulas: Iterable[Formula], lexicon: Lexicon, unknown: Iterable[Look], *, told: bool
) -> Iterator[tuple[Look, str]]:
    r"""Yield unknown vectors that stand in displays of nothing but such, in identities, and their meanings.

    ``told``: only beside one that words call any vector. A letter without a mark is the column of body
    components of the vector with one, as in ``[\tilde u] v``.
    """
    unknown = set(unknown)
    marked = {k for k in unknown if (k.accents or k.style) and is_any(k)}
    entries = (e for layer in lexicon.layers for e in layer)
    said = {e.look for e in entries if e.meaning.quantity == "vector"}
    letters = {k.name for k in marked | said}
    plain = {Look(n) for n in letters} & unknown
    free = marked | plain | said | {Look(n, accents=("tilde",)) for n in letters}
    free |= {Look(n, sub=(axis,)) for n in letters for axis in AXES}
    free |= {replace(k, accents=tuple(sorted(("tilde", *k.accents)))) for k in marked | said}
    shown = [set(operands_of(f)) for f in formulas if f.piece.kind == "display"]
    for look in sorted(marked | plain, key=lambda k: (k.text, k.accents)):
        lines = [s for s in shown if look in s]
        if lines and all(s <= free and (s & said or not told) for s in lines):
            yield look, f"vector {look.name}{' in B' if look in plain else ''}"


def is_any(look: Look) -> bool:
    """Return whether a vector may be any: of a usual letter, without labels or the mark of a matrix."""
    return (
        bool(_ANY_VECTOR.fullmatch(look.name))
        and not any(look.corners)
        and not _SKEW & {*look.accents}
    )


_SKEW = frozenset({"tilde", "widetilde"})


_ALIKE: tuple[frozenset[str], ...] = (
    frozenset({"angular_momentum", "absolute_angular_momentum"}),
    frozenset({"kinetic_energy", "rotational_energy"}),
    frozenset({"mass", "total_mass"}),
    frozenset({"force", "external_force", "internal_force"}),
    frozenset({"angle", "turn_angle", "free_angle", "principal_angle"}),
    frozenset({"torque", "gravity_torque"}),
    frozenset({"euler_parameter", "euler_vector", "quaternion", "quaternion_last"}),
)
"""Quantities that words separate worse than a preset does."""


_CLOSELY = re.compile(r"\b(?:about(?! (?:\w+ ){1,3}axes)|relative|respect|from|built|particles?)\b")
"""Words by which a note says more of a quantity than its name."""


def said_by(own: Lexicon, draft: Draft) -> str:
    """Return the pattern by which a preset says what words say, or says it by a formula; "" for none."""
    if draft.table != "symbols" or "<" in draft.latex or draft.meaning.startswith("turn_angle"):
        return ""
    look = look_of(read_formula(draft.latex).tree)
    found = own.find(look) if look is not None else None
    if found is None:
        return ""
    both = {found.meaning.quantity, draft.meaning.split(maxsplit=1)[0]}
    alike = len(both) == 1 or any(both <= a for a in _ALIKE)
    same = found.meaning.words == draft.meaning or found.meaning.quantity == "equals"
    return found.entry.latex if same or (alike and not _CLOSELY.search(draft.words)) else ""
