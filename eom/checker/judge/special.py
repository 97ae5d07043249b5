"""Special cases that a note can mean, and those that only excuse a slip.

Of assumptions that are special (`eom.worlds.worlds.ASSUMPTIONS`, restrictions of a system) a rest, an
absent load, a constant rate is a kind of motion that a line may mean, unless the words around it say that
the motion is any. Not so that two points, frames or moments coincide: who gives them names apart does not
mean that they are the same, unless the note says so. Whether a note names them apart is looked up in all
that it writes. Parameters of a system are apart by that.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations_with_replacement, islice, permutations

import sympy as sp

from eom.checker.judge.coordinates import equations, on_solutions
from eom.checker.judge.judge import Judgement, models_of
from eom.checker.judge.members import Members
from eom.checker.judge.models import ENOUGH, Search, terms_of
from eom.checker.judge.systems import SPEEDS, TRIES, Solutions, unrated
from eom.checker.judge.worlds import Worlds, filled
from eom.checker.mean.claims import CONSTANT, Claim
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.model import Model, printed
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import Formula
from eom.checker.read.symbol_shape import seen
from eom.checker.read.syntax import Node, Number
from eom.checker.read.writing import latex_of
from eom.errors import InputError
from eom.fields import RESIDUES, Singular
from eom.limits import Overdue
from eom.system import Expr, System
from eom.terms.terms import Term, add, nodes
from eom.typeset.markup import symbol_latex
from eom.worlds.solutions import Restriction, rate, real_point, without_rates
from eom.worlds.worlds import ANGLES, ASSUMPTIONS, MOMENT

_FRAMED = frozenset({"unit", "angular_velocity", "rotation", "eigenvectors", *ANGLES})
"""Quantities whose labels are frames."""


Name = tuple[str, str]
"""A quantity, and a label that it has: a point, "frame" and a frame, "moment" and an axis."""


def named(claims: Iterable[Claim]) -> frozenset[Name]:
    """Return what claims name, and by which quantities."""
    return frozenset(
        n for c in claims for t in terms_of(c) for node in nodes(t) for n in _names(node)
    )


def _names(node: Term) -> Iterator[Name]:
    if node.head == "atom":
        kind, *labels = map(str, node.data)
        yield from ((kind, "frame " * (kind in _FRAMED) + label) for label in labels)
    elif node.head == "sum":
        yield from (("sum", str(over)) for over in node.data[1:])
    elif node.head == "dot" and node.args[1].head == "dot":
        axis, (inertia, other) = node.args[0], node.args[1].args
        if axis == other and axis.data[:1] == ("unit",) and inertia.data[:1] == ("inertia",):
            yield MOMENT, MOMENT + str(axis.data[2])


def coincides(name: str, claim: Claim, names: frozenset[Name]) -> bool:
    """Return whether an assumption makes one of what a note names apart: by one kind of quantity.

    ``names``: see `named`.
    """
    if claim.model is not None and on_solutions(claim):
        found = (r for r in _possible(claim) if r.name == name)
        return any(_equates(r, claim.model) and not _said(r, claim.model, names) for r in found)
    first, *others = ASSUMPTIONS[name].joins or ("",)
    kinds = {kind for kind, label in names if label == first}
    return any(all((kind, label) in names for label in others) for kind in kinds)


def _possible(claim: Claim) -> Iterable[Restriction]:
    """Return what may be assumed of the system of a claim."""
    models = models_of(claim)
    own = models.possible.values() if isinstance(models, Members) else ()
    return (*own, *(claim.model.possible if claim.model is not None else ()))


def zeros(formulas: Iterable[Formula]) -> frozenset[Name]:
    """Return the letters that formulas say are zero, as LaTeX."""
    found = (s.members for f in formulas for s in f.statements if len(s.members) == 2)
    pairs = (pair for a, b in found for pair in ((a, b), (b, a)))
    letters = (_letter_in(a) for a, b in pairs if isinstance(b, Number) and b.text == "0")
    return frozenset((ZERO, letter) for letter in letters if letter)


ZERO = "zero"


def _letter_in(node: Node) -> str:
    """Return the letter that a formula is, "" for any other."""
    found = seen(node)
    return latex_of(found.look) if found is not None and not (found.raised or found.dots) else ""


def _said(found: Restriction, model: Model, names: frozenset[Name]) -> bool:
    """Return whether a note says somewhere that what is restricted is zero."""
    quantities = ((n, q) for n, q in model.quantities.items() if q.symbol in found.zero)
    spelt = [
        symbol_latex(model.letters[n]) if n in model.letters else printed(q) for n, q in quantities
    ]
    return bool(spelt) and all((ZERO, _letter_in(read_formula(t).tree)) in names for t in spelt)


def _equates(found: Restriction, model: Model) -> bool:
    """Return whether parameters of a system become equal that are not so anyway, or one of them zero."""
    given = [set(pair) for r in model.given for pair in r.equal]
    fixed = {q.symbol for q in model.system.parameters} - model.starting.keys()
    if found.symbols <= model.starting.keys():
        return False
    return any({*pair} not in given for pair in found.equal) or bool(fixed & {*found.zero})


def moves(name: str, claim: Claim) -> bool:
    """Return whether an assumption makes a motion a special one: something rests, is steady or turns so."""
    if claim.model is not None and on_solutions(claim):
        return any(r.held or r.rest for r in claim.model.possible if r.name == name)
    return name in STEADY


STEADY = frozenset(
    "O_fixed_in_space OA_fixed_in_space OB_fixed_in_space O_uniform C_at_rest fixed_axis steady_turn "
    "steady_rotors A_fixed_in_body".split()
)
"""Assumptions on how a point, a frame or a rotor moves."""


def says(claim: Claim) -> frozenset[str]:
    """Return the restrictions of its system that a claim says in as many words."""
    if claim.model is None or not on_solutions(claim):
        return frozenset()
    try:
        pairs = [frozenset(p) for p in equations(claim, claim.model)]
    except InputError:
        return frozenset()
    return frozenset(
        r.name
        for r in claim.model.possible
        if any(frozenset(p) in pairs for p in (*r.equal, *((s, 0) for s in r.zero)))
    )


def excused(
    found: Judgement, claim: Claim, names: frozenset[Name], stated: frozenset[str], anyhow: bool
) -> tuple[str, ...]:
    """Return the coincidences by which alone a claim holds that a note has not ``stated``.

    Those of the set that has the fewest of them; none where a set does without. ``anyhow``: whether the
    note speaks of any motion here, so that special ones count as well; so they do where a line says what
    is constant in the motions of a system.
    """
    anyhow = anyhow or (claim.kind == CONSTANT and on_solutions(claim))
    unsaid = [
        tuple(
            n
            for n in s
            if n not in stated and (coincides(n, claim, names) or (anyhow and moves(n, claim)))
        )
        for s in found.sets
    ]
    return min(unsaid, key=len, default=())


def in_letters(name: str, claim: Claim, lexicon: Lexicon) -> str:
    """Return a coincidence in the symbols of the note, "$I_1 = I_2$" or "$P = B^*$", else in words."""
    if claim.model is not None and on_solutions(claim):
        first, equals, second = name.partition(" = ")
        if not equals:
            return name
        return f"${claim.model.letter(first)} = {claim.model.letter(second)}$"
    joins = ASSUMPTIONS[name].joins
    letters = [_letter(j, lexicon) for j in joins]
    return f"${' = '.join(letters)}$" if all(letters) and letters else ASSUMPTIONS[name].meaning


def _letter(what: str, lexicon: Lexicon) -> str:
    """Return how a note writes a point, a frame or a moment of inertia, "" where that is not known."""
    if what.startswith(MOMENT):
        axis = what.removeprefix(MOMENT)
        moments = (e for layer in lexicon.layers for e in layer if e.meaning.quantity == "inertia")
        rows = ((e, e.meaning.component) for e in moments)
        found = (e.latex for e, c in rows if len(c) > 1 and {*c} <= {axis, "<k>"})
        plain = (t.replace("{<k>}", axis).replace("<k>", axis) for t in found if "<P>" not in t)
        return next(plain, "")
    frame = what.startswith("frame ")
    names = lexicon.frames if frame else lexicon.points
    own = ["".join(given) for given, name in names.items() if name == what.removeprefix("frame ")]
    return min(own[::-1], key=lambda t: not t[:1].isupper(), default="").replace("^ast", "^*")


# -- the lowest condition ------------------------------------------------------------------------------

POSITIVE = frozenset({"kg", "m", "kg m^2", "N/m", "s", "m/s^2", "N m/rad"})
"""Units of parameters that are never zero."""
STIFF = frozenset({"inertia", "mass", "total_mass", "position", "scalar", "unit", "identity"})
"""Quantities whose components alone are no motion that may vanish."""
USUAL = ("newton_2", "third_law_strong", "body_frame", "principal_axes", "principal_at_O")
"""What is assumed beyond what is given where a condition of a line in worlds is looked for."""
MAX_DEGREE = 3
"""Factors of what a line in worlds leaves over."""
MAX_LETTERS = 9
MAX_RATIO = 12


def condition(claim: Claim, given: Sequence[str] = ()) -> str:
    """Return the lowest condition on its own quantities under which a wrong claim holds, "" for none."""
    try:
        if on_solutions(claim):
            return _on_system(Solutions(claim, claim.scalars, tuple(given)))
        general = claim.parameters is None and claim.moving is None
        return _in_worlds(claim, given) if general else ""
    except (InputError, Singular, Overdue):
        return ""


def _on_system(models: Solutions) -> str:
    """Return a factor that may vanish of what a line leaves over on the solutions of its system."""
    left = models.leaves()
    if left is None:
        return ""
    model = models.model
    above = sp.fraction(sp.together(left))[0]
    sides = [model.system.expand(without_rates(model.system, s)) for p in models.said for s in p]
    found = [
        c
        for f, _ in sp.factor_list(above)[1]
        for c in _vanishing(f, model)
        if any(s.subs(*c) != 0 for s in sides)
    ]
    letters = {
        q.symbol: sp.Symbol(model.letters.get(n, printed(q))) for n, q in model.quantities.items()
    }
    angles = {q.symbol for q in model.system.states if q.unit == "rad"}

    def rank(sides: tuple[Expr, Expr]) -> tuple[bool, bool, int, int]:
        free = sides[0].free_symbols | sides[1].free_symbols
        size = sum(int(s.count_ops()) for s in sides)
        return sides[0] in angles, bool(free & angles), len(free), size

    least = min(found, key=rank, default=None)
    return "" if least is None else f"${_equated(*(e.xreplace(letters) for e in least))}$"


def _vanishing(factor: Expr, model: Model) -> Iterator[tuple[Expr, Expr]]:
    """Yield what has to be equal so that a factor vanishes while no term of it does by itself."""
    still = {q.symbol: q.unit for q in model.system.parameters}
    angles = {q.symbol for q in model.system.states if q.unit == "rad"}
    plain = factor.xreplace({f: sp.Dummy() for f in factor.atoms(sp.sin, sp.cos)})
    turned = factor.free_symbols <= angles and not plain.free_symbols & angles
    if factor.is_Symbol and still.get(factor, "") not in POSITIVE:
        yield factor, sp.Integer(0)
    elif isinstance(factor, sp.sin | sp.cos) and factor.args[0].is_Symbol:
        yield factor.args[0], sp.Integer(0) if isinstance(factor, sp.sin) else sp.pi / 2
    elif factor.is_Add and (factor.free_symbols <= still.keys() or turned):
        terms = sp.Add.make_args(factor)
        minus = [t for t in terms if t.could_extract_minus_sign()]
        if 0 < len(minus) < len(terms):
            yield sp.Add(*(t for t in terms if t not in minus)), -sp.Add(*minus)


def _equated(left: Expr, right: Expr) -> str:
    return " = ".join(sp.latex(side) for side in sorted((left, right), key=lambda s: s.is_number))


def _in_worlds(claim: Claim, given: Sequence[str]) -> str:
    """Return a letter that vanishes with what a line between components leaves over in all worlds."""
    (said, *more) = Worlds(claim, claim.scalars).said
    letters = sorted(claim.scalars, key=str)
    if more or said.left.kind != "scalar" or not 0 < len(letters) <= MAX_LETTERS:
        return ""
    models = Worlds(claim, claim.scalars, tuple(given))
    points = list(islice(models.draw(filled(Search(models).base[1], USUAL)), ENOUGH))
    wanted = [p.scalar(add(said.left, -said.right)) for p in points]
    values = {s: [p.scalar(claim.scalars[s]) for p in points] for s in letters}
    for degree in range(1, MAX_DEGREE + 1):
        for chosen in combinations_with_replacement(letters, degree):
            if _is_multiple(wanted, [values[s] for s in chosen]):
                free = [s for s in dict.fromkeys(chosen) if _moves(claim.scalars[s])]
                return f"${sp.latex(free[0])} = 0$" if free else ""
    return ""


def _is_multiple(wanted: Sequence[int | None], factors: Sequence[Sequence[int | None]]) -> bool:
    """Return whether numbers are a product times one small fraction."""
    found = set()
    for n, value in enumerate(wanted):
        product = 1
        for f in factors:
            product = product * (f[n] or 0) % RESIDUES.prime
        if not value or not product:
            return False
        found.add(RESIDUES.reduce(value * RESIDUES.inverse(product)))
    small = RESIDUES.fraction(found.pop(), MAX_RATIO) if len(found) == 1 else None
    return small is not None


def _moves(term: Term) -> bool:
    """Return whether a letter stands for a motion or a load, which may vanish."""
    return any(n.head == "atom" and n.data[0] not in STIFF for n in nodes(term))


# -- where conditions hold ------------------------------------------------------------------------------


def at_conditions(claim: Claim, conditions: Iterable[Claim]) -> bool | None:
    """Return whether a claim holds where quantities of its system have values; None where that is open.

    It may do so for an instant, or, where a quantity keeps its value, in such motions.
    """
    models = Solutions(claim, claim.scalars)
    system = models.model.system
    if system.mass_matrix is not None:
        return None
    own = {q.symbol for q in (*system.states, *system.inputs, *system.parameters)}
    values: dict[Expr, Expr] = {}
    for left, right in (p for c in conditions for p in Solutions(c, c.scalars).said):
        pair = (unrated(system, e).xreplace(values) for e in (left, right))
        found = next(((a, b) for a, b in permutations(pair) if a in own and not b.has(a)), None)
        if found is None:
            return None
        values = {s: e.xreplace(dict([found])) for s, e in values.items()} | dict([found])
    apart = [unrated(system, a - b).xreplace(values) for a, b in models.said]
    fixed = [q.symbol for q in system.states if q.symbol in values]
    if not values or any(e.has(sp.zoo, sp.nan) for e in apart):
        return None
    here = _vanish(models, apart)
    kept = None if here is not False else _kept(system, apart, values, fixed)
    return here if kept is None else _vanish(models, kept)


def _kept(
    system: System, apart: Sequence[Expr], values: dict[Expr, Expr], fixed: Iterable[Expr]
) -> list[Expr] | None:
    """Return what is to be zero in motions in which states keep their values; None where there are none.

    What keeps them is solved for a speed, which may be zero, or for any other quantity, which may not.
    """
    found, speeds = list(apart), {q.symbol for q in system.states if q.unit in SPEEDS}
    for e in (e for state in fixed for e in (rate(state), rate(rate(state)))):
        zero = sp.numer(sp.together(unrated(system, e).xreplace(values)))
        if zero == 0:
            continue
        linear = (s for s in sorted(zero.free_symbols, key=str) if sp.diff(zero, s, 2) == 0)
        symbol = next(linear, None)
        value = None if symbol is None else sp.cancel(symbol - zero / sp.diff(zero, symbol))
        if value is None or (value == 0 and symbol not in speeds):
            return None
        values = {s: v.xreplace({symbol: value}) for s, v in values.items()} | {symbol: value}
        found = [f.xreplace({symbol: value}) for f in found]
    return found


def _vanish(models: Solutions, expressions: Sequence[Expr]) -> bool | None:
    """Return whether expressions without rates are zero at real points; None where they have no value."""
    system, found = models.model.system, list[bool]()
    equal = {b: a for r in models.held for a, b in r.equal} | {
        s: sp.S.Zero for r in models.held for s in r.zero
    }
    for seed in range(TRIES):
        point = real_point(system, seed)
        values = [e.xreplace(equal).xreplace(point).evalf(DIGITS) for e in expressions]
        if all(v.is_number and v.is_real for v in values):
            found.append(all(abs(v) < _NOTHING for v in values))
        if len(found) == ENOUGH:
            return all(found)
    return None


DIGITS, _NOTHING = 50, sp.Float(10) ** -30
