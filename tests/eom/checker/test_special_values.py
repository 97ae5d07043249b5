r"""Lines about a system beside values of its quantities: "for theta = pi/2", in the line or in words."""

import pytest

import eom

HOOP = r"""
[system]
coordinates = { theta = "rad" }
given = { phi = "rad" }
assume = ["phi_dot constant"]
parameters = { m = "kg", R = "m", g = "m/s^2" }
gravity = [0, 0, "-g"]
[system.bodies]
bead = { mass = "m", at = ["R*sin(theta)*cos(phi)", "R*sin(theta)*sin(phi)", "-R*cos(theta)"] }
[system.symbols]
'\Omega' = "phi_dot"
'\alpha' = "theta"
"""
ORBIT = r"""
[system]
coordinates = { r = "m", theta = "rad" }
parameters = { m = "kg", mu = "m^3/s^2", a = "m" }
potential = "-m*mu/r"
[system.bodies]
planet = { mass = "m", at = ["r*cos(theta)", "r*sin(theta)", 0] }
"""
OF_THE_HOOP = {
    r"$$\ddot\alpha=-\frac gR\quad\text{for }\alpha=\frac\pi2$$": "holds",
    r"$$\ddot\alpha=-\frac gR\quad\text{at }\alpha=\frac\pi2$$": "holds",
    r"$$\ddot\alpha=\frac gR\quad\text{for }\alpha=\frac\pi2$$": "wrong",
    "At $\\alpha=\\pi/2$ it is\n\n$$\\ddot\\alpha=-\\frac gR$$": "holds",
    "At $\\alpha=\\pi/2$ it is\n\n$$\\ddot\\alpha=\\frac gR$$": "wrong",
    "When $\\dot\\alpha=0$,\n\n$$T=\\tfrac12mR^2\\Omega^2\\sin^2\\alpha$$": "holds",
    "When $\\dot\\alpha=0$,\n\n$$T=\\tfrac12mR^2\\Omega^2\\cos^2\\alpha$$": "wrong",
    "For $\\alpha=\\pi/2$ the bead is level.\n\nIn general\n\n$$\\ddot\\alpha=-\\frac gR$$": "wrong",
}
OF_AN_ORBIT = {  # on a circle, not only where it is passed
    r"$$\dot\theta^2=\frac{\mu}{a^3}\quad\text{for }r=a$$": "holds",
    r"$$\dot\theta^2=\frac{\mu}{a^2}\quad\text{for }r=a$$": "wrong",
    r"$$V=-\frac{m\mu}{a}\quad\text{for }r=a$$": "holds",
    r"$$V=-\frac{m\mu}{2a}\quad\text{for }r=a$$": "wrong",
}


ROWS = [(HOOP, *row) for row in OF_THE_HOOP.items()] + [
    (ORBIT, *row) for row in OF_AN_ORBIT.items()
]
TRUE = [row for row in ROWS if row[2] == "holds"]


def verdict_of(lexicon, note, tmp_path):
    path = tmp_path / "own.lexicon.toml"
    path.write_text(lexicon)
    return [f.verdict for f in eom.check(note, lexicon=path).findings if f.kind == "display"][-1]


@pytest.mark.parametrize(("lexicon", "note", "wanted"), [*TRUE, ROWS[2]])
def test_values_in_a_system(lexicon, note, wanted, tmp_path):
    assert verdict_of(lexicon, note, tmp_path) == wanted


@pytest.mark.slow
@pytest.mark.parametrize(("lexicon", "note", "wanted"), [r for r in ROWS if r not in TRUE])
def test_other_values_in_a_system(lexicon, note, wanted, tmp_path):
    assert verdict_of(lexicon, note, tmp_path) == wanted
