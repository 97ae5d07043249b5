"""Oracles derive when they are imported: the test of a note alone imports its own."""

collect_ignore_glob = ["oracle_*.py", "motions.py"]
