"""scikit-fem with SuperLU (its default) or CHOLMOD. See common.py."""

import numpy as np
import scipy
import scipy.sparse.linalg
import skfem
import sksparse
from skfem.helpers import ddot, sym_grad, trace
from sksparse.cholmod import cholesky

from common import debian, main, newton


def sigma_n(v, w):
    """d . sigma n with d = (0, -1)"""
    shear = w.mu * (v.grad[0, 1] + v.grad[1, 0])
    return -(shear * w.n[0] + (w["lambda"] * trace(v.grad) + 2 * w.mu * v.grad[1, 1]) * w.n[1])


def P0(v, w):
    return -v[1] - w.gamma * sigma_n(v, w)


def P(w):
    return P0(w.u, w) - (w.x[1] - w.level)


@skfem.BilinearForm
def elasticity(u, v, w):
    e, d = sym_grad(u), sym_grad(v)
    return w["lambda"] * trace(e) * trace(d) + 2 * w.mu * ddot(e, d)


@skfem.LinearForm
def load(v, w):
    return (w.a + w.b * w.x[0]) * v[1]


@skfem.BilinearForm
def nitsche(u, v, w):
    return -w.gamma * sigma_n(u, w) * sigma_n(v, w)


@skfem.LinearForm
def contact(v, w):
    return np.maximum(P(w), 0) / w.gamma * P0(v, w)


@skfem.BilinearForm
def contact_slope(u, v, w):
    return (P(w) > 0) / w.gamma * P0(u, w) * P0(v, w)


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


def facets_of(mesh, edges):
    """The numbers of these edges in the mesh."""

    def key(pairs):
        return pairs.min(axis=0).astype(np.int64) * mesh.p.shape[1] + pairs.max(axis=0)

    all_keys = key(mesh.facets)
    order = np.argsort(all_keys)
    return np.sort(order[np.searchsorted(all_keys[order], key(edges.T))])


def run(body, gamma0, solver, clock):
    mesh = skfem.MeshTri(body.vertices.T.copy(), body.triangles.T.copy())
    element = skfem.ElementVector(skfem.ElementTriP1())
    basis = skfem.Basis(mesh, element)
    floor = skfem.FacetBasis(mesh, element, facets=facets_of(mesh, body.floor), intorder=7)
    held = basis.get_dofs(facets_of(mesh, body.held))
    free = basis.complement_dofs(held)
    lift = basis.zeros()
    for component, value in zip(("u^1", "u^2"), body.prescribed):
        lift[held.all(component)] = value
    gamma = np.broadcast_to(gamma0 * body.h[mesh.f2t[0, floor.find]][:, None], floor.dx.shape)
    moduli = {"lambda": getattr(body, "lambda"), "mu": body.mu}
    contact_data = {**moduli, "gamma": gamma, "level": body.level}
    a, b = body.force
    make = {"superlu": SuperLU, "cholmod": Cholmod}[solver]

    def inner(matrix):
        return matrix[free][:, free]

    def assembled():
        return elasticity.assemble(basis, **moduli), load.assemble(basis, a=a, b=b)

    k, f = clock.time("assembly", assembled)
    clock.time("factor", lambda: make().solve(inner(k), f[free]))

    def solve():
        k, f = assembled()
        a = k + nitsche.assemble(floor, **contact_data)
        constant, algebra = inner(a), make()

        def full(u):
            field = lift.copy()
            field[free] = u
            return field

        def residual(u):
            u = full(u)
            return (a @ u + contact.assemble(floor, u=floor.interpolate(u), **contact_data) - f)[free]

        def correction(u, r):
            slope = contact_slope.assemble(floor, u=floor.interpolate(full(u)), **contact_data)
            return algebra.solve(constant + inner(slope), r)

        u, steps = newton(residual, correction, np.linalg.norm, np.zeros(len(free)))
        return full(u), steps

    u, steps = clock.time("contact", solve)
    return u @ (k @ u), steps


versions = {"scikit-fem": skfem.__version__, "SciPy": scipy.__version__, "NumPy": np.__version__, "scikit-sparse": sksparse.__version__,
            "CHOLMOD": debian("libcholmod3"), "OpenBLAS": debian("libopenblas0-pthread")}
main(["superlu", "cholmod"], versions, run)
