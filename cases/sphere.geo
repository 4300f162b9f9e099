// A quarter of the section of a ball of radius 10: below its equator, beside its axis x = 0. Fine where it touches the plate.
// The mesh is made by: gmsh -2 -format msh41 -o sphere.msh sphere.geo   (Gmsh 4.8.4)
SetFactory("OpenCASCADE");
Point(1) = {0, 0, 0};
Point(2) = {10, 10, 0};
Point(3) = {0, 10, 0};
Circle(1) = {1, 3, 2};
Line(2) = {2, 3};
Line(3) = {3, 1};
Curve Loop(1) = {1, 2, 3};
Plane Surface(1) = {1};
Field[1] = Distance;
Field[1].PointsList = {1};
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = 0.03125;
Field[2].SizeMax = 2;
Field[2].DistMin = 0.7;
Field[2].DistMax = 10;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Physical Curve("ball") = {1};
Physical Curve("equator") = {2};
Physical Surface("steel") = {1};
