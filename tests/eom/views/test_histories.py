"""Time histories: what is drawn of a run, in which unit, how much of it, and the drift below."""

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen.runs.pruning import Drift
from codegen.runs.result import Result
from eom.errors import InputError
from eom.quantities import Quantity
from eom.scenes.scene import Scene
from eom.views.draw import formulas
from eom.views.draw.picture import Curve
from eom.views.draw.printed import thinned
from eom.views.time.histories import FLOOR, MOST, histories, histories_of

T = np.linspace(0.0, 2.0, 101)


def result(outputs, t=T, drift=None):
    return Result(
        t=t, y=np.zeros((0, len(t))), sol=None, nfev=0, status=0, message="end reached", outputs=outputs,
        drift=drift or {}, margin={}, t_stop=float(t[-1]) if len(t) else 0.0, y_stop=np.zeros(0),
        method="none", steps=0, rejected=0,
    )  # fmt: skip


def known(units):
    return [Quantity(sp.Symbol(name, real=True), unit) for name, unit in units.items()]


def curves(panel):
    return {i.label: i.points for i in panel.items if isinstance(i, Curve)}


def panels(picture):
    return [panel for (panel,) in picture.rows]


def change(start, over_time):
    over_time = np.asarray(over_time, dtype=float)
    return Drift(start, float(np.max(np.abs(over_time))), over_time)


def test_quantities_of_one_unit_stand_together_with_the_unit_on_the_axis():
    values = {"psi": T, "omega_1": 2 * T, "theta": -T, "q0": T**2}
    units = {"psi": "rad", "omega_1": "rad/s", "theta": "rad", "q0": ""}
    found = panels(histories(result(values), known(units), title="A title"))
    assert [p.axes[1].words for p in found] == ["[rad]", r"$\omega_{1}$ [rad/s]", "$q_{0}$ [1]"]
    assert [p.axes[0].words for p in found] == ["", "", "$t$ [s]"]
    assert list(curves(found[0])) == [r"$\psi$", r"$\theta$"]
    np.testing.assert_array_equal(curves(found[0])[r"$\theta$"], np.stack([T, -T], axis=-1))
    assert all(p.axes[0].limits == (0.0, 2.0) for p in found)


def test_drift_is_below_and_says_what_it_is_relative_to():
    wander = 1e-12 * T
    one = {"E": change(4.0, wander), "H": change(2.0, -wander)}
    below = panels(histories(result({"x": T}, drift=one), known({"x": "m"})))[-1]
    assert below.axes[1].words == "relative drift"
    assert below.axes[1].scale == "log"
    drawn = curves(below)
    np.testing.assert_allclose(drawn["$E$"][:, 1], wander[1:] / 4)
    np.testing.assert_allclose(drawn["$H$"][:, 1], wander[1:] / 2)
    both = {**one, "p": change(0.0, wander)}
    mixed = panels(histories(result({"x": T}, drift=both), known({"x": "m"})))[-1]
    assert list(curves(mixed)) == ["$E$, relative", "$H$, relative", "$p$, absolute"]
    np.testing.assert_allclose(curves(mixed)["$p$, absolute"][:, 1], wander[1:])
    low, high = mixed.axes[1].limits
    assert low == FLOOR
    assert high >= wander.max()


def test_what_never_drifts_is_drawn_at_the_floor_and_infinity_breaks_nothing():
    drift = {"E": change(1.0, 0 * T), "H": change(1.0, np.where(T > 1, np.inf, 0.0))}
    below = panels(histories(result({"x": T}, drift=drift), known({"x": "m"})))[-1]
    np.testing.assert_array_equal(curves(below)["$E$"][:, 1], FLOOR)
    assert np.all(np.isfinite(below.axes[1].limits))


def test_many_states_are_not_drawn_unasked():
    names = [f"q_joint{k}" for k in range(50)]
    run = result({n: k * T for k, n in enumerate(names)})
    units = dict.fromkeys(names, "rad")
    (few,) = panels(picture := histories(run, known(units)))
    assert len(curves(few)) == MOST
    assert "42 more in rad" in picture.caption
    all_of_them = panels(histories(run, known(units), names))
    assert sum(len(curves(p)) for p in all_of_them) == 50
    assert max(len(curves(p)) for p in all_of_them) == MOST
    looks = [(i.colour, i.dash) for p in all_of_them for i in p.items]
    assert len(set(looks[:MOST])) == MOST
    many = {f"E{k}": change(1.0, (k + 1) * 1e-12 * T) for k in range(20)}
    below = panels(last := histories(result({"x": T}, drift=many), known({"x": "m"})))[-1]
    assert list(curves(below)) == [f"$E_{{{k}}}$" for k in range(12, 20)]
    assert "12 more constants" in last.caption


def test_an_angle_that_is_brought_back_by_a_turn_is_no_line_across():
    angle = (3 * T + math.pi) % (2 * math.pi) - math.pi
    (panel,) = panels(histories(result({"psi": angle}), known({"psi": "rad"})))
    (line,) = curves(panel).values()
    assert np.isnan(line[:, 1]).sum() == 1
    (panel,) = panels(histories(result({"psi": angle}), known({"psi": "m"})))
    assert not np.isnan(next(iter(curves(panel).values()))).any()


def test_no_motion_and_no_numbers_are_refused_and_gaps_are_reported():
    for times in (np.zeros(0), np.zeros(1), np.array([0.0, math.nan])):
        with pytest.raises(InputError, match="two times"):
            histories(result({"x": times}, times), known({"x": "m"}))
    with pytest.raises(InputError, match="no value is a number"):
        histories(result({"x": np.full(101, math.nan)}), known({"x": "m"}))
    with pytest.raises(InputError, match="did you mean"):
        histories(result({"omega_1": T}), known({"omega_1": "rad/s"}), ["omga_1"])
    with pytest.raises(InputError, match="no quantity"):
        histories(result({}), [])
    gap = np.where((T > 0.5) & (T < 1), math.nan, T)
    picture = histories(result({"x": gap}), known({"x": "m"}))
    assert f"{np.isnan(gap).sum()} of 101 values of x" in picture.caption


def test_hostile_names_and_titles_are_drawn_as_text():
    name = r"a$ \frac{ b_ <script>"
    picture = histories(
        result({name: T, "ok": T}), known({name: "m", "ok": "m"}), title="5 $ \\x{ $"
    )
    (panel,) = panels(picture)
    assert all(label.replace("\\$", "").count("$") in {0, 2} for label in curves(panel))
    pytest.importorskip("matplotlib")
    from eom.views.draw.printed import figure

    figure(picture).canvas.draw()


@given(
    st.lists(st.floats(-1e3, 1e3) | st.just(math.nan), min_size=1, max_size=120),
    st.integers(4, 60),
)
def test_thinning_keeps_the_ends_the_order_and_the_extremes(values, most):
    x, y = np.arange(len(values), dtype=float), np.array(values)
    u, v = thinned(x, y, most)
    assert len(u) <= max(most, 2)
    assert u[0] == x[0]
    assert u[-1] == x[-1]
    assert np.all(np.diff(u) > 0)
    np.testing.assert_array_equal(v, y[u.astype(int)])
    if np.any(np.isfinite(y)):
        assert (np.nanmin(v), np.nanmax(v)) == (np.nanmin(y), np.nanmax(y))


@given(st.text(max_size=200))
def test_plain_text_opens_no_formula_and_stays_on_one_line(text):
    found = formulas.short(text)
    assert found.replace("\\$", "").count("$") == 0
    assert "\n" not in found
    assert len(found.replace("\\$", "$")) <= formulas.LONGEST


@given(st.text(max_size=70))
def test_a_name_is_a_whole_formula_or_plain_text(text):
    found = formulas.name(text)
    assert found == formulas.short(text) or (found[0] == found[-1] == "$" and found.count("$") == 2)


def test_units_have_raised_digits():
    assert formulas.unit("kg m^2/s^2") == "kg m²/s²"
    assert formulas.unit("N m") == "N m"
    assert formulas.unit("1") == ""


def test_the_histories_of_a_scene_are_those_of_its_run():
    scene = Scene.ready("t-handle-in-angles")
    picture = histories_of(scene, seconds=1.0, points=21)
    angles, rates, below = panels(picture)
    assert list(curves(angles)) == [r"$\psi$", r"$\theta$", r"$\phi$"]
    first = curves(rates)[r"$\omega_{2}$"]
    np.testing.assert_allclose(first[:, 0], np.linspace(0, 1, 21))
    assert first[0, 1] == 10.0
    assert "drift" in below.axes[1].words
