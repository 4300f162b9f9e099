"""Writes reference/cases/*.toml: the example cases, the exact solutions on several meshes, and parts, P1 and P2, Gauss 4 and exact; with
friction Gauss 11, which is exact to degree 21, and exact.

Each is a complete case file. The patch tests use the mesh square.msh, which Gmsh 4.8.4 made from square.geo, as the other meshes. Meshes with n <= 8 have all
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
WITH_FRICTION = {"gauss11": "{ gauss = 11 }", "exact": '"exact"'}

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
            f"[method]\ndegree = {degree}\ngamma0 = {gamma0}\ncontact_quadrature = {(QUADRATURES | WITH_FRICTION)[quadrature]}\n")


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


PARTS = {  # name: (what is in it, material, the rest)
    "bimaterial": ("two materials, loads by surface, an inclined floor, pressure, traction beside displacement, a point",
                   'plane = "stress"\n\n[material.pad]\nyoung = 1.0\npoisson = 0.4\n\n[material.punch]\nyoung = 20.0\npoisson = 0.3',
                   '[load]\nbody = ["0.01*x", 0]\n\n[load.punch]\nbody = [0, "-0.02*y"]\n\n'
                   '[obstacle.floor]\nplane = { point = [0, -0.08], normal = [-0.03, 1] }\n\n[point.peg]\ndisplacement = [0, "free"]\n\n'
                   '[boundary.top]\ndisplacement = ["free", "-0.05 - 0.01*x"]\ntraction = ["0.02*x", 0]\n\n'
                   '[boundary.right]\npressure = "0.03*(1 + y)"\n\n[boundary.bottom]\ncontact = { obstacle = "floor" }'),
    "lug": ("two materials, contact with a floor, a wall and a pin in a bore, pressure on a fillet",
            'plane = "strain"\n\n[material.rubber]\nyoung = 20\npoisson = 0.45\n\n[material.steel]\nyoung = 210000\npoisson = 0.3',
            '[load.steel]\nbody = [0, -0.05]\n\n[obstacle.floor]\nplane = { point = [0, 0.01], normal = [0, 1] }\n\n'
            '[obstacle.wall]\nplane = { point = [-0.005, 0], normal = [2, 0] }\n\n'
            '[obstacle.pin]\ncircle = { center = [8, 30.005], radius = 3.99, side = "outside" }\n\n[boundary.base]\n'
            'contact = { obstacle = "floor" }\n\n[boundary.back]\ncontact = { obstacle = "wall" }\n\n[boundary.bore]\n'
            'contact = { obstacle = "pin" }\n\n[boundary.fillet]\npressure = 3\n\n[boundary.right]\ntraction = [-2, 0]\n\n'
            '[boundary.top]\ndisplacement = [-0.004, -0.01]'),
    "seat": ("a shaft in a bearing, pushed along the normal of its chord, held at a point", "lambda = 1.5\nmu = 1.0",
             '[obstacle.bearing]\ncircle = { center = [0.005, -0.01], radius = 1.02, side = "inside" }\n\n[point.key]\n'
             'displacement = [0.01, "free"]\n\n[boundary.chord]\nnormal = "-0.05 + 0.01*x"\n\n[boundary.arc]\ncontact = { obstacle = "bearing" }'),
    "cam": ("a notch on a cam that is given by its distance, held along a tangent and a normal", "lambda = 1.0\nmu = 1.0",
            '[load]\nbody = ["0.02", "-0.1"]\n\n[obstacle.cam]\ndistance = "sqrt(x^2 + (y + 0.8)^2) - 1"\n\n[boundary.top]\n'
            'normal = "-0.04*exp(0.1*x)"\ntangential = "0.01"\n\n[boundary.notch]\ncontact = { obstacle = "cam" }'),
    "fillet": ("straight lines that go over into arcs, a gap along the normal of the smooth boundary", "young = 2.0\npoisson = 0.3",
               '[boundary.top]\ndisplacement = [0.02, -0.06]\n\n[boundary.right]\nnormal = 0.02\n\n[boundary.foot]\n'
               'contact = { gap = "0.01 + 0.08*y + 0.01*x" }'),
}


def parts():
    for name, (what, material, middle) in PARTS.items():
        for degree in (1, 2):
            for quadrature in QUADRATURES:
                text = case(f"Part: {what}, P{degree}, {quadrature}", f'gmsh = "{name}.msh"', material, middle, degree, '"auto"', quadrature)
                yield f"{name}-p{degree}-{quadrature}", text + probes(gmsh.read(FOLDER / f"{name}.msh").points)


LAWS = {
    "orthotropic": "orthotropic = { e1 = 12, e2 = 0.6, e3 = 0.9, nu12 = 0.4, nu13 = 0.4, nu23 = 0.3, g12 = 0.7, angle = 30 }",
    "stiffness": 'stiffness = [12, 3, 2, 5, -1, 2]\nplane = "stress"',
}


def tensors():
    shape = (2.0, 1.0, 8, 4, "crossed")
    middle = ('[boundary.top]\ndisplacement = [0.01, "-0.05 - 0.02*x"]\n\n[obstacle.drum]\n'
              'circle = { center = [0.8, -5.01], radius = 5, side = "outside" }\n\n[boundary.bottom]\ncontact = { obstacle = "drum" }')
    for name, law in LAWS.items():
        for degree in (1, 2):
            for quadrature in QUADRATURES:
                text = case(f"A tensor: {name}, on a drum, P{degree}, {quadrature}", rectangle_line(*shape), law, middle, degree, '"auto"', quadrature)
                yield f"{name}-p{degree}-{quadrature}", text + probes(rectangle(*shape).points)


REVOLUTIONS = {  # name: (what is in it, mesh, its points, material, the rest)
    "plug": ("a solid cylinder with pressure on its side is pushed on a ball, a load in it", rectangle_line(1.0, 1.0, 6, 6, "crossed"),
             lambda: rectangle(1.0, 1.0, 6, 6, "crossed").points, "lambda = 1.5\nmu = 1.0",
             '[load]\nbody = ["0.02*x", "-0.05"]\n\n[obstacle.ball]\ncircle = { center = [0, -2.01], radius = 2, side = "outside" }\n\n'
             '[boundary.top]\ndisplacement = ["free", "-0.05 - 0.02*x"]\ntraction = ["0.01*x", 0]\n\n[boundary.right]\n'
             'pressure = "0.02*(1 + y)"\n\n[boundary.bottom]\ncontact = { obstacle = "ball" }'),
    "collar": ("a hub is pushed on a cone", 'gmsh = "../../cases/hub.msh"', lambda: gmsh.read(FOLDER.parents[1] / "cases" / "hub.msh").points,
               "young = 210000\npoisson = 0.3",
               '[obstacle.cone]\nplane = { point = [20.02, 0], normal = [1, 0.05] }\n\n[boundary.back]\ndisplacement = ["free", -0.05]\n\n'
               '[boundary.bore]\ncontact = { obstacle = "cone" }'),
}


def revolutions():
    for name, (what, mesh, points, material, middle) in REVOLUTIONS.items():
        for degree in (1, 2):
            for quadrature in QUADRATURES:
                text = case(f"A body of revolution: {what}, P{degree}, {quadrature}", mesh, f'{material}\nplane = "axisymmetric"', middle, degree,
                            '"auto"', quadrature)
                yield f"{name}-p{degree}-{quadrature}", text + probes(points())


def of_cells(*shape):
    return rectangle_line(*shape), lambda: rectangle(*shape).points


def of_file(name):
    return f'gmsh = "{name}.msh"', lambda: gmsh.read(FOLDER / f"{name}.msh").points


FRICTION = {  # name: (what is in it, (mesh, its points), material, the rest)
    "tresca": ("a block with a given slip bound, in part across an open gap, is turned and dragged", of_cells(1.0, 1.0, 8, 8, "crossed"), LAME,
               '[boundary.top]\ndisplacement = ["0.02 + 0.01*x", "-0.05 - 0.02*x"]\n\n'
               '[boundary.bottom]\ncontact = { gap = "0.2*(x - 0.7)^2", friction = { tresca = "0.02 + 0.03*x" } }'),
    "drag": ("a pad with Coulomb's friction is pressed and dragged", of_cells(4.0, 1.0, 16, 4, "left"), "young = 10.0\npoisson = 0.3",
             '[boundary.top]\ndisplacement = ["0.01", "-0.01 - 0.002*x"]\n\n[boundary.bottom]\n'
             'contact = { gap = "0", friction = { coulomb = 0.4 } }'),
    "stay": ("a block that Coulomb's friction alone holds, on two boundaries", of_cells(2.0, 1.0, 8, 4, "right"), "young = 1.0\npoisson = 0.3",
             '[load]\nbody = ["0.006*y", "-0.02"]\n\n[boundary.bottom]\ncontact = { gap = "0", friction = { coulomb = 0.5 } }\n\n'
             '[boundary.right]\ncontact = { gap = "0.001", friction = { tresca = "0.001*y" } }'),
    "journal": ("a shaft in a bearing with Coulomb's friction, along which the direction turns", of_file("seat"), "lambda = 1.5\nmu = 1.0",
                '[obstacle.bearing]\ncircle = { center = [0.005, -0.01], radius = 1.02, side = "inside" }\n\n[point.key]\n'
                'displacement = [0.01, "free"]\n\n[boundary.chord]\nnormal = "-0.05 + 0.01*x"\n\n[boundary.arc]\n'
                'contact = { obstacle = "bearing", friction = { coulomb = 0.3 } }'),
    "grain": ("a tensor with a given slip bound on a drum", of_cells(2.0, 1.0, 8, 4, "crossed"), LAWS["orthotropic"],
              '[boundary.top]\ndisplacement = [0.03, "-0.05 - 0.02*x"]\n\n[obstacle.drum]\n'
              'circle = { center = [0.8, -5.01], radius = 5, side = "outside" }\n\n[boundary.bottom]\n'
              'contact = { obstacle = "drum", friction = { tresca = 0.03 } }'),
}


def friction():
    for name, (what, (mesh, points), material, middle) in FRICTION.items():
        for degree in (1, 2):
            for quadrature in WITH_FRICTION:
                text = case(f"Friction: {what}, P{degree}, {quadrature}", mesh, material, middle, degree, '"auto"', quadrature)
                yield f"friction-{name}-p{degree}-{quadrature}", text + probes(points())


def main():
    for name, text in (*examples(), *exact_solutions(), *patches(), *parts(), *tensors(), *revolutions(), *friction()):
        (FOLDER / f"{name}.toml").write_text(text)


if __name__ == "__main__":
    main()
