"""Speed beside hand-written C, NumPy and SciPy: ``python -m benchmarks``."""
