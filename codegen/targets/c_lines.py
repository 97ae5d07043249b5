"""Lines of C that scalars and vector lanes share: assignments, and what parts carry along."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from codegen.targets.render import Line, Part


def assigned(lines: Sequence[Line], kind: str, write: Callable[[str], str] = str) -> list[str]:
    """Return assignments to variables of type ``kind``, their expressions changed by ``write``."""
    return [
        f"    {write(line.expression)}"
        if line.room
        else f"    const {kind} {line.variable} = {write(line.expression)};"
        + (f" /* {line.comment} */" if line.comment else "")
        for line in lines
    ]


def part_lines(part: Part, kind: str, write: Callable[[str], str] = str) -> list[str]:
    """Return the lines of a part between its loads from what is carried and its stores to it."""
    return [
        *(_load(line, slot, kind) for line, slot in part.loads),
        *assigned(part.lines, kind, write),
        *(_store(line, slot) for line, slot in part.stores),
    ]


def variables(declared: Sequence[str]) -> list[str]:
    """Return the names of declared arguments."""
    return [a.split()[-1].lstrip("*") for text in declared for a in text.split(",")]


def _load(line: Line, slot: int, kind: str) -> str:
    if line.room:
        return f"    const {kind} *const {line.variable} = carried_ + {slot};"
    return f"    const {kind} {line.variable} = carried_[{slot}];"


def _store(line: Line, slot: int) -> str:
    if line.room:
        copy = f"carried_[{slot} + k_] = {line.variable}[k_];"
        return f"    for (int k_ = 0; k_ < {line.room}; ++k_) {copy}"
    return f"    carried_[{slot}] = {line.variable};"


def guarded(guard: str, comment: Sequence[str], body: Sequence[str]) -> str:
    """Return a header: its comment, and its lines where it is included first, for C and C++."""
    return "\n".join([
        *comment,
        f"#ifndef {guard}",
        f"#define {guard}",
        "",
        "#include <stddef.h>",
        "",
        "#ifdef __cplusplus",
        'extern "C" {',
        "#endif",
        "",
        *body,
        "",
        "#ifdef __cplusplus",
        "}",
        "#endif",
        "",
        f"#endif /* {guard} */",
        "",
    ])  # fmt: skip


def string(text: str) -> str:
    """Return a C string literal; everything but plain ASCII letters, digits and signs is escaped."""
    octal = "".join(
        chr(b)
        if (b < 128 and chr(b).isalnum()) or chr(b) in " _+-*/^()[]{}.,':;=<>"
        else f"\\{b:03o}"
        for b in text.encode()
    )
    return f'"{octal}"'


def name_function(name: str, kind: str, names: Sequence[str]) -> str:
    """Return the function that gives the names of one kind of quantities."""
    head = f"const char *{name}_{kind}_name(int k) {{"
    if not names:
        return "\n".join([head, "    (void)k;", "    return NULL;", "}"])
    listed = ", ".join(string(n) for n in names)
    return "\n".join(
        [
            head,
            f"    static const char *const names[] = {{{listed}}};",
            f"    return k >= 0 && k < {len(names)} ? names[k] : NULL;",
            "}",
        ]
    )
