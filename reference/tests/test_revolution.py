"""Bodies of revolution: the eliminated hoop strain, its controls, and what is refused."""

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from ufl import dx, inner, tr

from fenicsx.case import CaseError, read_case
from fenicsx.edges import hoop_strains, trace_constants
from fenicsx.method import Method
from fenicsx.problem import Problem
from fenicsx.revolution import MethodOfRevolution, matrix_of

from .support import BLOCK, CASES, TestCase


def largest(matrix):
    return abs(matrix).max()


class Revolution(TestCase):
    def method(self, name):
        problem = Problem(read_case(CASES / f"{name}.toml"), MPI.COMM_SELF)
        return problem, MethodOfRevolution(problem, 0.01)

    def difference(self, name, degree):
        """Of the matrix from the one with u_r / r by a rule of the degree, relative."""
        problem, method = self.method(name)
        r, (lam, mu) = ufl.SpatialCoordinate(problem.mesh)[0], method.law
        v, w = ufl.TestFunction(problem.V), ufl.TrialFunction(problem.V)
        sigma = Method.sigma(method, w)
        hoop = lam * (tr(method.eps(w)) + w[0] / r) + 2 * mu * w[0] / r
        a = r * (inner(sigma + lam * w[0] / r * ufl.Identity(2), method.eps(v)) + hoop * v[0] / r)
        other = matrix_of(a * dx(metadata={"quadrature_degree": degree}))
        return largest(method.K - other) / largest(method.K)

    def test_the_hoop_strain_of_p1_is_that_of_one_point(self):
        self.assertLess(self.difference("plug-p1-exact", 1), 1e-14)

    def test_controls_other_rules_and_the_second_degree_are_not_that_of_one_point(self):
        self.assertGreater(self.difference("plug-p1-exact", 4), 1e-3)
        self.assertGreater(self.difference("plug-p2-exact", 6), 1e-5)

    def test_a_stretch_has_its_own_hoop_strain_and_the_axis_is_not_special(self):
        radii = np.array([[0.0, 0.0, 1.0], [0.0, 2.0, 1.0], [1.0, 3.0, 2.5]])
        at = np.tile([[0.2, 0.3], [0.0, 1.0]], (3, 1, 1))
        for p in (1, 2):
            nodes = radii if p == 1 else np.hstack((radii, (radii[:, [1, 0, 0]] + radii[:, [2, 2, 1]]) / 2))
            theta = np.einsum("eqi,ei->eq", hoop_strains(p, radii, at), 3 * nodes)
            np.testing.assert_allclose(theta, 3, rtol=1e-13)

    def test_trace_constants_are_those_of_the_plane_far_out_and_4_at_most(self):
        far = np.array([[1.0, 1.0]]) * 1e9
        for p, constant in ((1, 1), (2, 3)):
            np.testing.assert_allclose(trace_constants(p, far, far[:, 0]), constant, rtol=1e-12)
        np.testing.assert_allclose(trace_constants(2, np.array([[1.0, 1.0]]), np.array([0.0])), 4, rtol=1e-12)

    def test_forces_of_the_whole_revolution_balance(self):
        result, *_ = self.solve(CASES / "plug-p2-exact.toml")
        q = result["quantities"]
        # The load of the cylinder: -0.05 on its volume pi.
        self.assertAlmostEqual(q["contact_resultant"][1] + q["reactions"]["top"][1] - 0.05 * np.pi, 0, delta=1e-13)
        self.assertEqual(list(q["reactions"]), ["top"])

    def test_what_is_not_there_is_refused(self):
        for change, said in (
            (('lambda = 1.0\nmu = 1.0', 'stiffness = [12, 3, 2, 5, -1, 2]\nplane = "axisymmetric"'), "not isotropic"),
            (("[method]", '[body]\nplane = "axisymmetric"\nthickness = 2\n[method]'), "body.thickness"),
        ):
            path = self.file(BLOCK.replace(*change))
            with self.assertRaisesRegex(CaseError, said):
                read_case(path)
