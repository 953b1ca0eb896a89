% The same by Octave; version 4 knows no cell arrays, so there the columns are variables of their own.
frequencies = [10.5 20.25; 10.75 NaN];
shapes = reshape((0:11) / 8, 3, 2, 2);
dofs = {"101:+Z"; "7:-X"; "m1"};
save -v6 octave-v6.mat frequencies shapes dofs
save -v7 octave-v7.mat frequencies shapes dofs
f1 = [10.5; 10.75]; f2 = [20.25; NaN];
save -v4 octave-v4.mat f1 f2
