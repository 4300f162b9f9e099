// A quarter of two rings, 20 to 30.015 and 29.985 to 45: they overlap by 0.03, and are pressed into each other.
// The mesh is made by: gmsh -2 -format msh41 -o press_fit.msh press_fit.geo   (Gmsh 4.8.4)

DefineConstant[m = 24, n = 33];             // the edges where they touch, of the inner ring and of the outer one

Point(1) = {0, 0, 0};                       // the centre
Point(2) = {20, 0, 0};
Point(3) = {30.015, 0, 0};
Point(4) = {0, 30.015, 0};
Point(5) = {0, 20, 0};
Point(6) = {29.985, 0, 0};
Point(7) = {45, 0, 0};
Point(8) = {0, 45, 0};
Point(9) = {0, 29.985, 0};

Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Circle(4) = {5, 1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{2, 4} = m + 1;
Transfinite Curve{1, 3} = 7;
Transfinite Surface{1} = {2, 3, 4, 5};

Line(5) = {6, 7};
Circle(6) = {7, 1, 8};
Line(7) = {8, 9};
Circle(8) = {9, 1, 6};
Curve Loop(2) = {5, 6, 7, 8};
Plane Surface(2) = {2};
Transfinite Curve{6, 8} = n + 1;
Transfinite Curve{5, 7} = 9;
Transfinite Surface{2} = {6, 7, 8, 9};

Physical Curve("shaft") = {2};
Physical Curve("bore") = {8};
Physical Curve("across") = {1, 5};
Physical Curve("along") = {3, 7};
Physical Surface("inner") = {1};
Physical Surface("outer") = {2};
