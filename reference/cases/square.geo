// The unit square with triangles of different sizes and shapes: gmsh -2 -format msh41 square.geo
Point(1) = {0, 0, 0, 0.3};
Point(2) = {1, 0, 0, 0.15};
Point(3) = {1, 1, 0, 0.4};
Point(4) = {0, 1, 0, 0.25};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Surface("body") = {1};
