// The table of the outputs: tests against the first and the last cloud.
import { agreement_rows } from "../src/agreement.js";
import { is_number, list, number_or_null, percent_change, record, standard_deviations } from "../src/data.js";
import { percent_text } from "../src/format.js";
import { data_table } from "../src/table.js";

/** Positions of the outputs by how well the model reproduces them, the worst first; of older results as they come. */
function worst_first(study) {
  const order = agreement_rows(study).map(({ name }) => name);
  const place = ({ name }) => (order.includes(name) ? order.indexOf(name) : order.length);
  return [...study.output_axes].sort((a, b) => place(a) - place(b) || a.index - b.index);
}

function rows_of(study) {
  const { outputs: block } = study;
  const deviations = Object.fromEntries(
    ["test", "initial", "final"].map((which) => [which, standard_deviations(block[`${which}_covariance`])]),
  );
  const agreement = new Map(agreement_rows(study).map((row) => [row.name, row]));
  // Near a node of a shape the result gives the error in percent of the largest component; older results give none.
  const error = (name, which, from, to) => {
    const { mean_error } = record(agreement.get(name)?.[which]);
    return is_number(mean_error) ? 100 * mean_error : percent_change(from, to);
  };
  return worst_first(study).map(({ index, name, unit }) => {
    const at = (field) => number_or_null(list(block[field])[index]);
    const std = (which) => number_or_null(deviations[which][index]);
    return {
      name,
      unit,
      test_count: at("test_count"),
      test_mean: at("test_mean"),
      test_std: std("test"),
      initial_mean: at("initial_mean"),
      initial_error: error(name, "initial", at("test_mean"), at("initial_mean")),
      initial_std: std("initial"),
      final_mean: at("final_mean"),
      final_error: error(name, "final", at("test_mean"), at("final_mean")),
      final_std: std("final"),
      model_error_std: at("model_error_std"),
      model_error_shift: number_or_null(list(block.model_error)[index]?.shift),
    };
  });
}

function columns_for(rows) {
  const error = (value) => percent_text(value, 2);
  const model = rows.some((row) => is_number(row.final_mean))
    ? ["Model, initial", "Model, updated"]
    : ["Model", "Model"];
  return [
    { key: "name", title: "Output", is_text: true },
    { key: "unit", title: "Unit", is_text: true },
    { key: "test_count", title: "n", group: "Tests", text: (n) => (is_number(n) ? String(n) : "–") },
    { key: "test_mean", title: "Mean", group: "Tests" },
    { key: "test_std", title: "Std. dev.", group: "Tests" },
    { key: "initial_mean", title: "Mean", group: model[0] },
    { key: "initial_error", title: "Error", group: model[0], text: error },
    { key: "initial_std", title: "Std. dev.", group: model[0] },
    { key: "final_mean", title: "Mean", group: model[1] },
    { key: "final_error", title: "Error", group: model[1], text: error },
    { key: "final_std", title: "Std. dev.", group: model[1] },
    { key: "model_error_std", title: "Std. dev.", group: "Model error" },
    { key: "model_error_shift", title: "Shift", group: "Model error" },
  ].filter(({ key, is_text }) => (is_text ? rows.some((row) => row[key]) : rows.some((row) => is_number(row[key]))));
}

export default {
  id: "outputs",
  title: "Outputs",
  has_data: (study) => study.is_update && list(study.outputs.names).length > 0,
  explained: [
    ["Error", "Mean of the model's cloud minus mean of the tests, in percent of the latter; near a node of a shape in percent of the shape's largest component."],
    ["Model error", "An error of the model that all specimens share; the shift is its estimate from the tests."],
  ],
  content(study) {
    const rows = rows_of(study);
    const is_compared = rows.some((row) => is_number(row.test_mean));
    return [
      data_table({
        id: "outputs",
        rows,
        columns: columns_for(rows),
        title: is_compared ? "Outputs: tests against the model, the worst first" : "Outputs of the model",
      }),
    ];
  },
};
