"""Method (8): forms against the edge integrals, derivative of J_h, patch tests, equilibrium, refusal of an indefinite tangent, a case on
which plain Newton has cycled."""

import json

import numpy as np
from mpi4py import MPI

from fenicsx import newton
from fenicsx.case import read_case
from fenicsx.edges import roots
from fenicsx.method import Method
from fenicsx.newton import NotSolved, Solver
from fenicsx.problem import Problem
from fenicsx.solve import coercivity
from fenicsx.store import RESULTS, differences

from .support import BLOCK, CASES, TestCase


def method_of(path):
    problem = Problem(read_case(path), MPI.COMM_SELF)
    return Method(problem, coercivity(problem)["gamma0"])


def some_field(method, seed):
    """A displacement with P of both signs on Gamma_C."""
    return np.random.default_rng(seed).normal(size=method.problem.owned_dofs)


class Edges(TestCase):
    def test_roots_of_lines_and_parabolas(self):
        lines = np.array([[-1.0, 3.0], [1.0, 3.0], [0.0, 0.0], [2.0, -2.0]])
        np.testing.assert_allclose(roots(lines), [[0.25], [1], [1], [0.5]])
        s = np.array([0, 0.5, 1])
        parabolas = np.array([(s - 0.2) * (s - 0.7), (s - 1e-9) * (s + 1), s * s + 1, 2 * s - 1, 0 * s, (s - 0.3) * (2 - s)])
        expected = [[0.2, 0.7], [1e-9, 1], [1, 1], [0.5, 1], [1, 1], [0.3, 1]]
        np.testing.assert_allclose(np.sort(roots(parabolas), axis=1), expected, rtol=1e-6, atol=0)

    def test_positive_part_integrals_agree_with_fine_quadrature(self):
        for degree in (1, 2):
            method = method_of(CASES / f"gap-p{degree}-exact-n8.toml")
            edges, u = method.edges, some_field(method, degree)
            P = edges.P(u)
            s = (np.arange(200000) + 0.5) / 200000
            fine = sum(length / gamma * np.mean(np.maximum(edges.at(p[None], s[None]), 0) ** 2)
                       for p, length, gamma in zip(P, edges.length, edges.gamma))
            points, w, (active,) = edges.rule(P)
            exact = np.sum(w * np.where(active, edges.at(P, points), 0) ** 2 / edges.gamma[:, None])
            self.assertAlmostEqual(exact, fine, delta=1e-9 * fine)
            self.assertTrue(np.any(active) and not np.all(active))


class Forms(TestCase):
    def test_ufl_and_edge_integrals_are_the_same_for_gauss_points(self):
        for degree in (1, 2):
            method = method_of(CASES / f"cantilever-p{degree}-gauss4-n8.toml")
            method.set(some_field(method, degree))
            by_ufl = method.functional()
            by_edges = method.linear_functional() + method.edges.functional(method.u.x.array)
            self.assertLess(np.max(np.abs(by_ufl - by_edges)), 1e-12 * np.max(np.abs(by_ufl)))

    def test_residual_is_the_derivative_of_J_h_and_the_tangent_that_of_the_residual(self):
        for name in ("gap-p1-exact-n4", "gap-p2-exact-n4", "gap-p1-gauss4-n4", "gap-p2-gauss4-n4"):
            with self.subTest(name):
                method = method_of(CASES / f"{name}.toml")
                u, d = some_field(method, 1), some_field(method, 2)
                method.set(u)
                r = method.functional() - method.problem.load
                H = method.tangent()
                image = H.createVecLeft()
                direction = H.createVecRight()
                direction.array[:] = d
                H.mult(direction, image)
                t = 1e-6

                def change(t):
                    method.set(d)
                    quadratic, seen = method.linear_functional() @ d, method.u.x.array.copy()
                    method.set(u)
                    linear = (method.linear_functional() - method.problem.load) @ d
                    return t * linear + t * t / 2 * quadratic + method.edges.energy_change(method.u.x.array, seen, t)

                # central differences: error t^2 times a third derivative, and rounding / t
                self.assertAlmostEqual((change(t) - change(-t)) / (2 * t), r @ d, delta=1e-6 * np.linalg.norm(r) * np.linalg.norm(d))
                method.set(u + t * d)
                forward = method.functional()
                method.set(u - t * d)
                slope = (forward - method.functional()) / (2 * t)
                self.assertLess(np.linalg.norm(slope - image.array), 1e-5 * np.linalg.norm(image.array))

    def test_rigid_motions_have_no_stress(self):
        method = method_of(CASES / "gap-p2-exact-n4.toml")
        for motion in method.problem.rigid_motions():
            method.set(motion)
            self.assertLess(np.max(np.abs(method.linear_functional())), 1e-13)


class Solutions(TestCase):
    def test_patch_tests_are_solved_to_rounding(self):
        for which in ("d1", "d2", "d3", "d4", "d5"):
            for degree in (1, 2):
                for quadrature in ("gauss4", "exact"):
                    name = f"patch-{which}-p{degree}-{quadrature}"
                    with self.subTest(name):
                        content, problem, method, history = self.solve(CASES / f"{name}.toml")
                        x, y = problem.nodes.T
                        exact = np.column_stack([component + 0 * x for component in problem.case.exact.displacement(x, y)]).ravel()
                        scale = max(np.max(np.abs(exact)), 1e-300)
                        self.assertLess(np.max(np.abs(method.u.x.array - exact)), 1e-13 * scale)
                        self.assertLess(max(content["errors"].values()), 1e-13)
                        self.assertEqual(history.outcome, "converged")

    def test_forces_and_moments_are_in_equilibrium(self):
        for name in ("block-p1-exact-n8", "gap-p2-exact-n8", "cantilever-p2-gauss4-n8", "cantilever-p1-exact-n8"):
            with self.subTest(name):
                content, problem, method, _ = self.solve(CASES / f"{name}.toml")
                q = content["quantities"]
                load = problem.load
                applied = np.array([load[0::2].sum(), load[1::2].sum()])
                reactions = np.sum(list(q["reactions"].values()), axis=0)
                scale = abs(q["contact_force"]) + np.abs(applied).sum()
                self.assertLess(np.max(np.abs(applied + reactions + q["contact_resultant"])), 1e-12 * scale)
                # moment about the origin: of the loads and reactions by nodes, of the pressure by edges
                x, y = problem.nodes.T
                residual = method.functional() - load
                fixed = np.where(problem.prescribed > 0, residual, 0)
                nodal = load + fixed
                edges = method.edges
                P = edges.P(method.u.x.array)
                s, w, (active,) = edges.rule(P)
                pressure = np.where(active, edges.at(P, s), 0) / edges.gamma[:, None]
                at = edges.ends[:, :1] + s[:, :, None] * (edges.ends[:, 1] - edges.ends[:, 0])[:, None]
                moment = np.sum(w * pressure * (at[:, :, 1] * edges.n[:, :1] - at[:, :, 0] * edges.n[:, 1:]))
                self.assertLess(abs(np.sum(x * nodal[1::2] - y * nodal[0::2]) + moment), 1e-12 * scale)

    def test_the_iterative_solver_gives_the_same_result(self):
        for name in ("block-p1-exact-n16", "cantilever-p2-gauss4-n16"):
            content, *_ = self.solve(CASES / f"{name}.toml", iterative=True)
            stored = json.loads((RESULTS / f"{name}.json").read_text())
            self.assertLess(max(value for _, value in differences(stored, content)), 1e-11)

    def test_an_indefinite_tangent_is_refused(self):
        path = self.file(BLOCK.replace("degree = 1", "degree = 2\ngamma0 = 0.5\nallow_noncoercive = true"))
        for iterative in (False, True):
            with self.subTest(iterative=iterative), self.assertRaisesRegex(NotSolved, "not positive definite"):
                self.solve(path, iterative=iterative)

    def test_too_few_iterations_are_reported_with_the_history(self):
        path = self.file(BLOCK.replace("degree = 1", "[solver]\nmax_iterations = 2"))
        with self.assertRaisesRegex(NotSolved, r"relative residual .* after 2 iterations, expected 1\.0e-10; residuals .*, .*, "):
            self.solve(path)

    def test_newton_with_full_steps_cycles_and_the_line_search_ends_it(self):
        # One Gauss point per edge, a gap with the given values at the midpoints; kappa = 0.03.
        gaps, path = [-0.2, -0.8, 0.1, -0.3, -0.9, -0.3], [0.0]
        for gap in gaps:
            path.append(2 * gap - path[-1])
        slopes = np.diff(path) / 0.05
        gap = f"{slopes[0]!r}*x" + "".join(f" + ({float(b - a)!r})*max(x - {i + 1}/20, 0)" for i, (a, b) in enumerate(zip(slopes, slopes[1:])))
        method = method_of(self.file(CYCLING.replace("GAP", gap)))
        solver = Solver(method, iterative=False)
        start = np.where(solver.prescribed, 0, np.where(np.arange(len(solver.data)) % 2, 0.85, 0))

        u, visited = start, []
        for _ in range(13):
            r = solver.residual(u)
            visited.append(self.active(method))
            u = u + solver.direction(r, newton.History(1.0))
        self.assertEqual(visited, [[5], [1, 2, 5], [2], [2, 5, 6]] * 3 + [[5]])

        solver.data = start
        u, history = solver.solve()
        self.assertEqual(self.active(method), [2, 5])
        edges, P = method.edges, method.edges.P(method.u.x.array)
        s, w, (active,) = edges.rule(P)
        J = 0.5 * method.linear_functional() @ u + np.sum(w * np.where(active, edges.at(P, s), 0) ** 2 / edges.gamma[:, None]) / 2
        self.assertAlmostEqual(J, 0.291087, delta=5e-7)
        self.assertLessEqual(history.iterations, 6)

    def active(self, method):
        """Numbers of the edges with P > 0 at their midpoint, from the left, at the current iterate."""
        edges = method.edges
        _, _, (active,) = edges.rule(edges.P(method.u.x.array))
        return (np.flatnonzero(active[np.argsort(edges.ends[:, :, 0].sum(axis=1)), 0]) + 1).tolist()

    def test_a_tolerance_below_rounding_is_met_to_rounding(self):
        path = self.file(BLOCK.replace("degree = 1", "[solver]\ntolerance = 1e-17"))
        *_, history = self.solve(path)
        self.assertEqual(history.outcome, "converged to rounding")
        self.assertLess(history.residuals[-1], 1e-14 * history.reference)


CYCLING = """
[mesh]
rectangle = { width = 0.3, height = 1.0, nx = 6, ny = 4, diagonal = "right" }
[material]
lambda = 1.0
mu = 1.0
[boundary.top]
displacement = ["0", "0"]
[boundary.bottom]
contact = { gap = "GAP" }
[method]
gamma0 = 0.0049029033784546
contact_quadrature = { gauss = 1 }
"""
