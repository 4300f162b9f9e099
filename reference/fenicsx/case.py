"""The case file: its schema, defaults and refusals. Every message says which file, where, what was found, what was expected."""

import math
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import exact
from .expression import Expression, ExpressionError
from .obstacle import Circle, Distance, NoLine, Plane, Polyline

MOST_CELLS = 4_000_000  # nx * ny of a rectangle, checked before anything is allocated
KINDS = ("displacement", "traction", "contact")  # beside [exact]
CONDITIONS = ("displacement", "traction", "pressure", "normal", "tangential", "contact", "force")
MODULI = ("lambda", "mu", "young", "poisson", "stiffness", "orthotropic")


class CaseError(Exception):
    """The case is wrong: the command ends with code 2 and writes nothing."""


@dataclass
class Rectangle:
    width: float
    height: float
    nx: int
    ny: int
    diagonal: str


@dataclass
class Trapezoid:
    """The unit square mapped by (s, t) -> (s + (1-s) t cot(omega), t); n x n cells."""

    omega: float
    n: int


@dataclass
class Gmsh:
    path: Path


@dataclass
class Material:
    """The three-dimensional Lame constants, and what plane strain, plane stress or a body of revolution makes of them."""

    lam: float
    mu: float
    plane: str

    @property
    def plane_lam(self):
        """lambda in plane strain and in a body of revolution; lambda* = 2 lambda mu / (lambda + 2 mu) in plane stress."""
        return self.lam if self.plane != "stress" else 2 * self.lam * self.mu / (self.lam + 2 * self.mu)

    @property
    def in_plane(self):
        """C11, C12, C16, C22, C26, C66"""
        lam, mu = self.plane_lam, self.mu
        return lam + 2 * mu, lam, 0.0, lam + 2 * mu, 0.0, mu

    @property
    def zz(self):
        """What sigma_zz is of sigma_xx, sigma_yy, sigma_xy."""
        nu = self.lam / (2 * (self.lam + self.mu)) if self.plane == "strain" else 0.0
        return nu, nu, 0.0


@dataclass
class Tensor:
    """C11, C12, C16, C22, C26, C66 of a law in the plane, and in plane strain what sigma_zz is of sigma_xx, sigma_yy, sigma_xy."""

    stiffness: tuple
    across: tuple | None

    @property
    def plane(self):
        return "stress" if self.across is None else "strain"

    @property
    def in_plane(self):
        return self.stiffness

    @property
    def zz(self):
        return self.across or (0.0, 0.0, 0.0)


@dataclass
class Boundary:
    """What `data` holds, by kind; None where [exact] supplies it:

    displacement: two expressions, None for a free component; `traction`: two expressions that act in the free ones
    traction: two expressions; pressure: an expression; support: u . n and u . t, expressions or None
    force: two numbers, the whole force on the boundary, for the whole thickness
    contact: the gap, an expression, or an obstacle; `friction`: a coefficient or, for a given slip bound, an expression
    """

    kind: str
    data: object
    traction: object = None
    friction: object = None


@dataclass
class Case:
    path: Path
    title: str
    mesh: object
    materials: dict  # by surface; one for the whole body goes by None
    body: list
    bodies: dict  # loads by surface beside `body`
    boundaries: dict
    points: dict  # name -> two expressions, None for a free component
    degree: int
    gamma0: object  # a float, or "auto"
    gauss: object  # points per edge, or None for the exact integral
    allow_noncoercive: bool
    tolerance: float
    max_iterations: int
    exact: object
    probes: list = field(default_factory=list)
    thickness: float = 1.0

    @property
    def material(self):
        """The first material; all have the same `plane`."""
        return next(iter(self.materials.values()))

    @property
    def of_revolution(self):
        """x is the distance from the axis x = 0, y the place along it."""
        return self.material.plane == "axisymmetric"

    @property
    def is_isotropic(self):
        return all(isinstance(material, Material) for material in self.materials.values())

    def of_kind(self, kind):
        """{name: data} of the boundaries of one kind, in name order."""
        return {name: self.boundaries[name].data for name in sorted(self.boundaries) if self.boundaries[name].kind == kind}


class _Table:
    """A TOML table that remembers which of its keys were asked for."""

    def __init__(self, where, content, file):
        self.where, self.content, self.file, self.known = where, content, file, []
        if not isinstance(content, dict):
            self.fail("", content, "a table")

    def place(self, key):
        return ".".join(part for part in (self.where, key) if part)

    def fail(self, key, value, expected):
        self.refuse(key, _show(value), expected)

    def refuse(self, key, found, expected):
        raise CaseError(f"{self.file}: {self.place(key)}: found {found or 'nothing'}, expected {expected}")

    def get(self, key, default=None):
        self.known.append(key)
        return self.content.get(key, default)

    def has(self, key):
        self.known.append(key)
        return key in self.content

    def need(self, key, expected):
        if not self.has(key):
            self.fail(key, None, expected)
        return self.content[key]

    def table(self, key, needed=True):
        content = self.need(key, "a table") if needed else self.get(key, {})
        return _Table(self.place(key), content, self.file)

    def number(self, key, expected="a finite number", accept=math.isfinite, default=None):
        value = self.need(key, expected) if default is None else self.get(key, default)
        if not _is_number(value) or not accept(value):
            self.fail(key, value, expected)
        return float(value)

    def integer(self, key, expected, accept, default=None):
        value = self.need(key, expected) if default is None else self.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or not accept(value):
            self.fail(key, value, expected)
        return value

    def choice(self, key, options, default=None):
        expected = " or ".join(f'"{option}"' for option in options)
        value = self.need(key, expected) if default is None else self.get(key, default)
        if value not in options or not isinstance(value, str):
            self.fail(key, value, expected)
        return value

    def boolean(self, key, default):
        value = self.get(key, default)
        if not isinstance(value, bool):
            self.fail(key, value, "true or false")
        return value

    def text(self, key, default):
        value = self.get(key, default)
        if not isinstance(value, str):
            self.fail(key, value, "a string")
        return value

    def numbers(self, key, count, expected):
        value = self.need(key, expected)
        if not isinstance(value, list) or len(value) != count or not all(map(_is_number, value)):
            self.fail(key, value, expected)
        return tuple(map(float, value))

    def expression(self, key, value):
        value = repr(float(value)) if _is_number(value) else value
        if not isinstance(value, str):
            self.fail(key, value, "an expression of x and y in a string")
        try:
            return Expression(value)
        except ExpressionError as error:
            raise CaseError(f"{self.file}: {self.place(key)}: in {_show(value)}, {error}") from None

    def pair(self, key, value, free_allowed=False):
        if not isinstance(value, list) or len(value) != 2:
            self.fail(key, value, "a list of two expressions")
        return [None if free_allowed and entry == "free" else self.expression(f"{key}[{i}]", entry) for i, entry in enumerate(value)]

    def place_of(self, key):
        """A point [x, y]."""
        value = self.need(key, "a point [x, y]")
        if not isinstance(value, list) or len(value) != 2 or not all(map(_is_number, value)):
            self.fail(key, value, "a point [x, y]")
        return np.array(value, float)

    def finish(self):
        for key in self.content:
            if key not in self.known:
                known = ", ".join(dict.fromkeys(self.known))
                raise CaseError(f"{self.file}: {self.place(key)}: unknown key; known here: {known}")


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _show(value):
    if value is None:
        return "nothing"
    text = f'"{value}"' if isinstance(value, str) else str(value).lower() if isinstance(value, bool) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def read_case(path):
    """The case in the file at `path`, or CaseError."""
    path = Path(path)
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise CaseError(f"{path}: cannot be read: {error.strerror}") from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise CaseError(f"{path}: not a TOML file: {error}") from None
    root = _Table("", content, path)
    if root.has("pair"):
        root.refuse("pair", "a pair of boundaries", "contact with rigid obstacles only: this engine has no contact between bodies")
    if root.has("step"):
        root.refuse("step", "load steps", "a case without: this engine solves one step")
    body = root.table("body", needed=False)
    materials = _materials(root.table("material"), _plane(body, "strain"))
    if root.has("exact") and None not in materials:
        root.fail("material", ", ".join(materials), "one material for the whole body beside [exact]")
    if root.has("exact") and isinstance(materials[None], Tensor):
        root.refuse("material", "a material that is not isotropic", "lambda and mu, or young and poisson, beside [exact]")
    solution = _exact(root.table("exact"), materials[None]) if root.has("exact") else None
    if solution and root.has("load"):
        root.fail("load", content["load"], "no [load] beside [exact], which supplies it")
    load = root.table("load", needed=False)
    method = root.table("method", needed=False)
    solver = root.table("solver", needed=False)
    output = root.table("output", needed=False)
    units = root.table("units", needed=False)
    output.get("stretch")  # of the picture, which is not drawn here
    for key in ("length", "force"):
        units.text(key, "")
    case = Case(
        path=path,
        title=root.text("title", ""),
        mesh=_mesh(root.table("mesh"), path),
        materials=materials,
        body=load.pair("body", load.get("body", ["0", "0"])),
        bodies=_bodies(load),
        boundaries=_boundaries(root.table("boundary"), solution, _obstacles(root)),
        points=_points(root),
        degree=method.integer("degree", "1 or 2", lambda p: p in (1, 2), default=2 if root.table("mesh").has("gmsh") else 1),
        gamma0=_gamma0(method),
        gauss=_quadrature(method),
        allow_noncoercive=method.boolean("allow_noncoercive", False),
        tolerance=solver.number("tolerance", "a positive number below 1", lambda t: 0 < t < 1, default=1e-10),
        max_iterations=solver.integer("max_iterations", "a positive integer", lambda n: n > 0, default=200),
        exact=solution,
        probes=_probes(output),
        thickness=body.number("thickness", "a positive number", lambda t: t > 0, default=1.0),
    )
    for table in (load, method, solver, output, units, body, root):
        table.finish()
    if case.of_revolution and solution:
        root.fail("exact", content["exact"], "no [exact] for a body of revolution: the solutions are plane")
    rough = [name for name, boundary in case.boundaries.items() if boundary.friction is not None]
    if rough and (case.of_revolution or solution):
        root.refuse(f"boundary.{rough[0]}.contact.friction", "friction", "none in a body of revolution" if case.of_revolution else "none beside [exact]")
    if case.of_revolution and body.has("thickness"):
        body.fail("thickness", case.thickness, "none for a body of revolution")
    return case


def _mesh(table, path):
    shapes = [shape for shape in ("rectangle", "gmsh", "trapezoid") if table.has(shape)]
    if len(shapes) != 1:
        table.refuse("", ", ".join(shapes), "exactly one of rectangle, gmsh, trapezoid")
    if table.has("perturb"):
        table.fail("perturb", table.content["perturb"], "no perturb: the reference has no generator of random meshes; give a Gmsh file")
    table.finish()
    if shapes == ["gmsh"]:
        return Gmsh(path.parent / table.text("gmsh", ""))
    inner = table.table(shapes[0])
    positive = ("a positive number", lambda a: a > 0)
    count = ("a positive integer", lambda n: n > 0)
    if shapes == ["trapezoid"]:
        omega = inner.number("omega", "an angle between pi/2 and pi", lambda a: math.pi / 2 < a < math.pi)
        shape = Trapezoid(omega, inner.integer("n", *count))
        cells = shape.n**2
    else:
        shape = Rectangle(inner.number("width", *positive), inner.number("height", *positive), inner.integer("nx", *count),
                          inner.integer("ny", *count), inner.choice("diagonal", ("right", "left", "crossed"), "right"))
        cells = shape.nx * shape.ny
    if cells > MOST_CELLS:
        inner.refuse("", f"{cells} cells", f"at most {MOST_CELLS}")
    inner.finish()
    return shape


def _plane(table, default):
    return table.choice("plane", ("strain", "stress", "axisymmetric"), default)


def _materials(table, plane):
    """{surface: Material}, or {None: Material} for the whole body."""
    named = [key for key, value in table.content.items() if isinstance(value, dict) and key != "orthotropic"]
    if not named:
        return {None: _material(table, plane)}
    plane = _plane(table, plane)
    materials = {name: _material(table.table(name), plane) for name in named}
    if len({material.plane for material in materials.values()}) > 1:
        table.refuse("plane", "several", "the same for the whole body")
    table.finish()
    return materials


def _material(table, plane):
    plane = _plane(table, plane)
    given = [any([table.has(key) for key in keys]) for keys in (MODULI[:2], MODULI[2:4], MODULI[4:5], MODULI[5:])]
    if sum(given) != 1:
        table.refuse("", ", ".join(key for key in MODULI if key in table.content),
                     "either lambda and mu, or young and poisson, or stiffness, or orthotropic")
    lame, engineering, stiffness, _ = given
    if lame:
        lam, mu = table.number("lambda"), table.number("mu", "a positive number", lambda m: m > 0)
        if not 3 * lam + 2 * mu > 0:
            table.fail("lambda", lam, "3 lambda + 2 mu > 0")
        material = Material(lam, mu, plane)
    elif engineering:
        young = table.number("young", "a positive number", lambda e: e > 0)
        poisson = table.number("poisson", "a number above -1 and below 0.5", lambda nu: -1 < nu < 0.5)
        material = Material(young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson)), plane)
    elif plane == "axisymmetric":
        table.refuse("", "a body of revolution that is not isotropic", "lambda and mu, or young and poisson: this engine has no other")
    elif stiffness:
        entries = table.numbers("stiffness", 6, "C11, C12, C16, C22, C26, C66")
        across = table.numbers("across", 3, "a list of three numbers, in plane strain") if plane == "strain" else None
        material = _elliptic(table, "stiffness", Tensor(entries, across))
    else:
        material = _elliptic(table, "orthotropic", _orthotropic(table.table("orthotropic"), plane))
    table.finish()
    return material


def _orthotropic(table, plane):
    """The law of the moduli along and across an axis: the inverse of the compliance, turned by the angle."""
    positive = ("a positive number", lambda e: e > 0)
    e1, e2, g12 = (table.number(key, *positive) for key in ("e1", "e2", "g12"))
    nu12, angle = table.number("nu12"), math.radians(table.number("angle", default=0.0))
    compliance = np.array([[1 / e1, -nu12 / e1], [-nu12 / e1, 1 / e2]])
    across = None
    if plane == "strain":
        e3, nu13, nu23 = table.number("e3", *positive), table.number("nu13"), table.number("nu23")
        beside = np.array([-nu13 / e1, -nu23 / e2])
        whole = np.linalg.inv(np.block([[compliance, beside[:, None]], [beside[None, :], np.array([[1 / e3]])]]))
        law = whole[:2, :2]
        across = np.append(whole[2, :2] @ np.linalg.inv(law), 0)
    else:
        law = np.linalg.inv(compliance)
    table.finish()
    in_axes = np.block([[law, np.zeros((2, 1))], [np.zeros((1, 2)), np.array([[g12]])]])
    c, s = math.cos(angle), math.sin(angle)
    strain = np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]])
    stress = np.array([[c * c, s * s, 2 * c * s], [s * s, c * c, -2 * c * s], [-c * s, c * s, c * c - s * s]])
    turned = strain.T @ in_axes @ strain
    return Tensor(tuple(turned[np.triu_indices(3)]), None if across is None else tuple(across @ stress))


def _elliptic(table, key, tensor):
    """The tensor, if its smallest eigenvalue is positive."""
    c11, c12, c16, c22, c26, c66 = tensor.stiffness
    root = math.sqrt(2)
    values = np.linalg.eigvalsh([[c11, c12, root * c16], [c12, c22, root * c26], [root * c16, root * c26, 2 * c66]])
    if not values[0] >= 1e-10 * values[2] > 0:
        table.refuse(key, f"the smallest eigenvalue {values[0]:.6g}", "an elliptic law: a positive one, at least 1e-10 of the largest")
    return tensor


def _bodies(load):
    """The loads by surface."""
    found = {}
    for name in [key for key, value in load.content.items() if isinstance(value, dict)]:
        inner = load.table(name)
        found[name] = inner.pair("body", inner.need("body", "a list of two expressions"))
        inner.finish()
    return found


def _boundaries(table, solution, obstacles):
    boundaries = {}
    for name in table.content:
        if solution:
            boundaries[name] = Boundary(table.choice(name, KINDS), None)
        else:
            boundaries[name] = _boundary(table.table(name), obstacles)
    table.finish()
    if not any(boundary.kind == "contact" for boundary in boundaries.values()):
        table.refuse("", ", ".join(boundaries), "at least one boundary with contact")
    return boundaries


def _boundary(table, obstacles):
    given = [key for key in CONDITIONS if table.has(key)]
    table.finish()
    if given == ["contact"]:
        return Boundary("contact", *_contact(table.table("contact"), obstacles))
    if given == ["traction"]:
        return Boundary("traction", table.pair("traction", table.content["traction"]))
    if given == ["force"]:
        return Boundary("force", table.place_of("force"))
    if given == ["pressure"]:
        return Boundary("pressure", table.expression("pressure", table.content["pressure"]))
    if given == ["displacement"] or given == ["displacement", "traction"]:
        displacement = table.pair("displacement", table.content["displacement"], free_allowed=True)
        if given == ["displacement"]:
            return Boundary("displacement", displacement)
        traction = table.pair("traction", table.content["traction"])
        for k in (0, 1):
            if displacement[k] and not _is_zero(traction[k]):
                table.fail(f"traction[{k}]", traction[k].text, "0 where the displacement is given")
        return Boundary("displacement", displacement, traction)
    if given and set(given) <= {"normal", "tangential"}:
        return Boundary("support", [table.expression(key, table.content[key]) if key in given else None for key in ("normal", "tangential")])
    table.refuse("", ", ".join(given), "exactly one of displacement, traction, pressure, normal and tangential, contact, force")


def _is_zero(expression):
    return not {"x", "y"} & set(expression.program) and float(expression.values(0.0, 0.0)) == 0


def _contact(table, obstacles):
    """(what it is with, the traction that it has none of, friction)"""
    friction = _friction(table.table("friction")) if table.has("friction") else None
    if table.has("gap") and table.has("obstacle"):
        table.refuse("", "gap, obstacle", "one of the two")
    if table.has("obstacle"):
        name = table.choice("obstacle", tuple(obstacles))
        table.finish()
        return obstacles[name], None, friction
    data = table.expression("gap", table.get("gap", "0"))
    table.finish()
    return data, None, friction


def _friction(table):
    given = [key for key in ("tresca", "coulomb") if table.has(key)]
    table.finish()
    if len(given) != 1:
        table.refuse("", ", ".join(given), "either tresca or coulomb")
    if given == ["coulomb"]:
        return table.number("coulomb", "a coefficient, a number that is not negative", lambda mu: mu >= 0)
    return table.expression("tresca", table.content["tresca"])


def _obstacles(root):
    table = root.table("obstacle", needed=False)
    return {name: _obstacle(table.table(name)) for name in table.content}


def _obstacle(table):
    shapes = [shape for shape in ("plane", "circle", "points", "distance") if table.has(shape)]
    if shapes == ["points"]:
        return _polyline(table)
    table.finish()
    if len(shapes) != 1:
        table.refuse("", ", ".join(shapes), "exactly one of plane, circle, points, distance")
    if shapes == ["distance"]:
        return Distance(table.expression("distance", table.content["distance"]))
    inner = table.table(shapes[0])
    if shapes == ["plane"]:
        point, normal = inner.place_of("point"), inner.place_of("normal")
        length = np.hypot(*normal)
        if not length > 0:
            inner.fail("normal", normal.tolist(), "a vector that is not zero")
        obstacle = Plane(point, normal / length)
    else:
        radius = inner.number("radius", "a positive number", lambda r: r > 0)
        obstacle = Circle(inner.place_of("center"), radius, inner.choice("side", ("outside", "inside")))
    inner.finish()
    return obstacle


def _polyline(table):
    points = table.need("points", "a list of points")
    is_point = lambda p: isinstance(p, list) and len(p) == 2 and all(map(_is_number, p))
    if not isinstance(points, list) or not all(map(is_point, points)):
        table.fail("points", points, "a list of points [x, y]")
    radius = table.get("radius", [])
    radii = radius if isinstance(radius, list) else [radius]
    if not all(_is_number(r) and r >= 0 for r in radii):
        table.fail("radius", radius, "a radius, or a list of radii, 0 or more")
    side = table.choice("side", ("left", "right"))
    table.finish()
    try:
        return Polyline.through(np.array(points, float), radii, side)
    except NoLine as error:
        table.refuse("points", str(error), "another line")


def _points(root):
    table, points = root.table("point", needed=False), {}
    for name in table.content:
        inner = table.table(name)
        points[name] = inner.pair("displacement", inner.need("displacement", "a list of two expressions"), free_allowed=True)
        inner.finish()
    return points


def _gamma0(method):
    if method.get("gamma0", "auto") == "auto":
        return "auto"
    return method.number("gamma0", 'a positive number or "auto"', lambda g: g > 0)


def _quadrature(method):
    value = method.get("contact_quadrature", "exact")
    if value == "exact":
        return None
    if not isinstance(value, dict):
        method.fail("contact_quadrature", value, '"exact" or { gauss = n }')
    table = method.table("contact_quadrature")
    points = table.integer("gauss", "a number of points from 1 to 64", lambda n: 1 <= n <= 64)
    table.finish()
    return points


def _probes(output):
    probes = output.get("probes", [])
    if not isinstance(probes, list):
        output.fail("probes", probes, "a list of points [x, y]")
    for i, point in enumerate(probes):
        if not isinstance(point, list) or len(point) != 2 or not all(_is_number(coordinate) for coordinate in point):
            output.fail(f"probes[{i}]", point, "a point [x, y]")
    return [[float(x), float(y)] for x, y in probes]


def _exact(table, material):
    name = table.choice("solution", tuple(exact.SOLUTIONS))
    which = table.choice("which", tuple(exact.PATCHES)) if name == "patch" else None
    solution = exact.PATCHES[which] if which else exact.SOLUTIONS[name]
    parameters = {}
    for key, check in solution.parameters.items():
        if check is exact.GAP:
            parameters[key] = table.expression(key, table.get(key, "0"))
            if "y" in parameters[key].program:
                table.fail(key, parameters[key].text, check)
        else:
            parameters[key] = table.number(key, *check)
    table.finish()
    return solution(material, **parameters)
