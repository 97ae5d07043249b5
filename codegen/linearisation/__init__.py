"""Equilibria, linear motion about them, sensitivities."""
