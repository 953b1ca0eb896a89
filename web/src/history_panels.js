// Small multiples of histories: one panel for each output or parameter, the iterations along x. Both history sections draw these.
import { legend, tooltip_box, zooming } from "./charts.js";
import { paged_figure } from "./figure.js";
import { name_with_unit, short_number } from "./format.js";
import { layout, panel_frame } from "./panels.js";

/** The history itself, on which the tooltip reports. */
export function history_line(name, data, panel, color) {
  return {
    name,
    type: "line",
    xAxisIndex: panel,
    yAxisIndex: panel,
    z: 3,
    symbol: "circle",
    symbolSize: 6,
    color,
    lineStyle: { width: 2 },
    data,
  };
}

function build({ names, main, series_of, lines_of }, study, axes, width) {
  const { cells, height } = layout(axes.length, width);
  const indices = study.iterations.map(({ index }) => index);
  const range = [indices[0], indices[indices.length - 1]];
  const panels = axes.map((axis) => ({
    title: name_with_unit(axis),
    x: { name: "Iteration", minInterval: 1, scale: false },
    y: { axisLabel: { formatter: (value) => short_number(value, 4) } },
  }));
  const series = axes.flatMap((axis, panel) => series_of(study, axis, panel, range));
  const option = {
    ...panel_frame(panels, cells),
    ...zooming(axes.length),
    series,
    legend: legend(series, Object.values(names)),
    tooltip: {
      trigger: "axis",
      formatter: (points) => {
        const point = points.find(({ seriesName }) => seriesName === main);
        if (!point) return "";
        const axis = axes[point.axisIndex];
        return tooltip_box(`${name_with_unit(axis)}, iteration ${point.value[0]}`, lines_of(study, axis, point.value));
      },
    },
  };
  return { option, height };
}

/**
 * The figure with nine panels a page.
 * @param names      of the series in the legend's order; `main` the one that the tooltip is about
 * @param axes       what gets a panel each
 * @param series_of  (study, axis, panel, [first, last iteration]) -> series
 * @param lines_of   (study, axis, [iteration, value]) -> lines of the tooltip
 */
export function history_figure(study, { id, title, caption, axes, ...drawing }) {
  return paged_figure({
    id,
    title,
    caption,
    items: axes,
    size: 9,
    build: (shown, width) => build(drawing, study, shown, width),
  });
}
