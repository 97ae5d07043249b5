"""Integration of systems: methods as tables, one adaptive loop in C, and SciPy's methods."""
