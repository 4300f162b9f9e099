"""Negative controls: methods that are wrong in one place differ from the stored results by far more than the 1e-10 of the comparisons."""

import json

import ufl

from fenicsx.method import Method
from fenicsx.store import RESULTS, differences

from .support import BLOCK, CASES, TestCase

NAMES = ("block-p1-gauss4-n8", "gap-p2-gauss4-n8", "cantilever-p2-gauss4-n8")
LARGE = 1e-4  # a million times the tolerance


class Penalty(Method):
    """v_n in place of P and P0, a in place of A: consistent no more."""

    def __init__(self, problem, gamma0):
        super().__init__(problem, gamma0)
        self.edges.B = self.edges.V_n

    def P0(self, v):
        return self.v_n(v)

    def P(self, v, g):
        return self.v_n(v) - g

    def A(self, u, v):
        return self.a(u, v)


class WithGamma(Method):
    """Another gamma in the forms and, so that the line search has the energy of these forms, on the edges."""

    def __init__(self, problem, gamma0):
        super().__init__(problem, gamma0)
        edges = self.edges
        edges.gamma = self.on_edges(gamma0)
        edges.B = edges.V_n - edges.gamma[:, None, None] * edges.S_n


class EdgeLength(WithGamma):
    """gamma = gamma0 |E|"""

    def gamma(self):
        return self.gamma0 * ufl.FacetArea(self.problem.mesh)

    def on_edges(self, gamma0):
        return gamma0 * self.edges.length


class Inverted(WithGamma):
    """gamma = 1 / (gamma0 h_T)"""

    def gamma(self):
        return 1 / (self.gamma0 * ufl.CellDiameter(self.problem.mesh))

    def on_edges(self, gamma0):
        return 1 / (gamma0 * self.edges.h_T)


def stored(name):
    return json.loads((RESULTS / f"{name}.json").read_text())


class Controls(TestCase):
    def differences(self, path, reference, method):
        content, *_ = self.solve(path, Method=method)
        return dict(differences(reference, content))

    def test_the_method_itself_agrees(self):
        for name in NAMES:
            self.assertLess(max(self.differences(CASES / f"{name}.toml", stored(name), Method).values()), 1e-11)

    def test_control_penalty_disagrees(self):
        self.check(Penalty, NAMES)

    def test_control_edge_length_in_place_of_h_T_disagrees(self):
        # With crossed diagonals the contact edge is its triangle's longest, so the case "gap" cannot tell.
        self.check(EdgeLength, [name for name in NAMES if not name.startswith("gap")])
        same = self.differences(CASES / "gap-p2-gauss4-n8.toml", stored("gap-p2-gauss4-n8"), EdgeLength)
        self.assertLess(max(same.values()), 1e-11)

    def check(self, method, names):
        for name in names:
            with self.subTest(name):
                differs = self.differences(CASES / f"{name}.toml", stored(name), method)
                for place in ("quantities.a_uu", "quantities.contact_force"):
                    self.assertGreater(differs[place], LARGE)
                self.assertGreater(max(value for place, value in differs.items() if place.startswith("probes")), LARGE)

    def test_control_inverted_gamma_disagrees(self):
        # A soft body, for which both gamma and 1/gamma are coercive: otherwise the control would stop at an indefinite tangent.
        text = BLOCK.replace("lambda = 1.0\nmu = 1.0", "lambda = 0.01\nmu = 0.01").replace("-4 + 10*x", "0.01*(-4 + 10*x)")
        path = self.file(text.replace("degree = 1", "gamma0 = 2.0\ncontact_quadrature = { gauss = 4 }"))
        reference, *_ = self.solve(path)
        self.assertLess(max(self.differences(path, reference, Method).values()), 1e-15)
        differs = self.differences(path, reference, Inverted)
        for place in ("quantities.a_uu", "quantities.contact_force"):
            self.assertGreater(differs[place], LARGE)
