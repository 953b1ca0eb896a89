// Natural frequencies as a table, and beside it the structure that swings in the chosen mode.
import { is_number, list } from "../src/data.js";
import { element } from "../src/dom.js";
import { number_text } from "../src/format.js";
import { shape_viewer } from "../src/shape_viewer.js";
import { read_modes, read_structure } from "../src/structure.js";
import { data_table } from "../src/table.js";

/** The mode's number, with a button to choose it: up and down arrows leaf through the modes as through any such group. */
function choice_of(mode, choose) {
  const input = element("input", {
    type: "radio",
    name: "mode-shown",
    value: mode.index,
    checked: mode.index === 0,
    "aria-label": `Show mode ${mode.number}`,
    onchange: () => choose(mode.index),
  });
  return element("label", { class: "choice" }, input, ` ${mode.number}`);
}

function mode_table(modes, unit, choose) {
  const is_told_by_number = ({ label, number }) => !label || label.toLowerCase() === `mode ${number}`;
  const columns = [
    {
      key: "number",
      title: "Mode",
      csv: ({ number }) => number,
      text: (_, mode) => (choose ? choice_of(mode, choose) : String(mode.number)),
    },
    { key: "frequency", title: "Frequency", unit, text: (value) => number_text(value, 5) },
    modes.every(is_told_by_number) ? null : { key: "label", title: "Name", is_text: true },
    modes.some(({ residual }) => is_number(residual))
      ? { key: "residual", title: "Residual", text: (value) => number_text(value, 2) }
      : null,
    modes.some(({ note }) => note) ? { key: "note", title: "Note", is_text: true, of_class: () => "remark" } : null,
  ].filter(Boolean);
  const table = data_table({
    id: "modes",
    title: "Natural frequencies",
    columns,
    rows: modes.map((mode) => ({ ...mode, name: mode.label || `mode ${mode.number}` })),
  });
  if (choose) {
    table.addEventListener("click", ({ target }) => {
      if (!target.closest("label")) target.closest("tbody tr")?.querySelector("input").click();
    });
  }
  return table;
}

export default {
  id: "shapes",
  title: "Mode shapes",
  has_data: ({ modes }) => list(modes.list).length > 0,
  explained: [
    [
      "Mode shape",
      "The form in which a structure vibrates freely at a natural frequency. Its size is arbitrary: here the largest displacement is 1. " +
        "Drag to turn, with the right button or Shift to move, Ctrl and the mouse wheel to enlarge; by touch with one finger and two. " +
        "Arrow keys turn the drawing or leaf through the table, + and \u2212 enlarge.",
    ],
    [
      "Residual",
      "How far frequency and shape are from solving the equations, relative to the terms in them: the smaller the better.",
    ],
  ],
  content(study) {
    const modes = read_modes(study.modes);
    const unit = String(study.modes.frequency_unit ?? "Hz");
    const structure = read_structure(study.modes);
    if (!structure) return [mode_table(modes, unit, null)];
    const viewer = shape_viewer(structure, modes, unit);
    return [element("div", { class: "shapes" }, viewer.element, mode_table(modes, unit, viewer.choose))];
  },
};
