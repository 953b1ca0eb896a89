// Distance between the means of cloud and tests, iteration by iteration, in both metrics.
import { history_of, has_history, is_number } from "../src/data.js";
import { redraw, tooltip_box, zooming } from "../src/charts.js";
import { checkbox } from "../src/dom.js";
import { figure } from "../src/figure.js";
import { number_text, short_number } from "../src/format.js";
import { layout, panel_frame } from "../src/panels.js";
import { bound, model } from "../src/palette.js";

const id = "distance";
const metrics = [
  { field: "distance_euclidean", title: "Euclidean distance", color: () => model, symbol: "circle" },
  { field: "distance_mahalanobis", title: "Mahalanobis distance", color: () => bound, symbol: "triangle" },
];

/** Unit of the Euclidean distance where all outputs share one. */
function common_unit(study) {
  const units = new Set(study.output_axes.map(({ unit }) => unit));
  return units.size === 1 ? [...units][0] : "";
}

function build(study, shown, is_logarithmic, width) {
  const { cells, height } = layout(shown.length, width, {
    minimum: 330,
    columns_at_most: 2,
    aspect: 0.55,
    legend_height: 4,
  });
  const unit = common_unit(study);
  const panels = shown.map(({ field, title }) => ({
    title: field === "distance_euclidean" && unit ? `${title} (${unit})` : title,
    x: { name: "Iteration", minInterval: 1, scale: false },
    y: is_logarithmic
      ? { type: "log", scale: true, axisLabel: { formatter: (value) => short_number(value, 2) } }
      : { scale: false, axisLabel: { formatter: (value) => short_number(value, 3) } },
  }));
  const drawable = (value) => (is_number(value) && (!is_logarithmic || value > 0) ? value : null);
  const option = {
    ...panel_frame(panels, cells),
    ...zooming(shown.length),
    tooltip: {
      trigger: "axis",
      formatter: ([point]) =>
        tooltip_box(`Iteration ${point.value[0]}`, [
          `${shown[point.axisIndex ?? point.seriesIndex].title}: ${number_text(point.value[1])}`,
        ]),
    },
    series: shown.map(({ field, title, color, symbol }, i) => ({
      name: title,
      type: "line",
      xAxisIndex: i,
      yAxisIndex: i,
      symbol,
      symbolSize: 7,
      color: color(),
      lineStyle: { width: 2 },
      data: history_of(study, field).map(([index, value]) => [index, drawable(value)]),
    })),
  };
  return { option, height };
}

export default {
  id: "convergence",
  title: "Convergence",
  has_data: (study) => metrics.some(({ field }) => has_history(study, field)),
  explained: [
    [
      "Distance of the means",
      "Between the mean of the model's cloud and that of the tests: Euclidean in the " +
        "outputs' unit, Mahalanobis in standard deviations. It should fall and level off; a level far above zero means that the " +
        "parameters cannot reach the tests.",
    ],
  ],
  content(study) {
    const shown = metrics.filter(({ field }) => has_history(study, field));
    let is_logarithmic = false;
    const toggle = checkbox(
      "Logarithmic axis",
      false,
      (checked) => {
        is_logarithmic = checked;
        redraw(id, { afresh: true });
      },
      { id: "distance-log" },
    );
    return [
      figure({
        id,
        title: "Distance between the means of cloud and tests",
        caption: "Distance of the mean outputs at each iteration; iteration 0 is the first cloud, drawn from the prior.",
        controls: [toggle],
        build: (width) => build(study, shown, is_logarithmic, width),
      }),
    ];
  },
};
