"""Method (8) for a body of revolution: all integrals with the weight r, and a hoop strain theta(v), the projection of v_r / r (docs/theory.md, 11).

theta(v) in DG of degree p - 1 has int r theta(v) q = int v_r q for all q there. UFL has the forms in v and theta as if they were independent;
the matrix of v alone follows by elimination, triangle by triangle. So it is on one process.
"""

import scipy.sparse as sparse
import scipy.sparse.linalg
import ufl
from dolfinx import fem
from petsc4py import PETSc
from ufl import dx, inner, tr

from . import compat
from .method import Method


class MethodOfRevolution(Method):
    def __init__(self, problem, gamma0):
        problem.refuse("body.plane: found \"axisymmetric\" on several processes, expected one" if problem.comm.size > 1 else None)
        Q = compat.scalar_space(problem.mesh, "DG", problem.case.degree - 1)
        self.theta = fem.Function(Q)
        super().__init__(problem, gamma0)
        r = ufl.SpatialCoordinate(problem.mesh)[0]
        lam, mu = self.law
        v, w, q, t = ufl.TestFunction(problem.V), ufl.TrialFunction(problem.V), ufl.TestFunction(Q), ufl.TrialFunction(Q)
        in_meridian = r * inner(super().sigma(w), self.eps(v)) * dx
        self.in_meridian = fem.form(in_meridian)
        self.hoop_strain = sparse.linalg.spsolve(matrix_of(r * t * q * dx).tocsc(), matrix_of(w[0] * q * dx).tocsc())
        hoop = matrix_of(r * lam * t * tr(self.eps(v)) * dx) @ self.hoop_strain
        along = matrix_of(r * (lam + 2 * mu) * t * q * dx)
        K = matrix_of(in_meridian) + hoop + hoop.T + self.hoop_strain.T @ along @ self.hoop_strain
        self.K = K.tocsr()

    def set(self, owned):
        super().set(owned)
        if hasattr(self, "hoop_strain"):
            self.theta.x.array[:] = self.hoop_strain @ owned

    def sigma(self, v):
        """The stress in the meridian, of the current iterate with its hoop strain."""
        hoop = self.law[0] * self.theta * ufl.Identity(2) if v is self.u else 0 * ufl.Identity(2)
        return super().sigma(v) + hoop

    def sigma_zz(self, v):
        """The hoop stress of the current iterate."""
        lam, mu = self.law
        return lam * (tr(self.eps(v)) + self.theta) + 2 * mu * self.theta

    def functional(self):
        u = self.u.x.array
        return self.linear_functional() + self.edges.functional(u)

    def linear_functional(self):
        u = self.u.x.array
        return self.K @ u + self.edges.stress_functional(u)

    def tangent(self, everywhere=False):
        matrix = fem.petsc.assemble_matrix(self.in_meridian)
        matrix.assemble()
        matrix.zeroEntries()
        matrix.setValuesCSR(self.K.indptr.astype(PETSc.IntType), self.K.indices.astype(PETSc.IntType), self.K.data)
        matrix.assemble()
        for dofs, block in self.edges.tangent(self.u.x.array, everywhere):
            matrix.setValuesLocal(dofs, dofs, block, addv=PETSc.InsertMode.ADD)
        for dofs, block in zip(self.edges.dofs, self.edges.stress_blocks()):
            matrix.setValuesLocal(dofs, dofs, block, addv=PETSc.InsertMode.ADD)
        matrix.assemble()
        return matrix

    def energy(self):
        u = self.u.x.array
        return float(u @ (self.K @ u))


def matrix_of(form):
    """The matrix of a bilinear form as SciPy has one."""
    matrix = fem.petsc.assemble_matrix(fem.form(form))
    matrix.assemble()
    rows, columns, values = matrix.getValuesCSR()
    found = sparse.csr_matrix((values, columns, rows), shape=matrix.getSize())
    matrix.destroy()
    return found
