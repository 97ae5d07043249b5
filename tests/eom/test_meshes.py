"""Closed triangle meshes: boxes exactly, spheres in the limit, everything else refused."""

from __future__ import annotations

import importlib
import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom.errors import InputError
from eom.mass.meshes import mesh_properties, read_mesh
from eom.mass.solids import mass_properties
from tests.draws import examples

BOX_FACES = [
    *((0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6)),
    *((0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7)),
    *((0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)),
]
TETRAHEDRON = (
    [(0, 0, 0), (2, 0, 0), (0, 3, 0), (0, 0, 4)],
    [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)],
)


def box(sides, corner=(0.0, 0.0, 0.0)):
    vertices = [tuple(corner[i] + sides[i] * (k >> i & 1) for i in range(3)) for k in range(8)]
    return vertices, [(a, c, b) for a, c, b in BOX_FACES]


def quartered(a, b, c, middle):
    ab, bc, ca = (middle[min(e), max(e)] for e in ((a, b), (b, c), (c, a)))
    return (a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)


def icosphere(levels):
    """An icosahedron, each triangle divided into four ``levels`` times, on the unit sphere."""
    g = (1 + math.sqrt(5)) / 2
    points = [(s, t * g, 0.0) for s in (-1, 1) for t in (-1, 1)]
    points += [(z, x, y) for x, y, z in points] + [(y, z, x) for x, y, z in points]
    points = [np.array(p) / math.hypot(1, g) for p in points]
    near = 2.1 / math.hypot(1, g)
    faces = []
    for i in range(12):
        for j in range(i):
            for k in range(j):
                p, q, r = points[i], points[j], points[k]
                if max(map(np.linalg.norm, (p - q, q - r, r - p))) < near:
                    outward = np.linalg.det([p, q, r]) > 0
                    faces.append((i, j, k) if outward else (i, k, j))
    for _ in range(levels):
        edges = {tuple(sorted(e)) for a, b, c in faces for e in ((a, b), (b, c), (c, a))}
        middle = {edge: len(points) + n for n, edge in enumerate(sorted(edges))}
        middles = [points[a] + points[b] for a, b in middle]
        points += [m / np.linalg.norm(m) for m in middles]
        faces = [t for face in faces for t in quartered(*face, middle)]
    return [tuple(map(float, p)) for p in points], faces


def close(found, expected, tolerance=1e-14):
    assert np.array(found, dtype=float) == pytest.approx(
        np.array(expected, dtype=float), rel=tolerance, abs=tolerance
    )


side = st.floats(0.1, 10)
place = st.floats(-10, 10)


@examples(30)
@given(sides=st.tuples(side, side, side), corner=st.tuples(place, place, place), rho=side)
def test_box_is_exact(sides, corner, rho):
    a, b, c = sides
    body = mesh_properties(*box(sides, corner), rho)
    m = rho * a * b * c
    expected = [m * (b * b + c * c) / 12, m * (a * a + c * c) / 12, m * (a * a + b * b) / 12]
    assert float(body.mass) == pytest.approx(m, rel=1e-12)
    close(body.centre, [[p + s / 2] for p, s in zip(corner, sides, strict=True)], 1e-13)
    scale = max(expected)
    close(body.about_centre / scale, np.diag(expected) / scale, 1e-12)


def test_box_far_from_the_origin_loses_nothing():
    """A million sides away; squares of the distance alone would leave four digits."""
    body = mesh_properties(*box((1.0, 2.0, 3.0), (1e6, -2e6, 3e6)))
    close(body.about_centre, np.diag([6.5, 5.0, 2.5]), 1e-12)
    assert float(body.mass) == pytest.approx(6, rel=1e-14)


def test_tetrahedron_is_that_of_the_catalogue():
    body = mesh_properties(*TETRAHEDRON, 0.5)
    values = {
        sp.Symbol(n, positive=True): v
        for n, v in zip(("a", "b", "c", "mass"), (2, 3, 4, 2), strict=True)
    }
    for point in ("corner", "centre of mass"):
        known = mass_properties("tetrahedron", point).inertia.subs(values)
        close(body.inertia if point == "corner" else body.about_centre, known)


def test_tetrahedron_of_the_published_example():
    """Tonon (2005), the worked example: inertia about the centre of mass at unit density."""
    vertices = [
        (8.33220, -11.86875, 0.93355),
        (0.75523, 5.00000, 16.37072),
        (52.61236, 5.00000, -5.38580),
        (2.00000, 5.00000, 3.00000),
    ]
    body = mesh_properties(vertices, TETRAHEDRON[1])
    J = body.about_centre
    found = [J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 1], J[0, 2]]
    published = [43520.33257, 194711.28938, 191168.76173, -4417.66150, -11996.20119, 46343.16662]
    assert [float(e) for e in found] == pytest.approx(published, rel=1e-6)
    close(body.centre, [[15.92492], [0.78281], [3.72962]], 1e-5)


def test_spheres_converge_at_second_order_in_edge_length():
    errors = []
    for levels in range(1, 5):
        body = mesh_properties(*icosphere(levels))
        errors.append(
            [
                1 - float(body.mass) / (4 * math.pi / 3),
                1 - float(body.about_centre[0, 0]) / (8 * math.pi / 15),
                1 - float(body.about_centre[2, 2]) / (8 * math.pi / 15),
            ]
        )
    ratios = np.array(errors)[:-1] / np.array(errors)[1:]
    orders = np.log2(ratios)
    assert np.all(np.array(errors) > 0)
    assert orders[-1] == pytest.approx(2, abs=0.02)
    assert np.all(np.diff(abs(orders - 2), axis=0) < 0)


def test_cavity_is_a_mesh_the_other_way_round():
    vertices, faces = box((3.0, 3.0, 3.0))
    hole, inner = box((1.0, 1.0, 1.0), (1.0, 1.0, 1.0))
    inward = [(a + 8, c + 8, b + 8) for a, b, c in inner]
    body = mesh_properties([*vertices, *hole], [*faces, *inward])
    assert float(body.mass) == pytest.approx(26)
    expected = mesh_properties(vertices, faces) - mesh_properties(hole, inner)
    close(body.inertia, expected.inertia, 1e-12)


@examples(20)
@given(seed=st.integers(0, 2**20))
def test_order_of_faces_and_corners_does_not_matter(seed):
    vertices, faces = icosphere(0)
    generator = np.random.default_rng(seed)
    mixed = [
        tuple(np.roll(faces[k], generator.integers(3)).tolist()) for k in generator.permutation(20)
    ]
    one, two = mesh_properties(vertices, faces), mesh_properties(vertices, mixed)
    close(one.second_moments, two.second_moments)


V, F = box((1.0, 1.0, 1.0))


def replaced(items, k, item):
    return [*items[:k], item, *items[k + 1 :]]


BAD = {
    "open": (V, F[:-1], 1, "not closed: an edge belongs to one face", "edge "),
    "doubled": (V, [*F, F[3]], 1, "twice in the same direction", "faces 3 and 12"),
    "turned": (V, replaced(F, 4, F[4][::-1]), 1, "twice in the same direction", "face"),
    "inside out": (V, [f[::-1] for f in F], 1, "inside out", ""),
    "number of a vertex": (V, replaced(F, 2, (0, 1, 8)), 1, "numbers of vertices", "face 2"),
    "negative number": (V, replaced(F, 2, (0, 1, -1)), 1, "numbers of vertices", "face 2"),
    "half a number": (V, replaced(F, 2, (0, 1, 1.5)), 1, "numbers of vertices", "face 2"),
    "quadrilateral": (V, replaced(F, 2, (0, 1, 2, 3)), 1, "numbers of vertices", "face 2"),
    "no face": (V, replaced(F, 2, None), 1, "numbers of vertices", "face 2"),
    "repeated corner": (V, replaced(F, 5, (1, 1, 4)), 1, "degenerate", "face 5"),
    "same place": (replaced(V, 1, V[0]), F, 1, "degenerate", "face 0"),
    "not finite": (replaced(V, 3, (0, math.nan, 0)), F, 1, "three finite numbers", "vertex 3"),
    "infinite": (replaced(V, 3, (0, math.inf, 0)), F, 1, "three finite numbers", "vertex 3"),
    "flat vertex": (replaced(V, 3, (0, 1)), F, 1, "three finite numbers", "vertex 3"),
    "text": (replaced(V, 3, "abc"), F, 1, "three finite numbers", "vertex 3"),
    "flat body": ([(x + 2 * z, y, 0.0) for x, y, z in V], F, 1, "no volume", ""),
    "no faces": (V, [], 1, "no faces", ""),
    "nothing": ([], [], 1, "no faces", ""),
    "density": (V, F, -1.0, "density is not positive", "density"),
    "no density": (V, F, 0.0, "density is not positive", "density"),
    "density nan": (V, F, math.nan, "density is not positive", "density"),
}


@pytest.mark.parametrize(("vertices", "faces", "density", "what", "where"), BAD.values(), ids=BAD)
def test_bad_meshes_are_refused_by_name(vertices, faces, density, what, where):
    with pytest.raises(InputError, match=what) as caught:
        mesh_properties(vertices, faces, density)
    assert where in caught.value.where


# files

OBJ = "".join(f"v {x} {y} {z}\n" for x, y, z in TETRAHEDRON[0]) + "".join(
    f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in TETRAHEDRON[1]
)


def ascii_stl():
    lines = ["solid thing"]
    for face in TETRAHEDRON[1]:
        corners = "".join(f"vertex {' '.join(map(str, TETRAHEDRON[0][k]))}\n" for k in face)
        lines.append(f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet")
    return "\n".join([*lines, "endsolid thing\n"])


def binary_stl():
    import struct

    body = b"".join(
        struct.pack("<12fH", 0, 0, 0, *(c for k in face for c in TETRAHEDRON[0][k]), 0)
        for face in TETRAHEDRON[1]
    )
    return b"\0" * 80 + struct.pack("<I", len(TETRAHEDRON[1])) + body


FILES = {"t.obj": OBJ.encode(), "t.STL": ascii_stl().encode(), "b.stl": binary_stl()}


@pytest.mark.parametrize("name", FILES)
def test_files_hold_the_same_body(name, tmp_path):
    pytest.importorskip("trimesh")
    (tmp_path / name).write_bytes(FILES[name])
    vertices, faces = read_mesh(tmp_path / name, unit=0.5)
    assert len(vertices) == 4
    found = mesh_properties(vertices, faces, 8.0)
    expected = mesh_properties(*TETRAHEDRON)
    assert float(found.mass) == pytest.approx(float(expected.mass), rel=1e-14)
    close(found.inertia, expected.inertia / 4)


def test_quadrilaterals_of_a_file_become_triangles(tmp_path):
    pytest.importorskip("trimesh")
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in V)
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    text += "".join("f " + " ".join(str(k + 1) for k in q) + "\n" for q in quads)
    (tmp_path / "cube.obj").write_text(text)
    assert float(mesh_properties(*read_mesh(tmp_path / "cube.obj")).mass) == pytest.approx(1)


UNREADABLE = {
    "missing": ("none.stl", None, "no such mesh file"),
    "format": ("body.step", b"ISO-10303", "unknown mesh format"),
    "no suffix": ("body", b"", "unknown mesh format"),
    "empty stl": ("body.stl", b"", "cannot be read|no triangles"),
    "short stl": ("body.stl", binary_stl()[:-30], "cannot be read|no triangles"),
    "noise stl": ("body.stl", bytes(range(256)) * 3, "cannot be read|no triangles"),
    "empty obj": ("body.obj", b"", "cannot be read|no triangles"),
    "points obj": ("body.obj", b"v 0 0 0\nv 1 0 0\n", "cannot be read|no triangles"),
    "noise obj": ("body.obj", b"f x y z\nv a b c\n", "cannot be read|no triangles"),
    "noise ply": ("body.ply", b"ply\nnonsense\n", "cannot be read|no triangles"),
    "noise off": ("body.off", b"OFF\n3 1\n", "cannot be read|no triangles"),
}


@pytest.mark.parametrize(("name", "content", "what"), UNREADABLE.values(), ids=UNREADABLE)
def test_unreadable_files_are_refused(name, content, what, tmp_path):
    pytest.importorskip("trimesh")
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=what) as caught:
        read_mesh(tmp_path / name)
    assert name in caught.value.where


def test_a_folder_and_a_misspelt_name(tmp_path):
    (tmp_path / "wheel.stl").write_bytes(binary_stl())
    with pytest.raises(InputError) as caught:
        read_mesh(tmp_path / "whel.stl")
    assert "wheel.stl" in caught.value.hint
    (tmp_path / "folder.stl").mkdir()
    with pytest.raises(InputError, match="no such mesh file"):
        read_mesh(tmp_path / "folder.stl")


@pytest.mark.parametrize("unit", [0.0, -1.0, math.inf])
def test_unit_of_length_is_positive(unit, tmp_path):
    (tmp_path / "t.obj").write_text(OBJ)
    with pytest.raises(InputError, match="unit of length"):
        read_mesh(tmp_path / "t.obj", unit)


def test_open_mesh_of_a_file_is_refused(tmp_path):
    pytest.importorskip("trimesh")
    (tmp_path / "open.obj").write_text(OBJ.rsplit("f", 1)[0])
    with pytest.raises(InputError, match="not closed"):
        mesh_properties(*read_mesh(tmp_path / "open.obj"))


def test_without_trimesh_the_command_is_named(tmp_path, monkeypatch):
    (tmp_path / "t.obj").write_text(OBJ)

    def absent(name):
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", absent)
    with pytest.raises(InputError, match="trimesh") as caught:
        read_mesh(tmp_path / "t.obj")
    assert "pip install" in caught.value.hint
