// The page of `mottle diagnose`: which candidate explains what the parameters cannot. Every number is one of diagnosis.json.
import { coloured_model } from "./src/coloured_model.js";
import { is_number, list, number_or_null, record } from "./src/data.js";
import { explained_bars, residual_bars } from "./src/diagnosis_bars.js";
import { bullets, button, definitions, element, facts_line, paragraph, prose } from "./src/dom.js";
import { count_text, number_text, p_value_text, plural, seconds_text, short_number } from "./src/format.js";
import { read_structure } from "./src/structure.js";
import { data_table } from "./src/table.js";

/** The fit in the model itself where there is one, else the linear answer. */
function read_candidate(source) {
  const candidate = record(source);
  const is_fitted = candidate.fitted === true;
  const answer = record(is_fitted ? candidate[candidate.best] : candidate.linear);
  const kind = is_fitted ? candidate.best : answer.kind;
  return {
    name: String(candidate.name ?? "–"),
    others: list(candidate.inseparable).map(String),
    is_fitted,
    is_random: kind === "freed",
    is_possible: answer.possible !== false,
    failure: answer.failure ? String(answer.failure) : null,
    needed: number_or_null(answer.needed),
    gain: number_or_null(answer.gain),
    bic: number_or_null(answer.bic),
    p: number_or_null(answer.adjusted_p_value),
    nominal: number_or_null(candidate.nominal),
    mean: number_or_null(answer.mean),
    std: number_or_null(answer.std),
    visibility: number_or_null(candidate.visibility),
    own_share: number_or_null(candidate.own_share),
    residuals: list(candidate.residuals),
  };
}

/** Candidates that cannot be told apart are one line, under the name of the best. */
function lines_of(candidates) {
  const named = new Set();
  return candidates.filter(({ name, others }) => {
    if (named.has(name)) return false;
    others.forEach((other) => named.add(other));
    return true;
  });
}

const section = (id, title, ...content) =>
  element("section", { id, class: "in-print", "aria-labelledby": `${id}-title` }, element("h2", { id: `${id}-title` }, title), content);

function head(result, candidates) {
  const facts = [
    ["Parameters", list(record(result.parameters).names).join(", ")],
    ["Candidates", count_text(candidates.length)],
    ["Fitted in the model", count_text(candidates.filter(({ is_fitted }) => is_fitted).length)],
    ["Level", is_number(result.level) ? String(result.level) : null],
    ["Model evaluations", is_number(result.model_evaluations) ? count_text(result.model_evaluations) : null],
    ["Time", is_number(record(result.timings_s).total) ? seconds_text(result.timings_s.total) : null],
    ["Mottle", result.commit ? `${result.mottle} (${result.commit})` : result.mottle],
  ].filter(([, value]) => value);
  return element(
    "header",
    {},
    element("p", { class: "kicker" }, "Diagnosis: what is missing among the parameters"),
    element("h1", {}, String(result.title ?? "").trim() || "Untitled study"),
    facts_line(facts),
  );
}

const sentences_at_first = 2;

/** What else there is to say, most of it on demand: the drawings belong on the first screen. */
function further(sentences) {
  const rest = sentences.slice(sentences_at_first);
  const texts = (some) => bullets(some.map(prose), { class: "summary-list" });
  return [
    texts(sentences.slice(0, sentences_at_first)),
    rest.length
      ? element("details", { class: "fold" }, element("summary", {}, plural(rest.length, "further sentence")), texts(rest))
      : null,
  ];
}

/** The answer in one sentence, and under it what else there is to say. */
function statement(result) {
  const is_linear = result.stage === "linear";
  const state = is_linear ? "linear" : result.explained === true ? "explained" : "not-explained";
  const sign = { linear: "≈", explained: "→", "not-explained": "–" }[state];
  return element(
    "div",
    { class: `verdict ${state === "explained" ? "neutral" : "open"}`, "data-answer": state },
    element("span", { class: "sign", "aria-hidden": "true" }, sign),
    element(
      "div",
      {},
      element("p", { class: "verdict-word" }, String(result.headline ?? "")),
      further(list(result.sentences)),
      is_linear ? paragraph("The fits in the model itself go on, and this page is then written again.") : null,
    ),
  );
}

function model_card(model, candidates) {
  const structure = model ? read_structure(model) : null;
  if (!structure || !structure.parts.length) return null;
  const largest = Math.max(0, ...candidates.map(({ gain }) => gain ?? 0)) || 1;
  const shares = new Map(candidates.map(({ name, gain }) => [name, Math.max(0, gain ?? 0) / largest]));
  return element("div", { class: "card" }, coloured_model(structure, shares, candidates[0]?.name));
}

/** The candidate, and under it what keeps it from being the answer. */
const name_text = (name, { others, is_possible, needed }) => [
  name,
  others.length ? element("div", { class: "note" }, `cannot be told apart from ${others.join(", ")}`) : null,
  is_possible ? null : element("div", { class: "note flag-text" }, `✗ would need ${short_number(needed)}, which cannot be`),
];

function candidates_table(lines) {
  const failed = lines.filter(({ failure }) => failure);
  const columns = [
    { key: "name", title: "Candidate", is_text: true, text: name_text },
    {
      key: "is_fitted",
      title: "Answer",
      is_text: true,
      text: (is_fitted) => element("span", { class: `badge ${is_fitted ? "neutral" : "doubtful"}` }, is_fitted ? "fitted" : "linear"),
    },
    { key: "gain", title: "Explains", text: (value) => number_text(value, 3) },
    { key: "bic", title: "BIC", text: (value) => number_text(value, 3) },
    { key: "p", title: "p (Holm)", text: p_value_text },
    { key: "nominal", title: "Nominal" },
    { key: "mean", title: "Mean" },
    { key: "std", title: "Std. dev.", text: (value, { is_random }) => (is_random ? number_text(value, 3) : "fixed") },
    { key: "visibility", title: "Sensitivity", text: (value) => number_text(value, 3) },
    { key: "own_share", title: "Independent", text: (value) => (is_number(value) ? value.toFixed(3) : "–") },
  ];
  const reasons = failed.map(({ name, failure }) => `${name}: ${failure}`).join("; ");
  return data_table({
    id: "candidates",
    title: "Candidates, the best explanation first",
    columns,
    rows: lines.filter(({ failure }) => !failure),
    all_rows: lines,
    caption: reasons ? `Without an answer: ${reasons}.` : null,
  });
}

function residuals_section(result, best) {
  const { names } = record(result.outputs);
  const before = list(record(result.parameters).residuals);
  if (!best || !before.some(is_number)) return null;
  const rows = list(names).map((name, k) => ({
    name: String(name),
    before: number_or_null(before[k]),
    after: number_or_null(best.residuals[k]),
  }));
  return section(
    "residuals",
    "Residuals explained",
    residual_bars(rows, best.name),
    data_table({
      id: "residuals",
      title: "Means of the tests less those of the fit, in standard errors of the tests' means",
      columns: [
        { key: "name", title: "Output", is_text: true },
        { key: "before", title: "Parameters alone", text: (value) => number_text(value, 3) },
        { key: "after", title: `With ${best.name}`, text: (value) => number_text(value, 3) },
      ],
      rows,
    }),
  );
}

function proposal(result) {
  const text = String(result.proposed_toml ?? "").trim();
  if (!text) return null;
  return section(
    "proposal",
    "Lines for the study",
    paragraph("With these parameters added, update again, and check the result with tests that were kept back."),
    element(
      "div",
      { class: "next" },
      element("span", { class: "tools" }, button("Copy", "Copy these lines", () => navigator.clipboard?.writeText(text))),
      element("pre", {}, text),
    ),
  );
}

const terms = [
  ["Explains", "The increase of the tests' log-likelihood when the candidate is estimated beside the parameters."],
  [
    "Linear and fitted",
    "Linear: by the derivatives at the fit of the parameters alone, for all candidates. Fitted: estimated in the model itself.",
  ],
  ["BIC", "With the candidate less without it: negative is better, \u221210 is strong evidence."],
  ["Sensitivity", "By how many standard errors one prior standard deviation of the candidate moves the tests' means."],
  ["Independent", "The part of that effect which the parameters cannot reproduce."],
];

const glossary = () => element("footer", { id: "glossary" }, element("h2", {}, "How to read this page"), definitions(terms));

export function compose_diagnosis(main, data) {
  const result = record(data.result);
  const candidates = list(result.candidates).map(read_candidate);
  const lines = lines_of(candidates);
  const best = lines.find(({ failure }) => !failure);
  document.title = `Diagnosis of ${result.title ?? "a study"} – Mottle`;
  document.documentElement.classList.add("print-all");
  main.classList.add("single");
  main.append(
    element(
      "div",
      { class: "body" },
      head(result, candidates),
      section(
        "answer",
        "Answer",
        statement(result),
        element(
          "div",
          { class: "first-screen" },
          element("div", { class: "card" }, explained_bars(lines.filter(({ failure }) => !failure))),
          model_card(data.model, candidates),
        ),
      ),
      section("candidates", "Candidates", candidates_table(lines)),
      residuals_section(result, best),
      proposal(result),
      glossary(),
    ),
  );
}
