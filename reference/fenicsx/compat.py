"""All that differs between DOLFINx releases. Found by asking the installed package, not its version number.

Only what README.md lists as run has been run; the branches for other releases follow their published signatures.
"""

import importlib.metadata
import inspect
import platform

import basix
import dolfinx
import dolfinx.fem.petsc
import numpy as np
import ufl
from dolfinx import fem, mesh
from petsc4py import PETSc

try:
    import basix.ufl as basix_ufl  # not in 0.5
except ImportError:
    basix_ufl = None


def create_mesh(comm, triangles, points):
    """The distributed mesh of straight triangles; each process passes its share of triangles and points."""
    if basix_ufl:
        domain = ufl.Mesh(basix_ufl.element("Lagrange", "triangle", 1, shape=(2,)))
    else:
        domain = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.Cell("triangle", geometric_dimension=2), 1))
    points_third = list(inspect.signature(mesh.create_mesh).parameters)[2] == "x"  # 0.11 takes the element there
    return mesh.create_mesh(comm, triangles, *((points, domain) if points_third else (domain, points)))


def vector_space(domain, degree):
    if hasattr(fem, "functionspace"):
        return fem.functionspace(domain, ("Lagrange", degree, (2,)))
    return fem.VectorFunctionSpace(domain, ("Lagrange", degree))


def space_of_two(domain, degree):
    """Two displacements."""
    if basix_ufl:
        element = basix_ufl.element("Lagrange", "triangle", degree, shape=(2,))
        return fem.functionspace(domain, basix_ufl.mixed_element([element, element]))
    element = ufl.VectorElement("Lagrange", domain.ufl_cell(), degree)
    return fem.FunctionSpace(domain, ufl.MixedElement(element, element))


def scalar_space(domain, family, degree):
    if hasattr(fem, "functionspace"):
        return fem.functionspace(domain, (family, degree))
    return fem.FunctionSpace(domain, (family, degree))


def expression(form, space):
    """A UFL expression ready to be interpolated into a space."""
    points = space.element.interpolation_points
    return fem.Expression(form, points() if callable(points) else points)


def cell_vertices(domain):
    """Row per local triangle: its vertices as rows of domain.geometry.x, in the reference triangle's order."""
    dofmap = domain.geometry.dofmap
    return dofmap if isinstance(dofmap, np.ndarray) else dofmap.array.reshape(-1, 3)


def basis(degree, points):
    """Values (points, functions) and gradients (points, functions, 2) of the Lagrange basis on the reference triangle."""
    element = basix.create_element(basix.ElementFamily.P, basix.CellType.triangle, degree, basix.LagrangeVariant.gll_warped)
    table = np.asarray(element.tabulate(1, points)).reshape(3, len(points), -1)
    return table[0], np.moveaxis(table[1:], 0, 2)


def versions():
    """Versions of what the numbers rest on."""
    return {"DOLFINx": dolfinx.__version__, "PETSc": ".".join(map(str, PETSc.Sys.getVersion())),
            "UFL": importlib.metadata.version("fenics-ufl"), "Basix": basix.__version__, "Python": platform.python_version()}
