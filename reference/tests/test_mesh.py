"""Meshes: rectangles with their diagonals, Gmsh files, h_T."""

import shutil
import subprocess

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenicsx import compat, gmsh
from fenicsx.case import CaseError, read_case
from fenicsx.edges import ContactEdges
from fenicsx.mesh import rectangle, trapezoid
from fenicsx.problem import Problem

from .support import BLOCK, CASES, TestCase


class Meshes(TestCase):
    def test_right_diagonals_run_from_the_lower_left_to_the_upper_right(self):
        self.assertEqual(rectangle(1, 1, 1, 1, "right").triangles.tolist(), [[0, 1, 3], [0, 3, 2]])
        self.assertEqual(rectangle(1, 1, 1, 1, "left").triangles.tolist(), [[0, 1, 2], [1, 3, 2]])

    def test_crossed_cells_have_a_vertex_at_their_centre(self):
        mesh = rectangle(2.0, 1.0, 2, 1, "crossed")
        self.assertEqual(mesh.points[6:].tolist(), [[0.5, 0.5], [1.5, 0.5]])
        self.assertEqual(len(mesh.triangles), 8)

    def test_areas_add_up_and_sides_lie_where_they_should(self):
        for diagonal in ("right", "left", "crossed"):
            mesh = rectangle(2.0, 1.0, 6, 5, diagonal)
            a, b, c = (mesh.points[corner] for corner in mesh.triangles.T)
            areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
            self.assertTrue(np.all(areas > 0))
            self.assertAlmostEqual(areas.sum(), 2.0, delta=1e-14)
            for name, axis, value in (("bottom", 1, 0), ("top", 1, 1), ("left", 0, 0), ("right", 0, 2)):
                self.assertTrue(np.all(mesh.points[mesh.boundaries[name]][:, :, axis] == value))

    def test_the_trapezoid_has_its_corners(self):
        points = trapezoid(3 * np.pi / 4, 2).points
        np.testing.assert_allclose(points[[0, 2, 8, 6]], [[0, 0], [1, 0], [1, 1], [-1, 1]], atol=1e-15)

    def test_h_T_is_the_longest_edge(self):
        points = np.array([[0.0, 0.0], [0.3, 0.1], [0.1, 0.7]])
        triangle = compat.create_mesh(MPI.COMM_SELF, np.array([[0, 1, 2]]), points)
        area = fem.assemble_scalar(fem.form(fem.Constant(triangle, 1.0) * ufl.dx))
        h_T = fem.assemble_scalar(fem.form(ufl.CellDiameter(triangle) * ufl.dx)) / area
        sides = [np.linalg.norm(points[i] - points[i - 1]) for i in range(3)]
        self.assertAlmostEqual(h_T, max(sides), delta=1e-15)
        circumradius = fem.assemble_scalar(fem.form(ufl.Circumradius(triangle) * ufl.dx)) / area
        self.assertGreater(abs(circumradius - max(sides)), 0.1)

    def test_edges_and_ufl_have_the_same_h_T(self):
        problem = Problem(read_case(CASES / "patch-d1-p2-exact.toml"), MPI.COMM_SELF)
        edges = ContactEdges(problem, 1.0)
        ds = problem.ds(problem.number["bottom"])
        total = fem.assemble_scalar(fem.form(ufl.CellDiameter(problem.mesh) ** 2 * ds))
        self.assertAlmostEqual(total, np.sum(edges.h_T**2 * edges.length), delta=1e-14)

    def test_normals_point_out_of_the_body(self):
        edges = ContactEdges(Problem(read_case(CASES / "patch-d1-p1-exact.toml"), MPI.COMM_SELF), 1.0)
        np.testing.assert_allclose(edges.n, np.tile([0.0, -1.0], (len(edges.n), 1)), atol=1e-15)


class GmshFiles(TestCase):
    def test_the_stored_mesh_is_the_unit_square(self):
        self.check_square(gmsh.read(CASES / "square.msh"))

    def test_ascii_and_binary_files_of_the_real_gmsh_are_read(self):
        if not shutil.which("gmsh"):
            self.fail("gmsh not found (Debian: apt-get install gmsh): this test reads files that it writes")
        for binary in ("0", "1"):
            out = self.folder / f"square{binary}.msh"
            subprocess.run(["gmsh", "-2", "-v", "0", "-format", "msh41", "-setnumber", "Mesh.Binary", binary, str(CASES / "square.geo"), "-o",
                            str(out)], check=True)
            self.assertIn(f"4.1 {binary} 8".encode(), out.read_bytes()[:40])
            self.check_square(gmsh.read(out))

    def check_square(self, mesh):
        self.assertEqual(sorted(mesh.boundaries), ["bottom", "left", "right", "top"])
        a, b, c = (mesh.points[corner] for corner in mesh.triangles.T)
        self.assertAlmostEqual(np.sum((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2, 1.0, delta=1e-14)
        for edges in mesh.boundaries.values():
            ends = mesh.points[edges]
            self.assertAlmostEqual(np.sum(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)), 1.0, delta=1e-14)

    def test_broken_files_are_refused(self):
        good = (CASES / "square.msh").read_text()
        triangle = good[good.index("$Elements"):].splitlines()
        broken = {
            "": "not a Gmsh 4.1 mesh of triangles: the file ends early",
            "\0\1\2\n": "not a Gmsh 4.1 mesh of triangles: found '\\x00\\x01\\x02', expected $MeshFormat",
            good.replace("4.1 0 8", "2.2 0 8"): "format 2.2 with data size 8, expected 4.1 with 8",
            good[: len(good) // 2]: "not a Gmsh 4.1 mesh of triangles",
            good[: good.index("$Elements")]: "it has no triangles",
            good.replace("1 1 \"bottom\"", "1 7 \"bottom\""): "no boundary named 'bottom'; this mesh has: left, right, top",
            good.replace("\n" + triangle[-2] + "\n", "\n" + _flipped(triangle[-2]) + "\n"): "has area -",
        }
        case = BLOCK.replace('rectangle = { width = 1.0, height = 1.0, nx = 4, ny = 4, diagonal = "right" }', 'gmsh = "broken.msh"')
        for text, message in broken.items():
            with self.subTest(message):
                self.assertNotEqual(text, good)
                self.file(text, "broken.msh")
                with self.assertRaises(CaseError) as caught:
                    Problem(read_case(self.file(case)), MPI.COMM_SELF)
                self.assertIn(message, str(caught.exception))


def _flipped(element):
    tag, a, b, c = element.split()
    return f"{tag} {a} {c} {b} "
