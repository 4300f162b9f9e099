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
or that lacks something else that the case asks for, comes with a warning: `solution.verdict` is "proved" or "not proved".
"""

from __future__ import annotations

import json
import os
import warnings
from dataclasses import dataclass
from typing import Any, List, Mapping, NamedTuple, Optional, Union

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
    """The number of the node."""
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
    """(triangles, 3 or 6): the nodes of each triangle, vertices first, then the middle opposite each vertex."""
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
        """Between what numbers of the true solution lie, as in certified["contact force", "floor"]; empty without a certificate,
        which `adapt` makes. The upper end of a peak pressure is infinite. docs/result.md has the names."""
        continuous = self.results.get("certificate", {}).get("continuous", {})
        return {
            (q["name"], q["boundary"]): (q["interval"][0], np.inf if q["interval"][1] is None else q["interval"][1])
            for q in continuous.get("quantities", [])
            if "interval" in q and "weight" not in q
        }


def solve_case(
    path: Union[str, "os.PathLike[str]"], *, set: Optional[Mapping[str, Any]] = None
) -> Solution:
    """Solve a case file; `set` sets keys over it, as in {"method.gamma0": 1e-3}."""
    settings = [f"{key}={_toml(value)}" for key, value in (set or {}).items()]
    return _solution(_signorini.solve_case(os.fspath(path), settings))


def solve(
    points: Any,
    triangles: Optional[npt.ArrayLike] = None,
    boundaries: Optional[Mapping[str, npt.ArrayLike]] = None,
    surfaces: Optional[Mapping[str, npt.ArrayLike]] = None,
    named_points: Optional[Mapping[str, int]] = None,
    **tables: Any,
) -> Solution:
    """Solve a contact problem on a mesh: points (n, 2), triangles (m, 3), counter-clockwise, and for each named boundary its
    edges (k, 2) as pairs of points; for materials and loads by surface the triangles (k,) of each, and for supports in points the
    number of each. Or a meshio mesh in place of them all.

    The tables are those of a case file: material, boundary, load, method, solver, output, ... A number may stand where the
    file has an expression.
    """
    if triangles is None and boundaries is None and hasattr(points, "cells"):
        points, triangles, boundaries, surfaces, named_points = from_meshio(points)
    if triangles is None or boundaries is None:
        raise TypeError("expected points, triangles and boundaries, or a meshio mesh")
    text = "".join(f"{_key(name)} = {_toml(table)}\n" for name, table in tables.items())
    return _solution(
        _signorini.solve(
            text,
            _bytes(points, np.float64, 2, "points"),
            _bytes(triangles, np.int64, 3, "triangles"),
            [(name, _bytes(edges, np.int64, 2, f"boundary '{name}'")) for name, edges in boundaries.items()],
            [(name, _numbers(members, f"surface '{name}'")) for name, members in (surfaces or {}).items()],
            [(name, int(point)) for name, point in (named_points or {}).items()],
        )
    )


class Mesh(NamedTuple):
    """A mesh as `solve` takes it."""

    points: Floats
    triangles: Integers
    boundaries: dict[str, Integers]
    surfaces: dict[str, Integers]
    named_points: dict[str, int]


def from_meshio(mesh: Any) -> Mesh:
    """Points, triangles and what is named of a meshio mesh, by its physical names (as Gmsh writes them) or its cell sets. Points that no triangle uses are left out, and triangles are turned counter-clockwise."""
    triangles = [block.data for block in mesh.cells if block.type == "triangle"]
    if not triangles:
        found = ", ".join(sorted({block.type for block in mesh.cells})) or "no cells"
        raise CaseError(f"the meshio mesh has {found}; expected triangles")
    corners = np.concatenate(triangles).astype(np.int64)
    places = np.asarray(mesh.points, dtype=np.float64)
    if places.shape[1] > 2 and np.any(places[:, 2] != 0):
        raise CaseError("the meshio mesh leaves the plane z = 0")
    used = np.unique(corners)
    number = np.full(len(places), -1, dtype=np.int64)
    number[used] = np.arange(len(used))
    points = np.ascontiguousarray(places[used, :2])
    corners = number[corners]
    a, b, c = (points[corners[:, i]] for i in range(3))
    clockwise = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    corners[clockwise] = corners[clockwise][:, [0, 2, 1]]

    named: dict[str, dict[str, list[Integers]]] = {"vertex": {}, "line": {}, "triangle": {}}
    names = {(dimension, int(tag)): name for name, (tag, dimension) in mesh.field_data.items()}
    physical = mesh.cell_data.get("gmsh:physical", [None] * len(mesh.cells))
    first = 0
    for i, block in enumerate(mesh.cells):
        if block.type not in named:
            continue
        of_type, dimension = named[block.type], list(named).index(block.type)
        members = np.arange(first, first + len(block.data)) if block.type == "triangle" else number[block.data]
        first += len(block.data) if block.type == "triangle" else 0
        if physical[i] is not None:
            for tag in np.unique(physical[i]):
                if (dimension, int(tag)) in names:
                    chosen = members[np.asarray(physical[i]) == tag]
                    of_type.setdefault(names[dimension, int(tag)], []).append(chosen)
        for name, cells in mesh.cell_sets.items():
            if not name.startswith("gmsh:") and cells[i] is not None and len(cells[i]) and name not in names.values():
                of_type.setdefault(name, []).append(members[np.asarray(cells[i], dtype=np.int64)])
    points_by_name = {name: int(np.concatenate(parts)[0, 0]) for name, parts in named["vertex"].items()}
    boundaries, surfaces = (
        {name: np.concatenate(parts) for name, parts in named[kind].items()} for kind in ("line", "triangle")
    )
    return Mesh(points, corners, boundaries, surfaces, points_by_name)


def _key(name: str) -> str:
    return json.dumps(str(name), ensure_ascii=False)


def _toml(value: Any) -> str:
    """The value as TOML. The texts of JSON are texts of TOML, and so are its numbers."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(name)} = {_toml(inner)}" for name, inner in value.items()) + "}"
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
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
    raise TypeError(f"{value!r} has no place in a case; expected a number, a text, true or false, a list or a dict")


def _bytes(values: Any, dtype: Any, columns: int, name: str) -> bytes:
    array = np.asarray(values)
    if array.ndim != 2 or array.shape[1] != columns:
        raise CaseError(f"{name} has shape {array.shape}; expected (n, {columns})")
    if np.issubdtype(dtype, np.integer) and not np.issubdtype(array.dtype, np.integer):
        raise CaseError(f"{name} is of {array.dtype}; expected whole numbers")
    return np.ascontiguousarray(array, dtype=dtype).tobytes()


def _numbers(values: Any, name: str) -> bytes:
    array = np.asarray(values)
    if array.ndim != 1 or not np.issubdtype(array.dtype, np.integer):
        raise CaseError(f"{name} has shape {array.shape} of {array.dtype}; expected a list of whole numbers")
    return np.ascontiguousarray(array, dtype=np.int64).tobytes()


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
    return Solution(
        nodes=floats(raw["nodes"], -1, 2),
        elements=integers(raw["elements"], -1, raw["nodes_per_triangle"]),
        displacement=floats(raw["displacement"], -1, 2),
        stress=floats(raw["stress"], -1, 4),
        von_mises=floats(raw["von_mises"], -1),
        contact=Contact(
            arc=floats(raw["arc"], -1),
            node=integers(raw["node"], -1),
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
