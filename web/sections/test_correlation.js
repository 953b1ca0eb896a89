// Correlation of the shapes of tests and model: MAC of every pair before and after the update.
import { is_number, list, number_or_null, record } from "../src/data.js";
import { element, paragraph } from "../src/dom.js";
import { figure } from "../src/figure.js";
import { mac_map } from "../src/mac_map.js";
import { signed } from "../src/matrix_map.js";
import { data_table } from "../src/table.js";

const doubtful = 0.8;
const states = [
  { key: "initial", when: "before the update" },
  { key: "final", when: "after the update" },
];
const cell = {
  width_at_most: 60,
  height_at_least: 13,
  height_at_most: 36,
  aspect: 0.62,
  name_at_most: 120,
  column_room: 60,
};

const correlation_of = ({ result }) => record(result.shape_correlation);
const mac_of = (correlation, key) => list(record(correlation[key]).mac).map(list);
const has_map = (correlation, key) => mac_of(correlation, key).some((row) => row.some(is_number));

function map_figure(correlation, { key, when }) {
  const names = list(correlation.modes).map(String);
  return figure({
    id: `mac-${key}`,
    title: `MAC of model and tests ${when}`,
    caption: "Rows: modes of the model; columns: the test modes that are paired with them. Mean over the specimens.",
    build: mac_map({
      rows: names,
      columns: names,
      values: mac_of(correlation, key),
      cell,
      row_title: "model",
      column_title: "tests",
      tooltip: (row, column, value) => [`Model mode ${row} – test mode of ${column}`, `MAC: ${signed(value)}`],
    }),
  });
}

const mac_text = (value) => (is_number(value) ? value.toFixed(3) : "–");

function pair_table(correlation) {
  const rows = list(correlation.modes).map((mode, k) => ({
    name: String(mode),
    specimens: number_or_null(list(correlation.specimens)[k]),
    initial: number_or_null(mac_of(correlation, "initial")[k]?.[k]),
    initial_least: number_or_null(list(record(correlation.initial).least)[k]),
    final: number_or_null(mac_of(correlation, "final")[k]?.[k]),
    final_least: number_or_null(list(record(correlation.final).least)[k]),
  }));
  const worst_first = [...rows].sort((a, b) => (a.final ?? a.initial ?? 2) - (b.final ?? b.initial ?? 2));
  const column = (key, title, group) => ({
    key,
    title,
    group,
    text: mac_text,
    of_class: (row) => (is_number(row[key]) && row[key] < doubtful ? "flag" : null),
  });
  return data_table({
    id: "mac-pairs",
    title: "Paired modes, the worst first",
    columns: [
      { key: "name", title: "Mode", is_text: true },
      { key: "specimens", title: "Specimens", text: (count) => (is_number(count) ? String(count) : "–") },
      column("initial", "mean", "MAC before"),
      column("initial_least", "least", "MAC before"),
      has_map(correlation, "final") ? column("final", "mean", "MAC after") : null,
      has_map(correlation, "final") ? column("final_least", "least", "MAC after") : null,
    ].filter(Boolean),
    rows: worst_first,
    caption: `Set off: below ${doubtful}. Pairs are those that were made with the model as it was read.`,
  });
}

export default {
  id: "test-correlation",
  title: "Correlation of test and model shapes",
  has_data: (study) => has_map(correlation_of(study), "initial"),
  explained: [
    [
      "MAC",
      "Modal assurance criterion of two shapes, their squared cosine: 1 the same shape, whatever its scale; 0 nothing in common. " +
        "Few measured points make different shapes look alike: off the diagonal the values should be small.",
    ],
  ],
  content(study) {
    const correlation = correlation_of(study);
    const shown = states.filter(({ key }) => has_map(correlation, key));
    return [
      pair_table(correlation),
      element(
        "div",
        { class: "side-by-side" },
        shown.map((state) => map_figure(correlation, state)),
      ),
      shown.length === 1
        ? paragraph("Shapes at the estimate are not known here, so only those before the update are compared.")
        : null,
    ];
  },
};
