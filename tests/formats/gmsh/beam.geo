// A bar of second-order tetrahedra with a beam of lines beside it.
L = 1.0; w = 0.05; h = 0.1;
Point(1) = {0, 0, 0}; Point(2) = {0, w, 0}; Point(3) = {0, w, h}; Point(4) = {0, 0, h};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve{1, 2, 3, 4} = 2; Transfinite Surface{1};
out[] = Extrude{L, 0, 0} { Surface{1}; Layers{10}; };
Physical Volume("bar") = {out[1]};
Physical Surface("clamp") = {1};
Physical Surface("end", 5) = {out[0]};
