// A box of parameters: its ends, the bounds of the tests, and the range of each output over the box.
import { is_number, list, number_or_null, record } from "../src/data.js";
import { paragraph } from "../src/dom.js";
import { paged_figure } from "../src/figure.js";
import { number_text } from "../src/format.js";
import { output_bars } from "../src/output_rows.js";
import { specimen_number } from "../src/population.js";
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

const bars = {
  names: { test: "Bounds to cover", model: "Range over the box", inside: "Test", outside: "Test outside that range" },
  tooltip: { test: "Bounds to cover", model: "Range over the box" },
  axis: "Half widths of the bounds from their middle",
  short_axis: "Half widths from the middle of the bounds",
  inside: "model",
};
const outputs_a_page = 8;

/** Outputs whose bounds are covered least first. */
function covered_outputs(study) {
  const both = (ends) => (list(ends).filter(is_number).length === 2 ? ends : null);
  return list(block_of(study).image)
    .map(record)
    .map(({ output, bounds, image, covered }, index) => ({
      name: `${covered === false ? "✗ " : ""}${output}`,
      unit: study.output_axes[index]?.unit ?? "",
      test: both(bounds),
      model: both(image),
      median: both(bounds) && (bounds[0] + bounds[1]) / 2,
      specimens: study.tests.map((row) => row[index]),
      numbers: study.tests.map((_, k) => specimen_number(study, k)),
      covered,
    }))
    .filter(({ test, model }) => test && model)
    .sort((a, b) => Number(a.covered ?? true) - Number(b.covered ?? true));
}

/** For each output what the box gives, what it is to cover, and the tests; null where nothing is known. */
export function cover_figure(study) {
  const outputs = covered_outputs(study);
  if (!outputs.length) return null;
  return paged_figure({
    id: "cover",
    title: "Which bounds of the tests the box covers",
    caption:
      "Narrow bar: range of the output over the box. Wide bar: the bounds that it is to cover, from −1 to 1. ✗: not covered. " +
      "Triangles: tests outside the range.",
    items: outputs,
    size: outputs_a_page,
    build: (shown, width) => output_bars(shown, bars, width),
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
