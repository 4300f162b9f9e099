"""What supports hold: demands u . d = value at nodes, the frames that oblique ones turn, and the part of a force that each boundary bears.

Where one oblique demand stands alone at a node, its unknowns are u . d and u . t, t being d turned left; two that are not parallel fix
the node. A direction that several boundaries ask for counts for the first in name order; points come last.
"""

from dataclasses import dataclass, field

import numpy as np

PARALLEL = 1e-8  # a smaller sine
AGREEMENT = 1e-12  # values that differ by less, relative to the largest, agree


@dataclass
class Demand:
    name: str
    place: str  # the key of the case file
    direction: np.ndarray
    value: float

    @property
    def oblique(self):
        return bool(np.all(self.direction != 0))


@dataclass
class Constraints:
    """`held[node, i]` and `data[node, i]`: whether the component i of u in the node's frame is prescribed, and its value. `axis[node]`:
    the first axis of the frame. `holders`: (name, node, direction, dual); the share of a force r is direction (dual . r)."""

    held: np.ndarray
    data: np.ndarray
    axis: np.ndarray
    holders: list = field(default_factory=list)

    @classmethod
    def of(cls, nodes, demands):
        """(Constraints, None), or (None, a message) where demands disagree; `demands[node]` in the order in which they count."""
        found = cls(np.zeros((len(nodes), 2), bool), np.zeros((len(nodes), 2)), np.tile([1.0, 0.0], (len(nodes), 1)))
        largest = max((abs(d.value) for at in demands.values() for d in at), default=0.0)
        for node, at in demands.items():
            independent = []
            for demand in sorted(at, key=lambda d: d.oblique):
                same = next((d for d in independent if abs(cross(d.direction, demand.direction)) <= PARALLEL), None)
                if same or len(independent) == 2:
                    expected = _value_along(independent, same, demand.direction)
                    if not abs(demand.value - expected) <= AGREEMENT * largest:
                        other = (same or independent[0]).name
                        x, y = nodes[node]
                        return None, (f"{demand.place}: found {float(demand.value)!r} at ({float(x)!r}, {float(y)!r}), "
                                      f"expected {float(expected)!r} as on boundary {other!r}")
                else:
                    independent.append(demand)
            found._hold(node, independent)
        return found, None

    def _hold(self, node, demands):
        if len(demands) == 1:
            (demand,) = demands
            self.holders.append((demand.name, node, demand.direction, demand.direction))
            if demand.oblique:
                self.axis[node] = demand.direction
                self.held[node, 0], self.data[node, 0] = True, demand.value
            else:
                k = int(demand.direction[0] == 0)
                self.held[node, k], self.data[node, k] = True, demand.direction[k] * demand.value
            return
        directions = np.array([d.direction for d in demands])
        duals = np.linalg.inv(directions)  # column i: one along direction i, nothing along the other
        for i, demand in enumerate(demands):
            self.holders.append((demand.name, node, demand.direction, duals[:, i]))
        self.held[node] = True
        self.data[node] = duals @ [d.value for d in demands]

    @property
    def turned(self):
        """The nodes with a frame of their own."""
        return np.flatnonzero(self.axis[:, 1] != 0)

    def into_frames(self, u):
        """The components in the frames of a field over the first nodes."""
        c, s = self.axis[: len(u) // 2].T
        x, y = u[0::2], u[1::2]
        return np.column_stack((c * x + s * y, c * y - s * x)).ravel()

    def from_frames(self, q):
        c, s = self.axis[: len(q) // 2].T
        along, across = q[0::2], q[1::2]
        return np.column_stack((c * along - s * across, s * along + c * across)).ravel()


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def _value_along(independent, same, direction):
    if same:
        return same.value * np.sign(same.direction @ direction)
    return direction @ np.linalg.solve([d.direction for d in independent], [d.value for d in independent])
