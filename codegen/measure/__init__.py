"""Tools that measure: run time against error, numerical stability."""
