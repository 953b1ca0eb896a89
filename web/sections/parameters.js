// The table of the parameters: before, after, how sure, and who ended on a bound.
import { is_number, list, number_or_null, percent_change, record } from "../src/data.js";
import { paragraph } from "../src/dom.js";
import { count_text, number_text, percent_text, short_number } from "../src/format.js";
import { estimate_of, is_box, is_posterior } from "../src/population.js";
import { data_table } from "../src/table.js";
import { number_of_factor } from "../src/units.js";

const interval_text = (interval) =>
  list(interval).some(is_number) ? `${number_text(interval[0], 3)} … ${number_text(interval[1], 3)}` : "–";

function bounds_text([lower, upper]) {
  if (!is_number(lower) && !is_number(upper)) return "none";
  return `${is_number(lower) ? short_number(lower) : "−∞"} … ${is_number(upper) ? short_number(upper) : "∞"}`;
}

function rows_of({ parameters: block, parameter_axes }) {
  return parameter_axes.map(({ index, name, unit }) => {
    const at = (field) => number_or_null(list(block[field])[index]);
    return {
      name,
      unit,
      prior_mean: at("prior_mean"),
      prior_std: at("prior_std"),
      mean: at("mean"),
      std: at("std"),
      number: is_number(list(list(block.box)[index])[0]) ? null : number_of_factor(block, index, at("mean")),
      change: percent_change(at("prior_mean"), at("mean")),
      mean_ci95: list(list(block.mean_ci95)[index]),
      std_ci95: list(list(block.std_ci95)[index]),
      bounds: list(list(block.bounds)[index]),
      box: list(list(block.box)[index]),
      at_bound: list(block.at_bound)[index] ?? null,
    };
  });
}

function columns_for(rows, updated_std) {
  const any = (key) => rows.some((row) => is_number(row[key]));
  const any_interval = (key) => rows.some((row) => row[key].some(is_number));
  const is_of_box = any_interval("box"); // its middle and spread are a convention
  const interval = (key, title, group = "95 % interval") => ({
    key,
    title,
    group,
    text: interval_text,
    csv: (row) => row[key].join(" to "),
  });
  return [
    { key: "name", title: "Parameter", is_text: true },
    rows.some((row) => row.unit) ? { key: "unit", title: "Unit", is_text: true } : null,
    any("prior_mean") ? { key: "prior_mean", title: "Mean", group: "Prior" } : null,
    any("prior_std") ? { key: "prior_std", title: "Std. dev.", group: "Prior" } : null,
    any("mean") && !is_of_box ? { key: "mean", title: "Mean", group: "Updated" } : null,
    any("std") && !is_of_box ? { key: "std", title: updated_std, group: "Updated" } : null,
    rows.some((row) => row.number)
      ? { key: "number", title: "Model's number", group: "Updated", is_text: true, text: (value) => value ?? "" }
      : null,
    any_interval("box") ? interval("box", "Box", "Updated") : null,
    any("change") && !is_of_box ? { key: "change", title: "Change", group: "Updated", text: (value) => percent_text(value) } : null,
    any_interval("bounds")
      ? { key: "bounds", title: "Bounds", text: bounds_text, csv: (row) => row.bounds.map((b) => b ?? "").join(" to ") }
      : null,
    rows.some((row) => row.at_bound)
      ? {
          key: "at_bound",
          title: "At bound",
          is_text: true,
          of_class: (row) => (row.at_bound ? "flag" : null),
          text: (side) => (side === "upper" ? "▲ upper" : side === "lower" ? "▼ lower" : (side ?? "")),
        }
      : null,
    any_interval("mean_ci95") ? interval("mean_ci95", "Mean") : null,
    any_interval("std_ci95") ? interval("std_ci95", "Std. dev.") : null,
  ].filter(Boolean);
}

/** Further solutions of the update, one row each. */
function other_solutions(study) {
  const others = list(study.result.other_solutions).map(record);
  if (!others.length) return null;
  const rows = others.map(({ mean, weight }, k) => ({
    name: `Solution ${k + 2}`,
    weight: is_number(weight) ? 100 * weight : null,
    ...Object.fromEntries(study.parameter_axes.map(({ index }) => [`p${index}`, number_or_null(list(mean)[index])])),
  }));
  return data_table({
    id: "other-solutions",
    title: "Other parameters that explain the tests as well",
    columns: [
      { key: "name", title: "", is_text: true },
      { key: "weight", title: "Probability", unit: "%" },
      ...study.parameter_axes.map(({ index, name, unit }) => ({ key: `p${index}`, title: name, unit })),
    ],
    rows,
    caption:
      "Means of the parameters. The probabilities, with that of the estimate above, are the likelihood of the tests times the prior's density. Measure outputs that differ between the solutions, or narrow the prior or the bounds.",
  });
}

/** What a posterior of samples says beside its moments. */
function posterior(study) {
  if (!is_posterior(study)) return null;
  const { log_evidence, effective_samples } = estimate_of(study);
  const { probabilities, values } = record(study.parameters.quantiles);
  const rows = study.parameter_axes.map(({ index, name, unit }) => ({
    name,
    unit,
    ...Object.fromEntries(list(probabilities).map((p, k) => [`q${p}`, number_or_null(list(list(values)[index])[k])])),
  }));
  return [
    paragraph(
      is_number(effective_samples)
        ? `The posterior is a sample worth ${count_text(Math.round(effective_samples))} independent draws. `
        : "",
      is_number(log_evidence)
        ? `Logarithm of the evidence: ${number_text(log_evidence, 5)}; of two models of the same tests, the one with the larger value explains them better.`
        : "",
    ),
    data_table({
      id: "quantiles",
      title: "Quantiles of the posterior",
      columns: [
        { key: "name", title: "Parameter", is_text: true },
        rows.some(({ unit }) => unit) ? { key: "unit", title: "Unit", is_text: true } : null,
        ...list(probabilities).map((p) => ({ key: `q${p}`, title: `${short_number(100 * p)}\u00a0%` })),
      ].filter(Boolean),
      rows,
    }),
  ];
}

export default {
  id: "parameters",
  title: "Parameters",
  is_in_print: (study) => !is_box(study), // the bounds have them
  has_data: (study) => study.is_update && study.parameter_axes.length > 0 && list(study.parameters.names).length > 0,
  explained: [
    [
      "At bound",
      "The estimate ended on a limit that was set beforehand: the data ask for more than the limit allows, " +
        "often a sign that the wrong parameter was chosen.",
    ],
  ],
  content(study) {
    const rows = rows_of(study);
    // Methods that do not estimate the scatter of the specimens have another deviation, which must not be taken for it.
    const is_of_mean = study.is_update && study.parameters.is_population === false && !is_posterior(study) && !is_box(study);
    const updated_std = is_posterior(study) ? "Posterior std. dev." : is_of_mean ? "Std. dev. of the mean" : "Std. dev.";
    const columns = columns_for(rows, updated_std);
    const has_intervals = columns.some(({ key }) => key === "mean_ci95" || key === "std_ci95");
    return [
      data_table({
        id: "parameters",
        columns,
        rows,
        title: study.is_update ? "Parameters before and after updating" : "Parameters as they were varied",
        caption: has_intervals
          ? "The 95 % intervals say how well mean and standard deviation of the population are known from these " +
            "tests; the standard deviation itself is the spread from one specimen to the next."
          : is_of_mean
            ? "The updated standard deviation is the method's uncertainty of the mean; it does not estimate the scatter of " +
              "the specimens."
            : null,
      }),
      posterior(study),
      other_solutions(study),
    ];
  },
};
