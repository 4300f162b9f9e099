"""The case file: defaults, and the refusals with their messages."""

import math

from mpi4py import MPI

from fenicsx.case import CaseError, read_case
from fenicsx.problem import Problem
from fenicsx.solve import coercivity

from .support import BLOCK, ROOT, TestCase

CONTACT = '[boundary.bottom]\ncontact = { gap = "0" }\n'

# (what is replaced in BLOCK, by what, message behind the file's name)
REFUSED = [
    ("[mesh]", "titel = 1\n[mesh]", "titel: unknown key; known here: pair, step, body, material, exact, load, method, solver, output, units, title, mesh, boundary, obstacle, point"),
    ("[mesh]", "[mesh", "not a TOML file: Expected ']' at the end of a table declaration (at line 2, column 6)"),
    ("[material]\nlambda = 1.0\nmu = 1.0\n", "", "material: found nothing, expected a table"),
    ("mu = 1.0", "mu = -1.0", "material.mu: found -1.0, expected a positive number"),
    ("mu = 1.0", "mu = nan", "material.mu: found nan, expected a positive number"),
    ("mu = 1.0", "mu = true", "material.mu: found true, expected a positive number"),
    ("mu = 1.0", 'mu = "1"', 'material.mu: found "1", expected a positive number'),
    ("mu = 1.0", "", "material.mu: found nothing, expected a positive number"),
    ("lambda = 1.0", "lambda = inf", "material.lambda: found inf, expected a finite number"),
    ("lambda = 1.0", "lambda = -0.7", "material.lambda: found -0.7, expected 3 lambda + 2 mu > 0"),
    ("mu = 1.0", "mu = 1.0\nyoung = 1.0", "material: found lambda, mu, young, expected either lambda and mu, or young and poisson, or stiffness, or orthotropic"),
    ("lambda = 1.0\nmu = 1.0", 'stiffness = [1, 2, 0, 1, 0, 1]\nplane = "stress"',
     "material.stiffness: found the smallest eigenvalue -1, expected an elliptic law: a positive one, at least 1e-10 of the largest"),
    ("lambda = 1.0\nmu = 1.0", "stiffness = [3, 1, 0, 3, 0, 1]", "material.across: found nothing, expected a list of three numbers, in plane strain"),
    ("lambda = 1.0\nmu = 1.0", "young = 1.0\npoisson = 0.5", "material.poisson: found 0.5, expected a number above -1 and below 0.5"),
    ("mu = 1.0", 'mu = 1.0\nplane = "bent"', 'material.plane: found "bent", expected "strain" or "stress" or "axisymmetric"'),
    ("nx = 4", "nx = 0", "mesh.rectangle.nx: found 0, expected a positive integer"),
    ("nx = 4", "nx = 4.0", "mesh.rectangle.nx: found 4.0, expected a positive integer"),
    ("nx = 4", "nx = 4000000", "mesh.rectangle: found 16000000 cells, expected at most 4000000"),
    ("width = 1.0", "width = -1", "mesh.rectangle.width: found -1, expected a positive number"),
    ('diagonal = "right"', 'diagonal = "up"', 'mesh.rectangle.diagonal: found "up", expected "right" or "left" or "crossed"'),
    ("[material]", 'gmsh = "a.msh"\n[material]', "mesh: found rectangle, gmsh, expected exactly one of rectangle, gmsh, trapezoid"),
    ("[material]", "perturb = { amount = 0.2, seed = 1 }\n[material]",
     "mesh.perturb: found {'amount': 0.2, 'seed': 1}, expected no perturb: the reference has no generator of random meshes; give a Gmsh file"),
    (CONTACT, "", "boundary: found top, expected at least one boundary with contact"),
    (CONTACT, '[boundary.bottom]\n', "boundary.bottom: found nothing, expected exactly one of displacement, traction, pressure, normal and tangential, contact, force"),
    (CONTACT, CONTACT + 'traction = ["0", "0"]\n',
     "boundary.bottom: found traction, contact, expected exactly one of displacement, traction, pressure, normal and tangential, contact, force"),
    (CONTACT, CONTACT + 'friction = 0.3\n', "boundary.bottom.friction: unknown key; known here: displacement, traction, pressure, normal, tangential, contact, force"),
    ('gap = "0"', "gap = true", "boundary.bottom.contact.gap: found true, expected an expression of x and y in a string"),
    ('gap = "0"', 'obstacle = "floor"', 'boundary.bottom.contact.obstacle: found "floor", expected '),
    ("[load]", '[obstacle.o]\nplane = { point = [0, 0], normal = [0, 0] }\n[load]',
     "obstacle.o.plane.normal: found [0.0, 0.0], expected a vector that is not zero"),
    ("[load]", '[obstacle.o]\ncircle = { center = [0, 0], radius = 0, side = "inside" }\n[load]',
     "obstacle.o.circle.radius: found 0, expected a positive number"),
    ("[load]", "[obstacle.o]\n[load]", "obstacle.o: found nothing, expected exactly one of plane, circle, points, distance"),
    ("[load]", '[obstacle.o]\npoints = [[0, 0], [1, 0], [1, 1]]\nradius = 2\nside = "left"\n[load]',
     "obstacle.o.points: found arcs that are longer than the side between them, expected another line"),
    ("[load]", '[[pair]]\nboundaries = ["left", "right"]\n[load]',
     "pair: found a pair of boundaries, expected contact with rigid obstacles only: this engine has no contact between bodies"),
    ("[load]", '[[step]]\nboundary.top.displacement = ["0", "-0.1"]\n[load]',
     "step: found load steps, expected a case without: this engine solves one step"),
    ('gap = "0"', 'friction = { coulomb = -0.1 }',
     "boundary.bottom.contact.friction.coulomb: found -0.1, expected a coefficient, a number that is not negative"),
    ('gap = "0"', 'friction = { tresca = "0.5 - x" }',
     "boundary.bottom.contact.friction.tresca: found -0.25 at (0.75, 0.0), expected a stress that is not negative at every point of the boundary"),
    ('gap = "0"', 'friction = { tresca = "1/x" }', "boundary.bottom.contact.friction.tresca: found inf at (0.0, 0.0), expected a finite number"),
    ('gap = "0"', 'friction = {}', "boundary.bottom.contact.friction: found nothing, expected either tresca or coulomb"),
    ('gap = "0"', 'friction = { tresca = 1, coulomb = 0.1 }', "boundary.bottom.contact.friction: found tresca, coulomb, expected either tresca or coulomb"),
    ('gap = "0"', 'friction = { mu = 0.1 }', "boundary.bottom.contact.friction.mu: unknown key; known here: tresca, coulomb"),
    ("mu = 1.0\n[load]", 'mu = 1.0\nplane = "axisymmetric"\n[obstacle.o]\nplane = { point = [0, 0], normal = [0, 1] }\n[boundary.right]\n'
     'contact = { obstacle = "o", friction = { coulomb = 0.1 } }\n[load]',
     "boundary.right.contact.friction: found friction, expected none in a body of revolution"),
    ('[load]\nbody = ["0", "-4 + 10*x"]', '[obstacle.o]\ndistance = "2*y"\n[boundary.right]\ncontact = { obstacle = "o" }',
     "boundary.right.contact.obstacle: found 0.0 with a gradient of length 2.0 at (1.0, 0.0), expected a distance"),
    ("[load]", "[point.peg]\ndisplacement = [0, 0]\n[load]", "mesh: no point named 'peg'; this mesh has: none"),
    ("[load]", "[load.steel]\nbody = [0, 0]\n[load]", "mesh: no surface named 'steel'; this mesh has: none"),
    ('displacement = ["0", "0"]', 'displacement = ["free", "0"]\ntraction = [0, 1]',
     'boundary.top.traction[1]: found "1.0", expected 0 where the displacement is given'),
    ('gap = "0"', 'gap = "z"',
     'boundary.bottom.contact.gap: in "z", column 1: unknown name \'z\'; known: x, y, pi, sqrt, sin, cos, exp, abs, min, max'),
    ('gap = "0"', 'gap = "1/x"', "boundary.bottom.contact.gap: found inf at (0.0, 0.0), expected a finite number"),
    ('displacement = ["0", "0"]', 'displacement = ["0"]', "boundary.top.displacement: found ['0'], expected a list of two expressions"),
    ('displacement = ["0", "0"]', 'displacement = ["0", "0", "0"]',
     "boundary.top.displacement: found ['0', '0', '0'], expected a list of two expressions"),
    ('displacement = ["0", "0"]', 'displacement = ["free", "0"]',
     "boundary: a rigid motion is free; expected displacement boundaries that exclude translations and rotation"),
    ("[boundary.top]", "[boundary.roof]", "mesh: no boundary named 'roof'; this mesh has: bottom, left, right, top"),
    ('[boundary.top]', '[boundary.left]\ndisplacement = ["0.1", "0"]\n[boundary.top]',
     "boundary.top.displacement[0]: found 0.0 at (0.0, 1.0), expected 0.1 as on boundary 'left'"),
    ('"-4 + 10*x"', '"1/(x - x)"', "load: body force or traction is not finite on the mesh"),
    ("degree = 1", "degree = 3", "method.degree: found 3, expected 1 or 2"),
    ("degree = 1", "gamma0 = 0", 'method.gamma0: found 0, expected a positive number or "auto"'),
    ("degree = 1", 'gamma0 = "big"', 'method.gamma0: found "big", expected a positive number or "auto"'),
    ("degree = 1", 'contact_quadrature = "gauss"', 'method.contact_quadrature: found "gauss", expected "exact" or { gauss = n }'),
    ("degree = 1", "contact_quadrature = { gauss = 0 }",
     "method.contact_quadrature.gauss: found 0, expected a number of points from 1 to 64"),
    ("degree = 1", "[solver]\ntolerance = 0.0", "solver.tolerance: found 0.0, expected a positive number below 1"),
    ("degree = 1", "[output]\nprobes = [[0.5]]", "output.probes[0]: found [0.5], expected a point [x, y]"),
    ("[load]", '[exact]\nsolution = "patch"\nwhich = "d4"\n[load]', 
     "load: found {'body': ['0', '-4 + 10*x']}, expected no [load] beside [exact], which supplies it"),
    ('[load]\nbody = ["0", "-4 + 10*x"]', '[exact]\nsolution = "smooth"\nc = 0.5\nk = 3\nm = 2\nap = 8\naq = 4\ngap = "x*y"',
     'exact.gap: found "x*y", expected an expression of x'),
    ('[load]\nbody = ["0", "-4 + 10*x"]', '[exact]\nsolution = "rough"',
     'exact.solution: found "rough", expected "smooth" or "singular" or "corner" or "patch"'),
]


class Cases(TestCase):
    def test_defaults(self):
        case = read_case(self.file(BLOCK.replace("[method]\ndegree = 1\n", "").replace('{ gap = "0" }', "{}")))
        self.assertEqual((case.title, case.material.plane, case.degree, case.gamma0, case.gauss), ("", "strain", 1, "auto", None))
        self.assertEqual((case.tolerance, case.max_iterations, case.allow_noncoercive, case.probes), (1e-10, 200, False, []))
        self.assertEqual(case.boundaries["bottom"].data.text, "0")

    def test_integers_are_numbers(self):
        self.assertEqual(read_case(self.file(BLOCK.replace("mu = 1.0", "mu = 1"))).material.mu, 1.0)

    def test_young_and_poisson_are_the_lame_constants_of_three_dimensions(self):
        case = read_case(self.file(BLOCK.replace("lambda = 1.0\nmu = 1.0", 'young = 2.5\npoisson = 0.25\nplane = "stress"')))
        self.assertAlmostEqual(case.material.lam, 1.0, delta=1e-15)
        self.assertAlmostEqual(case.material.mu, 1.0, delta=1e-15)
        self.assertAlmostEqual(case.material.plane_lam, 2 / 3, delta=1e-15)

    def test_orthotropic_moduli_that_are_isotropic_are_young_and_poisson(self):
        for plane, beyond in (("stress", ""), ("strain", ", e3 = 2.5, nu13 = 0.25, nu23 = 0.25")):
            moduli = f'orthotropic = {{ e1 = 2.5, e2 = 2.5, nu12 = 0.25, g12 = 1.0, angle = 20{beyond} }}\nplane = "{plane}"'
            found = read_case(self.file(BLOCK.replace("lambda = 1.0\nmu = 1.0", moduli))).material
            expected = read_case(self.file(BLOCK.replace("mu = 1.0", f'mu = 1.0\nplane = "{plane}"'))).material
            for a, b in zip(found.in_plane + found.zz, expected.in_plane + expected.zz):
                self.assertAlmostEqual(a, b, delta=1e-14)

    def test_refusals_name_file_place_found_and_expected(self):
        for old, new, message in REFUSED:
            with self.subTest(message):
                self.assertIn(old, BLOCK)
                path = self.file(BLOCK.replace(old, new))
                with self.assertRaises(CaseError) as caught:
                    Problem(read_case(path), MPI.COMM_SELF)
                self.assertEqual(str(caught.exception), f"{path}: {message}")

    def test_missing_files_are_refused(self):
        with self.assertRaisesRegex(CaseError, "none.toml: cannot be read: No such file or directory"):
            read_case(self.folder / "none.toml")
        text = BLOCK.replace('rectangle = { width = 1.0, height = 1.0, nx = 4, ny = 4, diagonal = "right" }', 'gmsh = "none.msh"')
        with self.assertRaisesRegex(CaseError, "none.msh: cannot be read: No such file or directory"):
            Problem(read_case(self.file(text)), MPI.COMM_SELF)

    def test_kappa_of_one_or_more_is_refused_with_limit_and_edge(self):
        limit = 1 / (2 * math.sqrt(2) * 3)
        path = self.file(BLOCK.replace("degree = 1", f"gamma0 = {1.01 * limit!r}"))
        with self.assertRaisesRegex(CaseError, r"method.gamma0: found 0\.1190\d*, expected less than the limit 0\.1178\d* "
                                               r"\(kappa = 1\.01, set by the edge \[0\.0, 0\.0\] - \[0\.25, 0\.0\]\)"):
            coercivity(Problem(read_case(path), MPI.COMM_SELF))
        path = self.file(BLOCK.replace("degree = 1", f"gamma0 = {1.01 * limit!r}\nallow_noncoercive = true"))
        self.assertAlmostEqual(coercivity(Problem(read_case(path), MPI.COMM_SELF))["kappa"], 1.01)

    def test_example_cases_are_read(self):
        for name in ("block", "gap", "cantilever"):
            self.assertIn("bottom", read_case(ROOT / "cases" / f"{name}.toml").boundaries)
