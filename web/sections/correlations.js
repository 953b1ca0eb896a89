// How the parameters go together from specimen to specimen: their correlations with intervals, as table, map and ellipses.
import { is_number } from "../src/data.js";
import { redraw } from "../src/charts.js";
import { axis_choice } from "../src/cloud_panels.js";
import { correlation_interval_text, ellipse_panels } from "../src/correlation_panels.js";
import { paragraph } from "../src/dom.js";
import { figure } from "../src/figure.js";
import { plural, short_number } from "../src/format.js";
import { matrix_map, signed } from "../src/matrix_map.js";
import { pair_plot } from "../src/pair_plot.js";
import { diverging } from "../src/palette.js";
import { correlation_pairs, is_population, is_posterior, region_text } from "../src/population.js";
import { data_table } from "../src/table.js";

const all_listed_at_most = 15;
const map_from_parameters = 4;
const map_from_pairs = 3;

const excludes_zero = ({ interval }) => Boolean(interval) && (interval[0] > 0 || interval[1] < 0);

function pairs_table(pairs, title, has_intervals) {
  const rank = (pair) => (excludes_zero(pair) ? 2 : 0) + Math.abs(pair.correlation ?? 0);
  const known = pairs.length <= all_listed_at_most ? pairs : pairs.filter(({ correlation }) => is_number(correlation));
  const listed =
    known.length <= all_listed_at_most
      ? known
      : [...known].sort((a, b) => rank(b) - rank(a)).slice(0, all_listed_at_most);
  const left_out = pairs.length - listed.length;
  const row_of = ({ first, second, correlation, interval }) => ({
    name: `${first.name}, ${second.name}`,
    correlation,
    interval,
    says: !is_number(correlation)
      ? "not determined"
      : !interval
        ? ""
        : excludes_zero({ interval })
          ? correlation > 0
            ? "increase together"
            : "one decreases as the other increases"
          : "",
  });
  return data_table({
    id: "correlations",
    title,
    columns: [
      { key: "name", title: "Parameters", is_text: true },
      { key: "correlation", title: "Correlation", text: (value) => (is_number(value) ? signed(value) : "–") },
      ...(has_intervals
        ? [
            {
              key: "interval",
              title: "95 % interval",
              text: correlation_interval_text,
              csv: ({ interval }) => interval?.join(" to ") ?? "",
            },
            { key: "says", title: "", is_text: true },
          ]
        : []),
    ],
    rows: listed.map(row_of),
    all_rows: pairs.map(row_of),
    caption: left_out
      ? `The ${listed.length} clearest of ${pairs.length} pairs; CSV saves them all.`
      : !pairs.some(({ interval }) => interval)
        ? null
        : "An interval that contains zero: these tests do not show that the two parameters are correlated.",
  });
}

function statement(pairs) {
  const known = pairs.filter(({ interval }) => interval);
  if (!known.length) return paragraph("No intervals are given: the uncertainty of these correlations is not known.");
  const clear = known.filter(excludes_zero).length;
  const by_chance = 0.05 * known.length;
  return paragraph(
    clear
      ? `${plural(clear, "correlation")} of ${known.length} ${clear === 1 ? "differs" : "differ"} from zero by ${clear === 1 ? "its" : "their"} 95 % interval; ` +
          `without any correlation, chance alone would do so for ${short_number(by_chance, 2)} on average.`
      : `None of the ${plural(known.length, "correlation")} differs significantly from zero in these tests.`,
    known.length < pairs.length ? ` ${plural(pairs.length - known.length, "pair")} cannot be determined.` : "",
  );
}

const is_in_map = ({ interval, correlation }) => Boolean(interval) && is_number(correlation);

/** The pairs whose correlation is determined, of the parameters that are in one. */
function correlation_map(study, pairs) {
  const shown = pairs.filter(is_in_map);
  const parameters = study.parameter_axes.filter(({ index }) =>
    shown.some(({ first, second }) => first.index === index || second.index === index),
  );
  const [rows, columns] = [parameters.slice(1), parameters.slice(0, -1)];
  const pair_at = (row, column) =>
    shown.find(({ first, second }) => first.index === columns[column].index && second.index === rows[row].index);
  const grid = rows.map((_, row) => columns.map((__, column) => pair_at(row, column)));
  const longest = Math.max(...columns.map(({ name }) => name.length));
  const left_out = study.parameter_axes.length - parameters.length;
  return figure({
    id: "correlation-map",
    title: "Correlations of the parameters",
    caption:
      "Each pair once. Framed: the 95 % interval does not contain zero." +
      (shown.length < (parameters.length * (parameters.length - 1)) / 2 ? " Left empty: not determined." : "") +
      (left_out ? ` Left out: ${plural(left_out, "parameter")} of which no correlation is determined.` : ""),
    build: matrix_map({
      name: "Correlation",
      rows: rows.map(({ name }) => name),
      columns: columns.map(({ name }) => name),
      values: grid.map((row) => row.map((pair) => pair?.correlation ?? null)),
      low: -1,
      high: 1,
      ends: ["+1", "\u22121"],
      stops: () => diverging,
      is_deep: (value) => Math.abs(value) > 0.78,
      is_marked: (row, column) => excludes_zero(grid[row][column]),
      cell: {
        width_at_most: 90,
        height_at_least: 18,
        height_at_most: 36,
        aspect: 0.6,
        name_at_most: 150,
        column_room: Math.min(110, Math.max(60, 8 * longest)),
      },
      tooltip: (row, column, value) => {
        const pair = shown.find(({ first, second }) => first.name === column && second.name === row);
        return [
          `${row} – ${column}`,
          `Correlation ${signed(value)}, 95 %: ${correlation_interval_text(pair?.interval)}`,
        ];
      },
    }),
  });
}

/** First to be shown where not all can be: the parameters of the clearest correlations. */
function first_axes(study, pairs) {
  const rank = (pair) => (pair.interval ? 2 : 0) + (excludes_zero(pair) ? 2 : 0) + Math.abs(pair.correlation ?? 0);
  const chosen = new Set();
  for (const { first, second } of [...pairs].sort((a, b) => rank(b) - rank(a))) {
    for (const { index } of [first, second]) if (chosen.size < 3) chosen.add(index);
  }
  return study.parameter_axes.filter(({ index }) => chosen.has(index));
}

/** The figure of pairs of chosen parameters; `build` draws the chosen ones. */
function pairs_figure(study, pairs, { id, title, caption, renderer, build }) {
  const choice = axis_choice(
    study.parameter_axes,
    4,
    "Parameters shown",
    (axes) => {
      shown = axes;
      redraw(id, { afresh: true });
    },
    first_axes(study, pairs),
  );
  let shown = choice.chosen;
  return figure({
    id,
    title,
    caption,
    renderer,
    controls: choice.control ? [choice.control] : [],
    build: (width) => build(shown, width),
  });
}

const ellipses_figure = (study, pairs) =>
  pairs_figure(study, pairs, {
    id: "correlation-ellipses",
    title: "Pairs of parameters with the uncertainty of their correlation",
    caption:
      `Solid: the ellipse that contains about ${region_text(study)} of the specimens. Thin: what it would be at either end of the ` +
      "correlation's 95\u00a0% interval. Diamonds: the specimens, as far as their own tests tell.",
    build: (axes, width) => ellipse_panels(study, axes, width),
  });

function posterior_figure(study, pairs) {
  const [prior, draws] = [study.clouds[0], study.clouds.at(-1)].map((cloud) => cloud?.parameters ?? []);
  return pairs_figure(study, pairs, {
    id: "posterior-pairs",
    title: "Pairs of parameters in the posterior, and the prior behind it",
    caption:
      `Grey: draws of the prior, as far as they lie in the panel; blue: draws of the posterior; line: the region that contains ${region_text(study)} of them.` +
      " A narrow oblique cloud is a combination that the tests determine while they leave its parts open.",
    renderer: "canvas",
    build: (axes, width) => pair_plot(study, axes, { prior: study.clouds.length > 1 ? prior : [], draws }, width),
  });
}

const has_pairs = (study) =>
  correlation_pairs(study).some(({ correlation, interval }) => is_number(correlation) || interval);

export default {
  id: "correlations",
  title: "Correlations of the parameters",
  has_data: (study) => (is_population(study) || is_posterior(study)) && study.parameter_axes.length > 1 && has_pairs(study),
  explained: [
    [
      "Correlation",
      "Whether two parameters vary together from one specimen to the next. Its interval is wide with few specimens: with ten, " +
        "a correlation of zero may well be found as ±0.5.",
    ],
  ],
  content(study) {
    const pairs = correlation_pairs(study);
    if (!Array.isArray(study.parameters.correlation)) {
      return [
        paragraph("This result holds no correlations, since an earlier version wrote it: run the study again to see them."),
      ];
    }
    return [
      is_posterior(study) ? null : statement(pairs),
      pairs_table(
        pairs,
        is_posterior(study)
          ? "Correlations of the parameters in the posterior"
          : "Correlations of the parameters from specimen to specimen",
        !is_posterior(study),
      ),
      study.parameter_axes.length >= map_from_parameters && pairs.filter(is_in_map).length >= map_from_pairs
        ? correlation_map(study, pairs)
        : null,
      is_posterior(study) ? posterior_figure(study, pairs) : ellipses_figure(study, pairs),
    ];
  },
};
