// The report: reads the data, composes the sections that have something to show, draws their plots.
import { compose_comparison } from "./compare.js";
import { compose_diagnosis } from "./diagnosis.js";
import { charts } from "./src/charts.js";
import { read_study } from "./src/data.js";
import { button, definitions, element, paragraph } from "./src/dom.js";
import { draw_waiting_figures } from "./src/figure.js";
import { scenes } from "./src/shape_viewer.js";
import { in_readable_units } from "./src/units.js";
import assignments from "./sections/assignments.js";
import conclusion from "./sections/conclusion.js";
import convergence from "./sections/convergence.js";
import correlations from "./sections/correlations.js";
import densities from "./sections/densities.js";
import header from "./sections/header.js";
import identifiability from "./sections/identifiability.js";
import interval from "./sections/interval.js";
import mac from "./sections/mac.js";
import output_history from "./sections/output_history.js";
import outputs from "./sections/outputs.js";
import parameter_history from "./sections/parameter_history.js";
import parameters from "./sections/parameters.js";
import posterior from "./sections/posterior.js";
import posterior_predictive from "./sections/posterior_predictive.js";
import predictions from "./sections/predictions.js";
import propagated from "./sections/propagated.js";
import residuals from "./sections/residuals.js";
import run from "./sections/run.js";
import sample_size from "./sections/sample_size.js";
import scatter from "./sections/scatter.js";
import scatter_history from "./sections/scatter_history.js";
import sensitivity from "./sections/sensitivity.js";
import shapes from "./sections/shapes.js";
import spearman from "./sections/spearman.js";
import surrogate from "./sections/surrogate.js";
import test_correlation from "./sections/test_correlation.js";
import troubles from "./sections/troubles.js";
import verdict from "./sections/verdict.js";

// A new section is a file in sections/ and its place in this list.
const sections = [
  conclusion,
  propagated,
  verdict,
  parameters,
  interval,
  densities,
  correlations,
  identifiability,
  outputs,
  posterior_predictive,
  test_correlation,
  residuals,
  assignments,
  predictions,
  surrogate,
  posterior,
  convergence,
  output_history,
  parameter_history,
  sample_size,
  spearman,
  scatter,
  scatter_history,
  sensitivity,
  shapes,
  mac,
  troubles,
  run,
];

function read_data() {
  const text = document.getElementById("mottle-data").textContent;
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}

/** A title may depend on the study. */
const title_of = ({ title }, study) => (typeof title === "function" ? title(study) : title);

function section_element(section, study) {
  const { id, content, is_in_print } = section;
  return element(
    "section",
    {
      id,
      "aria-labelledby": `${id}-title`,
      class: (typeof is_in_print === "function" ? is_in_print(study) : is_in_print) ? "in-print" : null,
    },
    element("h2", { id: `${id}-title` }, title_of(section, study)),
    content(study),
  );
}

function contents(drawn, study) {
  return element(
    "nav",
    { "aria-label": "Contents" },
    element("h2", {}, "Contents"),
    element(
      "ol",
      {},
      drawn.map((section) => element("li", {}, element("a", { href: `#${section.id}` }, title_of(section, study)))),
      element("li", {}, element("a", { href: "#glossary" }, "How to read this page")),
    ),
  );
}

function glossary(drawn, study) {
  const entries = drawn.flatMap(({ explained }) => explained ?? []);
  return element(
    "footer",
    { id: "glossary" },
    element("h2", {}, "How to read this page"),
    definitions(entries),
    element(
      "p",
      { class: "note screen-only" },
      study.is_modes ? null : "Printing gives a summary of two pages. ",
      button("Print everything", "Print all sections of this page", () => {
        document.documentElement.classList.add("print-all");
        window.print();
        document.documentElement.classList.toggle("print-all", study.is_modes);
      }),
      " In every plot: hover for values; Ctrl and the mouse wheel enlarge, dragging moves, Reset shows everything again; " +
        "PNG and SVG save the plot, CSV a table.",
    ),
    element(
      "p",
      { class: "note" },
      `Plots by Apache ECharts${drawn.includes(shapes) ? ", mode shapes by three.js" : ""}; licences are in this file's source.`,
    ),
  );
}

const study_units = "#study-units";
const has_study_units = () => window.location.hash === study_units;

/** A button that shows the page in the other units; nothing where both are the same. */
function unit_choice(data) {
  const units = ({ result }) => JSON.stringify(result?.parameters?.units ?? null);
  if (units(data) === units(in_readable_units(data))) return null;
  return button(
    has_study_units() ? "Readable units" : "Units of the study",
    "Show the parameters in other units",
    () => {
      window.location.hash = has_study_units() ? "" : study_units;
      window.location.reload();
    },
    { "data-action": "units", class: "screen-only" },
  );
}

function compose(main) {
  const data = read_data();
  if (data?.kind === "compare") return compose_comparison(main, data);
  if (data?.kind === "diagnosis") {
    compose_diagnosis(main, data);
    draw_waiting_figures();
    return;
  }
  if (!data || !(data.result || data.kind === "modes")) {
    main.append(
      element("h1", {}, "Mottle report"),
      paragraph("This page holds no results: its data could not be read. Write it again with `mottle report DIR`."),
    );
    return;
  }
  const shown = has_study_units() ? data : in_readable_units(data);
  const study = read_study(shown);
  study.unit_choice = unit_choice(data);
  document.title = `${study.title} – Mottle`;
  if (study.is_modes) document.documentElement.classList.add("print-all"); // only a report has a summary to print
  const drawn = sections.filter((section) => section.has_data(study));
  const body = element(
    "div",
    { class: "body" },
    header.content(study),
    drawn.map((section) => section_element(section, study)),
    glossary(drawn, study),
  );
  main.append(contents(drawn, study), body);
  draw_waiting_figures();
}

window.mottle = { charts, scenes, ready: false };
compose(document.getElementById("report"));
window.mottle.ready = true;
document.documentElement.dataset.ready = "true";
