// A box of parameters: its ends, the bounds of the tests, and the range of each output over the box.
import { is_number, list, number_or_null, record } from "../src/data.js";
import { paragraph } from "../src/dom.js";
import { number_text } from "../src/format.js";
import { data_table } from "../src/table.js";

const block_of = ({ result }) => record(result.interval);
const ends_text = (ends) =>
  list(ends).some(is_number) ? list(ends).map((end) => (is_number(end) ? number_text(end, 5) : "–")).join(" … ") : "–";
const ends_column = (key, title, group) => ({
  key,
  title,
  group,
  text: ends_text,
  csv: (row) => list(row[key]).map((end) => end ?? "").join(" to "),
});

function parameter_table(study) {
  const { hull, trends } = block_of(study);
  const rows = study.parameter_axes.map(({ index, name, unit }) => ({
    name,
    unit,
    box: list(list(study.parameters.box)[index]),
    hull: list(list(hull)[index]),
    trend: list(trends)[index] ?? "",
  }));
  return data_table({
    id: "interval-parameters",
    title: "Bounds of the parameters",
    columns: [
      { key: "name", title: "Parameter", is_text: true },
      rows.some(({ unit }) => unit) ? { key: "unit", title: "Unit", is_text: true } : null,
      ends_column("box", "Box"),
      ends_column("hull", "Hull of the specimens' own"),
      { key: "trend", title: "Eigenvalues with it", is_text: true },
    ].filter(Boolean),
    rows,
    caption:
      "The box is the smallest whose outputs cover the bounds of the tests. The hull holds parameters that fit each specimen alone.",
  });
}

function output_table(study) {
  const rows = list(block_of(study).image)
    .map(record)
    .map(({ output, observed, bounds, image, excess, certified, covered }) => ({
      name: output,
      observed,
      bounds,
      image,
      below: number_or_null(list(excess)[0]),
      above: number_or_null(list(excess)[1]),
      proven: certified === true ? "yes" : "no",
      covered: covered === true ? "yes" : "no",
    }));
  return data_table({
    id: "interval-outputs",
    title: "Bounds of the outputs",
    columns: [
      { key: "name", title: "Output", is_text: true },
      ends_column("observed", "Observed", "Tests"),
      ends_column("bounds", "To be covered", "Tests"),
      ends_column("image", "Range over the box", "Model"),
      { key: "below", title: "Beyond, lower end", group: "Model" },
      { key: "above", title: "Beyond, upper end", group: "Model" },
      { key: "covered", title: "Covered", is_text: true, of_class: (row) => (row.covered === "no" ? "flag" : null) },
      { key: "proven", title: "Proven", is_text: true },
    ],
    rows,
    caption: "Negative: not covered. Proven: no parameters in the box give outputs beyond the range, by more than its tolerance.",
  });
}

export default {
  id: "interval",
  title: "Bounds",
  is_in_print: true,
  has_data: (study) => list(block_of(study).image).length > 0,
  explained: [
    ["Box", "Bounds of each parameter by itself. Nothing is said of how parameters lie between them, nor of their correlation."],
  ],
  content: (study) => [
    parameter_table(study),
    output_table(study),
    list(block_of(study).undetermined).length ? paragraph(list(block_of(study).undetermined).join(" ")) : null,
  ],
};
