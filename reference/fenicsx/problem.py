"""A case on a distributed mesh: the space V^h, the materials, the facets of each named boundary, what holds the body, gap and direction of
contact, the load L."""

from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc

from . import compat
from .case import CaseError
from .constraints import Constraints, Demand
from .friction import slip_bounds
from .load import exact_load
from .mesh import plane_mesh
from .obstacle import NoDistance
from .smooth import SmoothBoundary

AXIS = None  # the name by which the axis of a body of revolution holds the nodes on it
DATA_DEGREE = 10  # body force and traction are integrated exactly if data times test function has this degree
FACET_VERTICES = np.array([[1, 2], [0, 2], [0, 1]])  # of the reference triangle; facet i lies opposite vertex i


@dataclass
class Facets:
    """Facets of one boundary that this process sees. `owned` marks those whose triangle it owns."""

    facets: np.ndarray
    cells: np.ndarray
    local: np.ndarray  # the facet's number in its triangle
    owned: np.ndarray
    ends: np.ndarray  # its vertices in the plane mesh, in the order of FACET_VERTICES


class Problem:
    def __init__(self, case, comm):
        self.case, self.comm = case, comm
        self.plane = plane = plane_mesh(case)
        self.smooth = SmoothBoundary(plane)
        mine = slice(None) if comm.rank == 0 else slice(0, 0)
        self.mesh = compat.create_mesh(comm, plane.triangles[mine].astype(np.int64), plane.points[mine])
        idle = self.mesh.topology.index_map(2).size_local == 0
        self.refuse("mesh: a process has no triangle, expected fewer processes" if idle else None)
        self.V = compat.vector_space(self.mesh, case.degree)
        self.W = compat.scalar_space(self.mesh, "Lagrange", case.degree)
        self.owned_dofs = 2 * self.V.dofmap.index_map.size_local
        self.original = np.asarray(self.mesh.geometry.input_global_indices)[compat.cell_vertices(self.mesh)]
        self.nodes = self._node_coordinates()
        self.sizes = {"vertices": len(plane.points), "triangles": len(plane.triangles), "dofs": 2 * self.V.dofmap.index_map.size_global,
                      "contact_edges": sum(len(plane.boundaries[name]) for name in case.of_kind("contact"))}
        self.h_max = float(max(np.max(np.linalg.norm(plane.points[plane.triangles[:, i]] - plane.points[plane.triangles[:, i - 1]], axis=1))
                               for i in range(3)))
        self.boundaries = self._facets(plane)
        self.surface_of = self._surfaces()
        self.ds = ufl.Measure("ds", domain=self.mesh, subdomain_data=self._tags())
        self.holds = self._constraints()
        self.prescribed = self.holds.held.ravel()
        self.data = self.holds.from_frames(self.holds.data.ravel())
        self.rough = self._friction()
        self.contact = self._contact()
        # The paper's lines of contact: straight, with a gap along the normal.
        curved = [name for name in case.of_kind("contact") if any(self.smooth.oriented(*e) in self.smooth.ends for e in plane.boundaries[name].tolist())]
        self.straight = not case.of_revolution and not curved and not any(hasattr(data, "closest") for data in case.of_kind("contact").values())
        self.gaps = {name: self._gap(name, gap) for name, gap in case.of_kind("contact").items()} if self.straight else {}
        self.slip_bounds = {name: self._slip_bound(name, law) for name, law in self.rough.items() if not isinstance(law, float)}
        self.load = self._load()
        self.free, self.slides = self._free_motions()

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
        topology = self.mesh.topology
        topology.create_connectivity(2, 1)
        topology.create_connectivity(1, 2)
        facets_of, owned_cells = topology.connectivity(2, 1), topology.index_map(2).size_local
        found = {name: [] for name in self.case.boundaries}
        for cell, vertices in enumerate(self.original.tolist()):
            for local, (i, j) in enumerate(FACET_VERTICES):
                name = name_of.get((min(vertices[i], vertices[j]), max(vertices[i], vertices[j])))
                if name:
                    found[name].append((facets_of.links(cell)[local], cell, local, cell < owned_cells, vertices[i], vertices[j]))
        rows = {name: np.array(list_, dtype=np.int32).reshape(-1, 6) for name, list_ in found.items()}
        return {name: Facets(r[:, 0], r[:, 1], r[:, 2], r[:, 3].astype(bool), r[:, 4:]) for name, r in rows.items()}

    def _tags(self):
        """Mesh tags that give boundary number i (in name order) the value i + 1."""
        self.number = {name: i + 1 for i, name in enumerate(sorted(self.boundaries))}
        facets = np.concatenate([self.boundaries[name].facets for name in self.number])
        values = np.concatenate([np.full(len(self.boundaries[name].facets), i, np.int32) for name, i in self.number.items()])
        order = np.argsort(facets)
        return mesh.meshtags(self.mesh, 1, facets[order], values[order])

    def _nodes_on(self, name):
        return fem.locate_dofs_topological(self.V, 1, self.boundaries[name].facets)

    def _surfaces(self):
        """The physical surface of each triangle that this process sees; None where it has none, or where there is one material and no
        load by surface."""
        surfaces = self.plane.surfaces
        if None in self.case.materials and not self.case.bodies:
            return [None] * len(self.original)
        name_of = {tuple(sorted(self.plane.triangles[t].tolist())): name for name, members in surfaces.items() for t in members}
        return [name_of.get(tuple(sorted(vertices))) for vertices in self.original.tolist()]

    def materials_of(self, cells):
        return [self.case.materials.get(self.surface_of[cell], self.case.material) for cell in cells]

    def lame(self, cells):
        """lambda (as it acts in the plane) and mu of the given triangles."""
        of = self.materials_of(cells)
        return np.array([m.plane_lam for m in of]), np.array([m.mu for m in of])

    def stiffness(self, cells):
        """C11, C12, C16, C22, C26, C66 of the given triangles, a row each."""
        return np.array([material.in_plane for material in self.materials_of(cells)]).reshape(-1, 6)

    def across(self, cells):
        """sigma_zz of sigma_xx, sigma_yy, sigma_xy, a row each."""
        return np.array([material.zz for material in self.materials_of(cells)]).reshape(-1, 3)

    def on_triangles(self, values):
        """The function with one value per triangle that this process sees."""
        function = fem.Function(compat.scalar_space(self.mesh, "DG", 0))
        dofmap = function.function_space.dofmap
        function.x.array[[dofmap.cell_dofs(cell)[0] for cell in range(len(self.original))]] = values
        return function

    def _constraints(self):
        """What boundaries and points prescribe, at the nodes that this process sees."""
        case, plane, message = self.case, self.plane, None
        supports = sorted({**case.of_kind("displacement"), **case.of_kind("support")})
        keys = {name: sorted({key for a, b in plane.boundaries[name].tolist() for key in self._keys(a, b)}, key=str) for name in supports}
        node_of = self._nodes_at({key for of in keys.values() for key in of} | {(vertex,) for vertex in plane.corners.values()})
        demands = {}

        def ask(name, place, nodes, directions, values):
            nonlocal message
            x, y = self.nodes[nodes].T
            message = message or self._not_finite(place, values, x, y)
            for node, direction, value in zip(nodes, directions, values):
                demands.setdefault(node, []).append(Demand(name, place, np.asarray(direction, float), value))

        def ask_components(name, place, nodes, components):
            x, y = self.nodes[nodes].T
            exact = case.exact and case.exact.displacement(x, y)
            for k in (0, 1):
                if exact is not None or components[k] is not None:
                    values = exact[k] if exact is not None else components[k].values(x, y)
                    ask(name, f"{place}.displacement[{k}]", nodes, np.tile(np.eye(2)[k], (len(nodes), 1)), values)

        for name in supports:
            data = case.boundaries[name].data
            if case.boundaries[name].kind == "displacement":
                ask_components(name, f"boundary.{name}", np.array([node_of[key] for key in keys[name] if key in node_of], int), data)
                continue
            for a, b in plane.boundaries[name].tolist():
                edge = self.smooth.oriented(a, b)
                _, normals = self.smooth.along(edge)
                seen = [(node_of[key], n) for key, n in zip(self._keys(*edge), normals[[0, 2, 1]]) if key in node_of]
                if seen:
                    nodes, normals = np.array([node for node, _ in seen]), np.array([n for _, n in seen])
                    tangents = np.column_stack((-normals[:, 1], normals[:, 0]))
                    for key, expression, directions in zip(("normal", "tangential"), data, (normals, tangents)):
                        if expression is not None:
                            ask(name, f"boundary.{name}.{key}", nodes, directions, expression.values(*self.nodes[nodes].T))
        for name, components in case.points.items():
            node = node_of.get((plane.corners[name],))
            if node is not None:
                ask_components(name, f"point.{name}", np.array([node]), components)
        if case.of_revolution:
            on_axis = np.flatnonzero(self.nodes[:, 0] == 0)
            ask(AXIS, "the axis", on_axis, np.tile([1.0, 0.0], (len(on_axis), 1)), np.zeros(len(on_axis)))
        self.refuse(message)
        constraints, message = Constraints.of(self.nodes, demands)
        self.refuse(message)
        return constraints

    def _keys(self, a, b):
        """What the nodes of an edge are known by: its two vertices and, for P2, the pair of them."""
        return [(a,), (b,), (min(a, b), max(a, b))][: self.case.degree + 1]

    def _nodes_at(self, keys):
        """{key: node} for those of the keys that this process sees."""
        found = {}
        for cell, vertices in enumerate(self.original.tolist()):
            own = [(v,) for v in vertices]
            if self.case.degree == 2:
                own += [tuple(sorted((vertices[i], vertices[j]))) for i, j in FACET_VERTICES]
            if any(key in keys for key in own):
                found.update((key, node) for key, node in zip(own, self.V.dofmap.cell_dofs(cell).tolist()) if key in keys)
        return found

    def _contact(self):
        """{(name, a, b): (directions, gaps)} at the Lagrange points from a to b of the contact edges whose triangles this process owns."""
        found, message = {}, None
        for name, data in self.case.of_kind("contact").items():
            facets = self.boundaries[name]
            for a, b in facets.ends[facets.owned].tolist():
                edge = self.smooth.oriented(a, b)
                places, normals = self.smooth.along(edge)
                if edge != (a, b):
                    places, normals = places[::-1], normals[::-1]
                if self.case.degree == 1:
                    places, normals = places[::2], normals[::2]
                if hasattr(data, "closest"):
                    try:
                        gaps, normals = (np.array(column) for column in zip(*(data.closest(place) for place in places)))
                    except NoDistance as error:
                        message = message or f"boundary.{name}.contact.obstacle: found {error}, expected a distance"
                        continue
                else:
                    gaps = self.case.exact.gap(*places.T) if self.case.exact else data.values(*places.T)
                    message = message or self._not_finite(f"boundary.{name}.contact.gap", gaps, *places.T)
                found[name, a, b] = normals, gaps
        self.refuse(message)
        return found

    def _friction(self):
        """{name: coefficient or slip bound} of the boundaries with friction; one whose bound is 0 all along has none."""
        found, message = {}, None
        for name in self.case.of_kind("contact"):
            law = self.case.boundaries[name].friction
            if law is None or isinstance(law, float):
                found.update({name: law} if law else {})
                continue
            places = self.plane.points[np.unique(self.plane.boundaries[name])]
            place, values = f"boundary.{name}.contact.friction.tresca", slip_bounds(law, places)
            message = message or self._not_finite(place, values, *places.T)
            if np.any(values < 0):
                worst = np.argmax(values < 0)
                x, y = places[worst]
                message = message or (f"{place}: found {float(values[worst])!r} at ({float(x)!r}, {float(y)!r}), "
                                      "expected a stress that is not negative at every point of the boundary")
            found.update({name: law} if np.any(values > 0) else {})
        self.refuse(message)
        return found

    def _slip_bound(self, name, law):
        """The slip bound at the vertices of the contact boundary `name`, affine between them."""
        space = compat.scalar_space(self.mesh, "Lagrange", 1)
        nodes = fem.locate_dofs_topological(space, 1, self.boundaries[name].facets)
        function = fem.Function(space)
        places = space.tabulate_dof_coordinates()[nodes, :2]
        # DOLFINx's coordinates carry rounding.
        function.x.array[nodes] = np.maximum(slip_bounds(law, places), 0)
        return function

    def _free_motions(self):
        """(the motions that supports leave free, those of them that slide along all obstacles), as fields over the owned dofs. One dof
        per slide is then held where it is. Refuses a body that neither supports nor contact can hold."""
        motions = self.rigid_motions()
        owned = self.owned_dofs
        held = np.flatnonzero(self.prescribed[:owned])
        rows = np.array([self.holds.into_frames(motion) for motion in motions])[:, held]
        values, vectors = np.linalg.eigh(self.comm.allreduce(rows @ rows.T))
        free = vectors[:, values <= 1e-10].T @ motions
        if not len(free):
            return free, free
        normal = self._normal_motion(free)
        values, vectors = np.linalg.eigh(self.comm.allreduce(normal @ normal.T))
        sliding = values <= 1e-16 * max(1.0, values[-1])
        slides = _orthonormal(vectors[:, sliding].T @ free, self.comm)
        work = self.comm.allreduce(np.array([slides @ self.load, np.abs(slides) @ np.abs(self.load)]))
        if sliding.all() or not np.all(np.abs(work[0]) <= 1e-9 * work[1]):
            self.refuse("boundary: a rigid motion is free; expected displacement boundaries that exclude translations and rotation")
        left = list(slides)
        while left:
            slide = left.pop()
            size = np.where(self.prescribed[:owned], 0.0, np.abs(slide))
            best = max(self.comm.allgather((float(size.max(initial=0.0)), self.comm.rank)))
            if best[1] == self.comm.rank:
                dof = int(np.argmax(size))
                self.prescribed[dof] = True
            pivot = self.comm.bcast((dof, slide[dof]) if best[1] == self.comm.rank else None, root=best[1])
            for other in left:
                value = self.comm.bcast(other[pivot[0]] if best[1] == self.comm.rank else None, root=best[1])
                other -= value / pivot[1] * slide
        return free, slides

    def _normal_motion(self, motions):
        """n~ . r at the nodes of the contact edges of owned triangles, a column for each, and across n~ where there is friction:
        (motions, points)."""
        keys = {key for _, a, b in self.contact for key in self._keys(a, b)}
        node_of = self._nodes_at(keys)
        columns = []
        for (name, a, b), (directions, _) in self.contact.items():
            for key, n in zip(self._keys(a, b), directions[[0, -1, 1]]):
                node = node_of[key]
                if 2 * node < self.owned_dofs:
                    columns.append(motions[:, 2 * node : 2 * node + 2] @ n)
                    if name in self.rough:
                        columns.append(motions[:, 2 * node : 2 * node + 2] @ [-n[1], n[0]])
        return np.array(columns).reshape(-1, len(motions)).T

    def least_norm(self, u):
        """u less its part along the slides: of all solutions the one whose nodal values have the least norm."""
        return u - self.slides.T @ self.comm.allreduce(self.slides @ u) if len(self.slides) else u

    def rigid_motions(self):
        """(3, owned dofs): the two translations and the rotation about the origin scaled to the mesh's size; of a body of revolution the
        translation along the axis."""
        x, y = self.nodes[: self.owned_dofs // 2].T
        largest = self.comm.allreduce(max(np.abs(x).max(initial=0), np.abs(y).max(initial=0)), op=MPI.MAX)
        motions = np.zeros((3, self.owned_dofs))
        motions[0, 0::2] = motions[1, 1::2] = 1
        motions[2, 0::2], motions[2, 1::2] = -y / largest, x / largest
        return motions[1:2] if self.case.of_revolution else motions

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
        """L(v) = int f.v + int_{Gamma_N} t.v as a vector over the owned dofs, of a body of revolution with the weight r, for a radian. A
        built-in solution's load is integrated in load.py."""
        x, v = ufl.SpatialCoordinate(self.mesh), ufl.TestFunction(self.V)
        zero = fem.Constant(self.mesh, np.zeros(2))  # keeps a form that is 0 by its text, which UFL would drop
        rule = {"quadrature_degree": DATA_DEGREE}
        r, angle = (x[0], 2 * np.pi) if self.case.of_revolution else (1, 1)
        L = r * ufl.inner(zero + _vector(self.case.body, x), v) * ufl.dx(self.mesh, metadata=rule)
        for name, components in self.case.bodies.items():
            there = self.on_triangles([float(surface == name) for surface in self.surface_of])
            L += r * there * ufl.inner(zero + _vector(components, x), v) * ufl.dx(self.mesh, metadata=rule)
        for name, pressure in self.case.of_kind("pressure").items():
            L -= r * pressure.ufl(x) * ufl.inner(ufl.FacetNormal(self.mesh), v) * self.ds(self.number[name], metadata=rule)
        for name, force in self.case.of_kind("force").items():
            ds = self.ds(self.number[name], metadata=rule)
            length = self.comm.allreduce(fem.assemble_scalar(fem.form(r * fem.Constant(self.mesh, 1.0) * ds)))
            traction = fem.Constant(self.mesh, force / (angle * length * self.case.thickness))
            L += r * ufl.inner(traction, v) * ds
        for name, boundary in sorted(self.case.boundaries.items()):
            components = boundary.data if boundary.kind == "traction" else boundary.traction
            if components:
                if boundary.kind != "traction":
                    components = [t if u is None else None for t, u in zip(components, boundary.data)]
                L += r * ufl.inner(_vector(components, x), v) * self.ds(self.number[name], metadata=rule)
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
    return ufl.as_vector([ufl.as_ufl(0.0) if component is None else component.ufl(x) for component in components])


def _orthonormal(fields, comm):
    """Fields with orthonormal nodal values that span the same."""
    if not len(fields):
        return fields
    values, vectors = np.linalg.eigh(comm.allreduce(fields @ fields.T))
    return (vectors / np.sqrt(values)).T @ fields
