"""Derivatives of programs: Jacobians, products, Taylor recurrences."""
