#!/usr/bin/env python3
"""Reads what `signorini solve` wrote with two independent readers, meshio and pyvista (VTK), and compares.

    check_outputs.py FOLDER ...

solution.vtu and contact.vtu must have their fields, finite, of the right shape, the same to the bit for both readers,
and in step with result.json. Then the check is checked: truncated and altered copies of the files must not pass.
Needs meshio, pyvista and numpy. Exit code 0 if all is well, else 1 with a line for what is not.
"""

import json
import shutil
import sys
import tempfile
from pathlib import Path

import meshio
import numpy as np
import pyvista

# Field: (components, belongs to points or cells)
SOLUTION = {"displacement": (3, "points"), "stress": (6, "cells"), "von_mises": (1, "cells")}
SOLUTION |= {"nodal_stress": (6, "points"), "nodal_von_mises": (1, "points"), "principal_1": (1, "points"), "principal_2": (1, "points")}
CONTACT = {name: (1, "points") for name in ("u_n", "gap", "sigma_n", "lambda")} | {"displacement": (3, "points")}

# VTK's number of a cell: meshio's name, corners, and the corners on both sides of each middle node.
KINDS = {
    5: ("triangle", 3, []),
    22: ("triangle6", 3, [(0, 1), (1, 2), (2, 0)]),
    3: ("line", 2, []),
    21: ("line3", 2, [(0, 1)]),
}


class Wrong(Exception):
    pass


def expect(condition, message):
    if not condition:
        raise Wrong(message)


def read(path):
    """The file as both readers see it: points, cells (VTK's number and node lists), point fields, cell fields."""
    try:
        m = meshio.read(path)
    except BaseException as error:  # meshio calls sys.exit on some files
        raise Wrong(f"meshio cannot read it: {type(error).__name__} {error}") from error
    reader = pyvista.get_reader(path)
    try:
        v = reader.read()
    except Exception as error:
        raise Wrong(f"pyvista cannot read it: {error}") from error
    expect(reader.reader.GetErrorCode() == 0, "VTK reports an error")
    expect(len(m.cells) == 1, f"meshio finds {len(m.cells)} blocks of cells; expected 1")
    kinds = sorted(set(v.celltypes.tolist()))
    expect(len(kinds) == 1 and kinds[0] in KINDS, f"cells of VTK types {kinds}; expected one of {list(KINDS)}")
    name = KINDS[kinds[0]][0]
    expect(m.cells[0].type == name, f"meshio sees cells '{m.cells[0].type}'; VTK sees '{name}'")
    cells = m.cells[0].data
    same("points", m.points, v.points)
    same("cells", cells, v.cells_dict[kinds[0]])
    m_cell_data = {name: blocks[0] for name, blocks in m.cell_data.items()}
    for where, ours, theirs in [("points", m.point_data, v.point_data), ("cells", m_cell_data, v.cell_data)]:
        names = sorted(theirs.keys())
        expect(sorted(ours) == names, f"fields on {where}: meshio finds {sorted(ours)}, VTK finds {names}")
        for field in ours:
            same(field, ours[field], theirs[field])
    return kinds[0], m.points, cells, {"points": m.point_data, "cells": m_cell_data}


def same(name, a, b):
    a, b = np.asarray(a), np.asarray(b)
    expect(a.shape == b.shape, f"{name}: meshio reads shape {a.shape}, VTK {b.shape}")
    expect(np.array_equal(a, b, equal_nan=True), f"{name}: meshio and VTK read different values")


def check_grid(path, kinds, fields):
    kind, points, cells, data = read(path)
    expect(kind in kinds, f"cells '{KINDS[kind][0]}'; expected one of {[KINDS[k][0] for k in kinds]}")
    expect(points.dtype == np.float64 and np.isfinite(points).all(), "points are not finite doubles")
    expect((points[:, 2] == 0).all(), "points lie outside the plane z = 0")
    expect(len(cells) > 0, "no cells")
    expect(set(cells.ravel()) == set(range(len(points))), "points that no cell uses")
    for name, (components, where) in fields.items():
        expect(name in data[where], f"no field '{name}' on the {where}; found {sorted(data[where])}")
        values = np.asarray(data[where][name])
        shape = (len(points) if where == "points" else len(cells),) + ((components,) if components > 1 else ())
        expect(values.shape == shape, f"{name} has shape {values.shape}; expected {shape}")
        expect(values.dtype == np.float64, f"{name} is {values.dtype}; expected doubles")
        expect(np.isfinite(values).all(), f"{name} is not finite")
    _, corners, middles = KINDS[kind]
    for i, (a, b) in enumerate(middles):
        off = points[cells[:, corners + i]] - (points[cells[:, a]] + points[cells[:, b]]) / 2
        expect(np.abs(off).max() <= 1e-12 * np.ptp(points), f"node {corners + i} is not between nodes {a} and {b}")
    if corners == 3:
        a, b, c = (points[cells[:, i], :2] for i in range(3))
        double_area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
        expect((double_area > 0).all(), "triangles that are not counter-clockwise")
    return points, cells, data


def check(folder):
    folder = Path(folder)
    result = json.loads((folder / "result.json").read_text())
    sizes, quantities = result["mesh"], result["quantities"]

    name = "solution.vtu"
    try:
        points, cells, data = check_grid(folder / name, [5, 22], SOLUTION)
        expect(len(cells) == sizes["triangles"], f"{len(cells)} triangles; result.json has {sizes['triangles']}")
        expect(2 * len(points) == sizes["dofs"], f"{len(points)} points; result.json has {sizes['dofs']} dofs")
        u = data["points"]["displacement"]
        expect((u[:, 2] == 0).all(), "displacement has a z component")
        largest = np.hypot(u[:, 0], u[:, 1]).max()
        expect(
            np.isclose(largest, quantities["max_displacement"], rtol=1e-14, atol=0),
            f"largest displacement {largest}; result.json has {quantities['max_displacement']}",
        )
        expect((data["cells"]["stress"][:, 4:] == 0).all(), "stress has yz or xz components")
        expect((data["cells"]["von_mises"] >= 0).all(), "von_mises is negative")
        xx, yy, _, xy, *_ = np.asarray(data["points"]["nodal_stress"]).T
        both = np.linalg.eigvalsh(np.array([[xx, xy], [xy, yy]]).T)
        for field, found in (("principal_1", both[:, 1]), ("principal_2", both[:, 0])):
            off = np.abs(data["points"][field] - found).max()
            expect(off <= 1e-12 * np.abs(both).max(), f"{field} is off the eigenvalues of nodal_stress by {off}")

        name = "contact.vtu"
        _, cells, data = check_grid(folder / name, [3, 21], CONTACT)
        expect(len(cells) == sizes["contact_edges"], f"{len(cells)} edges; result.json has {sizes['contact_edges']}")
        expect((data["points"]["lambda"] <= 0).all(), "lambda is positive: the contact pulls")
    except Wrong as wrong:
        raise Wrong(f"{folder / name}: {wrong}") from wrong


def damaged(content):
    """Copies of a file that must not pass, each with what was done to it."""
    for part in (0.1, 0.5, 0.9, 0.999):
        yield f"cut after {part:.1%}", content[: int(part * len(content))]
    # The first array: its length, then the numbers, of which two become NaN.
    start = content.index(b'format="binary">\n') + len(b'format="binary">\n')
    yield "with other bits in its first array", content[: start + 64] + b"/" * 24 + content[start + 88 :]
    first = content.index(b'Name="') + 6
    yield "with another name for its first field", content[:first] + b"x" + content[first + 1 :]


def check_that_damage_is_noticed(folder):
    for name in ("solution.vtu", "contact.vtu"):
        content = (Path(folder) / name).read_bytes()
        for damage, copy in damaged(content):
            with tempfile.TemporaryDirectory() as scratch:
                for file in ("solution.vtu", "contact.vtu", "result.json"):
                    shutil.copy(Path(folder) / file, scratch)
                (Path(scratch) / name).write_bytes(copy)
                try:
                    check(scratch)
                except Wrong:
                    continue
            raise Wrong(f"{folder}/{name} passes even {damage}: this check checks nothing")


def main(folders):
    if not folders:
        sys.exit(__doc__)
    for folder in folders:
        try:
            check(folder)
            check_that_damage_is_noticed(folder)
        except (Wrong, OSError, KeyError, ValueError) as error:
            sys.exit(f"check_outputs.py: {type(error).__name__}: {error}")
        print(f"{folder}: meshio and pyvista agree")


if __name__ == "__main__":
    main(sys.argv[1:])
