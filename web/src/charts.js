// ECharts with only the parts that the sections use, and the life of a chart: drawn, resized, printed, zoomed.
// A chart is a description {id, renderer, build(width) -> {option, height}}; build is called again whenever the width
// changes and for every export, so it holds all state of the drawing.
import { init, use } from "echarts/core";
import * as parts from "./echarts_parts.js";
import { font_family, hairline, ink, muted, paper, scale } from "./palette.js";
import { on_theme_change, printed_figure_width, printed_width, with_light_theme } from "./theme.js";

use(Object.values(parts));

export const charts = {};
const live = new Map();

/** What every option shares: no animation (a report is read, compared and tested as it stands), our font. */
function with_defaults(option) {
  return {
    animation: false,
    backgroundColor: "transparent",
    textStyle: { fontFamily: font_family, color: ink },
    ...option,
    ...(option.tooltip && { tooltip: { backgroundColor: paper, ...option.tooltip } }),
  };
}

export function create_chart(host, description) {
  const { option, height } = description.build(available_width(host));
  host.style.height = `${height}px`;
  const chart = init(host, null, {
    renderer: description.renderer ?? "svg",
    devicePixelRatio: Math.max(2, window.devicePixelRatio || 1),
    width: available_width(host),
    height,
  });
  chart.setOption(with_defaults(option));
  charts[description.id] = chart;
  live.set(description.id, { chart, host, description, width: available_width(host) });
  chart.getZr().flush();
  host.dataset.drawn = "true";
  observer.observe(host);
  return chart;
}

/** A chart of its own for a file, in light colours, with the same zoom as on the page. */
export function create_copy(id, host, { renderer, width }) {
  const { chart, description } = live.get(id);
  return with_light_theme(() => {
    const { option, height } = description.build(width);
    const copy = init(host, null, { renderer, width, height, ssr: host === null, devicePixelRatio: 2 });
    copy.setOption({ ...with_defaults(option), backgroundColor: paper });
    apply_zoom(copy, zoom_of(chart));
    return copy;
  });
}

/** Draws the chart anew after its description's state changed; `afresh` forgets series and zoom. */
export function redraw(id, { afresh = false } = {}) {
  const entry = live.get(id);
  const { option, height } = entry.description.build(entry.width, { is_summary: entry.is_summary });
  entry.host.style.height = `${height}px`;
  entry.chart.resize({ width: entry.width, height });
  entry.chart.setOption(with_defaults(option), { notMerge: afresh });
  entry.chart.getZr().flush();
}

const available_width = (host) => Math.max(240, Math.floor(host.clientWidth || 900));

function fit(entry, width) {
  if (width === entry.width) return;
  const is_other_drawing = width === printed_figure_width || entry.width === printed_figure_width;
  entry.width = width;
  redraw(entry.description.id, { afresh: is_other_drawing });
}

const observer = new ResizeObserver((changes) => {
  for (const { target } of changes) {
    for (const entry of live.values()) if (entry.host === target) fit(entry, available_width(target));
  }
});

function fit_all(printing) {
  const is_summary = !document.documentElement.classList.contains("print-all");
  for (const entry of live.values()) {
    entry.is_summary = printing && is_summary && entry.host.closest(".in-print") !== null; // its width is like no other
    const on_paper = entry.is_summary ? printed_figure_width : printed_width;
    fit(entry, printing ? on_paper : available_width(entry.host));
  }
}
window.addEventListener("beforeprint", () => fit_all(true));
window.addEventListener("afterprint", () => fit_all(false));
on_theme_change(() => [...live.keys()].forEach((id) => redraw(id)));

export function zoom_of(chart) {
  return (chart.getOption().dataZoom ?? []).map(({ start, end }) => ({ start, end }));
}

export function apply_zoom(chart, zooms) {
  zooms.forEach(({ start, end }, dataZoomIndex) =>
    chart.dispatchAction({ type: "dataZoom", dataZoomIndex, start, end }),
  );
}

export function reset_zoom(id) {
  const { chart } = live.get(id);
  apply_zoom(
    chart,
    zoom_of(chart).map(() => ({ start: 0, end: 100 })),
  );
}

/** While on, dragging over a plot chooses the area to enlarge. */
export function choose_zoom_area(id, is_on) {
  live.get(id).chart.dispatchAction({ type: "takeGlobalCursor", key: "dataZoomSelect", dataZoomSelectActive: is_on });
}

/** Axis of a plot in the report's style; `more` overrides. */
export function axis(more = {}) {
  return {
    type: "value",
    scale: true,
    nameLocation: "middle",
    nameTextStyle: { color: ink, fontSize: 12 },
    axisLine: { show: true, onZero: false, lineStyle: { color: muted } },
    axisTick: { show: true, lineStyle: { color: muted } },
    splitLine: { lineStyle: { color: hairline } },
    splitNumber: 4,
    ...more,
    axisLabel: more.axisLabel ? { color: scale, ...more.axisLabel } : { color: muted, fontSize: 11, hideOverlap: true },
  };
}

/** Wheel with Ctrl enlarges (plain wheel scrolls the page), dragging moves; the hidden toolbox serves the area zoom. */
export function zooming(axis_count) {
  const all = Array.from({ length: axis_count }, (_, i) => i);
  const inside = { type: "inside", filterMode: "none", zoomOnMouseWheel: "ctrl", moveOnMouseWheel: false };
  return {
    dataZoom: all.flatMap((i) => [
      { ...inside, xAxisIndex: i },
      { ...inside, yAxisIndex: i },
    ]),
    toolbox: {
      show: true,
      itemSize: 0,
      showTitle: false,
      left: -50,
      feature: { dataZoom: { filterMode: "none", brushStyle: { color: "rgba(0,114,178,0.12)", borderColor: muted } } },
    },
  };
}

/** Marks as they are drawn: ECharts would show a dot on every line and a flattened diamond. */
const legend_marks = {
  line: "path://M0,4h26v2.4h-26z",
  dashed: "path://M0,4h7v2.2h-7zM9.5,4h7v2.2h-7zM19,4h7v2.2h-7z",
  dotted: "path://M0,4h2v2h-2zM4,4h2v2h-2zM8,4h2v2h-2zM12,4h2v2h-2zM16,4h2v2h-2zM20,4h2v2h-2zM24,4h2v2h-2z",
  strip: "path://M0,0h26v10h-26z",
  circle: "circle",
  diamond: "path://M5,0L10,5L5,10L0,5z",
};

function mark_of({ type, symbol, lineStyle }) {
  if (type === "custom") return "strip";
  if (type === "scatter") return symbol;
  if (symbol !== "none") return null;
  if (lineStyle.type === "dotted") return "dotted";
  return lineStyle.type && lineStyle.type !== "solid" ? "dashed" : "line";
}

/** One entry for each name among the series, in the order of `names`; names of empty series are left out. */
export function legend(series, names) {
  const entries = names.flatMap((name) => {
    const one = series.find((candidate) => candidate.name === name && candidate.data.length);
    const mark = one && mark_of(one);
    return one ? [mark ? { name, icon: legend_marks[mark] } : { name }] : [];
  });
  return {
    top: 0,
    left: 0,
    itemWidth: 26,
    itemHeight: 11,
    itemGap: 18,
    selectedMode: true,
    textStyle: { fontSize: 12, color: ink },
    data: entries,
  };
}

/** Room above the first row of panels for a legend of these names, on as many lines as they take. */
export function legend_height(names, width) {
  let [lines, taken] = [1, 0];
  for (const name of names) {
    const entry = 49 + 6.6 * name.length;
    if (taken > 0 && taken + entry > width) [lines, taken] = [lines + 1, 0];
    taken += entry;
  }
  return 10 + 24 * lines;
}

/** Tooltip as elements, so that names are never taken as markup. */
export function tooltip_box(heading, lines) {
  const box = document.createElement("div");
  box.className = "tooltip";
  const head = box.appendChild(document.createElement("strong"));
  head.textContent = heading;
  for (const line of lines) box.appendChild(document.createElement("div")).textContent = line;
  return box;
}
