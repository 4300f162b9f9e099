"""Semismooth Newton for (8): the residual is the gradient of the convex functional

    J_h(v) = 1/2 A(v, v) + 1/2 int_{Gamma_C} (1/gamma) [P(v)]+^2 - L(v)      (kappa < 1),

so each step goes along a descent direction and is halved until J_h falls enough (Armijo). Differences of J_h are summed term by term,
because near the solution the values themselves agree to rounding. Steps go on after the tolerance is met for as long as each divides
the residual by ten or more: the result is then exact to rounding, which comparisons between codes need.

Coulomb's friction has no energy. Problems with a given bound have: the first one's is never reached, that of each other one is mu times
the pressure of the one before. After each of them full Newton steps on the equations themselves are tried, with LU, as long as
they go down.
"""

from dataclasses import dataclass, field

import numpy as np
from petsc4py import PETSc

MOST_BOUNDS = 60  # problems with a given bound
FALLS = 0.9  # the share to which a full step takes the residual at least
ARMIJO = 1e-4  # required decrease, as a share of the linear model's
NEGLIGIBLE = 1e-10  # a step of this size relative to u is at the rounding level: no line search, and if it gains nothing, the end
INDEFINITE = (PETSc.KSP.ConvergedReason.DIVERGED_INDEFINITE_MAT, PETSc.KSP.ConvergedReason.DIVERGED_INDEFINITE_PC)  # as CG finds it


class NotSolved(Exception):
    """Newton or the linear solver failed; the command ends with code 1."""


@dataclass
class History:
    reference: float
    residuals: list = field(default_factory=list)
    factorizations: int = 0
    inner: list = field(default_factory=list)  # iterations of CG per step
    outcome: str = ""

    @property
    def iterations(self):
        return len(self.residuals) - 1


class Solver:
    """Newton's method for one Method. `iterative`: CG with algebraic multigrid in place of the sparse Cholesky factorisation, or GMRES
    where Coulomb's friction makes the matrix not symmetric."""

    def __init__(self, method, iterative):
        self.method, self.problem, self.iterative = method, method.problem, iterative
        owned = self.problem.owned_dofs
        self.prescribed = self.problem.prescribed[:owned]
        self.data = self.problem.data[:owned]

    def norm(self, owned):
        return float(np.sqrt(self.dot(owned, owned)))

    def dot(self, a, b):
        return self.problem.comm.allreduce(float(a @ b))

    def free(self, owned):
        holds = self.problem.holds
        return holds.from_frames(np.where(self.prescribed, 0.0, holds.into_frames(owned)))

    def residual(self, u):
        """The residual of (8) at u on the free dofs, leaving the method at u."""
        self.method.set(u)
        return self.free(self.method.functional() - self.problem.load)

    def solve(self):
        """(u, history): the solution on the owned dofs. It starts from the prescribed data, zero at all other nodes."""
        return self.coulomb() if self.method.has_coulomb else self.minimum(self.data)

    def coulomb(self):
        """The solution with Coulomb's friction."""
        self.method.set(self.data)
        self.method.freeze()
        u, history = self.minimum(self.data)
        stages = [history]
        for _ in range(MOST_BOUNDS):
            self.method.freeze(u)
            u, history = self.minimum(u)
            stages.append(history)
            self.method.release()
            found = self.full_steps(u, stages)
            if found is not None:
                history = stages[-1]
                history.factorizations = sum(stage.factorizations for stage in stages)
                return self.end(found, history.outcome, history)
        raise NotSolved(f"Coulomb's friction: relative residual {stages[-1].residuals[-1] / stages[-1].reference:.3e} after {MOST_BOUNDS} problems "
                        "with a given bound")

    def full_steps(self, u, stages):
        """The solution that full steps from u lead to, or None where one does not go down."""
        r, history = self.start(u)
        stages.append(history)
        while history.iterations < self.problem.case.max_iterations:
            before = history.residuals[-1]
            met = before <= self.problem.case.tolerance * history.reference
            candidate = u + self.direction(r, history)
            new = self.residual(candidate)
            after = self.norm(new)
            if met and not after < before / 10:
                history.outcome = "converged"
                return candidate if after < before else u
            if not after < FALLS * before:
                return None
            history.residuals.append(after)
            u, r = candidate, new
        return None

    def start(self, u):
        """(the residual at u, a history that begins there)"""
        r = self.residual(u)
        history = History(self.norm(self.free(self.problem.load)) + self.norm(r + self.free(self.problem.load)))
        history.residuals.append(self.norm(r))
        return r, history

    def minimum(self, u):
        """(u, history): the least J_h, from u."""
        tolerance, most = self.problem.case.tolerance, self.problem.case.max_iterations
        u = u.copy()
        r, history = self.start(u)
        if history.residuals[0] == 0:
            return self.end(u, "converged", history)
        while history.iterations < most:
            d = self.direction(r, history)
            before = history.residuals[-1]
            met = before <= tolerance * history.reference
            negligible = self.norm(d) <= NEGLIGIBLE * self.norm(u)
            t = 1.0 if met or negligible else self.step(u, d, r)
            candidate = u + t * d
            new = self.residual(candidate)
            after = self.norm(new)
            if (met or negligible) and not after < before:
                return self.end(u, "converged" if met else "converged to rounding", history)
            if not np.isfinite(after):
                raise NotSolved(f"Newton: the residual is {after} after {history.iterations + 1} iterations")
            history.residuals.append(after)
            if (met or negligible) and not after < before / 10:
                return self.end(candidate, "converged" if met else "converged to rounding", history)
            u, r = candidate, new
        if history.residuals[-1] <= tolerance * history.reference:
            return self.end(u, "converged", history)
        raise NotSolved(f"Newton: relative residual {history.residuals[-1] / history.reference:.3e} after {most} iterations, expected "
                        f"{tolerance:.1e}; residuals {', '.join(f'{value:.3e}' for value in history.residuals)}")

    def end(self, u, outcome, history):
        self.method.set(u)
        history.outcome = outcome
        return u, history

    def step(self, u, d, r):
        """The first t = 1, 1/2, 1/4, ... with J_h(u + t d) - J_h(u) <= ARMIJO t r.d"""
        slope = self.dot(r, d)
        if not slope < 0:
            raise NotSolved(f"Newton: the tangent is not positive definite (r.d = {slope:.3e}, expected a negative number)")
        self.method.set(d)
        A_d, seen_d = self.method.linear_functional(), self.method.u.x.array.copy()
        self.method.set(u)
        linear = self.dot(self.method.linear_functional() - self.problem.load, d)
        quadratic = self.dot(A_d, d)
        t = 1.0
        while t > 1e-12:
            change = t * linear + t * t / 2 * quadratic + self.method.edges.energy_change(self.method.u.x.array, seen_d, t)
            if change <= ARMIJO * t * slope:
                return t
            t /= 2
        raise NotSolved("Newton: no step along the direction decreases J_h")

    def direction(self, r, history):
        """d with H d = -r on the free dofs and d = 0 on the prescribed ones."""
        matrix = self.method.tangent(everywhere=not self.held())
        turn = self.turn(matrix)
        if turn:
            matrix, flat = matrix.PtAP(turn), matrix
            flat.destroy()
        first = matrix.getOwnershipRange()[0]
        matrix.zeroRowsColumns(first + np.flatnonzero(self.prescribed).astype(PETSc.IntType), diag=1.0)
        b, x = matrix.createVecRight(), matrix.createVecRight()
        b.array[:] = -self.problem.holds.into_frames(r)
        ksp = PETSc.KSP().create(self.problem.comm)
        ksp.setOperators(matrix)
        symmetric = not self.method.has_coulomb or self.method.live.value == 0
        self._configure_krylov(ksp, matrix, symmetric) if self.iterative else self._configure_direct(ksp, matrix, symmetric)
        ksp.solve(b, x)
        reason = ksp.getConvergedReason()
        if symmetric and (reason in INDEFINITE or (not self.iterative and self._negative_pivots(ksp))):
            raise NotSolved("the tangent is not positive definite")
        if reason <= 0:
            raise NotSolved(f"the linear solver failed (PETSc's reason {reason})")
        history.inner.append(ksp.getIterationNumber())
        history.factorizations += not self.iterative
        d = self.free(self.problem.holds.from_frames(x.array.copy()))
        for thing in filter(None, (ksp, b, x, matrix, turn)):
            thing.destroy()
        return d

    def held(self):
        """Supports and the contact of the current iterate leave no motion but slides. Where they do, contact everywhere gives a tangent that
        bounds J_h from above, and a step that decreases it."""
        free, slides = self.problem.free, self.problem.slides
        if len(free) == len(slides):
            return True
        edges, seen = self.method.edges, self.method.u.x.array
        current, fields = seen[: self.problem.owned_dofs].copy(), np.zeros((len(free), len(seen)))
        for field, motion in zip(fields, free):
            self.method.set(motion)
            field[:] = self.method.u.x.array
        self.method.set(current)
        stiffness = np.zeros((len(free), len(free)))
        for dofs, block in edges.tangent(self.method.u.x.array):
            stiffness += fields[:, dofs] @ block @ fields[:, dofs].T
        values = np.linalg.eigvalsh(self.problem.comm.allreduce(stiffness))
        return bool(values[len(slides)] > 1e-8 * values[-1] > 0)

    def turn(self, matrix):
        """The rotation R of the nodes with frames of their own, for R^T H R; None if there are none anywhere."""
        holds, owned = self.problem.holds, self.problem.owned_dofs
        if not self.problem.comm.allreduce(len(holds.turned)):
            return None
        turn = PETSc.Mat().createAIJ(matrix.getSizes(), nnz=(2, 0), comm=self.problem.comm)
        first = turn.getOwnershipRange()[0]
        for node, (c, s) in enumerate(holds.axis[: owned // 2]):
            dofs = np.array([first + 2 * node, first + 2 * node + 1], PETSc.IntType)
            turn.setValues(dofs, dofs, np.array([[c, -s], [s, c]]))
        turn.assemble()
        return turn

    def _configure_direct(self, ksp, matrix, symmetric):
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, symmetric)
        ksp.setType("preonly")
        ksp.getPC().setType("cholesky" if symmetric else "lu")
        ksp.getPC().setFactorSolverType("mumps")

    def _negative_pivots(self, ksp):
        return ksp.getPC().getFactorMatrix().getMumpsInfog(12) > 0

    def _configure_krylov(self, ksp, matrix, symmetric):
        matrix.setBlockSize(2)
        motions = []
        for motion in self.problem.rigid_motions():
            vector = matrix.createVecRight()
            vector.array[:] = motion
            motions.append(vector)
        _orthonormalise(motions)
        matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=motions, comm=self.problem.comm))
        ksp.setType("cg" if symmetric else "fgmres")
        ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        ksp.setTolerances(rtol=1e-10, max_it=1000)
        ksp.getPC().setType("gamg")


def _orthonormalise(vectors):
    for i, vector in enumerate(vectors):
        for other in vectors[:i]:
            vector.axpy(-vector.dot(other), other)
        vector.normalize()
