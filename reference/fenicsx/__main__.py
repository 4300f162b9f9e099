"""python3 -m fenicsx CASE.toml [--out DIR] [--iterative] [--nx N] [--ranks N]

Solves the case and writes DIR/result.json and DIR/solution.xdmf. Codes: 0 solved, 1 could not solve, 2 the case is wrong.
"""

import argparse
import logging
import sys
import traceback
from pathlib import Path

from . import launch


def arguments():
    parser = argparse.ArgumentParser(prog="python3 -m fenicsx", description="Solves a contact case by method (8) with DOLFINx and PETSc.")
    parser.add_argument("case", metavar="CASE.toml")
    parser.add_argument("--out", metavar="DIR", help="output folder; default out/<case name>/")
    parser.add_argument("--iterative", action="store_true", help="CG with algebraic multigrid (GAMG) instead of MUMPS Cholesky")
    parser.add_argument("--nx", type=int, help="cells along x instead of the case's, ny in proportion")
    parser.add_argument("--ranks", type=int, default=1, help="run on this many MPI processes")
    return parser.parse_args()


def main():
    options = arguments()
    if options.ranks > 1:
        return launch.on_ranks(options.ranks, "fenicsx", sys.argv[1:])

    logging.disable(logging.INFO)  # the form compiler reports every C file
    from mpi4py import MPI

    from .case import CaseError
    from .newton import NotSolved
    from .solve import solve
    from .write import write

    comm = MPI.COMM_WORLD
    try:
        content, problem, method, history = solve(options.case, comm, options.iterative, options.nx)
        folder = Path(options.out or Path("out") / Path(options.case).stem)
        write(content, problem, method, folder)
    except CaseError as error:
        return stop(comm, error, 2)
    except (NotSolved, OSError) as error:
        return stop(comm, error, 1)
    except Exception:
        traceback.print_exc()
        comm.Abort(1)
    if comm.rank == 0:
        print(summary(content, history, comm.size, options.iterative))
        print(f"written: {folder}/result.json, {folder}/solution.xdmf")
    return 0


def stop(comm, error, code):
    if comm.rank == 0:
        print(f"error: {error}", file=sys.stderr)
    return code


def summary(content, history, ranks, iterative):
    q, gamma = content["quantities"], content["gamma"]
    inner = f"; CG iterations per step: {', '.join(map(str, history.inner))}" if iterative else ""
    return "\n".join((
        f"{content['title']}: {content['mesh']['triangles']} triangles, {content['mesh']['dofs']} dofs, {ranks} process(es)",
        f"gamma0 = {gamma['gamma0']:.6g}, kappa = {gamma['kappa']:.4g}, limit = {gamma['limit']:.6g}",
        f"Newton: {history.outcome} after {history.iterations} iterations, relative residual "
        f"{history.residuals[-1] / (history.reference or 1):.1e}{inner}",
        f"contact force {q['contact_force']:.10g}, length {q['contact_length']:.10g}, peak pressure {q['peak_pressure']:.10g}",
        f"energy {q['a_uu']:.12g}, work {q['work']:.12g}, largest displacement {q['max_displacement']:.10g}",
    ))


if __name__ == "__main__":
    sys.exit(main())
