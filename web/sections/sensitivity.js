// The regression of the last cloud: dy/dx with standard errors, and how much of the scatter it explains.
import { is_number, list, number_or_null, record } from "../src/data.js";
import { element, paragraph } from "../src/dom.js";
import { figure } from "../src/figure.js";
import { number_text, short_number } from "../src/format.js";
import { matrix_map } from "../src/matrix_map.js";
import { diverging } from "../src/palette.js";
import { data_table } from "../src/table.js";

const in_one_table = 6;
const in_each_of_several = 5;
const cell = {
  width_at_most: 74,
  height_at_least: 16,
  height_at_most: 30,
  aspect: 0.5,
  name_at_most: 150,
  column_room: 90,
};

function rows_of(study, regression) {
  return study.output_axes.map(({ index, name, unit }) => {
    const row = {
      name,
      unit,
      r_squared: number_or_null(list(regression.r_squared)[index]),
      r_squared_quadratic: number_or_null(list(regression.r_squared_quadratic)[index]),
    };
    for (const parameter of study.parameter_axes) {
      row[`g${parameter.index}`] = number_or_null(list(list(regression.sensitivity)[index])[parameter.index]);
      row[`e${parameter.index}`] = number_or_null(list(list(regression.standard_error)[index])[parameter.index]);
    }
    return row;
  });
}

/** Change of each output in percent for one percent of each parameter, as a map; nothing where the result does not say it. */
function percent_map(study, regression) {
  const values = list(regression.percent_per_percent).map(list);
  if (!values.some((row) => row.some(is_number))) return null;
  const largest = Math.max(...values.flat().filter(is_number).map(Math.abs)) || 1;
  return figure({
    id: "sensitivity-percent",
    title: "Sensitivity in percent per percent",
    caption:
      "Change of the output in percent for a change of the parameter by one percent, at the mean of the cloud. A frequency " +
      "changes by half of what its stiffness does, if that stiffness alone holds it.",
    build: matrix_map({
      name: "% per %",
      rows: study.output_axes.map(({ name }) => name),
      columns: study.parameter_axes.map(({ name }) => name),
      values,
      low: -largest,
      high: largest,
      ends: [short_number(largest, 2), short_number(-largest, 2)],
      stops: () => diverging,
      is_deep: (value) => Math.abs(value) > 0.78 * largest,
      cell,
      tooltip: (row, column, value) => [`${row} by ${column}`, `${short_number(value, 3)} % per %`],
    }),
  });
}

function with_error(parameter) {
  return (value, row) => {
    const error = row[`e${parameter.index}`];
    return [
      number_text(value),
      is_number(error) ? element("span", { class: "error" }, ` ± ${number_text(error, 2)}`) : null,
    ];
  };
}

function part(study, rows, parameters, is_first, of) {
  const fit = (value) => (is_number(value) ? value.toFixed(4) : "–");
  const columns = [
    { key: "name", title: "Output", is_text: true },
    { key: "unit", title: "Unit", is_text: true },
    ...parameters.map((parameter) => ({
      key: `g${parameter.index}`,
      title: parameter.name,
      unit: parameter.unit ? `per ${parameter.unit}` : "",
      text: with_error(parameter),
    })),
  ];
  if (is_first) {
    columns.push({ key: "r_squared", title: "R²", group: "Explained", text: fit });
    if (rows.some((row) => is_number(row.r_squared_quadratic))) {
      columns.push({ key: "r_squared_quadratic", title: "R², quadratic", group: "Explained", text: fit });
    }
  }
  const has_errors = rows.some((row) => parameters.some(({ index }) => is_number(row[`e${index}`])));
  const caption = `Change of the output for a unit change of the parameter${has_errors ? ", ± one standard error of the regression" : ""}.`;
  const suffix = of.count > 1 ? `, ${parameters[0].name} to ${parameters[parameters.length - 1].name}` : "";
  return data_table({
    id: of.count > 1 ? `sensitivity-${of.part + 1}` : "sensitivity",
    title: `Sensitivity of the outputs${suffix}`,
    columns: columns.filter(({ key }) => key !== "unit" || rows.some((row) => row.unit)),
    rows,
    caption: of.part === of.count - 1 ? caption : null,
  });
}

export default {
  id: "sensitivity",
  title: "Sensitivity",
  has_data: (study) => list(record(study.result.regression).sensitivity).length > 0,
  explained: [
    [
      "Sensitivity",
      "Slopes of a linear fit of the outputs over the cloud; a slope that is not well above its standard error is not known.",
    ],
    [
      "R²",
      "Fraction of an output's variance that the linear fit explains; where the quadratic one explains much more, the model is curved " +
        "over the cloud.",
    ],
  ],
  content(study) {
    const regression = record(study.result.regression);
    const rows = rows_of(study, regression);
    const total = study.parameter_axes.length;
    const count = total <= in_one_table ? 1 : Math.ceil(total / in_each_of_several);
    const size = Math.ceil(total / count);
    const tables = Array.from({ length: count }, (_, k) =>
      part(study, rows, study.parameter_axes.slice(k * size, (k + 1) * size), k === 0, { part: k, count }),
    );
    const condition = is_number(regression.condition)
      ? paragraph(`Condition number of the samples' columns: ${short_number(regression.condition)}.`)
      : null;
    return [percent_map(study, regression), ...tables, condition];
  },
};
