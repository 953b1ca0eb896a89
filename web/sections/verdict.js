// Is the model right? In plain words, then the tests behind it.
import { is_number, list, record } from "../src/data.js";
import { bullets, element, paragraph, prose } from "../src/dom.js";
import { p_value_text, short_number, words } from "../src/format.js";
import { data_table } from "../src/table.js";

/** "adequate", "inadequate", "undecided", or null where there is no verdict; older results say true or false alone. */
function conclusion_of({ conclusion, adequate }) {
  if (["adequate", "inadequate", "undecided"].includes(conclusion)) return conclusion;
  return adequate === true ? "adequate" : adequate === false ? "inadequate" : null;
}

function statement(verdict, study) {
  const level = is_number(verdict.level) ? `${short_number(100 * verdict.level)}\u00a0%` : null;
  const at_level = level ? ` A right model would be refused like this in ${level} of cases at most.` : "";
  switch (conclusion_of(verdict)) {
    case "adequate":
      return {
        tone: "good",
        sign: "✓",
        word: "Adequate",
        text:
          "The model, with the parameters found below, explains the tests: it was tested, and none of the checks refuses it." +
          (level ? ` Level of the whole verdict: ${level}.` : ""),
      };
    case "inadequate":
      return {
        tone: "bad",
        sign: "✗",
        word: "Inadequate",
        text:
          "With the parameters that were updated, the model does not explain the tests. Something that was not updated varies, " +
          `or is wrong: do not take the estimates below as physical values.${at_level}`,
      };
    case "undecided":
      return {
        tone: "open",
        sign: "?",
        word: "Undecided",
        text:
          "No test refuses the model, but too little of it could be tested to call it right: a wrong model may explain these tests " +
          "equally well, with other parameters.",
      };
    default:
      return {
        tone: "neutral",
        sign: "–",
        word: "No verdict",
        text:
          study.tests.length || has_test_means(study)
            ? "The result says nothing about whether the model is right."
            : "There are no test data to compare the model with: this page shows what the model predicts.",
      };
  }
}

const has_test_means = (study) => list(study.outputs.test_mean).some(is_number);

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

export default {
  id: "verdict-section",
  title: "Verdict",
  has_data: (study) => !study.is_modes,
  explained: [
    [
      "Verdict",
      "Adequate when the model was tested and the whole set of checks, at one common false-alarm rate, does not refuse it; undecided " +
        "when nothing, or not enough, could be tested. Numbers can look right in a wrong model, so read this first.",
    ],
  ],
  content(study) {
    const verdict = record(study.result.verdict);
    const { tone, sign, word, text } = statement(verdict, study);
    const tests = list(verdict.tests).map(record);
    const reasons = list(verdict.reasons).map(prose);
    const not_tested = list(verdict.not_tested).map(prose);
    const hidden = list(verdict.could_hide).map(record);
    const notes = list(study.result.notes);
    return [
      element(
        "div",
        { class: `verdict ${tone}`, "data-verdict": conclusion_of(verdict) ?? "none" },
        element("span", { class: "sign", "aria-hidden": "true" }, sign),
        element(
          "div",
          {},
          element("p", { class: "verdict-word" }, word),
          paragraph(text),
          reasons.length ? bullets(reasons, { class: "reasons" }) : null,
          not_tested.length
            ? [element("p", { class: "list-head" }, "What was not tested"), bullets(not_tested, { class: "not-tested" })]
            : null,
        ),
      ),
      tests.length ? tests_table(tests) : null,
      hidden.length ? could_hide_table(hidden) : null,
      notes.length
        ? element(
            "div",
            { class: "notes" },
            notes.map((note) => paragraph(prose(note))),
          )
        : null,
    ];
  },
};
