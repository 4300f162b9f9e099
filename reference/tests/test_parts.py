"""Curved lines of contact, obstacles and supports at angles: the smooth boundary, closest points, frames, and a block turned with all that
holds it."""

import math

import numpy as np
from mpi4py import MPI

from fenicsx.constraints import Constraints, Demand
from fenicsx.expression import Expression
from fenicsx.obstacle import Circle, Distance, NoDistance, Plane, Polyline
from fenicsx.plane import PlaneMesh
from fenicsx.smooth import SmoothBoundary
from fenicsx.solve import solve

from .support import CASES, ROOT, TestCase

ANGLES = [0.1, 0.3, 0.45, 0.9, 1.4, 1.6, 2.2, 2.8, 3.3, 3.9, 4.1, 4.7, 5.2, 5.6, 6.0]


def fan(rim, closed):
    """Triangles around the origin."""
    count = len(rim)
    triangles = [[0, 1 + i, 1 + (i + 1) % count] for i in range(count if closed else count - 1)]
    return PlaneMesh(np.array([[0.0, 0.0], *rim]), np.array(triangles), {})


def circle(angles):
    return [[2 * math.cos(a), 2 * math.sin(a)] for a in angles]


class Smooth(TestCase):
    def check_circle(self, plane, edges):
        smooth = SmoothBoundary(plane)
        for edge in edges:
            places, normals = smooth.along(edge)
            radii = np.hypot(*places.T)
            self.assertLess(np.abs(radii - 2).max(), 1e-14)
            self.assertLess(np.abs(normals - places / radii[:, None]).max(), 1e-14)

    def test_on_circles_with_unequal_facets_normals_and_middles_are_exact(self):
        n = len(ANGLES)
        self.check_circle(fan(circle(ANGLES), True), [(1 + i, 1 + (i + 1) % n) for i in range(n)])

    def test_on_an_arc_between_corners_too(self):
        self.check_circle(fan(circle([0, 0.3, 0.5, 0.9, 1.5]), False), [(i, i + 1) for i in range(1, 5)])

    def test_control_with_weights_by_length_they_are_not(self):
        smooth = SmoothBoundary(fan(circle(ANGLES), True))
        smooth.length = {edge: 1 / length for edge, length in smooth.length.items()}
        self.assertGreater(np.abs(smooth._shared(2) - np.array(circle([0.3])[0]) / 2).max(), 0.01)

    def test_straight_sides_keep_the_normals_of_their_facets(self):
        plane = fan([[4.0, -1.0], [4.0, 0.0], [4.0, 1.0], [3.75, 2.0], [3.5, 3.0]], False)
        self.assertEqual(SmoothBoundary(plane).ends, {})

    def test_a_side_that_goes_over_into_an_arc_keeps_its_normal_there(self):
        plane = fan([[2.0, -1.0], [2.0, -0.5], *circle([0, 0.2, 0.4, 0.6])], False)
        ends = SmoothBoundary(plane).ends
        self.assertNotIn((1, 2), ends)
        for normal in (*ends[2, 3], ends[3, 4][0]):
            self.assertEqual(normal.tolist(), [1.0, 0.0])


class Obstacles(TestCase):
    def test_gap_and_direction_lead_to_the_closest_point(self):
        for obstacle, x, gap, direction in [
            (Plane(np.array([0.0, 1.0]), np.array([0.0, 1.0])), [3, 1.5], 0.5, [0, -1]),
            (Circle(np.array([1.0, 0.0]), 2.0, "outside"), [4, 4], 3, [-0.6, -0.8]),
            (Circle(np.array([1.0, 0.0]), 2.0, "inside"), [2.2, 1.6], 0, [0.6, 0.8]),
            (Polyline.through(np.array([[0.0, 0.0], [2.0, 0.0]]), [], "left"), [7, 1.5], 1.5, [0, -1]),
            (Polyline.through(np.array([[0.0, 0.0], [2.0, 0.0]]), [], "right"), [-7, -0.5], 0.5, [0, 1]),
            (Polyline.through(np.array([[-1.0, 0.0], [0.0, 1.0], [1.0, 0.0]]), [], "left"), [0, 3], 2, [0, -1]),
            (Polyline.through(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 5.0]]), [1.0], "left"), [2.3, 0.6], 0.5, [0.6, -0.8]),
            (Polyline.through(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 5.0]]), [1.0], "left"), [2.5, 3], 0.5, [1, 0]),
            (Distance(Expression("sqrt((x - 1)^2 + y^2) - 2")), [4, 4], 3, [-0.6, -0.8]),
            (Distance(Expression("1.05*(sqrt((x - 1)^2 + y^2) - 2)")), [4, 4], 3, [-0.6, -0.8]),
        ]:
            found = obstacle.closest(np.array(x, float))
            self.assertAlmostEqual(found[0], gap, delta=1e-15)
            self.assertLess(np.abs(found[1] - direction).max(), 1e-15)

    def test_derivatives_of_expressions_are_their_difference_quotients(self):
        x = np.array([0.7, 0.4])
        for text in ["x*y/(1 + y)", "sqrt(x + y^2)", "sin(x)*cos(y)", "exp(x - y)", "min(x, y) + max(2*x, y)", "abs(y - x)", "x^y", "-x^3", "2^x"]:
            expression = Expression(text)
            from fenicsx.obstacle import _DUAL, _Dual
            value, *d = expression.run({"x": _Dual(x[0], 1.0, 0.0), "y": _Dual(x[1], 0.0, 1.0)}, _DUAL, _Dual).parts()
            self.assertAlmostEqual(value, float(expression.values(*x)), delta=1e-15)
            for k in (0, 1):
                h = 1e-6 * np.eye(2)[k]
                quotient = float(expression.values(*(x + h)) - expression.values(*(x - h))) / 2e-6
                self.assertAlmostEqual(d[k], quotient, delta=1e-8, msg=text)

    def test_what_is_no_distance_is_refused(self):
        for obstacle, x in [(Distance(Expression("2*y")), [0, 0]), (Circle(np.zeros(2), 1.0, "outside"), [0, 0])]:
            with self.assertRaises(NoDistance):
                obstacle.closest(np.array(x, float))


class Supports(TestCase):
    NODES = np.array([[0.0, 0.0], [1.0, 0.0]])

    def demand(self, angle, value, name="a"):
        return Demand(name, f"boundary.{name}.normal", np.array([math.cos(angle), math.sin(angle)]), value)

    def test_one_oblique_demand_turns_the_frame_and_two_fix_the_node(self):
        found, message = Constraints.of(self.NODES, {0: [self.demand(0.5, 0.1)], 1: [self.demand(0.5, 0.1), self.demand(1.5, -0.2, "b")]})
        self.assertIsNone(message)
        self.assertEqual(found.held.tolist(), [[True, False], [True, True]])
        u = found.from_frames(found.data.ravel()).reshape(-1, 2)
        for node, angle, value in [(0, 0.5, 0.1), (1, 0.5, 0.1), (1, 1.5, -0.2)]:
            self.assertAlmostEqual(u[node] @ [math.cos(angle), math.sin(angle)], value, delta=1e-15)
        # A force on the second node is shared by both.
        force = np.array([0.3, -0.7])
        shares = [direction * (dual @ force) for _, node, direction, dual in found.holders if node == 1]
        self.assertLess(np.abs(sum(shares) - force).max(), 1e-15)

    def test_demands_that_disagree_are_refused(self):
        _, message = Constraints.of(self.NODES, {0: [self.demand(0.5, 0.1), self.demand(0.5, 0.2, "b")]})
        self.assertIn("found 0.2 at (0.0, 0.0), expected 0.1 as on boundary 'a'", message)

    def test_frames_are_rotations(self):
        found, _ = Constraints.of(self.NODES, {0: [self.demand(0.5, 0.1)]})
        u = np.array([0.3, -0.1, 0.7, 0.2])
        self.assertLess(np.abs(found.from_frames(found.into_frames(u)) - u).max(), 1e-15)


class Parts(TestCase):
    def test_a_body_held_by_contact_carries_its_load_and_does_not_slide(self):
        content, problem, method, _ = solve(ROOT / "cases" / "disk_force.toml", MPI.COMM_SELF)
        self.assertAlmostEqual(content["contact"][0]["resultant"][1], 8.5, delta=1e-9)
        self.assertEqual((len(problem.free), len(problem.slides)), (3, 1))
        u = method.u.x.array[: problem.owned_dofs]
        self.assertLess(np.abs(problem.slides @ u).max(), 1e-12 * np.linalg.norm(u))

    def test_forces_on_the_boundaries_balance_loads_and_reactions(self):
        content = solve(CASES / "bimaterial-p2-exact.toml", MPI.COMM_SELF)[0]
        total = np.sum([content["quantities"]["contact_resultant"], *content["quantities"]["reactions"].values()], axis=0)
        # body (0.01 x, 0) on 2 x 1, (0, -0.02 y) on the punch, pressure 0.03 (1 + y) on x = 2, traction 0.02 x on the top
        loads = np.array([0.02 - 0.045 + 0.04, -0.02 * 2 * (0.5 - 0.08)])
        self.assertLess(np.abs(total + loads).max(), 1e-13)
