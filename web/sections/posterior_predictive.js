// The posterior against the tests: intervals of outputs with each specimen's value, and specimens that are left out.
import { is_number } from "../src/data.js";
import { paragraph } from "../src/dom.js";
import { figure } from "../src/figure.js";
import { number_text, plural } from "../src/format.js";
import { output_bars } from "../src/output_rows.js";
import { specimen_number } from "../src/population.js";
import { leave_one_out_of, predictive_outputs } from "../src/posterior.js";
import { data_table } from "../src/table.js";

const bars = {
  names: { test: "95 % of further tests", model: "95 % of the model's outputs", inside: "Specimen", outside: "Specimen outside" },
  tooltip: { test: "Further test, 95 %", model: "Model, 95 %" },
  axis: "Distance from the median, in half widths of the 95 % interval of a further test",
  short_axis: "Half widths of the bar from its median",
  inside: "test",
};
const largest_shape = 0.7;
const listed_at_most = 15;
const interval_text = (ends) => (ends ? `${number_text(ends[0], 5)} … ${number_text(ends[1], 5)}` : "–");

function outputs_table(outputs) {
  const inside = ({ specimens, test }) => specimens.filter((value) => is_number(value) && value >= test[0] && value <= test[1]).length;
  const interval = (key, title) => ({ key, title, text: interval_text, csv: (row) => row[key]?.join(" to ") ?? "" });
  return data_table({
    id: "posterior-predictive",
    title: "What the posterior expects of outputs and tests",
    columns: [
      { key: "name", title: "Output", is_text: true },
      outputs.some(({ unit }) => unit) ? { key: "unit", title: "Unit", is_text: true } : null,
      interval("model", "Model, 95 %"),
      interval("test", "Further test, 95 %"),
      {
        key: "inside",
        title: "Specimens inside",
        text: (value, { measured }) => (measured ? `${value} of ${measured}` : "–"),
      },
    ].filter(Boolean),
    rows: outputs.map((output) => ({ ...output, inside: inside(output), measured: output.specimens.filter(is_number).length })),
  });
}

const elpd_text = ({ elpd, error }) => `${number_text(elpd, 4)}${is_number(error) ? ` ± ${number_text(error, 2)}` : ""}`;

function specimens_table(study, { specimens }) {
  const rows = specimens.map(({ elpd, shape }, k) => ({ name: String(specimen_number(study, k)), elpd, shape }));
  const listed = [...rows].sort((a, b) => a.elpd - b.elpd).slice(0, listed_at_most);
  return data_table({
    id: "leave-one-out",
    title: "ln probability density of each specimen under the posterior of the others",
    columns: [
      { key: "name", title: "Specimen", is_text: true },
      { key: "elpd", title: "ln density" },
      {
        key: "shape",
        title: "Pareto k",
        text: (value) => (is_number(value) ? value.toFixed(2).replace("-", "\u2212") : "∞"),
        of_class: ({ shape }) => (shape > largest_shape ? "flag" : null),
      },
    ],
    rows: rows.length > listed_at_most ? listed : rows,
    all_rows: rows,
    caption:
      `Set off: a Pareto k above ${largest_shape}, where re-weighting the draws does not give this density.` +
      (rows.length > listed_at_most ? ` The ${listed_at_most} lowest of ${rows.length}; CSV saves them all.` : ""),
  });
}

function leave_one_out(study) {
  const found = leave_one_out_of(study);
  if (!found) return null;
  if (!is_number(found.elpd)) return paragraph(found.reason);
  const doubtful = found.specimens.filter(({ shape }) => shape > largest_shape).length;
  return [
    paragraph(
      `Leave-one-out: the expected ln density of ${found.specimens.length} new specimens is ${elpd_text(found)}, ` +
        `with ${number_text(found.parameters, 2)} effective parameters; by WAIC it is ${elpd_text(found.waic)}. `,
      doubtful ? `It is not to be relied on: ${plural(doubtful, "specimen")} has too much influence.`.replace("specimens has", "specimens have") : "",
    ),
    specimens_table(study, found),
  ];
}

export default {
  id: "posterior-predictive",
  title: "The posterior against the tests",
  has_data: (study) => study.is_update && (predictive_outputs(study).length > 0 || is_number(leave_one_out_of(study)?.elpd)),
  explained: [
    [
      "Further test",
      "What one more test would give if the model is right: the model's outputs at the posterior's draws, with measurement noise and the model's error.",
    ],
    [
      "Leave-one-out",
      "How probable each specimen is when the parameters are known from the others alone: a measure of prediction. Larger is better; differences of " +
        "models count against their standard errors.",
    ],
  ],
  content(study) {
    const outputs = predictive_outputs(study);
    return [
      outputs.length
        ? figure({
            id: "posterior-predictive",
            title: "Outputs that the posterior expects, and the tests",
            caption:
              "Wide bar: where 95\u00a0% of further tests are expected; narrow bar: the same of the model's outputs without noise. Diamonds: the specimens; " +
              "triangles: those outside. Beyond ±4 they are drawn at 4.",
            build: (width) => output_bars(outputs, bars, width),
          })
        : null,
      outputs.length ? outputs_table(outputs) : null,
      leave_one_out(study),
    ];
  },
};
