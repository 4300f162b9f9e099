"""Writes reference/cases/*.toml: the example cases and the exact solutions on several meshes, P1 and P2, Gauss 4 and exact.

Each is a complete case file. The patch tests use the mesh square.msh, which Gmsh 4.8.4 made from square.geo. Meshes with n <= 8 have all
their vertices as probes. A variant keeps the example's gamma0 if it keeps its degree, and takes "auto" otherwise (the limit falls to a
third from P1 to P2).

    PYTHONPATH=reference python3 reference/make_cases.py
"""

import math
from pathlib import Path

from fenicsx import gmsh
from fenicsx.mesh import rectangle, trapezoid

FOLDER = Path(__file__).parent / "cases"
OMEGA = 3 * math.pi / 4
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


SOLUTIONS = {  # name: (mesh of n, its points, [exact], kinds of bottom, left, right, top)
    "smooth": (lambda n: rectangle_line(1.0, 1.0, n, n, "right"), lambda n: rectangle(1.0, 1.0, n, n, "right").points,
               'solution = "smooth"\nc = 0.5\nk = 3\nm = 2\nap = 8\naq = 4', "contact traction traction displacement"),
    "smooth-gap": (lambda n: rectangle_line(1.0, 1.0, n, n, "right"), lambda n: rectangle(1.0, 1.0, n, n, "right").points,
                   f'solution = "smooth"\nc = {1 / 3!r}\nk = 4\nm = 3\nap = 16\naq = 8\ngap = "0.2 - 0.3*x + 0.5*x^2"',
                   "contact traction traction displacement"),
    "singular": (lambda n: rectangle_line(1.0, 1.0, n, n, "right"), lambda n: rectangle(1.0, 1.0, n, n, "right").points,
                 'solution = "singular"\nc = 0.5\namplitude = 1', "contact displacement displacement displacement"),
    "corner": (lambda n: f"trapezoid = {{ omega = {OMEGA!r}, n = {n} }}", lambda n: trapezoid(OMEGA, n).points,
               f'solution = "corner"\nomega = {OMEGA!r}', "contact traction displacement displacement"),
}
PATCHES = {"d1": "p = 0.3", "d2": "p = 0.3\nd = 0.1", "d3": "p = 0.3\nw = 0.2\ng0 = 0.1", "d4": "", "d5": "d = 0.1"}


def exact_middle(parameters, kinds):
    sides = "".join(f'{side} = "{kind}"\n' for side, kind in zip(("bottom", "left", "right", "top"), kinds.split()))
    return f"[exact]\n{parameters.strip()}\n\n[boundary]\n{sides.strip()}"


def exact_solutions():
    for name, (mesh, points, parameters, kinds) in SOLUTIONS.items():
        for n in (4, 8, 16):
            for degree in (1, 2):
                for quadrature in QUADRATURES:
                    text = case(f"Exact solution: {name}, P{degree}, n = {n}, {quadrature}", mesh(n), LAME, exact_middle(parameters, kinds),
                                degree, '"auto"', quadrature)
                    if n <= 8:
                        text += probes(points(n))
                    yield f"{name}-p{degree}-{quadrature}-n{n}", text


def patches():
    for which, parameters in PATCHES.items():
        middle = exact_middle(f'solution = "patch"\nwhich = "{which}"\n{parameters}', "contact traction traction displacement")
        for degree in (1, 2):
            for quadrature in QUADRATURES:
                text = case(f"Patch test {which}, P{degree}, {quadrature}", 'gmsh = "square.msh"', "lambda = 3.0\nmu = 0.7", middle, degree,
                            '"auto"', quadrature)
                yield f"patch-{which}-p{degree}-{quadrature}", text + probes(gmsh.read(FOLDER / "square.msh").points)


def main():
    for name, text in (*examples(), *exact_solutions(), *patches()):
        (FOLDER / f"{name}.toml").write_text(text)


if __name__ == "__main__":
    main()
