// Means and deviations of the parameters, iteration by iteration, within their bounds.
import { has_history, has_numbers, history_of, is_number, list } from "../src/data.js";
import { legend, redraw, tooltip_box, zooming } from "../src/charts.js";
import { figure, pager } from "../src/figure.js";
import { name_with_unit, number_text, short_number } from "../src/format.js";
import { band_series, layout, level_series, pages_of, panel_frame } from "../src/panels.js";
import { band, bound, model } from "../src/palette.js";

const id = "parameter-history";
const names = { mean: "Mean", band: "Mean ± 2 standard deviations", bound: "Bound" };

function panel_series(study, axis, panel, range) {
  const means = history_of(study, "parameter_mean", axis.index);
  const deviations = history_of(study, "parameter_std", axis.index);
  const strip = means
    .map(([index, mean], k) => [index, mean - 2 * deviations[k][1], mean + 2 * deviations[k][1]])
    .filter((_, k) => is_number(means[k][1]) && is_number(deviations[k][1]));
  const bounds = list(list(study.parameters.bounds)[axis.index]).filter(is_number);
  return [
    strip.length ? band_series(names.band, strip, band, panel) : null,
    ...bounds.map((value) => level_series(names.bound, value, range, panel, { color: bound, type: "dotted" })),
    {
      name: names.mean,
      type: "line",
      xAxisIndex: panel,
      yAxisIndex: panel,
      z: 3,
      symbol: "circle",
      symbolSize: 6,
      color: model,
      lineStyle: { width: 2 },
      data: means,
    },
  ].filter(Boolean);
}

function build(study, axes, width) {
  const { cells, height } = layout(axes.length, width);
  const indices = study.iterations.map(({ index }) => index);
  const range = [indices[0], indices[indices.length - 1]];
  const panels = axes.map((axis) => ({
    title: name_with_unit(axis),
    x: { name: "Iteration", minInterval: 1, scale: false },
    y: { axisLabel: { formatter: (value) => short_number(value, 4) } },
  }));
  const series = axes.flatMap((axis, panel) => panel_series(study, axis, panel, range));
  const option = {
    ...panel_frame(panels, cells),
    ...zooming(axes.length),
    series,
    legend: legend(series, Object.values(names)),
    tooltip: {
      trigger: "axis",
      formatter: (points) => {
        const point = points.find(({ seriesName }) => seriesName === names.mean);
        if (!point) return "";
        const axis = axes[point.axisIndex];
        const deviation = history_of(study, "parameter_std", axis.index).find(([index]) => index === point.value[0]);
        return tooltip_box(`${name_with_unit(axis)}, iteration ${point.value[0]}`, [
          `Mean: ${number_text(point.value[1])}`,
          `Standard deviation: ${number_text(deviation?.[1])}`,
        ]);
      },
    },
  };
  return { option, height };
}

export default {
  id: "parameter-convergence",
  title: "Parameters by iteration",
  has_data: (study) => has_history(study, "parameter_mean") && study.iterations.length > 1,
  explained: [
    ["Parameters by iteration", "A mean that comes to rest on a dotted bound has not been found: it was stopped."],
  ],
  content(study) {
    const pages = pages_of(study.parameter_axes, 9);
    let shown = pages.page(0);
    const controls = pager({
      ...pages,
      show: (k) => {
        shown = pages.page(k);
        redraw(id, { afresh: true });
      },
    });
    return [
      figure({
        id,
        title: "Means and deviations of the parameters",
        controls,
        caption:
          "Mean of each parameter at each iteration with a band of two standard deviations either side" +
          (list(study.parameters.bounds).some(has_numbers) ? "; dotted: bounds." : "."),
        build: (width) => build(study, shown, width),
      }),
    ];
  },
};
