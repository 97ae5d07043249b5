"""How LaTeX, Unicode text, ASCII and presentation MathML write the boxes of a formula.

A renderer is a table with one row a kind of box; SymPy expressions are left to SymPy's own printers,
with the names of `eom.typeset.boxes.symbol`.
"""

from __future__ import annotations

import html
import re
import unicodedata
from collections.abc import Callable, Mapping
from typing import Any
from xml.dom.minidom import parseString

import sympy as sp
from sympy.printing.mathml import MathMLPresentationPrinter
from sympy.printing.str import StrPrinter

from eom.errors import unknown_name
from eom.typeset.boxes import (
    GREEK_NAMES,
    Accent,
    Big,
    Box,
    Fence,
    Formula,
    Fraction,
    Grid,
    Operator,
    Row,
    Scripts,
    Symbol,
    Unseen,
    Words,
    symbol,
)

Expr = Any
Render = Callable[[Any], str]

ACCENTS: dict[str, tuple[str, str, str]] = {
    "vec": (r"\vec", "\u20d7", "→"),
    "hat": (r"\hat", "\u0302", "^"),
    "dot": (r"\dot", "\u0307", "˙"),
    "ddot": (r"\ddot", "\u0308", "¨"),
    "tilde": (r"\tilde", "\u0303", "~"),
    "widetilde": (r"\widetilde", "\u0303", "~"),
    "underline": (r"\underline", "\u0332", "_"),
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
    "star": ("*", "*", "*"),
    "d": (r"\mathrm{d}", "d", "d"),
    "partial": (r"\partial ", "∂", "d"),
}
"""An operator in LaTeX, in Unicode and in ASCII, with the space around it."""

SIGNS: dict[str, tuple[str, str, str]] = {
    "sum": (r"\sum", "Σ", "sum"),
    "integral": (r"\int", "∫", "integral"),
}
_CLOSING = {"(": ")", "[": "]"}


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
        return _formula_width(box.value)
    if isinstance(box, Fraction):
        return max(width(box.above), width(box.below))
    if isinstance(box, Row):
        return sum(width(i) for i in box.items)
    if isinstance(box, Fence):
        return 2 + width(box.inner)
    if isinstance(box, Grid):
        return sum(4 + max(width(b) for b in c) for c in zip(*box.rows, strict=True))
    return len([c for c in render(box, "text") if not unicodedata.combining(c)])


def _formula_width(value: Expr) -> int:
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
    left = f"{{}}^{{{inner(box.left).strip()}}}" if box.left else ""
    sub = f"_{{{inner(box.sub).strip()}}}" if box.sub else ""
    sup = f"^{{{inner(box.sup).strip()}}}" if box.sup else ""
    return f"{left}{inner(box.base)}{sub}{sup}"


def _latex_grid(box: Grid, inner: Render) -> str:
    rows = r" \\ ".join(" & ".join(inner(b) for b in line) for line in box.rows)
    return f"\\begin{{bmatrix}} {rows} \\end{{bmatrix}}"


def _latex_big(box: Big, inner: Render) -> str:
    upper = f"^{{{inner(box.upper)}}}" if box.upper else ""
    return f"{SIGNS[box.sign][0]}_{{{inner(box.lower)}}}{upper} "


def _latex_formula(box: Formula, _: Render) -> str:
    symbols: set[Expr] = box.value.atoms(sp.Symbol)
    names = {s: box.names.get(s) or symbol_latex(s.name) for s in symbols}
    words = any(names[s].startswith(r"\mathrm") for s in symbols)
    product = r" \, " if words else None
    return str(sp.latex(box.value, symbol_names=names, mul_symbol=product, mat_str="matrix"))


_LATEX: dict[type, Callable[[Any, Render], str]] = {
    Symbol: _latex_symbol,
    Accent: lambda b, inner: f"{ACCENTS[b.mark][0]}{{{inner(b.base)}}}",
    Scripts: _latex_scripts,
    Row: lambda b, inner: "".join(inner(i) for i in b.items),
    Fence: lambda b, inner: (
        f"\\left{b.opening} {inner(b.inner).strip()} \\right{_CLOSING[b.opening]}"
    ),
    Fraction: lambda b, inner: f"\\frac{{{inner(b.above)}}}{{{inner(b.below)}}}",
    Grid: _latex_grid,
    Big: _latex_big,
    Operator: lambda b, _: OPERATORS[b.name][0],
    Formula: _latex_formula,
    Words: lambda b, _: f"\\text{{{escape_latex(b.text)}}}",
    Unseen: lambda b, inner: f"\\phantom{{{inner(b.inner)}}}",
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


def _index(lower: str) -> str:
    """Return the index of a sum without where it starts."""
    return lower.partition(" = ")[0]


def _text_scripts(box: Scripts, inner: Render) -> str:
    left = _script(inner(box.left), "^", _RAISED) if box.left else ""
    left = f"{left} " if left.startswith("^") else left
    sub = _script(inner(box.sub), "_", _LOWERED) if box.sub else ""
    sup = _script(inner(box.sup), "^", _RAISED) if box.sup else ""
    return f"{left}{inner(box.base)}{sub}{sup}"


def _text_accent(box: Accent, inner: Render) -> str:
    base, mark = inner(box.base), ACCENTS[box.mark][1]
    if isinstance(box.base, Symbol | Accent):
        return "".join(c + mark for c in base) if box.mark == "underline" else base + mark
    return f"{box.mark.removeprefix('wide')}({base})"


def _text_grid(box: Grid, inner: Render) -> str:
    return f"[{', '.join('[' + ', '.join(inner(b) for b in line) + ']' for line in box.rows)}]"


def _text_fraction(box: Fraction, inner: Render) -> str:
    parts = [inner(b) for b in (box.above, box.below)]
    return "/".join(p if " " not in p else f"({p})" for p in parts)


class _Text(StrPrinter):  # type: ignore[misc]
    """SymPy expressions with Greek letters, dots, raised powers and no asterisks."""

    def _print_Symbol(self, expr: Expr) -> str:
        return render(symbol(expr.name), "text")


def _text_formula(box: Formula, _: Render) -> str:
    value = box.value.tolist() if isinstance(box.value, sp.MatrixBase) else box.value
    words = str(_Text().doprint(value))
    words = re.sub(r"\*\*(\d)(?![\d.])", lambda m: _RAISED[m[1]], words)
    return words.replace("**", "^").replace("*", " ")


_TEXT: dict[type, Callable[[Any, Render], str]] = {
    Symbol: lambda b, _: styled(b.name, b.style if b.style == "blackboard" else ""),
    Accent: _text_accent,
    Scripts: _text_scripts,
    Row: lambda b, inner: "".join(inner(i) for i in b.items),
    Fence: lambda b, inner: f"{b.opening}{inner(b.inner).strip()}{_CLOSING[b.opening]}",
    Fraction: _text_fraction,
    Grid: _text_grid,
    Big: lambda b, inner: f"{SIGNS[b.sign][1]}{_script(_index(inner(b.lower)), '_', _LOWERED)} ",
    Operator: lambda b, _: OPERATORS[b.name][1],
    Formula: _text_formula,
    Words: lambda b, _: b.text,
    Unseen: lambda b, inner: " " * width(b.inner),
}


def _ascii_scripts(box: Scripts, inner: Render) -> str:
    parts = [("_", box.sub), ("^", box.sup)]
    after = "".join(m + _ascii_group(inner(b)) for m, b in parts if b)
    return f"{inner(box.left) + ' ' if box.left else ''}{inner(box.base)}{after}"


def _ascii_group(words: str) -> str:
    return words if words.isalnum() else f"({words})"


_ASCII: dict[type, Callable[[Any, Render], str]] = {
    **_TEXT,
    Symbol: lambda b, _: b.name,
    Accent: lambda b, inner: f"{inner(b.base)}_{b.mark}",
    Scripts: _ascii_scripts,
    Big: lambda b, inner: f"{SIGNS[b.sign][2]}_{_index(inner(b.lower))} ",
    Operator: lambda b, _: OPERATORS[b.name][2],
    Formula: lambda b, _: _plain_text(b.value),
}

# -- MathML ----------------------------------------------------------------------------------


class _MathML(MathMLPresentationPrinter):  # type: ignore[misc]
    """SymPy expressions with the names of `symbol`."""

    def _print_Symbol(self, sym: Expr, style: str = "plain") -> Any:  # noqa: ARG002 - SymPy's own
        node = parseString(_write(_MATHML, symbol(sym.name))).documentElement  # noqa: S318 - our own text
        return self.dom.importNode(node, True)


_ENTITY = re.compile(r"&(?!(?:lt|gt|amp|quot);)(\w+);")


def _mathml_formula(box: Formula, _: Render) -> str:
    words = str(_MathML().doprint(box.value))
    return f"<mrow>{_ENTITY.sub(lambda m: html.unescape(m[0]), words)}</mrow>"


def _mathml_symbol(box: Symbol, _: Render) -> str:
    if box.name.isdigit():
        return f"<mn>{box.name}</mn>"
    letter = html.escape(styled(box.name, box.style))
    upright = box.style == "roman" and len(letter) == 1
    return f'<mi mathvariant="normal">{letter}</mi>' if upright else f"<mi>{letter}</mi>"


def _mathml_scripts(box: Scripts, inner: Render) -> str:
    sub, sup, left = (inner(b) if b else "" for b in (box.sub, box.sup, box.left))
    if left:
        below, above = sub or "<mrow/>", sup or "<mrow/>"
        base = f"{inner(box.base)}{below}{above}<mprescripts/><mrow/>{left}"
        return f"<mmultiscripts>{base}</mmultiscripts>"
    tag = f"m{'sub' * bool(sub)}{'sup' * bool(sup)}"
    return f"<{tag}>{inner(box.base)}{sub}{sup}</{tag}>" if sub or sup else inner(box.base)


def _mathml_accent(box: Accent, inner: Render) -> str:
    tag, kind = ("munder", "accentunder") if box.mark == "underline" else ("mover", "accent")
    return f'<{tag} {kind}="true">{inner(box.base)}<mo>{ACCENTS[box.mark][2]}</mo></{tag}>'


def _mathml_grid(box: Grid, inner: Render) -> str:
    cells = ("".join(f"<mtd>{inner(b)}</mtd>" for b in line) for line in box.rows)
    table = f"<mtable>{''.join(f'<mtr>{c}</mtr>' for c in cells)}</mtable>"
    return f"<mrow><mo>[</mo>{table}<mo>]</mo></mrow>"


def _mathml_big(box: Big, inner: Render) -> str:
    sign = {"sum": "∑"}.get(box.sign, SIGNS[box.sign][1])
    tags = ("munder", "munderover") if box.sign == "sum" else ("msub", "msubsup")
    tag = tags[box.upper is not None]
    upper = inner(box.upper) if box.upper else ""
    return f"<{tag}><mo>{sign}</mo>{inner(box.lower)}{upper}</{tag}>"


_MATHML_FORMS = {
    "negative": ' form="prefix"',
    "open": ' stretchy="false"',
    "close": ' stretchy="false"',
}


def _mathml_operator(box: Operator, _: Render) -> str:
    if box.name == "d":
        return '<mi mathvariant="normal">d</mi>'
    words = html.escape(OPERATORS[box.name][1].strip())
    words = {"times": "\u2062", "thin": "\u2062", ":=": "≜"}.get(box.name, words)
    form = _MATHML_FORMS.get(box.name, "")
    return f"<mo{form}>{words}</mo>"


_MATHML: dict[type, Callable[[Any, Render], str]] = {
    Symbol: _mathml_symbol,
    Accent: _mathml_accent,
    Scripts: _mathml_scripts,
    Row: lambda b, inner: f"<mrow>{''.join(inner(i) for i in b.items)}</mrow>",
    Fence: lambda b, inner: (
        f"<mrow><mo>{b.opening}</mo>{inner(b.inner)}<mo>{_CLOSING[b.opening]}</mo></mrow>"
    ),
    Fraction: lambda b, inner: f"<mfrac>{inner(b.above)}{inner(b.below)}</mfrac>",
    Grid: _mathml_grid,
    Big: _mathml_big,
    Operator: _mathml_operator,
    Formula: _mathml_formula,
    Words: lambda b, _: f"<mtext>{html.escape(b.text)}</mtext>",
    Unseen: lambda b, inner: f"<mphantom>{inner(b.inner)}</mphantom>",
}

RENDERERS: dict[str, Mapping[type, Callable[[Any, Render], str]]] = {
    "latex": _LATEX,
    "text": _TEXT,
    "ascii": _ASCII,
    "mathml": _MATHML,
}
