// Makes gmsh.unv (datasets 2411, 2412) with Gmsh 4.8.4 of Debian 12:
//   gmsh -2 gmsh.geo -format unv -save_all -o gmsh.unv
Point(1) = {0, 0, 0.5}; Point(2) = {2, 0, 0}; Point(3) = {2, 1, 0}; Point(4) = {0, 1, 0.5};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Surface(1) = {1};
Transfinite Curve {1, 3} = 3; Transfinite Curve {2, 4} = 2;
Transfinite Surface {1};
Recombine Surface {1};
