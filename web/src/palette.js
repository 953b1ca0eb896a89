// Colours after Okabe and Ito: told apart with any colour vision, and by lightness when printed in grey.
// What differs by colour differs by shape too: tests are diamonds and dashed lines, the model circles and solid ones.

export const ink = "#1d2429";
export const muted = "#5b666f";
export const hairline = "#d9dee2";
export const model = "#0072b2";
export const model_points = "#3f9bd1";
export const test = "#14181b";
export const bound = "#d55e00";
export const accent = "#009e73";
export const band = "rgba(0, 114, 178, 0.14)";
export const test_band = "rgba(20, 24, 27, 0.08)";

/** From -1 to +1; both ends dark enough to be read apart in grey by the number in the cell. */
export const diverging = ["#0072b2", "#7fb9d9", "#f7f7f5", "#f0a86c", "#d55e00"];

export const font_family =
  'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "Noto Sans", "DejaVu Sans", Arial, sans-serif';
