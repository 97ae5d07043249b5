"""Checking of hand derivations: reading of notes, their notation, and the verdict on every line."""
