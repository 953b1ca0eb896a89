// The posterior by pairs of parameters: its draws and regions with the prior's draws behind them; on a wide page as a matrix with
// the marginal densities on its diagonal.
import { extent, is_number } from "./data.js";
import { legend, legend_height, tooltip_box, zooming } from "./charts.js";
import { pairs_of } from "./cloud_panels.js";
import { name_with_unit, number_text, short_number } from "./format.js";
import { signed } from "./matrix_map.js";
import { layout, line_series, panel_frame } from "./panels.js";
import { model, model_points, muted } from "./palette.js";
import { correlation_pair, parameter_of } from "./population.js";

const matrix_from = 620; // px
const names = {
  prior: "Prior, draws",
  draws: "Posterior, draws",
  region: "Posterior, region of its draws",
  prior_density: "Prior, density",
  density: "Posterior, density",
};

/** Limits of a parameter: about its posterior, so that a wide prior does not make it a point. */
function limits_of(parameter, draws, regions) {
  const range = extent([
    ...draws.map((row) => row[parameter.index]),
    ...regions.flatMap(({ x, y, region }) =>
      region.flat().flatMap(([a, b]) => (x.index === parameter.index ? [a] : y.index === parameter.index ? [b] : [])),
    ),
  ]);
  if (!range) return {};
  const margin = 0.25 * (range[1] - range[0]) || 0.03 * Math.abs(range[0]) || 1;
  return { min: range[0] - margin, max: range[1] + margin };
}

const is_within = ({ min, max }, value) => is_number(value) && value >= min && value <= max;

function points_series(name, rows, { x, y }, limits, panel, style) {
  const data = rows
    .map((row) => [row[x.index], row[y.index]])
    .filter(([a, b]) => is_within(limits.get(x), a) && is_within(limits.get(y), b));
  return { name, type: "scatter", xAxisIndex: panel, yAxisIndex: panel, symbol: "circle", silent: true, data, ...style };
}

function pair_series(pair, clouds, limits, panel) {
  return [
    points_series(names.prior, clouds.prior, pair, limits, panel, { z: 1, symbolSize: 4, itemStyle: { color: muted, opacity: 0.35 } }),
    points_series(names.draws, clouds.draws, pair, limits, panel, { z: 2, symbolSize: 4, itemStyle: { color: model_points, opacity: 0.5 } }),
    ...pair.region.map((data) => line_series(names.region, data, panel, { color: model }, { z: 3, silent: true })),
  ];
}

const density_series = ({ curves }, panel) => [
  line_series(names.prior_density, curves.prior, panel, { color: muted, type: "dashed" }, { z: 2, silent: true }),
  line_series(names.density, curves.updated, panel, { color: model }, { z: 3, silent: true }),
];

const ticks = { show: true, showMinLabel: false, showMaxLabel: false, hideOverlap: true, fontSize: 11, formatter: (value) => short_number(value, 4) };
const bare = { axisLabel: { show: false }, axisTick: { show: false }, splitLine: { show: false } };
const title_of = ({ correlation }) => (is_number(correlation) ? `correlation ${signed(correlation)}` : "");

/** The lower triangle, row by row: a density on the diagonal, pairs left of it. */
function entries_of(axes, pairs, parameters) {
  return axes.flatMap((y, row) =>
    axes.slice(0, row + 1).map((x, column) => ({
      x,
      y,
      row,
      column,
      pair: row === column ? null : pairs.find((one) => one.x === x && one.y === y),
      parameter: row === column ? parameters.get(x) : null,
    })),
  );
}

/** A matrix whose axes are named at the left and at the foot. */
function matrix_of(entries, size, limits, width, top) {
  const [left, gap, foot, head] = [66, 12, 44, 34];
  const side = Math.floor((width - left - 14 - gap * (size - 1)) / size);
  const row_height = Math.round(Math.min(side * 0.8, 240));
  const unnamed = { ...bare, axisTick: { show: true } };
  const panels = entries.map(({ x, y, row, column, pair }) => ({
    title: pair ? title_of(pair) : name_with_unit(x),
    x: { ...limits.get(x), ...(row === size - 1 ? { name: name_with_unit(x), axisLabel: ticks } : unnamed) },
    y: pair
      ? { ...limits.get(y), ...(column === 0 ? { name: name_with_unit(y), nameGap: 50, axisLabel: ticks } : unnamed) }
      : { min: 0, ...bare, axisLine: { show: false } },
  }));
  const cells = entries.map(({ row, column }) => ({
    left: left + column * (side + gap),
    top: top + head + row * (row_height + head + 6),
    width: side,
    height: row_height,
  }));
  return { panels, cells, height: top + size * (row_height + head + 6) + foot };
}

/** One below the other, each with names on its own axes. */
function list_of(entries, limits, width, top) {
  const { cells, height } = layout(entries.length, width, { aspect: 0.7, legend_height: top });
  const panels = entries.map(({ x, y, pair }) => ({
    title: pair ? title_of(pair) : name_with_unit(x),
    x: { name: name_with_unit(x), ...limits.get(x), axisLabel: ticks },
    y: pair
      ? { name: name_with_unit(y), nameGap: 46, ...limits.get(y), axisLabel: ticks }
      : { min: 0, ...bare, axisLine: { show: false } },
  }));
  return { panels, cells, height };
}

/** @param clouds  {prior, draws}: rows of parameters */
export function pair_plot(study, axes, clouds, width) {
  const parameters = new Map(axes.map((axis) => [axis, parameter_of(study, axis)]));
  const pairs = pairs_of(axes).map(({ x, y }) => ({ x, y, ...correlation_pair(study, x, y) }));
  const limits = new Map(axes.map((axis) => [axis, limits_of(parameters.get(axis), clouds.draws, pairs)]));
  const shown = Object.values(names);
  const top = legend_height(shown, width);
  const entries = entries_of(axes, pairs, parameters);
  const { panels, cells, height } =
    width >= matrix_from ? matrix_of(entries, axes.length, limits, width, top) : list_of(entries, limits, width, top);
  const series = entries.flatMap(({ pair, parameter }, panel) =>
    parameter ? density_series(parameter, panel) : pair_series(pair, clouds, limits, panel),
  );
  const option = {
    ...panel_frame(panels, cells),
    ...zooming(panels.length),
    series,
    legend: legend(series, shown),
    tooltip: {
      trigger: "axis",
      axisPointer: { type: "none" },
      formatter: (points) => {
        const { pair, parameter } = entries[points[0].axisIndex];
        if (pair) return tooltip_box(`${pair.x.name}, ${pair.y.name}`, [`Correlation in the posterior: ${is_number(pair.correlation) ? signed(pair.correlation) : "–"}`]);
        return tooltip_box(name_with_unit(parameter), [`Posterior: mean ${number_text(parameter.mean)}, standard deviation ${number_text(parameter.std)}`]);
      },
    },
  };
  return { option, height };
}
