"""NGSolve with its own sparse Cholesky factorisation. See common.py."""

import ngsolve as ng
import numpy as np
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, IntegrationRule, LinearForm, Sym, Trace, VectorH1, ds, dx
from netgen.meshing import Element1D, Element2D, Mesh, MeshPoint, Pnt

from common import main, newton


def meshed(body):
    mesh = Mesh()
    mesh.dim = 2
    points = [mesh.Add(MeshPoint(Pnt(x, y, 0))) for x, y in body.vertices.tolist()]
    whole = mesh.AddRegion("body", dim=2)
    for triangle in body.triangles.tolist():
        mesh.Add(Element2D(whole, [points[i] for i in triangle]))
    for name, edges in (("floor", body.floor), ("held", body.held)):
        region = mesh.AddRegion(name, dim=1)
        for edge in edges.tolist():
            mesh.Add(Element1D([points[i] for i in edge], index=region))
    return ng.Mesh(mesh)


def run(body, gamma0, solver, clock):
    mesh = meshed(body)
    V = VectorH1(mesh, order=1, dirichlet="held")
    u, v = V.TnT()
    state = GridFunction(V)
    gamma = GridFunction(ng.L2(mesh, order=0))
    gamma.vec.FV().NumPy()[:] = gamma0 * body.h
    n = ng.specialcf.normal(2)
    lam, mu, (a, b) = getattr(body, "lambda"), body.mu, body.force
    # Volume gradients on the edge need skeleton; degree 7 is 4 Gauss points.
    floor = ds(skeleton=True, definedon=mesh.Boundaries("floor"), intrules={ng.SEGM: IntegrationRule(ng.SEGM, 7)})

    def sigma_n(v):
        """d . sigma n with d = (0, -1)"""
        return -(mu * (Grad(v)[0, 1] + Grad(v)[1, 0]) * n[0] + (lam * Trace(Grad(v)) + 2 * mu * Grad(v)[1, 1]) * n[1])

    def P0(v):
        return -v[1] - gamma * sigma_n(v)

    def form(integral):
        # symmetric: half of the matrix is stored, as the Cholesky factorisation wants it.
        k = BilinearForm(V, symmetric=True)
        k += integral
        return k

    elasticity = form((lam * Trace(Grad(u)) * Trace(Grad(v)) + 2 * mu * InnerProduct(Sym(Grad(u)), Sym(Grad(v)))) * dx)
    p = P0(state) - (ng.y - body.level)
    nitsche = form(-gamma * sigma_n(u) * sigma_n(v) * floor)
    slope = form(ng.IfPos(p, 1, 0) / gamma * P0(u) * P0(v) * floor)
    contact = LinearForm(ng.IfPos(p, p, 0) / gamma * P0(v) * floor)
    force = LinearForm((a + b * ng.x) * v[1] * dx)
    free = np.flatnonzero(np.array(V.FreeDofs(), dtype=bool))

    def factor(matrix):
        return matrix.Inverse(V.FreeDofs(), inverse="sparsecholesky")

    lift = GridFunction(V)
    lift.Set(tuple(body.prescribed), definedon=mesh.Boundaries("held"))
    lifted = lift.vec.FV().NumPy().copy()

    def full(u, lift=lifted):
        state.vec.FV().NumPy()[:] = lift
        state.vec.FV().NumPy()[free] = u

    def values(vector):
        return vector.FV().NumPy()[free].copy()

    def volume():
        elasticity.Assemble()
        force.Assemble()

    clock.time("assembly", volume)
    x = state.vec.CreateVector()

    def solve_linear():
        x.data = factor(elasticity.mat) * force.vec

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
            x.data = a * state.vec + contact.vec - force.vec
            return values(x)

        def correction(u, r):
            full(u)
            slope.Assemble()
            tangent.AsVector().data = a.AsVector() + slope.mat.AsVector()
            if algebra:
                algebra[0].Update()
            else:
                algebra.append(factor(tangent))
            full(r, 0)
            x.data = algebra[0] * state.vec
            return values(x)

        return newton(residual, correction, np.linalg.norm, np.zeros(len(free)))

    u, steps = clock.time("contact", solve)
    full(u)
    x.data = elasticity.mat * state.vec
    return ng.InnerProduct(x, state.vec), steps


main(["sparsecholesky"], {"NGSolve": ng.__version__}, run)
