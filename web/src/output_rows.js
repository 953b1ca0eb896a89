// One row an output: bars from one value to another, specimens on them, and the axes; shared by predictions, posteriors and boxes.
import { axis, legend, legend_height, tooltip_box, zooming } from "./charts.js";
import { extent, is_number } from "./data.js";
import { fit_in, name_with_unit, number_text, short_number } from "./format.js";
import { band, bound, ink, model, muted, paper, test } from "./palette.js";

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

const far = 4; // specimens beyond are drawn there

/** In what the bars are drawn: halves of the wide bar from its median. */
function in_halves({ test: ends, median }) {
  const half = (ends[1] - ends[0]) / 2 || 1;
  return (value) => (value - median) / half;
}

const ends_text = (ends) => (ends ? `${number_text(ends[0], 5)} … ${number_text(ends[1], 5)}` : "–");

/**
 * @param outputs  {name, unit, test: [low, high] of the wide bar, model: the same of the narrow one, median, specimens, numbers?}
 * @param words    {names: {test, model, inside, outside} of the legend, axis, short_axis, tooltip: {test, model},
 *                 inside: the bar, "test" or "model", that specimens are to lie in}
 */
export function output_bars(outputs, words, width) {
  const { names } = words;
  const labels = outputs.map((output) => row_label(output, number_text(output.median, 5), width));
  const shown = Object.values(names);
  const grid = rows_grid(labels, width, legend_height(shown, width));
  const place = outputs.map(in_halves);
  const bar = (key) =>
    outputs.map((output, row) => (output[key] ? [place[row](output[key][0]), row, place[row](output[key][1])] : [null, row, null]));
  const points = outputs.flatMap(({ specimens }, row) =>
    specimens.flatMap((value, k) =>
      is_number(value) ? [[Math.max(-far, Math.min(far, place[row](value))), row, k, value]] : [],
    ),
  );
  const is_inside = ([, row, , value]) => value >= outputs[row][words.inside][0] && value <= outputs[row][words.inside][1];
  const series = [
    row_bars(names.test, bar("test"), { fill: band }, 0.3, 1),
    row_bars(names.model, bar("model"), { fill: model }, 0.12, 2),
    row_marks(names.inside, points.filter(is_inside), test, "diamond"),
    row_marks(names.outside, points.filter((point) => !is_inside(point)), bound, "triangle"),
  ];
  const reach = 1.05 * Math.max(1.5, ...extent([...points.map(([x]) => x), ...bar("model").flatMap(([a, , b]) => [a, b]), -1, 1]).map(Math.abs));
  const option = {
    grid: [grid],
    ...rows_axes(labels, grid, width < 560 ? words.short_axis : words.axis, reach),
    ...zooming(1),
    series,
    legend: legend(series, shown),
    tooltip: {
      trigger: "item",
      formatter: ({ value }) => {
        const output = outputs[value[1]];
        return value.length === 4
          ? tooltip_box(name_with_unit(output), [`Specimen ${output.numbers?.[value[2]] ?? value[2] + 1}: ${number_text(value[3], 5)}`])
          : tooltip_box(name_with_unit(output), [
              `${words.tooltip.test}: ${ends_text(output.test)}`,
              `${words.tooltip.model}: ${ends_text(output.model)}`,
            ]);
      },
    },
  };
  return { option, height: grid.top + grid.height + 52 };
}
