// Prior and updated density of every parameter, what the intervals leave open, and where the specimens lie.
import { extent, is_number } from "../src/data.js";
import { legend, legend_height, tooltip_box, zooming } from "../src/charts.js";
import { paragraph } from "../src/dom.js";
import { paged_figure } from "../src/figure.js";
import { name_with_unit, number_text, short_number } from "../src/format.js";
import { band_series, layout, line_series, panel_frame } from "../src/panels.js";
import { band, bound, model, muted, test } from "../src/palette.js";
import { answer_kind, has_curves, is_population, is_posterior, parameter_of } from "../src/population.js";

const printed_at_most = 6; // on two pages, with everything else
const id = "densities";
const panels_a_page = 9;
const names = {
  prior: "Prior",
  updated: "Updated",
  band: "Range within the 95 % intervals",
  specimens: "Estimate of a specimen",
  bounds: "Bound",
};

const peak_of = (points, which = 1) => extent(points.map((point) => point[which]))?.[1] ?? 0;

/** The highest density drawn: a band that goes further up, where the deviation may be near zero, is cut. */
function top_of({ prior, updated, band: strip }) {
  const curves = Math.max(peak_of(prior), peak_of(updated));
  return 1.12 * Math.max(curves, Math.min(peak_of(strip, 2), 1.9 * (peak_of(updated) || curves))) || 1;
}

function sideways(parameter, curves, top) {
  const shown = [...curves.prior, ...curves.updated].filter(([, y]) => y > 0.004 * top).map(([x]) => x);
  const strip = curves.band.filter(([, , high]) => high > 0.02 * top).map(([x]) => x);
  const range = extent([...shown, ...strip, ...parameter.specimens, parameter.mean]);
  if (!range) return {};
  const margin = 0.03 * (range[1] - range[0]) || 0.03 * Math.abs(range[0]) || 1;
  return { min: range[0] - margin, max: range[1] + margin };
}

function series_of(parameter, curves, top, limits, panel) {
  const upright = (x) => [
    [x, 0],
    [x, top],
  ];
  const marks = parameter.specimens.map((x, k) => [x, 0.035 * top, k]).filter(([x]) => is_number(x));
  const is_inside = (x) => x >= limits.min && x <= limits.max;
  return [
    curves.band.length ? band_series(names.band, curves.band, band, panel) : null,
    ...parameter.bounds
      .filter(is_inside)
      .map((x) => line_series(names.bounds, upright(x), panel, { color: bound, type: "dotted", width: 1.5 }, { z: 2 })),
    line_series(names.prior, curves.prior, panel, { color: muted, type: "dashed" }, { z: 3 }),
    line_series(
      names.updated,
      curves.updated.length || !is_number(parameter.mean) ? curves.updated : upright(parameter.mean),
      panel,
      { color: model },
      { z: 4 },
    ),
    {
      name: names.specimens,
      type: "scatter",
      xAxisIndex: panel,
      yAxisIndex: panel,
      symbol: "rect",
      symbolSize: [1.6, 11],
      z: 5,
      itemStyle: { color: test, opacity: 0.75 },
      data: marks,
    },
  ].filter(Boolean);
}

const interval_text = (interval) =>
  interval ? `, 95 %: ${number_text(interval[0], 3)} … ${number_text(interval[1], 3)}` : "";

function tooltip_lines(parameter, x, limits) {
  const near = parameter.specimens
    .map((value, k) => ({ k, value, gap: Math.abs(value - x) }))
    .filter(({ value, gap }) => is_number(value) && gap < 0.012 * (limits.max - limits.min))
    .sort((a, b) => a.gap - b.gap)
    .slice(0, 3);
  return [
    is_number(parameter.prior_mean)
      ? `Prior: mean ${number_text(parameter.prior_mean)}, standard deviation ${number_text(parameter.prior_std)}`
      : null,
    is_number(parameter.mean)
      ? `Updated mean: ${number_text(parameter.mean)}${interval_text(parameter.mean_ci95)}`
      : null,
    is_number(parameter.std)
      ? `Updated standard deviation: ${number_text(parameter.std)}${interval_text(parameter.std_ci95)}`
      : null,
    ...near.map(({ k, value }) => `Specimen ${parameter.specimen_numbers[k]}: ${number_text(value)}`),
  ].filter(Boolean);
}

function title_of(study, parameter) {
  const scale = parameter.scale === "identity" ? "" : `, ${parameter.scale} scale`;
  const has_intervals = Array.isArray(study.parameters.mean_ci95);
  const is_open = has_intervals && !parameter.mean_ci95 && !parameter.std_ci95 ? ", not determined" : "";
  return `${parameter.name}${scale}${is_open}`;
}

function build(study, parameters, width) {
  const { cells, height } = layout(parameters.length, width, {
    left: 58,
    legend_height: legend_height(Object.values(names), width),
  });
  const drawn = parameters.map((parameter) => {
    const { curves } = parameter;
    const top = top_of(curves);
    return { parameter, curves, top, limits: sideways(parameter, curves, top) };
  });
  const axis_label = { showMinLabel: false, showMaxLabel: false, formatter: (value) => short_number(value, 4) };
  const panels = drawn.map(({ parameter, top, limits }) => ({
    title: title_of(study, parameter),
    x: { name: name_with_unit(parameter), ...limits, axisLabel: { ...axis_label, hideOverlap: true, fontSize: 11 } },
    y: {
      name: "Density",
      nameGap: 40,
      min: 0,
      max: top,
      splitNumber: 3,
      axisLabel: { showMaxLabel: false, hideOverlap: true, fontSize: 11, formatter: (value) => short_number(value, 3) },
      splitLine: { show: false },
    },
  }));
  const series = drawn.flatMap(({ parameter, curves, top, limits }, panel) =>
    series_of(parameter, curves, top, limits, panel),
  );
  const option = {
    ...panel_frame(panels, cells),
    ...zooming(panels.length),
    series,
    legend: legend(series, Object.values(names)),
    tooltip: {
      trigger: "axis",
      formatter: (points) => {
        const { parameter, limits } = drawn[points[0].axisIndex];
        return tooltip_box(name_with_unit(parameter), tooltip_lines(parameter, points[0].axisValue, limits));
      },
    },
  };
  return { option, height };
}

function caption_of(study, parameters) {
  const has_band = parameters.some(({ mean_ci95, std_ci95 }) => mean_ci95 && std_ci95);
  const has_marks = parameters.some(({ specimens }) => specimens.some(is_number));
  return [
    "Dashed: the distribution that the study started from; solid: as updated.",
    has_band ? "The band contains the densities whose mean and standard deviation lie within their 95 % intervals." : null,
    parameters.some(({ scale }) => scale !== "identity") && !is_posterior(study)
      ? "Log or logit scale: the population is taken as normal there."
      : null,
    has_marks ? "Each tick at the foot is one specimen." : null,
    is_posterior(study) ? "Updated: the posterior's samples, each as a narrow normal curve." : null,
    is_population(study)
      ? null
      : "This method's standard deviation is not the scatter of the specimens: see the notes under the verdict.",
  ]
    .filter(Boolean)
    .join(" ");
}

const can_be_drawn = (study) =>
  study.parameter_axes
    .map((axis) => parameter_of(study, axis))
    .filter(({ mean, std }) => is_number(mean) && is_number(std));

/** Prior and updated density of every parameter, nine a page; in print the first six. */
export function densities_figure(study) {
  const parameters = can_be_drawn(study);
  if (!has_curves(study)) {
    return paragraph("This result holds no curves, since an earlier version wrote it: run the study again to see them.");
  }
  return paged_figure({
    id,
    title: "Prior and updated densities",
    caption: caption_of(study, parameters),
    items: parameters,
    size: panels_a_page,
    build: (shown, width, { is_summary } = {}) => build(study, is_summary ? shown.slice(0, printed_at_most) : shown, width),
  });
}

export default {
  id: "distributions",
  title: "Parameters: prior and updated distributions",
  is_in_print: (study) => answer_kind(study) === null && can_be_drawn(study).length <= printed_at_most,
  has_data: (study) => study.is_update && !["box", "posterior"].includes(answer_kind(study)) && can_be_drawn(study).length > 0,
  explained: [
    [
      "Updated density",
      "How the parameter scatters from specimen to specimen. Where the band is wide, the tests are too few to say more; where the curve " +
        "stands at the edge of the prior, the prior was wrong, or the model is.",
    ],
  ],
  content: (study) => [densities_figure(study)],
};
