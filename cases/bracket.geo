// A steel bracket with a fillet and a bolt hole, on a rubber pad. The pad stands on the floor y = -4, the bracket leans on the wall x = 0.
// The mesh is made by: gmsh -2 -format msh41 -o bracket.msh bracket.geo   (Gmsh 4.15.2)

DefineConstant[h = 2];

Point(1) = {0.02, 0, 0, h};                 // 0.02 in front of the wall
Point(2) = {20, 0, 0, h};
Point(3) = {60, 0, 0, h};
Point(4) = {60, 10, 0, h};
Point(5) = {18, 10, 0, h/2};
Point(6) = {18, 18, 0};                     // the centre of the fillet
Point(7) = {10, 18, 0, h/2};
Point(8) = {10, 50, 0, h};
Point(9) = {0.02, 50, 0, h};
Point(10) = {20, -4, 0, h};
Point(11) = {60, -4, 0, h};
Point(12) = {40, 5, 0};                     // the centre of the hole
Point(13) = {42.5, 5, 0, h/3};
Point(14) = {37.5, 5, 0, h/3};

Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Circle(5) = {5, 6, 7};
Line(6) = {7, 8};
Line(7) = {8, 9};
Line(8) = {9, 1};
Line(9) = {2, 10};
Line(10) = {10, 11};
Line(11) = {11, 3};
Circle(12) = {13, 12, 14};
Circle(13) = {14, 12, 13};
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7, 8};
Curve Loop(2) = {12, 13};
Curve Loop(3) = {9, 10, 11, -2};
Plane Surface(1) = {1, 2};
Plane Surface(2) = {3};

Physical Curve("wall") = {8};
Physical Curve("floor") = {10};
Physical Curve("hole") = {12, 13};
Physical Curve("bond") = {2};               // inside the body: nothing is prescribed there
Physical Surface("steel") = {1};
Physical Surface("rubber") = {2};
