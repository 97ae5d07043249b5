"""Programs: value numbering, text form, and what verify refuses."""

import sys
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from types import MappingProxyType

import pytest

from codegen.ir.program import Builder, Instruction, Name, Program


def states(b, count=2):
    return [b.leaf("state", k) for k in range(count)]


def test_equal_instructions_are_one():
    b = Builder()
    x, y = states(b)
    assert b.leaf("state", 1) == y
    assert b.add("sub", x, y) == b.add("sub", x, y)
    assert b.add("sub", x, y) != b.add("sub", y, x)
    assert b.add("mul", x, y) == b.add("mul", y, x)
    assert b.add("max", y, x) == b.add("max", x, y)
    assert b.const(2) == b.const(Fraction(4, 2))


def test_slots_of_different_arrays_are_different():
    b = Builder()
    assert len({b.leaf(op, 0) for op in ("state", "parameter", "input")}) == 3


def test_the_text_form_shows_everything():
    b = Builder()
    x, y = states(b)
    total = b.add("mul", b.add("add", x, y), b.leaf("pi"))
    program = b.program({"f": [total, x], "g": []})
    assert str(program) == (
        "0 = state 0\n1 = state 1\n2 = add 0 1\n3 = pi\n4 = mul 2 3\nf: 4 0\ng: "
    )
    assert program.counts() == {"add": 1, "mul": 1}
    assert program.cost() == 2


def test_constants_are_exact_in_the_text():
    b = Builder()
    program = b.program({"f": [b.const(Fraction(1, 3))]})
    assert str(program) == "0 = const 1/3\nf: 0"


def test_binding_says_when_a_value_is_known():
    b = Builder()
    two, p, t = b.const(2), b.leaf("parameter", 0), b.leaf("time")
    x, u = b.leaf("state", 0), b.leaf("input", 0)
    kinds = {b.add("mul", two, p): 1, b.add("add", p, t): 2, b.add("add", t, x): 3}
    kinds |= {b.add("sin", u): 3, two: 0, b.add("sin", two): 0}
    assert {k: b.binding[k] for k in kinds} == kinds


def test_the_first_name_of_a_value_stays_and_leaves_keep_their_own():
    b = Builder()
    x, y = states(b)
    total = b.add("add", x, y)
    b.name(total, Name("first"))
    b.name(total, Name("second"))
    b.name(x, Name("other"))
    assert b.program({"f": [total]}).names == {total: Name("first")}


def test_programs_do_not_change_with_their_builder():
    b = Builder()
    x, y = states(b)
    program = b.program({"f": [x]})
    b.name(b.add("add", x, y), Name("later"))
    assert len(program.instructions) == 2
    assert not program.names
    with pytest.raises(TypeError):
        program.results["f"] = (0,)
    assert isinstance(program.results, MappingProxyType)


@pytest.mark.parametrize(
    "instructions",
    [
        (Instruction("sin", (0,)),),
        (Instruction("state", (), 0), Instruction("sin", (1,))),
        (Instruction("state", (), 0), Instruction("sin", (-1,))),
        (Instruction("state", (), 0), Instruction("add", (0,))),
        (Instruction("state", (), 0), Instruction("sin", (0, 0))),
        (Instruction("state", (), 0), Instruction("state", (0,), 1)),
        (Instruction("state"),),
        (Instruction("pi", (), 3),),
        (Instruction("time", (), 0),),
    ],
)
def test_malformed_instructions_are_found(instructions):
    with pytest.raises(AssertionError):
        Program(instructions, {"f": (0,)})


@pytest.mark.parametrize("number", [1, -1])
def test_results_that_do_not_exist_are_found(number):
    with pytest.raises(AssertionError):
        Program((Instruction("pi"),), {"f": (number,)})


def test_unknown_operations_are_found():
    with pytest.raises(AssertionError):
        Program((Instruction("pi"), Instruction("gamma", (0,))), {"f": (1,)})


def test_threads_make_programs_at_once():
    def make(k):
        b = Builder()
        return b.program({"f": [b.add("mul", b.leaf("state", 0), b.const(k))]})

    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        with ThreadPoolExecutor(4) as pool:
            made = list(pool.map(make, range(2, 4000)))
    finally:
        sys.setswitchinterval(before)
    assert all(p.cost() == 1 for p in made)
