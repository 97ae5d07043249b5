"""Why a line is wrong: what is left over, what would make it right, where it fails, which convention."""

from __future__ import annotations

from collections.abc import Iterable

from eom.checker.conventions import other_convention
from eom.checker.corrections import Verified, corrections, levels, workshop
from eom.checker.counterexample import counterexample
from eom.checker.explanation import UNEXPLAINED, Correction, Explanation
from eom.checker.lines import Line, line
from eom.checker.notes import Understood
from eom.checker.options import Option
from eom.checker.remainder import leftover
from eom.checker.rewriting import blamed, rewritten, tight
from eom.checker.slips import LOST
from eom.checker.syntax import Missing
from eom.checker.systems import on_solutions
from eom.checker.verdicts import GRAVE, Judged
from eom.checker.writing import latex


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
    if judged.claim.parameters is not None or on_solutions(judged.claim):
        return Explanation(blamed=places)
    wrong = line(understood, judged.claim)
    if wrong is None:
        return Explanation(blamed=places or tuple(f.span for f in judged.claim.findings))
    shop = workshop(understood, wrong)
    found = corrections(understood, shop, given, stated)
    ranked = found[0].ranked if found else None
    candidate = ranked.candidate if ranked is not None else None
    place = ranked.place if ranked is not None else next((p for _, p in levels(shop, given)), None)
    return Explanation(
        residual=leftover(shop, candidate, place) if place is not None else "",
        blamed=blamed(wrong, candidate) if candidate is not None else places,
        corrections=tuple(_correction(understood, wrong, v) for v in found),
        counterexample=counterexample(shop, candidate, place) if place is not None else None,
        convention=other_convention(understood, wrong.number, given),
    )


def _correction(understood: Understood, wrong: Line, found: Verified) -> Correction:
    ranked = found.ranked
    text, span, new = rewritten(understood, wrong, ranked.candidate, ranked.tree)
    options = ranked.candidate.options
    words = "; ".join(dict.fromkeys(_words(o) for o in options))
    slips = ", ".join(dict.fromkeys(o.slip.name for o in options))
    return Correction(text, words, slips, span, new, found.judgement.sets)


def _words(option: Option) -> str:
    """Say what was undone: the slip, what stands there and what may have been meant."""
    if option.slip is LOST and option.node is option.new:
        return f"{option.slip.words}: ${'-' if option.sign < 0 else '+'} {tight(option.new)}$"
    if isinstance(option.new, Missing):
        return f"{option.slip.words}: ${latex(option.addend.node)}$"
    if option.sign != option.addend.sign:
        return f"{option.slip.words}: before ${latex(option.addend.node)}$"
    return f"{option.slip.words}: ${latex(option.old)}$ should be ${latex(option.new)}$"
