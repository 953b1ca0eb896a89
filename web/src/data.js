// Reads the page's data and answers questions about it. Any field may be missing or null: the answers here are
// then empty lists or null, never an exception, so that a section only has to ask whether there is something to draw.

export const is_number = (value) => typeof value === "number" && Number.isFinite(value);
export const number_or_null = (value) => (is_number(value) ? value : null);
export const list = (value) => (Array.isArray(value) ? value : []);
export const record = (value) => (value && typeof value === "object" && !Array.isArray(value) ? value : {});
export const has_numbers = (value) => list(value).some(is_number);

/** Square roots of a covariance's diagonal, null where it is unknown. */
export function standard_deviations(covariance) {
  return list(covariance).map((row, i) => {
    const variance = list(row)[i];
    return is_number(variance) && variance >= 0 ? Math.sqrt(variance) : null;
  });
}

export function extent(values) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (!is_number(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low <= high ? [low, high] : null;
}

/** Relative difference in percent, null where there is nothing to divide by. */
export function percent_change(from, to) {
  return is_number(from) && is_number(to) && from !== 0 ? (100 * (to - from)) / Math.abs(from) : null;
}

/** "1" is how a result says that a quantity has no unit. */
const unit_text = (unit) => (unit === null || unit === undefined || unit === "1" ? "" : String(unit));

/** Names with units, filled up where a result names fewer than it holds. */
function named(block, prefix, count) {
  const names = list(block.names);
  return Array.from({ length: Math.max(names.length, count) }, (_, i) => ({
    index: i,
    name: String(names[i] ?? `${prefix}${i + 1}`),
    unit: unit_text(list(block.units)[i]),
  }));
}

export function read_study(data) {
  const source = record(data);
  const is_modes = source.kind === "modes";
  const result = is_modes ? head_of_modes(source) : record(source.result);
  const parameters = record(result.parameters);
  const outputs = record(result.outputs);
  const iterations = list(result.iterations)
    .map(record)
    .map((entry, position) => ({ ...entry, index: is_number(entry.index) ? entry.index : position }));
  const clouds = list(source.clouds)
    .map(record)
    .map((cloud, position) => ({
      iteration: is_number(cloud.iteration) ? cloud.iteration : position,
      parameters: list(cloud.parameters).map(list),
      outputs: list(cloud.outputs).map(list),
    }));
  const first_cloud = clouds[0] ?? { parameters: [], outputs: [] };
  const study = {
    is_modes,
    result,
    source: String(source.source ?? "").trim(),
    summary: list(source.summary).map(String),
    modes: record(source.modes),
    mac: record(source.mac),
    diagnosis: typeof source.diagnosis === "string" ? source.diagnosis : null,
    parameters,
    outputs,
    iterations,
    clouds,
    parameter_axes: named(parameters, "x", list(first_cloud.parameters[0]).length),
    output_axes: named(outputs, "y", list(first_cloud.outputs[0]).length),
  };
  study.tests = tests_by_output(record(source.tests), study.output_axes);
  study.title = String(result.title ?? "").trim() || (is_modes ? "Mode shapes" : "Untitled study");
  study.has_iterations = !["box", "posterior"].includes(record(parameters.estimate).kind) && !record(result.posterior).names;
  study.is_update = result.command ? result.command === "update" : iterations.length > 0;
  study.is_propagation = !is_modes && !study.is_update && (result.command === "propagate" || has_numbers(outputs.initial_mean));
  return study;
}

/** A page of mode shapes holds no result, only what its head says. */
function head_of_modes({ title, mottle, units, warnings }) {
  return { title, mottle, units, warnings };
}

/** Specimens [specimen x output] in the order of the outputs; a column that was not tested is all null. */
function tests_by_output(tests, output_axes) {
  const columns = list(tests.columns).map(String);
  const positions = output_axes.map((axis) => columns.indexOf(axis.name));
  return list(tests.rows).map((row) => positions.map((at) => (at < 0 ? null : number_or_null(list(row)[at]))));
}

/** Per iteration, one component of a history entry: [[index, value], ...]. */
export function history_of(study, field, component) {
  return study.iterations.map((entry) => {
    const value = component === undefined ? entry[field] : list(entry[field])[component];
    return [entry.index, number_or_null(value)];
  });
}

/** Of more than a beginning and an end: two points are no course. A box or a posterior is not approached by means of clouds. */
export const has_history = (study, field) =>
  study.has_iterations && study.iterations.length > 2 && study.iterations.some((entry) => is_number(entry[field]) || has_numbers(entry[field]));

/** The iterations of which there is a cloud or an ellipse to show, in order. */
export function shown_iterations(study) {
  const indices = new Set(study.clouds.map((cloud) => cloud.iteration));
  for (const entry of study.iterations) {
    if (list(entry.ellipses).length || list(entry.parameter_ellipses).length) indices.add(entry.index);
  }
  return [...indices].sort((a, b) => a - b);
}

const matches_axis = (reference, axis) => reference === axis.index || reference === axis.name;

/** 2-sigma ellipse of two axes as a closed polyline, from the listed ellipses; null where the pair is not among them. */
export function ellipse_of_pair(ellipses, x_axis, y_axis) {
  for (const ellipse of list(ellipses).map(record)) {
    const same = matches_axis(ellipse.first, x_axis) && matches_axis(ellipse.second, y_axis);
    const swapped = matches_axis(ellipse.first, y_axis) && matches_axis(ellipse.second, x_axis);
    if (!same && !swapped) continue;
    const points = ellipse_points(ellipse);
    return points && swapped ? points.map(([x, y]) => [y, x]) : points;
  }
  return null;
}

/** `angle` in radians, from the first axis to the major one. */
function ellipse_points({ centre, semi_major, semi_minor, angle, scale = [1, 1] }) {
  const [x, y] = list(centre);
  if (![x, y, semi_major, semi_minor, angle].every(is_number)) return null;
  const steps = 96;
  return Array.from({ length: steps + 1 }, (_, k) => {
    const t = (2 * Math.PI * k) / steps;
    const along = semi_major * Math.cos(t);
    const across = semi_minor * Math.sin(t);
    return [
      scale[0] * (x + along * Math.cos(angle) - across * Math.sin(angle)),
      scale[1] * (y + along * Math.sin(angle) + across * Math.cos(angle)),
    ];
  });
}
