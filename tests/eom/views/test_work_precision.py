"""The diagram of run time over error, from points that are known."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from codegen.measure.workprecision.measuring import Point
from eom.errors import InputError
from eom.views.draw.picture import Curve, Marks
from eom.views.time.work_precision import work_precision


def diagram(programs, error=1e-20, title="A problem"):
    points = [
        Point(
            name,
            10.0**-k,
            10.0**-k / 3,
            known=True,
            seconds=1e-4 * (k + n),
            median=1e-4,
            runs=3,
            steps=9,
        )
        for n, name in enumerate(programs, 1)
        for k in (3, 6, 9)
    ]
    reference = SimpleNamespace(error=error)
    return SimpleNamespace(
        case=SimpleNamespace(title=title), reference=reference, points=tuple(points)
    )


def test_each_program_is_a_line_of_its_points_with_fine_results_to_the_right():
    programs = ("taylor", "scipy:RK45", "solve_ivp:DOP853", "heyoka", "sundials:BDF")
    given = diagram(programs)
    ((panel,),) = work_precision(given).rows
    lines = [i for i in panel.items if isinstance(i, Curve)]
    assert [line.label for line in lines] == list(programs)
    assert [line.dash for line in lines] == ["solid", "dashed", "dotted", "solid", "dashed"]
    assert len({(line.colour, line.dash) for line in lines}) == len(lines)
    for line, name in zip(lines, programs, strict=True):
        own = [(p.error, p.seconds) for p in given.points if p.program == name]
        np.testing.assert_array_equal(line.points, own)
    assert len([i for i in panel.items if isinstance(i, Marks)]) == len(programs)
    assert [axis.scale for axis in panel.axes] == ["log", "log"]
    (first, last), (low, high) = (axis.limits for axis in panel.axes)
    assert first > max(p.error for p in given.points) > min(p.error for p in given.points) > last
    assert low < min(p.seconds for p in given.points) < max(p.seconds for p in given.points) < high


def test_a_reference_that_is_not_better_than_doubles_is_drawn():
    ((panel,),) = work_precision(diagram(["taylor"], error=1e-9)).rows
    (line,) = (
        i for i in panel.items if isinstance(i, Curve) and i.label == "error of the reference"
    )
    np.testing.assert_array_equal(line.points[:, 0], 1e-9)


def test_nothing_measured_is_refused_and_titles_are_plain():
    with pytest.raises(InputError, match="nothing was measured"):
        work_precision(diagram([]))
    assert work_precision(diagram(["a"], title="5 $")).title == "5 \\$"


def test_the_axis_of_errors_is_turned_round_on_paper():
    pytest.importorskip("matplotlib")
    from eom.views.draw.printed import figure

    (axes,) = figure(work_precision(diagram(["taylor", "DOP853"]))).axes
    assert axes.xaxis_inverted()
    assert math.isfinite(sum(axes.get_xlim()))
