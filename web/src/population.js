// What a result says of its estimate: distribution and intervals of each parameter, and their pairs. Curves and regions come
// from the result; nothing is computed here.
import { is_number, list, number_or_null, record } from "./data.js";
import { short_number } from "./format.js";

const numbers_or_null = (values) => (list(values).length === 2 && values.every(is_number) ? values : null);

/** "population", "posterior", "box" or "mean"; of results that do not say it, whether they call themselves a population. */
export const estimate_of = ({ parameters }) => {
  const { kind, log_evidence, effective_samples } = record(parameters.estimate);
  return {
    kind: kind ?? (parameters.is_population === true ? "population" : "mean"),
    log_evidence: number_or_null(log_evidence),
    effective_samples: number_or_null(effective_samples),
  };
};

/** Whether the updated covariance is that of the specimens, as of methods that estimate a population. */
export const is_population = (study) => estimate_of(study).kind === "population";
export const is_posterior = (study) => estimate_of(study).kind === "posterior";
/** Whether the estimate is bounds of the parameters, whose moments are those of an even spread. */
export const is_box = (study) => estimate_of(study).kind === "box";

/** What the method answers beside a mean and a scatter: "batches", a "box" or a "posterior" of samples; else null. */
export function answer_kind(study) {
  const { components, posterior, abc } = study.result;
  if (list(components).length) return "batches";
  if (is_box(study)) return "box";
  return is_posterior(study) || list(record(posterior).names).length || record(abc).stages ? "posterior" : null;
}

/** How much of the population or posterior the regions of pairs hold, as the result says it. */
export const region_text = ({ parameters }) => `${short_number(100 * record(parameters.estimate).region_probability, 2)}\u00a0%`;

/** Parameters of the specimens, one row each; a method that does not look at each has none. */
export const specimen_rows = ({ result }) => list(record(result.specimens).parameters).map(list);

/** Number of the specimen at index k: its row in the tests' file. Results of earlier versions count from 1. */
export const specimen_number = ({ result }, k) => number_or_null(list(record(result.specimens).numbers)[k]) ?? k + 1;

/** Rows [x, ...] of columns that a result keeps apart. */
function points_of(block, ...names) {
  const columns = names.map((name) => list(record(block)[name]));
  return columns[0].map((_, k) => columns.map((column) => column[k])).filter((point) => point.every(is_number));
}

/** Whether the result holds curves; results of earlier versions do not. */
export const has_curves = ({ parameters }) => Array.isArray(parameters.densities);

/** One parameter: moments of prior and update, its curves as [[x, ...], ...], intervals as [low, high] or null, specimens' values. */
export function parameter_of(study, { index, name, unit }) {
  const { parameters: block } = study;
  const at = (field) => number_or_null(list(block[field])[index]);
  const densities = record(list(block.densities)[index]);
  return {
    index,
    name,
    unit,
    scale: list(block.scale)[index] ?? "identity",
    prior_mean: at("prior_mean"),
    prior_std: at("prior_std"),
    mean: at("mean"),
    std: at("std"),
    curves: {
      prior: points_of(densities.prior, "x", "density"),
      updated: points_of(densities.updated, "x", "density"),
      // The intervals bound normal densities, which several batches together have not.
      band: list(study.result.components).length > 1 ? [] : points_of(densities.band, "x", "least", "greatest"),
    },
    mean_ci95: numbers_or_null(list(block.mean_ci95)[index]),
    std_ci95: numbers_or_null(list(block.std_ci95)[index]),
    bounds: list(list(block.bounds)[index]).filter(is_number),
    specimens: specimen_rows(study).map((row) => number_or_null(row[index])),
    specimen_numbers: specimen_rows(study).map((_, k) => specimen_number(study, k)),
  };
}

/** What the result draws of a pair: outlines of its region, and of what it would be at the ends of the correlation's interval. */
function outlines_of({ parameters }, first, second) {
  const found = list(parameters.regions)
    .map(record)
    .find((region) => region.first === first.index && region.second === second.index);
  const outlines = (field) => list(record(found)[field]).map((outline) => points_of(outline, "x", "y"));
  return { region: outlines("outlines"), ends: outlines("interval_ends") };
}

const pairs_of_study = new WeakMap();

/** Every pair of parameters {first, second, correlation, interval, region, ends}; null or empty where not determined. */
export function correlation_pairs(study) {
  if (!pairs_of_study.has(study)) {
    const { correlation, correlation_ci95 } = study.parameters;
    const all = study.parameter_axes.map((axis) => parameter_of(study, axis));
    const pair_of = (first, second) => ({
      first,
      second,
      correlation: number_or_null(list(list(correlation)[first.index])[second.index]),
      interval: numbers_or_null(list(list(correlation_ci95)[first.index])[second.index]),
      ...outlines_of(study, first, second),
    });
    pairs_of_study.set(
      study,
      all.flatMap((first, i) => all.slice(i + 1).map((second) => pair_of(first, second))),
    );
  }
  return pairs_of_study.get(study);
}

export const correlation_pair = (study, x, y) =>
  correlation_pairs(study).find(({ first, second }) => first.index === x.index && second.index === y.index);
