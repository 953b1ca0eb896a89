// What a result says of a sampled posterior, made up: its numbers serve to look at the page; nobody takes them as results.
import { random_normal } from "./matrix.mjs";

const quantile_scores = [-1.96, -1, 0, 1, 1.96];

function stages_of(normal) {
  const count = 9;
  return Array.from({ length: count }, (_, k) => ({
    exponent: k + 1 === count ? 1 : 1e-4 * 2.8 ** k * Math.exp(0.1 * normal()),
    effective_samples: 500,
    moves: 4 + Math.round(Math.abs(2 * normal())),
    acceptance: 0.45 + 0.03 * normal(),
    correlation: 0.09 - 0.02 * Math.abs(normal()),
  }));
}

/** Adds `evidence`, `posterior` and `modes` of eight islands; the second one of an island that disagrees. */
export function add_posterior(data, { levels = [], modes = 2, seed = 3 } = {}) {
  const { result, tests } = data;
  const { parameters, outputs } = result;
  const normal = random_normal(seed);
  const names = [...parameters.names, ...levels, "log_likelihood"];
  const [chains, draws, bins] = [8, 1000, 20];
  const count = (chain, bin) => Math.max(0, Math.round(draws / bins + 7 * normal() + (chain === 1 ? 1.6 * (bin - 9.5) : 0)));
  const deviation = (k) => Math.sqrt(outputs.final_covariance[k][k]);
  const quantiles = (factor) =>
    outputs.names.map((_, k) => quantile_scores.map((z) => outputs.final_mean[k] + factor * z * deviation(k)));
  const islands = Array.from({ length: chains }, () => -12.34 + 0.05 * normal());
  const source = levels.length > 0 ? "importance-sampling" : "islands";
  result.evidence = { ln_evidence: -12.34, standard_error: 0.018, ci95: [-12.383, -12.297], source, spread: 0.05, islands };
  result.posterior = {
    file: "posterior.csv",
    chains,
    draws,
    names,
    r_hat: names.map((_, k) => 1.001 + (k === 1 ? 0.013 : 0)),
    ess_bulk: names.map((_, k) => 3000 - 900 * k),
    ess_tail: names.map((_, k) => 3500 - 950 * k),
    model_evaluations: 140420,
    failed_evaluations: 0,
    stages: islands.map(() => stages_of(normal)),
    ranks: {
      bins,
      expected_range: [37, 64],
      counts: names.map(() => islands.map((_, chain) => Array.from({ length: bins }, (__, bin) => count(chain, bin)))),
    },
    predictive: { probabilities: [0.025, 0.16, 0.5, 0.84, 0.975], outputs: quantiles(0.7), tests: quantiles(1.2) },
    leave_one_out: {
      elpd: 41.2,
      standard_error: 3.1,
      effective_parameters: 2.7,
      pointwise: tests.rows.map(() => 4 + normal()),
      pareto_k: tests.rows.map((_, s) => (s === 4 ? null : s === 3 ? 0.83 : 0.2 + 0.1 * normal())),
    },
    waic: { elpd: 41.3, standard_error: 3.1, effective_parameters: 2.6, pointwise: tests.rows.map(() => 4) },
    not_left_out: null,
  };
  result.modes = Array.from({ length: modes }, (_, m) => ({
    probability: modes === 1 ? 1 : m ? 0.29 : 0.71,
    standard_error: 0.008,
    mean: [...parameters.mean.map((value, i) => value + m * parameters.std[i]), ...levels.map(() => 0.012)],
  }));
  return data;
}
