"""Explicit Runge-Kutta methods with an embedded error estimate and dense output, as data."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

Row = tuple[float, ...]


@dataclass(frozen=True)
class Tableau:
    """Coefficients in the order in which stages are computed.

    ``stages[s]`` weighs the slopes before stage s; row ``main_stages`` gives the new state, whose
    slope is the next stage; the rows after it serve dense output alone. ``error_high`` weighs the
    slopes for the error estimate, ``error_low`` for a second one that the first is divided by
    (Hairer, Norsett and Wanner, sect. II.10), empty where there is one alone; ``dense`` for the last
    coefficients of the interpolant. Steps are chosen as if the estimate were of order ``order``.
    """

    name: str
    order: int
    nodes: Row
    stages: tuple[Row, ...]
    main_stages: int
    error_high: Row
    dense: tuple[Row, ...]
    error_low: Row = ()

    @property
    def dense_terms(self) -> int:
        """Number of coefficients a state of the interpolant, the three of a cubic included."""
        return 3 + len(self.dense)


def exact(row: str) -> tuple[Fraction, ...]:
    """Return a row of the table as rational numbers."""
    return tuple(Fraction(number) for number in row.split())


def _rounded(row: str) -> Row:
    return tuple(float(number) for number in exact(row))


DP5_NODES = "0 1/5 3/10 4/5 8/9 1 1"
DP5_STAGES = (
    "",
    "1/5",
    "3/40 9/40",
    "44/45 -56/15 32/9",
    "19372/6561 -25360/2187 64448/6561 -212/729",
    "9017/3168 -355/33 46732/5247 49/176 -5103/18656",
    "35/384 0 500/1113 125/192 -2187/6784 11/84",
)
DP5_ERROR = "-71/57600 0 71/16695 -71/1920 17253/339200 -22/525 1/40"
DP5_DENSE = (
    "-12715105075/11282082432 0 87487479700/32700410799 -10690763975/1880347072"
    " 701980252875/199316789632 -1453857185/822651844 69997945/29380423"
)


DP5 = Tableau(
    name="dp5",
    order=5,
    nodes=_rounded(DP5_NODES),
    stages=tuple(_rounded(row) for row in DP5_STAGES),
    main_stages=6,
    error_high=_rounded(DP5_ERROR),
    dense=(_rounded(DP5_DENSE),),
)
"""DP5: the explicit Runge-Kutta method of order 5(4) of Dormand and Prince, dense output of order 4.

J. R. Dormand and P. J. Prince, "A family of embedded Runge-Kutta formulae", Journal of Computational
and Applied Mathematics 6 (1980) 19-26; the interpolant is that of Hairer, Norsett and Wanner, Solving
Ordinary Differential Equations I, 2nd ed. (1993), sect. II.6 (code DOPRI5), which needs no further
stage. Every number is a quotient, and the tests hold these to the theory exactly.
"""

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
"""Tsit5: the explicit Runge-Kutta method of order 5(4) of Tsitouras, with dense output of order 4.

Ch. Tsitouras, "Runge-Kutta pairs of order 5(4) satisfying only the first column simplifying
assumption", Computers and Mathematics with Applications 62 (2011) 770-775, table 1. The numbers here
are the doubles next to those that meet the order conditions in 60 digits with the paper's free ones
(nodes 0.161, 0.327 and 0.9, weight 0.01 of the second stage, 1/66 of the last in the error); the
tests hold them to that. The interpolant of the paper is a quartic with the slopes of both ends, that
is Hermite's cubic and theta^2 (1 - theta)^2 times its coefficients of theta^4, which stand below.
"""

# fmt: off
DOP853 = Tableau(
    name="dop853",
    order=8,
    nodes=(0, 0.05260015195876773, 0.0789002279381516, 0.1183503419072274, 0.2816496580927726, 0.3333333333333333, 0.25, 0.3076923076923077, 0.6512820512820513, 0.6, 0.8571428571428571, 1.0, 1.0, 0.1, 0.2, 0.7777777777777778),
    stages=(
        (),
        (0.05260015195876773,),
        (0.0197250569845379, 0.0591751709536137),
        (0.02958758547680685, 0, 0.08876275643042054),
        (0.2413651341592667, 0, -0.8845494793282861, 0.924834003261792),
        (0.037037037037037035, 0, 0, 0.17082860872947386, 0.12546768756682242),
        (0.037109375, 0, 0, 0.17025221101954405, 0.06021653898045596, -0.017578125),
        (0.03709200011850479, 0, 0, 0.17038392571223998, 0.10726203044637328, -0.015319437748624402, 0.008273789163814023),
        (0.6241109587160757, 0, 0, -3.3608926294469414, -0.868219346841726, 27.59209969944671, 20.154067550477894, -43.48988418106996),
        (0.47766253643826434, 0, 0, -2.4881146199716677, -0.590290826836843, 21.230051448181193, 15.279233632882423, -33.28821096898486, -0.020331201708508627),
        (-0.9371424300859873, 0, 0, 5.186372428844064, 1.0914373489967295, -8.149787010746927, -18.52006565999696, 22.739487099350505, 2.4936055526796523, -3.0467644718982196),
        (2.273310147516538, 0, 0, -10.53449546673725, -2.0008720582248625, -17.9589318631188, 27.94888452941996, -2.8589982771350235, -8.87285693353063, 12.360567175794303, 0.6433927460157636),
        (0.054293734116568765, 0, 0, 0, 0, 4.450312892752409, 1.8915178993145003, -5.801203960010585, 0.3111643669578199, -0.1521609496625161, 0.20136540080403034, 0.04471061572777259),
        (0.056167502283047954, 0, 0, 0, 0, 0, 0.25350021021662483, -0.2462390374708025, -0.12419142326381637, 0.15329179827876568, 0.00820105229563469, 0.007567897660545699, -0.008298),
        (0.03183464816350214, 0, 0, 0, 0, 0.028300909672366776, 0.053541988307438566, -0.05492374857139099, 0, 0, -0.00010834732869724932, 0.0003825710908356584, -0.00034046500868740456, 0.1413124436746325),
        (-0.42889630158379194, 0, 0, 0, 0, -4.697621415361164, 7.683421196062599, 4.06898981839711, 0.3567271874552811, 0, 0, 0, -0.0013990241651590145, 2.9475147891527724, -9.15095847217987),
    ),
    main_stages=12,
    error_high=(0.01312004499419488, 0, 0, 0, 0, -1.2251564463762044, -0.4957589496572502, 1.6643771824549864, -0.35032884874997366, 0.3341791187130175, 0.08192320648511571, -0.022355307863886294, 0),
    error_low=(-0.18980075407240762, 0, 0, 0, 0, 4.450312892752409, 1.8915178993145003, -5.801203960010585, -0.4226823213237919, -0.1521609496625161, 0.20136540080403034, 0.02265179219836082, 0),
    dense=(
        (-8.428938276109013, 0, 0, 0, 0, 0.5667149535193777, -3.0689499459498917, 2.38466765651207, 2.117034582445028, -0.871391583777973, 2.2404374302607883, 0.6315787787694688, -0.08899033645133331, 18.148505520854727, -9.194632392478356, -4.436036387594894),
        (10.427508642579134, 0, 0, 0, 0, 242.28349177525817, 165.20045171727028, -374.5467547226902, -22.113666853125306, 7.733432668472264, -30.674084731089398, -9.332130526430229, 15.697238121770845, -31.139403219565178, -9.35292435884448, 35.81684148639408),
        (19.985053242002433, 0, 0, 0, 0, -387.0373087493518, -189.17813819516758, 527.8081592054236, -11.57390253995963, 6.8812326946963, -1.0006050966910838, 0.7777137798053443, -2.778205752353508, -60.19669523126412, 84.32040550667716, 11.99229113618279),
        (-25.69393346270375, 0, 0, 0, 0, -154.18974869023643, -231.5293791760455, 357.6391179106141, 93.40532418362432, -37.45832313645163, 104.0996495089623, 29.8402934266605, -43.53345659001114, 96.32455395918828, -39.17726167561544, -149.72683625798564),
    ),
)
"""DOP853: the explicit Runge-Kutta method of order 8(5,3) of Dormand and Prince, with dense output.

The coefficients are those of Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I,
2nd ed. (1993), sect. II.5 and II.6 (code DOP853). The tests check the order conditions and compare
them with the class of SciPy. The error estimate combines one of order 5 and one of order 3; the
interpolant is of order 7 and needs three further stages.
"""
