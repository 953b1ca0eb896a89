// Units that engineers read: GPa in place of 7e10 Pa. Everything that the result says of a parameter is converted at once, when
// the data are read, so that tables, plots and files of one page agree.
import { is_number, list, record } from "./data.js";
import { number_text } from "./format.js";

// Units by what they replace, from the largest: used where the prior mean is at least `from` of the unit in the study.
const readable = {
  Pa: [
    { unit: "GPa", from: 1e9, factor: 1e-9 },
    { unit: "MPa", from: 1e6, factor: 1e-6 },
    { unit: "kPa", from: 1e4, factor: 1e-3 },
  ],
  "N/m": [
    { unit: "kN/mm", from: 1e6, factor: 1e-6 },
    { unit: "N/mm", from: 1e4, factor: 1e-3 },
  ],
  "N m/rad": [
    { unit: "MN m/rad", from: 1e6, factor: 1e-6 },
    { unit: "kN m/rad", from: 1e4, factor: 1e-3 },
  ],
  "N/mm": [{ unit: "kN/mm", from: 1e4, factor: 1e-3 }],
  m: [{ unit: "mm", from: 0, to: 0.5, factor: 1e3 }],
  "m^4": [{ unit: "mm⁴", from: 0, to: 1e-4, factor: 1e12 }],
  "m^2": [{ unit: "mm²", from: 0, to: 0.1, factor: 1e6 }],
  "N m": [{ unit: "kN m", from: 1e4, factor: 1e-3 }],
};
const same = { "N/m m^2/rad": "N m/rad", "N*m/rad": "N m/rad", "N/m*m^2/rad": "N m/rad" };

const powers = { 2: "²", 3: "³", 4: "⁴" };
const pretty = (unit) =>
  unit
    .replace(/\^([234])/g, (_, power) => powers[power])
    .replace(/1\/sqrt\((\w+)\)/, "1/√$1")
    .replace(/sqrt\((\w+)\)/, "√$1");

/** {unit, factor} to show a quantity of this unit and size with. */
export function shown_unit(unit, size) {
  const known = same[unit] ?? unit ?? "";
  const found = list(readable[known]).find(
    ({ from, to }) => is_number(size) && size !== 0 && Math.abs(size) >= from && Math.abs(size) < (to ?? Infinity),
  );
  return found ? { unit: found.unit, factor: found.factor } : { unit: pretty(known), factor: 1 };
}

/** "71.2 GPa": the number of the model that a factor of this size gives; null where it is no factor of one number. */
export function number_of_factor(block, index, factor) {
  const value = list(block.factor_of)[index];
  if (!is_number(value) || !is_number(factor)) return null;
  const { unit, factor: scale } = shown_unit(list(block.factor_units)[index], value * factor);
  return `${number_text(value * factor * scale)}${unit && unit !== "-" ? ` ${unit}` : ""}`;
}

const times = (value, factor) => (is_number(value) ? value * factor : value);
const scaled = (values, factor) => (Array.isArray(values) ? values.map((value) => times(value, factor)) : values);
/** Rows of entries by parameter. */
const by_parameter = (rows, factors) =>
  Array.isArray(rows)
    ? rows.map((row) => (Array.isArray(row) ? row.map((value, i) => times(value, factors[i] ?? 1)) : row))
    : rows;
const one_each = (values, factors, convert) =>
  Array.isArray(values) ? values.map((value, i) => convert(value, factors[i] ?? 1)) : values;
const vector = (values, factors) => one_each(values, factors, times);
const ends = (rows, factors) => one_each(rows, factors, scaled);
const matrix = (rows, factors) =>
  one_each(rows, factors, (row, factor) =>
    Array.isArray(row) ? row.map((value, j) => times(value, factor * (factors[j] ?? 1))) : row,
  );

const curve = (of, factor, ...fields) => {
  if (!of || typeof of !== "object") return of;
  const converted = { ...of, x: scaled(of.x, factor) };
  for (const field of fields) if (of[field]) converted[field] = scaled(of[field], 1 / factor);
  return converted;
};

const densities = (all, factors) =>
  one_each(all, factors, (of, factor) => {
    const { prior, updated, band } = record(of);
    return {
      ...record(of),
      prior: curve(prior, factor, "density"),
      updated: curve(updated, factor, "density"),
      band: curve(band, factor, "least", "greatest"),
    };
  });

const region = (factors) => (of) => {
  const { first, second, outlines, interval_ends } = record(of);
  const convert = (outline) => ({
    ...outline,
    x: scaled(record(outline).x, factors[first] ?? 1),
    y: scaled(record(outline).y, factors[second] ?? 1),
  });
  return { ...record(of), outlines: list(outlines).map(convert), interval_ends: list(interval_ends).map(convert) };
};

function convert_parameters(block, units, factors) {
  const fields = {
    prior_mean: vector,
    prior_std: vector,
    mean: vector,
    std: vector,
    location: vector,
    covariance: matrix,
    mean_ci95: ends,
    std_ci95: ends,
    bounds: ends,
    box: ends,
    densities,
  };
  const converted = { ...block, units };
  for (const [field, convert] of Object.entries(fields))
    if (Array.isArray(block[field])) converted[field] = convert(block[field], factors);
  if (Array.isArray(block.regions)) converted.regions = block.regions.map(region(factors));
  if (block.quantiles)
    converted.quantiles = { ...block.quantiles, values: ends(record(block.quantiles).values, factors) };
  const parts = (entry, factor, names) => ({
    ...record(entry),
    ...Object.fromEntries(
      names
        .filter((name) => name in record(entry))
        .map((name) => [name, Array.isArray(entry[name]) ? scaled(entry[name], factor) : times(entry[name], factor)]),
    ),
  });
  if (Array.isArray(block.findings))
    converted.findings = one_each(block.findings, factors, (entry, factor) =>
      parts(entry, factor, ["interval95", "prior95"]),
    );
  if (Array.isArray(block.prior))
    converted.prior = one_each(block.prior, factors, (entry, factor) =>
      parts(entry, factor, ["mean", "std", "lower", "upper"]),
    );
  return converted;
}

/** An ellipse keeps its shape in the study's units; its points are scaled when they are drawn. */
const ellipse = (factors, names) => (of) => {
  const at = (axis) => factors[typeof axis === "number" ? axis : names.indexOf(axis)] ?? 1;
  return { ...record(of), scale: [at(record(of).first), at(record(of).second)] };
};

/** Sensitivities [output][parameter]: per unit of the parameter. */
function convert_regression(regression, factors) {
  const inverse = factors.map((factor) => 1 / factor);
  const { sensitivity, standard_error } = record(regression);
  return (
    regression && {
      ...regression,
      sensitivity: by_parameter(sensitivity, inverse),
      standard_error: by_parameter(standard_error, inverse),
    }
  );
}

/** A batch of specimens, whose fields are those of the parameters. */
const batch = (factors) => (of) => ({
  ...record(of),
  mean: vector(record(of).mean, factors),
  std: vector(record(of).std, factors),
  mean_ci95: ends(record(of).mean_ci95, factors),
  std_ci95: ends(record(of).std_ci95, factors),
});

/** The page's data {result, clouds, ...} with parameters in units that are read easily. */
export function in_readable_units(data) {
  const result = record(data.result);
  const block = record(result.parameters);
  const names = list(block.names);
  const shown = names.map((_, i) => shown_unit(list(block.units)[i], list(block.prior_mean)[i]));
  const factors = shown.map(({ factor }) => factor);
  if (!names.length || !Array.isArray(block.units)) return data;
  const units = shown.map(({ unit }) => unit);
  const iterations = list(result.iterations).map((entry) => ({
    ...record(entry),
    parameter_mean: vector(record(entry).parameter_mean, factors),
    parameter_std: vector(record(entry).parameter_std, factors),
    parameter_covariance: matrix(record(entry).parameter_covariance, factors),
    parameter_ellipses: Array.isArray(record(entry).parameter_ellipses)
      ? entry.parameter_ellipses.map(ellipse(factors, names))
      : record(entry).parameter_ellipses,
  }));
  const specimens = result.specimens && {
    ...result.specimens,
    parameters: by_parameter(result.specimens.parameters, factors),
  };
  const clouds = Array.isArray(data.clouds)
    ? data.clouds.map((cloud) => ({ ...record(cloud), parameters: by_parameter(record(cloud).parameters, factors) }))
    : data.clouds;
  return {
    ...data,
    clouds,
    result: {
      ...result,
      iterations: Array.isArray(result.iterations) ? iterations : result.iterations,
      specimens,
      parameters: convert_parameters(block, units, factors),
      other_solutions: Array.isArray(result.other_solutions)
        ? result.other_solutions.map((other) => ({ ...record(other), mean: by_parameter([record(other).mean], factors)[0] }))
        : result.other_solutions,
      modes: Array.isArray(result.modes)
        ? result.modes.map((mode) => ({ ...record(mode), mean: by_parameter([record(mode).mean], factors)[0] }))
        : result.modes,
      components: Array.isArray(result.components) ? result.components.map(batch(factors)) : result.components,
      interval: result.interval && { ...result.interval, hull: ends(record(result.interval).hull, factors) },
      regression: convert_regression(result.regression, factors),
    },
  };
}
