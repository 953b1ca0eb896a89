// Bars of a diagnosis: what each candidate explains, and what of the residuals the best one leaves.
import { axis, legend, legend_height, tooltip_box } from "./charts.js";
import { is_number } from "./data.js";
import { figure } from "./figure.js";
import { fit_in, number_text } from "./format.js";
import { bound, hairline, ink, model, model_points, muted, test } from "./palette.js";

const candidates_at_most = 14;
const outputs_at_most = 20;
const bar_pitch = 24;
const label_width = 150;

/** Horizontal bars, the first row on top: one series each of `series` [{name, color, data, stack}]. */
function bars({ names, series, x_title, width, lines_of }) {
  const labels = Math.min(label_width, 0.38 * width);
  const top = legend_height(series.map(({ name }) => name), width);
  const all = series.map(({ name, color, data, more }) => ({
    name,
    type: "bar",
    data,
    itemStyle: { color },
    barMaxWidth: 15,
    ...more,
  }));
  return {
    height: top + bar_pitch * names.length + 52,
    option: {
      grid: { left: labels + 12, right: 16, top, bottom: 46 },
      xAxis: axis({ name: x_title, nameGap: 28, scale: false, splitLine: { lineStyle: { color: hairline } } }),
      yAxis: axis({
        type: "category",
        inverse: true,
        data: names,
        splitLine: { show: false },
        axisTick: { show: false },
        axisLabel: { color: ink, fontSize: 12, formatter: fit_in(labels) },
      }),
      series: all,
      legend: legend(all, series.map(({ name }) => name)),
      tooltip: {
        trigger: "axis",
        axisPointer: { type: "shadow" },
        formatter: (points) => tooltip_box(names[points[0].dataIndex], lines_of(points[0].dataIndex)),
      },
    },
  };
}

/** What each candidate explains; linear answers are paler, impossible ones grey. */
export function explained_bars(lines) {
  const shown = lines.slice(0, candidates_at_most);
  const of_kind = (wanted) => shown.map((line) => (wanted(line) ? Math.max(0, line.gain ?? 0) : null));
  const kinds = () => [
    { name: "fitted in the model", color: model, data: of_kind(({ is_fitted, is_possible }) => is_fitted && is_possible) },
    { name: "linear answer", color: model_points, data: of_kind(({ is_fitted, is_possible }) => !is_fitted && is_possible) },
    { name: "would need an impossible value", color: muted, data: of_kind(({ is_possible }) => !is_possible) },
  ];
  const label = ({ name, others }) => (others.length ? `${name} (+${others.length})` : name);
  return figure({
    id: "explained",
    title: "What each candidate explains",
    caption:
      "Increase of the log-likelihood over the parameters alone. (+1): one further candidate cannot be told apart from it." +
      (lines.length > shown.length ? ` The best ${shown.length} of ${lines.length}.` : ""),
    build: (width) =>
      bars({
        names: shown.map(label),
        series: kinds()
          .filter(({ data }) => data.some(is_number))
          .map((kind) => ({ ...kind, more: { stack: "candidate", itemStyle: bar_style(kind) } })),
        x_title: "Increase of the log-likelihood",
        width,
        lines_of: (at) => [
          `log-likelihood +${number_text(shown[at].gain, 3)}, BIC ${number_text(shown[at].bic, 3)}`,
          `${number_text(shown[at].nominal)} → ${number_text(shown[at].mean)}`,
          ...(shown[at].others.length ? [`or ${shown[at].others.join(", ")}`] : []),
        ],
      }),
  });
}

/** A linear answer is told apart by its hollow bar too. */
const bar_style = ({ name, color }) =>
  name === "linear answer" ? { color: "transparent", borderColor: color, borderWidth: 1.6 } : { color };

/** Residuals of the means, in standard errors, without and with the best candidate. */
export function residual_bars(rows, name) {
  const size = ({ before, after }) => Math.max(Math.abs(before ?? 0), Math.abs(after ?? 0));
  const shown = [...rows].sort((a, b) => size(b) - size(a)).slice(0, outputs_at_most);
  return figure({
    id: "residuals",
    title: `Residuals of the means without and with ${name}`,
    caption:
      "Means of the tests less those of the fit, in standard errors of the tests' means: beyond ±2 is more than chance leaves." +
      (rows.length > shown.length ? ` The largest ${shown.length} of ${rows.length}.` : ""),
    build: (width) =>
      bars({
        names: shown.map((row) => row.name),
        series: [
          { name: "parameters alone", color: test, data: shown.map(({ before }) => before), more: { barMaxWidth: 8, itemStyle: { color: test } } },
          { name: `with ${name}`, color: bound, data: shown.map(({ after }) => after), more: { barMaxWidth: 8, itemStyle: { color: bound } } },
        ],
        x_title: "Standard errors",
        width,
        lines_of: (at) => [
          `parameters alone: ${number_text(shown[at].before, 3)}`,
          `with ${name}: ${number_text(shown[at].after, 3)}`,
        ],
      }),
  });
}
