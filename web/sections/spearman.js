// Rank correlation of every parameter with every output over the first cloud, as a map with its numbers.
import { is_number, list } from "../src/data.js";
import { axis, tooltip_box } from "../src/charts.js";
import { figure } from "../src/figure.js";
import { diverging, ink } from "../src/palette.js";

const signed = (value) => `${value <= -0.005 ? "\u2212" : ""}${Math.abs(value).toFixed(2)}`;

function build(study, matrix, width) {
  const rows = study.parameter_axes.length;
  const columns = study.output_axes.length;
  const name_width = Math.min(150, 24 + 7 * Math.max(...study.parameter_axes.map(({ name }) => name.length)));
  const inner_width = Math.min(width - name_width - 16, 130 * columns);
  const cell_width = inner_width / columns;
  const cell_height = Math.min(38, Math.max(22, cell_width * 0.6));
  const grid = {
    left: name_width,
    top: 10,
    width: inner_width,
    height: Math.round(rows * cell_height),
    outerBoundsMode: "none",
  };
  const cells = study.parameter_axes
    .flatMap(({ index: row }) => study.output_axes.map(({ index: column }) => [column, row, list(matrix[row])[column]]))
    .filter(([, , value]) => is_number(value));
  const label_size = Math.min(12, Math.max(8, cell_width / 4));
  const turned =
    cell_width < 44 ? { rotate: 60, width: 60, overflow: "truncate" } : { width: cell_width - 6, overflow: "truncate" };
  const category = (axes, more) =>
    axis({
      type: "category",
      data: axes.map(({ name }) => name),
      splitLine: { show: false },
      axisTick: { show: false },
      axisLabel: { color: ink, fontSize: 12, interval: 0, ...turned },
      ...more,
    });
  const option = {
    grid: [grid],
    xAxis: category(study.output_axes, { name: "" }),
    yAxis: category(study.parameter_axes, {
      inverse: true,
      axisLabel: { color: ink, fontSize: 12, interval: 0, width: name_width - 12, overflow: "truncate" },
    }),
    visualMap: {
      type: "continuous",
      min: -1,
      max: 1,
      precision: 1,
      dimension: 2,
      orient: "horizontal",
      left: name_width - 6,
      bottom: 0,
      itemWidth: 12,
      itemHeight: Math.min(220, Math.max(120, inner_width - 80)),
      text: ["+1", "\u22121"],
      textStyle: { color: ink, fontSize: 11 },
      calculable: false,
      inRange: { color: diverging },
    },
    tooltip: {
      trigger: "item",
      formatter: ({ value: [column, row, rho] }) =>
        tooltip_box(`${study.parameter_axes[row].name} → ${study.output_axes[column].name}`, [
          `Spearman's ρ: ${signed(rho)}`,
        ]),
    },
    series: [
      {
        name: "Spearman's rank correlation",
        type: "heatmap",
        itemStyle: { borderColor: "#ffffff", borderWidth: 1.5 },
        label: { show: cell_width >= 26, fontSize: label_size, color: ink, formatter: ({ value }) => signed(value[2]) },
        data: cells.map((value) => ({ value, label: { color: Math.abs(value[2]) > 0.78 ? "#ffffff" : ink } })),
      },
    ],
  };
  return { option, height: grid.top + grid.height + (turned.rotate ? 60 : 34) + 40 };
}

export default {
  id: "spearman",
  title: "Which parameter moves which output",
  has_data: (study) => list(study.result.spearman).some((row) => list(row).some(is_number)),
  explained: [
    [
      "Spearman map",
      "Rank correlation over the first cloud: +1 rises together, −1 one falls as the other rises, 0 no monotone link. " +
        "A parameter with a pale row cannot be found from these outputs.",
    ],
  ],
  content(study) {
    const matrix = list(study.result.spearman);
    return [
      figure({
        id: "spearman",
        title: "Spearman's rank correlation of parameters and outputs",
        caption: "Rows are parameters, columns are outputs; first cloud.",
        build: (width) => build(study, matrix, width),
      }),
    ];
  },
};
