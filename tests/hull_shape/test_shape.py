"""What a surface encloses and shows, and what is wrong with a file."""

from pathlib import Path

import numpy as np
import pytest
from support.hull_shapes import ellipsoid, write_stl

from cube_sim.errors import ShapeError
from cube_sim.hull_shape.drag import drag_of
from cube_sim.hull_shape.mesh import box_mesh, closed_mesh
from cube_sim.hull_shape.reading import read_mesh
from cube_sim.hull_shape.silhouette import silhouettes_of
from cube_sim.hull_shape.solid import solid_of

BOX = box_mesh((0.6, 0.4, 0.2)).triangles
OBJ = """# a tetrahedron
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1/1/1 3/1/1 2/2/2
f 1 2 4
f -4 -1 -2
f 2 3 4
"""


def test_a_box_has_the_volume_centre_and_inertia_of_a_box():
    solid = solid_of(box_mesh((0.6, 0.4, 0.2)).moved(np.eye(3), np.array([-1.0, 2.0, 3.0])))
    assert solid.volume == pytest.approx(0.048, rel=1e-12)
    np.testing.assert_allclose(solid.centre, [1.0, -2.0, -3.0], atol=1e-12)
    np.testing.assert_allclose(solid.inertia_per_mass, np.diag([0.2, 0.4, 0.52]) / 12, atol=1e-12)
    np.testing.assert_allclose(solid.size, [0.6, 0.4, 0.2], atol=1e-12)


def test_an_obj_is_read_with_its_unit_and_its_frame(tmp_path):
    file = tmp_path / "hull.obj"
    file.write_text(OBJ)
    solid = solid_of(read_mesh(file, "cm", "FRD"))
    assert solid.volume == pytest.approx(1e-6 / 6, rel=1e-12)
    np.testing.assert_allclose(solid.centre, [0.0025, -0.0025, -0.0025], atol=1e-12)


@pytest.mark.parametrize("first", range(8))
def test_polygons_are_cut_whatever_their_shape(first, tmp_path):
    """A prism on a U, as programs write it that do not cut polygons: 5 squares high 1, its inside not filled."""
    outline = np.roll([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)], first, axis=0)
    lines = [f"v {x} {y} {z}" for z in (0, 1) for x, y in outline]
    lines += ["f " + " ".join(str(i) for i in range(8, 0, -1)), "f " + " ".join(str(i) for i in range(9, 17))]
    lines += [f"f {i + 1} {(i + 1) % 8 + 1} {(i + 1) % 8 + 9} {i + 9}" for i in range(8)]
    (tmp_path / "u.obj").write_text("\n".join(lines))
    mesh = read_mesh(tmp_path / "u.obj")
    assert mesh.remarks == ()
    assert solid_of(mesh).volume == pytest.approx(5.0)
    np.testing.assert_allclose(silhouettes_of(mesh).areas, [2.0, 3.0, 5.0], rtol=0.005)
    areas = np.linalg.norm(np.cross(*(mesh.triangles[:, i] - mesh.triangles[:, 0] for i in (1, 2))), axis=1) / 2
    assert areas.sum() == pytest.approx(2 * 5.0 + 12.0)  # nothing lies folded over itself


@pytest.mark.parametrize("binary", [False, True])
def test_an_stl_is_read(binary, tmp_path):
    write_stl(tmp_path / "hull.STL", 1000.0 * BOX, binary)
    solid = solid_of(read_mesh(tmp_path / "hull.STL", "mm"))
    assert solid.volume == pytest.approx(0.048, rel=1e-6)


def test_what_can_be_mended_is_mended_and_said():
    turned = BOX.copy()
    turned[3] = turned[3][::-1]
    mended = closed_mesh(Path("x"), turned)
    assert solid_of(mended).volume == pytest.approx(0.048)
    assert mended.remarks == ("1 faces were turned: their corners ran the other way than their neighbours'",)
    inside_out = closed_mesh(Path("x"), BOX[:, ::-1])
    assert solid_of(inside_out).volume == pytest.approx(0.048)
    assert inside_out.remarks == ("normals pointed inwards and were turned",)
    flat = np.concatenate([BOX, [[BOX[0, 0], BOX[0, 0], BOX[0, 1]]]])
    assert closed_mesh(Path("x"), flat).remarks == ("1 faces without extent were left out",)
    shell = closed_mesh(Path("x"), np.concatenate([BOX, 0.9 * BOX[:, ::-1]]))
    assert solid_of(shell).volume == pytest.approx(0.048)
    assert "inner wall" in shell.remarks[-1]
    apart = closed_mesh(Path("x"), np.concatenate([BOX, BOX + np.array([1.0, 0, 0])]))
    assert solid_of(apart).volume == pytest.approx(0.096)
    noisy = BOX + np.random.default_rng(1).uniform(-1e-8, 1e-8, BOX.shape)
    assert len(closed_mesh(Path("x"), noisy).vertices) == 8


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        (
            "x.obj",
            OBJ.replace("f 2 3 4\n", ""),
            r":[678]: the edge from \(.*\) to \(.*\) belongs to this face alone: the surf",
        ),
        ("x.obj", OBJ + "f 1 2 9\n", r":10: vertex 9 is not there; 4 vertices stand before this line"),
        ("x.obj", OBJ + "f 1 2\n", r":10: a face of 2 corners; three at least make one"),
        ("x.obj", OBJ.replace("v 0 1 0", "v 0 l 0"), r":4: '0 l 0' is no point; three numbers are"),
        ("x.obj", OBJ + "f 1 2 4\n", r":7: the edge .* belongs to 3 faces; two share an edge"),
        ("x.obj", "v 0 0 0\n", r"has no faces"),
        ("x.stl", "solid x\nfacet\nvertex 1 2 3\nendfacet\n", r":4: a facet of 1 vertices; three are right"),
        ("x.stl", "nothing", r"is no STL"),
        ("x.step", "", r"is no mesh that can be read; .obj and .stl are"),
    ],
)
def test_a_mistake_is_one_line_with_its_place(name, text, told, tmp_path):
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(ShapeError, match=told) as raised:
        read_mesh(file)
    assert str(raised.value).startswith(str(file))
    assert "\n" not in str(raised.value)


def test_what_is_not_there_or_overlaps_or_is_flat_is_refused(tmp_path):
    with pytest.raises(ShapeError, match=r"none\.obj: cannot be read: No such file"):
        read_mesh(tmp_path / "none.obj")
    with pytest.raises(ShapeError, match="two of its 2 bodies overlap"):
        closed_mesh(Path("x"), np.concatenate([BOX, BOX + np.array([0.3, 0.1, 0.05])]))
    sheet = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [0, 1, 0], [1, 0, 0]]], dtype=float)
    with pytest.raises(ShapeError, match="encloses nothing"):
        closed_mesh(Path("x"), sheet)


def test_shadows_of_a_box_and_of_a_sphere():
    shown = silhouettes_of(closed_mesh(Path("x"), BOX))
    np.testing.assert_allclose(shown.areas, [0.08, 0.12, 0.24], rtol=0.005)
    np.testing.assert_allclose(shown.third_moments[2], [2 * 0.3**4 / 4 * 0.4, 2 * 0.2**4 / 4 * 0.6, 0], rtol=0.01)
    np.testing.assert_allclose(shown.flat, 1.0)
    ball = silhouettes_of(closed_mesh(Path("x"), ellipsoid((1, 1, 1), 4)))
    np.testing.assert_allclose(ball.areas, np.pi, rtol=0.005)
    assert ball.flat.max() < 0.25


def test_a_cube_meets_the_drag_of_the_shipped_one():
    """models/cube.xml: 1/2 rho Cd L^2 with Cd = 1.05, and rho Cd L^5/64 for each of two pairs of faces."""
    mesh = box_mesh((0.5, 0.5, 0.5))
    drag = drag_of(silhouettes_of(mesh), solid_of(mesh).size, 1000.0)
    np.testing.assert_allclose(drag.quadratic[:3], 131.25, rtol=0.005)
    np.testing.assert_allclose(drag.quadratic[3:], 2 * 1000 * 1.05 * 0.5**5 / 64, rtol=0.01)
    assert drag.likened[0] == "a flat-faced block 1 times as long as wide"


def test_slender_round_hulls_are_likened_to_ellipsoids_and_cylinders():
    mesh = closed_mesh(Path("x"), ellipsoid((4, 1, 1), 4))
    drag = drag_of(silhouettes_of(mesh), solid_of(mesh).size, 1000.0)
    np.testing.assert_allclose(drag.coefficients, [0.25, 0.74, 0.74], atol=1e-6)
