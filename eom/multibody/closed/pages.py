"""Pages of closed forms: one method with its steps, or several side by side, term by term."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import sympy as sp

from eom.derivations.showing import FORMATS
from eom.errors import typed, unknown_name
from eom.multibody.closed.forms import (
    EQUATIONS,
    METHODS,
    ClosedForm,
    Comparison,
    Term,
    closed_form,
    compare,
)
from eom.multibody.closed.readable import KINDS
from eom.multibody.closed.stages import Stage, Value, display_names, stages
from eom.multibody.model.model import Tree
from eom.multibody.model.names import inputs_of
from eom.quantities import TIME
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
    Grid,
    Operator,
    Row,
    Words,
    row,
    symbol,
)
from eom.typeset.markup import render
from eom.typeset.writing import Names, expression_pieces

Expr = Any


@shown.register(ClosedForm)
@shown.register(Comparison)
def show(given: ClosedForm | Comparison, style: str = "text") -> str:
    """Return a page in a format of `eom.derivations.showing.FORMATS`. Raises `InputError` for others."""
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
    names: Mapping[str, str] | None = None,
    independent: Sequence[str] = (),
    rates: bool = False,
) -> str:
    """Return the page of a tree by one of `METHODS`, or by all of them side by side.

    Parameters
    ----------
    tree : Tree
        As of `closed_form`.
    method : str, default "all"
        A row of `METHODS`, or ``all`` for all of them side by side.
    style : str, default "text"
        A format of `eom.derivations.showing.FORMATS`: text, latex, markdown or html.
    coordinates, names, independent, rates : mapping of expression to expressions, optional
        As of `closed_form`.

    Returns
    -------
    str
        The derivation, from the positions of the bodies to the equations.

    Raises
    ------
    InputError
        For unknown methods and formats, else as `compare`.

    Notes
    -----
    Units, frames, signs and sources are those of `closed_form`.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> hinge = Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> pendulum = Tree("pendulum", (Body("bob", 2, (0, 0, -1)),), (hinge,), gravity=(0, 0, -10))
    >>> tree_page(pendulum, "kane", "markdown").splitlines()[0]
    '# pendulum by Kane'
    """
    if style not in FORMATS:
        raise unknown_name("format", style, FORMATS)
    if method not in {*METHODS, "all"}:
        raise unknown_name("method", method, [*METHODS, "all"], f"tree {tree.name!r}")
    wishes: dict[str, Any] = {
        "coordinates": coordinates,
        "names": names,
        "independent": independent,
        "rates": rates,
    }
    if method == "all":
        return show(compare(tree, **wishes), style)
    return show(closed_form(tree, method, **wishes), style)


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
    yield from _remarks(form)
    if form.prescribed:
        yield Heading("Prescribed motion")
        moving = {TIME, *(i.symbol for i in inputs_of(form.tree))}
        still = set(form.whole.accelerations)
        lines = []
        for d in form.prescribed:
            shown, value = names.of(d.symbol), d.expression
            if shown != value and not (value == 0 and d.symbol in still):
                of_time = (Words("(t)"),) if value.free_symbols & moving else ()
                lines.append(_line(Row((Formula(shown), *of_time)), value, names))
        yield Display(tuple(lines))


def _remarks(form: ClosedForm) -> Iterator[Block]:
    """Yield what the constraints say beside equations: who follows, what holds where."""
    held = form.bonds
    if held is None:
        return
    names = display_names(form)
    yield Heading("Constraints")
    items: list[tuple[Box, str]] = [
        (Formula(d.symbol.xreplace(names)), "follows the other speeds") for d in form.followers
    ]
    items += [(Formula(names.of(x)), "taken to be positive") for x in held.positive]
    items += [(Formula(names.of(x)), "must not be zero: there other speeds follow")
              for x in held.divisors]  # fmt: skip
    items += [(Words(name), "holds by itself, or by the others") for name in held.idle]
    items += [(Formula(d.symbol), f"{d.quantity.meaning} ({d.quantity.unit or 'its own unit'})")
              for d in form.multipliers]  # fmt: skip
    yield Bullets(tuple(items))


# -- steps -------------------------------------------------------------------------------------


def _derivation(form: ClosedForm) -> Iterator[Steps]:
    """Yield a block a stage, so that every format puts the reason before its formulas."""
    names, number = display_names(form), 0
    for number, stage in enumerate(stages(form), 1):
        note = Note(number, stage.reason[:1].upper() + stage.reason[1:])
        yield Steps((note,), (tuple(_stage_lines(stage, names)),))
    last = Note(number + 1, "The equations of motion", "their terms are sorted by kind below")
    yield Steps((last,), (tuple(equation_lines(form)),))
    for after, (reason, lines) in enumerate(_further(form, names), number + 2):
        yield Steps((Note(after, reason),), (lines,))


def _further(form: ClosedForm, names: Names) -> Iterator[tuple[str, tuple[Line, ...]]]:
    """Yield what follows from the equations: the same divided by common factors, and multipliers."""
    if any(f != 1 for f in form.common_factors):
        yield (
            "What all terms of an equation share is divided out",
            tuple(equation_lines(form, form.divided)),
        )
    if form.multipliers:
        lines = (_line(Formula(d.symbol), d.expression, names) for d in form.multipliers)
        yield (
            "Forces of the constraints, from the equations of the speeds that follow",
            tuple(lines),
        )


def _stage_lines(stage: Stage, names: Names) -> Iterator[Line]:
    for left, value in stage.lines:
        yield Line(left, EQUALS, _pieces(value, names))


def _pieces(value: Value, names: Names) -> tuple[Box, ...]:
    if isinstance(value, tuple):
        return (Grid(tuple((row(*_pieces(x, names)),) for x in value)),)
    return expression_pieces(names.of(value))


def _line(left: Box, right: Expr, names: Names, words: str = "") -> Line:
    return Line(left, EQUALS, _pieces(right, names), words)


def equation_lines(form: ClosedForm, terms: Sequence[Term] | None = None) -> Iterator[Line]:
    """Yield the equations: left side in the order of the kinds, the applied forces on the right.

    ``terms``: in place of those of the form.
    """
    names = display_names(form)
    for u in form.speeds:
        own = [t for t in (form.terms if terms is None else terms) if t.equation == u.symbol]
        left = [t for t in own if KINDS[t.kind].left]
        right = [t for t in own if not KINDS[t.kind].left]
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
            yield minus, Row((box, Operator("thin"), Formula(factor)))


def equations_latex(form: ClosedForm) -> str:
    """Return the equations as one aligned display."""
    rows = []
    for line in equation_lines(form, form.divided):
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
