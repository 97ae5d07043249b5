"""Statements of mechanics that stand in prose, each with what computes it.

A row says where a sentence stands, word for word, and which function computes that it is so: by the
package's derivations, systems and runs, or by elementary means beside them. `tests/test_statements.py`
runs them all; the documentation shows them as a table.
"""

from tests.statements import attitude, dissipation, freebody, machines, mass, particles, tops
from tests.statements.table import ROWS, Statement, stands

__all__ = (
    "ROWS", "Statement", "attitude", "dissipation", "freebody", "machines", "mass", "particles",
    "stands", "tops",
)  # fmt: skip
