"""Which module may import which, and what no module may do, read from the source text."""

from __future__ import annotations

import ast
import functools
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks import house
from tests.public import sections

ROOT = Path(__file__).parents[1]
PACKAGES = ("eom", "codegen")
FILES = {
    p: ".".join(p.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    for package in PACKAGES
    for p in sorted((ROOT / package).rglob("*.py"))
}
NAMES = tuple(FILES.values())
FOLDERS = {name for p, name in FILES.items() if p.name == "__init__.py"}

ENTRY, COMMANDS, VIEWS = "eom.__main__", "eom.commands", "eom.views"
MAX_FUNCTION_LINES = 40
MAX_MODULE_LINES = 700


@functools.cache
def trees():
    """Return the syntax tree of each module by its name."""
    return {name: ast.parse(p.read_text(encoding="utf-8")) for p, name in FILES.items()}


def absolute(name, node):
    """Modules that an import statement names, with dots resolved."""
    if isinstance(node, ast.Import):
        return [a.name for a in node.names]
    base = node.module or ""
    if node.level:
        parts = name.split(".")
        parts = parts if name in FOLDERS else parts[:-1]
        parts = parts[: len(parts) - node.level + 1]
        base = ".".join([*parts, base]).rstrip(".")
    children = [f"{base}.{a.name}" for a in node.names]
    return [c if c in NAMES else base for c in children]


def is_type_checking(node):
    test = node.test
    return "TYPE_CHECKING" in {getattr(test, "id", ""), getattr(test, "attr", "")}


@functools.cache
def imports(name, *, inside_functions):
    """(imported module, line) of the imports of a module; those for type checkers left out."""
    found, stack = [], [trees()[name]]
    while stack:
        node = stack.pop()
        if isinstance(node, ast.Import | ast.ImportFrom):
            found += [(target, node.lineno) for target in absolute(name, node)]
        elif isinstance(node, ast.If) and is_type_checking(node):
            stack += node.orelse
        elif inside_functions or not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            stack += house.statements_in(node)
    return found


def within(module, package):
    return module == package or module.startswith(package + ".")


def broken(names, forbidden, *, inside_functions=True):
    return [
        f"{name}:{line} imports {target}"
        for name in names
        for target, line in imports(name, inside_functions=inside_functions)
        if forbidden(target)
    ]


EOM = [n for n in NAMES if within(n, "eom")]
CODEGEN = [n for n in NAMES if within(n, "codegen")]
COMMAND_LINE = [n for n in EOM if n == ENTRY or within(n, COMMANDS)]
SHOWING = [n for n in EOM if within(n, VIEWS)]
DERIVING = [n for n in EOM if n not in COMMAND_LINE and n not in SHOWING]


def test_the_packages_are_found():
    assert {"eom.system", "eom.errors", "eom.scenes.scene"} <= set(EOM)
    assert {"codegen.frontend.lower", "codegen.targets.c", "codegen.runs.simulation"} <= set(
        CODEGEN
    )
    assert ("eom.errors", 14) not in imports("eom.errors", inside_functions=True)
    assert any(
        t == "eom.system" for t, _ in imports("codegen.frontend.lower", inside_functions=True)
    )


def test_eom_never_imports_arrays():
    assert broken(DERIVING, lambda t: within(t, "numpy") or within(t, "scipy")) == []


def test_only_the_outer_layer_of_eom_sees_codegen():
    def outer(target):
        return target == ENTRY or within(target, COMMANDS) or within(target, VIEWS)

    assert broken(DERIVING, lambda t: within(t, "codegen")) == []
    assert broken([*DERIVING, *CODEGEN], outer) == []
    assert broken(SHOWING, lambda t: t == ENTRY or within(t, COMMANDS)) == []


def test_command_line_imports_codegen_and_arrays_late():
    def late(target):
        return any(within(target, p) for p in ("codegen", "numpy", "scipy", "sympy", "rich", VIEWS))

    assert {ENTRY, f"{COMMANDS}.simulating"} <= set(COMMAND_LINE)
    assert broken(COMMAND_LINE, late, inside_functions=False) == []


def test_codegen_knows_the_contract_alone():
    """Tables belong to it: they are numbers that the expressions of a system hold.

    So do the units of its quantities, in which values are given. What shows an object is asked for by words
    (`eom.displays`), which the front door of `eom` gives a meaning.

    How processes are started, and how often garbage is looked for, is the same in both packages, and
    says nothing of systems; nor do exact arithmetic and quaternions over any scalars, which import nothing.
    """
    arithmetic = {"eom.fields", "eom.rotations"}
    assert not any(t in NAMES for m in arithmetic for t, _ in imports(m, inside_functions=True))
    contract = {"eom.system", "eom.quantities", "eom.tables", "eom.errors", "eom.interrupts"}
    contract |= {"eom.limits"}
    contract |= {"eom.units", "eom.displays"} | arithmetic

    def foreign(target):
        return within(target, "eom") and target not in contract

    assert broken(CODEGEN, foreign) == []


def test_import_graph_has_no_cycle():
    """Remove modules that import nothing left, until none is left."""
    graph = {
        n: {t for t, _ in imports(n, inside_functions=False) if t in NAMES and t != n}
        for n in NAMES
    }
    while graph:
        free = [n for n, targets in graph.items() if not targets]
        assert free, f"cycle among {sorted(graph)}"
        graph = {n: targets - set(free) for n, targets in graph.items() if n not in free}


@pytest.mark.parametrize("module", ["eom", "eom.errors", "eom.scenes.catalogue"])
def test_import_is_light(module):
    code = f"import {module}, sys; print(*sorted({{'sympy', 'numpy', 'scipy'}} & set(sys.modules)))"
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert run.stdout.strip() == ""


def test_every_public_name_of_eom_loads():
    import eom

    assert eom.__all__ == sorted(eom.__all__, key=eom.__all__.index)
    assert len(set(eom.__all__)) == len(eom.__all__)
    assert all(getattr(eom, name) is not None for name in eom.__all__)
    import codegen

    assert set(dir(eom)) == {*eom.__all__, *codegen.__all__}
    assert not set(eom.__all__) & set(codegen.__all__)
    assert all(getattr(eom, name) is getattr(codegen, name) for name in codegen.__all__)
    with pytest.raises(AttributeError, match="nobody"):
        _ = eom.nobody


def called(node):
    function = node.func
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def is_text(node):
    """Whether an expression is text for certain: a literal, an f-string, str(...)."""
    if isinstance(node, ast.JoinedStr):
        return True
    if isinstance(node, ast.Call):
        return called(node) in {"str", "repr", "format", "join"}
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def evaluated(tree):
    """Calls in a tree that evaluate text, or give text to SymPy."""
    calls = [n for n in ast.walk(tree) if isinstance(n, ast.Call)]
    bare = [n for n in calls if isinstance(n.func, ast.Name)]
    direct = [f"{called(n)} in line {n.lineno}" for n in bare if called(n) in {"eval", "exec"}]
    direct += [f"parse_expr in line {n.lineno}" for n in calls if called(n) == "parse_expr"]
    texts = [
        f"{called(n)} of text in line {n.lineno}"
        for n in calls
        if called(n) in {"sympify", "S", "nsimplify", "parse_expr"}
        and n.args
        and is_text(n.args[0])
    ]
    return direct + texts


def test_no_text_is_evaluated():
    assert [f"{name}: {words}" for name, tree in trees().items() for words in evaluated(tree)] == []


def lines(node):
    return node.end_lineno - node.lineno + 1


def code_lines(function):
    """Lines of a function from ``def`` to its end, its docstring left out."""
    first = function.body[0]
    described = ast.get_docstring(function) is not None
    return lines(function) - (lines(first) if described else 0)


def code_lines_of_module(tree):
    """Lines of a module; tables do not count, which are assignments that hold no function, nor
    docstrings of functions and classes that have a row an argument."""
    tables = [n for n in tree.body if isinstance(n, ast.Assign | ast.AnnAssign) and lines(n) > 10]
    told = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.ClassDef)]
    tables += [n.body[0] for n in told if sections(ast.get_docstring(n) or "")]
    return max((n.end_lineno for n in tree.body), default=0) - sum(map(lines, tables))


def test_functions_are_short():
    functions = [
        (name, n)
        for name, tree in trees().items()
        for n in house.statements(tree)
        if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)
    ]
    assert len(functions) > len(NAMES)
    sizes = {f"{name}.{f.name} in line {f.lineno}": code_lines(f) for name, f in functions}
    assert {name: n for name, n in sizes.items() if n > MAX_FUNCTION_LINES} == {}


def test_modules_are_short():
    sizes = {name: code_lines_of_module(tree) for name, tree in trees().items()}
    assert {name: n for name, n in sizes.items() if n > MAX_MODULE_LINES} == {}
