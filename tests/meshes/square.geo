// Two surfaces under an arc, three of their sides with a name. Gmsh 4.8.4 made
//   square-binary.msh:  gmsh -2 -format msh41 -bin -o square-binary.msh square.geo
lc = 0.5;
Point(10) = {0, 0, 0, lc};
Point(20) = {1, 0, 0, lc};
Point(30) = {1, 0.5, 0, lc};
Point(40) = {0, 0.5, 0, lc};
Point(50) = {1, 1, 0, lc};
Point(60) = {0, 1, 0, lc};
Point(70) = {0.5, 2, 0, lc};  // the centre of the arc: no triangle uses it
Line(1) = {10, 20};
Line(2) = {20, 30};
Line(3) = {30, 40};
Line(4) = {40, 10};
Line(5) = {30, 50};
Circle(6) = {50, 70, 60};
Line(7) = {60, 40};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Curve Loop(2) = {-3, 5, 6, 7};
Plane Surface(2) = {2};
Physical Curve("the floor") = {1};
Physical Curve("right", 7) = {2, 5};
Physical Curve("top", 3) = {-6};
Physical Surface("body") = {1, 2};
