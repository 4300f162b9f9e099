"""Distances to an exact solution u, in the norms of Theorem 3.5 and Corollary 3.6:

    energy = a(u - u^h, u - u^h)^(1/2),   h1 = ||u - u^h||_{1,Omega},   l2 = ||u - u^h||_{0,Omega},
    contact_residual = || gamma^(1/2) (sigma_n(u) + (1/gamma) [P(u^h)]+) ||_{0,Gamma_C},
    normal_stress = || gamma^(1/2) sigma_n(u - u^h) ||_{0,Gamma_C}.
"""

import numpy as np

from . import quadrature
from .edges import edge_basis, roots
from .load import basis_at, corners_of


def errors(problem, method):
    solution, material, u = problem.case.exact, problem.case.material, method.u.x.array
    owned = problem.mesh.topology.index_map(2).size_local
    cell, points, w = quadrature.on_triangles(corners_of(problem, np.arange(owned)), solution)
    dofs, values, gradients = basis_at(problem, cell, points)
    exact, exact_gradient = solution.displacement(*points.T), solution.gradient(*points.T)
    e = [exact[k] - np.sum(values * u[dofs + k], axis=1) for k in (0, 1)]
    (xx, xy), (yx, yy) = [[exact_gradient[k][i] - np.sum(gradients[:, :, i] * u[dofs + k], axis=1) for i in (0, 1)] for k in (0, 1)]
    l2 = w @ (e[0] ** 2 + e[1] ** 2)
    seminorm = w @ (xx**2 + xy**2 + yx**2 + yy**2)
    shear = (xy + yx) / 2
    energy = w @ (material.plane_lam * (xx + yy) ** 2 + 2 * material.mu * (xx**2 + yy**2 + 2 * shear**2))
    sums = problem.comm.allreduce(np.array([energy, l2 + seminorm, l2, *on_contact_edges(method.edges, solution, u)]))
    return dict(zip(("energy", "h1", "l2", "contact_residual", "normal_stress"), np.sqrt(sums).tolist()))


def on_contact_edges(edges, solution, u):
    """The two squared norms on Gamma_C. Each edge is cut at the roots of P(u^h), at the kink and at the singular point."""
    total, P, stress = np.zeros(2), edges.P(u), np.einsum("eqd,ed->eq", edges.S_n, u[edges.dofs])
    special = [c for c in (solution.cut, solution.apex and solution.apex[0]) if c is not None]
    polynomial_roots = roots(P)
    for e, (a, b) in enumerate(edges.ends):
        inside = [(c - a[0]) / (b[0] - a[0]) for c in special]
        cuts = np.unique([0.0, 1.0, *polynomial_roots[e], *(t for t in inside if 0 < t < 1)])
        for low, high in zip(cuts, cuts[1:]):
            s, x, y, w = _piece(a, b, low, high, solution)
            at = edge_basis(edges.p, s)
            pressed = edge_basis(edges.p, np.array((low + high) / 2)) @ P[e] > 0
            pressure = at @ P[e] / edges.gamma[e] if pressed else 0.0
            sxx, syy, sxy = solution.stress(x, y)
            n = edges.n[e]
            sigma_n = n[0] ** 2 * sxx + n[1] ** 2 * syy + 2 * n[0] * n[1] * sxy
            weight = edges.gamma[e] * edges.length[e] * w
            total += [weight @ (sigma_n + pressure) ** 2, weight @ (sigma_n - at @ stress[e]) ** 2]
    return total


def _piece(a, b, low, high, solution):
    """(s, x, y, weights) on the part [low, high] of the edge a + s (b - a), graded towards an end where the stress is singular.
    Coordinates are measured from that end, so that they keep their digits."""
    t, w = quadrature.gauss(quadrature.POINTS)
    start, end = a + low * (b - a), a + high * (b - a)
    if solution.apex is not None:
        near_start, near_end = (bool(np.allclose(q, solution.apex, rtol=0, atol=1e-12)) for q in (start, end))
        if near_start or near_end:
            t, w = quadrature.gauss(quadrature.POINTS_AT_APEX)
            g = solution.edge_grading
            t, w = t**g, g * t ** (g - 1) * w
            other = end if near_start else start
            x, y = (np.array(solution.apex) + t[:, None] * (other - np.array(solution.apex))).T
            return (low + t * (high - low) if near_start else high - t * (high - low)), x, y, w * (high - low)
    x, y = (start + t[:, None] * (end - start)).T
    return low + t * (high - low), x, y, w * (high - low)
