// Mean outputs of the cloud, iteration by iteration, against the tests' means.
import { has_history, history_of, is_number, list } from "../src/data.js";
import { number_text } from "../src/format.js";
import { history_figure, history_line } from "../src/history_panels.js";
import { band_series, level_series } from "../src/panels.js";
import { model, test, test_band } from "../src/palette.js";

const names = {
  model: "Mean of the model's cloud",
  test: "Mean of the tests",
  band: "± 2 standard errors of that mean",
};

function test_mean_of(study, output) {
  const mean = list(study.outputs.test_mean)[output];
  const standard_error = list(study.outputs.test_mean_standard_error)[output];
  return is_number(mean) ? { mean, error: is_number(standard_error) ? 2 * standard_error : null } : null;
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
  series.push(history_line(names.model, history_of(study, "output_mean", axis.index), panel, model));
  return series;
}

function tooltip_lines(study, axis, [, value]) {
  const target = test_mean_of(study, axis.index);
  return [`Model: ${number_text(value, 5)}`, target ? `Tests: ${number_text(target.mean, 5)}` : null].filter(Boolean);
}

export default {
  id: "output-convergence",
  title: "Mean outputs by iteration",
  has_data: (study) => has_history(study, "output_mean"),
  explained: [
    [
      "Mean outputs",
      "Each panel shows one output: the cloud's mean should converge to a value inside the grey strip, within " +
        "which the mean of the tests is known.",
    ],
  ],
  content(study) {
    return [
      history_figure(study, {
        id: "output-history",
        title: "Mean outputs of the cloud against the tests",
        caption:
          "Mean of the model's cloud at each iteration" +
          (list(study.outputs.test_mean).some(is_number)
            ? "; dashed: mean of the tests, with twice its standard error as a strip."
            : "."),
        axes: study.output_axes,
        names,
        main: names.model,
        series_of: panel_series,
        lines_of: tooltip_lines,
      }),
    ];
  },
};
