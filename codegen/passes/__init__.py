"""From program to program, each with its law."""
