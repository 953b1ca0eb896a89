// What the tests can see: singular values of the scaled sensitivity, its rank, and the combinations that stay unseen.
import { is_number, list, record } from "../src/data.js";
import { axis, tooltip_box, zooming } from "../src/charts.js";
import { bullets, element, paragraph } from "../src/dom.js";
import { figure } from "../src/figure.js";
import { combination_text, number_text, plural, short_number } from "../src/format.js";
import { bound, hairline, ink, model } from "../src/palette.js";

function build(values, rank, width) {
  const height = 250;
  const positive = values.map((value) => (value > 0 ? value : null));
  const option = {
    grid: [{ left: 66, right: 16, top: 16, bottom: 48, outerBoundsMode: "none" }],
    xAxis: axis({
      type: "category",
      data: values.map((_, i) => String(i + 1)),
      name: "Direction, from the best seen to the least",
      nameGap: 28,
      splitLine: { show: false },
    }),
    yAxis: axis({
      type: "log",
      name: "Singular value",
      nameGap: 48,
      axisLabel: { formatter: (value) => short_number(value, 2) },
    }),
    ...zooming(1),
    tooltip: {
      trigger: "item",
      formatter: ({ dataIndex, value }) =>
        tooltip_box(`Direction ${dataIndex + 1}`, [
          `Singular value ${number_text(value)}`,
          dataIndex < rank ? "seen" : "not seen",
        ]),
    },
    series: [
      {
        name: "Singular value",
        type: "line",
        color: model,
        lineStyle: { width: 1.5, color: hairline },
        showAllSymbol: true,
        label: {
          show: values.length <= 12 && width > 420,
          position: "top",
          fontSize: 11,
          color: ink,
          formatter: ({ value }) => number_text(value, 3),
        },
        data: positive.map((value, i) => ({
          value,
          ...(i < rank
            ? { symbol: "circle", symbolSize: 11, itemStyle: { color: model } }
            : { symbol: "emptyTriangle", symbolSize: 12, itemStyle: { color: bound } }),
        })),
      },
    ],
  };
  return { option, height };
}

function statement(study, block, count) {
  const { rank } = block;
  if (!is_number(rank)) return null;
  if (rank >= count) {
    return paragraph(`The outputs see all ${plural(count, "parameter")} independently: rank ${rank} of ${count}.`);
  }
  return paragraph(
    `The outputs see only ${plural(rank, "combination")} of the ${plural(count, "parameter")}: rank ${rank} of ${count}. `,
    element("b", {}, "What lies in the other directions comes from the prior, not from the tests."),
  );
}

function unseen(directions) {
  if (!directions.length) return null;
  return element(
    "div",
    { class: "unseen" },
    paragraph("Combinations that the tests do not see, in standard deviations of the prior:"),
    bullets(directions.map((weights) => element("span", { class: "combination" }, combination_text(weights)))),
  );
}

export default {
  id: "identifiability",
  title: "What the tests can see",
  has_data: (study) => {
    const block = record(study.result.identifiability);
    return is_number(block.rank) || list(block.singular_values).length > 0;
  },
  explained: [
    [
      "Singular values",
      "How strongly the outputs answer to the parameters' independent combinations, best first. A value far below the others " +
        "is a combination that the tests do not see.",
    ],
  ],
  content(study) {
    const block = record(study.result.identifiability);
    const values = list(block.singular_values);
    const rank = is_number(block.rank) ? block.rank : values.length;
    const count = study.parameter_axes.length || values.length;
    const directions = list(block.unseen_directions).map((direction) => record(record(direction).weights));
    return [
      statement(study, block, count),
      values.some((value) => value > 0)
        ? figure({
            id: "singular-values",
            title: "Singular values of the scaled sensitivity",
            caption: "Filled circles: directions that the outputs see. Open triangles: directions that they do not.",
            build: (width) => build(values, rank, width),
          })
        : null,
      unseen(directions),
    ];
  },
};
