// The page of `propagate`: what the model gives for the scatter that was put in. Nothing is compared with tests here.
import { is_number, list, number_or_null, record, standard_deviations } from "../src/data.js";
import { element, paragraph } from "../src/dom.js";
import { number_text, percent_text, plural, short_number } from "../src/format.js";
import { data_table } from "../src/table.js";
import { next_steps } from "./conclusion.js";

const named_influences = 3;
const weakest_named = 0.1;

/** "k5 +0.91, k1 −0.30": rank correlations with the parameters, strongest first. */
function influences({ result, parameter_axes }, output) {
  const named = parameter_axes
    .map(({ index, name }) => ({ name, rho: number_or_null(list(list(result.spearman)[index])[output]) }))
    .filter(({ rho }) => is_number(rho) && Math.abs(rho) >= weakest_named)
    .sort((a, b) => Math.abs(b.rho) - Math.abs(a.rho));
  const text = ({ name, rho }) => `${name}\u00a0${rho < 0 ? "\u2212" : "+"}${Math.abs(rho).toFixed(2)}`;
  return named.slice(0, named_influences).map(text).join(", ") || "–";
}

function rows_of(study) {
  const { outputs, output_axes } = study;
  const deviations = standard_deviations(outputs.initial_covariance);
  return output_axes.map(({ index, name, unit }) => ({
    name,
    unit,
    initial_mean: number_or_null(list(outputs.initial_mean)[index]),
    std: number_or_null(deviations[index]),
    variation: number_or_null(list(outputs.coefficient_of_variation)[index]),
    interval: list(list(outputs.interval95)[index]),
    influences: influences(study, index),
  }));
}

const interval_text = (ends) =>
  ends.filter(is_number).length === 2 ? `${number_text(ends[0])} … ${number_text(ends[1])}` : "–";

function output_table(study) {
  const rows = rows_of(study);
  return data_table({
    id: "outputs",
    title: "What the model gives",
    columns: [
      { key: "name", title: "Output", is_text: true },
      { key: "unit", title: "Unit", is_text: true },
      { key: "initial_mean", title: "Mean" },
      { key: "std", title: "Std. dev." },
      {
        key: "variation",
        title: "Std. dev. / mean",
        text: (value) => (is_number(value) ? percent_text(100 * value, 2).replace("+", "") : "–"),
      },
      {
        key: "interval",
        title: "95\u00a0% of the samples",
        text: interval_text,
        csv: ({ interval }) => interval.join(" to "),
      },
      { key: "influences", title: "Rank correlation with", is_text: true, of_class: () => "prose" },
    ].filter(({ key }) => rows.some((row) => (key === "interval" ? row.interval.length : row[key] || row[key] === 0))),
    rows,
    caption: "Parameters are named by the strength of their rank correlation with the output, the strongest first.",
  });
}

function statement(study) {
  const { model_evaluations, failed_evaluations } = study.result;
  const failed = list(failed_evaluations).length;
  return element(
    "div",
    { class: `verdict ${failed ? "open" : "neutral"}` },
    element("span", { class: "sign", "aria-hidden": "true" }, "→"),
    element(
      "div",
      {},
      element("p", { class: "verdict-word" }, "The model's own scatter"),
      paragraph(
        `${is_number(model_evaluations) ? plural(model_evaluations, "sample") : "Samples"} of the parameters as the study gives them` +
          `${failed ? `; ${plural(failed, "model run")} failed and ${failed === 1 ? "is" : "are"} left out` : ", none failed"}. ` +
          "Nothing was updated and nothing was compared with tests: this page says what follows from the assumed parameters, not whether they are right.",
      ),
    ),
  );
}

const is_given = (value) => is_number(value);

function parameter_table({ parameters: block, parameter_axes }) {
  const rows = parameter_axes.map(({ index, name, unit }) => {
    const prior = record(list(block.prior)[index]);
    return {
      name,
      unit,
      kind: prior.kind ?? null,
      prior_mean: number_or_null(list(block.prior_mean)[index]),
      prior_std: number_or_null(list(block.prior_std)[index]),
      limits: [prior.lower, prior.upper],
    };
  });
  const has_limits = rows.some(({ limits }) => limits.some(is_given));
  return data_table({
    id: "parameters",
    title: "Parameters as they were varied",
    columns: [
      { key: "name", title: "Parameter", is_text: true },
      rows.some(({ unit }) => unit) ? { key: "unit", title: "Unit", is_text: true } : null,
      rows.some(({ kind }) => kind) ? { key: "kind", title: "Distribution", is_text: true } : null,
      { key: "prior_mean", title: "Mean" },
      { key: "prior_std", title: "Std. dev." },
      has_limits
        ? {
            key: "limits",
            title: "Limits",
            text: (ends) => ends.map((end) => (is_given(end) ? short_number(end) : "–")).join(" … "),
            csv: ({ limits }) => limits.join(" to "),
          }
        : null,
    ].filter(Boolean),
    rows,
  });
}

export default {
  id: "propagated",
  title: "What the model predicts",
  is_in_print: true,
  has_data: (study) => study.is_propagation,
  explained: [
    [
      "Rank correlation",
      "Spearman's coefficient of a parameter and an output over the samples: near ±1 where the output follows that parameter alone, near 0 where it does not depend on it, or not in one direction.",
    ],
  ],
  content: (study) => [
    statement(study),
    output_table(study),
    next_steps(list(study.result.next)),
    study.parameter_axes.length ? parameter_table(study) : null,
  ],
};
