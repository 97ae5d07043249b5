"""``python -m benchmarks.house [--check]``: how large the product is, and how it hangs together.

Modules and lines of both packages (Python), the fullest folder, circles of imports between files and
between folders, private names that other modules use, and lengths of functions. All imports count, also
late ones and those for types alone.
``--check`` fails where a figure is worse than `LIMITS`, as a test does.
"""

from __future__ import annotations

import ast
import math
import sys
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("eom", "codegen")
NINTH_DECILE = 0.9
BLOCKS = ("body", "orelse", "finalbody", "handlers", "cases")

Graph = Mapping[str, set[str]]

LIMITS = {
    "modules": 547,
    "lines of code": 110_750,
    "modules in the fullest folder": 23,
    "folders of more than 25 modules": 0,
    "circles of files": 0,
    "circles of folders": 0,
    "private names of other modules": 0,
    "lines of functions, ninth decile": 17,
}
"""What no change may make worse; a change that makes one better lowers it."""


@dataclass(frozen=True)
class Module:
    """A module: its dotted ``name``, whether it is a folder's own, and its text."""

    name: str
    is_folder: bool
    text: str

    @cached_property
    def tree(self) -> ast.Module:
        """The module, parsed."""
        return ast.parse(self.text)

    @cached_property
    def nodes(self) -> list[ast.AST]:
        """All nodes of the module."""
        return list(ast.walk(self.tree))

    @property
    def folder(self) -> str:
        """The dotted name of the folder that it lies in."""
        return self.name if self.is_folder else self.name.rpartition(".")[0]

    @property
    def code(self) -> int:
        """Number of lines that are no docstring, no comment alone and not blank."""
        lines = self.text.splitlines()
        skipped = {k for node in self.nodes for k in _text(node)}
        return sum(
            1
            for k, line in enumerate(lines, 1)
            if k not in skipped and line.strip() and not line.lstrip().startswith("#")
        )

    def imports(self, known: Iterable[str]) -> set[str]:
        """Return the modules of ``known`` that it imports, wherever the statement stands."""
        names = set(known)
        found = statements(self.tree)
        nodes = [n for n in found if isinstance(n, ast.Import | ast.ImportFrom)]
        return {t for n in nodes for t in self._targets(n, names)} - {self.name}

    def private_names(self) -> list[str]:
        """Return the private names of other modules of the product that it uses: ``module._name``."""
        nodes = [n for n in self.nodes if isinstance(n, ast.ImportFrom)]
        own = [n for n in nodes if n.level or (n.module or "").partition(".")[0] in PACKAGES]
        taken = {a.asname or a.name: f"{n.module}.{a.name}" for n in own for a in n.names}
        reached = (
            f"{taken[n.value.id]}.{n.attr}"
            for n in self.nodes
            if isinstance(n, ast.Attribute)
            and isinstance(n.value, ast.Name)
            and n.value.id in taken
        )
        return [name for name in (*taken.values(), *reached) if _is_private(name)]

    def _targets(self, node: ast.Import | ast.ImportFrom, known: set[str]) -> set[str]:
        if isinstance(node, ast.Import):
            return {a.name for a in node.names} & known
        parts = self.folder.split(".")
        parts = parts[: len(parts) - node.level + 1] if node.level else []
        base = ".".join([*parts, *([node.module] if node.module else [])])
        children = {f"{base}.{a.name}" for a in node.names}
        return (children & known) | ({base} & known if children - known else set())


def _is_private(name: str) -> bool:
    last = name.rpartition(".")[2]
    return last.startswith("_") and not last.startswith("__")


def _text(node: ast.AST) -> range:
    """Return the lines of a text that stands as a statement of its own."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return range(node.lineno, (node.end_lineno or node.lineno) + 1)
    return range(0)


def statements_in(node: ast.AST) -> list[ast.AST]:
    """Return what stands in the blocks of a statement, which are all places of statements."""
    return [n for block in BLOCKS for n in getattr(node, block, ())]


def statements(node: ast.AST) -> list[ast.AST]:
    """Return a statement and all within it; expressions, which are most of a tree, are not entered."""
    found = [node]
    for each in found:
        found += statements_in(each)
    return found


def modules(root: Path = ROOT) -> list[Module]:
    """Return all modules of the product."""
    files = [f for package in PACKAGES for f in sorted((root / package).rglob("*.py"))]
    return [
        Module(
            ".".join(f.relative_to(root).with_suffix("").parts).removesuffix(".__init__"),
            f.name == "__init__.py",
            f.read_text(encoding="utf-8"),
        )
        for f in files
    ]


def graph(found: Iterable[Module]) -> Graph:
    """Return what each module imports."""
    listed = list(found)
    names = [m.name for m in listed]
    return {m.name: m.imports(names) for m in listed}


def stages(found: Iterable[Module]) -> dict[str, str]:
    """Return the stage of each module that is no folder's own: its folder, or itself beside folders.

    A module that lies directly in a package of `PACKAGES` is a stage by itself: these are the contract of
    both packages and what opens scenes of every kind.
    """
    plain = (m for m in found if not m.is_folder)
    return {m.name: m.name if m.folder in PACKAGES else m.folder for m in plain}


def of_folders(found: Iterable[Module], edges: Graph) -> Graph:
    """Return what the modules of each stage import from others; folders' own modules do not count."""
    stage = stages(found)
    between: dict[str, set[str]] = {s: set() for s in stage.values()}
    for name in stage:
        between[stage[name]] |= {stage[t] for t in edges[name] if t in stage} - {stage[name]}
    return between


def circles(edges: Graph) -> list[list[str]]:
    """Return the strongly connected components of more than one node.

    Source: Tarjan, SIAM Journal on Computing 1 (1972) 146.
    """
    order: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        order[node] = low[node] = len(order)
        stack.append(node)
        for target in edges[node]:
            if target not in order:
                visit(target)
                low[node] = min(low[node], low[target])
            elif target in stack:
                low[node] = min(low[node], order[target])
        if low[node] == order[node]:
            place = stack.index(node)
            found.append(sorted(stack[place:]))
            del stack[place:]

    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(max(limit, 10 * len(edges) + 1000))
    for node in edges:
        if node not in order:
            visit(node)
    sys.setrecursionlimit(limit)
    return sorted(c for c in found if len(c) > 1)


def function_lengths(found: Iterable[Module]) -> list[int]:
    """Return the lines of each function, its docstring left out, in order."""
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
    nodes = (n for m in found for n in m.nodes if isinstance(n, kinds))
    return sorted((n.end_lineno or n.lineno) - n.lineno + 1 - len(_text(n.body[0])) for n in nodes)


def figures(root: Path = ROOT) -> dict[str, int]:
    """Return the figures by what they are of."""
    found = modules(root)
    edges = graph(found)
    of_files = circles(edges)
    lengths = function_lengths(found)
    fullest = Counter(m.folder for m in found if not m.is_folder)
    return {
        "modules": len(found),
        "lines of code": sum(m.code for m in found),
        "lines in all": sum(len(m.text.splitlines()) for m in found),
        "modules in the fullest folder": max(fullest.values()),
        "folders of more than 25 modules": sum(n > 25 for n in fullest.values()),
        "circles of files": len(of_files),
        "files in circles": sum(map(len, of_files)),
        "circles of folders": len(circles(of_folders(found, edges))),
        "private names of other modules": sum(len(m.private_names()) for m in found),
        "lines of functions, ninth decile": lengths[int(NINTH_DECILE * len(lengths))],
    }


def main(arguments: list[str]) -> int:
    """Print the figures beside their limits; return 1 if asked to check them and one is exceeded."""
    found = figures()
    for name, value in found.items():
        print(f"{name:<36} {value:>8,} {LIMITS.get(name, math.inf):>10,}")
    exceeded = any(value > LIMITS.get(name, math.inf) for name, value in found.items())
    return int(exceeded and "--check" in arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
