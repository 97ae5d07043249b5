"""How LaTeX, Unicode text, ASCII and presentation MathML write the boxes of a formula.

A renderer is a table with one row a kind of box; SymPy expressions are left to SymPy's own printers,
with the names of `eom.typeset.boxes.symbol`.
"""

from __future__ import annotations

import html
import re
import unicodedata
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any
from xml.dom.minidom import parseString

import sympy as sp
from sympy.printing.latex import LatexPrinter
from sympy.printing.mathml import MathMLPresentationPrinter
from sympy.printing.str import StrPrinter

from eom.errors import unknown_name
from eom.typeset.boxes import (
    GREEK_NAMES,
    Accent,
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
    Unseen,
    Words,
    symbol,
)
from eom.typeset.expressions import expression_box

Expr = Any
Render = Callable[[Any], str]

ACCENTS: dict[str, tuple[str, str, str]] = {
    "vec": (r"\vec", "\u20d7", "→"),
    "hat": (r"\hat", "\u0302", "^"),
    "dot": (r"\dot", "\u0307", "˙"),
    "ddot": (r"\ddot", "\u0308", "¨"),
    "tilde": (r"\tilde", "\u0303", "~"),
    "widetilde": (r"\widetilde", "\u0303", "~"),
    "underline": (r"\underline", "\u0332", "―"),
    "bar": (r"\bar", "\u0304", "¯"),
    "check": (r"\check", "\u030c", "ˇ"),
    "breve": (r"\breve", "\u0306", "˘"),
    "acute": (r"\acute", "\u0301", "´"),
    "grave": (r"\grave", "\u0300", "`"),
    "ring": (r"\mathring", "\u030a", "˚"),
    "dddot": (r"\dddot", "\u20db", "⃛"),
    "ddddot": (r"\ddddot", "\u20dc", "⃜"),
    "harpoon": (r"\overrightharpoon", "\u20d1", "⇀"),
    "double_bar": (r"\overleftrightarrow", "\u20e1", "↔"),
    "underarrow": (r"\underrightarrow", "\u20ef", "→"),
    "undertilde": (r"\utilde", "\u0330", "~"),
}
"""A mark in LaTeX, as a combining character, and as a MathML operator."""

OPERATORS: dict[str, tuple[str, str, str]] = {
    "cross": (r" \times ", " × ", " x "),
    "dot": (r" \cdot ", " · ", " . "),
    "tensor": (r" \otimes ", " ⊗ ", " (x) "),
    "plus": (" + ", " + ", " + "),
    "minus": (" - ", " − ", " - "),
    "negative": ("-", "−", "-"),
    "=": (" = ", " = ", " = "),
    ":=": (r" \triangleq ", " := ", " := "),
    ">=": (r" \ge ", " ≥ ", " >= "),
    "times": (" ", " ", " "),
    "thin": (r" \, ", " ", " "),
    "slash": ("/", "/", "/"),
    "comma": (",", ",", ","),
    "cross-mark": (r"\times", "×", "x"),
    "bullet": (r"\bullet", "•", "*"),
    "circle": (r"\circ", "∘", "o"),
    "open": (r"\bigl( ", "(", "("),
    "close": (r" \bigr)", ")", ")"),
    "(": ("(", "(", "("),
    ")": (")", ")", ")"),
    "star": ("*", "*", "*"),
    "d": (r"\mathrm{d}", "d", "d"),
    "partial": (r"\partial ", "∂", "d"),
    "sum": (r"\sum", "Σ", "sum"),
    "integral": (r"\int", "∫", "integral"),
}
"""An operator in LaTeX, in Unicode and in ASCII, with the space around it."""

_STRUCK = '<menclose notation="updiagonalstrike">'
FORMS: dict[str, tuple[str, str, str]] = {
    "braces": ("{{{0}}}", "{0}", "<mrow>{0}</mrow>"),
    "blamed": ("{0}", "{0}", '<mrow class="blamed">{0}</mrow>'),
    "root": (r"\sqrt{{{0}}}", "sqrt({0})", "<msqrt>{0}</msqrt>"),
    "applied": (
        "{0} {1}",
        "{0}({1})",
        '<mrow><mspace width="0.17em"/>{0}<mo>\u2061</mo><mspace width="0.17em"/>{1}</mrow>',
    ),
    "degree": (r"\sqrt[{1}]{{{0}}}", "root({0}, {1})", "<mroot>{0}{1}</mroot>"),
    "over": (r"\overset{{{1}}}{{{0}}}", "{0}^({1})", "<mover>{0}{1}</mover>"),
    "under": (r"\underset{{{1}}}{{{0}}}", "{0}_({1})", "<munder>{0}{1}</munder>"),
    "overbrace": (r"\overbrace{{{0}}}", "{0}", "<mover>{0}<mo>⏞</mo></mover>"),
    "underbrace": (r"\underbrace{{{0}}}", "{0}", "<munder>{0}<mo>⏟</mo></munder>"),
    "boxed": (r"\boxed{{{0}}}", "{0}", '<menclose notation="box">{0}</menclose>'),
    "cancel": (r"\cancel{{{0}}}", "{0}", f"{_STRUCK}{{0}}</menclose>"),
    "cancelto": (r"\cancelto{{{1}}}{{{0}}}", "{1}", f"<msup>{_STRUCK}{{0}}</menclose>{{1}}</msup>"),
}
"""What is built of parts, in LaTeX, in text and in MathML; nothing is seen of braces.

Blamed is what a page shows as being at fault.
"""
DELIMITERS: dict[str, tuple[str, str]] = {
    "{": (r"\{", "{"),
    "}": (r"\}", "}"),
    "||": (r"\|", "‖"),
    "<": (r"\langle", "⟨"),
    ">": (r"\rangle", "⟩"),
    "⌊": (r"\lfloor", "⌊"),
    "⌋": (r"\rfloor", "⌋"),
    "⌈": (r"\lceil", "⌈"),
    "⌉": (r"\rceil", "⌉"),
    ".": (".", ""),
}
"""A bracket in LaTeX and as it is seen."""
_CLOSING = {"(": ")", "[": "]"}
ALIGNED = ("", "aligned")
"""Environments of rows that stand below one another with their relations."""
_AROUND = {"b": "[]", "p": "()", "v": "||", "V": "‖‖", "B": "{}", "c": "{.", "r": ".}"}
"""Brackets of an environment by its first letter: matrices, cases."""


def _brackets(box: Fence | Grid, column: int) -> tuple[str, ...]:
    """Return opening and closing bracket in a ``column`` of `DELIMITERS`."""
    if isinstance(box, Grid):
        opening, closing = tuple(_AROUND.get(box.environment[:1], ".."))
    else:
        opening, closing = box.opening, box.closing or _CLOSING[box.opening]
    return tuple(DELIMITERS.get(d, (d, d))[column] for d in (opening, closing))


_LATIN_CAPITALS = dict(
    zip(
        "Alpha Beta Epsilon Zeta Eta Iota Kappa Mu Nu Omicron Rho Tau Chi omicron".split(),
        "ABEZHIKMNOPTXo",
        strict=True,
    )
)
"""Greek letters for which LaTeX has no command."""


def render(box: Box, markup: str) -> str:
    """Return a box in one of `RENDERERS`. Raises `InputError` for other markup."""
    if markup not in RENDERERS:
        raise unknown_name("markup", markup, RENDERERS)
    written = _write(RENDERERS[markup], box)
    return unicodedata.normalize("NFC", written) if markup == "text" else written.strip()


def width(box: Box) -> int:
    """Return about how many letters wide a box is: the larger part of a fraction counts."""
    if isinstance(box, Formula):
        return _formula_width(box)
    if isinstance(box, Fraction):
        return width(box.beside) if box.beside else max(width(box.above), width(box.below))
    if isinstance(box, Row):
        return sum(width(i) for i in box.items) + len(box.gap) * max(0, len(box.items) - 1)
    if isinstance(box, Fence):
        return 2 + width(box.inner)
    if isinstance(box, Grid):
        return sum(2 + max(width(b) for b in c) for c in zip(*box.rows, strict=True))
    if isinstance(box, Form) and box.name == "applied":
        return sum(map(width, box.parts))
    return len([c for c in render(box, "text") if not unicodedata.combining(c)])


def _formula_width(box: Formula) -> int:
    opened = expression_box(box.value)
    if not isinstance(opened, Formula):
        return width(opened)
    value = box.value
    above, below = sp.fraction(value) if isinstance(value, sp.Expr) else (value, sp.S.One)
    return max(len(_plain_text(v).replace("*", "")) for v in (above, below))


def _plain_text(value: Expr) -> str:
    return str(value.tolist()) if isinstance(value, sp.MatrixBase) else str(value)


def _write(table: Mapping[type, Callable[[Any, Render], str]], box: Box) -> str:
    return table[type(box)](box, lambda inner: _write(table, inner))


def symbol_latex(name: str) -> str:
    r"""Return the LaTeX of a name.

    >>> symbol_latex("theta_dot"), symbol_latex("J12"), symbol_latex("radial_2")
    ('\\dot{\\theta}', 'J_{12}', '\\mathrm{radial}_{2}')
    """
    return render(symbol(name), "latex")


def greek(word: str) -> str:
    """Return the Greek letter of a name, other words as they are.

    >>> greek("omega"), greek("Omega"), greek("spin")
    ('ω', 'Ω', 'spin')
    """
    if word not in GREEK_NAMES:
        return word
    case = "CAPITAL" if word[0].isupper() else "SMALL"
    return unicodedata.lookup(f"GREEK {case} LETTER {word.upper().replace('LAMBDA', 'LAMDA')}")


_LETTERS = {greek(name): name for name in sorted(GREEK_NAMES - set(_LATIN_CAPITALS))}

# -- LaTeX -----------------------------------------------------------------------------------

_LATEX_STYLES = {
    "italic": "{}",
    "bold": r"\mathbf{{{}}}",
    "roman": r"\mathrm{{{}}}",
    "calligraphic": r"\mathcal{{{}}}",
    "blackboard": r"\mathbb{{{}}}",
}
_ESCAPES = {c: f"\\{c}" for c in "{}$&#%_"} | {
    "\\": "\\textbackslash{}",
    "^": "\\^{}",
    "~": "\\~{}",
    "<": "\\textless{}",
    ">": "\\textgreater{}",
    "|": "\\textbar{}",
    "×": "$\\times$",
    "·": "$\\cdot$",
    "−": "$-$",
    "≤": "$\\le$",
    "≥": "$\\ge$",
    "√": "$\\surd$",
    "→": "$\\to$",
    "–": "--",
    "—": "---",
    "’": "'",
}


def escape_latex(words: str) -> str:
    """Return words for LaTeX outside formulas; Greek letters become small formulas."""
    return "".join(_ESCAPES.get(c) or _ascii_latex(c) for c in words)


def _ascii_latex(character: str) -> str:
    if character.isascii():
        return character
    if character in _LETTERS:
        return f"$\\{_LETTERS[character]}$"
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return plain or "?"


def _latex_symbol(box: Symbol, _: Render) -> str:
    if box.name.isdigit() and box.style != "bold":
        return box.name
    if box.name in GREEK_NAMES:
        letter = _LATIN_CAPITALS.get(box.name, f"\\{box.name}")
        return f"\\boldsymbol{{{letter}}}" if box.style == "bold" else letter
    return _LATEX_STYLES[box.style].format(escape_latex(box.name))


def _latex_scripts(box: Scripts, inner: Render) -> str:
    signs = ((box.left_sub, "_"), (box.left, "^"), (box.sub, "_"), (box.sup, "^"))
    parts = [f"{sign}{{{inner(b).strip()}}}" if b else "" for b, sign in signs]
    left = "{}" * bool(box.left or box.left_sub) + "".join(parts[:2])
    return f"{left}{inner(box.base)}{''.join(parts[2:])}"


def _joined(box: Row, inner: Render) -> str:
    """Return the items of a row; a gap stands between those that are not empty."""
    return box.gap.join(filter(None, (inner(i) for i in box.items)))


def _latex_grid(box: Grid, inner: Render) -> str:
    name, aligned = box.environment, box.environment in ALIGNED
    lines = ([inner(b) for b in line] for line in box.rows)
    cells = [" ".join(filter(None, c)) if aligned else " & ".join(c) for c in lines]
    tall = not aligned and name != "" and any(r"\frac" in row for row in cells)
    rows = (r" \\[1ex] " if tall else r" \\ ").join(cells)
    columns = f"{{{box.columns}}}" if box.columns else ""
    return f"\\begin{{{name}}}{columns} {rows} \\end{{{name}}}" if name else rows


class _PositiveFirst:
    """A SymPy printer that begins a sum with a term that is added, if there is one."""

    def _as_ordered_terms(self, expr: Expr, order: Any = None) -> list[Any]:
        terms = list(super()._as_ordered_terms(expr, order=order))  # type: ignore[misc]
        added = next((t for t in terms if not t.as_coeff_Mul()[0].is_negative), terms[0])
        terms.remove(added)
        return [added, *terms]


class _Latex(_PositiveFirst, LatexPrinter):  # type: ignore[misc]
    """SymPy's LaTeX."""


def _opened(write: Render) -> Callable[[Formula, Render], str]:
    """Return what writes a formula as its boxes, and by ``write`` what has none but itself."""

    def rule(box: Formula, inner: Render) -> str:
        if isinstance(box.value, sp.Symbol) and isinstance(box.names.get(box.value), str):
            return write(box)
        boxes = expression_box(box.value, box.names)
        return write(boxes) if isinstance(boxes, Formula) else inner(boxes)

    return rule


def _latex_formula(box: Formula) -> str:
    symbols: set[Expr] = box.value.atoms(sp.Symbol)
    known = {s: box.names.get(s) or symbol_latex(s.name) for s in symbols}
    names = {s: n if isinstance(n, str) else render(n, "latex") for s, n in known.items()}
    words = any(names[s].startswith(r"\mathrm") for s in symbols)
    product = r" \, " if words else None
    settings = {"symbol_names": names, "mul_symbol": product, "mat_str": "matrix"}
    return str(_Latex(settings).doprint(box.value))


_LATEX: dict[type, Callable[[Any, Render], str]] = {
    Symbol: _latex_symbol,
    Sign: lambda b, _: b.latex,
    Form: lambda b, inner: FORMS[b.name][0].format(*map(inner, b.parts)),
    Accent: lambda b, inner: f"{ACCENTS[b.mark][0]}{{{inner(b.base)}}}",
    Scripts: _latex_scripts,
    Row: _joined,
    Fence: lambda b, inner: ("{1}{0}{2}" if b.flat else "\\left{1} {0} \\right{2}").format(
        inner(b.inner).strip(), *_brackets(b, 0)
    ),
    Fraction: lambda b, inner: (
        inner(b.beside) if b.beside else f"\\frac{{{inner(b.above)}}}{{{inner(b.below)}}}"
    ),
    Grid: _latex_grid,
    Operator: lambda b, _: OPERATORS[b.name][0],
    Formula: _opened(_latex_formula),
    Words: lambda b, _: f"\\text{{{escape_latex(b.text)}}}",
    Unseen: lambda b, inner: f"\\hphantom{{{inner(b.inner)}}}",
}

# -- text ------------------------------------------------------------------------------------

_LOWERED = dict(
    zip("0123456789+−=aehijklmnoprstuvxβγρφχ", "₀₁₂₃₄₅₆₇₈₉₊₋₌ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓᵦᵧᵨᵩᵪ", strict=True)
)
_RAISED = dict(
    zip(
        "0123456789+−ABDEGHIJKLMNOPRTUVW",
        "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻ᴬᴮᴰᴱᴳᴴᴵᴶᴷᴸᴹᴺᴼᴾᴿᵀᵁⱽᵂ",
        strict=True,
    )
)
_ALPHABETS = {
    "bold": "MATHEMATICAL BOLD",
    "calligraphic": "MATHEMATICAL SCRIPT",
    "blackboard": "MATHEMATICAL DOUBLE-STRUCK",
    "sans": "MATHEMATICAL SANS-SERIF",
    "fraktur": "MATHEMATICAL FRAKTUR",
    "typewriter": "MATHEMATICAL MONOSPACE",
}


def styled(name: str, style: str) -> str:
    """Return a letter of a mathematical alphabet where Unicode has it."""
    if style not in _ALPHABETS or (len(name) > 1 and name not in GREEK_NAMES):
        return greek(name)
    case = "CAPITAL" if name[0].isupper() else "SMALL"
    for alphabet in (_ALPHABETS[style], _ALPHABETS[style].removeprefix("MATHEMATICAL ")):
        try:
            return unicodedata.lookup(f"{alphabet} {case} {name.upper()}")
        except KeyError:
            continue
    return greek(name)


def _script(words: str, mark: str, letters: Mapping[str, str]) -> str:
    if all(c in letters for c in words):
        return "".join(letters[c] for c in words)
    bare = len(words) == 1 or words.isalnum() or set(words) <= set("•∘")
    return f"{mark}{words}" if bare else f"{mark}({words})"


def _index(box: Scripts, inner: Render) -> str:
    """Return what is below, of limits without where they start."""
    return inner(box.sub).partition(" = ")[0] if box.stacked else inner(box.sub)


def _text_scripts(box: Scripts, inner: Render) -> str:
    left = _script(inner(box.left_sub), "_", _LOWERED) if box.left_sub else ""
    left += _script(inner(box.left), "^", _RAISED) if box.left else ""
    left = f"{left} " if left.startswith(("^", "_")) else left
    sub = _script(_index(box, inner), "_", _LOWERED) if box.sub else ""
    sup = _script(inner(box.sup), "^", _RAISED) if box.sup and not box.stacked else ""
    return f"{left}{inner(box.base)}{sub}{sup}"


def _text_accent(box: Accent, inner: Render) -> str:
    base, mark = inner(box.base), ACCENTS[box.mark][1]
    if isinstance(box.base, Symbol | Accent):
        return "".join(c + mark for c in base) if box.mark == "underline" else base + mark
    return f"{box.mark.removeprefix('wide')}({base})"


def _text_grid(box: Grid, inner: Render) -> str:
    if box.environment in ALIGNED:
        return "; ".join(" ".join(inner(b) for b in line) for line in box.rows)
    return f"[{', '.join('[' + ', '.join(inner(b) for b in line) + ']' for line in box.rows)}]"


_GROUP = re.compile(r"[(\[|][^()\[\]|]*[)\]|]")


def _is_sum(words: str) -> bool:
    """Return whether a sign stands between terms outside of brackets."""
    while (inside := _GROUP.sub("", words)) != words:
        words = inside
    return any(sign in words for sign in (" + ", " \u2212 ", " - "))


def _text_fraction(box: Fraction, inner: Render) -> str:
    above, below = inner(box.above), inner(box.below)
    above = f"({above})" if _is_sum(above) else above
    return f"{above}/({below})" if " " in _GROUP.sub("", below) else f"{above}/{below}"


class _Text(_PositiveFirst, StrPrinter):  # type: ignore[misc]
    """SymPy expressions with Greek letters, dots, raised powers and no asterisks."""

    def _print_Pi(self, expr: Expr) -> str:  # noqa: ARG002 - SymPy's own
        return "\u03c0"

    def _print_Determinant(self, expr: Expr) -> str:
        return f"|{self._print(expr.arg.tolist())}|"

    def _print_Symbol(self, expr: Expr) -> str:
        return render(symbol(expr.name), "text")


def _text_formula(box: Formula) -> str:
    value = box.value.tolist() if isinstance(box.value, sp.MatrixBase) else box.value
    words = str(_Text().doprint(value))
    words = re.sub(r"\*\*(\d)(?![\d.])", lambda m: _RAISED[m[1]], words)
    words = re.sub(r"(?<![0-9]e)-", "\u2212", words)
    return words.replace("**", "^").replace("*", " ")


_TEXT: dict[type, Callable[[Any, Render], str]] = {
    Symbol: lambda b, _: styled(b.name, b.style if b.style == "blackboard" else ""),
    Sign: lambda b, _: b.text,
    Form: lambda b, inner: FORMS[b.name][1].format(*map(inner, b.parts)),
    Accent: _text_accent,
    Scripts: _text_scripts,
    Row: _joined,
    Fence: lambda b, inner: "{1}{0}{2}".format(inner(b.inner).strip(), *_brackets(b, 1)),
    Fraction: _text_fraction,
    Grid: _text_grid,
    Operator: lambda b, _: OPERATORS[b.name][1],
    Formula: _opened(_text_formula),
    Words: lambda b, _: b.text,
    Unseen: lambda b, inner: " " * width(b.inner),
}


def _ascii_scripts(box: Scripts, inner: Render) -> str:
    before = "".join(inner(b) + " " for b in (box.left_sub, box.left) if b)
    sub = f"_{_ascii_group(_index(box, inner))}" if box.sub else ""
    sup = f"^{_ascii_group(inner(box.sup))}" if box.sup and not box.stacked else ""
    return f"{before}{inner(box.base)}{sub}{sup}"


def _ascii_group(words: str) -> str:
    return words if words.isalnum() else f"({words})"


def _ascii_sign(box: Sign, _: Render) -> str:
    words = re.findall("[A-Za-z0-9]+", box.latex)
    return box.text if box.text.isascii() else words[-1] if words else " "


_ASCII: dict[type, Callable[[Any, Render], str]] = {
    **_TEXT,
    Symbol: lambda b, _: b.name,
    Sign: _ascii_sign,
    Fence: lambda b, inner: (
        f"{b.opening}{inner(b.inner).strip()}{b.closing or _CLOSING[b.opening]}"
    ),
    Accent: lambda b, inner: f"{inner(b.base)}_{b.mark}",
    Scripts: _ascii_scripts,
    Operator: lambda b, _: OPERATORS[b.name][2],
    Formula: lambda b, _: _plain_text(b.value),
}

# -- MathML ----------------------------------------------------------------------------------


class _MathML(_PositiveFirst, MathMLPresentationPrinter):  # type: ignore[misc]
    """SymPy expressions with the names of `symbol`."""

    def _print_Determinant(self, expr: Expr) -> Any:
        kept, self._settings["mat_delim"] = self._settings["mat_delim"], ""
        found = super()._print_Determinant(expr)
        self._settings["mat_delim"] = kept
        return found

    def _print_Symbol(self, sym: Expr, style: str = "plain") -> Any:  # noqa: ARG002 - SymPy's own
        node = parseString(_write(_MATHML, symbol(sym.name))).documentElement  # noqa: S318 - our own text
        return self.dom.importNode(node, True)


_ENTITY = re.compile(r"&(?!(?:lt|gt|amp|quot);)(\w+);")


def _mathml_formula(box: Formula) -> str:
    words = str(_MathML().doprint(box.value)).replace("<mo>-</mo>", "<mo>\u2212</mo>")
    return f"<mrow>{_ENTITY.sub(lambda m: html.unescape(m[0]), words)}</mrow>"


_BOLD_DIGITS = {ord(str(k)): chr(0x1D7CE + k) for k in range(10)}
"""Digits in bold, as unit matrices are written; browsers know no other way to write them."""


def _mathml_symbol(box: Symbol, _: Render) -> str:
    if box.name.isdigit():
        return f"<mn>{box.name.translate(_BOLD_DIGITS) if box.style == 'bold' else box.name}</mn>"
    letter = html.escape(styled(box.name, box.style))
    upright = box.style == "roman" and len(letter) == 1
    return f'<mi mathvariant="normal">{letter}</mi>' if upright else f"<mi>{letter}</mi>"


def _mathml_sign(box: Sign, _: Render) -> str:
    words = html.escape(box.text)
    if box.tag == "normal":
        kind = ' mathvariant="normal"' if len(box.text) == 1 else ""
        return f"<mi{kind}>{words}</mi>"
    words = words.replace(" ", "\u00a0") if box.tag == "mtext" else words
    return f"<{box.tag}>{words}</{box.tag}>"


def _mathml_row(box: Row, inner: Render) -> str:
    """Return the items of a row; before a function with its bracket there is a little room."""
    first = box.items[0] if len(box.items) == 2 and isinstance(box.items[1], Fence) else None
    name = first.base if isinstance(first, Scripts) else first
    called = isinstance(name, Sign) and name.tag == "mi" and len(name.text) > 1
    gap = '<mspace width="0.17em"/>' if called else ""
    return f"<mrow>{gap}{''.join(inner(i) for i in box.items)}</mrow>"


def _mathml_scripts(box: Scripts, inner: Render) -> str:
    sub, sup = (inner(b) if b else "" for b in (box.sub, box.sup))
    base = inner(box.base)
    if box.left and not box.left_sub and (sub or sup):  # beside, as engines leave gaps in one
        left = f"<msup><mrow/>{inner(box.left)}</msup>"
        return f"<mrow>{left}{_mathml_scripts(replace(box, left=None), inner)}</mrow>"
    if box.left or box.left_sub:
        before = (inner(b) if b else "<mrow/>" for b in (box.left_sub, box.left))
        behind = f"{sub or '<mrow/>'}{sup or '<mrow/>'}"
        return f"<mmultiscripts>{base}{behind}<mprescripts/>{''.join(before)}</mmultiscripts>"
    under, over = ("under", "over") if box.stacked else ("sub", "sup")
    tag = f"m{under * bool(sub)}{over * bool(sup)}"
    return f"<{tag}>{base}{sub}{sup}</{tag}>" if sub or sup else base


def _is_compound(box: Box) -> bool:
    base = box.base if isinstance(box, Scripts) else box
    return isinstance(base, Row | Fence | Grid | Formula | Fraction)


def _mathml_accent(box: Accent, inner: Render) -> str:
    """Return a mark on a letter; a tilde on more stands raised behind it, as browsers have no wide one."""
    if box.mark == "widetilde" and _is_compound(box.base):
        held = box.base if isinstance(box.base, Grid | Fence) else Fence(box.base)
        return f"<msup>{inner(held)}<mo>\u223c</mo></msup>"
    tag, kind = ("munder", "") if "under" in box.mark else ("mover", ' accent="true"')
    return f"<{tag}{kind}>{inner(box.base)}<mo>{ACCENTS[box.mark][2]}</mo></{tag}>"


def _mathml_fenced(box: Fence | Grid, middle: str) -> str:
    brackets = _brackets(box, 1)
    tall = re.search("<mfrac|<mtable|∑|∫", middle)
    flat = "" if tall else ' stretchy="false"'
    opening, closing = (f"<mo{flat}>{html.escape(d)}</mo>" if d else "" for d in brackets)
    return f"<mrow>{opening}{middle}{closing}</mrow>"


def _mathml_grid(box: Grid, inner: Render) -> str:
    """Return a table; fractions in it are as large as beside it."""
    cells = ["".join(f"<mtd>{inner(b)}</mtd>" for b in line) for line in box.rows]
    kind = ' displaystyle="true"' if any("<mfrac" in line for line in cells) else ""
    kind = ' columnalign="right left" displaystyle="true"' if box.environment in ALIGNED else kind
    table = f"<mtable{kind}>{''.join(f'<mtr>{c}</mtr>' for c in cells)}</mtable>"
    return _mathml_fenced(box, table)


_MATHML_FORMS = {
    "negative": ' form="prefix"',
    "plus": ' form="infix"',
    "minus": ' form="infix"',
    "open": ' stretchy="false"',
    "close": ' stretchy="false"',
    "(": ' form="prefix" stretchy="false"',
    ")": ' form="postfix" stretchy="false"',
    "slash": ' lspace="0" rspace="0"',
}


def _mathml_operator(box: Operator, _: Render) -> str:
    if box.name == "d":
        return '<mi mathvariant="normal">d</mi>'
    words = html.escape(OPERATORS[box.name][1].strip())
    words = {"times": "\u2062", "thin": "\u2062", ":=": "≜", "sum": "∑"}.get(box.name, words)
    form = _MATHML_FORMS.get(box.name, "")
    form = ' lspace="0" rspace="0.17em"' if box.name == "thin" else form
    return f"<mo{form}>{words}</mo>"


_MATHML: dict[type, Callable[[Any, Render], str]] = {
    Symbol: _mathml_symbol,
    Sign: _mathml_sign,
    Form: lambda b, inner: FORMS[b.name][2].format(*map(inner, b.parts)),
    Accent: _mathml_accent,
    Scripts: _mathml_scripts,
    Row: _mathml_row,
    Fence: lambda b, inner: _mathml_fenced(b, inner(b.inner)),
    Fraction: lambda b, inner: (
        inner(b.beside) if b.beside else f"<mfrac>{inner(b.above)}{inner(b.below)}</mfrac>"
    ),
    Grid: _mathml_grid,
    Operator: _mathml_operator,
    Formula: _opened(_mathml_formula),
    Words: lambda b, _: f"<mtext>{html.escape(b.text)}</mtext>",
    Unseen: lambda b, inner: (
        f'<mpadded height="0" depth="0"><mphantom>{inner(b.inner)}</mphantom></mpadded>'
    ),
}

RENDERERS: dict[str, Mapping[type, Callable[[Any, Render], str]]] = {
    "latex": _LATEX,
    "text": _TEXT,
    "ascii": _ASCII,
    "mathml": _MATHML,
}
