"""Gmsh MSH 4.1 files, ASCII or binary: straight triangles by physical surface, lines of named physical curves, named physical points."""

import struct

import numpy as np

from .case import CaseError
from .plane import PlaneMesh

POINT, LINE, TRIANGLE = 15, 1, 2  # Gmsh's element types
NODES_OF = {POINT: 1, LINE: 2, TRIANGLE: 3}  # point, line, triangle; any other element is refused


def read(path):
    """The PlaneMesh in the file at `path`, or CaseError."""
    try:
        nodes, triangles, curves, surfaces, places = _Reader(path.read_bytes()).mesh()
    except OSError as error:
        raise CaseError(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, IndexError, KeyError, struct.error) as error:
        raise CaseError(f"{path}: not a Gmsh 4.1 mesh of triangles: {error}") from None
    used = sorted({node for triangle in triangles for node in triangle})
    number = {tag: i for i, tag in enumerate(used)}
    try:
        points = np.array([nodes[tag] for tag in used])
        edges = {name: np.array([[number[a], number[b]] for a, b in lines]) for name, lines in curves.items()}
        corners = {name: number[tag] for name, tag in places.items()}
    except KeyError as error:
        raise CaseError(f"{path}: node {error} is used and not listed, or lies on a boundary line or at a named point and in no triangle") from None
    if np.any(points[:, 2] != points[0, 2]):
        raise CaseError(f"{path}: the mesh is not in a plane z = const")
    rows = np.array([[number[tag] for tag in triangle] for triangle in triangles])
    return PlaneMesh(points[:, :2].copy(), rows, edges, {name: np.array(members) for name, members in surfaces.items()}, corners)


class _Reader:
    """The same walk over both encodings: in ASCII numbers are words, in binary little-endian int32, uint64, double."""

    def __init__(self, content):
        self.content, self.position = content, 0
        self.expect("$MeshFormat")
        version, binary, size = self.line().split()
        if version != "4.1" or size != "8":
            raise ValueError(f"format {version} with data size {size}, expected 4.1 with 8")
        self.binary = binary == "1"
        if self.binary and self.ints(1) != [1]:
            raise ValueError("big-endian file")

    def line(self):
        end = self.content.find(b"\n", self.position)
        if end < 0:
            raise ValueError("the file ends early")
        text = self.content[self.position:end].decode("utf-8", "replace").strip()
        self.position = end + 1
        return text

    def expect(self, text):
        found = ""
        while not found:  # an empty line ends a binary section
            found = self.line()
        if found != text:
            raise ValueError(f"found {found[:30]!r}, expected {text}")

    def ints(self, n):
        return self._take(n, "i", int)

    def sizes(self, n):
        return self._take(n, "Q", int)

    def doubles(self, n):
        return self._take(n, "d", float)

    def _take(self, n, code, convert):
        if self.binary:
            size = struct.calcsize(f"<{n}{code}")
            values = list(struct.unpack_from(f"<{n}{code}", self.content, self.position))
            self.position += size
            return values
        values = []
        while len(values) < n:
            while self.content[self.position:self.position + 1].isspace():
                self.position += 1
            end = self.position
            while end < len(self.content) and not self.content[end:end + 1].isspace():
                end += 1
            values.append(convert(self.content[self.position:end]))
            self.position = end
        return values

    def mesh(self):
        names, entity_names, nodes, found = {}, {}, {}, ([], {}, {}, {})
        while (section := self.next_section()) is not None:
            if section == "$PhysicalNames":
                names = self.physical_names()
            elif section == "$Entities":
                entity_names = self.entities(names)
            elif section == "$Nodes":
                nodes = self.nodes()
            elif section == "$Elements":
                found = self.elements(entity_names)
        if not found[0]:
            raise ValueError("it has no triangles")
        return nodes, *found

    def next_section(self):
        """Moves behind the next line that opens a section; None at the end of the file."""
        while True:
            start = self.content.find(b"$", self.position)
            if start < 0:
                return None
            self.position = start
            text = self.line()
            if not text.startswith("$End"):
                return text

    def physical_names(self):
        names = {}
        for _ in range(int(self.line())):
            dimension, tag, name = self.line().split(maxsplit=2)
            names[int(dimension), int(tag)] = name.strip('"')
        return names

    def entities(self, names):
        """{(dimension, entity): its physical name}; entities without one are left out."""
        entity_names = {}
        counts = self.sizes(4)
        for dimension, count in enumerate(counts):
            for _ in range(count):
                (tag,) = self.ints(1)
                self.doubles(3 if dimension == 0 else 6)
                physical = self.ints(self.sizes(1)[0])
                if dimension > 0:
                    self.ints(self.sizes(1)[0])
                named = [names[dimension, abs(p)] for p in physical if (dimension, abs(p)) in names]
                if len(named) > 1:
                    raise ValueError(f"entity {tag} of dimension {dimension} has the physical names {', '.join(named)}, expected one")
                if named:
                    entity_names[dimension, tag] = named[0]
        return entity_names

    def nodes(self):
        nodes = {}
        blocks, *_ = self.sizes(4)
        for _ in range(blocks):
            dimension, _, parametric = self.ints(3)
            (count,) = self.sizes(1)
            tags = self.sizes(count)
            width = 3 + (dimension if parametric else 0)
            for tag in tags:
                nodes[tag] = self.doubles(width)[:3]
        return nodes

    def elements(self, entity_names):
        """Triangles, the lines of each named curve, the triangles of each named surface, the node at each named point."""
        triangles, curves, surfaces, places = [], {}, {}, {}
        blocks, *_ = self.sizes(4)
        for _ in range(blocks):
            dimension, entity, kind = self.ints(3)
            (count,) = self.sizes(1)
            if kind not in NODES_OF:
                raise ValueError(f"element type {kind}, expected straight triangles (2) and lines (1)")
            name = entity_names.get((dimension, entity))
            for _ in range(count):
                _, *nodes = self.sizes(1 + NODES_OF[kind])
                if kind == TRIANGLE:
                    if name is not None:
                        surfaces.setdefault(name, []).append(len(triangles))
                    triangles.append(nodes)
                elif kind == LINE and name is not None:
                    curves.setdefault(name, []).append(nodes)
                elif kind == POINT and name is not None:
                    places[name] = nodes[0]
        return triangles, curves, surfaces, places
