// The page of `mottle compare`: results of several updates side by side. Every number is one of their result.json.
import { agreement_rows, conclusion_of, findings_of } from "./src/agreement.js";
import { mean_text, of_tests, refused } from "./src/agreement_text.js";
import { extent, is_number, list, read_study, record } from "./src/data.js";
import { bullets, element, paragraph } from "./src/dom.js";
import { evidence_table } from "./src/evidence_table.js";
import { count_text, number_text, seconds_text, words } from "./src/format.js";
import { key, mark_badge, span_of, spoken, track, value_text } from "./src/parameter_bars.js";
import { data_table } from "./src/table.js";
import { shown_unit } from "./src/units.js";

const tones = { adequate: "good", inadequate: "bad", undecided: "doubtful" };

function read_run({ label, report, result }) {
  const study = read_study({ result });
  const verdict = record(study.result.verdict);
  return {
    label: String(label ?? "–"),
    report,
    study,
    conclusion: conclusion_of(verdict),
    headline: verdict.headline ?? "",
    is_reassuring: verdict.is_reassuring !== false,
  };
}

/** Green only where the result itself is reassuring, as in the report. */
function verdict_badge({ conclusion, is_reassuring }) {
  const tone = conclusion === "adequate" && !is_reassuring ? "doubtful" : (tones[conclusion] ?? "neutral");
  return element("span", { class: `badge ${tone}` }, conclusion ?? "no verdict");
}

function runs_table(runs) {
  const rows = runs.map((run) => {
    const { result } = run.study;
    return {
      name: run.label,
      run,
      title: result.title,
      method: result.method,
      status: words(result.status),
      verdict: run.conclusion,
      specimens: extent(list(record(result.outputs).test_count))?.[1] ?? null,
      seconds: record(result.timings_s).total ?? null,
    };
  });
  const address = (path) => path.split("/").map(encodeURIComponent).join("/"); // a name is no markup and no scheme
  const link = (label, { run }) => (run.report ? element("a", { href: address(run.report) }, label) : label);
  return data_table({
    id: "runs",
    title: "What was run, and what came of it",
    columns: [
      { key: "name", title: "Results", is_text: true, text: link },
      { key: "title", title: "Study", is_text: true },
      { key: "method", title: "Method", is_text: true },
      { key: "status", title: "Ended", is_text: true },
      {
        key: "verdict",
        title: "Verdict",
        is_text: true,
        text: (_, { run }) => [verdict_badge(run), run.headline ? ` ${run.headline}` : ""],
        of_class: () => "prose",
      },
      { key: "specimens", title: "Specimens", text: count_text },
      { key: "seconds", title: "Time", text: seconds_text },
    ],
    rows,
    caption: "Times are those of one machine on one day.",
  });
}

/** "1.02 (0.98 … 1.06)". */
const with_ends = (value, ends) => value_text({ estimate: value, interval: ends, unit: "" });
const known_ends = (ends) => (list(ends).filter(is_number).length === 2 ? ends : null);

const times = (value, factor) => (is_number(value) ? value * factor : value);
const all_times = (values, factor) => values && values.map((value) => times(value, factor));

/** A finding in the unit that all runs of this parameter are shown in. */
function in_unit(finding, { unit, factor }) {
  const { prior, prior_mean, estimate, interval, specimens, bounds } = finding;
  return {
    ...finding,
    unit,
    prior: all_times(prior, factor),
    prior_mean: times(prior_mean, factor),
    estimate: times(estimate, factor),
    interval: all_times(interval, factor),
    specimens: all_times(specimens, factor),
    bounds: all_times(bounds, factor),
    std: times(finding.std, factor),
    std_ends: all_times(finding.std_ends, factor),
  };
}

/** What each run found of each parameter: one entry a name and unit, in the order of their first mention. */
function parameters_of(runs) {
  const found = new Map();
  for (const run of runs) {
    const { std, std_ci95 } = run.study.parameters;
    findings_of(run.study).forEach((finding, index) => {
      const id = `${finding.name} ${finding.unit}`;
      if (!found.has(id)) found.set(id, []);
      const more = {
        std: list(std)[index],
        std_ends: known_ends(list(std_ci95)[index]),
        is_confirmed: finding.is_confirmed && run.is_reassuring,
      };
      found.get(id).push({ run, finding: { ...finding, ...more } });
    });
  }
  return [...found.values()].map((entries) => {
    const { unit, prior_mean, estimate } = entries[0].finding;
    const shown = shown_unit(unit, prior_mean ?? estimate);
    const converted = entries.map(({ run, finding }) => ({ run, finding: in_unit(finding, shown) }));
    return { name: entries[0].finding.name, unit: shown.unit, entries: converted };
  });
}

function parameter_block({ name, unit, entries }, runs) {
  const span = span_of(entries.map(({ finding }) => finding));
  const row = (run) => {
    const finding = entries.find((entry) => entry.run === run)?.finding;
    const attributes = { class: "compared-run", "data-run": run.label };
    const label = element("span", { class: "compared-label" }, run.label);
    if (!finding) return element("div", attributes, label, element("span", { class: "bar-value" }, "not a parameter"));
    return element(
      "div",
      { ...attributes, role: "img", "aria-label": `${run.label}, ${spoken(finding)}` },
      label,
      span ? track(finding, span) : element("span", {}),
      element("span", { class: "compared-value" }, value_text({ ...finding, unit: "" }), " ", mark_badge(finding)),
    );
  };
  return element(
    "div",
    { class: "compared", "data-parameter": name },
    element("h3", {}, name, unit ? element("span", { class: "unit" }, ` ${unit}`) : null),
    runs.map(row),
    span ? axis_ends(span) : null,
  );
}

const axis_ends = ({ low, high }) =>
  element(
    "div",
    { class: "compared-run axis", "aria-hidden": "true" },
    element("span", {}),
    element("div", { class: "axis-ends" }, element("span", {}, number_text(low, 3)), element("span", {}, number_text(high, 3))),
    element("span", {}),
  );

/** {estimate0: ..., estimate1: ...}: cells of one row, by the key of their column. */
const values_by_run = (by_run, fields) =>
  Object.fromEntries(
    by_run.flatMap((of, at) => Object.entries(fields).map(([name, value]) => [`${name}${at}`, of ? value(of) : null])),
  );

function parameters_table(parameters, runs) {
  const rows = parameters.map(({ name, unit, entries }) => {
    const by_run = runs.map((run) => entries.find((entry) => entry.run === run)?.finding);
    return { name: unit ? `${name} (${unit})` : name, by_run, ...values_by_run(by_run, { estimate: (of) => of.estimate, std: (of) => of.std }) };
  });
  const column = (at, keyed, title, ends) => ({
    key: `${keyed}${at}`,
    title,
    group: runs[at].label,
    text: (_, { by_run }) => (by_run[at] ? with_ends(by_run[at][keyed], by_run[at][ends]) : "–"),
  });
  return data_table({
    id: "parameters",
    title: "Means and standard deviations with 95 % intervals, where the method gives them",
    columns: [
      { key: "name", title: "Parameter", is_text: true },
      ...runs.flatMap((_, at) => [
        column(at, "estimate", "mean", "interval"),
        column(at, "std", "std. dev.", "std_ends"),
      ]),
    ],
    rows,
  });
}

function outputs_table(runs) {
  const found = runs.map(({ study }) => new Map(agreement_rows(study).map((output) => [output.name, output])));
  const names = new Set(runs.flatMap(({ study }) => study.output_axes.map(({ name }) => name)));
  const rows = [...names].map((name) => {
    const by_run = found.map((outputs) => outputs.get(name));
    const fields = {
      before: ({ initial }) => initial.mean_error,
      after: ({ final }) => final.mean_error,
      scatter: ({ final }) => final.std_ratio,
    };
    return { name, by_run, ...values_by_run(by_run, fields) };
  });
  if (!found.some((outputs) => outputs.size)) return null;
  const column = (at, keyed, title, text, claim) => ({
    key: `${keyed}${at}`,
    title,
    group: runs[at].label,
    text: (_, { by_run }) => (by_run[at] ? refused(claim && by_run[at][claim], text(by_run[at])) : "–"),
    of_class: ({ by_run }) => (claim && by_run[at]?.[claim] === false ? "flag" : null),
  });
  const columns = runs.flatMap((_, at) => [
    column(at, "before", "mean, before", ({ initial, unit }) => mean_text(initial, unit)),
    column(at, "after", "mean, after", ({ final, unit }) => mean_text(final, unit), "is_mean_reproduced"),
    column(at, "scatter", "std. dev.", ({ final }) => of_tests(final.std_ratio), "is_scatter_reproduced"),
  ]);
  return data_table({
    id: "outputs",
    title: "Errors of the outputs' means before and after, and the standard deviation after as a share of the tests'",
    columns: [{ key: "name", title: "Output", is_text: true }, ...columns],
    rows,
    caption: "✗: beyond what chance allows, as the run's own report says.",
  });
}

function evidence_section(evidence) {
  if (!evidence) return null;
  const { models, warnings, not_compared } = record(evidence);
  const reasons = list(not_compared).map(({ label, reason }) => `${label} is not compared: ${reason}.`);
  return section(
    "evidence",
    "Evidence",
    list(models).length ? evidence_table(evidence) : paragraph("No two of these results can be compared by their evidence."),
    list(warnings).length || reasons.length ? bullets([...list(warnings), ...reasons]) : null,
  );
}

const section = (id, title, ...content) =>
  element("section", { id, class: "in-print", "aria-labelledby": `${id}-title` }, element("h2", { id: `${id}-title` }, title), content);

function outputs_section(runs) {
  const table = outputs_table(runs); // of results of earlier versions there is none
  return table ? section("outputs", "Outputs", table) : null;
}

export function compose_comparison(main, data) {
  const runs = list(data.runs).map(record).map(read_run);
  const labels = runs.map(({ label }) => label);
  const parameters = parameters_of(runs);
  document.title = `${labels.join(", ")} – Mottle`;
  main.classList.add("single");
  main.append(
    element(
      "div",
      { class: "body" },
      element(
        "header",
        {},
        element("p", { class: "kicker" }, "Updates side by side"),
        element("h1", {}, labels.join(", ")),
      ),
      section("runs", "Runs", runs_table(runs)),
      evidence_section(data.evidence),
      section(
        "parameters",
        "Parameters",
        key(parameters.flatMap(({ entries }) => entries.map(({ finding }) => finding))),
        element(
          "div",
          { class: "comparison" },
          parameters.map((parameter) => parameter_block(parameter, runs)),
        ),
        paragraph(
          element(
            "span",
            { class: "note" },
            "All bars of a parameter have one axis. Intervals that overlap do not show that two runs agree, and runs of the same " +
              "tests are not independent of each other.",
          ),
        ),
        parameters_table(parameters, runs),
      ),
      outputs_section(runs),
    ),
  );
}
