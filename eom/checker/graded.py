"""What became of a note among many: its report, or the error that left none."""

from __future__ import annotations

from dataclasses import dataclass

from eom.checker.reports import Report


@dataclass(frozen=True)
class Graded:
    """A note by its name with its ``report``, or with the ``error`` for which there is none."""

    name: str
    report: Report | None = None
    error: str = ""

    @property
    def status(self) -> str:
        """Return "nothing wrong", "wrong" or "unusable"."""
        if self.report is None:
            return "unusable"
        return "wrong" if self.report.faults else "nothing wrong"
