"""Tsit5: the explicit Runge-Kutta method of order 5(4) of Tsitouras, with dense output of order 4.

Ch. Tsitouras, "Runge-Kutta pairs of order 5(4) satisfying only the first column simplifying
assumption", Computers and Mathematics with Applications 62 (2011) 770-775, table 1. The numbers here
are the doubles next to those that meet the order conditions in 60 digits with the paper's free ones
(nodes 0.161, 0.327 and 0.9, weight 0.01 of the second stage, 1/66 of the last in the error); the
tests hold them to that. The interpolant of the paper is a quartic with the slopes of both ends, that
is Hermite's cubic and theta^2 (1 - theta)^2 times its coefficients of theta^4, which stand below.
"""

from codegen.loops.tableau import Tableau

TSIT5 = Tableau(
    name="tsit5",
    order=5,
    nodes=(0, 0.161, 0.327, 0.9, 0.9800255409045097, 1.0, 1.0),
    stages=(
        (),
        (0.161,),
        (-0.008480655492356989, 0.335480655492357),
        (2.8971530571054935, -6.359448489975075, 4.3622954328695815),
        (5.325864828439257, -11.748883564062828, 7.4955393428898365, -0.09249506636175525),
        (5.86145544294642, -12.92096931784711, 8.159367898576159, -0.071584973281401,
         -0.028269050394068383),
        (0.09646076681806523, 0.01, 0.4798896504144996, 1.379008574103742, -3.290069515436081,
         2.324710524099774),
    ),
    main_stages=6,
    error_high=(-0.0017800110522257714, -0.000816434459656747, 0.007880878010261995,
                -0.1447110071732629, 0.5823571654525552, -0.45808210592918697,
                0.015151515151515152),
    dense=(
        (-1.0530884977290216, 0.1017, 2.490627285651253, -16.548102889244902, 47.37952196281928,
         -34.87065786149661, 2.5),
    ),
)  # fmt: skip
