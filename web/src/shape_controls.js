// What can be set about the structure that swings: buttons, sliders and boxes, each with its label.
import { list } from "./data.js";
import { button, checkbox, element } from "./dom.js";
import { save_canvas } from "./export.js";
import { views } from "./viewpoint.js";

const picture_width = 1000;

function range_input({ label, name, min, max, value, text, action }) {
  const input = element("input", { type: "range", id: `shape-${name}`, min, max, step: 1, value });
  const act = () => {
    input.setAttribute("aria-valuetext", text(Number(input.value)));
    action(Number(input.value));
  };
  input.addEventListener("input", act);
  act();
  return element("label", { class: "choice range" }, `${label} `, input);
}

/** Choice of a parameter whose elements are coloured; nothing where the data name none. */
function part_choice(viewer) {
  const { parts } = viewer.structure;
  if (!parts.length) return null;
  const input = element(
    "select",
    { id: "shape-part", onchange: () => viewer.set({ part: parts[Number(input.value)] ?? null }) },
    element("option", { value: "-1" }, "none"),
    parts.map(({ name }, k) => element("option", { value: k }, name)),
  );
  return element("label", { class: "choice" }, "Elements of ", input);
}

export function controls_of(viewer) {
  const { state } = viewer;
  viewer.play_button = button(
    "▶ Play",
    "Start or stop the animation",
    () => (state.is_playing ? viewer.pause() : viewer.play()),
    { id: "shape-play" },
  );
  return [
    viewer.play_button,
    range_input({
      label: "Amplitude",
      name: "amplitude",
      min: 0,
      max: 30,
      value: 100 * state.amplitude,
      text: (value) => `${value} percent of the structure's size`,
      action: (value) => viewer.set({ amplitude: value / 100 }),
    }),
    range_input({
      label: "Speed",
      name: "speed",
      min: 1,
      max: 30,
      value: 10 * state.speed,
      text: (value) => `${value / 10} cycles per second`,
      action: (value) => viewer.set({ speed: value / 10 }),
    }),
    checkbox("Edges", state.has_edges, (has_edges) => viewer.set({ has_edges }), { id: "shape-edges" }),
    checkbox("Undeformed", state.has_outline, (has_outline) => viewer.set({ has_outline }), { id: "shape-outline" }),
    viewer.modes.some((mode) => list(mode.test.nodes).length)
      ? checkbox("Tests", state.has_test, (has_test) => viewer.set({ has_test }), { id: "shape-test" })
      : null,
    part_choice(viewer),
  ].filter(Boolean);
}

export function tools_of(viewer) {
  const along = (name) => (name === "Iso" ? "Look from a corner" : `Look along ${name.toLowerCase()}`);
  return [
    ...Object.keys(views).map((name) =>
      button(name, along(name), () => viewer.look(name), { "data-view": name.toLowerCase() }),
    ),
    button("PNG", "Save this view as a PNG image", () => save_canvas(viewer.id, viewer.picture(picture_width)), {
      "data-export": "png",
    }),
  ];
}
