"""Closed forms of small trees by Lagrange, Kane and Newton-Euler, term by term."""
