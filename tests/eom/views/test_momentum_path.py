"""The path of the angular momentum on its sphere, and the circles of the separatrix."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from codegen import free_motion
from eom.errors import InputError
from eom.views.body.polhodes import momentum_path, separatrices
from eom.views.draw.picture import Curve, Surface

sizes = st.tuples(st.floats(0.1, 1.0), st.floats(0.1, 1.0), st.floats(0.1, 1.0))


def moments_of(parts):
    """Moments of a body whose mass lies on the axes: any that a body has."""
    return np.array([parts[1] + parts[2], parts[0] + parts[2], parts[0] + parts[1]])


@given(sizes)
def test_on_the_circles_the_energy_is_that_of_spin_about_the_intermediate_axis(parts):
    moments = moments_of(parts)
    middle = np.sort(moments)[1]
    for circle in separatrices(moments):
        assert np.allclose(np.linalg.norm(circle, axis=1), 1.0, rtol=1e-14)
        assert np.allclose((circle**2 / moments).sum(axis=1), 1 / middle, rtol=1e-12)


def test_two_equal_moments_have_no_separatrix():
    assert separatrices(np.array([1.0, 1.0, 2.0])) == ()
    assert separatrices(np.array([2.0, 1.0, 2.0])) == ()


def test_the_path_lies_on_the_sphere_and_ends_are_marked():
    moments = np.array([1.0, 2.0, 3.0])
    omega, _ = free_motion(moments, (0.3, 1.0, 0.8))(np.linspace(0, 10, 101))
    h = (moments[:, None] * omega).T
    picture = momentum_path(moments, h, title="A <body> & its $momentum$")
    (panel,) = picture.rows[0]
    (sphere,) = (i for i in panel.items if isinstance(i, Surface))
    radius = np.linalg.norm(h[0])
    assert np.allclose(np.linalg.norm(sphere.vertices, axis=1), radius)
    for curve in (i for i in panel.items if isinstance(i, Curve)):
        assert np.allclose(np.linalg.norm(curve.points, axis=1), radius)
    assert [i.label for i in panel.items[-2:]] == ["start", "end"]


@pytest.mark.parametrize(
    "h",
    [
        np.zeros((5, 3)),
        np.ones((1, 3)),
        np.ones((4, 2)),
        np.array([[1.0, 0, 0], [0, 1.01, 0]]),
        np.array([[1.0, 0, 0], [0, np.nan, 0]]),
    ],
)
def test_paths_that_are_none_are_refused(h):
    with pytest.raises(InputError, match="momentum_path"):
        momentum_path((1.0, 2.0, 3.0), h)


def test_it_prints():
    pytest.importorskip("matplotlib")
    h = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]])
    data, words = momentum_path((1.0, 2.0, 3.0), h)._repr_mimebundle_(include=None, exclude=None)
    again, _ = momentum_path((1.0, 2.0, 3.0), h)._repr_mimebundle_()
    assert data == again
    assert data["image/png"].startswith("iVBORw0KGgo")
    assert "sphere" in data["text/plain"]
    assert words["image/png"]["alt"] == data["text/plain"]
