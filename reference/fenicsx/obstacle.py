"""Rigid obstacles: gap and direction of contact from the closest point (docs/case.md, [obstacle.NAME])."""

from dataclasses import dataclass

import numpy as np

from .expression import Expression

MOST_OFF = 0.1  # the length of a distance's gradient may be off 1 by so much


class NoDistance(Exception):
    """An expression that is no distance at a point, or a point without a closest one."""


@dataclass
class Plane:
    point: np.ndarray
    normal: np.ndarray  # a unit vector towards the body

    def closest(self, x):
        return (x - self.point) @ self.normal, -self.normal


@dataclass
class Circle:
    center: np.ndarray
    radius: float
    side: str  # where the body is

    def closest(self, x):
        out = x - self.center
        distance = np.hypot(*out)
        if distance == 0:
            raise NoDistance(f"no closest point at ({float(x[0])!r}, {float(x[1])!r}), the centre")
        return (distance - self.radius, -out / distance) if self.side == "outside" else (self.radius - distance, out / distance)


class NoLine(Exception):
    """Points and radii that make no line."""


@dataclass
class Polyline:
    """Straight sides and arcs, one after the other: ("line", a, b) and ("arc", a, b, centre, turn), turn > 0 to the left."""

    pieces: list
    closed: bool
    side: str  # where the body is for somebody who walks along it

    @staticmethod
    def through(points, radii, side):
        closed = len(points) > 1 and bool(np.all(points[0] == points[-1]))
        points = points[:-1] if closed else points
        n = len(points)
        if n < (3 if closed else 2):
            raise NoLine(f"{n + closed} points")
        steps = [points[(k + 1) % n] - points[k] for k in range(n if closed else n - 1)]
        lengths = [np.hypot(*step) for step in steps]
        if min(lengths) == 0:
            raise NoLine("a point that follows itself")
        along = [step / length for step, length in zip(steps, lengths)]
        corners = range(n) if closed else range(1, n - 1)
        if len(radii) not in (0, 1, len(corners)):
            raise NoLine(f"{len(radii)} radii for {len(corners)} corners")
        turns, cuts, rounding = [0.0] * n, [0.0] * n, [0.0] * n
        for i, k in enumerate(corners):
            before, after = along[k - 1], along[k % len(along)]
            turns[k] = np.arctan2(before[0] * after[1] - before[1] * after[0], before @ after)
            if np.pi - abs(turns[k]) <= 1e-8:
                raise NoLine("a line that turns back")
            rounding[k] = (radii[i] if len(radii) > 1 else radii[0]) if radii else 0.0
            cuts[k] = rounding[k] * np.tan(abs(turns[k]) / 2) if abs(turns[k]) > 1e-8 else 0.0
        pieces = []
        for k, (t, length) in enumerate(zip(along, lengths)):
            end = (k + 1) % n
            if cuts[k] + cuts[end] > length * (1 + 1e-12):
                raise NoLine("arcs that are longer than the side between them")
            a, b = points[k] + cuts[k] * t, points[end] - cuts[end] * t
            if cuts[k] + cuts[end] < length * (1 - 1e-12):
                pieces.append(("line", a, b))
            if cuts[end] > 0:
                centre = b + np.sign(turns[end]) * rounding[end] * np.array([-t[1], t[0]])
                pieces.append(("arc", b, points[end] + cuts[end] * along[(k + 1) % len(along)], centre, turns[end]))
        return Polyline(pieces, closed, side)

    def closest(self, x):
        """The nearest of the points of all pieces, the first and the last of an open line going on straight."""
        best = None
        for k, piece in enumerate(self.pieces):
            before, after = not self.closed and k == 0, not self.closed and k == len(self.pieces) - 1
            for place, normal in _feet(piece, x, before, after):
                distance = np.hypot(*(x - place))
                if best is None or distance < best[0] - 1e-13 * (1 + distance):
                    best = (distance, place, [normal])
                elif np.hypot(*(place - best[1])) <= 1e-12 * (1 + np.hypot(*place)):
                    best[2].append(normal)
        distance, place, normals = best
        out = sum(normals) / np.hypot(*sum(normals))
        sign = -1.0 if (x - place) @ out < 0 else 1.0
        sharp = any(normal @ out < 1 - 1e-12 for normal in normals) and distance > 1e-12 * (1 + np.hypot(*place))
        growth = sign * (x - place) / distance if sharp else out
        gap = sign * distance
        return (gap, -growth) if self.side == "left" else (-gap, growth)


def _feet(piece, x, before, after):
    """The closest point of a piece, and the normal to the left there."""
    kind, a, b, *arc = piece
    if kind == "line":
        t = (b - a) / np.hypot(*(b - a))
        s = (x - a) @ t
        s = s if before else max(s, 0.0)
        s = s if after else min(s, np.hypot(*(b - a)))
        yield a + s * t, np.array([-t[1], t[0]])
        return
    centre, turn = arc
    left = lambda place: np.sign(turn) * (centre - place) / np.hypot(*(centre - place))
    out = x - centre
    angle = lambda v: np.arctan2(*(np.array([(a - centre)[0] * v[1] - (a - centre)[1] * v[0], (a - centre) @ v]))) * np.sign(turn) % (2 * np.pi)
    if np.hypot(*out) > 0 and angle(out) < abs(turn):
        place = centre + out * np.hypot(*(a - centre)) / np.hypot(*out)
        yield place, left(place)
    for end, beyond in ((a, before), (b, after)):
        yield end, left(end)
        if beyond:  # the straight side beyond an arc
            n = left(end)
            t = np.array([n[1], -n[0]]) * (1 if end is b else -1)
            s = max((x - end) @ t, 0.0)
            yield end + s * t, n


@dataclass
class Distance:
    expression: Expression

    def closest(self, x):
        """phi / |grad phi| and -grad phi / |grad phi|: the distance to first order."""
        with np.errstate(all="ignore"):
            value, *gradient = self.expression.run({"x": _Dual(x[0], 1.0, 0.0), "y": _Dual(x[1], 0.0, 1.0)}, _DUAL, _Dual).parts()
        length = np.hypot(*gradient)
        if not np.isfinite(value) or not abs(length - 1) <= MOST_OFF:
            raise NoDistance(f"{float(value)!r} with a gradient of length {float(length)!r} at ({float(x[0])!r}, {float(x[1])!r})")
        return value / length, -np.array(gradient) / length


class _Dual:
    """A value with its derivatives along x and y."""

    def __init__(self, value, dx=0.0, dy=0.0):
        self.value, self.d = np.float64(value), np.array([dx, dy])

    def parts(self):
        return self.value, *self.d

    def chain(self, value, slope):
        return _Dual(value, *(slope * self.d))


def _power(a, b):
    value = a.value**b.value
    d = np.zeros(2)
    if np.any(a.d):
        d = d + b.value * a.value ** (b.value - 1) * a.d
    if np.any(b.d):
        d = d + value * np.log(a.value) * b.d
    return _Dual(value, *d)


_DUAL = {
    "+": lambda a, b: _Dual(a.value + b.value, *(a.d + b.d)),
    "-": lambda a, b: _Dual(a.value - b.value, *(a.d - b.d)),
    "*": lambda a, b: _Dual(a.value * b.value, *(b.value * a.d + a.value * b.d)),
    "/": lambda a, b: _Dual(a.value / b.value, *((a.d - a.value / b.value * b.d) / b.value)),
    "^": _power,
    "negative": lambda a: _Dual(-a.value, *-a.d),
    "sqrt": lambda a: a.chain(np.sqrt(a.value), 0.5 / np.sqrt(a.value)),
    "sin": lambda a: a.chain(np.sin(a.value), np.cos(a.value)),
    "cos": lambda a: a.chain(np.cos(a.value), -np.sin(a.value)),
    "exp": lambda a: a.chain(np.exp(a.value), np.exp(a.value)),
    "abs": lambda a: a.chain(abs(a.value), np.sign(a.value)),
    "min": lambda a, b: a if a.value <= b.value else b,
    "max": lambda a, b: a if a.value >= b.value else b,
}
