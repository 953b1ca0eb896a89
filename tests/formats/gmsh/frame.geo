// A cantilever of lines.
Point(1) = {0, 0, 0}; Point(2) = {1000, 0, 0};
Line(1) = {1, 2};
Transfinite Curve{1} = 11;
Physical Curve("arm") = {1};
Physical Point("root") = {1};
Physical Point("tip") = {2};
