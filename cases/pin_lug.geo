// The upper half of a lug, 40 wide, with a hole of radius 10.05, and of a pin of radius 10 in it.
// The mesh is made by: gmsh -2 -format msh41 -o pin_lug.msh pin_lug.geo   (Gmsh 4.8.4)

DefineConstant[h = 0.8];                    // the edges on pin and hole

Point(1) = {0, 0, 0};                       // the centre of both
Point(2) = {10, 0, 0};                      // the pin
Point(3) = {0, 10, 0};
Point(4) = {-10, 0, 0};
Point(5) = {10.05, 0, 0};                   // the hole
Point(6) = {0, 10.05, 0};
Point(7) = {-10.05, 0, 0};
Point(8) = {20, 0, 0};                      // the lug, round at its end
Point(9) = {0, 20, 0};
Point(10) = {-50, 20, 0};
Point(11) = {-50, 0, 0};

Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 2};
Curve Loop(1) = {1, 2, 3};
Plane Surface(1) = {1};

Circle(4) = {5, 1, 6};
Circle(5) = {6, 1, 7};
Circle(6) = {8, 1, 9};
Line(7) = {9, 10};
Line(8) = {10, 11};
Line(9) = {11, 7};
Line(10) = {5, 8};
Curve Loop(2) = {10, 6, 7, 8, 9, -5, -4};
Plane Surface(2) = {2};

Physical Curve("pin") = {1, 2};
Physical Curve("hole") = {4, 5};
Physical Curve("symmetry") = {3, 9, 10};
Physical Curve("end") = {8};
Physical Surface("steel") = {1};
Physical Surface("aluminium") = {2};

// Edges of h on pin and hole, growing away from them.
Field[1] = MathEval;
Field[1].F = Sprintf("%g + 0.3*Fabs(Sqrt(x*x + y*y) - 10)", h);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
