// Half a disk of radius 1 around the origin, its chord turned by 0.3: gmsh -2 -format msh41 seat.geo
Point(1) = {0, 0, 0, 0.3};
Point(2) = {Cos(0.3), Sin(0.3), 0, 0.15};
Point(3) = {-Cos(0.3), -Sin(0.3), 0, 0.25};
Point(4) = {Sin(0.3), -Cos(0.3), 0, 0.12};
Line(1) = {2, 1};
Line(2) = {1, 3};
Circle(3) = {3, 1, 4};
Circle(4) = {4, 1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Point("key") = {1};
Physical Curve("chord") = {1, 2};
Physical Curve("arc") = {3, 4};
Physical Surface("shaft") = {1};
