// A plot with its number, caption and buttons. Made in two steps: the frame when a section is composed, the chart
// when the page stands and widths are known.
import { choose_zoom_area, create_chart, redraw, reset_zoom } from "./charts.js";
import { button, element } from "./dom.js";
import { save_png, save_svg } from "./export.js";

const waiting = [];
let numbered = 0;

/**
 * A numbered figure around whatever is drawn in `host`.
 * @param title, caption  the head, and what to see in it in one or two sentences
 * @param controls        elements that change what is shown
 * @param tools           buttons
 * @param under           elements between drawing and caption
 * @param attributes      of the figure
 * @param start           called when the page stands
 */
export function frame({ id, title, caption, controls = [], tools, host, under = [], attributes = {}, start }) {
  numbered += 1;
  waiting.push(start);
  return element(
    "figure",
    { class: "plot", id: `figure-${id}`, ...attributes },
    element(
      "div",
      { class: "plot-head" },
      element("div", { class: "plot-title" }, element("b", {}, `Figure ${numbered}`), ` ${title}`),
      element("div", { class: "tools", role: "group", "aria-label": `Tools of figure ${numbered}` }, tools),
    ),
    controls.length ? element("div", { class: "controls" }, controls) : null,
    host,
    under,
    element("figcaption", {}, caption),
  );
}

/**
 * @param id        names the chart in window.mottle.charts and in file names
 * @param title     short, for the head of the figure
 * @param caption   what to see in it, one or two sentences
 * @param build     (width, {is_summary}) -> {option, height}; is_summary: for the printed summary, which has little room
 * @param renderer  "svg" (sharp in print, right for lines) or "canvas" (right for thousands of points)
 * @param controls  elements that change what is shown
 */
export function figure({ id, title, caption, build, renderer = "svg", controls = [] }) {
  const host = element("div", { class: "plot-area", role: "img", "aria-label": `${title}. ${caption}` });
  const zoom = button(
    "Zoom",
    "Choose an area to enlarge by dragging; Ctrl and the mouse wheel enlarge too",
    () => {
      const is_on = zoom.getAttribute("aria-pressed") !== "true";
      zoom.setAttribute("aria-pressed", String(is_on));
      choose_zoom_area(id, is_on);
    },
    { "aria-pressed": "false" },
  );
  const tools = [
    zoom,
    button("Reset", "Show the whole plot again", () => reset_zoom(id)),
    button("PNG", "Save this plot as a PNG image", () => save_png(id), { "data-export": "png" }),
    button("SVG", "Save this plot as an SVG drawing", () => save_svg(id), { "data-export": "svg" }),
  ];
  const attributes = { "data-plot": id, "data-renderer": renderer };
  const start = () => create_chart(host, { id, renderer, build });
  return frame({ id, title, caption, controls, tools, host, attributes, start });
}

export function draw_waiting_figures() {
  for (const start of waiting.splice(0)) start();
}

/** Buttons that leaf through `count` pages; nothing where there is only one. */
function pager({ count, label, show }) {
  if (count < 2) return [];
  let current = 0;
  const text = element("span", { class: "pager-label", "aria-live": "polite" }, label(0));
  const turn = (step) => {
    current = (current + step + count) % count;
    text.textContent = label(current);
    show(current);
  };
  return [
    element(
      "span",
      { class: "pager" },
      button("‹", "Previous panels", () => turn(-1)),
      text,
      button("›", "Next panels", () => turn(1)),
    ),
  ];
}

/**
 * A figure that shows `items` in pages of `size`.
 * @param build  (items of the page, width, {is_summary}) -> {option, height}
 */
export function paged_figure({ id, items, size, build, ...rest }) {
  const count = Math.max(1, Math.ceil(items.length / size));
  const page = (k) => items.slice(k * size, (k + 1) * size);
  let shown = page(0);
  const controls = pager({
    count,
    label: (k) => `${k * size + 1}–${Math.min(items.length, (k + 1) * size)} of ${items.length}`,
    show: (k) => {
      shown = page(k);
      redraw(id, { afresh: true });
    },
  });
  return figure({ id, controls, build: (width, how) => build(shown, width, how), ...rest });
}
