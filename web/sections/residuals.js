// What the updated population leaves of every specimen: whitened residuals as a map, and the specimens that stand out.
import { is_number, list, number_or_null, record } from "../src/data.js";
import { paragraph } from "../src/dom.js";
import { paged_figure } from "../src/figure.js";
import { p_value_text, plural, short_number } from "../src/format.js";
import { matrix_map, signed } from "../src/matrix_map.js";
import { diverging } from "../src/palette.js";
import { specimen_number } from "../src/population.js";
import { data_table } from "../src/table.js";

const id = "residuals";
const specimens_a_page = 50;

const cell = {
  width_at_most: 74,
  height_at_least: 16,
  height_at_most: 34,
  aspect: 0.6,
  name_at_most: 150,
  column_room: 34,
};

/** Beyond which a whitened residual is large, as the result has it; those of earlier versions do not say it and mean 3. */
const limit_of = (study) => number_or_null(record(study.result.specimens).large_residual) ?? 3;
const rows_of = (study) => list(record(study.result.specimens).residuals).map(list);

function beyond(study) {
  const limit = limit_of(study);
  return rows_of(study).flatMap((row, specimen) =>
    row.flatMap((value, output) => (Math.abs(value) > limit ? [{ specimen, output, value }] : [])),
  );
}

/** Outliers as the result names them: `specimen` is the number of the row in the tests' file. */
const outliers_of = (study) => list(study.result.outliers).map(record);

function largest_of(study, specimen) {
  const row = rows_of(study).find((_, k) => specimen_number(study, k) === specimen) ?? [];
  return row
    .map((value, output) => ({ value, name: study.output_axes[output]?.name ?? `y${output + 1}` }))
    .filter(({ value }) => Math.abs(value) > 2)
    .sort((a, b) => Math.abs(b.value) - Math.abs(a.value))
    .slice(0, 3)
    .map(({ name, value }) => `${name}\u00a0${signed(value)}`)
    .join(", ");
}

function outlier_table(study, outliers) {
  const rows = outliers.map(({ specimen, distance, p_value }) => ({
    name: String(specimen),
    distance,
    p_value,
    largest: largest_of(study, Number(specimen)),
  }));
  return data_table({
    id: "outliers",
    title: "Specimens that stand out",
    columns: [
      { key: "name", title: "Specimen", is_text: true },
      { key: "distance", title: "Distance" },
      { key: "p_value", title: "p", text: p_value_text },
      { key: "largest", title: "Residuals beyond ±2", is_text: true, text: (text) => text || "–" },
    ],
    rows,
    caption:
      "Look at these specimens before anything else: a wrong bolt, a shifted sensor or a mistyped number in one of them moves " +
      "the estimates of all. Numbers are those of the rows in the tests' file, from 1.",
  });
}

function statement(study, found) {
  const total = rows_of(study).flat().filter(is_number).length;
  const limit = limit_of(study);
  const expected = record(study.result.specimens).expected_large;
  if (!found.length) return paragraph(`None of the ${plural(total, "residual")} lies beyond ±${limit}.`);
  const named = found
    .slice(0, 8)
    .map(
      ({ specimen, output, value }) =>
        `specimen ${specimen_number(study, specimen)} in ${study.output_axes[output]?.name} (${signed(value)})`,
    )
    .join(", ");
  return paragraph(
    `${plural(found.length, "residual")} of ${total} ${found.length === 1 ? "lies" : "lie"} beyond ±${limit}` +
      `${is_number(expected) ? `, where a right model would have ${short_number(expected, 2)} on average` : ""}: ${named}${found.length > 8 ? " …" : ""}.`,
  );
}

/** The map of the specimens `shown` (indices), outputs as rows. */
function map_of(study, shown, marked) {
  const rows = rows_of(study);
  const outputs = study.output_axes;
  const limit = limit_of(study);
  return matrix_map({
    name: "Whitened residual",
    rows: outputs.map(({ name }) => name),
    columns: shown.map((k) => `${specimen_number(study, k)}${marked.has(specimen_number(study, k)) ? "*" : ""}`),
    values: outputs.map((_, output) => shown.map((specimen) => rows[specimen][output])),
    low: -4,
    high: 4,
    ends: ["+4", "\u22124"],
    stops: () => diverging,
    is_deep: (value) => Math.abs(value) > 3.1,
    is_marked: (row, column, value) => Math.abs(value) > limit,
    cell,
    column_title: "Specimen",
    tooltip: (output, specimen, value) => [
      `Specimen ${specimen.replace("*", "")}`,
      `${output}: residual ${signed(value)}${Math.abs(value) > limit ? `, beyond ±${limit}` : ""}`,
    ],
  });
}

function residual_figure(study) {
  const outliers = new Set(outliers_of(study).map(({ specimen }) => Number(specimen)));
  return paged_figure({
    id,
    title: "Whitened residuals of every specimen",
    caption:
      `Columns are specimens, rows are outputs. Framed: beyond ±${limit_of(study)}` +
      `${outliers.size ? "; *: specimens that stand out" : ""}; empty: not measured.`,
    items: rows_of(study).map((_, k) => k),
    size: specimens_a_page,
    build: (shown, width) => map_of(study, shown, outliers)(width),
  });
}

export default {
  id: "specimens",
  title: "Residuals of every specimen",
  has_data: (study) => rows_of(study).some((row) => row.some(is_number)) || outliers_of(study).length > 0,
  explained: [
    [
      "Whitened residual",
      "Test minus mean of the model, decorrelated and scaled so that each is a standard normal number where the model is right. " +
        "A row of one colour is an output that the model misses; a column of strong colours is a specimen that does not belong to the others.",
    ],
  ],
  content(study) {
    const has_residuals = rows_of(study).some((row) => row.some(is_number));
    const outliers = outliers_of(study);
    return [
      has_residuals ? statement(study, beyond(study)) : null,
      has_residuals ? residual_figure(study) : null,
      outliers.length ? outlier_table(study, outliers) : null,
      Array.isArray(study.result.outliers) && !outliers.length
        ? paragraph("No specimen stands out from the others by its distance from them.")
        : null,
    ];
  },
};
