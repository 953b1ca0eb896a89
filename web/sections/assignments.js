// Batches of specimens: each specimen in the two parameters that tell the batches apart best, a table of the batches, and the
// most probable batch and outlier probability against the specimen's number.
import { extent, is_number, list, record } from "../src/data.js";
import { legend, legend_height, tooltip_box, zooming } from "../src/charts.js";
import { figure } from "../src/figure.js";
import { name_with_unit, number_text, short_number } from "../src/format.js";
import { layout, line_series, panel_frame } from "../src/panels.js";
import { accent, bound, ink, model, muted, paper, test } from "../src/palette.js";
import { correlation_pair, parameter_of } from "../src/population.js";
import { data_table } from "../src/table.js";

const clear_from = 0.9; // a specimen's probability of its batch, below which it is said

const components_of = ({ result }) => list(result.components).map(record);
const assignments_of = ({ result }) => list(result.assignments).map(record);

/** Probability of the batch that a specimen is most probably of; null of an outlier. */
const probability_of = ({ component, probabilities }) =>
  is_number(component) ? (list(probabilities)[component - 1] ?? null) : null;

/** Parameters, those first whose means differ most between two batches, in standard deviations of these. */
function by_separation(study) {
  const batches = components_of(study);
  const separation = ({ index }) => {
    const at = (batch, field) => list(batch[field])[index] ?? 0;
    const pairs = batches.flatMap((one, k) => batches.slice(k + 1).map((other) => [one, other]));
    return Math.max(
      0,
      ...pairs.map(([one, other]) => Math.abs(at(one, "mean") - at(other, "mean")) / (Math.hypot(at(one, "std"), at(other, "std")) || 1e-300)),
    );
  };
  return [...study.parameter_axes].sort((a, b) => separation(b) - separation(a));
}

/** The parameters that are drawn: two, or the only one; in the order of the study, as are the regions of pairs. */
const batch_axes = (study) => by_separation(study).slice(0, 2).sort((a, b) => a.index - b.index);

const style_of = (batch) => [
  { color: model, symbol: "circle" },
  { color: accent, symbol: "rect" },
  { color: test, symbol: "diamond" },
  { color: muted, symbol: "roundRect" },
][batch % 4];

/** [x, y, number, text of its label]: against the numbers of the specimens where there is one parameter. */
function points_of(study, axes, rows) {
  const [x, y] = axes.map((axis) => parameter_of(study, axis));
  return rows
    .map(({ row, k }) => {
      const probability = probability_of(row);
      const is_doubtful = probability === null || probability < clear_from;
      const label = probability === null ? `${row.specimen}` : `${row.specimen}: ${short_number(100 * probability, 2)} %`;
      return [x.specimens[k], y ? y.specimens[k] : row.specimen, row.specimen, is_doubtful ? label : ""];
    })
    .filter(([a, b]) => is_number(a) && is_number(b));
}

function marks(name, data, { color, symbol }) {
  return {
    name,
    type: "scatter",
    symbol,
    symbolSize: data.length > 60 ? 6 : 9,
    z: 4,
    itemStyle: { color, borderColor: paper, borderWidth: 0.6, opacity: 0.85 },
    label: { show: data.length <= 60, position: "right", fontSize: 11, color: ink, formatter: ({ value }) => value[3] },
    labelLayout: { hideOverlap: true },
    data,
  };
}

function limits_of(series, which) {
  const range = extent(series.flatMap(({ data }) => data.map((point) => point[which])));
  if (!range) return {};
  const margin = 0.08 * (range[1] - range[0]) || 0.03 * Math.abs(range[0]) || 1;
  return { min: range[0] - margin, max: range[1] + margin };
}

function batch_panel(study, width) {
  const axes = batch_axes(study);
  const rows = assignments_of(study).map((row, k) => ({ row, k }));
  const names = components_of(study).map((_, k) => `Batch ${k + 1}`);
  const regions = axes.length > 1 ? correlation_pair(study, ...axes).region : [];
  const series = [
    ...names.map((name, k) => marks(name, points_of(study, axes, rows.filter(({ row }) => row.component === k + 1)), style_of(k))),
    marks("Outlier", points_of(study, axes, rows.filter(({ row }) => !is_number(row.component))), { color: bound, symbol: "triangle" }),
    ...regions.map((data) => line_series("Region of a batch", data, 0, { color: muted, width: 1.5 }, { z: 2, silent: true })),
  ];
  const shown = [...names, "Outlier", "Region of a batch"];
  const { cells, height } = layout(1, Math.min(width, 760), { aspect: 0.6, left: 66, legend_height: legend_height(shown, width), top: 8 });
  const ticks = { showMinLabel: false, showMaxLabel: false, hideOverlap: true, fontSize: 11, formatter: (value) => short_number(value, 4) };
  const [x, y] = axes;
  const panel = {
    title: "",
    x: { name: name_with_unit(x), ...limits_of(series, 0), axisLabel: ticks },
    y: { name: y ? name_with_unit(y) : "Specimen", nameGap: 46, ...limits_of(series, 1), axisLabel: ticks },
  };
  const option = {
    ...panel_frame([panel], cells),
    ...zooming(1),
    series,
    legend: legend(series, shown),
    tooltip: {
      trigger: "item",
      formatter: ({ value, seriesName }) =>
        tooltip_box(`Specimen ${value[2]}: ${seriesName.toLowerCase()}`, axes.map((axis, i) => `${name_with_unit(axis)}: ${number_text(value[i])}`)),
    },
  };
  return { option, height };
}

const id = "assignments";
const parameters_at_most = 3; // beside the figure

const batch_text = (component) => (is_number(component) ? `batch ${component}` : "an outlier");

function tooltip(row) {
  const lines = list(row.probabilities).map((value, k) => `batch ${k + 1}: ${short_number(value, 3)}`);
  return tooltip_box(`Specimen ${row.specimen}: ${batch_text(row.component)}`, [
    ...lines,
    `outlier: ${short_number(row.outlier_probability, 3)}`,
  ]);
}

function build(study, width) {
  const rows = assignments_of(study);
  const count = components_of(study).length;
  const { cells, height } = layout(2, width, { columns_at_most: 1, aspect: 0.25, legend_height: 4 });
  const x = { name: "Specimen", minInterval: 1, scale: true };
  const panels = [
    {
      title: "Most probable batch (0: outlier)",
      x,
      y: { min: -0.5, max: count + 0.5, interval: 1, axisLabel: { formatter: (v) => (Number.isInteger(v) ? v : "") } },
    },
    { title: "Probability of being an outlier", x, y: { min: 0, max: 1 } },
  ];
  const series = (panel, color, y) => ({
    name: panels[panel].title,
    type: "scatter",
    symbolSize: 7,
    color,
    xAxisIndex: panel,
    yAxisIndex: panel,
    data: rows.map((row) => [row.specimen, y(row)]),
  });
  const option = {
    ...panel_frame(panels, cells),
    ...zooming(2),
    series: [
      series(0, model, ({ component }) => (is_number(component) ? component : 0)),
      series(1, accent, ({ outlier_probability }) => outlier_probability),
    ],
    tooltip: { trigger: "item", formatter: ({ dataIndex }) => tooltip(rows[dataIndex]) },
  };
  return { option, height };
}

/** "1–9, 12". */
function ranges_text(numbers) {
  const sorted = [...numbers].sort((a, b) => a - b);
  const runs = [];
  for (const number of sorted) {
    const run = runs.at(-1);
    if (run && number === run[1] + 1) run[1] = number;
    else runs.push([number, number]);
  }
  return runs.map(([first, last]) => (first === last ? `${first}` : `${first}\u2013${last}`)).join(", ") || "–";
}

/** Specimens of a batch (null: outliers), with the probability of those that may be of another. */
function members_text(study, batch) {
  const rows = assignments_of(study).filter(({ component }) => (is_number(component) ? component : null) === batch);
  const doubtful = rows.filter((row) => batch !== null && probability_of(row) < clear_from);
  const named = doubtful.map((row) => `${row.specimen} (${short_number(100 * probability_of(row), 2)}\u00a0%)`);
  return [ranges_text(rows.map(({ specimen }) => specimen)), named.length ? `doubtful: ${named.join(", ")}` : ""].filter(Boolean).join("; ");
}

/** A row a batch: its specimens, its share, its parameters (those drawn, where they are many), and the outliers. */
export function batch_table(study) {
  const axes = study.parameter_axes.length > parameters_at_most ? batch_axes(study) : study.parameter_axes;
  const outliers = assignments_of(study).filter(({ component }) => !is_number(component)).length;
  const row_of = (component, k) => ({
    name: String(k + 1),
    specimens: members_text(study, k + 1),
    weight: is_number(component.weight) ? 100 * component.weight : null,
    ...Object.fromEntries(
      axes.map(({ index }) => [
        `p${index}`,
        `${short_number(list(component.mean)[index], 4)} ± ${short_number(list(component.std)[index], 2)}`,
      ]),
    ),
  });
  return data_table({
    id: "batches",
    is_stacked: false,
    title: "Batches",
    columns: [
      { key: "name", title: "Batch", is_text: true },
      { key: "specimens", title: "Specimens", is_text: true },
      { key: "weight", title: "Share", text: (value) => (is_number(value) ? `${value.toFixed(0)}\u00a0%` : "–") },
      ...axes.map(({ index, name, unit }) => ({ key: `p${index}`, title: name, unit, is_text: true, text: (value) => value ?? "" })),
    ],
    rows: [...components_of(study).map(row_of), ...(outliers ? [{ name: "none", specimens: members_text(study, null), weight: null }] : [])],
    caption:
      "Mean and standard deviation of each parameter within the batch." +
      (axes.length < study.parameter_axes.length ? " The two parameters that tell the batches apart best." : ""),
  });
}

export const batch_figure = (study) =>
  figure({
    id: "batches",
    title: "Batches of specimens",
    caption: "Every mark is a specimen, as far as its own test tells, in the parameters that tell the batches apart best.",
    build: (width) => batch_panel(study, width),
  });

export default {
  id: "batches-of-specimens",
  title: "Which batch each specimen belongs to",
  has_data: (study) => assignments_of(study).length > 0,
  content(study) {
    return [
      figure({
        id,
        title: "To which batch each specimen belongs",
        caption: "Numbers of specimens are those of the rows in the tests' file, from 1.",
        build: (width) => build(study, width),
      }),
    ];
  },
};
