// The right halves of two cylinders where they touch, of radius 50 below and 25 above; each as high as it is wide.
// The mesh is made by: gmsh -2 -format msh41 -o cylinders.msh cylinders.geo   (Gmsh 4.8.4)

DefineConstant[h = 0.06];                   // the edges near the point of contact, above; below they are half as long again

Point(1) = {0, -50, 0};                     // the lower cylinder: its centre, and the point of contact
Point(2) = {50, -50, 0};
Point(3) = {0, 0, 0};
Point(4) = {0, 25, 0};                      // the upper one
Point(5) = {25, 25, 0};
Point(6) = {0, 0, 0};

Line(1) = {1, 2};
Circle(2) = {2, 1, 3};
Line(3) = {3, 1};
Curve Loop(1) = {1, 2, 3};
Plane Surface(1) = {1};

Line(4) = {4, 6};
Circle(5) = {6, 4, 5};
Line(6) = {5, 4};
Curve Loop(2) = {4, 5, 6};
Plane Surface(2) = {2};

Physical Curve("base") = {1};
Physical Curve("lower") = {2};
Physical Curve("symmetry") = {3, 4};
Physical Curve("upper") = {5};
Physical Curve("top") = {6};
Physical Surface("cast_iron") = {1};
Physical Surface("steel") = {2};

// Edges of h within 1.2 of the point of contact, growing away from it.
Field[1] = MathEval;
Field[1].F = Sprintf("1.5*%g + 0.35*(Sqrt(x*x + y*y) - 1.2 + Fabs(Sqrt(x*x + y*y) - 1.2))/2", h);
Field[2] = Restrict;
Field[2].InField = 1;
Field[2].SurfacesList = {1};
Field[2].CurvesList = {1, 2, 3};
Field[3] = MathEval;
Field[3].F = Sprintf("%g + 0.35*(Sqrt(x*x + y*y) - 1.2 + Fabs(Sqrt(x*x + y*y) - 1.2))/2", h);
Field[4] = Restrict;
Field[4].InField = 3;
Field[4].SurfacesList = {2};
Field[4].CurvesList = {4, 5, 6};
Field[5] = Min;
Field[5].FieldsList = {2, 4};
Background Field = 5;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Geometry.AutoCoherence = 0;
