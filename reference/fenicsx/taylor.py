"""Taylor polynomials of degree 3 in x, c0 + c1 t + c2 t^2 + c3 t^3 at many points at once: the derivatives of a gap function.

A polynomial is an array with the four coefficients first. `OPERATIONS` gives each operation of an Expression its meaning on them.
"""

import math

import numpy as np


def derivatives(expression, x):
    """(g, g', g'', g''') of an expression of x alone."""
    zero = np.zeros_like(x)
    c = expression.run({"x": np.array([x, zero + 1, zero, zero])}, OPERATIONS, lambda number: np.array([zero + number, zero, zero, zero]))
    return c[0], c[1], 2 * c[2], 6 * c[3]


def _times(a, b):
    return np.array([sum(a[i] * b[k - i] for i in range(k + 1)) for k in range(4)])


def _compose(c, f, f1, f2, f3):
    """The polynomial of f(c) from the values of f and its derivatives at c0."""
    return np.array([f, f1 * c[1], f1 * c[2] + f2 / 2 * c[1] ** 2, f1 * c[3] + f2 * c[1] * c[2] + f3 / 6 * c[1] ** 3])


def _power(a, b):
    """a^b for a constant b, at a0 = 0 too where the derivatives exist; otherwise exp(b log a)."""
    e = b[0].flat[0] if b.size else 1.0
    if np.any(b[1:]) or np.any(b[0] != e):
        return _exp(_times(b, _compose(a, np.log(a[0]), 1 / a[0], -1 / a[0] ** 2, 2 / a[0] ** 3)))
    factors = [math.prod(e - j for j in range(k)) for k in range(4)]
    return _compose(a, *(factor * a[0] ** (e - k) if factor else 0 * a[0] for k, factor in enumerate(factors)))


def _exp(a):
    value = np.exp(a[0])
    return _compose(a, value, value, value, value)


def _sin(a):
    s, c = np.sin(a[0]), np.cos(a[0])
    return _compose(a, s, c, -s, -c)


def _cos(a):
    s, c = np.sin(a[0]), np.cos(a[0])
    return _compose(a, c, -s, -c, s)


def _constant(a, number):
    return np.array([0 * a[0] + number, 0 * a[0], 0 * a[0], 0 * a[0]])


OPERATIONS = {"+": np.add, "-": np.subtract, "*": _times, "/": lambda a, b: _times(a, _power(b, _constant(b, -1.0))), "^": _power,
              "negative": np.negative, "sqrt": lambda a: _power(a, _constant(a, 0.5)), "exp": _exp, "sin": _sin, "cos": _cos,
              "abs": lambda a: np.where(a[0] < 0, -a, a), "min": lambda a, b: np.where(a[0] <= b[0], a, b),
              "max": lambda a, b: np.where(a[0] >= b[0], a, b)}
