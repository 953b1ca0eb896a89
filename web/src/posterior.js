// What a result says of a sampled posterior: chains, stages, evidence, modes, predictions. Nothing is computed here.
import { is_number, list, number_or_null, record } from "./data.js";

const numbers = (values) => list(values).map(number_or_null);

/** {names, chains, draws, r_hat, ess_bulk, ess_tail, ranks, stages, predictive, leave_one_out, waic, ...}; null where none was sampled. */
export function posterior_of({ result }) {
  const block = record(result.posterior);
  const names = list(block.names).map(String);
  if (!names.length) return null;
  const ranks = record(block.ranks);
  return {
    names,
    chains: number_or_null(block.chains),
    draws: number_or_null(block.draws),
    evaluations: number_or_null(block.model_evaluations),
    r_hat: numbers(block.r_hat),
    ess_bulk: numbers(block.ess_bulk),
    ess_tail: numbers(block.ess_tail),
    ranks: {
      bins: number_or_null(ranks.bins),
      range: numbers(ranks.expected_range),
      counts: list(ranks.counts).map((chains) => list(chains).map(numbers)),
    },
    stages: list(block.stages).map((chain) => list(chain).map(record)),
  };
}

/** ln evidence with its interval and that of each island; null where there is none. */
export function evidence_of({ result }) {
  const { ln_evidence, standard_error, ci95, islands, source } = record(result.evidence);
  if (!is_number(ln_evidence)) return null;
  const interval = numbers(ci95);
  return {
    value: ln_evidence,
    error: number_or_null(standard_error),
    interval: interval.length === 2 && interval.every(is_number) ? interval : null,
    islands: numbers(islands),
    by_importance: source === "importance-sampling",
  };
}

/** Modes, the most probable first: {probability, error, mean[] in the order of the posterior's names}. */
export const modes_of = ({ result }) =>
  list(result.modes)
    .map(record)
    .map(({ probability, standard_error, mean }) => ({
      probability: number_or_null(probability),
      error: number_or_null(standard_error),
      mean: numbers(mean),
    }))
    .filter(({ probability }) => is_number(probability));

/** Per output: 95 % intervals and medians of the model and of a further test, and the specimens' values. */
export function predictive_outputs(study) {
  const block = record(record(study.result.posterior).predictive);
  const at = (rows, index, p) => number_or_null(list(list(rows)[index])[list(block.probabilities).indexOf(p)]);
  const ends = (rows, index) => {
    const interval = [at(rows, index, 0.025), at(rows, index, 0.975)];
    return interval.every(is_number) ? interval : null;
  };
  return study.output_axes
    .map(({ index, name, unit }) => ({
      name,
      unit,
      model: ends(block.outputs, index),
      test: ends(block.tests, index),
      median: at(block.tests, index, 0.5),
      specimens: study.tests.map((row) => row[index]),
    }))
    .filter(({ test, median }) => test && is_number(median));
}

/** Leave-one-out and WAIC by specimen; null where the result has none. */
export function leave_one_out_of({ result }) {
  const { leave_one_out, waic, not_left_out } = record(result.posterior);
  const block = record(leave_one_out);
  const reason = typeof not_left_out === "string" ? not_left_out : null;
  if (!is_number(block.elpd)) return reason ? { reason } : null;
  const accuracy = (of) => ({
    elpd: number_or_null(of.elpd),
    error: number_or_null(of.standard_error),
    parameters: number_or_null(of.effective_parameters),
  });
  return {
    reason,
    ...accuracy(block),
    waic: accuracy(record(waic)),
    specimens: list(block.pointwise).map((value, k) => ({
      elpd: number_or_null(value),
      shape: number_or_null(list(block.pareto_k)[k]) ?? Infinity, // JSON has no infinity
    })),
  };
}
