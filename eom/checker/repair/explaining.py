"""Why a line is wrong: what is left over, what would make it right, where it fails, which convention."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from eom.checker.explanation import UNEXPLAINED, Correction, Counterexample, Explanation
from eom.checker.judge.inequalities import ORDERS
from eom.checker.judge.notes import Understood
from eom.checker.judge.systems import on_solutions
from eom.checker.judge.verdicts import GRAVE, Judged
from eom.checker.repair.candidates import Candidate, Workshop
from eom.checker.repair.conventions import other_convention
from eom.checker.repair.corrections import Verified, corrections, levels, workshop
from eom.checker.repair.counterexample import counterexample
from eom.checker.repair.lines import Line, Place, line
from eom.checker.repair.orders import unordered
from eom.checker.repair.remainder import leftover
from eom.checker.repair.rewriting import blamed, rewritten
from eom.checker.repair.scalar_slips import between_scalars
from eom.checker.repair.stated import stated
from eom.checker.repair.wording import words as told


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
    change = "; ".join(dict.fromkeys(told(wrong, o) for o in options))
    slips = ", ".join(dict.fromkeys(o.slip.name for o in options))
    return Correction(text, change, slips, span, new, found.judgement.sets)
