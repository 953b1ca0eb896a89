// The head of the report: what was studied, how it ended, and the counts that matter.
import { is_number, list } from "../src/data.js";
import { bullets, element, prose } from "../src/dom.js";
import { count_text, words } from "../src/format.js";

const tone_of_status = {
  converged: "good",
  "max-iterations": "doubtful",
  stalled: "doubtful",
  stopped: "doubtful",
  failed: "bad",
};

function facts(study) {
  const { result, clouds, tests } = study;
  const n_test = result.sample_size?.n_test ?? (tests.length || null);
  const n_model = result.sample_size?.n_model ?? null;
  const last = study.iterations[study.iterations.length - 1];
  return [
    ["Method", result.method && words(result.method)],
    ["Iterations", study.is_update && last ? count_text(last.index) : null],
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
    ["Mottle", result.mottle],
  ].filter(([, value]) => value !== null && value !== undefined && value !== "");
}

export default {
  content(study) {
    const { result } = study;
    const warnings = list(result.warnings);
    return element(
      "header",
      {},
      element(
        "p",
        { class: "kicker" },
        study.is_update ? "Stochastic model updating" : "Forward propagation of a model's scatter",
      ),
      element("h1", {}, study.title),
      result.status
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
      element(
        "dl",
        { class: "facts" },
        facts(study).map(([term, value]) => element("div", {}, element("dt", {}, term), element("dd", {}, value))),
      ),
      warnings.length
        ? element("div", { class: "callout" }, element("b", {}, "Warnings"), bullets(warnings.map(prose)))
        : null,
    );
  },
};
