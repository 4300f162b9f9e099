"""Quadrature that follows an exact solution: triangles and edges are cut where its load has a kink or its stress is singular.

A triangle is integrated in collapsed coordinates, x = apex + rho (...), rho in [0, 1], by Gauss points in both. Where the apex is the
point where the stress is singular, rho = t^s: then r^(alpha-1), alpha > 1/2, becomes smooth enough in t for the same rule.
"""

import numpy as np

POINTS = 16  # per direction on a triangle, per piece on an edge: exact to degree 30
POINTS_AT_APEX = 24
GRADING = 4  # s on triangles


def collapsed(n, s):
    """(barycentric coordinates, weights with sum 1) on a triangle whose apex is its first vertex."""
    t, w = gauss(n)
    rho, weight = t**s, 2 * s * t ** (2 * s - 1) * w  # 2 rho d(rho)
    bary = np.stack(np.broadcast_arrays((1 - rho)[:, None], rho[:, None] * (1 - t), rho[:, None] * t), axis=-1)
    return bary.reshape(-1, 3), np.outer(weight, w).ravel()


def gauss(n):
    """n Gauss points and weights on [0, 1]."""
    t, w = np.polynomial.legendre.leggauss(n)
    return (t + 1) / 2, w / 2


def on_triangles(corners, solution):
    """(triangle, points, weights): quadrature points (n, 2) on the triangles (count, 3, 2), each with the number of its triangle."""
    pieces = [(i, piece, None) for i, piece in enumerate(corners)]
    if solution.cut is not None:
        pieces = [(i, part, None) for i, piece, _ in pieces for part in _cut(piece, solution.cut)]
    if solution.apex is not None:
        pieces = [part for i, piece, _ in pieces for part in _around(i, piece, np.array(solution.apex))]
    found = []
    for graded in (False, True):
        chosen = [(i, piece) for i, piece, apex in pieces if (apex is not None) == graded]
        if not chosen:
            continue
        bary, w = collapsed(POINTS_AT_APEX, GRADING) if graded else collapsed(POINTS, 1)
        vertices = np.array([piece for _, piece in chosen])
        points = np.einsum("qv,pvk->pqk", bary, vertices)
        sides = vertices[:, 1:] - vertices[:, :1]
        area = np.abs(np.linalg.det(sides)) / 2
        found.append((np.repeat([i for i, _ in chosen], len(w)), points.reshape(-1, 2), np.outer(area, w).ravel()))
    return tuple(np.concatenate(column) for column in zip(*found))


def _cut(triangle, c):
    """The parts of a triangle on the two sides of x = c, as triangles."""
    x = triangle[:, 0]
    if x.min() >= c or x.max() <= c:
        return [triangle]
    parts = []
    for side in (1, -1):
        polygon = []
        for a, b in zip(triangle, np.roll(triangle, -1, axis=0)):
            if side * (a[0] - c) >= 0:
                polygon.append(a)
            if (a[0] - c) * (b[0] - c) < 0:
                crossing = a + (c - a[0]) / (b[0] - a[0]) * (b - a)
                polygon.append(np.array([c, crossing[1]]))
        parts += [np.array([polygon[0], polygon[k], polygon[k + 1]]) for k in range(1, len(polygon) - 1)]
    return parts


def _around(i, triangle, apex):
    """The triangle as it is, or cut into triangles that have `apex` as their first vertex if it holds that point."""
    a, b, c = triangle
    whole = _cross(b - a, c - a)
    shares = [_cross(q - apex, r - apex) / whole for q, r in ((b, c), (c, a), (a, b))]
    if min(shares) < -1e-12:
        return [(i, triangle, None)]
    return [(i, np.array([apex, q, r]), apex) for share, (q, r) in zip(shares, ((b, c), (c, a), (a, b))) if share > 1e-12]


def _cross(p, q):
    return p[0] * q[1] - p[1] * q[0]
