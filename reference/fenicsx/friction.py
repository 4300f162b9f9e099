"""Friction on the contact edges in numpy (docs/theory.md, 13): the shear stress on the body is -F / gamma, F = clip(P_t; [m]+), with

    P_t(v) = v_t - gamma s_t(v),    m = gamma s for Tresca's slip bound s,    m = mu P_n for Coulomb's coefficient mu,

t being n~ turned left. s is affine on an edge, from its ends. Between the roots of m and of P_t -+ m all of this is polynomial, so that
the rule "exact" has no error here either. While `frozen` says with which P_n, Coulomb's law is one with a given bound, which has an energy.
"""

import numpy as np

GLUED = 1e30  # a bound that nothing reaches


def edge_values(rough, vertices, points, p):
    """(coefficients, slip bounds at the Lagrange points, which edges have friction) of edges with these vertices; `rough` says the law of
    each: None, a coefficient, or an expression."""
    count = len(rough)
    mu, s = np.zeros(count), np.zeros((count, p + 1))
    at = np.linspace(0, 1, p + 1)
    for e, (law, ends) in enumerate(zip(rough, vertices)):
        if isinstance(law, float):
            mu[e] = law
        elif law is not None:
            start, end = slip_bounds(law, points[ends])
            s[e] = start + (end - start) * at
    return mu, s, np.array([law is not None for law in rough], bool)


def slip_bounds(expression, places):
    return np.asarray(expression.values(*places.T), float)


class Friction:
    """Friction on the edges `on` of ContactEdges with coefficients mu or slip bounds s; `B`, `V` are the tables of P_t and of v_t at the
    Lagrange points."""

    def __init__(self, edges, on, mu, s, B, V):
        self.edges, self.on = edges, on
        self.mu, self.s, self.B, self.V = mu, s, B, V
        self.frozen = None

    @property
    def is_coulomb(self):
        return bool(np.any(self.mu > 0))

    def P0(self, v):
        return np.einsum("eqd,ed->eq", self.B, v[self.edges.dofs])

    def bound(self, normal):
        """m at the Lagrange points, where P_n is `normal`."""
        pressed = normal if self.frozen is None else self.frozen
        return self.edges.gamma[:, None] * self.s + self.mu[:, None] * pressed

    def freeze(self, normal, glued=False):
        """Makes the slip bound that of this P_n, or one that nothing reaches."""
        self.frozen = np.full_like(normal, GLUED) if glued else normal.copy()

    def release(self):
        self.frozen = None

    def sections(self, normal, across):
        """(points, weights, m and P_t there, where it sticks, 1 and -1 where it slides)."""
        m = self.bound(normal)
        s, w, (some, above, not_below) = self.edges.rule(m, across - m, across + m)
        slides = np.where(some & above, 1.0, np.where(some & ~not_below, -1.0, 0.0))
        sticks = some & (slides == 0)
        at = self.edges.at
        return s, w * self.on[:, None], at(m, s), at(across, s), sticks, slides

    def forces(self, u):
        """(int (1/gamma) F N_i at each Lagrange point, the lengths on which it sticks and slides)."""
        s, w, m, p, sticks, slides = self.sections(self.edges.P(u), self.P0(u))
        clipped = np.where(sticks, p, slides * m) / self.edges.gamma[:, None]
        forces = np.einsum("eq,eqi->ei", w * clipped, self.edges.basis(s))
        return forces, np.sum(w * sticks, axis=1), np.sum(w * np.abs(slides), axis=1)

    def functional(self, u):
        """int (1/gamma) F P0_t(.), an entry for each dof of each edge."""
        return np.einsum("ei,eid->ed", self.forces(u)[0], self.B)

    def tangent(self, u, everywhere=False):
        """A block per edge: the derivative of `functional`, or as if all of it stuck. Where Coulomb's friction slides it is not symmetric."""
        edges = self.edges
        s, w, _, _, sticks, slides = self.sections(edges.P(u), self.P0(u))
        if everywhere:
            sticks, slides = np.ones_like(sticks), np.zeros_like(slides)
        N = edges.basis(s)
        mass = lambda weight: np.einsum("eq,eqi,eqj->eij", w * weight / edges.gamma[:, None], N, N)
        blocks = np.einsum("eid,eij,ejc->edc", self.B, mass(sticks), self.B)
        if self.frozen is None and self.is_coulomb:
            by_normal = mass(slides * self.mu[:, None])
            blocks += np.einsum("eid,eij,ejc->edc", self.B, by_normal, edges.B)
        return blocks

    def energy_change(self, u, d, t):
        """The change of int Phi(P_t) / gamma, Phi = F (P_t - F / 2), along t d, with the bound as it is: differences term by term."""
        edges = self.edges
        before, D, m = self.P0(u), self.P0(d), self.bound(edges.P(u))
        after = before + t * D
        s, w, (some, *above) = edges.rule(m, before - m, before + m, after - m, after + m)
        bound, b, a, change = (edges.at(nodal, s) for nodal in (m, before, after, t * D))
        sides = [np.where(high, 1.0, np.where(low, 0.0, -1.0)) for high, low in (above[:2], above[2:])]
        clip = [np.where(side == 0, p, side * bound) for side, p in zip(sides, (b, a))]
        apart = clip[1] * (a - clip[1] / 2) - clip[0] * (b - clip[0] / 2)
        inside = change * (a + b) / 2
        same = np.where(sides[0] == 0, inside, sides[0] * bound * change)
        difference = np.where(some, np.where(sides[0] == sides[1], same, apart), 0)
        return float(np.sum(w * self.on[:, None] / edges.gamma[:, None] * difference))

    def report(self, u):
        """What is said of each edge: its shear force, the lengths on which it sticks and slides, the work, what Tresca's friction bears at
        most, where nothing is pressed and all of it; the largest slip at a node, and where that is."""
        edges = self.edges
        forces, sticks, slides = self.forces(u)
        slip = np.einsum("eqd,ed->eq", self.V, u[edges.dofs])
        _, w, (pressed,) = edges.rule(edges.P(u))
        active, middle = np.sum(w * pressed, axis=1), (self.s[:, 0] + self.s[:, -1]) / 2
        open_ = middle * np.maximum(edges.length - active, 0)
        largest = np.argmax(np.abs(slip), axis=1)
        at = (largest / edges.p)[:, None]
        places = (1 - at) * edges.ends[:, 0] + at * edges.ends[:, 1]
        return np.column_stack((np.abs(forces.sum(axis=1)), sticks, slides, np.sum(forces * slip, axis=1), open_, middle * edges.length,
                                np.abs(slip).max(axis=1), places))
