"""The docstrings of the whole public API: complete by rule, and with the facts of `tests/facts.py`.

Rules, for everything that `tests/public.py` finds:

- the first line is one sentence;
- each parameter and each field is named between double backquotes, there or in a docstring that it
  refers to between single ones; a field may have a text of its own behind it. One that is its name is
  left out: ``name`` and ``title`` that are text, and what is called as its type (``system: System``);
- what a function returns is told by a sentence with "return", a noun at the beginning of a property,
  or by its type where that is a class under these rules;
- an array that is returned or held has its shape in words in brackets, as (3,) or (n, N);
- an error that the function raises, or what it calls directly, is named behind "Raises";
- each public function has an example that runs.
"""

from __future__ import annotations

import inspect
import re

import pytest

from tests.facts import COLUMNS, FACTS, INNER, NONE
from tests.public import (
    classes_in,
    doc_of_class,
    doc_of_constant,
    errors,
    fields,
    function_of,
    is_property,
    makers,
    members,
    parameters,
    public,
    reached,
    returned,
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
    """Docstrings of the public objects, and of members beside, that single backquotes name."""
    found = []
    for reference in re.findall(r"(?<!`)`([\w.]+)`(?!`)", words):
        last = reference.split(".")[-1]
        found += [doc(n) for n in EVERYTHING if n.endswith("." + last)]
        found += [doc_of(n) for n in CALLABLE if n.endswith("." + reference)]
    return found


def says_itself(name, annotation):
    """Tell whether a parameter is its name: a name or title, or what is called as its type."""
    if name in {"name", "title"}:
        return annotation.startswith("str")
    kinds = set(re.findall(r"\w+", annotation)) - {"None"}
    return any(name == kind.casefold() for kind in kinds) and len(kinds) == 1


def not_named(taken, words):
    """Return what of the parameters or fields ``taken`` the docstrings do not name."""
    texts = [words, *named_in(words)]
    return [n for n, annotation in taken.items() if not says_itself(n, str(annotation))
            and not any(f"``{n}``" in t or f"``{n}(" in t for t in texts)]  # fmt: skip


def first_line(words):
    return words.splitlines()[0] if words else ""


@pytest.mark.parametrize("name", [*EVERYTHING, *MEMBERS])
def test_the_first_line_is_one_sentence(name):
    line = first_line(doc_of(name))
    assert re.fullmatch(r"[A-Z`'\"3d].{8,106}[.]", line), line
    assert not re.search(r"[.] [A-Z](?!\w*-)", line.replace("Raises", "")), "two sentences"


@pytest.mark.parametrize("name", CALLABLE)
def test_each_parameter_is_named(name):
    assert not not_named(parameters(CALLABLE[name]), doc_of(name))


@pytest.mark.parametrize("name", CLASSES)
def test_each_field_is_described(name):
    own = texts_of_fields(CLASSES[name])
    taken = {n: a for n, a in fields(CLASSES[name]).items() if n not in own}
    assert not not_named(taken, doc_of_class(CLASSES[name]))


@pytest.mark.parametrize("name", CALLABLE)
def test_what_is_returned_is_told(name):
    function, words = CALLABLE[name], doc_of(name)
    kind = returned(function)
    if kind == "None" or (name in MEMBERS and is_property(*MEMBERS[name][:2])):
        return
    known = set(classes_in(kind, function.__module__)) & set(CLASSES.values())
    assert re.search(r"\b[Rr]eturns?\b", words) or known, first_line(words)


@pytest.mark.parametrize("name", CALLABLE)
def test_an_array_that_is_returned_has_a_shape(name):
    if ARRAY.search(returned(CALLABLE[name])):
        words = doc_of(name)
        assert any(SHAPE.search(t) for t in [words, *named_in(words)])


@pytest.mark.parametrize("name", CLASSES)
def test_an_array_that_is_held_has_a_shape(name):
    """In the text behind the field, or in the sentence of the docstring that names it."""
    cls = CLASSES[name]
    own, words = texts_of_fields(cls), doc_of_class(cls)
    sentences = re.split(r"(?<=[.:])\s+(?=[A-Z`])", words)
    for field, annotation in fields(cls).items():
        if ARRAY.search(str(annotation)):
            places = [k for k, s in enumerate(sentences) if f"``{field}``" in s]
            told = [own.get(field, ""), *(" ".join(sentences[k : k + 3]) for k in places)]
            assert any(SHAPE.search(t) or "all arrays" in t for t in told), field


@pytest.mark.parametrize("name", [*CALLABLE, *CLASSES])
def test_errors_are_named(name):
    words = doc_of(name)
    functions = makers(CLASSES[name]) if name in CLASSES else [CALLABLE[name]]
    raised = set().union(*map(errors, functions))
    told = {e for t in [words, *named_in(words)] for e in re.findall(r"`(\w+Error)`", t)}
    assert raised <= told, raised - told
    if raised:
        assert re.search(r"[Rr]aise|[Ee]rrors", words)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_function_has_an_example(name):
    assert ">>> " in doc(name)


# -- the facts ------------------------------------------------------------------------------------


def plain(words):
    return " ".join(words.split())


def annotations(name):
    """All annotations of a function, or of the fields and what makes a class, as one text."""
    obj = EVERYTHING[name]
    if inspect.isclass(obj):
        return " ".join(map(str, fields(obj).values()))
    function = function_of(obj)
    return " ".join([*parameters(function).values(), returned(function)]) if function else ""


@pytest.mark.parametrize("name", FACTS)
def test_facts_stand_in_the_docstring(name):
    """Each fact stands there in these words, and is one of its kind."""
    words = doc(name)
    if name in CLASSES:
        own = [inspect.getdoc(f) or "" for c, _, f in MEMBERS.values() if c is CLASSES[name]]
        words = " ".join([words, *texts_of_fields(CLASSES[name]).values(), *own])
    for (column, pattern), fact in zip(COLUMNS.items(), FACTS[name], strict=True):
        if fact != NONE:
            assert pattern.search(fact), f"{column}: {fact!r} is none"
            assert fact in " ".join(words.split()), f"{column}: {fact!r} is not in the docstring"


@pytest.mark.parametrize("name", FACTS)
def test_what_has_arrays_and_numbers_states_shapes_and_units(name):
    shapes, units, *_ = FACTS[name]
    held = annotations(name)
    assert shapes != NONE or not ARRAY.search(held)
    assert units != NONE or not NUMBERS.search(held)


def test_each_public_name_has_its_facts():
    assert set(PUBLIC) == set(FACTS)


def test_what_is_inner_is_reached():
    """A class that users come to follows the rules, or is listed as one that they need not know."""
    assert set(INNER) <= set(reached(INNER))
