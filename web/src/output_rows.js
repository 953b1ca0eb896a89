// One row an output: bars from one value to another, specimens on them, and the axes; shared by predictions and posteriors.
import { axis } from "./charts.js";
import { fit_in, number_text, short_number } from "./format.js";
import { ink, muted, paper } from "./palette.js";

export const row_height = 28;

/** "f1: 0.1600 ± 0.012 Hz", or the name alone where there is no room or no value. */
export function row_label({ name, unit }, values, width) {
  return width < 620 || !values ? name : `${name}: ${values} ${unit}`.trim();
}

/** Mean or median of a row's label, with its deviation. */
export const value_and_deviation = (value, deviation) => `${number_text(value, 4)} ± ${number_text(deviation, 2)}`;

/** Room for the labels, and the rows below `top`. */
export function rows_grid(labels, width, top) {
  const left = Math.min(width * 0.4, 24 + 7 * Math.max(...labels.map((text) => text.length)));
  return { left, right: 16, top, height: labels.length * row_height, outerBoundsMode: "none" };
}

/** A value axis symmetric about 0, and an axis with a label for each row. */
export function rows_axes(labels, { left }, name, reach) {
  return {
    xAxis: axis({
      name,
      nameGap: 28,
      min: -reach,
      max: reach,
      axisLabel: { showMinLabel: false, showMaxLabel: false, formatter: (value) => short_number(value, 2) },
    }),
    yAxis: axis({
      type: "category",
      inverse: true,
      data: labels,
      splitLine: { show: false },
      axisTick: { show: false },
      axisLine: { show: true, onZero: true, lineStyle: { color: muted } },
      axisLabel: { color: ink, fontSize: 12, interval: 0, formatter: fit_in(left - 12) },
    }),
  };
}

/** Specimens: [place, row, ...]. */
export function row_marks(name, data, color, symbol) {
  return {
    name,
    type: "scatter",
    symbol,
    symbolSize: data.length > 300 ? 6 : 8,
    z: 4,
    itemStyle: { color, borderColor: paper, borderWidth: 0.6, opacity: 0.85 },
    data,
  };
}

/** Bars: [from, row, to], null where there is none; `share` of a row's height to either side. */
export function row_bars(name, rows, style, share, z) {
  return {
    name,
    type: "custom",
    clip: true,
    z,
    data: rows,
    encode: { x: [0, 2], y: 1 },
    itemStyle: { color: style.fill, opacity: style.opacity ?? 1 },
    renderItem: (params, api) => {
      if (!Number.isFinite(api.value(0))) return null;
      const [x0, y] = api.coord([api.value(0), api.value(1)]);
      const [x1] = api.coord([api.value(2), api.value(1)]);
      const shape = { x: x0, y: y - row_height * share, width: Math.max(x1 - x0, 1.5), height: row_height * 2 * share };
      return { type: "rect", shape, style };
    },
  };
}
