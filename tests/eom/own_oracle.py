"""Whether a line of a derivation of one's own is true, by SymPy's vector package and known motions.

Frames, points and energies are built by `sympy.physics.vector` from what the derivation declares; highest
rates are those of published equations of motion, which the tests give. A line is evaluated to 40 digits at
random states. Nothing of the checker is used.
"""

import random

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.physics.vector import Dyadic, ReferenceFrame, Vector, dynamicsymbols, outer

DIGITS = 40
TRUE, FALSE = 1e-25, 1e-8
POSITIVE, ANY = (400, 1600), (-2500, 2500)
"""Ends of the numbers that are drawn, and where signs are asked for, over 1009."""
DRAWS = 80
t = dynamicsymbols._t


class Mechanics:
    """The symbols, frames and points of a derivation, as SymPy has them; ``motions``: rates by
    name and order."""

    def __init__(self, d, motions):
        self.d, self.frames, self.points = d, {"I": ReferenceFrame("I")}, {"OI": Vector(0)}
        self.symbols, self.numbers = {}, {}
        free = {s: m for s, m in d.scalars.items() if m.head in {"atom", "der"}}
        for s, meaning in free.items():
            self.symbols[s] = self.value(meaning)
        for name, row in d.own.frames.items():
            base, angle = self.frames[row.base], self.expression(sp.sympify(row.angle))
            axis = (base.x, base.y, base.z)[row.axis - 1]
            self.frames[name] = base.orientnew(name, "Axis", [angle, axis])
        for name, place in d.own.points.items():
            self.points[name] = self.value(place)
        for s, meaning in d.scalars.items():
            self.symbols[s] = self.value(meaning)
        self.motions = {
            sp.diff(dynamicsymbols(name), t, order): self.expression(e)
            for (name, order), e in motions.items()
        }

    def expression(self, e):
        return e.xreplace(self.symbols)

    def value(self, term):
        """The value of a term: an expression, a Vector, a Dyadic."""
        return getattr(self, f"_{term.head}")(term)

    def _expr(self, term):
        return self.expression(term.data[0])

    def _zero(self, term):
        return Dyadic(0) if term.kind == "dyadic" else Vector(0)

    def _add(self, term):
        first, *rest = map(self.value, term.args)
        for r in rest:
            first = first + r
        return first

    def _mul(self, term):
        *numbers, last = map(self.value, term.args)
        return sp.Mul(*numbers) * last

    def _dot(self, term):
        a, b = map(self.value, term.args)
        return a.dot(b)

    def _cross(self, term):
        a, b = map(self.value, term.args)
        return a.cross(b)

    def _outer(self, term):
        a, b = map(self.value, term.args)
        return outer(a, b)

    def _der(self, term):
        value = self.value(term.args[0])
        frame = self.frame(term.data[0] or "I")
        return value.dt(frame) if isinstance(value, Vector | Dyadic) else sp.diff(value, t)

    def _column(self, term):
        return self.value(term.args[0]).to_matrix(self.frame(term.data[0]))

    def _entries(self, term):
        return sp.Matrix(3, len(term.args) // 3, [self.value(a) for a in term.args])

    def _partial(self, term):
        """The slope by a variable; another function that is a momentum is a variable by itself."""
        by = term.args[1].data[0]
        meaning = self.d.scalars[by]
        if meaning.head == "partial":
            plain = term.args[0].data[0]
            spelt = {s: m.data[0] for s, m in self.d.scalars.items() if m.head == "expr"}
            return self.expression(plain.xreplace(spelt).diff(by))
        spelt = self._spelt(term.args[0])
        if spelt is not None:
            return self.expression(spelt.diff(by))
        value, variable = self.value(term.args[0]), self.symbols[by]
        if isinstance(value, Vector):
            return value.diff(variable, self.frames["I"], var_in_dcm=True)
        return sp.sympify(value).diff(variable)

    def _spelt(self, term):
        """An expression by coordinates, rates and momenta, each a variable; None where vectors are."""
        known = {s: m for s, m in self.d.scalars.items() if m.head == "expr"}
        e = term.data[0] if term.head == "expr" else sp.Integer(0)
        while e.free_symbols & known.keys():
            e = e.xreplace({s: m.data[0] for s, m in known.items()})
        momenta = {s for s, m in self.d.scalars.items() if m.head == "partial"}
        return e if e.free_symbols & momenta else None

    def _start(self, term):
        """The value at the start: of each symbol that with the index 0."""
        e = term.args[0].data[0]
        changing = {s for s, m in self.d.scalars.items() if m.data[:1] == ("coordinate",)}
        return e.xreplace({s: sp.Symbol(f"{s}_0", real=True) for s in e.free_symbols & changing})

    def _atom(self, term):
        return getattr(self, f"_the_{term.data[0]}")(*term.data[1:])

    def _the_scalar(self, name):
        return sp.Symbol(name, real=True)

    def _the_coordinate(self, name):
        return dynamicsymbols(name)

    def _the_gravity_parameter(self):
        return sp.Symbol("any mu", real=True)

    def _the_orbit_radius(self):
        return sp.Symbol("any R", real=True)

    def _the_unit(self, frame, axis):
        f = self.frame(frame)
        return (f.x, f.y, f.z)[int(axis) - 1]

    def _the_position(self, point, origin):
        return self.point(point) - self.point(origin)

    def _the_angular_velocity(self, frame, base):
        return self.frame(frame).ang_vel_in(self.frame(base))

    def frame(self, name):
        """A frame; one that nobody defined turns in any way."""
        if name not in self.frames:
            angles = dynamicsymbols(f"{name}_1:4")
            self.frames[name] = self.frames["I"].orientnew(name, "Body", angles, "313")
        return self.frames[name]

    def point(self, name):
        """A point; one that nobody defined moves in any way."""
        if name not in self.points:
            i, parts = self.frames["I"], dynamicsymbols(f"r_{name}_1:4")
            self.points[name] = parts[0] * i.x + parts[1] * i.y + parts[2] * i.z
        return self.points[name]

    def _the_mass(self, who):
        return self.value(self.d.own.bodies[who].mass)

    def _the_linear_momentum(self, who):
        return self._the_mass(who) * self.points[who].dt(self.frames["I"])

    def _the_inertia(self, who):
        body, axes = self.d.own.bodies[who], self.frames[self.d.own.bodies[who].frame]
        moments = map(self.value, body.moments)
        return sum((J * outer(e, e) for J, e in zip(moments, axes, strict=True)), Dyadic(0))

    def _spin(self, who):
        body = self.d.own.bodies[who]
        omega = self._the_angular_velocity(body.frame, "I") if body.frame else Vector(0)
        return omega, self._the_inertia(who).dot(omega) if body.frame else Vector(0)

    def _the_angular_momentum(self, who, about):
        arm = self._the_position(who, about)
        return arm.cross(self._the_mass(who) * arm.dt(self.frames["I"])) + self._spin(who)[1]

    def _the_kinetic_energy(self, who):
        v, (omega, spin) = self.points[who].dt(self.frames["I"]), self._spin(who)
        return self._the_mass(who) * v.dot(v) / 2 + omega.dot(spin) / 2

    def at(self, e, seed):
        """The value of an expression at a random state, where motions are those that are known."""
        parts = e.atoms(sp.Derivative, AppliedUndef) | (e.free_symbols - {t})
        return e.xreplace({part: self.number(part, seed) for part in parts}).evalf(DIGITS)

    def number(self, what, seed):
        """A number for a symbol, a function or a rate: the same in every line."""
        key = (what, seed)
        if key not in self.numbers:
            known = self._known(what)
            ends = ANY if isinstance(seed, tuple) else POSITIVE
            drawn = sp.Rational(random.Random(f"{what} {seed}").randint(*ends), 1009)
            self.numbers[key] = drawn.evalf(2 * DIGITS) if known is None else self.at(known, seed)
        return self.numbers[key]

    def _known(self, what):
        """What a function or a rate is by a known motion, or by rates of one of less order."""
        if what.is_Symbol or what in self.motions:
            return self.motions.get(what)
        if not isinstance(what, sp.Derivative):
            return None
        below = what.expr.diff(t, what.derivative_count - 1)
        found = self._known(below)
        if found is not None:
            found = self.motions[what] = sp.diff(found, t).doit()
        return found

    def is_never_negative(self, equation):
        """Whether the left side is not below the right one at any random state with a real value.

        None where there is no such state.
        """
        e, found = sp.sympify(self.value(equation.left) - self.value(equation.right)).doit(), []
        for seed in range(DRAWS):
            value = self.at(e, ("sign", seed))
            if value.is_Float or value.is_Rational:
                found.append(value >= -FALSE)
            if found and not found[-1]:
                return False
        return True if found else None

    def is_true(self, equation):
        """Whether both sides agree at two random states; nothing may lie between true and false."""
        left, right = self.value(equation.left), self.value(equation.right)
        rest = left - right
        frame = self.frames["I"]
        if isinstance(rest, Vector | Dyadic):
            rest = rest.to_matrix(frame)
        parts = list(rest) if isinstance(rest, sp.MatrixBase) else [rest]
        for e in parts:
            apart = max(abs(self.at(sp.sympify(e).doit(), seed)) for seed in (1, 2))
            assert apart < TRUE or apart > FALSE, equation
            if apart > FALSE:
                return False
        return True
