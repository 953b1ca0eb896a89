// How the posterior was sampled and how far its sample can be relied on: chains, stages, evidence, modes.
import { is_number } from "../src/data.js";
import { paragraph } from "../src/dom.js";
import { figure, paged_figure } from "../src/figure.js";
import { count_text, number_text, plural } from "../src/format.js";
import { evidence_panel, rank_panels, stage_panels } from "../src/posterior_panels.js";
import { evidence_of, modes_of, posterior_of } from "../src/posterior.js";
import { data_table } from "../src/table.js";

const panels_a_page = 9;
const largest_r_hat = 1.01;
const least_effective = 400;
const spoken = (name) => name.replace(/_/g, "-");

function diagnostics_table({ names, r_hat, ess_bulk, ess_tail }) {
  const effective = (key, title) => ({
    key,
    title,
    group: "Effective sample size",
    text: count_text,
    of_class: (row) => (row[key] < least_effective && is_number(row[key]) ? "flag" : null),
  });
  return data_table({
    id: "posterior-chains",
    title: "Agreement of the chains",
    columns: [
      { key: "name", title: "Quantity", is_text: true },
      {
        key: "r_hat",
        title: "R-hat",
        text: (value) => (is_number(value) ? value.toFixed(4) : "–"),
        of_class: (row) => (row.r_hat > largest_r_hat ? "flag" : null),
      },
      effective("ess_bulk", "bulk"),
      effective("ess_tail", "tail"),
    ],
    rows: names.map((name, k) => ({ name: spoken(name), r_hat: r_hat[k], ess_bulk: ess_bulk[k], ess_tail: ess_tail[k] })),
    caption: `Set off: an R-hat above ${largest_r_hat}, fewer than ${least_effective} effective draws.`,
  });
}

function modes_table(modes, { names }, axes) {
  if (modes.length < 2) return null;
  const unit_of = (name) => axes.find((axis) => axis.name === name)?.unit ?? "";
  return data_table({
    id: "posterior-modes",
    title: "Separate modes of the posterior",
    columns: [
      { key: "name", title: "Mode", is_text: true },
      { key: "probability", title: "Probability", text: (value) => number_text(value, 3) },
      { key: "error", title: "Std. error", text: (value) => number_text(value, 2) },
      ...names
        .filter((_, k) => modes.some(({ mean }) => is_number(mean[k])))
        .map((name, k) => ({ key: `mean${k}`, title: name, unit: unit_of(name), group: "Mean" })),
    ],
    rows: modes.map(({ probability, error, mean }, k) => ({
      name: String(k + 1),
      probability,
      error,
      ...Object.fromEntries(mean.map((value, i) => [`mean${i}`, value])),
    })),
    caption: "Mean and standard deviation of the whole posterior describe none of these.",
  });
}

const has_ranks = ({ ranks }) => is_number(ranks.bins) && ranks.counts.length > 0;
const has_stages = ({ stages }) => stages.some((chain) => chain.length > 0);

function statement({ chains, draws, evaluations }, evidence, modes) {
  return paragraph(
    is_number(chains) && is_number(draws) ? `${plural(chains, "independent island")} of ${plural(draws, "draw")} each` : "",
    is_number(evaluations) ? `, from ${plural(evaluations, "model run")}. ` : ". ",
    evidence
      ? `ln evidence ${number_text(evidence.value, 6)}${evidence.by_importance ? " by importance sampling" : ""}${is_number(evidence.error) ? ` ± ${number_text(evidence.error, 2)} (standard error)` : ""}. `
      : "",
    modes.length === 1 ? "One mode was found." : modes.length > 1 ? `${modes.length} separate modes were found.` : "",
  );
}

export default {
  id: "posterior",
  title: "How the posterior was sampled",
  has_data: (study) => study.is_update && posterior_of(study) !== null,
  explained: [
    [
      "R-hat",
      "Compares the chains with each other: 1 where all are alike, and above 1.01 where they have not found the same distribution.",
    ],
    [
      "Effective sample size",
      "How many independent draws know the middle (bulk) or the ends (tail) of the distribution as well as these draws do.",
    ],
    [
      "Evidence",
      "The probability density of the tests under the model and its prior. The difference of two models' ln evidence says by how much " +
        "the same tests change the odds between them: `mottle compare`.",
    ],
  ],
  content(study) {
    const posterior = posterior_of(study);
    const evidence = evidence_of(study);
    const modes = modes_of(study);
    return [
      statement(posterior, evidence, modes),
      modes_table(modes, posterior, study.parameter_axes),
      diagnostics_table(posterior),
      has_ranks(posterior)
        ? paged_figure({
            id: "posterior-ranks",
            title: "Ranks of the draws of each island",
            caption:
              "A line an island. Where the islands agree all lines lie along the strip, which holds 95\u00a0% of the counts of independent draws; " +
              "a line that stays above or below it is an island that is elsewhere.",
            items: posterior.names,
            size: panels_a_page,
            build: (shown, width) => rank_panels(posterior, shown, width),
          })
        : null,
      has_stages(posterior)
        ? figure({
            id: "posterior-stages",
            title: "From the prior to the posterior, stage by stage",
            caption:
              "A line an island. The exponent says how much of the likelihood counts: 1 is the posterior. Moves of a stage go on until little " +
              "correlation is left with its start.",
            build: (width) => stage_panels(posterior, width),
          })
        : null,
      evidence && evidence.islands.some(is_number)
        ? figure({
            id: "posterior-evidence",
            title: "Evidence by island",
            caption:
              "Each island estimates the evidence on its own. Line and band: " +
              (evidence.by_importance
                ? "what importance sampling about the parameters that meet the tests best finds, which is more precise here, with its 95\u00a0% interval."
                : "the mean of their evidences with its 95\u00a0% interval, by their spread."),
            build: (width) => evidence_panel(evidence, width),
          })
        : null,
    ];
  },
};
