"""Built-in exact solutions of (1)-(2): displacement, gradient, body force and gap, as numpy functions of x and y.

lam below is lambda in plane strain and lambda* = 2 lambda mu / (lambda + 2 mu) in plane stress. The contact boundary lies on y = 0
with n = (0, -1). Each class says on which domain it is exact and which boundaries carry what.
"""

import math

import numpy as np

from . import taylor

GAP = "an expression of x"
FINITE = ("a finite number", math.isfinite)
POSITIVE = ("a positive number", lambda a: a > 0)
INSIDE = ("a number between 0 and 1", lambda c: 0 < c < 1)


class Solution:
    """`cut`: the line x = cut where the load has a kink (or None); `apex`: where the stress is singular (or None), and there
    `edge_grading` g: with r = t^g the stress squared is smooth in t along the contact line, dr included."""

    cut = None
    apex = None

    def __init__(self, material, **parameters):
        self.lam, self.mu = material.plane_lam, material.mu
        self.kolosov = (self.lam + 3 * self.mu) / (self.lam + self.mu)
        for name, value in parameters.items():
            setattr(self, name, value)

    def stress(self, x, y):
        """(sxx, syy, sxy) at the points."""
        (xx, xy), (yx, yy) = self.gradient(x, y)
        trace = self.lam * (xx + yy)
        return trace + 2 * self.mu * xx, trace + 2 * self.mu * yy, self.mu * (xy + yx)

    def body_force(self, x, y):
        return np.zeros_like(x), np.zeros_like(x)

    def gap(self, x, y):
        return np.zeros_like(x)


class Smooth(Solution):
    """Unit square, clamped on y = 1, tractions on x = 0 and x = 1: contact for x < c, open by ap [x-c]+^k for x > c.

    p = ap [x-c]+^k - g, q = -aq [c-x]+^m, B = 1 - 3 y^2 + 2 y^3, A = -y B:  u = (A p', B p - A q).
    """

    parameters = {"c": INSIDE, "k": ("a number above 2.5", lambda k: k > 2.5), "m": ("a number above 1.5", lambda m: m > 1.5),
                  "ap": POSITIVE, "aq": POSITIVE, "gap": GAP}

    def __init__(self, material, gap, **parameters):
        super().__init__(material, **parameters)
        self.floor, self.cut = gap, parameters["c"]

    def gap(self, x, y):
        return self.floor.values(x, y)

    def _profiles(self, x, y):
        def power(t, e):
            return np.where(t > 0, np.abs(t) ** e, 0.0)

        k, m, right, left = self.k, self.m, x - self.c, self.c - x
        p = [self.ap * power(right, k), self.ap * k * power(right, k - 1), self.ap * k * (k - 1) * power(right, k - 2),
             self.ap * k * (k - 1) * (k - 2) * power(right, k - 3)]
        p = [opening - gap for opening, gap in zip(p, taylor.derivatives(self.floor, x))]
        q = [-self.aq * power(left, m), self.aq * m * power(left, m - 1), -self.aq * m * (m - 1) * power(left, m - 2)]
        A = [-(y - 3 * y**3 + 2 * y**4), -(1 - 9 * y**2 + 8 * y**3), 18 * y - 24 * y**2]
        B = [1 - 3 * y**2 + 2 * y**3, -6 * y + 6 * y**2, -6 + 12 * y]
        return p, q, A, B

    def displacement(self, x, y):
        p, q, A, B = self._profiles(x, y)
        return A[0] * p[1], B[0] * p[0] - A[0] * q[0]

    def gradient(self, x, y):
        p, q, A, B = self._profiles(x, y)
        return (A[0] * p[2], A[1] * p[1]), (B[0] * p[1] - A[0] * q[1], B[1] * p[0] - A[1] * q[0])

    def body_force(self, x, y):
        p, q, A, B = self._profiles(x, y)
        both, mu = self.lam + self.mu, self.mu
        return (-both * (A[0] * p[3] + B[1] * p[1] - A[1] * q[1]) - mu * (A[0] * p[3] + A[2] * p[1]),
                -both * (A[1] * p[2] + B[2] * p[0] - A[2] * q[0]) - mu * (B[0] * p[2] - A[0] * q[2] + B[2] * p[0] - A[2] * q[0]))


class Singular(Solution):
    """Unit square, displacement given on x = 0, x = 1, y = 1, no load: contact for x < c, r^(3/2) singularity at (c, 0)."""

    parameters = {"c": INSIDE, "amplitude": POSITIVE}
    edge_grading = 4.0

    @property
    def apex(self):
        return self.c, 0.0

    def _polar(self, x, y):
        X, Y = x - self.c, np.maximum(y, 0.0)  # rounding must not put a point of the contact line below it
        return np.hypot(X, Y), np.arctan2(Y, X), Y

    def displacement(self, x, y):
        r, th, y = self._polar(x, y)
        scale = self.amplitude / (2 * self.mu)
        return (scale * (-(self.kolosov - 1) / 3 * r**1.5 * np.sin(1.5 * th) - y * np.sqrt(r) * np.cos(th / 2)),
                scale * ((self.kolosov + 1) / 3 * r**1.5 * np.cos(1.5 * th) + y * np.sqrt(r) * np.sin(th / 2)))

    def gradient(self, x, y):
        r, th, y = self._polar(x, y)
        R, I = -self.amplitude * np.sqrt(r) * np.sin(th / 2), self.amplitude * np.sqrt(r) * np.cos(th / 2)
        R1, I1 = self.amplitude / (2 * np.sqrt(r)) * np.sin(th / 2), self.amplitude / (2 * np.sqrt(r)) * np.cos(th / 2)
        less, more, mu2 = (self.kolosov - 1) / 2, (self.kolosov + 1) / 2, 2 * self.mu
        return ((less * R - y * I1) / mu2, (-more * I - y * R1) / mu2), ((more * I - y * R1) / mu2, (less * R + y * I1) / mu2)


class Corner(Solution):
    """Trapezoid (0,0), (1,0), (1,1), (cot omega, 1): full contact on y = 0, no traction on the slanted side, displacement
    given on x = 1 and y = 1, no load; u = O(r^alpha), sin(2 alpha omega) + alpha sin(2 omega) = 0, a = -1."""

    parameters = {"omega": ("an angle between pi/2 and pi", lambda omega: math.pi / 2 < omega < math.pi)}
    apex = (0.0, 0.0)

    def __init__(self, material, **parameters):
        super().__init__(material, **parameters)
        omega, self.a = self.omega, -1.0
        self.alpha = _bisect(lambda s: math.sin(2 * s * omega) + s * math.sin(2 * omega), 0.5 + 1e-9, 0.999)
        self.b = -self.a * (math.cos(2 * self.alpha * omega) + self.alpha * math.cos(2 * omega))
        self.edge_grading = 1 / (2 * self.alpha - 1)

    def displacement(self, x, y):
        y = np.maximum(y, 0.0)
        r, th, al = np.hypot(x, y), np.arctan2(y, x), self.alpha
        scale = r**al / (2 * self.mu)
        return (scale * ((self.kolosov * self.a - self.b) * np.cos(al * th) - al * self.a * np.cos((2 - al) * th)),
                scale * ((self.kolosov * self.a + self.b) * np.sin(al * th) - al * self.a * np.sin((2 - al) * th)))

    def gradient(self, x, y):
        z, al = x + 1j * np.maximum(y, 0.0), self.alpha
        d_phi, dd_phi, d_psi = self.a * al * z ** (al - 1), self.a * al * (al - 1) * z ** (al - 2), self.b * al * z ** (al - 1)
        by_x = (self.kolosov * d_phi - d_phi.conj() - z * dd_phi.conj() - d_psi.conj()) / (2 * self.mu)
        by_y = 1j * (self.kolosov * d_phi - d_phi.conj() + z * dd_phi.conj() + d_psi.conj()) / (2 * self.mu)
        return (by_x.real, by_y.real), (by_x.imag, by_y.imag)


def _bisect(f, low, high):
    """A root of f between two points of opposite sign, to the last bit."""
    positive_high = f(high) > 0
    while low < (middle := (low + high) / 2) < high:
        low, high = (low, middle) if (f(middle) > 0) == positive_high else (middle, high)
    return middle


class Patch(Solution):
    """u affine, so exact in P1 and P2: unit square, displacement given on y = 1, tractions on x = 0 and x = 1, no body force.

    A subclass names its parameters and gives `affine`: ((a, b, c), (d, e, f)) for u = (a x + b y + c, d x + e y + f).
    E1 = (lam+2mu)/(4mu(lam+mu)), E2 = lam/(4mu(lam+mu)).
    """

    def __init__(self, material, **parameters):
        super().__init__(material, **parameters)
        common = 4 * self.mu * (self.lam + self.mu)
        self.E1, self.E2 = (self.lam + 2 * self.mu) / common, self.lam / common

    def displacement(self, x, y):
        return tuple(a * x + b * y + c for a, b, c in self.affine())

    def gradient(self, x, y):
        return tuple((a + 0 * x, b + 0 * x) for a, b, _ in self.affine())


class Compression(Patch):
    """d1: full contact under the pressure p."""

    parameters = {"p": POSITIVE}

    def affine(self):
        return (self.p * self.E2, 0, 0), (0, -self.p * self.E1, 0)


class Separation(Patch):
    """d2: lifted by d under the horizontal tension p."""

    parameters = {"p": FINITE, "d": POSITIVE}

    def affine(self):
        return (self.p * self.E1, 0, 0), (0, -self.p * self.E2, self.d)


class AffineGap(Patch):
    """d3: full contact under the pressure p on a floor with the gap g0 - w x."""

    parameters = {"p": POSITIVE, "w": FINITE, "g0": FINITE}

    def affine(self):
        return (self.p * self.E2, -self.w, 0), (self.w, -self.p * self.E1, -self.g0)

    def gap(self, x, y):
        return self.g0 - self.w * x


class Grazing(Patch):
    """d4: nothing moves and P = 0 everywhere."""

    parameters = {}

    def affine(self):
        return (0, 0, 0), (0, 0, 0)


class Interference(Patch):
    """d5: clamped at y = 1, the floor d too high."""

    parameters = {"d": POSITIVE}

    def affine(self):
        return (0, 0, 0), (0, -self.d, self.d)

    def gap(self, x, y):
        return np.full_like(x, -self.d)


PATCHES = {"d1": Compression, "d2": Separation, "d3": AffineGap, "d4": Grazing, "d5": Interference}
SOLUTIONS = {"smooth": Smooth, "singular": Singular, "corner": Corner, "patch": None}
