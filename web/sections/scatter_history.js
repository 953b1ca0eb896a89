// The cloud on its way: a slider through the iterations moves cloud and ellipse, in outputs and in parameters.
import { has_numbers, is_number, shown_iterations } from "../src/data.js";
import { redraw } from "../src/charts.js";
import { axis_choice, legend_height, limits_of_pair, pair_panels, pairs_of, snapshot } from "../src/cloud_panels.js";
import { button, element } from "../src/dom.js";
import { figure } from "../src/figure.js";
import { number_text } from "../src/format.js";
import { layout } from "../src/panels.js";

const frame_ms = 700;

/** One space's figure: what is shown of it, and how it is drawn at a given step. */
function space_figure(study, { id, space, axes, title, caption, label }, steps, current) {
  const snapshots = () => steps.map((step) => snapshot(study, step, space));
  const limits_for = (shown) =>
    new Map(
      pairs_of(shown).map((pair) => [
        `${pair.x.index}-${pair.y.index}`,
        limits_of_pair(study, snapshots(), pair, space),
      ]),
    );
  const choice = axis_choice(axes, 4, label, (chosen) => {
    shown = chosen;
    limits = limits_for(shown);
    redraw(id, { afresh: true });
  });
  let shown = choice.chosen;
  let limits = limits_for(shown);
  const build = (width) => {
    const pairs = pairs_of(shown);
    const { cells, height } = layout(pairs.length, width, { aspect: 0.8, legend_height: legend_height(width) });
    const view = snapshot(study, steps[current()], space);
    const panels = pairs.map((pair, k) => ({
      pair,
      title: steps.length > 1 ? `Iteration ${steps[current()]}` : "",
      limits: limits.get(`${pair.x.index}-${pair.y.index}`),
      view,
      cell: cells[k],
    }));
    return { option: pair_panels(study, space, panels), height };
  };
  return {
    id,
    element: figure({
      id,
      renderer: "canvas",
      title,
      caption,
      build,
      controls: choice.control ? [choice.control] : [],
    }),
  };
}

/** Range input and play button; calls `show(position)`. Left and right arrows, Home and End work as on any slider. */
function slider(study, steps, show) {
  const last = steps.length - 1;
  const reading = element("output", { for: "iteration", class: "reading" });
  const range = element("input", {
    type: "range",
    id: "iteration",
    min: 0,
    max: last,
    step: 1,
    value: last,
    "aria-label": "Iteration",
  });
  let timer = null;
  const go = (position) => {
    range.value = String(position);
    const entry = study.iterations.find(({ index }) => index === steps[position]);
    const distance = is_number(entry?.distance_mahalanobis)
      ? `, Mahalanobis distance ${number_text(entry.distance_mahalanobis)}`
      : "";
    reading.textContent = `Iteration ${steps[position]} of ${steps[last]}${distance}`;
    range.setAttribute("aria-valuetext", reading.textContent);
    show(position);
  };
  const stop = () => {
    clearInterval(timer);
    timer = null;
    play.textContent = "▶ Play";
  };
  const play = button(
    "▶ Play",
    "Play the iterations one after another",
    () => {
      if (timer) return stop();
      if (Number(range.value) === last) go(0);
      play.textContent = "❚❚ Stop";
      timer = setInterval(() => {
        go(Math.min(last, Number(range.value) + 1));
        if (Number(range.value) === last) stop();
      }, frame_ms);
      return undefined;
    },
    { id: "play" },
  );
  range.addEventListener("input", () => {
    stop();
    go(Number(range.value));
  });
  const bar = element("div", { class: "slider", role: "group", "aria-label": "Iteration shown" }, play, range, reading);
  return { bar, go };
}

const has_parameter_scatter = (study) =>
  study.parameter_axes.length > 1 && study.clouds.some(({ parameters }) => parameters.some(has_numbers));
const has_output_scatter = (study) => study.output_axes.length > 1;

export default {
  id: "scatter-history",
  title: (study) =>
    shown_iterations(study).length > 1 ? "The cloud through the iterations" : "Samples of the parameters",
  has_data: (study) =>
    shown_iterations(study).length > 0 &&
    (study.has_iterations || shown_iterations(study).length === 1) &&
    (has_parameter_scatter(study) || (has_output_scatter(study) && shown_iterations(study).length > 1)),
  explained: [
    [
      "Parameter scatter",
      "The samples that each iteration drew; a slanted ellipse means that the data determine a combination " +
        "of two parameters better than each alone.",
    ],
  ],
  content(study) {
    const steps = shown_iterations(study);
    let position = steps.length - 1;
    const current = () => position;
    const figures = [];
    const through = steps.length > 1 ? " at the chosen iteration" : "";
    if (has_output_scatter(study) && steps.length > 1) {
      figures.push(
        space_figure(
          study,
          {
            id: "scatter-outputs",
            space: "outputs",
            axes: study.output_axes,
            label: "Outputs shown",
            title: `Outputs${through}`,
            caption: "Tests and cloud; the axes stay while the cloud moves.",
          },
          steps,
          current,
        ),
      );
    }
    if (has_parameter_scatter(study)) {
      figures.push(
        space_figure(
          study,
          {
            id: "scatter-parameters",
            space: "parameters",
            axes: study.parameter_axes,
            label: "Parameters shown",
            title: `Parameters${through}`,
            caption: "Samples of the parameters, with their 2σ ellipse where it is known; dotted: bounds.",
          },
          steps,
          current,
        ),
      );
    }
    if (steps.length < 2) return figures.map(({ element: node }) => node);
    let is_drawn = false;
    const { bar, go } = slider(study, steps, (next) => {
      position = next;
      if (is_drawn) figures.forEach(({ id }) => redraw(id));
    });
    go(position);
    is_drawn = true;
    return [bar, ...figures.map(({ element: node }) => node)];
  },
};
