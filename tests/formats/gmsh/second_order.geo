// The bar of beam.geo and the plate of plate.geo, coarse, in second-order elements of one kind:
// gmsh second_order.geo -3 -setnumber kind 0 -format msh41 -o hexahedra20.msh, 1: prisms15.msh, 2: triangles6.msh,
// 3: quadrangles8.msh. Of pyramids13.msh each cell of the bar is six pyramids from its centre, given a SetOrder 2.
DefineConstant[ kind = 0 ];
If (kind < 2)
  L = 1.0; w = 0.05; h = 0.1;
  Point(1) = {0, 0, 0};
  line[] = Extrude {0, w, 0} { Point{1}; Layers{1}; };
  If (kind == 0)
    side[] = Extrude {0, 0, h} { Line{line[1]}; Layers{1}; Recombine; };
  Else
    side[] = Extrude {0, 0, h} { Line{line[1]}; Layers{1}; };
  EndIf
  bar[] = Extrude {L, 0, 0} { Surface{side[1]}; Layers{10}; Recombine; };
  Physical Volume("bar") = {bar[1]};
  Physical Surface("clamp") = {side[1]};
Else
  a = 0.6; b = 0.4;
  Point(1) = {0, 0, 0}; Point(2) = {a, 0, 0}; Point(3) = {a, b, 0}; Point(4) = {0, b, 0};
  Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
  Curve Loop(1) = {1, 2, 3, 4};
  Plane Surface(1) = {1};
  Transfinite Curve{1, 3} = 7; Transfinite Curve{2, 4} = 5;
  Transfinite Surface{1} Alternate;
  If (kind == 3)
    Recombine Surface{1};
  EndIf
  Physical Surface("plate") = {1};
  Physical Curve("edges", 7) = {1, 2, 3, 4};
EndIf
Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 1;
