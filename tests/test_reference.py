"""The docstrings of the whole public API: complete by rule, and with the facts of `tests/facts.py`.

Rules, for everything that `tests/public.py` finds:

- the first line is one sentence;
- each parameter and each field is named between double backquotes, there or in a docstring that it
  refers to between single ones; a field may have a text of its own behind it. One that is its name is
  left out: ``name`` and ``title`` that are text, and what is called as its type (``system: System``);
- what a function returns is reported by a sentence with "return", a noun at the beginning of a property,
  or by its type where that is a class under these rules;
- an array that is returned or held has its shape in words in brackets, as (3,) or (n, N);
- an error that the function raises, or what it calls directly, is named behind "Raises";
- what takes arguments, and each public class with fields, says them in sections: those of numpydoc in
  their order, its arguments in the order in which they are taken, each with a text, what is returned and,
  where there are any, errors;
- each public function has an example that runs, but for what takes seconds (`SLOW`).
"""

from __future__ import annotations

import ast
import inspect
import re
from dataclasses import dataclass, is_dataclass
from pathlib import Path

import pytest

import codegen
import eom
from codegen.compiling.checked import Array
from eom.errors import InputError
from tests.facts import COLUMNS, FACTS, INNER, NEVER, NONE
from tests.public import (
    SECTIONS,
    classes_in,
    doc_of_class,
    doc_of_constant,
    errors,
    fields,
    function_of,
    is_property,
    lineage,
    makers,
    members,
    parameters,
    public,
    reached,
    returned,
    rows_of,
    sections,
    texts_of_fields,
)

PUBLIC = public()
REACHED = {n: c for n, c in reached(INNER).items() if n not in INNER}
EVERYTHING = PUBLIC | REACHED
CLASSES = {n: o for n, o in EVERYTHING.items() if inspect.isclass(o)}
FUNCTIONS = {n: inspect.unwrap(o) for n, o in PUBLIC.items() if function_of(o)}
MEMBERS = {f"{n}.{m}": (c, m, f) for n, c in CLASSES.items() for m, f in members(c).items()}
CALLABLE = FUNCTIONS | {n: f for n, (_, _, f) in MEMBERS.items()}
ARRAY = re.compile(r"\b(Array|NDArray|ndarray|Counts|Floats)\b")
SLOW = {"eom.derivations.lectures.equation_map"}
NUMBERS = re.compile(r"\b(float|Array|ArrayLike|NDArray|Expr|Value)\b")
SHAPE = re.compile(
    r"\((?:\*?[A-Za-z0-9.*]+(?: [-+] [A-Za-z0-9]+)?,[^()]*|\.\.\.)\)|``shape``|3 x 3|n x n"
)


def doc(name):
    obj = EVERYTHING[name]
    if inspect.isclass(obj):
        return doc_of_class(obj)
    if function_of(obj):
        return inspect.getdoc(function_of(obj)) or ""
    return doc_of_constant(*name.rsplit(".", 1))


def doc_of(name):
    return doc(name) if name in EVERYTHING else inspect.getdoc(CALLABLE[name]) or ""


def named_in(words):
    """Docstrings of the public objects, and of members beside, that single backquotes name.

    Errors aside: what they are made of says nothing of a function that raises them.
    """
    found = []
    for reference in re.findall(r"(?<!`)`([\w.]+)`(?!`)", words):
        last = reference.split(".")[-1]
        if last.endswith("Error"):
            continue
        found += [doc(n) for n in EVERYTHING if n.endswith("." + last)]
        found += [doc_of(n) for n in CALLABLE if n.endswith("." + reference)]
    return found


def says_itself(name, annotation):
    """Return whether a parameter is its name: a name or title, or what is called as its type."""
    if name in {"name", "title"}:
        return annotation.startswith("str")
    kinds = set(re.findall(r"\w+", annotation)) - {"None"}
    return any(name == kind.casefold() for kind in kinds) and len(kinds) == 1


def not_named(taken, words):
    """Return what of the parameters or fields ``taken`` the docstrings do not name."""
    texts = [words, *named_in(words)]
    told = {n for t in texts for n in rows_of(sections(t).get("Parameters", ""))}
    return [n for n, annotation in taken.items() if not says_itself(n, str(annotation)) and n not in told
            and not any(f"``{n}``" in t or f"``{n}(" in t for t in texts)]  # fmt: skip


def first_line(words):
    return words.splitlines()[0] if words else ""


# -- the rules: what is wrong with a docstring, in words; nothing if all is well -------------------


def no_sentence(words, _):
    """The first line begins with a capital, a name or a number, ends with a full stop, and is one."""
    line = first_line(words)
    if not re.fullmatch(r"[A-Z`'\"3d].{8,106}[.]", line):
        yield f"no sentence: {line!r}"
    if re.search(r"[.] [A-Z](?!\w*-)", line.replace("Raises", "")):
        yield f"two sentences: {line!r}"


def unnamed_parameters(words, function):
    yield from not_named(parameters(function), words)


def unnamed_fields(words, cls):
    own = texts_of_fields(cls)
    yield from not_named({n: a for n, a in fields(cls).items() if n not in own}, words)


def unreported_results(words, function):
    kind = returned(function)
    known = set(classes_in(kind, function.__module__)) & set(CLASSES.values())
    if kind != "None" and not known and not re.search(r"\b[Rr]eturns?\b", words):
        yield "what is returned?"


def shapeless_results(words, function):
    reported = any(SHAPE.search(t) for t in [words, *named_in(words)])
    if ARRAY.search(returned(function)) and not reported:
        yield "an array without a shape is returned"


def shapeless_fields(words, cls):
    """The shape stands in the text behind a field, or near its name in the docstring."""
    own = rows_of(sections(words).get("Parameters", "")) | texts_of_fields(cls)
    sentences = re.split(r"(?<=[.:])\s+(?=[A-Z`])", words)
    for field, annotation in fields(cls).items():
        if ARRAY.search(str(annotation)):
            places = [k for k, s in enumerate(sentences) if f"``{field}``" in s]
            reported = [own.get(field, ""), *(" ".join(sentences[k : k + 3]) for k in places)]
            if not any(SHAPE.search(t) or "all arrays" in t for t in reported):
                yield f"{field} has no shape"


def unreported_errors(words, obj):
    functions = makers(obj) if inspect.isclass(obj) else [obj]
    raised = set().union(*map(errors, functions)) - set(rows_of(sections(words).get("Raises", "")))
    reported = {e for t in [words, *named_in(words)] for e in re.findall(r"`(\w+Error)`", t)}
    yield from sorted(raised - reported)
    if raised and not re.search(r"[Rr]aise|[Ee]rrors", words):
        yield "does not say that it raises"


def no_example(words, _):
    if ">>> " not in words:
        yield "no example"


def wrong_sections(words, function):
    found = sections(words)
    if parameters(function):
        wanted = {"Parameters": True, "Returns": returned(function) != "None"}
        wanted |= {"Raises": "Error`" in words, "Examples": ">>> " in words}
        yield from (f"no section {s}" for s, needed in wanted.items() if needed and s not in found)
    if list(found) != [s for s in SECTIONS if s in found]:
        yield f"sections are {list(found)}"
    rows = rows_of(found.get("Parameters", ""))
    if "Parameters" in found and list(rows) != list(parameters(function)):
        yield f"arguments are {list(parameters(function))}"
    for heading in ("Parameters", "Returns", "Raises"):
        below = rows_of(found.get(heading, ""))
        yield from (f"{n} has no text" for n, text in below.items() if not text.endswith("."))


def fields_without_section(words, cls):
    """Each field of a class has a text behind it, or in the section of parameters, in order."""
    told = {n for c in lineage(cls) for n in rows_of_class(c)}
    known = {n: a for n, a in fields(cls).items() if n not in texts_of_fields(cls)}
    yield from (n for n, a in known.items() if n not in told and not says_itself(n, str(a)))
    own = rows_of_class(cls)
    if own != [n for n in fields(cls) if n in own]:
        yield f"the order of {own}"


def rows_of_class(cls):
    return [*rows_of(sections(inspect.cleandoc(cls.__doc__ or "")).get("Parameters", ""))]


METHODS = {n: f for n, f in CALLABLE.items() if n in FUNCTIONS or not is_property(*MEMBERS[n][:2])}
RULES = {
    no_sentence: EVERYTHING | CALLABLE,
    unnamed_parameters: CALLABLE,
    unnamed_fields: CLASSES,
    unreported_results: METHODS,
    shapeless_results: CALLABLE,
    shapeless_fields: CLASSES,
    unreported_errors: {n: obj for n, obj in (CALLABLE | CLASSES).items() if n not in NEVER},
    no_example: {n: f for n, f in FUNCTIONS.items() if n not in SLOW},
    wrong_sections: CALLABLE,
    fields_without_section: {n: c for n, c in CLASSES.items() if n in PUBLIC and is_dataclass(c)},
}
"""Each rule, and what it holds for."""


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_docstrings_are_complete(rule):
    wrong = {n: list(rule(doc_of(n), obj)) for n, obj in RULES[rule].items()}
    assert {n: found for n, found in wrong.items() if found} == {}


def refused(x: float) -> float:
    raise InputError("not that", got=x)


IN_ORDER = """Do it.

Parameters
----------
x : float
    A number.

Returns
-------
float
    Never.

Raises
------
InputError
    Always.
"""


def calls(x: float) -> Array:
    return refused(x)


@dataclass(frozen=True)
class Vague:
    values: Array
    reported: int = 0
    """How many."""

    def __post_init__(self):
        refused(self.reported)


def test_the_rules_see_what_is_missing():
    assert list(no_sentence("What it does", calls)) == ["no sentence: 'What it does'"]
    assert list(no_sentence("This is it. That too.", calls))
    assert list(unnamed_parameters("Return ``y``.", calls)) == ["x"]
    assert not list(unnamed_parameters("Return ``x``.", calls))
    assert list(not_named({"what": "str"}, "Raises `InputError`.")) == ["what"]
    assert list(unnamed_fields("What has ``reported``.", Vague)) == ["values"]
    assert list(unreported_results("Do it.", calls))
    assert not list(unreported_results("Return it.", calls))
    assert list(shapeless_results("Return it.", calls))
    assert not list(shapeless_results("Return it, (n,).", calls))
    assert list(shapeless_fields("What has ``values``.", Vague)) == ["values has no shape"]
    assert not list(shapeless_fields("What has ``values`` (n, 3).", Vague))
    assert list(fields_without_section("", Vague)) == ["values"]
    assert "InputError" in unreported_errors("Do it.", calls)
    assert "InputError" in unreported_errors("Do it.", Vague)
    assert not list(unreported_errors("Do it. Raises `InputError`.", refused))
    assert not list(wrong_sections(IN_ORDER, refused))
    assert not list(unnamed_parameters(IN_ORDER, refused))
    assert not list(unreported_errors(IN_ORDER, refused))
    assert list(wrong_sections(IN_ORDER.replace("x : float", "y : float"), refused))
    assert list(wrong_sections(IN_ORDER.replace("    A number.", ""), refused)) == ["x has no text"]
    assert list(wrong_sections(IN_ORDER.replace("Raises", "Errors"), refused))
    found = list(wrong_sections("Return ``x``. Raises `InputError`.", refused))
    assert found == [f"no section {s}" for s in ("Parameters", "Returns", "Raises")]


# -- the facts ------------------------------------------------------------------------------------


def annotations(name):
    """All annotations of a function, or of the fields of a class, as one text."""
    obj = EVERYTHING[name]
    if inspect.isclass(obj):
        return " ".join(map(str, fields(obj).values()))
    function = function_of(obj)
    return " ".join([*parameters(function).values(), returned(function)]) if function else ""


def everything_said(name):
    """The docstring of a name, of a class with those of its fields and members, in one line."""
    words = [doc(name)]
    if name in CLASSES:
        words += texts_of_fields(CLASSES[name]).values()
        words += [inspect.getdoc(f) or "" for c, _, f in MEMBERS.values() if c is CLASSES[name]]
    return " ".join(" ".join(words).split())


def missing(name):
    """Facts that are none of their kind, or that the docstring does not state in these words."""
    said = everything_said(name).casefold()
    for (column, pattern), fact in zip(COLUMNS.items(), FACTS[name], strict=True):
        if fact != NONE and not (pattern.search(fact) and fact.casefold() in said):
            yield f"{column}: {fact}"
    shapes, units, *_ = FACTS[name]
    if shapes == NONE and ARRAY.search(annotations(name)):
        yield "it has arrays: which shapes?"
    if units == NONE and NUMBERS.search(annotations(name)):
        yield "it has numbers: which units?"


def test_each_public_name_states_its_facts():
    assert set(PUBLIC) == set(FACTS)
    wrong = {n: list(missing(n)) for n in FACTS}
    assert {n: found for n, found in wrong.items() if found} == {}


def test_what_is_inner_is_reached():
    """A class that users come to follows the rules, or is listed as one that they need not know."""
    assert set(INNER) <= set(reached(INNER))


def test_names_of_trees_and_of_types_stand_on_their_pages():
    reference = Path(__file__).parents[1] / "docs" / "reference"
    page = (reference / "many-bodies.md").read_text("utf-8")
    listed = re.findall(r"^\.\. auto\w+:: eom\.multibody\.(\w+)$", page, re.MULTILINE)
    assert sorted(listed) == sorted(set(eom.multibody.__all__) - {"GROUND"})
    page = (reference / "types.md").read_text("utf-8")
    told = re.findall(r"^\.\. py:data:: (\w+)$", page, re.MULTILINE)
    conf = ast.parse((reference.parent / "conf.py").read_text("utf-8"))
    (names,) = (
        ast.literal_eval(n.value.generators[0].iter)
        for n in conf.body
        if isinstance(n, ast.Assign) and ast.unparse(n.targets[0]) == "autodoc_type_aliases"
    )
    assert sorted(told) == sorted(names)


def test_one_page_lists_the_names_of_both_packages():
    page = (Path(__file__).parents[1] / "docs" / "reference" / "names.md").read_text("utf-8")
    listed = re.findall(r"^   ((?:eom|codegen)\.\w+)$", page, re.MULTILINE)
    named = {f"{p.__name__}.{n}" for p in (eom, codegen) for n in p.__all__}
    assert sorted(listed) == sorted(named - {"eom.__version__"})
