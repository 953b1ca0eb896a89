// What a result says of the population of specimens: distribution and intervals of each parameter, and their correlations.
import { is_number, list, number_or_null, record } from "./data.js";
import { correlation_on_scales, moments_on_scale, scale_of } from "./density.js";

const numbers_or_null = (values) => (list(values).length === 2 && values.every(is_number) ? values : null);

/** Whether the updated covariance is that of the specimens, as of methods that estimate a population. */
export const is_population = ({ parameters }) => parameters.is_population === true;

/** Parameters of the specimens, one row each; a method that does not look at each has none. */
export const specimen_rows = ({ result }) => list(record(result.specimens).parameters).map(list);

/** One parameter: moments of prior and update, its scale, intervals as [low, high] or null, specimens' values. */
export function parameter_of(study, { index, name, unit }) {
  const { parameters: block } = study;
  const at = (field) => number_or_null(list(block[field])[index]);
  const scale = scale_of(list(block.scale)[index], list(list(block.bounds)[index]));
  const [mean, std] = [at("mean"), at("std")];
  return {
    index,
    name,
    unit,
    scale,
    prior: record(list(block.prior)[index]),
    prior_mean: at("prior_mean"),
    prior_std: at("prior_std"),
    mean,
    std,
    on_scale: moments_on_scale(scale, mean, std),
    mean_ci95: numbers_or_null(list(block.mean_ci95)[index]),
    std_ci95: numbers_or_null(list(block.std_ci95)[index]),
    bounds: list(list(block.bounds)[index]).filter(is_number),
    specimens: specimen_rows(study).map((row) => number_or_null(row[index])),
  };
}

/**
 * Correlation of two parameters on their scales with its interval.
 * @param first, second  of parameter_of
 * @return  {correlation, interval}, null where the data do not determine them
 */
function correlation_of(study, first, second) {
  const { covariance, correlation_ci95 } = study.parameters;
  const value = correlation_on_scales(
    first.scale,
    first.on_scale,
    second.scale,
    second.on_scale,
    list(list(covariance)[first.index])[second.index],
  );
  const interval = numbers_or_null(list(list(correlation_ci95)[first.index])[second.index]);
  return { correlation: is_number(value) ? Math.min(1, Math.max(-1, value)) : null, interval };
}

const pairs_of_study = new WeakMap();

/**
 * Every pair of parameters {first, second, correlation, interval}; worked out once for a study. Where some pairs have an interval, one
 * without is not determined, and its correlation is null.
 */
export function correlation_pairs(study) {
  if (!pairs_of_study.has(study)) {
    const all = study.parameter_axes.map((axis) => parameter_of(study, axis));
    const pairs = all.flatMap((first, i) =>
      all.slice(i + 1).map((second) => ({ first, second, ...correlation_of(study, first, second) })),
    );
    const has_intervals = pairs.some(({ interval }) => interval);
    pairs_of_study.set(
      study,
      pairs.map((pair) => (has_intervals && !pair.interval ? { ...pair, correlation: null } : pair)),
    );
  }
  return pairs_of_study.get(study);
}

export const correlation_pair = (study, x, y) =>
  correlation_pairs(study).find(({ first, second }) => first.index === x.index && second.index === y.index);

/** Curve of two variables that are normal on their scales, `reach` deviations from the mean. */
export function ellipse_on_scales(first, second, correlation, reach = 2) {
  const rest = Math.sqrt(Math.max(0, 1 - correlation * correlation));
  return Array.from({ length: 97 }, (_, k) => {
    const angle = (2 * Math.PI * k) / 96;
    const [u, v] = [reach * Math.cos(angle), reach * Math.sin(angle)];
    return [
      first.scale.to(first.on_scale.mean + first.on_scale.std * u),
      second.scale.to(second.on_scale.mean + second.on_scale.std * (correlation * u + rest * v)),
    ];
  });
}
