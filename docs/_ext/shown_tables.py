"""Tables that are made from the package's own data, so that they cannot fall behind it.

In a page: a block ``{shown-table} NAME`` with a name of `TABLES`.
"""

import itertools
import re
import tomllib
from collections.abc import Callable, Iterable, Sequence
from typing import ClassVar

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx

from eom.checker.report.page import mathml

Rows = list[tuple[str, ...]]


def _books() -> Rows:
    from eom.scenes.conventions import BOOKS

    return [
        (f"`{name}`", title, made.direction, made.order, made.scalar, made.products,
         made.sequence, f"{made.reference}, {made.body}")
        for name, (title, made) in BOOKS.items()
    ]  # fmt: skip


def _choices() -> Rows:
    from eom.scenes.conventions import CHOICES, HOUSE

    return [
        (name, f"{value} (here)" if value == getattr(HOUSE, name) else value, meaning)
        for name, values in CHOICES.items()
        for value, meaning in values.items()
    ]


def _methods() -> Rows:
    from codegen.integrate.methods import ROWS

    words = {True: "yes", False: "no"}
    return [(f"`{m.name}`", m.meaning, words[m.projects], words[m.finds]) for m in ROWS]


def _assumptions() -> Rows:
    from eom.worlds.worlds import ASSUMPTIONS

    return [
        (f"`{name}`", row.meaning, row.kind, ", ".join(f"`{n}`" for n in row.needs))
        for name, row in ASSUMPTIONS.items()
    ]


def _scenes() -> Rows:
    from eom.scenes import catalogue

    return [(f"`{name}`", title) for name, title in catalogue.titles().items()]


def _derivations() -> Rows:
    from eom.derivations import titles

    return [
        (group, f"`{name}`", title)
        for group, made in titles().items()
        for name, title in made.items()
    ]


def _targets() -> Rows:
    from codegen.compiling.compiled import ROWS

    return [(f"`{name}`", f".{row.extension}") for name, row in sorted(ROWS.items())]


def _presets() -> Rows:
    from importlib import resources

    folder = resources.files("eom.checker.mean") / "presets"
    files = sorted((p for p in folder.iterdir() if p.name.endswith(".toml")), key=lambda p: p.name)
    texts = [(p.name.removesuffix(".toml"), p.read_text(encoding="utf-8")) for p in files]
    return [(f"`{name}`", _first_sentence(text)) for name, text in texts]


def _first_sentence(text: str) -> str:
    """Return the first sentence of the comment that a file begins with."""
    lines = itertools.takewhile(lambda line: line.startswith("#"), text.splitlines())
    return " ".join(line.lstrip("# ") for line in lines).split(". ")[0].rstrip(".")


LABELS = {
    "internal_force": ("i", "j"),
    "eigenvectors": ("B", "A"),
    "turn_angle": ("1", "313", "B", "I"),
    "fixed_vector": ("a", "B"),
    "dyadic": ("D",),
}
"""Labels of quantities that no preset has, where they are not numbers."""
OWN_ENTRIES = {
    "defined": (r"\vec{a}", "by the first equation of the note that has it alone on one side", ""),
    "equals": (
        r"\vec{v}",
        "what a formula says; written with a sign of equality",
        r"= \dot{\vec{r}}",
    ),
    "vectrix": (r"\mathcal{F}_B", "column of the unit vectors of frame (1)", "vectrix B"),
    "time": ("t", "time", ""),
    "skew": ("S", "function: the skew matrix of a vector, S(a) b = a x b", ""),
    "system": ("A", "what the note's system calls (1)", "system I1"),
    "turn": (
        r"C_{<k>}",
        "function: components after a turn of the frame about axis (1)",
        "turn <k>",
    ),
    "active_turn": (r"R_{<k>}", "function: the inverse of turn", "active_turn <k>"),
    "quaternion": (
        "q",
        "column of the Euler parameters of frame (1) in (2), scalar first",
        "quaternion B I",
    ),
    "velocity": (
        r"\vec{v}_P",
        "velocity of (1) relative to (2), as seen in (3)",
        "velocity P OI I",
    ),
    "acceleration": (
        r"\vec{a}_P",
        "acceleration of (1) relative to (2), as seen in (3)",
        "acceleration P OI I",
    ),
    "quaternion_last": (r"\bar{q}", "the same, scalar last", "quaternion_last B I"),
    "quaternion_left": ("L", "function: matrix of a product from the left, L(p) q = p q", ""),
    "quaternion_right": ("R", "function: matrix of a product from the right, R(q) p = p q", ""),
    "omega_matrix": (r"\Omega", "function: 2 dq/dt = Omega(w) q", ""),
    "xi_matrix": (r"\Xi", "function: 2 dq/dt = Xi(q) w", ""),
    "spatial_cross": ("S", "function: matrix of the cross product of spatial motions", ""),
    "spatial_cross_dual": ("S", "function: matrix of the cross product with a spatial force", ""),
    "coordinates": ("q", "column of the coordinates of the note's system", ""),
    "mass_matrix": ("M", "mass matrix of its kinetic energy", ""),
    "coriolis_matrix": ("C", "matrix of velocities by Christoffel's symbols", ""),
    "gravity_column": ("g", "slopes of its potential energy", ""),
    "force_column": (r"\tau", "its generalised forces", ""),
    "place": ("p", "place of its body (1), by components", "place tip component 1 2"),
    "jacobian": ("J", "slopes of the place of its body (1)", "jacobian tip component 1 2"),
    "column": ("a", "any column (1) of (2) numbers; constant", "column a 2 constant"),
    "matrix": (
        "K",
        "any matrix (1), (2) x (3), constant, symmetric, skew, diagonal, identity",
        "matrix K 2 2 symmetric of q",
    ),
}
"""Entries, LaTeX, words and meaning, of what the checker alone knows; no meaning: the name."""


def entries() -> dict[str, tuple[str, str, str]]:
    """Return LaTeX, words and meaning of an entry for every quantity: from a preset, or typeset."""
    from eom.checker.mean.lexicon import OWN, TABLED
    from eom.checker.mean.lexicon_files import PRESETS
    from eom.terms.vocabulary import QUANTITIES, quantity
    from eom.typeset.letters import ROLES
    from eom.typeset.notation import NOTATIONS
    from eom.typeset.writing import write

    known = {}
    for preset in PRESETS:
        for latex, meaning in _preset(preset).items():
            known.setdefault(meaning.split()[0], (latex, meaning))
    found = {}
    for name, row in QUANTITIES.items():
        places = row.words.count("{")
        usual = tuple("a" if r == "letter" else "1" for r in ROLES.get(name, ("",) * places))
        labels = LABELS.get(name, usual)
        latex = write(quantity(name, *labels), NOTATIONS["arrow"], "latex")
        made = (latex.removeprefix(r"\left[ ").removesuffix(r" \right]"), " ".join((name, *labels)))
        latex, meaning = known.get(name, made)
        found[name] = (latex, row.words.format("(1)", "(2)", "(3)", "(4)"), meaning)
    return found | {
        n: (latex, words, meaning or n)
        for n in [*OWN, *sorted(TABLED - {*QUANTITIES})]
        for latex, words, meaning in [OWN_ENTRIES[n]]
    }


def _preset(name: str) -> dict[str, str]:
    from importlib import resources

    text = (resources.files("eom.checker.mean") / "presets" / f"{name}.toml").read_text(
        encoding="utf-8"
    )
    symbols = tomllib.loads(text)["symbols"]
    return {
        latex: m for latex, m in symbols.items() if isinstance(m, str) and not m.startswith("=")
    }


def _quantities() -> Rows:
    return [
        (f"`{n}`", words, f"`'{latex}' = \"{m}\"`") for n, (latex, words, m) in entries().items()
    ]


def _tree_outputs() -> Rows:
    from eom.multibody.files.scene import GROUPS

    groups = [(f"`{word}`", ", ".join(f"`{n}`" for n in names)) for word, names in GROUPS.items()]
    return [
        *groups,
        ("`reactions`", "forces and torques through joints: `F_JOINT_1`, ..., `M_JOINT_3`"),
        ("`drives`", "what moves prescribed joints: `tau_JOINT`"),
        ("`points`", "points of bodies: `x_POINT_1`, `v_POINT_1`, `a_POINT_1`, ..."),
        ("`constraint_forces`", "multipliers: `lambda_CONSTRAINT`, ..."),
    ]


def _units() -> Rows:
    from eom.units import ROWS

    return [
        (f"`{name}`", str(row.factor), f"`{row.text}`" if row.text != name else "")
        for name, row in ROWS.items()
        if name != "1"
    ]


def _prefixes() -> Rows:
    from eom.units import PREFIXES

    return [(f"`{name}`", f"10^{power}") for name, power in PREFIXES.items()]


def _pictures() -> Rows:
    from eom.views.gallery import PICTURES

    return [(f"`{name}`", entry.words, entry.needs) for name, entry in PICTURES.items()]


def _sequences() -> Rows:
    """Return of each sequence its matrix, the rates of its angles, and where they fail."""
    import sympy as sp

    from eom.kinematics.coordinates import SEQUENCES, attitude
    from eom.kinematics.frames import vector

    omega = sp.symbols("omega_1:4")
    rows: Rows = []
    for name in SEQUENCES:
        made = attitude(name)
        i, j, k = (int(n) for n in name.split("-"))
        first, second, third = made.rates(vector("B", omega))
        along = sp.simplify((third - omega[k - 1]) / first)
        last = str(omega[k - 1] + along * sp.Symbol("psi'"))
        (singular,) = made.singularities
        rows.append(
            (
                name,
                f"`C_{k}(phi) C_{j}(theta) C_{i}(psi)`",
                *(f"`{sp.simplify(rate)}`" for rate in (first, second)),
                f"`{last}`",
                f"`{singular.expression} = 0`",
            )
        )
    return rows


def _statements() -> Rows:
    from tests.statements import ROWS

    return [
        (row.sentence, _place(row.where), row.name.replace(".", ": ").replace("_", " "))
        for row in ROWS
    ]


def _place(where: str) -> str:
    """Return where a sentence stands, in words."""
    if where.startswith("derive "):
        _, name, label = where.split(" ")
        return f"`eom derive {name}`, step `{label}`"
    if where.startswith("eom."):
        parts = where.split(".")
        return f"docstring of `{'.'.join(parts[-2:] if parts[-2][0].isupper() else parts[-1:])}`"
    return f"`{where.removeprefix('docs/').removeprefix('notebooks/')}`"


TABLES: dict[str, tuple[tuple[str, ...], Callable[[], Rows]]] = {
    "books": (
        ("name", "book or program", "matrix", "angles turn about", "scalar", "products", "angles", "axes"),
        _books,
    ),
    "choices": (("choice", "value", "meaning"), _choices),
    "methods": (("method", "what it is", "projects", "finds events"), _methods),
    "assumptions": (("assumption", "meaning", "kind", "needs"), _assumptions),
    "scenes": (("scene", "title"), _scenes),
    "derivations": (("chapter", "derivation", "title"), _derivations),
    "targets": (("target", "files"), _targets),
    "presets": (("preset", "title"), _presets),
    "quantities": (("quantity", "what it is, with its labels by number", "an entry"), _quantities),
    "pictures": (("picture", "what it shows", "of"), _pictures),
    "units": (("unit", "how many", "of"), _units),
    "sequences": (
        ("sequence", "matrix", "psi'", "theta'", "phi'", "singular where"),
        _sequences,
    ),
    "statements": (("sentence", "where it stands", "what computes it"), _statements),
    "prefixes": (("prefix", "how many"), _prefixes),
    "tree-outputs": (("word", "outputs"), _tree_outputs),
}  # fmt: skip


def inline(text: str) -> list[nodes.Node]:
    """Return words, with what stands in backticks as code, and formulas between dollars as such."""
    made: list[nodes.Node] = []
    for k, piece in enumerate(text.split("`")):
        if k % 2:
            made.append(nodes.literal(piece, piece))
        else:
            made += [
                _formula(p) if n % 2 else nodes.Text(p)
                for n, p in enumerate(_MATH.split(piece))
                if p
            ]
    return made


_MATH = re.compile(r"\${1,2}([^$]+)\${1,2}")


def _formula(latex: str) -> nodes.Node:
    """Return a formula; where it is a part that has no MathML, as code."""
    drawn = mathml(latex.strip(), display=False).startswith("<math")
    return nodes.math(latex, latex.strip()) if drawn else nodes.literal(latex, latex)


def _row(cells: Iterable[str]) -> nodes.row:
    return nodes.row("", *(nodes.entry("", nodes.paragraph("", "", *inline(c))) for c in cells))


def table(head: Sequence[str], rows: Rows) -> nodes.table:
    """Return a table as a node of the page; columns as wide as their words."""
    columns = [nodes.colspec(colwidth=1) for _ in head]
    group = nodes.tgroup("", *columns, nodes.thead("", _row(head)), cols=len(head))
    group += nodes.tbody("", *map(_row, rows))
    return nodes.table("", group, classes=["colwidths-auto"])


class ShownTable(Directive):
    """``{shown-table} NAME``."""

    required_arguments = 1
    option_spec: ClassVar = {}

    def run(self) -> list[nodes.Node]:
        """Return the table."""
        head, rows = TABLES[self.arguments[0]]
        return [table(head, rows())]


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the block."""
    app.add_directive("shown-table", ShownTable)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
