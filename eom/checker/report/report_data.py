"""Reports as data: JSON by the schema of `report.schema.json`, and a table with a row for each note."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable
from typing import Any

from eom.checker.read.places import NOWHERE, Source, Span
from eom.checker.report.findings import (
    ORDER,
    Correction,
    Counterexample,
    Explanation,
    Finding,
    Graded,
    Report,
)

VERSION = 2
"""Of the schema; raised where a reader of an older one could go wrong. 2: findings of kind "prose"."""

Data = dict[str, Any]


def to_json(graded: Iterable[Graded]) -> str:
    """Return all reports as JSON; notes without a report with their error."""
    data = {"version": VERSION, "notes": [note(g) for g in graded]}
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def note(graded: Graded) -> Data:
    """Return what is told of one note."""
    head = {"name": graded.name, "status": graded.status, "error": graded.error}
    return head | (_report(graded.report) if graded.report is not None else {})


def _report(report: Report) -> Data:
    return {
        "meanings": report.lexicon,
        "drafts": list(report.drafts),
        "unplaced": list(report.unplaced),
        "given": list(report.given),
        "notices": [{"text": n.text, "line": n.line} for n in report.notices],
        "counts": report.counts,
        "findings": [finding(f) for f in report.findings],
    }


def finding(found: Finding) -> Data:
    """Return what is told of a formula; places are lines and columns from 1, of first and last sign."""
    return {
        "kind": found.kind,
        "number": found.number,
        "in": found.source.name,
        "place": place(found.source, found.span),
        "latex": found.latex,
        "verdict": found.verdict,
        "sets": [list(s) for s in found.sets],
        "reason": found.reason,
        "at": place(found.source, found.place),
        "read_as": list(found.read_as),
        "remarks": [{"kind": r.kind, "text": r.text, "line": r.line} for r in found.remarks],
        "carried": found.carried,
        "explanation": _explanation(found.explanation, found.source),
    }


def place(source: Source, span: Span) -> Data | None:
    """Return a place in a source, None for none."""
    if span == NOWHERE:
        return None
    line, column = source.line_column(span.start)
    last_line, last_column = source.line_column(max(span.stop - 1, span.start))
    return {"line": line, "column": column, "last_line": last_line, "last_column": last_column}


def _explanation(explained: Explanation, source: Source) -> Data:
    counter = explained.counterexample
    return {
        "residual": explained.residual,
        "blamed": [place(source, s) for s in explained.blamed],
        "corrections": [_correction(c, source) for c in explained.corrections],
        "counterexample": None if counter is None else _counterexample(counter),
        "convention": explained.convention,
    }


def _correction(correction: Correction, source: Source) -> Data:
    return {
        "latex": correction.latex,
        "change": correction.change,
        "slip": correction.slip,
        "at": place(source, correction.span),
        "text": correction.text,
        "sets": [list(s) for s in correction.sets],
    }


def _counterexample(counter: Counterexample) -> Data:
    return {
        "values": [list(v) for v in counter.values],
        "members": [list(m) for m in counter.members],
        "assumptions": list(counter.assumptions),
    }


# -- tables --------------------------------------------------------------------------------------

COLUMNS = ("note", "status", "equations", *ORDER, "first_fault", "meanings", "error")


def rows(graded: Iterable[Graded]) -> list[Data]:
    """Return one row a note: counts of verdicts, and the line of the first fault, "" for none."""
    return [_row(g) for g in graded]


def _row(graded: Graded) -> Data:
    report = graded.report or Report(graded.name, ())
    faults = report.faults
    return {
        "note": graded.name,
        "status": graded.status,
        "equations": len(report.equations) - report.counts.get("no claim", 0),
        **{v: report.counts.get(v, 0) for v in ORDER},
        "first_fault": faults[0].line if faults else "",
        "meanings": report.lexicon,
        "error": "; ".join(" ".join(line.split()) for line in graded.error.splitlines()),
    }


def to_csv(graded: Iterable[Graded]) -> str:
    """Return the table as CSV; no cell is taken for a formula by a spreadsheet."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for row in rows(graded):
        writer.writerow({k: _cell(v) for k, v in row.items()})
    return stream.getvalue()


def to_table_json(graded: Iterable[Graded]) -> str:
    """Return the table as JSON: a list of objects with the columns of the CSV."""
    return json.dumps(rows(graded), indent=1, ensure_ascii=False) + "\n"


def _cell(value: object) -> object:
    """Return a cell; text that a spreadsheet would evaluate gets an apostrophe in front."""
    evaluated = isinstance(value, str) and value[:1] in {"=", "+", "-", "@", "\t", "\r"}
    return f"'{value}" if evaluated else value
