// Three blocks, one on the other, of 7, 11 and 9 edges where they touch.
// The mesh is made by: gmsh -2 -format msh41 -o stack.msh stack.geo   (Gmsh 4.8.4)

Geometry.AutoCoherence = 0;                 // points in one place stay apart
widths[] = {30, 22, 26};
edges[] = {7, 11, 9};
y = 0;
For k In {0:2}
  w = widths[k]/2;
  p = newp; Point(p) = {-w, y, 0}; Point(p + 1) = {w, y, 0}; Point(p + 2) = {w, y + 10, 0}; Point(p + 3) = {-w, y + 10, 0};
  c = newl; Line(c) = {p, p + 1}; Line(c + 1) = {p + 1, p + 2}; Line(c + 2) = {p + 2, p + 3}; Line(c + 3) = {p + 3, p};
  l = newll; Curve Loop(l) = {c, c + 1, c + 2, c + 3};
  s = news; Plane Surface(s) = {l};
  Transfinite Curve{c, c + 2} = edges[k] + 1;
  Transfinite Curve{c + 1, c + 3} = 5;
  Transfinite Surface{s};
  bottom[k] = c;
  top[k] = c + 2;
  body[k] = s;
  corner[k] = p;
  y += 10;
EndFor
Physical Curve("base") = {bottom[0]};
Physical Curve("lower_top") = {top[0]};
Physical Curve("middle_bottom") = {bottom[1]};
Physical Curve("middle_top") = {top[1]};
Physical Curve("upper_bottom") = {bottom[2]};
Physical Curve("top") = {top[2]};
Physical Point("left") = {corner[1]};
Physical Surface("lower") = {body[0]};
Physical Surface("middle") = {body[1]};
Physical Surface("upper") = {body[2]};
