"""Meshes as plain arrays: points, triangles, for each named boundary its edges as pairs of vertices, for each named surface its triangles,
and the vertices at named points."""

from dataclasses import dataclass, field

import numpy as np


@dataclass
class PlaneMesh:
    points: np.ndarray  # (vertices, 2)
    triangles: np.ndarray  # (triangles, 3), counter-clockwise
    boundaries: dict  # name -> (edges, 2)
    surfaces: dict = field(default_factory=dict)  # name -> numbers of triangles
    corners: dict = field(default_factory=dict)  # name -> vertex
