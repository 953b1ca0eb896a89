// Light or dark, as the reader's system asks; what is printed or saved is always light.
import { use_theme } from "./palette.js";

export const printed_width = 660; // CSS pixels between the margins of an A4 page
export const printed_figure_width = 1560; // of a figure of the printed summary, at its zoom of 0.42

const dark = window.matchMedia("screen and (prefers-color-scheme: dark)");
const listeners = [];
let is_printing = false;

const apply = () => use_theme(dark.matches && !is_printing ? "dark" : "light");

function change() {
  apply();
  for (const listener of listeners) listener();
}

/** `listener` is called after the palette has changed. */
export function on_theme_change(listener) {
  listeners.push(listener);
}

/** What `draw` returns, drawn with the light palette. */
export function with_light_theme(draw) {
  use_theme("light");
  try {
    return draw();
  } finally {
    apply();
  }
}

apply();
dark.addEventListener("change", change);
for (const [event, printing] of [
  ["beforeprint", true],
  ["afterprint", false],
]) {
  window.addEventListener(event, () => {
    is_printing = printing;
    if (dark.matches) change();
  });
}
