// Mean outputs of the cloud, iteration by iteration, against the tests' means.
import { has_history, history_of, is_number, list, standard_deviations } from "../src/data.js";
import { legend, redraw, tooltip_box, zooming } from "../src/charts.js";
import { figure, pager } from "../src/figure.js";
import { name_with_unit, number_text, short_number } from "../src/format.js";
import { band_series, layout, level_series, pages_of, panel_frame } from "../src/panels.js";
import { model, test, test_band } from "../src/palette.js";

const id = "output-history";
const names = {
  model: "Mean of the model's cloud",
  test: "Mean of the tests",
  band: "± 2 standard errors of that mean",
};

function test_mean_of(study, output) {
  const mean = list(study.outputs.test_mean)[output];
  const std = standard_deviations(study.outputs.test_covariance)[output];
  const count = list(study.outputs.test_count)[output];
  const error = is_number(std) && count > 0 ? (2 * std) / Math.sqrt(count) : null;
  return is_number(mean) ? { mean, error } : null;
}

function panel_series(study, axis, panel, range) {
  const target = test_mean_of(study, axis.index);
  const series = [];
  if (target && is_number(target.error)) {
    const [low, high] = [target.mean - target.error, target.mean + target.error];
    series.push(
      band_series(
        names.band,
        range.map((x) => [x, low, high]),
        test_band,
        panel,
      ),
    );
  }
  if (target) series.push(level_series(names.test, target.mean, range, panel, { color: test, type: "dashed" }));
  series.push({
    name: names.model,
    type: "line",
    xAxisIndex: panel,
    yAxisIndex: panel,
    z: 3,
    symbol: "circle",
    symbolSize: 6,
    color: model,
    lineStyle: { width: 2 },
    data: history_of(study, "output_mean", axis.index),
  });
  return series;
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
        const point = points.find(({ seriesName }) => seriesName === names.model);
        if (!point) return "";
        const axis = axes[point.axisIndex];
        const target = test_mean_of(study, axis.index);
        return tooltip_box(
          `${name_with_unit(axis)}, iteration ${point.value[0]}`,
          [`Model: ${number_text(point.value[1], 5)}`, target ? `Tests: ${number_text(target.mean, 5)}` : null].filter(
            Boolean,
          ),
        );
      },
    },
  };
  return { option, height };
}

export default {
  id: "output-convergence",
  title: "Mean outputs by iteration",
  has_data: (study) => has_history(study, "output_mean") && study.iterations.length > 1,
  explained: [
    [
      "Mean outputs",
      "Each panel shows one output: the cloud's mean should come to rest inside the grey strip, within " +
        "which the tests know their own mean.",
    ],
  ],
  content(study) {
    const pages = pages_of(study.output_axes, 9);
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
        title: "Mean outputs of the cloud against the tests",
        controls,
        caption:
          "Mean of the model's cloud at each iteration" +
          (list(study.outputs.test_mean).some(is_number)
            ? "; dashed: mean of the tests, with twice its standard error as a strip."
            : "."),
        build: (width) => build(study, shown, width),
      }),
    ];
  },
};
