r"""What letters stand for by the customs of the field: c_{12}, a speed v_2, two energies.

A custom says what is meant, not what is true: where a line then follows, it does so from the lines that
give the letters.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

import sympy as sp

from eom.checker.consequence.jets import (
    MAY,
    Equal,
    Expr,
    Letter,
    derived,
    jet,
    lettered,
    partial,
    timed,
)
from eom.checker.consequence.rules import Rule, Rules

LAGRANGIANS = ("L", "cal L", "calligraphic L", "script L")
KINETIC = ("T", "K", "E_kin", "E_k", "E_K", "T_kin", "E_c", "W_kin")
POTENTIAL = ("V", "U", "P", "E_pot", "E_p", "E_P", "V_pot", "W_pot", "Pi")
LAW, SPEED, SHORTHAND = -1, -2, -3
CUSTOMS = {
    LAW: "the energies or the Lagrangian are all that acts",
    SPEED: "a speed is that of the coordinates with its label",
    SHORTHAND: "shorthands go on by their pattern",
}
"""What is taken for granted, by numbers that stand beside those of formulas, with words for it."""
_NUMBERED = re.compile(r"(.+_)(\d+|[ijk])")


def meant(rules: Rules, q: Equal) -> Iterator[Rule]:
    """Yield what letters of an equation stand for that no line gives."""
    unknown = [k for k in lettered(q.letters).values() if k.name not in rules.known]
    shorthands = dict(_shorthands(rules.known.values())) if unknown else {}
    for known in unknown:
        label = _NUMBERED.fullmatch(known.name)
        if label and label[1] in shorthands:
            yield _alike(shorthands[label[1]], known.name, label[2])
        elif known.name[0] == "v" and known.kind == MAY:
            yield from _speed(rules, known)


def _shorthands(rules: Iterable[Rule]) -> Iterator[tuple[str, Rule]]:
    r"""Yield sines and cosines that are named by the labels of their angles: c_1 = \cos q_1."""
    for rule in rules:
        own = _NUMBERED.fullmatch(rule.name)
        if own and isinstance(rule.value, sp.sin | sp.cos):
            angles = lettered(rule.value.free_symbols).values()
            labels = [_NUMBERED.fullmatch(k.name) for k in angles]
            if labels and {a[2] if a else "" for a in labels} == set(own[2]):
                yield own[1], rule


def _alike(like: Rule, name: str, label: str) -> Rule:
    """Return what a letter is by the pattern of another, of the sum of the angles of its label."""
    angle = next(iter(lettered(like.value.free_symbols).values()))
    base = angle.name.rpartition("_")[0]
    terms = [jet(f"{base}_{n}", 0, angle.kind) for n in label]
    return Rule(name, 0, like.value.func(sp.Add(*terms)), like.sources | {SHORTHAND})


def _speed(rules: Rules, known: Letter) -> Iterator[Rule]:
    """Yield that v_2 is the speed of what has the coordinates x_2, y_2."""
    names = [n + known.name[1:] for n in "xyz" if n + known.name[1:] in rules.known]
    if len(names) > 1:
        rates = [jet(n, 1) for n in names]
        sources = frozenset[int]().union(*(rules.normal(r)[1] for r in rates))
        squares = sp.Add(*(r**2 for r in rates))
        yield Rule(known.name, 0, sp.sqrt(squares), sources | {SPEED}, squared=True)


def is_moving(rule: Rule) -> bool:
    """Return whether rates stand in what a letter is."""
    return any(k.order for k in lettered(rule.value.free_symbols).values())


def energies(rules: Rules, letters: Iterable[Expr]) -> Expr | None:
    """Return the kinetic less the potential energy, where lines give both."""
    kinetic = next((r for n in KINETIC if (r := rules.known.get(n)) and is_moving(r)), None)
    potential = next((r for n in POTENTIAL if (r := rules.known.get(n))), None)
    if kinetic is None or potential is None:
        return None
    of = {known.name: derived(s, 0) for s, known in lettered(letters).items()}
    return of[kinetic.name] - of[potential.name]


def lagrange(rules: Rules, function: Expr) -> Iterator[Equal]:
    """Yield Lagrange's equations without forces. Raises `InputError`."""
    full, _ = rules.normal(function)
    moving = {k.name for k in lettered(full.free_symbols).values() if k.order == 1}
    for name in sorted(moving):
        q, v = jet(name), jet(name, 1)
        yield Equal(timed(partial(function, v)), partial(function, q))
