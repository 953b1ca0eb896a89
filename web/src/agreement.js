// How well the updated model reproduces the tests, as the result says it, and what it found of each parameter.
import { is_number, list, number_or_null, record } from "./data.js";
import { is_box, is_posterior } from "./population.js";
import { number_of_factor } from "./units.js";

/** "adequate", "inadequate", "undecided", or null where there is no verdict; older results say true or false alone. */
export function conclusion_of({ conclusion, adequate }) {
  if (["adequate", "inadequate", "undecided"].includes(conclusion)) return conclusion;
  return adequate === true ? "adequate" : adequate === false ? "inadequate" : null;
}

/** Outputs, the worst first; empty for results of earlier versions. */
export const agreement_rows = ({ result }) =>
  list(record(result.agreement).outputs)
    .map(record)
    .map(({ name, unit, initial, final, std_ratio_range, is_mean_reproduced, is_scatter_reproduced }) => ({
      name: String(name ?? "–"),
      unit: unit ?? "",
      initial: record(initial),
      final: record(final),
      range: list(std_ratio_range),
      is_mean_reproduced: is_mean_reproduced ?? null,
      is_scatter_reproduced: is_scatter_reproduced ?? null,
    }));

/** Whether means or scatter are known not to be reproduced. */
export function is_not_reproduced({ result }) {
  const { are_means_reproduced, is_scatter_reproduced } = record(result.agreement);
  return are_means_reproduced === false || is_scatter_reproduced === false;
}

const interval_or_null = (values) => (list(values).filter(is_number).length === 2 ? values : null);

/** One parameter's bar, {name, unit, mark, reason, prior, estimate, interval, is_box, specimens, number, bounds}; missing parts are null. */
export function findings_of(study) {
  const { parameters: block } = study;
  return study.parameter_axes.map(({ index, name, unit }) => {
    const finding = record(list(block.findings)[index]);
    const probabilities = list(record(block.quantiles).probabilities);
    const quantiles = list(list(record(block.quantiles).values)[index]);
    const at = (probability) => number_or_null(quantiles[probabilities.indexOf(probability)]);
    return {
      name,
      unit,
      mark: finding.mark ?? (list(block.at_bound)[index] ? "at-bound" : null),
      side: list(block.at_bound)[index] ?? null,
      reason: finding.reason ?? "",
      is_box: is_box(study),
      is_posterior: is_posterior(study),
      is_confirmed: conclusion_of(record(study.result.verdict)) === "adequate",
      prior: interval_or_null(finding.prior95),
      prior_mean: number_or_null(list(block.prior_mean)[index]),
      estimate: is_box(study) ? null : number_or_null(list(block.mean)[index]), // the middle of a box is no estimate
      number: is_box(study) ? null : number_of_factor(block, index, list(block.mean)[index]),
      interval: interval_or_null(finding.interval95) ?? interval_or_null(list(block.mean_ci95)[index]),
      specimens: block.is_population === true ? interval_or_null([at(0.025), at(0.975)]) : null,
      bounds: list(list(block.bounds)[index]),
    };
  });
}
