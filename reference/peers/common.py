"""What the scripts for the other codes share: the problem, Newton's method, the clock, the line of JSON.

The problem: the unit square in n x n cells, diagonals from the lower left to the upper right, P1, lambda = mu = 1 (plane strain),
body force (0, -4 + 10 x), the top clamped, contact with a rigid floor below. Method (8) with 4 Gauss points per contact edge:

    A(u, v) + int (1/gamma) [P(u)]+ P0(v) = L(v),   A(u, v) = a(u, v) - int gamma sigma_n(u) sigma_n(v),
    P0(v) = v_n - gamma sigma_n(v),   P = P0 (no gap),   gamma = gamma0 h_T,   and h_T = sqrt(2) / n for every triangle here.

A script is called as `script n gamma0 solver` and prints one line of JSON. Its clock starts with mesh, space, compiled forms and (where
the code has one) the pattern of the matrix ready; a run with n = 8 goes before, so that nothing is timed that happens once per process.
The volume terms are constant and assembled once; each Newton step assembles the contact terms, adds them and factors the sum, with the
analysis of the pattern kept where the code can keep it.
"""

import json
import subprocess
import sys
import time

TOLERANCE = 1e-10  # of the residual, relative to the one at u = 0, which is the load
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
    """`run(n, gamma0, solver, clock)` times "assembly", "factor" and "contact" and returns (a(u, u), Newton steps)."""
    if len(sys.argv) != 4 or sys.argv[3] not in solvers:
        sys.exit(f"usage: {sys.argv[0]} n gamma0 {'|'.join(solvers)}")
    n, gamma0, solver = int(sys.argv[1]), float(sys.argv[2]), sys.argv[3]
    run(8, gamma0, solver, Clock())
    before, clock = peak_memory(), Clock()
    energy, steps = run(n, gamma0, solver, clock)
    print(json.dumps({"versions": versions, "solver": solver, "n": n, "seconds": clock.seconds, "steps": steps, "energy": energy,
                      "memory": peak_memory(), "memory_before": before}))
