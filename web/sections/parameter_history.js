// Means and deviations of the parameters, iteration by iteration, within their bounds.
import { has_history, has_numbers, history_of, is_number, list } from "../src/data.js";
import { number_text } from "../src/format.js";
import { history_figure, history_line } from "../src/history_panels.js";
import { band_series, level_series } from "../src/panels.js";
import { band, bound, model } from "../src/palette.js";

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
    history_line(names.mean, means, panel, model),
  ].filter(Boolean);
}

function tooltip_lines(study, axis, [iteration, value]) {
  const deviation = history_of(study, "parameter_std", axis.index).find(([index]) => index === iteration);
  return [`Mean: ${number_text(value)}`, `Standard deviation: ${number_text(deviation?.[1])}`];
}

export default {
  id: "parameter-convergence",
  title: "Parameters by iteration",
  has_data: (study) => has_history(study, "parameter_mean"),
  explained: [
    ["Parameters by iteration", "A mean that stays on a dotted bound has not been found: the bound stopped it."],
  ],
  content(study) {
    return [
      history_figure(study, {
        id: "parameter-history",
        title: "Means and standard deviations of the parameters",
        caption:
          "Mean of each parameter at each iteration with a band of two standard deviations either side" +
          (list(study.parameters.bounds).some(has_numbers) ? "; dotted: bounds." : "."),
        axes: study.parameter_axes,
        names,
        main: names.mean,
        series_of: panel_series,
        lines_of: tooltip_lines,
      }),
    ];
  },
};
