"""From a system, or SymPy's mechanics, to a program: lowering, layout, what is known of its structure."""
