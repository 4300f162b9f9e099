"""Writes reference/cases/*.toml: the example cases and the exact solutions on several meshes, P1 and P2, Gauss 4 and exact.

Each is a complete case file. Meshes with n <= 8 have all their vertices as probes. A variant keeps the example's gamma0 if it keeps its
degree, and takes "auto" otherwise (the limit falls to a third from P1 to P2).

    PYTHONPATH=reference python3 reference/make_cases.py
"""

import math
from pathlib import Path

from fenicsx.mesh import rectangle

FOLDER = Path(__file__).parent / "cases"
QUADRATURES = {"gauss4": "{ gauss = 4 }", "exact": '"exact"'}

LAME = "lambda = 1.0\nmu = 1.0"
CLAMPED = 'displacement = ["0", "0"]'
EXAMPLES = {  # name: (mesh, material, load and boundaries, the example's (degree, gamma0))
    "block": (lambda n: (1.0, 1.0, n, n, "right"), LAME,
              f'[load]\nbody = ["0", "-4 + 10*x"]\n\n[boundary.top]\n{CLAMPED}\n\n[boundary.bottom]\ncontact = {{ gap = "0" }}', (1, "0.1")),
    "gap": (lambda n: (1.0, 1.0, n, n, "crossed"), LAME,
            '[boundary.top]\ndisplacement = ["0", "-0.05"]\n\n[boundary.bottom]\ncontact = { gap = "0.2*(x - 0.3)^2" }', (1, '"auto"')),
    "cantilever": (lambda n: (2.0, 1.0, n, n // 2, "left"), "young = 1.0\npoisson = 0.3",
                   f'[boundary.left]\n{CLAMPED}\n\n[boundary.top]\ntraction = ["0", "-0.02"]\n\n'
                   '[boundary.bottom]\ncontact = { gap = "0.1" }', (2, '"auto"')),
}


def rectangle_line(width, height, nx, ny, diagonal):
    return f'rectangle = {{ width = {width}, height = {height}, nx = {nx}, ny = {ny}, diagonal = "{diagonal}" }}'


def probes(points):
    return "\n[output]\nprobes = [\n" + "".join(f"    [{float(x)!r}, {float(y)!r}],\n" for x, y in points) + "]\n"


def case(title, mesh, material, middle, degree, gamma0, quadrature):
    return (f'title = "{title}"\n\n[mesh]\n{mesh}\n\n[material]\n{material}\n\n{middle}\n\n'
            f"[method]\ndegree = {degree}\ngamma0 = {gamma0}\ncontact_quadrature = {QUADRATURES[quadrature]}\n")


def examples():
    for name, (shape, material, middle, (own_degree, own_gamma0)) in EXAMPLES.items():
        for n in (4, 8, 16):
            for degree in (1, 2):
                for quadrature in QUADRATURES:
                    gamma0 = own_gamma0 if degree == own_degree else '"auto"'
                    text = case(f"{name}, P{degree}, n = {n}, {quadrature}", rectangle_line(*shape(n)), material, middle, degree, gamma0,
                                quadrature)
                    if n <= 8:
                        text += probes(rectangle(*shape(n)).points)
                    yield f"{name}-p{degree}-{quadrature}-n{n}", text


def main():
    FOLDER.mkdir(exist_ok=True)
    for name, text in examples():
        (FOLDER / f"{name}.toml").write_text(text)


if __name__ == "__main__":
    main()
