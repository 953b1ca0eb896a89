// The head of the report: what was studied, how it ended, and the counts that matter.
import { extent, is_number, list, record } from "../src/data.js";
import { bullets, element, facts_line, paragraph, prose } from "../src/dom.js";
import { count_text, number_text, words } from "../src/format.js";

const tone_of_status = {
  converged: "neutral", // how the iteration ended says nothing of the model
  "max-iterations": "doubtful",
  stalled: "doubtful",
  stopped: "doubtful",
  failed: "bad",
};

const range_text = ([low, high]) => (low === high ? number_text(low) : `${number_text(low)} to ${number_text(high)}`);

function facts_of_modes({ modes, source, title, result }) {
  const frequencies = extent(list(modes.list).map(({ frequency }) => frequency));
  const nodes = list(modes.node_ids).length;
  return [
    ["Model", source === title ? null : source],
    ["Modes", count_text(list(modes.list).length)],
    ["Frequencies", frequencies && `${range_text(frequencies)} ${modes.frequency_unit ?? ""}`.trim()],
    ["Nodes drawn", nodes ? count_text(nodes) : null],
    ["Units", result.units],
    ["Mottle", result.mottle],
  ];
}

function facts_of_result(study) {
  const { result, clouds, tests } = study;
  const n_test = result.sample_size?.n_test ?? (tests.length || null);
  const n_model = result.sample_size?.n_model ?? null;
  const last = study.iterations[study.iterations.length - 1];
  return [
    ["Method", result.method && words(result.method)],
    ["Iterations", study.is_update && study.has_iterations && last ? count_text(last.index) : null],
    ["Tests", is_number(n_test) ? count_text(n_test) : null],
    [
      "Samples a cloud",
      is_number(n_model) ? count_text(n_model) : clouds.length ? `${count_text(clouds[0].outputs.length)} shown` : null,
    ],
    ["Parameters", study.parameter_axes.length ? count_text(study.parameter_axes.length) : null],
    ["Outputs", study.output_axes.length ? count_text(study.output_axes.length) : null],
    ["Model evaluations", is_number(result.model_evaluations) ? count_text(result.model_evaluations) : null],
    ["Seed", result.seed === undefined || result.seed === null ? null : String(result.seed)],
    ["Units", result.units],
    ["Finished", record(result.timings_s).finished],
    ["Mottle", result.commit ? `${result.mottle} (${result.commit})` : result.mottle],
  ];
}

function facts(study) {
  const all = study.is_modes ? facts_of_modes(study) : facts_of_result(study);
  return all.filter(([, value]) => value !== null && value !== undefined && value !== "");
}

function kicker(study) {
  if (study.is_modes) return "Natural frequencies and mode shapes";
  return study.is_update ? "Stochastic model updating" : "Forward propagation of a model's scatter";
}

export default {
  content(study) {
    const { result } = study;
    const warnings = list(result.warnings);
    return element(
      "header",
      {},
      element("p", { class: "kicker" }, kicker(study)),
      element("h1", {}, study.title),
      result.status && !study.is_update ? paragraph(result.message ?? "") : null,
      result.status && study.is_update
        ? element(
            "p",
            { class: "status" },
            element(
              "span",
              { class: `badge ${tone_of_status[result.status] ?? "neutral"}`, "data-field": "status" },
              words(result.status),
            ),
            result.message ? ` ${result.message}` : null,
          )
        : null,
      facts_line(facts(study), study.unit_choice ? element("div", {}, element("dd", {}, study.unit_choice)) : null),
      study.summary.length
        ? element(
            "div",
            { class: "summary" },
            study.summary.map((line) => element("p", {}, prose(line))),
          )
        : null,
      warnings.length
        ? element("div", { class: "callout" }, element("b", {}, "Warnings"), bullets(warnings.map(prose)))
        : null,
    );
  },
};
