"""The smooth boundary behind the facets of a mesh (docs/parts.md, "The direction of contact"): a normal at each end of each edge of
the outline, and the cubic Hermite curve through the vertices, on which P2 has its third node of contact.

An edge is the pair of its vertices with the body on its left; its normal points out, its tangent is the normal turned left.
"""

import math

import numpy as np

SMOOTH = math.radians(40)  # a sharper bend is a corner
STRAIGHT = 1e-8  # a bend of fewer radians is rounding


class SmoothBoundary:
    """`facet[edge]`: the normal of each edge of the outline; `ends[edge]`: the normals at its two ends, for curved edges only."""

    def __init__(self, plane):
        self.points = plane.points
        sides = {(t[i], t[(i + 1) % 3]) for t in plane.triangles.tolist() for i in range(3)}
        outline = [edge for edge in sides if edge[::-1] not in sides]
        self.length, self.facet = {}, {}
        for a, b in outline:
            along = self.points[b] - self.points[a]
            self.length[a, b] = float(np.hypot(*along))
            self.facet[a, b] = np.array([along[1], -along[0]]) / self.length[a, b]
        self.arriving, self.leaving = {}, {}
        for edge in outline:
            self.leaving.setdefault(edge[0], []).append(edge)
            self.arriving.setdefault(edge[1], []).append(edge)
        shared = {vertex: self._shared(vertex) for vertex in self.leaving}
        self.ends = {}
        for edge in outline:
            normals = self._of_edge(edge, *(shared.get(vertex) for vertex in edge))
            if normals:
                self.ends[edge] = normals

    def oriented(self, a, b):
        """The edge between two vertices as it stands in the outline."""
        return (a, b) if (a, b) in self.facet else (b, a)

    def _passage(self, vertex):
        """The one edge that arrives at a vertex and the one that leaves it; None where parts of the body touch in a point."""
        arriving, leaving = self.arriving.get(vertex, []), self.leaving.get(vertex, [])
        return (arriving[0], leaving[0]) if len(arriving) == len(leaving) == 1 else None

    def _bend(self, vertex):
        """By how much the outline turns left at a vertex."""
        passage = self._passage(vertex)
        if not passage:
            return math.inf
        n, m = (self.facet[edge] for edge in passage)
        return math.atan2(n[0] * m[1] - n[1] * m[0], n @ m)

    def _shared(self, vertex):
        """The normal that both edges have at a vertex, or None."""
        passage, bend = self._passage(vertex), self._bend(vertex)
        if not passage or abs(bend) <= STRAIGHT or abs(bend) > SMOOTH:
            return None
        before, after = passage
        beyond = self._bend(before[0]), self._bend(after[1])
        straight = [abs(other) <= STRAIGHT for other in beyond]
        if all(straight):
            return None
        if any(straight):  # a side goes over into an arc if that bends on, and no less
            arc = beyond[0] if straight[1] else beyond[1]
            goes_on = arc * bend > 0 and abs(bend) <= abs(arc)
            return self.facet[before if straight[0] else after] if goes_on else None
        return _unit(self.facet[before] / self.length[before] + self.facet[after] / self.length[after])

    def _of_edge(self, edge, start, end):
        n = self.facet[edge]
        if start is None and end is None:
            return None
        if start is None:
            start = n if abs(self._bend(edge[0])) <= STRAIGHT else _mirrored(end, n)
        elif end is None:
            end = n if abs(self._bend(edge[1])) <= STRAIGHT else _mirrored(start, n)
        return start, end

    def along(self, edge):
        """(places, normals) at start, middle and end of an edge of the outline."""
        a, b = (self.points[vertex] for vertex in edge)
        if edge not in self.ends:
            return np.array([a, (a + b) / 2, b]), np.array([self.facet[edge]] * 3)
        n, m = self.ends[edge]
        half = math.sqrt(max(0.0, (1 + n @ m) / 2))  # the cosine of half the angle between the normals
        speed = 2 * self.length[edge] / (1 + half)
        t, s = _left(n), _left(m)
        middle = (a + b) / 2 + speed / 8 * (t - s)
        tangent = 1.5 * (b - a) - speed / 4 * (t + s)
        return np.array([a, middle, b]), np.array([n, _unit(-_left(tangent)), m])


def _left(v):
    return np.array([-v[1], v[0]])


def _unit(v):
    return v / np.hypot(*v)


def _mirrored(normal, facet):
    """The normal at the other end of a circle's arc."""
    return _unit(2 * (normal @ facet) * facet - normal)
