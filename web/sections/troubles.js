// What went wrong on the way: evaluations that failed and draws that were thrown away.
import { is_number, list, record } from "../src/data.js";
import { element, paragraph } from "../src/dom.js";
import { count_text, plural } from "../src/format.js";

const listed_at_most = 20;

function by_reason(failures) {
  const groups = new Map();
  for (const { reason, sample, iteration } of failures) {
    const key = String(reason ?? "no reason given");
    const place = is_number(iteration) ? `${iteration}:${sample ?? "?"}` : String(sample ?? "?");
    groups.set(key, [...(groups.get(key) ?? []), place]);
  }
  return [...groups].sort(([, a], [, b]) => b.length - a.length);
}

function samples_text(samples) {
  const shown = samples.slice(0, 8).join(", ");
  return samples.length > 8 ? `${shown} … (${count_text(samples.length)})` : shown;
}

function failures_part(failures, evaluations) {
  if (!failures.length) return paragraph("No model evaluation failed.");
  const groups = by_reason(failures);
  const share =
    is_number(evaluations) && evaluations > 0
      ? ` of ${count_text(evaluations)} (${((100 * failures.length) / evaluations).toFixed(2)} %)`
      : "";
  return [
    paragraph(
      `${plural(failures.length, "model evaluation")}${share} failed and ${failures.length === 1 ? "was" : "were"} left out. ` +
        "Samples that fail are seldom a random choice: the cloud may be biased where they lie.",
    ),
    element(
      "div",
      { class: "table-scroll" },
      element(
        "table",
        { "data-table": "failures" },
        element(
          "thead",
          {},
          element(
            "tr",
            {},
            [
              "Reason",
              "Count",
              failures.some(({ iteration }) => is_number(iteration)) ? "Iteration:sample" : "Sample",
            ].map((head, i) => element("th", { scope: "col", class: i === 1 ? "number" : null }, head)),
          ),
        ),
        element(
          "tbody",
          {},
          groups
            .slice(0, listed_at_most)
            .map(([reason, samples]) =>
              element(
                "tr",
                {},
                element("td", { class: "prose" }, reason),
                element("td", { class: "number" }, count_text(samples.length)),
                element("td", {}, samples_text(samples)),
              ),
            ),
        ),
      ),
    ),
    groups.length > listed_at_most
      ? paragraph(`${plural(groups.length - listed_at_most, "further reason")} in result.json.`)
      : null,
  ];
}

export default {
  id: "troubles",
  title: "Failed evaluations and rejected draws",
  has_data: ({ result }) => Array.isArray(result.failed_evaluations) || is_number(record(result.rejected_draws).count),
  content({ result }) {
    const rejected = record(result.rejected_draws);
    const rule = rejected.rule ? ` Rule: ${String(rejected.rule).replace(/\.$/, "")}.` : "";
    return [
      Array.isArray(result.failed_evaluations)
        ? failures_part(list(result.failed_evaluations).map(record), result.model_evaluations)
        : null,
      is_number(rejected.count)
        ? paragraph(
            rejected.count > 0
              ? `${plural(rejected.count, "draw")} ${rejected.count === 1 ? "was" : "were"} rejected before the model ran.${rule}`
              : `No draw was rejected.${rule}`,
          )
        : null,
    ];
  },
};
