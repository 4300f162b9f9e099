"""Meshes as plain arrays: points, triangles, and for each named boundary its edges as pairs of vertices."""

from dataclasses import dataclass

import numpy as np


@dataclass
class PlaneMesh:
    points: np.ndarray  # (vertices, 2)
    triangles: np.ndarray  # (triangles, 3), counter-clockwise
    boundaries: dict  # name -> (edges, 2)
