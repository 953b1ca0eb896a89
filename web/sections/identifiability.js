// What the tests can see: singular values of the scaled sensitivity, its rank, and the combinations that stay unseen.
import { is_number, list, record } from "../src/data.js";
import { axis, tooltip_box, zooming } from "../src/charts.js";
import { bullets, element, paragraph } from "../src/dom.js";
import { figure, paged_figure } from "../src/figure.js";
import { combination_text, number_text, plural, short_number } from "../src/format.js";
import { bound, hairline, ink, model } from "../src/palette.js";
import { bars_at_most, direction_panels, part_panel, unseen_directions } from "../src/unseen_panels.js";

const directions_a_page = 6;
// Weights of a unit direction: of a parameter that is unseen by itself, and of one that has a share in it.
const alone = 0.95;
const takes_part = 0.1;

function build(values, rank, width) {
  const height = 250;
  const positive = values.map((value) => (value > 0 ? value : null));
  const option = {
    grid: [{ left: 66, right: 16, top: 16, bottom: 48, outerBoundsMode: "none" }],
    xAxis: axis({
      type: "category",
      data: values.map((_, i) => String(i + 1)),
      name: "Direction, from the best identified to the least",
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
          dataIndex < rank ? "identified" : "not identified",
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
    return paragraph(`All ${plural(count, "parameter")} can be identified independently: rank ${rank} of ${count}.`);
  }
  return paragraph(
    `The outputs determine only ${plural(rank, "combination")} of the ${plural(count, "parameter")}: rank ${rank} of ${count}. `,
    element("b", {}, "The values in the other directions come from the prior, not from the tests."),
  );
}

/** "k1 and k2 can only be seen together: k1 + 0.9 k2": of two parameters what is seen is the combination across the direction. */
function words_of({ terms, weights, meaning }) {
  if (meaning) return String(meaning).replace(/[^.]$/, "$&.");
  const [first, second] = terms;
  if (Math.abs(first.weight) >= alone) return [element("b", {}, first.name), ": the outputs do not see it."];
  const parts = terms.filter(({ weight }) => Math.abs(weight) >= takes_part);
  const combination = (text) => element("span", { class: "combination" }, text);
  if (parts.length === 2) {
    const ratio = -first.weight / second.weight;
    return [
      element("b", {}, `${first.name} and ${second.name}`),
      " can only be seen together: the outputs see ",
      combination(`${first.name} ${ratio < 0 ? "\u2212" : "+"} ${Math.abs(ratio).toFixed(2)}\u00a0${second.name}`),
      ", not ",
      combination(`${combination_text(weights)}.`),
    ];
  }
  return ["The outputs do not determine ", combination(combination_text(weights)), "."];
}

function unseen(directions) {
  if (!directions.length) return null;
  return element(
    "div",
    { class: "unseen" },
    paragraph(
      "Combinations that the tests do not determine, in standard deviations of the prior" +
        (directions.length > 1 ? "; any mixture of them is unseen too:" : ":"),
    ),
    bullets(directions.map((direction) => words_of(direction))),
  );
}

function direction_figure(directions) {
  return paged_figure({
    id: "unseen-directions",
    title: "Directions that cannot be identified, by parameter",
    caption:
      "Moving all parameters at once by these weights, in prior standard deviations, changes no output. " +
      `Up to ${bars_at_most} largest weights each.`,
    items: directions,
    size: directions_a_page,
    build: direction_panels,
  });
}

export default {
  id: "identifiability",
  title: "Identifiability of the parameters",
  has_data: (study) => {
    const block = record(study.result.identifiability);
    return is_number(block.rank) || list(block.singular_values).length > 0;
  },
  explained: [
    [
      "Singular values",
      "How strongly the outputs depend on the parameters' independent combinations, strongest first. A value far below the others " +
        "is a combination that cannot be identified from the tests.",
    ],
    [
      "Unidentified variance",
      "The fraction of a parameter's prior variance in combinations that cannot be identified: 100\u00a0% means not identified at all, " +
        "0\u00a0% wholly. What is unseen stays as the prior has it.",
    ],
  ],
  content(study) {
    const block = record(study.result.identifiability);
    const values = list(block.singular_values);
    const rank = is_number(block.rank) ? block.rank : values.length;
    const count = study.parameter_axes.length || values.length;
    const directions = unseen_directions(block);
    return [
      statement(study, block, count),
      values.some((value) => value > 0)
        ? figure({
            id: "singular-values",
            title: "Singular values of the scaled sensitivity",
            caption: "Filled circles: directions that can be identified. Open triangles: directions that cannot.",
            build: (width) => build(values, rank, width),
          })
        : null,
      unseen(directions),
      directions.length
        ? figure({
            id: "unseen-parts",
            title: "Fraction of each parameter's variance that is not identified",
            caption: "Fraction of the parameter's prior variance in the directions that cannot be identified.",
            build: (width) => part_panel(study.parameter_axes, directions, width),
          })
        : null,
      directions.length ? direction_figure(directions) : null,
    ];
  },
};
