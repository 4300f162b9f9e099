"""GetFEM with MUMPS. See common.py."""

import getfem as gf
import numpy as np

from common import debian, main, newton

LAMBDA = MU = 1.0
FLOOR = 1
ALL = -1
# n = (0, -1) on the floor.
SIGMA_N = "(lambda*Trace(Grad_{0}) + 2*mu*Grad_{0}(2,2))"
P0 = f"(-{{0}}(2) - gamma*{SIGMA_N})"
U, V, W = "u", "Test_u", "Test2_u"
LOAD = "(-4 + 10*X(1))*Test_u(2)"
CONTACT = f"pos_part({P0.format(U)})/gamma*{P0.format(V)}"
NITSCHE = f"-gamma*{SIGMA_N.format(W)}*{SIGMA_N.format(V)}"
SLOPE = f"Heaviside({P0.format(U)})/gamma*{P0.format(W)}*{P0.format(V)}"


def square(n):
    x = np.linspace(0, 1, n + 1)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(n), np.arange(n)))
    a, b, c, d = (np.stack([x[i + p], x[j + q]]) for p, q in ((0, 0), (1, 0), (1, 1), (0, 1)))
    mesh = gf.Mesh("empty", 2)
    for triangle in ((a, b, c), (a, c, d)):
        mesh.add_convex(gf.GeoTrans("GT_PK(2,1)"), np.stack(triangle, axis=1))
    mesh.set_region(FLOOR, mesh.outer_faces_with_direction([0, -1], 0.01))
    return mesh


def run(n, gamma0, solver, clock):
    mesh = square(n)
    mf, p0 = gf.MeshFem(mesh, 2), gf.MeshFem(mesh, 1)
    mf.set_classical_fem(1)
    p0.set_classical_fem(0)
    volume, edges = gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(2)")), gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(7)"))
    clamped = mf.basic_dof_nodes()[1] > 1 - 1e-9
    zero = np.zeros(mf.nbdof())
    constants = [x for name, value in (("gamma", gamma0 * np.sqrt(2) / n), ("lambda", LAMBDA), ("mu", MU))
                 for x in (name, 0, np.array([value]))]

    def assemble(rule, order, form, region, u):
        return gf.asm_generic(rule, order, form, region, "u", 1, mf, u, *constants)

    def elastic():
        """By the assembly for this operator alone, much faster than the generic one. The clamped degrees of freedom are held by
        a huge number on their diagonal, exact to rounding: taking their rows and columns out is slower than the factorisation."""
        moduli = np.full(p0.nbdof(), LAMBDA), np.full(p0.nbdof(), MU)
        return gf.Spmat("add", gf.asm_linear_elasticity(volume, mf, p0, *moduli), gf.Spmat("diag", np.where(clamped, 1e30, 0.0)))

    def free(r):
        return np.where(clamped, 0.0, r)

    def body():
        return free(assemble(volume, 1, LOAD, ALL, zero))

    def algebra(k, right):
        return free(gf.linsolve_mumps(k, right).ravel())

    k, f = clock.time("assembly", lambda: (elastic(), body()))
    clock.time("factor", lambda: algebra(k, f))

    def solve():
        f = body()
        a = gf.Spmat("add", elastic(), assemble(edges, 2, NITSCHE, FLOOR, zero))

        def residual(u):
            return free(a.mult(u) + assemble(edges, 1, CONTACT, FLOOR, u) - f)

        def correction(u, r):
            return algebra(gf.Spmat("add", a, assemble(edges, 2, SLOPE, FLOOR, u)), r)

        return newton(residual, correction, np.linalg.norm, zero)

    u, steps = clock.time("contact", solve)
    return u @ k.mult(u), steps


# The module does not know its version.
main(["mumps"], {"GetFEM": debian("python3-getfem"), "MUMPS": debian("libmumps-seq-5.5")}, run)
