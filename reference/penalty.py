"""A case by the penalty method, in place of (8): a(u, v) + sum over Gamma_C of int (1/eps) [u_n - g]+ v_n = L(v), with P1 or P2.

    python3 reference/penalty.py cases/gap.toml --out out/penalty --eps 1e-2 1e-3 1e-4

writes OUT/eps_<eps>.csv (x, y, ux, uy at the nodes) for each eps, a length over a modulus. `signorini certify CASE.toml
--displacement OUT/eps_<eps>.csv` then proves how wrong each is (docs/certificates.md). With [exact] the true error is printed. One process; needs DOLFINx (README.md).
"""

import argparse
import sys
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np
import ufl
from dolfinx import fem
from fenicsx.case import read_case
from fenicsx.edges import ContactEdges
from fenicsx.errors import errors
from fenicsx.problem import Problem
from fenicsx.solve import resize
from mpi4py import MPI
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve
from ufl import dot, dx, grad, inner, sym, tr

STEPS = 60
GAMMA0 = 0.01  # of norms on Gamma_C that are not printed
TOLERANCE = 1e-12  # of the residual, relative to the load and the prescribed data


def forms(problem, u, eps):
    """Residual (without the load) and tangent of the penalty method at `u`."""
    material = problem.case.material
    lam, mu = float(material.plane_lam), float(material.mu)
    n, v, w = ufl.FacetNormal(problem.mesh), ufl.TestFunction(problem.V), ufl.TrialFunction(problem.V)

    def sigma(a):
        return lam * tr(sym(grad(a))) * ufl.Identity(2) + 2 * mu * sym(grad(a))

    residual, tangent = inner(sigma(u), sym(grad(v))) * dx, inner(sigma(w), sym(grad(v))) * dx
    for name, gap in problem.gaps.items():
        ds = problem.ds(problem.number[name], metadata={"quadrature_degree": 4})
        through = dot(u, n) - gap
        touches = ufl.conditional(ufl.gt(through, 0), 1.0, 0.0)
        residual += (1 / eps) * touches * through * dot(v, n) * ds
        tangent += (1 / eps) * touches * dot(w, n) * dot(v, n) * ds
    return fem.form(residual), fem.form(tangent)


def solve(problem, eps, start=None):
    """The displacement, from Newton's method begun at `start`."""
    u = fem.Function(problem.V)
    u.x.array[:] = problem.data if start is None else start
    free = np.flatnonzero(problem.prescribed == 0)
    residual_form, tangent_form = forms(problem, u, eps)
    reference = None
    for _ in range(STEPS):
        inner_forces = problem.assemble(residual_form)
        residual = (inner_forces - problem.load)[free]
        reference = reference or np.linalg.norm(problem.load) + np.linalg.norm(inner_forces)
        if np.linalg.norm(residual) <= TOLERANCE * reference:
            return u
        matrix = fem.petsc.assemble_matrix(tangent_form)
        matrix.assemble()
        rows, columns, values = matrix.getValuesCSR()
        size = len(u.x.array)
        tangent = csr_matrix((values, columns, rows), shape=(size, size))[free][:, free]
        u.x.array[free] -= spsolve(tangent.tocsc(), residual)
    raise SystemExit(f"eps = {eps}: no convergence in {STEPS} steps, residual {np.linalg.norm(residual) / reference:.1e}")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("case")
    arguments.add_argument("--out", type=Path, required=True)
    arguments.add_argument("--eps", type=float, nargs="+", required=True)
    arguments.add_argument("--nx", type=int, help="cells along x, in place of the case's")
    arguments = arguments.parse_args()
    case = read_case(arguments.case)
    if arguments.nx:
        resize(case, arguments.nx)
    problem = Problem(case, MPI.COMM_SELF)
    problem.refuse(None if problem.straight else "the penalty method here takes straight lines of contact with a gap")
    arguments.out.mkdir(parents=True, exist_ok=True)
    start = None
    for eps in sorted(arguments.eps, reverse=True):
        u = solve(problem, eps, start)
        start = u.x.array.copy()
        name = arguments.out / f"eps_{eps:.0e}"
        table = np.hstack((problem.nodes, u.x.array.reshape(-1, 2)))
        np.savetxt(f"{name}.csv", table, delimiter=",", header="x,y,ux,uy", comments="", fmt="%.17g")
        true = ""
        if case.exact:
            true = f": energy error {errors(problem, SimpleNamespace(u=u, edges=ContactEdges(problem, GAMMA0)))['energy']:.6g}"
        print(f"{name}.csv{true}")


if __name__ == "__main__":
    main()
