"""One case from file to result."""

import time

from .case import CaseError, read_case
from .edges import ContactEdges
from .method import Method as PlaneMethod
from .newton import Solver
from .problem import Problem
from .result import result
from .revolution import MethodOfRevolution


def coercivity(problem):
    """The `gamma` part of the result: gamma0, its limit 1/C_h, kappa, the edge that sets it; refuses kappa >= 1."""
    case = problem.case
    C_h, edge = ContactEdges(problem, 1.0).coercivity()
    gamma0 = 0.5 / C_h if case.gamma0 == "auto" else case.gamma0
    kappa = gamma0 * C_h
    if kappa >= 1 and not case.allow_noncoercive:
        raise CaseError(f"{case.path}: method.gamma0: found {gamma0!r}, expected less than the limit {1 / C_h!r} "
                        f"(kappa = {kappa:.6g}, set by the edge {edge[0]} - {edge[1]}), or allow_noncoercive = true")
    return {"gamma0": gamma0, "limit": 1 / C_h, "kappa": kappa, "limiting_edge": edge}


def solve(path, comm, iterative=False, nx=None, Method=None):
    """(result, problem, method, history) of the case at `path`, on `nx` cells along x if given."""
    clock = [time.perf_counter()]
    case = read_case(path)
    if nx:
        resize(case, nx)
    clock.append(time.perf_counter())
    problem = Problem(case, comm)
    gamma = coercivity(problem)
    Method = Method or (MethodOfRevolution if case.of_revolution else PlaneMethod)
    method = Method(problem, gamma["gamma0"])
    clock.append(time.perf_counter())
    u, history = Solver(method, iterative).solve()
    u = problem.least_norm(u)
    method.set(u)
    clock.append(time.perf_counter())
    seconds = dict(zip(("read", "assemble", "solve"), (b - a for a, b in zip(clock, clock[1:]))))
    return result(problem, method, gamma, u, history, seconds), problem, method, history


def resize(case, nx):
    """Gives a rectangle nx cells along x, and as many along y as keep their proportion."""
    mesh = case.mesh
    if not hasattr(mesh, "nx") or nx * mesh.ny % mesh.nx:
        raise CaseError(f"{case.path}: --nx {nx}: expected a rectangle whose ny = {getattr(mesh, 'ny', None)} scales with it to an integer")
    mesh.nx, mesh.ny = nx, nx * mesh.ny // mesh.nx
