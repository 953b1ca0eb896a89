% Octave's eigs as a contender: the lowest modes of the matrices that mottle_sparse_benchmark left. Prints JSON.
%   octave-cli --no-history octave_modes.m FOLDER MODES SECONDS
1;  % a script, not the file of a function

function matrix = read_matrix(folder, name)
  read = @(suffix, type) fread(fopen(fullfile(folder, [name suffix])), Inf, [type '=>double']);
  starts = read('.starts', 'int32');
  rows = read('.rows', 'int32') + 1;
  values = read('.values', 'double');
  columns = repelems(1:numel(starts) - 1, [1:numel(starts) - 1; diff(starts)'])';
  lower = sparse(rows, columns, values, numel(starts) - 1, numel(starts) - 1);
  matrix = lower + tril(lower, -1)';
end

words = argv();
stiffness = read_matrix(words{1}, 'K');
mass = read_matrix(words{1}, 'M');
modes = str2double(words{2});
budget = str2double(words{3});
options.tol = 1e-10;
best = Inf;
spent = 0;
for call = 1:5
  begin = cputime();
  [vectors, lambda] = eigs(stiffness, mass, modes, 0, options);
  seconds = cputime() - begin;
  best = min(best, seconds);
  spent += seconds;
  if spent + best > budget
    break
  end
end
values = sort(diag(lambda));
printf('{"seconds": %.6g, "eigenvalues": [%s]}\n', best, strjoin(arrayfun(@(x) sprintf('%.17g', x), values', 'UniformOutput', false), ', '));
