"""A case on a distributed mesh: the space V^h, the facets of each named boundary, the prescribed data, the gap and the load L."""

from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc

from . import compat
from .case import CaseError
from .load import exact_load
from .mesh import plane_mesh

DATA_DEGREE = 10  # body force and traction are integrated exactly if data times test function has this degree
FACET_VERTICES = np.array([[1, 2], [0, 2], [0, 1]])  # of the reference triangle; facet i lies opposite vertex i


@dataclass
class Facets:
    """Facets of one boundary that this process sees. `owned` marks those whose triangle it owns."""

    facets: np.ndarray
    cells: np.ndarray
    local: np.ndarray  # the facet's number in its triangle
    owned: np.ndarray


class Problem:
    def __init__(self, case, comm):
        self.case, self.comm = case, comm
        plane = plane_mesh(case)
        mine = slice(None) if comm.rank == 0 else slice(0, 0)
        self.mesh = compat.create_mesh(comm, plane.triangles[mine].astype(np.int64), plane.points[mine])
        idle = self.mesh.topology.index_map(2).size_local == 0
        self.refuse("mesh: a process has no triangle, expected fewer processes" if idle else None)
        self.V = compat.vector_space(self.mesh, case.degree)
        self.W = compat.scalar_space(self.mesh, "Lagrange", case.degree)
        self.owned_dofs = 2 * self.V.dofmap.index_map.size_local
        self.nodes = self._node_coordinates()
        self.sizes = {"vertices": len(plane.points), "triangles": len(plane.triangles), "dofs": 2 * self.V.dofmap.index_map.size_global,
                      "contact_edges": sum(len(plane.boundaries[name]) for name in case.of_kind("contact"))}
        self.h_max = float(max(np.max(np.linalg.norm(plane.points[plane.triangles[:, i]] - plane.points[plane.triangles[:, i - 1]], axis=1))
                               for i in range(3)))
        self.boundaries = self._facets(plane)
        self.ds = ufl.Measure("ds", domain=self.mesh, subdomain_data=self._tags())
        self._prescribe()
        self.gaps = {name: self._gap(name, gap) for name, gap in case.of_kind("contact").items()}
        self.load = self._load()

    def _node_coordinates(self):
        """(nodes that this process sees, 2): vertices as they were given, then midpoints. DOLFINx's own table carries rounding, by which a
        point may leave the side it lies on."""
        dofmap = self.V.dofmap
        corners = self.mesh.geometry.x[compat.cell_vertices(self.mesh)][:, :, :2]
        on_cell = corners if self.case.degree == 1 else np.hstack((corners, corners[:, FACET_VERTICES].mean(axis=2)))
        nodes = np.empty((dofmap.index_map.size_local + dofmap.index_map.num_ghosts, 2))
        for cell, points in enumerate(on_cell):
            nodes[dofmap.cell_dofs(cell)] = points
        return nodes

    def _facets(self, plane):
        """{name: Facets}, found by the vertices' numbers in `plane`."""
        name_of = {(min(a, b), max(a, b)): name for name in self.case.boundaries for a, b in plane.boundaries[name].tolist()}
        original = np.asarray(self.mesh.geometry.input_global_indices)
        topology = self.mesh.topology
        topology.create_connectivity(2, 1)
        topology.create_connectivity(1, 2)
        facets_of, owned_cells = topology.connectivity(2, 1), topology.index_map(2).size_local
        found = {name: [] for name in self.case.boundaries}
        for cell, vertices in enumerate(original[compat.cell_vertices(self.mesh)].tolist()):
            for local, (i, j) in enumerate(FACET_VERTICES):
                name = name_of.get((min(vertices[i], vertices[j]), max(vertices[i], vertices[j])))
                if name:
                    found[name].append((facets_of.links(cell)[local], cell, local, cell < owned_cells))
        rows = {name: np.array(list_, dtype=np.int32).reshape(-1, 4) for name, list_ in found.items()}
        return {name: Facets(r[:, 0], r[:, 1], r[:, 2], r[:, 3].astype(bool)) for name, r in rows.items()}

    def _tags(self):
        """Mesh tags that give boundary number i (in name order) the value i + 1."""
        self.number = {name: i + 1 for i, name in enumerate(sorted(self.boundaries))}
        facets = np.concatenate([self.boundaries[name].facets for name in self.number])
        values = np.concatenate([np.full(len(self.boundaries[name].facets), i, np.int32) for name, i in self.number.items()])
        order = np.argsort(facets)
        return mesh.meshtags(self.mesh, 1, facets[order], values[order])

    def _nodes_on(self, name):
        return fem.locate_dofs_topological(self.V, 1, self.boundaries[name].facets)

    def _prescribe(self):
        """`prescribed`: the boundary's number per dof (0: free), the first in name order; `data`: its value; ghosts included."""
        self.data = np.zeros(2 * len(self.nodes))
        self.prescribed = np.zeros(2 * len(self.nodes), int)
        message = None
        for name, components in self.case.of_kind("displacement").items():
            nodes = self._nodes_on(name)
            x, y = self.nodes[nodes].T
            exact = self.case.exact and self.case.exact.displacement(x, y)
            for k in (0, 1):
                if not self.case.exact and components[k] is None:
                    continue
                values = exact[k] if self.case.exact else components[k].values(x, y)
                message = message or self._not_finite(f"boundary.{name}.displacement[{k}]", values, x, y)
                dofs = 2 * nodes + k
                taken = self.prescribed[dofs] > 0
                differ = taken & (np.abs(self.data[dofs] - values) > 1e-12 * np.abs(values))
                for i in np.flatnonzero(differ)[:1]:
                    other = next(n for n, number in self.number.items() if number == self.prescribed[dofs[i]])
                    message = message or (f"boundary.{name}.displacement[{k}]: found {values[i]!r} at ({x[i]!r}, {y[i]!r}), "
                                          f"expected {self.data[dofs[i]]!r} as on boundary {other!r}")
                self.data[dofs[~taken]] = values[~taken]
                self.prescribed[dofs[~taken]] = self.number[name]
        self.refuse(message)
        self._no_rigid_motion()

    def _no_rigid_motion(self):
        """Refuses a case whose prescribed dofs leave a translation or rotation free."""
        fixed = np.flatnonzero(self.prescribed[:self.owned_dofs])
        rows = self.rigid_motions()[:, fixed]
        smallest = np.linalg.eigvalsh(self.comm.allreduce(rows @ rows.T))[0]
        if not smallest > 1e-10:
            self.refuse("boundary: a rigid motion is free; expected displacement boundaries that exclude translations and rotation")

    def rigid_motions(self):
        """(3, owned dofs): the two translations and the rotation about the origin scaled to the mesh's size."""
        x, y = self.nodes[: self.owned_dofs // 2].T
        largest = self.comm.allreduce(max(np.abs(x).max(initial=0), np.abs(y).max(initial=0)), op=MPI.MAX)
        motions = np.zeros((3, self.owned_dofs))
        motions[0, 0::2] = motions[1, 1::2] = 1
        motions[2, 0::2], motions[2, 1::2] = -y / largest, x / largest
        return motions

    def _gap(self, name, gap):
        """The Lagrange interpolant of the gap on the edges of the contact boundary `name` (zero at all other nodes)."""
        nodes = self._nodes_on(name)
        x, y = self.nodes[nodes].T
        values = self.case.exact.gap(x, y) if self.case.exact else gap.values(x, y)
        self.refuse(self._not_finite(f"boundary.{name}.contact.gap", values, x, y))
        function = fem.Function(self.W)
        function.x.array[nodes] = values
        return function

    def _load(self):
        """L(v) = int f.v + int_{Gamma_N} t.v as a vector over the owned dofs. A built-in solution's load is integrated in load.py."""
        x, v = ufl.SpatialCoordinate(self.mesh), ufl.TestFunction(self.V)
        zero = fem.Constant(self.mesh, np.zeros(2))  # keeps a form that is 0 by its text, which UFL would drop
        rule = {"quadrature_degree": DATA_DEGREE}
        L = ufl.inner(zero + _vector(self.case.body, x), v) * ufl.dx(self.mesh, metadata=rule)
        for name, components in self.case.of_kind("traction").items():
            if components:
                L += ufl.inner(_vector(components, x), v) * self.ds(self.number[name], metadata=rule)
        load = self.assemble(fem.form(L), exact_load(self) if self.case.exact else None)
        self.refuse(None if np.all(np.isfinite(load)) else "load: body force or traction is not finite on the mesh")
        return load

    def assemble(self, form, local=None):
        """The vector over the owned dofs of a linear form, plus `local` contributions (one entry per dof that this process sees)."""
        vector = fem.petsc.assemble_vector(form)
        if local is not None:
            with vector.localForm() as seen:
                seen.array[:] += local
        vector.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
        owned = vector.array.copy()
        vector.destroy()
        return owned

    def refuse(self, message):
        """Raises CaseError on every process if any process has a message."""
        messages = [m for m in self.comm.allgather(message) if m]
        if messages:
            raise CaseError(f"{self.case.path}: {messages[0]}")

    @staticmethod
    def _not_finite(place, values, x, y):
        for i in np.flatnonzero(~np.isfinite(values))[:1]:
            return f"{place}: found {float(values[i])!r} at ({float(x[i])!r}, {float(y[i])!r}), expected a finite number"
        return None



def _vector(components, x):
    return ufl.as_vector([component.ufl(x) for component in components])
