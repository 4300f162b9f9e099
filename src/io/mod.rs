//! What goes in and out: case files, Gmsh meshes, VTU, SVG, JSON.
