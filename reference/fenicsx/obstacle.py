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
