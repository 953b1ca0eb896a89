// How far the surrogate that stood in for the model was off, output by output, and what its refinements did to that.
import { is_number, list, number_or_null, record, standard_deviations } from "../src/data.js";
import { paragraph } from "../src/dom.js";
import { number_text, plural } from "../src/format.js";
import { data_table } from "../src/table.js";

const kinds = { quadratic: "A quadratic", kriging: "A Gaussian process", chaos: "A sparse polynomial" };
const percent = (share) => (is_number(share) ? `${number_text(100 * share, 2)}\u00a0%` : "–");

const rounds_of = (study) => list(record(study.result.surrogate).rounds).map(record);

function table(study, rounds) {
  const last = rounds.at(-1);
  const scatter = standard_deviations(study.outputs.test_covariance);
  const rows = study.output_axes.map(({ name, unit }, k) => {
    const at_estimate = number_or_null(list(last.error_at_estimate)[k]);
    return {
      name,
      unit,
      carried_error: number_or_null(list(last.carried_error)[k]),
      first: number_or_null(list(rounds[0].error_at_estimate)[k]),
      error_at_estimate: at_estimate,
      scatter: number_or_null(list(last.scatter_error_at_estimate)[k]),
      share: is_number(at_estimate) && scatter[k] > 0 ? at_estimate / scatter[k] : null,
    };
  });
  const tolerance = record(study.result.surrogate).tolerance;
  return data_table({
    id: "surrogate",
    title: "Errors of the surrogate, root mean square",
    columns: [
      { key: "name", title: "Output", is_text: true },
      rows.some(({ unit }) => unit) ? { key: "unit", title: "Unit", is_text: true } : null,
      rounds.length > 1 ? { key: "first", title: "First round", group: "At the estimate" } : null,
      { key: "error_at_estimate", title: "Last round", group: "At the estimate" },
      {
        key: "share",
        title: "Of the tests' scatter",
        group: "At the estimate",
        text: percent,
        of_class: ({ share }) => (is_number(share) && is_number(tolerance) && share > tolerance ? "flag" : null),
      },
      rows.some(({ scatter }) => is_number(scatter))
        ? {
            key: "scatter",
            title: "Of its std. dev.",
            group: "At the estimate",
            text: percent,
            of_class: ({ scatter }) =>
              is_number(scatter) && is_number(tolerance) && Math.abs(scatter) > tolerance ? "flag" : null,
          }
        : null,
      { key: "carried_error", title: "Added to the noise" },
    ].filter(Boolean),
    rows,
    caption: "At the estimate: over new model runs drawn from the updated population. Of its std. dev.: how far the surrogate's standard deviation over these runs is off the model's. Set off: above what was asked for.",
  });
}

export default {
  id: "surrogate",
  title: "Surrogate of the model",
  has_data: (study) => rounds_of(study).length > 0,
  explained: [
    [
      "Surrogate",
      "A formula fitted to model runs and used in their place. Its error, measured at runs that were not used for the fit, counts as noise of the tests.",
    ],
  ],
  content(study) {
    const rounds = rounds_of(study);
    const { kind, within_tolerance } = record(study.result.surrogate);
    const runs = rounds.map((round) => round.runs).filter(is_number);
    return [
      paragraph(
        `${kinds[kind] ?? "A surrogate"} fitted to ${plural(runs.at(-1) ?? 0, "model run")} stood in for the model`,
        runs.length > 1 ? `, after rounds with ${runs.slice(0, -1).join(", ")}.` : ".",
        within_tolerance === false ? " It is not as good as was asked for: take the intervals with care." : "",
      ),
      table(study, rounds),
    ];
  },
};
