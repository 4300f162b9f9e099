"""DOLFINx with PETSc's direct solvers: MUMPS (Cholesky) or CHOLMOD. See common.py."""

import dolfinx
import dolfinx.fem.petsc
import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc
from ufl import dot, grad, inner, sym, tr

from common import debian, main, newton


def meshed(body):
    """The mesh, tags 1 on the floor and 2 on what is held, and h of each triangle as it is numbered here."""
    cell = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.triangle, 1))
    domain = mesh.create_mesh(MPI.COMM_SELF, body.triangles, body.vertices, cell)
    domain.topology.create_connectivity(1, 2)
    facets = np.array(mesh.exterior_facet_indices(domain.topology), dtype=np.int32)
    nodes = np.array(dolfinx.cpp.mesh.entities_to_geometry(domain._mesh, 1, facets, False))
    ends = np.sort(np.array(domain.geometry.input_global_indices)[nodes], axis=1)
    named = {tuple(sorted(edge)): tag for tag, edges in ((1, body.floor), (2, body.held)) for edge in edges.tolist()}
    tags = np.array([named.get(tuple(pair), 0) for pair in ends.tolist()], dtype=np.int32)
    order = np.argsort(facets)
    return domain, mesh.meshtags(domain, 1, facets[order], tags[order]), body.h[domain.topology.original_cell_index]


def direct(matrix, solver):
    """A Cholesky factorisation by `solver`; PETSc keeps the analysis for matrices of the same pattern."""
    matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    ksp = PETSc.KSP().create(MPI.COMM_SELF)
    ksp.setType("preonly")
    ksp.getPC().setType("cholesky")
    ksp.getPC().setFactorSolverType(solver)
    ksp.setOperators(matrix)
    return ksp


def run(body, gamma0, solver, clock):
    domain, tags, h = meshed(body)
    V = fem.VectorFunctionSpace(domain, ("Lagrange", body.degree))
    u, v, w = fem.Function(V), ufl.TestFunction(V), ufl.TrialFunction(V)
    x = ufl.SpatialCoordinate(domain)
    top = fem.locate_dofs_topological(V, 1, tags.find(2))
    clamped = [fem.dirichletbc(np.array(body.prescribed), top, V)]
    ds = ufl.Measure("ds", domain, subdomain_data=tags, metadata={"quadrature_degree": 7})(1)
    gamma = fem.Function(fem.FunctionSpace(domain, ("DG", 0)))
    gamma.x.array[:] = gamma0 * h
    n, d = ufl.FacetNormal(domain), ufl.as_vector([0, -1])
    numbers = [getattr(body, "lambda"), body.mu, *body.force, body.level]
    lam, mu, a, b, level = (fem.Constant(domain, PETSc.ScalarType(number)) for number in numbers)

    def sigma(v):
        e = sym(grad(v))
        return lam * tr(e) * ufl.Identity(2) + 2 * mu * e

    def sigma_n(v):
        return dot(d, dot(sigma(v), n))

    def P0(v):
        return dot(v, d) - gamma * sigma_n(v)

    P = P0(u) - (x[1] - level)
    elastic = inner(sigma(w), sym(grad(v))) * ufl.dx
    positive = ufl.conditional(ufl.gt(P, 0), P, 0)
    slope = ufl.conditional(ufl.gt(P, 0), 1, 0)
    linear = fem.form(elastic)
    force = fem.form((a + b * x[0]) * v[1] * ufl.dx)
    nitsche = fem.form(-gamma * sigma_n(w) * sigma_n(v) * ds)
    contact = fem.form(positive / gamma * P0(v) * ds)
    contact_slope = fem.form(slope / gamma * P0(w) * P0(v) * ds)
    fixed = clamped[0].dof_indices()[0]
    lift = fem.Function(V)
    fem.petsc.set_bc(lift.vector, clamped)

    def vector(form):
        r = fem.petsc.assemble_vector(form)
        r.array[fixed] = 0
        return r

    def add(k, form):
        # It adds, but for the diagonal of clamped rows, which it sets to 1.
        fem.petsc.assemble_matrix(k, form, bcs=clamped)
        k.assemble()

    def elastic_matrix():
        k = fem.petsc.create_matrix(linear)
        add(k, linear)
        return k

    k, f = clock.time("assembly", lambda: (elastic_matrix(), vector(force)))

    def solve_linear():
        x = f.duplicate()
        ksp = direct(k, solver)
        ksp.solve(f, x)
        ksp.destroy()
        x.destroy()

    clock.time("factor", solve_linear)
    k.destroy()

    def solve():
        a, f = elastic_matrix(), vector(force)
        add(a, nitsche)
        if any(body.prescribed):
            fem.petsc.apply_lifting(f, [linear, nitsche], [clamped, clamped])
            f.array[fixed] = 0
        tangent = a.copy()
        ksp = direct(tangent, solver)

        def residual(values):
            u.x.array[:] = values
            r = vector(contact)
            ax = f.duplicate()
            a.mult(u.vector, ax)
            r = r.array + ax.array - f.array
            r[fixed] = 0
            return r

        def correction(values, r):
            u.x.array[:] = values
            a.copy(tangent, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
            add(tangent, contact_slope)
            right, d = f.duplicate(), f.duplicate()
            right.array[:] = r
            ksp.setOperators(tangent)
            ksp.solve(right, d)
            return d.array

        return newton(residual, correction, np.linalg.norm, lift.vector.array.copy())

    u.x.array[:], steps = clock.time("contact", solve)
    return fem.assemble_scalar(fem.form(inner(sigma(u), sym(grad(u))) * ufl.dx)), steps


versions = {"DOLFINx": dolfinx.__version__, "PETSc": ".".join(map(str, PETSc.Sys.getVersion())), "MUMPS": debian("libmumps-5.5"),
            "CHOLMOD": debian("libcholmod3"), "OpenBLAS": debian("libopenblas0-pthread")}
main(["mumps", "cholmod"], versions, run)
