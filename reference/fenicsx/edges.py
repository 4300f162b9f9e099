"""The contact edges in numpy: P as a polynomial on each edge, integrals of its positive part, and what is reported of them.

P restricted to an edge has the displacement's degree p, so its values at the edge's p + 1 Lagrange points determine it:
P(u) = B u_T - g there, B the matrix of P0 on the dofs u_T of the owning triangle T. The direction of contact n~ is given at these
points (docs/theory.md, 2.1): u . n~ is interpolated from them, and s(v) = n~ . sigma(v) n, which stands for sigma_n, from the two ends. Between consecutive roots P keeps its sign and
p + 1 Gauss points integrate its square, and all else in (8), without error: this is the rule "exact". Tables of P at points have one
row per edge. What friction adds is in friction.py.
"""

import numpy as np
from mpi4py import MPI

from . import compat
from .friction import Friction, edge_values
from .problem import FACET_VERTICES
from .quadrature import gauss

REFERENCE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


def edge_basis(degree, s):
    """The Lagrange basis of an edge at s in [0, 1] (an array of any shape; the basis is the last axis)."""
    if degree == 1:
        return np.stack((1 - s, s), axis=-1)
    return np.stack(((1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)), axis=-1)


def _largest(law, n):
    """The largest eigenvalue of the acoustic tensor."""
    c11, c12, c16, c22, c26, c66 = law
    x, y = n
    xx = c11 * x * x + 2 * c16 * x * y + c66 * y * y
    yy = c66 * x * x + 2 * c26 * x * y + c22 * y * y
    xy = c16 * x * x + (c12 + c66) * x * y + c26 * y * y
    return np.linalg.eigvalsh([[xx, xy], [xy, yy]])[-1]


def edge_mass(weights):
    """int_0^1 w a b for affine a and b in terms of their values at 0 and 1, a matrix for each row of weights."""
    return np.einsum("kij,ek->eij", np.array([[[3, 1], [1, 1]], [[1, 1], [1, 3]]]) / 12, weights)


def trace_constants(p, weights, opposite):
    """The sharp c of (1/|E|) int_E w a^2 <= (c/|T|) int_T w a^2 for a of degree p - 1: 1 and 3 where w is constant."""
    if p == 1:
        return weights.mean(axis=1) / ((weights.sum(axis=1) + opposite) / 3)
    on_triangle = [[[6, 2, 2], [2, 2, 1], [2, 1, 2]], [[2, 2, 1], [2, 6, 2], [1, 2, 2]], [[2, 1, 2], [1, 2, 2], [2, 2, 6]]]
    m = np.einsum("kij,ek->eij", np.array(on_triangle) / 60, np.column_stack((weights, opposite)))
    # The least int_T with given values at the ends of E.
    inner = m[:, :2, :2] - m[:, :2, 2:] * m[:, 2:, :2] / m[:, 2:, 2:]
    return np.max(np.linalg.eigvals(np.linalg.solve(inner, edge_mass(weights))).real, axis=1)


def hoop_strains(p, radii, at):
    """theta(phi e_r) at the places `at` (triangles, points, 2) of the reference triangle, (triangles, points, functions): the polynomial of degree
    p - 1 on each triangle with int r theta q = int phi q for all q of that degree, by a rule that is exact."""
    t, w = gauss(3)  # squeezed into a corner it is exact up to degree 4
    x = np.array([[a, b * (1 - a)] for a in t for b in t])
    weights = np.array([u * v * (1 - a) for a, u in zip(t, w) for v in w])
    functions = lambda places: np.stack([np.ones(places.shape[:-1]), *np.moveaxis(places, -1, 0)][: 1 if p == 1 else 3], axis=-1)
    r = radii[:, :1] + (radii[:, 1:] - radii[:, :1]) @ x.T
    q = functions(x)
    mass = np.einsum("q,eq,qa,qb->eab", weights, r, q, q)
    means = np.einsum("q,qa,qi->ai", weights, q, compat.basis(p, x)[0])
    return functions(at) @ np.linalg.solve(mass, np.tile(means, (len(radii), 1, 1)))


def coefficients(nodal):
    """(c0, c1[, c2]) of c0 + c1 s + c2 s^2 with the given values at s = 0, (1/2,) 1; one row per edge."""
    if nodal.shape[1] == 2:
        return nodal[:, 0], nodal[:, 1] - nodal[:, 0]
    start, middle, end = nodal.T
    return start, -3 * start + 4 * middle - end, 2 * (start - 2 * middle + end)


def roots(nodal):
    """The roots in (0, 1) of each row's polynomial, (edges, degree), with 1 where there is none."""
    c = coefficients(nodal)
    with np.errstate(all="ignore"):
        if len(c) == 2:
            found = (-c[0] / c[1])[:, None]
        else:
            discriminant = c[1] ** 2 - 4 * c[2] * c[0]
            q = -(c[1] + np.copysign(np.sqrt(discriminant), c[1])) / 2
            found = np.column_stack((q / c[2], c[0] / q))
    return np.where((found > 0) & (found < 1), found, 1.0)


class ContactEdges:
    """The edges on Gamma_C whose triangles this process owns."""

    def __init__(self, problem, gamma0):
        self.comm, self.p, self.gauss = problem.comm, problem.case.degree, problem.case.gauss
        self.problem = problem
        self.names, self.cells, self.vertices, local = [], [], [], []
        for name in problem.case.of_kind("contact"):
            facets = problem.boundaries[name]
            self.names += [name] * np.count_nonzero(facets.owned)
            self.cells += facets.cells[facets.owned].tolist()
            local += facets.local[facets.owned].tolist()
            self.vertices += facets.ends[facets.owned].tolist()
        self._geometry(problem, np.array(local, int))
        self.gamma = gamma0 * self.h_T
        self._operators(problem, np.array(local, int))

    def _geometry(self, problem, local):
        count = len(self.cells)
        corners = problem.mesh.geometry.x[compat.cell_vertices(problem.mesh)[self.cells].reshape(count, 3)][:, :, :2]
        self.corners = corners
        self.ends = np.array([corners[e, FACET_VERTICES[i]] for e, i in enumerate(local)]).reshape(count, 2, 2)
        along = self.ends[:, 1] - self.ends[:, 0]
        self.length = np.linalg.norm(along, axis=1)
        self.n = np.column_stack((along[:, 1], -along[:, 0])) / self.length[:, None]
        inward = np.array([corners[e, i] for e, i in enumerate(local)]).reshape(count, 2) - self.ends[:, 0]
        self.n[np.einsum("ek,ek->e", self.n, inward) > 0] *= -1
        self.h_T = np.max(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2), axis=1)
        self.J = np.stack((corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=2)  # d x / d (reference)
        self.area = np.abs(np.linalg.det(self.J)) / 2
        # The weight of all integrals: r in a body of revolution, affine along an edge.
        weighted = problem.case.of_revolution
        self.weights = self.ends[:, :, 0] if weighted else np.ones((count, 2))
        self.opposite = corners[:, :, 0].sum(axis=1) - self.weights.sum(axis=1) if weighted else np.ones(count)

    def _operators(self, problem, local):
        """`V_n`, `S_n` (edges, p + 1, dofs of T): n~ . v and s(v) at the edge's Lagrange points; `B` = V_n - gamma S_n; the gap; and the
        same across n~ for friction, where s_t is 0 on edges without."""
        count = len(self.cells)
        on_line = [problem.contact[name, a, b] for name, (a, b) in zip(self.names, self.vertices)]
        self.directions = np.array([n for n, _ in on_line]).reshape(count, self.p + 1, 2)
        self.gap = np.array([g for _, g in on_line]).reshape(count, self.p + 1)
        mu, bounds, self.rough = edge_values([problem.rough.get(name) for name in self.names], self.vertices, problem.plane.points, self.p)
        s = np.linspace(0, 1, self.p + 1)
        tables = [compat.basis(self.p, (1 - s)[:, None] * REFERENCE[i] + s[:, None] * REFERENCE[j]) for i, j in FACET_VERTICES]
        values = np.array([table[0] for table in tables])[local]
        ends = [0, -1]
        gradients = (np.array([table[1] for table in tables])[local] @ np.linalg.inv(self.J)[:, None])[:, ends]
        functions, n = values.shape[2], self.n[:, None, None, :]

        def along(directions):
            d = directions[:, ends, None, :]
            S = self._stresses(problem, gradients, n, d)
            if problem.case.of_revolution:
                S = S + self._hoop_stresses(problem, self.REFERENCE_ENDS[local])[..., None] * np.sum(n * d, axis=3)[..., None] * [1.0, 0.0]
            S = np.einsum("pa,eaik->epik", edge_basis(1, s), S)
            V = values[..., None] * directions[:, :, None, :]
            return (table.reshape(count, self.p + 1, 2 * functions) for table in (V, S))

        self.V_n, self.S_n = along(self.directions)
        self.across = np.stack((-self.directions[..., 1], self.directions[..., 0]), axis=2)
        V_t, S_t = along(self.across)
        self.S_t = S_t * self.rough[:, None, None]
        self._stiffness(problem)
        self.B = self.V_n - self.gamma[:, None, None] * self.S_n
        self.friction = Friction(self, self.rough, mu, bounds, V_t - self.gamma[:, None, None] * self.S_t, V_t)
        nodes = np.array([problem.V.dofmap.cell_dofs(cell) for cell in self.cells], np.int32).reshape(count, functions)
        self.dofs = (2 * nodes[:, :, None] + np.arange(2, dtype=np.int32)).reshape(count, 2 * functions)

    def _stresses(self, problem, gradients, n, d):
        """d . sigma(phi e_k) n for the gradients of phi."""
        if problem.case.is_isotropic:
            lam, mu = (values.reshape(-1, 1, 1, 1) for values in problem.lame(self.cells))
            along_n, along_d = (np.sum(gradients * v, axis=3, keepdims=True) for v in (n, d))
            # lam (d . n) d_k phi + mu (d_k (n . grad phi) + n_k (d . grad phi))
            return lam * np.sum(d * n, axis=3, keepdims=True) * gradients + mu * (d * along_n + n * along_d)
        _, (xx, yy, xy) = self._pulled(problem, n, d)
        x, y = gradients[..., 0], gradients[..., 1]
        return np.stack((xx * x + xy * y, xy * x + yy * y), axis=3)

    def _pulled(self, problem, n, d):
        """The strain along d and n (xx, yy, 2 xy) and its stress, which has the traction grad phi . sigma."""
        c11, c12, c16, c22, c26, c66 = (c.reshape(-1, 1, 1) for c in problem.stiffness(self.cells).T)
        a, b, c = d[..., 0] * n[..., 0], d[..., 1] * n[..., 1], d[..., 0] * n[..., 1] + d[..., 1] * n[..., 0]
        return (a, b, c), (c11 * a + c12 * b + c16 * c, c12 * a + c22 * b + c26 * c, c16 * a + c26 * b + c66 * c)

    def _stiffness(self, problem):
        """`stiffness`: the c of |d . sigma n|^2 <= c sigma:eps, of the whole traction where d turns or friction acts, too."""
        if problem.case.is_isotropic:
            lam, mu = problem.lame(self.cells)
            self.stiffness = lam + 2 * mu
            return
        d = self.directions[:, :1, None, :]
        strain, stress = self._pulled(problem, self.n[:, None, None, :], d)
        energy = sum(a * b for a, b in zip(strain, stress))[:, 0, 0]
        whole = self.rough | np.any(self.directions[:, 0] != self.directions[:, -1], axis=1)
        laws = problem.stiffness(self.cells)
        self.stiffness = np.where(whole, [_largest(law, normal) for law, normal in zip(laws, self.n)], energy)

    REFERENCE_ENDS = np.array([[REFERENCE[i], REFERENCE[j]] for i, j in FACET_VERTICES])

    def _hoop_stresses(self, problem, at):
        """lambda theta(phi e_r) at the places `at` (edges, 2, 2) of the reference triangle, theta being the projection of phi / r."""
        lam, _ = problem.lame(self.cells)
        values = hoop_strains(problem.case.degree, self.corners[:, :, 0], at)
        return lam.reshape(-1, 1, 1) * values

    def P(self, u):
        """P(u) at the Lagrange points of each edge; u holds all dofs that this process sees."""
        return self.P0(u) - self.gap

    def P0(self, v):
        return np.einsum("eqd,ed->eq", self.B, v[self.dofs])

    # - int gamma s(u) s(.), which UFL integrates where the line of contact is the paper's.

    def stress_blocks(self):
        """One block per edge; s and the weight are affine."""
        mass = edge_mass(self.weights)
        of = lambda ends: np.einsum("e,eid,eij,ejc->edc", self.gamma * self.length, ends, mass, ends)
        return -of(self.S_n[:, [0, -1]]) - of(self.S_t[:, [0, -1]])

    def stress_functional(self, u):
        total = np.zeros_like(u)
        np.add.at(total, self.dofs, np.einsum("edc,ec->ed", self.stress_blocks(), u[self.dofs]))
        return total

    def rule(self, *polynomials):
        """Points s and weights (lengths, without the weight r) for integrals of positive parts of the polynomials (nodal values), in one table
        per edge; and per polynomial, where it counts as positive."""
        if self.gauss:
            s, w = gauss(self.gauss)
            s, w = np.tile(s, (len(self.length), 1)), np.tile(w, (len(self.length), 1))
            signs = [self.at(nodal, s) for nodal in polynomials]
        else:
            ends = np.zeros((len(self.length), 1)), np.ones((len(self.length), 1))
            cuts = np.sort(np.hstack((ends[0], *map(roots, polynomials), ends[1])), axis=1)
            pieces, middles = np.diff(cuts), (cuts[:, 1:] + cuts[:, :-1]) / 2
            t, w = gauss(self.p + 1)
            s = (cuts[:, :-1, None] + pieces[:, :, None] * t).reshape(len(pieces), pieces.shape[1] * len(t))
            w = (pieces[:, :, None] * w).reshape(s.shape)
            signs = [np.repeat(self.at(nodal, middles), len(t), axis=1) for nodal in polynomials]
        return s, w * self.length[:, None], [sign > 0 for sign in signs]

    def weight(self, s):
        return np.einsum("eqi,ei->eq", edge_basis(1, s), self.weights)

    def basis(self, s):
        return edge_basis(self.p, s)

    def at(self, nodal, s):
        return np.einsum("eqi,ei->eq", self.basis(s), nodal)

    def functional(self, u):
        """int (1/gamma) [P(u)]+ P0(.) and friction's beside it, over all dofs that this process sees."""
        P = self.P(u)
        s, w, (active,) = self.rule(P)
        pressure = np.where(active, self.at(P, s), 0) / self.gamma[:, None]
        loads = np.einsum("eq,eq,eqi,eid->ed", w * self.weight(s), pressure, edge_basis(self.p, s), self.B) + self.friction.functional(u)
        total = np.zeros_like(u)
        np.add.at(total, self.dofs, loads)
        return total

    def tangent(self, u, everywhere=False):
        """(dofs, block) per edge of int (1/gamma) H(P(u)) P0(.) P0(.), with friction's beside it; as if all were pressed and stuck if
        `everywhere`."""
        P = self.P(u)
        s, w, (active,) = self.rule(np.ones_like(P) if everywhere else P)
        N = edge_basis(self.p, s)
        mass = np.einsum("eq,eqi,eqj->eij", w * self.weight(s) * active / self.gamma[:, None], N, N)
        return zip(self.dofs, np.einsum("eid,eij,ejc->edc", self.B, mass, self.B) + self.friction.tangent(u, everywhere))

    def energy_change(self, u, d, t):
        """1/2 int (1/gamma) ([P(u + t d)]+^2 - [P(u)]+^2) without cancellation: a^2 - b^2 = (a - b)(a + b)."""
        before, D = self.P(u), self.P0(d)
        after = before + t * D
        s, w, (was, is_) = self.rule(before, after)
        b, a = np.where(was, self.at(before, s), 0), np.where(is_, self.at(after, s), 0)
        both = was & is_
        difference = np.where(both, t * self.at(D, s), a - b)
        change = float(np.sum(w * self.weight(s) / (2 * self.gamma[:, None]) * difference * (a + b)))
        return self.comm.allreduce(change + self.friction.energy_change(u, d, t))

    # What is reported.

    def pressure(self, u):
        """contact_force = -int lambda^h, contact_resultant = int lambda^h n~ and what friction adds, contact_length = the measure of
        {P > 0}, peak_pressure."""
        P = self.P(u)
        forces, w, active = self._forces(P)
        resultant = np.sum(self._vectors(forces, u), axis=(0, 1))
        sums = self.comm.allreduce(np.array([np.sum(forces), *resultant, np.sum(w * active)]))
        peak = self.comm.allreduce(float(np.max(self._largest(P) / self.gamma, initial=0.0)), op=MPI.MAX)
        return {"contact_force": float(sums[0]), "contact_resultant": [float(sums[1]), float(sums[2])],
                "contact_length": float(sums[3]), "peak_pressure": peak}

    def _forces(self, P):
        """(int (1/gamma) [P]+ N_i at each Lagrange point i of each edge, lengths, where they count)."""
        s, w, (active,) = self.rule(P)
        pressure = np.where(active, self.at(P, s), 0) / self.gamma[:, None]
        return np.einsum("eq,eqi->ei", w * self.weight(s) * pressure, edge_basis(self.p, s)), w, active

    def _vectors(self, forces, u):
        """The forces on the body at each Lagrange point of each edge, friction's among them."""
        return -forces[..., None] * self.directions - self.friction.forces(u)[0][..., None] * self.across

    def boundaries(self, u):
        """For each contact boundary the force, resultant, moment about the origin and length of contact, and the largest recovered
        pressure: at each node the mean of -lambda^h weighted by its hat function, for P2 on half edges where the line is straight
        (docs/parts.md)."""
        P = self.P(u)
        forces, w, active = self._forces(P)
        at = np.linspace(0, 1, self.p + 1)
        places = (1 - at)[:, None] * self.ends[:, None, 0] + at[:, None] * self.ends[:, None, 1]
        vectors = self._vectors(forces, u)
        moments = np.sum(places[..., 0] * vectors[..., 1] - places[..., 1] * vectors[..., 0], axis=1)
        s, fine, (pressed, _) = self.rule(P, np.tile(2 * at - 1, (len(P), 1)))  # cut at the middle, too
        pressure = np.where(pressed, self.at(P, s), 0) / self.gamma[:, None]
        is_end = (at == 0) | (at == 1)
        curved = np.array([self.problem.smooth.oriented(*ends) in self.problem.smooth.ends for ends in self.vertices], bool)[:, None]
        slope = np.where(curved, 1, self.p)[..., None]
        hats = lambda s: np.maximum(0, 1 - slope * np.abs(s[..., None] - at)) * (is_end | ~curved)[:, None]
        work = np.einsum("eq,eqi->ei", fine * self.weight(s) * pressure, hats(s))
        t, half = gauss(2)  # exact on half edges for a hat times the weight
        s = np.tile(np.hstack((t, t + 1)) / 2, (len(P), 1))
        weight = np.einsum("e,q,eq,eqi->ei", self.length, np.hstack((half, half)) / 2, self.weight(s), hats(s))
        parts = zip(self.names, self.vertices, forces.sum(axis=1), vectors.sum(axis=1), moments, np.sum(w * active, axis=1), work, weight,
                    self.directions, self.friction.report(u))
        parts = [part for of in self.comm.allgather(list(parts)) for part in of]
        return [self._boundary(name, [part[1:] for part in parts if part[0] == name]) for name in sorted({part[0] for part in parts})]

    def _boundary(self, name, parts):
        nodes = {}  # vertex or edge -> [direction, work, weight] for each direction of contact there
        for (a, b), *_, work, weight, directions, _ in parts:
            keys = [a, b] if self.p == 1 else [a, (a, b), b]
            for key, n, value, size in zip(keys, directions, work, weight):
                at = nodes.setdefault(key, [])
                group = next((g for g in at if np.hypot(*(g[0] - n)) <= 1e-6), None)
                if group:
                    group[1:] = group[1] + value, group[2] + size
                else:
                    at.append([n, value, size])
        sums = [sum(column) for column in zip(*(part[1:5] for part in parts))]
        found = {"boundary": name, "force": float(sums[0]), "resultant": sums[1].tolist(), "moment": float(sums[2]), "length": float(sums[3]),
                 "peak_pressure": float(max(value / size for at in nodes.values() for _, value, size in at if size > 0))}
        if name in self.problem.rough:
            of_edges = np.array([part[-1] for part in parts])
            shear, sticks, slides, work, open_, most, *_ = of_edges.sum(axis=0).tolist()
            slip, *at = max(of_edges[:, 6:].tolist())
            found["friction"] = {"shear": shear, "sticks": sticks, "slides": slides, "slip": slip, "slip_at": at, "dissipated": work,
                                 "across_gaps": open_ / most if most > 0 else 0.0}
        return found

    def _largest(self, P):
        """The maximum of P on each edge: at an end, or for p = 2 at the vertex of the parabola."""
        largest = np.maximum(P[:, 0], P[:, -1])
        if self.p == 2:
            _, c1, c2 = coefficients(P)
            with np.errstate(all="ignore"):
                s = -c1 / (2 * c2)
            inside = (c2 < 0) & (s > 0) & (s < 1)
            largest = np.maximum(largest, self.at(P, np.where(inside, s, 0)[:, None])[:, 0])
        return largest

    def coercivity(self):
        """(C_h, the edge that sets it): kappa = gamma0 C_h, C_h = max_T h_T C c_p sum_{E in T} |E| / |T|, with C = lambda + 2 mu in
        plane strain and 4 mu (lambda + mu) / (lambda + 2 mu) in plane stress (of a tensor as in `_stresses`), c_1 = 1, c_2 = 3. An edge along which n~ turns by theta
        counts 2 - cos(theta) times for P2, with friction x + sqrt(x^2 - 1) times, x = (4 - cos(theta)) / 3. With the weight r: docs/theory.md, 11.2. Of equal edges, the first by its ends."""
        cosine = np.sum(self.directions[:, 0] * self.directions[:, -1], axis=1)
        mass = edge_mass(self.weights)
        rho = mass[:, 0, 1] / np.sqrt(mass[:, 0, 0] * mass[:, 1, 1])
        turns = (self.p == 2) & np.any(self.directions[:, 0] != self.directions[:, -1], axis=1)
        x = np.maximum((4 - cosine) / 3, 1)
        turning = np.where(turns, np.where(self.rough, x + np.sqrt(x * x - 1), 1 + (1 - cosine) * rho / (1 - rho)), 1.0)
        constants = trace_constants(self.p, self.weights, self.opposite) * turning * self.length / self.area
        per_cell = {}
        for cell, constant in zip(self.cells, constants):
            per_cell[cell] = per_cell.get(cell, 0.0) + constant
        numbers = [c * h * per_cell[cell] for c, cell, h in zip(self.stiffness, self.cells, self.h_T)]
        edges = [(value, sorted(ends.tolist())) for value, ends in zip(numbers, self.ends)]
        edges = [edge for part in self.comm.allgather(edges) for edge in part]
        largest = max(value for value, _ in edges)
        return largest, min(ends for value, ends in edges if value >= largest * (1 - 1e-12))
