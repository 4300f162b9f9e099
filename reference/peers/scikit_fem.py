"""scikit-fem with SuperLU (its default) or CHOLMOD. See common.py."""

import numpy as np
import scipy
import scipy.sparse.linalg
import skfem
import sksparse
from skfem.helpers import ddot, sym_grad, trace
from sksparse.cholmod import cholesky

from common import debian, main, newton

LAMBDA = MU = 1.0


def sigma_n(w):
    """n . sigma n with n = (0, -1)"""
    return LAMBDA * trace(w.grad) + 2 * MU * w.grad[1, 1]


@skfem.BilinearForm
def elasticity(u, v, w):
    e, d = sym_grad(u), sym_grad(v)
    return LAMBDA * trace(e) * trace(d) + 2 * MU * ddot(e, d)


@skfem.LinearForm
def load(v, w):
    return (-4 + 10 * w.x[0]) * v[1]


@skfem.BilinearForm
def nitsche(u, v, w):
    return -w.gamma * sigma_n(u) * sigma_n(v)


@skfem.LinearForm
def contact(v, w):
    p = -w.u[1] - w.gamma * sigma_n(w.u)
    return np.maximum(p, 0) / w.gamma * (-v[1] - w.gamma * sigma_n(v))


@skfem.BilinearForm
def contact_slope(u, v, w):
    p = -w.u[1] - w.gamma * sigma_n(w.u)
    return (p > 0) / w.gamma * (-u[1] - w.gamma * sigma_n(u)) * (-v[1] - w.gamma * sigma_n(v))


class SuperLU:
    """Minimum degree of A + A', the ordering for symmetric patterns, and pivots on the diagonal: faster than its default."""

    def solve(self, matrix, right):
        options = {"SymmetricMode": True, "DiagPivotThresh": 0.001}
        return scipy.sparse.linalg.splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", options=options).solve(right)


class Cholmod:
    def __init__(self):
        self.factor = None

    def solve(self, matrix, right):
        matrix = matrix.tocsc()
        if self.factor is None:
            self.factor = cholesky(matrix, mode="supernodal")
        else:
            self.factor.cholesky_inplace(matrix)
        return self.factor(right)


def run(n, gamma0, solver, clock):
    x = np.linspace(0, 1, n + 1)
    points = np.stack([np.tile(x, n + 1), np.repeat(x, n + 1)])
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    triangles = np.hstack([np.stack([a, a + 1, a + n + 2]), np.stack([a, a + n + 1, a + n + 2])])
    mesh = skfem.MeshTri(points, triangles)
    element = skfem.ElementVector(skfem.ElementTriP1())
    basis = skfem.Basis(mesh, element)
    floor = skfem.FacetBasis(mesh, element, facets=mesh.facets_satisfying(lambda x: x[1] == 0), intorder=7)
    free = basis.complement_dofs(basis.get_dofs(lambda x: x[1] == 1))
    gamma = gamma0 * np.sqrt(2) / n
    make = {"superlu": SuperLU, "cholmod": Cholmod}[solver]

    def inner(matrix):
        return matrix[free][:, free]

    k, f = clock.time("assembly", lambda: (elasticity.assemble(basis), load.assemble(basis)))
    clock.time("factor", lambda: make().solve(inner(k), f[free]))

    def solve():
        k, f = elasticity.assemble(basis), load.assemble(basis)
        a = k + nitsche.assemble(floor, gamma=gamma)
        constant, algebra = inner(a), make()

        def full(u):
            field = np.zeros(basis.N)
            field[free] = u
            return field

        def residual(u):
            u = full(u)
            return (a @ u + contact.assemble(floor, u=floor.interpolate(u), gamma=gamma) - f)[free]

        def correction(u, r):
            slope = contact_slope.assemble(floor, u=floor.interpolate(full(u)), gamma=gamma)
            return algebra.solve(constant + inner(slope), r)

        u, steps = newton(residual, correction, np.linalg.norm, np.zeros(len(free)))
        return full(u), steps

    u, steps = clock.time("contact", solve)
    return u @ (k @ u), steps


versions = {"scikit-fem": skfem.__version__, "SciPy": scipy.__version__, "NumPy": np.__version__, "scikit-sparse": sksparse.__version__,
            "CHOLMOD": debian("libcholmod3"), "OpenBLAS": debian("libopenblas0-pthread")}
main(["superlu", "cholmod"], versions, run)
