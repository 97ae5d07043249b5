"""How accurate generated code is, and solutions with many digits."""
