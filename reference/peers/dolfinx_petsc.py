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

LAMBDA = MU = 1.0


def sigma(v):
    e = sym(grad(v))
    return LAMBDA * tr(e) * ufl.Identity(2) + 2 * MU * e


def square(n):
    return mesh.create_unit_square(MPI.COMM_SELF, n, n, diagonal=mesh.DiagonalType.right)


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


def run(n, gamma0, solver, clock):
    domain = square(n)
    V = fem.VectorFunctionSpace(domain, ("Lagrange", 1))
    u, v, w = fem.Function(V), ufl.TestFunction(V), ufl.TrialFunction(V)
    x = ufl.SpatialCoordinate(domain)
    top = fem.locate_dofs_geometrical(V, lambda x: np.isclose(x[1], 1))
    clamped = [fem.dirichletbc(np.zeros(2), top, V)]
    floor = np.sort(mesh.locate_entities_boundary(domain, 1, lambda x: np.isclose(x[1], 0)))
    tags = mesh.meshtags(domain, 1, floor, np.full(len(floor), 1, dtype=np.int32))
    ds = ufl.Measure("ds", domain, subdomain_data=tags, metadata={"quadrature_degree": 7})(1)
    gamma = fem.Constant(domain, PETSc.ScalarType(gamma0 * np.sqrt(2) / n))
    normal = ufl.FacetNormal(domain)

    def sigma_n(v):
        return dot(normal, dot(sigma(v), normal))

    def P0(v):
        return dot(v, normal) - gamma * sigma_n(v)

    elastic = inner(sigma(w), sym(grad(v))) * ufl.dx
    positive = ufl.conditional(ufl.gt(P0(u), 0), P0(u), 0)
    slope = ufl.conditional(ufl.gt(P0(u), 0), 1, 0)
    linear = fem.form(elastic)
    body = fem.form((-4 + 10 * x[0]) * v[1] * ufl.dx)
    nitsche = fem.form(-gamma * sigma_n(w) * sigma_n(v) * ds)
    contact = fem.form(positive / gamma * P0(v) * ds)
    contact_slope = fem.form(slope / gamma * P0(w) * P0(v) * ds)
    fixed = clamped[0].dof_indices()[0]

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

    k, f = clock.time("assembly", lambda: (elastic_matrix(), vector(body)))

    def solve_linear():
        x = f.duplicate()
        ksp = direct(k, solver)
        ksp.solve(f, x)
        ksp.destroy()
        x.destroy()

    clock.time("factor", solve_linear)
    k.destroy()

    def solve():
        a, f = elastic_matrix(), vector(body)
        add(a, nitsche)
        tangent = a.copy()
        ksp = direct(tangent, solver)

        def residual(values):
            u.x.array[:] = values
            r = vector(contact)
            ax = f.duplicate()
            a.mult(u.vector, ax)
            return r.array + ax.array - f.array

        def correction(values, r):
            u.x.array[:] = values
            a.copy(tangent, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
            add(tangent, contact_slope)
            right, d = f.duplicate(), f.duplicate()
            right.array[:] = r
            ksp.setOperators(tangent)
            ksp.solve(right, d)
            return d.array

        return newton(residual, correction, np.linalg.norm, np.zeros(f.size))

    u.x.array[:], steps = clock.time("contact", solve)
    return fem.assemble_scalar(fem.form(inner(sigma(u), sym(grad(u))) * ufl.dx)), steps


versions = {"DOLFINx": dolfinx.__version__, "PETSc": ".".join(map(str, PETSc.Sys.getVersion())), "MUMPS": debian("libmumps-5.5"),
            "CHOLMOD": debian("libcholmod3"), "OpenBLAS": debian("libopenblas0-pthread")}
main(["mumps", "cholmod"], versions, run)
