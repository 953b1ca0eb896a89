// Is the model right? In plain words, then the tests behind it.
import { is_number, list, record } from "../src/data.js";
import { bullets, element, paragraph, prose } from "../src/dom.js";
import { p_value_text, short_number, words } from "../src/format.js";
import { data_table } from "../src/table.js";

function statement(verdict, study) {
  const level = is_number(verdict.level) ? `${short_number(100 * verdict.level)}\u00a0%` : null;
  const at_level = level ? ` A right model would be refused like this in ${level} of cases at most.` : "";
  if (verdict.adequate === true) {
    return {
      tone: "good",
      sign: "✓",
      word: "Adequate",
      text:
        list(verdict.tests).length === 0
          ? "Nothing found speaks against the model with the parameters below, but no statistical check was made of it."
          : "The model, with the parameters found below, explains the tests: none of the checks refuses it." +
            (level ? ` Level of the whole verdict: ${level}.` : ""),
    };
  }
  if (verdict.adequate === false) {
    return {
      tone: "bad",
      sign: "✗",
      word: "Inadequate",
      text:
        "With the parameters that were updated, the model does not explain the tests. Something that was not updated varies, " +
        `or is wrong: do not take the estimates below as physical values.${at_level}`,
    };
  }
  return {
    tone: "neutral",
    sign: "–",
    word: "No verdict",
    text:
      study.tests.length || has_test_means(study)
        ? "The result says nothing about whether the model is right."
        : "There are no test data to hold the model against: this page shows what the model predicts.",
  };
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
      { key: "meaning", title: "What it says", is_text: true, of_class: () => "prose" },
    ],
    rows: tests,
  });
}

export default {
  id: "verdict-section",
  title: "Verdict",
  has_data: (study) => !study.is_modes,
  explained: [
    [
      "Verdict",
      "Adequate when the whole set of checks, at one common false-alarm rate, does not refuse the model; " +
        "numbers can look right in a wrong model, so read this first.",
    ],
  ],
  content(study) {
    const verdict = record(study.result.verdict);
    const { tone, sign, word, text } = statement(verdict, study);
    const tests = list(verdict.tests).map(record);
    const reasons = list(verdict.reasons).map(prose);
    const notes = list(study.result.notes);
    return [
      element(
        "div",
        { class: `verdict ${tone}`, "data-verdict": String(verdict.adequate ?? null) },
        element("span", { class: "sign", "aria-hidden": "true" }, sign),
        element(
          "div",
          {},
          element("p", { class: "verdict-word" }, word),
          paragraph(text),
          reasons.length ? bullets(reasons, { class: "reasons" }) : null,
        ),
      ),
      tests.length ? tests_table(tests) : null,
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
