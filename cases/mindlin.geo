// Two half cylinders of radius 10 that touch at the origin, equal to each other.
// The mesh is made by: gmsh -2 -format msh41 -o mindlin.msh mindlin.geo   (Gmsh 4.8.4)

DefineConstant[h = 0.05];                   // the edges near the point of contact

Point(1) = {0, -10, 0};                     // the lower cylinder: its centre, and the point of contact
Point(2) = {10, -10, 0};
Point(3) = {0, 0, 0};
Point(4) = {-10, -10, 0};
Point(5) = {0, 10, 0};                      // the upper one
Point(6) = {-10, 10, 0};
Point(7) = {0, 0, 0};
Point(8) = {10, 10, 0};

Line(1) = {4, 2};
Circle(2) = {2, 1, 3};
Circle(3) = {3, 1, 4};
Curve Loop(1) = {1, 2, 3};
Plane Surface(1) = {1};

Line(4) = {8, 6};
Circle(5) = {6, 5, 7};
Circle(6) = {7, 5, 8};
Curve Loop(2) = {4, 5, 6};
Plane Surface(2) = {2};

Physical Curve("base") = {1};
Physical Curve("lower") = {2, 3};
Physical Curve("upper") = {5, 6};
Physical Curve("top") = {4};
Physical Surface("lower cylinder") = {1};
Physical Surface("upper cylinder") = {2};

Field[1] = Ball;
Field[1].Radius = 0.6;
Field[1].Thickness = 9;
Field[1].VIn = h;
Field[1].VOut = 2;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Geometry.AutoCoherence = 0;
