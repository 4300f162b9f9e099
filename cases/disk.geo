// Lower half of a disk of radius 1 around (0, 1): it touches the floor y = 0 in its lowest point.
// The mesh is made by: gmsh -2 -format msh41 -o disk.msh disk.geo   (Gmsh 4.8.4)

DefineConstant[h = 0.01];                  // the edges near the lowest point

Point(1) = {0, 1, 0};                      // the centre
Point(2) = {-1, 1, 0};
Point(3) = {-0.5, 1 - Sqrt(0.75), 0};
Point(4) = {0, 0, 0};                      // the lowest point
Point(5) = {0.5, 1 - Sqrt(0.75), 0};
Point(6) = {1, 1, 0};

Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Circle(4) = {5, 1, 6};
Line(5) = {6, 2};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};

Physical Curve("contact") = {2, 3};
Physical Curve("free") = {1, 4};
Physical Curve("top") = {5};
Physical Surface("body") = {1};

// Edges of h near the lowest point, growing to 0.15 away from it.
Field[1] = Distance;
Field[1].PointsList = {4};
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].DistMin = 0.15;
Field[2].SizeMin = h;
Field[2].DistMax = 1;
Field[2].SizeMax = 0.15;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
