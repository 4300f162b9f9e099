"""The files of a solution."""

import json
import xml.etree.ElementTree

import numpy as np
from dolfinx.io import XDMFFile
from mpi4py import MPI

from fenicsx import write
from fenicsx.case import CaseError

from .support import CASES, TestCase


class Files(TestCase):
    def test_xdmf_has_the_mesh_the_displacement_and_the_von_mises_stress(self):
        content, problem, method, _ = self.solve(CASES / "block-p2-exact-n4.toml")
        write.write(content, problem, method, self.folder / "out")
        with XDMFFile(MPI.COMM_SELF, str(self.folder / "out" / "solution.xdmf"), "r") as file:
            self.assertEqual(file.read_mesh().topology.index_map(2).size_global, 32)
        tree = xml.etree.ElementTree.parse(self.folder / "out" / "solution.xdmf")
        self.assertEqual([(a.get("Name"), a.get("Center")) for a in tree.iter("Attribute")], [("displacement", "Node"), ("von_mises", "Cell")])

    def test_result_json_reads_back_to_the_same_doubles_and_times_every_stage(self):
        content, problem, method, _ = self.solve(CASES / "singular-p1-exact-n4.toml")
        write.write(content, problem, method, self.folder / "out")
        read = json.loads((self.folder / "out" / "result.json").read_text())
        self.assertEqual(read, content)
        self.assertEqual(list(read), ["version", "title", "mesh", "gamma", "newton", "quantities", "contact", "errors", "probes", "seconds"])
        self.assertEqual(list(read["seconds"]), ["read", "assemble", "solve", "write"])

    def test_a_nan_is_not_written(self):
        with self.assertRaises(ValueError):
            write.text_of({"energy": float("nan")})

    def test_von_mises_stress_of_uniaxial_compression(self):
        # sigma = diag(0, -p); in plane strain sigma_zz = nu (sxx + syy) = -nu p
        for plane in ("strain", "stress"):
            text = (CASES / "patch-d1-p2-exact.toml").read_text().replace("mu = 0.7", f'mu = 0.7\nplane = "{plane}"')
            text = text.replace('gmsh = "square.msh"', 'rectangle = { width = 1.0, height = 1.0, nx = 3, ny = 2, diagonal = "left" }')
            _, problem, method, _ = self.solve(self.file(text))
            nu = 3.0 / (2 * (3.0 + 0.7)) if plane == "strain" else 0.0
            expected = 0.3 * np.sqrt(1 - nu + nu**2)
            np.testing.assert_allclose(write.von_mises(problem, method).x.array, expected, rtol=1e-12)

    def test_probes_take_the_value_of_the_field_and_must_lie_in_the_mesh(self):
        text = (CASES / "patch-d3-p2-exact.toml").read_text().split("[output]")[0]
        text = text.replace('gmsh = "square.msh"', 'rectangle = { width = 1.0, height = 1.0, nx = 3, ny = 2, diagonal = "crossed" }')
        points = [[0.0, 0.0], [1.0, 1.0], [0.123, 0.456], [0.5, 0.25]]
        content, problem, *_ = self.solve(self.file(text + f"[output]\nprobes = {points}\n"))
        exact = np.column_stack(problem.case.exact.displacement(*np.array(points).T))
        np.testing.assert_allclose(content["probes"], np.hstack((points, exact)), rtol=0, atol=1e-14)
        with self.assertRaisesRegex(CaseError, r"output.probes: found \[1.1, 0.5\], expected a point of the mesh"):
            self.solve(self.file(text + "[output]\nprobes = [[1.1, 0.5]]\n"))
