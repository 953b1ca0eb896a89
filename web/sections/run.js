// How the run was made: what it takes to make it again.
import { is_number, list, record } from "../src/data.js";
import { element } from "../src/dom.js";
import { count_text, seconds_text, short_number, words } from "../src/format.js";

/** {a: 1, b: {c: 2}} -> [["a", 1], ["b.c", 2]]. */
function flattened(options, prefix = "") {
  return Object.entries(options).flatMap(([key, value]) =>
    value && typeof value === "object" && !Array.isArray(value)
      ? flattened(value, `${prefix}${key}.`)
      : [[`${prefix}${key}`, value]],
  );
}

function value_text(value) {
  if (value === null || value === undefined) return "–";
  if (is_number(value)) return Number.isInteger(value) ? count_text(value) : short_number(value, 6);
  if (Array.isArray(value)) return value.map(value_text).join(", ");
  return typeof value === "boolean" ? (value ? "yes" : "no") : String(value);
}

const version_of = ({ mottle, commit }) => (mottle && commit ? `${mottle}, commit ${commit}` : mottle);

function block(title, entries, id) {
  if (!entries.length) return null;
  return element(
    "div",
    { class: "run-block" },
    element("h3", {}, title),
    element(
      "table",
      { class: "plain", "data-table": id },
      element(
        "tbody",
        {},
        entries.map(([name, value]) =>
          element("tr", {}, element("th", { scope: "row" }, name), element("td", { class: "number" }, value)),
        ),
      ),
    ),
  );
}

export default {
  id: "run",
  title: "How the run was made",
  has_data: ({ result }) =>
    Object.keys(record(result.options)).length > 0 ||
    Object.keys(record(result.timings_s)).length > 0 ||
    is_number(result.model_evaluations),
  content({ result }) {
    const counts = [
      ["Command", result.command && `mottle ${result.command}`],
      ["Method", result.method],
      ["Seed", result.seed === null || result.seed === undefined ? null : String(result.seed)],
      ["Mottle", version_of(result)],
      ["Finished", record(result.timings_s).finished],
      ["Result schema", value_text(result.schema)],
      ["Model evaluations", is_number(result.model_evaluations) ? count_text(result.model_evaluations) : null],
    ];
    return [
      element(
        "div",
        { class: "run-blocks" },
        block(
          "Run",
          counts.filter(([, value]) => value && value !== "–"),
          "run",
        ),
        block(
          "Options as used",
          flattened(record(result.options)).map(([name, value]) => [words(name), value_text(value)]),
          "options",
        ),
        block(
          "Files as read, with the first digits of their digests",
          [...list(result.study_files), ...list(result.model_files)]
            .map(record)
            .map(({ name, digest }) => [String(name), String(digest).slice(0, 12)]),
          "files",
        ),
        block(
          "Time",
          flattened(record(result.timings_s))
            .filter(([, value]) => is_number(value))
            .map(([name, value]) => [words(name), seconds_text(value)]),
          "timings",
        ),
      ),
    ];
  },
};
