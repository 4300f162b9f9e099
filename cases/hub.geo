// The section of a hub with a flange: from r = 20 to 40, the flange to 70; the bore is the line r = 20.
// The mesh is made by: gmsh -2 -format msh41 -o hub.msh hub.geo   (Gmsh 4.8.4)
SetFactory("OpenCASCADE");
Point(1) = {20, 0, 0};
Point(2) = {70, 0, 0};
Point(3) = {70, 12, 0};
Point(4) = {44, 12, 0};
Point(5) = {40, 16, 0};
Point(6) = {40, 50, 0};
Point(7) = {20, 50, 0};
Point(8) = {44, 16, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Circle(4) = {4, 8, 5};
Line(5) = {5, 6};
Line(6) = {6, 7};
Line(7) = {7, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7};
Plane Surface(1) = {1};
Mesh.MeshSizeMax = 2;
Physical Curve("back") = {1};
Physical Curve("bore") = {7};
Physical Surface("steel") = {1};
