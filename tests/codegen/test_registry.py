"""The table of targets: rows are complete, refusals come first, and the how-to for a new row works."""

import re
from dataclasses import replace
from pathlib import Path

import mpmath
import pytest
import sympy as sp
from click.testing import CliRunner

import eom
from codegen import compile as compile_system
from codegen.compiling.compiled import ROWS, generate
from codegen.frontend.layout import Layout, excerpt
from codegen.frontend.lower import lower_system
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.names import identifier
from codegen.ir.ops import BLOCKS, OPS
from codegen.targets import load_module
from codegen.targets.render import ATOM, Template, call, infix
from codegen.targets.target import Target, bodies, missing, used_helpers
from eom.__main__ import generate as generate_command
from eom.__main__ import main
from eom.errors import InputError
from eom.quantities import Quantity
from eom.system import System
from tests.codegen.test_python_target import computable
from tests.codegen.test_targets import every_operation, p, system_of, x, y

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("row", ROWS.values(), ids=ROWS)
def test_a_target_writes_or_names_every_operation(row):
    gaps = missing(row)
    assert not gaps, f"{row.name} lacks {', '.join(gaps)}"
    assert not set(row.templates) & set(row.unsupported)
    assert all(row.unsupported.values()), "each says what to do instead"


@pytest.mark.parametrize("row", ROWS.values(), ids=ROWS)
def test_templates_hold_each_operand(row):
    for name, template in row.templates.items():
        if name in BLOCKS:
            continue
        fields = set(re.findall(r"\{(\d)\}", template.text))
        assert fields == {str(k) for k in range(len(fields))}
        assert not template.needs or len(template.needs) == len(fields)
        if name in OPS:
            assert len(fields) == OPS[name].arity


@pytest.mark.parametrize("row", ROWS.values(), ids=ROWS)
def test_helpers_use_earlier_ones_only_and_each_is_called(row):
    names = list(row.helpers)
    for k, text in enumerate(row.helpers.values()):
        words = set(re.findall(r"\w+", text))
        assert not words & set(names[k + 1 :])
    called = {w for t in row.templates.values() for w in re.findall(r"\w+", t.text)}
    called |= {w for t in row.helpers.values() for w in re.findall(r"(?<!function )(\w+)", t)}
    assert set(names) <= called


@pytest.mark.parametrize("name", ROWS)
def test_files_are_named_after_the_system_and_are_ascii(name):
    compiled = compile_system(system_of(computable(every_operation()), "naïve name"), "numpy")
    files = generate(compiled.program, compiled.layout, name)
    assert all(
        file.startswith(identifier("naïve name"))
        for file in files
        if file not in {"Makefile", "CMakeLists.txt"}
    )
    assert any(file.endswith(f".{ROWS[name].extension}") for file in files)
    assert all(
        text.isascii() and text.endswith("\n") and ("\t" not in text or file == "Makefile")
        for file, text in files.items()
    )


def test_the_command_line_lists_the_targets():
    (option,) = (o for o in generate_command.params if o.name == "target")
    assert set(option.metavar.split("|")) == {*ROWS, "fmu"}


def test_the_command_line_writes_each_target(tmp_path):
    for name, row in ROWS.items():
        folder = tmp_path / name
        run = CliRunner().invoke(
            main, ["generate", "t-handle", "--target", name, "--out", str(folder)]
        )
        assert run.exit_code == 0, run.output
        assert any(path.suffix == f".{row.extension}" for path in folder.iterdir())


# --- refusals --------------------------------------------------------------------------------------------


def lacking(*ops, target="python"):
    row = ROWS[target]
    kept = {op: template for op, template in row.templates.items() if op not in ops}
    return replace(row, templates=kept, unsupported=dict.fromkeys(ops, "use target c"))


def test_what_a_target_cannot_compute_is_refused_with_the_expression(monkeypatch, tmp_path):
    monkeypatch.setitem(ROWS, "python", lacking("atan2"))
    system = system_of([x + y, 2 * sp.atan2(p * y, x + 1) + 1])
    with pytest.raises(InputError) as error:
        compile_system(system, "python")
    assert error.value.what == "target python does not compute atan2"
    assert error.value.where == "system 'all_of_them', f1 of outputs"
    assert error.value.got == "atan2(mul(y, p), add(x, 1))"
    assert error.value.hint == "use target c"
    numpy = compile_system(system, "numpy")
    with pytest.raises(InputError, match="does not compute atan2"):
        generate(numpy.program, numpy.layout, "python")


def test_a_refusal_comes_before_anything_is_written(monkeypatch, tmp_path):
    monkeypatch.setitem(ROWS, "python", lacking("mul"))
    arguments = ["generate", "heavy-top", "--target", "python", "--out", str(tmp_path / "new")]
    run = CliRunner().invoke(main, arguments)
    assert run.exit_code == 2
    assert "target python does not compute mul" in str(run.output) + str(run.exception)
    assert not (tmp_path / "new").exists()


def test_what_is_a_number_already_is_not_refused(monkeypatch):
    monkeypatch.setitem(ROWS, "python", lacking("sin"))
    compiled = compile_system(system_of([x * sp.sin(sp.Integer(1))]), "python")
    assert compiled.outputs(0.0, [2.0, 0.0], [0.0, 0.0])[0] == 2 * float(mpmath.sin(1))


def test_long_expressions_are_cut():
    expression = sum(sp.sin(k * x + y) for k in range(60))
    system = system_of([sp.exp(expression)])
    program = lower_system(system)
    text = excerpt(program, Layout.of(system), program.results["outputs"][0])
    assert len(text) <= 120
    assert text.startswith("exp(add(")


# --- the how-to of CONTRIBUTING.md -----------------------------------------------------------------------


def how_to():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    return text.split("## Adding a target\n")[1].split("\n## ")[0]


def test_the_how_to_shows_lines_that_stand_in_the_target():
    source = (ROOT / "codegen/targets/javascript.py").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", how_to(), re.DOTALL)
    lines = [
        line for block in blocks for line in block.splitlines() if line.strip() not in {"", "..."}
    ]
    assert len(lines) > 15
    assert [line for line in lines if f"{line[3:]}\n" not in source] == []


def test_the_how_to_names_what_there_is():
    for module, name in re.findall(r"`(codegen/[\w/]+\.py)`(?:, `(\w+)`)?", how_to()):
        source = (ROOT / module).read_text(encoding="utf-8")
        assert not name or name in source


def test_a_target_of_a_handful_of_rows_works_by_the_steps_of_the_how_to(monkeypatch):
    """Step by step: a target that computes with mpmath, for any number of digits."""
    # 1. a table of templates
    templates = {
        "add": infix("+", 10),
        "mul": infix("*", 20),
        "neg": Template("-{0}", 15, (20,)),
        "sin": call("mp.sin"),
        "max": call("_max", 2),
        "select": Template("({1} if {0} else {2})", ATOM, (6, 6, 6)),
    }
    # 2. helper functions
    helpers = {"_max": "def _max(a, b):\n    return a if a > b else b\n"}

    # 3. from bodies to files
    def files(program, layout):
        written = bodies(digits, program, layout)
        texts = ["from mpmath import mp\n", *used_helpers(digits, written)]
        for group, body in written.items():
            lines = [f"    {line.variable} = {line.expression}" for line in body.lines]
            results = ", ".join(body.results)
            texts.append(
                "\n".join([f"def {group}(t, x, p, u):", *lines, f"    return [{results}]\n"])
            )
        return {f"{identifier(layout.name)}.{digits.extension}": "\n".join(texts)}

    # 4. the row
    slots = {"time": "t", "state": "x[{0}]", "parameter": "p[{0}]", "input": "u[{0}]"}
    numbers = {"inf": "mp.inf", "-inf": "(-mp.inf)", "nan": "mp.nan"}
    digits = Target(
        "digits", "py", templates, slots, numbers, files, helpers, {"tan": "use python"}
    )
    monkeypatch.setitem(ROWS, "digits", digits)
    # 5. the coverage test names the rows that are missing
    assert missing(digits) == [op for op in OPS if op not in {*templates, "tan"}]
    assert "cos" in missing(digits)
    with pytest.raises(AssertionError, match=r"digits lacks .*cos"):
        test_a_target_writes_or_names_every_operation(digits)

    states = (Quantity(x), Quantity(y))
    rates = (y * sp.sin(x) + sp.Float(0.1), -3 * (x + y) * sp.Max(x, y))
    system = System("six_rows", states, rates)
    program, layout = lower_system(system), Layout.of(system)
    (text,) = generate(program, layout, "digits").values()
    with mpmath.workdps(50):
        at = [mpmath.mpf("0.3"), mpmath.mpf("-1.7")]
        got = load_module(text, "digits").rates(0, at, [], [])
        expected = interpret_exactly(program, Point(x=[0.3, -1.7]))["rates"]
        assert all(abs(a - e) < 1e-15 for a, e in zip(got, expected, strict=True))
        exact = -3 * (at[0] + at[1]) * at[0]
        assert abs(got[1] - exact) < mpmath.mpf(10) ** -48  # no double was in between
    # and what has no row is refused, with or without a word of advice
    for expression, hint in ((sp.tan(x), "use python"), (sp.cos(x), "choose another target")):
        system = System("tan", states, (expression, y))
        with pytest.raises(InputError, match="target digits does not compute") as error:
            generate(lower_system(system), Layout.of(system), "digits")
        assert error.value.hint == hint


def test_every_ready_scene_is_written_by_every_target():
    for name in ("heavy-top", "t-handle"):
        compiled = compile_system(eom.load_scene(name).derive(), "numpy")
        for target in ROWS:
            assert generate(compiled.program, compiled.layout, target)
