// The first screen: the conclusion, the errors of means and scatter before and after, the parameters, what to run next.
import { agreement_rows, conclusion_of, findings_of, is_not_reproduced } from "../src/agreement.js";
import { mean_text, of_tests, refused } from "../src/agreement_text.js";
import { is_number, list, record } from "../src/data.js";
import { bullets, button, element, paragraph, prose } from "../src/dom.js";
import { short_number } from "../src/format.js";
import { by_attention, parameter_bars } from "../src/parameter_bars.js";
import { answer_kind } from "../src/population.js";
import { data_table } from "../src/table.js";
import { batch_figure, batch_table } from "./assignments.js";
import { densities_figure } from "./densities.js";
import { cover_figure } from "./interval.js";

const outputs_at_most = 8;
const parameters_at_most = 8;

const words_of = {
  adequate: {
    sign: "✓",
    word: "Adequate",
    tone: "good",
    text: "The model, with these parameters, was tested, and no test refuses it.",
  },
  inadequate: {
    sign: "✗",
    word: "Inadequate",
    tone: "bad",
    text:
      "With the parameters that were updated, the model does not explain the tests: something that was not updated varies, or is " +
      "wrong. Do not take the estimates as physical values.",
  },
  undecided: {
    sign: "?",
    word: "Undecided",
    tone: "open",
    text: "No test refuses the model, but too little of it could be tested to call it right.",
  },
};
const no_verdict = {
  sign: "–",
  word: "No verdict",
  tone: "neutral",
  text: "The result says nothing about whether the model is right.",
};

/** Green only where the result itself is reassuring; what is not reproduced is never shown as undecided alone. */
function tone_of(study, conclusion, given) {
  if (is_not_reproduced(study)) return conclusion === "adequate" ? "open" : "bad";
  return conclusion === "adequate" && record(study.result.verdict).is_reassuring === false ? "open" : given;
}

/** Kinds of causes that are a test which refused the model. */
const refusals = ["means", "scatter", "bounds", "prior-shift", "cover"];

/** What the verdict comes from: a cross where a test refused the model, else a mark of doubt. */
function causes_of(verdict) {
  const causes = list(verdict.causes).map(record);
  if (!causes.length) return null;
  return element(
    "ul",
    { class: "causes" },
    causes.map(({ kind, sentence }) => {
      const is_refusal = refusals.includes(kind);
      return element(
        "li",
        { class: is_refusal ? "flag-text" : null, "data-cause": kind },
        element("span", { class: "cause-sign", "aria-hidden": "true" }, is_refusal ? "✗" : "!"),
        prose(String(sentence ?? "")),
      );
    }),
  );
}

function summary_of({ summary }) {
  return list(summary).length ? bullets(list(summary).map(prose), { class: "summary-list" }) : null;
}

function statement(study) {
  const verdict = record(study.result.verdict);
  const conclusion = conclusion_of(verdict);
  const { sign, word, tone, text } = words_of[conclusion] ?? no_verdict;
  return element(
    "div",
    { class: `verdict ${tone_of(study, conclusion, tone)}`, "data-verdict": conclusion ?? "none" },
    element("span", { class: "sign", "aria-hidden": "true" }, sign),
    element(
      "div",
      {},
      element(
        "p",
        { class: "verdict-word" },
        word,
        verdict.headline ? element("span", { class: "headline" }, ` – ${verdict.headline}`) : null,
      ),
      verdict.headline ? null : paragraph(text),
      verdict.answer ? element("p", { class: "answer" }, prose(String(verdict.answer))) : null,
      causes_of(verdict),
      answer_kind(study) ? null : summary_of(verdict),
    ),
  );
}

/** Before and after of one quantity; what is not reproduced after is flagged. */
function pair_of_columns({ keys, field, group, text, claim }) {
  const column = (key, which, title, more) => ({
    key,
    title,
    group,
    csv: (row) => row[which][field],
    text: (_, row) => text(row[which], row),
    ...more,
  });
  return [
    column(keys[0], "initial", "before", {}),
    column(keys[1], "final", "after", {
      text: (_, row) => refused(row[claim], text(row.final, row)),
      of_class: (row) => (row[claim] === false ? "flag" : null),
    }),
  ];
}

function output_table(study, rows) {
  const means = {
    keys: ["m0", "m1"],
    field: "mean_error",
    group: "Error of the mean",
    text: (cloud, row) => mean_text(cloud, row.unit),
    claim: "is_mean_reproduced",
  };
  const scatter = {
    keys: ["s0", "s1"],
    field: "std_ratio",
    group: "Std. dev., % of the tests'",
    text: (cloud) => of_tests(cloud.std_ratio),
    claim: "is_scatter_reproduced",
  };
  return data_table({
    id: "agreement",
    is_stacked: false,
    title: "Model against tests, the worst output first",
    columns: [{ key: "name", title: "Output", is_text: true }, ...pair_of_columns(means), ...pair_of_columns(scatter)],
    rows: rows.slice(0, outputs_at_most),
    all_rows: rows,
    caption: caption_of(study, rows),
  });
}

function caption_of({ result }, rows) {
  const { chance, region } = record(result.agreement);
  const { tests, initial_inside, final_inside, probability, is_reproduced } = record(region);
  const inside = is_number(final_inside)
    ? [
        element(
          "span",
          { class: is_reproduced === false ? "flag-text" : null, "data-field": "inside" },
          `${is_reproduced === false ? "✗ " : ""}${final_inside} of ${tests} tests`,
        ),
        ` lie within the updated model's ${short_number(100 * probability)}\u00a0% region${is_number(initial_inside) ? `, ${initial_inside} before` : ""}. `,
      ]
    : [];
  return [
    ...inside,
    `✗: beyond what chance allows in ${short_number(100 * (chance ?? 0.01))} of 100 cases, all outputs together.`,
    ` Before: the first cloud, drawn from the prior. Standard deviations are those of the model with the measurement's noise, where that is stated or estimated; the table of outputs has the model's alone.`,
    rows.length > outputs_at_most ? ` All ${rows.length} outputs are in the table of outputs.` : "",
  ];
}

function parameter_part(study) {
  const findings = findings_of(study);
  const drawn = findings.filter(
    ({ estimate, prior, prior_mean }) => is_number(estimate) || prior || is_number(prior_mean),
  );
  if (!drawn.length) return null;
  const shown = drawn.length > parameters_at_most ? by_attention(drawn).slice(0, parameters_at_most) : drawn;
  const rest = by_attention(drawn).slice(parameters_at_most);
  return element(
    "div",
    { class: "card" },
    element("h3", {}, "Parameters"),
    parameter_bars(shown),
    rest.length
      ? element(
          "details",
          { class: "fold" },
          element("summary", {}, `${rest.length} further parameters`),
          parameter_bars(rest),
        )
      : null,
  );
}

/** What stands first of a method that answers another question than for a mean and a scatter. */
const answers = {
  batches: (study) => [batch_figure(study), element("div", { class: "card" }, batch_table(study))],
  box: (study) => [cover_figure(study), parameter_part(study)],
  posterior: (study) => [densities_figure(study)],
};

const side_by_side = (parts, more = {}) =>
  parts.some(Boolean) ? element("div", { class: "first-screen", ...more }, parts) : null;

function step(text, is_first) {
  const { command, reason } = record(text);
  const copy = command ? button("Copy", "Copy this command", () => navigator.clipboard?.writeText(command)) : null;
  return element(
    "div",
    { class: "next-step" },
    element("b", {}, is_first ? "Next: " : "Then: "),
    command ? [element("code", {}, command), " ", element("span", { class: "tools" }, copy), " "] : null,
    element("span", {}, prose(reason ?? "")),
  );
}

export function next_steps(steps) {
  if (!steps.length) return null;
  return element(
    "div",
    { class: "next" },
    steps.map((one, k) => step(one, k === 0)),
  );
}

/** The page of a diagnosis beside the report; a name is no markup and no scheme. */
function diagnosis_link({ diagnosis }) {
  if (!diagnosis) return null;
  const address = diagnosis.split("/").map(encodeURIComponent).join("/");
  const link = element("a", { href: address, "data-link": "diagnosis" }, "diagnosis");
  return element("p", { class: "note" }, "Which further parameter explains these tests is in the ", link, ".");
}

export default {
  id: "conclusion",
  title: "Conclusion",
  is_in_print: true,
  has_data: (study) => !study.is_modes && !study.is_propagation,
  explained: [
    [
      "Marks of parameters",
      "Found: the tests determine it, if the model is right. Mean only: the method does not estimate its scatter. At bound: the bound " +
        "stopped it. Not seen: what is known of it comes from the prior. Doubtful: a test refused the model, or the update did not converge.",
    ],
    [
      "Region of the model",
      "What contains 95\u00a0% of the model's outputs, known noise included, taken as normal. If the model were right, about that share of the tests would lie in it.",
    ],
  ],
  content(study) {
    const verdict = record(study.result.verdict);
    const kind = answer_kind(study);
    const rows = kind === "box" ? [] : agreement_rows(study); // a box has no mean and no scatter to compare
    const answer = kind ? side_by_side(answers[kind](study), { "data-answer": kind }) : null; // first, as it is numbered
    const comparison = [
      rows.length ? element("div", { class: "card" }, output_table(study, rows)) : null,
      kind === "box" ? null : parameter_part(study),
    ];
    return [
      statement(study),
      answer,
      kind && list(verdict.next).length ? next_steps(list(verdict.next)) : null,
      kind ? summary_of(verdict) : null,
      side_by_side(comparison),
      kind ? null : next_steps(list(verdict.next)),
      diagnosis_link(study),
    ];
  },
};
