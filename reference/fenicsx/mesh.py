"""The mesh of a case: structured ones are made here, others are read from a file.

Rectangles are divided into ny rows of nx cells; a cell is cut by its diagonal

    right (lower left to upper right)    left (upper left to lower right)    crossed (both, with a vertex at the centre)

A mesh is small beside the linear systems: every process builds all of it, and DOLFINx distributes the triangles of process 0.
"""

import math

import numpy as np

from . import gmsh
from .case import CaseError, Gmsh, Trapezoid
from .plane import PlaneMesh


def plane_mesh(case):
    """The mesh of a case, checked; CaseError if it is not one, or lacks a boundary that the case names."""
    spec = case.mesh
    if isinstance(spec, Gmsh):
        mesh = gmsh.read(spec.path)
    elif isinstance(spec, Trapezoid):
        mesh = trapezoid(spec.omega, spec.n)
    else:
        mesh = rectangle(spec.width, spec.height, spec.nx, spec.ny, spec.diagonal)
    _check(mesh, case)
    return mesh


def rectangle(width, height, nx, ny, diagonal):
    """[0, width] x [0, height]; vertices row by row from the lower left, then the centres of crossed cells."""
    x, y = np.arange(nx + 1) * width / nx, np.arange(ny + 1) * height / ny
    points = np.column_stack((np.tile(x, ny + 1), np.repeat(y, nx + 1)))
    number = np.arange((nx + 1) * (ny + 1)).reshape(ny + 1, nx + 1)
    a, b, c, d = (corner.ravel() for corner in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]))
    if diagonal == "crossed":
        centres = (points[a] + points[c]) / 2
        m = len(points) + np.arange(nx * ny)
        points = np.vstack((points, centres))
        triangles = ((a, b, m), (b, c, m), (c, d, m), (d, a, m))
    elif diagonal == "right":
        triangles = ((a, b, c), (a, c, d))
    else:
        triangles = ((a, b, d), (b, c, d))
    sides = {"bottom": number[0], "right": number[:, -1], "top": number[-1], "left": number[:, 0]}
    boundaries = {name: np.column_stack((line[:-1], line[1:])) for name, line in sides.items()}
    return PlaneMesh(points, np.stack([np.column_stack(t) for t in triangles], axis=1).reshape(-1, 3), boundaries)


def trapezoid(omega, n):
    """The unit square in n x n cells, diagonals right, mapped by (s, t) -> (s + (1 - s) t cot(omega), t)."""
    mesh = rectangle(1.0, 1.0, n, n, "right")
    s, t = mesh.points.T
    return PlaneMesh(np.column_stack((s + (1 - s) * t / math.tan(omega), t)), mesh.triangles, mesh.boundaries)


def _check(mesh, case):
    def fail(message):
        raise CaseError(f"{case.path}: mesh: {message}")

    for name in case.boundaries:
        if name not in mesh.boundaries:
            fail(f"no boundary named {name!r}; this mesh has: {', '.join(sorted(mesh.boundaries)) or 'none'}")
    for name in case.points:
        if name not in mesh.corners:
            fail(f"no point named {name!r}; this mesh has: {', '.join(sorted(mesh.corners)) or 'none'}")
    for name in [*case.materials, *case.bodies]:
        if name is not None and name not in mesh.surfaces:
            fail(f"no surface named {name!r}; this mesh has: {', '.join(sorted(mesh.surfaces)) or 'none'}")
    if None not in case.materials:
        without = np.ones(len(mesh.triangles), bool)
        for name in case.materials:
            without[mesh.surfaces[name]] = False
        for bad in np.flatnonzero(without)[:1]:
            fail(f"triangle {bad} has no material, expected one for each surface ({', '.join(sorted(mesh.surfaces)) or 'none'})")
    a, b, c = (mesh.points[corner] for corner in mesh.triangles.T)
    area = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
    longest = np.max([np.sum((p - q) ** 2, axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    for bad in np.flatnonzero(~(area > 1e-12 * longest))[:1]:
        fail(f"triangle {bad} (vertices {', '.join(map(str, mesh.triangles[bad]))}) has area {float(area[bad])!r}; expected a "
             "counter-clockwise triangle that is not flat")
    owners = {}
    for triangle in mesh.triangles.tolist():
        for edge in ((0, 1), (1, 2), (2, 0)):
            key = frozenset((triangle[edge[0]], triangle[edge[1]]))
            owners[key] = owners.get(key, 0) + 1
    for name in case.boundaries:
        for edge in mesh.boundaries[name].tolist():
            if owners.get(frozenset(edge), 0) != 1:
                fail(f"edge {edge} of boundary {name!r} belongs to {owners.get(frozenset(edge), 0)} triangles, expected 1")
    named = {}
    for name in case.boundaries:
        for edge in mesh.boundaries[name].tolist():
            other = named.setdefault(frozenset(edge), name)
            if other != name:
                fail(f"edge {edge} belongs to the boundaries {other!r} and {name!r}, expected one")
