"""The exact solutions satisfy (1)-(2); errors fall at the rates of Theorem 3.5 and Remark 3.7."""

import json
import math

import numpy as np

from fenicsx import exact, quadrature, taylor
from fenicsx.case import Material
from fenicsx.expression import Expression
from fenicsx.store import RESULTS

from .support import TestCase

UNIT = Material(1.0, 1.0, "strain")
OTHERS = (Material(3.0, 0.7, "strain"), Material(3.0, 0.7, "stress"))
SOLUTIONS = {
    "smooth": lambda m: exact.Smooth(m, Expression("0"), c=1 / 3, k=4.0, m=3.0, ap=16.0, aq=8.0),
    "smooth with a gap": lambda m: exact.Smooth(m, Expression("0.2 - 0.3*x + 0.5*x^2"), c=1 / 3, k=3.0, m=2.0, ap=8.0, aq=4.0),
    "singular": lambda m: exact.Singular(m, c=0.4, amplitude=1.5),
    "corner": lambda m: exact.Corner(m, omega=0.6 * math.pi),
    "d1": lambda m: exact.Compression(m, p=0.3),
    "d2": lambda m: exact.Separation(m, p=0.3, d=0.1),
    "d3": lambda m: exact.AffineGap(m, p=0.3, w=0.2, g0=0.1),
    "d4": lambda m: exact.Grazing(m),
    "d5": lambda m: exact.Interference(m, d=0.1),
}


def points(seed):
    """Inside the unit square, away from its sides and from x = c."""
    x, y = np.random.default_rng(seed).uniform(0.05, 0.95, (2, 40))
    keep = (np.abs(x - 1 / 3) > 0.02) & (np.hypot(x - 0.4, y) > 0.05)
    return x[keep], y[keep]


def difference(f, x, y, h=1e-4):
    """Central differences of a function of (x, y), fourth order: ((d/dx, d/dy) of f)."""
    def along(dx, dy):
        return (8 * (f(x + dx, y + dy) - f(x - dx, y - dy)) - (f(x + 2 * dx, y + 2 * dy) - f(x - 2 * dx, y - 2 * dy))) / (12 * h)
    return along(h, 0), along(0, h)


class Solutions(TestCase):
    def test_values_known_to_many_digits(self):
        x, y = np.array([0.9]), np.array([0.6])
        a = exact.Smooth(UNIT, Expression("0"), c=1 / 3, k=3.0, m=2.0, ap=8.0, aq=4.0)
        np.testing.assert_allclose(np.ravel(a.displacement(x, y)), [-1.627648, 0.5124077037037035], rtol=1e-14)
        np.testing.assert_allclose(np.ravel(a.body_force(x, y)), [35.9616, -42.66773333333332], rtol=1e-14)
        np.testing.assert_allclose(a.gradient(x, y)[0][1], 3.945813333333333, rtol=1e-14)
        b = exact.Singular(UNIT, c=0.5, amplitude=1.0)
        at = np.array([0.3]), np.array([0.2])
        np.testing.assert_allclose(np.ravel(b.displacement(*at)), [-0.01075810061892700, -0.02035223728176083], rtol=1e-13)
        np.testing.assert_allclose(b.gradient(*at)[0][1], -0.2395003853032351, rtol=1e-14)
        c = exact.Corner(UNIT, omega=3 * math.pi / 4)
        self.assertAlmostEqual(c.alpha, 0.5444837367824640, delta=1e-15)
        np.testing.assert_allclose(np.ravel(c.displacement(x, y)), [-0.3889076234771358, -0.2516567736790981], rtol=1e-14)

    def test_gradient_and_equilibrium_by_differences(self):
        for material in (UNIT, *OTHERS):
            for name, make in SOLUTIONS.items():
                with self.subTest(f"{name}, {material}"):
                    solution, (x, y) = make(material), points(1)
                    for k in (0, 1):
                        by_difference = difference(lambda p, q: solution.displacement(p, q)[k], x, y)
                        np.testing.assert_allclose(by_difference, solution.gradient(x, y)[k], atol=1e-8)
                    (xx_x, _), (_, yy_y), (xy_x, xy_y) = [difference(lambda p, q: solution.stress(p, q)[i], x, y) for i in range(3)]
                    f = solution.body_force(x, y)
                    np.testing.assert_allclose(xx_x + xy_y + f[0], 0, atol=3e-7)
                    np.testing.assert_allclose(xy_x + yy_y + f[1], 0, atol=3e-7)

    def test_contact_conditions_hold_on_the_contact_boundary(self):
        x = np.linspace(0.01, 0.99, 50)
        y = np.zeros_like(x)
        for material in (UNIT, *OTHERS):
            for name, make in SOLUTIONS.items():
                with self.subTest(f"{name}, {material}"):
                    solution = make(material)
                    distance = -solution.displacement(x, y)[1] - solution.gap(x, y)
                    _, sigma_n, sxy = solution.stress(x, y)
                    self.assertLess(np.max(distance), 1e-14)
                    self.assertLess(np.max(sigma_n), 1e-14)
                    self.assertLess(np.max(np.abs(sigma_n * distance)), 1e-14)
                    self.assertLess(np.max(np.abs(sxy)), 1e-13)

    def test_the_slanted_side_of_the_corner_is_free_of_traction(self):
        solution, s = exact.Corner(UNIT, omega=3 * math.pi / 4), np.linspace(0.1, 1, 10)
        sxx, syy, sxy = solution.stress(-s, s)
        n = np.array([-1, -1]) / math.sqrt(2)
        self.assertLess(np.max(np.abs([sxx * n[0] + sxy * n[1], sxy * n[0] + syy * n[1]])), 1e-13)


class Taylor(TestCase):
    def test_derivatives_by_differences(self):
        x = np.linspace(0.2, 0.9, 15)
        for text in ("0.2 - 0.3*x + 0.5*x^2", "sin(3*x)*cos(x)/(1 + x^2)", "sqrt(x)*exp(-x)", "x^x", "2^x - x^-2.5", "abs(x - 0.31)^3 + min(x, 1/x)",
                     "max(x, 0.57)^2"):
            expression = Expression(text)
            found = taylor.derivatives(expression, x)
            np.testing.assert_allclose(found[0], expression.values(x, x), rtol=1e-14, atol=1e-15)
            for k in range(3):
                with self.subTest(f"{text}, derivative {k + 1}"):
                    by_difference = difference(lambda p, q: taylor.derivatives(expression, p)[k], x, x)[0]
                    np.testing.assert_allclose(found[k + 1], by_difference, rtol=1e-8, atol=1e-8)

    def test_no_points_have_no_derivatives(self):  # a process may own no node of a boundary
        self.assertEqual([d.shape for d in taylor.derivatives(Expression("(1 + x)^0.5/x"), np.zeros(0))], [(0,)] * 4)

    def test_whole_powers_have_derivatives_at_zero(self):
        self.assertEqual([float(d[0]) for d in taylor.derivatives(Expression("x^2 + x^3"), np.array([0.0]))], [0, 0, 2, 6])


class Quadrature(TestCase):
    def test_cut_and_graded_rules_are_exact_for_polynomials(self):
        triangle = np.array([[[0.1, 0.0], [0.9, 0.1], [0.4, 0.8]]])
        fine, moments = quadrature.collapsed(20, 1), []
        for cut, apex in ((None, None), (0.35, None), (None, (0.4, 0.3)), (None, (0.5, 0.05)), (None, (0.1, 0.0))):
            solution = exact.Grazing(UNIT)
            solution.cut, solution.apex = cut, apex
            _, p, w = quadrature.on_triangles(triangle, solution)
            moments.append([w @ (p[:, 0] ** i * p[:, 1] ** j) for i in range(5) for j in range(5)])
        area = 0.5 * abs(np.linalg.det(triangle[0, 1:] - triangle[0, 0]))
        p = fine[0] @ triangle[0]
        expected = [area * fine[1] @ (p[:, 0] ** i * p[:, 1] ** j) for i in range(5) for j in range(5)]
        np.testing.assert_allclose(moments, np.tile(expected, (5, 1)), rtol=1e-13)

    def test_a_kink_on_the_cut_is_integrated_exactly(self):
        solution = exact.Smooth(UNIT, Expression("0"), c=0.35, k=3.0, m=2.0, ap=1.0, aq=1.0)
        triangle = np.array([[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]])
        _, p, w = quadrature.on_triangles(triangle, solution)
        self.assertAlmostEqual(w @ np.maximum(p[:, 0] - 0.35, 0), 0.65**3 / 6, delta=1e-16)

    def test_a_singularity_at_a_vertex_is_integrated_to_eleven_digits(self):
        solution = exact.Corner(UNIT, omega=3 * math.pi / 4)
        triangle = np.array([[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]])
        _, p, w = quadrature.on_triangles(triangle, solution)
        q = 2 * solution.alpha - 2
        r = np.hypot(*p.T) ** q
        theta, weight = quadrature.gauss(40)
        edge = 1 / (np.cos(theta * math.pi / 2) + np.sin(theta * math.pi / 2))
        self.assertAlmostEqual(w @ r / (weight @ edge ** (q + 2) * math.pi / 2 / (q + 2)), 1, delta=1e-11)


class Rates(TestCase):
    def test_errors_fall_at_the_rates_of_theorem_3_5_and_remark_3_7(self):
        # Predicted rates of h1; contact_residual is at least as fast, and equally fast only for the corner. Bands: n = 8 to 16.
        table = [("smooth", 1, 1.0, 0.05), ("smooth", 2, 2.0, 0.06), ("singular", 1, 1.0, 0.05), ("singular", 2, 1.5, 0.05),
                 ("corner", 1, 0.5445, 0.04), ("corner", 2, 0.5445, 0.04)]
        for name, degree, rate, band in table:
            for quadrature_name in ("gauss4", "exact"):
                with self.subTest(f"{name} P{degree} {quadrature_name}"):
                    coarse, fine = (json.loads((RESULTS / f"{name}-p{degree}-{quadrature_name}-n{n}.json").read_text())["errors"] for n in (8, 16))
                    self.assertAlmostEqual(math.log2(coarse["h1"] / fine["h1"]), rate, delta=band)
                    contact = math.log2(coarse["contact_residual"] / fine["contact_residual"])
                    self.assertGreater(contact, rate - band)
                    if name == "corner":
                        self.assertLess(contact, rate + band)
