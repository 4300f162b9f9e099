"""GetFEM with MUMPS. See common.py."""

import getfem as gf
import numpy as np

from common import debian, main, newton

FLOOR = 1
ALL = -1
# d . sigma n with d = (0, -1)
SIGMA_N = "(-(lambda*Trace(Grad_{0})*Normal(2) + mu*((Grad_{0} + Grad_{0}')*Normal)(2)))"
P0 = f"(-{{0}}(2) - gamma*{SIGMA_N})"
U, V, W = "u", "Test_u", "Test2_u"
P = f"({P0.format(U)} - (X(2) - level))"
LOAD = "(a + b*X(1))*Test_u(2)"
CONTACT = f"pos_part({P})/gamma*{P0.format(V)}"
NITSCHE = f"-gamma*{SIGMA_N.format(W)}*{SIGMA_N.format(V)}"
SLOPE = f"Heaviside({P})/gamma*{P0.format(W)}*{P0.format(V)}"


def meshed(body):
    mesh = gf.Mesh("empty", 2)
    mesh.add_convex(gf.GeoTrans("GT_PK(2,1)"), body.vertices[body.triangles].transpose(2, 1, 0))
    mesh.set_region(FLOOR, body.sides(body.floor).T)
    return mesh


def run(body, gamma0, solver, clock):
    mesh = meshed(body)
    mf, p0 = gf.MeshFem(mesh, 2), gf.MeshFem(mesh, 1)
    mf.set_classical_fem(1)
    p0.set_classical_fem(0)
    volume, edges = gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(2)")), gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(7)"))
    held = {tuple(vertex) for vertex in body.vertices[np.unique(body.held)].tolist()}
    clamped = np.array([tuple(node) in held for node in mf.basic_dof_nodes().T.tolist()])
    zero = np.zeros(mf.nbdof())
    lift = np.where(clamped, np.resize(body.prescribed, mf.nbdof()), 0.0)
    a, b = body.force
    lam, mu = getattr(body, "lambda"), body.mu
    numbers = {"lambda": lam, "mu": mu, "level": body.level, "a": a, "b": b}
    constants = [x for name, value in numbers.items() for x in (name, 0, np.array([value]))]
    constants += ["gamma", 0, p0, gamma0 * body.h]

    def assemble(rule, order, form, region, u):
        return gf.asm_generic(rule, order, form, region, "u", 1, mf, u, *constants)

    def stiffness():
        return gf.asm_linear_elasticity(volume, mf, p0, np.full(p0.nbdof(), lam), np.full(p0.nbdof(), mu))

    def elastic():
        """By the assembly for this operator alone, much faster than the generic one. The clamped degrees of freedom are held by
        a huge number on their diagonal, exact to rounding: taking their rows and columns out is slower than the factorisation."""
        return gf.Spmat("add", stiffness(), gf.Spmat("diag", np.where(clamped, 1e30, 0.0)))

    def free(r):
        return np.where(clamped, 0.0, r)

    def force():
        return free(assemble(volume, 1, LOAD, ALL, zero))

    def algebra(k, right):
        return free(gf.linsolve_mumps(k, right).ravel())

    k, f = clock.time("assembly", lambda: (elastic(), force()))
    clock.time("factor", lambda: algebra(k, f))

    def solve():
        f = force()
        a = gf.Spmat("add", elastic(), assemble(edges, 2, NITSCHE, FLOOR, zero))

        def residual(u):
            return free(a.mult(u) + assemble(edges, 1, CONTACT, FLOOR, u) - f)

        def correction(u, r):
            return algebra(gf.Spmat("add", a, assemble(edges, 2, SLOPE, FLOOR, u)), r)

        return newton(residual, correction, np.linalg.norm, lift)

    u, steps = clock.time("contact", solve)
    return u @ stiffness().mult(u), steps


# The module does not know its version.
main(["mumps"], {"GetFEM": debian("python3-getfem"), "MUMPS": debian("libmumps-seq-5.5")}, run)
