"""A body that loses energy: the slug in oil, the energy sink, the major-axis rule."""

from functools import lru_cache

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

from eom import derive, problems
from eom.mechanics.dissipation import (
    damped_stability,
    effective_inertia_rate,
    energy_rate,
    excess_energy,
    nutation_rate,
    nutation_trend,
    viscous_slug,
)
from tests.statements.table import same, says

SPINNING = "notebooks/lecture-001-spinning-body.ipynb"
WORK = "notebooks/work-precision.ipynb"
SLUG = viscous_slug()
STATES = [q.symbol for q in SLUG.states]
PARAMETERS = {q.name: q.symbol for q in SLUG.parameters}
NUMBERS = {"I1": 1.0, "I2": 2.0, "I3": 3.0, "J_s": 0.3, "c": 0.3}
WHOLE = np.array([1.3, 2.3, 3.3])
"""Moments with the slug."""


def along(f):
    """Return the rate of an expression along the motion of body and slug."""
    return sum(sp.diff(f, x) * r for x, r in zip(STATES, SLUG.rates, strict=True))


def energy_and_momentum():
    """Return energy, and the momentum in the body as a column, of body and slug."""
    w, s = sp.Matrix(STATES[:3]), sp.Matrix(STATES[3:])
    J = sp.diag(*(PARAMETERS[n] for n in ("I1", "I2", "I3")))
    slug = PARAMETERS["J_s"] * (w + s)
    return (w.dot(J * w) + slug.dot(w + s)) / 2, J * w + slug


@lru_cache(maxsize=8)
def run(start, end=200.0):
    """Return times, momenta (3, N) and energies of the body of the notebook."""
    put = {PARAMETERS[n]: v for n, v in NUMBERS.items()}
    rates = sp.lambdify(STATES, [r.subs(put) for r in SLUG.rates])
    energy, momentum = energy_and_momentum()
    told = sp.lambdify(STATES, [energy.subs(put), *momentum.subs(put)])
    t = np.linspace(0, end, 4001)
    found = solve_ivp(lambda _, x: rates(*x), (0, end), start, "DOP853", t, rtol=1e-10, atol=1e-12)
    energies, *h = told(*found.y)
    return t, np.array(h), energies, found.y


LEAST = (1.0, 0.02, 0.05, 0.0, 0.0, 0.0)


@says(SPINNING, "The momentum of the whole is constant whatever goes on inside.")
@says(SPINNING, "$H$ stays and $T$ falls")
@says(
    "derive energy-dissipation energy-rate",
    "energy falls as long as the slug slips, whatever the motion",
)
@says(SPINNING, "Energy falls as long as anything slips, and stays constant only in steady spin.")
@says(SPINNING, r"of the sum of both powers only the part in $\boldsymbol\sigma$ is left")
def energy_falls_and_momentum_stays():
    energy, h = energy_and_momentum()
    assert same(along(h.dot(h)), 0)
    s = STATES[3:]
    assert same(along(energy), -PARAMETERS["c"] * sum(x**2 for x in s))
    assert same(energy_rate(), -PARAMETERS["c"] * sum(x**2 for x in s))
    # nothing slips for good only where the slug's rates vanish with it: omega x J omega = 0
    held = [r.subs(dict.fromkeys(s, 0)) for r in SLUG.rates]
    w, J = sp.Matrix(STATES[:3]), sp.diag(*(PARAMETERS[n] for n in ("I1", "I2", "I3")))
    crossed = w.cross(J * w)
    assert all(same(held[3 + k] * J[k, k], crossed[k]) for k in range(3))


@says(
    SPINNING,
    r"It spirals out from $\hat b_1$, crosses the separatrix, and winds down onto $-\hat b_3$.",
)
@says(SPINNING, "off the axis by a few degrees")
def the_body_of_the_notebook_turns_over():
    _, h, energy, _ = run(LEAST)
    start = h[:, 0] / np.linalg.norm(h[:, 0])
    assert 2 < np.degrees(np.arccos(start[0])) < 9
    assert np.all(np.diff(energy) < 1e-9)
    H = np.linalg.norm(h, axis=0)
    assert np.ptp(H) < 1e-7
    parted = H[0] ** 2 / (2 * WHOLE[1])  # the energy of the separatrix
    assert energy[0] > parted > energy[-1]
    out = np.hypot(h[1], h[2])[energy > parted]
    assert out[-1] > 3 * out[0]
    np.testing.assert_allclose(h[:, -1] / H[-1], (0, 0, -1), atol=0.15)


@says(SPINNING, "a free body that loses energy ends in spin about the axis of its greatest moment.")
@says(
    "derive energy-dissipation excess",
    "the motion ends in a steady spin, and of these it is the one without energy to lose: the major-axis rule",
)
@says(
    "notebooks/lecture-000-polhodes.ipynb",
    "drifts from curve to curve, until only the axis of the greatest moment is left",
)
@says(
    "eom.mechanics.dissipation.effective_inertia_rate",
    "H^2/(2 T) lies between the least and the greatest moment and never falls",
)
def every_start_ends_about_the_greatest_moment():
    draw = np.random.default_rng(1)
    for start in draw.normal(size=(3, 3)):
        _, h, energy, _ = run((*start, 0.0, 0.0, 0.0), 800.0)
        effective = (h**2).sum(axis=0) / (2 * energy)
        assert np.all(np.diff(effective) > -1e-8)
        assert WHOLE[0] < effective[0] < effective[-1] < WHOLE[2] + 1e-6
        assert WHOLE[2] - effective[-1] < 1e-3


@says(
    "eom.mechanics.dissipation.excess_energy", "No coefficient is negative where it is the greatest"
)
@says(SPINNING, r"if $I_3$ is the greatest moment no factor is negative")
@says(
    SPINNING,
    r"with $H$ given, the energy above that of a spin about $\hat b_3$ is a sum of squares",
)
def the_least_energy_is_in_spin_about_the_greatest_moment():
    pairs = excess_energy(3)
    energy, h = energy_and_momentum()
    names = {f"h_{k}": h[k - 1] for k in (1, 2, 3)}
    over = {s: names.get(s.name, s) for _, base in pairs for s in base.free_symbols}
    total = sum(f * (base**2).xreplace(over) for f, base in pairs)
    whole = PARAMETERS["I3"] + PARAMETERS["J_s"]
    assert same(total, energy - h.dot(h) / (2 * whole))
    for moments, signs in (((1.0, 1.5, 2.2), {1}), ((2.0, 1.5, 1.1), {1, -1})):
        put = {PARAMETERS[f"I{k}"]: v for k, v in enumerate(moments, 1)} | {PARAMETERS["J_s"]: 0.4}
        assert {int(sp.sign(f.subs(put))) for f, _ in pairs} == signs


@says(
    "derive energy-dissipation momentum-parts",
    "momenta add: of the body, with its own inertia, and of the slug",
)
@says("derive energy-dissipation slug-momentum", "the slug turns with the body, and in it")
def moments_are_those_of_the_body_and_the_slug_adds_its_own():
    """The principal moments of this chapter are the body's: with the slug at rest in it each grows by J_s."""
    energy, h = energy_and_momentum()
    still = dict.fromkeys(STATES[3:], 0)
    for k, rate in enumerate(STATES[:3], 1):
        whole = PARAMETERS[f"I{k}"] + PARAMETERS["J_s"]
        assert same(h[k - 1].subs(still), whole * rate)
        assert same(energy.subs(still).diff(rate), whole * rate)
    letters = derive("energy-dissipation").letters
    for k in (1, 2, 3):
        assert letters[PARAMETERS[f"I{k}"]].endswith("of the body without the slug")


@says(
    "derive energy-dissipation hurwitz",
    "of the three spins that about the greatest moment alone is stable, for every slug and film",
)
@says(
    "eom.mechanics.dissipation.damped_spin",
    "The conditions hold if and only if I_k of the body exceeds both other moments, for every J_s, c and nu.",
)
def spin_about_the_greatest_moment_alone_is_stable():
    draw = np.random.default_rng(2)
    for _ in range(4):
        squares = draw.uniform(0.2, 2, 3)
        moments = squares.sum() - squares
        slug, damping, rate = 10 ** draw.uniform(-2, 1, 3)
        for axis in (1, 2, 3):
            said = damped_stability(moments.tolist(), axis, slug, damping, rate)
            assert said == ("stable" if axis == moments.argmax() + 1 else "unstable")


@says(
    "derive energy-dissipation sink-nutation",
    "the angle falls if I_a > I_t, to spin about the axis of a disc, and grows if I_a < I_t, to the flat spin of a rod",
)
@says(
    "eom.mechanics.dissipation.nutation_trend",
    "oblate bodies are stable, prolate ones end in flat spin",
)
def nutation_under_an_energy_sink():
    rate = nutation_rate()
    names = {s.name: s for s in rate.free_symbols}
    for transverse, axial, falls in ((1.0, 1.5, True), (2.0, 0.5, False)):
        put = {"It": transverse, "Ia": axial, "theta": 0.5, "H": 1.0, "D": 0.1}
        value = rate.subs({names[n]: put.get(n, 0.1) for n in names})
        assert (value < 0) == falls

        def energy(angle, It=transverse, Ia=axial):
            return (np.sin(angle) ** 2 / It + np.cos(angle) ** 2 / Ia) / 2

        slope = (energy(0.5 + 1e-6) - energy(0.5 - 1e-6)) / 2e-6
        assert abs(float(value) - -0.1 / slope) < 1e-4
        assert nutation_trend(transverse, axial) == ("stable" if falls else "unstable")


@says(
    "derive energy-dissipation sink-effective",
    "for any body it only grows, towards the greatest moment",
)
@says(
    "eom.mechanics.dissipation.effective_inertia_rate",
    "it passes the intermediate one at the separatrix, and ends at the greatest one",
)
def effective_inertia_grows():
    rate = effective_inertia_rate()
    assert all(rate.subs(dict.fromkeys(rate.free_symbols, v)) > 0 for v in (0.1, 1.0, 7.0))
    _, h, energy, _ = run(LEAST)
    effective = (h**2).sum(axis=0) / (2 * energy)
    crossing = np.flatnonzero(effective > WHOLE[1])[0]
    before, after = h[:, : crossing - 300], h[:, crossing + 300 :]
    assert np.all(before[0] > 0)  # around b1 before,
    assert np.all(after[2] < 0)  # around b3 after


@says(WORK, "it fades within a microsecond")
@says(
    WORK,
    "An explicit method is stable for steps of a few of these times, and the motion lasts 20 s: some ten million steps.",
)
def the_stiff_slug():
    p = problems.ready("damped-body-stiff")
    rates = p.system.rates
    sigma = next(q.symbol for q in p.system.states if q.name == "sigma_1")
    k = p.system.state_names.index("sigma_1")
    fading = -float(
        sp.diff(rates[k], sigma).subs({q.symbol: p.parameters[q.name] for q in p.system.parameters})
    )
    assert 1 / fading < 1e-6
    limit = 6.4 / fading  # about where the stability of a method of order 8 ends on the real axis
    assert p.end == 20
    assert 3e6 < p.end / limit < 3e7
