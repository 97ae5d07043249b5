"""What users meet of `eom` and `codegen`: public objects, what is reached from them, their docstrings.

Public is what `__all__` of the packages in `PACKAGES` lists, and the names in `MODULES`. Reached is a
class of ours that stands in the annotation of a public function, of a field, or of a public member of a
public or reached class.
"""

from __future__ import annotations

import ast
import builtins
import functools
import importlib
import inspect
import itertools
import re
import sys
import typing
from dataclasses import dataclass, is_dataclass

PACKAGES = ("eom", "eom.exercises", "eom.multibody", "codegen")
MODULES = {
    "eom.checker.note.kept": "from_note to_note",
    "eom.derivations.lectures": "equation_map",
    "eom.derivations.verification": "DerivationError",
    "eom.kinematics.coordinates": "attitude elementary",
    "eom.kinematics.frames": "vector",
    "eom.rotations": "matrix_of_quaternion",
    "eom.mass.principal": "definiteness principal_axes",
    "eom.mass.properties": "MassProperties",
    "eom.mass.regions": "Region properties simplex",
    "eom.mass.solids": "inertia mass_properties",
    "eom.mechanics.recognition": "recognise",
    "eom.mechanics.torques": "applied gravity_gradient weight",
    "eom.multibody.sympy.from_sympy": "tree_from_sympy",
    "eom.multibody.sympy.to_sympy": "lagranges_method to_sympy",
    "eom.scenes.conventions": (
        "Convention Stated attitude_of_angles attitude_of_matrix attitude_of_quaternion book "
        "changed of_scene state"
    ),
    "eom.terms.terms": "cross der dot partial total",
    "eom.terms.vocabulary": "omega position quantity unit velocity",
    "eom.typeset.printing": "show",
    "eom.views.animation.animation": "animation_of animation_of_motion",
    "eom.views.animation.animation_page": "page",
    "eom.views.body.cones": "cones free_cones",
    "eom.views.body.frame_sketches": "frame_sketch wheel wheel_of",
    "eom.views.body.free": "FreeBody free_body",
    "eom.views.body.poinsot": "herpolhode",
    "eom.views.body.polhodes": "ellipsoids momentum_path polhodes",
    "eom.views.body.rotating": "Turning sphere turning",
    "eom.views.draw.picture": (
        "Arrow Axis COLOURS Curve Marks Panel Picture Surface Words check points"
    ),
    "eom.views.draw.printed": "figure",
    "eom.views.draw.saving": "save",
    "eom.views.draw.turned": "page",
    "eom.views.gallery": "Ask PICTURES available picture pictures",
    "eom.views.live.page": "page",
    "eom.views.time.histories": "histories histories_of quantities",
    "eom.views.time.work_precision": "work_precision",
    "eom.views.tree.joint_trees": "joint_tree",
    "eom.views.tree.sketches": "sketch tree_frames",
}
"""Names of modules that documents ask users to import, beside those of the packages."""
DUNDERS = ("__call__", "__getitem__")
"""Methods with underscores that a user writes as brackets; they need docstrings as others do."""


def ours(name):
    return str(name).split(".")[0] in {"eom", "codegen", "tests"}


def public():
    """Everything that is public, by dotted name, in order."""
    found = {}
    listed = {p: getattr(importlib.import_module(p), "__all__", ()) for p in PACKAGES}
    for home, names in {**listed, **{m: names.split() for m, names in MODULES.items()}}.items():
        for name in names:
            found[f"{home}.{name}"] = getattr(importlib.import_module(home), name)
    return found


def dotted(cls):
    return f"{cls.__module__}.{cls.__qualname__}"


# -- docstrings, also those of constants and fields -----------------------------------------------


@functools.cache
def tree_of(module):
    return ast.parse(inspect.getsource(sys.modules[module]))


@functools.cache
def nodes_of(module):
    """Functions and classes of a module by the line of their first decorator, or of themselves."""
    kinds = (ast.FunctionDef, ast.Lambda, ast.ClassDef)
    found = {}
    for node in ast.walk(tree_of(module)):
        if isinstance(node, kinds):
            decorators = getattr(node, "decorator_list", [])
            found.setdefault(min(d.lineno for d in [*decorators, node]), node)
    return found


def texts_behind(body):
    """Text of each string that stands behind an assignment, by the name that is assigned to."""
    found = {}
    for node, after in itertools.pairwise(body):
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        text = isinstance(after, ast.Expr) and getattr(after.value, "value", None)
        if isinstance(targets[0], ast.Name) and isinstance(text, str):
            found[targets[0].id] = inspect.cleandoc(text)
    return found


def doc_of_constant(package, name):
    """The text behind the assignment, in the package or in the module that it is imported from."""
    tree = tree_of(package)
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and name in {a.name for a in node.names}:
            importlib.import_module(node.module)
            tree = tree_of(node.module)
    return texts_behind(tree.body).get(name, "")


def lineage(cls):
    """The class and those of ours that it inherits from."""
    return [c for c in cls.__mro__ if ours(c.__module__)]


@functools.cache
def texts_of_fields(cls):
    """Text behind each field of a class or of one that it inherits from."""
    found = {}
    for c in reversed(lineage(cls)):
        nodes = nodes_of(c.__module__).values()
        bodies = (n.body for n in nodes if getattr(n, "name", "") == c.__name__)
        found |= texts_behind(
            next(bodies, [])
        )  # what is made of another class has no text of its own
    return found


@functools.cache
def doc_of_class(cls):
    return "\n\n".join(inspect.cleandoc(c.__doc__ or "") for c in lineage(cls))


SECTIONS = ("Parameters", "Returns", "Raises", "Notes", "References", "Examples")
"""Sections of a docstring that has any, in this order, as numpydoc writes them."""
HEADING = re.compile(r"^(\w+)\n-{3,}$", re.MULTILINE)


def sections(words):
    """The text of each section of a docstring by its heading, in order; of several with one heading all."""
    _, *parts = HEADING.split(words)
    found: dict[str, str] = {}
    for name, text in zip(parts[::2], parts[1::2], strict=True):
        found[name] = "\n".join([*filter(None, [found.get(name)]), text.strip("\n")])
    return found


def rows_of(section):
    """The text below each name of a section; of a row with several names below each."""
    found, names = {}, []
    for line in section.splitlines():
        if line and not line.startswith(" "):
            names = [name.strip() for name in line.partition(" : ")[0].split(",")]
            found |= dict.fromkeys(names, "")
        else:
            found |= {name: f"{found[name]} {line.strip()}".strip() for name in names}
    return found


# -- members and fields ---------------------------------------------------------------------------


def function_of(member):
    """The function behind a method, property, or a function that is wrapped; None if there is none."""
    if isinstance(member, property):
        member = member.fget
    member = getattr(member, "__func__", member)
    if isinstance(member, functools.cached_property):
        member = member.func
    member = inspect.unwrap(member) if callable(member) else member
    return member if inspect.isfunction(member) else None


def members(cls):
    """Public methods and properties by name, also inherited ones of ours; no field is one."""
    found = {}
    for c in reversed(lineage(cls)):
        for name, member in vars(c).items():
            shown = name in DUNDERS or not name.startswith("_")
            is_field = name in getattr(c, "__dataclass_fields__", ())
            if shown and function_of(member) and not (is_field or is_validator(c, name)):
                found[name] = function_of(member)
    return found


def is_property(cls, name):
    return isinstance(inspect.getattr_static(cls, name), property | functools.cached_property)


def makers(cls):
    """The functions of a class, or of one that it inherits from, that run when one is made."""
    found = [vars(c).get(hook) for c in lineage(cls) for hook in ("__post_init__", "__init__")]
    written = [f for f in found if inspect.isfunction(f)]
    return [f for f in written if f.__code__.co_filename == inspect.getsourcefile(cls)]


def is_validator(cls, name):
    """Pydantic's hooks and fields are no members that a user calls."""
    hooks = getattr(cls, "__pydantic_decorators__", None)
    if hooks is None:
        return False
    kinds = (
        hooks.validators,
        hooks.field_validators,
        hooks.model_validators,
        hooks.root_validators,
    )
    return any(name in kind for kind in kinds)


def fields(cls):
    """Annotation of each public field that a dataclass or model takes or has."""
    found = {}
    if not (is_dataclass(cls) or hasattr(cls, "model_fields")):
        return found
    known = getattr(cls, "model_fields", None) or cls.__dataclass_fields__
    for c in reversed(lineage(cls)):
        found |= {n: a for n, a in vars(c).get("__annotations__", {}).items() if n in known}
    return {n: a for n, a in found.items() if not n.startswith("_")}


def parameters(function):
    """Annotation of each parameter, as text."""
    found = inspect.signature(function).parameters.values()
    return {p.name: text(p.annotation) for p in found if p.name not in {"self", "cls"}}


def text(annotation):
    if annotation is inspect.Parameter.empty:
        return ""
    return annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)


def returned(function):
    return text(inspect.signature(function).return_annotation)


# -- what is reached ------------------------------------------------------------------------------


@functools.cache
def names_in(module):
    """What names of a module stand for, also those that it imports for type checkers or late."""
    found = dict(vars(sys.modules[module]))
    for node in ast.walk(tree_of(module)):
        if isinstance(node, ast.ImportFrom) and node.module and ours(node.module):
            home = vars(importlib.import_module(node.module))
            for alias in node.names:
                found.setdefault(alias.asname or alias.name, home.get(alias.name))
    return found


def classes_in(annotation, module):
    """Classes of ours in an annotation, aliases looked through."""
    if isinstance(annotation, str):
        for word in re.findall(r"[A-Za-z_][\w.]*", annotation):
            value = names_in(module).get(word.split(".")[0])
            for part in word.split(".")[1:]:
                value = getattr(value, part, None)
            yield from classes_in(value, module) if not isinstance(value, str) else ()
    elif inspect.isclass(annotation) and ours(annotation.__module__):
        yield annotation
    for argument in typing.get_args(annotation):
        several = argument if isinstance(argument, list | tuple) else (argument,)
        for one in several:
            if not isinstance(one, str):
                yield from classes_in(one, module)


def results_of(obj):
    """Classes in what a function returns, or in the fields and results of members of a class."""
    if not inspect.isclass(obj):
        function = inspect.unwrap(obj)
        yield from classes_in(returned(function), function.__module__)
        return
    for c in lineage(obj):
        for name, annotation in vars(c).get("__annotations__", {}).items():
            if not name.startswith("_"):
                yield from classes_in(annotation, c.__module__)
    for function in members(obj).values():
        yield from classes_in(returned(function), function.__module__)


def arguments_of(obj):
    """Classes in the parameters of a function or of the methods of a class."""
    functions = members(obj).values() if inspect.isclass(obj) else [inspect.unwrap(obj)]
    for function in functions:
        for annotation in parameters(function).values():
            yield from classes_in(annotation, function.__module__)


def reached(inner):
    """Classes by dotted name that users come to from public ones, not looking into ``inner``."""
    found = {dotted(c): c for c in public().values() if inspect.isclass(c)}
    listed = set(found)
    stack = [o for o in public().values() if callable(o)]
    while stack:
        obj = stack.pop()
        for cls in [*results_of(obj), *arguments_of(obj)]:
            name = dotted(cls)
            if name not in found and not cls.__name__.startswith("_"):
                found[name] = cls
                stack += [cls] if name not in inner else []
    return {name: found[name] for name in sorted(set(found) - listed)}


# -- what a function raises -----------------------------------------------------------------------


@dataclass(frozen=True)
class Scope:
    """Source of a function and the names that it sees."""

    node: ast.AST
    names: dict


@functools.cache
def scope(function):
    node = nodes_of(function.__module__)[function.__code__.co_firstlineno]
    inside = inspect.getclosurevars(function).nonlocals if function.__closure__ else {}
    return Scope(node, {**vars(builtins), **function.__globals__, **inside})


def value_of(node, names):
    """What a name or dotted name stands for; None where that is not known before it runs."""
    if isinstance(node, ast.Name):
        return names.get(node.id)
    if isinstance(node, ast.Attribute):
        base = value_of(node.value, names)
        return vars(base).get(node.attr) if inspect.ismodule(base) else None
    return None


@functools.cache
def errors_of(function):
    """Names of the errors of ours that the source of a function raises, or gets to raise."""
    found = set()
    here = scope(function)
    for node in ast.walk(here.node):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
            raised = value_of(node.exc.func, here.names)
            if inspect.isfunction(raised):
                found |= {c.__name__ for c in classes_in(returned(raised), raised.__module__)}
            elif inspect.isclass(raised) and ours(raised.__module__):
                found.add(raised.__name__)
    return frozenset(found)


def called(function):
    """Functions of ours that a function calls by name; of a class what it does when it is made."""
    here = scope(function)
    for node in ast.walk(here.node):
        if isinstance(node, ast.Call):
            value = value_of(node.func, here.names)
            value = inspect.unwrap(value) if callable(value) else value
            if inspect.isclass(value) and ours(value.__module__):
                yield from makers(value)
            elif inspect.isfunction(value) and ours(value.__module__):
                yield value


def errors(function):
    """Names of the errors that a function raises, or what it calls directly does."""
    return errors_of(function).union(*map(errors_of, called(function)))
