"""Why a line is wrong: what is left over, what would make it right, where it fails, which convention.

Lines that are right in another convention: what symbols of attitude mean is exchanged all over.

Three questions of convention are no errors: whether a rotation matrix turns frames or vectors, whether
a sequence is one about moving or fixed axes, whether the scalar of a quaternion stands first or last.

Words for a slip that was undone: which, where in a chain or table, what stands there, what was meant.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from eom.checker.judge.inequalities import ORDERS
from eom.checker.judge.judge import HOLDS, UNDER, judge
from eom.checker.judge.notes import Understood, reread
from eom.checker.judge.systems import on_solutions
from eom.checker.judge.verdicts import GRAVE, Judged
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.meanings import Meaning
from eom.checker.read.paths import Path, at
from eom.checker.read.syntax import Matrix, Missing, Node
from eom.checker.read.writing import latex
from eom.checker.repair.candidates import Candidate, Workshop
from eom.checker.repair.corrections import Verified, corrections, levels, workshop
from eom.checker.repair.counterexample import counterexample
from eom.checker.repair.levels import penalty
from eom.checker.repair.lines import Line, Place, line
from eom.checker.repair.options import Option
from eom.checker.repair.orders import between_scalars, unordered
from eom.checker.repair.remainder import leftover
from eom.checker.repair.rewriting import blamed, rewritten, tight
from eom.checker.repair.slips import LOST
from eom.checker.repair.stated import stated
from eom.checker.report.findings import UNEXPLAINED, Correction, Counterexample, Explanation


def explain(
    understood: Understood, judged: Judged, given: Iterable[str] = (), stated: Iterable[str] = ()
) -> Explanation:
    """Return why a claim of a formula is wrong or ill-formed; nothing is said of other claims.

    ``given``: assumed without being said; ``stated``: what the note has assumed so far, which makes
    repairs that need it more plausible.
    """
    if judged.verdict not in GRAVE:
        return UNEXPLAINED
    given, stated = tuple(given), tuple(stated)
    places = judged.chain.blamed if judged.chain is not None else ()
    scalars = between_scalars(understood, judged.claim)
    compared = scalars or unordered(understood, judged.claim, given)
    if compared is not None:
        return compared
    wrong = line(understood, judged.claim)
    if wrong is None:
        return Explanation(blamed=places or tuple(f.span for f in judged.claim.findings))
    shop = workshop(understood, wrong, given)
    found = corrections(understood, shop, given, stated)
    ranked = found[0].ranked if found else None
    candidate = ranked.candidate if ranked is not None else None
    place = ranked.place if ranked is not None else next((p for _, p in levels(shop, given)), None)
    return Explanation(
        residual=leftover(shop, candidate, place) if place is not None else "",
        blamed=blamed(wrong, candidate) if candidate is not None else places,
        corrections=tuple(_correction(understood, wrong, v) for v in found),
        counterexample=_fails(shop, candidate, place, given) if place is not None else None,
        convention=other_convention(understood, wrong.number, given),
    )


def corrected(
    understood: Understood, judged: Judged, given: Iterable[str] = (), stated: Iterable[str] = ()
) -> tuple[Correction, ...]:
    """Return the repairs of a claim alone, without what else `explain` says."""
    given, stated = tuple(given), tuple(stated)
    claim = judged.claim
    apart = claim.parameters is not None or bool(ORDERS & set(claim.relations))
    wrong = None if apart or judged.verdict not in GRAVE else line(understood, claim)
    if wrong is None:
        return explain(understood, judged, given, stated).corrections
    found = corrections(understood, workshop(understood, wrong, given), given, stated)
    return tuple(_correction(understood, wrong, v) for v in found)


def _fails(
    shop: Workshop, candidate: Candidate | None, place: Place, given: tuple[str, ...]
) -> Counterexample | None:
    """Return small numbers for which a line fails, with what they assume beyond what is given."""
    on_states = on_solutions(shop.line.claim)
    found = (stated if on_states else counterexample)(shop, candidate, place)
    if found is None:
        return None
    return replace(found, assumptions=tuple(n for n in found.assumptions if n not in given))


def _correction(understood: Understood, wrong: Line, found: Verified) -> Correction:
    ranked = found.ranked
    text, span, new = rewritten(understood, wrong, ranked.candidate, ranked.tree)
    options = ranked.candidate.options
    change = "; ".join(dict.fromkeys(words(wrong, o) for o in options))
    slips = ", ".join(dict.fromkeys(o.slip.name for o in options))
    return Correction(text, change, slips, span, new, found.judgement.sets)


PLAUSIBLE = 1.5
"""Most that the assumptions may weigh under which a line holds in another convention."""


@dataclass(frozen=True)
class Convention:
    """Words for the other side of a convention, and what a meaning becomes there."""

    words: str
    change: Callable[[Meaning], Meaning]


def _transposed(meaning: Meaning) -> Meaning:
    """Exchange the frames of a rotation, and turns of frames and of vectors."""
    if meaning.quantity == "rotation":
        return replace(meaning, labels=meaning.labels[::-1])
    return replace(meaning, quantity=_TURNS.get(meaning.quantity, meaning.quantity))


_TURNS = {"turn": "active_turn", "active_turn": "turn"}


def _order(meaning: Meaning) -> Meaning:
    """Exchange turns about moving and fixed axes."""
    if meaning.quantity != "turn_angle":
        return meaning
    place, axes, *frames = meaning.labels
    fixed = axes.startswith("space")
    other = axes.removeprefix("space") if fixed else "space" + axes.removeprefix("body")
    return replace(meaning, labels=(place, other, *frames))


_SCALARS = {"quaternion": "quaternion_last", "quaternion_last": "quaternion"}


def _scalar(meaning: Meaning) -> Meaning:
    """Exchange columns of Euler parameters with the scalar first and last."""
    return replace(meaning, quantity=_SCALARS.get(meaning.quantity, meaning.quantity))


CONVENTIONS: tuple[Convention, ...] = (
    Convention("all rotation matrices transposed (active and passive exchanged)", _transposed),
    Convention("turns about fixed and moving axes exchanged", _order),
    Convention("the scalar of quaternions at the other end", _scalar),
)
"""Every convention, with what it changes."""


def changed(lexicon: Lexicon, convention: Convention) -> Lexicon:
    """Return a lexicon whose meanings are those of the other convention."""
    layers = tuple(
        tuple(replace(entry, meaning=convention.change(entry.meaning)) for entry in layer)
        for layer in lexicon.layers
    )
    return lexicon if layers == lexicon.layers else replace(lexicon, layers=layers)


def other_convention(understood: Understood, number: int, given: Iterable[str] = ()) -> str:
    """Return in which other conventions a wrong claim of a formula is right, "" for none.

    ``number``: of the claim. What the note itself has defined stays as it was defined. A line without
    rates is often right by each of two conventions; both are told.
    """
    given = tuple(given)
    right = [c.words for c in CONVENTIONS if _right(understood, number, c, given)]
    return f"right in the other convention: {', or: '.join(right)}" if right else ""


def _right(
    understood: Understood, number: int, convention: Convention, given: tuple[str, ...]
) -> bool:
    """Tell whether a claim is right in another convention that changes what it says."""
    reading = understood.formula.reading
    lexicon = changed(understood.lexicon, convention)
    if reading is None or lexicon is understood.lexicon:
        return False
    claims = reread(replace(understood, lexicon=lexicon), reading.tree)
    claim = claims[number] if number < len(claims) else None
    before = understood.claims[number]
    if claim is None or claim.verdict or claim.kind != before.kind:
        return False
    same = claim.members == before.members and claim.scalars == before.scalars
    if same and not before.verdict:
        return False
    found = judge(claim, given)
    least = min((penalty(s, frozenset(given)) for s in found.sets), default=0.0)
    return found.verdict == HOLDS or (found.verdict == UNDER and least <= PLAUSIBLE)


SIDES = 2
"""Members of an equation; those of a longer chain are counted."""


def words(line: Line, option: Option) -> str:
    """Say what was undone."""
    head = f"{option.slip.words}{_member(line, option)}"
    if option.added:
        return f"{head}: {', '.join(_added(option, cell, text) for cell, text in option.added)}"
    head += _cell(option.addend.node, option.paths[0])
    if option.slip is LOST:
        return f"{head}: ${'-' if option.sign < 0 else '+'} {tight(option.new)}$"
    if isinstance(option.new, Missing):
        return f"{head}: ${latex(option.addend.node)}$"
    if option.sign != option.addend.sign:
        return f"{head}: before ${latex(option.addend.node)}$"
    return f"{head}: ${latex(option.old)}$ should be ${latex(option.new)}$"


def _member(line: Line, option: Option) -> str:
    """Name the member of a chain, as it is counted in the line."""
    written = [m.number for m in line.members if m.path is not None]
    place = written.index(option.addend.member) + 1
    return f" in member {place}" if len(written) > SIDES else ""


def _added(option: Option, cell: tuple[int, int], text: str) -> str:
    """Say what a cell of a table lacks."""
    path = option.paths[0]
    inside = path[-1:] == (("rows", cell),)
    return f"${text}${_cell(option.addend.node, path if inside else (*path, ('rows', cell)))}"


def _cell(root: Node, path: Path) -> str:
    """Name the row of the innermost table around a place, and the column where there are several."""
    for k in range(len(path) - 1, -1, -1):
        name, numbers = path[k]
        table = at(root, path[:k])
        if isinstance(table, Matrix) and name == "rows" and len(numbers) == SIDES:
            row, column = numbers
            wide = len(table.rows[0]) > 1
            return f" in row {row + 1}" + (f", column {column + 1}" if wide else "")
    return ""
