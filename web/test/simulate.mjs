// A run like the program's, in the shape of its result.json: the method of docs/theory/mares.md on any small model.
// Its numbers serve to look at the page; nobody takes them as results.
import {
  add,
  apply,
  cholesky,
  covariance_of,
  diagonal,
  eigen,
  ellipses_of,
  inverse,
  mean_of,
  multiply,
  random_normal,
  spearman,
  standard_deviations,
  subtract,
  transpose,
} from "./matrix.mjs";

const kept_in_page = 300;

export function draw_cloud(study, mean, covariance, normal) {
  const factor = cholesky(covariance);
  const parameters = [];
  while (parameters.length < study.samples) {
    const x = mean.map(
      (value, i) =>
        value +
        apply(
          factor,
          mean.map(() => normal()),
        )[i],
    );
    const inside = x.every(
      (value, i) => value >= (study.bounds[i][0] ?? -Infinity) * 0.5 && value <= (study.bounds[i][1] ?? Infinity) * 1.5,
    );
    if (inside) parameters.push(x);
  }
  return { parameters, outputs: parameters.map(study.model) };
}

export function regress({ parameters, outputs }) {
  const mean = mean_of(parameters);
  const x = parameters.map((row) => subtract(row, mean));
  const y_mean = mean_of(outputs);
  const y = outputs.map((row) => subtract(row, y_mean));
  const inverse_gram = inverse(multiply(transpose(x), x));
  const slopes = multiply(inverse_gram, multiply(transpose(x), y));
  const sensitivity = transpose(slopes);
  const residual = y.map((row, k) => subtract(row, apply(sensitivity, x[k])));
  const sum_squares = (rows, j) => rows.reduce((sum, row) => sum + row[j] ** 2, 0);
  const freedom = parameters.length - mean.length - 1;
  return {
    sensitivity,
    standard_error: sensitivity.map((row, j) =>
      row.map((_, i) => Math.sqrt((inverse_gram[i][i] * sum_squares(residual, j)) / freedom)),
    ),
    r_squared: y_mean.map((_, j) => 1 - sum_squares(residual, j) / sum_squares(y, j)),
    r_squared_quadratic: y_mean.map((_, j) => 1 - (0.15 * sum_squares(residual, j)) / sum_squares(y, j)),
    condition: 1.08,
  };
}

function iteration_entry(index, cloud, study, test) {
  const output_mean = mean_of(cloud.outputs);
  const output_covariance = covariance_of(cloud.outputs);
  const parameter_mean = mean_of(cloud.parameters);
  const parameter_covariance = covariance_of(cloud.parameters);
  const gap = subtract(test.mean, output_mean);
  return {
    index,
    distance_euclidean: Math.hypot(...gap),
    distance_mahalanobis: Math.sqrt(
      gap.reduce((sum, value, i) => sum + value * apply(inverse(test.covariance), gap)[i], 0),
    ),
    parameter_mean,
    parameter_std: standard_deviations(parameter_covariance),
    parameter_covariance,
    output_mean,
    output_std: standard_deviations(output_covariance),
    output_covariance,
    ellipses: ellipses_of(output_mean, output_covariance),
    parameter_ellipses: ellipses_of(parameter_mean, parameter_covariance),
  };
}

/** study: {title, model, names, units, output_names, output_units, prior_mean, prior_std, bounds, samples, iterations, seed, tests} */
export function update(study) {
  const normal = random_normal(study.seed);
  const prior_covariance = diagonal(study.prior_std.map((std) => std * std));
  const test = { mean: mean_of(study.tests), covariance: covariance_of(study.tests) };
  let mean = study.prior_mean;
  let covariance = prior_covariance;
  const iterations = [];
  const clouds = [];
  let first;
  let regression;
  let cloud;
  for (let j = 0; j <= study.iterations; j += 1) {
    cloud = draw_cloud(study, mean, covariance, normal);
    first ??= cloud;
    iterations.push(iteration_entry(j, cloud, study, test));
    clouds.push({
      iteration: j,
      parameters: cloud.parameters.slice(0, kept_in_page),
      outputs: cloud.outputs.slice(0, kept_in_page),
    });
    regression = regress(cloud);
    const g = regression.sensitivity;
    const weight = inverse(test.covariance);
    const gtw = multiply(transpose(g), weight);
    const gain = multiply(inverse(add(multiply(gtw, g), inverse(covariance))), gtw);
    const step = apply(gain, subtract(test.mean, mean_of(cloud.outputs)));
    mean = mean.map((value, i) =>
      Math.min(study.bounds[i][1] ?? Infinity, Math.max(study.bounds[i][0] ?? -Infinity, value + step[i])),
    );
    const sgt = multiply(prior_covariance, transpose(g));
    covariance = add(
      prior_covariance,
      multiply(multiply(sgt, inverse(add(test.covariance, multiply(g, sgt)))), transpose(sgt)),
      -1,
    );
  }
  return {
    data: {
      result: result_of(study, { iterations, test, regression, first, cloud }),
      tests: { columns: study.output_names, rows: study.tests },
      clouds,
    },
  };
}

function result_of(study, { iterations, test, regression, first, cloud }) {
  const last = iterations[iterations.length - 1];
  const begin = iterations[0];
  const n = study.tests.length;
  const on_bound = (i) =>
    Math.abs(last.parameter_mean[i] - study.bounds[i][1]) < 0.06
      ? "upper"
      : Math.abs(last.parameter_mean[i] - study.bounds[i][0]) < 0.06
        ? "lower"
        : null;
  const scaled = regression.sensitivity.map((row, j) =>
    row.map((value, i) => (value * study.prior_std[i]) / Math.sqrt(test.covariance[j][j])),
  );
  const decomposition = eigen(multiply(transpose(scaled), scaled));
  const singular_values = decomposition.values
    .map((value) => Math.sqrt(Math.max(value, 1e-12)))
    .reverse()
    .slice(0, Math.min(scaled.length, study.names.length));
  const rank = singular_values.filter((value) => value > 1e-3 * singular_values[0]).length;
  const unseen = study.names
    .map((_, i) => i)
    .slice(0, study.names.length - rank)
    .map((column) => ({
      weights: Object.fromEntries(study.names.map((name, i) => [name, decomposition.vectors[i][column]])),
    }));
  return {
    schema: 1,
    mottle: "0.1.0",
    title: study.title,
    command: "update",
    units: "SI",
    method: "mares",
    seed: study.seed,
    status: "converged",
    message: "The step of the means fell below 0.001 prior standard deviations.",
    parameters: {
      names: study.names,
      units: study.units,
      prior_mean: study.prior_mean,
      prior_std: study.prior_std,
      mean: last.parameter_mean,
      std: last.parameter_std,
      covariance: last.parameter_covariance,
      bounds: study.bounds,
      at_bound: study.names.map((_, i) => on_bound(i)),
      mean_ci95: last.parameter_mean.map((value, i) => [
        value - (2.26 * last.parameter_std[i]) / Math.sqrt(n),
        value + (2.26 * last.parameter_std[i]) / Math.sqrt(n),
      ]),
      std_ci95: last.parameter_std.map((value) => [0.69 * value, 1.83 * value]),
    },
    outputs: {
      names: study.output_names,
      units: study.output_units,
      test_count: study.output_names.map(() => n),
      test_mean: test.mean,
      test_covariance: test.covariance,
      initial_mean: begin.output_mean,
      initial_covariance: begin.output_covariance,
      final_mean: last.output_mean,
      final_covariance: last.output_covariance,
    },
    iterations,
    test_ellipses: ellipses_of(test.mean, test.covariance),
    regression,
    spearman: spearman(first.parameters.slice(0, 400), first.outputs.slice(0, 400)),
    sample_size: {
      alpha: 0.05,
      n_test: n,
      n_model: study.samples,
      t_critical: 2.803,
      monte_carlo_error: last.output_std.map((std) => std / Math.sqrt(cloud.outputs.length)),
      curve: {
        n_total: [5, 6, 8, 10, 14, 20, 30, 50, 100, 200, 500, 1000, 2000, 5000, 10000],
        t: [82.4, 13.9, 6.1, 4.3621, 3.67, 3.3062, 3.11, 2.9642, 2.8752, 2.835, 2.811, 2.8031, 2.799, 2.797, 2.796],
        limit: 2.7955,
      },
    },
    verdict: study.verdict,
    identifiability: { rank, singular_values, unseen_directions: unseen },
    model_evaluations: study.samples * iterations.length,
    rejected_draws: { count: 37, rule: "draw again while any parameter is outside its bounds" },
    failed_evaluations: [],
    timings_s: { clouds: 0.0141, regression: 0.0023, verdict: 0.0008, total: 0.0213 },
    options: {
      samples: study.samples,
      iterations: 30,
      mares: { weighting: "mahalanobis", prior: "recentred", covariance: "fixed-prior", tolerance: 1e-3 },
    },
    warnings: [],
    notes: [
      "The deviations that this method finds say how well the mean is known given the spread, not the spread itself; " +
        "method `em` estimates the spread.",
    ],
  };
}
