// Bars of what the tests do not see: the unseen part of each parameter, and the weights of each unseen direction.
import { is_number, list, record } from "./data.js";
import { tooltip_box, zooming } from "./charts.js";
import { fit_in, number_text, short_number } from "./format.js";
import { layout, panel_frame } from "./panels.js";
import { bound, ink, model, muted } from "./palette.js";

export const bars_at_most = 10;
const least_weight = 0.02;
const bar_height = 19;

/** [{position, weights by name, terms: [{name, weight}], largest first, meaning}], scaled to length one; `meaning` in words,
 *  where the result has it. */
export function unseen_directions(block) {
  return list(block.unseen_directions)
    .map(record)
    .map(({ weights: given, meaning }) => {
      const entries = Object.entries(record(given)).filter(([, weight]) => is_number(weight));
      const length = Math.hypot(...entries.map(([, weight]) => weight)) || 1;
      const terms = entries
        .map(([name, weight]) => ({ name, weight: weight / length }))
        .sort((a, b) => Math.abs(b.weight) - Math.abs(a.weight));
      return { meaning, terms, weights: Object.fromEntries(terms.map(({ name, weight }) => [name, weight])) };
    })
    .filter(({ terms }) => terms.length > 0)
    .map((direction, position) => ({ ...direction, position }));
}

/** Cells as high as their bars, each row of them as high as its highest. */
function cells_of(panels, grid) {
  const has_titles = panels.some(({ title }) => title);
  const [above, under] = [has_titles ? 30 : 8, 46];
  const inner = panels.map(({ bars }) => bars.length * bar_height + 8);
  const cells = [];
  let top = 0;
  for (let start = 0; start < panels.length; start += grid.columns) {
    const row = inner.slice(start, start + grid.columns);
    row.forEach((height, k) => cells.push({ ...grid.cells[start + k], top: top + above, height }));
    top += above + Math.max(...row) + under;
  }
  return { cells, height: top };
}

/** Horizontal bars with their names on the left; panels = [{title, bars: [{name, value}], min, max}]. */
function bar_panels(panels, width, { name, columns_at_most, interval, format, tip }) {
  const longest = Math.max(...panels.flatMap(({ bars }) => bars.map((bar) => bar.name.length)));
  const left = Math.min(150, 20 + 7 * longest);
  const grid = layout(panels.length, width, { columns_at_most, minimum: left + 190, left, right: 24 });
  const { cells, height } = cells_of(panels, grid);
  const option = {
    ...panel_frame(
      panels.map(({ title, bars, min, max }) => ({
        title,
        x: {
          name,
          min,
          max,
          interval,
          scale: false,
          axisLabel: { formatter: format, fontSize: 11, hideOverlap: true },
        },
        y: {
          type: "category",
          inverse: true,
          data: bars.map((bar) => bar.name),
          splitLine: { show: false },
          axisTick: { show: false },
          axisLine: { show: true, onZero: true, lineStyle: { color: muted } },
          axisLabel: { color: ink, fontSize: 12, interval: 0, formatter: fit_in(left - 12) },
        },
      })),
      cells,
    ),
    ...zooming(panels.length),
    tooltip: {
      trigger: "item",
      formatter: ({ name: bar, value, seriesIndex }) => tooltip_box(bar, [tip(value, panels[seriesIndex])]),
    },
    series: panels.map(({ bars }, k) => ({
      name,
      type: "bar",
      xAxisIndex: k,
      yAxisIndex: k,
      barMaxWidth: 13,
      itemStyle: { color: model },
      data: bars.map(({ value }) => ({ value, itemStyle: { color: value < 0 ? bound : model } })),
    })),
  };
  return { option, height };
}

/** One panel a direction, its largest weights as bars. */
export function direction_panels(directions, width) {
  const panels = directions.map(({ terms, position }) => ({
    title: `Direction ${position + 1} that cannot be identified`,
    min: -1,
    max: 1,
    bars: terms
      .filter(({ weight }, rank) => rank === 0 || Math.abs(weight) >= least_weight)
      .slice(0, bars_at_most)
      .map(({ name, weight }) => ({ name, value: weight })),
  }));
  return bar_panels(panels, width, {
    name: "Weight",
    columns_at_most: 3,
    interval: 0.5,
    format: (value) => short_number(value, 2),
    tip: (value) => `Weight ${number_text(value, 3)}`,
  });
}

/** Share of each parameter's prior variance in the unseen directions, which are orthonormal. */
export function part_panel(axes, directions, width) {
  const bars = axes.map(({ name }) => ({
    name,
    value: Math.min(
      1,
      directions.reduce((sum, { weights }) => sum + (weights[name] ?? 0) ** 2, 0),
    ),
  }));
  return bar_panels([{ title: "", bars, min: 0, max: 1 }], width, {
    name: "Unidentified variance",
    columns_at_most: 1,
    interval: 0.25,
    format: (value) => `${Math.round(100 * value)} %`,
    tip: (value) => `${short_number(100 * value, 3)} % of it is not identified`,
  });
}
