// Small multiples inside one chart: where each panel lies, and the pieces that every panel needs.
import { axis } from "./charts.js";
import { ink } from "./palette.js";

/**
 * Cells for `count` panels in a chart of the given width.
 * `aspect` is height over width of the drawing area; `legend_height` is kept free above the first row.
 */
export function layout(
  count,
  width,
  {
    minimum = 215,
    columns_at_most = 3,
    aspect = 0.62,
    legend_height = 34,
    left = 62,
    right = 14,
    top = 26,
    bottom = 44,
  } = {},
) {
  const columns = Math.max(1, Math.min(count, columns_at_most, Math.floor(width / minimum)));
  const rows = Math.ceil(count / columns);
  const cell_width = width / columns;
  const inner_width = Math.max(80, cell_width - left - right);
  const inner_height = Math.round(Math.min(inner_width * aspect, 340));
  const cell_height = inner_height + top + bottom;
  const cells = Array.from({ length: count }, (_, i) => ({
    left: Math.round((i % columns) * cell_width + left),
    top: Math.round(legend_height + Math.floor(i / columns) * cell_height + top),
    width: Math.round(inner_width),
    height: inner_height,
  }));
  return { columns, rows, cells, height: legend_height + rows * cell_height };
}

/** The option's grid, axes and panel titles; panel = {title, x, y} with x, y axis options. */
export function panel_frame(panels, cells) {
  return {
    grid: cells.map((cell) => ({ ...cell, outerBoundsMode: "none" })),
    xAxis: panels.map((panel, i) =>
      axis({ gridIndex: i, nameGap: 26, nameTruncate: { maxWidth: cells[i].width }, ...panel.x }),
    ),
    yAxis: panels.map((panel, i) =>
      axis({ gridIndex: i, nameGap: 44, nameTruncate: { maxWidth: cells[i].height }, ...panel.y }),
    ),
    title: panels.map((panel, i) => ({
      text: panel.title ?? "",
      left: cells[i].left,
      top: cells[i].top - 22,
      padding: 0,
      textStyle: { fontSize: 12, fontWeight: 600, color: ink, overflow: "truncate", width: cells[i].width },
    })),
  };
}

/** Band between two histories [[x, low, high], ...] as one filled polygon. */
export function band_series(name, points, color, panel) {
  const known = points.filter((point) => point.every(Number.isFinite));
  return {
    name,
    type: "custom",
    xAxisIndex: panel,
    yAxisIndex: panel,
    silent: true,
    clip: true,
    z: 1,
    data: known,
    encode: { x: 0, y: [1, 2] },
    itemStyle: { color },
    renderItem: (params, api) => {
      if (params.dataIndex !== 0) return null;
      const upper = known.map(([x, , high]) => api.coord([x, high]));
      const lower = known.map(([x, low]) => api.coord([x, low])).reverse();
      return { type: "polygon", shape: { points: [...upper, ...lower] }, style: { fill: color } };
    },
  };
}

/** A line without symbols through points of a panel; `more` is of the series. */
export function line_series(name, data, panel, line_style, more = {}) {
  return {
    name,
    type: "line",
    xAxisIndex: panel,
    yAxisIndex: panel,
    symbol: "none",
    data,
    lineStyle: { width: 2, ...line_style },
    itemStyle: { color: line_style.color },
    ...more,
  };
}

/** A level across the whole panel, drawn as a line of two points so that it counts for the axis. */
export function level_series(name, value, [from, to], panel, line_style) {
  const ends = [
    [from, value],
    [to, value],
  ];
  return line_series(name, ends, panel, { width: 1.5, ...line_style }, { z: 2, silent: true });
}
