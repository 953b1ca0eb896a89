// What the data of a page call for, and how to read what the page shows of them.
import assert from "node:assert/strict";

export const list = (value) => (Array.isArray(value) ? value : []);
export const is_number = (value) => typeof value === "number" && Number.isFinite(value);
export const has_numbers = (value) => list(value).flat(Infinity).some(is_number);
export const is_modes = (data) => data.kind === "modes";
export const result_of = (data) => (is_modes(data) ? { title: data.title } : (data.result ?? {}));

const is_update = (result) => (result.command ? result.command === "update" : list(result.iterations).length > 0);

/** What a method answers beside a mean and a scatter, or null. */
export function answer_of(result) {
  const { components, parameters = {}, posterior, abc } = result;
  if (list(components).length) return "batches";
  if (parameters.estimate?.kind === "box") return "box";
  return parameters.estimate?.kind === "posterior" || list(posterior?.names).length || abc?.stages ? "posterior" : null;
}

/** A box and a posterior are not approached by means of clouds: nothing of theirs is drawn against iterations. */
const has_iterations = ({ parameters, posterior }) =>
  !["box", "posterior"].includes(parameters?.estimate?.kind) && !posterior?.names;

/** Plots of the estimate itself, which stand before those of the iterations. */
function plots_of_estimate(result) {
  const { parameters = {}, identifiability, specimens, prediction, posterior } = result;
  const names = list(parameters.names);
  const pairs = names.flatMap((_, i) => names.slice(i + 1).map((__, k) => [i, i + 1 + k]));
  const has_width = (i) => is_number(parameters.mean?.[i]) && parameters.std?.[i] > 0;
  const is_known = ([i, j]) => has_width(i) && has_width(j) && is_number(parameters.correlation?.[i]?.[j]);
  const has_interval = ([i, j]) => list(parameters.correlation_ci95?.[i]?.[j]).filter(is_number).length === 2;
  const is_posterior = parameters.estimate?.kind === "posterior";
  const is_population = parameters.is_population === true || is_posterior;
  const has_correlations = is_population && Array.isArray(parameters.correlation) && pairs.some((pair) => is_known(pair) || has_interval(pair));
  const in_map = pairs.filter((pair) => is_known(pair) && has_interval(pair)).length;
  const predicted = list(prediction?.names).map((_, k) => k);
  const has_prediction = predicted.some((k) => is_number(prediction.mean?.[k]));
  const has_bar = (k) => list(prediction.interval95?.[k]).filter(is_number).length === 2 && prediction.std?.[k] > 0;
  const has_directions = list(identifiability?.unseen_directions).length > 0;
  const has_density = (_, i) => is_number(parameters.mean?.[i]) && is_number(parameters.std?.[i]);
  const is_box = parameters.estimate?.kind === "box";
  return [
    list(result.components).length ? "batches" : null,
    is_box && list(result.interval?.image).length ? "cover" : null,
    is_update(result) && !is_box && names.some(has_density) && Array.isArray(parameters.densities) ? "densities" : null,
    has_correlations && names.length >= 4 && in_map >= 3 ? "correlation-map" : null,
    has_correlations ? (is_posterior ? "posterior-pairs" : "correlation-ellipses") : null,
    has_numbers(identifiability?.singular_values) ? "singular-values" : null,
    has_directions ? "unseen-parts" : null,
    has_directions ? "unseen-directions" : null,
    has_numbers(posterior?.predictive?.tests) ? "posterior-predictive" : null,
    has_numbers(result.shape_correlation?.initial?.mac) ? "mac-initial" : null,
    has_numbers(result.shape_correlation?.final?.mac) ? "mac-final" : null,
    has_numbers(specimens?.residuals) ? "residuals" : null,
    result.assignments?.length ? "assignments" : null,
    has_prediction && predicted.some(has_bar) ? "prediction-intervals" : null,
    has_prediction && has_numbers(prediction.held_out?.transforms) ? "prediction-pit" : null,
    has_numbers(posterior?.ranks?.counts) ? "posterior-ranks" : null,
    list(posterior?.stages).some((chain) => list(chain).length > 0) ? "posterior-stages" : null,
    has_numbers(result.evidence?.islands) ? "posterior-evidence" : null,
  ];
}

/** The plots that the data call for. */
export function expected_plots(data) {
  const result = result_of(data);
  const iterations = list(result.iterations);
  const any = (field) => has_iterations(result) && iterations.length > 2 && iterations.some((entry) => is_number(entry[field]) || has_numbers(entry[field]));
  const outputs = list(result.outputs?.names).length;
  const shown = new Set([
    ...list(data.clouds).map(({ iteration }) => iteration),
    ...iterations
      .filter((entry) => list(entry.ellipses).length || list(entry.parameter_ellipses).length)
      .map(({ index }) => index),
  ]);
  return [
    ...plots_of_estimate(result),
    any("distance_euclidean") || any("distance_mahalanobis") ? "distance" : null,
    any("output_mean") ? "output-history" : null,
    any("parameter_mean") ? "parameter-history" : null,
    list(result.sample_size?.curve?.n_total).length > 2 ? "sample-size" : null,
    has_numbers(result.spearman) ? "spearman" : null,
    outputs > 1 && shown.size ? "scatter-first-last" : null,
    outputs > 1 && shown.size > 1 && has_iterations(result) ? "scatter-outputs" : null,
    (has_iterations(result) || shown.size === 1) && list(result.parameters?.names).length > 1 && has_numbers(list(data.clouds).map(({ parameters }) => parameters))
      ? "scatter-parameters"
      : null,
    has_numbers(result.regression?.percent_per_percent) ? "sensitivity-percent" : null,
    has_numbers(data.mac?.values) ? "mac" : null,
  ].filter(Boolean);
}

/** Number of distinct colours drawn, sampled; 1 means blank. */
export function drawn_colours(page, id) {
  return page.evaluate((plot) => {
    const host = document.querySelector(`[data-plot="${plot}"] .plot-area`);
    const canvas = host.querySelector("canvas");
    if (!canvas) return host.querySelectorAll("svg path").length;
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const colours = new Set();
    for (let i = 0; i < data.length; i += 4 * 7) colours.add(`${data[i]},${data[i + 1]},${data[i + 2]},${data[i + 3]}`);
    return colours.size;
  }, id);
}

export const series_of = (page, id) =>
  page.evaluate(
    (plot) => window.mottle.charts[plot].getOption().series.map(({ name, type, data }) => ({ name, type, data })),
    id,
  );

const superscripts = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹";

/** The number that a cell shows: "−1.2·10⁻³" is -0.0012. */
function shown_number(text) {
  const exponent = (_, power) =>
    `e${[...power]
      .map((sign) => superscripts.indexOf(sign))
      .map((k) => (k === 0 ? "-" : String(k - 1)))
      .join("")}`;
  return Number(text.replace("−", "-").replace(/·10(.*)/, exponent));
}

/** `rows`: names, in the order of `values`; the table may have another. */
export async function close_to_data(page, table, key, rows, values) {
  const shown = await page.locator(`[data-table="${table}"] tr[data-row]`).evaluateAll(
    (found, column) =>
      found.map((row) => {
        const cell = row.querySelector(`[data-key="${column}"]`);
        return { row: row.dataset.row, text: cell?.innerText ?? null, value: cell?.dataset.value ?? null };
      }),
    key,
  );
  for (const [i, value] of values.entries()) {
    const cell = shown.find(({ row }) => row === rows[i]);
    if (!is_number(value)) {
      if (typeof cell?.text === "string") assert.equal(cell.text.trim(), "–", `${table}.${key}[${i}] of a missing number`);
      continue;
    }
    assert.ok(cell && cell.value !== null, `${table}.${key}[${i}] is missing`);
    assert.equal(Number(cell.value), value, `${table}.${key}[${i}]`);
    const number = shown_number(cell.text);
    assert.ok(Math.abs(number - value) <= 6e-4 * Math.abs(value), `${table}.${key}[${i}] shows ${number} for ${value}`);
  }
}
