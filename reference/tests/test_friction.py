"""Friction: forms against the edge integrals, derivatives, the law at the points, and methods that are wrong in one place."""

import json

import numpy as np
from mpi4py import MPI

from fenicsx import method, pair, store
from fenicsx.case import read_case
from fenicsx.method import Method
from fenicsx.newton import NotSolved
from fenicsx.problem import Problem
from fenicsx.solve import coercivity
from fenicsx.store import differences

from .support import BLOCK, CASES, TestCase
from .test_method import some_field

NAMES = ("tresca", "drag", "stay", "journal", "grain")
LARGE = 1e-4  # a million times the tolerance of the comparisons


def method_of(path, Method=Method):
    problem = Problem(read_case(path), MPI.COMM_SELF)
    return Method(problem, coercivity(problem)["gamma0"])


def stored(name):
    return json.loads((store.RESULTS / f"{name}.json").read_text())


class Forms(TestCase):
    def test_ufl_and_edge_integrals_are_the_same_for_gauss_points(self):
        for name in ("tresca", "drag", "stay"):
            for degree in (1, 2):
                on = method_of(CASES / f"friction-{name}-p{degree}-gauss11.toml")
                for bound in ("live", "frozen", "glued"):
                    if bound != "live":
                        on.freeze(None if bound == "glued" else some_field(on, 7))
                    on.set(some_field(on, degree))
                    by_ufl = on.functional()
                    by_edges = on.linear_functional() + on.edges.functional(on.u.x.array)
                    self.assertLess(np.max(np.abs(by_ufl - by_edges)), 1e-12 * np.max(np.abs(by_ufl)), f"{name} {degree} {bound}")

    def test_the_tangent_is_the_derivative_of_the_residual_and_that_of_the_energy_where_the_bound_is_given(self):
        for name in NAMES:
            for rule in ("exact", "gauss11"):
                on = method_of(CASES / f"friction-{name}-p2-{rule}.toml")
                u, d = some_field(on, 1), some_field(on, 2)
                t = 1e-6
                for frozen in (False, True):
                    on.freeze(some_field(on, 3)) if frozen else on.release()
                    on.set(u)
                    r = on.functional() - on.problem.load
                    H = on.tangent()
                    direction, image = H.createVecRight(), H.createVecLeft()
                    direction.array[:] = d
                    H.mult(direction, image)
                    residuals = []
                    for sign in (1, -1):
                        on.set(u + sign * t * d)
                        residuals.append(on.functional())
                    slope = (residuals[0] - residuals[1]) / (2 * t)
                    # Central differences: error t^2 times a third derivative, and rounding / t; a kink between both ends is of order t.
                    self.assertLess(np.linalg.norm(slope - image.array), 1e-5 * np.linalg.norm(image.array), f"{name} {rule} {frozen}")
                    if not frozen:
                        continue

                    def change(t):
                        on.set(d)
                        quadratic, seen = on.linear_functional() @ d, on.u.x.array.copy()
                        on.set(u)
                        linear = (on.linear_functional() - on.problem.load) @ d
                        return t * linear + t * t / 2 * quadratic + on.edges.energy_change(on.u.x.array, seen, t)

                    self.assertAlmostEqual((change(t) - change(-t)) / (2 * t), r @ d, delta=1e-6 * np.linalg.norm(r) * np.linalg.norm(d))


class Solutions(TestCase):
    def test_the_shear_is_within_the_bound_and_at_the_bound_against_the_slip(self):
        for name in NAMES:
            with self.subTest(name):
                content, _, on, _ = self.solve(CASES / f"friction-{name}-p1-exact.toml")
                edges, u = on.edges, on.u.x.array
                _, w, m, p, sticks, slides = edges.friction.sections(edges.P(u), edges.friction.P0(u))
                self.assertTrue(np.all(np.abs(p[sticks]) <= m[sticks]))
                self.assertTrue(np.all(p[slides != 0] * slides[slides != 0] >= m[slides != 0]))
                found = content["contact"][0]["friction"]
                self.assertTrue(found["sticks"] > 0 and found["slides"] > 0 and found["dissipated"] > 0)
                self.assertLess(np.min(np.hypot(*(edges.ends.reshape(-1, 2) - found["slip_at"]).T)), 1e-12)

    def test_forces_are_in_equilibrium(self):
        for name in ("tresca", "drag", "journal"):
            content, problem, *_ = self.solve(CASES / f"friction-{name}-p2-exact.toml")
            q = content["quantities"]
            self.assertFalse(np.any(problem.load))
            total = np.sum([q["contact_resultant"], *q["reactions"].values()], axis=0)
            self.assertLess(np.max(np.abs(total)), 1e-12 * q["contact_force"])

    def test_gmres_and_cg_give_the_same_result(self):
        for name in ("friction-drag-p1-exact", "friction-tresca-p2-gauss11"):
            content, *_ = self.solve(CASES / f"{name}.toml", iterative=True)
            self.assertLess(max(value for _, value in differences(stored(name), content)), 1e-10)

    def test_a_bound_of_0_is_no_friction(self):
        smooth, *_ = self.solve(self.file(BLOCK))
        for law in ("coulomb = 0", 'tresca = "0"'):
            content, *_ = self.solve(self.file(BLOCK.replace('gap = "0"', f'gap = "0", friction = {{ {law} }}')))
            self.assertEqual(max(value for _, value in differences(smooth, content)), 0)

    def test_a_body_that_slides_away_is_not_solved(self):
        text = (CASES / "friction-stay-p1-exact.toml").read_text()
        wall = text[text.index("[boundary.right]") : text.index("[method]")]
        path = self.file(text.replace(wall, "").replace("0.006*y", "0.02"))
        with self.assertRaises(NotSolved):
            self.solve(path)


class Twice(Method):
    """Twice the bound, Coulomb's and Tresca's."""

    def __init__(self, problem, gamma0):
        super().__init__(problem, gamma0)
        self.edges.friction.mu *= 2
        self.edges.friction.s *= 2

    def bound(self, *of):
        return 2 * super().bound(*of)


class Along(Method):
    """The shear stress along the slip."""

    def __init__(self, problem, gamma0):
        super().__init__(problem, gamma0)
        of = self.edges.friction
        of.B = of.B - 2 * of.V

    def v_t(self, v):
        return -super().v_t(v)


class OfBoth(Method):
    """mu |P_n| for a bound, also where nothing is pressed."""

    def bound(self, u, g, mu, s):
        return self.gamma() * s + mu * abs(self.P(u, g))


class WithoutGamma(Method):
    """s in place of gamma s for a bound."""

    def __init__(self, problem, gamma0):
        super().__init__(problem, gamma0)
        self.edges.friction.s = self.edges.friction.s / self.edges.gamma[:, None]

    def bound(self, u, g, mu, s):
        return s + mu * method.positive_part(self.P(u, g))


class WithoutShear(Method):
    """int gamma sigma_t(u) sigma_t(v) left out of A."""

    def __init__(self, problem, gamma0):
        super().__init__(problem, gamma0)
        self.edges.S_t = 0 * self.edges.S_t

    def sigma_t(self, v):
        return 0 * super().sigma_t(v)


class Controls(TestCase):
    def worst(self, name, wrong):
        """The largest difference, or infinity where there is no solution."""
        try:
            content, *_ = self.solve(CASES / f"{name}.toml", Method=wrong)
        except NotSolved:
            return float("inf")
        return max(value for _, value in differences(stored(name), content))

    def test_the_method_itself_agrees(self):
        for name in NAMES:
            for rule in ("exact", "gauss11"):
                self.assertLess(self.worst(f"friction-{name}-p2-{rule}", Method), 1e-11)

    def test_control_another_bound_disagrees(self):
        for name in NAMES:
            for rule in ("exact", "gauss11"):
                self.assertGreater(self.worst(f"friction-{name}-p1-{rule}", Twice), LARGE, f"{name} {rule}")

    def test_control_shear_along_the_slip_disagrees(self):
        for name in ("tresca", "drag", "grain"):
            for rule in ("exact", "gauss11"):
                self.assertGreater(self.worst(f"friction-{name}-p1-{rule}", Along), LARGE, f"{name} {rule}")

    def test_control_a_bound_without_gamma_disagrees(self):
        for rule in ("exact", "gauss11"):
            self.assertGreater(self.worst(f"friction-tresca-p1-{rule}", WithoutGamma), LARGE, rule)

    def test_control_shear_left_out_of_the_form_disagrees(self):
        for name in ("tresca", "drag"):
            for rule in ("exact", "gauss11"):
                self.assertGreater(self.worst(f"friction-{name}-p2-{rule}", WithoutShear), 1e-6, f"{name} {rule}")

    def test_control_friction_of_what_is_not_pressed_is_another_residual(self):
        path = CASES / "friction-drag-p1-gauss11.toml"
        right, wrong = method_of(path), method_of(path, OfBoth)
        u = some_field(right, 4)
        for on in (right, wrong):
            on.set(u)
        self.assertGreater(np.max(np.abs(right.functional() - wrong.functional())), LARGE * np.max(np.abs(right.functional())))

    def test_control_a_pair_with_another_friction_disagrees(self):
        for name, law in (("joined-coulomb-p1", "coulomb"), ("apart-tresca-p2", "tresca")):
            file = pair.cases()[name]
            self.assertIsNone(pair.check(name, file))
            text = file.read_text().replace("coulomb = 0.3", "coulomb = 0.301").replace("0.015 +", "0.0151 +")
            self.assertNotEqual(text, file.read_text())
            mesh = pair.FOLDER / f"{name.split('-')[0]}.msh"
            (self.folder / mesh.name).write_bytes(mesh.read_bytes())
            other = self.file(text)
            old = json.loads((pair.STORED / f"{name}.json").read_text())
            self.assertGreater(pair.difference(old, pair.model(other)(other).solve()), 1e3 * pair.TOLERANCE)
