"""Whether a line is true of particles whose places are functions of coordinates, by 60-digit numerics.

Places are sums of sines of the coordinates and of time; a slope is a quotient of the differences between
two motions in which one coordinate is moved a little, all else being as it was. Nothing of the checker is
used.
"""

from decimal import Decimal, DecimalException, localcontext
from functools import lru_cache

import numpy as np

from eom.terms.terms import nodes
from tests.eom import oracle
from tests.eom.oracle import SIN, Random, Undefined, Values

LITTLE = Decimal("1e-20")
"""By how much a coordinate is moved: the square is far below what is called true."""
TIMES = oracle.times()
FORCES = {"force", "internal_force", "constraint_force", "applied_force"}


class Configured(Values):
    """Values of terms where places are functions of the coordinates that a derivation has named.

    ``moved``: how much is added to coordinates, by name; ``at_rest``: the motion without it, whose forces
    are those of this one, as forces are functions of no coordinate.
    """

    def __init__(self, d, assumed, seed, moved=None, at_rest=None):
        self.d, self.assumed, self.seed, self.moved = d, assumed, seed, moved or {}
        scene = oracle.scene_of(assumed, seed, self._place)
        super().__init__(scene, d.scalars)
        self.ground = at_rest or self
        if at_rest is not None:
            scene.forces, scene.internal = at_rest.scene.forces, at_rest.scene.internal

    def coordinate(self, name):
        moved = self.moved.get(name, Decimal(0))
        return Random(self.seed, "coordinate", name).smooth() + moved

    def _waves(self, coordinates, *name):
        """A smooth function of coordinates, and of time."""
        rnd = Random(self.seed, *name)
        whole = rnd.either() + rnd.either() * TIMES
        for _ in range(3):
            inside = rnd.either() * TIMES + rnd.either()
            for q in coordinates:
                inside = inside + rnd.either() * self.coordinate(q)
            whole = whole + rnd.either() * SIN(inside)
        return whole

    def _place(self, n):
        parts = [self._waves(self.d.own.configured, "place", n, axis) for axis in range(3)]
        return np.array(parts)

    def varied(self, rule, name, power=0):
        """The quotient of differences of what a rule says of two motions.

        In them a coordinate is moved by a little times a power of time.
        """
        if self.moved:
            raise Undefined("a slope of a slope")
        ends = [rule(self._beside(name, power, sign)) for sign in (1, -1)]
        return (ends[0] - ends[1]) / (2 * LITTLE)

    def _beside(self, name, power, sign):
        key = ("beside", name, power, sign)
        if key not in self.memo:
            moved = {name: sign * LITTLE * (TIMES if power else Decimal(1))}
            self.memo[key] = Configured(self.d, self.assumed, self.seed, moved, self)
        return self.memo[key]

    def _partial(self, term, env):
        """The slope by a coordinate, or by its rate: what is moved grows with time, and less the former."""
        inside, by = term.args
        if any(n.data[0] in FORCES for n in nodes(inside) if n.head == "atom"):
            raise Undefined("a slope of a force")
        name, order = self._variable(by)
        at_once = self.varied(lambda v: v.of(inside, env), name)
        if order == 0:
            return at_once
        return self.varied(lambda v: v.of(inside, env), name, 1) - TIMES * at_once

    def _variable(self, by):
        meaning = self.scalars.get(by.data[0], by) if by.head == "expr" else by
        if meaning.head == "der":
            name, order = self._variable(meaning.args[0])
            if order == 0:
                return name, 1
        elif meaning.data[:1] == ("coordinate",):
            return meaning.data[1], 0
        raise Undefined("no coordinate and no first rate")

    def _atom(self, term, env):
        name, *labels = term.data
        rule = {
            "coordinate": self.coordinate,
            "function": self._function,
            "constraint_force": self._constraint,
            "applied_force": self._applied,
        }.get(name)
        if rule is None:
            return super()._atom(term, env)
        return rule(*(0 if label == "P" else env.get(label, label) for label in labels))

    def _function(self, name, *variables):
        """Any function of coordinates, or a slope of it, by its name and strokes."""
        whole, *by = name.split("|")
        if by:
            rest, along = "|".join((whole, *by[1:])), by[0].split()[1]
            return self.varied(lambda v: v._function(rest, *variables), along)
        return self._waves([v.split()[1] for v in variables], "function", whole)

    def _constraint(self, i):
        """Any forces, less what would do work along a coordinate at one instant."""
        ground = self.ground
        if "constraints" not in ground.memo:
            count = range(len(ground.scene.masses))
            drawn = np.array([Random(self.seed, "held", n).path() for n in count])
            names = self.d.own.configured
            slopes = [ground.varied(lambda v: np.array(v.scene.places), q) for q in names]
            ground.memo["constraints"] = _without(drawn, slopes)
        return ground.memo["constraints"][i]

    def _applied(self, i):
        scene = self.ground.scene
        return scene.forces[i] + sum(scene.internal[i]) - self._constraint(i)


def _work(a, b):
    return (a * b).sum(axis=(0, 1))


def _without(drawn, slopes):
    """Forces that do no work along any of the slopes: those before are made orthogonal first."""
    kept = []
    for slope in slopes:
        apart = slope
        for other in kept:
            apart = apart - _work(apart, other) / _work(other, other) * other
        kept.append(apart)
        drawn = drawn - _work(drawn, apart) / _work(apart, apart) * apart
    return drawn


@lru_cache(maxsize=16)
def _values(held, assumed, seed):
    return Configured(held, assumed, seed)


def is_true(held, equation, assumptions, seeds=(0, 1)):
    """Whether a line holds in all motions; ``held``: the derivation, as a key. Raises `Undefined`."""
    for seed in seeds:
        try:
            with localcontext(prec=oracle.DIGITS):
                found = oracle.apart(equation, _values(held, frozenset(assumptions), seed))
        except (DecimalException, ZeroDivisionError) as error:
            raise Undefined from error
        if found > oracle.FALSE:
            return False
        if found > oracle.TRUE:
            raise Undefined(found)
    return True
