// Turns a simulated run into one of a method that estimates a population: intervals, specimens, outliers, predictions.
// Its numbers serve to look at the page; nobody takes them as results.
import { add_curves } from "./curves_fixture.mjs";
import { apply, cholesky, random_normal } from "./matrix.mjs";

const fisher = (r, n) => [
  Math.tanh(Math.atanh(r) - 1.96 / Math.sqrt(n - 3)),
  Math.tanh(Math.atanh(r) + 1.96 / Math.sqrt(n - 3)),
];

/** A covariance with the deviations of `std` and a correlation of 0.75 between the first two. */
function covariance_of(std) {
  return std.map((a, i) => std.map((b, j) => a * b * (i === j ? 1 : i + j === 1 ? 0.75 : 0.12 * Math.cos(i * j))));
}

function normal_probability(z) {
  const t = 1 / (1 + 0.3275911 * (Math.abs(z) / Math.SQRT2));
  const tail = ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t + 0.254829592) * t;
  const p = 0.5 * tail * Math.exp((-z * z) / 2);
  return z > 0 ? 1 - p : p;
}

/** Directions of the last `count` parameters in pairs, and the last one alone. */
function unseen_of(names, count) {
  return Array.from({ length: count }, (_, k) => {
    const weights = Object.fromEntries(names.map((name) => [name, 0]));
    const at = names.length - 1 - 2 * k;
    if (k === count - 1)
      return { weights: { ...weights, [names[at]]: 1 }, meaning: `${names[at]} cannot be identified from the outputs` };
    if (k === 1) {
      const parts = [0.6, -0.5, 0.45, -0.3, 0.25, -0.1826];
      return { weights: { ...weights, ...Object.fromEntries(parts.map((part, i) => [names[i], part])) } };
    }
    return { weights: { ...weights, [names[at]]: 0.74, [names[at - 1]]: -0.6726 } };
  });
}

function histogram(pit) {
  const bins = Math.max(4, Math.min(10, Math.floor(pit.length / 8)));
  const counts = new Array(bins).fill(0);
  for (const value of pit) counts[Math.min(bins - 1, Math.floor(value * bins))] += 1;
  return { counts, expected_range: [0, Math.ceil((2.2 * pit.length) / bins)] };
}

export function prediction_of(names, held_out, { seed = 5, narrow = 1 } = {}) {
  const normal = random_normal(seed);
  const mean = names.map((_, k) => 40 * 1.4 ** k);
  const std = mean.map((value) => 0.012 * value * narrow);
  const z = Array.from({ length: held_out }, () => names.map(() => normal() / narrow));
  const pit = z.map((row) => row.map(normal_probability));
  const share = (inside) => inside.filter(Boolean).length / held_out;
  return {
    names,
    units: names.map(() => "Hz"),
    mean,
    std,
    interval95: mean.map((value, k) => [value - 1.96 * std[k], value + 1.96 * std[k]]),
    held_out: {
      specimens: held_out,
      coverage: names.map((_, k) => share(z.map((row) => Math.abs(row[k]) < 1.96))),
      joint_coverage: share(z.map((row) => row.every((value) => Math.abs(value) < 1.96 + 0.12 * names.length))),
      transforms: pit,
      scores: z,
      histograms: names.map((_, k) => histogram(pit.map((row) => row[k]))),
      least_inside: names.map(() => Math.floor(0.85 * held_out)),
      uniformity_p_values: names.map((_, k) => (narrow < 1 ? 1e-5 : 0.2 + 0.1 * k)),
    },
  };
}

/**
 * @param scales       of the first parameters; the others are on their own axis
 * @param unseen       number of unseen directions, in which no interval is known
 * @param prediction   of prediction_of, optional
 */
export function with_population(data, { scales = [], unseen = 0, outliers = [], prediction = null, seed = 11 } = {}) {
  const { result, tests } = data;
  const { parameters, identifiability } = result;
  const normal = random_normal(seed);
  const n = tests.rows.length;
  const q = parameters.names.length;
  const std = parameters.prior_std.map((value) => 0.6 * value);
  const covariance = covariance_of(std);
  const factor = cholesky(covariance);
  identifiability.unseen_directions = unseen_of(parameters.names, unseen);
  identifiability.rank = Math.min(identifiability.rank, q - unseen);
  const is_open = parameters.names.map((name) =>
    identifiability.unseen_directions.some(({ weights }) => Math.abs(weights[name]) > 0.1),
  );
  const half = (i) => (2.26 * std[i]) / Math.sqrt(n);
  const spread = 1.5 / Math.sqrt(n);
  Object.assign(parameters, {
    is_population: true,
    intervals_by: "analytic",
    scale: parameters.names.map((_, i) => scales[i] ?? "identity"),
    prior: parameters.names.map((_, i) => ({
      kind: scales[i] === "log" ? "lognormal" : "normal",
      mean: parameters.prior_mean[i],
      std: parameters.prior_std[i],
      lower: null,
      upper: null,
    })),
    std: std.map((value, i) => (is_open[i] && unseen > 2 && i === q - 1 ? 0 : value)),
    covariance,
    mean_ci95: parameters.mean.map((value, i) => (is_open[i] ? [null, null] : [value - half(i), value + half(i)])),
    std_ci95: std.map((value, i) => (is_open[i] ? [null, null] : [value * (1 - spread), value * (1 + 1.8 * spread)])),
    correlation_ci95: covariance.map((row, i) =>
      row.map((value, j) =>
        i === j ? [1, 1] : is_open[i] || is_open[j] ? [null, null] : fisher(value / (std[i] * std[j]), n),
      ),
    ),
  });
  add_curves(parameters);
  const residual = (specimen, output) => {
    if (tests.rows[specimen][output] === null) return null;
    const far = outliers.includes(specimen + 1) && output < 2 ? 3.6 - 7.4 * output : 0;
    return far || normal();
  };
  result.method = "maximum-likelihood";
  // The tests' file began with an empty row: specimens have the numbers of its rows.
  const numbers = tests.rows.map((_, s) => s + 2);
  result.specimens = {
    numbers,
    parameters: Array.from({ length: n }, () => {
      const step = apply(
        factor,
        std.map(() => normal()),
      );
      return parameters.mean.map((value, i) => value + step[i]);
    }),
    residuals: tests.rows.map((row, s) => row.map((_, k) => residual(s, k))),
    large_residual: 3,
    expected_large: 0.0027 * n * tests.columns.length,
  };
  result.outliers = outliers.map((place, k) => ({
    specimen: numbers[place - 1],
    distance: 5.3 + k,
    p_value: 2e-5 / (k + 1),
  }));
  if (prediction) result.prediction = prediction;
  return data;
}

/** The same with its specimens in two batches, one of them doubtful and one an outlier. */
export function with_batches(data) {
  const { parameters, specimens } = data.result;
  const half = Math.ceil(specimens.parameters.length / 2);
  const component = (sign, count) => ({
    weight: count / specimens.parameters.length,
    mean: parameters.mean.map((value, i) => value + sign * (i === 0 ? 0.1 : 1.4) * parameters.std[i]),
    std: parameters.std.map((value) => 0.4 * value),
    specimens: count,
  });
  data.result.components = [component(-1, half), component(1, specimens.parameters.length - half)];
  data.result.assignments = specimens.parameters.map((_, k) => {
    const second = k < half ? 1e-6 : 0.999;
    if (k === 1) return { specimen: 2, component: 1, probabilities: [0.71, 0.285], outlier_probability: 0.005 };
    if (k === 3) return { specimen: 4, component: null, probabilities: [1e-9, 1e-12], outlier_probability: 1 };
    return { specimen: k + 1, component: k < half ? 1 : 2, probabilities: [1 - second, second], outlier_probability: 1e-6 };
  });
  Object.assign(data.result.verdict, { answer: "The specimens come from <2> batches." });
  return data;
}
