// The table of models that are compared by their evidence; its numbers are those of the comparison.
import { is_number, list, record } from "./data.js";
import { number_text } from "./format.js";
import { data_table } from "./table.js";

/** 0.987; near 1 what is left to it, so that 1 − 10⁻⁶ is not taken for certainty. */
const probability_text = (value) =>
  is_number(value) && value > 0.999 && value < 1 ? `1 \u2212 ${number_text(1 - value, 2)}` : number_text(value, 3);
const with_error = (value, error) => (is_number(value) ? `${number_text(value, 5)} ± ${number_text(error, 2)}` : "–");

/** `evidence` of the comparison: {models, scale, ...}. */
export function evidence_table({ models, scale }) {
  const has_elpd = list(models).some(({ elpd }) => is_number(elpd));
  return data_table({
    id: "evidence",
    title: "Which model the tests make more probable",
    columns: [
      { key: "name", title: "Results", is_text: true },
      { key: "ln_evidence", title: "ln evidence", text: (value, { standard_error }) => with_error(value, standard_error) },
      {
        key: "ln_bayes_factor",
        title: "ln Bayes factor",
        text: (value, { ln_bayes_factor_standard_error: error }) => (value === 0 ? "0 (best)" : with_error(value, error)),
      },
      { key: "strength", title: "Against it", is_text: true, text: (value, { ln_bayes_factor }) => (ln_bayes_factor === 0 ? "–" : value) },
      {
        key: "probability",
        title: "Probability",
        text: probability_text,
      },
      {
        key: "probability_ci95",
        title: "95 % interval",
        text: (ends) => list(ends).map(probability_text).join(" … "),
        csv: ({ probability_ci95: ends }) => list(ends).join(" to "),
      },
      has_elpd
        ? {
            key: "elpd_difference",
            title: "Leave-one-out",
            text: (value, { elpd_difference_standard_error: error }) => (value === 0 ? "0 (largest)" : with_error(value, error)),
          }
        : null,
    ].filter(Boolean),
    rows: list(models).map((model) => ({ ...record(model), name: model.label })),
    caption:
      "± is a standard error. ln Bayes factor: of the best model over each. Probabilities: where all of these models were equally probable before the " +
      `tests, with intervals by the evidences' standard errors. Words after ${scale ?? "Kass and Raftery 1995"}: 2 ln B below 2, 6, 10 and beyond.` +
      (has_elpd ? " Leave-one-out: expected ln density of further specimens, less the largest." : ""),
  });
}
