// Tests and cloud with their 2-sigma ellipses, first and last iteration under one another on the same axes.
import { shown_iterations } from "../src/data.js";
import { redraw } from "../src/charts.js";
import { axis_choice, legend_height, limits_of_pair, pair_panels, pairs_of, snapshot } from "../src/cloud_panels.js";
import { figure } from "../src/figure.js";
import { layout } from "../src/panels.js";
import { answer_kind } from "../src/population.js";

const id = "scatter-first-last";
const columns_at_most = 3;

/** Rows of panels: for each row of pairs the first iteration, below it the last; `position` counts cells row by row. */
function arrange(pairs, steps, columns) {
  return pairs.flatMap((pair, k) =>
    steps.map((iteration, step) => {
      const row = Math.floor(k / columns) * steps.length + step;
      return { pair, iteration, position: row * columns + (k % columns) };
    }),
  );
}

function title_of_step(study, steps, iteration) {
  if (steps.length < 2 && !study.is_update) return "";
  if (study.has_iterations) return `Iteration ${iteration}`;
  return iteration === study.clouds[0]?.iteration ? "Prior" : "Updated";
}

function build(study, axes, steps, width) {
  const pairs = pairs_of(axes);
  const columns = Math.max(1, Math.min(pairs.length, columns_at_most, Math.floor(width / 215)));
  const rows = Math.ceil(pairs.length / columns) * steps.length;
  const grid = layout(rows * columns, width, {
    minimum: width / columns,
    columns_at_most: columns,
    aspect: 0.8,
    legend_height: legend_height(width),
  });
  const limits = new Map(
    pairs.map((pair) => [
      pair,
      limits_of_pair(
        study,
        steps.map((step) => snapshot(study, step, "outputs")),
        pair,
        "outputs",
      ),
    ]),
  );
  const panels = arrange(pairs, steps, columns).map(({ pair, iteration, position }) => ({
    pair,
    title: title_of_step(study, steps, iteration),
    limits: limits.get(pair),
    view: snapshot(study, iteration, "outputs"),
    cell: grid.cells[position],
  }));
  return { option: pair_panels(study, "outputs", panels), height: grid.height };
}

export default {
  id: "scatter",
  title: (study) => (study.tests.length ? "Scatter of tests and model" : "Scatter of the model's outputs"),
  is_in_print: true,
  has_data: (study) => study.output_axes.length > 1 && shown_iterations(study).length > 0,
  explained: [
    [
      "Scatter and ellipses",
      "Each dot is one sample of the model, each diamond one specimen. An ellipse contains about 86\u00a0% of a normal " +
        "scatter of two outputs (2σ). In the last iteration the solid ellipse should lie on the dashed one.",
    ],
  ],
  content(study) {
    const all = shown_iterations(study);
    const steps = all.length > 1 ? [all[0], all[all.length - 1]] : all;
    const choice = axis_choice(study.output_axes, 4, "Outputs shown", (axes) => {
      shown = axes;
      redraw(id, { afresh: true });
    });
    let shown = choice.chosen;
    return [
      figure({
        id,
        renderer: "canvas",
        controls: choice.control ? [choice.control] : [],
        title: !(steps.length > 1)
          ? "Samples of the outputs"
          : study.has_iterations
            ? "Tests and model at the first and the last iteration"
            : "Tests and model before and after the update",
        caption:
          "Every pair of the outputs shown, with 2σ ellipses" +
          (steps.length > 1 ? "; the same axes above and below." : "."),
        build: (width, { is_summary } = {}) =>
          is_summary
            ? build(study, answer_kind(study) ? shown.slice(0, 3) : shown, steps.slice(-1), width)
            : build(study, shown, steps, width),
      }),
    ];
  },
};
