#!/usr/bin/env python3
"""make.py FOLDER: writes the meshes of this folder, in the ways in which other people's meshes differ. Gmsh 4.8.4 and meshio 5.3.5 made
those that are here; tests/suite/meshes.rs says what is read of each."""
import re
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np

OUT = Path(sys.argv[1])
SQUARE = [f"Point({i + 1}) = {{{x}, {y}, %(z)s, 0.6}}" for i, (x, y) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)])]
SQUARE += [f"Line({i}) = {{{i}, {i % 4 + 1}}}" for i in range(1, 5)]
ENDS = ['Physical Curve("bottom") = {1}', 'Physical Curve("top") = {3}', 'Physical Surface("body") = {1}']
RIGHT = ["Point(5) = {2, 0, 0, 0.6}", "Point(6) = {2, 1, 0, 0.6}", "Line(5) = {2, 5}", "Line(6) = {5, 6}", "Line(7) = {6, 3}"]
TWO = ['Physical Curve("bottom") = {1, 5}', 'Physical Curve("top") = {3, 7}']
TWO += ['Physical Surface("left") = {1}', 'Physical Surface("right") = {2}']


def gmsh(name, lines, *options, form="msh41", dimension=2):
    geometry = OUT / "geometry.geo"
    geometry.write_text("".join(f"{line};\n" for line in lines))
    target = OUT / f"{name}.msh"
    subprocess.run(["gmsh", "-v", "1", f"-{dimension}", str(geometry), "-format", form, *options, "-o", str(target)], check=True)
    geometry.unlink()
    return target


def square(name, *options, groups=ENDS, more=(), loop="1, 2, 3, 4", z=0, kernel=(), form="msh41"):
    surface = [f"Curve Loop(1) = {{{loop}}}", "Plane Surface(1) = {1}"]
    lines = [*kernel, *(line % {"z": z} if "%" in line else line for line in SQUARE), *surface, *more, *groups]
    return gmsh(name, lines, *options, form=form)


# Formats.
new, old = square("msh41"), square("msh22", form="msh22")
square("msh41_binary", "-bin")
square("msh22_binary", "-bin", form="msh22")
square("msh40", form="msh40")
square("msh1", form="msh1")
square("parametric_22", "-parametric", form="msh22")
for name, version in [("msh21", "2.1"), ("msh2", "2")]:
    (OUT / f"{name}.msh").write_text(old.read_text().replace("2.2 0 8", f"{version} 0 8", 1))
(OUT / "comment_first.msh").write_text("$Comments\na square\n$EndComments\n" + old.read_text())
(OUT / "no_entities.msh").write_text(re.sub(r"\$Entities.*?\$EndEntities\n", "", new.read_text(), flags=re.S))

# Groups.
square("unnamed_unused", groups=[*ENDS, "Physical Curve(77) = {2}"])
numbers = ["Physical Curve(1) = {1}", "Physical Curve(3) = {3}", "Physical Surface(9) = {1}"]
square("numbers_only", groups=numbers)
square("numbers_only_22_binary", "-bin", groups=numbers, form="msh22")
square("no_curves", groups=ENDS[2:])
square("no_groups", groups=[], form="msh22")
square("points", groups=[*ENDS, 'Physical Point("p") = {1, 2}', "Physical Point(5) = {3}"])
for suffix, form in [("", "msh41"), ("_22", "msh22")]:
    square(f"curves_in_two_groups{suffix}", groups=[*ENDS, 'Physical Curve("all") = {1, 2, 3, 4}'], form=form)
    square(f"surface_in_two_groups{suffix}", groups=[*ENDS, 'Physical Surface("domain") = {1}'], form=form)
inside = ["Point(9) = {0.5, 0.5, 0, 0.6}", "Point(10) = {0.5, 0.8, 0, 0.6}", "Line(9) = {9, 10}"]
square("curve_inside", more=[*inside, "Line{9} In Surface{1}"], groups=[*ENDS, 'Physical Curve("cut") = {9}'])
outside = [line.replace("{0.5", "{2") for line in inside]
square("curve_outside", more=outside, groups=[*ENDS, 'Physical Curve("far") = {9}'])

# Orientation.
square("clockwise", loop="-4, -3, -2, -1")
square("clockwise_22", loop="-4, -3, -2, -1", kernel=['SetFactory("OpenCASCADE")'], form="msh22")
square("one_surface_clockwise", more=[*RIGHT, "Curve Loop(2) = {2, -7, -6, -5}", "Plane Surface(2) = {2}"], groups=TWO)

# Partitions.
square("partitions", "-part", "3")
square("partitions_binary", "-part", "3", "-part_topo", "-bin")
square("partitions_with_ghosts", "-part", "3", "-part_ghosts")
square("partitions_22", "-part", "3", form="msh22")
for form, names in [("msh41", {"_1": "one_partition", "_2": None}), ("msh22", {"_1": "first_partition_22", "_2": "second_partition_22"})]:
    square("split", "-part", "2", "-part_split", form=form)
    for part, name in names.items():
        if name:
            (OUT / f"split{part}.msh").rename(OUT / f"{name}.msh")
        else:
            (OUT / f"split{part}.msh").unlink()

# Elements, and what is not in the plane.
square("quadrangles", more=["Recombine Surface{1}"])
square("quadrangles_order_2", "-order", "2", more=["Recombine Surface{1}"], form="msh22")
more = [*RIGHT, "Curve Loop(2) = {5, 6, 7, -2}", "Plane Surface(2) = {2}", "Recombine Surface{2}"]
square("quadrangles_and_triangles", more=more, groups=TWO)
square("order_2", "-order", "2")
square("order_3", "-order", "3", form="msh22")
square("z_is_2", z=2)
occ = ['SetFactory("OpenCASCADE")', "Mesh.MeshSizeMin = 2", "Mesh.MeshSizeMax = 2"]
box = [*occ, "Box(1) = {0, 0, 0, 1, 1, 1}"]
gmsh("body_3d", [*box, 'Physical Volume("v") = {1}', 'Physical Surface("s") = {1}'], dimension=3)
gmsh("shell_3d", [*box, 'Physical Surface("s") = {1:6}'], form="msh22")
disk = [*occ, "Disk(1) = {0, 0, 0, 1}", 'Physical Surface("d") = {1}', 'Physical Curve("rim") = {1}']
gmsh("curved", [line.replace("= 2", "= 1") for line in disk], "-order", "2")

# meshio.
mesh = meshio.read(new)
mesh.write(OUT / "meshio_names.msh", file_format="gmsh", binary=False)
triangles = np.vstack([block.data for block in mesh.cells if block.type == "triangle"])
bare = meshio.Mesh(mesh.points, [("triangle", triangles)])
bare.write(OUT / "meshio_bare.msh", file_format="gmsh", binary=False)
bare.write(OUT / "meshio_bare_binary.msh", file_format="gmsh", binary=True)
turned = meshio.Mesh(mesh.points, [("triangle", triangles[:, ::-1])])
turned.write(OUT / "meshio_clockwise.msh", file_format="gmsh22", binary=False)
cells = [("quad", [[i, i + 1, i + 5, i + 4] for i in range(3)])]
places = np.array([[i % 4, i // 4, 0.0] for i in range(8)])
meshio.Mesh(places, cells).write(OUT / "meshio_quadrangles.msh", file_format="gmsh", binary=False)
square("abaqus")
subprocess.run(["gmsh", "-v", "1", str(OUT / "abaqus.msh"), "-save", "-o", str(OUT / "abaqus.inp")], check=True)
abaqus = meshio.read(OUT / "abaqus.inp")
blocks = [block for block in abaqus.cells if block.type == "triangle"]
meshio.Mesh(abaqus.points, blocks).write(OUT / "meshio_of_abaqus.msh", file_format="gmsh", binary=False)
(OUT / "abaqus.msh").unlink()
(OUT / "abaqus.inp").unlink()
