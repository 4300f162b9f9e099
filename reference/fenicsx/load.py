"""The load of an exact solution, L(v) = int f.v + int_{Gamma_N} (sigma n).v, integrated in numpy: f has a kink on the line x = cut."""

import numpy as np

from . import compat, quadrature


def exact_load(problem):
    """This process's contributions to L, one entry per dof that it sees."""
    solution, total = problem.case.exact, np.zeros_like(problem.data)
    owned = problem.mesh.topology.index_map(2).size_local
    corners = corners_of(problem, np.arange(owned))
    cell, points, w = quadrature.on_triangles(corners, solution)
    add(problem, total, cell, points, w, solution.body_force(*points.T))
    for name in problem.case.of_kind("traction"):
        facets = problem.boundaries[name]
        for cell, local in zip(facets.cells[facets.owned], facets.local[facets.owned]):
            corners = corners_of(problem, np.array([cell]))[0]
            opposite, (a, b) = corners[local], np.delete(corners, local, axis=0)
            t, w = quadrature.gauss(quadrature.POINTS)
            points = a + t[:, None] * (b - a)
            length = np.linalg.norm(b - a)
            n = np.array([b[1] - a[1], a[0] - b[0]]) / length
            n *= -np.sign(n @ (opposite - a))
            sxx, syy, sxy = solution.stress(*points.T)
            add(problem, total, np.full(len(t), cell), points, w * length, (sxx * n[0] + sxy * n[1], sxy * n[0] + syy * n[1]))
    return total


def corners_of(problem, cells):
    return problem.mesh.geometry.x[compat.cell_vertices(problem.mesh)[cells]][:, :, :2]


def basis_at(problem, cells, points):
    """Dofs (points, functions) of the x components, values and gradients of the basis at points given with their cells."""
    corners = corners_of(problem, cells)
    J = np.stack((corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=2)
    inverse = np.linalg.inv(J)
    reference = np.einsum("qij,qj->qi", inverse, points - corners[:, 0])
    values, gradients = compat.basis(problem.case.degree, reference)
    nodes = np.array([problem.V.dofmap.cell_dofs(cell) for cell in range(cells.max() + 1)])[cells]
    return 2 * nodes, values, np.einsum("qik,qkl->qil", gradients, inverse)


def add(problem, total, cells, points, w, force):
    """total += int force . v over the points."""
    dofs, values, _ = basis_at(problem, cells, points)
    for k in (0, 1):
        np.add.at(total, dofs + k, values * (w * force[k])[:, None])
