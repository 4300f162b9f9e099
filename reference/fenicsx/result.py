"""result.json: what is reported of a solution, in the project's format."""

import numpy as np

from . import compat
from .case import CaseError
from .errors import errors
from .problem import AXIS


def result(problem, method, gamma, u, history, seconds):
    """The content of result.json; u is the solution on the owned dofs, and the method's current iterate."""
    content = {
        "version": f"reference (DOLFINx {compat.versions()['DOLFINx']})",
        "title": problem.case.title,
        "mesh": problem.sizes | {"h_max": problem.h_max},
        "gamma": gamma,
        "newton": {
            "iterations": history.iterations,
            "residuals": history.residuals,
            "residual": history.residuals[-1],
            "factorizations": history.factorizations,
            "status": history.outcome,
        },
        "quantities": quantities(problem, method, u),
        "contact": method.edges.boundaries(method.u.x.array),
    }
    if problem.case.of_revolution:
        whole(content)
    if problem.case.exact:
        content["errors"] = errors(problem, method)
    if problem.case.probes:
        content["probes"] = probes(problem, method.u.x.array)
    content["seconds"] = seconds
    return content


def whole(content):
    """Makes energies and forces of a radian those of the whole revolution. Radial forces cancel all round: they are left for a radian."""
    for numbers in (content["quantities"], *content["contact"]):
        for key in ("a_uu", "elastic_energy", "work", "contact_force", "force"):
            if key in numbers:
                numbers[key] *= 2 * np.pi
    vectors = [content["quantities"]["contact_resultant"], *content["quantities"]["reactions"].values()]
    for vector in vectors + [boundary["resultant"] for boundary in content["contact"]]:
        vector[1] *= 2 * np.pi
    for boundary in content["contact"]:
        boundary["moment"] = 0.0


def quantities(problem, method, u):
    pressure = method.edges.pressure(method.u.x.array)
    largest = np.max(np.hypot(u[0::2], u[1::2]), initial=0.0)
    energy = float(method.energy())
    return {
        "a_uu": energy,
        "elastic_energy": energy / 2,
        "work": problem.comm.allreduce(float(problem.load @ u)),
        "max_displacement": max(problem.comm.allgather(float(largest))),
        **pressure,
        "reactions": reactions(problem, method.functional() - problem.load),
    }


def reactions(problem, residual):
    """{boundary or point: [x, y]}: its share of the unconstrained equations' residual, which is the force on the body."""
    own = {}
    for name, node, direction, dual in problem.holds.holders:
        total = own.setdefault(name, np.zeros(2))
        if 2 * node < problem.owned_dofs:
            total += direction * (dual @ residual[2 * node : 2 * node + 2])
    names = sorted({name for of in problem.comm.allgather(list(own)) for name in of} - {AXIS})
    return {name: problem.comm.allreduce(own.get(name, np.zeros(2))).tolist() for name in names}


def probes(problem, u):
    """[x, y, u_x, u_y] per probe: u^h in the triangle that holds the point, found by barycentric coordinates."""
    corners = problem.mesh.geometry.x[compat.cell_vertices(problem.mesh)][:, :, :2]
    to_reference = np.linalg.inv(np.stack((corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=2))
    found = []
    for point in problem.case.probes:
        reference = np.einsum("cij,cj->ci", to_reference, point - corners[:, 0])
        inside = np.minimum(reference.min(axis=1), 1 - reference.sum(axis=1))
        cell = int(np.argmax(inside))
        values, _ = compat.basis(problem.case.degree, reference[cell][None])
        dofs = 2 * problem.V.dofmap.cell_dofs(cell)
        found.append((float(inside[cell]), [float(values[0] @ u[dofs]), float(values[0] @ u[dofs + 1])]))
    rows = []
    for point, candidates in zip(problem.case.probes, zip(*problem.comm.allgather(found))):
        inside, displacement = max(candidates)
        if inside < -1e-9:
            raise CaseError(f"{problem.case.path}: output.probes: found {point}, expected a point of the mesh")
        rows.append(point + displacement)
    return rows
