"""Notes that are judged true become derivations and come back; what is not true stays a note."""

from functools import cache

import pytest

import eom
from eom.checker.note.kept import TRUE, from_note, to_note
from eom.derivations import names
from eom.errors import InputError
from tests.eom.own_derivations import OWN

CHAPTERS = [n for n in names() if not n.startswith("inertia-of-")]
SIGN = "only equations between these are judged"
CONDITION = "a condition: it does not hold for all bodies and motions"
OPEN = {
    "rigid-body-momentum": "not an integral over a body",  # of dF
    "energy-dissipation": CONDITION,
    "torque-free-motion": "it is not known how this depends on the variable",
    "gyrostat": CONDITION,
    "rocket-equation": "a number that is given; nothing here determines it",  # m_0, away from t_0
    "collisions": SIGN,
    "heavy-symmetric-top": SIGN,
    "gravity-gradient-stability": CONDITION,
}
"""Chapters with a line that the reader of notes leaves undecided, and why."""
UNSAID = {"virtual-work": "places of all masses as functions of coordinates"}
"""Chapters that no note can say, and what of them."""
AGAIN = {"inertia-properties": "words within a formula"}
"""Chapters that come back from a note, of which another note has lines that are undecided, and why."""


def faults(text):
    return [
        (f.line, f.verdict, f.reason)
        for f in eom.check(text).findings
        if f.kind == "display" and f.verdict not in {*TRUE, "no claim"}
    ]


@pytest.mark.sparse(only=["variable-mass", "tilde-identities", "transport-theorem"])
@pytest.mark.parametrize("name", [n for n in CHAPTERS if n not in {*OPEN, *UNSAID}])
def test_a_derivation_becomes_a_note_of_true_lines_and_comes_back(name):
    d = eom.derive(name)
    note = to_note(d)
    assert faults(note) == []
    back = from_note(note)
    assert back.title == d.title
    assert len(back.steps) >= sum(s.kind == "result" for s in d.steps)
    assert all(s.evidence for s in back.steps)
    found = faults(to_note(back))
    assert bool(found) == (name in AGAIN)
    assert all(v == "undecided" and reason.startswith(AGAIN[name]) for _, v, reason in found)


@pytest.mark.parametrize("name", UNSAID)
def test_a_chapter_that_no_note_can_say_is_refused(name):
    with pytest.raises(InputError, match=UNSAID[name]):
        to_note(eom.derive(name))


@pytest.mark.slow
@pytest.mark.parametrize("name", OPEN)
def test_what_the_reader_cannot_decide_is_said(name):
    note = to_note(eom.derive(name))
    found = faults(note)
    assert found
    assert all(verdict == "undecided" for _, verdict, _ in found)
    assert any(OPEN[name] in reason for *_, reason in found)
    with pytest.raises(InputError, match=r"not judged true|cannot be verified without the note"):
        from_note(note)


NOTE = r"""+++
[check]
preset = "arrow-tilde"
[check.symbols]
'\vec F' = "force P"
'm' = "mass P"
'\vec R' = "position P OI"
'\vec\rho' = "position P O"
'\vec H_O' = "angular_momentum P O"
'\vec u' = "vector u"
'\vec v' = "vector v"
'\vec w' = "vector w"
+++

# A particle

Newton's second law holds.

The momentum changes by the force, as the mass is constant:

$$ \vec F = m \ddot{\vec R} $$

$$ \vec H_O = m \vec\rho \times \dot{\vec\rho} $$
"""


def test_steps_have_reasons_lines_and_assumptions():
    d = from_note(NOTE)
    assert (d.name, d.title, d.group) == ("a-particle", "A particle", "Notes")
    first = d.steps[0]
    assert first.reason == "The momentum changes by the force, as the mass is constant"
    assert set(first.assumptions) == {"newton_2", "one_particle"}
    assert first.evidence == "held in 3 random worlds"
    assert "A particle" in d.page("html")
    assert d.steps[1].reason == "line 23 of the note"


CHAIN = r"""$$\begin{aligned}
\vec u \times (\vec v \times \vec w) &= \vec v (\vec u \cdot \vec w) - \vec w (\vec u \cdot \vec v) \\
 &= (\vec u \cdot \vec w) \vec v - (\vec u \cdot \vec v) \vec w \\
 &= -(\vec v \times \vec w) \times \vec u
\end{aligned}$$"""


def test_a_chain_comes_back_as_a_chain():
    steps = from_note(NOTE + CHAIN).steps[2:]
    assert len({s.statement.left for s in steps}) == 1
    assert len({s.statement.right for s in steps}) == len(steps) == 2


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        (r"m \ddot", r"2 m \ddot", "not judged true.*wrong"),
        (r"\vec F = m \ddot{\vec R}", r"\vec F = m \ddot{\vec Z}", "not judged true.*undecided"),
        (
            r"$$ \vec H_O = m \vec\rho \times \dot{\vec\rho} $$",
            r"$$ \vec F + m = 0 $$",
            "ill-formed",
        ),
        ("$$", "$", "no line of this note"),
    ],
)
def test_a_note_that_is_not_true_is_refused_with_its_line(old, new, what):
    with pytest.raises(InputError, match=rf"(?s){what}"):
        from_note(NOTE.replace(old, new))


# -- what a note declares to move ----------------------------------------------------------------------


@cache
def own_note(name):
    return to_note(OWN[name]().finish())


@pytest.mark.sparse(only=["bead_by_kane", "moving_point", "pendulum_by_hamilton"])
@pytest.mark.parametrize("name", OWN)
def test_a_derivation_of_ones_own_becomes_a_note_and_comes_back(name):
    """Frames, places, bodies and laws stand in its front matter."""
    note = own_note(name)
    assert faults(note) == []
    back = from_note(note)
    d = OWN[name]()
    assert back.own.frames == d.own.frames
    assert set(back.own.points) == set(d.own.points)
    assert len(back.own.laws) == len(d.own.laws)
    assert len(back.steps) >= len(d.steps) - 4
    assert faults(to_note(back)) == []


ACTIVE = r"\cdot \left( -m g \hat{h}_{3} \right) = "
SLIPS = [
    ("bead_by_kane", r"\ddot{q} = w^{2}", r"\ddot{q} = -w^{2}", "left less right is w**2*sin(2*q)"),
    ("bead_by_kane", r"= 2 m R \dot{q} w", r"= m R \dot{q} w", "left less right is "),
    ("bead_by_kane", ACTIVE + "-m R g", ACTIVE + "m R g", "left less right is -2*R*g*m*sin(q)"),
    ("disc", r"n = m g \cos", r"n = m g \sin", "left less right"),
    (
        "pendulum_by_hamilton",
        r"\frac{\partial H}{\partial p} = \dot{q}",
        r"\frac{\partial H}{\partial p} = 2 \dot{q}",
        "left less right is -q_dot",
    ),
]


@pytest.mark.parametrize(("name", "old", "new", "why"), SLIPS)
def test_a_slip_in_such_a_note_is_found_and_told(name, old, new, why):
    note = own_note(name)
    assert old in note
    found = faults(note.replace(old, new))
    assert [verdict for _, verdict, _ in found] == ["wrong"]
    assert why in found[0][2]
    with pytest.raises(InputError, match="not judged true"):
        from_note(note.replace(old, new))


DECLARED = """+++
[check]
preset = "arrow-tilde"
[check.symbols]
'q' = "coordinate q"
'w' = "scalar w"
%s
+++

$$ \\ddot q = 0 $$
"""


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ("[check.turned]\nH = 3", "not such a table"),
        ("[check.turned]\nH = { form = 'I' }", "not such a table"),
        ("[check.turned]\nH = { angle = 'q', axis = 4 }", "axis 1, 2 or 3"),
        ("[check.turned]\nH = { angle = 'x' }", "symbol without a meaning"),
        ("[check.placed]\nQ = 'q'", "this is no vector"),
        ("[check.placed]\nQ = 3", "not a formula"),
        ("[[check.determined]]\nlaw = 'q'\ngives = ['q']", "a law is an equation"),
        ("[[check.determined]]\nlaw = '\\dot q = w'\ngives = ['v']", "no coordinate in this law"),
        ("[check.determined]\nlaw = '\\dot q = w'", "not a table"),
    ],
)
def test_what_is_declared_wrongly_says_so(tables, said):
    with pytest.raises(InputError, match=said):
        eom.check(DECLARED % tables)


STARTED = {
    "w = w(t_0) - g (t - t_0)": "holds",
    "g t + w = g t_0 + w_0": "holds",
    "w = w(t_0) - g t": "wrong",
    "w = w_0 + g (t - t_0)": "wrong",
    r"w_1 = w(t_2) + g \cdot (t_2 - t_1)": "holds",
    r"w_1 = w(t_2) - g \cdot (t_2 - t_1)": "wrong",
    "w(t) - w(0) = -g t": "undecided",
}


@pytest.mark.parametrize("line", STARTED)
def test_time_that_is_a_coordinate_need_not_start_from_zero(line):
    note = "+++\n[check]\npreset = 'arrow-tilde'\n[check.symbols]\n"
    note += "'g' = 'scalar g'\n't' = 'coordinate t'\n'w' = 'coordinate w'\n"
    for law, name in ((r"\dot{t} = 1", "t"), (r"\dot{w} = -g", "w")):
        note += f"[[check.determined]]\nlaw = '{law}'\ngives = ['{name}']\n"
    (found,) = eom.check(f"{note}+++\n\n$$ {line} $$\n").findings
    assert found.verdict == STARTED[line]


def test_a_law_that_is_declared_decides_what_was_open():
    law = "[[check.determined]]\nlaw = '\\dot q = w'\ngives = ['q']"
    assert [f.verdict for f in eom.check(DECLARED % "").findings] == ["undecided"]
    assert [f.verdict for f in eom.check(DECLARED % law).findings] == ["holds"]
    other = (DECLARED % law).replace("ddot q = 0", "ddot q = w")
    assert [f.verdict for f in eom.check(other).findings] == ["wrong"]
    order = (DECLARED % law).replace("ddot q = 0", "ddot q \\ge 0")
    assert [f.verdict for f in eom.check(order).findings] == ["undecided"]
