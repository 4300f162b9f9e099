"""python3 -m fenicsx.pair [--check] [NAME ...]

Two bodies by method (8) with one weighted functional: the cases reference/pairs/*.toml, whose results are stored in
reference/results/pairs/NAME.json. With --check nothing is stored, and code 1 says that one differs.

The bodies are the two surfaces of one mesh, and each has a displacement of its own on all of it: what one is outside its body is held at
0. With d the normal of the first body, jump v = d . (v1 - v2), s_i(v) = d . sigma(v_i) d, gamma_i those of the two triangles,

    Gamma = gamma_1 + gamma_2,   s = (gamma_1 s_1 + gamma_2 s_2) / Gamma,   P(v) = jump v - g - Gamma s(v),
    J(v) = 1/2 a(v, v) - 1/2 int Gamma s(v)^2 + 1/2 int q(P(v))^2 / Gamma - L(v),

where q is [.]+ in contact; bonded bodies have vectors in place of d . and q(p) = p. Friction has P_t likewise with t, d turned left, in
place of d ., and no gap: with the bound m it adds to the derivative of J, from which int Gamma s_t^2 / 2 is taken as well,

    int clip(P_t; m) P_t(v) / Gamma,   m = Gamma s for a slip bound s,   m = mu [P]+ for a coefficient mu.

`Joined`: on a mesh that matches a node of the common line has two displacements, as if it were doubled, and UFL has both sides of the line
as sides of one facet. `Apart`: each body has nodes of its own on a straight line, and the integrals there are those of numpy over the
stretches between neighbouring nodes of either, cut at the roots of P.
"""

import argparse
import datetime
import json
import logging
import sys
import tomllib
from pathlib import Path

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI

from . import compat, gmsh, method
from .edges import edge_basis, roots
from .expression import Expression
from .quadrature import gauss
from .store import RESULTS, ROOT, sha256
from .write import text_of

FOLDER = ROOT / "reference" / "pairs"
STORED = RESULTS / "pairs"
COMMAND = "PYTHONPATH=reference python3 -m fenicsx.pair"
TOLERANCE = 1e-11
KAPPA = 0.5
BODIES = ("lower", "upper")
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)


class Pair:
    """A case with a [[pair]] of the bodies "lower" and "upper", and supports on "base" and "top"."""

    def __init__(self, file, kappa=KAPPA):
        self.case = tomllib.loads(file.read_text())
        self.degree = self.case["method"]["degree"]
        self.plane = gmsh.read(file.parent / self.case["mesh"]["gmsh"])
        self.mesh = compat.create_mesh(MPI.COMM_SELF, self.plane.triangles, self.plane.points)
        self.original = np.array(self.mesh.topology.original_cell_index)
        self.materials = [self._lame(self.case["material"][name]) for name in BODIES]
        self._bodies()
        self._facets()
        self.V = compat.space_of_two(self.mesh, self.degree)
        self._held()
        self.u = fem.Function(self.V)
        self._friction()
        clearance = Expression(self.case["pair"][0]["clearance"])
        self.gap = lambda x: clearance.values(x[0], x[1])
        self._body()
        self._contact(kappa)

    def _friction(self):
        """Coefficient and slip bound, one of them 0; `rough` says that there is friction, `share` the part of it that counts: Newton's
        method goes by SHARES."""
        of = self.case["pair"][0].get("friction", {})
        self.rough, self.share = bool(of), fem.Constant(self.mesh, 1.0)
        self.mu, bound = float(of.get("coulomb", 0)), Expression(str(of.get("tresca", 0)))
        self.slip_bound = lambda x: bound.values(x[0], x[1])

    @staticmethod
    def _lame(material):
        young, poisson = material["young"], material["poisson"]
        return young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))

    def _bodies(self):
        """The triangles of each body, as the mesh numbers them, and the functions that are 1 there and 0 elsewhere."""
        space = compat.scalar_space(self.mesh, "DG", 0)
        self.cells, self.chi = [], []
        for name in BODIES:
            self.cells.append(np.flatnonzero(np.isin(self.original, self.plane.surfaces[name])).astype(np.int32))
            chi = fem.Function(space)
            chi.x.array[self.cells[-1]] = 1.0
            self.chi.append(chi)

    def _facets(self):
        """The facets of the named curves, and those between bodies that share them."""
        topology = self.mesh.topology
        topology.create_connectivity(1, 2)
        topology.create_connectivity(2, 1)
        of = topology.connectivity(1, 2)
        body = np.zeros(len(self.original), int)
        body[self.cells[1]] = 1
        between = [f for f in range(topology.index_map(1).size_local) if len(of.links(f)) == 2 and np.ptp(body[of.links(f)]) == 1]
        self.between = np.array(between, np.int32)
        # A facet is known by its middle.
        count = topology.index_map(1).size_local
        middles = mesh.compute_midpoints(self.mesh, 1, np.arange(count, dtype=np.int32))[:, :2]
        known = {tuple(middle): f for f, middle in enumerate(middles.round(9).tolist())}
        facet = lambda pair: known[tuple(np.mean(self.plane.points[pair], axis=0).round(9).tolist())]
        self.curve = {name: np.array([facet(pair) for pair in edges], np.int32) for name, edges in self.plane.boundaries.items()}
        edges = np.vstack([self.plane.triangles[:, pair] for pair in ((0, 1), (1, 2), (2, 0))])
        self.length = {facet(pair): np.linalg.norm(np.subtract(*self.plane.points[pair])) for pair in edges}
        self.of = of

    def _held(self):
        """The degrees of freedom of each component of each body, the free ones, and what is prescribed for the rest."""
        self.dofs, self.places = {}, {}
        supports = {"lower": "base", "upper": "top"}
        free, self.data, self.support = np.zeros(self.V.dofmap.index_map.size_global * self.V.dofmap.index_map_bs, bool), None, {}
        self.data = np.zeros(len(free))
        for i, name in enumerate(BODIES):
            for c in (0, 1):
                sub = self.V.sub(i).sub(c)
                whole, to_parent = sub.collapse()
                to_parent = np.array(to_parent)
                own = np.unique(np.concatenate([whole.dofmap.cell_dofs(cell) for cell in self.cells[i]]))
                self.dofs[name, c] = to_parent[own]
                self.places[name] = whole.tabulate_dof_coordinates()[own, :2]
                free[to_parent[own]] = True
                value = self.case["boundary"][supports[name]]["displacement"][c]
                held = fem.locate_dofs_topological((sub, whole), 1, self.curve[supports[name]])
                places = whole.tabulate_dof_coordinates()[held[1]]
                self.data[held[0]] = Expression(str(value)).values(places[:, 0], places[:, 1])
                self.support[supports[name], c] = np.array(held[0])
        for held in self.support.values():
            free[held] = False
        self.free = np.flatnonzero(free)

    def _gamma(self, kappa, facets):
        """gamma on the triangles at the line: kappa |T| / (c_p (lambda + 2 mu) |E|), the sum over their edges there."""
        space = compat.scalar_space(self.mesh, "DG", 0)
        gamma, lengths = fem.Function(space), np.zeros(len(self.original))
        for f in facets:
            lengths[self.of.links(f)] += self.length[f]
        a, b, c = (self.plane.points[self.plane.triangles[self.original, k]] for k in range(3))
        (p, q), (r, s) = (b - a).T, (c - a).T
        area = np.abs(p * s - q * r) / 2
        for cells, (lam, mu) in zip(self.cells, self.materials):
            near = cells[lengths[cells] > 0]
            gamma.x.array[near] = kappa * area[near] / ({1: 1, 2: 3}[self.degree] * (lam + 2 * mu) * lengths[near])
        return gamma

    def _sigma(self, w, i):
        lam, mu = self.materials[i]
        strain = ufl.sym(ufl.grad(w))
        return lam * ufl.tr(strain) * ufl.Identity(2) + 2 * mu * strain

    def _body(self):
        """The energy of the bodies, and the work of their loads."""
        u, x = ufl.split(self.u), ufl.SpatialCoordinate(self.mesh)
        dx = ufl.Measure("dx", domain=self.mesh, metadata={"quadrature_degree": 10})
        self.elastic = sum(self.chi[i] * ufl.inner(self._sigma(u[i], i), ufl.sym(ufl.grad(u[i]))) / 2 * dx for i in (0, 1))
        body = ufl.as_vector([Expression(str(e)).ufl(x) for e in self.case["load"]["lower"]["body"]])
        self.loaded = self.chi[0] * ufl.dot(body, u[0]) * dx
        self.energy, self.work = fem.form(2 * self.elastic), fem.form(self.loaded)

    def _differentiate(self, J, friction=None):
        # q' is 1 or 0, and UFL differentiates its square as that.
        first = ufl.derivative(J, self.u, ufl.TestFunction(self.V))
        if friction is not None:
            first += friction
        self.first, self.second = fem.form(first), fem.form(ufl.derivative(first, self.u))

    def _residual(self):
        return fem.petsc.assemble_vector(self.first).array.copy()

    def _tangent(self):
        matrix = fem.petsc.assemble_matrix(self.second)
        matrix.assemble()
        start, columns, values = matrix.getValuesCSR()
        return sparse.csr_matrix((values, columns, start))

    def solve(self):
        """The result, to be stored."""
        self.u.x.array[:] = self.data
        for share in SHARES if self.rough else [1.0]:
            self.share.value = share
            r = self._newton()
        return self._result(r)

    def _newton(self):
        """The residual where it is rounding."""
        u, before = self.u.x.array, np.inf
        for _ in range(60):
            r = self._residual()
            size = np.linalg.norm(r[self.free])
            if size < 1e-16 or (size < 1e-12 and not size < before / 2):
                return r
            before, start = size, u[self.free]
            tangent = self._tangent()[self.free][:, self.free]
            step = scipy.sparse.linalg.spsolve(tangent.tocsc(), r[self.free])
            # Whole steps may go to and fro over a kink of friction.
            for share in (1.0, 0.5, 0.25, 0.125) if self.rough and size > 1e-10 else (1.0,):
                u[self.free] = start - share * step
                if np.linalg.norm(self._residual()[self.free]) < size:
                    break
        raise SystemExit("Newton's method does not converge")

    def _result(self, r):
        u, number = self.u.x.array, lambda form: float(fem.assemble_scalar(form))
        displacement = {}
        for name in BODIES:
            rows = np.column_stack((self.places[name], u[self.dofs[name, 0]], u[self.dofs[name, 1]]))
            # In an order that does not depend on rounding.
            displacement[name] = rows[np.lexsort(rows[:, 1::-1].round(9).T)].tolist()
        reactions = {name: [float(np.sum(r[self.support[name, c]])) for c in (0, 1)] for name in ("base", "top")}
        force, resultant, moment, *friction = self._forces()
        found = {"a_uu": number(self.energy), "work": number(self.work), "force": force, "resultant": resultant, "moment": moment,
                 "reactions": reactions, "displacement": displacement}
        return found | {"friction": dict(zip(("sticks", "slides"), friction))} if self.rough else found


class Joined(Pair):
    """[[pair]] surfaces = ["lower", "upper"]: they share the nodes of their common line."""

    def _contact(self, kappa):
        x, u = ufl.SpatialCoordinate(self.mesh), ufl.split(self.u)
        n, gamma = ufl.FacetNormal(self.mesh), self._gamma(kappa, self.between)
        tags = mesh.meshtags(self.mesh, 1, np.sort(self.between), np.ones(len(self.between), np.int32))
        points = self.case["method"]["contact_quadrature"]["gauss"]
        dS = ufl.Measure("dS", domain=self.mesh, subdomain_data=tags, metadata={"quadrature_degree": 2 * points - 1})(1)

        def side(i, value):
            """The value on the side of body i."""
            return self.chi[i]("+") * value("+") + self.chi[i]("-") * value("-")

        d = side(0, n)
        gammas = [side(i, gamma) for i in (0, 1)]
        both = gammas[0] + gammas[1]
        jump = side(0, u[0]) - side(1, u[1])
        stress = sum(g * ufl.dot(side(i, self._sigma(u[i], i)), d) for i, g in enumerate(gammas)) / both
        # The gap at the nodes, linear or quadratic between them.
        gap = fem.Function(compat.scalar_space(self.mesh, "Lagrange", self.degree))
        gap.interpolate(self.gap)
        friction, measures = None, []
        if self.case["pair"][0].get("law", "contact") == "contact":
            P = ufl.dot(jump, d) - gap("+") - both * ufl.dot(stress, d)
            q = ufl.conditional(ufl.gt(P, 0), P, 0) * d
            pulls = stress if self.rough else ufl.dot(stress, d) * d
        else:
            q, pulls = jump - gap("+") * d - both * stress, stress
        J = self.elastic - both * ufl.dot(pulls, pulls) / 2 * dS + ufl.dot(q, q) / (2 * both) * dS - self.loaded
        if self.rough:
            t = ufl.as_vector((-d[1], d[0]))
            P_t = ufl.dot(jump, t) - both * ufl.dot(stress, t)
            bound = fem.Function(compat.scalar_space(self.mesh, "Lagrange", 1))
            bound.interpolate(self.slip_bound)
            m = self.share * (both * bound("+") + self.mu * ufl.dot(q, d))
            clipped = method.clip(P_t, m)
            friction = clipped / both * ufl.derivative(P_t, self.u, ufl.TestFunction(self.V)) * dS
            slides = ufl.conditional(ufl.gt(m, 0), method.side(P_t, m) ** 2, 0)
            measures = ufl.conditional(ufl.gt(m, 0), 1, 0) - slides, slides
            q += clipped * t
        self._differentiate(J, friction)
        force = -q / both
        parts = ufl.dot(q, d) / both, force[0], force[1], x("+")[0] * force[1] - x("+")[1] * force[0], *measures
        self.parts = [fem.form(part * dS) for part in parts]

    def _forces(self):
        force, x, y, moment, *measures = (float(fem.assemble_scalar(part)) for part in self.parts)
        return force, [x, y], moment, *measures


class Apart(Pair):
    """[[pair]] boundaries = ["low", "up"] along one straight line, in contact. With `merged` False the stretches are the edges of the first body,
    whatever nodes the second one has on them."""

    def __init__(self, file, kappa=KAPPA, merged=True):
        self.merged = merged
        super().__init__(file, kappa)

    def _contact(self, kappa):
        self._differentiate(self.elastic - self.loaded)
        names = self.case["pair"][0]["boundaries"]
        corners = self.mesh.geometry.x[compat.cell_vertices(self.mesh)][:, :, :2]
        ends = [np.array([self.plane.points[pair] for pair in self.plane.boundaries[name]]) for name in names]
        foot = ends[0].reshape(-1, 2)[np.argmin(ends[0].reshape(-1, 2)[:, 0])]
        along = ends[0].reshape(-1, 2)[np.argmax(ends[0].reshape(-1, 2)[:, 0])] - foot
        along /= np.linalg.norm(along)
        self.d = np.array([-along[1], along[0]])  # from the lower body to the upper one
        self.t = -along
        sides = [np.sort((line - foot) @ along, axis=1) for line in ends]
        low, high = max(side.min() for side in sides), min(side.max() for side in sides)
        nodes = np.sort(np.concatenate([side.ravel() for side in (sides if self.merged else sides[:1])] + [[low, high]]))
        nodes = nodes[(low - 1e-12 < nodes) & (nodes < high + 1e-12)]
        breaks = nodes[np.insert(np.diff(nodes) > 1e-9, 0, True)]
        p, (start, end) = self.degree, (breaks[:-1], breaks[1:])
        self.at = np.linspace(0, 1, p + 1)
        self.lengths = end - start
        self.x = foot + (start[:, None] + self.lengths[:, None] * self.at)[:, :, None] * along
        gamma = self._gamma(kappa, np.concatenate([self.curve[name] for name in names])).x.array
        shape = (len(start) * (p + 1), len(self.u.x.array))
        directions = [self.d, self.t]
        values, stresses, gammas = [sparse.lil_matrix(shape) for _ in directions], [[sparse.lil_matrix(shape) for _ in BODIES] for _ in directions], []
        for i, name in enumerate(names):
            of = np.array([self.of.links(f)[0] for f in self.curve[name]])
            own = [np.flatnonzero((side[0] < m) & (m < side[1]))[0] for m in (start + end) / 2 for side in [sides[i].T]]
            gammas.append(gamma[of[own]])
            spaces = [self.V.sub(i).sub(c).collapse() for c in (0, 1)]
            lam, mu = self.materials[i]
            for e, cell in enumerate(of[own]):
                a, b, c = corners[cell]
                jacobian = np.column_stack((b - a, c - a))
                phi, gradients = compat.basis(p, np.linalg.solve(jacobian, (self.x[e] - a).T).T)
                gradients = gradients @ np.linalg.inv(jacobian)
                rows = e * (p + 1) + np.arange(p + 1)
                for c, (space, parent) in enumerate(spaces):
                    dofs = np.array(parent)[space.dofmap.cell_dofs(cell)]
                    for direction, value, stress in zip(directions, values, stresses):
                        # direction . sigma d of a displacement along axis c with this gradient
                        s = lam * (direction @ self.d) * gradients[:, :, c]
                        s = s + mu * (direction[c] * (gradients @ self.d) + self.d[c] * (gradients @ direction))
                        # Affine between the ends.
                        s = (1 - self.at)[:, None] * s[0] + self.at[:, None] * s[-1]
                        for k, dof in enumerate(dofs):
                            value[rows, dof] = (1, -1)[i] * direction[c] * phi[:, k]
                            stress[i][rows, dof] = s[:, k]
        self.both = gammas[0] + gammas[1]
        spread = lambda numbers: sparse.diags(np.repeat(numbers, p + 1))
        weighted = [sum(spread(g / self.both) @ s.tocsr() for g, s in zip(gammas, stress)) for stress in stresses]
        self.P0, self.P0_t = (value.tocsr() - spread(self.both) @ stress for value, stress in zip(values, weighted))
        ends = self.slip_bound(np.moveaxis(self.x[:, [0, -1]], 2, 0)) * np.ones((len(start), 2))
        self.s = ends @ [1 - self.at, self.at]
        # int Gamma s s, by Gauss points that are enough for affine s.
        points, weights = gauss(p + 1)
        basis = edge_basis(p, points)
        mass = np.einsum("g,ga,gb->ab", weights, basis, basis)
        blocks = sparse.block_diag([mass * factor for factor in self.both * self.lengths])
        self.pulls = sum(stress.T @ blocks @ stress for stress in (weighted if self.rough else weighted[:1]))

    def _sections(self):
        """Points (stretch, section, point) between the roots of P, and with friction of m and P_t -+ m, their weights, the basis; there P,
        clip(P_t; [m]+), where it sticks, and 1 and -1 where it slides."""
        p, u = self.degree, self.u.x.array
        nodal = (self.P0 @ u).reshape(-1, p + 1) - self.gap(np.moveaxis(self.x, 2, 0))
        across = (self.P0_t @ u).reshape(-1, p + 1)
        bound = float(self.share.value) * (self.both[:, None] * self.s + self.mu * nodal)
        cut_at = [nodal, bound, across - bound, across + bound] if self.rough else [nodal]
        cuts = np.sort(np.column_stack((np.zeros(len(nodal)), *map(roots, cut_at), np.ones(len(nodal)))), axis=1)
        points, weights = gauss(p + 1)
        width = np.diff(cuts, axis=1)[:, :, None]
        s = cuts[:, :-1, None] + width * points
        basis = edge_basis(p, s)
        P, P_t, m = (np.einsum("esgk,ek->esg", basis, values) for values in (nodal, across, bound))
        if not self.rough:
            m = 0 * m
        slides = np.where(m > 0, np.sign(P_t) * (np.abs(P_t) > m), 0)
        sticks = (m > 0) & (slides == 0)
        return s, weights * width * self.lengths[:, None, None], basis, P, np.where(sticks, P_t, slides * m), sticks, slides

    def _residual(self):
        _, w, basis, P, clipped, *_ = self._sections()
        q, f = (np.einsum("esg,esg,esgk->ek", w, values, basis) / self.both[:, None] for values in (np.maximum(P, 0), clipped))
        return super()._residual() - self.pulls @ self.u.x.array + self.P0.T @ q.ravel() + self.P0_t.T @ f.ravel()

    def _tangent(self):
        _, w, basis, P, _, sticks, slides = self._sections()
        mass = lambda where: sparse.block_diag(np.einsum("esg,esg,esgk,esgl->ekl", w, where, basis, basis) / self.both[:, None, None])
        found = super()._tangent() - self.pulls + self.P0.T @ mass((P > 0).astype(float)) @ self.P0
        if self.rough:
            mu = float(self.share.value) * self.mu
            found = found + self.P0_t.T @ (mass(sticks.astype(float)) @ self.P0_t + mass(mu * slides) @ self.P0)
        return found

    def _forces(self):
        s, w, _, P, clipped, sticks, slides = self._sections()
        pressure, shear = (w * values / self.both[:, None, None] for values in (np.maximum(P, 0), clipped))
        vectors = -pressure[..., None] * self.d - shear[..., None] * self.t
        x = self.x[:, 0, None, None] + s[..., None] * (self.x[:, -1] - self.x[:, 0])[:, None, None]
        moment = np.sum(x[..., 0] * vectors[..., 1] - x[..., 1] * vectors[..., 0])
        force = vectors.sum(axis=(0, 1, 2))
        return float(pressure.sum()), force.tolist(), float(moment), float(np.sum(w * sticks)), float(np.sum(w * np.abs(slides)))


def model(file):
    """The class that solves a case."""
    return Apart if "boundaries" in tomllib.loads(file.read_text())["pair"][0] else Joined


def cases():
    return {file.stem: file for file in sorted(FOLDER.glob("*.toml"))}


def fresh(file):
    mesh_file = file.parent / tomllib.loads(file.read_text())["mesh"]["gmsh"]
    provenance = {"versions": compat.versions(), "case": file.relative_to(ROOT).as_posix(), "case_sha256": sha256(file),
                  "mesh_sha256": sha256(mesh_file), "command": COMMAND, "date": datetime.date.today().isoformat()}
    return model(file)(file).solve() | {"provenance": provenance}


def difference(a, b):
    """The largest difference of two results, forces relative to the force, displacements to the largest one, energies to a(u, u), lengths
    that stick or slide to their sum."""
    u, v = (np.concatenate([np.array(result["displacement"][name]) for name in BODIES]) for result in (a, b))
    if u.shape != v.shape:
        return float("inf")
    forces = [np.array([result["force"], *result["resultant"], result["moment"], *result["reactions"]["base"], *result["reactions"]["top"]])
              for result in (a, b)]
    if ("friction" in a) != ("friction" in b):
        return float("inf")
    lengths = [np.array([result["friction"][key] for key in ("sticks", "slides")] if "friction" in a else [1.0]) for result in (a, b)]
    energies = [np.array([result["a_uu"], result["work"]]) for result in (a, b)]
    return float(max(np.max(np.abs(forces[0] - forces[1])) / np.max(np.abs(forces[0])), np.max(np.abs(lengths[0] - lengths[1])) / lengths[0].sum(),
                     np.max(np.abs(energies[0] - energies[1])) / energies[0][0], np.max(np.abs(u - v)) / np.max(np.abs(u[:, 2:]))))


def check(name, file):
    """What is wrong with a stored result, or nothing."""
    stored = STORED / f"{name}.json"
    if not stored.exists():
        return f"{name}: not stored"
    old = json.loads(stored.read_text())
    if old["provenance"]["case_sha256"] != sha256(file):
        return f"{name}: {old['provenance']['case']} has changed since its result was stored"
    off = difference(old, fresh(file))
    return None if off <= TOLERANCE else f"{name}: differs by {off:.1e}, expected at most {TOLERANCE:.0e}"


def main():
    parser = argparse.ArgumentParser(prog="python3 -m fenicsx.pair", description="Stores or checks the reference results of pairs.")
    parser.add_argument("--check", action="store_true", help="compare with the stored results, store nothing")
    parser.add_argument("names", nargs="*", metavar="NAME", help="case names; default: all")
    options = parser.parse_args()
    logging.disable(logging.INFO)
    known = cases()
    unknown = [name for name in options.names if name not in known]
    if unknown:
        parser.error(f"unknown case {unknown[0]!r}; known: {', '.join(known)}")
    names = options.names or list(known)
    if options.check:
        wrong = [line for line in (check(name, known[name]) for name in names) if line]
        if not options.names:
            wrong += [f"{file.stem}: stored, and no such case" for file in sorted(STORED.glob("*.json")) if file.stem not in known]
        print("\n".join(wrong) or f"{len(names)} stored results of pairs agree with fresh ones to {TOLERANCE:.0e}")
        return 1 if wrong else 0
    STORED.mkdir(exist_ok=True)
    for name in names:
        (STORED / f"{name}.json").write_text(text_of(fresh(known[name])))
        print(f"stored {name}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
