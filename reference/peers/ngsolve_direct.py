"""NGSolve with its own sparse Cholesky factorisation. See common.py."""

import ngsolve as ng
import numpy as np
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, IntegrationRule, LinearForm, Sym, Trace, VectorH1, ds, dx
from ngsolve.meshes import MakeStructured2DMesh

from common import main, newton

LAMBDA = MU = 1.0


def run(n, gamma0, solver, clock):
    mesh = MakeStructured2DMesh(quads=False, nx=n, ny=n, flip_triangles=True)
    V = VectorH1(mesh, order=1, dirichlet="top")
    u, v = V.TnT()
    state = GridFunction(V)
    gamma = gamma0 * np.sqrt(2) / n
    # Volume gradients on the edge need skeleton; degree 7 is 4 Gauss points.
    floor = ds(skeleton=True, definedon=mesh.Boundaries("bottom"), intrules={ng.SEGM: IntegrationRule(ng.SEGM, 7)})

    def sigma_n(v):
        """n . sigma n with n = (0, -1)"""
        return LAMBDA * Trace(Grad(v)) + 2 * MU * Grad(v)[1, 1]

    def P0(v):
        return -v[1] - gamma * sigma_n(v)

    def form(integral):
        # symmetric: half of the matrix is stored, as the Cholesky factorisation wants it.
        k = BilinearForm(V, symmetric=True)
        k += integral
        return k

    elasticity = form((LAMBDA * Trace(Grad(u)) * Trace(Grad(v)) + 2 * MU * InnerProduct(Sym(Grad(u)), Sym(Grad(v)))) * dx)
    p = -state[1] - gamma * (LAMBDA * Trace(Grad(state)) + 2 * MU * Grad(state)[1, 1])
    nitsche = form(-gamma * sigma_n(u) * sigma_n(v) * floor)
    slope = form(ng.IfPos(p, 1, 0) / gamma * P0(u) * P0(v) * floor)
    contact = LinearForm(ng.IfPos(p, p, 0) / gamma * P0(v) * floor)
    body = LinearForm((-4 + 10 * ng.x) * v[1] * dx)
    free = np.flatnonzero(np.array(V.FreeDofs(), dtype=bool))

    def factor(matrix):
        return matrix.Inverse(V.FreeDofs(), inverse="sparsecholesky")

    def full(u):
        state.vec.FV().NumPy()[:] = 0
        state.vec.FV().NumPy()[free] = u

    def values(vector):
        return vector.FV().NumPy()[free].copy()

    def volume():
        elasticity.Assemble()
        body.Assemble()

    clock.time("assembly", volume)
    x = state.vec.CreateVector()

    def solve_linear():
        x.data = factor(elasticity.mat) * body.vec

    clock.time("factor", solve_linear)

    def solve():
        volume()
        nitsche.Assemble()
        slope.Assemble()
        # All have the same pattern: that of the space.
        constant = elasticity.mat.AsVector() + nitsche.mat.AsVector()
        a, tangent = elasticity.mat.CreateMatrix(), elasticity.mat.CreateMatrix()
        a.AsVector().data = constant
        algebra = []

        def residual(u):
            full(u)
            contact.Assemble()
            x.data = a * state.vec + contact.vec - body.vec
            return values(x)

        def correction(u, r):
            full(u)
            slope.Assemble()
            tangent.AsVector().data = a.AsVector() + slope.mat.AsVector()
            if algebra:
                algebra[0].Update()
            else:
                algebra.append(factor(tangent))
            full(r)
            x.data = algebra[0] * state.vec
            return values(x)

        return newton(residual, correction, np.linalg.norm, np.zeros(len(free)))

    u, steps = clock.time("contact", solve)
    full(u)
    x.data = elasticity.mat * state.vec
    return ng.InnerProduct(x, state.vec), steps


main(["sparsecholesky"], {"NGSolve": ng.__version__}, run)
