// To which batch each specimen belongs: most probable component and outlier probability against the specimen's number.
import { is_number, list, record } from "../src/data.js";
import { tooltip_box, zooming } from "../src/charts.js";
import { figure } from "../src/figure.js";
import { short_number } from "../src/format.js";
import { layout, panel_frame } from "../src/panels.js";
import { accent, model } from "../src/palette.js";
import { data_table } from "../src/table.js";

const id = "assignments";
const rows_of = (study) => list(study.result.assignments).map(record);
const components_of = (study) => list(study.result.components).map(record);

const batch_text = (component) => (is_number(component) ? `batch ${component}` : "an outlier");

function tooltip(row) {
  const lines = list(row.probabilities).map((value, k) => `batch ${k + 1}: ${short_number(value, 3)}`);
  return tooltip_box(`Specimen ${row.specimen}: ${batch_text(row.component)}`, [
    ...lines,
    `outlier: ${short_number(row.outlier_probability, 3)}`,
  ]);
}

function build(study, width) {
  const rows = rows_of(study);
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

function batch_table(study) {
  const names = list(record(study.parameters).names);
  return data_table({
    id: "batches",
    title: "Batches",
    columns: [
      { key: "batch", title: "Batch", is_text: true },
      { key: "specimens", title: "Specimens" },
      { key: "weight", title: "Weight" },
      ...names.map((name, i) => ({ key: `p${i}`, title: name, is_text: true })),
    ],
    rows: components_of(study).map((component, k) => ({
      batch: String(k + 1),
      specimens: component.specimens,
      weight: component.weight,
      ...Object.fromEntries(
        names.map((_, i) => [
          `p${i}`,
          `${short_number(list(component.mean)[i], 4)} ± ${short_number(list(component.std)[i], 2)}`,
        ]),
      ),
    })),
    caption: "Mean and standard deviation of each parameter within the batch.",
  });
}

export default {
  id: "batches-of-specimens",
  title: "Batches of specimens",
  has_data: (study) => rows_of(study).length > 0,
  content(study) {
    return [
      figure({
        id,
        title: "To which batch each specimen belongs",
        caption: "Numbers of specimens are those of the rows in the tests' file, from 1.",
        build: (width) => build(study, width),
      }),
      batch_table(study),
    ];
  },
};
