// Ellipses of pairs of parameters with what their correlation's interval leaves open, and the specimens' points.
import { extent, is_number } from "./data.js";
import { legend, legend_height, tooltip_box, zooming } from "./charts.js";
import { pairs_of } from "./cloud_panels.js";
import { name_with_unit, number_text, short_number } from "./format.js";
import { signed } from "./matrix_map.js";
import { layout, line_series, panel_frame } from "./panels.js";
import { model, paper, test } from "./palette.js";
import { correlation_pair } from "./population.js";

const names = {
  region: "Updated, 2σ ellipse",
  ends: "At the ends of the correlation's 95 % interval",
  specimens: "Estimate of a specimen",
};

export const correlation_interval_text = (interval) =>
  interval ? `${signed(interval[0])} … ${signed(interval[1])}` : "–";

/** What one panel shows of a pair: curves and points, each null or empty where it is not known. */
function drawing_of(study, { x, y }) {
  const { first, second, correlation, interval, region, ends } = correlation_pair(study, x, y);
  return {
    pair: { x, y },
    correlation,
    interval,
    region,
    ends,
    points: first.specimens
      .map((value, k) => [value, second.specimens[k], first.specimen_numbers[k]])
      .filter(([a, b]) => is_number(a) && is_number(b)),
  };
}

function limits_of({ region, ends, points }, which) {
  const range = extent([...region.flat(), ...ends.flat(), ...points].map((point) => point[which]));
  if (!range) return {};
  const margin = 0.06 * (range[1] - range[0]) || 0.03 * Math.abs(range[0]) || 1;
  return { min: range[0] - margin, max: range[1] + margin };
}

function series_of({ region, ends, points }, panel) {
  return [
    ...ends.map((data) => line_series(names.ends, data, panel, { color: model, width: 1, opacity: 0.75, type: [3, 3] }, { z: 2, silent: true })),
    ...region.map((data) => line_series(names.region, data, panel, { color: model }, { z: 3, silent: true })),
    {
      name: names.specimens,
      type: "scatter",
      xAxisIndex: panel,
      yAxisIndex: panel,
      symbol: "diamond",
      symbolSize: points.length > 40 ? 7 : 10,
      z: 4,
      itemStyle: { color: test, borderColor: paper, borderWidth: 0.8 },
      data: points,
    },
  ];
}

const panel_title = ({ correlation, interval }) =>
  is_number(correlation) && interval
    ? `${signed(correlation)}, 95 %: ${correlation_interval_text(interval)}`
    : is_number(correlation)
      ? `${signed(correlation)}, no interval`
      : "not determined";

/** One panel for every pair of `axes`. */
export function ellipse_panels(study, axes, width) {
  const drawings = pairs_of(axes).map((pair) => drawing_of(study, pair));
  const shown = Object.values(names);
  const { cells, height } = layout(drawings.length, width, {
    aspect: 0.8,
    legend_height: legend_height(shown, width),
  });
  const axis_label = {
    showMinLabel: false,
    showMaxLabel: false,
    hideOverlap: true,
    fontSize: 11,
    formatter: (value) => short_number(value, 4),
  };
  const panels = drawings.map((drawing) => ({
    title: panel_title(drawing),
    x: { name: name_with_unit(drawing.pair.x), ...limits_of(drawing, 0), axisLabel: axis_label },
    y: { name: name_with_unit(drawing.pair.y), nameGap: 46, ...limits_of(drawing, 1), axisLabel: axis_label },
  }));
  const series = drawings.flatMap(series_of);
  const option = {
    ...panel_frame(panels, cells),
    ...zooming(panels.length),
    series,
    legend: legend(series, shown),
    tooltip: {
      trigger: "item",
      formatter: ({ value, seriesIndex }) => {
        const { x, y } = drawings[series[seriesIndex].xAxisIndex].pair;
        return tooltip_box(`Specimen ${value[2]}`, [
          `${name_with_unit(x)}: ${number_text(value[0])}`,
          `${name_with_unit(y)}: ${number_text(value[1])}`,
        ]);
      },
    },
  };
  return { option, height };
}
