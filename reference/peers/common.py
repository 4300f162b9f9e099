"""What the scripts for the other codes share: the problem, Newton's method, the clock, the line of JSON.

The problem is in a file that the bench writes: a body of triangles, P1 (for DOLFINx also P2), with constant moduli (plane strain), a body force (0, a + b x), a
displacement (0, c) prescribed on the edges `held`, and contact of the edges `floor` with a rigid floor at the height `level`. Its direction
is d = (0, -1), and the gap is y - level. Method (8) with 4 Gauss points per contact edge:

    A(u, v) + int (1/gamma) [P(u)]+ P0(v) = L(v),   A(u, v) = a(u, v) - int gamma sigma_n(u) sigma_n(v),   sigma_n(v) = d . sigma(v) n,
    P0(v) = v . d - gamma sigma_n(v),   P = P0 - gap,   gamma = gamma0 h_T, h_T being the longest edge of the triangle.

A script is called as `script small.json body.json gamma0 solver` and prints one line of JSON. Its clock starts with mesh, space, compiled forms and (where
the code has one) the pattern of the matrix ready; the small body goes before, so that nothing is timed that happens once per process.
The volume terms are constant and assembled once; each Newton step assembles the contact terms, adds them and factors the sum, with the
analysis of the pattern kept where the code can keep it.
"""

import json
import subprocess
import sys
import time

import numpy as np

# Of the residual, relative to the one at u = 0, which is the load. With the rule for the contact edges Newton's method ends after finitely many
# steps, from some 1e-3 at once to rounding, which is 1.5e-8 on the graded square of P2 and 1e-13 on squares.
TOLERANCE = 1e-7
MOST_STEPS = 50


def newton(residual, correction, norm, start):
    """The zero of `residual`, the number of steps, by full steps of Newton's method: u <- u - correction(u, residual(u))."""
    u, steps = start, 0
    r = residual(u)
    first = norm(r)
    while norm(r) > TOLERANCE * first:
        if steps == MOST_STEPS:
            sys.exit(f"Newton's method does not converge: |R| = {norm(r)} after {steps} steps, at first {first}")
        u = u - correction(u, r)
        r = residual(u)
        steps += 1
    return u, steps


class Body:
    """The problem of a file: its data under their names there, edges with their triangles, h of each triangle."""

    def __init__(self, path):
        with open(path) as file:
            self.__dict__.update(json.load(file))
        self.vertices, self.triangles = np.array(self.vertices), np.array(self.triangles)
        corners = self.vertices[self.triangles]
        self.h = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        self.held, self.floor = np.array(self.held), np.array(self.floor)

    def sides(self, edges):
        """The triangle of each of these boundary edges, and the place in it of the vertex opposite."""
        places = {}
        for k in range(3):
            a, b = self.triangles[:, (k + 1) % 3], self.triangles[:, (k + 2) % 3]
            places.update(zip(zip(np.minimum(a, b), np.maximum(a, b)), ((t, k) for t in range(len(a)))))
        return np.array([places[min(edge), max(edge)] for edge in edges.tolist()])


class Clock:
    """Seconds of named parts of the work."""

    def __init__(self):
        self.seconds = {}

    def time(self, name, work):
        start = time.perf_counter()
        result = work()
        self.seconds[name] = time.perf_counter() - start
        return result


def peak_memory():
    """The most resident memory that this process has had, in bytes."""
    with open("/proc/self/status") as status:
        return next(1024 * int(line.split()[1]) for line in status if line.startswith("VmHWM"))


def debian(package):
    """The version of an installed Debian package."""
    query = ["dpkg-query", "-W", "-f", "${Version}", package]
    return subprocess.run(query, capture_output=True, text=True, check=True).stdout


def main(solvers, versions, run):
    """`run(body, gamma0, solver, clock)` times "assembly", "factor" and "contact" and returns (a(u, u), Newton steps)."""
    if len(sys.argv) != 5 or sys.argv[4] not in solvers:
        sys.exit(f"usage: {sys.argv[0]} small.json body.json gamma0 {'|'.join(solvers)}")
    small, body, gamma0, solver = sys.argv[1:]
    run(Body(small), float(gamma0), solver, Clock())
    body = Body(body)
    before, clock = peak_memory(), Clock()
    energy, steps = run(body, float(gamma0), solver, clock)
    print(json.dumps({"versions": versions, "seconds": clock.seconds, "steps": steps, "energy": energy,
                      "memory": peak_memory(), "memory_before": before}))
