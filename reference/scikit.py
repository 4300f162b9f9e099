"""A bimaterial block, a bracket of three contact surfaces, a pair of blocks whose meshes do not match and a body of revolution by a third
program: scikit-fem assembles the body, meshio reads the mesh, and what is special to method (8) is written out below. Nothing is shared
with signorini or with fenicsx/, not even the case files: the data of the bodies stand here once more, as functions.

    python3 reference/scikit.py target/release/signorini

solves them (P1 and P2), runs `signorini solve CASE --json` and reads the stored results of FEniCSx (but for the pair, which that does not
solve), and compares energies, forces per surface, moments and displacements with both: exit code 1 if one differs by more than 1e-9 of its
scale. The body of revolution is not the same discrete problem: here its hoop strain is u_r / r itself, by quadrature, and the answers must
draw near on finer meshes as the theory says.

On a contact edge P is a polynomial of the displacement's degree p, given by its values at p + 1 equidistant points. They are
u . n~ - g - gamma s(u), s(v) = n~ . sigma(v) n being affine along the edge. Between the roots of P, Gauss points integrate exactly.
"""

import json
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg
import skfem
from skfem.helpers import ddot, dot, sym_grad, trace

HERE = Path(__file__).resolve().parent
TOLERANCE = 1e-9


# The bodies.


def straight(normal, point):
    """Contact with the plane of this normal, towards the body, through this point: places -> (n~, g)."""
    normal = np.array(normal) / np.hypot(*normal)
    return lambda x: (np.broadcast_to(-normal[:, None], x.shape), normal @ (x - np.array(point)[:, None]))


def pin(center, radius, bore_center, bore_radius):
    """Contact of a round bore with a pin in it: the places are first moved from the chord onto the bore."""

    def closest(x):
        c, d = np.array(bore_center)[:, None], np.array(center)[:, None]
        on_bore = c + bore_radius * (x - c) / np.hypot(*(x - c))
        distance = np.hypot(*(on_bore - d))
        return -(on_bore - d) / distance, distance - radius

    return closest


def plane_strain(young, poisson):
    return young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))


def plane_stress(young, poisson):
    lam, mu = plane_strain(young, poisson)
    return 2 * lam * mu / (lam + 2 * mu), mu


class Bimaterial:
    name, mesh = "bimaterial", "bimaterial.msh"
    materials = {"pad": plane_stress(1.0, 0.4), "punch": plane_stress(20.0, 0.3)}
    contact = {"bottom": straight([-0.03, 1], [0, -0.08])}
    # Components held on curves and at points; force per area of each surface, per length of each curve (with its normal).
    held = {"top": {1: lambda x: -0.05 - 0.01 * x[0]}}
    held_points = {(0.0, 1.0): {0: 0.0}}
    body = {
        "pad": lambda x: [0.01 * x[0], 0 * x[0]],
        "punch": lambda x: [0.01 * x[0], -0.02 * x[1]],
    }
    traction = {
        "top": lambda x, n: [0.02 * x[0], 0 * x[0]],
        "right": lambda x, n: -0.03 * (1 + x[1]) * n,
    }


class Lug:
    name, mesh = "lug", "lug.msh"
    materials = {"rubber": plane_strain(20.0, 0.45), "steel": plane_strain(210000.0, 0.3)}
    contact = {
        "base": straight([0, 1], [0, 0.01]),
        "back": straight([1, 0], [-0.005, 0]),
        "bore": pin([8, 30.005], 3.99, [8, 30], 4),
    }
    held = {"top": {0: lambda x: -0.004 + 0 * x[0], 1: lambda x: -0.01 + 0 * x[0]}}
    held_points = {}
    body = {"steel": lambda x: [0 * x[0], -0.05 + 0 * x[0]]}
    traction = {"fillet": lambda x, n: -3 * n, "right": lambda x, n: [-2 + 0 * x[0], 0 * x[0]]}


class Apart:
    """Two blocks on an inclined line, each with nodes of its own there."""

    name, mesh = "apart", "../pairs/apart.msh"
    materials = {"lower": plane_strain(1.0, 0.4), "upper": plane_strain(20.0, 0.3)}
    pair, along = ("low", "up"), np.array([2, 0.2]) / np.hypot(2, 0.2)
    held = {"base": {0: lambda x: 0 * x[0], 1: lambda x: 0 * x[0]}, "top": {0: lambda x: 0.01 + 0 * x[0], 1: lambda x: -0.03 - 0.02 * x[0]}}
    held_points = {}
    body = {"lower": lambda x: [0.02 * x[0], -0.01 + 0 * x[0]]}
    traction = {}

    @staticmethod
    def gap(x):
        return 0.02 * (x[0] - 0.7) ** 2 - 0.002


# The body, by scikit-fem.


@skfem.BilinearForm
def elasticity(u, v, w):
    e, d = sym_grad(u), sym_grad(v)
    return w.lam * trace(e) * trace(d) + 2 * w.mu * ddot(e, d)


@skfem.BilinearForm
def elasticity_of_revolution(u, v, w):
    """Of a radian. No point of the rule is on the axis."""
    r = w.x[0]
    e, d, hoop, other = sym_grad(u), sym_grad(v), u[0] / r, v[0] / r
    return r * (w.lam * (trace(e) + hoop) * (trace(d) + other) + 2 * w.mu * (ddot(e, d) + hoop * other))


without_hoops = skfem.BilinearForm(lambda u, v, w: w.x[0] * elasticity.form(u, v, w))


class Model:
    def __init__(self, case, degree):
        self.case, self.degree = case, degree
        self._read()
        element = skfem.ElementVector({1: skfem.ElementTriP1, 2: skfem.ElementTriP2}[degree]())
        self.basis = skfem.Basis(self.mesh, element, intorder=4)
        whole = [np.broadcast_to(values[:, None], self.basis.dx.shape) for values in (self.lam, self.mu)]
        self.stiffness = self.form.assemble(self.basis, lam=whole[0], mu=whole[1]).tocsr()
        self.load = self._load(element)
        self.free, self.start = self._held()
        self._contact(element)

    form = elasticity

    def _hoop_stress(self, values, gradients, x, lam):
        """What each point's sigma_rr and sigma_zz have of a hoop strain."""
        return 0.0

    def _weights(self, x):
        """The weight of the integrals at the ends of each edge."""
        return np.ones((x.shape[1], 2))

    def _read(self):
        """The mesh with its physical groups, and lambda and mu of each triangle."""
        file = meshio.read(HERE / "cases" / self.case.mesh)
        triangles, lines = (np.vstack([c.data for c in file.cells if c.type == kind]) for kind in ("triangle", "line"))
        tags = {kind: np.concatenate([t for c, t in zip(file.cells, file.cell_data["gmsh:physical"]) if c.type == kind])
                for kind in ("triangle", "line")}
        used, triangles = np.unique(triangles, return_inverse=True)
        number = {old: new for new, old in enumerate(used)}
        self.mesh = skfem.MeshTri(file.points[used, :2].T.copy(), triangles.reshape(-1, 3).T.copy())
        facets = {tuple(sorted(pair)): f for f, pair in enumerate(self.mesh.facets.T.tolist())}
        self.curves, self.surfaces = {}, {}
        for name, (tag, dimension) in file.field_data.items():
            if dimension == 1:
                pairs = lines[tags["line"] == tag]
                self.curves[name] = np.array([facets[tuple(sorted(number[v] for v in pair))] for pair in pairs.tolist()])
            elif dimension == 2:
                # scikit-fem may sort the vertices of a triangle, not the triangles.
                self.surfaces[name] = np.flatnonzero(tags["triangle"] == tag)
        self.lam, self.mu = (np.empty(self.mesh.t.shape[1]) for _ in range(2))
        for name, (lam, mu) in self.case.materials.items():
            self.lam[self.surfaces[name]], self.mu[self.surfaces[name]] = lam, mu

    def _load(self, element):
        load = np.zeros(self.basis.N)
        for name, force in self.case.body.items():
            part = skfem.Basis(self.mesh, element, intorder=6, elements=self.surfaces[name])
            load += skfem.LinearForm(lambda v, w: dot(np.array(force(w.x)), v)).assemble(part)
        for name, force in self.case.traction.items():
            side = skfem.FacetBasis(self.mesh, element, intorder=6, facets=self.curves[name])
            load += skfem.LinearForm(lambda v, w: dot(np.array(force(w.x, w.n)), v)).assemble(side)
        return load

    def _held(self):
        """The free degrees of freedom, and the prescribed values with 0 elsewhere."""
        component = np.empty(self.basis.N, int)  # of each degree of freedom
        component[self.basis.nodal_dofs] = np.array([0, 1])[:, None]
        if self.degree == 2:
            component[self.basis.facet_dofs] = np.array([0, 1])[:, None]
        self.component = component
        values, free = np.zeros(self.basis.N), np.ones(self.basis.N, bool)
        for name, demands in self.case.held.items():
            dofs = self.basis.get_dofs(self.curves[name]).all()
            for c, value in demands.items():
                of_c = dofs[component[dofs] == c]
                values[of_c], free[of_c] = value(self.basis.doflocs[:, of_c]), False
        for place, demands in self.case.held_points.items():
            vertex = np.argmin(np.hypot(*(self.mesh.p - np.array(place)[:, None])))
            for c, value in demands.items():
                dof = self.basis.nodal_dofs[c, vertex]
                values[dof], free[dof] = value, False
        return free, values

    # The contact edges: rows of P0 and s at p + 1 points of each.

    def _contact(self, element):
        p = self.degree
        self.at = np.linspace(0, 1, p + 1)
        p0, s_rows, self.edges = [], [], []
        for name in sorted(self.case.contact):
            facets = self.curves[name]
            basis = skfem.FacetBasis(self.mesh, element, facets=facets, quadrature=(self.at[None], np.ones(p + 1)))
            x = basis.global_coordinates().value  # (2, edges, points)
            n = np.array(basis.normals)[:, :, :1]
            direction, gap = (np.array(part).reshape(-1, *x.shape[1:]) for part in self.case.contact[name](x.reshape(2, -1)))
            cells = self.mesh.f2t[0, facets]
            corners = self.mesh.p[:, self.mesh.t[:, cells]]
            diameter = np.max(np.hypot(*(corners - np.roll(corners, 1, axis=1))), axis=0)
            length = np.hypot(*(x[:, :, -1] - x[:, :, 0]))
            lam, mu = self.lam[cells][:, None], self.mu[cells][:, None]
            shape = (len(facets) * (p + 1), self.basis.N)
            value, stress = sparse.lil_matrix(shape), sparse.lil_matrix(shape)
            for i in range(basis.Nbfun):
                v, g = np.array(basis.basis[i][0].value), np.array(basis.basis[i][0].grad)
                strain = (g + np.swapaxes(g, 0, 1)) / 2
                sigma = 2 * mu * strain
                sigma[0, 0] += lam * (strain[0, 0] + strain[1, 1])
                sigma[1, 1] += lam * (strain[0, 0] + strain[1, 1])
                hoop = self._hoop_stress(v, g, x, lam)
                sigma[0, 0] += hoop
                sigma[1, 1] += hoop
                s = np.einsum("ieq,ijeq,jeq->eq", direction, sigma, np.broadcast_to(n, x.shape))
                s = s[:, :1] * (1 - self.at) + s[:, -1:] * self.at
                along = np.sum(v * direction, axis=0)
                for e, dof in enumerate(basis.element_dofs[i]):
                    for q in range(p + 1):
                        value[e * (p + 1) + q, dof] += along[e, q]
                        stress[e * (p + 1) + q, dof] += s[e, q]
            self.edges.append({"name": name, "x": x, "direction": direction, "gap": gap[0], "length": length, "cells": cells,
                               "diameter": diameter, "value": value.tocsr(), "stress": stress.tocsr(), "weights": self._weights(x)})
        gamma0 = self._gamma0()
        for edge in self.edges:
            edge["gamma"] = gamma0 * edge["diameter"]
            gammas = sparse.diags(np.repeat(edge["gamma"], p + 1))
            edge["P0"] = (edge["value"] - gammas @ edge["stress"]).tocsr()

    def _gamma0(self):
        """That of kappa = 1/2."""
        return 0.5 / self._largest_constant()

    def _largest_constant(self):
        """kappa / gamma0: the largest of c_p (lambda + 2 mu) h_T |T's contact edges| / |T|, in which an edge of P2 along which n~ turns
        by theta counts 2 - cos(theta) times."""
        lengths = np.zeros(self.mesh.t.shape[1])
        diameters = np.ones_like(lengths)
        for edge in self.edges:
            cosine = np.sum(edge["direction"][:, :, 0] * edge["direction"][:, :, -1], axis=0)
            counted = edge["length"] * (1 if self.degree == 1 else 2 - np.minimum(cosine, 1))
            np.add.at(lengths, edge["cells"], counted)
            diameters[edge["cells"]] = edge["diameter"]
        first, second, third = (self.mesh.p[:, vertices] for vertices in self.mesh.t)
        (a, b), (c, d) = second - first, third - first
        area = np.abs(a * d - b * c) / 2
        return np.max({1: 1, 2: 3}[self.degree] * (self.lam + 2 * self.mu) * diameters * lengths / area)

    def lagrange(self, s):
        """The edge's basis at s: (..., p + 1)."""
        if self.degree == 1:
            return np.stack([1 - s, s], axis=-1)
        return np.stack([(1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)], axis=-1)

    def pieces(self, P):
        """For each edge the points and weights on [0, 1] where P > 0."""
        t, w = np.polynomial.legendre.leggauss(self.degree + 1)
        for nodal in P.reshape(-1, self.degree + 1):
            roots = np.roots(np.polyfit(self.at, nodal, self.degree)) if np.any(nodal) else []
            roots = [r.real for r in roots if abs(r.imag) == 0 and 0 < r.real < 1]
            cuts = np.array([0, *sorted(roots), 1])
            points, weights = [], []
            for a, b in zip(cuts[:-1], cuts[1:]):
                if self.lagrange(np.array((a + b) / 2)) @ nodal > 0:
                    points += list((a + b) / 2 + (b - a) / 2 * t)
                    weights += list((b - a) / 2 * w)
            yield np.array(points), np.array(weights)

    def contact_terms(self, u):
        """int (1/gamma) [P]+ P0(.), its derivative, and -int (-lambda^h) N_a at the points of each edge."""
        residual, tangent, forces = np.zeros(self.basis.N), sparse.csr_matrix((self.basis.N,) * 2), []
        for edge in self.edges:
            P = edge["P0"] @ u - edge["gap"].ravel()
            k = self.degree + 1
            blocks, pushes = [], np.zeros_like(P)
            for e, (s, w) in enumerate(self.pieces(P)):
                N = self.lagrange(s) if len(s) else np.zeros((0, k))
                factor = edge["length"][e] / edge["gamma"][e]
                start, end = edge["weights"][e]
                blocks.append(factor * (N.T * (w * (start + (end - start) * s))) @ N)
                pushes[e * k : (e + 1) * k] = blocks[-1] @ P[e * k : (e + 1) * k]
            residual += edge["P0"].T @ pushes
            tangent = tangent + edge["P0"].T @ sparse.block_diag(blocks, "csr") @ edge["P0"]
            forces.append(pushes)
        return residual, tangent, forces

    def stress_matrix(self):
        """int gamma s(.) s(.)"""
        k = self.degree + 1
        start, end = np.array([[3, 1], [1, 1]]) / 12, np.array([[1, 1], [1, 3]]) / 12
        total = sparse.csr_matrix((self.basis.N,) * 2)
        for edge in self.edges:
            rows = np.arange(len(edge["length"]))[:, None] * k + np.array([0, k - 1])
            blocks = [g * h * (a * start + b * end) for g, h, (a, b) in zip(edge["gamma"], edge["length"], edge["weights"])]
            S = edge["stress"][rows.ravel()]
            total = total + S.T @ sparse.block_diag(blocks, "csr") @ S
        return total

    def solve(self):
        A = (self.stiffness - self.stress_matrix()).tocsr()
        u, free = self.start.copy(), np.flatnonzero(self.free)

        def residual(u):
            contact, tangent, forces = self.contact_terms(u)
            return A @ u + contact - self.load, tangent, forces

        r, tangent, forces = residual(u)
        for _ in range(100):
            step = np.zeros_like(u)
            step[free] = scipy.sparse.linalg.spsolve((A + tangent)[free][:, free].tocsc(), -r[free])
            t, slope = 1.0, np.linalg.norm(r[free])
            while True:
                after = residual(u + t * step)
                if np.linalg.norm(after[0][free]) < (1 - 1e-4 * t) * slope or t < 1e-3:
                    break
                t /= 2
            u, (r, tangent, forces) = u + t * step, after
            if np.linalg.norm(t * step) <= 1e-14 * np.linalg.norm(u):
                return self.answers(u, r, forces)
        raise SystemExit(f"{self.case.name}, P{self.degree}: Newton's method does not converge")

    def answers(self, u, r, forces):
        answers = {"energy": u @ self.stiffness @ u, "work": self.load @ u}
        answers["max_displacement"] = np.max(np.hypot(u[self.component == 0], u[self.component == 1]))
        for edge, pushes in zip(self.edges, forces):
            pushes = pushes.reshape(edge["x"].shape[1:])
            vectors = -pushes * edge["direction"]
            name = edge["name"]
            answers[f"{name} force"] = np.sum(pushes)
            answers[f"{name} x"], answers[f"{name} y"] = np.sum(vectors, axis=(1, 2))
            answers[f"{name} moment"] = np.sum(edge["x"][0] * vectors[1] - edge["x"][1] * vectors[0])
        for name, demands in self.case.held.items():
            dofs = self.basis.get_dofs(self.curves[name]).all()
            for c in demands:
                own = dofs[self.component[dofs] == c]
                answers[f"{name} reaction {'xy'[c]}"] = np.sum(r[own])
        vertices = self.basis.nodal_dofs
        return answers, {tuple(x): u[vertices[:, v]] for v, x in enumerate(self.mesh.p.T)}


# A body of revolution: a solid cylinder with pressure on its side is pushed on a ball. The loads have the weight r.


class Plug:
    name = "plug"
    held = {"top": {1: lambda x: -0.05 - 0.02 * x[0]}, "axis": {0: lambda x: 0 * x[0]}}
    held_points = {}
    body = {"all": lambda x: [0.02 * x[0] ** 2, -0.05 * x[0]]}
    traction = {"top": lambda x, n: [0.01 * x[0] ** 2, 0 * x[0]], "right": lambda x, n: -0.02 * (1 + x[1]) * x[0] * n}

    @staticmethod
    def on_ball(x):
        d = np.array([0, -2.01])[:, None]
        distance = np.hypot(*(x - d))
        return -(x - d) / distance, distance - 2.0

    contact = {"bottom": on_ball.__func__}


class OfRevolution(Model):
    def __init__(self, n, degree, gamma0, form=elasticity_of_revolution):
        self.n, self.form, self.gamma0 = n, form, gamma0
        super().__init__(Plug, degree)

    def _read(self):
        n = self.n
        place = np.arange(n + 1) / n
        points = np.array([(x, y) for y in place for x in place])
        corner = lambda i, j: j * (n + 1) + i
        triangles = [t for j in range(n) for i in range(n) for t in (
            (corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)), (corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)))]
        self.mesh = skfem.MeshTri(points.T.copy(), np.array(triangles).T.copy())
        sides = {"bottom": lambda x: x[1] == 0, "top": lambda x: x[1] == 1, "right": lambda x: x[0] == 1, "axis": lambda x: x[0] == 0}
        self.curves = {name: self.mesh.facets_satisfying(side) for name, side in sides.items()}
        self.surfaces = {"all": np.arange(self.mesh.t.shape[1])}
        self.lam, self.mu = 1.5 * np.ones(self.mesh.t.shape[1]), np.ones(self.mesh.t.shape[1])

    def _hoop_stress(self, values, gradients, x, lam):
        """lambda v_r / r; on the axis, where v_r = 0, the limit along the edge, which is along r."""
        r = x[0]
        return lam * np.where(r > 0, values[0] / np.where(r > 0, r, 1), gradients[0, 0])

    def _weights(self, x):
        return x[0][:, [0, -1]]

    def _gamma0(self):
        return self.gamma0


def of_revolution(program):
    """How far the two are apart on three meshes; 1 for each order that is too small, and for each control that is not noticed."""
    wrong = 0
    for degree, sizes in ((1, (8, 16, 32)), (2, (4, 8, 16))):
        apart, without = [], None
        for n in sizes:
            file = HERE / "cases" / f"plug-p{degree}-exact.toml"
            rectangle = [f"mesh.rectangle.{key}={value}" for key, value in (("nx", n), ("ny", n), ("diagonal", '"right"'))]
            command = [program, "solve", str(file), "--json", *(part for change in rectangle for part in ("--set", change))]
            result = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
            q = result["quantities"]
            theirs = np.array([q["a_uu"], q["contact_resultant"][1]])
            ours = lambda **options: of_a_radian(OfRevolution(n, degree, result["gamma"]["gamma0"], **options)) * 2 * np.pi
            apart.append(np.abs(ours() / theirs - 1))
            without = np.abs(ours(form=without_hoops) / theirs - 1)
        orders = np.log2(np.array(apart[:-1]) / np.array(apart[1:]))
        found = ", ".join(f"{a:.1e} and {b:.1e}" for a, b in apart)
        print(f"plug, P{degree}: energy and force differ from u_r / r by quadrature by {found}; orders {np.round(orders[-1], 2).tolist()}")
        # The energy norm of the difference is of order p, and these two answers of at least that.
        if not np.all(orders[-1] > degree - 0.1):
            wrong += 1
            print(f"  expected orders of {degree} at least")
        print(f"control: from a body without hoop stresses by {without[0]:.1e} and {without[1]:.1e}")
        if not np.max(without) > 10 * np.max(apart[-1]):
            wrong += 1
    return wrong


def of_a_radian(model):
    answers, _ = model.solve()
    return np.array([answers["energy"], answers["bottom y"]])


class PairModel(Model):
    """The model of two bodies: the functionals are those of both on the stretches between neighbouring nodes of either. The flux is the mean
    of those of the two sides with the weights gamma_1 and gamma_2, or `halves`; with `merged` False the stretches are the first body's edges,
    whatever nodes the second has on them."""

    def __init__(self, case, degree, halves=False, merged=True):
        self.halves, self.merged = halves, merged
        super().__init__(case, degree)

    def _contact(self, element):
        p, along = self.degree, self.case.along
        self.at = np.linspace(0, 1, p + 1)
        direction = np.array([-along[1], along[0]])  # from the first body to the second
        # For each side its facets by where they start and end along the line.
        ends = []
        for name in self.case.pair:
            of_ends = along @ self.mesh.p[:, self.mesh.facets[:, self.curves[name]]].reshape(2, -1)
            of_ends = np.sort(of_ends.reshape(2, -1), axis=0)
            order = np.argsort(of_ends[0])
            ends.append((of_ends[:, order], self.curves[name][order]))
        low, high = max(of[0][0, 0] for of in ends), min(of[0][1, -1] for of in ends)
        nodes = np.concatenate([of[0].ravel() for of in (ends if self.merged else ends[:1])] + [[low, high]])
        nodes = np.sort(nodes[(low - 1e-12 < nodes) & (nodes < high + 1e-12)])
        breaks = nodes[np.insert(np.diff(nodes) > 1e-9, 0, True)]
        start, end = breaks[:-1], breaks[1:]
        foot = self.mesh.p[:, self.mesh.facets[0, self.curves[self.case.pair[0]][0]]]
        x = foot[:, None, None] + along[:, None, None] * (start[:, None] * (1 - self.at) + end[:, None] * self.at - along @ foot)
        shape = (len(start) * (p + 1), self.basis.N)
        value, stresses, gammas = sparse.lil_matrix(shape), [], []
        for sign, (of_ends, facets) in zip((1, -1), ends):
            own = facets[np.searchsorted(of_ends[0], (start + end) / 2) - 1]
            cells = self.mesh.f2t[0, own]
            gammas.append(self._gamma(facets)[cells])
            stress = sparse.lil_matrix(shape)
            mapping = self.basis.mapping
            places = mapping.invF(x, tind=cells)
            lam, mu = self.lam[cells][:, None], self.mu[cells][:, None]
            for i in range(self.basis.Nbfun):
                field = element.gbasis(mapping, places, i, tind=cells)[0]
                v, g = np.array(field.value), np.array(field.grad)
                strain = (g + np.swapaxes(g, 0, 1)) / 2
                sigma = 2 * mu * strain
                sigma[0, 0] += lam * (strain[0, 0] + strain[1, 1])
                sigma[1, 1] += lam * (strain[0, 0] + strain[1, 1])
                s = np.einsum("i,ijeq,j->eq", direction, sigma, direction)
                dofs = np.array(self.basis.element_dofs[i])[cells]
                for e, dof in enumerate(dofs):
                    for q in range(p + 1):
                        value[e * (p + 1) + q, dof] += sign * (direction @ v[:, e, q])
                        stress[e * (p + 1) + q, dof] += s[e, 0] * (1 - self.at[q]) + s[e, -1] * self.at[q]
            stresses.append(stress.tocsr())
        gamma = sum(gammas)
        weights = [np.full(len(gamma), 0.5) if self.halves else part / gamma for part in gammas]
        stress = sum(sparse.diags(np.repeat(weight, p + 1)) @ part for weight, part in zip(weights, stresses))
        value = value.tocsr()
        self.edges = [{"name": self.case.pair[0], "x": x, "direction": np.broadcast_to(direction[:, None, None], x.shape), "gap": self.case.gap(x),
                       "length": end - start, "weights": self._weights(x), "gamma": gamma, "value": value, "stress": stress.tocsr(),
                       "P0": (value - sparse.diags(np.repeat(gamma, p + 1)) @ stress).tocsr()}]

    def _gamma(self, facets):
        """gamma of each triangle: where kappa on it is 1/2."""
        lengths = np.zeros(self.mesh.t.shape[1])
        a, b = (self.mesh.p[:, vertices] for vertices in self.mesh.facets[:, facets])
        np.add.at(lengths, self.mesh.f2t[0, facets], np.hypot(*(b - a)))
        first, second, third = (self.mesh.p[:, vertices] for vertices in self.mesh.t)
        (a, b), (c, d) = second - first, third - first
        area = np.abs(a * d - b * c) / 2
        return 0.5 * area / ({1: 1, 2: 3}[self.degree] * (self.lam + 2 * self.mu) * np.where(lengths > 0, lengths, np.inf))


# The comparison.


def of_result(result, case):
    """The same answers out of a result.json."""
    q = result["quantities"]
    answers = {"energy": q["a_uu"], "work": q["work"], "max_displacement": q["max_displacement"]}
    for boundary in result["contact"]:
        name = boundary["boundary"]
        answers[f"{name} force"], answers[f"{name} moment"] = boundary["force"], boundary["moment"]
        answers[f"{name} x"], answers[f"{name} y"] = boundary["resultant"]
    for name, demands in case.held.items():
        for c in demands:
            answers[f"{name} reaction {'xy'[c]}"] = q["reactions"][name][c]
    return answers, {(x, y): np.array([u, v]) for x, y, u, v in result["probes"]}


def differences(ours, theirs):
    """[(name, difference over its scale)]; the scale of forces is the largest one, of moments that times the arm of the largest moment."""
    (a, u), (b, v) = ours, theirs
    assert a.keys() == b.keys(), sorted(a.keys() ^ b.keys())
    assert v, "no probes"
    kind = {name: name.split()[1] if " " in name else name for name in a}
    forces = max(abs(value) for name, value in b.items() if kind[name] in ("force", "x", "y", "reaction"))
    moments = max(abs(value) for name, value in b.items() if kind[name] == "moment")
    scales = {"energy": b["energy"], "work": max(abs(b["work"]), b["energy"]), "max_displacement": b["max_displacement"], "moment": moments}
    found = [(name, abs(a[name] - b[name]) / scales.get(kind[name], forces)) for name in a]
    places, values = np.array(list(u)), np.array(list(u.values()))
    for place, displacement in v.items():
        nearest = np.argmin(np.hypot(*(places - place).T))
        found.append((f"displacement at {place}", np.max(np.abs(values[nearest] - displacement)) / b["max_displacement"]))
    return found


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    wrong = 0
    for case in (Bimaterial, Lug, Apart):
        for degree in (1, 2):
            own = (PairModel if case is Apart else Model)(case, degree).solve()
            if case is Apart:
                file, stored = HERE / "pairs" / f"apart-p{degree}.toml", {}
            else:
                name = f"{case.name}-p{degree}-exact"
                file = HERE / "cases" / f"{name}.toml"
                stored = {"FEniCSx": json.loads((HERE / "results" / f"{name}.json").read_text())}
            run = subprocess.run([sys.argv[1], "solve", str(file), "--json"], capture_output=True, text=True, check=True)
            ours = {"signorini": json.loads(run.stdout)}
            for program, result in (ours | stored).items():
                found = differences(own, of_result(result, case))
                place, worst = max(found, key=lambda pair: pair[1])
                print(f"{file.stem}: scikit-fem and {program} differ by at most {worst:.1e}, in {len(found)} numbers ({place})")
                if not worst <= TOLERANCE:
                    wrong += 1
                    print(f"  expected at most {TOLERANCE:.0e}")
            if case is Apart:
                # The controls: equal weights, and stretches that do not end where the other body has a node.
                for words, planted in (("equal weights", {"halves": True}), ("one body's edges", {"merged": False})):
                    try:
                        other = PairModel(case, degree, **planted).solve()
                    except SystemExit as error:  # equal weights may not even be coercive
                        print(f"control: with {words}: {error}")
                        continue
                    worst = max(value for _, value in differences(other, of_result(ours["signorini"], case)))
                    print(f"control: with {words} they differ by {worst:.1e}")
                    wrong += not worst > 1e3 * TOLERANCE
    wrong += of_revolution(sys.argv[1])
    # The control: another parameter of the method is another discrete solution.
    model = Model(Bimaterial, 1)
    for edge in model.edges:
        edge["P0"] = (edge["value"] - 1.1 * (edge["value"] - edge["P0"])).tocsr()
        edge["gamma"] = 1.1 * edge["gamma"]
    other = differences(model.solve(), of_result(json.loads((HERE / "results" / "bimaterial-p1-exact.json").read_text()), Bimaterial))
    print(f"control: with 1.1 gamma0 they differ by {max(value for _, value in other):.1e}")
    if not max(value for _, value in other) > 1e3 * TOLERANCE:
        wrong += 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
