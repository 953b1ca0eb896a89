// What the conclusion rests on: what was tested and what was not, the checks, the errors that could hide, and the notes.
import { is_number, list, record } from "../src/data.js";
import { bullets, element, paragraph, prose } from "../src/dom.js";
import { p_value_text, plural, short_number, words } from "../src/format.js";
import { data_table } from "../src/table.js";

/** "mean-residuals" is how a result names a check. */
const check_name = (name) => (/^[a-z0-9-]+$/.test(name ?? "") ? words(name) : (name ?? "–"));

function tests_table(tests) {
  return data_table({
    id: "verdict",
    title: "Checks behind the verdict",
    columns: [
      { key: "name", title: "Check", is_text: true, text: check_name },
      { key: "statistic", title: "Statistic" },
      { key: "critical", title: "Critical value" },
      { key: "p_value", title: "p", text: p_value_text },
      {
        key: "passed",
        title: "Outcome",
        is_text: true,
        csv: (row) => row.passed,
        of_class: (row) => (row.passed === false ? "flag" : null),
        text: (passed) => (passed === true ? "✓ passed" : passed === false ? "✗ refused" : "– not run"),
      },
      { key: "meaning", title: "Meaning", is_text: true, of_class: () => "prose" },
    ],
    rows: tests,
  });
}

/** A part of the number; of one that is zero in the model the change itself. */
function off_by(relative_change, row) {
  if (is_number(relative_change)) return `${short_number(100 * relative_change, 3)}\u00a0%`;
  return is_number(row.change) ? short_number(row.change, 3) : "–";
}

function refused_text(is_detected, row) {
  if (!is_detected) return "never refuses it";
  return row.assumes_estimated_noise
    ? "would refuse it in 80\u00a0% of cases if the noise were known; it is estimated, and fewer are refused"
    : "refuses it in 80\u00a0% of cases";
}

/** "k1 by 1.4, k2 by 0.3", largest first. */
const moves_text = (moves) =>
  list(moves)
    .map(record)
    .filter(({ half_widths }) => is_number(half_widths) && Math.abs(half_widths) >= 0.01)
    .sort((one, other) => Math.abs(other.half_widths) - Math.abs(one.half_widths))
    .slice(0, 3)
    .map(({ parameter, half_widths }) => `${parameter} by ${short_number(half_widths, 3)}`)
    .join(", ") || "–";

/** What may be wrong in the model and not be noticed. */
function could_hide_table(hidden) {
  return data_table({
    id: "could-hide",
    title: "Errors of the model that the verdict could miss",
    columns: [
      { key: "name", title: "Fixed quantity", is_text: true },
      { key: "nominal", title: "In the model" },
      { key: "relative_change", title: "Off by", text: off_by },
      {
        key: "is_detected",
        title: "The test of the means",
        is_text: true,
        csv: (row) => row.is_detected,
        text: refused_text,
      },
      { key: "would_move", title: "Moves a mean, in half-widths of its 95\u00a0% interval", is_text: true, text: moves_text, csv: (row) => moves_text(row.would_move) },
    ],
    rows: hidden,
    caption:
      "Smaller errors pass more often. Where a mean moves by more than 1, its interval misses the true value: it is valid for a right model only. " +
      "Shifts are of first order: one beyond a prior standard deviation only shows that the error is harmful.",
  });
}

const fold = (content, title) => element("details", { class: "fold" }, element("summary", {}, title), content);

function sentences(title, kind, texts) {
  if (!list(texts).length) return null;
  return element(
    "div",
    { class: "sentences" },
    element("h3", {}, title),
    bullets(list(texts).map(prose), { class: kind }),
  );
}

function level_text({ level }, tests) {
  if (!is_number(level) || !tests.length) return null;
  return paragraph(
    `False-alarm rate of all checks together: ${short_number(100 * level)}\u00a0%. A right model would be refused in so many cases at most.`,
  );
}

function notes(texts) {
  if (!texts.length) return null;
  return element(
    "details",
    { class: "fold notes" },
    element("summary", {}, plural(texts.length, "note")),
    texts.map((note) => paragraph(prose(note))),
  );
}

export default {
  id: "verdict-section",
  title: "What the conclusion rests on",
  is_in_print: true,
  has_data: (study) => {
    const { tests, reasons, not_tested, could_hide } = record(study.result.verdict);
    return [tests, reasons, not_tested, could_hide, study.result.notes].some((part) => list(part).length > 0);
  },
  explained: [
    [
      "Verdict",
      "Adequate when the model was tested and the whole set of checks, at one common false-alarm rate, does not refuse it; undecided " +
        "when nothing, or not enough, could be tested. Numbers can look right in a wrong model, so read this first.",
    ],
  ],
  content(study) {
    const verdict = record(study.result.verdict);
    const tests = list(verdict.tests).map(record);
    const hidden = list(verdict.could_hide).map(record);
    return [
      sentences("What was tested", "reasons", verdict.reasons),
      sentences("What was not tested", "not-tested", verdict.not_tested),
      level_text(verdict, tests),
      tests.length ? tests_table(tests) : null,
      hidden.length ? fold(could_hide_table(hidden), `Errors of the model that the verdict could miss: ${hidden.length}`) : null,
      notes(list(study.result.notes)),
    ];
  },
};
