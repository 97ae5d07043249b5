"""Integrate a system by SciPy alone, with functions that SymPy prints: an oracle of motions."""

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp


def run(system, values, start, t_end, points=200):
    """Return times, states by row, the symbols of the states, and numbers by parameter."""
    states = [q.symbol for q in system.states]
    numbers = {q.symbol: values[q.name] for q in system.parameters}
    rates = [system.expand(r).subs(numbers) for r in system.rates]
    function = sp.lambdify([states], rates, "math")
    grid = np.linspace(0, t_end, points)
    found = solve_ivp(
        lambda t, x: function(x), (0, t_end), start, "DOP853", grid, rtol=1e-11, atol=1e-13
    )
    assert found.success
    return grid, found.y, states, numbers
