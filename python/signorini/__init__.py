"""Unilateral (Signorini) contact in linear elasticity by Nitsche's method, after Chouly & Hild (2013).

    import signorini
    solution = signorini.solve_case("cases/block.toml", set={"method.degree": 2})

or, with a mesh of your own (arrays, or a meshio mesh in place of the three):

    solution = signorini.solve(
        points, triangles, {"top": edges, "bottom": edges},
        material={"young": 2.5, "poisson": 0.25},
        boundary={"top": {"displacement": [0, -0.01]}, "bottom": {"contact": {"gap": "0.1*x^2"}}},
    )

The keyword arguments of `solve` are the tables of a case file (docs/case.md), all but [mesh]. A wrong case raises CaseError,
which is a ValueError; a case that has no solution raises SolveError, which is a RuntimeError. A solution that is not proved,
or that lacks something else that the case asks for, comes with a RuntimeWarning: `solution.verdict` is "proved" or "not proved". Each
remark that the command would print is a UserWarning. Ctrl-C ends a solve.
"""

from __future__ import annotations

import json
import operator
import os
import warnings
from dataclasses import dataclass
from typing import Any, Callable, List, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _signorini
from ._signorini import CaseError, SolveError, __version__
from .results import Results

__all__ = [
    "CaseError", "Contact", "Mesh", "Results", "Solution", "SolveError", "__version__", "from_meshio", "solve", "solve_case",
]

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
Texts = npt.NDArray[np.str_]


@dataclass(frozen=True, eq=False)
class Contact:
    """The contact boundaries, by arc length. A node between two edges is there twice: sigma_n jumps."""

    arc: Floats
    """Arc length from the start of the boundary."""
    node: Integers
    """The number of the node; -1 between two bodies, where the nodes of one face the edges of the other."""
    place: Floats
    """(points, 2): the place in the undeformed body."""
    u_n: Floats
    """u.n, n the outward normal."""
    gap: Floats
    """The initial gap g along n."""
    sigma_n: Floats
    """The normal stress, negative in compression."""
    lambda_h: Floats
    """lambda^h = -(1/gamma) [P]+, which jumps from edge to edge."""
    pressure: Floats
    """The recovered contact pressure, never negative: the one to report."""
    boundary: Texts
    """The name of the boundary."""


@dataclass(frozen=True, eq=False, repr=False)
class Solution:
    """A solved case, in its own units. Printed, it is its summary; in a notebook, its picture."""

    nodes: Floats
    """(nodes, 2): the vertices of the mesh, then, for degree 2, the middles of its edges."""
    elements: Integers
    """(triangles, 3 or 6): the nodes of each triangle, vertices first, then the middles of its edges, in the order of VTK and meshio: that
    between the first two vertices, that between the second and the third, that between the third and the first."""
    displacement: Floats
    """(nodes, 2)"""
    stress: Floats
    """(triangles, 4): the mean xx, yy, zz, xy."""
    von_mises: Floats
    """(triangles,)"""
    contact: Contact
    results: Results
    """What result.json has (docs/result.md)."""
    summary: str
    """What the command prints."""
    _solved: Optional[_signorini.Solved]

    def __repr__(self) -> str:
        return self.summary

    def _repr_svg_(self) -> str:
        return self._here().picture()

    def write(self, folder: Union[str, "os.PathLike[str]"], *, report: bool = False) -> List[str]:
        """Write the files that the command writes, with `report` report.html, too; return their paths."""
        return self._here().write(os.fspath(folder), report)

    def to_meshio(self) -> Any:
        """The mesh of the solution with displacement, stress and von Mises stress, as meshio has it (which must be installed)."""
        import meshio

        kind = {3: "triangle", 6: "triangle6"}[self.elements.shape[1]]
        flat = np.zeros((len(self.nodes), 1))
        xx, yy, zz, xy = self.stress.T
        none = np.zeros(len(xx))
        # Three components and nine, as ParaView has vectors and tensors.
        tensors = np.stack([xx, xy, none, xy, yy, none, none, none, zz], axis=1)
        return meshio.Mesh(
            np.hstack([self.nodes, flat]),
            [(kind, self.elements)],
            point_data={"displacement": np.hstack([self.displacement, flat])},
            cell_data={"stress": [tensors], "von_mises": [self.von_mises]},
        )

    def _here(self) -> _signorini.Solved:
        if self._solved is None:
            raise RuntimeError("a solution that comes from another process (pickle) has its arrays only: draw and write it there")
        return self._solved

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_solved": None}

    @property
    def verdict(self) -> str:
        """ "proved": the exact solution of the discrete problem is within `solver.proof` of this one; or "not proved"."""
        return str(self.results["verdict"])

    @property
    def certified(self) -> dict[tuple[str, str], tuple[float, float]]:
        """Between what numbers those of the true solution lie, as in certified["contact force", "floor"]; empty without a certificate,
        which `certificate=True` and `adapt` make. The upper end of a peak pressure is infinite. docs/result.md has the names."""
        continuous = self.results.get("certificate", {}).get("continuous", {})
        return {
            (q["name"], q["boundary"]): (q["interval"][0], np.inf if q["interval"][1] is None else q["interval"][1])
            for q in continuous.get("quantities", [])
            if "interval" in q and "weight" not in q
        }


def solve_case(
    path: Union[str, "os.PathLike[str]"], *, set: Optional[Mapping[str, Any]] = None, certificate: bool = False
) -> Solution:
    """Solve a case file; `set` sets keys over it, as in {"method.gamma0": 1e-3}. With `certificate`, also bound the distance to the
    true solution: `solution.certified`."""
    settings = [f"{key}={_toml(value)}" for key, value in (set or {}).items()]
    return _solution(_signorini.solve_case(os.fspath(path), settings, certificate))


def solve(
    points: Any,
    triangles: Optional[npt.ArrayLike] = None,
    boundaries: Optional[Mapping[str, npt.ArrayLike]] = None,
    surfaces: Optional[Mapping[str, npt.ArrayLike]] = None,
    named_points: Optional[Mapping[str, int]] = None,
    *,
    certificate: bool = False,
    title: str = "Contact problem",
    pairs: Sequence[Mapping[str, Any]] = (),
    **tables: Any,
) -> Solution:
    """Solve a contact problem on a mesh: points (n, 2), triangles (m, 3), counter-clockwise, and for each named boundary its
    edges (k, 2) as pairs of points; for materials and loads by surface the triangles (k,) of each, and for supports in points the
    number of each. Or a meshio mesh in place of them all. With `certificate`, also bound the distance to the true solution:
    `solution.certified`.

    The tables are those of a case file: material, boundary, load, method, solver, output, ... A number may stand where the
    file has an expression, and a function of x and y (two floats): {"gap": lambda x, y: 0.1 * x**2}. A gap may also be an array with a
    value for each point of the mesh, linear between them; those off the boundary do not matter. `pairs` are the tables [[pair]], of boundaries that touch each other:
    [{"boundaries": ["pin", "hole"]}].
    """
    if pairs:
        tables["pair"] = list(pairs)
    remarks: List[str] = []
    origin = None
    if triangles is None and boundaries is None and hasattr(points, "cells"):
        mesh, origin, remarks = _from_meshio(points, _pairs(tables))
        points, triangles, boundaries, surfaces, named_points = mesh
    if triangles is None or boundaries is None:
        raise TypeError("expected points, triangles and boundaries, or a meshio mesh")
    places = _array(points, "f", (None, 2), "points")
    edges = {name: _array(edges, "i", (None, 2), f"boundary '{name}'") for name, edges in boundaries.items()}
    functions: List[Callable[[float, float], float]] = []
    text = f"title = {_toml(title)}\n"
    for name, table in tables.items():
        if name == "boundary" and isinstance(table, Mapping):
            table = {key: _with_gap(key, inner, places, edges, origin) for key, inner in table.items()}
        text += f"{_key(name)} = {_toml(table, functions)}\n"
    arrays = (
        places.tobytes(),
        _array(triangles, "i", (None, 3), "triangles").tobytes(),
        [(name, ends.tobytes()) for name, ends in edges.items()],
        [(name, _array(members, "i", (None,), f"surface '{name}'").tobytes()) for name, members in (surfaces or {}).items()],
        [(name, _number(point, f"point '{name}'")) for name, point in (named_points or {}).items()],
    )
    return _solution(_signorini.solve(text, arrays, functions, remarks, certificate))


class Mesh(NamedTuple):
    """A mesh as `solve` takes it."""

    points: Floats
    triangles: Integers
    boundaries: dict[str, Integers]
    surfaces: dict[str, Integers]
    named_points: dict[str, int]


def _pairs(tables: Mapping[str, Any]) -> "List[List[str]]":
    """The boundaries of the pairs of a case, by which its mesh is checked."""
    entries = tables.get("pair", [])
    lists = [entry.get("boundaries") for entry in entries if isinstance(entry, Mapping)]
    return [list(names) for names in lists if isinstance(names, (list, tuple)) and [type(name) for name in names] == [str, str]]


def from_meshio(mesh: Any, *, pairs: Sequence[Sequence[str]] = ()) -> Mesh:
    """Points, triangles and what is named of a meshio mesh, by its physical names (as Gmsh writes them), the numbers of groups without a
    name, or its cell sets. As the command does with a mesh file: points that no triangle uses are left out, a block whose triangles
    all run clockwise is turned, quadrangles are split (which is said in a warning), and elements of higher order are read if their
    edges are straight. The boundaries of `pairs`, as in [("pin", "hole")], may touch each other."""
    made, _, remarks = _from_meshio(mesh, [list(pair) for pair in pairs])
    _warn(remarks)
    return made


# Gmsh's numbers of the cells of meshio, and their dimension. The nodes of all of them are in one order.
_CELLS = {
    "vertex": (15, 0), "line": (1, 1), "line3": (8, 1), "triangle": (2, 2), "triangle6": (9, 2),
    "quad": (3, 2), "quad8": (16, 2), "quad9": (10, 2),
}
_SOLIDS = ("tetra", "hexahedron", "wedge", "pyramid")


def _from_meshio(mesh: Any, pairs: List[List[str]]) -> "tuple[Mesh, Integers, List[str]]":
    """The mesh, the number that each of its points has in the meshio mesh, and what was decided."""
    solid = next((block.type for block in mesh.cells if block.type.startswith(_SOLIDS)), None)
    if solid is not None:
        raise CaseError(f"the meshio mesh has cells of type {solid}: 3D is not solved; expected a plane mesh of triangles")
    if not any(block.type in _CELLS and _CELLS[block.type][1] == 2 for block in mesh.cells):
        found = ", ".join(sorted({block.type for block in mesh.cells})) or "no cells"
        raise CaseError(f"the meshio mesh has {found}; expected triangles")
    places = _array(mesh.points, "f", (None, None), "the points of the meshio mesh")
    if places.shape[1] not in (2, 3):
        raise CaseError(f"the points of the meshio mesh have shape {places.shape}; expected (n, 2) or (n, 3)")
    nodes = np.zeros((len(places), 3))
    nodes[:, : places.shape[1]] = places
    names: List[dict[int, List[str]]] = [{}, {}, {}]
    blocks = []
    corners = []
    for i, block in enumerate(mesh.cells):
        if block.type not in _CELLS:
            raise CaseError(f"the meshio mesh has cells of type {block.type}; expected {', '.join(_CELLS)}")
        number, dimension = _CELLS[block.type]
        cells = _array(block.data, "i", (None, None), f"block {i} ({block.type}) of the meshio mesh")
        if len(cells) and not (0 <= cells.min() and cells.max() < len(places)):
            raise CaseError(f"block {i} ({block.type}) of the meshio mesh names points from {cells.min()} to {cells.max()}; expected 0 to {len(places) - 1}")
        if dimension == 2:
            corners.append(cells[:, : 3 if block.type.startswith("triangle") else 4].ravel())
        entities = np.zeros(len(cells), dtype=np.int32)
        of_block = _names_of_block(mesh, i, dimension, len(cells))
        member = np.array([chosen for _, chosen in of_block]).reshape(len(of_block), len(cells))
        if len(cells):
            kinds, which = np.unique(member, axis=1, return_inverse=True)
            first = len(names[dimension])
            entities[:] = first + np.asarray(which).reshape(-1)
            for kind in range(kinds.shape[1] if len(of_block) else 1):
                names[dimension][first + kind] = [name for k, (name, _) in enumerate(of_block) if kinds[k, kind]]
        blocks.append((number, cells.tobytes(), entities.tobytes()))
    made = _signorini.plane_mesh(nodes.tobytes(), blocks, [list(of_dimension.items()) for of_dimension in names], pairs)
    points = np.frombuffer(made["points"]).reshape(-1, 2).copy()

    def integers(data: bytes, *shape: int) -> Integers:
        return np.frombuffer(data, dtype=np.int64).reshape(*shape).copy()

    # Points without a triangle are left out, the others keep their order.
    origin = np.unique(np.concatenate(corners))
    result = Mesh(
        points,
        integers(made["triangles"], -1, 3),
        {name: integers(edges, -1, 2) for name, edges in made["boundaries"].items()},
        {name: integers(members, -1) for name, members in made["surfaces"].items()},
        dict(made["named_points"]),
    )
    return result, origin, list(made["remarks"])


def _names_of_block(mesh: Any, i: int, dimension: int, count: int) -> "List[tuple[str, npt.NDArray[np.bool_]]]":
    """The names that cells of a block have, each with which of them have it."""
    names = {int(tag): name for name, (tag, of) in mesh.field_data.items() if int(of) == dimension}
    found: dict[str, npt.NDArray[np.bool_]] = {}
    physical = mesh.cell_data.get("gmsh:physical")
    if physical is not None and physical[i] is not None:
        tags = np.abs(_array(physical[i], "i", (count,), f"the physical groups of block {i}"))
        for tag in np.unique(tags[tags != 0]):
            name = names.get(int(tag), str(int(tag)))
            if int(tag) in names or name not in names.values():
                found[name] = tags == tag
    for name, cells in mesh.cell_sets.items():
        if name.startswith("gmsh:") or cells[i] is None or not len(cells[i]) or name in found:
            continue
        members = _array(cells[i], "i", (None,), f"the cell set '{name}' in block {i}")
        if not (0 <= members.min() and members.max() < count):
            raise CaseError(f"the cell set '{name}' names cells from {members.min()} to {members.max()} of block {i}; expected 0 to {count - 1}")
        found[name] = np.isin(np.arange(count), members)
    return list(found.items())


def _with_gap(
    name: str, table: Any, points: Floats, boundaries: Mapping[str, Integers], origin: Optional[Integers]
) -> Any:
    """The table of a boundary, with a function in place of a gap that is an array."""
    contact = table.get("contact") if isinstance(table, Mapping) else None
    gap = contact.get("gap") if isinstance(contact, Mapping) else None
    if not isinstance(gap, (np.ndarray, list, tuple)):
        return table
    values = _array(gap, "f", (None,), f"the gap of boundary '{name}'")
    if origin is not None and len(values) > len(points):
        values = values[origin] if origin[-1] < len(values) else values
    if len(values) != len(points):
        raise CaseError(f"the gap of boundary '{name}' has {len(values)} values; expected one for each of the {len(points)} points of the mesh")
    if name not in boundaries or not len(boundaries[name]):
        raise CaseError(f"the gap of boundary '{name}' is an array; expected a boundary of this name with edges in the mesh")
    a, b = boundaries[name].T
    start, along, at_start, at_end = points[a], points[b] - points[a], values[a], values[b]
    squared = (along**2).sum(axis=1)

    def nearest(x: float, y: float) -> float:
        """The value at the closest place of the boundary."""
        to = np.array([x, y]) - start
        share = np.clip((to * along).sum(axis=1) / squared, 0, 1)
        off = to - share[:, None] * along
        k = int(np.argmin((off**2).sum(axis=1)))
        return float((1 - share[k]) * at_start[k] + share[k] * at_end[k])

    return {**table, "contact": {**contact, "gap": nearest}}


def _key(name: str) -> str:
    return json.dumps(str(name), ensure_ascii=False)


def _toml(value: Any, functions: Optional[List[Callable[[float, float], float]]] = None) -> str:
    """The value as TOML, functions by their place in the list. The texts of JSON are texts of TOML, and so are its numbers."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(name)} = {_toml(inner, functions)}" for name, inner in value.items()) + "}"
    if isinstance(value, np.ndarray):
        value = _unmasked(value, "an array of the case").tolist()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(inner, functions) for inner in value) + "]"
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if callable(value) and functions is not None:
        functions.append(value)
        return f'"@{len(functions) - 1}"'
    raise TypeError(f"{value!r} has no place in a case; expected a number, a text, true or false, a list or a dict")


def _unmasked(values: Any, name: str) -> npt.NDArray[Any]:
    if np.ma.is_masked(values):
        raise CaseError(f"{name} has masked entries; expected numbers in all of them")
    try:
        return np.asarray(values)
    except ValueError as error:
        raise CaseError(f"{name} is no array of numbers: {error}") from None


def _array(values: Any, kind: str, shape: "tuple[Optional[int], ...]", name: str) -> npt.NDArray[Any]:
    """The values as doubles ("f") or as whole numbers of 64 bits ("i"), in rows; None stands for any number."""
    array = _unmasked(values, name)
    fits = array.ndim == len(shape) and all(want in (None, have) for want, have in zip(shape, array.shape))
    if not fits:
        expected = ", ".join("n" if want is None else str(want) for want in shape) + ("," if len(shape) == 1 else "")
        raise CaseError(f"{name} has shape {array.shape}; expected ({expected})")
    if array.dtype.kind not in ("iu" if kind == "i" else "iuf") and array.size:
        expected = "whole numbers" if kind == "i" else "real numbers"
        raise CaseError(f"{name} is of {array.dtype}; expected {expected}")
    return np.ascontiguousarray(array, dtype=np.int64 if kind == "i" else np.float64)


def _number(value: Any, name: str) -> int:
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        return operator.index(value)
    except TypeError:
        raise CaseError(f"{name} is {value!r}; expected the number of a point") from None


def _warn(texts: List[str]) -> None:
    for text in texts:
        warnings.warn(text, UserWarning, stacklevel=3)


def _solution(solved: _signorini.Solved) -> Solution:
    raw = solved.arrays()

    def floats(data: bytes, *shape: int) -> Floats:
        return np.frombuffer(data, dtype=np.float64).reshape(*shape).copy()

    def integers(data: bytes, *shape: int) -> Integers:
        return np.frombuffer(data, dtype=np.int64).reshape(*shape).copy()

    results: Results = json.loads(raw["results"])
    short = [f"not proved: {results['reason']}"] if "reason" in results else []
    for what in short + [f"no {what}" for what in results.get("missing", [])]:
        warnings.warn(what, RuntimeWarning, stacklevel=3)
    for remark in results.get("remarks", []):
        warnings.warn(remark, UserWarning, stacklevel=3)
    return Solution(
        nodes=floats(raw["nodes"], -1, 2),
        elements=integers(raw["elements"], -1, raw["nodes_per_triangle"]),
        displacement=floats(raw["displacement"], -1, 2),
        stress=floats(raw["stress"], -1, 4),
        von_mises=floats(raw["von_mises"], -1),
        contact=Contact(
            arc=floats(raw["arc"], -1),
            node=integers(raw["node"], -1),
            place=floats(raw["place"], -1, 2),
            u_n=floats(raw["u_n"], -1),
            gap=floats(raw["gap"], -1),
            sigma_n=floats(raw["sigma_n"], -1),
            lambda_h=floats(raw["lambda_h"], -1),
            pressure=floats(raw["pressure"], -1),
            boundary=np.array(raw["boundary"], dtype=np.str_),
        ),
        results=results,
        summary=solved.summary(),
        _solved=solved,
    )
