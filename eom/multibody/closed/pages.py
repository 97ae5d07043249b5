"""Pages of closed forms: one method with its steps, or several side by side, term by term.

What each method shows of its way: stages with a reason and lines (left side, value).

A value is an expression, or three of them: components in the axes that the reason names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.derivations.derived import FORMATS
from eom.errors import typed, unknown_name
from eom.multibody.algebra.scalars import is_zero
from eom.multibody.closed.forms import (
    EQUATIONS,
    METHODS,
    ClosedForm,
    Comparison,
    Term,
    closed_form,
    compare,
)
from eom.multibody.closed.lagrange import Kane, Lagrange, NewtonEuler
from eom.multibody.closed.mechanism import dotted
from eom.multibody.closed.polynomials import Monomial, Polynomial, Scalar, terms_of
from eom.multibody.closed.readable import KINDS, content
from eom.multibody.model.model import Tree
from eom.typeset.blocks import (
    EQUALS,
    Block,
    Bullets,
    Cell,
    Display,
    Heading,
    Line,
    Note,
    Paragraph,
    Steps,
    Table,
    broken,
    shown,
)
from eom.typeset.boxes import (
    Box,
    Fence,
    Formula,
    Fraction,
    Grid,
    Operator,
    Row,
    Scripts,
    Symbol,
    Words,
    row,
    symbol,
)
from eom.typeset.markup import render
from eom.typeset.writing import expression_pieces, in_decimals

Expr = Any


class Names(dict[Expr, Expr]):
    """How symbols are shown, and whether numbers are shown as decimals."""

    decimals = False

    def of(self, value: Expr) -> Expr:
        """Return an expression, or a matrix, as it is shown."""
        found = value.xreplace(self)
        return in_decimals(found) if self.decimals else found


@shown.register(ClosedForm)
@shown.register(Comparison)
def show(given: ClosedForm | Comparison, style: str = "text") -> str:
    """Return a page in a format of `eom.derivations.derived.FORMATS`. Raises `InputError` for others."""
    if style == EQUATIONS and isinstance(given, ClosedForm):
        return equations_latex(given)
    if style not in FORMATS:
        raise unknown_name("format", style, FORMATS)
    return FORMATS[style](list(blocks(given)))


@typed
def tree_page(
    tree: Tree,
    method: str = "all",
    style: str = "text",
    *,
    coordinates: Mapping[Expr, Expr] | None = None,
) -> str:
    """Return the page of a tree by one of `METHODS`, or by all of them side by side.

    ``method``: a row of `METHODS`, or ``all``. ``style``: a format of `eom.derivations.derived.FORMATS`:
    text, latex, markdown or html. ``coordinates``: as of `closed_form`, as are units, frames, signs and
    sources. Raises `InputError` for unknown methods and formats, else as `compare`.

    >>> from eom.multibody import Body, Joint
    >>> hinge = Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> pendulum = Tree("pendulum", (Body("bob", 2, (0, 0, -1)),), (hinge,), gravity=(0, 0, -10))
    >>> tree_page(pendulum, "kane", "markdown").splitlines()[0]
    '# pendulum by Kane'
    """
    if style not in FORMATS:
        raise unknown_name("format", style, FORMATS)
    if method == "all":
        return show(compare(tree, coordinates=coordinates), style)
    if method not in METHODS:
        raise unknown_name("method", method, [*METHODS, "all"], f"tree {tree.name!r}")
    return show(closed_form(tree, method, coordinates=coordinates), style)


def blocks(given: ClosedForm | Comparison) -> Iterator[Block]:
    """Yield what there is to show, in reading order."""
    forms = given.forms if isinstance(given, Comparison) else (given,)
    titles = " | ".join(METHODS[f.method][0] for f in forms)
    name = given.forms[0].tree.name if isinstance(given, Comparison) else given.tree.name
    yield Heading(f"{name.replace('_', ' ')} by {titles}", 1)
    yield from _variables(forms[0])
    for form in forms:
        yield Heading(METHODS[form.method][0] if len(forms) > 1 else "Derivation")
        yield from _derivation(form)
    if isinstance(given, Comparison) and len(forms) > 1:
        yield from _side_by_side(given)
    yield from _by_kind(forms[0])


# -- names -------------------------------------------------------------------------------------


def display_names(form: ClosedForm) -> Names:
    """Return how speeds and accelerations are shown: those of a coordinate q as rates of q."""
    found = Names()
    found.decimals = form.tree.numbers == "decimals"
    given = form.steps.mechanism
    for u, a, moved in zip(given.speeds, given.accelerations, given.basis, strict=True):
        if len(moved) == 1 and set(moved.values()) == {1}:
            q = next(iter(moved)).name
            found[u.symbol] = sp.Symbol(dotted(q), real=True)
            found[a] = sp.Symbol(dotted(dotted(q)), real=True)
    return found


def _variables(form: ClosedForm) -> Iterator[Block]:
    names = display_names(form)
    items = [(Formula(q.symbol), q.description) for q in form.coordinates]
    for u in form.speeds:
        shown = u.symbol.xreplace(names)
        if shown == u.symbol:
            items.append((Formula(u.symbol), u.description))
        elif not u.name.endswith("_dot"):
            items.append((Formula(shown), f"{u.description}, elsewhere {u.name}"))
    yield Heading("Variables")
    yield Bullets(tuple(items))
    if form.prescribed:
        yield Heading("Prescribed motion")
        yield Display(
            tuple(
                _line(Formula(d.symbol.xreplace(names)), d.expression, names)
                for d in form.prescribed
            )
        )


# -- steps -------------------------------------------------------------------------------------


def _derivation(form: ClosedForm) -> Iterator[Steps]:
    """Yield a block a stage, so that every format puts the reason before its formulas."""
    names, number = display_names(form), 0
    for number, stage in enumerate(stages(form), 1):
        note = Note(number, stage.reason[:1].upper() + stage.reason[1:])
        yield Steps((note,), (tuple(_stage_lines(stage, names)),))
    last = Note(number + 1, "The equations of motion", "their terms are sorted by kind below")
    yield Steps((last,), (tuple(equation_lines(form)),))


def _stage_lines(stage: Stage, names: Names) -> Iterator[Line]:
    for left, value in stage.lines:
        yield Line(left, EQUALS, _pieces(value, names))


def _pieces(value: Value, names: Names) -> tuple[Box, ...]:
    if isinstance(value, tuple):
        return (Grid(tuple((row(*_pieces(x, names)),) for x in value)),)
    return expression_pieces(names.of(value))


def _line(left: Box, right: Expr, names: Names, words: str = "") -> Line:
    return Line(left, EQUALS, _pieces(right, names), words)


def equation_lines(form: ClosedForm) -> Iterator[Line]:
    """Yield the equations: left side in the order of the kinds, the applied forces on the right."""
    names = display_names(form)
    for u in form.speeds:
        left = [t for t in form.of(u.symbol) if KINDS[t.kind].left]
        right = [t for t in form.of(u.symbol) if not KINDS[t.kind].left]
        pieces = _sum(left, names)
        yield Line(row(*pieces), EQUALS, _sum(right, names), broken_left=pieces)


def _sum(terms: list[Term], names: Names) -> tuple[Box, ...]:
    """Return the terms in the order given, with their signs."""
    signed = [pair for t in terms for pair in _signed(t, names)]
    if not signed:
        return expression_pieces(sp.S.Zero)
    first = (Operator("negative"),) if signed[0][0] else ()
    others = [Row((Operator("minus" if minus else "plus"), box)) for minus, box in signed[1:]]
    return (row(*first, signed[0][1]), *others)


def _signed(term: Term, names: Names) -> Iterator[tuple[bool, Box]]:
    """Yield the parts of a term with whether they are subtracted; a factor stands behind a sum."""
    coefficient, factor = names.of(term.coefficient), term.factor.xreplace(names)
    whole = [coefficient] if factor != 1 else sp.Add.make_args(coefficient)
    for part in whole:
        minus = bool(part.as_coeff_Mul()[0].is_negative)
        bare = -part if minus else part
        pieces = expression_pieces(bare)
        box = Fence(row(*pieces)) if isinstance(bare, sp.Add) and factor != 1 else row(*pieces)
        if factor == 1:
            yield minus, box
        elif bare == 1:
            yield minus, Formula(factor)
        else:
            yield minus, Row((box, Operator("times"), Formula(factor)))


def equations_latex(form: ClosedForm) -> str:
    """Return the equations as one aligned display."""
    rows = []
    for line in equation_lines(form):
        for part in broken(line):
            left = render(part.left, "latex") if part.left else ""
            relation = render(part.relation, "latex")
            rows.append(f"{left} &{relation} {render(Row(part.right), 'latex')}".rstrip())
    return "\\begin{align*}\n" + " \\\\\n".join(rows) + "\n\\end{align*}"


# -- side by side ------------------------------------------------------------------------------


def _side_by_side(given: Comparison) -> Iterator[Block]:
    yield Heading("Side by side")
    count = len(given.rows)
    yield Paragraph(
        f"Of each term the steps that give it, by method; the {count} coefficients agree, each verified "
        "by exact arithmetic at random points."
    )
    titles = tuple(METHODS[f.method][0] for f in given.forms)
    for u in given.forms[0].speeds:
        names = display_names(given.forms[0])
        rows = [r for r in given.rows if r.equation == u.symbol]
        yield Heading(f"Equation of {_plain(u.symbol.xreplace(names))}", 3)
        table = []
        for r in rows:
            first = next(t for t in r.terms if t is not None)
            about = _about(first, names)
            cells = tuple(_cell(form, t) for form, t in zip(given.forms, r.terms, strict=True))
            table.append((about, cells))
        yield Table(titles, tuple(table))


def _plain(s: Expr) -> str:
    return render(symbol(s.name), "text")


def _about(term: Term, names: Names) -> tuple[Box, ...]:
    """Return the kind of a term and what its coefficient goes with."""
    kind = Words(KINDS[term.kind].title)
    if term.factor == 1:
        return (kind,)
    return (kind, Words(", "), Operator("times"), Formula(term.factor.xreplace(names)))


def _cell(form: ClosedForm, term: Term | None) -> Cell:
    """Return what the steps of a method give to a coefficient, and the sum of several."""
    names = display_names(form)
    if term is None:
        return Cell((("", _pieces(sp.S.Zero, names)),))
    lines = [(label, _pieces(x, names)) for label, x in term.origins]
    if len(lines) > 1:
        lines.append(("sum", _pieces(term.coefficient, names)))
    return Cell(tuple(lines))


# -- the result --------------------------------------------------------------------------------


def _by_kind(form: ClosedForm) -> Iterator[Block]:
    names = display_names(form)
    yield Heading("Terms by kind")
    for kind, meaning in KINDS.items():
        terms = [t for t in form.terms if t.kind == kind]
        if terms and kind == "inertial":
            matrix = names.of(form.mass_matrix)
            yield Paragraph("Mass matrix, over the accelerations in the order of the variables:")
            yield Display((Line(symbol("M"), EQUALS, (_grid(matrix),)),))
        elif terms:
            column = names.of(form.column(kind))
            side = "" if meaning.left else " (right side)"
            yield Paragraph(f"{meaning.title}{side}:")
            yield Display((Line(symbol(_LETTERS[kind]), EQUALS, (_grid(column),)),))


_LETTERS = {
    "centrifugal": "h_centrifugal",
    "coriolis": "h_Coriolis",
    "gyroscopic": "h_gyroscopic",
    "prescribed": "h_prescribed",
    "gravity": "h_gravity",
    "spring": "h_springs",
    "damper": "h_dampers",
    "applied": "Q",
}


def _grid(matrix: Expr) -> Box:
    return Grid(tuple(tuple(row(*expression_pieces(x)) for x in line) for line in matrix.tolist()))


Value = Expr | tuple[Expr, ...]


@dataclass(frozen=True)
class Stage:
    """A step of a method: why, and what it gives."""

    reason: str
    lines: tuple[tuple[Box, Value], ...]


def stages(form: ClosedForm) -> list[Stage]:
    """Return the stages of the method of a closed form; those without lines are left out."""
    stages = _STAGES_OF[type(form.steps)](form, form.steps)
    return [stage for stage in stages if stage.lines]


@dataclass(frozen=True)
class _Pen:
    """Writes scalars of one closed form, by the products of speeds in them."""

    form: ClosedForm

    def __call__(self, x: Scalar) -> Expr:
        if not isinstance(x, Polynomial):
            return self.form.write(x)
        given = self.form.steps.mechanism
        names = [*given.accelerations, *(u.symbol for u in given.speeds)]
        moving = {given.algebra.index(s) for s in names}
        found = x.by(lambda g: g in moving)
        return sp.Add(*(self._product(m, c) for m, c in found.items()))

    def _product(self, moving: Monomial, x: Scalar) -> Expr:
        """Return a product of speeds with its coefficient, the number in it kept in front."""
        number = content(list(terms_of(x).values()))
        bare = self.form.write(x * (1 / number))
        generators = self.form.steps.mechanism.algebra.generators
        front = sp.Rational(number.numerator, number.denominator)
        return sp.Mul(front, bare, *(generators[g] ** p for g, p in moving))

    def vector(self, v: Sequence[Scalar]) -> tuple[Expr, ...]:
        return tuple(map(self, v))


def _lines(pairs: Iterator[tuple[Box, Value]]) -> tuple[tuple[Box, Value], ...]:
    """Return the lines whose value is not zero."""
    return tuple((left, value) for left, value in pairs if not _nothing(value))


def _nothing(value: Value) -> bool:
    return all(x == 0 for x in value) if isinstance(value, tuple) else bool(value == 0)


def _of(letter: str, body: str, *more: str) -> Box:
    """Return a letter with the name of a body below it, and a speed's number."""
    below: list[Box] = [_name(body)]
    for m in more:
        below += [Operator("comma"), Symbol(m)]
    return Scripts(Symbol(letter), sub=Row(tuple(below)))


def _name(body: str) -> Box:
    """Return the name of a body, however it is made up of letters, digits and underscores."""
    return Words(body)


def _by(above: Box, below: Expr) -> Box:
    """Return a partial derivative."""
    partial = Operator("partial")
    return Fraction(Row((partial, above)), Row((partial, symbol(str(below)))))


def _d_dt(inner: Box) -> Box:
    d = Operator("d")
    return Row((Fraction(d, Row((d, Symbol("t")))), Operator("times"), inner))


# -- Lagrange ----------------------------------------------------------------------------------


def _lagrange(form: ClosedForm, steps: Lagrange) -> Iterator[Stage]:
    pen, links = _Pen(form), steps.mechanism.links
    heavy = [k for k, link in enumerate(links) if not is_zero(link.mass)]
    yield Stage(
        "positions of the centres of mass, in the ground's axes",
        _lines((_of("r", links[k].name), pen.vector(steps.centres[k])) for k in heavy),
    )
    yield Stage(
        "their derivatives in time",
        _lines((_of("v", links[k].name), pen.vector(steps.motions[k].linear)) for k in heavy),
    )
    turning = [k for k in heavy if not all(is_zero(x) for row in links[k].inertia for x in row)]
    yield Stage(
        "angular velocities, in the bodies' axes, from the derivatives of the rotations",
        _lines(
            (_of("omega", links[k].name), pen.vector(steps.motions[k].angular)) for k in turning
        ),
    )
    yield Stage(
        "kinetic energies: half of m v.v and omega.J omega about the centre of mass; rotors add to T",
        _lines((_of("T", links[k].name), pen(steps.energies[k])) for k in heavy)
        + _lines(iter([(Symbol("T"), pen(steps.kinetic))])),
    )
    yield Stage(
        "potential energies of gravity and springs; Rayleigh's function of the dampers",
        _lines(
            iter(
                [
                    (symbol("V_gravity"), pen(steps.gravity)),
                    (symbol("V_springs"), pen(steps.springs)),
                    (Symbol("R"), pen(steps.dissipation)),
                ]
            )
        ),
    )
    yield from _differentiated(form, steps, pen)


def _differentiated(form: ClosedForm, steps: Lagrange, pen: _Pen) -> Iterator[Stage]:
    given, shown = steps.mechanism, _shown(form)
    rows = [(s, shown(given.speeds[s].symbol)) for s in given.free]
    yield Stage(
        "momenta",
        _lines((_by(Symbol("T"), u), pen(steps.momenta[s])) for s, u in rows),
    )
    yield Stage(
        "their derivatives in time",
        _lines((_d_dt(_by(Symbol("T"), u)), pen(given.rate(steps.momenta[s]))) for s, u in rows),
    )
    yield Stage(
        "how the kinetic energy changes with the coordinates",
        _lines((_turned(form, "T", s), pen(steps.moved(steps.kinetic, s))) for s, _ in rows),
    )
    yield Stage(
        "speeds that are no rates of coordinates: the terms of Boltzmann and Hamel",
        _lines((_of("B", str(u)), pen(steps.brackets(s))) for s, u in rows),
    )
    yield Stage(
        "how the potential energy changes with the coordinates",
        _lines(
            (_turned(form, "V", s), pen(steps.moved(steps.gravity + steps.springs, s)))
            for s, _ in rows
        ),
    )


def _turned(form: ClosedForm, letter: str, s: int) -> Box:
    """Return dT/dq where the speed is the rate of q, else X_s T."""
    given = form.steps.mechanism
    moved = given.basis[s]
    if len(moved) == 1 and set(moved.values()) == {1}:
        return _by(Symbol(letter), next(iter(moved)))
    return Row((Scripts(Symbol("X"), sub=symbol(given.speeds[s].name)), Symbol(letter)))


# -- Kane --------------------------------------------------------------------------------------


def _kane(form: ClosedForm, steps: Kane) -> Iterator[Stage]:
    pen, given = _Pen(form), steps.mechanism
    heavy = [(k, link.name) for k, link in enumerate(given.links) if not is_zero(link.mass)]
    yield Stage(
        "angular velocities and velocities of the centres of mass, in the bodies' axes",
        _pairs(
            pen, "omega", "v", ((n, steps.origins[k].angular, steps.centres[k]) for k, n in heavy)
        ),
    )
    partials = (
        (n, str(row), steps.partial(k, s)) for row, s in enumerate(given.free, 1) for k, n in heavy
    )
    yield Stage(
        "partial angular velocities and partial velocities: the coefficients of the speeds",
        _lines(
            (_of(letter, name, row), pen.vector(v))
            for name, row, pair in partials
            for letter, v in zip(("omega", "v"), pair, strict=True)
        ),
    )
    yield Stage(
        "angular accelerations and accelerations, by differentiation in turning axes",
        _pairs(pen, "alpha", "a", ((n, *steps.accelerations[k]) for k, n in heavy)),
    )
    yield _generalised(form, pen, "motion", "generalised inertia forces, less their sign", "F*")
    for source, words in _ACTIVE:
        yield _generalised(form, pen, source, words, "F")


def _pairs(
    pen: _Pen, first: str, second: str, found: Iterable[tuple[str, Sequence[Any], Sequence[Any]]]
) -> tuple[tuple[Box, Value], ...]:
    """Return two vectors of each body, with their letters."""
    return _lines(
        (_of(letter, name), pen.vector(v))
        for name, *vectors in found
        for letter, v in zip((first, second), vectors, strict=True)
    )


_ACTIVE = (
    ("gravity", "generalised active forces of gravity, less their sign"),
    ("spring", "generalised active forces of springs, less their sign"),
    ("damper", "generalised active forces of dampers, less their sign"),
    ("applied", "generalised active forces that are applied"),
)


def _generalised(form: ClosedForm, pen: _Pen, source: str, reason: str, letter: str) -> Stage:
    found = [
        (
            Row((Words(f"{c.label}, "), symbol(str(_shown(form)(form.speeds[c.row].symbol))))),
            c.value,
        )
        for c in form.steps.contributions()
        if c.source == source and not is_zero(c.value)
    ]
    return Stage(f"{reason} ({letter})", _lines((left, pen(x)) for left, x in found))


# -- Newton-Euler ------------------------------------------------------------------------------


def _newton_euler(form: ClosedForm, steps: NewtonEuler) -> Iterator[Stage]:
    pen, links = _Pen(form), steps.mechanism.links
    heavy = [(k, link) for k, link in enumerate(links) if not is_zero(link.mass)]
    moving = (
        (link.name, steps.motions[k].alpha, steps.acceleration(k, link.centre)) for k, link in heavy
    )
    yield Stage(
        "angular accelerations, and accelerations of the centres of mass, in the bodies' axes",
        _pairs(pen, "alpha", "a", moving),
    )
    rates = ((link.name, steps.momentum_rate(k)) for k, link in heavy)
    balances = ((name, rate.linear, rate.angular) for name, rate in rates)
    yield Stage(
        "balances of each body: force m a, and moment J alpha + omega x J omega about the centre",
        _pairs(pen, "f", "n", balances),
    )
    yield Stage(
        "moments and forces are handed on towards the ground; along the directions that a joint leaves "
        "free it carries no reaction, and what the bodies beyond it ask there is",
        _asked(form, steps, pen),
    )


def _asked(form: ClosedForm, steps: NewtonEuler, pen: _Pen) -> tuple[tuple[Box, Value], ...]:
    names = [u.name for link in steps.mechanism.links for u in link.joint.speeds]
    shown = _shown(form)
    return _lines(
        (Row((Words(f"{label}, at "), symbol(str(shown(sp.Symbol(names[s], real=True)))))), pen(x))
        for s, _, label, x in steps.joint_rows()
        if not is_zero(x)
    )


def _shown(form: ClosedForm) -> Callable[[Expr], Expr]:

    names = display_names(form)
    return lambda e: e.xreplace(names)


_STAGES_OF: dict[type, Callable[[ClosedForm, Any], Iterator[Stage]]] = {
    Lagrange: _lagrange,
    Kane: _kane,
    NewtonEuler: _newton_euler,
}
