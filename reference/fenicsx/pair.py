"""python3 -m fenicsx.pair [--check] [NAME ...]

Two bodies on a mesh that matches, by method (8) with one weighted functional on their common line: the cases reference/pairs/joined-*.toml,
whose results are stored in reference/results/pairs/NAME.json. With --check nothing is stored, and code 1 says that one differs.

The bodies are the two surfaces of one mesh, and each has a displacement of its own on all of it: what one is outside its body is held at
0. Then a node of the common line has two displacements, as if it were doubled, and UFL has both sides of the line as sides of one facet.
With d the normal of the first body, jump v = d . (v1 - v2), s_i(v) = d . sigma(v_i) d, gamma_i those of the two triangles,

    Gamma = gamma_1 + gamma_2,   s = (gamma_1 s_1 + gamma_2 s_2) / Gamma,   P(v) = jump v - g - Gamma s(v),
    J(v) = 1/2 a(v, v) - 1/2 int Gamma s(v)^2 + 1/2 int q(P(v))^2 / Gamma - L(v),

where q is [.]+ in contact; bonded bodies have vectors in place of d . and q(p) = p.
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

from . import compat, gmsh
from .expression import Expression
from .store import RESULTS, ROOT, sha256
from .write import text_of

FOLDER = ROOT / "reference" / "pairs"
STORED = RESULTS / "pairs"
COMMAND = "PYTHONPATH=reference python3 -m fenicsx.pair"
TOLERANCE = 1e-11
KAPPA = 0.5
BODIES = ("lower", "upper")


class Pair:
    """A case with [[pair]] surfaces = ["lower", "upper"] and supports on "base" and "top"."""

    def __init__(self, file, kappa=KAPPA):
        self.case = tomllib.loads(file.read_text())
        self.degree = self.case["method"]["degree"]
        self.plane = gmsh.read(file.parent / self.case["mesh"]["gmsh"])
        self.mesh = compat.create_mesh(MPI.COMM_SELF, self.plane.triangles, self.plane.points)
        self.original = np.array(self.mesh.topology.original_cell_index)
        self.materials = [self._lame(self.case["material"][name]) for name in BODIES]
        self._bodies()
        self._facets()
        element = ufl.VectorElement("Lagrange", self.mesh.ufl_cell(), self.degree)
        self.V = fem.FunctionSpace(self.mesh, ufl.MixedElement(element, element))
        self._held()
        self._forms(kappa)

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
        """The facets between the bodies, and those of the named curves."""
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

    def _gamma(self, kappa):
        """gamma on the triangles at the line: kappa |T| / (c_p (lambda + 2 mu) |E|), the sum over their edges there."""
        space = compat.scalar_space(self.mesh, "DG", 0)
        gamma, lengths = fem.Function(space), np.zeros(len(self.original))
        for f in self.between:
            lengths[self.of.links(f)] += self.length[f]
        a, b, c = (self.plane.points[self.plane.triangles[self.original, k]] for k in range(3))
        area = np.abs(np.cross(b - a, c - a)) / 2
        for cells, (lam, mu) in zip(self.cells, self.materials):
            near = cells[lengths[cells] > 0]
            gamma.x.array[near] = kappa * area[near] / ({1: 1, 2: 3}[self.degree] * (lam + 2 * mu) * lengths[near])
        return gamma

    def _forms(self, kappa):
        self.u = fem.Function(self.V)
        v, x = ufl.TestFunction(self.V), ufl.SpatialCoordinate(self.mesh)
        u = ufl.split(self.u)
        n, gamma = ufl.FacetNormal(self.mesh), self._gamma(kappa)
        tags = mesh.meshtags(self.mesh, 1, np.sort(self.between), np.ones(len(self.between), np.int32))
        points = self.case["method"]["contact_quadrature"]["gauss"]
        dS = ufl.Measure("dS", domain=self.mesh, subdomain_data=tags, metadata={"quadrature_degree": 2 * points - 1})(1)
        dx = ufl.Measure("dx", domain=self.mesh, metadata={"quadrature_degree": 10})

        def sigma(w, i):
            lam, mu = self.materials[i]
            strain = ufl.sym(ufl.grad(w))
            return lam * ufl.tr(strain) * ufl.Identity(2) + 2 * mu * strain

        def side(i, value):
            """The value on the side of body i."""
            return self.chi[i]("+") * value("+") + self.chi[i]("-") * value("-")

        d = side(0, n)
        gammas = [side(i, gamma) for i in (0, 1)]
        both = gammas[0] + gammas[1]
        jump = side(0, u[0]) - side(1, u[1])
        stress = sum(g * ufl.dot(side(i, sigma(u[i], i)), d) for i, g in enumerate(gammas)) / both
        # The gap at the nodes, linear or quadratic between them.
        gap = fem.Function(compat.scalar_space(self.mesh, "Lagrange", self.degree))
        clearance = Expression(self.case["pair"][0]["clearance"])
        gap.interpolate(lambda x: clearance.values(x[0], x[1]))
        energy = sum(self.chi[i] * ufl.inner(sigma(u[i], i), ufl.sym(ufl.grad(u[i]))) / 2 * dx for i in (0, 1))
        body = ufl.as_vector([Expression(str(e)).ufl(x) for e in self.case["load"]["lower"]["body"]])
        work = self.chi[0] * ufl.dot(body, u[0]) * dx
        if self.case["pair"][0]["law"] == "contact":
            P = ufl.dot(jump, d) - gap("+") - both * ufl.dot(stress, d)
            q = ufl.conditional(ufl.gt(P, 0), P, 0) * d
            pulls = ufl.dot(stress, d) * d
        else:
            q, pulls = jump - gap("+") * d - both * stress, stress
        J = energy - both * ufl.dot(pulls, pulls) / 2 * dS + ufl.dot(q, q) / (2 * both) * dS - work
        # q' is 1 or 0, and UFL differentiates its square as that.
        residual = ufl.derivative(J, self.u, v)
        self.residual, self.tangent = fem.form(residual), fem.form(ufl.derivative(residual, self.u))
        self.energy, self.work = fem.form(2 * energy), fem.form(work)
        force = -q / both
        self.force = [fem.form(force[c] * dS) for c in (0, 1)]
        self.normal_force = fem.form(ufl.dot(q, d) / both * dS)
        self.moment = fem.form((x("+")[0] * force[1] - x("+")[1] * force[0]) * dS)

    def solve(self):
        """The result, to be stored."""
        u = self.u.x.array
        u[:] = self.data
        before = np.inf
        for _ in range(60):
            r = fem.petsc.assemble_vector(self.residual).array.copy()
            size = np.linalg.norm(r[self.free])
            if size < 1e-16 or (size < 1e-12 and not size < before / 2):
                return self._result(r)
            before = size
            matrix = fem.petsc.assemble_matrix(self.tangent)
            matrix.assemble()
            start, columns, values = matrix.getValuesCSR()
            tangent = sparse.csr_matrix((values, columns, start))[self.free][:, self.free]
            u[self.free] -= scipy.sparse.linalg.spsolve(tangent.tocsc(), r[self.free])
        raise SystemExit("Newton's method does not converge")

    def _result(self, r):
        u, number = self.u.x.array, lambda form: float(fem.assemble_scalar(form))
        displacement = {}
        for name in BODIES:
            rows = np.column_stack((self.places[name], u[self.dofs[name, 0]], u[self.dofs[name, 1]]))
            displacement[name] = rows[np.lexsort((rows[:, 1], rows[:, 0]))].tolist()
        reactions = {name: [float(np.sum(r[self.support[name, c]])) for c in (0, 1)] for name in ("base", "top")}
        return {"a_uu": number(self.energy), "work": number(self.work), "force": number(self.normal_force),
                "resultant": [number(form) for form in self.force], "moment": number(self.moment), "reactions": reactions,
                "displacement": displacement}


def cases():
    return {file.stem: file for file in sorted(FOLDER.glob("joined-*.toml"))}


def fresh(file):
    mesh_file = file.parent / tomllib.loads(file.read_text())["mesh"]["gmsh"]
    provenance = {"versions": compat.versions(), "case": file.relative_to(ROOT).as_posix(), "case_sha256": sha256(file),
                  "mesh_sha256": sha256(mesh_file), "command": COMMAND, "date": datetime.date.today().isoformat()}
    return Pair(file).solve() | {"provenance": provenance}


def difference(a, b):
    """The largest difference of two results, forces relative to the force, displacements to the largest one, energies to a(u, u)."""
    u, v = (np.concatenate([np.array(result["displacement"][name]) for name in BODIES]) for result in (a, b))
    if u.shape != v.shape:
        return float("inf")
    forces = [np.array([result["force"], *result["resultant"], result["moment"], *result["reactions"]["base"], *result["reactions"]["top"]])
              for result in (a, b)]
    energies = [np.array([result["a_uu"], result["work"]]) for result in (a, b)]
    return float(max(np.max(np.abs(forces[0] - forces[1])) / np.max(np.abs(forces[0])),
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
