// How many samples are enough: Hotelling's critical value against sample size, and the Monte-Carlo error of the means.
import { is_number, list, record, standard_deviations } from "../src/data.js";
import { legend, tooltip_box, zooming } from "../src/charts.js";
import { paragraph } from "../src/dom.js";
import { figure } from "../src/figure.js";
import { count_text, number_text, short_number } from "../src/format.js";
import { layout, level_series, panel_frame } from "../src/panels.js";
import { accent, bound, model, paper } from "../src/palette.js";
import { data_table } from "../src/table.js";

const names = { curve: "Critical value T", limit: "Limit for infinitely many samples", here: "This run" };

const steepest_shown = 4; // times the limit: with hardly more samples than outputs T is in the hundreds

function build(size, width) {
  const curve = record(size.curve);
  const totals = list(curve.n_total);
  const highest = is_number(curve.limit) ? steepest_shown * curve.limit : Infinity;
  const points = totals
    .map((n, i) => [n, list(curve.t)[i]])
    .filter(([n, t]) => is_number(n) && is_number(t) && (t <= highest || n >= size.n_test + size.n_model));
  const range = [points[0][0], points[points.length - 1][0]];
  const here = [size.n_test + size.n_model, size.t_critical];
  const { cells, height } = layout(1, width, { columns_at_most: 1, aspect: 0.4, right: 26, top: 8 });
  const series = [
    { name: names.curve, type: "line", symbol: "none", color: model, lineStyle: { width: 2 }, data: points },
  ];
  if (is_number(curve.limit))
    series.push(level_series(names.limit, curve.limit, range, 0, { color: bound, type: "dashed" }));
  if (here.every(is_number)) {
    series.push({
      name: names.here,
      type: "scatter",
      symbol: "diamond",
      symbolSize: 15,
      color: accent,
      z: 5,
      data: [here],
      itemStyle: { borderColor: paper, borderWidth: 1.5 },
    });
  }
  const panels = [
    {
      x: {
        type: "log",
        scale: true,
        name: "Tests and samples together, n₁ + n₂",
        min: range[0],
        max: range[1],
        axisLabel: { formatter: (v) => count_text(v) },
      },
      y: { name: "T", nameGap: 40, axisLabel: { formatter: (v) => short_number(v, 3) } },
    },
  ];
  const option = {
    ...panel_frame(panels, cells),
    ...zooming(1),
    series,
    legend: legend(series, Object.values(names)),
    tooltip: {
      trigger: "item",
      formatter: ({ seriesName, value }) =>
        tooltip_box(seriesName, [`n₁ + n₂ = ${count_text(value[0])}`, `T = ${number_text(value[1])}`]),
    },
  };
  return { option, height };
}

function sentences(size) {
  const { n_test, n_model, t_critical } = size;
  const limit = record(size.curve).limit;
  const text = [];
  if (is_number(t_critical) && is_number(n_test) && is_number(n_model)) {
    text.push(
      `With ${count_text(n_test)} tests and ${count_text(n_model)} samples the means may lie up to ` +
        `T = ${number_text(t_critical)} apart, in standard errors of their difference over all outputs together, before they count as different` +
        `${is_number(size.alpha) ? ` at the ${short_number(100 * size.alpha)}\u00a0% level` : ""}.`,
    );
  }
  if (is_number(limit) && is_number(t_critical)) {
    text.push(
      `Infinitely many would bring this to ${number_text(limit)}, ${(100 * (1 - limit / t_critical)).toFixed(1)}\u00a0% lower: ` +
        "beyond that only more tests can make the comparison more powerful.",
    );
  }
  return text.length ? paragraph(text.join(" ")) : null;
}

function errors_table(study, errors) {
  const deviations = standard_deviations(study.outputs.test_covariance);
  const rows = study.output_axes.map(({ index, name, unit }) => {
    const error = errors[index];
    const std = deviations[index];
    return { name, unit, error, share: is_number(error) && std > 0 ? (100 * error) / std : null };
  });
  const share = {
    key: "share",
    title: "In % of the tests' std. dev.",
    text: (value) => (is_number(value) ? `${value.toFixed(2)} %` : "–"),
  };
  return data_table({
    id: "monte-carlo",
    title: "Monte-Carlo error of the cloud's mean outputs",
    rows,
    columns: [
      { key: "name", title: "Output", is_text: true },
      { key: "unit", title: "Unit", is_text: true },
      { key: "error", title: "Standard error" },
      ...(rows.some((row) => is_number(row.share)) ? [share] : []),
    ],
    caption:
      "Standard error of the mean of the last cloud, from its number of samples. It should be small against the scatter of the tests.",
  });
}

const has_curve = (size) => list(record(size.curve).n_total).length > 2;

export default {
  id: "sample-size",
  title: "Sample size",
  has_data(study) {
    const size = record(study.result.sample_size);
    return has_curve(size) || is_number(size.t_critical) || list(size.monte_carlo_error).some(is_number);
  },
  explained: [
    [
      "Critical value T",
      "The largest distance of the two means, in standard deviations of their difference, that chance alone explains. " +
        "Where the curve is flat, more samples do not help the test.",
    ],
    [
      "Monte-Carlo error",
      "How far the cloud's mean may be off because the cloud is finite; it falls with the square root of the samples.",
    ],
  ],
  content(study) {
    const size = record(study.result.sample_size);
    const errors = list(size.monte_carlo_error);
    return [
      sentences(size),
      has_curve(size)
        ? figure({
            id: "sample-size",
            title: "Critical value of Hotelling's statistic against sample size",
            caption: "T falls as samples are added and levels off at its limit; the diamond is this run.",
            build: (width) => build(size, width),
          })
        : null,
      errors.some(is_number) ? errors_table(study, errors) : null,
    ];
  },
};
