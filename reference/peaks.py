"""Peak pressures on curved contact lines by a third program, for tests/suite/peaks.rs: it shares no code, no method and no mesh with the
other two.

    min 1/2 a(u, u)   over u with u . n_j <= g_j at every node j of the contact line

Biquadratic elements on a grid that is mapped exactly onto the body (the arc is an arc), the conditions of contact at the nodes by an
active set of multipliers, and the pressure at a node as its multiplier over its Simpson weight. numpy and scipy:

    python3 reference/peaks.py
"""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)
POINTS, WEIGHTS = (POINTS + 1) / 2, WEIGHTS / 2


def quadratic(t):
    """Values and derivatives of the three Lagrange functions on [0, 1]."""
    return np.array([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)]), np.array([4 * t - 3, 4 - 8 * t, 4 * t - 1])


class Body:
    """The image of [0, 1]^2 under `place(s, t)`, which gives x and its derivatives along s and t; t runs along the line of contact s = 0."""

    def __init__(self, place, s, t, lam, mu):
        self.place, self.lam, self.mu = place, lam, mu
        fine = [np.sort(np.concatenate((line, (line[1:] + line[:-1]) / 2))) for line in (s, t)]
        self.s, self.t = fine
        self.rows, self.columns = len(fine[0]), len(fine[1])
        self.x = np.array([[place(a, b)[0] for b in fine[1]] for a in fine[0]])
        self.K = self._stiffness(s, t)

    def node(self, i, j):
        return i * self.columns + j

    def _stiffness(self, s, t):
        entries = []
        for i, (s0, s1) in enumerate(zip(s, s[1:])):
            for j, (t0, t1) in enumerate(zip(t, t[1:])):
                nodes = np.array([self.node(2 * i + a, 2 * j + b) for a in range(3) for b in range(3)])
                block = np.zeros((18, 18))
                for p, v in zip(POINTS, WEIGHTS):
                    for q, w in zip(POINTS, WEIGHTS):
                        (A, dA), (B, dB) = quadratic(p), quadratic(q)
                        grid = np.column_stack((np.outer(dA, B).ravel() / (s1 - s0), np.outer(A, dB).ravel() / (t1 - t0)))
                        _, J = self.place(s0 + p * (s1 - s0), t0 + q * (t1 - t0))
                        G = grid @ np.linalg.inv(J)  # J[k] = (dx_k/ds, dx_k/dt)
                        weight = abs(np.linalg.det(J)) * (s1 - s0) * (t1 - t0) * v * w
                        both = self.mu * np.einsum("ic,jd->idjc", G, G) + self.lam * np.einsum("ic,jd->icjd", G, G)
                        both += self.mu * np.einsum("ik,jk,cd->icjd", G, G, np.eye(2))
                        block += weight * both.reshape(18, 18)
                dofs = np.column_stack((2 * nodes, 2 * nodes + 1)).ravel()
                entries.append((np.repeat(dofs, 18), np.tile(dofs, 18), block.ravel()))
        rows, columns, values = map(np.concatenate, zip(*entries))
        size = 2 * self.rows * self.columns
        return coo_matrix((values, (rows, columns)), (size, size)).tocsc()

    def solve(self, prescribed, normals, gaps):
        """(pressures at the nodes of the line, lengths they stand for); `prescribed`: {dof: value}."""
        size, m = self.K.shape[0], self.columns
        C = coo_matrix((np.ravel(normals), (np.repeat(np.arange(m), 2), [2 * self.node(0, j) + c for j in range(m) for c in (0, 1)])),
                       (m, size)).tocsr()
        fixed = np.array(sorted(prescribed))
        free = np.setdiff1d(np.arange(size), fixed)
        u = np.zeros(size)
        u[fixed] = [prescribed[dof] for dof in fixed]
        factor = splu(self.K[free][:, free])
        start, across = factor.solve(-(self.K @ u)[free]), factor.solve(C[:, free].T.toarray())
        S, opening = C[:, free] @ across, C @ u + C[:, free] @ start - gaps
        active = opening > 0
        for _ in range(100):
            force = np.zeros(m)
            force[active] = np.linalg.solve(S[np.ix_(active, active)], opening[active])
            again = np.where(active, force > 0, opening - S @ force > 0)
            if np.array_equal(again, active):
                weights = self._lengths()
                return force / weights, weights
            active = again
        raise RuntimeError("the active set does not settle")

    def _lengths(self):
        """int of the line's nodal functions, by Simpson's rule."""
        speed = np.array([np.hypot(*self.place(0.0, t)[1][:, 1]) for t in self.t])
        weights = np.zeros(self.columns)
        for j in range(0, self.columns - 1, 2):
            weights[j : j + 3] += (self.t[j + 2] - self.t[j]) / 6 * np.array([1, 4, 1])
        return weights * speed


def isotropic(young, poisson, plane):
    lam, mu = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    return (2 * lam * mu / (lam + 2 * mu) if plane == "stress" else lam), mu


def plate(n):
    """cases/pin.toml: a quarter of a square plate of side 120 with a hole of radius 20, on a pin that fits; its cut is moved by -0.02."""

    def place(s, t):
        a = np.pi / 2 * t
        e, de = np.array([np.cos(a), np.sin(a)]), np.pi / 2 * np.array([-np.sin(a), np.cos(a)])
        c, dc = (e[0], de[0]) if t <= 0.5 else (e[1], de[1])
        R, dR = 60 / c, -60 * dc / c**2
        return e * ((1 - s) * 20 + s * R), np.column_stack((e * (R - 20), de * ((1 - s) * 20 + s * R) + e * s * dR))

    layers = np.linspace(0, 1, n // 2 + 1) ** 1.5
    body = Body(place, layers, np.linspace(0, 1, n + 1), *isotropic(210000, 0.3, "stress"))
    prescribed = {}
    for i in range(body.rows):
        prescribed[2 * body.node(i, 0) + 1] = -0.02
        prescribed[2 * body.node(i, body.columns - 1)] = 0.0
    return body.solve(prescribed, [-x / np.hypot(*x) for x in body.x[0]], np.zeros(body.columns))


def shaft(n):
    """The lower half of a hollow shaft, 0.3 < r < 1, in a bearing of radius 1.002 that it touches at its lowest point; its cuts are moved by
    (0, -0.005). lambda = mu = 1, plane strain."""

    def place(s, t):
        a, r = np.pi * (1 + t), 1 - 0.7 * s
        e, de = np.array([np.cos(a), np.sin(a)]), np.pi * np.array([-np.sin(a), np.cos(a)])
        return r * e, np.column_stack((-0.7 * e, r * de))

    body = Body(place, np.linspace(0, 1, n // 3 + 1), np.linspace(0, 1, n + 1), 1.0, 1.0)
    prescribed = {}
    for i in range(body.rows):
        for j in (0, body.columns - 1):
            prescribed[2 * body.node(i, j)], prescribed[2 * body.node(i, j) + 1] = 0.0, -0.005
    out = body.x[0] - [0, 0.002]
    distance = np.hypot(*out.T)
    return body.solve(prescribed, out / distance[:, None], 1.002 - distance)


def main():
    for case in (plate, shaft):
        for n in (24, 48, 96):
            pressures, lengths = case(n)
            print(f"{case.__name__}: {n} elements along the line: peak {pressures.max():.5g}, force {pressures @ lengths:.6g}, "
                  f"contact on {lengths[pressures > 0].sum():.4g}")


if __name__ == "__main__":
    main()
