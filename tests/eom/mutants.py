"""All single edits of an equation: signs, factors, transposes, what is dropped or exchanged, frames.

`judge` says what the checker makes of an edit; `tests.eom.oracle` says whether the edit is true.
"""

from collections import Counter
from dataclasses import dataclass, field
from itertools import pairwise

import sympy as sp

from eom.derivations.verification import plain
from eom.errors import InputError
from eom.terms.rules.calculus import BILINEAR
from eom.terms.terms import (
    INDICES,
    Equation,
    Term,
    der,
    entries,
    expr,
    make,
    mul,
    nodes,
    number,
    rebuild,
    transpose,
)
from tests.eom import chapters, oracle
from tests.eom.chapters import judge

SENSELESS = (sp.nan, sp.zoo, sp.oo, sp.I)
POINTS, AXES, ANGLES = ("O", "C", "OI"), ("1", "2", "3"), ("psi", "theta", "phi")
ROLES = {
    "mass": ("particle",),
    "position": ("place", "place"),
    "force": ("particle",),
    "internal_force": ("particle", "particle"),
    "angular_velocity": ("frame", "frame"),
    "unit": ("frame", "axis"),
    "rotation": ("frame", "frame"),
    "angle": ("angle",),
    "vector": ("name",),
    "fixed_vector": ("name", "frame"),
    "first_moment": ("who", "point"),
    "absolute_angular_momentum": ("who", "point"),
    "angular_momentum": ("who", "point"),
    "torque": ("who", "point"),
    "rotational_energy": ("who", "point"),
    "inertia": ("point",),
}
"""What each label of a quantity stands for; labels of others are not edited."""


@dataclass(frozen=True)
class Mutant:
    """An edit: its kind, and the equation, or None where its parts do not fit together."""

    kind: str
    equation: Equation | None


@dataclass(frozen=True)
class Setting:
    """What may stand for a label in one statement."""

    frames: tuple
    indices: tuple
    names: tuple

    def choices(self, role, label):
        if role in {"place", "particle"} and label in INDICES:
            return self.indices
        found = {
            "place": POINTS,
            "point": POINTS,
            "frame": self.frames,
            "axis": AXES,
            "angle": ANGLES,
            "name": self.names,
        }
        return found.get(role, ()) if label != "P" else ()


def setting_of(equation, assumptions):
    parts = [n for side in (equation.left, equation.right) for n in nodes(side)]
    atoms = [n.data for n in parts if n.head == "atom"]
    bound = [n.data[0] for n in parts if n.head == "sum"]
    indices = {label for a in atoms for label in a[1:] if label in INDICES} | set(bound)
    names = {a[1] for a in atoms if a[0] in {"vector", "fixed_vector"}}
    last = {"spin_312": "C", "no_torque_2": "C", "no_torque_3": "C", "viscous_slug": "S"}
    frames = dict.fromkeys(["I", "A", "B", *(last[a] for a in assumptions if a in last)])
    return Setting(tuple(frames), tuple(sorted(indices)), tuple(sorted(names)))


# -- edits of one node -----------------------------------------------------------------------


def _sign(node, _):
    yield lambda: -node


def _factor(node, _):
    yield lambda: mul(number(2), node)


def _transposed(node, _):
    if node.kind == "matrix":
        yield lambda: node.args[0] if node.head == "transpose" else transpose(node)
    if node.head == "entries" and len(node.args) == 9:
        rows = [node.args[k : k + 3] for k in (0, 3, 6)]
        yield lambda: entries(list(zip(*rows, strict=True)))


def _dropped(node, _):
    if node.head in {"add", "mul"}:
        for k in range(len(node.args)):
            rest = (*node.args[:k], *node.args[k + 1 :])
            yield lambda rest=rest: rebuild(node, rest)
    if node.head in BILINEAR | {"der", "transpose", "inverse", "tilde", "column"}:
        for a in node.args:
            yield lambda a=a: a


def _exchanged(node, _):
    if node.head in BILINEAR:
        yield lambda: rebuild(node, node.args[::-1])
    if node.head in {"entries", "rows"}:
        for k in range(len(node.args) - 1):
            args = list(node.args)
            args[k], args[k + 1] = args[k + 1], args[k]
            yield lambda args=args: rebuild(node, args)


def _frames(node, setting):
    if node.head in {"der", "column"} and node.data[0]:
        for frame in setting.frames:
            if frame != node.data[0]:
                yield lambda frame=frame: make(node.head, node.args, (frame,))


def _derivatives(node, setting):
    if node.head == "der":
        yield lambda: der(node, node.data[0] or "I")


def _indices(node, setting):
    if node.head != "atom":
        return
    name, *labels = node.data
    for k, role in enumerate(ROLES.get(name, ())):
        for other in setting.choices(role, labels[k]):
            if other != labels[k]:
                data = (name, *labels[:k], other, *labels[k + 1 :])
                yield lambda data=data: Term("atom", (), data, node.kind)
    if len(labels) == 2 and len(set(ROLES.get(name, "?"))) == 1:
        yield lambda: Term("atom", (), (name, *labels[::-1]), node.kind)


# -- edits of SymPy expressions --------------------------------------------------------------


def _plain(rule):
    def edits(node, _):
        if node.head == "expr":
            for new in dict.fromkeys(_everywhere(node.data[0], rule)):
                if not new.has(*SENSELESS):
                    yield lambda new=new: expr(new)

    return edits


def _everywhere(e, rule):
    """Apply ``rule`` at each place of the tree in turn; limits of integrals count."""
    yield from rule(e)
    if isinstance(e, sp.MatrixBase):
        for k in range(len(e)):
            for new in _everywhere(e[k], rule):
                changed = e.as_mutable()
                changed[k] = new
                yield changed.as_immutable()
        return
    for k, a in enumerate(e.args):
        if isinstance(e, sp.Integral) and k:
            yield from (e.func(*e.args[:k], new, *e.args[k + 1 :]) for new in _bounds(a, rule))
            continue
        for new in _everywhere(a, rule):
            if not (isinstance(e, sp.Derivative) and k and not new[0].is_Symbol):
                yield e.func(*e.args[:k], new, *e.args[k + 1 :])


def _bounds(limits, rule):
    x, low, high = limits
    yield from (sp.Tuple(x, new, high) for new in _everywhere(low, rule))
    yield from (sp.Tuple(x, low, new) for new in _everywhere(high, rule))


def _is_value(e):
    return isinstance(e, sp.Expr) and e != 0


def _plain_sign(e):
    if e.is_Add:
        yield from (e - 2 * a for a in e.args)
    elif _is_value(e) and (e.is_Symbol or isinstance(e, sp.Function)):
        yield -e


def _plain_factor(e):
    if _is_value(e) and (e.is_Mul or e.is_Symbol or e.is_Number):
        yield 2 * e


def _plain_dropped(e):
    if e.is_Add or e.is_Mul:
        yield from (e.func(*e.args[:k], *e.args[k + 1 :]) for k in range(len(e.args)))


def _plain_exchanged(e):
    swapped = {sp.sin: sp.cos, sp.cos: sp.sin}
    if e.func in swapped:
        yield swapped[e.func](*e.args)
    if e.is_Pow and e.exp.is_Integer:
        yield from (e.base ** (e.exp + step) for step in (1, -1))


def _plain_index(node, _):
    """One symbol for another of the same expression, everywhere; x_1 for x_2."""
    if node.head == "expr":
        symbols = sorted(node.data[0].free_symbols, key=str)
        for a, b in pairwise(symbols):
            new = node.data[0].xreplace({a: b})
            if not new.has(*SENSELESS):
                yield lambda new=new: expr(new)


EDITS = (
    ("sign", _sign),
    ("sign", _plain(_plain_sign)),
    ("factor", _factor),
    ("factor", _plain(_plain_factor)),
    ("transpose", _transposed),
    ("dropped", _dropped),
    ("dropped", _plain(_plain_dropped)),
    ("exchanged", _exchanged),
    ("exchanged", _plain(_plain_exchanged)),
    ("frame", _frames),
    ("derivative", _derivatives),
    ("index", _indices),
    ("index", _plain_index),
)
"""Kind of edit, and the rule from a node to what may stand in its place."""


def _built(make_it):
    try:
        return make_it()
    except InputError:
        return None


def _edited(term, rule, setting):
    """Yield ``term`` with one node edited; None where it cannot be built."""
    for edit in rule(term, setting):
        yield _built(edit)
    for k, a in enumerate(term.args):
        for new in _edited(a, rule, setting):
            args = (*term.args[:k], new, *term.args[k + 1 :])
            yield None if new is None else _built(lambda args=args: rebuild(term, args))


def mutants(equation, assumptions):
    """Yield every single edit of both sides, once; definitions are taken as equations."""
    relation = "=" if equation.relation == ":=" else equation.relation
    setting, seen = setting_of(equation, assumptions), set()
    sides = (equation.left, equation.right)
    for kind, rule in EDITS:
        for side in (0, 1):
            for new in _edited(sides[side], rule, setting):
                pair = (new, sides[1]) if side == 0 else (sides[0], new)
                if new is None or new.kind != sides[side].kind:
                    yield Mutant(kind, None)
                elif pair != sides and pair not in seen:
                    seen.add(pair)
                    yield Mutant(kind, Equation(*pair, relation))


def is_naming(d, step):
    """Whether a step gives names to plain symbols: whatever they are called, it is not false."""
    left = step.statement.left
    parts = [n.data[0] for n in nodes(left) if n.head == "expr"]
    known = all(p.free_symbols <= set(d.scalars) for p in parts)
    if step.evidence == "supposed":  # a condition is chosen, and neither true nor false
        return True
    return step.statement.relation == ":=" and left.head in {"expr", "entries"} and not known


def judged_steps(d):
    return [step for step in d.steps if not is_naming(d, step)]


def edits_of(derivations):
    """Yield every edit with its derivation and its step."""
    for d in derivations:
        for step in judged_steps(d):
            for mutant in mutants(step.statement, step.assumptions):
                yield d, step, mutant


def outcome(d, step, mutant):
    """What became of an edit, in words: the truth by numerics, and the checker's verdict."""
    if mutant.equation is None:
        return "ill-formed"
    verdict = judge(d, mutant.equation, step.assumptions)
    if verdict == "ill-formed":
        return verdict
    try:
        truth = chapters.is_true(d, mutant.equation, step.assumptions)
    except oracle.Undefined:
        return "without a value"
    return f"{'true' if truth else 'false'}, {verdict}"


WRONG = {"false, accepted", "true, rejected", "broken"}


@dataclass
class Count:
    """Edits by kind and by what became of them, and those that were judged wrongly."""

    by_kind: dict = field(default_factory=dict)
    wrong: list = field(default_factory=list)

    def add(self, d, step, mutant):
        why = ""
        try:
            found = outcome(d, step, mutant)
        except Exception as error:  # one that breaks is told, and the others are judged
            found, why = "broken", f" ({type(error).__name__}: {error})"
        self.by_kind.setdefault(mutant.kind, Counter())[found] += 1
        if found in WRONG:
            where = f"{found}{why}: {d.name}, {step.label}, {mutant.kind}"
            left, right = (plain(side) for side in (mutant.equation.left, mutant.equation.right))
            self.wrong.append(f"{where}: {left} {mutant.equation.relation} {right}")

    def include(self, other):
        """Add what another has counted."""
        for kind, found in other.by_kind.items():
            self.by_kind.setdefault(kind, Counter()).update(found)
        self.wrong += other.wrong

    @property
    def total(self):
        return sum(self.by_kind.values(), Counter())

    @property
    def really_false(self):
        return sum(n for found, n in self.total.items() if found.startswith("false"))

    @property
    def missed(self):
        """Whether less than 99 % of the false edits are caught, a true one is rejected, or one breaks."""
        accepted = self.total["false, accepted"]
        failed = self.total["true, rejected"] + self.total["broken"]
        return 100 * accepted > self.really_false or failed > 0
