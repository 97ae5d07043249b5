r"""SymPy expressions as boxes, in the order of the field: ``(I_3 - I_2)\,\omega_2\omega_3``.

A product has its number first, then sizes (symbols that are positive), sums of these, letters of either
sign, functions, integrals; of letters Latin ones, then other sums, Greek letters, u to z, numbered ones,
time. A sum begins with what is added; a polynomial with its highest power, an equation of motion with its
highest rates, what is neither with its number. A minus before a difference is taken up by it.
What is no sum, product, power, known function, integral, derivative or matrix stays a formula for SymPy's
own printers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import sympy as sp
from sympy.printing.conventions import requires_partial

from eom.typeset.boxes import (
    GREEK_NAMES,
    Box,
    Fence,
    Form,
    Formula,
    Fraction,
    Grid,
    Operator,
    Row,
    Scripts,
    Sign,
    Symbol,
    raised,
    row,
    symbol,
)

Expr = Any
Names = Mapping[Expr, str | Box]

FUNCTIONS = ("sin", "cos", "tan", "cot", "sec", "csc", "sinh", "cosh", "tanh", "log")
"""Functions whose argument stands without brackets where it is one letter."""
_COMMANDS = {name: Sign(f"\\{name}", name, "mi") for name in FUNCTIONS}


def expression_box(value: Expr, names: Names | None = None) -> Box:
    """Return a SymPy expression or matrix as boxes; what is not known stays a `Formula`.

    ``names``: boxes of symbols, or LaTeX of those by themselves; others are called by
    `eom.typeset.boxes.symbol`.
    """
    known = names or {}
    if isinstance(value, sp.MatrixBase):
        return _grid(value, known, "bmatrix")
    if isinstance(value, sp.Add):
        return _sum(value, known)
    if isinstance(value, sp.Mul | sp.Rational | sp.Float):
        minus, rest = _one_signed(value)
        box = _unsigned(list(sp.Mul.make_args(rest)), known)
        return row(Operator("negative"), box) if minus else box
    rule = next((r for kind, r in _RULES if isinstance(value, kind)), None)
    return Formula(value, known) if rule is None else rule(value, known)


# -- sums ------------------------------------------------------------------------------------


def signed(value: Expr) -> list[tuple[bool, Expr]]:
    """Return the terms of a sum, each with whether it is subtracted, and without its sign."""
    return [_one_signed(t) for t in in_order(value)]


def with_signs(parts: Sequence[tuple[bool, Box]]) -> tuple[Box, ...]:
    """Return terms with their signs, each a box."""
    if len(parts) == 1 and not parts[0][0]:
        return (parts[0][1],)
    first = (Operator("negative"),) if parts[0][0] else ()
    rest = [Row((Operator("minus" if minus else "plus"), box)) for minus, box in parts[1:]]
    return (row(*first, parts[0][1]), *rest)


def _one_signed(term: Expr) -> tuple[bool, Expr]:
    """Return whether a term is subtracted, and the rest; a difference in it takes the sign up."""
    single = not isinstance(term, sp.Expr) or isinstance(term, sp.Add | sp.MatrixBase)
    if single or not _is_negative(term):
        return False, term
    coefficient, rest = term.as_coeff_Mul()
    factors = list(sp.Mul.make_args(rest))
    place = next((k for k, f in enumerate(factors) if _is_difference(f)), None)
    if place is None or len(factors) == 1:
        return True, -term
    factors[place] = -factors[place]
    return False, sp.Mul(-coefficient, *factors)


def _sum(value: Expr, names: Names) -> Box:
    parts = signed(value)
    return row(*with_signs([(minus, expression_box(rest, names)) for minus, rest in parts]))


def in_order(value: Expr) -> list[Expr]:
    """Return the terms of a sum in the order of the field, any other value alone.

    A polynomial in a letter of either sign, of which each term has another power, begins with the highest
    one; rates with what they are rates of begin with the highest; else SymPy's order, with a number, or
    with squares of sums first. One that is added begins, if there is one.
    """
    if not isinstance(value, sp.Add):
        return [value]
    terms = value.as_ordered_terms()
    powers = _rates_in(terms) or _powers_of(_variable(terms), terms)
    if powers:
        terms = [t for _, t in sorted(zip(powers, terms, strict=True), key=lambda pair: -pair[0])]
    elif any(t.is_Number and t.is_positive for t in terms):
        terms.sort(key=_degree)
    else:
        terms.sort(key=lambda t: not (t.is_Pow and t.base.is_Add and t.exp.is_Integer))
    return _added_first(_numbered(terms))


def _numbered(terms: list[Expr]) -> list[Expr]:
    """Return terms of which those that differ by the numbers of their letters follow these."""
    shapes = [_shape(t) for t in terms]
    found = list(terms)
    for shape in {s for s, numbers in shapes if numbers}:
        places = [k for k, (s, _) in enumerate(shapes) if s == shape]
        for place, k in zip(places, sorted(places, key=lambda k: shapes[k][1]), strict=True):
            found[place] = terms[k]
    return found


def _shape(term: Expr) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the letters of a term without numbers, with their powers, and the numbers."""
    factors = (f.as_base_exp() for f in sp.Mul.make_args(term))
    letters = [(b.name, n) for b, n in factors if b.is_Symbol and _rank(b) == _LETTER]
    found = sorted((_DIGIT.sub("", name), str(n), _DIGIT.findall(name)) for name, n in letters)
    shape = tuple(f"{name}^{n}" for name, n, _ in found)
    return shape, tuple("".join(digits) for _, _, digits in found)


_DIGIT = re.compile(r"\d")
_RATE = re.compile(r"(.*?)(_\d+)?_(d+)ot")


def _rates_in(terms: Sequence[Expr]) -> list[int]:
    """Return whether the highest rate stands in each term; none unless they are rates of others."""
    names = {s.name for t in terms for s in t.free_symbols}
    found = {name: m for name in names if (m := _RATE.fullmatch(name))}
    highest = max((len(m[3]) for m in found.values()), default=0)
    stems = {m[1] for m in found.values()}
    beside = any(re.split(r"_\d", name)[0] in stems for name in names - found.keys())
    if not highest or (highest == 1 and not beside):
        return []
    orders = [
        max((len(found[s.name][3]) for s in t.free_symbols if s.name in found), default=0)
        for t in terms
    ]
    return [int(n == highest) for n in orders]


def _degree(term: Expr) -> int:
    """Return how many letters a term has as factors, each as often as its power says."""
    powers = (f.as_base_exp() for f in sp.Mul.make_args(term) if not f.is_number)
    return sum(int(n) if n.is_Integer else 1 for _, n in powers)


def _variable(terms: Sequence[Expr]) -> Expr | None:
    """Return the letter in which terms are a polynomial; of several one whose highest power is alone."""
    letters = {s for t in terms for f in sp.Mul.make_args(t) for s in _letters_of(f)}
    found = [(_powers_of(s, terms), s) for s in sorted(letters, key=str)]
    able = [(p, s) for p, s in found if len(set(p)) == len(terms) and max(p) > 1]

    def best(pair: tuple[list[int], Expr]) -> tuple[bool, int, str]:
        powers, s = pair
        leading = terms[powers.index(max(powers))]
        return not (leading / s ** max(powers)).is_number, -max(powers), str(s)

    return min(able, key=best)[1] if able else None


def _letters_of(factor: Expr) -> set[Expr]:
    base = factor.base if isinstance(factor, sp.Pow) else factor
    return {base} if base.is_Symbol and not base.is_positive else set()


def _powers_of(letter: Expr | None, terms: Sequence[Expr]) -> list[int]:
    """Return the power of a letter in each term; none where it is in one by other ways, too."""
    if letter is None:
        return []
    found = [t.as_coeff_exponent(letter) for t in terms]
    if any(rest.has(letter) or not n.is_Integer or n < 0 for rest, n in found):
        return []
    return [int(n) for _, n in found]


def _is_difference(factor: Expr) -> bool:
    """Return whether a factor is a - b."""
    if not isinstance(factor, sp.Add) or len(factor.args) != 2:
        return False
    return sum(_is_negative(t) for t in factor.args) == 1


def _is_negative(term: Expr) -> bool:
    return bool(term.as_coeff_Mul()[0].is_negative)


def _added_first(terms: Sequence[Expr]) -> list[Expr]:
    """Return terms of a sum in brackets: one that is added begins, if there is one."""
    found = list(terms)
    first = next((t for t in found if not _is_negative(t)), found[0])
    found.remove(first)
    return [first, *found]


def _bracketed(total: Expr, names: Names) -> Box:
    inside = _sum(total, names)
    return Fence(inside, flat=not is_tall(inside))


# -- products --------------------------------------------------------------------------------


def _unsigned(factors: list[Expr], names: Names) -> Box:
    """Return a product that is not negative: a fraction if some factor is below the line.

    Integrals and determinants above stand beside the fraction, and on pages what holds quotients.
    """
    above, below = _divided(_contents(factors))
    if not below:
        return _product(above, names, alone=True)
    denominator = _product(below, names, alone=True)
    behind = [f for f in above if f.has(sp.Integral, sp.Determinant)]
    if behind:
        front = [f for f in above if f not in behind]
        return Row((Fraction(_product(front, names), denominator), THIN, _product(behind, names)))
    beside = _beside(above, below, names)
    return Fraction(_product(above, names, alone=True), denominator, beside)


def _beside(above: list[Expr], below: list[Expr], names: Names) -> Box | None:
    """Return a quotient with factors that hold quotients beside the line, of those below the inverse."""
    (front, times), (rest, over) = (_by_quotients(factors, names) for factors in (above, below))
    if not times and not over:
        return None
    numerator = _product(front, names, alone=True)
    first: list[Box] = [Fraction(numerator, _product(rest, names, alone=True))] if rest else []
    first += [numerator] if front and not rest else []
    middle = [_product(times, names)] if times else []
    power = Row((Operator("negative"), Symbol("1")))
    last = [Scripts(Fence(_product(over, names, alone=True)), sup=power)] if over else []
    return row(*_spaced([*first, *middle, *last]))


def _by_quotients(factors: list[Expr], names: Names) -> tuple[list[Expr], list[Expr]]:
    """Return the factors without quotients in them, and those with."""
    held = [holds_quotient(_factor(f, names)) for f in factors]
    found = list(zip(factors, held, strict=True))
    return [f for f, holds in found if not holds], [f for f, holds in found if holds]


def _spaced(boxes: Sequence[Box]) -> list[Box]:
    return [part for box in boxes for part in (THIN, box)][1:]


def _contents(factors: Sequence[Expr]) -> list[Expr]:
    """Return factors with the numbers common to all terms of a sum in front: 2 (a - b) of 2 a - 2 b."""
    single = len(factors) == 1 and isinstance(factors[0], sp.Add)
    if single or any(f.is_Float for f in factors):
        return list(factors)
    number, found = sp.S.One, []
    for f in factors:
        base, power = f.as_base_exp()
        content = base.primitive()[0] if isinstance(base, sp.Add) else sp.S.One
        if content != 1 and content.is_Integer and power.is_Integer:
            number *= content**power
            f = sp.Add(*(t / content for t in base.args)) ** power  # noqa: PLW2901 - as it is shown
        elif f.is_Rational:
            number, f = number * f, sp.S.One  # noqa: PLW2901 - put in front
        found.append(f)
    return [number, *(f for f in found if f != 1)]


def _divided(factors: Sequence[Expr]) -> tuple[list[Expr], list[Expr]]:
    """Return the factors above and below the line; ones are left out."""
    above, below = [], []
    for f in factors:
        if f.is_Float and f == 1:
            continue
        if f.is_Rational:
            above += [sp.Integer(f.p)] if f.p != 1 else []
            below += [sp.Integer(f.q)] if f.q != 1 else []
        elif isinstance(f, sp.Pow) and f.base != sp.E and _is_negative(f.exp):
            below.append(sp.Pow(f.base, -f.exp))
        else:
            above.append(f)
    return above, below


_NUMBER, _SIZE, _SUM, _LETTER, _FUNCTION, _LAST = range(6)
"""What stands before what in a product; a sum of letters of either sign counts as a letter."""
_MASSES = re.compile(r"[mM](_\w+|\d+)?")
"""Masses stand before other sizes."""
_MOMENTS = re.compile(r"[IJ]_?[123]")
"""Moments of inertia are sizes, whatever is assumed of their symbols."""


def _rank(factor: Expr) -> int:
    base = factor.base if isinstance(factor, sp.Pow) else factor
    if _is_mass(base):
        return _SIZE
    if factor.is_number:
        return _NUMBER
    if isinstance(base, sp.Symbol):
        return _SIZE if _is_size(base) else _LETTER
    if isinstance(base, sp.Add):
        whole = factor is base or factor.exp.is_Integer
        return _FUNCTION if not whole else _SUM if _is_of_sizes(base) else _LETTER
    return _LAST if isinstance(base, sp.Integral | sp.Derivative) else _FUNCTION


def _is_size(base: Expr) -> bool:
    return base.is_Symbol and bool(base.is_positive or _MOMENTS.fullmatch(base.name))


def _is_of_sizes(total: Expr) -> bool:
    """Return whether a sum counts as a size: a term is made of sizes alone, or each holds one."""
    sizes = [[_is_size(b) for b in _bases(t)] for t in total.args]
    return any(found and all(found) for found in sizes) or all(map(any, sizes))


def _bases(term: Expr) -> list[Expr]:
    """Return what the factors of a product are powers of, but for numbers."""
    bases = (f.base if isinstance(f, sp.Pow) else f for f in sp.Mul.make_args(term))
    return [b for b in bases if not b.is_number]


def _in_order(factors: Sequence[Expr]) -> list[Expr]:
    """Return factors in the order of a product; those of one place keep SymPy's."""
    found = sorted(sp.Mul(*factors, evaluate=False).as_ordered_factors(), key=_place)
    return _cyclic(found) if any(map(_is_indexed, found)) else found


def _place(factor: Expr) -> tuple[int, bool, int]:
    """Return the rank, then masses before others, and the place of a letter among letters."""
    base = factor.base if isinstance(factor, sp.Pow) else factor
    rank = _rank(factor)
    return rank, not _is_mass(base), _place_of_letter(base) if rank == _LETTER else 0


def _place_of_letter(base: Expr) -> int:
    """Return the place: Latin letters, sums, Greek ones, u to z, rates of turning, numbered ones, time."""
    if not base.is_Symbol:
        return 1
    if base.name == "t":
        return 7
    stem = re.split(r"_|\d", base.name)[0]
    if not re.search(r"\d", base.name):
        return 2 if stem in GREEK_NAMES else 3 if stem in _VARIABLES else 0
    return 4 if stem == "omega" else 6 if stem in GREEK_NAMES else 5


_VARIABLES = frozenset("uvwxyz")


def _is_indexed(factor: Expr) -> bool:
    """Return whether a factor holds moments about axes, by which it belongs to a cyclic equation."""
    base = factor.base if isinstance(factor, sp.Pow) else factor
    terms = base.args if isinstance(base, sp.Add) else (base,)
    names = (s.name for t in terms for s in t.free_symbols if _is_size(s))
    return any(_INDEXED.fullmatch(name) for name in names)


def _is_mass(base: Expr) -> bool:
    """Return whether a factor is a mass, or a sum of masses."""
    single = base.is_Symbol or isinstance(base, sp.Add)
    return single and all(_MASSES.fullmatch(s.name) for s in base.free_symbols)


_INDEXED = re.compile(r"(.*?_?)([123])((?:_d+ot)?)")


def _cyclic(factors: list[Expr]) -> list[Expr]:
    """Return factors with components 3 and 1 of one letter, side by side, in cyclic order."""
    found = list(factors)
    for k, (a, b) in enumerate(pairwise(factors)):
        if _LETTER == _rank(a) == _rank(b) and a.is_Symbol and b.is_Symbol:
            first, second = (_INDEXED.fullmatch(f.name) for f in (a, b))
            if first and second and first.group(1, 3) == second.group(1, 3):
                turn = first[2], second[2]
                found[k : k + 2] = [b, a] if turn == ("1", "3") else [a, b]
    return found


THIN = Operator("thin")


def _product(factors: Sequence[Expr], names: Names, *, alone: bool = False) -> Box:
    """Return factors side by side; ``alone``: a single sum needs no brackets."""
    if not factors:
        return Symbol("1")
    if len(factors) == 1:
        (one,) = factors
        if one.is_Integer or one.is_Float:
            return _digits(one, names)
        bare = alone or not isinstance(one, sp.Add)
        return expression_box(one, names) if bare else _bracketed(one, names)
    ordered = _in_order(factors)
    boxes = [_factor(f, names) for f in ordered]
    upright = any(map(_is_word, boxes))
    parts: list[Box] = [boxes[0]]
    for before, f, box in zip(ordered, ordered[1:], boxes[1:], strict=False):
        apart = upright or (isinstance(before, sp.Add) and _rank(f) > _SUM)
        numbers = before.is_Number and f.is_Number
        parts += [Operator("dot") if numbers else THIN if apart else Operator("times"), box]
    return Row(tuple(parts))


def _is_word(box: Box) -> bool:
    base = box.base if isinstance(box, Scripts) else box
    if isinstance(base, Formula):
        return str(base.names.get(base.value, "")).startswith(r"\mathrm")
    return isinstance(base, Symbol) and base.style == "roman" and len(base.name) > 1


def _factor(factor: Expr, names: Names) -> Box:
    if isinstance(factor, sp.Add):
        return _bracketed(factor, names)
    if factor.is_Integer or factor.is_Float:
        return _digits(factor, names)
    box = expression_box(factor, names)
    return Fence(box) if _is_loose(factor) else box


def _is_loose(factor: Expr) -> bool:
    """Return whether a factor needs brackets: no atom, power or function."""
    return isinstance(factor, sp.Piecewise | sp.core.relational.Relational)


# -- powers, functions -----------------------------------------------------------------------


def _power(value: Expr, names: Names) -> Box:
    base, exponent = value.base, value.exp
    if _is_even(exponent) and isinstance(base, sp.Add) and _is_mostly_negative(base):
        base = -base
    if base == sp.E:
        return Scripts(Symbol("e"), sup=_exponent(exponent, names))
    if _is_negative(exponent):
        return _unsigned([value], names)
    if exponent.is_Rational and not exponent.is_Integer and exponent.p == 1:
        inside = expression_box(base, names)
        degree = Symbol(str(exponent.q))
        return Form("root", (inside,)) if exponent.q == 2 else Form("degree", (inside, degree))
    upper = _exponent(exponent, names)
    if isinstance(base, sp.Function) and _name(base) in _COMMANDS and exponent.is_Integer:
        return _applied(Scripts(_COMMANDS[_name(base)], sup=upper), base.args[0], names)
    return raised(_base(base, names), upper)


def _is_even(exponent: Expr) -> bool:
    return bool(exponent.is_Integer and exponent % 2 == 0)


def _is_mostly_negative(total: Expr) -> bool:
    return 2 * sum(map(_is_negative, total.args)) > len(total.args)


def _exponent(exponent: Expr, names: Names) -> Box:
    """Return what is raised, or a limit: a quotient on one line, as letters in a fraction would be tiny."""
    if exponent.is_Rational and not exponent.is_Integer:
        minus = Operator("negative") if exponent.p < 0 else None
        return row(minus, Symbol(str(abs(exponent.p))), Operator("slash"), Symbol(str(exponent.q)))
    above, below = sp.fraction(exponent)
    if below == 1:
        return expression_box(exponent, names)
    sign = Operator("negative") if _is_negative(above) else None
    upper = _base(above, names) if isinstance(above, sp.Add) else None
    return row(
        sign,
        upper or expression_box(-above if sign else above, names),
        Operator("slash"),
        _factor_below(below, names),
    )


def _factor_below(below: Expr, names: Names) -> Box:
    box = expression_box(below, names)
    single = isinstance(below, sp.Symbol | sp.Pow | sp.Function) or below.is_Integer
    return box if single else Fence(box)


def _base(base: Expr, names: Names) -> Box:
    box = _bracketed(base, names) if isinstance(base, sp.Add) else expression_box(base, names)
    single = isinstance(base, sp.Symbol | sp.Add | sp.NumberSymbol)
    single = single or bool(base.is_Integer and base >= 0)
    return box if single else Fence(box)


def _name(function: Expr) -> str:
    return str(function.func.__name__)


def _function(value: Expr, names: Names) -> Box:
    if _name(value) not in _COMMANDS or len(value.args) != 1:
        return Formula(value, names)
    return _applied(_COMMANDS[_name(value)], value.args[0], names)


def _applied(name: Box, argument: Expr, names: Names) -> Box:
    inside = expression_box(argument, names)
    if argument.is_Symbol or argument.is_Integer:
        return Form("applied", (name, inside))
    return Row((name, Fence(inside, flat=not is_tall(inside))))


def _exponential(value: Expr, names: Names) -> Box:
    return Scripts(Symbol("e"), sup=_exponent(value.args[0], names))


def _absolute(value: Expr, names: Names) -> Box:
    return Fence(expression_box(value.args[0], names), "|", "|")


# -- integrals, derivatives, matrices --------------------------------------------------------


def _integral(value: Expr, names: Names) -> Box:
    """Return signs from the outermost, what is integrated, and its differentials from the innermost."""
    if any(len(limit) != 3 for limit in value.limits):
        return Formula(value, names)
    signs = [
        _limited(*(_exponent(end, names) for end in limit[1:])) for limit in reversed(value.limits)
    ]
    ends = [Row((THIN, Operator("d"), expression_box(limit[0], names))) for limit in value.limits]
    inside = _factor(value.function, names)
    return Row((*signs, Row((inside, *ends))), " ")


def _limited(lower: Box, upper: Box) -> Box:
    return Scripts(Operator("integral"), lower, upper)


def _derivative(value: Expr, names: Names) -> Box:
    if len(value.variable_count) != 1 or value.variable_count[0][1] != 1:
        return Formula(value, names)
    d = Operator("partial" if requires_partial(value) else "d")
    inside = expression_box(value.expr, names)
    below = Row((d, expression_box(value.variables[0], names)))
    shown = inside if value.expr.is_Symbol else Fence(inside, flat=not is_tall(inside))
    return Row((Fraction(d, below), Operator("times"), shown))


def _grid(value: Expr, names: Names, environment: str) -> Box:
    rows = tuple(tuple(expression_box(e, names) for e in line) for line in value.tolist())
    return Grid(rows, environment)


_DET = Sign("\\det", "det", "mi")


def _determinant(value: Expr, names: Names) -> Box:
    if not isinstance(value.arg, sp.MatrixBase):
        return Formula(value, names)
    if value.arg.shape == (1, 1):  # between bars it would be a magnitude
        return Row((_DET, Fence(expression_box(value.arg[0, 0], names))))
    return Fence(_grid(value.arg, names, "matrix"), "|", "|")


def is_tall(box: Box) -> bool:
    """Return whether a box is higher than a line."""
    if isinstance(box, Fraction | Grid | Form):
        return not isinstance(box, Form) or box.name != "applied"
    if isinstance(box, Row):
        return any(map(is_tall, box.items))
    if isinstance(box, Scripts):
        return is_tall(box.base) or box.stacked
    if isinstance(box, Fence):
        return is_tall(box.inner)
    return isinstance(box, Operator) and box.name in {"integral", "sum"}


def holds_quotient(box: Box) -> bool:
    """Return whether a line of a fraction stands in a box, but for indices, powers and limits."""
    if isinstance(box, Row | Form):
        return any(map(holds_quotient, box.items if isinstance(box, Row) else box.parts))
    if isinstance(box, Grid):
        return any(holds_quotient(cell) for line in box.rows for cell in line)
    if isinstance(box, Scripts | Fence):
        return holds_quotient(box.base if isinstance(box, Scripts) else box.inner)
    return isinstance(box, Fraction)


def _letter(value: Expr, names: Names) -> Box:
    named = names.get(value)
    if named is None:
        return symbol(value.name)
    return Formula(value, names) if isinstance(named, str) else named


def _number(value: Expr, names: Names) -> Box:
    return symbol("pi") if value == sp.pi else Formula(value, names)


def _digits(value: Expr, names: Names) -> Box:
    """Return a number that is not negative; one with an exponent stays a formula."""
    if value.is_Float and "e" in str(value):
        return Formula(value, names)
    return Symbol(str(value).rstrip("0").rstrip(".") if value.is_Float else str(value))


_RULES: tuple[tuple[Any, Callable[[Expr, Names], Box]], ...] = (
    (sp.Symbol, _letter),
    (sp.NumberSymbol, _number),
    (sp.exp, _exponential),
    (sp.Pow, _power),
    (sp.Abs, _absolute),
    (sp.Function, _function),
    (sp.Integral, _integral),
    (sp.Derivative, _derivative),
    (sp.Determinant, _determinant),
)
"""How each kind is written, the first that fits."""
