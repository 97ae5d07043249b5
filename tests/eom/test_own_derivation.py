"""Derivations of one's own: own frames, points, bodies and laws; false lines are refused."""

import inspect
import random
from functools import cache

import pytest
import sympy as sp

import eom
from eom.derivations.forms import show_derivation
from eom.derivations.showing import FORMATS
from eom.derivations.verification import DerivationError, plain
from eom.terms.terms import Equation, add, cross, der, dot, expr, mul, partial
from eom.terms.vocabulary import omega, position, quantity, unit, velocity
from tests.eom import oracle
from tests.eom.mutants import judged_steps, mutants
from tests.eom.own_derivations import MOTIONS, OWN
from tests.eom.own_oracle import Mechanics

q, qd, qdd, m, g, R, w, L, W = sp.symbols("q q_d q_dd m g R w L W", real=True)


def hoop():
    """A bead on a hoop that turns about its vertical diameter, by Lagrange."""
    d = eom.Derivation("hoop", "A bead on a hoop", "Own")
    for s, name in ((m, "m"), (g, "g"), (R, "R"), (w, "w")):
        d.name_scalar(s, quantity("scalar", name), name)
    d.name_scalar(q, quantity("coordinate", "q"), "angle from the lowest point")
    d.name_scalar(qd, der(expr(q)), "its rate")
    d.name_scalar(qdd, der(expr(qd)), "its second rate")
    turn = sp.Symbol("turn", real=True)
    d.name_scalar(turn, quantity("coordinate", "turn"), "angle of the hoop")
    d.determine(Equation(der(expr(turn)), expr(w)), turn)
    d.frame("H", turn)
    side, up = (expr(R * f) for f in (sp.sin(q), -sp.cos(q)))
    d.point("Q", add(mul(side, unit("H", 1)), mul(up, unit("H", 3))))
    return d


T = m * R**2 * (qd**2 + w**2 * sp.sin(q) ** 2) / 2
V = -m * g * R * sp.cos(q)


def test_a_bead_on_a_hoop_by_lagrange():
    d = hoop()
    v = velocity("Q")
    d.state(Equation(mul(expr(m / 2), dot(v, v)), expr(T)), "kinetic energy")
    d.state(Equation(partial(expr(T - V), expr(qd)), expr(m * R**2 * qd)), "momentum")
    law = Equation(der(partial(expr(T - V), expr(qd))), partial(expr(T - V), expr(q)))
    d.determine(law, q)
    motion = w**2 * sp.sin(q) * sp.cos(q) - g / R * sp.sin(q)
    d.state(Equation(expr(qdd), expr(motion)), "equation of motion", label="motion")
    count = len(d.steps)
    for false in (-motion, motion.subs(w, 0), motion + 2 * g / R * sp.sin(q),
                  w**2 * sp.sin(q) * sp.cos(q) - g / R * sp.cos(q)):  # fmt: skip
        with pytest.raises(DerivationError, match="false"):
            d.state(Equation(expr(qdd), expr(false)), "mutant")
    assert len(d.steps) == count
    assert d.finish()["motion"].evidence == "held in 3 random worlds"


# -- five derivations and one, with their mutants -----------------------------------------------------


def symbol(name):
    return sp.Symbol(name, real=True)


def truth(d):
    """What says whether a line is true: SymPy's vectors, or masses with smooth motions."""
    if d.name in MOTIONS:
        return Mechanics(d, MOTIONS[d.name]).is_true
    return lambda line: oracle.is_true(line, d.assumed, d.scalars)


def judged(d, equation):
    """What becomes of a line: accepted, or refused in words."""
    try:
        d.check(equation, "mutant")
    except eom.InputError as error:
        return error.what
    return "accepted"


@cache
def made(name):
    """A derivation to which no line is added."""
    return OWN[name]()


@pytest.fixture(params=OWN)
def own(request, monkeypatch):
    monkeypatch.setattr("eom.derivations.derivation.disagreement", lambda *_: "")  # takes longer
    d = made(request.param)
    return d, truth(d)


def lines_of(d):
    """Steps that say something of quantities; where a point is, is free to be said."""
    return [s for s in judged_steps(d.finish()) if s.statement.left.data[:2] != ("position", "A")]


@pytest.mark.parametrize("name", OWN)
def test_a_derivation_takes_thirty_lines_at_most(name):
    lines = inspect.getsource(OWN[name]).splitlines()
    assert len([line for line in lines if line.strip() and '"""' not in line]) <= 30


def test_every_line_is_true_by_other_means(own):
    d, true = own
    for step in lines_of(d):
        assert true(step.statement), step.label


@pytest.mark.parametrize(
    "most", [4, pytest.param(10**4, marks=pytest.mark.slow)], ids=["some", "all"]
)
def test_every_mutant_is_refused_unless_it_is_true(own, most):
    """All single edits are judged; of those that pass, and of some that do not, it is asked elsewhere."""
    d, true = own
    found = [e.equation for s in lines_of(d) for e in mutants(s.statement, d.assumed) if e.equation]
    verdicts = [(e, judged(d, e)) for e in found]
    passed = [e for e, verdict in verdicts if verdict == "accepted"]
    refused = [e for e, verdict in verdicts if verdict == "the step is false"]
    assert len(found) > 80
    assert len(refused) > 0.5 * len(found)
    draw = random.Random(d.name)
    wrong = [e for e in draw.sample(passed, min(most, len(passed))) if not true(e)]
    missed = [e for e in draw.sample(refused, min(most, 40)) if true(e)]
    assert [f"{plain(e.left)} = {plain(e.right)}" for e in (*wrong, *missed)] == []


# -- what is declared in a line -----------------------------------------------------------------------


@pytest.fixture
def plane():
    """A derivation with a body in the plane."""
    d = eom.Derivation("plane", "A rod in the plane", "Own")
    M, J = d.constants(M="mass", J="moment of inertia")
    x, x_dot, _ = d.coordinate("x", "place")
    u, u_dot, u_ddot = d.coordinate("u", "angle")
    d.frame("K", u)
    d.body("D", M, x * unit("I", 1), "K", (J, J, J))
    return d, M, J, x, x_dot, u, u_dot, u_ddot


def test_a_body_has_momenta_and_energy(plane):
    d, M, J, _, x_dot, _, u_dot, _ = plane
    e1, e3 = unit("I", 1), unit("I", 3)
    d.state(Equation(quantity("linear_momentum", "D"), M * x_dot * e1), "momentum")
    d.state(Equation(quantity("angular_momentum", "D", "D"), J * u_dot * e3), "about its centre")
    d.point("K1", unit("I", 2))
    about = quantity("absolute_angular_momentum", "D", "K1")
    d.state(Equation(about, J * u_dot * e3 + M * x_dot * e3), "about another point")
    energy = (M * x_dot**2 + J * u_dot**2) / 2
    d.state(Equation(quantity("kinetic_energy", "D"), energy), "energy")
    for false in (2 * energy, energy - J * u_dot**2 / 2, energy + M * u_dot):
        with pytest.raises(DerivationError, match="false"):
            d.state(Equation(quantity("kinetic_energy", "D"), false), "mutant")


def test_a_wire_is_a_constraint_on_places(plane):
    """y = f(x) by itself, beside a law of second order for x: it is differentiated as often as needed."""
    d, M, *_ = plane
    (s, s_dot, s_ddot), (h, _, h_ddot) = (d.coordinate(n, "place") for n in ("s", "h"))
    (force,) = d.coordinate("N", "force of the wire", 0)
    d.determine(Equation(h, s**2), h, reason="a wire")
    d.state(Equation(h_ddot, 2 * s_dot**2 + 2 * s * s_ddot), "twice differentiated")
    d.determine(Equation(M * s_ddot, -2 * s * force), s, reason="along the ground")
    d.determine(Equation(M * h_ddot, force - M * 10), force, reason="upwards")
    d.state(Equation(s_ddot * (1 + 4 * s**2), -2 * s * (10 + 2 * s_dot**2)), "on a parabola")
    with pytest.raises(DerivationError, match="false"):
        d.state(Equation(s_ddot * (1 + 4 * s**2), -2 * s * (10 + s_dot**2)), "mutant")


def test_coupled_laws_are_solved_together(plane):
    d, *_ = plane
    (s, _, s2), (h, _, h2) = (d.coordinate(n, "place") for n in ("s", "h"))
    d.determine(Equation(2 * s2 + h2, -s), s)
    d.determine(Equation(s2 + 2 * h2, -h), h)
    d.state(Equation(3 * s2, h - 2 * s), "eliminated")
    with pytest.raises(DerivationError, match="false"):
        d.state(Equation(3 * s2, h - s), "mutant")


def test_a_law_at_odds_with_another_is_refused(plane):
    d, *_, u, u_dot, u_ddot = plane
    d.determine(Equation(u_dot, 1), u)
    with pytest.raises(eom.InputError, match=r"no motion keeps|undefined in every"):
        d.determine(Equation(u_ddot, 1), u)
    assert len(d.own.laws) == 1
    d.state(Equation(u_ddot, 0), "the first law stands")


def test_what_was_refused_leaves_nothing_behind(plane):
    """A law that is refused, and another in its place: the worlds are those of the second."""
    d, *_, u, u_dot, u_ddot = plane
    with pytest.raises(eom.InputError):
        d.determine(Equation(u_dot**2, 1), u)
    d.determine(Equation(u_dot, 1), u)
    d.state(Equation(u_ddot, 0), "of the second")
    with pytest.raises(eom.InputError):
        d.point("G", symbol("zz") * unit("I", 1))
    d.point("G", 2 * unit("I", 1))
    d.state(Equation(position("G"), 2 * unit("I", 1)), "of the second")


WRONG = {
    "a frame of a name that is taken": lambda d: d.frame("K", 1),
    "a frame about no axis": lambda d: d.frame("G", 1, axis=4),
    "a point of a name that is taken": lambda d: d.point("C", unit("I", 1)),
    "a point at a number": lambda d: d.point("G", 1),
    "a point that is no name": lambda d: d.point("a b", unit("I", 1)),
    "moments without a frame": lambda d: d.body("G", 1, unit("I", 1), moments=(1, 1, 1)),
    "a frame without moments": lambda d: d.body("G", 1, unit("I", 1), "K"),
    "rolling of what is no body": lambda d: d.rolls("G", unit("I", 1)),
    "a law that determines a constant": lambda d: d.determine(
        Equation(1, symbol("M")), symbol("M")
    ),
    "a law without what it determines": lambda d: d.determine(
        Equation(symbol("x_dot"), 1), symbol("u")
    ),
    "two coordinates of one name": lambda d: d.coordinate("M", "another"),
    "a place with an unknown symbol": lambda d: d.point("G", symbol("zz") * unit("I", 1)),
    "a line with a text": lambda d: d.state(Equation("x", 1), "text"),
    "a line of two kinds": lambda d: d.state(Equation(unit("I", 1), 1), "kinds"),
    "an unknown assumption": lambda d: d.assume("rigit"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_cannot_be_is_refused_and_nothing_is_kept(plane, what):
    d = plane[0]
    before = len(d.steps), dict(d.own.frames), dict(d.own.points), len(d.own.laws)
    with pytest.raises(eom.InputError):
        WRONG[what](d)
    assert (len(d.steps), dict(d.own.frames), dict(d.own.points), len(d.own.laws)) == before


# -- what an error says -----------------------------------------------------------------------------


def test_a_false_line_says_what_is_left_over_and_where_it_fails():
    d = made("bead_by_lagrange")
    with pytest.raises(DerivationError) as caught:
        d.state(
            Equation(symbol("q_ddot"), w**2 * sp.sin(q) * sp.cos(q) + g / R * sp.sin(q)), "slip"
        )
    hint = caught.value.hint
    assert hint.startswith("left less right is -2*g*sin(q)/R; where R = ")
    assert "the left side is" in hint
    assert all(f"{name} = " in hint for name in ("g", "w", "q", "q_ddot"))


def test_of_vectors_components_are_told():
    d = made("foucault")
    with pytest.raises(DerivationError) as caught:
        d.state(Equation(cross(omega("E"), unit("E", 1)), -W * unit("E", 2)), "slip")
    assert "left less right is (-2*W*sin(turn), 2*W*cos(turn), 0)" in caught.value.hint
    assert "components in I" in caught.value.hint


def test_what_holds_of_no_symbols_is_told_by_a_world():
    d = made("moving_point")
    law = Equation(
        der(quantity("absolute_angular_momentum", "system", "A")), quantity("torque", "system", "A")
    )
    with pytest.raises(DerivationError) as caught:
        d.state(law, "a slip of many books")
    assert caught.value.hint.startswith("the left side is (")
    assert "left less right" not in caught.value.hint


# -- on paper ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("style", FORMATS)
@pytest.mark.parametrize("name", OWN)
def test_it_is_shown_as_those_that_ship_are(name, style):
    shown = show_derivation(made(name).finish(), style)
    assert "each verified when it was made" in shown
    assert "any number" not in shown
    assert "any coordinate" not in shown


def test_a_chain_is_one_block_and_names_of_frames_are_told():
    d = made("bead_by_kane")
    shown = show_derivation(d.finish())
    assert "frame H is turned from I about axis 3 through turn" in shown.replace("Frame", "frame")
    assert "second rate of q" in shown
    assert position("Q") in {s.statement.left for s in d.steps}
