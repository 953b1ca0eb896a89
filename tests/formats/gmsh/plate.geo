// A rectangular plate with a point at its middle.
a = 0.6; b = 0.4;
Point(1) = {0, 0, 0}; Point(2) = {a, 0, 0}; Point(3) = {a, b, 0}; Point(4) = {0, b, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 13; Transfinite Curve{2, 4} = 9;
Transfinite Surface{1}; Recombine Surface{1};
Physical Surface("plate") = {1};
Physical Curve("edges", 7) = {1, 2, 3, 4};
Physical Curve("left edge", 8) = {4};
Physical Point("corner") = {1};
