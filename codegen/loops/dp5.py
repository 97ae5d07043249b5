"""DP5: the explicit Runge-Kutta method of order 5(4) of Dormand and Prince, dense output of order 4.

J. R. Dormand and P. J. Prince, "A family of embedded Runge-Kutta formulae", Journal of Computational
and Applied Mathematics 6 (1980) 19-26; the interpolant is that of Hairer, Norsett and Wanner, Solving
Ordinary Differential Equations I, 2nd ed. (1993), sect. II.6 (code DOPRI5), which needs no further
stage. Every number is a quotient, and the tests hold these to the theory exactly.
"""

from fractions import Fraction

from codegen.loops.tableau import Row, Tableau

NODES = "0 1/5 3/10 4/5 8/9 1 1"
STAGES = (
    "",
    "1/5",
    "3/40 9/40",
    "44/45 -56/15 32/9",
    "19372/6561 -25360/2187 64448/6561 -212/729",
    "9017/3168 -355/33 46732/5247 49/176 -5103/18656",
    "35/384 0 500/1113 125/192 -2187/6784 11/84",
)
ERROR = "-71/57600 0 71/16695 -71/1920 17253/339200 -22/525 1/40"
DENSE = (
    "-12715105075/11282082432 0 87487479700/32700410799 -10690763975/1880347072"
    " 701980252875/199316789632 -1453857185/822651844 69997945/29380423"
)


def exact(row: str) -> tuple[Fraction, ...]:
    """Return a row of the table as rational numbers."""
    return tuple(Fraction(number) for number in row.split())


def _rounded(row: str) -> Row:
    return tuple(float(number) for number in exact(row))


DP5 = Tableau(
    name="dp5",
    order=5,
    nodes=_rounded(NODES),
    stages=tuple(_rounded(row) for row in STAGES),
    main_stages=6,
    error_high=_rounded(ERROR),
    dense=(_rounded(DENSE),),
)
