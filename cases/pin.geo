// A quarter of a plate with a hole of radius 20, which sits on a rigid pin of the same radius.
// The mesh is made by: gmsh -2 -format msh41 -o pin.msh pin.geo   (Gmsh 4.8.4)

DefineConstant[h = 1.5];                    // the edges on the hole

Point(1) = {0, 0, 0};                       // the centre of the pin
Point(2) = {20, 0, 0};
Point(3) = {60, 0, 0};
Point(4) = {60, 60, 0};
Point(5) = {0, 60, 0};
Point(6) = {0, 20, 0};

Line(1) = {2, 3};
Line(2) = {3, 4};
Line(3) = {4, 5};
Line(4) = {5, 6};
Circle(5) = {6, 1, 2};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};

Physical Curve("hole") = {5};
Physical Curve("symmetry") = {4};
Physical Curve("cut") = {1};
Physical Surface("plate") = {1};

// Edges of h on the hole, growing to 5 h at 40 from it.
Field[1] = MathEval;
Field[1].F = Sprintf("%g*(1 + (Sqrt(x*x + y*y) - 20)/10)", h);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
