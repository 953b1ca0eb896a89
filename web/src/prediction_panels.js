// Drawings of a prediction: intervals of the outputs with the held-out tests on them, and histograms of their transforms.
import { extent, is_number, list, record } from "./data.js";
import { tooltip_box, zooming } from "./charts.js";
import { name_with_unit, number_text, p_value_text, plural, short_number } from "./format.js";
import { row_bars, row_label, row_marks, rows_axes, rows_grid, value_and_deviation } from "./output_rows.js";
import { band_series, layout, panel_frame } from "./panels.js";
import { bound, model, muted, test, test_band } from "./palette.js";

const level = 0.95;
/** Transforms of the held-out tests that have the output; `pit` also holds null. */
export const tested = ({ pit }) => pit.filter(is_number);

/** Where a held-out test lies, as a standard normal number, kept within ±4. */
const place_of = (score) => Math.max(-4, Math.min(4, score));
const is_outside = (pit) => pit < (1 - level) / 2 || pit > (1 + level) / 2;

/** One bar an output, in predicted deviations, and the held-out tests on it. */
export function interval_bars(outputs, width) {
  const labels = outputs.map((output) =>
    row_label(output, is_number(output.mean) ? value_and_deviation(output.mean, output.std) : "", width),
  );
  const grid = rows_grid(labels, width, 14);
  const points = (wanted) =>
    outputs.flatMap(({ pit, scores }, row) =>
      pit.flatMap((value, specimen) =>
        is_number(value) && is_number(scores[specimen]) && is_outside(value) === wanted
          ? [[place_of(scores[specimen]), row, specimen, value]]
          : [],
      ),
    );
  const bars = outputs.map(({ interval, mean, std }, row) => {
    const ends = interval && std > 0 ? interval.map((end) => (end - mean) / std) : null;
    return ends ? [ends[0], row, ends[1]] : [null, row, null];
  });
  const all = [...points(false), ...points(true)].map(([x]) => x);
  const reach = Math.max(3, ...extent([...all, ...bars.flatMap(([a, , b]) => [a, b])]).map(Math.abs)) * 1.05;
  const option = {
    grid: [grid],
    ...rows_axes(
      labels,
      grid,
      width < 560 ? "Predicted std. dev. from the mean" : "Predicted standard deviations from the predicted mean",
      reach,
    ),
    ...zooming(1),
    tooltip: {
      trigger: "item",
      formatter: ({ value }) => {
        const output = outputs[value[1]];
        return value.length === 4
          ? tooltip_box(name_with_unit(output), [
              `Held-out test ${value[2] + 1}`,
              `Probability integral transform ${number_text(value[3], 3)}`,
            ])
          : tooltip_box(name_with_unit(output), [
              `Mean ${number_text(output.mean, 5)}, standard deviation ${number_text(output.std)}`,
              output.interval
                ? `95 %: ${number_text(output.interval[0], 5)} … ${number_text(output.interval[1], 5)}`
                : "",
            ]);
      },
    },
    series: [
      row_bars("95 % interval", bars, { fill: model, opacity: 0.28 }, 0.3, 2),
      row_marks("Held-out test", points(false), test, "diamond"),
      row_marks("Held-out test outside", points(true), bound, "triangle"),
    ],
  };
  return { option, height: grid.top + grid.height + 52 };
}

export const has_histogram = ({ histogram }) => list(record(histogram).counts).length > 0;

function read_histogram(output) {
  const { counts, expected_range } = output.histogram;
  return { counts, bins: counts.length, total: tested(output).length, range: list(expected_range) };
}

/** One histogram an output, with the range that an even spread gives. */
export function pit_histograms(outputs, width) {
  const { cells, height } = layout(outputs.length, width, { aspect: 0.5, legend_height: 6 });
  const drawn = outputs.map((output) => ({ output, ...read_histogram(output) }));
  const panels = drawn.map(({ output, counts, range }) => ({
    title: is_number(output.uniformity_p)
      ? `${output.name}, p ${p_value_text(output.uniformity_p).replace(/^(?!<)/, "= ")}`
      : output.name,
    x: {
      name: "Probability integral transform",
      min: 0,
      max: 1,
      interval: 0.25,
      axisLabel: { fontSize: 11, formatter: (value) => short_number(value, 2) },
    },
    y: {
      name: "Tests",
      min: 0,
      max: Math.max(...counts, range[1]) * 1.15,
      minInterval: 1,
      axisLabel: { fontSize: 11, showMaxLabel: false, formatter: (value) => short_number(value, 3) },
    },
  }));
  const series = drawn.flatMap(({ counts, bins, range }, panel) => [
    band_series(
      "Expected, 95 % of bins",
      [
        [0, ...range],
        [1, ...range],
      ],
      test_band,
      panel,
    ),
    {
      name: "Held-out tests",
      type: "custom",
      xAxisIndex: panel,
      yAxisIndex: panel,
      clip: true,
      z: 2,
      data: counts.map((count, k) => [(k + 0.5) / bins, count, k]),
      encode: { x: 0, y: 1 },
      itemStyle: { color: model },
      renderItem: (params, api) => {
        const [x0, top] = api.coord([api.value(2) / bins, api.value(1)]);
        const [x1, foot] = api.coord([(api.value(2) + 1) / bins, 0]);
        return {
          type: "rect",
          shape: { x: x0 + 0.5, y: top, width: x1 - x0 - 1, height: foot - top },
          style: { fill: model, opacity: 0.75 },
        };
      },
    },
    {
      name: "Expected",
      type: "line",
      xAxisIndex: panel,
      yAxisIndex: panel,
      symbol: "none",
      silent: true,
      z: 3,
      lineStyle: { color: muted, width: 1.5, type: "dashed" },
      itemStyle: { color: muted },
      data: [
        [0, drawn[panel].total / bins],
        [1, drawn[panel].total / bins],
      ],
    },
  ]);
  const option = {
    ...panel_frame(panels, cells),
    ...zooming(panels.length),
    series,
    tooltip: {
      trigger: "item",
      formatter: ({ value, seriesIndex }) => {
        const { output, bins, range } = drawn[series[seriesIndex].xAxisIndex];
        return tooltip_box(output.name, [
          `${short_number(value[2] / bins, 2)} to ${short_number((value[2] + 1) / bins, 2)}: ${plural(value[1], "test")}`,
          `Expected: ${range[0]} to ${range[1]}`,
        ]);
      },
    },
  };
  return { option, height };
}
