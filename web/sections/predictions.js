// What the updated distribution says of outputs that were not used, and how tests that were held out bear it out.
import { is_number, list, number_or_null, record } from "../src/data.js";
import { paragraph } from "../src/dom.js";
import { figure, paged_figure } from "../src/figure.js";
import { number_text, p_value_text, plural } from "../src/format.js";
import { has_histogram, interval_bars, pit_histograms, tested } from "../src/prediction_panels.js";
import { data_table } from "../src/table.js";

const panels_a_page = 9;
const percent = (share) => (is_number(share) ? `${(100 * share).toFixed(0)}\u00a0%` : "–");

/** The prediction with one entry an output; what is missing is null or empty. */
function read(study) {
  const block = record(study.result.prediction);
  const held_out = record(block.held_out);
  const units = list(block.units);
  const pit = list(held_out.transforms).map(list);
  const scores = list(held_out.scores).map(list);
  return {
    count: number_or_null(held_out.specimens) ?? (pit.length || null),
    joint_coverage: number_or_null(held_out.joint_coverage),
    has_held_out: pit.length > 0 || list(held_out.coverage).some(is_number),
    outputs: list(block.names).map((name, k) => {
      const interval = list(list(block.interval95)[k]);
      return {
        name: String(name),
        unit: units[k] && units[k] !== "1" ? String(units[k]) : "",
        mean: number_or_null(list(block.mean)[k]),
        std: number_or_null(list(block.std)[k]),
        interval: interval.length === 2 && interval.every(is_number) ? interval : null,
        coverage: number_or_null(list(held_out.coverage)[k]),
        uniformity_p: number_or_null(list(held_out.uniformity_p_values)[k]),
        least_inside: number_or_null(list(held_out.least_inside)[k]),
        histogram: list(held_out.histograms)[k] ?? null,
        pit: pit.map((row) => number_or_null(row[k])),
        scores: scores.map((row) => number_or_null(row[k])),
      };
    }),
  };
}

function table(prediction) {
  const rows = prediction.outputs.map((output) => ({ ...output, tests: tested(output).length || null }));
  const any = (key) => rows.some((row) => is_number(row[key]));
  const is_off = ({ coverage, tests, least_inside }) =>
    is_number(coverage) && is_number(least_inside) && Math.round(coverage * tests) < least_inside;
  return data_table({
    id: "predictions",
    title: "Predicted outputs",
    columns: [
      { key: "name", title: "Output", is_text: true },
      rows.some(({ unit }) => unit) ? { key: "unit", title: "Unit", is_text: true } : null,
      { key: "mean", title: "Mean", group: "Predicted", text: (value) => number_text(value, 5) },
      { key: "std", title: "Std. dev.", group: "Predicted" },
      {
        key: "interval",
        title: "95 % of specimens",
        group: "Predicted",
        text: (ends) => (ends ? `${number_text(ends[0], 5)} … ${number_text(ends[1], 5)}` : "–"),
        csv: ({ interval }) => interval?.join(" to ") ?? "",
      },
      any("tests")
        ? { key: "tests", title: "n", group: "Held-out tests", text: (n) => (is_number(n) ? String(n) : "–") }
        : null,
      any("coverage")
        ? {
            key: "coverage",
            title: "Within",
            group: "Held-out tests",
            text: percent,
            of_class: (row) => (is_off(row) ? "flag" : null),
          }
        : null,
      any("uniformity_p")
        ? {
            key: "uniformity_p",
            title: "p of uniformity",
            group: "Held-out tests",
            text: p_value_text,
            of_class: ({ uniformity_p }) =>
              is_number(uniformity_p) && uniformity_p < 0.05 / rows.length ? "flag" : null,
          }
        : null,
    ].filter(Boolean),
    rows,
    caption: any("coverage")
      ? "Within: fraction of the held-out tests inside the 95 % interval. Set off: a fraction that a right prediction would give in fewer than " +
        "one of a hundred cases, or a p below 0.05 divided by the number of outputs."
      : null,
  });
}

function statement({ count, joint_coverage, has_held_out, outputs }) {
  if (!has_held_out) return paragraph("No tests were held out: nothing here says whether the prediction is right.");
  const known = outputs.filter(({ coverage }) => is_number(coverage));
  const mean = known.reduce((sum, { coverage }) => sum + coverage, 0) / (known.length || 1);
  return paragraph(
    `Compared with ${is_number(count) ? plural(count, "test") : "tests"} that the update did not use`,
    known.length ? `: ${percent(mean)} of their outputs lie within the predicted 95\u00a0% intervals` : "",
    is_number(joint_coverage)
      ? `, and ${percent(joint_coverage)} of the tests as a whole within the predicted 95\u00a0% region.`
      : ".",
  );
}

function histogram_figure(outputs) {
  return paged_figure({
    id: "prediction-pit",
    title: "Where the held-out tests lie in the predicted distribution",
    caption:
      "Flat, within the grey strip: the prediction is right. A hump in the middle: predicted too wide; high ends: too narrow; " +
      "a slope: shifted.",
    items: outputs,
    size: panels_a_page,
    build: pit_histograms,
  });
}

export default {
  id: "predictions",
  title: (study) => (read(study).has_held_out ? "Predictions against held-out tests" : "Predictions"),
  has_data: (study) => read(study).outputs.some(({ mean }) => is_number(mean)),
  explained: [
    [
      "Probability integral transform",
      "The predicted probability of a value below that of the test. If the prediction is right, these numbers are uniform from 0 to 1.",
    ],
    ["Held-out tests", "Tests that the update did not use: the only ones that can show whether it predicts."],
  ],
  content(study) {
    const prediction = read(study);
    const with_tests = prediction.outputs.filter((output) => tested(output).length > 0);
    const with_bars = prediction.outputs.filter(({ interval, std }) => interval && std > 0);
    return [
      statement(prediction),
      table(prediction),
      with_bars.length
        ? figure({
            id: "prediction-intervals",
            title: with_tests.length ? "Predicted intervals and held-out tests" : "Predicted intervals",
            caption:
              "Bars: where 95\u00a0% of specimens are expected." +
              (with_tests.length
                ? " Diamonds: held-out tests; triangles: those outside. Beyond ±4 they are drawn at 4."
                : ""),
            build: (width) => interval_bars(with_bars, width),
          })
        : null,
      with_tests.some(has_histogram) ? histogram_figure(with_tests.filter(has_histogram)) : null,
    ];
  },
};
