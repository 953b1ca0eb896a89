// Scatter of a cloud, the tests and their 2-sigma ellipses for pairs of axes: the panels that both scatter sections draw.
import { ellipse_of_pair, extent, is_number, list } from "./data.js";
import { legend, tooltip_box, zooming } from "./charts.js";
import { element } from "./dom.js";
import { name_with_unit, number_text, short_number } from "./format.js";
import { line_series, panel_frame } from "./panels.js";
import { bound, model, model_points, paper, test } from "./palette.js";

const names = {
  cloud: "Model, samples",
  ellipse: "Model, 2σ ellipse",
  tests: "Tests",
  test_ellipse: "Tests, 2σ ellipse",
  bounds: "Bounds",
};

export function pairs_of(axes) {
  return axes.flatMap((x, i) => axes.slice(i + 1).map((y) => ({ x, y })));
}

/** What is known of one iteration in one space ("outputs" or "parameters"). */
export function snapshot(study, iteration, space) {
  const cloud = study.clouds.find((one) => one.iteration === iteration);
  const entry = study.iterations.find((one) => one.index === iteration);
  return {
    points: cloud ? cloud[space] : [],
    ellipses: entry ? entry[space === "outputs" ? "ellipses" : "parameter_ellipses"] : [],
  };
}

function test_ellipse(study, pair) {
  return ellipse_of_pair(study.result.test_ellipses, pair.x, pair.y);
}

const points_of_pair = (rows, { x, y }) =>
  rows.map((row) => [row[x.index], row[y.index]]).filter(([a, b]) => is_number(a) && is_number(b));

/** Axis limits that hold every given snapshot of a pair, so that iterations can be compared by eye. */
export function limits_of_pair(study, snapshots, pair, space) {
  const points = snapshots.flatMap(({ points: rows }) => points_of_pair(rows, pair));
  for (const { ellipses } of snapshots) {
    points.push(...(ellipse_of_pair(ellipses, pair.x, pair.y) ?? []));
  }
  if (space === "outputs") points.push(...points_of_pair(study.tests, pair), ...(test_ellipse(study, pair) ?? []));
  const padded = (which) => {
    const range = extent(points.map((point) => point[which]));
    if (!range) return {};
    const margin = 0.04 * (range[1] - range[0] || Math.abs(range[0]) || 1);
    return { min: range[0] - margin, max: range[1] + margin };
  };
  return { x: padded(0), y: padded(1) };
}

const line = (name, panel, data, line_style, z) => line_series(name, data, panel, line_style, { z, silent: true });

function bound_lines(study, pair, panel, limits) {
  const across = (which, value) =>
    which === "x"
      ? [
          [value, limits.y.min],
          [value, limits.y.max],
        ]
      : [
          [limits.x.min, value],
          [limits.x.max, value],
        ];
  return ["x", "y"].flatMap((which) =>
    list(list(study.parameters.bounds)[pair[which].index])
      .filter((value) => is_number(value) && value >= limits[which].min && value <= limits[which].max)
      .map((value) => line(names.bounds, panel, across(which, value), { color: bound, type: "dotted", width: 1.5 }, 1)),
  );
}

function series_of_pair(study, view, pair, panel, space, limits) {
  const at = { xAxisIndex: panel, yAxisIndex: panel };
  const series = [
    {
      name: names.cloud,
      type: "scatter",
      ...at,
      symbol: "circle",
      symbolSize: 5,
      z: 2,
      itemStyle: { color: model_points, opacity: 0.4 },
      data: points_of_pair(view.points, pair),
    },
    line(
      names.ellipse,
      panel,
      ellipse_of_pair(view.ellipses, pair.x, pair.y) ?? [],
      { color: model },
      3,
    ),
  ];
  if (space === "parameters") return [...series, ...bound_lines(study, pair, panel, limits)];
  if (study.tests.length) {
    series.push({
      name: names.tests,
      type: "scatter",
      ...at,
      symbol: "diamond",
      symbolSize: study.tests.length > 40 ? 7 : 10,
      z: 5,
      itemStyle: { color: test, borderColor: paper, borderWidth: 0.8 },
      data: points_of_pair(study.tests, pair),
    });
  }
  const dashed = test_ellipse(study, pair);
  if (dashed) series.push(line(names.test_ellipse, panel, dashed, { color: test, type: [6, 4] }, 4));
  return series;
}

/** `panels` as in pair_panels. */
function scatter_tooltip(panels, series) {
  return {
    trigger: "item",
    formatter: ({ seriesName, value, seriesIndex }) => {
      const { x, y } = panels[series[seriesIndex].xAxisIndex].pair;
      return tooltip_box(seriesName, [
        `${name_with_unit(x)}: ${number_text(value[0], 5)}`,
        `${name_with_unit(y)}: ${number_text(value[1], 5)}`,
      ]);
    },
  };
}

/** Round ticks between limits that follow the data; the limits themselves carry no label. */
function panel_of_pair({ title, pair, limits }) {
  const axis_label = { showMinLabel: false, showMaxLabel: false, formatter: (value) => short_number(value, 4) };
  return {
    title,
    x: { name: name_with_unit(pair.x), ...limits.x, axisLabel: axis_label },
    y: { name: name_with_unit(pair.y), ...limits.y, axisLabel: axis_label },
  };
}

/** Height that the legend takes: two lines of it on a narrow page. */
export const legend_height = (width) => (width < 560 ? 62 : 34);

/**
 * The option of a chart of such panels.
 * @param panels  [{title, pair, limits (limits_of_pair), view (snapshot), cell (of layout)}]
 */
export function pair_panels(study, space, panels) {
  const series = panels.flatMap(({ pair, limits, view }, panel) =>
    series_of_pair(study, view, pair, panel, space, limits),
  );
  return {
    ...panel_frame(
      panels.map(panel_of_pair),
      panels.map(({ cell }) => cell),
    ),
    ...zooming(panels.length),
    series,
    legend: legend(series, Object.values(names)),
    tooltip: scatter_tooltip(panels, series),
  };
}

/** Choice of which axes to show, where there are too many to show all pairs, `first` to begin with; calls `show(axes)`. */
export function axis_choice(axes, at_most, label, show, first = axes.slice(0, 3)) {
  let chosen = axes.length <= 3 ? axes : first;
  if (axes.length <= 3) return { chosen, control: null };
  const note = element("span", { class: "choice-note", role: "status" });
  const boxes = axes.map((axis) => {
    const input = element("input", { type: "checkbox", checked: chosen.includes(axis), "data-axis": axis.name });
    input.checked = chosen.includes(axis);
    input.addEventListener("change", () => {
      const next = axes.filter((one) => (one === axis ? input.checked : chosen.includes(one)));
      if (next.length < 2 || next.length > at_most) {
        input.checked = !input.checked;
        note.textContent = next.length < 2 ? "Two at least." : `${at_most} at most: take one away first.`;
        return;
      }
      note.textContent = "";
      chosen = next;
      show(chosen);
    });
    return element("label", { class: "chip" }, input, element("span", {}, axis.name));
  });
  const control = element("fieldset", { class: "chips" }, element("legend", {}, label), boxes, note);
  return { chosen, control };
}
