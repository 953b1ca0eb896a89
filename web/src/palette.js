// Colours after Okabe and Ito: told apart with any colour vision, and by lightness when printed in grey.
// What differs by colour differs by shape too: tests are diamonds and dashed lines, the model circles and solid ones.
// The names follow the theme (theme.js), so a drawing reads them anew each time that it is drawn.

const light = {
  paper: "#ffffff",
  ink: "#1d2429",
  muted: "#5b666f",
  scale: "#54555a",
  hairline: "#d9dee2",
  model: "#0072b2",
  model_points: "#3f9bd1",
  test: "#14181b",
  bound: "#d55e00",
  accent: "#009e73",
  band: "rgba(0, 114, 178, 0.14)",
  test_band: "rgba(20, 24, 27, 0.08)",
  edge: "#1d2429",
  sequential: ["#eceff0", "#a6d0e6", "#4a9fcc", "#0a6aa6", "#07365c"],
};

/** Marks a shade lighter; the scale from 0 to 1 turned round, so that its far end stands out from the dark page as well. */
const dark = {
  paper: "#14191d",
  ink: "#e4e8eb",
  muted: "#9ca8b1",
  scale: "#9ca8b1",
  hairline: "#343d45",
  model: "#4aa8dc",
  model_points: "#3f9bd1",
  test: "#f2f4f5",
  bound: "#f08a3c",
  accent: "#2cc296",
  band: "rgba(74, 168, 220, 0.22)",
  test_band: "rgba(242, 244, 245, 0.14)",
  edge: "#0b0f12",
  sequential: ["#27404f", "#1f6590", "#3f97c9", "#96cdea", "#f6f8f2"],
};

const themes = { light, dark };

export let {
  paper,
  ink,
  muted,
  scale,
  hairline,
  model,
  model_points,
  test,
  bound,
  accent,
  band,
  test_band,
  edge,
  sequential,
} = light;

export function use_theme(name) {
  ({ paper, ink, muted, scale, hairline, model, model_points, test, bound, accent, band, test_band, edge, sequential } =
    themes[name]);
}

/** From -1 to +1; both ends dark enough to be read apart in grey by the number in the cell. */
export const diverging = ["#0072b2", "#7fb9d9", "#f7f7f5", "#f0a86c", "#d55e00"];

/** Texts on a coloured cell, in either theme. */
export const on_pale = light.ink;
export const on_deep = "#ffffff";

export const font_family =
  'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "Noto Sans", "DejaVu Sans", Arial, sans-serif';
